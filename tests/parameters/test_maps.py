"""Maps of the frontier: cells, the search, the file, the command, the picture."""

import concurrent.futures
import functools
import io
import json
import os
import random
import subprocess
import sys
from fractions import Fraction as F

import pytest
from matplotlib.text import Text
from test_reports import explained, labels

import converse
from converse import check, parameters
from converse.commands import map as cli
from converse.draw import map_figure
from converse.parameters import map as map_module
from converse.parameters import region, search
from converse.parameters.map import AT_ONCE, OPEN, PROVED, Node, ParameterMap
from converse.prover.workers import ATTEMPTS, WorkerPool
from converse.storage.files import ConverseError

from moments import PATIENCE


@functools.lru_cache(maxsize=None)
def estimated_once(direction, budget, real=search.estimate_frontier):
    """The estimate depends on the direction alone, which is that of corners of several maps."""
    return real((direction, direction), F(0))


@pytest.fixture
def coarse(monkeypatch):
    """An estimate at few places and with little effort, made once for all tests."""
    monkeypatch.setattr(map_module, "ESTIMATE_GRID", 4)
    monkeypatch.setattr(search, "POINT_BUDGET", 1 << 7)
    monkeypatch.setattr(search, "estimate_frontier", lambda directions, place, stop=None: (
        estimated_once(region.direction(directions, place), 1 << 7)))


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A map of the plane b = 0, not very near to the frontier, and its file."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(map_module, "ESTIMATE_GRID", 4)
        patch.setattr(search, "POINT_BUDGET", 1 << 9)
        path = tmp_path_factory.mktemp("map") / "map.json"
        yield parameters.explore("b=0", "1.3", path=path), path


def random_cell(rng, name):
    directions = region.REGIONS[name]
    face = rng.randrange(len(directions))
    cell = region.root(face)
    for _ in range(rng.randrange(20)):
        cell = rng.choice(cell.halves(rng.randrange(len(cell.low))))
    return directions[face], cell


# ---- cells

@pytest.mark.parametrize("name", region.REGIONS)
def test_a_patch_holds_its_cell(name):
    rng = random.Random(name)
    for _ in range(100):
        directions, cell = random_cell(rng, name)
        middle, parts = region.patch(directions, cell)
        for _ in range(10):
            r, s = [low + (high - low) * F(rng.choice([0, 1, rng.random()]))
                    for low, high in zip(cell.low, cell.high)]
            rm, sm = cell.middle
            t = [(r - rm) / ((cell.high[0] - cell.low[0]) / 2),
                 r * (s - sm) / (cell.high[0] * (cell.high[1] - cell.low[1]) / 2)]
            assert all(abs(x) <= 1 for x in t)
            assert tuple(r * d for d in region.direction(directions, s)) == tuple(
                p + sum(x * part[i] for x, part in zip(t, parts)) for i, p in enumerate(middle))


@pytest.mark.parametrize("name", region.REGIONS)
def test_halves_are_the_whole(name):
    rng = random.Random(name)
    for _ in range(100):
        _, cell = random_cell(rng, name)
        for axis in range(len(cell.low)):
            lower, upper = cell.halves(axis)
            assert lower.high[axis] == upper.low[axis] == cell.middle[axis]
            assert lower.low == cell.low and upper.high == cell.high


# ---- the search

@pytest.mark.slow
def test_a_map(made):
    found, path = made
    kinds = [leaf.kind for leaf in found.leaves()]
    assert found.complete and {PROVED, AT_ONCE, OPEN} == set(kinds)
    for face in range(2):
        assert found.height(face) < F(7, 5)
        for radius in found.estimate[face].values():
            assert 0.3 < radius < 1.2           # the standard map's is 0.9716
    # Nothing is open of which a part lies above what was asked for, everything below is.
    for leaf in found.leaves():
        low = found.target(leaf.cell)
        assert (leaf.kind == OPEN) == (leaf.cell.high[0] <= low)
        if leaf.kind != OPEN:
            assert leaf.cell.low[0] >= F(9, 10) * F(low)
    assert 1 < found.reached <= 1.3


