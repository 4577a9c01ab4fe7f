"""The search as a whole: what is proved is true, what is not true is not proved."""

import contextlib
import os
import shutil
import subprocess
import sys
import time
from fractions import Fraction
from threading import Thread

import mpmath
import pytest
from conftest import around

import converse
from converse.model.exact import pi_bounds
from converse.model.map import LINE
from converse.prover.settings import Settings
from converse.prover.tree import leaves

import kernels
from truth import TORTURE, beta, decimal, eigenvalues, exact, inverse, mp, rng_for, uniform

FULL = (("1", "1"), ("1", "1"))


def problem(a, b, c, v=FULL):
    """(centre, half) pairs of decimal strings."""
    pairs = [a, b, c, *v]
    return around(tuple(Fraction(x) for x, _ in pairs),
                          tuple(Fraction(x) for _, x in pairs), ())


def line(epsilon, width="0"):
    """The thesis's line of parameters a = b = c/2 near k = 52.9549 epsilon."""
    a = LINE * Fraction(epsilon)
    a, h = decimal(a, 8), Fraction(width)
    return problem((a, h), (a, h), (2 * a, 2 * h))


@pytest.fixture(scope="module")
def proofs(root):
    """The four theorems, sound."""
    return {name: converse.prove(converse.read_input(root / "inputs" / (name + ".in")),
                                 method="thesis")
            for name in ("trig278", "trig276", "trig274", "trig272")}


@pytest.mark.parametrize("name, prisms, T, B", [
    ("trig278", 1, "5.719460284523", "3.483910989845"),
    ("trig276", 45, "5.708517020978", "3.474466846712"),
    ("trig274", 111, "5.694837941547", "3.462661667795"),
    ("trig272", 468, "5.681158862116", "3.450856488878"),
])
def test_the_four_theorems(proofs, name, prisms, T, B):
    """To the last digit: T and B have 12 decimal places whatever the precision."""
    proof = proofs[name]
    assert proof.no_tori and proof.counts.undecided == 0
    assert proof.counts.proved == prisms
    assert (proof.constants["T"], proof.constants["B"]) == (T, B)


@pytest.mark.parametrize("dp", [1, 2, 3, 4, 5, 30])
def test_the_region_in_radians_holds_the_region(dp):
    """With few places every margin counts; none is wider than need be."""
    rng, ulp = rng_for("region%d" % dp), Fraction(1, 10**dp)
    with mpmath.workdps(60):
        pi = exact(mpmath.pi)
    for _ in range(1000 * TORTURE):
        centre, half = (decimal(uniform(rng, -1, 1, 9) * 10**rng.randrange(-2, 4), 12) *
                        rng.choice((0, 1, 1)) for _ in range(2))
        half = abs(half)
        found, reach = kernels.region(centre, half, dp)
        assert abs(centre * pi - found) + half * pi <= reach
        assert reach <= half * pi + (abs(centre) + half + 2) * ulp


def test_prisms_of_the_region_that_is_meant_stay_within_reach():
    """Of what moves with three parameters: centre and shifts are off by no more than they are said
    to be, however pi is rounded, and the half-width has these errors and hardly more."""
    rng = rng_for("radians that move")
    for _ in range(300 * TORTURE):
        dp = rng.choice([1, 5, 30, 60])
        c, h, *shifts = [Fraction(rng.choice([0, 1, rng.randrange(1, 10 ** 6)])
                                  * rng.choice([-1, 1]), 10 ** rng.choice([0, 6, 40]))
                         for _ in range(5)]
        out = kernels.call("region_that_moves", [c, abs(h), *shifts], 5, dp)
        c_, h_, *shifts_ = out
        exact = [x * y for x in (c, abs(h), *shifts) for y in pi_bounds(100)]
        parts = [max(abs(x - y) for y in exact[2 * i:2 * i + 2])
                 for i, x in enumerate((c_, h_, *shifts_))]
        most = [(abs(x) + 1) / Fraction(10) ** dp for x in (c, h, *shifts)]
        assert all(part <= x for part, x in zip(parts[:1] + parts[2:], most[:1] + most[2:]))
        assert parts[1] <= sum(most)
        assert h_ - exact[2] >= parts[0] + sum(parts[2:])


