"""The command: its flags, its messages, its exit status."""

import hashlib
import io
import os
import re
import subprocess
import sys

import pytest

from converse import Proof, check
from converse.commands import common
from converse.commands.prove import main
from converse.version import __version__

GOOD = b"0.3085 0.00125\n0.3085 0.00125\n0.617 0.0025\n\n1.0 1.0\n1.0 1.0\n\n"


@pytest.fixture(scope="session")
def sample(root):
    return root / "inputs" / "trig274.in"


@pytest.fixture(scope="session")
def output(command, sample):
    status, out, err = command("-d30", stdin=sample.read_bytes())
    assert (status, err) == (0, "")
    return timeless(out)


@pytest.fixture
def run(capfd, monkeypatch):
    """Runs the command in this process: (exit status, stdout, stderr).  Other processes run it for
    the fixture `output`, which its reports equal."""
    def run(*arguments, stdin=b""):
        monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(stdin)))
        status = main([str(argument) for argument in arguments])
        return (status, *capfd.readouterr())
    return run


def timeless(text):
    return re.sub(r"took [0-9.]+ seconds", "took ... seconds", text)


def one_line(err):
    """A diagnostic is one line and no traceback."""
    return err.startswith("converse: ") and err.endswith("\n") and err.count("\n") == 1


@pytest.mark.parametrize("arguments", [
    [], ["-d30"], ["-d", "30"], ["--depth", "30"], ["--depth=30"], ["-p35"], ["-p", "35"],
    ["--precision", "35"], ["-s"], ["--stubborn"],
    ["-sd30", "-p35"], ["-p", "35", "-s", "-d", "30"], ["-d", "30", "-s", "-p35"],
])
def test_flags_in_any_form_and_order(run, sample, output, arguments):
    for source in ([sample], [], ["-"]):
        status, out, err = run(*arguments, *source,
                                   stdin=b"" if source == [sample] else sample.read_bytes())
        assert (status, timeless(out), err) == (0, output, "")
        if arguments:
            break


def test_input_name_before_the_flags(run, sample, output):
    assert timeless(run(sample, "-d", "30")[1]) == output


def test_depth_and_undecided(run, sample):
    status, out, err = run("-d3", sample)
    assert status == 1 and err == ""
    assert "I could not decide" in out and "Undecided prisms : 1\n" in out
    stubborn = run("-d3", "-s", sample)
    assert stubborn[0] == 1 and "Undecided prisms : 1\n" not in stubborn[1]


def test_precision(run, sample):
    assert "Arithmetic : 50 decimal places" in run("-p", "50", sample)[1]


@pytest.mark.parametrize("method", ["thesis", "loewner"])
def test_verbose(run, sample, method):
    given = ["--method", method] + ["--together"] * (method == "loewner")
    plain, told = (run(*given, *flag, sample) for flag in ([], ["-t"]))
    leaf = re.compile(r"(proved|symmetric|undecided) +\(\S+, \S+\) \+- \(\S+, \S+\), [0-9]+ cuts")
    found = [line for line in told[1].split("\n") if leaf.fullmatch(line)]
    rest = "\n".join(line for line in told[1].split("\n") if line not in found)
    rest, expected = (re.sub(r"[0-9.]+ s\n", "", timeless(text)) for text in (rest, plain[1]))
    assert (told[0], rest, told[2]) == (plain[0], expected, "")
    proved = sum(line.startswith("proved") for line in found)
    successful = re.search(r"Of the (\S+) successful prisms|(\S+) prisms? proved", rest)
    assert proved == int((successful[1] or successful[2]).replace(",", "")) <= len(found)


def test_as_printed(run, sample):
    status, out, err = run("--as-printed", sample)
    assert status == 4
    assert one_line(err) and "not a proof" in err
    assert out.endswith(" seconds.\n") and "Program :" not in out and "Method" not in out
    status, out, err = run("--as-printed", "-d2", sample)
    assert status == 1 and one_line(err)


