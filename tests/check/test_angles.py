"""Proof files of three angles, whose trees are grown by the checker's own bound; and claims that
are examined in one angle."""

import dataclasses
import itertools
import math
import random
from fractions import Fraction

import numpy as np
import pytest

from checker import check
from trees import claim_of, found_tree, proof_file, ranged

UNITS = (1, 0, 0), (0, 1, 0), (0, 0, 1)
XSTAR = "0.575 0.575 0.575"
DIAGONAL = "1 1 0 1 -1 1 1 0 -1"         # its first column is (1, 1, 1)
PLACES = 10 ** 6


def line(eps):
    """The waves of the line of three angles."""
    a = Fraction("11.21436") * Fraction(eps)
    return [*["%d %d %d 0 %s" % (*k, check.decimal_text(a)) for k in UNITS],
            "1 1 1 0 " + check.decimal_text(2 * a)]


def file_of(tree, waves, ends, xstar=XSTAR, frame=DIAGONAL, **fields):
    """ends: (low, high) of each v."""
    return proof_file(tree, waves, **{"angles": 3, "frame": frame, "xstar": xstar, **{
        "v%d" % i: ranged(*pair) for i, pair in enumerate(ends)}, **fields})


def half(waves, frame=DIAGONAL, xstar=XSTAR):
    """The ends of a region that is enough by the reversal of time."""
    whole = [(Fraction(0), Fraction(2))] * 3
    claim = claim_of(file_of("P", waves, whole, xstar, frame))
    low, high = check.reversal_centre(claim)
    P = check.periods(claim.rows)
    return [(Fraction(math.floor(low * PLACES), PLACES),
             Fraction(math.ceil((high + P[0] / 2) * PLACES), PLACES)), *[
                 (Fraction(0), x) for x in P[1:]]]


@pytest.fixture(scope="module")
def proof():
    """The arguments of a file that proves the line of three angles at 0.018."""
    waves = line("0.018")
    ends = half(waves)
    return found_tree(claim_of(file_of("P", waves, ends)), 2000), waves, ends


# ---- three angles

def test_a_theorem_of_three_angles(proof, run):
    status, out, err = run(file_of(*proof))
    assert (status, err) == (0, "") and " in doubles " in out
    words = " ".join(out.split())
    for said in ("J' = J - grad V(y) of three angles y (modulo 2 pi)",
                 "J2' = J2 + 0.20185848 cos y2 + 0.40371696 cos(y0 + y1 + y2)",
                 "has no invariant Lagrangian graph (no invariant torus J = P + S'(y) over all "
                 "three angles, P constant, S periodic and C1)",
                 "y' = (v0 + v1, v0 - v1 + v2, v0 - v2)",
                 "0 <= v2 / pi <= 2; all others by reversal of time",
                 "x* : 0.575 0.575 0.575"):
        assert said in words, said
    assert 300 < proof[0].count("P") < 800 and "5" in proof[0]


def test_integers_say_the_same(proof):
    """Of some of the leaves; and no path excludes the whole region at once."""
    claim = claim_of(file_of(*proof))
    criterion, cells = check.Criterion(claim), [cell for _, cell in check.leaves(claim.tree)]
    for cell in random.Random(1).sample(cells, 12):
        assert criterion.excluded(cell)[0] is None
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(check, "MAX_PIECES", 2)
        assert criterion.excluded(check.ROOT)[0]


@pytest.mark.slow
def test_where_tori_are_seen_nothing_is_verified(proof, run, monkeypatch):
    """The line at 0.002, with the tree of 0.018; and three standard maps, each with circles."""
    monkeypatch.setattr(check, "MAX_PIECES", 16)
    tree = proof[0]
    weak = ["1 0 0 0 0.9", "0 1 0 0 0.95", "0 0 1 0 0.97"]
    for waves, xstar in ((line("0.002"), XSTAR), (weak, "0 1.5707963 0"),
                         (weak, "1.5707963 1.5707963 1.5707963")):
        status, out, err = run(file_of(tree, waves, half(waves, DIAGONAL, xstar), xstar))
        assert (status, out) == (5, "") and "not excluded" in err


