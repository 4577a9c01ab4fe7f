"""The proof file (docs/reference/proof-file.md), of a proof that is finished or not."""

import dataclasses
from dataclasses import replace

from ..model.exact import decimal_text, exact
from ..model.map import from_patch
from ..model.problem import ANGLES, Problem, ranges
from ..storage.kept import program_of, sealed
from . import tree
from .native import CONSTANTS, ORDINARY, Counts
from .proof import Proof, Tree
from .settings import FILED, Settings

FIRST_LINE = "converse proof 6"
CLAIMS = {False: "sound", True: "as printed, not a proof"}       # by as_printed
LINE_WIDTH = 78                              # of the tree's lines


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
    if proof.longest is not None and not proof.all_decided:
        lines += ["long orbits: " + _yes(not proof.longest)]
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
        lines += part_lines(letter, part)
    return sealed(lines)


def part_lines(name, part):
    """The lines of a Tree that has a name in its file."""
    problem = part.problem
    shifts = zip(*problem.shifts) if problem.shifts else [()] * problem.size
    return ["part: " + name, "xstar: " + " ".join(part.xstar),
            *map(_ends_line, ANGLES, problem.region, shifts), *_tree_lines(part.text)]


def _tree_lines(text):
    return ["tree:"] + [text[i:i + LINE_WIDTH] for i in range(0, len(text), LINE_WIDTH)]


def _untried(text):
    """How many prisms of a search that is not stubborn are yet to be tried: those with a `?` and
    those that are missing at the end, unless an undecided one has ended it."""
    return text.count(tree.UNTRIED) if "U" in text else tree.untried(text)


def proof_of(claim):
    """The Proof of a file, from its claim as the checker reads it."""
    header = claim.header
    problem = Problem(map_of(claim, claim.names), comments=header.get("comment", ()),
                      axes=claim.frame, alone="no" if claim.alone is None else claim.alone,
                      **ranges(_ends(claim)))
    counts = {}
    for item in dataclasses.fields(Counts):
        numbers = tuple(map(int, header[item.name].split()))
        counts[item.name] = numbers if isinstance(item.default, tuple) else numbers[0]
    settings = Settings(header["method"], as_printed={
        kind: printed for printed, kind in CLAIMS.items()}[header["kind"]], **{
        name: value == "yes" if value in ("yes", "no") else int(value)
        for name, value in ((name, header[name]) for name in FILED)})
    constants = {name: header[name] for name in CONSTANTS[settings.method]
                 if name in header and exact(header[name])}
    first = Tree(problem, tuple(header["xstar"].split()) if claim.xstar else None, claim.tree)
    hints, grown = tuple(map(int, header["pending"].split())), []
    for each in (first, *[tree_of(part, problem) for part in claim.parts]):
        tree.complete(each.text)        # TreeError, a ValueError: it is not a tree
        if problem.size == 2 and tree.CUTS[tree.ANGLES[2]] in each.text:
            raise ValueError("a cut along v2 (5), and the map has no such angle")
        if each.problem.shifts and "S" in each.text:
            raise ValueError("a prism of a part is skipped (S), though the part's region moves")
        mine, hints = _divided(hints, each.text) if claim.parts else (hints, ())
        grown.append(replace(each, pending=mine))
    tree.check_letters([each.text for each in grown])
    if grown[1:] and settings.method != "loewner":
        raise ValueError("parts, which go with the sharper method")
    return Proof(tuple(grown), settings, Counts(**counts), constants,
                 float(header.get("seconds", 0)), program_of(header), claim.at_once != "no",
                 header.get("hopeless") == "yes",
                 {"yes": 0, "no": ORDINARY}.get(header.get("long orbits")),
                 sum(each.text.count("P") + each.text.count("S") for each in grown), claim.sha256)


def map_of(claim, names=()):
    """The map of a claim's waves.  names: of its parameters, with their ranges."""
    return from_patch([(*wave.k, wave.phase) for wave in claim.waves],
                      [wave.middle for wave in claim.waves],
                      list(zip(*[wave.parts for wave in claim.waves])), names)


def tree_of(claim, problem):
    """The Tree of a part of a claim, which is of the same map as the problem."""
    return Tree(problem.part(_ends(claim), claim.shifts), tuple(map(decimal_text, claim.xstar)),
                claim.tree)


def _ends(claim):
    """The ranges of v0, v1, ..."""
    return tuple((centre - half, centre + half) for centre, half in zip(claim.centre, claim.half))


def _divided(hints, text):
    """The hints of a tree, if any of them is known, and the hints of the trees after it."""
    mine, rest = hints[:_untried(text)], hints[_untried(text):]
    return mine if any(mine) else (), rest


def wave_lines(problem):
    """The fields of the header that say of which maps it is."""
    return ["wave: " + " ".join([*map(str, term.k), str(term.phase), *map(
        decimal_text, (term.p, *term.parts))]) for term in problem.terms]


def _problem_lines(problem):
    """The fields of the header that say which problem it is."""
    lines = ["angles: 3"] * (problem.size > 2) + wave_lines(problem)
    lines += ["frame: " + " ".join(map(str, problem.frame)),
              "alone: %s" % ("no" if problem.factor is None else problem.factor),
              "odd about: " + ("no" if problem.odd is None else " ".join(map(str, problem.odd)))]
    return lines + list(map(_ends_line, ANGLES, problem.region))


def _ends_line(name, ends, shifts=()):
    low, high = ends
    return "%s: %s" % (name, " ".join(map(decimal_text, (
        (low + high) / 2, (high - low) / 2, *shifts))))


def _yes(truth):
    return "yes" if truth else "no"
