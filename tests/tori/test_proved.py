"""Proofs of tori: what must be proved, what must not, and that only the checker says so."""

import dataclasses
import re
from fractions import Fraction as Q

import numpy as np
import pytest
from files import line

from converse import check
from converse.model.map import THESIS, SymplecticMap
from converse.model.problem import Problem
from converse.storage.files import ConverseError
from converse.tori import certificate, proved
from converse.tori.effort import TimeIsUp
from converse.tori.find import find
from converse.tori.proved import NotProved, prove
from converse.tori.rotation import Rotation, read_rotation

GOLDEN, T49 = read_rotation("golden", 1), read_rotation("T49", 2)


def standard(k):
    return Problem(SymplecticMap([(1, 0)], [k]))


@pytest.fixture(scope="module")
def circle():
    return find(standard("0.8"), GOLDEN)


@pytest.fixture(scope="module")
def surface():
    return find(line("0.002"), T49)


@pytest.mark.parametrize("problem, rotation", [
    (standard("0.5"), GOLDEN), (standard("-0.8"), GOLDEN), (line("0.002"), T49),
    (Problem(SymplecticMap([(1, 0), (2, 0, Q(1, 3))], ["0.3", "0.04"])), GOLDEN),
    (Problem(SymplecticMap([(2, 0, Q(-1, 5))], ["0.1"])), read_rotation("silver", 1)),
    (Problem(SymplecticMap([(1, 0), (0, 1, Q(1, 8)), (1, -1, Q(-1, 10))],
                           ["0.03", "0.02", "-0.01"])),
     read_rotation("spiral", 2)),
    # waves of one direction in two angles
    (Problem(SymplecticMap(THESIS, [0, 0, "0.09"])), T49),
    (Problem(SymplecticMap([(1, 0)], ["1e-300"])), GOLDEN),
    pytest.param(line("0.004"), T49, marks=pytest.mark.slow)])
def test_tori_are_proved(problem, rotation):
    proof = prove(problem, rotation)
    piece, = proof.pieces
    assert 0 < proof.residual <= proof.needed and piece.margin > 10
    assert 0 < proof.distance < 1e-4 and piece.modes > 1 and piece.bits > 20
    frame, alpha, rho = piece.torus.strip
    assert len(frame) == piece.torus.dimension
    assert set(map(type, alpha)) == {Q} and 0.7 * rho < piece.rho < 1.01 * rho
    assert proof.report().startswith("THEOREM\n  The map")
    assert repr(proof).startswith("<ProvedTorus: V = ") and "; rotation " in repr(proof)
    said, bound = re.search("within (.*)>", repr(proof)).group(1), proof.distance
    assert bound <= float(said) <= 1.1 * bound
    assert "...." not in proof.report()
    assert ("\n                 = [0; " in proof.report()) == (rotation.dimension == 1)


@pytest.mark.slow
def test_the_time_limit(circle):
    """It ends find() and prove() before the next step; what was found is told before."""
    for call in (lambda: find(standard("0.8"), GOLDEN, time_limit=0),
                 lambda: prove(standard("0.8"), GOLDEN, time_limit=0.0),
                 lambda: prove(circle, time_limit=0, keep=kept.append)):
        kept = []
        with pytest.raises(TimeIsUp, match="^the 0 seconds of the time limit are over; the next"):
            call()
    assert kept == [certificate.text([circle])]
    for call in (find, prove):
        with pytest.raises(ValueError, match="time_limit is a number of seconds, not -1"):
            call(standard("0.8"), GOLDEN, time_limit=-1)
    assert prove(standard("0.8"), GOLDEN, time_limit=1e9)


def test_what_is_proved_is_what_the_file_says(circle, tmp_path):
    """And the checker says the same of the file that is saved."""
    proof = prove(circle)
    assert certificate.text([proof.torus]) == proof.certificate
    proof.save(tmp_path / "golden.torus")
    result = check.verify(tmp_path / "golden.torus")
    fact, = result.facts
    piece, = proof.pieces
    assert all(getattr(fact, each.name) == getattr(piece, each.name)
               for each in dataclasses.fields(fact))


def test_nothing_is_proved_that_the_checker_does_not_confirm(circle, monkeypatch):
    """Whatever is wrong: its refusal is an exception."""
    for error, kind in ((check.NotConfirmed("no"), NotProved), (check.Rejected("no"), ValueError),
                        (check.Unusable("no"), ConverseError)):
        def refuse(*_, error=error):
            raise error
        monkeypatch.setattr(check, "verify_torus", refuse)
        with pytest.raises(kind, match="^no$"):
            prove(circle)


