"""Certificates of existence: the checker verifies what is true, refuses what is not as the format
says, and never confirms what is false."""

import gzip
import math
import random
import re
from fractions import Fraction

import mpmath
import pytest
from files import sealed

from converse import Problem
from converse.check import field, series, tori, torus_file
from converse.model.map import THESIS, SymplecticMap
from converse.tori.proved import prove
from converse.tori.rotation import read_rotation

from checker import check

mp = mpmath.mp.clone()
mp.dps = 40

# The golden circle of the standard map at k = 0.5, V(y) = -0.5 sin y: u_1, u_2, ... times 2^40.
GOLDEN = [
    "-12771844e3 0", "0 29cb34dcc", "1058b2550 0", "0 -15894620", "-22f16c3f 0", "0 3fa1dab",
    "e114ee 0", "0 -31c2fce", "-391931 0", "0 1c0563", "89837 0", "0 -21b0e", "-1045dd 0",
    "0 15c36", "537f 0", "0 -598a", "-84f 0", "0 989", "1fb 0", "0 -136", "-c4d 0", "0 e0",
    "4d 0", "0 -23", "-5 0", "0 f", "2 0", "0 0", "-1 0"]
HEADER = """converse torus 1
program: by hand
dimension: 1
wave: 1 0 0 0.5
polynomial: -1 1 1
root: 0 1
rotation: 0 1
frame: 1
alpha: 1
rho: 0.3
pieces: 1
tori:
piece 0 0 40 0 %d
"""


def modes_text(values):
    return "".join("%d 0 %s\n" % (k, value) for k, value in enumerate(values, 1))


BODY = HEADER % len(GOLDEN) + modes_text(GOLDEN)


def changed(old, new, count=1):
    """The certificate with a change, and the checksum right."""
    assert old in BODY
    return sealed(BODY.replace(old, new, count))


@pytest.fixture(autouse=True)
def quick_steps(monkeypatch):
    """No steps are told, which would depend on the clock."""
    monkeypatch.setattr(check, "QUIET_SECONDS", math.inf)


@pytest.fixture(scope="module", autouse=True)
def looked_once():
    """The small divisors of a rotation once, where several files have it."""
    look, found = field.Divisors._look, {}

    def once(self, radius):
        key = repr((vars(self.field), self.elements, vars(self.norm), self.tail, radius,
                    field.TURN_BITS))
        if key not in found:
            look(self, radius)
            found[key] = self.records, self.radius
        self.records, self.radius = found[key]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(field.Divisors, "_look", once)
        yield


# ---- what is verified

def test_the_golden_circle_is_verified(run):
    status, out, err = run(sealed(BODY))
    assert (status, err) == (0, "")
    assert out.startswith("Verified :\n")
    assert "\nV(y) = -0.5 sin y,\nthat is, J' = J + 0.5 cos y,\n" in out
    assert "omega = t = 0.618033988749..." in out
    assert run(gzip.compress(sealed(BODY).encode()))[:2] == (0, out)


@pytest.mark.slow
@pytest.mark.parametrize("digits", [20, 66, 70])
def test_large_coordinates_of_the_rotation_do_not_make_its_decimals_false(run, digits):
    """They cancel, and with 256 bits of t they would leave few true decimals, or none."""
    with mp.workdps(120):
        t = (mp.sqrt(5) - 1) / 2
        whole = int(mp.floor(10 ** digits * t))
        exact = mp.nstr(10 ** digits * t - whole, 20)[:14]
    text = HEADER.replace("0.5", "0").replace("0 1\nframe", "-%d 1e%d\nframe" % (whole, digits))
    status, out, err = run(sealed(text % 0))
    assert (status, err) == (0, "")
    assert "t = %s..." % exact in out


def test_a_certificate_is_not_verified_if_a_piece_is_not(run, monkeypatch):
    monkeypatch.setattr(tori, "verify_torus", lambda *_: (["Verified :"], ()))
    status, out, err = run(sealed(BODY))
    assert (status, out) == (2, "") and "the checker failed (RuntimeError: 0 of 1 parts" in err


def test_quiet_says_nothing(run, monkeypatch):
    monkeypatch.setattr(check, "QUIET_SECONDS", -1)
    assert run(sealed(BODY), "--quiet") == (0, "", "")


def test_each_step_of_a_long_check_is_told(run, monkeypatch):
    monkeypatch.setattr(check, "QUIET_SECONDS", -1)
    status, _, err = run(sealed(BODY))
    assert status == 0
    constants, residual = err.splitlines()
    assert constants == "converse-check: the constants"
    assert residual.startswith("converse-check: the residual, with ")


@pytest.mark.parametrize("hints", [
    ("rho: 0.3", "rho: 1/10"), ("alpha: 1\nrho: 0.3", "alpha: 7/3\nrho: 0.1"),
    ("frame: 1\nalpha: 1\nrho: 0.3", "frame: -3\nalpha: 1\nrho: 1/9"),
    ("root: 0 1", "root: 0.6 5/8"),
    ("program: by hand", "program:  [2J"), ("pieces: 1", "pieces: 1\ncomment: a\ncomment: b"),
    ("pieces: 1", "hint-grid: 1 2 3\npieces: 1"), ("wave: 1 0 0 0.5", "wave: 1 0 2 1/2"),
    ("wave: 1 0 0 0.5", "wave: -1 0 1 0.5"), ("wave: 1 0 0 0.5", "wave: 1 0 1 -0.5"),
    ("wave: 1 0 0 0.5", "wave: 1 0 0 0.25\nwave: 1 0 0 0.25"),
    ("polynomial: -1 1 1", "polynomial: 7 -7 -7"),
    ("rotation: 0 1", "rotation: 1 1"), ("rotation: 0 1", "rotation: 0 -1"),
    ("root: 0 1", "root: -2 -1"),
    ("wave: 1 0 0 0.5", "wave: 1 0 0 0.5\nwave: 0 1 0 0"),
    ("rotation: 0 1", "rotation: 1 -1")])
def test_hints_and_other_words_change_nothing(run, hints):
    """Hints may be bad; and the same claim may be said in other words."""
    status, out, err = run(changed(*hints))
    assert (status, err) == (0, ""), err


def test_it_is_near_the_torus_of_the_file(run):
    """The distance that is reported is not less than that of a longer series."""
    _, out, _ = run(sealed(BODY))
    distance = float(re.search("within ([0-9.e-]+) of", out).group(1))
    coarse = sealed(HEADER % 14 + modes_text(GOLDEN[:14]))
    status, text, err = run(coarse)
    assert status == 0, err
    lost = 2 * sum(math.hypot(*[int(x, 16) for x in value.split()])
                   for value in GOLDEN[14:]) / 2 ** 40
    assert float(re.search("within ([0-9.e-]+) of", text).group(1)) >= lost / 2
    assert distance < 1e-3


def test_it_is_verified_whole(run):
    status, out, err = run(sealed(BODY), "--sample", "3")
    assert (status, out) == (2, "") and "as a whole" in err


