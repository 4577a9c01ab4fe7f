"""The same tree, counts and theorem however the work is divided, and whoever dies on the way."""

import concurrent.futures
import contextlib
import math
import os
import random
import re
import signal
import subprocess
import sys
import time
from fractions import Fraction

import pytest
from conftest import ROOT, around
from files import line

from converse import ConverseError, Proof, __version__, prove
from converse.model.exact import decimal_text
from converse.prover import native, run, shared, tree, workers
from converse.prover.settings import Settings

from moments import PATIENCE
from truth import TORTURE

LONG = line("0.01405", "0.0149")            # a third of a second, 27,696 leaves


@pytest.fixture(autouse=True)
def early(monkeypatch):
    """Hands the work to an executor from the beginning, in smaller tasks than usual."""
    monkeypatch.setattr(native, "LOOK_SECONDS", 0.005)
    monkeypatch.setattr(run, "ALONE_LEAVES", 0)
    monkeypatch.setattr(shared, "TASK_SECONDS", 0.02)
    monkeypatch.setattr(shared, "TASK_RATIO", 0)


@pytest.fixture
def ends(monkeypatch):
    """ends(when): the time of a search that has begun is up when the test says so."""
    def ends(when):
        monkeypatch.setattr(run._Run, "_seconds_left", lambda self: (
            -math.inf if self.search is not None and when(self) else math.inf))
    return ends


@pytest.fixture(scope="module")
def proof():
    return prove(LONG, method="loewner", jobs=1)


def test_threads(proof):
    assert proof.no_tori
    for jobs in (2, 3, 7):
        assert prove(LONG, method="loewner", jobs=jobs) == proof


def test_the_method_of_the_thesis_too():
    a, b = Fraction("0.306"), Fraction("0.00125")
    problem = around((a, a, 2 * a, Fraction(1), Fraction(1)),
                      (b, b, 2 * b, Fraction(1), Fraction(1)))
    with concurrent.futures.ThreadPoolExecutor(3) as executor:
        assert prove(problem, executor=executor, method="thesis") == prove(
            problem, jobs=1, method="thesis")


@pytest.mark.parametrize("stubborn", [False, True])
def test_undecided_prisms(stubborn):
    problem = line("0.0100", "0.0280")
    alone, many = (prove(problem, depth=13, stubborn=stubborn, method="loewner", jobs=jobs)
                   for jobs in (1, 3))
    assert alone.undecided and alone == many
    with concurrent.futures.ThreadPoolExecutor(3) as executor:
        assert prove(problem, depth=13, stubborn=stubborn, method="loewner",
                     executor=executor) == alone


def test_processes(proof):
    with concurrent.futures.ProcessPoolExecutor(2) as executor:
        assert prove(LONG, method="loewner", executor=executor) == proof


def die(*args):
    raise OSError("the worker died")


def test_workers_that_die():
    class Dead(concurrent.futures.ThreadPoolExecutor):
        def submit(self, work, *args):
            return super().submit(die)

    with Dead(2) as executor, pytest.raises(ConverseError, match="are gone.*the worker died"):
        prove(LONG, method="loewner", executor=executor)


def test_an_executor_that_is_gone():
    executor = concurrent.futures.ThreadPoolExecutor(1)
    executor.shutdown()
    with pytest.raises(ConverseError, match="workers are gone"):
        prove(LONG, method="loewner", executor=executor)


def test_time_limit_and_resume(proof, tmp_path, ends):
    """The time is up after some thousands of cuts, and again, and again."""
    path, runs, cuts = tmp_path / "a.proof", 1, 0
    ends(lambda self: (self.counts_before + self.view.counts).cuts > cuts + 2000)
    result = prove(LONG, method="loewner", jobs=3, backup=path)
    while not result.all_decided:
        assert Proof.load(path) == result and result.counts.cuts > cuts
        cuts, runs = result.counts.cuts, runs + 1
        result = prove(resume=path, jobs=3)
    assert runs > 1 and result == Proof.load(path) == proof


class Inline(concurrent.futures.Executor):
    """Works in the thread that asks."""

    def submit(self, work, *args):
        future = concurrent.futures.Future()
        future.set_result(work(*args))
        return future


@pytest.mark.parametrize("error, depth", [(KeyboardInterrupt, 120), (MemoryError, 120),
                                          (KeyboardInterrupt, 15), (MemoryError, 15)])
