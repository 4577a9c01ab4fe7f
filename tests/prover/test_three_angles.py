"""Maps of three angles: their reports, files, figures and commands."""

import pytest

from converse import FourierMap, Problem, Proof, Settings, Tree
from converse import prove as converse_prove
from converse import read_input
from converse.commands import map, orbits, prove, tori
from converse.draw import captions
from converse.model.region import reduced
from converse.prover.tree import cells

STAR = "0.575", "0.575", "0.575"
UNITS = (1, 0, 0, "+cos"), (0, 1, 0, "+cos"), (0, 0, 1, "+cos")


@pytest.fixture
def path(root):
    return root / "inputs" / "line-three.json"


@pytest.fixture
def problem(path):
    return reduced(read_input(str(path)), STAR)


def proof_of(problem, text):
    return Proof((Tree(problem, STAR, text),), Settings("loewner"))


def test_the_report_names_three_angles(problem):
    text = " ".join(proof_of(problem, "05PPP").report().split())
    for words in (
            "22.42872 epsilon sin(y0 + y1 + y2), that is, J0' = J0 + 11.21436 epsilon cos y0 +",
            "J2' = J2 + 11.21436 epsilon cos y2 + 22.42872 epsilon cos(y0 + y1 + y2),",
            "has no invariant torus J = P + S'(y) over all angles, P constant,",
            "x* = (0.575, 0.575, 0.575)", "follow by reversal of time and exchange of the angles"):
        assert words in text
    undecided = " ".join(proof_of(problem, "05PPU").report().split())
    assert "There may be an invariant torus. The map" in undecided and ", 0 <= v2 <=" in undecided


def test_the_file_names_three_angles(problem):
    lines = proof_of(problem, "05PPP")._text().split("\n")
    assert lines[lines.index("method: loewner") + 1] == "angles: 3"
    assert "wave: 1 1 1 0 0.354373776 0.0560718" in lines
    assert "v2: 0.3333333335 0.3333333335" in lines
    assert "xstar: 0.575 0.575 0.575" in lines and "odd about: 0 0 0" in lines
    assert len(next(line for line in lines if line.startswith("frame: ")).split()) == 1 + 9
    two = Proof((Tree(Problem(FourierMap({(1, 0): "0.3", (0, 1): "0.3"})), STAR[:2], "P"),))
    assert "angles" not in two._text() and "v2" not in two._text()


def test_cuts_of_the_third_angle(problem):
    """Cuts 0, 1, 5 halve v0, v1, v2; what is left of the region is known exactly."""
    leaves = proof_of(problem, "05P1UPP").undecided
    (low0, high0), (low1, high1), (low2, high2) = problem.region
    assert [leaf.centre for leaf in leaves] == [
        ((3 * low0 + high0) / 4, (3 * low1 + high1) / 4, (low2 + 3 * high2) / 4)]
    assert [cell for kind, cell in cells("05P1UPP") if kind == "U"] == [
        ((0, 0, 0, 0, 0, 1), (1, 1, 0, 0, 0, 1))]


def test_a_figure_is_seen_along_the_third_angle(problem):
    pytest.importorskip("matplotlib")
    proof = proof_of(problem, "05PPU")
    assert "prisms are seen along v2, and what is not proved lies on top" in captions.foot(proof)
    assert captions.star(proof) is None or len(captions.star(proof)) == 2
    axes = proof.plot().axes[0]
    assert "undecided (1)" in axes.get_legend_handles_labels()[1]


@pytest.mark.parametrize("command, arguments, words", [
    (tori, [], "tori and orbits are looked for in one angle or two; this map has three"),
    (orbits, ["1,1/2", "1", "--at", "epsilon=0.01"], "this map has three, of which converse"),
    (map, [], "a diagram is of one angle or two; of three, prove a range with converse"),
    (prove, ["--x2", "1"], "--x2 is the third angle of x*; give the others by --xstar X0 X1"),
    (prove, ["--xstar", "1", "1"], "xstar is three numbers, in radians, not")])
def test_what_is_not_for_three_angles_is_refused_in_a_line(capsys, path, command, arguments, words):
    assert command.main([str(path), *arguments]) == 2
    out, err = capsys.readouterr()
    assert words in err and err.count("\n") == 1 and not out


# ---- searches

def rotors(K, *waves):
    """Three rotors of strength K, and further waves."""
    return FourierMap({**dict.fromkeys(UNITS, K), **dict(waves)})


@pytest.mark.parametrize("map_, most", [
    (rotors("0.9", ((1, 1, 1, "+cos"), "0.1")), 600),       # exchange of all angles
    (rotors("1.1", ((1, -1, 0, "+cos"), "0.1"), ((0, 1, -1, "+cos"), "0.1")), 600),
    (FourierMap({(1, 1, 1): "0.36"}), 300),     # in y0 + y1 + y2 alone
])
def test_theorems_are_proved_and_verified(map_, most, tmp_path):
    found = converse_prove(map_)
    assert found.no_tori and 0 < found.counts.proved < most and len(found.xstar) == 3
    found.save(tmp_path / "a.proof")
    again = Proof.load(tmp_path / "a.proof")
    assert again == found and again.problem.map == map_ and again.verify().verdict == "verified"


@pytest.mark.parametrize("map_", [
    FourierMap({**dict.fromkeys(((1, 0, 0), (0, 1, 0), (0, 0, 1)), "0.022"), (1, 1, 1): "0.045"}),
    rotors("0.9"),                      # each of the three standard maps has circles
    FourierMap({(1, 1, 1): "0.3"})])    # so has the standard map of 0.9
def test_maps_with_tori_stay_undecided(map_):
    found = converse_prove(map_, depth=11, stubborn=True)
    assert not found.no_tori and found.counts.undecided
