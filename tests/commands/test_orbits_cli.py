"""The command converse-orbits: what it says is what the API finds, and every failure is a line."""

import math
import re
import subprocess
import sys
from fractions import Fraction

import numpy as np
import pytest
from matplotlib.figure import Figure

from converse import orbits
from converse.commands import orbits as cli
from converse.orbits import pictures
from converse.orbits.solver import newton
from converse.storage.files import ConverseError

from moments import PATIENCE

SMALL = "65,86/114"
COMMAND = [sys.executable, "-m", "converse.commands.orbits"]


@pytest.fixture
def run(capfd):
    """Runs the command in this process: (exit status, stdout, stderr)."""
    def run(*arguments):
        status = cli.main([str(argument) for argument in arguments])
        return (status, *capfd.readouterr())
    return run


def one_line(err):
    return err.startswith("converse-orbits: ") and err.endswith("\n") and err.count("\n") == 1


# ---- find

def numbers(out, name):
    """The numbers behind a name, of each state."""
    number = r"(?<![\w^/|])-?[0-9][0-9.]*(?:e-?[0-9]+)?(?![\w/])"
    return [[float(x) for x in re.findall(number, line)]
            for line in re.findall("^%s : (.*)$" % re.escape(name), out, re.MULTILINE)]


@pytest.mark.parametrize("name, vector, eps, values", [
    ("trig", "65,86/114", "0.01 0.02:0.03:0.005", [0.01, 0.02, 0.025, 0.03]),
    ("froeschle", "(12, 16)/21", "1/32", [1 / 32]),
    ("standard", "89/233", "1 1.1", [1.0, 1.1])])
def test_the_report_is_the_familys(run, name, vector, eps, values):
    status, out, err = run(name, vector, *eps.split())
    assert (status, err) == (0, "")
    p, q = cli._vector(vector)
    family = orbits.follow(getattr(orbits, name), p, q, values)
    assert re.findall("^eps : (.*)$", out, re.MULTILINE) == [repr(x) for x in values]
    assert re.findall(r"^State : (.*?) \(floating", out, re.MULTILINE) == [s.label for s in family]
    for words, expected in (("Action per point less |p/q|^2/2", [[s.action] for s in family]),
                            ("Exponents", [list(s.exponents) for s in family]),
                            ("Deviation", [list(s.deviation) for s in family])):
        found = numbers(out.replace("eps 0", "it").replace("x_0", "it"), words)
        assert len(found) == len(expected)
        for mine, theirs in zip(found, expected):
            assert mine == pytest.approx(theirs, rel=1e-9)
    assert out.startswith("Map : ") and "Potential : %s\n" % name in out
    assert "Type : %s," % vector.replace("65,86/114", "(65, 86)/114").replace(
        "12,16/21", "(12, 16)/21") in out


def test_what_is_undetermined_is_said(run):
    status, out, err = run("trig", "200,265/351", "0.002")
    state = orbits.follow(orbits.trig, (200, 265), 351, [0.002])[0]
    assert (status, err, state.undetermined) == (0, "", 2)
    assert "Near-null directions : 2, along which" in out
    assert "Exponents : below 1e-05, below 1e-05\n" in out and state.exponents.max() < 1e-5


def test_what_is_no_minimum_ends_with_status_1(run, monkeypatch):
    minimax = newton(orbits.straight(orbits.standard, (1,), 3, origin=(0.0,)), 0.5)[0]
    assert minimax.label == "saddle"
    monkeypatch.setattr("converse.orbits.solver.follow",
                        lambda *_, progress, **how: progress(1, minimax))
    status, out, err = run("standard", "1/3", "0.5")
    assert (status, err) == (1, "")
    assert "State : saddle (floating point: its action can be lowered" in out
    assert "Exponents : below 1e-05\n" in out and "Residue : 0." in out


