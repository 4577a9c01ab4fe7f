"""The search for a diagram, its command and its picture."""

import io
import json
import os
import sys
from fractions import Fraction as F

import pytest
from test_reports import explained, labels

from converse import FroeschleMap, StandardMap, check, diagram
from converse.commands import map as cli
from converse.diagram import Diagram, cells
from converse.diagram.value import POINTS_A_SECOND, Seen
from converse.draw import diagram_figure
from converse.storage.files import ConverseError

STRONG = FroeschleMap((1, 2), (0, "0.5"))   # where a proof is short


@pytest.fixture
def input_file(tmp_path):
    def write(parameters, name="mine.json"):
        path = tmp_path / name
        path.write_text(json.dumps({"parameters": parameters, "harmonics": [
            {"k": [1, 0], "amplitude": dict.fromkeys(parameters, 1), "phase": "-1/2"},
            {"k": [0, 1], "amplitude": {min(parameters): 1}, "phase": "-1/2"}]}))
        return str(path)
    return write


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A diagram with two parameters, and its file."""
    path = tmp_path_factory.mktemp("map") / "plane.map"
    return diagram.explore(STRONG, path=path, budget="0.1", jobs=1), path


# ---- the search

def test_what_is_proved_does_not_depend_on_the_number_of_tasks(made, tmp_path):
    found, path = made
    other = diagram.explore(STRONG, path=tmp_path / "other", budget="0.1", jobs=3)
    assert found.members and [m.text for m in other.members] == [m.text for m in found.members]
    assert other.search == found.search and other.points == found.points
    assert found.points >= 0.1 * POINTS_A_SECOND


def test_proofs_and_open_cells_are_all_of_the_range(made):
    found, _ = made
    def area(box):
        (low0, low1), (high0, high1) = box
        return (high0 - low0) * (high1 - low1)

    assert sum(map(area, found.none)) + sum(map(area, found.open)) == F(1, 2)
    waiting = [tuple(zip(*cells._box(line))) for line in found.search]
    assert sum(map(area, waiting)) == sum(map(area, found.open))


@pytest.mark.slow
def test_the_checker_confirms_it(made):
    result = check.verify(made[1])
    assert result and labels(result.text) <= explained()
    assert "every k in [1.5, 2], every b in [0, 0.5]" in result.text


@pytest.mark.slow
def test_one_run_or_several(made, tmp_path):
    path, told = tmp_path / "map", []
    diagram.explore(STRONG, path=path, budget="0.03", jobs=1, tell=told.append)
    again = diagram.explore(path=path, resume=True, budget="0.1", jobs=2, tell=told.append)
    assert [m.text for m in again.members] == [m.text for m in made[0].members]
    assert told == [again.sentence(member) for member in again.members]
    assert again.points == made[0].points


def test_an_interruption_loses_nothing(made, tmp_path):
    path = tmp_path / "map"

    def tell(text):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        diagram.explore(STRONG, path=path, jobs=1, tell=tell)
    before = Diagram.load(path)
    assert len(before.members) == 1
    again = diagram.explore(path=path, resume=True, budget="0.1")
    assert again.none == made[0].none


def test_halves_are_cut_where_v_bends_most():
    found = Diagram.of(FroeschleMap((0, 2), (0, 1)))
    lower, upper = cells.halves(found, found.ranges)
    assert (lower, upper) == (((0, 1), (0, 1)), ((1, 2), (0, 1)))
    lower, upper = cells.halves(found, ((F(0), F(1, 2)), (F(0), F(1))))
    assert lower[1] == (0, F(1, 2)) and upper[1] == (F(1, 2), 1)


@pytest.mark.parametrize("options, error", [
    ({"budget": 0}, "above 0"), ({"budget": -1}, "above 0"), ({"budget": "x"}, "not a decimal"),
    ({"jobs": 0}, "jobs must be"), ({"time_limit": -1}, "time_limit")])
def test_arguments_that_make_no_sense(tmp_path, options, error):
    with pytest.raises(ValueError, match=error):
        diagram.explore(STRONG, path=tmp_path / "map", **options)
    assert not os.listdir(tmp_path)


def test_nothing_is_overwritten(made, tmp_path):
    path = tmp_path / "map"
    path.write_text("precious")
    with pytest.raises(ConverseError, match="exists"):
        diagram.explore(STRONG, path=path)
    with pytest.raises(ConverseError, match="is of another family or range"):
        diagram.explore(FroeschleMap((1, 2), (0, 1)), path=made[1], resume=True)
    with pytest.raises(TypeError, match="a family, or the file"):
        diagram.explore()
    older = Diagram.load(made[1])
    older.version = "0.9"
    older.save(tmp_path / "older")
    with pytest.raises(ConverseError, match="is of converse 0.9"):
        diagram.explore(path=tmp_path / "older", resume=True)
    assert path.read_text() == "precious"


# ---- the command

def test_the_command(input_file, tmp_path, capsys):
    path, picture = str(tmp_path / "mine.map"), str(tmp_path / "mine.svg")
    name = input_file({"k": ["1.2", "2"]})
    assert cli.main([name, "-b", path, "-g", picture, "--budget", "0.01min"]) == 3
    out, err = capsys.readouterr()
    assert err == "" and out.splitlines()[0] == "every k >= 1.2: no torus"
    assert "\nTHEOREM\n" in out and "Verify     converse-check " + path in out
    assert labels(out) <= explained() and "no torus" in open(picture).read()
    assert check.main([path, "--quiet"]) == 0
    assert cli.main([path]) == 3
    assert capsys.readouterr().out.partition("\n") == (
        "THEOREM, of which 1 proof was read from a file that is believed", "\n",
        out[out.index("THEOREM") + 8:])
    assert cli.main(["-r", path, name]) == 3 and cli.main(["-r", path]) == 3
    assert "k in [1.2, 2]; no torus was proved; between" in " ".join(out.split())


@pytest.mark.slow
def test_nothing_proved(input_file, capsys):
    assert cli.main([input_file({"k": ["0.1", "0.2"]}), "--budget", "0.01"]) == 3
    assert "every k >= 2.0001" in capsys.readouterr().out       # by one point
    assert cli.main([input_file({"k": ["0.1", "0.2"], "b": ["0", "0.1"]}), "--budget", "0.2s"]) == 1
    assert capsys.readouterr().out.startswith("UNDECIDED: nothing is proved.\n")


@pytest.mark.parametrize("arguments, words", [
    (("{one}", "--budget", "0"), "is not a time above 0"), (("{one}", "--budget", "-1"), "a time"),
    (("{one}", "--budget", "1d"), "is not a time above 0"), (("{point}",), "no parameter of the f"),
    (("none.json",), "cannot be read"), (("-r", "none.map"), "cannot be read"),
    (("{one}", "-b", "no/a.map"), "cannot be written"), (("{one}", "-g", "a.eps"), ".svg or .png"),
    (("{one}", "-b", "a.svg", "-g", "a.svg"), "would overwrite"),
    (("{one}", "-b", "a.map", "-r", "a.map"), "leave out -b"),
    (("-r", "{plane}", "{one}"), "of another family"),
    (("{plane}", "--budget", "1"), "is a diagram"),
    (("{plane}", "-b", "b.map"), "is a diagram"),
    (("{unused}",), "no amplitude depends on"), (("{part}",), "a part of the torus")])
def test_bad_usage_is_one_line(input_file, made, tmp_path, monkeypatch, capsys, arguments, words):
    monkeypatch.chdir(tmp_path)
    names = {"one": input_file({"k": ["1", "2"]}), "plane": str(made[1]),
             "point": input_file({"k": ["1", "1"]}, "point.json")}
    for name, extra in ("unused", {"parameters": {"k": [1, 2], "x": [0, 1]}}), ("part", {
            "v0": [0, 1]}):
        content = {**json.loads(open(names["one"]).read()), **extra}
        names[name] = str(tmp_path / (name + ".json"))
        open(names[name], "w").write(json.dumps(content))
    there = sorted(os.listdir())
    assert cli.main([each.format(**names) for each in arguments]) == 2
    out, err = capsys.readouterr()
    assert words in err and err.count("\n") == 1 and out == "" and sorted(os.listdir()) == there


def test_progress_says_what_is_done(input_file, monkeypatch):
    class Terminal(io.StringIO):
        def isatty(self):
            return True

    written = []
    monkeypatch.setattr(cli.ProgressLine, "_write", written.append)
    monkeypatch.setattr(sys, "stderr", Terminal())
    found = Diagram.of(StandardMap((1, 2)))
    found.points = 12345
    with cli.ProgressLine() as line:
        line(lambda: cli.progress_text(found))
    assert "0 proved, 12,345 points of orbits" in written[0]


# ---- the picture

def test_the_picture_of_a_line(tmp_path):
    found = Diagram.of(StandardMap((0, 2)))
    path = tmp_path / "k.svg"
    diagram_figure.draw(found, path)
    assert "proved" not in path.read_text()
    found.sides["above"] = F("1.5"), (F(1, 2), F(0)), (1, 0)
    found.seen.append(Seen((F("0.9"),), (0.618,)))
    diagram_figure.draw(found, path)
    words = path.read_text()
    assert "proved: no torus" in words and "seen, not proved" in words and "a torus" not in words
    axes = found.plot(diagram_figure.plot.new(4, 3, lambda figure: None).subplots())
    assert axes.get_xlabel() == "k" and axes.get_ylabel() == "rotation number"
    assert axes.get_xlim()[1] == pytest.approx(1.5 * 1.2 * 1.02)        # not to 2: no torus there
    assert [line.get_marker() for line in axes.lines if not line.get_clip_on()] == [">"]
    found.sides["above"] = F("2.5"), (F(1, 2), F(0)), (1, 0)        # beyond the range: no line
    axes = found.plot(diagram_figure.plot.new(4, 3, lambda figure: None).subplots())
    assert not any(patch.get_linewidth() for patch in axes.patches)
    assert all(line.get_clip_on() for line in axes.lines)           # and no arrow


def test_rotation_numbers_are_folded():
    assert diagram_figure._folded((0.25, 0.75, 1.25, -0.4, 3.0)) == pytest.approx(
        [0.25, 0.25, 0.25, 0.4, 0])


def test_the_picture_of_a_plane(made, tmp_path):
    path = tmp_path / "plane.svg"
    diagram_figure.draw(made[0], path)
    assert "proved: no torus" in path.read_text() and "larger" not in path.read_text()