@pytest.mark.slow
def test_a_cell_with_a_part_above_the_ratio_is_missing(made):
    """What straddles it counts as not yet proved."""
    found = ParameterMap.load(made[1])
    straddling = next(leaf for leaf in found.leaves() if leaf.kind == PROVED
                      and leaf.cell.low[0] < found.target(leaf.cell))
    straddling.decide(OPEN, None)
    assert not found.complete and found.reached > 1.3
    assert "not all of it is proved" in found.report()


@pytest.mark.slow
def test_the_checker_confirms_it(made):
    found, path = made
    result = check.verify(path)
    assert result and result.status == check.VERIFIED
    assert {"Region", "Face"} <= labels(result.text) and labels(result.text) <= explained()
    assert "%d" % found.count(PROVED) in result.text


@pytest.mark.slow
def test_a_cell_that_is_not_proved_is_not_believed(made, tmp_path):
    """Below the frontier: the checker does not take anybody's word for it."""
    found = ParameterMap.load(made[1])
    proof = next(leaf.proof for leaf in found.leaves() if leaf.kind == PROVED)
    lowest = next(leaf for leaf in found.leaves() if leaf.kind == OPEN and leaf.cell.low[0] == 0)
    lowest.decide(PROVED, {**proof, "tree": "P", "v0": ["1", "1"],
                            "v1": ["1", "1"]})
    found.save(tmp_path / "map.json")
    with pytest.raises(check.NotConfirmed):
        check.verify(tmp_path / "map.json")


@pytest.mark.slow
def test_what_was_only_read_is_told_in_the_headline(made):
    found, path = made
    assert found.report().startswith("THEOREM.\nThe map  y' = ")
    again = ParameterMap.load(path)
    assert again.report().startswith("THEOREM, of which %d cells were read from a file that is "
                                     "believed.\nThe map" % (
                                         found.count(PROVED) + found.count(AT_ONCE)))


@pytest.mark.slow
def test_a_map_without_an_open_cell_makes_no_sense(made, tmp_path):
    """At r = 0 there are tori."""
    found = ParameterMap.load(made[1])
    found.roots = [Node(root.cell) for root in found.roots]
    for root in found.roots:
        root.decide(AT_ONCE, None)
    found.save(tmp_path / "map.json")
    with pytest.raises(ConverseError, match="makes no sense .no cell of a face is open, but"):
        ParameterMap.load(tmp_path / "map.json")


@pytest.mark.slow
def test_what_reaches_to_infinity_is_at_once(made):
    for leaf in made[0].leaves():
        if leaf.cell.high[0] == region.RADIUS:
            assert leaf.kind == AT_ONCE


@pytest.mark.slow
def test_one_whole_run_or_several(coarse, tmp_path):
    """However it is divided, it ends with all that was asked for."""
    path, runs, handed_out, give = tmp_path / "map.json", 0, [], WorkerPool.give
    found = parameters.explore("c=0", "1.4", path=path, time_limit=0)
    while not found.complete:
        with pytest.MonkeyPatch.context() as patch:     # it is late when some tasks are handed out
            patch.setattr(WorkerPool, "give", lambda self, *task: (handed_out.append(task),
                                                             give(self, *task)))
            patch.setattr(search.Filling, "late", property(lambda self: len(handed_out) > 8 * runs))
            handed_out, runs = [], runs + 1
            found = parameters.explore(path=path, resume=True, jobs=1)
    known = ParameterMap.load(path)
    assert runs > 1 and known.complete
    deeper = parameters.explore("c=0", "1.3", path=path, resume=True)
    assert deeper.complete and deeper.height(0) < found.height(0)
    assert deeper.reached <= 1.3 < found.reached <= 1.4
    assert known.seconds < deeper.seconds


