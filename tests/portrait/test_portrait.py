"""Portraits of phase space: what is proved, what is never excluded, and files that are refused."""

import math
import re
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from files import sealed

from converse import ConverseError, MuldoonMap, StandardMap, SymplecticMap, check, tori
from converse.check.portrait import check_places, patch_of_strip, read_region, share
from converse.model.problem import Problem
from converse.prover import tree
from converse.prover.portrait import Portrait, portray, pruned

from truth import TORTURE

GOLDEN = "t^2+t-1: "
# Twenty rotation numbers, all of the field of the golden mean: (a + b t)/(c + d t).
ROTATIONS = ["(%s)/(%s)" % pair for pair in [
    ("t", "1"), ("1-t", "1"), ("1", "3+t"), ("2+t", "5+2t"), ("1+t", "4+3t"), ("1", "4+t"),
    ("3+t", "7+2t"), ("1", "2+3t"), ("3+2t", "7+5t"), ("1+t", "3+4t"), ("2+t", "9+4t"),
    ("1", "5+t"), ("1", "6+t"), ("4+t", "9+2t"), ("3+t", "8+3t"), ("3+2t", "8+5t"),
    ("2+t", "7+3t"), ("1", "7+t"), ("5+t", "11+2t"), ("5+3t", "12+7t")]]
EPSILON = 1e-9                          # of points of tori and ends of prisms, as doubles


def standard(k, width=None):
    return Problem(SymplecticMap([(1, 0)], [k], [] if width is None else [[width]]))


@pytest.fixture(scope="module")
def strips(tmp_path_factory):
    """A portrait of k = 0.9 in 60 strips, and its file."""
    path = tmp_path_factory.mktemp("portrait") / "strips.portrait"
    return portray(standard("0.9"), path=path, columns=60, depth=10), path


def prisms_of(region):
    """The proved prisms of a region: rows of the ends of t2, and of v and its half-width at t2 = 0,
    in units of pi, in doubles."""
    rows, (low, high) = [], region.problem.v0
    for kind, (index, cuts) in tree.cells(region.text):
        if kind == "P":
            u, t = ((2 * index[axis] + 1) / 2 ** cuts[axis] - 1 for axis in (0, 3))
            rows.append((t - 0.5 ** cuts[3], t + 0.5 ** cuts[3],
                         float(low + (high - low) * Fraction(1 + u) / 2),
                         float(high - low) / 2 / 2 ** cuts[0]))
    return np.array(rows).reshape(-1, 4)


def excluded_points(portrait, torus):
    """Points of a circle, of its image by the reversal of time, and of their mirror images about
    pi/2, that lie in proved prisms; and how many points were looked at."""
    theta = np.linspace(0, 2 * math.pi, 20 * len(portrait.stars), endpoint=False)[:, None] + 0.01
    y = torus.x(theta)[:, 0]
    following = torus.J(theta + 2 * math.pi * torus.rotation.floats[0])[:, 0]
    back = -torus.J(theta)[:, 0]
    x = np.concatenate([y, y, math.pi - y, math.pi - y])
    w = np.concatenate([following, back, -following, -back])
    wrong, seen = [], 0
    for star, regions in portrait.found.items():
        s = (x - float(star) + math.pi) % (2 * math.pi) - math.pi
        here = abs(s) <= float(portrait.strip)
        seen += here.sum()
        for region in regions:
            low, high, v, half = prisms_of(region)[:, :, None].transpose(1, 0, 2)
            t = np.sin(s[here]) / float(portrait.strip)
            shift = float(region.problem.shifts[1][0]) if region.problem.shifts else 0.0
            off = v + shift * t - (w[here] + float(star)) / math.pi
            off -= 2 * np.round(off / 2)
            inside = (low - EPSILON <= t) & (t <= high + EPSILON) & (abs(off) < half - EPSILON)
            wrong += [(star, *point) for point in zip(s[here][inside.any(axis=0)],
                                                      w[here][inside.any(axis=0)])]
    return wrong, seen


