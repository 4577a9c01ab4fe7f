"""Calls for the processes of test_processes.py, which import this module and no test."""

import os
import time

from moments import PATIENCE


def wait_for(path):
    until = time.monotonic() + PATIENCE
    while not path.exists() and time.monotonic() < until:
        time.sleep(0.005)


def large_square(folder, n):
    """The first call ends after the others that may be given meanwhile."""
    if n == 0:
        wait_for(folder / "7")
    (folder / str(n)).touch()
    return n * n, b"x" * (1 << 18)              # more than a pipe holds


def process_id(_):
    return os.getpid()


def inverse(folder, n):
    """The second call ends first."""
    if n == 0:
        wait_for(folder / "1")
    (folder / str(n)).touch()
    return 1 // (1 - n)


def killed(folder, number, item):
    """The first process is killed while the second works."""
    at, _ = item
    (folder / str(at)).touch()
    wait_for(folder / str(1 - at))
    if at == 0:
        os.kill(os.getpid(), number)
    time.sleep(1e6)


def printed(n):
    os.write(1, b"words")
    print("more words", flush=True)
    return n


def function(_):
    return lambda: 0


def at_work(path, _):
    with open(path, "wb", 0) as file:
        file.write(b"at work\n")
        time.sleep(1e6)
