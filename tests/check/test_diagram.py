"""Diagrams: the checker confirms those that are proved, and says of which values; it rejects
everything else."""

import gzip
import hashlib
import re
from fractions import Fraction as F

import pytest
from files import sealed

from converse import FourierMap, FroeschleMap, StandardMap, prove
from converse.diagram import Diagram

from checker import check

pytestmark = pytest.mark.usefixtures("impatient")


def members(text):
    """The head of a diagram, and its members."""
    head, rest = text.split("members:\n")
    found = re.findall("(?s)converse (?:proof|torus).*?\nend\n", rest)
    return head + "members:\n", found


def with_members(text, *found):
    return sealed(members(text)[0] + "".join(found) + "checksum: ")


def with_line(text, name, value):
    return sealed(re.sub("(?m)^%s: .*$" % name, "%s: %s" % (name, value), text, count=1))


@pytest.fixture(scope="module")
def froeschle():
    found = Diagram.of(FroeschleMap((0, 3), (0, 1)))
    found.add(prove(FroeschleMap(("1.5", "1.6"), ("0.1", "0.2"))))
    return found._text()


# ---- what is confirmed

@pytest.mark.parametrize("options", [(), ("--exact",), ("--jobs", "2")])
def test_confirms_a_diagram(diagram, run, options):
    """One theorem about all values, in the parameter of the family."""
    status, out, err = run(diagram, *options)
    assert (status, err) == (0, "") and out.startswith("Verified :\nTHEOREM.")
    assert re.findall("  (every k .*)", out) == [
        "every k in [1.2, 1.3]", "every k >= 1.6",
        "every k in [0.1, 0.2]: omega = t = 0.618033988749...,"]
    assert "\nV(y) = k cos y,\n" in out
    assert "Certificates of tori checked : 1\n" in out
    assert hashlib.sha256(diagram.encode()).hexdigest() in out


def test_a_compressed_diagram_and_a_spot_check(diagram, run):
    assert run(gzip.compress(diagram.encode()))[0] == 0
    status, out, _ = run(diagram, "--sample", "2")
    assert status == 4 and "Certificates" not in out and "NOT verified" in out


def test_two_parameters(froeschle, run):
    status, out, _ = run(froeschle)
    assert status == 0 and "  every k in [1.5, 1.6], every b in [0.1, 0.2]\n" in out
    assert "has no invariant Lagrangian graph" in out


def test_a_diagram_of_tori_alone_and_one_of_a_side_alone(diagram, run):
    """What there is is verified; there may be no proof of the other kind."""
    head, found = members(diagram)
    status, out, _ = run(with_members(re.sub("(?m)^above: .*\n", "", diagram), found[2]))
    assert status == 0 and "has no" not in out and "Leaves : 0" in out
    status, out, _ = run(with_members(diagram))
    assert status == 0 and "every k >= 2.5" in out and "conjugate" not in out


# ---- of which values a member speaks

K = FourierMap({1: {"K": 1, "constant": "0.1"}, 2: {"K": "-1/2"}, 3: "1/3"}, K=(0, 2))


def family_of(source):
    made = Diagram.of(source)
    return check.Family(made.waves, made.names)


def waves(*texts):
    return check.parse_waves(texts, check.RATIO)


@pytest.mark.parametrize("lines, values", [
    (("1 0 0 1.1", "2 0 0 -0.5", "3 0 0 1/3"), (1, 1)),
    (("1 0 0 1.1 0.2", "2 0 0 -0.5 -0.1", "3 0 0 1/3 0"), (F("0.8"), F("1.2"))),
    (("1 0 0 1.1 -0.2", "2 0 0 -0.5 0.1", "3 0 0 1/3 0"), (F("0.8"), F("1.2"))),
    # the same potential, written otherwise
    (("-1 0 1 1.1", "2 0 1 0.5", "3 0 0 1/6", "3 0 2 1/6"), (1, 1)),
    # a parameter encloses 1/3
    (("1 0 0 1.1 0.2 0", "2 0 0 -0.5 -0.1 0", "3 0 0 0.3 0 0.1"), (F("0.8"), F("1.2"))),
    (("1 0 0 1.1 0.2 0.1", "2 0 0 -0.5 -0.1 -0.05", "3 0 0 1/3 0 0"), (F("0.7"), F("1.3"))),
    # it crosses the family where t = 0
    (("1 0 0 1.1 0.2", "2 0 0 -0.5 0.1", "3 0 0 1/3 0"), (1, 1)),
    (("1 0 0 1.1 0.2", "2 0 0 -0.5 -0.1", "3 0 0 1/3 0.1"), (1, 1))])
