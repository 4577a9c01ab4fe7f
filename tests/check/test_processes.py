"""Calls in processes of their own: in order, whoever is quicker, and whoever dies."""

import contextlib
import multiprocessing
import os
import signal
import subprocess
import sys
import time

import pytest

from converse.check.processes import ProcessDied, in_order

from moments import PATIENCE

pytestmark = pytest.mark.skipif(multiprocessing.get_start_method() != "fork",
                                reason="functions within a test cannot be pickled")


def answers(call, items, jobs=2):
    with contextlib.closing(in_order(call, items, jobs, contextlib.nullcontext)) as found:
        yield from found


def wait_for(path):
    until = time.monotonic() + PATIENCE
    while not path.exists() and time.monotonic() < until:
        time.sleep(0.005)


def test_results_are_in_order_and_few_are_in_memory(tmp_path):
    """The first call ends after the others that may be given meanwhile."""
    taken = []

    def items():
        for n in range(40):
            taken.append(n)
            yield n

    def call(n):
        if n == 0:
            wait_for(tmp_path / "7")
        (tmp_path / str(n)).touch()
        return n * n, b"x" * (1 << 18)          # more than a pipe holds

    found = answers(call, items())
    assert next(found)[0] == 0 and len(taken) == 8
    assert [n for n, _ in found] == [n * n for n in range(1, 40)]
    assert not multiprocessing.active_children()


def test_as_many_processes_as_there_is_work():
    assert len(set(answers(lambda _: os.getpid(), range(100), 3))) <= 3
    assert list(answers(lambda _: os.getpid(), [], 3)) == []
    here, = answers(lambda _: len(multiprocessing.active_children()), [1], 3)
    assert here == 0


def test_an_exception_is_raised_in_its_turn(tmp_path):
    """However early it is known."""
    def call(n):
        if n == 0:
            wait_for(tmp_path / "1")
        (tmp_path / str(n)).touch()
        return 1 // (1 - n)

    found = answers(call, range(1000))
    assert next(found) == 1
    with pytest.raises(ZeroDivisionError):
        next(found)
    assert not multiprocessing.active_children()


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM])
def test_a_process_that_is_killed_at_work_is_told(tmp_path, number):
    """The other one is at work, too, and the next piece of work is larger than a pipe."""
    def call(item):
        at, _ = item
        (tmp_path / str(at)).touch()
        wait_for(tmp_path / str(1 - at))
        if at == 0:
            os.kill(os.getpid(), number)
        time.sleep(1e6)

    with pytest.raises(ProcessDied):
        list(answers(call, ((n, b"x" * (1 << 20)) for n in range(100))))
    assert not multiprocessing.active_children()


def test_processes_end_with_their_parent():
    code = """if True:
        import contextlib, os, time
        from converse.check.processes import in_order
        def call(n):
            os.write(1, b"at work\\n")
            time.sleep(1e6)
        list(in_order(call, range(2), 2, contextlib.nullcontext))
        """
    run = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True)
    assert [run.stdout.readline() for _ in range(2)] == ["at work\n"] * 2
    run.kill()
    assert run.communicate(timeout=PATIENCE)[0] == ""           # the pipe is closed: all have ended