@pytest.mark.parametrize("axis", (0, 1, 2))
def test_a_region_that_is_too_short_is_a_part(proof, run, axis):
    """By 10^-6 along one axis, or by the end that the centre of the reversal needs."""
    tree, waves, ends = proof
    for lower, upper in ((2, 0), (0, 2)):
        short = list(ends)
        short[axis] = (ends[axis][0] + Fraction(lower, PLACES), ends[axis][1] - Fraction(upper,
                                                                                         PLACES))
        status, out, _ = run(file_of(tree, waves, short))
        assert status == 3 and out.startswith("Verified, for a part of the torus only")
        assert "(no other y' was examined, and the region is not the full torus)" in out


@pytest.mark.parametrize("n", (2, 3))
def test_periods_against_points(n):
    """Boxes of the periods hold each point of the torus once, of frames of all sorts."""
    draw, tried = random.Random(3), 0
    shifts = 2 * np.array([*itertools.product(range(-9, 10), repeat=n)]).T
    while tried < 12:
        rows = [[draw.randint(-2, 2) for _ in range(n)] for _ in range(n)]
        F = np.array(rows, float)
        if not 0.5 < abs(np.linalg.det(F)) < 9:
            continue
        P = np.array([float(x) for x in check.periods(rows)])[:, None]
        assert math.isclose(np.prod(P), 2 ** n / abs(np.linalg.det(F)))
        lattice = np.linalg.solve(F, shifts)
        for _ in range(20):
            v = np.array([[draw.uniform(0, float(x))] for x in P[:, 0]]) + lattice
            assert (((v >= 0) & (v < P)).all(axis=0)).sum() == 1
        tried += 1


def test_wrong_files_of_three_angles(proof, run):
    tree, waves, ends = proof
    for more, why in (
            ({"angles": "4"}, "the header's angles is neither 3"),
            ({"angles": None}, "v2 without 'angles: 3'"), ({"v2": None}, "v2 without"),
            ({"alone": "0"}, "alone"), ({"frame": "1 0 0 1"}, "not nine integers"),
            ({"frame": "1 0 0 0 1 0 1 1 0"}, "determinant 0"), ({"xstar": "1 1"}, "three decimal"),
            ({"odd about": "0 0"}, "three decimal"), ({"cuts": "3"}, "the header's cuts"),
            ({"symmetric": 1, "proved": 0, "tree": "S"}, "not symmetric")):
        text = file_of(more.pop("tree", tree), waves, ends, **more)
        status, out, err = run(text)
        assert (status, out) == (1, "") and why in err and "Traceback" not in err, (why, err)
    for wave, why in (("1 0 0 0.2", "not K0 K1 K2 PHASE AMPLITUDE"),
                      ("0 0 0 0 1", "k that is zero"),
                      ("1 0 0.5 0 1", "no integer k")):
        status, out, err = run(file_of(tree, [wave], ends))
        assert (status, out) == (1, "") and why in err
    for name in ("y2", "J2"):           # which stand for something else in this theorem
        status, out, err = run(file_of(tree, ["1 1 1 0 1 0.1"], ends, parameter=name + " 0 1"))
        assert (status, out) == (1, "") and "is not a name of a parameter" in err


def test_a_cut_of_v2_in_a_file_of_two_angles(run):
    """It is named by its place."""
    text = file_of("5PP", ["1 0 0 0.99"], [(Fraction(0), Fraction(2))] * 2, "1 1", "1 0 0 1",
                   angles=None)
    status, out, err = run(text)
    assert (status, out) == (1, "")
    assert "cuts an angle or a parameter that there is not, at node 0" in err


@pytest.mark.slow
def test_parts_of_three_angles(run):
    """A leaf is linked to a part at the same x*, whose region has to hold it."""
    waves = line("0.018")               # of which B is known
    ends = half(waves)
    for short, status in ((None, 0), (0, 5), (1, 5), (2, 5)):
        wide = [ranged(low, high - Fraction(axis == short, PLACES))
                for axis, (low, high) in enumerate(ends)]
        found = run(file_of("a", waves, ends, parts=[(XSTAR, *wide, "P")]))
        assert found[0] == status, found
        assert "links between starting points" in found[1] or "may lead out" in found[2]


