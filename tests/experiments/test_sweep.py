"""Sweeps: the same bytes whoever computes them and however often they were interrupted."""

import csv
import importlib.util
import io
import math
import os
import subprocess
import sys

import numpy as np
import pytest
import sweep

from converse import orbits
from converse.storage.files import ConverseError

from moments import PATIENCE

VECTORS = [((5, 7), 9), ((3, 4), 5), ((12, 16), 21), ((1, 2), 4), ((2, 1), 8)]
EPS = [0.004, 0.01]


@pytest.fixture
def path(tmp_path):
    return tmp_path / "table.csv"


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The bytes of the sweep of VECTORS."""
    file = tmp_path_factory.mktemp("sweep") / "whole.csv"
    sweep.sweep(orbits.trig, VECTORS, EPS, file=file)
    return file.read_bytes()


def read(path):
    """The table in a file."""
    return sweep.table_of(path.read_text("utf-8"))


def same(table, other):
    """NaN, too."""
    return table.dtype == other.dtype and repr(table.tolist()) == repr(other.tolist())


# ---- sweeps

def test_a_sweep_is_its_families(whole):
    table = sweep.sweep(orbits.trig, VECTORS, EPS)
    text = io.StringIO()
    families = [orbits.follow(orbits.trig, p, q, EPS) for p, q in VECTORS]
    csv.writer(text, lineterminator="\n").writerows(
        [sweep.COLUMNS, *(sweep.row(state) for family in families for state in family)])
    assert whole.decode() == text.getvalue()
    assert len(table) == len(VECTORS) * len(EPS) and table.dtype["p"].shape == (2,)
    for k, state in enumerate(state for family in families for state in family):
        row = table[k]
        assert (tuple(row["p"]), row["q"], row["eps"]) == (state.p, state.q, state.eps)
        assert (row["action"], row["label"]) == (state.action, state.label)
        assert (row["exponent_1"], row["exponent_2"]) == tuple(state.exponents)


def test_the_table_is_read_again(path):
    table = sweep.onsets(orbits.standard, [((1,), 3), ((2,), 5)], file=path, width=0.001)
    assert same(read(path), table) and tuple(table.dtype.names) == sweep.ONSET_COLUMNS
    below, above = orbits.onset(orbits.standard, (2,), 5, width=0.001)
    assert table["p"].tolist() == [[1], [2]]
    assert table[1].tolist()[3:] == (
        above.label, below.eps, above.eps, below.exponents[0], above.exponents[0])
    path.write_text(path.read_text().replace("exponent", "stretch"))
    with pytest.raises(ValueError, match="no such columns"):
        read(path)


# ---- interrupted

def test_torn_anywhere(whole, path):
    """Cut after any byte the file is the beginning of the same sweep."""
    for size in [0, 1, 7, *range(40, len(whole) + 1, 97), len(whole) - 1, len(whole)]:
        path.write_bytes(whole[:size])
        sweep.sweep(orbits.trig, VECTORS, EPS, file=path)
        assert path.read_bytes() == whole, size


@pytest.mark.parametrize("potential, vectors, eps, words", [
    (orbits.ff, VECTORS, EPS, "another potential"),
    (orbits.trig, VECTORS[::-1], EPS, "line 2 is of"), (orbits.trig, VECTORS[:4], EPS, "more rows"),
    (orbits.trig, VECTORS[:3] + VECTORS[:2], EPS, "line 8 is of"),
    (orbits.trig, VECTORS, [0.004, 0.011], "line 3 is of another potential, type or eps"),
    (orbits.trig, VECTORS, EPS + [0.02], "line 4 is of"),
    ])
def test_the_file_of_another_sweep_is_refused(whole, path, potential, vectors, eps, words):
    path.write_bytes(whole)
    with pytest.raises(ConverseError, match=words) as error:
        sweep.sweep(potential, vectors, eps, file=path)
    assert str(error.value).startswith(str(path)) and "\n" not in str(error.value)
    assert path.read_bytes() == whole


MANY = """
import sweep, sys
from converse import orbits
def strike(done, of):
    if done == stop:
        raise KeyboardInterrupt