def test_of_which_values_a_member_speaks(lines, values):
    assert family_of(K).values(waves(*lines))[0] == (values,)


@pytest.mark.parametrize("lines", [
    ("1 0 0 1.1", "2 0 0 -0.5"),                                # a wave is missing,
    ("1 0 0 1.1", "2 0 0 -0.5", "3 0 0 1/3", "4 0 0 1e-9"),     # or there is another
    ("1 0 0 1.1", "2 0 0 -0.51", "3 0 0 1/3"), ("1 0 1e-9 1.1", "2 0 0 -0.5", "3 0 0 1/3"),
    ("1 0 0 1.1 0", "2 0 0 -0.5 0", "3 0 0 0.3 0.01"),          # 1/3 is not enclosed: t > 1,
    ("1 0 0 1.1 0", "2 0 0 -0.5 0", "3 0 0 0.4 0.01"),          # t < -1
    ("1 1 0 1.1", "2 0 0 -0.5", "3 0 0 1/3")])
def test_a_member_of_another_family_is_rejected(lines):
    with pytest.raises(check.Rejected, match="not of the family"):
        family_of(K).values(waves(*lines))


def test_boxes_of_two_parameters():
    """One parameter of the member may move both: then its values are no box."""
    family = family_of(FroeschleMap((0, 1), (0, 1)))
    box, _ = family.values(waves("1 0 -1/2 0.4 0.1 0", "0 1 -1/2 0.4 0.1 0", "1 1 -1/2 0.2 0 0.1"))
    assert box == ((F("0.3"), F("0.5")), (F("0.1"), F("0.3")))
    with pytest.raises(check.Rejected, match="not a box"):
        family.values(waves("1 0 -1/2 0.4 0.1", "0 1 -1/2 0.4 0.1", "1 1 -1/2 0.2 0.1"))


@pytest.mark.parametrize("ends, box", [(("1.3", "1.4"), ("1.3", float("inf"))),
                                       (("-1.4", "-1.36"), (float("-inf"), "-1.36")),
                                       (("1.2", "1.3"), ("1.2", "1.3"))])
def test_all_larger_multiples(ends, box):
    """Where B > 10/3 at the end at t = 1, and each multiple of a map is the map of a multiple."""
    family = family_of(StandardMap((0, 2)))
    text = prove(StandardMap(ends))._text()
    found = family.member(text.encode())
    assert found.box == (tuple(x if isinstance(x, float) else F(x) for x in box),)


def test_an_upper_end_that_is_no_map_of_the_family():
    """The multiples of the member's map at t = 1 are none of the family, which the member crosses
    at t = 0: nothing is known of the multiples of that map."""
    text = prove(StandardMap(("1.3", "1.4")))._text().replace("at once: yes", "at once: upper end")
    across = with_line(text, "wave", "1 0 -1/2 1.2 0\nwave: 3 0 -1/2 0 0.02")
    assert "at once: upper end" in across
    found = family_of(StandardMap((0, 2))).member(with_line(across, "v0", "1 1").encode())
    assert (found.box, found.larger) == (((F("1.2"), F("1.2")),), False)


def test_the_multiples_of_a_family_with_a_constant_are_not_of_it():
    family = FourierMap({1: {"K": 1}, 2: "0.2"}, K=(0, 3))
    proof = prove(Diagram.of(family).over(((F(2), F("2.1")),)))
    assert proof.at_once and family_of(family).member(proof._text().encode()).box == (
        (F(2), F("2.1")),)


# ---- beyond a value

@pytest.mark.parametrize("side, line, confirmed", [
    ("above", "2.0001 1/2 0 1 0", True), ("above", "1.9999 1/2 0 1 0", False),
    ("above", "2 1/2 0 1 0", False),                # it is true, but only just
    ("below", "-2.0001 0 0 1 0", True), ("below", "-2.0001 1/2 0 1 0", False),
    ("above", "-3 0 0 1 0", False),                 # n.beta n grows with k
    ("above", "5 1/4 0 1 0", False), ("above", "5 1/2 0 0 0", False),
    ("above", "5 1/2 0 0 1", False)])
def test_all_values_beyond_one(run, diagram, side, line, confirmed):
    text = re.sub("(?m)^above: .*$", "%s: %s" % (side, line), with_members(diagram))
    status, out, err = run(sealed(text))
    assert (status, bool(out)) == ((0, True) if confirmed else (5, False))
    if not confirmed:
        assert "it is not confirmed that no graph exists %s" % side in err


