"""Other potentials and frames; which potentials are symmetric; and trees."""

import dataclasses
import math
import re
from fractions import Fraction

import pytest
from files import sealed, tree_of

from checker import check
from claims import (OTHERS, ZERO, angle_at, definite, exact_decimal, general, in_frame, mp, near,
                    random_point, real, waves_of)
from trees import claim_of, found_tree, with_field, with_tree

pytestmark = pytest.mark.usefixtures("impatient")


# ---- other potentials and frames
HALF_PI = "1.5707963267948966"
PROBLEMS = {                # waves, what else is said of them, and where minimizing is contradicted
    "the standard map": ([((1, 0), 0, "1.2", ["0.01"])], {"odd": "0 0"}, (HALF_PI, 0)),
    "with harmonics": ([((1, 0), 0, "0.98", ["0.01", 0]), ((2, 0), "-1/3", "0.1", [0, "0.02"])], {},
                       ("1.45", 0)),
    "(1, -1)": ([((1, 0), "1/2", "1.2", ["0.01"]), ((1, -1), 0, "0.4", ["-0.02"])],
                {"odd": "-1/2 1/2"}, (0, "-1.5")),
    "in a frame": ([((1, 1), 0, "0.62", [])], {"frame": (1, 0, -1, 1), "odd": "0 0"},
                   (HALF_PI, 0)),
    "a patch": ([((1, 0), 0, "0.6", ["0.01", "0.004", 0]),
                 ((0, 1), 0, "0.6", ["0.01", "-0.004", 0]),
                 ((1, 1), 0, "0.6", ["0.01", 0, "0.02"])], {"odd": "0 0"}, ("0.858", "0.858")),
    "one alone": ([((1, 0), 0, "1.3", ["0.1"]), ((0, 1), 0, "0.01", ["0.01"])],
                  {"alone": "0", "odd": "0 0"}, (HALF_PI, 0))}


@pytest.fixture(scope="module")
def others(texts, tmp_path_factory):
    """Proof files of other potentials, by name."""
    found = {}
    for name, (waves, more, xstar) in PROBLEMS.items():
        text = general(texts["trig274"], waves, tree="P", xstar=xstar, **more)
        tree = found_tree(claim_of(text), 20000)
        tree = "01PP1PP" if tree == "P" else tree           # something to alter
        found[name] = sealed(with_tree(with_field(text, "depth", 99), tree))
    return found


@pytest.mark.parametrize("name", PROBLEMS)
def test_confirms_other_potentials(others, run, name):
    text = others[name]
    status, out, err = run(text)
    assert (status, err) == (0, "") and out.startswith("Verified :")
    assert tree_of(text).count("P") > 3 and "multiple" not in out
    waves, more, _ = PROBLEMS[name]
    if name == "with harmonics":
        assert "\n-1 <= t1 <= 1\n-1 <= t2 <= 1\n" in out
        assert " - (0.1 + 0.02 t2) sin(2 y - 1/3 pi)" in out
    assert ("Alone : y0" in out) == (name == "one alone")
    assert run(text, "--exact")[0] == 0 or len(tree_of(text)) > 300


@pytest.mark.parametrize("name", PROBLEMS)
def test_no_orbit_of_a_leaf_of_other_potentials_minimizes(others, generator, name):
    claim = claim_of(others[name])
    cells = [cell for at, cell in check.leaves(claim.tree) if claim.tree[at] == "P"]
    waves = waves_of(claim)
    for _ in range(60):
        amplitudes, v = random_point(generator, claim, generator.choice(cells))
        x1 = in_frame(claim.frame, [real(x) * mp.pi for x in v])
        assert not definite([real(p) for p in amplitudes], [real(x) for x in claim.xstar], x1, 25,
                            waves=waves)