GOLDEN_FILES = {
    "standard-0.9": ["V(y) = -0.9 sin y,", "has an invariant circle"],
    "standard-0.2-0.6": ["has for all -1 <= s <= 1 an", "V(y) = -(0.4 + 0.2 s) sin y,"],
    "standard-0.1-0.75": ["(0.425 + 0.325 s) cos y,", "Pieces : 2\n"],
    "line-0.004": ["Lagrangian graph", " - 0.08971488 sin(y0 + y1),"],
    "phases": [" - 0.02 sin(y1 + 1/8 pi) ", "0.754877666246..."],
}


@pytest.mark.parametrize("name", GOLDEN_FILES)
@pytest.mark.slow
def test_certificates_of_the_program_are_verified(root, run, name):
    data = (root / "golden_outputs" / "tori" / (name + ".torus")).read_bytes()
    status, out, err = run(data)
    assert (status, err) == (0, "")
    assert all(word in out for word in GOLDEN_FILES[name])
    residual, needed = re.search("Residual : (.*), admissible: (.*)", out).groups()
    assert float(residual) <= float(needed) * 1.2


CHANGES_OF_A_RANGE = [
    # wrong bytes
    (1, r"pieces: [0-9]+", "pieces: 2"), (1, r"piece -1 ", "piece -0.9 "),
    (1, r"piece (\S+) 1 ", r"piece \1 0.9 "), (1, r"piece -1 \S+ ", "piece -1 -2 "),
    (1, r"piece -1 (\S+) (.*)\n", r"piece -1 0.99 \2\n"),
    (1, "wave: 1 0 0 0.4 0.2", "wave: 1 0 0 0.4"),
    (1, "wave: 1 0 0 0.4 0.2", "wave: 1 0 0 0.4 0.2 0.1"),
    (1, "wave: 1 0 0 0.4 0.2", "wave: 1 0 0 0.4 0.2 0"),
    # false, or not what the torus is for
    (5, "wave: 1 0 0 0.4 0.2", "wave: 1 0 0 0.4 0.3"),
    (5, "wave: 1 0 0 0.4 0.2", "wave: 1 0 0 0.4 -0.2"),
    (5, "wave: 1 0 0 0.4 0.2", "wave: 1 0 0 0.41 0.2"),
    (5, r"\n1 1 (\S+) (\S+)\n", r"\n1 1 0 0\n"), (5, r"\n1 2 (\S+) (\S+)\n", r"\n1 2 \2 \1\n"),
]


CHANGES_OF_TWO_PIECES = [
    # a gap, an overlap, an order
    (1, r"\npiece 0 1 ", r"\npiece 1/10 1 "), (1, r"\npiece 0 1 ", r"\npiece -1/10 1 "),
    (1, r"\npiece 0 1 ", r"\npiece 0 0 "), (1, r"\npiece 0 1 ", r"\npiece -1 1 "),
    # false in one of them
    (5, r"piece -1 0 (.*(?:\n.*)*\npiece) 0 1 ", r"piece -1 1/2 \1 1/2 1 "),
    (5, r"piece -1 0 (.*(?:\n.*)*\npiece) 0 1 ", r"piece -1 -1/2 \1 -1/2 1 "),
    (5, r"(piece -1 0 .*\n)1 0 (\S+) (\S+)\n", r"\g<1>1 0 \3 \2\n"),
    (5, r"(piece 0 1 .*\n)1 0 (\S+) (\S+)\n", r"\g<1>1 0 \3 \2\n"),
]


def test_the_whole_of_each_piece_is_verified(root):
    """The amplitudes at sigma = -1 and 1 are those at its ends, and u is the file's."""
    claim = check.content(
        (root / "golden_outputs" / "tori" / "standard-0.1-0.75.torus").read_bytes())
    setting = tori.Setting(claim)
    for piece, ends in zip(claim.pieces, (("0.1", "0.425"), ("0.425", "0.75"))):
        torus = tori.Torus(setting, piece, False)
        (_, _, middle, half), = torus.waves
        assert (middle - half, middle + half) == tuple(map(Fraction, ends))
        assert {k: [[re * re + im * im for re, im in vector] for vector in series]
                for k, series in torus.modes.items()} == \
            {k: [[re * re + im * im for re, im in vector] for vector in series]
             for k, series in piece.modes.items()}


CHANGES_OF_A_LINE = [
    (1, "polynomial: -1 -2 1 1", "polynomial: -1 -2 2 1"),
    (1, "polynomial: -1 -2 1 1", "polynomial: 0 -2 1 1"),
    (1, r"rotation: 25/13 -7/13 -8/13", "rotation: -23/13 8/13 11/13"),
    (1, r"rotation: 25/13 -7/13 -8/13", "rotation: -46/13 16/13 22/13"),
    (1, r"rotation: 25/13 -7/13 -8/13", "rotation: 1/3 0 0"), (1, "dimension: 2", "dimension: 1"),
    (5, "wave: 1 0 0 ", "wave: 2 0 0 "),
    (1, r"rotation: 25/13", "rotation: 25/0"),
    (5, "wave: 1 1 0 0.08971488", "wave: 1 1 0 0.0897"),
    (5, r"\n1 0 0 (\S+) (\S+) (\S+) (\S+)\n", r"\n1 0 0 \3 \4 \1 \2\n"),
    (1, r"\n1 0 0 (\S+) (\S+) (\S+) (\S+)\n", r"\n1 0 0 \1 \2\n"),
    (1, r"\n1 0 0 (\S+)", r"\n-1 0 0 \1"), (1, r"\n1 0 0 (\S+)", r"\n0 0 0 \1"),
    (1, r"frame: .*", "frame: 1 1 2 2"), (1, r"frame: .*", "frame: 0 1 0 1"),
    (1, r"alpha: .*", "alpha: 1 -1"), (1, r"alpha: .*", "alpha: 0 1"),
    (1, r"wave: 0 1 .*\nwave: 1 1 .*\n", ""),
]


TABLES = {"standard-0.2-0.6": CHANGES_OF_A_RANGE, "standard-0.1-0.75": CHANGES_OF_TWO_PIECES,
          "line-0.004": CHANGES_OF_A_LINE}


@pytest.mark.parametrize("name, expected, pattern, new", [
    pytest.param(name, *row, marks=[pytest.mark.slow] * (name != "standard-0.2-0.6"))
    for name, rows in TABLES.items() for row in rows])
def test_certificates_that_are_changed(root, run, name, expected, pattern, new):
    text = (root / "golden_outputs" / "tori" / (name + ".torus")).read_text()
    other = re.sub(pattern, new, text, count=1)
    assert other != text
    status, out, err = run(sealed(other))
    assert (status, out) == (expected, "") and err.count("\n") == 1, (status, out, err)
    if name == "standard-0.1-0.75":
        assert ("not confirmed: piece " if status == 5 else "rejected: line ") in err


# ---- what is refused

