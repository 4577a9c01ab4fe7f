"""How the checker runs: as one file, in processes, interrupted, and from Python."""

import ast
import contextlib
import gzip
import itertools
import multiprocessing
import os
import re
import shutil
import signal
import subprocess
import sys
import threading
import time
from fractions import Fraction

import pytest
from files import sealed, tree_of

from converse import check as package

from checker import check, start_of_workers
from moments import PATIENCE
from trees import part_of, with_field
from truth import TORTURE

pytestmark = pytest.mark.usefixtures("impatient")
# Of a process without sanitizers, which may import what lies about its file.
PLAIN = {name: value for name, value in os.environ.items()
         if name not in ("LD_PRELOAD", "PYTHONSAFEPATH", "PYTHONPATH")}


@pytest.mark.parametrize("start, filler, status", [
    (b"", b"\n", 2), (b"converse proof 6\n", b"\0", 5),
    (b"converse proof 6\ntree:\n", b"0P", 5)])
def test_a_bomb_is_bounded(one_file, tmp_path, start, filler, status):
    """A file of kilobytes that unpacks to gigabytes, in a process with a gigabyte."""
    path = tmp_path / "bomb.gz"
    part = gzip.compress(filler * (1 << 20), 9)
    path.write_bytes(gzip.compress(start) + part * (1 + (300 << 20) // (len(filler) << 20)))
    done = alone(one_file, path, before="import resource; "
                              "resource.setrlimit(resource.RLIMIT_AS, [1 << 30] * 2)")
    assert (done.returncode, done.stdout) == (status, "") and done.stderr.count("\n") == 1
    assert "limit" in done.stderr or "not a proof file" in done.stderr


def alone(one_file, *arguments, before="", stdin=None):
    """Runs a process that has nothing but Python and the one file."""
    code = before + "; import runpy, sys; sys.argv = sys.argv[1:]; " \
        "runpy.run_path(sys.argv[0], run_name='__main__')"
    return subprocess.run([sys.executable, "-I", "-S", "-c", code.lstrip("; "), one_file,
                           *map(str, arguments)], capture_output=True, text=True, stdin=stdin,
                          env=PLAIN)


FOLDER = os.path.dirname(package.__file__)


def made(home):
    """What `make checker` makes of the sources of the checker in a folder."""
    subprocess.run(["make", "-s", "-C", home, "checker", "PYTHON=" + sys.executable], check=True,
                   stdout=subprocess.DEVNULL)
    return home / "build" / "converse-check.pyz"


@pytest.fixture(scope="module")
def sources(root, tmp_path_factory):
    """A folder with the Makefile and the sources of the checker alone."""
    home = tmp_path_factory.mktemp("sources")
    shutil.copy(root / "Makefile", home)
    shutil.copytree(FOLDER, home / "converse" / "check",
                    ignore=shutil.ignore_patterns("__pycache__"))
    return home


@pytest.fixture(scope="module")
def one_file(sources):
    return made(sources)


@pytest.mark.skipif(sys.version_info < (3, 10), reason="it cannot name its own modules")
@pytest.mark.quick
def test_it_imports_nothing_of_the_program(root):
    """Python's own modules, numpy, and its own: nothing else, however deep in a function."""
    for file in sorted((root / "converse" / "check").rglob("*.py")):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            names = []
            if isinstance(node, ast.Import):
                names = [alias.name for alias in node.names]
            elif isinstance(node, ast.ImportFrom):
                assert node.level < 2, "%s, line %d" % (file, node.lineno)
                names = [node.module] if node.level == 0 else []
            elif isinstance(node, ast.Name):
                assert node.id not in ("__import__", "exec", "eval"), file
            for name in names:
                assert name.split(".")[0] in {*sys.stdlib_module_names, "numpy"}, (file, name)
            assert "import_module" not in str(getattr(node, "attr", "")), file


def test_the_one_file_says_the_same(texts, moving, diagram, one_file, run, tmp_path):
    """Of the same files, good and bad, one with numpy and the next without; word for word."""
    bad = with_field(texts["trig274"], "c", "0.617 0.618")
    large = sealed(with_field(texts["trig278"], "a", "1e200 0"))
    cases = [part_of(texts["trig278"]), diagram, bad, large, "junk",
             moving["narrow box"]]
    path, statuses = tmp_path / "some.proof", set()
    fast, exact = (("-I",), ("--jobs", "2")), (("-I", "-S"), ("--exact",))
    for text, (isolated, options) in zip(cases, itertools.cycle((fast, exact))):
        status, out, err = run(text, *options)
        statuses.add(status)
        done = subprocess.run([sys.executable, *isolated, one_file, path, *options],
                              capture_output=True, text=True, env=PLAIN, cwd=tmp_path)
        found = done.returncode, done.stdout, done.stderr.replace(str(path), "FILE")
        assert found == (status, out, err)
    assert statuses == {0, 1, 2, 3, 5}


def test_help_names_every_status(capsys):
    assert check.main(["--help"]) == 0
    out = capsys.readouterr().out
    for status, word in enumerate(("verified", "rejected", "bad usage", "part of the torus",
                                   "spot check", "not confirmed")):
        assert re.search("(?m)^  %d  .*%s" % (status, word), out)


@pytest.mark.parametrize("stream", [">&-", "> /dev/full", "2>&-", ">&- 2>&-"])
def test_streams_that_are_closed_or_full(texts, one_file, tmp_path, stream):
    """No success without a report, and no traceback."""
    path = tmp_path / "x"
    path.write_text(texts["trig278"], encoding="utf-8")
    done = subprocess.run(["bash", "-c", "set -o pipefail; \"$@\" " + stream, "-", sys.executable,
                           one_file, path], capture_output=True, text=True)
    assert "Traceback" not in done.stderr and done.stderr.count("\n") <= 1
    assert done.returncode == 0 if stream == "2>&-" else done.returncode == 2


@pytest.mark.parametrize("arguments", [["--help"], ["--version"], []])
@pytest.mark.parametrize("form", ["package", "one file"])
def test_a_reader_that_has_enough_is_no_failure(texts, one_file, tmp_path, form, arguments):
    path = tmp_path / "x"
    path.write_text(texts["trig278"], encoding="utf-8")
    read, write = os.pipe()
    os.close(read)
    done = subprocess.run([sys.executable, *(["-m", "converse.check"] if form == "package" else
                                             [one_file]), *(arguments or [path])],
                          stdout=write, stderr=subprocess.PIPE, text=True,
                          env={**os.environ, "PYTHONUNBUFFERED": ""})
    os.close(write)
    assert (done.returncode, done.stderr) == (141, "")


def test_the_example_of_the_format(root, run):
    page = (root / "docs/reference/proof-file.md").read_text(encoding="utf-8")
    example = page[page.rindex("    converse proof 6\n"):].split("\n\n")[0]
    status, out, _ = run("".join(line[4:] + "\n" for line in example.split("\n")))
    assert status == 0 and out.startswith("Verified :")


def test_the_format_names_what_the_checker_knows(root, texts, monkeypatch):
    """Each field, each limit, each status; and nothing that is in no file."""
    monkeypatch.undo()                          # the limits themselves
    page = (root / "docs/reference/proof-file.md").read_text(encoding="utf-8")
    header = page[page.index("## The header"):page.index("## The tree")]
    names = set(re.findall("`([^`\n]+)`", header)) - {"sound", "yes", "no", "0", "1", "3",
                                                      "upper end", "as printed, not a proof"}
    assert names == check.FIELDS | check.OPTIONAL
    fields = (root / "docs/reference/map-file.md").read_text(encoding="utf-8")
    names = re.findall("(?m)^\\| ((?:`[a-z]+`,? ?)+) \\|", fields.partition("## What")[0])
    assert set(re.findall("`([a-z]+)`", " ".join(names))) == (
        check.DIAGRAM.needed | check.DIAGRAM.optional)
    for value in (check.MAX_CHARACTERS, check.MAX_CUTS, check.MAX_BITS, check.MAX_SITES,
                  check.MAX_PIECES, check.MAX_HALVINGS):
        assert re.search("\\b{:,}\\b".format(value), page[page.index("limits: "):])
    assert 1 << 28 == check.MAX_BYTES and 1 << 24 == check.MAX_LINE and 10 ** 300 == check.MAX_SIZE
    for status in range(6):
        assert "\n| %d | " % status in page


@pytest.fixture(scope="module")
def long(moving, tmp_path_factory):
    """A proof file whose check takes a second or two, and the pieces that it takes."""
    path = tmp_path_factory.mktemp("long") / "proof"
    path.write_text(moving["segment"], encoding="utf-8")
    return path, re.search("in [0-9]+ pieces", check.verify(path, exact=True).text).group()


def test_a_signal_that_waited():
    """As a library the checker leaves signals as they were, whoever's handler raises."""
    for handler in (signal.default_int_handler, check.interrupt):
        before, waited = signal.signal(signal.SIGINT, handler), False
        try:
            with pytest.raises(KeyboardInterrupt), check.undisturbed():
                signal.pthread_kill(threading.get_ident(), signal.SIGINT)
                time.sleep(0.01)                # not here
                waited = True
        finally:
            for number in check.SIGNALS:
                signal.signal(number, signal.SIG_DFL)
            signal.signal(signal.SIGINT, before)
        assert waited and check._late is None and not signal.pthread_sigmask(signal.SIG_BLOCK, [])


@pytest.mark.parametrize("jobs", ["1", "3"])
def test_killed_at_random_moments(long, tmp_path, generator, jobs):
    """It ends with the status of its signal and one line, and leaves no process and no file."""
    path, pieces = long
    kinds = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGKILL]
    code = """
import signal
signal.signal(2, signal.SIG_DFL)                # as Python starts and ends
import sys
sys.path.insert(0, sys.argv.pop(1))
from check import main, progress
progress.LINE_SECONDS = 1e9
print(flush=True)
sys.exit(main())
"""
    command = [sys.executable, "-I", "-c", code, os.path.dirname(FOLDER), path, "--jobs", jobs,
               "--exact"]
    for n in range(12 * min(TORTURE, 2)):
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   text=True, start_new_session=True, cwd=tmp_path)
        process.stdout.readline()
        kind = kinds[n % 4]
        time.sleep(0.5 * generator.random())
        if process.poll() is None:
            (os.killpg if n % 3 else os.kill)(process.pid, kind)
        out, err = process.communicate(timeout=PATIENCE)
        with contextlib.suppress(ProcessLookupError, PermissionError):
            for _ in range(10 * PATIENCE):              # a worker that is left ends by itself
                os.killpg(process.pid, 0)
                time.sleep(0.1)
            raise AssertionError("a process is left")
        assert "Traceback" not in err and err.count("\n") <= 1
        if out:                                 # it is done, even if struck after its last word
            assert pieces in out
        elif n % 3 and "a worker process died" in err:
            assert process.returncode == 2          # the whole group was struck, a worker first
        else:
            assert process.returncode in (-kind, 128 + kind), err
            assert process.returncode < 0 or "interrupted; nothing was verified" in err
        assert not os.listdir(tmp_path)