@pytest.mark.parametrize("name, field, value, status, why", [
    ("a patch", "frame", "1 2 2 4", 1, "determinant"), ("a patch", "alone", "0", 1, "both"),
    ("a patch", "alone", "2", 1, "neither"), ("a patch", "alone", "yes", 1, "neither"),
    ("one alone", "alone", "1", 5, "not excluded"), ("one alone", "alone", "no", 0, ""),
    ("a patch", "odd about", "1/2 0", 1, "not odd"), ("a patch", "odd about", "1/0 0", 1, "two"),
    ("a patch", "odd about", "yes", 1, "two"), ("a patch", "odd about", "1 -7", 0, ""),
    ("(1, -1)", "odd about", "1/2 -1/2", 0, ""), ("(1, -1)", "odd about", "0 0", 1, "not odd"),
    ("(1, -1)", "odd about", "1/2 0", 1, "not odd"),
    ("with harmonics", "odd about", "0 0", 1, "not odd"),
    ("with harmonics", "at once", "yes", 1, "only where V is odd"),
    ("with harmonics", "at once", "upper end", 1, "only where V is odd"),
    ("a patch", "at once", "upper end", 1, "no upper end"),
    ("in a frame", "at once", "upper end", 1, "no upper end"),
    ("in a frame", "at once", "yes", 5, "B > 10/3"),
    ("the standard map", "at once", "upper end", 5, "B > 10/3"),
    ("one alone", "at once", "upper end", 0, ""), ("one alone", "at once", "yes", 5, "B > 10/3"),
    ("a patch", "wave", "1 0 0", 1, "K0 K1"), ("a patch", "wave", "1 0 0 1 0 0 0 0", 1, "K0 K1"),
    ("a patch", "wave", "1 0 0 0.6 0.01", 1, "as many"),
    ("a patch", "wave", "0 0 0 1 0 0 0", 1, "zero"),
    ("a patch", "wave", "1 101 0 1 0 0 0", 1, "beyond 100"),
    ("a patch", "wave", "1 1 0 1e301 0 0 0", 5, "out of range"),
    ("a patch", "wave", "1 1 1/2 0.6 0.01 0 0.02", 1, "not odd")])
def test_header_of_other_potentials(others, run, name, field, value, status, why):
    text = re.sub("(?m)^%s: .*$" % field, "%s: %s" % (field, value), others[name], count=1)
    if status == 0 and others[name] != text:
        assert "wrong checksum" in run(text)[2]
    found, out, err = run(sealed(text))
    assert found == status and why in err and err.count("\n") == (status != 0)
    assert (out == "") == (status != 0)


@pytest.mark.parametrize("waves, order", [
    ([((1, 0), 0, 1, ["0.1", 0]), ((0, 1), 0, 1, [0, "0.1"])], (1, 0)),
    ([((1, 0), 0, 1, ["0.1", 0]), ((0, 1), 0, 1, ["0.1", 0])], (0, 1)),
    ([((1, 0), 0, 1, ["0.1", 0]), ((0, 1), 0, 1, ["0.1", "0.1"])], None),
    ([((1, 0), 0, 1, ["0.1", 0]), ((0, 1), 0, 1, [0, "0.2"])], None),
    ([((1, 0), 0, 1, []), ((0, 1), 0, 1, [])], ()),
    ([((1, 0), 0, 1, []), ((0, 1), 0, 2, [])], None),
    ([((1, -1), "1/2", 1, [])], ()), ([((1, -1), 0, 1, [])], None), ([((1, -1), 1, 1, [])], None),
    ([((1, -1), 0, 1, []), ((-1, 1), 0, 1, [])], ()),
    ([((1, 0), "1/3", 1, ["0.1"]), ((0, 1), "7/3", 1, ["0.1"])], (0,)),
    ([((1, 0), "1/3", 1, ["0.1"]), ((0, -1), "2/3", 1, ["0.1"])], (0,)),
    ([((1, 0), "1/3", 1, ["0.1"]), ((0, 1), "4/3", -1, ["-0.1"])], (0,)),
    ([((1, 0), "1/3", 1, ["0.1"]), ((0, 1), "4/3", 1, ["0.1"])], None),
    ([((1, 2), 0, 1, ["0.1", 0, 0]), ((2, 1), 0, 1, [0, "0.1", 0]), ((1, 1), 0, 1, [0, 0, 1])],
     (1, 0, 2)),
    ([((1, 2), 0, 1, [0, "0.1", 0]), ((2, 1), 0, 1, [0, 0, "0.1"]), ((1, 1), 0, 1, [1, 0, 0])],
     (0, 2, 1))])