FIRST = "1 0 " + GOLDEN[0]
SECOND = "2 0 " + GOLDEN[1]
BAD_TEXT = [            # what makes another claim, or none; test_fuzz.py has what is no word of it
    ("dimension: 1", "dimension: 3"), ("dimension: 1", "dimension: 2"), ("dimension: 1\n", ""),
    ("dimension: 1", "dimension: 1\ndimension: 1"), ("program: by hand", "author: me"),
    ("wave: 1 0 0 0.5\n", ""), ("wave: 1 0 0 0.5", "wave: 0 0 0 0.5"),
    ("wave: 1 0 0 0.5", "wave: 1 1 0 0.5"), ("wave: 1 0 0 0.5", "wave: 1 0 0 0.5 0 0"),
    ("wave: 1 0 0 0.5", "wave: 1 0 0 \u0660.5"), ("wave: 1 0 0 0.5", "wave: 2 0 0 0.5"),
    ("wave: 1 0 0 0.5", "wave: 1 0 0 0.5\nwave: 2 0 0 1 1"),
    ("polynomial: -1 1 1", "polynomial: -1 0 1"), ("polynomial: -1 1 1", "polynomial: 1 2 1"),
    ("polynomial: -1 1 1", "polynomial: -1 1 0"), ("polynomial: -1 1 1", "polynomial: 1 0 1"),
    ("polynomial: -1 1 1", "polynomial: -1 1 1 1"),
    ("root: 0 1", "root: 1 0"), ("root: 0 1", "root: -2 1"), ("root: 0 1", "root: 1 2"),
    ("root: 0 1", "root: 1/2 1/2"), ("rotation: 0 1", "rotation: 1/2 0"),
    ("rotation: 0 1", "rotation: 0 1\nrotation: 1 1"), ("rotation: 0 1\n", ""),
    ("frame: 1", "frame: 0"), ("frame: 1", "frame: 1 0 0 1"), ("alpha: 1", "alpha: 0"),
    ("alpha: 1", "alpha: -1"), ("rho: 0.3", "rho: 0.3 0.3"), ("rho: 0.3", "rho: 0"),
    ("pieces: 1", "pieces: 0"), ("pieces: 1", "pieces: 2"), ("piece 0 0", "piece -1 1"),
    ("piece 0 0", "piece 0 1"), ("piece 0 0 40 0", "piece 0 0 40 1"),
    (" 40 0 %d\n" % len(GOLDEN), " 40 0 %d\n" % (len(GOLDEN) - 1)),
    (" 40 0 %d\n" % len(GOLDEN), " 40 0 %d\n" % (len(GOLDEN) + 1)),
    (FIRST, FIRST + "\n" + FIRST), (FIRST, "0 0 0 0"), (FIRST, "1 1 " + GOLDEN[0]), (FIRST, ""),
    (SECOND, "1 0 " + GOLDEN[1]), (FIRST, "-" + FIRST),
]
# True or false, it is more than the checker undertakes.
TOO_MUCH = [
    ("piece 0 0 40", "piece 0 0 99999999"), (" 40 0 %d\n" % len(GOLDEN), " 40 0 99999999\n"),
    ("pieces: 1", "pieces: 99999"), (FIRST, "99999999 0 1 0"), (FIRST, "1 0 %s 0" % ("f" * 3000)),
    (FIRST, "1 0 %s 0" % ("f" * 400)), ("polynomial: -1 1 1", "polynomial: -1 1 1" + "0" * 80),
    ("rho: 0.3", "rho: " + "1" * 3001), ("rho: 0.3", "rho: 7"), ("rho: 0.3", "rho: 1e299"),
    ("rho: 0.3", "rho: 1e-300"), ("rho: 0.3", "rho: 5"), ("alpha: 1", "alpha: 1e9"),
    ("frame: 1", "frame: 1000"),
    ("wave: 1 0 0 0.5", "wave: 1 0 0 1e301"), ("rotation: 0 1", "rotation: 0 1e300"),
    ("rotation: 0 1", "rotation: 0 1/%d" % 10 ** 300),
]


@pytest.mark.parametrize("change, expected, word", [
    *[(change, 1, "rejected: ") for change in BAD_TEXT],
    *[pytest.param(change, 5, "not confirmed: ", marks=pytest.mark.slow) for change in TOO_MUCH]])
def test_what_is_wrong_or_too_much_is_refused(run, change, expected, word):
    status, out, err = run(changed(*change))
    assert (status, out) == (expected, "") and err.startswith("converse-check: FILE: " + word), err
    assert err.count("\n") == 1 and "Error" not in err


RANGE = [("wave: 1 0 0 0.5", "wave: 1 0 0 0.5 0"), ("piece 0 0 40 0", "piece -1 1 40 100")]
# A few hundred bytes that would take gigabytes or hours.
HEAVY = {
    "large weights": [("alpha: 1", "alpha: 99999/1000")],
    "large weights of powers": [("alpha: 1\nrho: 0.3", "alpha: 50001/1000\nrho: 1/100"), *RANGE],
    "a fast wave": [("wave: 1 0 0 0.5", "wave: 1 0 0 0.5\nwave: 100 0 0 1e-300"),
                    ("alpha: 1", "alpha: 99999/1000")],
}


@pytest.mark.parametrize("name", HEAVY)
@pytest.mark.slow
def test_small_files_of_much_work_are_not_confirmed(run, name):
    text = BODY
    for old, new in HEAVY[name]:
        assert old in text
        text = text.replace(old, new, 1)
    status, out, err = run(sealed(text))
    assert (status, out) == (5, "") and "the checker's limit" in err, err


def test_a_far_mode_needs_too_large_a_grid(run, monkeypatch):
    monkeypatch.setattr(tori, "MAX_GRID", 1 << 12)
    text = BODY.replace("rho: 0.3", "rho: 1/1000").replace(
        " 40 0 %d\n" % len(GOLDEN), " 40 0 %d\n4181 0 200000 0\n" % (len(GOLDEN) + 1))
    status, out, err = run(sealed(text))
    assert (status, out) == (5, "") and "points is needed, the checker's limit" in err, err


def test_coefficients_that_are_not_given_count(run, monkeypatch):
    """Each k of a piece takes the space of all powers of s."""
    monkeypatch.setattr(torus_file, "MAX_MODES", 100 * len(GOLDEN))
    text = BODY
    for old, new in RANGE:
        text = text.replace(old, new, 1)
    status, out, err = run(sealed(text))
    assert (status, out) == (5, "") and "coefficients, the checker's limit" in err, err


@pytest.mark.parametrize("change", [
    (" 40 0 %d\n" % len(GOLDEN), " 40 0 %d\n100000 0 0 0\n" % (len(GOLDEN) + 1)),
    ("rotation: 0 1", "rotation: 1%s 1" % ("0" * 299))])
def test_modes_of_zero_and_whole_turns_change_nothing(run, change):
    status, out, err = run(changed(*change))
    assert (status, err) == (0, ""), err