def test_patch_of_a_strip_holds_all_of_the_strip():
    """V(y + s), for s and parameters at random and at the ends, in the prover and the checker."""
    draw = np.random.default_rng(1)
    for k, phase, p, g in ((1, "0", "0.9", None), (-3, "1/3", "-0.7", "0.05"),
                           (2, "1/2", "0.01", "0.2")):
        problem = Problem(SymplecticMap([(k, 0, Fraction(phase))], [p], [] if g is None else [[g]]))
        portrait = Portrait.new(problem, columns=40)
        patch, wave = portrait.patch, portrait.problem
        theirs = patch_of_strip(check.claim.Wave((k, 0), wave.waves[0][2], wave.amplitude[0],
                                                 tuple(part[0] for part in wave.parts)),
                                portrait.strip)
        assert [(each.k, each.phase % 2, each.middle, each.parts) for each in theirs] == [
            ((k, 0), phi % 2, a, parts) for (_, _, phi), a, parts in
            zip(patch.waves, patch.amplitude, zip(*patch.parts))]
        h = float(portrait.strip)
        for s, tau in [(h, 1), (-h, -1), (h, -1), (0, 1), *draw.uniform(-1, 1, (50, 2)) * (h, 1)]:
            q = float(Fraction(p)) + tau * float(Fraction(g or 0))
            cosine, sine = q * math.cos(k * s), q * math.sin(k * s)
            t2 = math.sin(k * s) / (k * h)
            rest = abs(cosine - float(patch.amplitude[0]))
            assert rest <= float(patch.parts[0][0]) + 1e-15
            along = [float(part[1]) for part in patch.parts]
            assert abs(sine - along[1] * t2) <= sum(map(abs, along[2:])) + 1e-15
            assert abs(t2) <= 1


@pytest.mark.slow
def test_portrait_is_verified_whole(strips):
    portrait, path = strips
    result = check.verify(path)
    assert result and result.verdict == "verified"
    assert "Undecided : at most 0.%06d of phase" % (portrait.undecided * 10 ** 6) in result.text
    assert 0.2 < portrait.undecided < 0.45
    assert "Area without circles : at least %.3f" % (
        (1 - portrait.undecided) * 4 * math.pi ** 2 - 0.0005) in result.text
    assert Portrait.load(path).found == portrait.found


def test_no_point_of_a_proved_circle_is_excluded(strips):
    """The negative control, with one of the twenty circles; the slow one has all."""
    portrait, _ = strips
    torus = tori.prove(standard("0.9"), tori.read_rotation("golden")).torus
    wrong, seen = excluded_points(portrait, torus)
    assert seen > 700 and not wrong
    moved = replace(torus, numbers=-torus.numbers)  # not a circle of the map: it is told apart
    assert len(excluded_points(portrait, moved)[0]) > 20


@pytest.mark.slow
@pytest.mark.skipif(TORTURE <= 1, reason="minutes; make torture has it")
@pytest.mark.parametrize("k, least", [("0.5", 20), ("0.9", 12), ("0.97", 3)])
def test_no_point_of_twenty_circles_is_excluded(k, least):
    """Of those of the rotation numbers that can be proved; at k = 0.97 few circles are left.  By
    the portrait of one k and of a range."""
    portraits = [portray(standard(k), columns=200, depth=13),
                 portray(standard(k, "0.0001"), columns=200, depth=12)]
    proved = 0
    for name in ROTATIONS:
        try:
            torus = tori.prove(standard(k), tori.read_rotation(GOLDEN + name)).torus
        except (tori.NotFound, tori.NotProved):
            continue
        proved += 1
        for portrait in portraits:
            wrong, seen = excluded_points(portrait, torus)
            assert seen > 3000 and not wrong, name
    assert proved >= least