def test_no_double_too_large_crashes():
    """Numbers whose squares, or sums, no double holds: an answer, or an error in words; and none
    that denies the tori of a = b = c = 0."""
    for method in ("thesis", "loewner"):
        for a, b in (("1e300", "0"), ("9e299", "1e299"), ("0", "1e300"), ("-1e200", "1e200")):
            with contextlib.suppress(converse.ConverseError):
                proof = converse.prove(problem((a, b), ("0", "0"), ("0", "0")), depth=0,
                                       method=method)
                assert not proof.no_tori or Fraction(b) < abs(Fraction(a))


def test_as_printed_counts(root):
    """The thesis's sample run: all its counts but one (319 tries where it has 318)."""
    proof = converse.prove(converse.read_input(root / "inputs" / "trig274.in"), as_printed=True)
    c = proof.counts
    assert (c.quick_tries, c.tries, c.Rtries) == (322, 319, 156)
    assert (c.cuts, c.proved, c.symmetric, c.undecided) == (166, 156, 11, 0)
    assert (c.most_cuts, c.max_steps, c.max_NTsteps) == (13, 5, 4)
    assert (c.HermSuccess, c.LLSuccess) == (0, 156)
    assert c.ll_used == (522, 0, 0)     # where it has 99.4, 0.0 and 0.6 percent
    assert not proof.no_tori            # a reconstruction is not a proof


@pytest.mark.parametrize("name, thesis", [("trig278", (3, 10, 39)), ("trig276", (4, 11, 64)),
                                          ("trig274", (4, 13, 156)), ("trig272", (6, 21, 933))])
def test_as_printed_table(root, name, thesis):
    """Longest orbit and depth within one, prisms within 8 % of the thesis's table."""
    c = converse.prove(converse.read_input(root / "inputs" / (name + ".in")),
                       as_printed=True).counts
    longest, deepest, prisms = thesis
    assert abs(c.max_NTsteps - longest) <= 1
    assert abs(c.most_cuts - deepest) <= 1
    assert abs(c.proved - prisms) <= 0.08 * prisms


def test_statistics_count_the_bounds_of_tries_that_fail(root):
    """A prism that falls to the eigenvalue never had its last bound from the trace."""
    c = converse.prove(converse.read_input(root / "inputs" / "trig272.in"), as_printed=True).counts
    assert c.HermSuccess == 0
    assert c.ll_used == (5562, 0, 82)


def second_variation_fails(a, b, c, x0, x1, reach=40):
    """Is some finite segment of the orbit through x0, x1 not a minimum?"""
    forward, backward = [x0, x1], [x1, x0]
    for orbit in (forward, backward):
        for _ in range(reach):
            (u0, u1), (v0, v1) = orbit[-2:]
            mixed = c * mpmath.cos(v0 + v1)
            orbit.append((2 * v0 - u0 + a * mpmath.cos(v0) + mixed,
                          2 * v1 - u1 + b * mpmath.cos(v1) + mixed))
    d = None
    for v in backward[:1:-1] + forward:
        m = beta(a, b, c, *v)
        if d is not None:
            m = tuple(x - y for x, y in zip(m, inverse(d)))
        if eigenvalues(m)[0] <= 0:
            return True
        d = m
    return False


def test_no_orbit_through_a_proved_prism_minimizes(proofs):
    """At random points of proved prisms the true second variation is not positive definite."""
    rng = rng_for("criterion")
    with mpmath.workdps(120):           # the orbits are unstable
        for proof in proofs.values():
            proved = [leaf for leaf in leaves(proof.problem, proof.tree) if leaf[0] == "P"]
            for _ in range(100 * TORTURE):
                _, centre, half, _ = rng.choice(proved)
                v = [mp(uniform(rng, c - h, c + h)) * mpmath.pi for c, h in zip(centre, half)]
                p = [mp(uniform(rng, c - h, c + h))
                     for c, h in zip(proof.problem.centre[:3], proof.problem.half[:3])]
                x0 = tuple(mp(Fraction(x)) for x in proof.xstar)
                assert second_variation_fails(*p, x0, tuple(v))