def test_starts_are_compared_though_no_trial_ends_in_time(monkeypatch):
    """Where c prevails the program's x* and one aside of it, whether or not a trial is long enough
    for a proof; where it is tiny the x* that is best for both other waves."""
    monkeypatch.setattr(search, "TRIAL_BUDGET", 1 << 11)
    cell = region.Cell(0, (F(99, 200), F(1, 32)), (F(99, 200), F(1, 32)))
    best = search._way(region.REGIONS["b=0"][1], cell, search.native.Stop())
    assert best == (search.SHEARED, ("1.270796", "0.3"))
    cell = region.Cell(0, (F(1), F(1, 200)), (F(1), F(1, 200)))
    best = search._way(region.REGIONS["a=b"][0], cell, search.native.Stop())
    assert best == (search.IDENTITY, search.RIGHT_ANGLES)


@pytest.mark.parametrize("abc, frame", [
    ((1, 0, F(1, 4)), search.SHEARED), ((1, F(1, 2), F(1, 4)), search.SHEARED),
    ((1, F(1, 2), F(1, 16)), search.IDENTITY), ((F(1, 2), F(1, 2), 1), search.DIAGONALS),
    ((1, 1, F(1, 8)), search.IDENTITY), ((0, 0, 1), None), ((1, F(1, 2), 0), None)])
def test_the_frame_follows_the_two_largest_waves(abc, frame):
    """Each of them feels one of v0, v1 alone; or they are those of the exchange of the angles, or
    of the only wave that counts, chosen elsewhere."""
    a, b, c = map(F, abc)
    directions = (a, b, c), (0, 0, 0)
    cell = region.Cell(0, (F(1), F(0)), (F(1), F(0)))
    found, xstar = search._way(directions, cell, search.native.Stop())
    assert found == frame and xstar is not None


@pytest.mark.slow
def test_progress_says_what_is_done(coarse, tmp_path, monkeypatch):
    class Terminal(io.StringIO):
        def isatty(self):
            return True

    def went_on(**options):
        shares, written = [], []
        monkeypatch.setattr(cli.ProgressLine, "_write", written.append)
        with cli.ProgressLine() as line:
            parameters.explore("c=0", path=tmp_path / "map.json", jobs=1, progress=lambda *done: (
                shares.append(done[0]), setattr(line, "due", 0.0),
                line(lambda: cli.progress_text(*done))), **options)
        return shares, "\n".join(written)

    monkeypatch.setattr(sys, "stderr", Terminal())
    shares, text = went_on(down_to="1.4")
    assert "estimating the frontier: " in text and " of 5 directions" in text
    assert "of the area down to 1.4 times the estimate" in text
    assert shares[0] == 0 and shares == sorted(shares)
    shares, text = went_on(down_to="1.2", resume=True)
    assert shares[0] > 0.5 and "estimating" not in text     # it begins where it was left


@pytest.mark.slow
def test_processes(monkeypatch, tmp_path):
    """They estimate, too."""
    monkeypatch.setattr(map_module, "ESTIMATE_GRID", 1)
    monkeypatch.setattr(search, "POINT_BUDGET", 1 << 7)
    with concurrent.futures.ProcessPoolExecutor(2) as pool:
        found = parameters.explore("c=0", "1.3", path=tmp_path / "map.json", executor=pool)
    assert found.complete and found.sha256 == ParameterMap.load(tmp_path / "map.json").sha256


class Unreliable(concurrent.futures.ThreadPoolExecutor):
    """Whose workers die: at every so many tasks, but as often at one as is borne, or always."""

    def __init__(self, every):
        super().__init__(2)
        self.every, self.tasks, self.deaths = every, 0, []

    def submit(self, call, *arguments):
        def dies(*_):
            raise OSError("a worker died")
        task, self.tasks = (call, *arguments), self.tasks + 1
        if self.every > 1 and (self.tasks % self.every or self.deaths.count(task) == ATTEMPTS - 1):
            return super().submit(*task)
        self.deaths.append(task)
        return super().submit(dies, *arguments)