@pytest.mark.parametrize("old, new, why", [
    ("undecided: 0.", "undecided: 0.0", "undecided is 0.0"),
    ("strip: 0.05", "strip: 0.06", "overlap"),
    ("even about: 1/2", "even about: 0", "not even about"),
    ("even about: 1/2", "even about: no", "undecided is"),
    ("wave: 1 0 0 0.9", "wave: 1 0 0 0.8", "does not hold enough"),
    ("wave: 1 0 0 0.9", "wave: 1 1 0 0.9", "not those of a map of one angle"),
    ("xstar: 1.6", "xstar: 9.6", "not in their order"),
    ("xstar: 1.6", "xstar: 1.59", "lies outside"),
    ("parts:\n", "parts:\nP\n", "not followed by a part"),
    ("P\nchecksum", "?\nchecksum", "not a node"),
    ("U\n", "P\n", "undecided is"),
    ("P\n", "\n", "incomplete"), ("P\n", "1PP\n", "cuts an angle"),
    ("v1: 1 1", "v1: 1 1\r", "not two"), ("v1: 1 1", "v1: 1\x0b1", "not two"),
    ("v1: 1 1 0 0\n", "v1: 1 1 0 0\x85", "each on its line"),
    ("columns: 60", "colours: 60", "unknown meaning"),
    ("depth: 10\n", "", "lacks depth"),
])
def test_altered_portraits_are_rejected(strips, tmp_path, old, new, why):
    """With a checksum that is made anew; without, any change is told."""
    path, text = tmp_path / "altered", strips[1].read_text()
    assert old in text
    text = new.join(text.rsplit(old, 1) if old.startswith(("U", "P")) else text.split(old, 1))
    path.write_bytes(text.encode())
    with pytest.raises(check.Rejected, match="wrong checksum"):
        check.verify(path)
    path.write_bytes(sealed(text).encode())
    with pytest.raises(check.Rejected, match=why):
        check.verify(path)


def region_of(waves, strip, nodes):
    """The part of a file over this tree, of half a turn of successors."""
    over = check.claim.Claim(waves, *[(Fraction(1),) * 2] * 2, (1, 0, 0, 1), None, None, {}, "no",
                             "", "")
    text = "1\nxstar: 1 0\nv0: 0.5 0.5\nv1: 1 1\ntree:\n" + nodes
    return read_region("1", text, over, strip)


@pytest.mark.parametrize("tree, strip, lost", [
    ("0UP", 0, "1/2"), ("2UP", 0, "1"), ("2U0UP", 0, "3/2"), ("3UP", "0.01", "1/2"),
    ("30UPP", "0.01", "1/4"), ("2UP", "0.01", "1"), ("4UP", "0.01", "1")])
def test_cuts_of_parameters_do_not_lessen_what_is_undecided(tree, strip, lost):
    """But for that of t2, along which the strip is cut."""
    wave = check.claim.Wave((1, 0), Fraction(0), Fraction(1), (Fraction(1, 10),))
    patch = patch_of_strip(wave, Fraction(strip)) if strip else (wave,)
    assert region_of(patch, Fraction(strip), tree).counts["lost"] == Fraction(lost)


@pytest.mark.parametrize("axis", "1345")
def test_cuts_of_what_a_portrait_does_not_have_are_rejected(axis):
    wave = check.claim.Wave((1, 0), Fraction(0), Fraction(1), (Fraction(1, 10),))
    with pytest.raises(check.Rejected, match="part 1: the tree cuts an angle or a parameter that"):
        region_of((wave,), Fraction(0), axis + "UP")


def test_the_share_of_a_slice_of_t2_is_that_of_the_points_of_the_strip():
    """s = arcsin(angle t2)/k: the outermost slices of t2 hold more of s than of t2."""
    wave = check.claim.Wave((1, 0), Fraction(0), Fraction(1), ())
    strip = Fraction(1, 2)
    claim = region_of(patch_of_strip(wave, strip), strip, "3P3P3P3PU")
    true = math.asin(0.5) - math.asin(0.5 * 7 / 8)          # over the strip's width, 1
    assert true <= share([claim], strip) < 1.2 * true


def test_strips_lie_in_one_turn(strips):
    portrait = check.content(strips[1].read_bytes())
    first = portrait.claims[0]
    for further in 6.1, 6.3:
        last = replace(first, xstar=(first.xstar[0] + Fraction(further), 0))
        longer = replace(portrait, even=None, claims=(*portrait.claims, last))
        if further < 2 * math.pi:
            check_places(longer)
        else:
            with pytest.raises(check.Rejected, match="outside of the turn"):
                check_places(longer)


@pytest.mark.slow
def test_leaf_that_is_not_proved_is_not_confirmed(strips, tmp_path, monkeypatch):
    """Each U of a column made a P, and the share what it then would be: the leaves are looked at,
    and through one of them a circle passes."""
    portrait, path = strips
    x = portrait.stars[0]
    forged = Portrait.load(path)
    forged.found[x] = tuple(replace(region, text=region.text.replace("U", "P"))
                            for region in portrait.found[x])
    forged.save(tmp_path / "forged")
    for module in check.criterion, check.lockstep:
        monkeypatch.setattr(module, "MAX_PIECES", 16)       # of a leaf: not to search for long
    with pytest.raises(check.NotConfirmed, match="part .*: proved leaf .* is not excluded"):
        check.verify(tmp_path / "forged")


