"""Sweeps: the same bytes whoever computes them and however often they were interrupted; and
onsets."""

import concurrent.futures
import importlib.util
import io
import math
import os
import signal
import subprocess
import sys
import threading

import numpy as np
import pytest
from sums import fourier

from converse import orbits
from converse._native import lib
from converse.model.potential import from_terms
from converse.orbits import potential
from converse.orbits.sweep import LOST, ONSET_COLUMNS
from converse.storage import files
from converse.storage.files import ConverseError

from moments import PATIENCE, SWEEP_HELD, wait_until

MODULE = sys.modules[orbits.sweep.__module__]   # its name in the package is the function's
VECTORS = [((5, 7), 9), ((3, 4), 5), ((12, 16), 21), ((1, 2), 4), ((2, 1), 8)]
EPS = [0.004, 0.01]
K_C = 0.971635406                               # Greene


@pytest.fixture
def path(tmp_path):
    return tmp_path / "table.csv"


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The bytes of the sweep of VECTORS."""
    file = tmp_path_factory.mktemp("sweep") / "whole.csv"
    orbits.sweep(orbits.trig, VECTORS, EPS, file=file)
    return file.read_bytes()


def read(path):
    """The table in a file."""
    return MODULE._table(path.read_text("utf-8"))


def same(table, other):
    """NaN, too."""
    return table.dtype == other.dtype and repr(table.tolist()) == repr(other.tolist())


# ---- growth and onset

def test_onsets_of_golden_approximants_tend_to_where_the_torus_breaks_up():
    found = {}
    for p, q in (((34,), 89), ((89,), 233), ((233,), 610)):
        below, above = orbits.onset(orbits.standard, p, q, width=1e-5)
        assert below.exponents[0] <= 1 / q < above.exponents[0]
        assert 0 < above.eps - below.eps <= 1e-5
        assert below.q == above.q == q and above.label == "minimum"
        found[q] = (below.eps + above.eps) / 2
    assert abs(found[89] - K_C) < 1e-3
    assert abs(found[233] - K_C) < 3e-4 and abs(found[610] - K_C) < 1e-4
    assert found[610] > K_C             # e against e^0.96: at the very onset nothing is closer


def test_greenes_residue_at_the_golden_onset():
    """The minimizing orbit's residue (2 - l - 1/l)/4 there tends to -0.2555: growth 0.968."""
    state = orbits.follow(orbits.standard, (233,), 610, [K_C])[0]
    assert -math.sinh(610 * state.exponents[0] / 2) ** 2 == pytest.approx(-0.2555, abs=0.001)


def test_a_saddle_is_no_onset(monkeypatch):
    """Whatever its exponents."""
    monkeypatch.setattr(orbits.PeriodicOrbit, "label", "saddle")
    assert orbits.onset(orbits.trig, (65, 86), 114, step=0.001, width=1e-4, top=0.004).above is None


def test_a_given_exponent_is_late():
    """The same for every q, and above the onset at 1/q, if it is the larger one."""
    free = orbits.onset(orbits.standard, (233,), 610)
    late = orbits.onset(orbits.standard, (233,), 610, exponent=0.01)
    assert free.above.eps < late.below.eps
    assert late.below.exponents[0] <= 0.01 < late.above.exponents[0]
    same = orbits.onset(orbits.standard, (233,), 610, exponent=1 / 610)
    assert (same.below.eps, same.above.eps) == (free.below.eps, free.above.eps)


def test_the_onsets_of_the_thesis_vectors():
    """Thesis, section 2.3: trig's first exponent leaves zero when the state contracts; 0.0080."""
    below, above = orbits.onset(orbits.trig, (1432, 1897), 2513, step=0.0005, width=5e-5)
    assert 0.0075 < below.eps < above.eps < 0.0085


def test_no_onset_up_to_the_end():
    below, above = orbits.onset(orbits.trig, (65, 86), 114, step=0.001, width=1e-4, top=0.0025)
    assert below.eps == 0.0025 and above is None


@pytest.mark.parametrize("how, words", [
    ({"width": 0}, "positive"), ({"step": -1}, "positive"),
    ({"step": 1e-4, "width": 1e-3}, "at most"),
    ({"top": math.inf}, "finite"), ({"width": math.nan}, "finite"),
    ({"exponent": 0}, "too small"), ({"exponent": math.nan}, "finite"),
    ({"exponent": 9e-6}, "too small")])
