"""Proof files with frames of any determinant, regions that hold enough of the torus by reversal and
exchange, and parts that leaves are linked to.  What is right is confirmed, and what is wrong in any
one place is not, by both paths of the checker."""

import contextlib
import itertools
import math
import random
import re
from fractions import Fraction

import numpy as np
import pytest
from files import sealed
from files import with_line as with_text

from converse import Problem, prove
from converse.check import verify
from converse.model.map import SymplecticMap

from checker import check
from trees import claim_of, decimal, found_tree, halves, proof_file, ranged

SYMMETRIC = ["1 0 0 0.2242872", "0 1 0 0.2242872", "1 1 0 0.4485744"]       # epsilon = 0.02
XSTAR, OTHER = "0.858 0.858", "0.875 0.875"
ASIDE = "0.875 0.8751"                  # where no part stands for its mirror image
DIAGONALS = "1 1 1 -1"
HALF = "0.5362 0.2502", "0.5 0.5"       # of the torus by reversal and exchange: c0 = 0.28612..


def file_of(tree, v0=HALF[0], v1=HALF[1], waves=SYMMETRIC, frame=DIAGONALS, xstar=XSTAR, parts=(),
            **fields):
    """A proof file; parts are (xstar, v0, v1, tree)."""
    return proof_file(tree, waves, parts, frame=frame, xstar=xstar, v0=v0, v1=v1, **fields)


def found(v0=HALF[0], v1=HALF[1], **more):
    """A tree that proves this."""
    return found_tree(claim_of(file_of("P", v0, v1, **more)), 5000)


def region_of(claim, cell, moved, margin):
    """v0 and v1 of what a cell is moved to, and this margin about it."""
    ranges = []
    for i, k, c, h, (low, high) in zip(*cell, claim.centre, claim.half, moved):
        low, high = c - h + 2 * h * i / (1 << k) + low, c - h + 2 * h * (i + 1) / (1 << k) + high
        unit = 10 ** 40
        middle = Fraction(round((low + high) / 2 * unit), unit)
        half = Fraction(math.ceil((max(high - middle, middle - low) + margin) * unit), unit)
        ranges.append("%s %s" % (check.decimal_text(middle), check.decimal_text(half)))
    return ranges


def linked(tree, others=(OTHER,), margin=Fraction(1, 1000), **more):
    """The arguments of a file whose deepest leaf is linked to a part with another x*, the deepest
    leaf of which is linked to the next."""
    trees, places, regions = [tree], [more.get("xstar", XSTAR), *others], [
        (more.pop("v0", HALF[0]), more.pop("v1", HALF[1]))]
    for letter, here, there in zip(check.LETTERS, places, others):
        tree, region = trees[-1], regions[-1]
        claim = claim_of(file_of("P", *region, **{**more, "xstar": here}))
        at, cell = max(((at, cell) for at, cell in check.leaves(tree)),
                       key=lambda leaf: sum(leaf[1][1]))
        trees[-1] = tree[:at] + letter + tree[at + 1:]
        moved = check.displacement(check.Criterion(claim), cell, claim.xstar,
                                   tuple(map(Fraction, there.split())))
        regions.append(region_of(claim, cell, moved, margin))
        trees.append(found(*regions[-1], **{**more, "xstar": there}))
    return {"tree": trees[0], "v0": regions[0][0], "v1": regions[0][1], **more,
            "parts": [(x, *region, tree) for x, region, tree in
                      zip(others, regions[1:], trees[1:])]}


@pytest.fixture(scope="module")
def tree():
    """Of half the torus by reversal and exchange."""
    return found()


@pytest.fixture(scope="module")
def one_link(tree):
    return linked(tree)


@pytest.fixture(scope="module")
def two_links(tree):
    return linked(tree, (OTHER, "0.85 0.87"))


@pytest.fixture
def run(run, monkeypatch):
    """As run, with fewer pieces; the exact path has the same status."""
    for name, value in (("LINE_SECONDS", 1e9), ("MAX_PIECES", 64), ("MAX_SITES", 150)):
        monkeypatch.setattr(check, name, value)

    def both(text):
        status, out, err = run(text)
        assert run(text, "--exact")[0] == status
        assert bool(out) == (status in (0, 3)) != bool(err)
        return status, out, err
    return both


# ---- regions that hold enough

def test_half_of_the_torus_is_enough(tree, run):
    """By reversal and exchange; and the whole by neither."""
    status, out, _ = run(file_of(tree))
    assert status == 0 and out.startswith("Verified :") and "region" not in out
    assert "; all others by reversal of time and exchange of the angles\n" in out
    whole = found("1 0.5", "1 1")
    status, out, _ = run(file_of(whole, "1 0.5", "1 1"))
    assert status == 0 and "all others" not in out and len(whole) > 3 * len(tree)


@pytest.mark.parametrize("waves, xstar, told", [
    (SYMMETRIC, None, "reversal of time and exchange of the angles"),
    (["1 0 0 0.4", "0 1 0 0.1", "2 1 0 0.25"], None, "reversal of time"),
    (SYMMETRIC, ("0.86", "0.85"), "reversal of time")])