def test_help_and_version(run):
    status, out, err = run("--help")
    assert status == 0 and err == ""
    for flag in ("-d", "-b", "-r", "-g", "-p", "-s", "-t", "--as-printed", "--depth",
                 "--backup", "--restore", "--graphics", "--precision", "--stubborn", "--verbose",
                 "--version"):
        assert flag in out
    assert run("--version") == (0, "converse %s\n" % __version__, "")


@pytest.mark.slow
def test_figure(run, sample, output, tmp_path):
    path = tmp_path / "figure.pdf"
    status, out, err = run("-g", path, sample)
    assert (status, timeless(out), err) == (0, output, "")
    assert path.read_bytes().startswith(b"%PDF")
    path = tmp_path / "figure.svg"
    assert run("-d3", "-g%s" % path, sample)[0] == 1
    assert "undecided (1)" in path.read_text("utf-8")


def test_backup_and_restore(run, sample, output, tmp_path):
    backup = tmp_path / "backup"
    status, out, err = run("-b", backup, sample)
    sha256 = hashlib.sha256(backup.read_bytes()).hexdigest()
    assert (status, timeless(out), err) == (0, output + "Proof file : SHA-256 %s\n" % sha256, "")
    assert Proof.load(backup).no_tori
    for arguments in (["-r", backup], ["-r%s" % backup, "-b%s" % backup],
                      ["--restore", backup, "--backup", tmp_path / "other.gz"]):
        status, out, err = run(*arguments)
        assert (status, timeless(out).split("Restored")[0], err) == (0, output, "")
        assert "Restored : 121 prisms were read from a file that is believed\n" in out
    assert Proof.load(tmp_path / "other.gz").no_tori
    assert hashlib.sha256(backup.read_bytes()).hexdigest() == sha256


def test_restore_alone(run, sample, root, tmp_path):
    """Everything is taken from the file, which is kept up to date; it may go deeper."""
    backup = tmp_path / "backup"
    loewner = "--method", "loewner", "--together"
    assert run("-d9", *loewner, "-s", "-b", backup, root / "inputs" / "trig180.in")[0] == 1
    half = Proof.load(backup)
    status, out, err = run("-r", backup, "-d", "120")
    assert (status, err) == (0, "") and "on the segment from (" in out
    whole = Proof.load(backup)
    assert whole.no_tori and whole.problem == half.problem and whole.depth == 120
    assert check.verify(backup)
    for words, arguments in (
            ("of another run", ["-d", "9"]), ("the method", ["--method", "thesis"]),
            ("the method", ["-p", "36"]), ("the method", ["--as-printed"]),
            ("x* and", ["--xstar", "0.8", "0.95"]), ("--together", ["--together"]),
            ("leave out the input", [sample])):
        status, out, err = run("-r", backup, *arguments)
        assert (status, out) == (2, "") and one_line(err) and words in err
    assert Proof.load(backup) == whole


def test_a_backup_is_never_overwritten(run, sample, root, tmp_path):
    backup = tmp_path / "backup"
    assert run("-b", backup, sample)[0] == 0
    before = backup.read_bytes()
    for path in (backup, tmp_path / "." / "backup", os.path.relpath(backup)):
        status, out, err = run("-b", path, root / "inputs" / "trig276.in")
        assert (status, out) == (2, "") and one_line(err) and "exists" in err and "-r" in err
    assert backup.read_bytes() == before


def test_a_part_of_the_torus(run):
    status, out, err = run(stdin=GOOD.replace(b"1.0 1.0", b"0.5 0.25", 1))
    assert (status, err) == (3, "")
    assert "whose successor of x* lies in the region" in out and "only a part of the torus" in out


