"""The report of a diagram: its theorem in the parameters of the family, and what is open."""

from ..check import box_words, exact_text, union
from ..model.exact import decimal_text, rounded, rounded_text
from ..model.problem import Problem
from ..model.statement import TORUS, ended, indented, labelled, map_lines, whole
from ..storage.kept import headline, verify_text

MOST_BOXES = 40                         # that a report lists
TERMS = 8                               # of a continued fraction
PLACES = 12                             # of the components of a rotation vector


def report(diagram, file=None):
    """Diagram.report()."""
    two, names, lines = diagram.family.dimension == 2, diagram.names, []
    torus = TORUS[diagram.family.dimension]
    values = _listed(names, diagram.boxes)
    boxes = {}                          # with tori, by the rotation vector
    for member in sorted(diagram.members, key=lambda member: member.box):
        if member.rotation is not None:
            boxes.setdefault(member.rotation, []).append(member.box)
    tori = [("; ".join(_words(names, each)), rotation) for rotation, each in boxes.items()]
    everywhere = _words(names, [box for each in boxes.values() for box in each])
    larger = _listed(names, [member.box for member in diagram.members if member.larger])
    if values:
        lines += ["has no %s J = P + S'(y)%s, P constant, S periodic and C1, for %s" % (
            torus, " over both angles" * two, "; ".join(values))]
    if larger:
        lines += ["and for every multiple s >= 1 of " + "; ".join(larger)]
    if tori:
        lines += ["%shas a%s %s, real analytic and conjugate to a rotation, for %s" % (
            "and " * bool(values), "n" * two, torus, "; ".join(everywhere))]
    pins = box_words(diagram.family.names[len(names):], diagram.family.ranges[len(names):])
    first = headline("THEOREM", diagram.restored, "proof") if lines else \
        "UNDECIDED: nothing is proved."
    lines = [first, *ended([*map_lines(Problem.of(diagram.family)), *indented(
        ["where %s," % pins] * bool(pins) + lines)]), ""]
    for label, text in _grounds(diagram, tori, file):
        lines += labelled(label, text)
    return "\n".join(lines) + "\n"


def _listed(names, boxes):
    """The values of the boxes in words; the number of the boxes if there are too many."""
    if len(boxes) > MOST_BOXES:
        return ["every (%s) in %d boxes, which the attributes `none` and `members` of the diagram, "
                "and converse-check, list" % (", ".join(names), len(boxes))]
    return _words(names, boxes)


def _words(names, boxes):
    """The values of the boxes in words; with one parameter those of their union."""
    if len(names) == 1:
        boxes = [(ends,) for ends in union([ends for ends, in boxes])]
    return [whole(box_words(names, box)) for box in boxes]


def _grounds(diagram, tori, file):
    """(label, text) of the lines below the theorem."""
    if diagram.members or diagram.sides:
        yield "Verify", verify_text(file, "diagram")
    for words, rotation in tori:
        yield "Rotation", "%s: %s" % (words, rotation_text(rotation))
    searched = ((diagram.none, "absence of tori"), (tori, "torus"))
    yield "Searched", "%s; between proved values nothing is proved" % "; ".join([
        box_words(diagram.names, diagram.ranges), *(
            "no %s was proved" % words for found, words in searched
            if not found and len(diagram.ranges) == 1)])
    if len(diagram.ranges) == 1:
        proved = [*diagram.none, *(each[:2] for each in diagram.tori)]

        def sign(end):                  # an end of the range may itself be open
            return "<" if any(low <= end <= high for low, high in proved) else "<="

        yield "Open", "; ".join(whole(" ".join((
            exact_text(low), sign(low), *diagram.names, sign(high), exact_text(high))))
            for low, high in diagram.open) or "nothing"
    else:
        yield "Open", "%s %% of the rectangle" % rounded_text(
            100 * _open_share(diagram), 3, up=True)
    for low, high in diagram.open if len(diagram.ranges) == 1 else []:
        seen = [each for each in diagram.seen if low <= each.value[0] <= high]
        if seen:
            yield "Seen", _seen_words(*diagram.names, seen)
    tori = sum(member.rotation is not None for member in diagram.members)
    sides = ", and %d by one point of the torus each" % len(diagram.sides)
    yield "Proofs", "%d of no torus%s, %d of tori; %s points of orbits, %.0f s" % (
        len(diagram.members) - tori, sides * bool(diagram.sides), tori,
        format(diagram.points, ","), diagram.seconds)
    if diagram.sha256:
        yield "SHA-256", diagram.sha256


def _seen_words(name, seen):
    """The values of an open part at which a torus is seen, in words."""
    values, rotations = [each.value[0] for each in seen], zip(*[each.rotation for each in seen])
    if len(seen) == 1:
        return "%s = %s: an orbit as of a torus, rotation %s" % (
            name, exact_text(*values), ", ".join("%.9g" % x for x, in rotations))
    return "%d values, %s from %s to %s: orbits as of tori, rotations %s" % (
        len(seen), name, exact_text(values[0]), exact_text(values[-1]),
        ", ".join("from %.6g to %.6g" % (min(turns), max(turns)) for turns in rotations))


def _open_share(diagram):
    """The share of the rectangle of two parameters in which nothing is proved."""
    def area(low, high):
        return (high[0] - low[0]) * (high[1] - low[1])

    return sum(area(*box) for box in diagram.open) / area(*zip(*diagram.ranges))


def rotation_text(rotation):
    """A rotation vector: its name or polynomial, its first decimals and, of one angle, its
    continued fraction."""
    text = ", ".join(decimal_text(rounded(low, PLACES, up=low < 0), PLACES) + "..."
                     for low, _ in rotation.turns(30))
    if rotation.dimension == 1:
        text += " = " + rotation.continued_fraction(TERMS)
    return "omega = %s (%s)" % (text, rotation)
