"""Files of points: states go through them to the last bit, and what is none is refused."""

import os

import numpy as np
import pytest
from sums import fourier

from converse import ConverseError, orbits
from converse.commands import orbits as orbits_cli

OWN = fourier({(1,): (0.013, 0.007), (2,): (0.003, 0)}, 'my "own", 1')


def same(a, b):
    return (a.potential == b.potential and (a.p, a.q, a.eps, a.origin) ==
            (b.p, b.q, b.eps, b.origin) and a.u.tobytes() == b.u.tobytes()
            and a.momenta.tobytes() == b.momenta.tobytes())


@pytest.mark.parametrize("ending", ["npz", "NPZ"])
@pytest.mark.parametrize("potential, p, q, eps", [
    (orbits.trig, (-5, 7), 9, [0.02, 0.03]), (orbits.standard, (34,), 89, [0.9]),
    (orbits.poly, (1, 1), 1, [0.01]), (OWN, (5,), 13, [1, -0.3])],
    ids=str)
def test_there_and_back(tmp_path, potential, p, q, eps, ending):
    path = tmp_path / ("a." + ending)
    family = orbits.follow(potential, p, q, eps)
    family.save(path)
    data = path.read_bytes()
    again = orbits.Family.load(path, potential)
    assert len(again) == len(family) and all(map(same, again, family))
    if potential.name in ("trig", "standard", "poly"):
        assert all(map(same, orbits.Family.load(str(path)), family))
    else:
        with pytest.raises(ConverseError, match="potential="):
            orbits.Family.load(path)
    again.save(path)                            # over itself, and the same bytes
    assert path.read_bytes() == data
    family[0].save(path)
    one, = orbits.Family.load(path, potential)
    assert same(one, family[0])


def test_every_double_comes_back(tmp_path):
    """Displacements and origins with all bits, tiny, negative, and minus zero."""
    rng = np.random.default_rng(1)
    u = rng.normal(size=(200, 2)) * 10.0 ** rng.integers(-300, 2, (200, 2))
    u[0] = -0.0, 5e-324
    state = orbits.PeriodicOrbit(orbits.ff, (3, -800), 200, 1 / 3, u,
                                 (np.nextafter(0.3, 1), -1e-17))
    state.save(tmp_path / "a.npz")
    assert same(orbits.Family.load(tmp_path / "a.npz")[0], state)


def test_what_others_read(tmp_path):
    state = orbits.follow(orbits.trig, (5, 7), 9, [0.02])[0]
    state.save(tmp_path / "a.npz")
    with np.load(tmp_path / "a.npz") as arrays:
        assert (arrays["x"][0] == state.x).all() and str(arrays["potential"]) == "trig"
        assert (arrays["momentum"][0] == state.momenta).all()


def test_files_that_are_none(tmp_path):
    state = orbits.follow(orbits.standard, (3,), 8, [0.9])[0]
    state.save(tmp_path / "a.npz")
    data = (tmp_path / "a.npz").read_bytes()
    bad = {"empty": b"", "zip": data[:300], "table": b"potential,p,q,eps,label\n",
           "picture": b"\x89PNG", "PK": b"PK\3\4", "latin": b"\xff",
           "flipped": data[:900] + bytes([data[900] ^ 1]) + data[901:]}
    for name, content in bad.items():
        path = tmp_path / name
        path.write_bytes(content)
        with pytest.raises(ConverseError) as raised:
            orbits.Family.load(path)
        assert str(raised.value).startswith(str(path)) and "\n" not in str(raised.value), name
    np.savez(tmp_path / "other.npz", x=[1.0])
    np.savez(tmp_path / "objects.npz", x=np.array([{}], dtype=object))
    for name in ("other.npz", "objects.npz", "missing", "."):
        with pytest.raises(ConverseError, match="is not a file of states|cannot be read"):
            orbits.Family.load(tmp_path / name)


def test_arrays_that_are_no_numbers(tmp_path):
    """Of text, of times, of complex numbers, of another shape, infinite; and an archive whose
    header says that it is encrypted."""
    path, bad = tmp_path / "a.npz", tmp_path / "b.npz"
    orbits.follow(orbits.standard, (3,), 8, [0.5, 0.6]).save(path)
    arrays = dict(np.load(path))
    with np.errstate(all="ignore"):
        for name, value in (("u", np.full((2, 8, 1), "a")), ("u", arrays["u"] * 1j),
                            ("u", arrays["u"].astype("datetime64[s]")), ("u", arrays["u"][:, 1:]),
                            ("u", np.full((2, 8, 1), np.inf)), ("origin", [["a"], ["b"]]),
                            ("q", "a"), ("eps", [0.5, np.nan]), ("p", [[3]])):
            np.savez(bad, **{**arrays, name: value})
            with pytest.raises(ConverseError, match="is not a file of states|is damaged"):
                orbits.Family.load(bad)
    data = bytearray(path.read_bytes())
    for at in range(len(data)):
        if data[at:at + 4] == b"PK\x01\x02":
            data[at + 8] |= 1
    bad.write_bytes(data)
    with pytest.raises(ConverseError, match="is not a file of states"):
        orbits.Family.load(bad)