@pytest.mark.quick
def test_which_potentials_are_symmetric(texts, generator, waves, order):
    """V with its coordinates exchanged is V with its parameters in that order, or never."""
    claim = claim_of(general(texts["trig274"], waves, xstar=("0.5", "0.5")))
    orders = check.Mirror(claim).orders
    assert (order in orders) if order is not None else orders == []

    def V(t, y):
        return sum(wave.at(t) * mp.sin(angle_at((wave.k, wave.phase), y)) for wave in claim.waves)

    for _ in range(20):
        t = [near(generator) for _ in range(claim.parameters)]
        y = [real(near(generator)) * 4 for _ in "01"]
        for found in orders:
            image = [t[m] for m in found]
            assert abs(sum(real(wave.at(t)) * mp.sin(angle_at((wave.k, wave.phase), y[::-1]))
                           - real(wave.at(image)) * mp.sin(angle_at((wave.k, wave.phase), y))
                           for wave in claim.waves)) < mp.mpf(10) ** -50
    for more in ({"frame": (0, 1, 1, 0)}, {"v0": (1, 2)}, {"xstar": ("0.5", "0.6")}):
        text = general(texts["trig274"], waves, **{"xstar": ("0.5", "0.5"), **more})
        assert check.Mirror(claim_of(text)).orders == []


@pytest.mark.quick
def test_a_linked_leaf_is_no_proved_mirror_image(texts):
    text = general(texts["trig274"], [((1, 0), 0, 1, []), ((0, 1), 0, 1, [])],
                   xstar=("0.5", "0.5"))
    for tree, proved in ("01PP1SP", True), ("01Pa1SP", False):
        claim = dataclasses.replace(claim_of(text), tree=tree)
        cell, = [cell for at, cell in check.leaves(tree, kinds="PSa") if tree[at] == "S"]
        assert (check.Mirror(claim).refusal(cell) is None) == proved


@pytest.mark.quick
def test_coefficients_are_those_of_the_potential(generator):
    for _ in range(100):
        waves = [check.Wave(k, phase + generator.randint(-3, 3), exact_decimal(generator, 1),
                            (exact_decimal(generator, 1),)) for k, phase in
                 generator.choices(OTHERS, k=5)]
        waves += [check.Wave((-k[0], -k[1]), phase, exact_decimal(generator, 1), (ZERO,))
                  for k, phase in generator.choices(OTHERS, k=3)]
        found = check.coefficients(waves)
        y, t = [real(near(generator)) * 4 for _ in "01"], near(generator)
        total = sum(real(p + t * g) * mp.sin(angle_at(key, y)) for key, (p, g) in found.items())
        assert abs(total - sum(real(wave.at((t,))) * mp.sin(angle_at((wave.k, wave.phase), y))
                               for wave in waves)) < mp.mpf(10) ** -50
        assert all(k > (0, 0) and 0 <= phase < 1 for k, phase in found)


# ---- the tree


def random_tree(generator, depth, axes="01"):
    if depth == 0 or generator.random() < 0.25:
        return generator.choice("PPPS")
    return generator.choice(axes) + "".join(random_tree(generator, depth - 1, axes) for _ in "01")


@pytest.mark.parametrize("together, axes", [("no", "01"), ("no", "01234"), ("yes", "012"),
                                            ("no", "23"), ("no", "0123")])
def test_mirror_images_against_boxes(texts, generator, together, axes):
    text, seen = with_field(texts["trig274"], "together", together), set()
    swapped = (1, 0, 2, 3, 4) if together == "yes" else (1, 0, 3, 2, 4)
    for _ in range(300):
        tree = random_tree(generator, generator.randint(1, 7), axes)
        mirror = check.Mirror(claim_of(with_tree(text, tree)))
        boxes = [(tree[at], [(Fraction(i, 2 ** k), Fraction(i + 1, 2 ** k))
                             for i, k in zip(*cell)], cell) for at, cell in check.leaves(tree)]
        assert sum(math.prod(high - low for low, high in box) for _, box, _ in boxes) == 1
        for node, box, cell in boxes:
            if node == "S":
                image = [box[axis] for axis in swapped]
                clear = all(kind == "P" for kind, other, _ in boxes
                            if all(a < d and c < b for (a, b), (c, d) in zip(image, other)))
                assert (mirror.refusal(cell) is None) == clear
                seen.add(clear)
    assert seen == {True, False}