@pytest.mark.slow
def test_workers_that_die(coarse, tmp_path):
    with Unreliable(3) as pool:
        assert parameters.explore("c=0", "1.3", path=tmp_path / "map.json", executor=pool).complete
        assert pool.deaths                  # it did come to that
    with Unreliable(1) as pool, pytest.raises(ConverseError, match="keep failing"):
        parameters.explore("c=0", "1.3", path=tmp_path / "other.json", executor=pool)
    assert not ParameterMap.load(tmp_path / "other.json").complete
    pool.shutdown()
    with pytest.raises(ConverseError, match="workers are gone"):
        parameters.explore("c=0", "1.3", path=tmp_path / "third.json", executor=pool)


@pytest.mark.parametrize("proved", [0, 5])      # while it estimates, and with so many cells proved
@pytest.mark.slow
def test_an_interruption_loses_nothing(coarse, tmp_path, proved):
    path = tmp_path / "map.json"

    def progress(share, found):
        assert 0 <= share <= 1
        if any(found.estimate) and found.count(PROVED) >= proved:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        parameters.explore("b=0", "1.3", path=path, jobs=1, progress=progress)
    before = ParameterMap.load(path)
    assert any(before.estimate) and before.count(PROVED) >= proved
    assert before.estimated_all == (proved > 0)
    found = parameters.explore(path=path, resume=True)
    assert found.complete and found.count(PROVED) >= before.count(PROVED)
    kept = {leaf.cell for leaf in before.leaves() if leaf.kind == PROVED}
    assert kept <= {leaf.cell for leaf in found.leaves() if leaf.kind == PROVED}


@pytest.mark.parametrize("arguments, error", [
    (("d=0", "1.1"), "the region is one of"), ((None, "1.1"), "the region is one of"),
    (("b=0", "1"), "above 1"), (("b=0", "x"), "not a decimal number"), (("b=0", 101), "above 1")])
def test_arguments_that_make_no_sense(tmp_path, arguments, error):
    with pytest.raises(ValueError, match=error):
        parameters.explore(*arguments, path=tmp_path / "map.json")
    assert not os.listdir(tmp_path)


@pytest.mark.slow
def test_nothing_is_overwritten(made, tmp_path):
    path = tmp_path / "map.json"
    path.write_text("precious")
    with pytest.raises(ConverseError, match="exists"):
        parameters.explore("b=0", path=path)
    with pytest.raises(ConverseError, match="is of another region, b=0"):
        parameters.explore("c=0", path=made[1], resume=True)
    other = ParameterMap.load(made[1])
    other.version = "0.9"
    other.save(tmp_path / "older.json")
    with pytest.raises(ConverseError, match="is of another program, 0.9"):
        parameters.explore(path=tmp_path / "older.json", resume=True)
    assert path.read_text() == "precious"


# ---- the file

@pytest.mark.parametrize("name", ["map.json", "map.json.gz"])
@pytest.mark.slow
def test_it_is_what_it_was(made, tmp_path, name):
    found = ParameterMap.load(made[1])
    assert found.save(tmp_path / name) == found.sha256
    again = ParameterMap.load(tmp_path / name)
    assert repr(again) == repr(made[0]) and again.estimate == made[0].estimate
    assert [(leaf.cell, leaf.kind, leaf.proof, leaf.tried) for leaf in again.leaves()] == [
        (leaf.cell, leaf.kind, leaf.proof, leaf.tried) for leaf in made[0].leaves()]