def test_states_that_are_no_family_are_not_written(tmp_path):
    """What load could not read: none, of two potentials, or of two types."""
    path, one = tmp_path / "a.npz", orbits.straight(orbits.standard, (3,), 8)
    for states in ((), (one, orbits.straight(orbits.froeschle, (3, 1), 8)), (one, one.repeat(2))):
        with pytest.raises(ValueError, match="one potential and one type"):
            orbits.Family(states).save(path)
    assert not path.exists()


def test_the_potential_is_named(tmp_path):
    state = orbits.follow(orbits.standard, (3,), 8, [0.9])[0]
    state.save(tmp_path / "a.npz")
    with pytest.raises(ConverseError, match="its potential is 'standard', not other"):
        orbits.Family.load(tmp_path / "a.npz", fourier({(1,): (-1, 0)}, "other"))
    with pytest.raises(ValueError, match="map is a SymplecticMap"):
        orbits.Family.load(tmp_path / "a.npz", "standard")


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


def test_a_full_disk_leaves_the_older_file(tmp_path, monkeypatch):
    state = orbits.follow(orbits.standard, (3,), 8, [0.9])[0]
    path = tmp_path / "a.npz"
    state.save(path)
    data = path.read_bytes()

    def full(handle):
        raise OSError(28, "No space left on device")
    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(ConverseError, match="No space left on device.*older file"):
        state.relax(1.2).save(path)
    assert path.read_bytes() == data and os.listdir(tmp_path) == ["a.npz"]


# ---- on the command line, and as a start

def command(capsys, *arguments):
    status = orbits_cli.main(list(map(str, arguments)))
    out, err = capsys.readouterr()
    return status, out, err


def test_find_writes_points_and_begins_at_them(tmp_path, capsys):
    a, b = tmp_path / "a.npz", tmp_path / "b.npz"
    assert command(capsys, "trig", "5,7/9", "0.02", "0.03", "--points", a)[0] == 0
    family = orbits.Family.load(a)
    direct = orbits.follow(orbits.trig, (5, 7), 9, [0.02, 0.03])
    assert all(map(same, family, direct))
    status, out, _ = command(capsys, "trig", "5,7/9", "0.031", "--from", a, "--points", b)
    assert status == 0
    further, = orbits.follow(orbits.trig, (5, 7), 9, [0.031], start=family[1])
    assert same(orbits.Family.load(b)[0], further) and "%.12g" % further.action in out


def test_from_keeps_a_branch_that_continuation_does_not_reach(tmp_path, capsys):
    best = orbits.straight(orbits.trig, (12, 16), 21, (0.2, 0.7)).relax(0.03)
    followed = orbits.follow(orbits.trig, (12, 16), 21, [0.03])[0]
    assert best.label == "minimum" and abs(best.action - followed.action) > 1e-6
    best.save(tmp_path / "best.npz")
    status, out, _ = command(capsys, "trig", "12,16/21", "0.03", "--from",
                             tmp_path / "best.npz")
    assert status == 0 and "%.12g" % best.action in out


def test_bad_use_of_points(tmp_path, capsys):
    a = tmp_path / "a.npz"
    (tmp_path / "else.npz").write_text("mine\n")
    orbits.follow(orbits.trig, (5, 7), 9, [0.02]).save(a)
    for arguments, words in (
            (("trig", "5,7/12", "0.02", "--from", a), "its states are of type (5, 7)/9"),
            (("ff", "5,7/9", "0.02", "--from", a), "its potential is 'trig', not ff"),
            (("trig", "5,7/9", "0.02", "--from", a, "--points", a), "would overwrite"),
            (("trig", "5,7/9", "0.02", "--from", tmp_path / "no"), "cannot be read"),
            (("trig", "5,7/9", "0.02", "--points", tmp_path / "else.npz"), "exists and is not"),
            (("trig", "5,7/9", "100", "--from", a), "too far to be followed")):
        status, out, err = command(capsys, *arguments)
        assert status == 2 and words in err and err.count("\n") == 1 and not out, arguments
    assert (tmp_path / "else.npz").read_text() == "mine\n"
    state = orbits.Family.load(a)[0]
    for start in (state.repeat(2), orbits.follow(orbits.ff, (5, 7), 9, [0.01])[0]):
        with pytest.raises(ValueError, match="the start is"):
            orbits.follow(orbits.trig, (5, 7), 9, [0.02], start=start)
    with pytest.raises(ValueError, match="a state is expected"):
        orbits.follow(orbits.trig, (5, 7), 9, [0.02], start="a.npz")