def test_the_bound_over_three_angles():
    """B of the line is at the sines' common least value; of standard maps that of the largest."""
    fixed = check.fixed_of(96)
    for waves, corner, B in ((UNITS + ((1, 1, 1),), (0.05, 0.06, 0.05, 0.1), None),
                             (UNITS, (0.3, -0.5, 0.2), 2.5), (UNITS, (0.3, 0.2, -0.5), 2.5)):
        known = [(k, 0) for k in waves]
        bound = check.torus_bound(fixed, known, [tuple(int(p * fixed.one) for p in corner)])
        grid = np.linspace(-math.pi, math.pi, 41)
        x = np.stack(np.meshgrid(grid, grid, grid)).reshape(3, -1)
        beta = 2 * np.eye(3) - sum(p * np.sin(k @ x)[:, None, None] * np.outer(k, k)
                                   for k, p in zip(map(np.array, waves), corner))
        most = np.linalg.eigvalsh(beta).max()
        assert most - 1e-12 < bound / fixed.one < most + 0.05
        assert B is None or abs(bound / fixed.one - B) < 1e-6


def test_the_bound_over_a_cell_of_three_angles():
    """It holds at each corner, and is near the truth there where the cell is small."""
    fixed, draw, nearest = check.fixed_of(96), random.Random(5), math.inf
    for _ in range(100):
        known = [([draw.randint(-1, 1) or 1 for _ in "012"], draw.uniform(-3, 3))
                 for _ in range(draw.randint(1, 3))]
        corner = [draw.uniform(-1, 1) for _ in known]
        y, w = [draw.uniform(-3, 3) for _ in "012"], draw.choice((0.01, 0.1))
        units = [(tuple(k), int(phase * fixed.one)) for k, phase in known]
        bound, _ = check.cell_bound(fixed, units, *[
            [int(x * fixed.one) for x in row] for row in (corner, y)], int(w * fixed.one))
        most = max([np.linalg.eigvalsh(2 * np.eye(3) - sum(
            [p * math.sin(np.dot(k, y + w * np.array(e)) + phase) * np.outer(k, k)
             for (k, phase), p in zip(known, corner)]))[-1]
            for e in itertools.product((-1, 1), repeat=3)])
        assert most - 1e-9 < bound / fixed.one
        nearest = min(nearest, bound / fixed.one - most)
    assert nearest < 1e-3


SORTED = "1 2 1 1 -1 1 1 -1 -2"
MOVING = ["1 0 0 0 0.2 0.1 0 0", "0 1 0 0 0.2 0 0.1 0", "0 0 1 0 0.2 0 0 0.1", "1 1 1 0 0.4 0 0 0"]


@pytest.mark.parametrize("waves, changes, enough", [
    (line("0.018"), {}, True), (MOVING, {}, True),      # the parameters are exchanged, too
    (line("0.018"), {1: (0, "0.6666666")}, False), (line("0.018"), {2: ("1e-9", "0.7")}, False),
    (line("0.018"), {2: ("-0.1", 1)}, True), (line("0.018"), {2: (-1, 0)}, False),
    (line("0.018"), {"xstar": "0.575 0.575 0.576"}, False),
    (line("0.018"), {"xstar": "0.5 0.575 0.575"}, False),
    (line("0.018"), {"frame": "1 2 1 1 -1 1 1 -1 -1"}, False),
    ([*line("0.018"), "1 1 0 0 0.1"], {}, False), ([*line("0.018"), "0 1 1 0 0.1"], {}, False),
    ([*line("0.018"), "1 -1 0 1/2 0.1", "0 1 -1 1/2 0.1"], {}, False),          # a chain
    ([*line("0.018"), "1 -1 0 1/2 0.1", "0 1 -1 1/2 0.1", "1 0 -1 1/2 0.1"], {}, True),
    ([*MOVING[:2], "0 0 1 0 0.2 0 0.1 0", MOVING[3]], {}, False)])
def test_sorted_angles_stand_for_the_torus(waves, changes, enough):
    xstar, frame = changes.get("xstar", XSTAR), changes.get("frame", SORTED)
    ends = [(Fraction(0), Fraction(2)), *[(Fraction(0), Fraction("0.6666666667"))] * 2]
    for i in {1, 2} & changes.keys():
        ends[i] = tuple(map(Fraction, changes[i]))
    found = check.symmetries_used(claim_of(file_of("P", waves, ends, xstar, frame)))
    assert found == (["exchange of the angles"] if enough else None)


