"""A signal at any moment at which Python looks for one, as its profiling lets a test choose."""

import errno
import io
import os
import random
import signal
import subprocess
import sys

import pytest

from converse import Proof, prove
from converse.storage import backup, files, signals
from converse.storage.signals import ENDING, interruptible, postponed

from truth import TORTURE


class Strikes:
    """Sends SIGINT at the n-th call or return in this thread, n = 1, 2, ...: there Python looks for
    signals."""

    def __init__(self):
        self.steps, self.at = 0, 0

    def __call__(self, frame, event, _):
        if frame.f_code is not Strikes.run.__code__:
            self.steps += 1
            if self.steps == self.at:
                os.kill(os.getpid(), signal.SIGINT)

    def run(self, call, at):
        """Was there such a step?  What call() raises, but for KeyboardInterrupt, is passed on."""
        self.steps, self.at, struck = 0, at, False
        sys.setprofile(self)
        try:
            call()
        except KeyboardInterrupt:
            struck = True
        finally:
            sys.setprofile(None)
        assert struck == (self.steps >= at)             # none is lost, none comes from nowhere
        return struck


@pytest.fixture(autouse=True)
def handlers():
    """They are afterwards what they were before, and nothing is left that would postpone
    signals."""
    before = list(map(signal.getsignal, ENDING))
    yield
    assert list(map(signal.getsignal, ENDING)) == before
    assert signals._depth == 0 and not signals._due


def test_handlers_are_restored_whenever_a_signal_comes(handlers):
    def call():
        with interruptible(ENDING), interruptible(), postponed():
            pass

    strikes, n = Strikes(), 1
    while strikes.run(call, n):
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
        n += 1
    assert n > 30


def test_only_the_first_signal_counts():
    with pytest.raises(KeyboardInterrupt), interruptible() as came:
        try:
            signal.raise_signal(signal.SIGINT)
        except KeyboardInterrupt:
            signal.raise_signal(signal.SIGINT)
            assert came.heard == [signal.SIGINT] * 2
            raise


@pytest.mark.parametrize("second", [signal.SIGINT, signal.SIGTERM])
def test_two_signals_are_one_whenever_the_second_comes(second):
    """Also while Python runs the handler of the first."""
    def trace(frame, event, _):
        nonlocal steps
        if frame.f_code is not signals._interrupt.__code__:
            return None
        frame.f_trace_opcodes = True
        steps += event == "opcode"
        if event == "opcode" and steps == at:
            signal.raise_signal(second)
        return trace

    at, steps, struck = 0, 0, 0
    while at <= steps:
        at, steps, caught = at + 1, 0, 0
        with interruptible(ENDING) as came:
            sys.settrace(trace)
            try:
                signal.raise_signal(signal.SIGINT)
                with postponed():                       # an exception may wait until here
                    pass
            except KeyboardInterrupt:
                caught += 1
            sys.settrace(None)
            with postponed():
                pass
            struck += len(came.heard) == 2
        assert caught == 1
    assert struck > 20


def test_a_signal_that_python_does_not_pass_on_is_raised_later():
    """As what is raised in a __del__ is not."""
    class Last:
        def __del__(self):
            os.kill(os.getpid(), signal.SIGINT)
            struck.append(True)

    struck, hook, passed = [], sys.unraisablehook, False
    with pytest.raises(KeyboardInterrupt), interruptible(ENDING):
        Last()
        passed = True
        with postponed():
            pass
    assert passed and not struck and sys.unraisablehook is hook


def test_a_handler_of_the_users_own_stays():
    heard = []
    before = signal.signal(signal.SIGINT, lambda *_: heard.append(1))
    try:
        with interruptible():
            signal.raise_signal(signal.SIGINT)
    finally:
        signal.signal(signal.SIGINT, before)
    assert heard == [1]


def test_a_lock_is_released_whenever_a_signal_comes(tmp_path):
    def call():
        with interruptible(), files.Lock(tmp_path / "a"):
            pass

    strikes, n = Strikes(), 1
    while strikes.run(call, n):
        assert not list(tmp_path.iterdir())
        with files.Lock(tmp_path / "a"):                # it is nobody's
            pass
        n += 1
    assert n > 50


def test_a_proof_is_left_as_it_is_whenever_a_signal_comes(root, tmp_path, monkeypatch):
    """There is no lock left and no other file, and what was saved leads to the same tree."""
    from converse import read_input

    monkeypatch.setattr(backup, "SECONDS", 0)
    problem, path = read_input(root / "inputs" / "trig278.in"), tmp_path / "a.proof"
    whole, rng = prove(problem, jobs=2, method="thesis").tree, random.Random(1)
    strikes = Strikes()
    for _ in range(15 * TORTURE):
        path.unlink(missing_ok=True)
        strikes.run(lambda: prove(problem, jobs=2, backup=path, method="thesis"),
                    rng.randint(1, 8000))
        assert set(os.listdir(tmp_path)) <= {"a.proof"}
        if path.exists():
            half = Proof.load(path)
            assert prove(resume=half, jobs=1).tree == whole


def test_ctrl_c_while_a_full_disk_is_written(tmp_path, monkeypatch):
    """The failure to close the file does not take the interrupt's place."""
    class Full(io.BytesIO):
        def write(self, data):
            signal.raise_signal(signal.SIGINT)
            return len(data)

        def close(self):
            raise OSError(errno.ENOSPC, "no space is left")

    def opened(handle, _):
        os.close(handle)
        return Full()

    monkeypatch.setattr(files, "open", opened, raising=False)
    with pytest.raises(KeyboardInterrupt), interruptible():
        files.write(tmp_path / "file", b"text")
    assert list(tmp_path.iterdir()) == []


EARLY = """
import importlib, os, signal
from converse import commands
importlib.import_module = lambda *_: os.kill(os.getpid(), signal.SIGINT)
commands.start_prove()
"""


def test_a_signal_while_a_command_is_loaded():
    done = subprocess.run([sys.executable, "-c", EARLY], capture_output=True)
    assert (done.returncode, done.stderr) == (-signal.SIGINT, b"")