def test_a_wave_may_be_fast(run):
    text = (HEADER % 0).replace("alpha: 1\nrho: 0.3", "alpha: 10\nrho: 0.1").replace(
        "wave: 1 0 0 0.5", "wave: 1 0 0 1e-300\nwave: 100 0 0 1e-300")
    status, out, err = run(sealed(text))
    assert (status, err) == (0, ""), err


def test_the_facts_of_a_check_are_values(tmp_path):
    """Of each piece; and what is not accurate enough tells by how much."""
    path = tmp_path / "some.torus"
    path.write_text(sealed(BODY))
    result = check.verify(path)
    fact, = result.facts
    assert 0 < fact.residual <= fact.needed and 0 < fact.distance < 1e-4
    assert tori.scientific(fact.distance) in result.text and abs(fact.rho - 0.3) < 1e-6
    assert "Residual : %s, admissible: " % tori.scientific(fact.residual) in result.text
    assert fact.modes > len(GOLDEN) and fact.bits > 20 and 1.82 < fact.gamma < 1.8641
    assert 1 < fact.constants.l < 10
    path.write_text(changed("wave: 1 0 0 0.5", "wave: 1 0 0 0.5005"))
    with pytest.raises(check.NotConfirmed) as caught:
        check.verify(path)
    assert caught.value.residual > caught.value.needed > 0


@pytest.mark.slow
def test_pieces_are_verified_by_processes(root, tmp_path):
    """The same is said, and what fails in one of them is told with its name."""
    path = root / "golden_outputs" / "tori" / "standard-0.1-0.75.torus"
    assert check.verify(path, jobs=2) == check.verify(path)
    text = path.read_text()
    (tmp_path / "wrong").write_text(sealed(text[:text.rindex("checksum")].replace(
        "0.425 0.325", "0.425 0.326")))
    with pytest.raises(check.NotConfirmed, match="^piece 1 of 2: the error") as caught:
        check.verify(tmp_path / "wrong", jobs=2)
    assert caught.value.residual > caught.value.needed > 0


# ---- the field and the divisors

T49 = (-1, -2, 1, 1)
X0 = tuple(Fraction(x, 13) for x in (-23, 8, 11))
X1 = tuple(Fraction(x, 13) for x in (25, -7, -8))


def test_irreducible_polynomials():
    for polynomial in ((-1, 1, 1), (-1, -2, 1, 1), (-1, -1, 0, 1), (1, 0, 1), (-2, 0, 0, 1)):
        assert field.is_irreducible(polynomial)
    for polynomial in ((-1, 0, 1), (0, 0, 1), (-6, 11, -6, 1), (1, 0, 0, 1), (0, 1, 1, 1),
                       (3, 8, 4), (1, 3, 3, 2)):        # (2t + 1)(2t + 3), (2t + 1)(t^2 + t + 1)
        assert not field.is_irreducible(polynomial)


def test_roots_are_counted():
    assert field.roots_between((-6, 11, -6, 1), Fraction(1, 2), Fraction(7, 2)) == 3
    assert field.roots_between((-6, 11, -6, 1), Fraction(3, 2), Fraction(5, 2)) == 1
    assert field.roots_between((-1, -1, 0, 1), Fraction(-9), Fraction(9)) == 1
    assert field.roots_between((-2, 0, 1), Fraction(-9), Fraction(0)) == 1


def divisors_of(polynomial, root, omega, frame, alpha, basis, *_):
    return field.Divisors(field.Field(polynomial, *map(Fraction, root)),
                          [tuple(map(Fraction, x)) for x in omega],
                          field.Norm(frame, alpha, basis))


def sizes_of(found, far):
    """(|k|, |1 - e^(2 pi i k.omega)|) of all k != 0 with components up to far, but for signs."""
    w = [float(found.field.interval(x)[0]) for x in found.elements]
    n = len(w)
    return [(found.norm(field.combination(m, found.norm.basis)),
             abs(2 * math.sin(math.pi * sum(x * y for x, y in zip(m, w)))))
            for m in [(a, b)[:n] for a in range(far) for b in range(-far, far + 1)] if any(m)]


VECTORS = {
    "golden": ((-1, 1, 1), (0, 1), [(0, 1)], [[1]], [1], [(1,)], 0.44721, 1.86406),
    "silver": ((-1, 2, 1), (0, 1), [(0, 1)], [[1]], [1], [(1,)], 0.35355, 1.92781),
    "T49": (T49, (1, 2), [X0, X1], [[1, 1], [1, -1]], [1, 3], [(1, 0), (0, 1)], 0.67334, 4.23071),
    "spiral": ((-1, -1, 0, 1), (1, 2), [(-1, 1, 0), (-1, 0, 1)], [[1, 0], [0, 1]], [1, 1],
               [(1, 0), (0, 1)], 0.23449, 1.39238),
}


@pytest.mark.parametrize("name", VECTORS)
@pytest.mark.slow
def test_small_divisors_are_bounded(name):
    """By nearly the best constants; and each divisor, computed to forty digits, obeys."""
    polynomial, root, omega, *_, gamma, least = VECTORS[name]
    found, omega = divisors_of(*VECTORS[name]), [tuple(map(Fraction, x)) for x in omega]
    n = len(omega)
    assert 0.98 * gamma < found.tail / (2 * math.pi) <= gamma * 1.00001
    assert 0.95 * least < found.least <= least * 1.00001
    t = mp.findroot(lambda x: sum(c * x ** j for j, c in enumerate(polynomial)),
                    (mp.mpf(root[0]) + root[1]) / 2)
    w = [sum(mp.mpf(c.numerator) / c.denominator * t ** j for j, c in enumerate(x)) for x in omega]
    for delta in (Fraction(1), Fraction(1, 10), Fraction(1, 50)):
        worst = 0
        for k in [(a, b)[:n] for a in range(40) for b in (range(-40, 41) if n == 2 else [0])]:
            if any(k):
                divisor = abs(1 - mp.expjpi(2 * sum(x * y for x, y in zip(k, w))))
                assert divisor * found.norm(k) ** n >= found.least
                for d in (delta, delta / 3):
                    worst = max(worst, (d / delta) ** n * mp.exp(-d * found.norm(k)) / divisor)
        assert worst <= found.loss(delta)


@pytest.mark.parametrize("bits", [0, 1, 5, 40, 300])
@pytest.mark.slow
def test_roots_are_enclosed(bits):
    """Also if another root is near; and multiples are what they say they are."""
    near = 49, -200, 200
    for polynomial, low, high in (((-1, 1, 1), 0, 1), (T49, 1, 2), (T49, -1, 0), (T49, -2, -1),
                                  (near, "0.49", "0.6"), (near, "1/3", "0.49")):
        one = field.Field(polynomial, Fraction(low), Fraction(high))
        a, b = one.root(bits)
        assert (b - a) * 2 ** bits == 1 or bits < 2
        inside = max(a, Fraction(low)), min(b, Fraction(high))
        assert field.evaluate(polynomial, inside[0]) * field.evaluate(polynomial, inside[1]) < 0
        for element in ((0, 1), (Fraction(1, 3), -10 ** 20), (10 ** 30, 7 * 10 ** 40)):
            with mp.workdps(200):
                t = mp.findroot(lambda x: sum(c * x ** j for j, c in enumerate(polynomial)),
                                sum(float(x) for x in one.root(60)) / 2)
                exact = 2 ** bits * sum(mp.mpf(Fraction(x).numerator) / Fraction(x).denominator
                                        * t ** j for j, x in enumerate(element))
                found = one.in_units(tuple(map(Fraction, element)) + (Fraction(0),) * (
                    one.degree - 2), bits)
                assert abs(found - exact) < 0.75