def test_portrait_is_not_verified_if_no_leaf_is_looked_at(strips, monkeypatch):
    monkeypatch.setattr(check.run, "check_leaves", lambda *_: (0, 0, 0))
    with pytest.raises(RuntimeError, match="0 of [0-9]+ parts of the proof"):
        check.verify(strips[1])


def test_regions_must_hold_the_successors_for_all_of_the_strip(strips):
    """Each end of each region counts: one that is shorter by a little is refused."""
    portrait, path = strips
    lines = path.read_text().splitlines(keepends=True)
    before = 0
    for x in portrait.stars:
        count = len(portrait.found[x])
        if count > 2:
            break
        before += count
    refusal = "part %d: .*not hold" % (1 + before)
    for n in range(1 + before, 1 + before + count):
        at = lines.index("part: %d\n" % n) + 2
        _, centre, half, zero, shift, *rest = lines[at].split()
        centre, half, shift = map(Fraction, (centre, half, shift))
        for end in 1, -1:
            off = Fraction("1e-8")
            for numbers in (centre + end * off, half - off, shift), (
                    centre, half, shift + end * Fraction("0.01")):
                c, h, s = map(check.decimal_text, numbers)
                line = " ".join(["v0:", c, h, zero, s, *rest]) + "\n"
                text = "".join([*lines[:at], line, *lines[at + 1:]])
                with pytest.raises(check.Rejected, match=refusal):
                    check.content(sealed(text).encode())


@pytest.mark.parametrize("old, new", [
    (r"xstar: (\S+) 0", r"xstar: \1 1e-9"), ("v1: 1 1", "v1: 1 0.999"), ("v1: 1 1", "v1: 1.1 1"),
    (r"v0: (\S+) (\S+) 0 ", r"v0: \1 \2 1e-9 "), ("v1: 1 1", "v1: 1 1 0 1e-9"),
    ("part: 2", "part: 3"), ("part: 1\n", "part: 1\nwave: 1 0 0 1\n"),
    (r"v0: (\S+) \S+", r"v0: \1 -1")])
def test_a_part_that_is_no_region_of_a_column_is_refused(strips, old, new):
    """Another angle, a region that moves with another parameter than that of strips, or in v1."""
    text = strips[1].read_text()
    changed = re.sub(old, new, text, count=1)
    assert changed != text
    with pytest.raises(check.Rejected):
        check.content(sealed(changed).encode())


def test_lines_do_not_move(tmp_path):
    path = tmp_path / "lines"
    portray(standard("0.9", "0.01"), path=path, columns=8, depth=6, strips=False)
    whole = path.read_text()
    for shift in "0", "1e-9":
        text = sealed(re.sub(r"v0: (\S+) (\S+)", r"v0: \1 \2 " + shift, whole, count=1))
        if shift == "0":
            check.content(text.encode())
        else:
            with pytest.raises(check.Rejected, match="part 1 .* moves"):
                check.content(text.encode())


def test_a_portrait_that_has_nothing_yet_is_continued(tmp_path):
    path = tmp_path / "portrait"
    assert not portray(standard("0.9"), path=path, columns=20, depth=6, time_limit=0).found
    with pytest.raises(check.Rejected, match="claims no theorem"):
        check.verify(path)
    assert portray(path=path, resume=True).complete


@pytest.mark.slow
def test_portrait_is_continued(strips, tmp_path):
    """A file without some columns: the others are kept as they are."""
    portrait, path = strips
    part = Portrait.load(path)
    kept = part.stars[::3]
    part.found = {x: part.found[x] for x in kept}
    part.save(tmp_path / "part")
    assert check.verify(tmp_path / "part").verdict == "verified"
    more = portray(path=tmp_path / "part", resume=True)
    assert more.found == portrait.found and more.complete
    with pytest.raises(TypeError, match="or the file of a portrait"):
        portray(standard("0.9"), path=path, columns=60, depth=9, resume=True)


def test_lines_of_two_harmonics(tmp_path):
    """Lines are for any potential of one angle, and for a range of parameters."""
    problem = Problem(SymplecticMap([(1, 0, "-1/2"), (2, 0, "-1/2")], ["0.5", "0.1"],
                                    [["0.001", 0]]))
    path = tmp_path / "lines"
    portrait = portray(problem, path=path, columns=12, depth=8, strips=False)
    assert portrait.undecided < 1 and check.verify(path)
    with pytest.raises(ValueError, match="ask for lines"):
        portray(problem, columns=12)


