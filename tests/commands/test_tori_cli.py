"""The command converse-tori: what it says is what the API finds, and every failure is a line."""

import dataclasses
import math
import os
import re
import signal
import subprocess
import sys
from fractions import Fraction

import pytest
from conftest import ROOT

from converse import Problem, check, read_input, tori
from converse.commands import tori as cli
from converse.model.map import MuldoonMap, SymplecticMap, from_patch
from converse.storage import files
from converse.tori import certificate, report

from checker import start_of_workers
from truth import TORTURE

K09 = str(ROOT / "inputs" / "standard-k090.in")
TRIG = str(ROOT / "inputs" / "trig004.in")
RANGE = str(ROOT / "inputs" / "trig278.in")
JSON = '{"parameters": {"K": [0.3, 0.4], "L": [0, 1]}, "harmonics": [' \
       '{"k": [1], "amplitude": {"K": 1}}, {"k": [2], "amplitude": {"L": 1}}]}'


@pytest.fixture
def run(capfd, monkeypatch):
    """Runs the command in this process: (exit status, stdout, stderr).  No steps are told, which
    would depend on the clock."""
    monkeypatch.setattr(cli, "QUIET_SECONDS", math.inf)

    def run(*arguments):
        status = cli.main([str(argument) for argument in arguments])
        return (status, *capfd.readouterr())
    return run


def one_line(err):
    return err.startswith("converse-tori: ") and err.endswith("\n") and err.count("\n") == 1


def flat(text):
    """A report without its line ends."""
    return " ".join(text.split())


def value(out, pattern):
    """The number that a line of the report has there."""
    return float(re.search(pattern.replace("#", r"([0-9.]+(?:e-?[0-9]+)?)"), out)[1])


@pytest.mark.slow
def test_a_theorem(run, tmp_path):
    file = tmp_path / "golden.torus"
    status, out, err = run(K09, "--rotation", "golden", "-b", file)
    assert (status, err) == (0, "")
    proof = tori.prove(tori.find(read_input(K09), tori.read_rotation("golden")))
    assert out.startswith("THEOREM\n") and " has a rotational invariant circle with" in out
    assert "Rotation   golden, " in out and "  with  V(y) = -0.9 sin y,\n" in out
    # The bounds are those of the proof, rounded to the safe side.
    for pattern, number in (("Residual   #,", proof.residual),
                            (r"\|u - u0\| <= #,", proof.distance)):
        assert number <= value(out, pattern) <= number * 1.02
    assert proof.needed * .98 <= value(out, "admissible: #\n") <= proof.needed
    assert 1.82 < value(out, ">= #/.k. for k != 0") < 1.8640649
    certificate = tori.read(file)
    assert "SHA-256    " + certificate.sha256 in out and "converse-check %s" % file in out
    assert certificate.tori[0].rotation.vector == ((0, 1),)
    assert certificate.tori[0].potential.amplitude == (Fraction("0.9"),)
    assert check.main([str(file)]) == 0             # by other means


@pytest.mark.slow
def test_a_theorem_with_choices(run, tmp_path):
    problem = tmp_path / "small.in"
    problem.write_text("0.01 0\n0.01 0\n0.02 0\n1 1\n1 1\n")
    status, out, err = run(problem, "--rotation", "T49", "--memory", 1, "--margin", 30,
                           "--points", 4096)
    assert (status, err) == (0, "")
    assert "  has an invariant torus with the rotation vector omega = (" in out
    assert re.search(r"\|k\| = (\d+ )?\|[^|]*k\[0\][^|]*\| \+ (\d+ )?\|", out)


@pytest.mark.slow
def test_a_theorem_for_a_negative_rotation_number(run, tmp_path):
    problem = tmp_path / "half.json"
    problem.write_text('{"harmonics": [{"k": [1], "amplitude": 0.5, "phase": "-1/3"}]}')
    status, out, err = run(problem, "--rotation", "t^2+t-1: -1+t")
    assert (status, err) == (0, "")
    assert "omega = -1+t = -0.38196601125010515" in out


