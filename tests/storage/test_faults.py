"""What goes wrong around a run: kill -9, Ctrl-C, closed pipes, full disks, terminals."""

import contextlib
import fcntl
import os
import pty
import random
import re
import resource
import shutil
import signal
import struct
import subprocess
import sys
import termios
import time
from pathlib import Path

import pytest

from converse import Proof
from converse.prover.portrait import Portrait
from converse.storage import backup as keeping
from converse.storage import files

from moments import BEGUN, HELD, PATIENCE, wait_until
from truth import STRIKE, TORTURE

# The backup is written
ALWAYS = """
from converse.prover import native
from converse.storage import backup
native.LOOK_SECONDS = backup.SECONDS = backup.SHARE = 0
"""
RARELY = """
from converse.storage import backup
backup.SECONDS = 1e9                            # but when it begins and when it ends
"""


@pytest.fixture(scope="session")
def sample(root):
    return root / "inputs" / "trig272.in"


@pytest.fixture(scope="session")
def output(command, sample):
    """Of a run that nothing goes wrong with."""
    status, out, err = command(sample)
    assert (status, err) == (0, "")
    return timeless(out)


@pytest.fixture
def held(tmp_path_factory):
    """The command at work, with some prisms decided and no end of it until the sign is removed."""
    @contextlib.contextmanager
    def held(*arguments, before="", leaves=20):
        sign = tmp_path_factory.mktemp("held") / "sign"
        with _started(before + HELD, sign, leaves, "--jobs", 1, *arguments) as process:
            wait_until(sign.exists, process)
            yield process, sign
    return held


@pytest.fixture
def begun(tmp_path_factory):
    """The command in the middle of setting a search up; the sign tells if it was stopped there."""
    @contextlib.contextmanager
    def begun(*arguments):
        sign = tmp_path_factory.mktemp("begun") / "sign"
        with _started(BEGUN, sign, *arguments) as process:
            wait_until(sign.exists, process)
            yield process, sign
    return begun


