"""What inputs and pages claim in terms of epsilon, or of k, follows from the numbers exactly."""

import re
from fractions import Fraction

import chart
import mpmath
import pytest
from conftest import ROOT

from converse import prove, read_input
from converse.model.map import LINE

INPUTS = sorted((ROOT / "inputs").glob("*.in"))
THESIS = (ROOT / "docs/1989.md").read_text("utf-8")
LEAST_MULTIPLE = {"a": 1, "b": 1, "c": 2}              # of LINE epsilon


def holds(problem, low, high=None):
    """Do the ranges hold the whole line from epsilon low to high (None: the problem is to hold its
    beginning, and all larger ones follow at once)?"""
    return all(least <= k * LINE * Fraction(low) and most >= k * LINE * Fraction(high or low)
               for (least, most), k in zip(problem.abc, LEAST_MULTIPLE.values()))


@pytest.mark.parametrize("path", INPUTS, ids=lambda path: path.stem)
def test_the_epsilon_of_an_input(path):
    problem = read_input(path)
    claims = [line for line in problem.comments if "eps" in line]
    assert bool(claims) == path.stem.startswith("trig")
    for line in claims:
        one = re.match(r"epsilon = (0\.[0-9]+):", line)
        low, high = one.groups() * 2 if one else re.match(
            r"(0\.[0-9]+) < epsilon < (0\.[0-9]+)(?:,|$)", line).groups()
        assert holds(problem, low, high) and not (one and any(problem.half[:3]))


def test_a_slip_would_be_seen():
    problem = read_input(ROOT / "inputs" / "trig148.in")
    assert holds(problem, "0.0148", "0.0280")
    assert not holds(problem, "0.01479999999", "0.0280") and not holds(problem, "0.0148", "0.02801")


@pytest.mark.parametrize("path", INPUTS, ids=lambda path: path.stem)
def test_the_k_of_an_input(path):
    """Of the standard map: k > 4/3 are all of these, so the range must begin there."""
    problem = read_input(path)
    for sign, least in re.findall("k ([>=]) ([0-9./]+[0-9])", " ".join(problem.comments)):
        assert problem.abc[0][0] <= Fraction(least) <= problem.abc[0][1]
        if sign == ">":                                 # and all larger ones follow at once
            together = problem.tied()
            assert prove(together, method="loewner").at_once


def test_the_bounds_of_the_thesis():
    """epsilon_c <= ...: the input begins there, or below."""
    rows = re.findall(r"^\| epsilon_c <= (0\.[0-9]+)(?: \(1989: 0\.[0-9]+\))? \(`(\w+\.in)`\)",
                      THESIS, re.MULTILINE)
    assert len(rows) == THESIS.count("| epsilon_c <=") == 4
    for epsilon, name in rows:
        assert holds(read_input(ROOT / "inputs" / name), epsilon)


def test_the_boxes_of_the_chart():
    for epsilon, centre in chart.BOXES:
        assert Fraction(centre) - Fraction("0.00125") <= LINE * Fraction(epsilon)


@pytest.mark.parametrize("page", ["docs/1989.md", "docs/proofs/argument.md"])
def test_the_thesis_constant(page):
    """2 pi^2/M, and what 0.0140 is with it."""
    with mpmath.workdps(40):
        M = mpmath.sqrt(207 + 33 * mpmath.sqrt(33)) / (8 * mpmath.sqrt(2))
        constant = 2 * mpmath.pi ** 2 / M
        line = mpmath.mpf(LINE.numerator) / LINE.denominator
        text = " ".join((ROOT / page).read_text("utf-8").split())
        assert "2 pi^2/M = %s..." % str(constant)[:13] in text
        assert "M = sqrt(207 + 33 sqrt 33)/(8 sqrt 2)" in text and "a/%s" % float(LINE) in text
        assert "1 + %s" % mpmath.nstr(line / constant - 1, 2).replace("e-0", "e-") in text
        there = mpmath.mpf("0.0140") * line / constant
        assert mpmath.mpf("0.01400000022") < there < mpmath.mpf("0.01400000023")
        assert "0.0140 here is 0.01400000023 there" in text


def test_the_orbits_have_the_thesis_constant():
    """converse.orbits' trig: a = 2 pi^2 eps/M, within 10^-40."""
    from converse import orbits

    low, high = orbits.trig.scale_enclosure(40)
    with mpmath.workdps(60):
        M = mpmath.sqrt(207 + 33 * mpmath.sqrt(33)) / (8 * mpmath.sqrt(2))
        assert mpmath.mpf(low.numerator) / low.denominator <= 1 / M \
            <= mpmath.mpf(high.numerator) / high.denominator
    assert 0 <= high - low <= Fraction(1, 10 ** 40)