@pytest.mark.slow
def test_a_start_from_a_certificate(run, tmp_path):
    file = tmp_path / "golden.torus.gz"
    problem = tmp_path / "standard.in"
    for k, more in (("0.5", ["--rotation", "golden", "-b", file]), ("0.55", ["-r", file])):
        problem.write_text(k + " 0\n0 0\n0 0\n1 1\n1 1\n")
        status, out, err = run(problem, *more)
        assert (status, err) == (0, "") and "Rotation   golden, " in out
        assert "V(y) = -%s sin y,\n" % k in out
    status, out, err = run(TRIG, "-r", file)
    assert (status, out) == (2, "") and one_line(err)
    assert "its map has 1 angle, and this one 2" in err


@pytest.mark.slow
def test_what_is_not_proved_is_said(run, tmp_path, monkeypatch):
    """A torus that is hardly accurate, with the numbers that the checker found."""
    monkeypatch.setattr(certificate, "_piece", lambda torus, piece=certificate._piece: piece(
        dataclasses.replace(torus, numbers=torus.numbers * 99999 // 100000)))
    file = tmp_path / "golden.torus"
    status, out, err = run(K09, "-b", file, "--rotation", "golden", "--margin", 100)
    assert (status, err) == (1, "") and not file.exists()
    assert out.startswith("UNDECIDED: nothing is proved.  There may be no rotational")
    assert re.search("Not proved the error of the torus is [0-9.]+e-[0-9]+, where less than "
                     "[0-9.]+e-[0-9]+ is needed", flat(out)) and "THEOREM" not in out


def test_too_little_memory_is_said(run):
    status, out, err = run(K09, "--rotation", "golden", "--memory", "1e-6")
    assert (status, err) == (1, "") and "THEOREM" not in out
    assert "GB of memory, and 1e-06 GB may be used By hand --memory;" in flat(out)


MINE = """{"parameters": {"K1": ["%s", "%s"]}, "harmonics": [
    {"k": [1], "amplitude": {"K1": 1}, "phase": "-1/2"},
    {"k": [2], "amplitude": "0.2", "phase": "-1/2"}]}"""


@pytest.mark.parametrize("rotation", [[], ["--rotation", "0.2372"],
                                      ["--rotation", "[0; 4, 4, 1, ...]"]])
@pytest.mark.slow
def test_a_circle_beyond_a_gap_is_proved(run, tmp_path, rotation):
    """At K1 = 0.30 there is none, and none is found."""
    problem = tmp_path / "mine.json"
    problem.write_text(MINE % ("0.42", "0.42"))
    status, out, err = run(problem, *rotation)
    assert status == 0 and "V(y) = 0.42 cos y + 0.2 cos(2 y)" in out
    assert not rotation or "= [0; 4, 4, 1, 1, ...]" in out
    problem.write_text(MINE % ("0.30", "0.30"))
    status, out, err = run(problem)
    assert (status, err) == (1, "")
    assert "Not found  at K1 = 0.3 no orbit is seen that is regular and not resonant" in out


@pytest.mark.slow
@pytest.mark.parametrize("numbers,rotation", [
    ((".98", "0", "0"), "golden"), (("0.158122476", "0.158122476", "0.316244952"), "T49")])
def test_beyond_the_last_torus_there_is_no_theorem(run, tmp_path, numbers, rotation):
    """On a small mesh, since a larger one takes long to find nothing."""
    problem = tmp_path / "beyond.in"
    problem.write_text("".join("%s 0\n" % x for x in numbers) + "1 1\n1 1\n")
    points = ["--points", "16384"] * (TORTURE <= 1)
    status, out, err = run(problem, "--rotation", rotation, *points)
    assert (status, err) == (1, "") and "THEOREM" not in out
    assert "\nNot found  no torus" in out


@pytest.mark.parametrize("arguments,words", [
    (["nowhere.in", "--rotation", "golden"], "nowhere.in"),
    ([TRIG, "--rotation", "golden"], "two angles"),
    ([K09, "--rotation", "T49"], "one angle"),
    ([K09, "--rotation", "t^2-1: t"], "reducible"),
    ([K09, "--rotation", "0.618x"], "not a rotation vector"),
    ([K09, "--rotation", "golden", "--memory", "x"], "'x'"),
    ([RANGE, "--rotation", "T49"], "--together"),
    (["two.json", "--rotation", "golden"], "2 parameters"),
    (["two.json", "--rotation", "golden", "--together"], "--together"),
    (["zero.in", "--rotation", "golden"], "V is 0"),
    ([K09, "--rotation", "golden", "--rho", "0.1"], "--rho"),
    ([K09, "--rotation", "golden", "--memory", "-1"], "above 0"),
    ([K09, "--rotation", "golden", "-b", "zero.in"], "zero.in: exists"),
    ([K09, "--rotation", "golden", "-b", "."], "is a directory"),
    ([K09, "--rotation", "golden", "-b", "no/where"], "no/where"),
    ([K09, "--rotation", "golden", "-g", "a.txt"], "the name of the figure ends in"),
    ([K09, "--rotation", "golden", "-b", "a.svg", "-g", "a.svg"], "would overwrite"),
    ([K09, "--rotation", "golden", "-r", "zero.in"], "zero.in"),
])
def test_bad_usage_is_a_line(run, tmp_path, monkeypatch, arguments, words):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "two.json").write_text(JSON)
    (tmp_path / "zero.in").write_text("0 0\n0 0\n0 0\n1 1\n1 1\n")
    status, out, err = run(*arguments)
    assert (status, out) == (2, "") and one_line(err) and words in err


@pytest.mark.parametrize("arguments,words", [
    (["--margin", "1e300"], "the margin, 1e+300, is not from 1 to 1e+100"),
    (["--margin", "1e-300"], "the margin, 1e-300, is not from")])
def test_what_the_library_refuses_is_a_line(run, arguments, words):
    status, out, err = run(K09, "--rotation", "golden", *arguments)
    assert status == 2 and one_line(err) and words in err and "THEOREM" not in out


def test_flags_that_may_be_the_reason_are_named(run, monkeypatch):
    monkeypatch.setattr(tori, "prove", lambda *_, **__: (_ for _ in ()).throw(
        tori.NotProved("it lacks")))
    _, out, _ = run(K09, "--rotation", "golden", "--memory", "1", "--points", 1 << 18)
    assert "\nNot proved it lacks\nBy hand    --points, --memory; without such a flag the " \
        "program chooses\n" in out
    _, out, _ = run(K09, "--rotation", "golden")
    assert "\nNot proved it lacks\nRotation   golden, " in out


@pytest.mark.slow
def test_each_step_of_a_long_run_is_told(run, monkeypatch):
    monkeypatch.setattr(cli, "QUIET_SECONDS", -1)
    status, _, err = run(K09, "--rotation", "golden")
    assert status == 0 and all(map(one_line, err.splitlines(keepends=True)))
    steps = iter(err.splitlines())      # in this order
    for words in ("looking for the torus of an orbit, on ", "refining a torus of ",
                  "verifying the torus", "verifying: the constants", "verifying: the residual"):
        assert any(step.startswith("converse-tori: " + words) for step in steps)


def test_an_interrupt_leaves_nothing(run, tmp_path, monkeypatch):
    def strike(*_, **__):
        raise KeyboardInterrupt
    monkeypatch.setattr(tori, "prove", strike)
    file = tmp_path / "golden.torus"
    status, out, err = run(K09, "--rotation", "golden", "-b", file)
    assert status == 130 and one_line(err) and "interrupted" in err
    assert "THEOREM" not in out and not file.exists()


def faulty(verify):
    """The command, whose processes verify pieces by this function."""
    return """if True:
        import sys
        from converse.check import processes
        from converse.commands import tori
        processes.START = %r
        tori.QUIET_SECONDS = 1e9
        sys.exit(tori.main(sys.argv[1:]))
        """ % start_of_workers(verify + "\nfrom converse.check import tori"
                               "\ntori.verify_width = verify")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.slow
def test_a_signal_ends_all_processes(tmp_path, number):
    """While pieces are verified, each of which would take minutes."""
    problem, file, pipe = (tmp_path / name for name in ("range.in", "range.torus", "pipe"))
    problem.write_text("0.45 0.35\n0 0\n0 0\n1 1\n1 1\n")
    os.mkfifo(pipe)
    code = faulty("""if True:
        import time
        def verify(*_):
            with open(%r, "wb", 0) as file:
                file.write(b"verifying")
                time.sleep(600)""" % str(pipe))
    run = subprocess.Popen([sys.executable, "-c", code, str(problem), "--rotation",
                            "golden", "--jobs", "2", "-b", str(file)], text=True,
                           stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    with open(pipe, "rb", 0) as told:
        assert told.read(9) == b"verifying"
        run.send_signal(number)
        out, err = run.communicate(timeout=300)
        assert told.read() in (b"", b"verifying")       # The processes, which had it open, ended.
    assert run.returncode == 128 + number
    assert err.startswith("converse-tori: interrupted; nothing is proved; ") and one_line(err)
    assert "range.torus.found has the torus that was found" in err and "THEOREM" not in out
    assert {each.name for each in tmp_path.iterdir()} == {"range.in", "pipe", "range.torus.found"}
    claim = check.read(tmp_path / "range.torus.found")
    assert len(claim.pieces) == 2 and claim.pieces[0].low == -1


@pytest.mark.slow
def test_a_process_that_dies_is_told(tmp_path):
    """In the midst of its work, while the other one works, too."""
    problem = tmp_path / "range.in"
    problem.write_text("0.45 0.35\n0 0\n0 0\n1 1\n1 1\n")
    code = faulty("""if True:
        import os, signal, time
        def verify(*_):
            if not os.path.exists("one"):
                open("one", "w").close()
                time.sleep(600)
            os.kill(os.getpid(), signal.SIGKILL)""")
    run = subprocess.run([sys.executable, "-c", code, "range.in", "--rotation", "golden",
                          "--jobs", "2"], text=True, capture_output=True, cwd=tmp_path, timeout=300)
    assert run.returncode == 2 and "THEOREM" not in run.stdout
    assert one_line(run.stderr) and "died, perhaps for lack of memory" in run.stderr


@pytest.mark.slow
def test_the_time_limit(run, tmp_path, monkeypatch):
    """It ends the search, or the check; the torus that was found is there, and is a start."""
    file, found = tmp_path / "golden.torus", tmp_path / "golden.torus.found"
    given = K09, "--rotation", "golden", "-b", file
    status, out, err = run(*given, "--time-limit", "0")
    assert status == 1 and out.startswith("UNDECIDED: nothing is proved.") and not err
    assert "\nTime limit the 0 seconds of the time limit are over; the next step was: " in out
    assert not list(tmp_path.iterdir())

    def late(words):
        raise tori.TimeIsUp("the time is up")
    with monkeypatch.context() as patch:
        patch.setattr(check, "verify_torus", lambda claim, tell, jobs: late(""))
        status, out, err = run(*given)
    assert status == 1 and "\nTime limit the time is up\n" in out and not file.exists()
    assert "Found %s has the torus that was" % found in flat(out) and check.read(found).pieces
    status, out, err = run(*given)
    assert (status, out) == (2, "") and one_line(err) and "golden.torus.found: exists" in err
    assert run(*given, "-r", found)[0] == 0
    assert [each.name for each in tmp_path.iterdir()] == [file.name]


@pytest.mark.slow
def test_a_certificate_is_one_runs_alone(run, tmp_path):
    """Another run that is to write the same file is refused while the first one works, and a file
    that is there stays."""
    file = tmp_path / "golden.torus"
    with files.Lock(str(file)):
        status, out, err = run(K09, "--rotation", "golden", "-b", file)
    assert (status, out) == (2, "") and one_line(err) and "another run is writing" in err
    assert not list(tmp_path.iterdir())
    status, *_ = run(K09, "--rotation", "golden", "-b", file)
    assert status == 0 and [each.name for each in tmp_path.iterdir()] == [file.name]
    before = file.read_bytes()
    status, out, err = run(K09, "--rotation", "golden", "-b", file)
    assert (status, out) == (2, "") and "exists" in err and file.read_bytes() == before


@pytest.mark.slow
def test_a_report_of_a_range_says_of_which_piece_it_speaks(run, tmp_path):
    """The residual of the piece with the least margin need not be the largest."""
    problem = tmp_path / "standard.in"
    problem.write_text("0.45 0.35\n0 0\n0 0\n1 1\n1 1\n")
    status, out, err = run(problem, "--rotation", "golden")
    assert (status, err) == (0, "")
    pieces, of_one = out.partition("THEOREM")[2].split("The lines below are about the piece with")
    (cut,) = re.findall(" -1 <= s <= ([0-9.]+): ", pieces)
    assert pieces.count(" %s <= s <= 1: " % cut) == 1
    assert "\nResidual" not in pieces and "\nResidual" in of_one
    assert value(of_one, "Residual   #,") in [
        float(x) for x in re.findall("residual ([0-9.e-]+),", pieces)]


@pytest.mark.parametrize("waves, words", [
    ([(1, 0), (0, 1)], "(1, 0) and (0, 1)"), ([(2, 2)], "(1, 0) and (0, 1)"),
    ([(1, 1), (1, -1)], "(1, 1) and (1, -1)")])
@pytest.mark.slow
def test_the_report_says_for_which_k_divisors_are_bounded(waves, words):
    """Where the waves span a line, of all k."""
    problem = Problem(SymplecticMap(waves, ["0.001"] * len(waves)))
    proof = tori.prove(problem, tori.read_rotation("T49"))
    assert "           k: the integer combinations of %s; |k| = " % words in report.verdict(proof)


def test_without_python_flint(tmp_path):
    code = ("import sys; sys.modules['flint'] = None\n"
            "from converse.commands.tori import main\n"
            "sys.exit(main([%r, '--rotation', 'golden']))" % K09)
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (2, "") and one_line(done.stderr)
    assert "pip install 'converse-kam[tori]'" in done.stderr


def test_bounds_are_rounded_to_the_safe_side():
    for x in (1.2345e-9, .00123456, .999999, 1.0, 1864.0648, 9999.99, 123456.0):
        for digits in (2, 3, 6):
            assert Fraction(report._up(x, digits)) >= Fraction(x) >= Fraction(
                report._down(x, digits))
            assert float(report._up(x, digits)) <= x * (1 + 10 ** (1 - digits))
    assert report._up(float("inf")) == "unbounded" and report._down(0.0) == "0"


@pytest.mark.slow
def test_a_range_is_told_exactly():
    """In the parameter of the input; in s, where only the torus is at hand."""
    golden = tori.read_rotation("golden")
    for problem, V, words in (
            (Problem(SymplecticMap([(1, 0)], ["0.25"], [["0.05"]])), "-(0.25 + 0.05 t[1]) sin y",
             "every t[1] in [-1, 1]"),
            (Problem(MuldoonMap(("0.2", "0.3"), 0, 0)), "-a sin y", "every a in [0.2, 0.3]"),
            (Problem(from_patch([(1, 0, "-1/2"), (2, 0)], ["0.25", "0.01"], [["0.05", 0]], [
                ("K", Fraction("0.2"), Fraction("0.3"))])), "K cos y - 0.01 sin(2 y)",
             "every K in [0.2, 0.3]")):
        out = report.undecided(problem, golden, tori.NotProved("it lacks"))
        assert "  with  V(y) = %s,\n  that is,  J' = J " % V in out
        assert ",\n  was examined for %s.\n" % words in out
    proof = tori.prove(problem, golden)
    theorem = report.verdict(proof, problem=problem)
    assert "  with  V(y) = K cos y - 0.01 sin(2 y),\n" in theorem
    assert "  for every K in [0.2, 0.3].\n" in theorem
    assert "(0.25 + 0.05 s) cos y - 0.01 sin(2 y),\n" in report.verdict(proof)
    assert "  for every s in [-1, 1].\n" in report.verdict(proof)


@pytest.mark.slow
def test_a_figure(run, tmp_path):
    figure, problem = tmp_path / "torus.png", tmp_path / "standard.in"
    problem.write_text("0.3 0.01\n0 0\n0 0\n1 1\n1 1\n")
    status, out, err = run(problem, "--rotation", "golden", "-g", figure)
    assert (status, err) == (0, "") and figure.read_bytes().startswith(b"\x89PNG")
    assert "  for every a in [0.29, 0.31].\n" in out