def test_what_the_program_writes(run, tmp_path, waves, xstar, told):
    """Its choice of frame and region holds enough, by the symmetries that there are."""
    words = [wave.split() for wave in waves]
    problem = Problem(SymplecticMap([(int(k), int(l)) for k, l, *_ in words],
                                    [p for *_, p in words]))
    path = tmp_path / "written"
    prove(problem, method="loewner", xstar=xstar).save(path)
    status, out, _ = run(path.read_bytes())
    assert status == 0 and "; all others by %s\n" % told in out
    assert out.startswith("Verified :") and "converse proof 6\n" in path.read_text()


def c0_of(text):
    return [float(x) for x in check.reversal_centre(claim_of(text))]


def test_the_centre_of_the_reversal():
    """It is what doubles say, for all parameters; and its ends are taken."""
    generator = random.Random(4)
    for _ in range(60):
        parts, waves = generator.randint(0, 3), []
        for _ in range(generator.randint(1, 4)):
            k = generator.choice(((1, 0), (0, 1), (1, 1), (2, -1), (0, 3)))
            numbers = [round(generator.uniform(-1, 1), 3) for _ in range(2 + parts)]
            waves.append((k, numbers))
        frame = generator.choice(((1, 0, 0, 1), (1, 1, 1, -1), (2, -1, 1, 2), (0, 1, 1, 0),
                                  (-3, 1, 0, 2)))
        x = [round(generator.uniform(-4, 4), 3) for _ in "01"]
        text = file_of("P", waves=[" ".join(map(str, (*k, *numbers))) for k, numbers in waves],
                       frame=" ".join(map(str, frame)), xstar="%s %s" % tuple(x))
        ends = []
        for t in itertools.product((-1, 1), repeat=parts):
            c = np.array(x, float)
            for k, (phase, p, *more) in waves:
                p += sum(a * b for a, b in zip(more, t))
                c += np.array(k) * p / 2 * math.cos(np.dot(k, x) + math.pi * phase)
            ends.append(np.linalg.solve(np.reshape(frame, (2, 2)), c)[0] / math.pi)
        low, high = c0_of(text)
        assert abs(low - min(ends)) < 1e-12 and abs(high - max(ends)) < 1e-12 and low <= high


def test_the_centre_of_the_reversal_with_few_bits(monkeypatch):
    """With 8 bits the cosines are off by units of 1/256, and the bounds still hold the centre."""
    monkeypatch.setattr(check, "CENTRE_BITS", 8)
    draw = random.Random(8)
    for _ in range(200):
        phase, x, y = (round(draw.uniform(-2, 2), 3) for _ in range(3))
        p = round(draw.uniform(1, 4), 3)
        low, high = c0_of(file_of("P", waves=["1 0 %s %s" % (phase, p)], frame="1 0 0 1",
                                  xstar="%s %s" % (x, y)))
        assert low <= (x + p / 2 * math.cos(x + math.pi * phase)) / math.pi <= high


MOVING = ["1 0 0 0.225 0.001", "0 1 0 0.225 0.001", "1 1 0 0.45 0.002"]
APART = ["1 0 0 0.225 0.001 0", "0 1 0 0.225 0 0.001", "1 1 0 0.45 0 0"]


@pytest.mark.parametrize("waves", [SYMMETRIC, MOVING, APART])
def test_how_much_of_v0_is_enough(waves):
    """[c0, c0 + 1/2] for all parameters, and 1e-12 less at either end is not; or any length 1."""
    low, high = [Fraction(x).limit_denominator(10 ** 16) for x in c0_of(file_of("P", waves=waves))]
    low = Fraction(math.floor(low * 10 ** 14), 10 ** 14)
    high = Fraction(math.ceil(high * 10 ** 14), 10 ** 14) + Fraction(1, 2)
    step = Fraction(1, 10 ** 12)
    for ends, enough in (((low, high), True), ((low - 1, high), True), ((low + step, high), False),
                         ((low, high - step), False), ((low - 1, high - 1), False),
                         ((low + 1, high + 1), False), ((0, 1), True), ((-7, -6), True),
                         ((5, Fraction(6) - step), False)):
        claim = claim_of(file_of("P", ranged(*ends), waves=waves))
        assert (check.symmetries_used(claim) is not None) == enough