def test_find_minimax(run):
    status, out, err = run("standard", "8/21", "0.971635406", "--minimax", "--prove")
    assert (status, err) == (0, "")
    assert "Pass : saddle, towards the neighbour displaced by 1/21\n" in out
    assert "Residue of the minimax orbit : 0.2522989653\nFlux : 4.728387149e-06\n" in out
    assert "one negative direction" in out and "\nFlux : 4.7283871494" in out
    status, out, err = run("trig", "5,7/9", "0.02", "--minimax")
    assert (status, out) == (2, "") and one_line(err) and "one angle" in err
    status, out, err = run("standard", "8/21", "0.2", "--minimax")
    assert status == 0 and "Pass : too flat for doubles" in out
    status, out, err = run("standard", "8/20", "0.2", "--minimax")
    assert (status, out, err.count("\n")) == (2, "", 1) and "in lowest terms" in err
    status, out, err = run("standard", "1/3", "0", "--minimax")
    assert (status, err) == (1, "") and "No pass : at eps 0 all states" in out


def test_what_is_not_found_ends_with_status_1(run, monkeypatch):
    relax = orbits.PeriodicOrbit.relax

    def fails(state, eps, *rest, **options):
        if eps > 0.01:
            raise ConverseError("no orbit")
        return relax(state, eps, *rest, **options)

    monkeypatch.setattr(orbits.PeriodicOrbit, "relax", fails)
    status, out, err = run("trig", SMALL, "0.01", "0.02")
    assert (status, err) == (1, "")
    assert out.count("State : minimum") == 1 and out.endswith("\nNot found : no orbit\n")


@pytest.mark.parametrize("kind, eps", [("-12,16/21", "0.02"), ("(-12, -16)/21", "-0.02:0:0.01"),
                                       ("12,16/21", "-.02")])
def test_what_begins_with_a_minus_is_no_option(run, kind, eps):
    status, out, err = run("trig", kind, eps)
    assert (status, err) == (0, "") and kind.strip("()").split(",")[0] in out
    low = float(eps.split(":")[0])
    assert "\neps : %r\n" % low in out


def test_figure(run, tmp_path):
    picture = tmp_path / "figure.svg"
    assert run("trig", SMALL, "0.01:0.02:0.01", "-g", picture)[0] == 0
    assert "<svg" in picture.read_text() and "Minimum: a local one" in picture.read_text()
    other = tmp_path / "figure.PNG"
    assert run("standard", "1/3", "0.5", "--graphics=%s" % other)[0] == 0
    assert other.read_bytes().startswith(b"\x89PNG")


def test_the_picture_of_what_is_proved(run, tmp_path, monkeypatch):
    """The proved points are drawn, and called so; what is not proved, is not."""
    shown, said = [], []
    rows = pictures.rows
    monkeypatch.setattr(pictures, "rows", lambda page, drawn: (
        shown.extend(drawn), rows(page, drawn))[1])
    monkeypatch.setattr(pictures.plot, "written", lambda width, height, kind, fill: (
        said.append(fill(Figure())), b"")[1])
    status, out, _ = run("standard", "1/3", "0.5", "0.9", "--prove", "-g",
                         tmp_path / "x.svg")
    assert status == 0 and out.count("THEOREM, proved with") == 2
    proofs = [orbits.prove(s) for s in orbits.follow(orbits.standard, (1,), 3, [0.5, 0.9])]
    for proof, one in zip(proofs, shown):
        assert np.array_equal(one.nearest.x, proof.nearest.x)
        assert pictures.kind(one).startswith("proved within ")
        near, away = re.findall(r"\d\S*e\S*\d", pictures.kind(one))  # rounded up, as the report
        assert Fraction(near) >= proof.radius and Fraction(away) >= proof.moved
        assert "within %s of the points" % near in out and "within %s of those" % away in out
    assert "nothing is proved" not in said[0] and "Proved: a true orbit" in said[0]
    assert run("standard", "1/3", "0", "0.5", "--prove", "-g", tmp_path / "x.svg")[0] == 1
    assert [pictures.kind(one).startswith("proved") for one in shown[2:]] == [False, True]
    assert "nothing is proved" in said[1] and "Proved: a true orbit" in said[1]
    run("standard", "1/3", "0.5", "-g", tmp_path / "x.svg")
    assert "nothing is proved" in said[2] and "Proved: a true orbit" not in said[2]