@pytest.mark.slow
def test_python_m(sample):
    for module, status in ("converse", 1), ("converse.check", 2):
        result = subprocess.run([sys.executable, "-m", module,
                                 *(["-d0", sample] if status == 1 else [])],
                                stdin=subprocess.DEVNULL, capture_output=True, check=False)
        assert result.returncode == status and b"Traceback" not in result.stderr


def test_marked_backup_is_no_proof(run, sample, tmp_path):
    backup = tmp_path / "backup"
    assert run("--as-printed", "-b", backup, sample)[0] == 4
    assert "kind: as printed, not a proof\n" in backup.read_text()
    status, out, err = run("-r", backup)
    assert status == 4 and one_line(err) and "not a proof" in err


@pytest.mark.slow
def test_the_sharper_method(run, root, tmp_path):
    sample, path = root / "inputs" / "trig180.in", tmp_path / "a.proof"
    status, out, err = run("--method", "loewner", "--together", "-b", path, "--jobs", "2",
                               sample)
    assert status == 0 and err == ""
    assert out.startswith("THEOREM\n") and "\n  and for every multiple s >= 1 of the upper" in out
    assert "\nVerify     converse-check %s\n" % path in out or len(str(path)) > 60
    assert "SHA-256    " + hashlib.sha256(path.read_bytes()).hexdigest() in out
    again = run("-r", path)
    assert again[0] == 0 and hashlib.sha256(path.read_bytes()).hexdigest() in again[1]
    picture = tmp_path / "a.svg"
    assert run("--method=loewner", "--together", "-g", picture, sample)[0] == 0
    assert b"<svg" in picture.read_bytes()[:1000]


# ---- bad usage and bad input ------------------------------------------------------------

@pytest.mark.parametrize("arguments, word", [
    (["-p", "0"], "'0'"), (["-p0"], "'0'"), (["-p", "-5"], "-5"), (["-p-5"], "-5"),
    (["-d", "x"], "'x'"), (["-dx"], "'x'"), (["-d", "-1"], "-1"), (["-d", "1.5"], "1.5"),
    (["-d", "9" * 30], "9999"), (["-d"], "-d"), (["-z"], "-z"), (["--dept", "3"], "--dept"),
    (["--unknown"], "--unknown"), (["-b"], "-b"), (["one", "two"], "two"),
    (["-b", ""], "the name of a file is empty"), ([""], "the name of the input file is empty"),
    (["-r", ""], "the name of a file is empty"), (["-b", "."], "is a directory"),
    (["-b", "/proc/a"], "/proc/a"), (["-g", "/proc/a.pdf"], "/proc/a.pdf"), (["-g", "a"], ".svg"),
    (["-b", "setup.py"], "setup.py: exists"), (["-g", "b.pdf", "-b", "./b.pdf"], "overwrite"),
    (["-d", "\u0663"], "is not a whole number"),
    (["-p", "40", "--method", "loewner"], "(--precision) is of the method thesis alone"),
    (["/missing/file.in"], "/missing/file.in"), (["/"], "/"),
])
def test_bad_usage(run, arguments, word, root, monkeypatch):
    monkeypatch.chdir(root)
    status, out, err = run(*arguments, stdin=GOOD)
    assert status == 2 and out == ""
    assert one_line(err) and word in err


@pytest.mark.parametrize("text, line", [
    (b"", 1), (GOOD.replace(b"0.617", b"nan"), 3),
    (bytes(range(256)), None), (b"\0" * 100, None),      # not text: no line is named
])
def test_bad_input(run, text, line, tmp_path):
    status, out, err = run("-b", tmp_path / "b", "-g", tmp_path / "g.pdf", stdin=text)
    assert status == 2 and out == ""
    where = "%s, line {}: ".format(line) if line else "%s: is not text in UTF-8"
    assert one_line(err) and where % ": <stdin>" in err and "; " in err
    assert list(tmp_path.iterdir()) == []
    path = tmp_path / "bad.in"
    path.write_bytes(text)
    status, out, err = run(path)
    assert status == 2 and one_line(err) and where % path in err


