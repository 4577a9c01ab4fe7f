"""Calls in processes of their own: in order, whoever is quicker, and whoever dies."""

import contextlib
import functools
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from converse.check.processes import ProcessDied, in_order

import calls
from moments import PATIENCE


@pytest.fixture(autouse=True)
def begun(monkeypatch):
    """The processes of the test, all of which have ended at its end."""
    begin, begun = subprocess.Popen, []

    def started(*arguments, **options):
        begun.append(begin(*arguments, **options))
        return begun[-1]

    monkeypatch.setattr(subprocess, "Popen", started)
    yield begun
    assert all(process.returncode is not None for process in begun)


def answers(call, items, jobs=2):
    with contextlib.closing(in_order(call, items, jobs, contextlib.nullcontext)) as found:
        yield from found


@pytest.mark.slow
def test_results_are_in_order_and_few_are_in_memory(tmp_path):
    taken = []

    def items():
        for n in range(40):
            taken.append(n)
            yield n

    found = answers(functools.partial(calls.large_square, tmp_path), items())
    assert next(found)[0] == 0 and len(taken) == 8
    assert [n for n, _ in found] == [n * n for n in range(1, 40)]


@pytest.mark.slow
def test_as_many_processes_as_there_is_work(begun):
    assert {*answers(calls.process_id, range(100), 3)} <= {each.pid for each in begun}
    assert len(begun) <= 3
    begun.clear()
    assert list(answers(calls.process_id, [], 3)) == [] and not begun
    assert list(answers(calls.process_id, [1], 3)) == [begun[0].pid] and len(begun) == 1


def test_an_exception_is_raised_in_its_turn(tmp_path):
    """However early it is known."""
    found = answers(functools.partial(calls.inverse, tmp_path), range(1000))
    assert next(found) == 1
    with pytest.raises(ZeroDivisionError):
        next(found)


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM])
def test_a_process_that_is_killed_at_work_is_told(tmp_path, number):
    """The other one is at work, too, and the next piece of work is larger than a pipe."""
    with pytest.raises(ProcessDied):
        list(answers(functools.partial(calls.killed, tmp_path, number),
                     ((n, b"x" * (1 << 20)) for n in range(100))))


@pytest.mark.parametrize("program", ["/bin/false", "/no/such/program", "", None])
def test_a_process_that_dies_before_its_first_word_is_told(capfd, monkeypatch, program):
    monkeypatch.setattr(sys, "executable", program)
    with pytest.raises(ProcessDied):
        list(answers(abs, range(9)))
    assert capfd.readouterr() == ("", "")


@pytest.mark.slow
def test_what_cannot_be_sent_fails():
    """The call, or its result."""
    with pytest.raises(AttributeError, match="pickle"):
        list(answers(lambda n: n, range(9)))
    with pytest.raises(ProcessDied):
        list(answers(calls.function, range(9)))


def test_what_a_call_prints_is_no_answer(capfd):
    assert list(answers(calls.printed, range(9))) == list(range(9))
    assert capfd.readouterr().out == ""


def test_processes_end_with_their_parent(tmp_path):
    code = """if True:
        import contextlib, functools, sys
        sys.path.append(sys.argv[1])
        sys.path.append(sys.argv[2])
        import calls
        from converse.check.processes import in_order
        call = functools.partial(calls.at_work, sys.argv[3])
        list(in_order(call, range(2), 2, contextlib.nullcontext))
        """
    pipe, (here, above, *_) = tmp_path / "pipe", Path(__file__).parents
    os.mkfifo(pipe)
    run = subprocess.Popen([sys.executable, "-c", code, here, above, pipe])
    with open(pipe, "rb", 0) as file:
        assert file.readline() + file.readline() == b"at work\n" * 2
        run.kill()
        run.wait(PATIENCE)
        assert file.read() == b""       # the processes, which had it open, have ended