@pytest.mark.parametrize("frame, xstar, v1, waves, enough", [
    (DIAGONALS, XSTAR, (0, 1), SYMMETRIC, True), (DIAGONALS, XSTAR, (0, 1), APART, True),
    (DIAGONALS, XSTAR, (-1, 1), SYMMETRIC, True), (DIAGONALS, XSTAR, (3, 5), SYMMETRIC, True),
    (DIAGONALS, "0.858 0.8580", (-3, 1), SYMMETRIC, True),
    (DIAGONALS, XSTAR, (-1, 0), SYMMETRIC, False), (DIAGONALS, XSTAR, (1, 2), SYMMETRIC, False),
    (DIAGONALS, XSTAR, (0, "0.999999999999"), SYMMETRIC, False),
    (DIAGONALS, XSTAR, ("1e-20", 1), SYMMETRIC, False),
    (DIAGONALS, "0.858 0.85800000000000000001", (0, 1), SYMMETRIC, False),
    (DIAGONALS, "0.858 -0.858", (0, 1), SYMMETRIC, False),
    (DIAGONALS, XSTAR, (0, 1), ["1 0 0 0.2", "0 1 0 0.2000000000000001", "1 1 0 0.4"], False),
    (DIAGONALS, XSTAR, (0, 1), ["1 0 0.1 0.2", "0 1 0 0.2", "1 1 0 0.4"], False),
    (DIAGONALS, XSTAR, (0, 1), ["1 0 0 0.2 0.01 0", "0 1 0 0.2 0 0.011", "1 1 0 0.4 0 0"], False),
    (DIAGONALS, XSTAR, (0, 1), ["2 -1 0 0.2", "1 -2 1 0.2"], True),
    (DIAGONALS, XSTAR, (0, 1), ["2 -1 0 0.2", "1 -2 0 0.2"], False),
    ("1 1 -1 1", XSTAR, (0, 1), SYMMETRIC, False), ("1 -1 1 1", XSTAR, (0, 1), SYMMETRIC, False),
    ("1 0 0 1", XSTAR, (0, 1), SYMMETRIC, False), ("-1 -1 -1 1", XSTAR, (0, 1), SYMMETRIC, False),
    ("2 0 0 2", XSTAR, (0, 1), SYMMETRIC, True), ("1 4 0 -2", XSTAR, (0, 1), SYMMETRIC, True),
    ("1 4 0 -2", XSTAR, (0, "0.99"), SYMMETRIC, False),
    ("3 3 -1 1", XSTAR, (0, 1), SYMMETRIC, False), ("3 3 -1 1", XSTAR, (0, 2), SYMMETRIC, True)])
def test_how_much_of_v1_is_enough(frame, xstar, v1, waves, enough):
    text = file_of("P", "0 1", ranged(*v1), frame=frame, xstar=xstar, waves=waves)
    assert (check.symmetries_used(claim_of(text)) is not None) == enough


FRAMES = [(1, 0, 0, 1), (0, 1, 1, 0), (1, 1, 1, -1), (2, 1, 1, 1), (2, 0, 0, 3), (1, 2, 0, -4),
          (3, 3, -1, 1), (2, -3, 3, 2), (-1, 6, 1, 3), (5, 2, 1, -2)]


def test_one_coordinate_alone(run):
    """The other's waves do not move c0, and its x* is not looked at."""
    waves, xstar = ["1 0 0 1.8 0.1", "0 1 0 0.01 0.01"], "1.5707963267948966 0"
    whole = found("1 1", "1 1", waves=waves, xstar=xstar, frame="1 0 0 1", alone="0")
    assert run(file_of(whole, "1 1", "1 1", waves=waves, xstar=xstar, frame="1 0 0 1",
                       alone="0"))[0] == 0
    v0 = "1.001 0.5011"                 # c0 = 0.5
    half = found(v0, "1 1", waves=waves, xstar=xstar, frame="1 0 0 1", alone="0")
    text = file_of(half, v0, "1 1", waves=waves, xstar=xstar, frame="1 0 0 1", alone="0")
    status, out, _ = run(text)
    assert status == 0 and "all others by reversal of time\n" in out
    assert run(sealed(text.replace("v0: " + v0, "v0: 1.002 0.5011")))[0] == 3
    low, high = c0_of(file_of("P", waves=["1 0 0 1.3 0.1", "0 1 0 9 0.01"], xstar="1 7",
                              frame="1 1 0 1", alone="0"))
    p = math.cos(1) / 2 / math.pi
    assert np.allclose((low, high), [(1 - 7) / math.pi + p * x for x in (1.2, 1.4)])


# ---- links

def test_links(one_link, two_links, run):
    """What is verified names the starting points, and what was linked."""
    for link, parts in ((one_link, 1), (two_links, 2)):
        status, out, _ = run(file_of(**link))
        assert status == 0 and out.startswith("Verified :") and "links between" in out
        assert "\nx* : 0.858 0.858\nx* of part a : 0.875 0.875\n" in out
        assert re.search("Leaves : .*, %d linked to other parts and 0 symmetric" % parts, out)


def test_links_of_a_region(one_link, run):
    """The region of the first part alone is what is claimed; here it is less than the torus."""
    assert run(file_of(**{**one_link, "v0": "0.5364 0.2502"}))[0] == 3
    narrow = {**one_link, "v0": HALF[0], "xstar": "0.858 0.8580000000000000001"}
    status, out, _ = run(file_of(**narrow))
    assert status == 3 and "goes from y = x* to y' = (v0 + v1, v0 - v1) in the region" in out
    assert "x* of part a" in out


def test_a_link_to_the_same_place(tree, run):
    """With the same x* nothing moves; with its tree, part a proves all that part 0 asks."""
    link = {"tree": "a", "parts": [(XSTAR, *HALF, tree)]}
    assert run(file_of(**link))[0] == 0
    assert run(file_of("0aa", parts=[(XSTAR, *HALF, tree)]))[0] == 0