@pytest.mark.slow
@pytest.mark.parametrize("environment", [{}, {"LC_ALL": "C", "PYTHONIOENCODING": "ascii"}])
def test_foreign_letters_in_comments(command, environment, tmp_path):
    status, out, err = command("-b", tmp_path / "b", stdin=GOOD + "\u03b5 \u2264 1".encode(),
                               env={**os.environ, "PYTHONUTF8": "1", **environment})
    assert status == 0 and err == ""
    assert ("\u03b5 \u2264 1" in out) or ("\\u03b5 \\u2264 1" in out)
    assert Proof.load(tmp_path / "b").problem.comments == ("\u03b5 \u2264 1",)


@pytest.mark.slow
def test_a_figure_of_nothing(run, sample, tmp_path):
    for name in "a.pdf", "a.svg":
        assert run("--time-limit", "0", "-g", tmp_path / name, sample)[0] == 1
        assert (tmp_path / name).stat().st_size > 1000


def test_nothing_that_a_terminal_obeys(run, sample, tmp_path):
    """In messages, whatever name or text they quote."""
    backup, evil = tmp_path / "b", tmp_path / "\x1b[31mx"
    assert run("-b", backup, sample)[0] == 0
    forged = backup.read_text().replace("program: converse ", "program: converse \x1b[2J")
    assert "\x1b" in forged
    body = forged[:forged.index("checksum:")]
    evil.write_text(body + "checksum: sha256 %s\nend\n" % hashlib.sha256(body.encode()).hexdigest())
    for arguments, stdin in ((["-r", evil], b""), ([evil], b""), ([], b"1 0\n\x1b[31mx 0\n"),
                             (["-g", evil, "-b", evil, sample], b"")):
        status, out, err = run(*arguments, stdin=stdin)
        assert status == 2 and one_line(err) and "\x1b" not in err + out


@pytest.mark.parametrize("arguments, advice", [
    (["-d", "0"], "or deeper cuts (-d 10)"), (["-d", "3"], "or deeper cuts (-d 10)"),
    (["-d", "60"], "or deeper cuts (-d 120)"),
    (["--method", "loewner", "-d", "60000"],
     "or other parameters; neither more time nor deeper cuts"),
    ([], "not all 0, as the map without potential has invariant tori")])
def test_advice_that_can_be_taken(run, sample, arguments, advice):
    """(Of a square no leaf is linked, which is tried for minutes else.)"""
    stdin = sample.read_bytes() if arguments == ["-d", "3"] else \
        b"%s 0\n0 0\n0 0\n1 .5\n1 .5\n" % (b".001" if arguments else b"0")
    status, out, err = run(*arguments, stdin=stdin)
    assert status == 1 and err == ""
    assert re.search(r"To try(?: : | +)(.*[^.\n])", out)[1].endswith(advice)


def test_a_potential_of_ones_own(run, root, tmp_path):
    """JSON by its name or its first brace; a circle is called one; its backup goes on alone."""
    sample, path = root / "inputs" / "standard.json", tmp_path / "a.proof"
    status, out, err = run("--method", "loewner", "-d9", "-s", "-b", path,
                               stdin=sample.read_bytes())
    assert (status, err) == (1, "") and out.startswith("UNDECIDED: ")
    status, out, err = run("-r", path, "-d", "120")
    assert (status, err) == (0, "")
    assert "  with  V(y) = K cos y,\n  that is,  J' = J + K sin y,\n" \
        "  has no rotational invariant circle\n  for every K in [0.976, 1.34]\n" \
        "  and for every K > 1.34.\n" in out


@pytest.mark.parametrize("arguments, words", [
    (["-p", "40"], "--method loewner"),
    (["--method", "loewner", "--together"], "name a parameter")])
def test_a_potential_needs_the_sharper_method(run, root, arguments, words):
    status, out, err = run(*arguments, root / "inputs" / "crossed.json")
    assert (status, out) == (2, "") and one_line(err) and words in err