@pytest.mark.slow
def test_what_a_map_lacks_is_said(made, tmp_path):
    def refused(**changed):
        data = {**json.loads(made[1].read_text()), **changed}
        del data["sha256"]
        path = tmp_path / "map.json"
        path.write_text(json.dumps({**data, "sha256": map_module._digest(data)}))
        with pytest.raises(ConverseError) as error:
            ParameterMap.load(path)
        return str(error.value)

    faces = json.loads(made[1].read_text())["faces"]
    del faces[0]["proofs"][-1]
    assert "there are fewer proofs than proved cells; use an intact copy" in refused(
        faces=faces).replace(")", "")
    for other in ("converse map 1", "converse map 3"):
        assert "its format, %s, is of another version" % other in refused(format=other)


@pytest.mark.slow
def test_a_damaged_file_is_refused_in_a_line(made, tmp_path):
    text = made[1].read_text()
    rng = random.Random(1)
    path = tmp_path / "map.json"
    damaged = [text[:rng.randrange(len(text))] for _ in range(20)]
    for _ in range(100):
        k = rng.randrange(len(text))
        damaged.append(text[:k] + chr(rng.randrange(32, 127)) + text[k + 1:])
    damaged += ["", "null", "[]", "{}", "3", '"x"', "[" * 100000, "\xff"]
    whole = json.loads(text)
    for key in whole:
        damaged += [json.dumps({k: v for k, v in whole.items() if k != key})]
    for content in damaged:
        path.write_text(content)
        try:
            loaded = json.loads(content)
        except (ValueError, RecursionError):
            loaded = None
        if loaded == whole:             # a blank
            continue
        with pytest.raises(ConverseError) as error:
            ParameterMap.load(path)
        assert "\n" not in str(error.value) and str(path) in str(error.value)
        assert "object" not in str(error.value)         # words of Python's
    with pytest.raises(ConverseError, match="cannot be read"):
        ParameterMap.load(tmp_path / "none.json")


# ---- the command and the picture

def run(*arguments, directory):
    home = os.path.dirname(os.path.dirname(converse.__file__))
    result = subprocess.run([sys.executable, "-m", "converse.commands.map", *map(str, arguments)],
                            cwd=directory, capture_output=True, text=True, timeout=PATIENCE,
                            env={**os.environ, "PYTHONPATH": home})
    return result.returncode, result.stdout, result.stderr


@pytest.mark.slow
def test_the_command(tmp_path):
    status, out, err = run("--plane", "c=0", "--time-limit", 0, "map.json", directory=tmp_path)
    assert (status, err) == (1, "") and "not all of it is proved" in out
    status, out, err = run("--plane", "b=0", "-r", "map.json", directory=tmp_path)
    assert status == 2 and "another region" in err and err.count("\n") == 1
    status, out, err = run("-g", "map.svg", "map.json", directory=tmp_path)
    assert status == 2 and "nothing to draw yet" in err and err.count("\n") == 1
    assert sorted(os.listdir(tmp_path)) == ["map.json"]


@pytest.mark.parametrize("arguments, words", [
    ((), "required: MAP"), (("--plane", "d=0", "m.json"), "invalid choice"),
    (("--plane", "b=0", "--down-to", "0.9", "m.json"), "not a number above 1"),
    (("m.json",), "cannot be read"), (("--down-to", "1.1", "m.json"), "--down-to needs"),
    (("-r", "m.json"), "cannot be read"), (("--plane", "b=0", "no/m.json"), "cannot be written"),
    (("--plane", "b=0", "-g", "m.json", "m.json"), "would overwrite"),
    (("--plane", "b=0", "-g", "m.ps", "m.json"), ".svg or .png or .pdf"),
    (("--plane", "b=0", "-g", "no/m.svg", "m.json"), "cannot be written")])
@pytest.mark.slow
def test_bad_usage_is_one_line(tmp_path, arguments, words):
    status, out, err = run(*arguments, directory=tmp_path)
    assert status == 2 and words in err and err.count("\n") == 1 and out == ""
    assert not os.listdir(tmp_path)