@pytest.mark.slow
def test_links_with_parameters(run):
    """Of each slice of the parameters by its own l and its own bound of beta."""
    more = {"waves": MOVING}
    v0 = "0.5362 0.2503"
    tree = found(v0, **more)
    link = linked("2" + tree + tree, v0=v0, **more)
    assert run(file_of(**link))[0] == 0
    claim = claim_of(file_of("2PP", v0, **more))
    criterion = check.Criterion(claim)
    other = Fraction(7, 8), Fraction(7, 8)
    root, (low, high) = [check.displacement(criterion, cell, claim.xstar, other)
                         for cell in (check.ROOT,)][0], halves(check.ROOT, 2)
    for cell in (low, high):
        inner = check.displacement(criterion, cell, claim.xstar, other)
        closer = [(c - a, b - d) for (a, b), (c, d) in zip(root, inner)]
        assert all(min(ends) > -1e-28 and max(ends) > 1e-6 for ends in closer)  # roots are rounded


def refused(tree, *parts, **more):
    """Which part the first link that may lead out of its region leads to; None if none does."""
    claim = claim_of(file_of(tree, parts=parts, **more))
    check.check_tree(claim)
    try:
        check.check_links(claim, check.Criterion(claim))
    except check.NotConfirmed as error:
        return re.search("is linked to part (.)", str(error))[1]
    return None


def test_no_displacement_is_taken_for_another():
    """Of links that differ in one thing alone, the first leads from an x* to itself."""
    lower, upper, wide = "0.4111 0.1251", "0.6613 0.1251", ("0.5 3", "0.5 3")
    for start, found in (XSTAR, None), (ASIDE, "b"):    # to two parts
        parts = (XSTAR, lower, HALF[1], "P"), (start, upper, HALF[1], "P")
        assert refused("0ab", *parts) == found
    for start, found in (ASIDE, None), (XSTAR, "b"):    # from two parts
        parts = (start, *wide, "b"), (ASIDE, *wide, "P")
        assert refused("0ba", *parts, xstar=ASIDE) == found
    more = {"waves": [wave + " 0.1" for wave in SYMMETRIC]}
    claim = claim_of(file_of("2PP", **more))            # with two sets of parameters
    for cell, found in (check.ROOT, None), (halves(check.ROOT, 2)[0], "a"):
        moved = check.displacement(check.Criterion(claim), cell, claim.xstar,
                                   tuple(map(Fraction, ASIDE.split())))
        region = region_of(claim, check.ROOT, moved, Fraction(1, 10 ** 9))
        assert refused("2aa", (ASIDE, *region, "P"), **more) == found


def test_the_bound_of_beta_holds_along_the_segment():
    """Of one wave, whose beta is 2 - p sin(x + phase): at points of short and long segments."""
    draw, near = random.Random(11), 1
    for _ in range(100):
        phase, p = round(draw.uniform(-1, 1), 3), draw.choice((-1, 1))
        criterion = check.Criterion(claim_of(file_of("P", waves=["1 0 %s %d" % (phase, p)])))
        middle, w = Fraction(draw.randint(-400, 400), 100), Fraction(draw.randint(0, 200), 100)
        bound, mixed, other = check.upper_beta(criterion.claim, criterion.fixed, check.ROOT,
                                               (middle, Fraction(0)), (w, Fraction(0)))
        most = max(2 - p * math.sin(float(middle + w * n / 40) + math.pi * phase)
                   for n in range(-20, 21))
        assert bound >= most - 1e-12 and (mixed, other) == (0, 2)
        near = min(near, float(bound) - most)
    assert near < 1e-3


def random_link(draw):
    """A claim with parameters, and another x*."""
    count = draw.randint(0, 2)
    waves = []
    for k in draw.sample(((1, 0), (0, 1), (1, 1), (1, -1), (2, 1)), draw.randint(1, 3)):
        p = [draw.uniform(-1, 1) * 0.7] + [draw.uniform(-0.1, 0.1) for _ in range(count)]
        waves.append("%d %d %.3f %s" % (*k, draw.uniform(-1, 1),
                                        " ".join(["%.4f" % x for x in p])))
    frame = draw.choice(FRAMES)
    x = [Fraction(round(draw.uniform(-3, 3), 4)).limit_denominator(10 ** 5) for _ in "01"]
    reach = draw.choice((1e-3, 0.05, 0.5))
    y = tuple(a + Fraction(round(draw.uniform(-reach, reach), 6)).limit_denominator(10 ** 6)
              for a in x)
    return claim_of(file_of("P", waves=waves, frame=" ".join(map(str, frame)),
                            xstar="%s %s" % tuple(map(decimal, x)))), y