def test_without_a_terminal_a_line_a_minute_tells_the_progress(run, sample, monkeypatch):
    """Each with the name of the command; none in a run of less than a minute."""
    assert run(sample)[2] == ""
    monkeypatch.setattr(common, "LINE_SECONDS", 0.0)
    lines = run(sample)[2].splitlines()
    assert len(lines) > 1
    for line in lines:
        assert re.match(r"converse: 0:\d\d:\d\d [\d,]+ prisms proved; .* x torus done", line)


def test_the_default_method_is_one_that_can(run, root):
    """Five lines keep that of 1989."""
    for name, first in (("crossed.json", "THEOREM\n"), ("trig274.in", "Parameters :\n")):
        status, out, _ = run(root / "inputs" / name)
        assert status == 0 and out.startswith(first)


def test_an_input_that_moves_together(run, tmp_path):
    (tmp_path / "a.json").write_text('{"parameters": {"e": ["0.4", "0.5"]}, "harmonics": [%s]}' %
                                     ", ".join(
        '{"k": %s, "amplitude": {"e": 1}}' % k for k in ("[1, 0]", "[0, 1]", "[1, 1]")))
    status, out, err = run(tmp_path / "a.json")
    assert (status, out) == (2, "") and one_line(err) and "--method loewner" in err
    status, out, err = run("--method", "loewner", tmp_path / "a.json")
    assert (status, err) == (0, "") and "  for every e in [0.4, 0.5]" in out
    assert "V(y) = -e sin y0 - e sin y1 - e sin(y0 + y1),\n" in out


def test_json_mistakes_are_one_line(run, tmp_path):
    (tmp_path / "a.json").write_text('{"harmonics": [{"k": [1, 0], "amplitude": '
                                     '"\\u001b]0;x\\n"}]}')
    status, out, err = run("--method", "loewner", tmp_path / "a.json")
    assert (status, out) == (2, "") and one_line(err) and "\x1b" not in err
    assert "a.json: the amplitude of harmonic 1: " in err


def test_a_point_is_chosen(run, sample, tmp_path):
    status, out, err = run("-d5", "--xstar", "0.8", "-0.95", "-b", tmp_path / "a", sample)
    assert (status, err) == (1, "") and "\nx* : 0.8 -0.95\n" in out
    for words in ("0.8", "x"), ("1/3", "0"), ("1e999", "0"):
        status, out, err = run("--xstar", *words, sample)
        assert (status, out) == (2, "") and one_line(err) and "--xstar" in err
    status, out, err = run("-d5", "--xstar", "-1e-3", "-.5e+0", sample)
    assert status in (0, 1) and err == ""
    status, out, err = run("--xstar", "0.8", "--jobs", "1", sample)
    assert (status, out) == (2, "") and one_line(err)


def test_missing_packages_are_told(tmp_path):
    """What is missing, and a command that brings it."""
    code = ("import sys; sys.modules.update(dict.fromkeys(%r))\n"
            "from converse.commands.map import main\nsys.exit(main(['-g', 'map.svg', 'map.json']))")
    for missing in ["numpy", "matplotlib"], ["matplotlib"]:
        done = subprocess.run([sys.executable, "-c", code % missing], capture_output=True,
                              text=True, cwd=tmp_path)
        assert done.returncode == 2
        assert done.stderr == "converse-map: figures need matplotlib; " \
            "pip install 'converse-kam[plot]'\n"


def test_the_version_is_told_without_what_a_run_imports():
    code = ("import sys; from importlib import import_module\n"
            "for name in 'prove', 'map', 'orbits', 'portrait', 'tori':\n"
            "    assert import_module('converse.commands.' + name).main(['--version']) == 0\n"
            "print({'concurrent.futures', 'fractions', 'logging', 'tempfile'} & set(sys.modules))")
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.stderr == "" and done.stdout.endswith("\nset()\n")