def test_a_worker_that_dies(deep, run, monkeypatch):
    """It is said, and nothing is verified."""
    left = tree_of(deep).count("P") - 100
    last = [cell for at, cell in check.leaves(tree_of(deep)) if tree_of(deep)[at] == "P"][left]
    with monkeypatch.context() as patch:
        patch.setattr(check, "START", start_of_workers("""if True:
            import os
            from converse.check.criterion import Criterion
            excluded = Criterion.excluded
            Criterion.excluded = lambda self, cell: (
                os._exit(3) if cell == %r else excluded(self, cell))
            """ % (last,)))
        status, out, err = run(deep, "--jobs", "2", "--exact")
    assert (status, out) == (2, "")
    assert "a worker process died, perhaps for lack of memory; nothing was verified\n" in err
    assert err.count("\n") == 1


@pytest.mark.parametrize("method", ["spawn", "forkserver", "fork"])
def test_processes_never_run_the_main_module(texts, tmp_path, method):
    """A script without a guard, whatever it says of how multiprocessing is to start processes."""
    if method not in multiprocessing.get_all_start_methods():
        pytest.skip("multiprocessing has no %s here" % method)
    path, script = tmp_path / "proof", tmp_path / "script.py"
    path.write_text(texts["trig274"], encoding="utf-8")
    script.write_text("""if True:
        import multiprocessing, sys
        print("the script runs")
        multiprocessing.set_start_method(sys.argv[1])
        from converse import check
        print(check.verify(sys.argv[2], jobs=2, exact=True).verdict)
        """, encoding="utf-8")
    done = subprocess.run([sys.executable, script, method, path], capture_output=True, text=True,
                          timeout=PATIENCE)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == "the script runs\nverified\n"