def test_interrupted_anywhere(error, depth, tmp_path, monkeypatch):
    """Whatever line of the bookkeeping an exception strikes, what was saved leads to the same
    tree."""
    monkeypatch.setattr(shared, "TASK_SECONDS", 0.001)
    monkeypatch.setattr("converse.storage.backup.SECONDS", 0.005)
    problem, path = line("0.0165", "0.0280"), tmp_path / "a.proof"
    whole = prove(problem, method="loewner", jobs=1, depth=depth)
    assert whole.no_tori == (depth == 120)
    rng, struck, lines = random.Random(1), [], [0, 0]

    def trace(frame, event, _):
        if frame.f_code.co_filename != shared.__file__ or "self" not in frame.f_locals:
            return None
        if event == "line":
            lines[0] += 1
            if lines[0] == lines[1]:
                struck.append(lines[0])
                raise error
        return trace

    most, runs = 0, 12 * TORTURE            # the lines of the last run that was not struck
    for _ in range(runs):
        path.unlink(missing_ok=True)
        before, lines[:] = len(struck), [0, rng.randrange(20, most) if most else 0]
        sys.settrace(trace)
        try:
            prove(problem, method="loewner", executor=Inline(), jobs=5, backup=path, depth=depth)
        except error:
            assert len(struck) > before
        finally:
            sys.settrace(None)
        most = lines[0] if len(struck) == before else most
        if path.exists():
            result = prove(resume=path, jobs=1)
            assert result == whole
    assert len(struck) > runs / 2


KILLED = """
import os, signal, sys
from converse import prove
from converse.prover import native, run
from converse.storage import backup
sys.path[:0] = %r
from test_parallel import LONG
path, resume, cuts, torn = sys.argv[1:]
backup.SECONDS = backup.SHARE = 0               # it is written at every look
native.LOOK_SECONDS = 0.005
looked = run._Run._look
def kill(*_):
    os.kill(os.getpid(), signal.SIGKILL)
def look(self):
    there = (self.counts_before + self.search.view().counts).cuts > int(cuts)
    if there and torn:
        os.replace = kill                       # while it is written
    end = looked(self)
    if there:
        kill()
    return end
run._Run._look = look
prove(jobs=2, **({"resume": path} if resume else {"source": LONG, "backup": path}))
"""


def test_a_killed_coordinator_goes_on_from_its_backup(proof, tmp_path):
    path, code = tmp_path / "a.proof.gz", KILLED % [os.path.dirname(__file__), str(ROOT / "tests")]
    for cuts, torn in (5000, ""), (10000, "torn"), (15000, "torn"), (20000, ""):
        killed = subprocess.run([sys.executable, "-c", code, path, path if path.exists() else "",
                                 str(cuts), torn], cwd=tmp_path, timeout=PATIENCE)
        assert killed.returncode == -signal.SIGKILL
        half = Proof.load(path)
        assert not half.no_tori and (torn or half.counts.cuts > cuts)
    assert prove(resume=path) == Proof.load(path) == proof


@pytest.fixture(scope="module")
def dask(tmp_path_factory):
    """A Dask cluster here, and a client of it.  A worker takes a second to start."""
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(
            n_workers=0, threads_per_worker=1, processes=True, dashboard_address=None,
            local_directory=str(tmp_path_factory.mktemp("dask"))) as made, \
            distributed.Client(made, timeout=PATIENCE) as client:
        yield made, client


@pytest.fixture
def cluster(dask, monkeypatch):
    """cluster(n): the cluster and its client, when it has n workers; it is asked at every turn."""
    made, client = dask
    monkeypatch.setattr(workers, "ASK_SECONDS", 0)

    def cluster(n):
        made.scale(n)
        end = time.monotonic() + PATIENCE
        while len(client.nthreads()) != n:
            assert time.monotonic() < end
            time.sleep(0.005)
        return dask
    return cluster


def test_dask_without_workers(proof, cluster):
    """They are waited for, which is said; a cluster that adapts starts one, since there is a
    task."""
    made, client = cluster(0)
    adaptive = made.adapt(minimum=0, maximum=1)
    with pytest.warns(RuntimeWarning, match="no workers; waiting"):
        assert prove(LONG, method="loewner", executor=client.get_executor()) == proof
    adaptive.stop()


@pytest.mark.parametrize("name, value, words", [
    ("ANSWER", workers.ANSWER.replace("converse", "no_such_package"), "has no.*no_such_package"),
    ("__version__", "0.1", "needs converse 0.1 and has %s" % __version__)])