def test_a_potential_in_a_file(run, root, tmp_path):
    """The standard map of an input, half a turn aside; eps and K multiply each other."""
    path = root / "inputs" / "standard.json"
    mine = cli.read_potential(str(path), [("K", Fraction("0.9"))])
    assert (mine.name, mine.n) == ("standard, K = 0.9", 1)
    assert list(mine.sum.terms(0)) == [((1, 0), (Fraction(9, 10),) * 2, (0, 0))]
    status, out, err = run(path, "34/55", "1", "1.2", "--at", "K=0.9")
    assert (status, err) == (0, "") and "Potential : standard, K = 0.9\n" in out
    assert "J' = J - eps grad V(y), angles of period 2 pi\n" in out
    assert "\nV(y) : 0.9 cos y\n" in out
    states = orbits.follow(orbits.standard, (34,), 55, [0.9, 1.08])
    for (action,), state in zip(numbers(out, "Action per point less |2 pi p/q|^2/2"), states):
        assert action == pytest.approx(4 * math.pi ** 2 * state.action, abs=1e-11)
    named = tmp_path / "trig.json"                  # another potential, another name
    named.write_text('{"harmonics": [{"k": [1], "amplitude": 1}]}')
    assert "Potential : trig.json\nV(y) : " in run(named, "1/3", "0.1")[1]
    status, out, err = run(root / "inputs" / "trig278.in", "5,7/9", "1", "--at", "a=0.1",
                           "--at", "b=1/7", "--at", "c=-0.2")
    assert (status, err) == (0, "") and (
        "V(y) : -0.1 sin y0 - 1/7 sin y1 + 0.2 sin(y0 + y1)\n" in out)


@pytest.mark.parametrize("text", ["1 0 0 -1/2\n0 1 0 -0.5\n", "2 0.25 -1\n"])
def test_a_file_of_bare_numbers_is_no_potential(run, tmp_path, text):
    path = tmp_path / "mine"
    path.write_text(text)
    status, out, err = run(path, "1/3", "0.1")
    assert (status, out) == (2, "") and one_line(err) and "mine, line 1: " in err


def test_proof(run):
    """--prove gives the theorem of prove."""
    status, out, err = run("trig", "5,7/9", "0.03", "--prove")
    assert (status, err) == (0, "")
    state, = orbits.follow(orbits.trig, (5, 7), 9, [0.03])
    assert "State : minimum (floating point, not proved" in out
    assert out.endswith(orbits.prove(state).report())
    status, out, err = run("trig", "200,265/351", "0", "--prove")
    assert (status, err) == (1, "") and "\nNot proved : " in out


# ---- help

def test_help_and_version(run):
    status, out, err = run("--help")
    assert (status, err) == (0, "") and "\nexit status:\n  0 " in out
    assert run("--version")[1].startswith("converse-orbits ")


# ---- what goes wrong