# ---- what is rejected

@pytest.mark.parametrize("change, status, why", [
    (lambda t: t.replace("converse diagram 1", "converse diagram 2", 1), 2, "another version"),
    (lambda t: with_line(t, "wave", "1 0 -1/2 0"), 1, "not one or two parameters"),
    (lambda t: with_line(t, "wave", "1 0 -1/2 0 0"), 1, "independently"),
    (lambda t: with_members(t, members(t)[1][0], sealed(re.sub(
        "(?m)^wave: .*$", "wave: 1 0 -1/2 1.25 0.01", members(t)[1][2]))), 1, "must be wrong"),
    (lambda t: with_line(t, "wave", "1 0 0 0 1"), 1, "member 1: its maps are not of the family"),
    (lambda t: with_line(t, "wave", "1 0 -1/2 0 1 1"), 1, "not one or two parameters"),
    (lambda t: with_line(t, "parameter", "k 2 0"), 1, "range of the parameter is empty"),
    (lambda t: with_line(t, "parameter", "1k 0 2"), 1, "not NAME LOW HIGH"),
    (lambda t: with_line(t, "parameter", "k 0 2\nparameter: j 0 1"), 1, "not one or two"),
    (lambda t: with_line(t, "above", "x 1/2 0 1 0"), 1, "the header's above is not"),
    (lambda t: with_line(t, "above", "2.5 1/2 0 1 0.5"), 1, "the header's above is not"),
    (lambda t: with_line(t, "above", "0.15 1/2 0 1 0"), 1, "must be wrong"),
    (lambda t: with_members(re.sub("(?m)^above: .*\n", "", t)), 1, "claims no theorem"),
    (lambda t: with_members(t, members(t)[1][0][:-4]), 1, "the last member is not whole"),
    (lambda t: with_members(t, "junk\n" + members(t)[1][0]), 2, "member 1: "),
    (lambda t: with_members(t, members(t)[1][0].replace("tree:\n", "tree:\nP")), 1,
     "member 1: wrong checksum"),
    (lambda t: with_members(t, sealed(members(t)[1][0].replace("tree:\n", "tree:\nU"))), 1,
     "member 1: leaf 1 is undecided"),
    (lambda t: with_members(t, sealed(members(t)[1][0].replace("at once: no", "at once: yes"))), 5,
     "proof 1: that larger parameters"),
    (lambda t: with_members(t, sealed(re.sub("(?m)^v0: .*$", "v0: 0.5 0.1", members(t)[1][0]))), 1,
     "member 1: it is of a part of the torus only"),
    (lambda t: with_members(t, members(t)[1][1], sealed(re.sub(
        "(?m)^wave: .*\n", "wave: 1 0 -1/2 0.5 0.05\n", re.sub(
            "(?m)^v0: .*$", "v0: 1 1", members(t)[1][0])))), 5,
     "proof 2: proved leaf 1 of ")])
def test_wrong_diagrams(diagram, run, change, status, why):
    text = change(diagram)
    assert text != diagram
    found, out, err = run(text)
    assert (found, out) == (status, "") and why in err and err.count("\n") == 1, err


def test_a_torus_that_is_not_there(diagram, run):
    """A certificate with other amplitudes: NOT CONFIRMED, named by its place."""
    torus = members(diagram)[1][2]
    moved = sealed(re.sub("(?m)^wave: .*$", "wave: 1 0 -1/2 0.9 0.1", torus))
    status, out, err = run(with_members(diagram, moved))
    assert (status, out) == (5, "") and "not confirmed" in err


def test_a_torus_of_another_number_of_angles(diagram):
    """Where the other wave is nothing, the torus of the family is no circle."""
    family = FourierMap({((1, 0), "-1/2"): {"K": 1}, (0, 1): {"L": 1}}, K=(0, 1), L=(0, 1))
    with pytest.raises(check.Rejected, match="another number of angles"):
        family_of(family).member(members(diagram)[1][2].encode())


def test_ends_are_rounded_towards_the_weaker_claim(generator):
    for _ in range(200):
        low = F(generator.randrange(10 ** 9), generator.randrange(1, 10 ** 6))
        high = low + F(generator.randrange(0, 10 ** 6), 10 ** generator.randrange(1, 18))
        texts = check.inward(low, high)
        assert low <= F(texts[0]) <= F(texts[1]) <= high
    assert check.inward(F(1, 3), F(1, 3)) == ["1/3", "1/3"]
