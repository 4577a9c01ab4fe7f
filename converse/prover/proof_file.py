"""The proof file (docs/reference/proof-file.md), of a proof that is finished or not."""

import dataclasses
import re
from collections import defaultdict
from fractions import Fraction

from ..model.exact import DECIMAL, decimal_text, exact
from ..model.map import from_patch
from ..model.problem import NAMES, Problem
from ..storage.kept import damaged, read_sealed, sealed, unsealed
from . import tree
from .native import CONSTANTS, Counts
from .proof import Proof, Tree
from .settings import FILED, Settings

FIRST_LINE = "converse proof 6"
PROGRAM = re.compile(r"converse ([0-9A-Za-z.+-]{1,40})")
CLAIMS = {False: "sound", True: "as printed, not a proof"}       # by as_printed
LINE_WIDTH = 78                              # of the tree's lines


def load(path):
    """Proof.load()."""
    return parsed(read_sealed(path, "proof file"), path)


def parsed(text, path):
    """The Proof in the text of a file, which messages about it call `path`."""
    lines, sha256 = unsealed(text, path, FIRST_LINE, "proof file")
    if "tree:" not in lines:
        raise damaged(path, len(lines) + 3, "there is no tree")
    start, values = lines.index("tree:"), defaultdict(list)
    for number, line in enumerate(lines[1:start], 2):
        key, colon, value = line.partition(": ")
        if not colon:
            raise damaged(path, number, "'%s' is not 'name: value'" % line)
        values[key].append(value)
    try:
        return _proof(values, _trees(lines[start:]), sha256)
    except (KeyError, IndexError, TypeError, ValueError) as error:
        raise damaged(path, start + 1, "the header or a tree makes no sense (%s)" % error) from None


def _trees(lines):
    """Reads the lines that begin with the first `tree:`.  Returns for each tree the fields of its
    part (the first has none) and its text."""
    trees = [({}, [])]
    for line in lines:
        key, colon, value = line.partition(": ")
        if key == "part" and colon:
            if value != tree.LETTERS[len(trees) - 1]:
                raise ValueError("part %.20s is out of its order" % value)
            trees.append(({}, []))
        elif colon:
            trees[-1][0][key] = value
        elif line != "tree:":
            trees[-1][1].append(line)
    if trees[0][0] or any(set(fields) != {"xstar", "v0", "v1"} for fields, _ in trees[1:]):
        raise ValueError("a part has other fields than it should")
    return [(fields, "".join(text)) for fields, text in trees]


def text_of(proof):
    """The content of the file."""
    problem, at_once = proof.problem, _yes(proof.at_once)
    if proof.at_once and len(problem.parts) == 1:
        at_once = "upper end"
    if problem.shifts:                  # which the header cannot say
        raise ValueError("the region of a whole proof does not move with the parameters")
    lines = [FIRST_LINE, "kind: " + CLAIMS[proof.as_printed],
             "program: converse " + proof.version, "method: " + proof.method]
    lines += _problem_lines(problem)
    lines += ["xstar: " + " ".join(proof.xstar)] if proof.xstar else []
    for name in FILED:
        value = getattr(proof.settings, name)
        lines += ["%s: %s" % (name, _yes(value) if isinstance(value, bool) else value)]
    lines += ["at once: " + at_once]
    lines += [] if proof.all_decided else ["seconds: %.2f" % proof.seconds]
    lines += ["hopeless: yes"] if proof.hopeless else []
    pending, before = (), 0
    for each in proof.trees:            # a hint that is missing is 0
        pending += (0,) * (before - len(pending)) + each.pending
        before += _untried(each.text)
    lines += ["pending: " + " ".join(map(str, pending))]
    for name, value in dataclasses.asdict(proof.counts).items():
        values = value if isinstance(value, tuple) else (value,)
        lines.append("%s: %s" % (name, " ".join(map(str, values))))
    lines += ["%s: %s" % item for item in proof.constants.items()]
    lines += ["parameter: %s %s %s" % (name, decimal_text(low), decimal_text(high))
              for name, low, high in problem.parameters]
    lines += ["comment: " + comment for comment in problem.comments]
    lines += _tree_lines(proof.tree)
    for letter, part in zip(tree.LETTERS, proof.parts):
        lines += ["part: " + letter, "xstar: " + " ".join(part.xstar),
                  _ends_line("v0", part.problem.v0, [s0 for s0, _ in part.problem.shifts]),
                  _ends_line("v1", part.problem.v1, [s1 for _, s1 in part.problem.shifts]),
                  *_tree_lines(part.text)]
    return sealed(lines)


def _tree_lines(text):
    return ["tree:"] + [text[i:i + LINE_WIDTH] for i in range(0, len(text), LINE_WIDTH)]


def _untried(text):
    """How many prisms of a search that is not stubborn are yet to be tried: those with a `?` and
    those that are missing at the end, unless an undecided one has ended it."""
    return text.count(tree.UNTRIED) if "U" in text else tree.untried(text)