# ---- matrices of one to three rows

@pytest.mark.parametrize("n", (1, 2, 3))
def test_matrices(n):
    """Cofactors, determinants, inverses and eigenvalues are those of numpy; `largest` is above."""
    draw = random.Random(n)
    for _ in range(400):
        d = [draw.randint(-9, 9) << 40 for _ in check.pairs_of(n)]
        rows = [list(map(int, row)) for row in check.full(d)]
        found, det = check.with_determinant(d)
        assert det == check.determinant(rows)
        for i, row in enumerate(check.full(found)):
            assert [check.dot(row, column) for column in rows] == [det * (i == j)
                                                                   for j in range(n)]
        values = np.linalg.eigvalsh(np.array(rows, float))
        size = abs(values).max() + 1
        assert values[-1] - 1e-9 * size <= check.largest(d) <= values[-1] + 0.1 * size
        assert values[-1] / 2 ** 40 - 1e-9 <= check.largest([x >> 40 for x in d])   # to a unit
        low = check.least([float(x) for x in d])
        assert abs(low - values[0]) < 0.1 * size
        if det:
            inverse = check.inverse_rows(rows)
            assert all(check.dot(row, column) == (i == j) for i, row in enumerate(inverse)
                       for j, column in enumerate(zip(*rows)))


@pytest.mark.parametrize("k", ((3,), (0, 2), (1, 1), (-1, 1), (1, 1, 1), (0, 3, -2), (1, 0, 100)))
def test_frames_of_errors(k):
    """R R' is a multiple of I, and R k all but a multiple of the first axis."""
    turn = check.turn_of([(k, 1)], len(k))
    for i, a in enumerate(turn.rows):
        assert [check.dot(a, b) for b in turn.rows] == [turn.length * (i == j)
                                                        for j in range(len(k))]
    size = math.sqrt(turn.length)
    if sum(map(bool, k)) > 1:
        assert abs(check.dot(turn.rows[0], k) / size - math.hypot(*k)) < 1e-5
        d = check.entries(k)
        found = [check.dot(row, d) / turn.length for row in turn.table]
        expected = [math.hypot(*k) ** 2] + [0] * (len(d) - 1)
        assert np.allclose(found, expected, atol=1e-3 * math.hypot(*k) ** 2)
    else:
        assert turn.table is None and turn.length == 1


# ---- claims in one angle

def test_a_claim_in_one_angle():
    """Waves that are multiples of a vector q are those of the angle q.x: B, l, orbits are."""
    draw = random.Random(5)
    for q in ((1, 0), (1, 1), (2, -3), (1, -1, 2)):
        n, size = len(q), sum(x * x for x in q)
        waves = tuple(check.Wave(tuple(m * x for x in q), Fraction(m, 7), Fraction(1, 5 * m * m),
                                 (Fraction(1, 50),)) for m in (1, -2))
        frame = {2: (2, 1, 1, 1), 3: (1, 1, 0, 0, 1, 1, 1, 0, 2)}[n]
        claim = check.Claim(waves, (Fraction(1, 3),) * n, (Fraction(1, 2),) * n, frame, None,
                            tuple(Fraction(i + 1, 9) for i in range(n)),
                            {"most_cuts": 3}, "no", "P", "")
        one = claim.reduced
        assert [wave.k for wave in one.waves] == [(1,), (-2,)] and len(one.xstar) == 1
        t = [Fraction(draw.randint(-9, 9), 9)]
        v = [draw.uniform(-1, 1) for _ in range(n)]
        before, x = [list(map(float, claim.xstar)), [math.pi * check.dot(row, v)
                                                      for row in claim.rows]]
        s0, s = float(one.xstar[0]), math.pi * check.dot(one.rows[0], v)
        for _ in range(5):
            force = [sum(float(wave.at(t)) * wave.k[i] * math.cos(
                check.dot(wave.k, x) + math.pi * wave.phase) for wave in waves) for i in range(n)]
            before, x = x, [2 * a - b + f for a, b, f in zip(x, before, force)]
            force = sum(float(wave.at(t)) * wave.k[0] * math.cos(
                wave.k[0] * s + math.pi * wave.phase) for wave in one.waves)
            s0, s = s, 2 * s - s0 + force
            assert abs(s - check.dot(q, x)) < 1e-9 * size
    other = dataclasses.replace(claim, waves=(*waves, check.Wave(
        (1, 0, 0), Fraction(0), Fraction(1), (Fraction(0),))))
    assert len(other.reduced.xstar) == 3 and other.reduced.waves == other.waves


