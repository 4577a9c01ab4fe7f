"""The proof file, format 3 (docs/format.md), of a proof that is finished or not."""

import re
from dataclasses import asdict, fields

from ..model.exact import DECIMAL, decimal_text, exact
from ..model.problem import NAMES, Problem
from ..storage import files
from ..storage.files import ConverseError
from . import tree
from .native import CONSTANTS, Counts
from .proof import Proof
from .settings import Settings

FIRST_LINE, BEFORE = "converse proof 3", "converse proof 2"
PROGRAM = re.compile(r"converse ([0-9A-Za-z.+-]{1,40})")
CLAIMS = {False: "sound", True: "as printed, not a proof"}       # by as_printed
LINE_WIDTH = 78                              # of the tree's lines


def save(proof, path):
    """Proof.save()."""
    return files.write_text(path, _text(proof))


def load(path):
    """Proof.load()."""
    text = files.read_text(path, "proof file",
                           ", line 1: the file is truncated or not a proof file of this program")
    lines = text.split("\n")

    def fail(number, wrong):
        raise ConverseError("%s, line %d: %s; use an intact copy or start anew"
                            % (path, number, wrong))

    if lines[0] == BEFORE:
        raise ConverseError("%s: is a proof file of format 2, which releases up to 1.6.0 read; "
                            "continue it with one of those, which writes format 3" % path)
    if lines[0] != FIRST_LINE:
        fail(1, "this is not a proof file of this program")
    if lines[-2:] != ["end", ""]:
        fail(len(lines), "the file is truncated")
    body = text[:text.rfind("\n", 0, len(text) - len("\nend\n")) + 1]
    if lines[-3] != "checksum: sha256 " + files.sha256(body):
        fail(len(lines) - 2, "the file was changed or damaged (wrong checksum)")

    start = lines.index("tree:") if "tree:" in lines else fail(len(lines), "there is no tree")
    values, comments, waves = {}, [], []
    for number, line in enumerate(lines[1:start], 2):
        key, colon, value = line.partition(": ")
        if not colon:
            fail(number, "'%s' is not 'name: value'" % line)
        elif key == "comment":
            comments.append(value)
        elif key == "wave":
            waves.append(value.split())
        else:
            values[key] = value
    try:
        problem = _problem(values, waves, comments)
        return _proof(values, problem, "".join(lines[start + 1:-3]), files.sha256(text))
    except (KeyError, IndexError, TypeError, ValueError) as error:
        fail(start + 1, "the header or the tree makes no sense (%s)" % error)


def _text(proof):
    problem, at_once = proof.problem, _yes(proof.at_once)
    if proof.at_once and len(problem.parts) == 1:
        at_once = "upper end"
    lines = [FIRST_LINE, "kind: " + CLAIMS[proof.as_printed],
             "program: converse " + proof.version, "method: " + proof.method]
    lines += _problem_lines(problem)
    lines += ["xstar: " + " ".join(proof.xstar)] if proof.xstar else []
    lines += ["depth: %d" % proof.depth, "digits: %d" % proof.digits,
              "stubborn: " + _yes(proof.settings.stubborn), "at once: " + at_once]
    lines += [] if proof.all_decided else ["seconds: %.2f" % proof.seconds]
    lines += ["pending: " + " ".join(map(str, proof.pending))]
    for name, value in asdict(proof.counts).items():
        values = value if isinstance(value, tuple) else (value,)
        lines.append("%s: %s" % (name, " ".join(map(str, values))))
    lines += ["%s: %s" % item for item in proof.constants.items()]
    lines += ["comment: " + comment for comment in problem.comments]
    lines += ["tree:"]
    lines += [proof.tree[i:i + LINE_WIDTH] for i in range(0, len(proof.tree), LINE_WIDTH)]
    text = "\n".join(lines) + "\n"
    return text + "checksum: sha256 %s\nend\n" % files.sha256(text)


def _proof(values, problem, nodes, sha256):
    """The Proof of the header's fields, their values by name, and the tree."""
    counts = {}
    for item in fields(Counts):
        numbers = tuple(int(word) for word in values[item.name].split())
        counts[item.name] = numbers if isinstance(item.default, tuple) else numbers[0]
    xstar = None
    if "xstar" in values:
        x0, x1 = values["xstar"].split()
        xstar = _number(x0), _number(x1)
    program = PROGRAM.fullmatch(values["program"])
    if program is None:
        raise ValueError("of an unknown program")
    settings = Settings(values["method"], int(values["depth"]), int(values["digits"]),
                        values["stubborn"] == "yes",
                        {kind: printed for printed, kind in CLAIMS.items()}[values["kind"]])
    constants = {name: _number(values[name]) for name in CONSTANTS[settings.method]
                 if name in values}
    tree.complete(nodes)                # TreeError, a ValueError: it is not a tree
    return Proof(problem, settings, nodes, Counts(**counts), xstar, constants,
                 float(values.get("seconds", 0)), program[1],
                 tuple(map(int, values["pending"].split())), _at_once(values, problem),
                 nodes.count("P") + nodes.count("S"), sha256)


def _problem_lines(problem):
    """The fields of the header that say which problem it is."""
    lines = ["wave: %d %d %s" % wave + "".join(" " + decimal_text(x) for x in numbers)
             for wave, *numbers in zip(problem.waves, problem.amplitude, *problem.parts)]
    lines += ["frame: %d %d %d %d" % problem.frame,
              "alone: %s" % ("no" if problem.factor is None else problem.factor),
              "odd about: " + ("no" if problem.odd is None else "%s %s" % problem.odd)]
    ends = zip(NAMES[3:], problem.centre[-2:], problem.half[-2:])
    return lines + ["%s: %s %s" % (name, decimal_text(centre), decimal_text(half))
                    for name, centre, half in ends]


def _problem(values, waves, comments):
    """The problem of such fields, given all the words of each wave."""
    amplitude, *parts = zip(*(words[3:] for words in waves))
    if len({len(words) for words in waves}) != 1:
        raise ValueError("the waves do not agree in how many parameters there are")
    alone = values["alone"]
    if "odd about" not in values:
        raise KeyError("odd about")
    v0, v1 = (_ends(values, name) for name in NAMES[3:])
    return Problem.patch(amplitude, parts, [(*map(int, words[:2]), words[2]) for words in waves],
                         v0, v1, comments, tuple(map(int, values["frame"].split())),
                         alone if alone == "no" else int(alone))


def _at_once(values, problem):
    """Is such a claim made, and one that may be made of the problem?"""
    word = values["at once"]
    if word == "no":
        return False
    if problem.odd is None or (word != "yes" and (word, len(problem.parts)) != ("upper end", 1)):
        raise ValueError("at once: %.40s" % word)
    return True


def _ends(values, name):
    centre, half = map(exact, values[name].split())
    if half < 0:
        raise ValueError("the half-width of %s is negative" % name)
    return centre - half, centre + half


def _number(text):
    """The text, which must be that of a decimal number."""
    if not DECIMAL.fullmatch(text):
        raise ValueError("'%.40s' is not a decimal number" % text)
    return text


def _yes(truth):
    return "yes" if truth else "no"