@pytest.mark.parametrize("arguments, words", [
    ([], "required"), (["trig"], "required"),
    (["trig", SMALL], "EPS"),
    (["trig", SMALL, "0.01", "--what"], "--what"),
    (["trig", "1/2", "0.01"], "a type is 2 whole numbers"),
    (["standard", SMALL, "0.5"], "a type is 1 whole number p"),
    *[(["trig", bad, "0.01"], "is not a type") for bad in (
        "1,2/0", "1,2,3/4", "1,2", "1.5,2/3", "a,b/c", "1,2/-3", "", "1" * 10 + ",2/3",
        "1,2/3\n4")],
    *[(["trig", SMALL, bad], "is neither a number below 10^9") for bad in (
        "x", "1e10", "nan", "inf", "1e400", "1e9999999999", "1/0", "1:2", "1:2:3:4", "", "1_0")],
    (["trig", SMALL, "1e6"], "too far to be followed"),
    (["trig", "5,7/999999999", "0.01"], "whole number q from 1 to 10000000, not"),
    *[(["trig", SMALL, bad], "range of no values") for bad in (
        "1:2:0", "2:1:0.1", "0:1:1e-9")],
    (["none", SMALL, "0.01"], "neither a potential nor a file"),
    (["DIR", SMALL, "0.01"], "cannot be read"),
    (["trig", SMALL, "0.01", "--points", "DIR"], "ends in .npz"),
    (["trig", SMALL, "0.01", "--points", "DIR/a.json"], "ends in .npz"),
    (["trig", SMALL, "0.01", "--points", "DIR/other.npz"], "exists and is not"),
    (["trig", SMALL, "0.01", "--points", "DIR/no/x.npz"], "cannot be written"),
    (["trig", SMALL, "0.01", "-g", "DIR/x.ps"], ".svg or .png or .pdf"),
    (["trig", SMALL, "0.01", "-g", "DIR/other.svg"], "not a figure of this program"),
    (["trig", SMALL, "0:0.04:0.0001", "-g", "DIR/x.svg"], "states at most"),
    (["DIR/terms.json", "1/3", "0.01", "--points", "DIR/terms.json"], "overwrite"),
    (["trig", SMALL, "0.01", "--at", "K=1"], "trig has no parameters"),
    (["DIR/terms.json", SMALL, "0.01", "--at", "K=1"], "there is no parameter K"),
    (["DIR/terms.json", SMALL, "0.01", "--at", "K"], "write NAME=NUMBER"),
])
def test_bad_usage(run, tmp_path, arguments, words):
    (tmp_path / "terms.json").write_text('{"harmonics": [{"k": [1, 0], "amplitude": 1}]}')
    (tmp_path / "other.npz").write_text("mine\n")
    (tmp_path / "other.svg").write_text("<?xml version='1.0'?><svg/>\n")
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    status, out, err = run(*[a.replace("DIR", str(tmp_path)) for a in arguments])
    assert (status, out) == (2, "") and one_line(err) and words in err, err
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == before


@pytest.mark.parametrize("text, words", [
    (b"{", "not valid JSON"),
    (b'{"harmonics": [{"k": [1, 0], "amplitude": [1, 2]}]}',
     "an amplitude goes from 1 to 2; give one number"),
    (b'{"parameters": {"K": [1, 2]}, "harmonics": [{"k": [1, 0], "amplitude": {"K": 1}}]}',
     "K goes from 1 to 2; choose a value: .at(K='1.5'), or --at K=1.5")])
def test_a_bad_potential(run, tmp_path, text, words):
    path = tmp_path / "mine"
    path.write_bytes(text)
    status, out, err = run(path, "1,2/3", "0.01")
    assert (status, out) == (2, "") and one_line(err) and words in err and str(path) in err


@pytest.mark.parametrize("module, arguments", [
    ("numpy", ["trig", SMALL, "0.01"]),
    ("converse._native", ["trig", SMALL, "0.01"]),
    ("matplotlib", ["trig", SMALL, "0.01", "-g", "x.svg"])])
def test_what_is_missing_is_said(tmp_path, module, arguments):
    result = subprocess.run(
        [sys.executable, "-c", "import runpy, sys\nsys.modules[%r] = None\n"
         "sys.argv[0] = 'x'\nrunpy.run_module('converse.commands.orbits', run_name='__main__')" %
         module,
         *arguments], cwd=tmp_path, capture_output=True, text=True, timeout=PATIENCE)
    assert (result.returncode, result.stdout) == (2, "") and one_line(result.stderr)
    assert module.split(".")[0] in result.stderr
    assert "pip install" in result.stderr or "run make" in result.stderr
    assert not list(tmp_path.iterdir())


def test_a_closed_pipe():
    with subprocess.Popen([*COMMAND, "trig", SMALL, "0.001:0.02:0.001"],
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        process.stdout.close()
        err = process.stderr.read()
    assert (process.returncode, err) == (141, "")