if __name__ == "__main__":
    stop = int(sys.argv[2])
    vectors = [((57, 76), 100 + k) for k in range(1, 21)]
    sweep.sweep(orbits.trig, vectors, [0.004, 0.008], file=sys.argv[1], jobs=2, progress=strike)
"""


def test_interrupted_and_continued(path):
    """In the end the bytes are those of one run."""
    other = path.parent / "whole.csv"
    for file, stop, status in ((other, -1, 0), (path, 3, 1), (path, 9, 1), (path, -1, 0)):
        done = subprocess.run([sys.executable, "-c", MANY, file, str(stop)], timeout=PATIENCE,
                              env={**os.environ, "PYTHONPATH": os.path.dirname(sweep.__file__)},
                              stderr=subprocess.DEVNULL)
        assert (done.returncode == 0) is (status == 0)
        assert other.read_bytes().startswith(file.read_bytes())
        if stop > 0:
            assert file.read_bytes().count(b"\n") == 1 + 2 * stop
    assert path.read_bytes() == other.read_bytes()


def test_the_command(path, capsys):
    vectors = path.with_suffix(".txt")
    vectors.write_text("5,7/9\n(3, 4)/5   # with its name\n\n12,16/21\n")
    assert sweep.main(["trig", str(path), "0.01", "--vectors", str(vectors)]) == 0
    assert capsys.readouterr().out == "written: %s, 3 types, 3 rows\n" % path
    assert same(read(path), sweep.sweep(orbits.trig, VECTORS[:3], [0.01]))
    path.unlink()
    assert sweep.main(["standard", str(path), "--farey", "0.618", "--sizes", "20:60"]) == 0
    assert read(path)["q"].tolist() == [21, 34, 55]
    assert sweep.main(["standard", str(path), "--random", "2", "--sizes", "5:9"]) == 2
    assert "not the beginning of this sweep" in capsys.readouterr().err


# ---- experiments/toughest.py

@pytest.fixture(scope="module")
def toughest(root):
    spec = importlib.util.spec_from_file_location("toughest", root / "experiments" / "toughest.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_one_vector_stands_for_its_mirror_images(toughest):
    """Their orbits are images of one another, so that their onsets are equal."""
    images = [(65, 31), (31, 65), (-65, -31), (83, 49), (-31, -65), (49 + 114, 83)]
    assert len({toughest.rational(toughest.folded(np.array(p) / 114), 114) for p in images}) == 1
    how = {"step": 0.001, "width": 1e-6}
    found = [orbits.onset(orbits.trig, p, 114, **how).above.eps for p in images]
    assert max(found) - min(found) < 5e-6
    assert abs(orbits.onset(orbits.trig, (64, 31), 115, **how).above.eps - found[0]) > 1e-4


def test_its_vectors_are_well_spread(toughest):
    vectors = toughest.spread(400, (300, 1200))
    w = np.array([p for p, _ in vectors]) / np.array([q for _, q in vectors])[:, None]
    assert ((w[:, 1] <= w[:, 0]) & (w.sum(1) <= 1)).all() and len(set(vectors)) == 400
    assert all(300 <= q <= 1210 and math.gcd(*p, q) == 1 for p, q in vectors)
    # Of 16 parts of the triangle of one size, each has about 25.
    t, s = w[:, 0] - w[:, 1], w.sum(1)              # uniform in 0 <= t <= s <= 1
    count = np.histogram2d(s ** 2, t / s, bins=4, range=((0, 1), (0, 1)))[0]
    assert count.sum() == 400 and 18 <= count.min() and count.max() <= 32


def test_its_approximants(toughest):
    for p, q in toughest.approximants(toughest.NEAR, 2000):
        assert max(abs(q * w - k) for w, k in zip(toughest.NEAR, p)) < 0.9 / math.sqrt(q)
    assert ((449, 439), 1503) in toughest.approximants(toughest.NEAR, 2000)
    assert list(toughest.golden(100)) == [((13,), 21), ((21,), 34), ((34,), 55), ((55,), 89)]