def test_a_worker_whose_numpy_is_not_sound_uses_integers(np, texts, run, monkeypatch):
    """However sound it was in the parent."""
    exact = run(texts["trig274"], "--exact")[1]
    assert "Method : Loewner criterion, multipliers, in integers" in exact
    monkeypatch.setattr(check, "FAST_CHUNK", (16, 32))
    monkeypatch.setattr(check, "START", start_of_workers("""if True:
        import os
        from converse.check import lockstep, workers
        workers.import_numpy_if_sound = lambda: False
        lockstep.Lockstep.settle = lambda *_: os._exit(3)
        """))
    assert run(texts["trig274"], "--jobs", "2") == (0, exact, "")


def test_narrow_cells_do_not_make_the_bound_of_beta_slow(texts, tmp_path, monkeypatch):
    """Cells of width 1e-999 need 3,400 bits; B needs no more than 256 to be as good."""
    torus_bound, bits = check.torus_bound, []

    def bound(fixed, *rest):
        bits.append(fixed.bits)
        return torus_bound(fixed, *rest)

    monkeypatch.setattr(check, "torus_bound", bound)
    found = []
    for text in texts["trig278"], sealed(with_field(texts["trig278"], "v0", "0.5 1e-999")):
        (tmp_path / "proof").write_text(text, encoding="utf-8")
        criterion = check.Criterion(check.read(tmp_path / "proof"))
        found.append(Fraction(criterion.B, criterion.fixed.one))
    assert criterion.fixed.bits > 3000 and max(bits) == 256 and len(bits) == 2
    assert abs(found[0] - found[1]) < Fraction(1, 2 ** 80)