@pytest.mark.slow
def test_a_map_along_a_diagonal(run):
    """V = 1.1 cos(y0 + y1)/2 is the standard map at 1.1 in the angle y0 + y1, and at 0.9 there are
    circles; x* is where the force is 0."""
    for k, good in (("1.1", True), ("0.9", False)):
        wave = "1 1 0.5 %s" % check.decimal_text(-Fraction(k) / 2)
        claim = claim_of(file_of("P", [wave], [(Fraction(0), Fraction(1)), (Fraction(0),
                         Fraction(2))], "3.141593 0", "1 1 1 -1", angles=None))
        assert len(claim.reduced.xstar) == 1
        criterion = check.Criterion(claim)
        if good:
            tree = found_tree(claim, 2000)
            ends = [(Fraction(0), Fraction(1)), (Fraction(0), Fraction(2))]
            status, out, _ = run(file_of(tree, [wave], ends, "3.141593 0", "1 1 1 -1", angles=None))
            assert status == 0 and criterion.axes == [0]
        else:
            with pytest.MonkeyPatch.context() as patch:
                patch.setattr(check, "MAX_PIECES", 16)
                assert criterion.excluded(check.ROOT)[0]


# ---- three angles that may be exchanged


def test_sorted_angles_are_enough(run):
    """By exchange and reversal a third of the region; none where V or x* tells the angles apart, or
    the region is short."""
    third = Fraction(666668, PLACES)
    waves = line("0.018")
    ends = [half(waves, SORTED)[0], (Fraction(0), third), (Fraction(0), third)]
    tree = found_tree(claim_of(file_of("P", waves, ends, frame=SORTED)), 2000)
    status, out, _ = run(file_of(tree, waves, ends, frame=SORTED))
    assert status == 0 and "by reversal of time and exchange of the angles" in out
    uneven = [waves[0], waves[1], "0 0 1 0 0.2018", waves[3]]
    for axis, change in ((1, (0, -2)), (2, (0, -2)), (1, (1, 0)), (2, (1, 0))):
        short = list(ends)
        short[axis] = tuple(x + Fraction(y, PLACES) for x, y in zip(ends[axis], change))
        assert check.symmetries_used(claim_of(file_of("P", waves, short, frame=SORTED))) is None
    for more in ({"waves": uneven}, {"xstar": "0.575 0.575 0.576"}, {"xstar": "0.574 0.575 0.575"},
                 {"frame": DIAGONAL}):
        known = {"waves": waves, "frame": SORTED, **more}
        wide = [(ends[0][0] - 1, ends[0][1] + 1), *ends[1:]]
        assert check.symmetries_used(claim_of(file_of("P", ends=wide, **known))) is None
        assert (check.symmetries_used(claim_of(file_of("P", waves, wide, frame=SORTED)))
                == ["exchange of the angles"])


def test_each_point_has_an_image_that_is_sorted():
    """By shifts of the sum 0 and permutations each point comes to where v1 and v2 are in [0, 2/3],
    with the same v0."""
    draw, F = np.random.default_rng(1), np.array([[1, 2, 1], [1, -1, 1], [1, -1, -2]])
    shifts = [2 * np.array(m) for m in itertools.product(range(-4, 5), repeat=3) if not sum(m)]
    for x in draw.uniform(-2, 2, (60, 3)):
        images = np.array([list(image) for m in shifts for image in itertools.permutations(x + m)])
        v = np.linalg.solve(F, images.T)
        assert np.allclose(v[0], x.sum() / 3)
        assert ((v[1:] >= -1e-12) & (v[1:] <= 2 / 3 + 1e-12)).all(axis=0).any()