def test_dask_without_this_program(cluster, monkeypatch, name, value, words):
    """A worker that lacks it, or has another release, says so."""
    monkeypatch.setattr(workers, name, value)
    _, client = cluster(1)
    with pytest.raises(workers.WorkersGone, match=words):
        prove(LONG, method="loewner", executor=client.get_executor())


def test_dask_workers_that_join_later(proof, ends, cluster):
    """They are given work: one worker has two tasks at a time."""
    _, client = cluster(1)
    executor = client.get_executor()
    submit, submitted, under_way = executor.submit, [], [0]

    def submit_and_grow(*args):
        if len(submitted) == 3:
            cluster(2)
            client.run(eval, "__import__('converse.prover.shared')")     # before time is short
        submitted.append(submit(*args))
        under_way.append(sum(not future.done() for future in submitted))
        return submitted[-1]

    executor.submit = submit_and_grow
    ends(lambda self: max(under_way) > 3)
    half = prove(line("0.0140", "0.0280"), method="loewner", executor=executor)
    assert not half.all_decided and max(under_way[:4]) <= 3


def test_dask_loses_a_worker(proof, cluster):
    _, client = cluster(2)
    pid = next(iter(client.run(os.getpid).values()))
    executor, submitted = client.get_executor(), []

    def submit(*args, submit=executor.submit):
        submitted.append(submit(*args))
        if len(submitted) == 3:
            os.kill(pid, signal.SIGKILL)
        return submitted[-1]

    executor.submit = submit
    assert prove(LONG, method="loewner", executor=executor, jobs=4) == proof
    assert len(submitted) > 3


def test_a_scheduler_that_does_not_answer_is_called_so():
    """Its process may be stopped, or its machine: nobody knows what workers there are."""
    class Silent:
        status, submit = "running", None

        def nthreads(self, callback_timeout):
            raise TimeoutError

    executor = Silent()
    executor._client = executor
    with pytest.warns(RuntimeWarning, match="the Dask scheduler does not answer; waiting"):
        assert workers.WorkerPool(executor, None).size == 0


def test_dask_loses_its_scheduler(tmp_path, proof):
    """What was found is saved, one line says so, and the command ends."""
    distributed = pytest.importorskip("distributed")
    code = """
import os, signal, sys
from converse.commands.prove import main
from converse.prover import run, shared
run.ALONE_LEAVES = shared.TASK_RATIO = 0
shared.TASK_SECONDS = 0.01
took, grow, scheduler = [], shared.Shared._take, int(sys.argv.pop(1))
def take(self, part, grown):
    grow(self, part, grown)
    took.append(part)
    if len(took) == 5:
        os.kill(scheduler, signal.SIGKILL)
shared.Shared._take = take
sys.exit(main())
"""
    with contextlib.ExitStack() as stack:
        def start(*arguments):
            process = subprocess.Popen([sys.executable, *arguments, "--no-dashboard"],
                                       text=True,
                                       cwd=tmp_path, stdout=subprocess.DEVNULL,
                                       stderr=subprocess.PIPE)
            stack.callback(process.kill)
            return process

        scheduler = start("-c", "import sys; sys.modules['converse'] = None; from distributed.cli."
                          "dask_scheduler import main; main()",     # It needs no converse.
                          "--host", "127.0.0.1", "--port", "0")
        address = next(re.search(r"tcp://127.0.0.1:[0-9]+", said)[0] for said in scheduler.stderr
                       if "Scheduler at" in said)
        start("-m", "distributed.cli.dask_worker", address, "--no-nanny", "--nthreads", "1")
        (tmp_path / "a.in").write_text(input_text(LONG))
        result = subprocess.run(
            [sys.executable, "-c", code, str(scheduler.pid), "--dask", address, "--method",
             "loewner",
             "--together", "-b", "a.proof", "a.in"], cwd=tmp_path, capture_output=True, text=True,
            timeout=PATIENCE)
    assert distributed and result.returncode == 2
    assert result.stderr.endswith("converse: the Dask scheduler is gone; continue with -r "
                                  "a.proof\n")
    assert all(line.startswith("converse: ") for line in result.stderr.splitlines())
    half = Proof.load(tmp_path / "a.proof")
    assert half.tree and not half.no_tori
    assert prove(resume=half, jobs=2).tree == proof.tree


def input_text(problem):
    return "\n".join("%s %s" % tuple(map(decimal_text, pair))
                     for pair in zip(problem.centre, problem.half)) + "\n"