def test_a_wide_enclosure_is_within_three_quarters():
    """Its low end is just below an integer, and the element nearly half a unit above that end."""
    one = field.Field((-1, 1, 1), Fraction(0), Fraction(1))
    factor, errors = Fraction(31, 16) * 2 ** 62, []
    for bits in range(32):
        low = one.interval((Fraction(0), factor), bits + 64)[0] * 2 ** bits
        rest = (math.floor(low) - low - Fraction(1, 1 << 20)) / 2 ** bits
        found = one.in_units((rest, factor), bits)
        exact = one.interval((rest, factor), 400)[0] * 2 ** bits
        errors.append(abs(found - exact))
    assert max(errors) <= Fraction(3, 4)


@pytest.mark.slow
def test_decimals_that_cannot_be_told_are_not_printed():
    one = field.Field((-1, 1, 1), Fraction(0), Fraction(1))
    assert one.truncated((Fraction(0), Fraction(-1)), 3) == Fraction(-618, 1000)
    with pytest.raises(check.NotConfirmed, match="too large coefficients"):
        one.truncated((Fraction(0), Fraction(10 ** 2500)), 12)


def test_norms_have_the_common_denominator():
    """Of the norms of p + m_0 x_0 + m_1 x_1: it makes them integers."""
    one = field.Field(T49, Fraction(1), Fraction(2))
    elements = [tuple(map(Fraction, x)) for x in (("1/2", "1/2", 0), (0, 0, "1/3"))]
    roots = [2 * mp.cos(2 * mp.pi * n / 7) for n in (1, 2, 3)]
    found = one.norm_denominator(elements)
    for p in range(-2, 3):
        for m in [(a, b) for a in range(-3, 4) for b in range(-3, 4)]:
            x = [p + m[0] / mp.mpf(2) * (1 + t) + m[1] / mp.mpf(3) * t ** 2 for t in roots]
            number = found * x[0] * x[1] * x[2]
            assert abs(number - mp.nint(number)) < 1e-20
    assert found == 216
    assert one.norm_denominator([X0, X1]) == 13


SPIRAL, SEVEN = VECTORS["spiral"][2], ((-1, 1, 0), (-1, 0, 1))


@pytest.mark.parametrize("polynomial, omega, frame, alpha", [
    (T49, (X0, X1), [[1, 1], [1, -1]], [1, 3]), (T49, (X0, X1), [[1, 0], [0, 1]], [1, 1]),
    ((-1, -1, 0, 1), SPIRAL, [[1, 2], [0, 1]], [3, 2]),
    ((-1, -1, 0, 1), SPIRAL, [[1, 0], [0, 1]], [1, 1]),
    # the largest value is within an edge, of both in turn
    (T49, SEVEN, [[1, 1], [1, -1]], [2, 1]), (T49, SEVEN, [[1, 1], [0, 1]], [2, 1])])
@pytest.mark.slow
def test_forms_on_the_unit_ball_are_bounded(polynomial, omega, frame, alpha):
    """Q and mu of (27) in existence.md, by values along the edges; and what follows from them."""
    omega = [tuple(map(Fraction, x)) for x in omega]
    found = divisors_of(polynomial, (1, 2), omega, frame, alpha, [(1, 0), (0, 1)])
    corners = [found.norm.coordinates(v) for v in found.norm.vertices]
    t = mp.findroot(lambda x: sum(c * x ** j for j, c in enumerate(polynomial)), 1.3)
    half, product = -(polynomial[2] + t) / 2, t * (polynomial[2] + t) + polynomial[1]
    others = [half + sign * mp.sqrt(half ** 2 - product) for sign in (1, -1)]
    w = [[sum(mp.mpf(c.numerator) / c.denominator * x ** j for j, c in enumerate(element))
          for element in omega] for x in (t, *others)]
    largest = spread = mp.mpf(0)
    v, u = [[mp.mpf(x.numerator) / x.denominator for x in corner]
            for corner in found.norm.vertices]
    for sign in (1, -1):
        for n in range(501):
            k = [x * n / 500 + sign * y * (500 - n) / 500 for x, y in zip(v, u)]
            sizes = [abs(sum(x * (a - b) for x, a, b in zip(k, other, w[0]))) for other in w[1:]]
            largest, spread = max(largest, sizes[0] * sizes[1]), max(spread, sum(sizes))
    bound = [mp.mpf(x.numerator) / x.denominator for x in (
        f(found.field, found.elements, corners) for f in (
            found._largest_form, found._conjugates))]
    assert largest * (1 - 1e-30) <= bound[0] <= 1.001 * largest
    assert spread <= bound[1] <= 100 * spread
    g = 1 / (found.field.norm_denominator(found.elements) * largest)
    K, D = found.radius, found.field.norm_denominator(found.elements)
    gamma = 1 / D / (largest + g * spread / K ** 3 + g ** 2 / K ** 6)
    assert float(found.tail) <= 2 * mp.pi * gamma * (1 - (mp.pi * gamma / K ** 2) ** 2 / 6)
    for k in [(a, b) for a in range(-9, 10) for b in range(-9, 10)]:
        assert math.hypot(*k) <= float(found.norm.kappa * found.norm(k)) * (1 + 1e-12)
    assert any(math.hypot(*map(float, v)) > float(found.norm.kappa) * (1 - 1e-12)
               for v in found.norm.vertices)


@pytest.mark.parametrize("name, root", [("golden", 5), ("silver", 8)])
def test_the_divisors_far_out_are_those_of_the_page(name, root):
    """(27) and (28) of existence.md with n = 1, Q the difference of the two roots."""
    found = divisors_of(*VECTORS[name])
    Q, K = mp.sqrt(root), found.radius
    gamma = 1 / (Q + 1 / Q / K ** 2)
    exact = 2 * mp.pi * gamma * (1 - (mp.pi * gamma / K) ** 2 / 6)
    assert exact * (1 - 1e-9) <= mp.mpf(found.tail.numerator) / found.tail.denominator <= exact


@pytest.mark.parametrize("name", ["golden", "T49"])
def test_few_bits_of_a_turn_give_smaller_divisors(name, monkeypatch):
    """What k.omega is off by is taken off."""
    monkeypatch.setattr(field, "TURN_BITS", 24)
    found = divisors_of(*VECTORS[name])
    sizes = sizes_of(found, 30)
    assert len(found.records) > 3
    for length, bound in found.records:
        assert bound <= min(size for far, size in sizes if far <= length)


