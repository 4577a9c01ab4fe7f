"""The command converse-portrait: its file, its figure, and one line for whatever is wrong."""

import re

import pytest

from converse import check
from converse.commands import portrait

RANGE = ('{"parameters": {"k": ["0.5", "0.5002"]}, "harmonics": '
         '[{"k": [1], "amplitude": {"k": 1}, "phase": "-1/2"}]}')
TWO = '{"harmonics": [{"k": [1], "amplitude": "0.5"}, {"k": [2], "amplitude": "0.1"}]}'


@pytest.fixture
def run(capsys):
    def call(*arguments):
        status = portrait.main(list(map(str, arguments)))
        return status, *capsys.readouterr()
    return call


@pytest.fixture
def inputs(root, tmp_path):
    """Names of input files."""
    found = {"standard": root / "inputs" / "standard-k090.in",
             "two angles": root / "inputs" / "trig274.in"}
    for name, text in ("range", RANGE), ("two", TWO):
        found[name] = tmp_path / (name + ".json")
        found[name].write_text(text)
    return found


@pytest.mark.slow
def test_portrait_is_kept_continued_and_drawn(run, inputs, tmp_path):
    pytest.importorskip("matplotlib")
    path, picture = tmp_path / "a.portrait.gz", tmp_path / "a.png"
    status, out, err = run(inputs["range"], "--columns", 16, "--depth", 8, "-b", path,
                           "--time-limit", 0)
    assert (status, err) == (1, "") and "Columns : 0 of 8" in out
    assert "Verify" not in out
    status, out, err = run("-r", path, "-g", picture, "--rotation", "golden",
                           "--rotation", "t^2+t-1: t/40")
    assert (status, err) == (1, "") and "Columns : 8 of 8" in out
    assert "\nVerify : converse-check %s\n" % path in out
    assert ": no torus of this rotation number" in out
    assert "for every t[1] in [-1, 1]" in out and check.verify(path)
    assert re.search("number golden : proved, its angles within [1-9][.][0-9]e-[0-9]+ of", out)
    assert picture.read_bytes()[:4] == b"\x89PNG"
    before = path.read_bytes()
    assert run("-r", path)[0] == 0 and path.read_bytes() == before


@pytest.mark.parametrize("name, arguments, word", [
    ("standard", ["--columns", 0], "--columns: '0' is not a whole number from 1"),
    ("standard", ["--columns", 3], "give at least 8"),
    ("standard", ["--depth", 0], "--depth: '0' is not a whole number from 1"),
    ("standard", ["--rotation", "golden"], "name one with -g"),
    ("standard", ["--rotation", "silly", "-g", "x.png"], "--rotation: 'silly' is not a rotation"),
    ("standard", ["-g", "x.gif"], "ends in .svg or .png or .pdf"),
    ("standard", ["-b", "there", "--columns", 20], "there: exists"),
    ("standard", ["-r", "there"], "leave out the input"),
    ("two angles", [], "a portrait is of a map of one angle"),
    ("two", ["--columns", 20], "strips are for a single wave"),
    (None, ["-r", "missing"], "missing: cannot be read"),
    (None, ["-r", "there"], "there: is not a proof file, a diagram, a portrait or a certificate"),
    ("nothing", [], "nothing"),
])
def test_bad_usage_is_one_line(run, inputs, tmp_path, monkeypatch, name, arguments, word):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "there").write_text("something else\n")
    status, out, err = run(*[inputs.get(name, name)] * (name is not None), *arguments)
    assert (status, out) == (2, "") and err.count("\n") == 1 and word in err
    assert err.startswith("converse-portrait: ")
    assert (tmp_path / "there").read_text() == "something else\n"


def test_without_a_file_the_report_tells_how_to_get_one(run, inputs):
    out = run(inputs["standard"], "--columns", 30, "--depth", 4)[1]
    assert "\nVerify : with -b FILE the run keeps the portrait; converse-check FILE verifies it\n" \
        in out


def test_depth_that_proves_nothing_is_told(run, inputs):
    status, out, err = run(inputs["standard"], "--columns", 30, "--depth", 1, "--lines")
    assert (status, err) == (1, "")
    assert "Undecided : at most 1 of" in out and "To try : a depth above 1 (--depth)" in out
    status, out, err = run(inputs["standard"], "--time-limit", 0)
    assert (status, err) == (1, "") and out.startswith("UNDECIDED") and "To try : more time" in out


@pytest.mark.parametrize("change, word", [
    (lambda text: text.replace("depth: 4", "depth: 5"), "wrong checksum"),
    (lambda text: text[:-40], "it is truncated"),
    (lambda text: text.replace("portrait 2", "portrait 1", 1), "another version, which converse ")])
def test_damaged_portrait_is_not_continued(run, inputs, tmp_path, change, word):
    path = tmp_path / "damaged"
    assert run(inputs["standard"], "--columns", 30, "--depth", 4, "-b", path)[0] == 0
    kept = change(path.read_text())
    path.write_text(kept)
    status, out, err = run("-r", path)
    assert (status, out) == (2, "") and err.count("\n") == 1 and word in err
    assert path.read_text() == kept