@pytest.mark.parametrize("stubborn", [False, True])
@pytest.mark.parametrize("digits", [1, 2, 3, 10, 35])
@pytest.mark.parametrize("a, b, c", [
    (("0", "0"), ("0", "0"), ("0", "0")),
    (("0.001", "0.0005"), ("0.001", "0.0005"), ("0.002", "0.001")),     # epsilon 0.0001
    (("0.112", "0"), ("0.112", "0"), ("0.224", "0")),                   # epsilon 0.01
    (("0.15", "0.15"), ("0.15", "0.15"), ("0.3", "0.3")),               # down to zero
    (("0.5", "0.01"), ("0", "0"), ("0", "0")),      # the standard map at k = 0.5, far below
    (("0.9", "0.01"), ("0", "0"), ("0", "0")),      # its last circle at 0.9716
    (("-0.1", "0.01"), ("0.1", "0.01"), ("0.05", "0")),
])
def test_tori_that_exist_are_not_denied(a, b, c, digits, stubborn):
    for depth in (0, 5) if stubborn else (0, 1, 8, 30):
        proof = converse.prove(problem(a, b, c), depth=depth, digits=digits, stubborn=stubborn)
        assert not proof.no_tori
        assert proof.counts.undecided > 0


@pytest.mark.parametrize("digits", [1, 2, 3, 4, 5, 6, 8, 10, 15])
def test_few_digits_lose_the_proof_but_not_the_truth(root, digits):
    """With too few digits the answer is undecided, never a crash; if proved, the same theorem."""
    proof = converse.prove(converse.read_input(root / "inputs" / "trig274.in"), digits=digits)
    assert proof.no_tori == (proof.counts.undecided == 0)
    if digits >= 6:
        assert proof.no_tori


def test_only_symmetric_problems_skip():
    assert converse.prove(line("0.0275", "0.0005"), method="thesis").counts.symmetric > 0
    for b, c, v in ((("0.3085", "0.0004"), ("0.617", "0"), FULL),
                    (("0.3086", "0.0005"), ("0.617", "0"), FULL),
                    (("0.3085", "0.0005"), ("0.617", "0"), (("1", "1"), ("1", "1.0001")))):
        proof = converse.prove(problem(("0.3085", "0.0005"), b, c, v), method="thesis")
        assert proof.counts.symmetric == 0
        assert proof.no_tori


def test_single_parameter_values():
    """Half-widths of zero: nothing divides by them."""
    assert converse.prove(line("0.0275"), method="thesis").no_tori


@pytest.mark.parametrize("v", [(("1", "0"), ("1", "1")), (("0.25", "0"), ("0.75", "0")),
                               (("0", "0"), ("0", "0"))])
def test_regions_without_width(v):
    """A line or a point of successors is a legal region; it is not the torus."""
    proof = converse.prove(problem(("0.3085", "0"), ("0.3085", "0"), ("0.617", "0"), v),
                           method="thesis")
    assert not proof.problem.full_torus
    assert proof.counts.undecided == 0


@pytest.mark.parametrize("a, b, c", [
    (("1e6", "0"), ("1e6", "0"), ("2e6", "0")),
    (("1000", "1"), ("-500", "1"), ("200", "1")),
    (("1e30", "0"), ("1", "0"), ("1", "0")),
])
def test_huge_parameters(a, b, c):
    """Far beyond the frontier: a theorem at once, and no overflow on the way."""
    assert converse.prove(problem(a, b, c), depth=12, method="thesis").no_tori