def changed(torus, **others):
    return dataclasses.replace(torus, **others)


def moved(torus, at, amount):
    """With another coefficient."""
    numbers = torus.numbers.copy()
    numbers[:, 0, 0, at] += int(amount * 2 ** torus.bits)
    return changed(torus, numbers=numbers)


def potential(torus, factor):
    p = torus.potential
    return changed(torus, potential=p._replace(
        amplitude=tuple(factor * each for each in p.amplitude)))


def turned(torus):
    r = torus.rotation
    (first, *rest), *others = r.vector
    return changed(torus, rotation=Rotation("", r.polynomial, r.root, (
        (first + Q(1, 10 ** 6), *rest), *others)))


DAMAGES = {
    "a coefficient": lambda t: moved(t, 0, 1e-6),
    "a high coefficient": lambda t: moved(t, -1, 1e-6),
    "smaller": lambda t: changed(t, numbers=t.numbers * 9999 // 10000),
    "nothing": lambda t: changed(t, k=t.k[:0], numbers=t.numbers[..., :0]),
    "other potential": lambda t: potential(t, Q(100001, 100000)),
    "other sign": lambda t: changed(t, numbers=-t.numbers),
    "other rotation": turned,
    "24 bits": lambda t: changed(t, numbers=t.numbers >> t.bits - 24, bits=24),
}


@pytest.mark.parametrize("damage, which", [
    *((d, "circle") for d in DAMAGES),
    *(pytest.param(d, "surface", marks=pytest.mark.slow) for d in ("a coefficient", "24 bits"))])
def test_damaged_tori_are_not_proved(damage, which, request):
    torus = request.getfixturevalue(which)
    with pytest.raises(NotProved) as error:
        prove(DAMAGES[damage](torus))
    assert "\n" not in str(error.value) and error.value.residual > error.value.needed


def test_what_is_not_a_torus_is_refused(circle, pieces):
    with pytest.raises(ValueError, match="outside of the group"):       # all waves have even k
        prove(changed(circle, potential=circle.potential._replace(waves=((2, 0, Q(0)),))))
    for k in 0, -1:
        with pytest.raises(ValueError, match="k is not positive"):
            prove(changed(circle, k=circle.k * k))
    with pytest.raises(ValueError, match="different"):
        prove([circle, *pieces])
    with pytest.raises(ValueError, match="tile"):
        prove([circle, circle])
    with pytest.raises(ValueError, match="no torus"):
        prove([])
    with pytest.raises(ValueError, match="no strip"):
        prove(changed(circle, strip=None))
    with pytest.raises(ValueError, match="another rotation vector"):
        prove(circle, read_rotation("silver"))
    with pytest.raises(ValueError, match="jobs is 0; at least one"):
        prove(circle, jobs=0)
    with pytest.raises(ValueError, match="for a map"):
        prove(circle, margin=10.0)


@pytest.mark.parametrize("rho, words", [
    (Q(1), "more than|error of the torus|inverse|too large|too far"),
    (Q(10), "too wide"), pytest.param(Q(1, 10 ** 9), "error", marks=pytest.mark.slow)])
def test_a_strip_that_does_not_suit_proves_nothing(circle, rho, words):
    with pytest.raises(NotProved, match=words):
        prove(changed(circle, strip=circle.strip._replace(rho=rho)))


def test_the_width_of_a_strip_is_rounded_down(circle):
    """The series is bounded in the strip of the certificate, and in no wider one."""
    strip = circle.strip._replace(rho=Q("0.12345678"))
    assert "rho = 0.123456\n" in prove(changed(circle, strip=strip)).report()


# ---- ranges

RANGE = Problem(SymplecticMap([(1, 0)], ["0.3"], [["0.2"]]))


@pytest.fixture(scope="module")
def pieces():
    return find(RANGE, GOLDEN)


@pytest.fixture(scope="module")
def two():
    found = find(Problem(SymplecticMap([(1, 0)], ["0.45"], [["0.35"]])), GOLDEN)
    assert len(found) == 2
    return found


def test_a_range_is_proved(pieces):
    proof = prove(pieces)
    assert proof.residual < proof.needed and 0 < proof.distance < 1e-3
    for p in "0.1", "0.5":          # and its tori are those of single values
        s = (Q(p) - Q("0.3")) / Q("0.2")
        piece, = (x for x in proof.pieces if x.torus.piece[0] <= s <= x.torus.piece[1])
        single, = prove(standard(p), GOLDEN).pieces
        theta = np.linspace(0, 6, 7)[:, None]
        gap = abs(piece.torus.x(theta, float(s)) - single.torus.x(theta)).max()
        assert gap < 2 * (piece.distance + single.distance)


RANGE_DAMAGES = {
    "wider": lambda t: changed(t, part=tuple(p * Q(1001, 1000) for p in t.part)),
    "shifted": lambda t: potential(t, Q(101, 100)),
    "constant": lambda t: changed(t, numbers=t.numbers[:, :1]),
    "a power": lambda t: changed(t, numbers=t.numbers + (
        np.arange(t.degree + 1) == 1)[:, None, None] * ((1 << t.bits) // 1000)),
}


@pytest.mark.parametrize("damage", [*list(RANGE_DAMAGES)[:-1], pytest.param(
    "a power", marks=pytest.mark.slow)])
def test_damaged_ranges_are_not_proved(damage, pieces):
    with pytest.raises(NotProved):
        prove([RANGE_DAMAGES[damage](torus) for torus in pieces])


def test_pieces_must_tile_the_range(pieces):
    torus, = pieces
    first, second = (changed(torus, piece=ends) for ends in ((Q(-1), Q(0)), (Q(1, 2), Q(1))))
    for wrong in [first], [second, first], [first, second], [torus, torus], [
            changed(torus, piece=(Q(0), Q(0)))]:
        with pytest.raises(ValueError, match="tile"):
            prove(wrong)


@pytest.mark.slow
def test_two_pieces_at_a_time_are_the_same_proof(two):
    words = []
    one, both = prove(two), prove(two, jobs=3, progress=words.append)
    assert one.certificate == both.certificate
    for name in "residual", "needed", "distance", "rho", "constants", "gamma", "modes", "bits":
        assert [getattr(piece, name) for piece in one.pieces] == \
            [getattr(piece, name) for piece in both.pieces]
    assert words == ["verifying 2 pieces", "verifying: 1 of 2 pieces are verified",
                     "verifying: 2 of 2 pieces are verified"]


@pytest.mark.slow
def test_what_one_process_cannot_prove_is_not_proved(two):
    """The reason comes through, with its numbers."""
    with pytest.raises(NotProved, match="^piece 1 of 2: the error of the torus is") as error:
        prove([potential(torus, Q(101, 100)) for torus in two], jobs=2)
    assert error.value.residual > error.value.needed > 0


@pytest.mark.parametrize("problem, rotation", [
    pytest.param(Problem(SymplecticMap(THESIS, ["0.01", "0.01", "0.02"],
                                       [["0.002", "0.002", "0.004"]])), T49,
                 marks=pytest.mark.slow)])
def test_ranges_of_two_angles_are_proved(problem, rotation):
    proof = prove(problem, rotation)
    assert proof.residual < proof.needed and proof.distance < 1e-4


@pytest.mark.parametrize("residual,needed,more,margins", [
    (1e-9, 1e-12, {}, [None, 1e7]), (1e-9, 0.0, {}, [None]), (float("inf"), 1e-9, {}, [None]),
    (1e-3, 1e-12, {}, [None]), (1e-9, 1e-12, {"margin": 50}, [50])])
def test_a_torus_that_is_not_accurate_enough_is_found_again(circle, monkeypatch, residual, needed,
                                                            more, margins):
    """Once, with a larger margin, unless what is missing is infinite, or the caller chose."""
    asked = []

    def refuse(*_):
        raise NotProved("it lacks", residual, needed)
    monkeypatch.setattr(proved, "find",
                        lambda *_, margin=None, **__: asked.append(margin) or circle)
    monkeypatch.setattr(proved, "_verified", refuse)
    with pytest.raises(NotProved, match="it lacks"):
        prove(standard("0.8"), GOLDEN, **more)
    assert asked == [margin and pytest.approx(margin) for margin in margins]


def test_no_theorem_is_claimed_that_was_not_asked_for(circle, monkeypatch):
    """A proof for the middle of a range is none for the range, nor one for another map."""
    monkeypatch.setattr(proved, "find", lambda *_, **__: circle)
    for problem in (Problem(SymplecticMap([(1, 0)], ["0.8"], [["0.01"]])), standard("0.81")):
        with pytest.raises(ConverseError, match="not of the problem"):
            prove(problem, GOLDEN)
    assert prove(standard("0.8"), GOLDEN).torus.potential == circle.potential