def test_onset_refuses(how, words):
    with pytest.raises(ValueError, match=words):
        orbits.onset(orbits.trig, (1, 1), 3, **how)


# ---- sweeps

def test_a_sweep_is_its_families(whole):
    table = orbits.sweep(orbits.trig, VECTORS, EPS)
    text = io.StringIO()
    families = [orbits.follow(orbits.trig, p, q, EPS) for p, q in VECTORS]
    orbits.Family(sum((family.states for family in families), ())).write_csv(text)
    assert whole.decode() == text.getvalue()
    assert len(table) == len(VECTORS) * len(EPS) and table.dtype["p"].shape == (2,)
    for k, state in enumerate(state for family in families for state in family):
        row = table[k]
        assert (tuple(row["p"]), row["q"], row["eps"]) == (state.p, state.q, state.eps)
        assert (row["action"], row["label"]) == (state.action, state.label)
        assert (row["exponent_1"], row["exponent_2"]) == tuple(state.exponents)


def test_the_table_is_read_again(path):
    table = orbits.onsets(orbits.standard, [((1,), 3), ((2,), 5)], file=path, width=0.001)
    assert same(read(path), table) and tuple(table.dtype.names) == ONSET_COLUMNS
    below, above = orbits.onset(orbits.standard, (2,), 5, width=0.001)
    assert table["p"].tolist() == [[1], [2]]
    assert table[1].tolist()[3:] == (
        above.label, below.eps, above.eps, below.exponents[0], above.exponents[0])
    path.write_text(path.read_text().replace("exponent", "stretch"))
    with pytest.raises(ValueError, match="no such columns"):
        read(path)


@pytest.mark.parametrize("kind, workers", [
    (concurrent.futures.ThreadPoolExecutor, 1), (concurrent.futures.ThreadPoolExecutor, 2),
    (concurrent.futures.ProcessPoolExecutor, 1), (concurrent.futures.ProcessPoolExecutor, 2)])
def test_whoever_works_the_bytes_are_the_same(whole, path, kind, workers):
    seen = []
    with kind(workers) as executor:
        table = orbits.sweep(orbits.trig, VECTORS, EPS, executor, path,
                             lambda done, of: seen.append((done, of)))
    assert path.read_bytes() == whole
    assert same(table, orbits.sweep(orbits.trig, VECTORS, EPS))
    assert seen == [(k, len(VECTORS)) for k in range(len(VECTORS) + 1)]


def test_users_potentials_go_to_other_processes():
    terms = {(1, 0): (0, -0.5), (0, 1): (0, -0.5), (1, 1): (0, -1)}
    for potential, vectors in ((fourier(terms, "mine"), VECTORS[:2]),
                               (orbits.potential.Fourier.of(from_terms(terms), "mine"),
                                VECTORS[:2])):
        with concurrent.futures.ProcessPoolExecutor(1) as executor:
            there = orbits.sweep(potential, vectors, EPS, executor)
        assert same(there, orbits.sweep(potential, vectors, EPS))
        assert set(there["potential"]) == {"mine"}


def test_a_dask_cluster():
    distributed = pytest.importorskip("distributed")
    with distributed.Client(processes=False, n_workers=1, threads_per_worker=2,
                            dashboard_address=None) as client:
        there = orbits.sweep(orbits.trig, VECTORS, EPS, client.get_executor())
    assert same(there, orbits.sweep(orbits.trig, VECTORS, EPS))


# ---- interrupted

def test_torn_anywhere(whole, path):
    """Cut after any byte the file is the beginning of the same sweep."""
    for size in [0, 1, 7, *range(40, len(whole) + 1, 97), len(whole) - 1, len(whole)]:
        path.write_bytes(whole[:size])
        orbits.sweep(orbits.trig, VECTORS, EPS, file=path)
        assert path.read_bytes() == whole, size


def test_what_is_finished_is_not_done_again(whole, path, monkeypatch):
    lines = whole.splitlines(keepends=True)
    path.write_bytes(b"".join(lines[:1 + 3 * len(EPS)]) + b"trig,1 2")
    found = []
    monkeypatch.setattr(MODULE, "follow", lambda v, p, q, *rest, **options: (
        found.append((p, q)), orbits.follow(v, p, q, *rest, **options))[1])
    seen = []
    orbits.sweep(orbits.trig, VECTORS, EPS, file=path, progress=lambda *done: seen.append(done))
    assert found == [VECTORS[3], VECTORS[4]]
    assert path.read_bytes() == whole and seen[0] == (3, 5)


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
        orbits.sweep(potential, vectors, eps, file=path)
    assert str(error.value).startswith(str(path)) and "\n" not in str(error.value)
    assert path.read_bytes() == whole


