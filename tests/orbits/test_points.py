"""Files of points: all of a state is in them, to the last bit."""


import numpy as np
import pytest
from thesis.potentials import ff

from converse import ConverseError, orbits
from converse.commands import orbits as orbits_cli


def states_of(path, potential):
    with np.load(path) as data:
        return [orbits.PeriodicOrbit(potential, data["p"], int(data["q"]), eps, u, origin)
                for eps, u, origin in zip(data["eps"], data["u"], data["origin"])]


def same(a, b):
    return (a.potential == b.potential and (a.p, a.q, a.eps, a.origin) ==
            (b.p, b.q, b.eps, b.origin) and a.u.tobytes() == b.u.tobytes()
            and a.momenta.tobytes() == b.momenta.tobytes())


def test_every_double_comes_back(tmp_path):
    """Displacements and origins with all bits, tiny, negative, minus zero; states of a family."""
    rng, path = np.random.default_rng(1), tmp_path / "a.npz"
    u = rng.normal(size=(200, 2)) * 10.0 ** rng.integers(-300, 2, (200, 2))
    u[0] = -0.0, 5e-324
    state = orbits.PeriodicOrbit(ff, (3, -800), 200, 1 / 3, u,
                                 (np.nextafter(0.3, 1), -1e-17))
    state.save(path)
    assert same(*states_of(path, ff), state)
    orbits.Family((state, state.moved(u / 2))).save(path)
    assert same(states_of(path, ff)[1], state.moved(u / 2))


def test_what_others_read(tmp_path):
    state = orbits.follow(orbits.trig, (5, 7), 9, [0.02])[0]
    state.save(tmp_path / "a.npz")
    with np.load(tmp_path / "a.npz") as arrays:
        assert (arrays["x"][0] == state.x).all() and str(arrays["potential"]) == "trig"
        assert (arrays["momentum"][0] == state.momenta).all()


def test_states_that_are_no_family_are_not_written(tmp_path):
    """None, of two potentials, or of two types."""
    path, one = tmp_path / "a.npz", orbits.straight(orbits.standard, (3,), 8)
    for states in ((), (one, orbits.straight(orbits.froeschle, (3, 1), 8)), (one, one.repeat(2))):
        with pytest.raises(ValueError, match="one potential and one type"):
            orbits.Family(states).save(path)
    assert not path.exists()


def test_what_is_in_the_way_is_kept(tmp_path):
    state = orbits.follow(orbits.standard, (3,), 8, [0.9])[0]
    path = tmp_path / "a.npz"
    path.write_bytes(b"PK not mine")
    with pytest.raises(ConverseError, match="exists and is not a file of points of this program"):
        state.save(path)
    assert path.read_bytes() == b"PK not mine"
    for name, words in (("a.txt", "ends in .npz"), ("a.csv", "ends in .npz"), (".npz", "ends in"),
                        ("no/a.npz", "cannot be written")):
        with pytest.raises(ConverseError, match=words):
            state.save(tmp_path / name)


def test_the_command_writes_points(tmp_path, capsys):
    path = tmp_path / "a.npz"
    assert orbits_cli.main(["trig", "5,7/9", "0.02", "0.03", "--points", str(path)]) == 0
    capsys.readouterr()
    direct = orbits.follow(orbits.trig, (5, 7), 9, [0.02, 0.03])
    assert all(map(same, states_of(path, orbits.trig), direct))


def test_a_start_is_of_the_same_map_and_type():
    state = orbits.follow(orbits.trig, (5, 7), 9, [0.02])[0]
    further, = orbits.follow(orbits.trig, (5, 7), 9, [0.03], start=state)
    assert further.label == "minimum" and further.eps == 0.03
    for start in (state.repeat(2), orbits.follow(ff, (5, 7), 9, [0.01])[0]):
        with pytest.raises(ValueError, match="the start is"):
            orbits.follow(orbits.trig, (5, 7), 9, [0.02], start=start)
    with pytest.raises(ValueError, match="a state is expected"):
        orbits.follow(orbits.trig, (5, 7), 9, [0.02], start="a.npz")
