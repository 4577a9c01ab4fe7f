"""Pieces of a range that are proved at the same time, in processes of their own."""

import multiprocessing
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace

import pytest

from converse.check import processes
from converse.model.problem import Problem
from converse.storage.files import ConverseError
from converse.tori import proved
from converse.tori.effort import proving, some
from converse.tori.find import find
from converse.tori.proved import NotProved, prove
from converse.tori.rotation import read_rotation

RANGE = Problem.patch(["0.45"], [["0.35"]], [(1, 0)])
GOLDEN = read_rotation("golden")


@pytest.fixture(scope="module")
def pieces():
    found = find(RANGE, GOLDEN)
    assert len(found) == 2
    return found


def test_two_pieces_at_a_time_are_the_same_proof(pieces):
    words = []
    one, two = prove(pieces), prove(pieces, jobs=3, progress=words.append)
    assert [piece.torus for piece in two.pieces] == pieces
    for name in "residual", "verdict", "constants", "rho", "tried", "grid", "bits", "norm":
        assert [getattr(piece, name) for piece in one.pieces] == \
            [getattr(piece, name) for piece in two.pieces]
    assert words == ["proving 2 pieces, 2 at a time", "1 of 2 pieces are proved",
                     "2 of 2 pieces are proved"]


def test_what_one_process_cannot_prove_is_not_proved(pieces):
    """The reason comes through, with its numbers."""
    with pytest.raises(NotProved) as error:
        prove(pieces, jobs=2, bits=24)
    assert error.value.residual > error.value.needed
    assert "balls of 24 bits are too few" in str(error.value)
    with pytest.raises(NotProved, match="0.05 GB may be used; give .* fewer jobs"):
        prove(pieces, jobs=2, shape=(1, 1 << 20), memory=10 ** 8)


def test_no_jobs_are_refused(pieces):
    with pytest.raises(ValueError, match="jobs is 0; at least one"):
        prove(pieces, jobs=0)


def test_a_process_that_dies_is_told(pieces, monkeypatch, tmp_path):
    """In the midst of its work, while the other one works, too."""
    class Attempt:
        def __init__(self, torus, *_):
            self.at = int(torus.piece[0] != -1)

        def run(self):
            (tmp_path / str(self.at)).touch()
            while not (tmp_path / str(1 - self.at)).exists():
                time.sleep(0.005)
            if self.at == 0:
                os.kill(os.getpid(), signal.SIGKILL)
            time.sleep(600)

    monkeypatch.setattr(proved, "_Attempt", Attempt)
    with pytest.raises(ConverseError, match="died, perhaps for lack of memory; let fewer work"):
        prove(pieces, jobs=2)
    assert not multiprocessing.active_children()


def test_memory_is_shared(pieces, monkeypatch):
    given = []

    class Attempt:
        def __init__(self, *arguments):
            given.append(arguments[-2])

        def run(self):
            raise NotProved("enough")

    def here(call, items, jobs, postponed):
        yield from map(call, items)

    monkeypatch.setattr(proved, "_Attempt", Attempt)
    monkeypatch.setattr(processes, "in_order", here)
    with pytest.raises(NotProved):
        prove(pieces, jobs=2, memory=10 ** 9)
    with pytest.raises(NotProved):
        prove(pieces, memory=10 ** 9)
    assert given == [10 ** 9 // 2, 10 ** 9]


@pytest.mark.parametrize("seconds, words", [
    (1.9, ""), (2, ", some 2 s"), (119, ", some 119 s"), (130, ", some 2.2 min"),
    (7200, ", some 2 h")])
def test_how_long_it_takes_is_said_in_words(seconds, words):
    assert some(seconds) == words


def test_a_longer_step_is_said_to_take_longer(pieces):
    """In seconds that the points of a grid take, 12 microseconds each for the residual, more with
    longer balls, and 25 for the inverse, which is made on grids of 1/4, 1/8, ... of them."""
    single = find(Problem.patch(["0.9"], (), [(1, 0)]), GOLDEN)
    first, second = pieces
    for torus in single, first, second:
        layers = 1 if torus is single else 1 << torus.degree.bit_length()
        points = 1
        while points < 2.3 * len(torus.modes):
            points *= 2
        assert proving(torus) == pytest.approx(layers * points * (12e-6 + 25e-6 / 2))
        assert proving(replace(torus, bits=129)) == pytest.approx(
            layers * points * (1.6 * 12e-6 + 25e-6 / 2))


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_all_processes(tmp_path, number):
    """In the midst of the proofs, of which one would take minutes."""
    code = """if True:
        import sys, time
        from converse.commands import tori as cli
        from converse.tori import proved
        class Attempt:
            def __init__(self, torus, *_):
                pass
            def run(self):
                sys.stdout.write("proving\\n")
                sys.stdout.flush()
                time.sleep(600)
        proved._Attempt = Attempt
        sys.exit(cli.main(sys.argv[1:]))
        """
    problem, file = tmp_path / "range.in", tmp_path / "range.torus"
    problem.write_text("0.45 0.35\n0 0\n0 0\n1 1\n1 1\n")
    run = subprocess.Popen([sys.executable, "-c", code, "prove", str(problem), "--rotation",
                            "golden", "--jobs", "2", "-b", str(file)], text=True,
                           stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert any(line == "proving\n" for line in run.stdout)
    run.send_signal(number)
    out, err = run.communicate(timeout=300)     # the pipes are closed, so the processes have ended
    assert run.returncode == 128 + number
    assert err == "converse-tori: interrupted; nothing is proved\n" and "I find" not in out
    assert [each.name for each in tmp_path.iterdir()] == ["range.in"]