def _proof(fields, trees, sha256):
    """The Proof of the header's fields, all their values by name, and what _trees returns."""
    values = {name: texts[-1] for name, texts in fields.items()}
    problem = _problem(values, [text.split() for text in fields["wave"]], fields["comment"],
                       [text.split(" ") for text in fields["parameter"]])
    counts = {}
    for item in dataclasses.fields(Counts):
        numbers = tuple(int(word) for word in values[item.name].split())
        counts[item.name] = numbers if isinstance(item.default, tuple) else numbers[0]
    xstar = _point(values["xstar"]) if "xstar" in values else None
    program = PROGRAM.fullmatch(values["program"])
    if program is None:
        raise ValueError("of an unknown program")
    settings = Settings(values["method"], as_printed={
        kind: printed for printed, kind in CLAIMS.items()}[values["kind"]], **{
        name: value == "yes" if value in ("yes", "no") else int(value)
        for name, value in ((name, values[name]) for name in FILED)})
    constants = {name: _number(values[name]) for name in CONSTANTS[settings.method]
                 if name in values}
    # A Problem may make parameters of numbers: how many there are is counted in the file.
    parameters = len(fields["wave"][0].split()) - 4
    hints, grown = tuple(map(int, values["pending"].split())), []
    for named, text in trees:
        tree.complete(text)             # TreeError, a ValueError: it is not a tree
        mine, hints = _divided(hints, text) if len(trees) > 1 else (hints, ())
        at, star = problem, xstar
        if grown:
            (v0, s0), (v1, s1) = (_ends(named, name, parameters) for name in NAMES[3:])
            at, star = problem.part((v0, v1), tuple(zip(s0, s1))), _point(named["xstar"])
        if at.shifts and "S" in text:
            raise ValueError("a prism of a part is skipped (S), though the part's region moves")
        grown.append(Tree(at, star, text, mine))
    tree.check_letters([text for _, text in trees])
    if grown[1:] and (settings.method != "loewner" or problem.factor is not None):
        raise ValueError("parts, which go with the sharper method and no coordinate that is alone")
    return Proof(tuple(grown), settings, Counts(**counts), constants,
                 float(values.get("seconds", 0)), program[1], _at_once(values, problem),
                 values.get("hopeless") == "yes",
                 sum(text.count("P") + text.count("S") for _, text in trees), sha256)


def _point(text):
    x0, x1 = text.split()
    return _number(x0), _number(x1)


def _divided(hints, text):
    """The hints of a tree, if any of them is known, and the hints of the trees after it."""
    mine, rest = hints[:_untried(text)], hints[_untried(text):]
    return mine if any(mine) else (), rest


def _problem_lines(problem):
    """The fields of the header that say which problem it is."""
    lines = ["wave: %d %d %s" % wave + "".join(" " + decimal_text(x) for x in numbers)
             for wave, *numbers in zip(problem.waves, problem.amplitude, *problem.parts)]
    lines += ["frame: %d %d %d %d" % problem.frame,
              "alone: %s" % ("no" if problem.factor is None else problem.factor),
              "odd about: " + ("no" if problem.odd is None else "%s %s" % problem.odd)]
    return lines + [_ends_line(name, getattr(problem, name)) for name in NAMES[3:]]


def _ends_line(name, ends, shifts=()):
    low, high = ends
    return "%s: %s" % (name, " ".join(map(decimal_text, (
        (low + high) / 2, (high - low) / 2, *shifts))))


def _problem(values, waves, comments, parameters):
    """The problem of such fields, given all the words of each wave and of each parameter."""
    amplitude, *parts = zip(*(words[3:] for words in waves))
    if len({len(words) for words in waves}) != 1:
        raise ValueError("the waves do not agree in how many parameters there are")
    alone = values["alone"]
    if "odd about" not in values:
        raise KeyError("odd about")
    v0, v1 = (_ends(values, name)[0] for name in NAMES[3:])
    harmonics = [(*map(int, words[:2]), words[2]) for words in waves]
    named = [(name, exact(_number(low)), exact(_number(high))) for name, low, high in parameters]
    return Problem(from_patch(harmonics, amplitude, parts, named), v0, v1, comments,
                   tuple(map(int, values["frame"].split())),
                   alone if alone == "no" else int(alone))


def _at_once(values, problem):
    """Is such a claim made, and one that may be made of the problem?"""
    word = values["at once"]
    if word == "no":
        return False
    if problem.odd is None or (word != "yes" and (word, len(problem.parts)) != ("upper end", 1)):
        raise ValueError("at once: %.40s" % word)
    return True


def _ends(values, name, parameters=0):
    """The ends of a range, and its shift by each parameter."""
    words = values[name].split()
    if len(words) not in (2, 2 + parameters):
        raise ValueError("%s has %d numbers, not %s" % (
            name, len(words), "2 or %d" % (2 + parameters) if parameters else 2))
    centre, half, *shifts = (exact(_number(word)) for word in words)
    if half < 0:
        raise ValueError("the half-width of %s is negative" % name)
    return (centre - half, centre + half), shifts or [Fraction(0)] * parameters


def _number(text):
    """The text, which must be a decimal number."""
    if not DECIMAL.fullmatch(text):
        raise ValueError("'%.40s' is not a decimal number" % text)
    return text


def _yes(truth):
    return "yes" if truth else "no"