@pytest.mark.parametrize("change, why", [
    ({"columns": 0}, "columns must be a whole number from 1"),
    ({"columns": 4}, "give at least 8"),
    ({"depth": 0}, "depth must be a whole number from 1"),
])
def test_bad_numbers(change, why):
    with pytest.raises(ValueError, match=why):
        portray(standard("0.9"), **change)


def test_bad_maps():
    with pytest.raises(ValueError, match="one angle"):
        portray(Problem(MuldoonMap("0.3", "0.3", "0.6")))
    with pytest.raises(ValueError, match="is zero"):
        portray(StandardMap(0))


def test_depth_that_proves_nothing_is_told(tmp_path):
    portrait = portray(standard("0.3"), path=tmp_path / "flat", columns=20, depth=1)
    assert portrait.undecided == 1 and "\nTo try : a depth above" in portrait.report()
    assert portrait.report().startswith("UNDECIDED: nothing is proved.\n  The map  ")
    assert "THEOREM" not in portrait.report() and "circle through" not in portrait.report()
    with pytest.raises(check.Rejected, match="claims no theorem"):
        check.verify(tmp_path / "flat")


def test_pruned():
    assert pruned("0P01UUU") == "0PU" and pruned("00UUU") == "U" and pruned("0PU") == "0PU"


def test_no_words_say_less_undecided_than_there_is(strips, monkeypatch):
    """0.096029 is not "at most 9.6%": in the line of a notebook, and above the figure."""
    from converse.draw.portrait_figure import title

    monkeypatch.setattr(Portrait, "undecided", Fraction("0.096029"))
    assert "30 of 30 columns, at most 9.61% undecided" in repr(strips[0])
    assert "undecided: 9.61%" in title(strips[0])


def test_what_was_only_read_is_told_in_the_headline(strips, tmp_path):
    """And a portrait of another release is neither continued nor relabelled."""
    found, path = strips
    assert found.report(path).startswith("THEOREM, for the proved prisms\n")
    again = Portrait.load(path)
    assert again.report(path).startswith(
        "THEOREM, for the proved prisms, of which 30 columns were read from a file that is "
        "believed\n")
    text = path.read_text().replace("program: converse ", "program: converse 4.", 1)
    other = tmp_path / "other.portrait"
    other.write_text(sealed(text))
    assert Portrait.load(other)._text() == other.read_text()
    assert portray(path=other, resume=True).complete            # only described
    again.found.pop(min(again.found))
    again.version = "4.0"
    again.save(other)
    with pytest.raises(ConverseError, match="is of converse 4.0; continue it with that release"):
        portray(path=other, resume=True)


def test_the_figure_has_the_coordinates_of_the_portraits_of_orbits(strips):
    """(y, J): the golden circle and its image pass where something is undecided, not so the
    points of the island about (pi/2, 0), nor the golden circle drawn at y' - y."""
    from converse.draw.portrait_figure import ROWS, TURN, circle, force, shares

    image, left = shares(strips[0])
    torus = tori.find(strips[0].problem, "golden")

    def undecided(y, J):
        """The most that is undecided within a hundredth of a turn above and below."""
        at = np.floor((np.asarray(y) - left) % TURN / TURN * image.shape[1]).astype(int)
        rows = np.floor(np.asarray(J) % TURN / TURN * ROWS).astype(int)
        return np.max([image[(rows + move) % ROWS, at] for move in range(-7, 8)], axis=0)

    y, J = circle(torus)
    assert (undecided(y, J) > 0).all()
    assert (undecided(y, J - force(strips[0].problem, y)) == 0).any()
    assert (undecided([math.pi / 2, math.pi / 2 - 0.3, math.pi / 2], [0, 0, 0.4]) == 0).all()


def test_lines_are_drawn_as_lines(strips):
    from matplotlib.figure import Figure

    lines = replace(strips[0], strip=Fraction(0))
    for portrait, most in ((lines, 0.12), (strips[0], 1)):
        axes = portrait.plot(Figure().subplots())
        alpha = axes.images[0].get_array()[..., 3]
        assert most / 9 < (alpha > 0).mean() < most