def test_two_threads_do_not_meet(root):
    """Nothing in the core is global."""
    names = ["trig272", "trig274", "trig276", "trig272"]
    problems = [converse.read_input(root / "inputs" / (n + ".in")) for n in names]
    alone = [converse.prove(p, digits=d).tree for p, d in zip(problems, (20, 35, 50, 60))]
    found = [None] * 4

    def run(i, digits):
        found[i] = converse.prove(problems[i], digits=digits).tree

    threads = [Thread(target=run, args=x) for x in enumerate((20, 35, 50, 60))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == alone


def test_no_symmetry_where_the_start_is_off_the_diagonal():
    """A starting point of one's own (from a backup) may lie anywhere; then nothing is skipped."""
    from converse.prover.native import Task, grow

    for xstar, skips in ((("0.82", "0.82"), True), (("0.82", "0.83"), False)):
        counts = grow(Task(line("0.0275"), Settings("thesis", digits=20), xstar)).counts
        assert counts.proved > 0 and (counts.symmetric > 0) == skips


# ---- what may be asked of a search in C, in which order

SETTINGS = Settings("thesis", depth=30)


def core_search(xstar=None, depth=30, **settings):
    from converse.prover.native import Search, Task

    search = Search(Task(line("0.0275"), Settings("thesis", depth=depth, **settings), xstar))
    assert search.work(0, bool)
    return search


def test_a_tree_that_is_taken_up():
    """A whole tree leaves nothing to do, and a wrong one is refused."""
    from converse.prover.native import WrongTree
    from converse.prover.shared import take_up

    search = core_search()
    for text, pending in (("P", 0), ("0PU", 0), ("0aP", 0), ("0SP", -1), ("0P", 1), ("0??", 2),
                          ("PP", -1), ("2PP", -1), ("X", -1), ("0P\0", -1), ("0P\u00e9", -1),
                          ("0P?\U0001d7d8", -1), ("0" * 30 + "P", 30), ("0" * 31 + "P", -1)):
        if pending < 0:
            with pytest.raises(WrongTree):
                take_up(search, 30, text, [])
        else:
            take_up(search, 30, text, [])
            view = search.view(True)
            assert view.text == text.rstrip("?") and len(view.cells) == pending
            assert view.finished == (pending == 0)
            assert search.work(1, bool, 100 if pending < 30 else 1)


@pytest.mark.parametrize("xstar, good", [(("0.82", "0.82"), True), (("0.82", "0.83"), False)])
def test_what_was_skipped_must_be_symmetric(xstar, good):
    from converse.prover.native import WrongTree
    from converse.prover.shared import take_up

    search = core_search(xstar)
    with contextlib.nullcontext() if good else pytest.raises(WrongTree):
        take_up(search, 30, "01?S?", [])
    for text in "01?SS", "0S?", "1S?":
        with pytest.raises(WrongTree):
            take_up(search, 30, text, [])


def test_the_finest_index():
    """A cell whose index has no bit left is not cut, whatever the depth."""
    search = core_search(depth=1000, digits=60, stubborn=True)
    for cuts, text in ((60, "0"), (61, "U")):
        cell = ((2 ** cuts // 3, 2 ** cuts // 5, 0, 0, 0), (cuts, cuts, 0, 0, 0), 0)
        grown = search.grow([cell], 1)
        assert grown.text.startswith(text) or grown.text == "P"
        assert all(max(cuts) <= 61 for _, cuts, _ in grown.cells)


@pytest.mark.parametrize("threads", [1, pytest.param(3, marks=pytest.mark.slow)])
def test_stopped_in_the_middle_of_a_prism(threads):
    """The prisms at hand are forgotten, with their statistics; then the search goes on as if
    nothing had been."""
    for digits in 3000, 12000, 48000, 192000:       # where the stop is late a prism takes longer
        search, seen, stops, delay = core_search(digits=digits), "", 0, 0.002
        whole = core_search(digits=digits).grow(leaves=12)
        while sum(map(seen.count, "PSU")) < 12:
            end = time.monotonic() + delay
            search.work(threads, lambda: time.monotonic() > end, 12 - sum(map(seen.count, "PSU")))
            text = search.view(True).text
            assert text.startswith(seen)
            stops += text == seen
            seen, delay = text, 1.1 * delay
        assert (seen, search.view().counts) == (whole.text, whole.counts)
        if stops > 0:
            break
    assert stops > 0


def test_a_search_whose_setting_up_was_stopped_is_good_for_nothing():
    from converse.prover.native import Search, Task, ffi, lib

    search = Search(Task(line("0.0275"), Settings("thesis", digits=100000)))
    assert not search.work(0, lambda: True)
    assert lib.cv_restart(search.handle, b"", ffi.NULL) == lib.CV_EARGUMENT
    assert lib.cv_begin(search.handle, 1, 1.0) == lib.cv_work(search.handle) == lib.CV_EARGUMENT


@pytest.mark.slow
def test_a_locale_with_a_comma(tmp_path):
    """As a graphical toolkit may set it; the test makes one, since few machines have it."""
    if not shutil.which("localedef"):
        pytest.skip("needs localedef")
    made = subprocess.run(["localedef", "-i", "de_DE", "-f", "UTF-8",
                           str(tmp_path / "de_DE.UTF-8")],
                          capture_output=True, check=False)
    code = ("import locale; locale.setlocale(locale.LC_ALL, 'de_DE.UTF-8'); import converse; "
            "assert locale.localeconv()['decimal_point'] == ','; "
            "p = converse.MuldoonMap('0.32', '0.32', '0.64'); "
            "assert converse.prove(p) and converse.prove(p, method='loewner')")
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True,
                            env=dict(os.environ, LOCPATH=str(tmp_path)), cwd=tmp_path)
    if "unsupported locale" in result.stderr:
        pytest.skip("no such locale can be made here: " + made.stderr.decode()[:60])
    assert result.returncode == 0, result.stderr