@contextlib.contextmanager
def _started(code, *arguments):
    with subprocess.Popen([sys.executable, "-c", code, *map(str, arguments)],
                          stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        try:
            yield process
        finally:
            process.kill()


def ended(process):
    """What it wrote on stderr until its end."""
    return process.communicate(timeout=PATIENCE)[1].decode()


def timeless(text):
    text = re.sub(r"took [0-9.]+ seconds", "took ... seconds", text)
    return re.sub(r"Proof file : .*\n", "", text)


@pytest.mark.parametrize("seed", range(20, 20 + max(1, TORTURE)))
def test_kill_at_random_moments(held, command, sample, output, tmp_path, seed):
    """While it writes its backup, which it always does."""
    rng = random.Random(seed)
    backup = tmp_path / "backup"
    trees, arguments = [""], ["-b", backup, sample]
    for _ in range(5):
        with held(*arguments, before=ALWAYS, leaves=5) as (process, _):
            wait_until(lambda: len(Proof.load(backup).tree) > len(trees[-1]), process)
            time.sleep(rng.uniform(0, 0.2))
            process.kill()
        half = Proof.load(backup)       # whole, whenever the run was killed
        assert half.tree.startswith(trees[-1]) and not half.no_tori
        trees.append(half.tree)
        arguments = ["-r", backup]
    status, out, err = command(*arguments)
    assert (status, timeless(out).split("Restored")[0], err) == (0, output, "")
    whole = Proof.load(backup)
    assert whole.no_tori and whole.tree.startswith(trees[-1])


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_interrupt(held, command, sample, output, tmp_path, number):
    backup = tmp_path / "backup"
    with held("-b", backup, sample) as (process, _):
        process.send_signal(number)
        out, err = process.communicate(timeout=PATIENCE)
    assert process.returncode == 128 + number
    assert err.decode() == "converse: interrupted; continue with -r %s\n" % backup
    assert out == b""
    half = Proof.load(backup)
    assert half.tree and not half.no_tori
    status, out, err = command("-r", backup)
    assert (status, timeless(out).split("Restored")[0]) == (0, output)


@pytest.fixture
def struck(root, tmp_path):
    """Strikes a portrait, which a pool of threads finds, where some code says; it can be
    continued."""
    def struck(code, number):
        path = tmp_path / "a.portrait"
        process = subprocess.run(
            [sys.executable, "-c", STRIKE + code + """
from converse.commands.portrait import main
sys.exit(main())
""", "--jobs", "1", "--columns", "12", "--depth", "7", "-b", path,
             root / "inputs" / "standard-k090.in"],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=PATIENCE)
        assert process.returncode == 128 + number, process.stderr
        assert process.stderr == "converse-portrait: interrupted; continue with -r %s\n" % path
        half = Portrait.load(path)
        assert len(half.found) < len(half.stars)
    return struck


@pytest.mark.parametrize("seen", [0, 1, 3])
def test_struck_inside_the_locks_of_a_pool(struck, seen):
    """A RuntimeError of the library is no traceback, and loses nothing."""
    struck("""
from converse.prover import workers
took, seen = workers.WorkerPool._take, []
def take(self):
    seen.append(self)
    if len(seen) > %d:
        sys.setprofile(strike)
    return took(self)
workers.WorkerPool._take = take
""" % seen, signal.SIGTERM)


def test_struck_with_the_lock_of_a_future(struck):
    """The lock is released; else the worker would wait for it, and the program for the worker."""
    struck("""
def strike(frame, event, arg):
    if event == "c_return" and type(frame.f_locals.get("self")).__name__ == "_AcquireFutures" and \\
            frame.f_code.co_name == "__enter__":
        sys.setprofile(None)
        os.kill(os.getpid(), signal.SIGINT)
from converse.prover import workers
took = workers.WorkerPool._take
def take(self):
    if self.running:
        sys.setprofile(strike)
    return took(self)
workers.WorkerPool._take = take
""", signal.SIGINT)


def test_struck_while_a_thread_is_begun(struck):
    """That is no lack of memory."""
    struck(STRIKE.replace("if not frame:", "if frame:") + """
from converse.prover import workers
start = workers.WorkerPool._submit
def start_and_be_struck(*arguments):
    sys.setprofile(strike)
    return start(*arguments)
workers.WorkerPool._submit = start_and_be_struck
""", signal.SIGTERM)


def test_interrupt_without_backup(held, sample):
    with held(sample) as (process, _):
        process.send_signal(signal.SIGINT)
        err = ended(process)
    assert process.returncode == 130
    assert err.startswith("converse: interrupted") and err.count("\n") == 1


def test_closed_pipe(held, sample, tmp_path):
    backup = tmp_path / "backup"
    with held("-p20", "-b", backup, sample) as (process, sign):
        process.stdout.close()
        sign.unlink()
        err = process.stderr.read().decode()
        assert process.wait(timeout=PATIENCE) == 128 + signal.SIGPIPE
    assert err == ""
    assert Proof.load(backup).no_tori


@pytest.mark.parametrize("argument", ["-p20", "--help", "--version"])
def test_full_standard_output(command, sample, argument):
    with open("/dev/full", "wb") as full:
        status, _, err = command(argument, sample, stdout=full)
    assert status == 2
    assert err == "converse: the output cannot be written (No space left on device)\n"


def test_full_disk_keeps_the_older_backup(held, command, sample, tmp_path):
    backup = tmp_path / "backup"
    with held("-b", backup, sample) as (process, _):
        process.send_signal(signal.SIGINT)
        ended(process)
    before = backup.read_bytes()

    def small_files():
        resource.setrlimit(resource.RLIMIT_FSIZE, (100, 100))

    status, out, err = command("-r", backup, preexec_fn=small_files)
    assert status == 2
    assert err.startswith("converse: %s: cannot be written" % backup) and err.count("\n") == 1
    assert "intact" in err
    assert backup.read_bytes() == before
    assert command("-r", backup, "--time-limit", "0")[0] == 1


def test_full_disk_in_mid_run(held, sample, tmp_path):
    """One warning, however often it is tried again; and at the end what the file is good for."""
    backup = tmp_path / "backup"
    with held("-b", backup, sample, before=ALWAYS) as (process, _):
        wait_until(lambda: Proof.load(backup).tree, process)
        resource.prlimit(process.pid, resource.RLIMIT_FSIZE, (100, 100))
        warning = process.stderr.readline().decode()
        before = backup.read_bytes()
        process.send_signal(signal.SIGINT)
        err = ended(process)
    assert process.returncode == 2
    assert warning.startswith("converse: %s: cannot be written" %
                              backup) and "tries again" in warning
    assert re.fullmatch(r"converse: interrupted; \S+: cannot be written .*; what was found after "
                        r"the first "
                        r"[0-9.]+ seconds of the search is not saved\n", err)
    assert backup.read_bytes() == before


class Disk:
    """Some of a proof, and whether there is room for it."""
    seconds, full = 1.5, False

    def save(self, path):
        if self.full:
            raise files.ConverseError("%s: no room" % path)
        return "sha256"


def test_a_warning_for_each_time_that_the_disk_is_full(tmp_path, monkeypatch):
    monkeypatch.setattr(keeping, "SECONDS", 0)
    monkeypatch.setattr(keeping, "SHARE", 0)
    disk = Disk()
    with keeping.Backup(tmp_path / "a") as keeper, pytest.warns(RuntimeWarning) as said:
        for full in 0, 1, 1, 1, 0, 0, 1, 1:
            disk.full = full
            keeper.update(lambda: disk)
        assert len(said) == 2 and not any(each.category is files.NotSaved for each in said)
        assert keeper.finish(disk) == ""
        disk.full = False
        assert keeper.finish(disk) == "sha256"
    assert len(said) == 3 and said[2].category is files.NotSaved
    assert "after the first 1.50 seconds of the search is not saved" in str(said[2].message)


def test_full_disk_for_the_figure(command, root, tmp_path):
    def small_files():
        resource.setrlimit(resource.RLIMIT_FSIZE, (100, 100))

    figure = tmp_path / "figure.pdf"
    status, out, err = command("-g", figure, root / "inputs" / "trig278.in",
                               preexec_fn=small_files)
    assert status == 2 and "I find no invariant tori" in out
    assert err.startswith("converse: ") and err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_two_runs_with_one_backup(held, command, sample, tmp_path):
    backup = tmp_path / "backup"
    with held("-b", backup, sample) as (process, _):
        status, out, err = command("-r", backup)
        process.kill()
    assert status == 2 and out == ""
    assert "another run" in err and err.count("\n") == 1
    assert command("-r", backup, "--time-limit", "0")[0] == 1     # the lock died with its holder


@pytest.mark.parametrize("redirection, status, said", [
    ("<&-", 2, b"converse: standard input is closed; name an input file\n"),
    (">&-", 2, b"converse: the standard output is closed; there is nowhere to report to\n"),
    ("2>&- <&-", 2, b""), ("2>&- <%s", 0, b"")])
def test_closed_streams(root, redirection, status, said):
    """Where standard error is closed the theorem is reported all the same."""
    program = Path(sys.executable).parent / "converse"
    if "%s" in redirection:
        redirection %= root / "inputs" / "trig278.in"
    result = subprocess.run(["sh", "-c", '"$0" -p20 ' + redirection, str(program)],
                            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                            stderr=subprocess.PIPE, check=False)
    assert (result.returncode, result.stderr) == (status, said)
    assert (b"I find no invariant tori" in result.stdout) == (status == 0)


def test_progress_on_a_terminal_only(start, command, sample):
    assert command("-p20", sample)[2] == ""
    master, slave = pty.openpty()
    fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("4H", 24, 80, 0, 0))
    with start("-p20", sample, stderr=slave) as process:
        os.close(slave)
        shown = b""
        try:
            while True:
                piece = os.read(master, 4096)
                if not piece:
                    break
                shown += piece
        except OSError:                 # the other end is closed
            pass
        out = process.stdout.read()
    os.close(master)
    assert process.returncode == 0 and b"I find no invariant tori" in out
    assert b"prisms proved" in shown and b"% of parameters x torus done" in shown
    assert shown.endswith(b" \r") and b"prisms proved," not in out