@pytest.mark.slow
def test_displacements_against_derivatives():
    """Whatever the derivative of f is between l and beta - l, f(y*) is where the bound says, and
    sometimes near its ends."""
    draw, cases, near = random.Random(3), 0, [0.0, 0.0]
    while cases < 60:
        claim, y = random_link(draw)
        criterion = check.Criterion(claim)
        k = draw.randint(0, 2)
        cell = (0, 0, *[draw.randrange(1 << k) for _ in "234"]), (0, 0, k, k, k)
        bounds = check.displacement(criterion, cell, claim.xstar, y)
        t = [(2 * i + 1 + draw.choice((-1, 0, 1))) / 2 ** n - 1
             for i, n in zip(cell[0][2:], cell[1][2:])]
        l = criterion.least_pivot(cell) / criterion.fixed.one
        x, w = np.array(claim.xstar, float), np.array(y, float) - np.array(claim.xstar, float)
        inverse = np.linalg.inv(np.reshape(claim.frame, (2, 2)).astype(float))
        z = x + (np.arange(400)[:, None] + 0.5) / 400 * w
        beta = np.zeros((400, 2, 2)) + 2 * np.eye(2)
        for wave in claim.examined:
            p = float(wave.middle) + sum(float(g) * s for g, s in zip(wave.parts, t))
            beta -= p * np.sin(z @ wave.k + math.pi * float(wave.phase))[:, None, None] \
                * np.outer(wave.k, wave.k)
        D = beta - 2 * l * np.eye(2)
        values, vectors = np.linalg.eigh(D)
        if values.min() < 0:
            continue
        root = vectors * np.sqrt(values)[:, None] @ vectors.transpose(0, 2, 1)
        for u in (*inverse, *-inverse):
            a, b = [v / np.linalg.norm(v, axis=1)[:, None] for v in (root @ u, root @ w)]
            # The R with |R| <= 1/2 that turns b to a makes u.A w largest.
            c = (a + b) / np.linalg.norm(a + b, axis=1)[:, None]
            R = c[:, :, None] * c[:, None] - np.eye(2) / 2
            moved = inverse @ ((l * np.eye(2) + D / 2 + root @ R @ root) @ w).mean(0) / math.pi
            for v, (low, high) in zip(moved, bounds):
                assert float(low) <= v <= float(high)
                where = (v - float(low)) / float(high - low)
                near = [max(near[0], where), max(near[1], 1 - where)]
            cases += 1
    assert min(near) > 0.99


def test_the_bound_of_beta_with_few_bits():
    """With 8 bits the sines are off by units of 1/256, and beta is not above its bound."""
    fixed, draw = check.fixed_of(8), random.Random(9)
    for _ in range(200):
        phase, x = (round(draw.uniform(-2, 2), 3) for _ in "01")
        p = round(draw.uniform(-4, 4), 3)
        claim = claim_of(file_of("P", waves=["1 0 %s %s" % (phase, p)]))
        most, *others = check.upper_beta(claim, fixed, check.ROOT, (Fraction(x), 0), (0, 0))
        assert 2 - p * math.sin(x + math.pi * phase) <= most and others == [0, 2]


# ---- parts that stand for their mirror images

def folded_link(shifts=("", ""), part_v1="%s %s", most=1, **more):
    """The arguments of a file with a link into a region of which the part proves only v1 >= 0.

    shifts: of v0 and v1; most: how much of the range of v1 the part has."""
    base = {"xstar": XSTAR, **more}
    there = base.pop("there", OTHER)
    tree = found(**base)
    claim = claim_of(file_of("P", **base))
    at, cell = max(((at, cell) for at, cell in check.leaves(tree) if cell[0][1] == 0),
                   key=lambda leaf: sum(leaf[1][1]))
    moved = check.displacement(check.Criterion(claim), cell, claim.xstar,
                               tuple(map(Fraction, there.split())))
    v0, v1 = region_of(claim, cell, moved, Fraction(1, 1000))
    centre, half = map(Fraction, v1.split())
    assert centre - half < 0 < centre
    v0, v1 = v0 + shifts[0], part_v1 % ((decimal((centre + half) * most / 2),) * 2) + shifts[1]
    part = there, v0, v1, found(" ".join(v0.split()[:2]), " ".join(v1.split()[:2]),
                                **{**base, "xstar": there})
    return {"tree": tree[:at] + "a" + tree[at + 1:], **base, "parts": [part]}


def wide(*parts):
    return [wave + part for wave, part in zip(SYMMETRIC, parts)]