@pytest.mark.parametrize("name", ["crossed.json", "froeschle-0.3.json"])    # the latter not ASCII
def test_an_input_is_no_map(root, capsys, name):
    """Of a potential of one's own there is none, and the line says what there is instead."""
    assert cli.main([str(root / "inputs" / name)]) == 2
    err = capsys.readouterr().err
    assert "is an input and not a map" in err and "--method loewner" in err and err.count("\n") == 1


@pytest.mark.slow
def test_the_report(made, capsys):
    assert cli.main([str(made[1])]) == 0
    out = capsys.readouterr().out
    assert out == ParameterMap.load(made[1]).report(made[1])
    assert "\nVerify : converse-check %s\n" % made[1] in out
    nothing = ParameterMap.new("b=0", F(2)).report(made[1])
    assert "Verify" not in nothing and nothing.count("open in some direction up to r = 2") == 2
    assert "all r >= " in out and "SHA-256 : " + made[0].sha256 in out
    assert {"Cells", "Prisms", "Reached"} <= labels(out) and labels(out) <= explained()


@pytest.mark.slow
def test_without_the_core_a_map_is_described_and_drawn(made, tmp_path):
    code = ("import sys\nsys.modules['converse._native'] = None\n"
            "from converse.commands.map import main\nsys.exit(main())")

    def run(*arguments):
        result = subprocess.run([sys.executable, "-c", code, *map(str, arguments)], cwd=tmp_path,
                                capture_output=True, text=True, timeout=PATIENCE)
        return result.returncode, result.stdout, result.stderr

    status, out, err = run("--plane", "b=0", "new.json")
    assert (status, out) == (2, "") and err.startswith("converse-map: the ")
    assert "C core" in err
    assert err.count("\n") == 1 and not os.listdir(tmp_path)
    status, out, err = run("-g", "map.svg", made[1])
    assert (status, err) == (1, "")         # its estimate has fewer places than is usual
    assert "Cells : %d proved" % made[0].count(PROVED) in out
    assert os.listdir(tmp_path) == ["map.svg"]


def test_what_is_written_in_pictures_can_be_read(tmp_path, monkeypatch):
    """No words are smaller than 8 points, none lie on the cells without a background."""
    drawn = []
    monkeypatch.setattr(map_figure, "SAMPLES", 30)
    monkeypatch.setattr(map_figure.plot, "encode",
                        lambda page, *_, **__: drawn.append(page) or b"")
    found = ParameterMap.new("a=b", F(2))
    for face, known in enumerate(found.estimate):
        known.update(dict.fromkeys(found.places(), 1.0))
        for half in found.roots[face].cut(0):
            half.kind = AT_ONCE if half.cell.low[0] else OPEN
    map_figure.draw(found, tmp_path / "map.svg")
    words = [text for text in drawn[0].findobj(Text) if text.get_text()]
    assert min(text.get_fontsize() for text in words) >= 8
    assert {"a = b", "c", "\u03b5 \u2265 0.0272: no torus (1989)"} <= {
        text.get_text() for text in words}
    legend = drawn[0].axes[0].get_legend()
    assert legend.get_frame_on() and legend.get_window_extent().y1 < \
        drawn[0].axes[0].get_window_extent().y0         # it hides nothing


@pytest.mark.parametrize("kind", ["svg", "png", "pdf"])
@pytest.mark.slow
def test_pictures(made, tmp_path, kind):
    path = tmp_path / ("map." + kind)
    map_figure.draw(made[0], path)
    first = path.read_bytes()
    assert first.startswith({"svg": b"<?xml", "png": b"\x89PNG", "pdf": b"%PDF"}[kind])
    map_figure.draw(made[0], path)
    assert path.read_bytes() == first


def test_the_largest_eigenvalue_of_the_picture():
    """B - 2 of the waves alone and together, to a few digits."""
    assert map_figure.largest([(1, 0, 0), (1, 0.5, 0), (0, 0, 1), (1, 1, 2)]) == pytest.approx(
        [1, 1, 2, 4.72], abs=0.01)