def test_a_table_of_onsets_is_not_one_of_states(path):
    orbits.onsets(orbits.standard, [((1,), 3), ((2,), 5)], file=path, width=0.001)
    data = path.read_bytes()
    with pytest.raises(ConverseError, match="columns"):
        orbits.sweep(orbits.standard, [((1,), 3), ((2,), 5)], EPS, file=path)
    assert path.read_bytes() == data


@pytest.mark.parametrize("data", [
    b"a letter\n", b"\0" * 100, b"\x89PNG\r\n\x1a\n", b"potential,q\n"])
def test_what_is_no_sweep_is_refused(path, data):
    path.write_bytes(data)
    with pytest.raises(ConverseError, match="columns are others"):
        orbits.sweep(orbits.trig, VECTORS, EPS, file=path)
    assert path.read_bytes() == data


@pytest.mark.parametrize("old, new", [(b"minimum,", b"minimum;"), (b",0.", b",zero."),
                                      (b"e-0", b"\xff-0")])
def test_a_damaged_sweep_is_refused(whole, path, old, new):
    """Here the last line with such words."""
    head, _, tail = whole.rpartition(old)
    path.write_bytes(head + new + tail)
    with pytest.raises(ConverseError, match="it is damaged"):
        orbits.sweep(orbits.trig, VECTORS, EPS, file=path)


def test_two_sweeps_do_not_write_one_file(path):
    with files.Lock(path), pytest.raises(ConverseError, match="another run"):
        orbits.sweep(orbits.trig, VECTORS, EPS, file=path)
    assert not path.exists()
    for place in (path.parent, path.parent / "none" / "table.csv", "/dev/full"):
        with pytest.raises(ConverseError, match="%s'?:" % place):
            orbits.sweep(orbits.trig, VECTORS, EPS, file=place)


def test_a_full_disk(whole, path):
    """What there is room for is written, said in a line, and continued."""
    result = subprocess.run([sys.executable, "-c", """
import resource, signal, sys
from converse import orbits
from converse.model.potential import from_terms
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))
try:
    orbits.sweep(orbits.trig, %r, %r, file=sys.argv[1])
except RuntimeError as error:
    print(type(error).__name__, error)
""" % (VECTORS, EPS), path], capture_output=True, text=True, timeout=PATIENCE)
    assert result.stderr == "" and result.stdout.count("\n") == 1
    assert result.stdout.startswith("ConverseError %s: cannot be written" % path)
    assert whole.startswith(path.read_bytes()) and 300 < path.stat().st_size <= 1000
    orbits.sweep(orbits.trig, VECTORS, EPS, file=path)
    assert path.read_bytes() == whole


MANY = """
import sys
from converse import orbits
if __name__ == "__main__":
    vectors = [((57, 76), 100 + k) for k in range(1, 41)]
    orbits.sweep(orbits.trig, vectors, [0.004, 0.008, 0.012], file=sys.argv[1], jobs=2)
"""


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGINT])
def test_killed_and_continued(path, number):
    """At once, and then again: in the end the bytes are those of one run."""
    other = path.parent / "whole.csv"
    subprocess.run([sys.executable, "-c", MANY, other], check=True, timeout=PATIENCE)
    lines, found = other.read_bytes().splitlines(keepends=True), 0
    for more in (8, 16):
        found += more
        there = b"".join(lines[:1 + 3 * found])
        with subprocess.Popen([sys.executable, "-c", SWEEP_HELD + MANY, str(more), path],
                              stderr=subprocess.DEVNULL) as process:
            try:
                wait_until(lambda: path.exists() and path.stat().st_size >= len(there), process)
                process.send_signal(number)
                assert process.wait(timeout=PATIENCE) != 0
            finally:
                process.kill()
        assert path.read_bytes() == there
    subprocess.run([sys.executable, "-c", MANY, path], check=True, timeout=PATIENCE)
    assert path.read_bytes() == other.read_bytes()


# ---- what goes wrong