ALIKE = wide(" 1e-9", " 1e-9", " 0")                            # one parameter
APART_ALIKE = wide(" 1e-9 0", " 0 1e-9", " 0 0")                # two, which the exchange exchanges
APART_TURNED = wide(" 1e-9 0 0", " 0 1e-9 0", " 0 0 1e-9")      # the third stays
FOLDS = {
    "one value": {},
    "a parameter": {"waves": ALIKE},
    "a parameter that moves v0": {"waves": ALIKE, "shifts": (" 1e-6", " 0")},
    "two parameters": {"waves": APART_ALIKE},
    "two parameters that move v0 alike": {"waves": APART_ALIKE, "shifts": (" 1e-6 1e-6", " 0 0")},
    "three, one of them as it likes": {"waves": APART_TURNED,
                                       "shifts": (" 1e-6 1e-6 -1e-5", " 0 0 0")},
}
FOLDS_NOT = {
    "x* off the diagonal": {"there": "0.875 0.875000001"},
    "x* off the diagonal by 1e-30": {"there": "0.875 0.875000000000000000000000000001"},
    "waves not symmetric": {"waves": [SYMMETRIC[0], "0 1 0 0.2242873", SYMMETRIC[2]]},
    "phases not symmetric": {"waves": [SYMMETRIC[0], "0 1 1e-9 0.2242872", SYMMETRIC[2]]},
    "a parameter of one wave": {"waves": wide(" 1e-9", " 0", " 0")},
    "parameters that no exchange maps": {"waves": wide(" 1e-9 0", " 0 2e-9", " 0 0")},
    "v1 that moves": {"waves": ALIKE, "shifts": (" 0", " 1e-12")},
    "v0 that moves by one of two": {"waves": APART_ALIKE, "shifts": (" 1e-6 0", " 0 0")},
    "v0 that two move apart": {"waves": APART_ALIKE, "shifts": (" 1e-6 -1e-6", " 0 0")},
    "v0 that another order would leave": {"waves": APART_TURNED,
                                          "shifts": (" 1e-6 0 1e-6", " 0 0 0")},
    "another frame": {"frame": "1 0 0 1", "there": "0.85 0.85"},
    "v1 that begins above 0": {"part_v1": "%s1 %s"},
    "v1 that ends too early": {"most": Fraction(9, 10)},
}


@pytest.mark.parametrize("name", FOLDS)
@pytest.mark.slow
def test_a_part_stands_for_its_mirror_image(run, name):
    """Where the exchange of the angles maps its x*, V and its region to themselves."""
    assert run(file_of(**folded_link(**FOLDS[name])))[0] in (0, 3)


@pytest.mark.parametrize("name", FOLDS_NOT)
def test_a_part_does_not_stand_for_its_mirror_image(run, name):
    status, out, err = run(file_of(**folded_link(**FOLDS_NOT[name])))
    assert (status, out) == (5, "") and "is linked to part a, but may lead out of" in err


def test_a_mirror_image_that_does_not_touch_the_region():
    """The range of v1 has to reach 0, however wide that of v0 is."""
    for v1, touches in ("0.25 0.25", True), ("0.25 0.2", False), ("-0.25 0.2", False):
        claim = claim_of(file_of("a", parts=[(XSTAR, HALF[0], v1, "P")]))
        assert check.folds(claim.parts[0]) == touches


@pytest.mark.parametrize("centre", ["0.25", "-0.25"])
def test_a_part_and_its_mirror_image_are_all_between_their_ends(centre):
    """-0.25 <= v1 <= 0.75 with its image holds |v1| <= 0.75, and no more."""
    for half, inside in (("0.75", True), ("0.7500001", False), ("1", False)):
        claim = claim_of(file_of("a", v1="0 " + half,
                                 parts=[(XSTAR, HALF[0], centre + " 0.5", "P")]))
        check.check_tree(claim)
        leads_out = contextlib.nullcontext() if inside else pytest.raises(
            check.NotConfirmed, match="may lead out")
        with leads_out:
            check.check_links(claim, check.Criterion(claim))


# ---- wrong files: what is changed, and what the checker says

def with_line(*change):
    return sealed(with_text(*change))


def replaced(text, old, new, count=1):
    assert old in text
    return sealed(text.replace(old, new, count))


def with_part(link, n=0, **changes):
    """The arguments with another x*, v0, v1 or tree of a part."""
    names = ("xstar", "v0", "v1", "tree")
    parts = [dict(zip(names, part)) for part in link["parts"]]
    parts[n].update(changes)
    return {**link, "parts": [tuple(part[name] for name in names) for part in parts]}


def with_leaf(tree, kind, number=0, old="P"):
    at = [at for at, node in enumerate(tree) if node == old][number]
    return tree[:at] + kind + tree[at + 1:]


def shorter(text, end, by):
    """A range with one of its ends moved inwards."""
    centre, half = map(Fraction, text.split())
    return "%s %s" % (decimal(centre - end * by / 2), decimal(half - by / 2))


def tree_of_part(link, n=0):
    return link["parts"][n][3]