def test_reading_from_a_terminal_says_so(start):
    """Whoever types the command alone is told what it waits for."""
    master, slave = pty.openpty()
    with start(stdin=slave) as process:
        os.close(slave)
        said = process.stderr.readline().decode()
        os.write(master, b"0.32 0\n0.32 0\n0.64 0\n1 1\n1 1\n\x04")
        out = process.communicate(timeout=PATIENCE)[0].decode()
        os.close(master)
    assert said == "converse: reading the problem from standard input; end it with Ctrl-D\n"
    assert process.returncode == 0 and "I find no invariant tori" in out


@pytest.mark.parametrize("options", [["-p", "100000"], ["-p", "100000", "--time-limit", "0.5"]])
def test_long_arithmetic_obeys(begun, sample, options):
    """Ctrl-C and the time limit also count while the search is set up, in the middle of it."""
    with begun(*options, sample) as (process, sign):
        if "--time-limit" not in options:
            process.send_signal(signal.SIGINT)
        ended(process)
    assert process.returncode == (1 if "--time-limit" in options else 130)
    assert sign.read_text() == ""


@pytest.mark.parametrize("first, second", [
    (signal.SIGTERM, signal.SIGHUP), (signal.SIGHUP, signal.SIGTERM),
    (signal.SIGINT, signal.SIGTERM),
    (signal.SIGINT, signal.SIGINT)])