@pytest.mark.parametrize("name", ["golden", "silver", "spiral"])
def test_losses_are_those_of_all_narrower_strips(name):
    found = divisors_of(*VECTORS[name])
    n, sizes = found.power, sizes_of(found, 12)
    for delta in (Fraction(1, 4), Fraction(3), Fraction(10)):
        widths = [float(delta) * 0.97 ** j for j in range(150)]
        worst = max((d / float(delta)) ** n * math.exp(-d * length) / size
                    for length, size in sizes for d in widths)
        assert worst <= found.loss(delta) <= 3 * worst


# ---- series

def random_entry(rng, ring, is_real, scale):
    step, found = ring.box.degree + 1, []
    for _ in range(1 if is_real else 2):
        found.append([int(rng.uniform(-1, 1) * scale * ring.one * 0.3 ** (length + at))
                      for length in ring.box.lengths for at in range(step)])
    return tuple(found) if not is_real else (found[0], None)


FRAMES = {"one": ([[1]], (1,), [(1,)]), "two": ([[1, 1], [1, -1]], (1, 3), [(1, 0), (0, 1)]),
          "skew": ([[1, 2], [0, 1]], (3, 2), [(1, 0), (0, 1)]),
          "part": ([[1, 1], [1, -1]], (2, 5), [(1, 1), (2, 0)])}


def test_a_range_of_many_powers_has_as_many_terms_as_coefficients():
    """A piece of the golden circles of 0 <= k <= 0.971 needs these modes and powers."""
    assert series.Box(field.Norm([[1]], (1,), [(1,)]), 31475, 23).count == 62951 * 24


@pytest.mark.parametrize("name", FRAMES)
def test_modes_have_places_of_their_own(name, monkeypatch):
    """In hardly more space than there are modes; and a choice that will not do is not taken."""
    for limit, degree in ((6, 0), (30, 0), (61, 1)):
        box = series.Box(field.Norm(*FRAMES[name]), limit, degree)
        size, powers, turns = box.places
        assert len(set(powers)) == box.count and max(powers) < size and min(powers) >= 0
        at = {m: power + size * turn for m, power, turn in zip(
            box.modes(), powers[::degree + 1], turns[::degree + 1])}
        zero = at[(0,) * box.norm.dimension]
        steps = [at[m] - zero for m in ((1, 0), (0, 1)) if m in at]
        if len(steps) == 2:
            assert all(x - zero == a * steps[0] + b * steps[1] for (a, b), x in at.items())
        assert limit < 30 or size <= 1.1 * box.count
        other = series.Box(box.norm, limit, degree)
        periods = [(box.groups - 1, 1), *other._periods()]
        monkeypatch.setattr(series.Box, "_periods", lambda _, periods=periods: iter(periods))
        assert other.places == box.places
        monkeypatch.undo()


@pytest.mark.parametrize("name", FRAMES)
def test_modes_outside_of_the_lattice_are_found(name):
    norm, found = field.Norm(*FRAMES[name]), 0
    for k in [(a, b)[:norm.dimension] for a in range(-5, 6) for b in range(-5, 6)]:
        exact = norm.coordinates(k)
        place = norm.place(k)
        found += place is None
        assert place == (None if any(x.denominator > 1 for x in exact) else exact)
    assert bool(found) == (name == "part")


# ---- the theorem

def conditions(c, waves, rho, kappa, divisors, steps, share, change, e):
    """The left sides of (16), of (17) and (18) divided by t, and (18), of existence.md."""
    n, (l0, m0, a0, b0, p0) = divisors.power, map(mp.mpf, map(float, (c.l, c.m, c.a, c.b, c.p)))
    rho, kappa, share, e = [mp.mpf(float(x)) for x in (rho, kappa, share, e)]
    t = float(change) / (l0 * m0 * a0)
    sigma = (2 * l0 + t) * t
    assert max(m0 * t, a0 * sigma) < 1
    l, m, a = l0 + t, m0 / (1 - m0 * t), a0 / (1 - a0 * sigma)
    da = a * a0 * sigma
    assert b0 * da < 1
    h = 1 + b0 / (1 - b0 * da) * (p0 + da)
    third = sum([float(p) * float(k) ** 3 * float(g) * mp.exp(float(k) * t) for p, k, g in waves])
    moved = sloped = mp.mpf(0)
    for i in range(steps + 1):
        delta = rho * 99 / 100 / (4 + 2 * share) / 2 ** i
        last, exact = i == steps, Fraction(float(delta))
        loss = float(divisors.loss(exact) if last else divisors.loss_at(exact))
        ahc = a * h * loss ** 2
        v = ahc * l ** 2 * e
        moved += v / (1 - mp.mpf(4) ** -n if last else 1)
        sloped += kappa / (mp.e * share * delta) * v / (1 - 2 * mp.mpf(4) ** -n if last else 1)
        growth = ahc * l * ((2 * m * l * kappa / (mp.e * delta) if n > 1 else 0)
                            + kappa / (mp.e * 2 * delta) + third * ahc * l ** 3 / 2)
        q, e = 16 ** n * growth * e, growth * e * e
    return q, sloped / t, moved / t, moved


@pytest.mark.parametrize("name", ["golden", "T49"])
@pytest.mark.parametrize("steps", [0, 3])
@pytest.mark.parametrize("waves", [[(0.5, 1, 2)], [(40, 2, 300)], [(1e-9, 1, 2)]])
@pytest.mark.slow
def test_the_largest_residual_meets_the_conditions(name, steps, waves, monkeypatch):
    found = divisors_of(*VECTORS[name])
    c = tori.Constants(*map(Fraction, (1.5, 1.75, 2, 1.25, 0.75)))
    waves = [tuple(map(Fraction, wave)) for wave in waves]
    rho, kappa = Fraction(1, 10), found.norm.kappa
    for share in tori.SHARES_OF_LOSS:
        for change in tori.CHANGES[::4]:
            with monkeypatch.context() as alone:
                alone.setattr(tori, "SHARES_OF_LOSS", [share])
                alone.setattr(tori, "CHANGES", [change])
                e, v = tori.allowed(c, waves, rho, kappa, found, steps)
            q, sloped, moved, distance = conditions(c, waves, rho, kappa, found, steps, share,
                                                    change, e)
            assert e > 0 and max(q, sloped, moved) <= 1 + 1e-9
            assert distance <= v * e * (1 + mp.mpf(1e-9))