def test_ctrl_c_ends_the_threads_too(monkeypatch):
    """One that is in the midst of a vector goes no further than to the next look at its flag."""
    relax, begun, ended = orbits.PeriodicOrbit.relax, threading.Event(), []

    def held(state, *arguments, **options):
        if state.q == VECTORS[1][1]:
            begun.set()
            assert potential._mine.stop.wait(PATIENCE)
        try:
            return relax(state, *arguments, **options)
        except KeyboardInterrupt:
            ended.append(state.q)
            raise

    def strike(done, of):
        if done == 1:
            assert begun.wait(PATIENCE)
            raise KeyboardInterrupt

    monkeypatch.setattr(orbits.PeriodicOrbit, "relax", held)
    with pytest.raises(KeyboardInterrupt):
        orbits.sweep(orbits.trig, VECTORS, EPS, progress=strike, jobs=1)
    assert ended == [VECTORS[1][1]]


def test_a_lost_branch_has_rows_without_numbers(path, monkeypatch):
    def lose(potential, p, q, eps, progress):
        if q == 5:
            eps = eps[:1]
        orbits.follow(potential, p, q, eps, progress)
        if q == 5:
            raise ConverseError("no orbit")

    monkeypatch.setattr(MODULE, "follow", lose)
    table = orbits.sweep(orbits.trig, VECTORS, EPS, file=path)
    assert [tuple(row) for row in np.argwhere(table["label"] == LOST)] == [(3,)]
    assert table["eps"].tolist() == EPS * len(VECTORS) and np.isnan(table["action"][3])
    assert same(read(path), table)
    monkeypatch.setattr(MODULE, "onset", lambda *_, **__: lose(orbits.trig, (1, 1), 5, EPS, None))
    assert orbits.onsets(orbits.trig, [((1, 1), 5)])["label"].tolist() == [LOST]


def test_the_solver_fails_and_smaller_steps_help(monkeypatch):
    """Only steps of less than 0.0003 succeed; then none does."""
    relax, tried = orbits.PeriodicOrbit.relax, []

    def fails(state, eps, **options):
        tried.append(eps - state.eps)
        if eps - state.eps > limit:
            raise ConverseError("no orbit")
        return relax(state, eps, **options)

    expected = orbits.onset(orbits.trig, (65, 86), 114, step=0.001, width=1e-4)
    monkeypatch.setattr(orbits.PeriodicOrbit, "relax", fails)
    limit = 0.0003
    found = orbits.onset(orbits.trig, (65, 86), 114, step=0.001, width=1e-4)
    assert (found.below.eps, found.above.eps) == (expected.below.eps, expected.above.eps)
    assert max(tried) > limit
    limit = 0.0
    with pytest.raises(ConverseError, match="no orbit"):
        orbits.onset(orbits.trig, (65, 86), 114, step=0.001, width=1e-4)
    assert min(tried) < 0.0025 / 64


class Deadly(orbits.Potential):
    """Ends every process that is sent this potential."""

    def __reduce__(self):
        return os._exit, (1,)


def test_a_worker_dies(path):
    potential = Deadly("deadly", (0.5, 0.5), lib.CV_FF)
    with concurrent.futures.ProcessPoolExecutor(1) as executor, \
            pytest.raises(ConverseError, match="workers are gone .*try again"):
        orbits.sweep(potential, [((1, 1), 3)], EPS, executor, path)
    assert path.read_text().count("\n") == 1        # the header: it can be continued


def test_what_goes_wrong_in_a_worker_comes_through(monkeypatch):
    def broken(state, *arguments):
        raise LookupError("mine")

    monkeypatch.setattr(orbits.PeriodicOrbit, "relax", broken)
    with concurrent.futures.ThreadPoolExecutor(1) as executor:
        for workers in None, executor:
            with pytest.raises(LookupError, match="mine"):
                orbits.sweep(orbits.trig, VECTORS, EPS, workers)


@pytest.mark.parametrize("arguments, words", [
    ((orbits.trig, [(1, 2)], EPS), "type"), ((orbits.trig, [((1, 2), 0)], EPS), "type"),
    ((orbits.trig, [((1,), 3)], EPS), "type"), ((orbits.trig, [7], EPS), "pair"),
    ((orbits.trig, VECTORS, []), "eps"), ((orbits.trig, VECTORS, [math.nan]), "eps")])
def test_bad_arguments(path, arguments, words):
    with pytest.raises(ValueError, match=words):
        orbits.sweep(*arguments, file=path)
    assert not path.exists()


def test_an_executor_that_is_none(path):
    with pytest.raises(TypeError, match="executor"):
        orbits.sweep(orbits.trig, VECTORS, EPS, executor=2, file=path)


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
