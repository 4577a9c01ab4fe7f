"""Onsets of many vectors: the same bytes however often they were interrupted."""

import importlib.util
import math
import os
import subprocess
import sys

import numpy as np
import pytest
import sweep
from thesis.potentials import ff

from converse import orbits
from converse.storage.files import ConverseError

from moments import PATIENCE

VECTORS = [((5, 7), 9), ((3, 4), 5), ((12, 16), 21), ((1, 2), 4), ((2, 1), 8)]
HOW = {"step": 0.002, "width": 0.001, "top": 0.02, "jobs": 1}


@pytest.fixture
def path(tmp_path):
    return tmp_path / "table.csv"


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The bytes of the table of VECTORS."""
    file = tmp_path_factory.mktemp("sweep") / "whole.csv"
    sweep.onsets(orbits.trig, VECTORS, file=file, **HOW)
    return file.read_bytes()


def test_the_table_is_read_again(path):
    table = sweep.onsets(orbits.standard, [((1,), 3), ((2,), 5)], file=path, width=0.001)
    again = sweep.table_of(path.read_text("utf-8"))
    assert again.dtype == table.dtype and repr(again.tolist()) == repr(table.tolist())
    below, above = orbits.onset(orbits.standard, (2,), 5, width=0.001)
    assert table["p"].tolist() == [[1], [2]]
    assert table[1].tolist()[3:] == (
        above.label, below.eps, above.eps, below.exponents[0], above.exponents[0])


def test_torn_anywhere(whole, path):
    """Cut after any byte the file is the beginning of the same table."""
    for size in [0, 1, 7, *range(40, len(whole) + 1, 97), len(whole) - 1, len(whole)]:
        path.write_bytes(whole[:size])
        sweep.onsets(orbits.trig, VECTORS, file=path, **HOW)
        assert path.read_bytes() == whole, size


@pytest.mark.parametrize("potential, vectors", [
    (ff, VECTORS), (orbits.trig, VECTORS[::-1]), (orbits.trig, VECTORS[:4])])
def test_the_file_of_another_table_is_refused(whole, path, potential, vectors):
    path.write_bytes(whole)
    with pytest.raises(ConverseError, match="^%s: is not the beginning" % path):
        sweep.onsets(potential, vectors, file=path, **HOW)
    assert path.read_bytes() == whole


BROKEN_OFF = """
import os, sweep, sys
from converse import orbits
if __name__ == "__main__":
    vectors = [((57, 76), 100 + k) for k in range(1, 21)]
    sweep.onsets(orbits.trig, vectors, file=sys.argv[1], jobs=2, step=0.002, width=0.001, top=0.02)
"""


def test_interrupted_and_continued(path):
    """In the end the bytes are those of one run."""
    def started():
        return subprocess.Popen([sys.executable, "-c", BROKEN_OFF, path], stderr=subprocess.DEVNULL,
                                env={**os.environ, "PYTHONPATH": os.path.dirname(sweep.__file__)})

    for stop in (3, 9):
        with started() as process:
            while not path.exists() or path.read_bytes().count(b"\n") <= stop:
                assert process.poll() is None
            process.send_signal(2)
            assert process.wait(PATIENCE)
    with started() as process:
        assert process.wait(PATIENCE) == 0
    broken = path.read_bytes()
    path.unlink()
    with started() as process:
        assert process.wait(PATIENCE) == 0
    assert path.read_bytes() == broken and broken.count(b"\n") == 21


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