def test_a_failure_of_its_own_is_no_success(deep, run, monkeypatch):
    for error in (MemoryError(), OSError(11, "Resource temporarily unavailable"), KeyError("x")):
        def fails(self, cell):
            raise error
        monkeypatch.setattr(check.Criterion, "excluded", fails)
        monkeypatch.setattr(check.Lockstep, "attempt", lambda *_: fails(*_[:2]))
        for options in ((), ("--exact",)):
            status, out, err = run(deep, *options)
            assert (status, out) == (2, "") and "the checker failed" in err
            assert err.count("\n") == 1


def test_the_bar(deep, tmp_path, monkeypatch, capsys):
    """On a terminal; it says how many leaves are confirmed and goes away."""
    path = tmp_path / "x"
    path.write_text(deep, encoding="utf-8")
    monkeypatch.setattr(check, "BAR_SECONDS", 1e-3)
    assert check.main([str(path)]) == 0
    assert capsys.readouterr().err == ""                # a line is not due yet
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    for options, shown in ((["--quiet"], False), ([], True)):
        assert check.main([str(path), *options]) == 0
        err = capsys.readouterr().err
        assert (" leaves" in err) == shown
    steps = [int(n.replace(",", "")) for n in re.findall("\r0:00:[0-9]{2} ([0-9,]+) of", err)]
    assert steps == sorted(steps)
    assert err.endswith("\r" + " " * (len(err.split("\r")[-4])) + "\r")


def test_lines_where_there_is_no_terminal(deep, run, monkeypatch, tmp_path, capsys):
    """Now and then, also while a task is not done; not in quiet, and not from Python unless asked
    for."""
    monkeypatch.setattr(check, "LINE_SECONDS", 0.01)
    status, out, err = run(deep, "--exact")
    assert status == 0 and out.startswith("Verified :")
    steps = [int(n.replace(",", "")) for n in re.findall(
        "(?m)^converse-check: 0:00:[0-9]{2} ([0-9,]+) of [0-9,]+ leaves$", err)]
    assert len(steps) == err.count("\n") > len(set(steps)) > 1 and steps == sorted(steps)
    assert run(deep, "--quiet") == (0, "", "")
    check.verify(tmp_path / "some.proof")
    assert capsys.readouterr() == ("", "")


def test_results_and_exceptions(texts, deep, tmp_path):
    path = tmp_path / "x"
    for text, options, status in (
            (texts["trig278"], {}, 0), (part_of(texts["trig274"]), {}, 3),
            (texts["trig278"], {"sample": 1}, 4), (texts["trig278"], {"jobs": 2}, 0)):
        path.write_text(text, encoding="utf-8")
        result = check.verify(path, **options)
        assert result.status == status and bool(result) == (status == 0)
        assert result.verdict == {0: "verified", 3: "verified in part", 4: "spot check"}[status]
    for text, failure in ((texts["trig278"][:-1], check.Rejected), ("x", check.Unusable),
                          (sealed(with_field(deep, "xstar", "0 0")), check.NotConfirmed)):
        path.write_text(text, encoding="utf-8")
        with pytest.raises(failure):
            check.verify(path)
    for wrong in ({"jobs": 0}, {"sample": 0}, {"sample": -1}):
        with pytest.raises(ValueError):
            check.verify(path, **wrong)


@pytest.mark.parametrize("options", [(), ("--sample", "1")])
@pytest.mark.parametrize("kind", ["proof", "part", "diagram"])
@pytest.mark.quick
def test_nothing_is_verified_if_a_leaf_is_not_confirmed(texts, diagram, run, tmp_path, monkeypatch,
                                                        kind, options):
    """Whatever the reason, as here that the leaves are not looked at."""
    text = {"proof": texts["trig278"], "part": part_of(texts["trig274"]),
            "diagram": diagram}[kind]
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(check, "check_leaves", lambda *_: (0, 0, 0))
    status, out, err = run(text, *options)
    assert (status, out) == (2, "") and re.search("the checker failed .RuntimeError: [01] of ", err)