def test_losses_of_single_steps():
    """No small divisor is forgotten."""
    for name in ("golden", "T49"):
        found = divisors_of(*VECTORS[name])
        n, sizes = found.power, sizes_of(found, 60)
        # at the last of these widths modes just beyond the radius may be the worst
        for d in (20, 1, 0.2, 0.05, 0.02, (n + 0.01) / found.radius):
            worst = max(math.exp(-d * length) / size for length, size in sizes)
            assert worst <= found.loss_at(Fraction(d)) * (1 + 1e-9)
            # what is beyond all that were looked at
            x = max(d * found.radius, n)
            assert (x / d) ** n * math.exp(-x) / float(found.tail) \
                <= found.loss_at(Fraction(d)) * (1 + 1e-9)
            # and what was not, with divisors above 16 times the tail's bound
            assert (n / (math.e * d)) ** n / float(found.tail) / 16 \
                <= found.loss_at(Fraction(d)) * (1 + 1e-9)


def small_torus(modes, wave="1 0 0 0.5", bits=40):
    text = (HEADER % len(modes)).replace("1 0 0 0.5", wave).replace("0 0 40", "0 0 %d" % bits)
    claim = check.content(sealed(text + modes_text(modes)).encode())
    return tori.Torus(tori.Setting(claim), claim.pieces[0], True)


def test_constants_count_what_is_left_out():
    """L = 1 + y for all y of norm up to x: the bounds are attained by y = x and -x."""
    torus, x = small_torus([]), Fraction(1, 16)
    ring = series.Ring(series.Box(torus.norm, 3, 0), Fraction(9, 8), 64)
    m, eta, a, b, p = tori.constants_with(torus, ring, 2, x)
    assert eta >= x and m >= 1 / (1 - x) and a >= 1 / (1 - x) ** 2
    assert b >= (1 + x) ** 2 and p >= 2 * x - x ** 2
    assert tori.constants_with(torus, ring, 2, Fraction(21, 20)) is None
    old = tori.Constants(*map(Fraction, (1, 1, 1, 1, 0)))
    new = old.after(x)
    assert new.l >= 1 + x and new.m >= 1 / (1 - x) and new.a >= 1 / (1 - x) ** 2
    assert new.b >= (1 + x) ** 2 and new.p >= 2 * x - x ** 2


@pytest.mark.parametrize("share, status", [(0.4, 0), (0.6, 5)])
def test_all_of_the_residual_is_compared(run, monkeypatch, share, status):
    class Known(tori.Residual):
        def __init__(self, *arguments):
            super().__init__(*arguments)
            self.polynomial = self.radius = Fraction(share) / 10 ** 6

    monkeypatch.setattr(tori, "Residual", Known)
    monkeypatch.setattr(tori, "allowed", lambda *_: (Fraction(1, 10 ** 6), Fraction(9)))
    assert run(sealed(BODY))[0] == status


# ---- a piece: what is lost on the way

def exact_sizes(torus):
    """Of each |k| the sum of 2 |u_k|, n = 1."""
    return [(abs(k[0]), 2 * mp.hypot(*series[0][0]) / mp.mpf(2) ** torus.bits)
            for k, series in torus.modes.items()]


class Recorded:
    """Calls of `allowed`, which says that any residual up to 1 will do."""

    def __init__(self, monkeypatch):
        self.calls, self.rings = [], []
        series_of = tori.Torus.series
        monkeypatch.setattr(tori, "allowed", self)
        monkeypatch.setattr(tori.Torus, "series", lambda torus, ring, near: self.rings.append(
            (ring, near, found := series_of(torus, ring, near))) or found)

    def __call__(self, constants, waves, rho, *_):
        self.calls.append((constants, rho))
        return Fraction(1), Fraction(0)


def test_numbers_are_on_the_safe_side():
    assert mp.mpf(field.E_LOW.numerator) / field.E_LOW.denominator <= mp.e
    assert mp.mpf(field.PI_LOW.numerator) / field.PI_LOW.denominator <= mp.pi
    assert mp.mpf(field.PI_HIGH.numerator) / field.PI_HIGH.denominator >= mp.pi
    powers = series.powers_of(Fraction(10, 9), 9)
    assert all(x * 9 ** k >= 10 ** k << series.FINE for k, x in enumerate(powers))
    for x in (Fraction(1, 3), Fraction(2, 3), Fraction(10, 7), Fraction(29), Fraction(1, 10 ** 40)):
        assert field.rounded_down(x) <= x <= field.rounded_up(x)
        assert field.upper_root(x) ** 2 >= x and field.upper_root(x * x) >= x
        with mp.workdps(150):
            number, below, above, log = [mp.mpf(y.numerator) / y.denominator for y in (
                x, field.exponential_below(x), field.exponential_above(x),
                tori.logarithm_below(1 + x))]
            assert below <= mp.exp(number) <= above and log <= mp.log(1 + number)


@pytest.mark.parametrize("width", [0.01, 0.1, 0.3])
def test_the_strip_is_no_wider_than_the_norm_says(monkeypatch, width):
    """rho, with which the theorem is asked, and S of the series: e^rho <= S."""
    seen = Recorded(monkeypatch)
    torus = small_torus(GOLDEN)
    found = tori.verify_width(torus, width, lambda text: None)
    assert len(seen.calls) > 1
    for ring, _, _ in seen.rings:
        for rho in [found.rho] + [rho for _, rho in seen.calls]:
            assert mp.exp(mp.mpf(rho.numerator) / rho.denominator) \
                <= mp.mpf(ring.sigma.numerator) / ring.sigma.denominator
    assert found.rho > 0.99 * width


def test_what_is_cut_off_changes_the_constants(monkeypatch):
    """The theorem is asked about the torus that the residual is of."""
    seen = Recorded(monkeypatch)
    torus = small_torus(GOLDEN)
    monkeypatch.setattr(tori.Torus, "extent", lambda *_: (4, 30))
    assert isinstance(tori.verify_width(torus, 0.1, lambda text: None), tori.Verified)
    *_, (whole, _), (cut, _) = seen.calls
    sigma = mp.mpf(seen.rings[-1][0].sigma.numerator) / seen.rings[-1][0].sigma.denominator
    beyond = sum(size * k * sigma ** k for k, size in exact_sizes(torus) if k > 4)
    assert beyond > 1e-3
    exact = whole.after(Fraction(float(beyond)))
    for name in "lmabp":
        assert getattr(cut, name) >= getattr(exact, name) * (1 - Fraction(1, 10 ** 12))


@pytest.mark.parametrize("near", [3, 100])
def test_the_distance_counts_what_was_cut_and_rounded(monkeypatch, near):
    """Here all of it, as the theorem is said to move the torus by nothing."""
    seen = Recorded(monkeypatch)
    torus = small_torus(GOLDEN)
    monkeypatch.setattr(tori.Torus, "extent", lambda *_: (min(near, torus.farthest), 30))
    found = tori.verify_width(torus, 0.1, lambda text: None)
    ring, _, used = seen.rings[-1]
    (_, im), = used.entries
    off = mp.mpf(0)
    for k, series_ in torus.modes.items():
        at = ring.box.find(k)
        exact = mp.mpf(series_[0][0][1]) / mp.mpf(2) ** torus.bits
        off += 2 * abs(exact - mp.mpf(im[at]) / ring.one) if at is not None else 2 * abs(exact)
    assert off > 0
    assert mp.mpf(found.distance.numerator) / found.distance.denominator >= off
    assert found.distance < 100 * off