def test_two_signals_at_once(held, sample, tmp_path, first, second):
    """As at the end of a session; the second must not strike while the first is obeyed."""
    for pause in (0.0, 0.005, 0.03):
        backup = tmp_path / ("%g.proof" % pause)
        with held("-b", backup, sample, before=RARELY) as (process, _):
            process.send_signal(first)
            time.sleep(pause)
            process.send_signal(second)
            err = ended(process)
        assert process.returncode in (128 + first, 128 + second)
        assert err == "converse: interrupted; continue with -r %s\n" % backup
        half = Proof.load(backup)
        assert half.tree and not half.no_tori


def test_a_lock_that_is_gone(held, root, tmp_path):
    """Whatever became of the lock, or of the directory, what was found is said."""
    for gone in "lock", "directory":
        home = tmp_path / gone
        home.mkdir()
        backup = home / "a.proof"
        with held("--method", "loewner", "--together", "-b", backup, root / "inputs" / "trig180.in",
                  before=RARELY) as (process, sign):
            os.unlink(str(backup) + ".lock")
            if gone == "directory":
                shutil.rmtree(home)     # where nobody writes at this moment
            sign.unlink()
            out, err = (text.decode() for text in process.communicate(timeout=PATIENCE))
        assert out.startswith("THEOREM\n")
        if gone == "lock":
            assert (process.returncode, err) == (0, "") and Proof.load(backup).no_tori
        else:
            assert process.returncode == 2 and err.endswith("is not saved\n")


def test_interrupted_before_anything_was_found(begun, sample, tmp_path):
    backup = tmp_path / "a.proof"
    with begun("-p", "100000", "-b", backup, sample) as (process, _):
        process.send_signal(signal.SIGINT)
        err = ended(process)
    assert process.returncode == 130 and err == "converse: interrupted; nothing was found yet\n"
    assert not backup.exists()
