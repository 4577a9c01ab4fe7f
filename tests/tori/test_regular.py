"""Tori that are made of orbits: the regular orbits are found, and the others refused."""

from fractions import Fraction

import numpy as np
import pytest

from converse import FroeschleMap, MuldoonMap, StandardMap, SymplecticMap, tori
from converse.model.problem import Problem
from converse.tori.continuation import Found, Way
from converse.tori.effort import Work
from converse.tori.find import NotFound, Search, find
from converse.tori.newton import best_frame
from converse.tori.plan import plan
from converse.tori.regular import Orbits, _resonant, near_vectors, regular, with_rotation
from converse.tori.rotation import read_rotation

from truth import TORTURE

dear = pytest.mark.skipif(TORTURE <= 1, reason="a minute; make torture has it")


def two_harmonics(K1, name="K1"):
    return SymplecticMap([(1, 0, "-1/2"), (2, 0, "-1/2")], [0, "0.2"], [[1, 0]], [K1], [name])


@pytest.mark.parametrize("K1", ["0.207", "0.212", "0.42", "0.575"])
@pytest.mark.slow
def test_circles_are_found_beyond_the_gaps(K1):
    torus = find(two_harmonics(K1))
    w, = torus.rotation.floats
    assert 0.13 < w < 0.28 and torus.rotation.polynomial == (-1, 1, 1)
    x, J = torus.x([1.0])[0], torus.J([1.0])[0]
    for m in range(20):                 # the orbit stays on it
        J += float(K1) * np.sin(x) + 0.4 * np.sin(2 * x)
        x += J
    assert x == pytest.approx(torus.x([1.0 + 40 * np.pi * w])[0], abs=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("K1", ["0.30", *(
    pytest.param(K1, marks=pytest.mark.slow) for K1 in ("0.515", "0.55"))])
def test_where_absence_is_proved_nothing_is_found(K1):
    with pytest.raises(NotFound, match="at K1 = %g no orbit is seen that is regular" % float(K1)):
        find(two_harmonics(K1))


@pytest.mark.slow
def test_an_island_is_no_circle():
    """The chain of 163 islands at K1 = 0.587 is as regular as a circle."""
    seen = regular(Orbits(two_harmonics("0.587").potential()))
    assert seen and all(abs(orbit.rotation[0] - 34 / 163) > 1e-4 for orbit in seen)


@pytest.mark.parametrize("vector, resonant", [
    ((0.3006387, 0.2922641), True), ((0.25, 0.3141592), True), ((0.3333338, 0.25), True),
    (read_rotation("V1").floats, False), (read_rotation("spiral").floats, False)])
def test_resonant_vectors_are_refused(vector, resonant):
    assert _resonant(np.array([vector]), 45, 3e-8) == [resonant]


@pytest.mark.slow
def test_the_golden_circle_is_the_last_of_the_standard_map():
    best = regular(Orbits(StandardMap("0.9714").potential()))[0]
    assert min(best.rotation[0], 1 - best.rotation[0]) == pytest.approx((3 - 5 ** 0.5) / 2)
    assert not regular(Orbits(StandardMap("1").potential()))


@pytest.mark.parametrize("source, rotation", [
    (StandardMap("0.9"), "golden"), (SymplecticMap([(2, 0, Fraction(1, 7))], ["0.15"]), "silver"),
    (SymplecticMap([(1, 0), (2, 0, Fraction(1, 6))], ["0.3", "-0.04"]), "t^2+t-1: 2-t"),
    pytest.param(MuldoonMap(epsilon="0.004"), "T49", marks=pytest.mark.slow)])
def test_an_orbit_and_continuation_lead_to_the_same_torus(source, rotation):
    """Above its rotation number, below it, and beyond one turn."""
    potential, rotation = source.potential(), read_rotation(rotation)
    orbits = Orbits(potential)
    orbit = with_rotation(orbits, rotation)
    assert orbit.rotation == rotation.floats and orbit.change < 1e-8
    amplitude = np.array(potential.amplitude, float)
    made = Way(potential, rotation, 1 << 16, amplitude, amplitude).of_orbit(orbits, orbit)
    assert isinstance(made, Found)
    followed = Way(potential, rotation, 1 << 16, 0 * amplitude, amplitude).follow()
    assert abs(made.mesh.moved(made.u, followed.mesh) - followed.u).max() < 1e-9


@dear
@pytest.mark.parametrize("source, modes", [(FroeschleMap("0.45", "0.1"), 45000)])
def test_tori_of_two_angles_are_found(source, modes):
    torus = find(source)
    assert torus.dimension == 2 and len(torus.k) < modes


def test_the_frame_follows_the_decay():
    k = np.array([(i, j) for i in range(-20, 21) for j in range(-20, 21)]).T
    for frame in (((1, 0), (0, 1)), ((1, 1), (1, -1)), ((2, 1), (1, -1))):
        row = np.array(frame) @ k
        assert best_frame(k, np.exp(-0.3 * abs(row[0]) - 1.5 * abs(row[1]))) in (
            frame, frame[::-1])


@pytest.mark.slow
def test_of_tori_on_equal_meshes_the_one_of_the_fewest_modes_is_taken(monkeypatch):
    made, finished = [], Way.finished

    def recorded(way, rough):
        found = finished(way, rough)
        aim = plan(found)
        made.append((aim.modes(found.mesh), aim.mesh(found.mesh).points, way.rotation))
        return found

    monkeypatch.setattr(Way, "finished", recorded)
    rotation = find(StandardMap("0.64")).rotation
    modes, points, vectors = zip(*made)
    assert len(modes) == 3 and len(set(modes)) == 3 and len(set(points)) == 1
    assert rotation == vectors[modes.index(min(modes))] != vectors[0]


def test_a_rotation_number_is_taken_near_a_place():
    torus = find(two_harmonics("0.207"), near=(0.178,))
    assert torus.rotation == tori.nearest((0.178,)) and abs(torus.rotation.floats[0] - 0.178) < 1e-3
    with pytest.raises(ValueError, match="not by both"):
        find(StandardMap("0.5"), "golden", near=(0.6,))
    with pytest.raises(ValueError, match="near 0.3, 0.2 has 2 components; give 1"):
        find(StandardMap("0.5"), near=(0.3, 0.2))


@pytest.mark.slow
def test_a_range_takes_the_vector_of_its_stronger_end():
    pieces = find(two_harmonics(("0.419", "0.42")))
    assert [torus.piece[0] for torus in pieces][0] == -1 and pieces[-1].piece[1] == 1


@pytest.mark.slow
def test_vectors_of_two_angles_have_orbits():
    orbits = Orbits(MuldoonMap(epsilon="0.011").potential())
    found = near_vectors(orbits, regular(orbits)[:2])
    assert len(found) > 8 and all(each.vector.floats == each.rotation and each.change < 1e-5
                                  for each in found)


@dear
def test_of_the_vectors_of_two_angles_the_smoothest_are_tried(monkeypatch):
    """At epsilon = 0.011 changes of 1e-12 are rounding errors, and vectors in gaps have such."""
    errors, of_orbit = [], Way.of_orbit

    def recorded(way, orbits, orbit, points=None):
        found = of_orbit(way, orbits, orbit, points)
        if points:
            errors.append((found, way.rotation))
        return found

    monkeypatch.setattr(Way, "of_orbit", recorded)
    search = Search(Problem.of(MuldoonMap(epsilon="0.011")), 1 << 20, None, Work())
    way, found = search.most_regular()
    rank = [vector for _, vector in sorted(errors, key=lambda each: each[0])].index(way.rotation)
    assert len(errors) > 20 and rank < len(errors) / 3