WRONG_STRUCTURE = {         # arguments of a file with two links -> a text; and what is said
    "a letter to its own part": (lambda f: file_of(**with_part(f, 0, tree="0a" + tree_of_part(f))),
                                 "nor a later part"),
    "a letter to an earlier part": (lambda f: file_of(**with_part(
        f, 1, tree="0a" + tree_of_part(f, 1))), "part b: 'a' is not a node"),
    "a letter to a missing part": (lambda f: file_of(**{**f, "tree": with_leaf(f["tree"], "c")}),
                                   "'c' is not a node of a finished tree nor a later part"),
    "a part that nobody needs": (lambda f: file_of(**{**f, "tree": with_leaf(
        f["tree"], "P", old="a")}), "no leaf is linked to part a"),
    "an empty tree": (lambda f: file_of(**with_part(f, 1, tree="")),
                      "part b: the tree is incomplete"),
    "a tree too long": (lambda f: file_of(**with_part(f, 1, tree="PP")), "before its text does"),
    "undecided in a part": (lambda f: replaced(file_of(**with_part(
        f, 1, tree="0U" + tree_of_part(f, 1))), "undecided: 1", "undecided: 0"), "is undecided"),
    "undecided beside links": (lambda f: replaced(file_of(**{**f, "tree": with_leaf(
        f["tree"], "U")}), "undecided: 1", "undecided: 0"), "is undecided"),
    "a parameter that there is not": (lambda f: file_of(**with_part(
        f, 1, tree="2PP")), "an angle or a parameter that there is not"),
    "symmetric in a part": (lambda f: file_of(**with_part(f, 0, tree="0S" + tree_of_part(f))),
                            "is skipped, but the problem is not symmetric"),
    "alone with links, of a product": (lambda f: file_of(**{**f, "waves": SYMMETRIC[:2],
                                                            "alone": "0"}),
                                       "links are of whole graphs"),
    "linked too few": (lambda f: with_line(file_of(**f), "linked", 1), "linked is 1, the tree's 2"),
    "proved of the first tree only": (lambda f: with_line(file_of(**f), "proved",
                                                          f["tree"].count("P")), "proved is"),
    "cuts of the first tree only": (lambda f: with_line(file_of(**with_part(
        f, 1, tree="0PP")), "cuts", f["tree"].count("0") + f["tree"].count("1")), "cuts is"),
    "most_cuts": (lambda f: with_line(file_of(**f), "most_cuts", 99), "most_cuts is 99"),
    "depth of a part": (lambda f: with_line(file_of(**with_part(
        f, 1, tree="0P" * 20 + "P")), "depth", 19), "more often than the depth allows"),
    "parts in another order": (lambda f: replaced(replaced(replaced(
        file_of(**f), "part: a", "part: x"), "part: b", "part: a"), "part: x", "part: b"),
        "part a is not 'part: a'"),
    "a part twice": (lambda f: replaced(file_of(**f), "part: b", "part: a"), "part b is not"),
    "a part without x*": (lambda f: replaced(file_of(**f), "xstar: %s\n" % OTHER, ""),
                          "part a is not"),
    "an x* that is a ratio": (lambda f: file_of(**with_part(f, 1, xstar="1/3 1")),
                              "part b's xstar is not two decimal numbers"),
    "a negative half-width": (lambda f: file_of(**with_part(f, 1, v1="1 -1")), "half-width is neg"),
    "determinant 0": (lambda f: with_line(file_of(**f), "frame", "1 2 2 4"), "determinant 0"),
    "27 parts": (lambda f: file_of("a", parts=[(XSTAR, *HALF, letter) for letter in
                                               check.LETTERS[1:] + "PP"]),
                 "more parts than letters"),
    "an S without exchange": (lambda f: file_of("0SP"), "the problem is not symmetric"),
}


@pytest.mark.parametrize("name", WRONG_STRUCTURE)
def test_wrong_files_are_rejected(two_links, run, name):
    change, why = WRONG_STRUCTURE[name]
    status, out, err = run(change(two_links))
    assert (status, out) == (1, "") and why in err, err


TIGHT = Fraction(1, 10 ** 39)           # the margin of a region, which is given to 40 digits


@pytest.fixture(scope="module")
def tight(tree):
    """A link to a region that is hardly larger than it must be."""
    return linked(tree, (ASIDE,), margin=TIGHT)


def moved(text, n, by):
    words = [Fraction(word) for word in text.split()]
    words[n] += Fraction(by)
    return "%s %s" % tuple(map(decimal, words))


STICKS_OUT = {
    **{"%s of the part short by %s at its %s end" % (name, by, ["lower", "upper"][end > 0]): (
        lambda f, name=name, end=end, by=by: with_part(f, 0, **{
            name: shorter(f["parts"][0][1 + (name == "v1")], end, Fraction(by))}))
       for name in ("v0", "v1") for end in (-1, 1) for by in ("1e-30", "1e-4")},
    **{"x*%d of the part moved by %s" % (n, by): (
        lambda f, n=n, by=by: with_part(f, 0, xstar=moved(ASIDE, n, by)))
       for n in (0, 1) for by in ("1e-20", "-1e-20", "0.01", "-0.01")},
    **{"x*%d of part 0 moved by %s" % (n, by): (
        lambda f, n=n, by=by: {**f, "xstar": moved(XSTAR, n, by)})
       for n in (0, 1) for by in ("1e-20", "-1e-20")},
    "turns count": lambda f: with_part(f, 0, v0=moved(f["parts"][0][1], 0, 2)),
    "the part of the neighbour": lambda f: {
        **f, "tree": with_leaf(with_leaf(f["tree"], "P", old="a"), "a", 0)},
    "the whole region": lambda f: {**f, "tree": "a"},
    "amplitudes with width": lambda f: {**f, "waves": [wave + " 1e-20" for wave in SYMMETRIC]},
    "larger amplitudes": lambda f: {**f, "waves": ["1 0 0 0.2242872", "0 1 0 0.2242872",
                                                   "1 1 0 0.45"]},
    "another phase": lambda f: {**f, "waves": [*SYMMETRIC[:2], "1 1 0.001 0.4485744"]},
    "a wider leaf": lambda f: {**f, "v1": "0.5 0.501"},
    "another frame": lambda f: {**f, "frame": "1 1 -1 1"},
    "a region of no width": lambda f: with_part(f, 0, v0=f["parts"][0][1].split()[0] + " 0"),
}