class Late(Inline):
    """Brings last what was given to it first, that is, what is leftmost of the tree: when nothing
    else is there to be waited for."""

    def __init__(self):
        self.late = []

    def submit(self, work, *arguments):
        if self.late:
            return super().submit(work, *arguments)
        future = concurrent.futures.Future()
        self.late.append(lambda: future.set_result(work(*arguments)))
        return future

    def wait(self, futures, *rest, wait=concurrent.futures.wait):
        if not any(future.done() for future in futures) and self.late:
            self.late.pop()()
        return wait(futures, *rest)


@pytest.mark.parametrize("jobs", [2, 5])
def test_an_undecided_prism_before_finished_ones(tmp_path, monkeypatch, jobs):
    """A search that is not stubborn ends at the first; what others did beyond it is of no
    account."""
    executor, taken, take = Late(), [], shared.Shared._take
    monkeypatch.setattr(shared.Shared, "_take", lambda self, part, grown: (
        taken.append(next((n for n, each in enumerate(self.known) if each.cells is part), None)),
        take(self, part, grown)))
    monkeypatch.setattr(concurrent.futures, "wait", executor.wait)
    grow = native.Search.grow           # a task ends after 40 leaves, however slow the machine is
    monkeypatch.setattr(native.Search, "grow", lambda self, cells, look: grow(self, cells, 40))
    problem, path = line("0.0170", "0.0280"), tmp_path / "a.proof"
    alone = prove(problem, method="loewner", depth=15, jobs=1)
    assert alone.undecided
    many = prove(problem, method="loewner", depth=15, executor=executor, jobs=jobs, backup=path)
    assert any(taken)                   # it did go that way
    assert many == alone and "Undecided  1 prism, " in many.report()
    deeper = prove(resume=path, depth=120, executor=executor,
                   jobs=jobs)    # and it can be continued
    assert deeper.no_tori and deeper.counts.undecided == 0
    assert deeper.counts.proved == deeper.tree.count("P") and deeper.verify()


def test_continuing_less_stubbornly_is_refused(tmp_path):
    path = tmp_path / "a.proof"
    half = prove(line("0.0145", "0.0155"), method="loewner", depth=20, stubborn=True, backup=path)
    before = path.read_bytes()
    assert half.tree.count("U") > 1
    with pytest.raises(ConverseError, match="stubborn"):
        prove(resume=path, stubborn=False)
    assert path.read_bytes() == before
    assert prove(resume=path, stubborn=False, depth=120).no_tori


@pytest.mark.parametrize("stubborn", [False, True])
def test_what_is_examined_never_falls(ends, stubborn):
    """It is the share of the volume that lies in leaves, whoever is at work."""
    seen = []
    ends(lambda self: self.view.counts.cuts > 1000)
    half = prove(line("0.0130", "0.0280"), method="loewner", jobs=3, depth=22, stubborn=stubborn,
                 progress=lambda examined, _: seen.append(examined))
    assert seen == sorted(seen) and seen[0] == 0 and 0 < seen[-1] < 1
    volume = sum(0.5 ** sum(cuts) for kind, (_, cuts) in tree.cells(half.tree)
                 if kind != tree.UNTRIED)
    assert seen[-1] == pytest.approx(volume, rel=1e-12) or not stubborn and volume < seen[-1]


def test_what_lies_beyond_an_undecided_prism_is_not_its_own():
    """Unless the search is stubborn: then the next part follows as always."""
    def part(text):
        return native.Grown(text, counts=native.Counts(**dict(zip(tree.NODES, tree.count(text)))))

    for stubborn, text in (False, "0U"), (True, "0UP"):
        task = native.Task(LONG, Settings("loewner", stubborn=stubborn))
        search = shared.Shared(task, native.Grown(), None)
        search.known = [part("0U"), part("P")]
        view = search.view(True)
        assert view.finished and view.text == text
        assert (view.counts.proved, view.counts.undecided) == (int(stubborn), 1)


def test_one_prism_that_may_need_a_longer_orbit_is_remembered():
    """Whatever the tasks that end after it say."""
    tasks = [native.Grown(cells=[((0,), (cuts,), 0)]) for cuts in (1, 2)]
    search = shared.Shared(native.Task(LONG, Settings()), native.Grown(), None)
    search.known = tasks
    for task, needs_long in zip(tasks, (True, False)):
        search._take(task.cells, native.Grown("P", needs_long=needs_long))
    assert search.view().needs_long and search.view(True).text == "PP"