def test_the_distance_counts_what_was_dropped(monkeypatch):
    """Real parts, of a torus that is nearly odd."""
    Recorded(monkeypatch)
    size = 1 << 33
    values = [value.split() for value in GOLDEN[:10]]
    other = [(x, "%x" % size) if y == "0" else ("%x" % size, y) for x, y in values]
    torus = small_torus([" ".join(pair) for pair in other])
    assert tori.verify_width(torus, 0.1, lambda text: None).distance >= Fraction(20 * size, 1 << 40)
    plain = tori.verify_width(small_torus(GOLDEN[:10]), 0.1, lambda text: None)
    assert plain.distance < Fraction(size, 1 << 40)


def test_the_constants_count_that_u_was_rounded(monkeypatch):
    """What stands for L = I + Du, in few bits, is no further from it than its radius."""
    torus = small_torus(GOLDEN)
    ring = series.Ring(series.Box(torus.norm, 29, 0), Fraction(9, 8), 30)
    products, multiply = [], series.Ring.multiply
    monkeypatch.setattr(series.Ring, "multiply", lambda self, f, g: products.append(f)
                        or multiply(self, f, g))
    tori.constants_with(torus, ring, 29, Fraction(0))
    left, sigma = products[0], mp.mpf(9) / 8
    (re, im), = left.entries
    off = mp.mpf(0)
    for at, (k,) in enumerate(ring.box.modes()):
        exact = mp.mpf(k == 0)
        if (abs(k),) in torus.modes:    # i k u_k, u_k imaginary, odd in k
            exact -= abs(k) * mp.mpf(torus.modes[abs(k),][0][0][1]) / mp.mpf(2) ** torus.bits
        off += abs(exact - mp.mpc(re[at], im[at] if im else 0) / ring.one) * sigma ** abs(k)
    assert 0 < off <= mp.mpf(left.radius) / 2 ** (ring.bits + series.FINE)


@pytest.mark.parametrize("is_real", [True, False])
def test_a_delayed_function_is_within_its_radius(is_real):
    """f(. - w), in few bits."""
    torus, rng = small_torus(GOLDEN), random.Random(11)
    ring = series.Ring(series.Box(torus.norm, 8, 0), Fraction(9, 8), 16)
    f = ring.series(1, 1, [random_entry(rng, ring, is_real, 1.0)], 12345)
    found = tori.delayed(torus, ring, f)
    (x, y), (re, im) = f.entries[0], found.entries[0]
    off, w = mp.mpf(0), mp.pi * (mp.sqrt(5) - 1)
    for at, (k,) in enumerate(ring.box.modes()):
        exact = mp.mpc(x[at], y[at] if y else 0) * mp.expj(-k * w)
        off += abs(exact - mp.mpc(re[at], im[at])) * (mp.mpf(9) / 8) ** abs(k)
    assert 0 < off <= mp.mpf(found.radius - 12345) / 2 ** series.FINE


@pytest.fixture(scope="module")
def surface(tmp_path_factory):
    """The text of a certificate of two angles, with some 200 modes."""
    path, c = tmp_path_factory.mktemp("tori") / "surface", Fraction("0.02242872")
    prove(Problem(SymplecticMap(THESIS, [c, c, 2 * c])), read_rotation("T49", 2)).save(path)
    return path.read_text(encoding="utf-8")


def resealed(text, pattern, new):
    """The certificate with a line that is another, and the checksum right."""
    text, count = re.subn("(?m)^%s" % pattern, new, text, count=1)
    assert count
    return sealed(text)



@pytest.mark.slow
def test_constants_do_not_need_many_times_the_modes_of_the_torus(surface, run, monkeypatch):
    monkeypatch.setattr(tori, "Ring", lambda *_: pytest.fail("a series is computed"))
    status, out, err = run(resealed(surface, "frame: .*", "frame: 1 2 1 3"))
    assert (status, out) == (5, "") and "too many for a torus of " in err


@pytest.mark.slow
def test_a_few_modes_far_out_are_no_reason_for_a_large_box(surface, run, monkeypatch):
    """The number of modes bounds the work."""
    box = tori.Box
    monkeypatch.setattr(tori, "Box", lambda norm, limit, degree: box(norm, limit, degree)
                        if limit < 400 else pytest.fail("a large box is made"))
    text = resealed(surface, "rho: .*", "rho: 1/50")
    text = resealed(text, r"(piece 0 0 \d+ 0) (\d+)\n", lambda found: "%s %d\n%s\n" % (
        found[1], int(found[2]) + 1, "400 400 0 0 1 0 1"))
    status, out, err = run(text)
    assert (status, out) == (5, "") and "too many for a torus of " in err


def test_the_number_of_modes_is_estimated():
    for norm in (field.Norm(((2,),), (3,), [[1]]),
                 field.Norm(((1, 1), (1, -1)), (1, 4), [[1, 0], [0, 1]]),
                 field.Norm(((1, 2), (3, 4)), (2, 3), [[1, 1], [0, 2]])):
        assert norm.count(500) == pytest.approx(series.Box(norm, 500, 0).groups, rel=0.05)


@pytest.mark.slow
def test_both_reasons_are_told_if_a_torus_that_is_nearly_odd_fails(run, monkeypatch):
    def fails(torus, *_):
        raise check.NotConfirmed("it is %s" % ("odd" if torus.is_odd else "whole"))

    monkeypatch.setattr(check, "verify_width", fails)
    text = HEADER % 2 + "1 0 1 -12771844e3\n2 0 0 29cb34dcc\n"
    assert run(sealed(text))[2].endswith("not confirmed: it is whole; as an odd torus: it is odd\n")
    assert run(sealed(text.replace("1 0 1 -", "1 0 0 -")))[2].endswith("confirmed: it is odd\n")


@pytest.mark.slow
def test_a_torus_that_is_nearly_odd(run, tmp_path):
    """Parts of 8e-6 that are not odd are left out first, and then are not."""
    torus = prove(Problem(SymplecticMap([(1, 0), (0, 1), (1, 1)], ["0.1", "0.1", "0.000001"])),
                  read_rotation("T49", 2))
    torus.save(tmp_path / "torus")
    assert run((tmp_path / "torus").read_text(encoding="utf-8"))[0] == 0


@pytest.mark.slow
def test_the_theorem_is_asked_in_the_norm_of_the_file(root, monkeypatch):
    """kappa, by which |k|_2 <= kappa |k|, is that of its frame and alpha, at each question."""
    asked, allowed = [], tori.allowed
    monkeypatch.setattr(tori, "allowed", lambda *arguments: (
        asked.append(arguments[3]), allowed(*arguments))[1])
    claim = check.content((root / "golden_outputs" / "tori" / "phases.torus").read_bytes())
    tori.verify_torus(claim)
    kappa = tori.Setting(claim).norm.kappa
    assert kappa != 1 and len(asked) == 2 and set(asked) == {kappa}