@pytest.mark.parametrize("name", STICKS_OUT)
def test_links_that_lead_out_are_not_confirmed(tight, run, name):
    status, out, err = run(file_of(**STICKS_OUT[name](tight)))
    assert (status, out) == (5, "") and "is linked to part a, but may lead out of" in err


def test_tight_links_are_confirmed(tight, run):
    """So what is wrong above is what was changed."""
    assert run(file_of(**tight))[0] == 0


@pytest.mark.slow
def test_a_part_that_is_not_proved(tight, two_links, run):
    """The leaves of a part are checked like others, and named."""
    for link, letter in ((tight, "a"), (two_links, "b")):
        n = check.LETTERS.index(letter)
        wide = with_part(link, n, v0="0 1", v1="0 1", tree="P")
        status, out, err = run(file_of(**wide))
        assert (status, out) == (5, "") and "part %s: proved leaf 1 of 1" % letter in err
    wide = with_part(tight, 0, xstar="-1.5 -1.5", v0="0 5", v1="0 5", tree="P")
    assert run(file_of(**wide))[0] == 5


def test_numbers_too_large_are_not_confirmed(two_links, run):
    """No x* is so far off, no digit so fine, that anything but one line comes of it."""
    for far in ("1e300 0", "1e30 1e30"):
        status, out, err = run(file_of(**with_part(two_links, 1, xstar=far)))
        assert (status, out) == (5, "") and "too far off" in err and err.count("\n") == 1
        assert check.symmetries_used(claim_of(file_of("P", xstar=far))) is None
    status, _, err = run(file_of(**with_part(two_links, 1, v0="1e300 1e-290")))
    assert status == 5 and err.count("\n") == 1


NOT_ALL = {             # of files without links: verified, but of a part of the torus
    "v0 short of c0 by 1e-12": lambda c: {"v0": ranged(c + Fraction(1, 10 ** 12), "0.7864")},
    "v0 short of c0 + 1/2 by 1e-12": lambda c: {
        "v0": ranged("0.286", c + Fraction(1, 2) - Fraction(1, 10 ** 12))},
    "v1 short of 0": lambda c: {"v1": ranged("1e-12", 1)},
    "v1 short of 1": lambda c: {"v1": ranged(0, "0.999999999999")},
    "waves not symmetric": lambda c: {"waves": [SYMMETRIC[0], "0 1 0 0.2242873", SYMMETRIC[2]]},
    "phases not symmetric": lambda c: {"waves": [SYMMETRIC[0], "0 1 1e-9 0.2242872", SYMMETRIC[2]]},
    "x* off the diagonal": lambda c: {"xstar": "0.858 0.85800001"},
    "a phase moves c0": lambda c: {"waves": [*SYMMETRIC[:2], "1 1 0.01 0.4485744"]},
    "a parameter with width moves c0": lambda c: {"waves": [
        *[wave + " 0" for wave in SYMMETRIC[:2]], "1 1 0 0.4485744 0.03"]},
    "parameters that no exchange maps": lambda c: {"waves": [
        "1 0 0 0.2242872 1e-9 0", "0 1 0 0.2242872 0 2e-9", SYMMETRIC[2] + " 0 0"]},
    "x* moves c0": lambda c: {"xstar": "0.857 0.857"},
    "another frame": lambda c: {"frame": "1 -1 1 1", "v1": "0.5 0.499"},
}


@pytest.mark.parametrize("name", NOT_ALL)
def test_regions_that_are_not_enough(run, name):
    """They are verified, which is said to be for a part of the torus only."""
    c = Fraction(c0_of(file_of("P"))[0])
    more = NOT_ALL[name](Fraction(round(c * 10 ** 16), 10 ** 16))
    v0, v1 = more.pop("v0", HALF[0]), more.pop("v1", HALF[1])
    status, out, _ = run(file_of(found(v0, v1, **more), v0, v1, **more))
    assert status == 3 and out.startswith("Verified, for a part of the torus only :")


def test_a_sample_of_linked_files(two_links, tmp_path):
    """Links and trees are checked whole whatever the sample."""
    path = tmp_path / "x"
    path.write_text(file_of(**two_links))
    total = sum(tree.count("P") for tree in
                (two_links["tree"], *[part[3] for part in two_links["parts"]]))
    result = verify(path, sample=3)
    assert result.status == 4 and not result and "links between starting points" in result.text
    assert "3 of %d proved" % total in result.text
    assert verify(path, jobs=2).status == 0
    path.write_text(file_of(**with_part(two_links, 1, v1="9 0.1")))
    with pytest.raises(check.NotConfirmed, match="may lead out of"):
        verify(path, sample=1)
