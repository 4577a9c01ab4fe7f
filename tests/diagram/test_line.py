"""The search along one parameter: the x* of a cell, the values with tori, and the order of work."""

import itertools
from fractions import Fraction as F

import pytest

from converse import FourierMap, diagram, tori
from converse.diagram import Diagram, line, none, some
from converse.diagram.value import POINTS_A_SECOND, Existence
from converse.model.problem import Problem

from truth import TORTURE


def cosines(**ranges):
    """V = K1 cos y + 0.2 cos 2y, whose circles come back twice as K1 grows."""
    return FourierMap({(1, "-1/2"): {"K1": 1}, (2, "+cos"): "0.2"}, **ranges)


def excluded(low, high, hints=(), points=20000):
    return none.exclude(cosines(K1=(low, high)), list(hints), points)


# ---- x*

def test_x_is_chosen_by_what_it_leaves():
    found = excluded("1.4", "1.5")
    assert found.proof.no_tori
    again = excluded("1.4", "1.5", found.xstars)
    assert again.proof.no_tori and again.xstars == found.xstars
    assert 4 * again.points < found.points              # without the scan


@pytest.mark.slow
def test_the_choice_of_x_is_the_same_each_time():
    assert excluded("0.3", "0.301")[::2] == excluded("0.3", "0.301")[::2]


def test_a_range_over_whose_middle_an_x_is_known_is_halved_without_a_scan(monkeypatch):
    monkeypatch.setattr(none._Search, "_basins", None)
    found = excluded("0.6", "0.66", [("1.8749", "0")])
    assert found.proof is None and ("1.8749", "0") in found.xstars


def test_a_cell_of_which_one_x_excludes_a_part_is_halved_and_not_linked(monkeypatch):
    """Orbits of 446 points are followed over narrow ranges only, and these are cheap."""
    monkeypatch.setattr(none, "linked", None)
    found = excluded("0.59", "0.594", [("1.8450", "0")], 1 << 16)
    assert found.proof is None and found.xstars == (("1.8450", "0"),)
    assert excluded("0.592", "0.593", found.xstars, 1 << 16).proof.no_tori


@pytest.mark.slow
def test_what_one_x_leaves_is_linked_to_others():
    """The first x* leaves four clusters."""
    found = excluded("0.52", "0.53", [("1.7969", "0")], 1 << 16)
    assert found.proof.no_tori and len(found.proof.trees) > 2
    assert len({each.xstar for each in found.proof.trees}) > 2 and found.proof.verify()
    assert all(any(each.problem.shifts[0]) for each in found.proof.parts)


def test_a_cell_takes_no_more_points_than_are_left():
    family = cosines(K1=("0.535", "0.54"))
    hints = [("1.7917", "0")]
    whole = none.exclude(family, hints, 2000)
    for most in (whole.points - 1, whole.points // 8, 1):
        part = none.exclude(family, hints, 2000, most)
        assert most < part.points < most + 50000 and part[1:] == (None, ())
    assert none.exclude(family, hints, 2000, 10 ** 4, lambda: True) is None


def test_a_circle_is_not_linked_away():
    """One is proved at K1 = 0.5088."""
    found = excluded("0.508", "0.509", [("1.7969", "0"), ("1.7809", "0"), ("1.8449", "0")])
    assert found.proof is None


def test_half_a_turn_is_scanned_where_v_is_even(monkeypatch):
    asked = []
    monkeypatch.setattr(none._Search, "_left", lambda self, place, cuts: (asked.append(place), 0))
    for harmonics, part in (({1: 1, (2, "+cos"): 1}, 1), ({(1, "+cos"): 1, (2, "+cos"): 1}, 2)):
        search = none._Search(Problem.of(FourierMap(harmonics)), 1, bool, 1)
        asked.clear()
        search._basins()
        scanned = sorted(place[0] / none.SCALE for place in asked)
        assert len(scanned) - none.SCAN[1] // part in (0, 1)    # and the prover's choice
        assert all(any(abs(x - z % 6.2832) < 0.06 for y in scanned for z in ((y, -y) if part == 2
                   else (y,))) for x in (0.1, 1, 2, 3, 4, 5, 6))


@pytest.mark.slow
def test_no_x_excludes_a_circle():
    assert excluded("0.42", "0.42")[1:] == (None, ())         # a circle is proved there


@pytest.mark.slow
def test_two_angles_have_an_x_far_from_the_first_choice():
    family = FourierMap({(1, 0, "-1/2"): {"K": 1}, (0, 1, "+cos"): {"K": 1},
                         ((1, 1), "+cos"): "0.1"}, K=("0.9", "0.92"))
    assert none.exclude(family, [], 10 ** 6).proof.no_tori


# ---- values with tori

def runs_of(looks):
    runs = some.Runs(Diagram.of(cosines(K1=(0, 1))), [])
    runs.looks = {F(value): (seen,) if seen else None for value, seen in looks.items()}
    return runs


def test_values_that_are_seen_next_to_each_other_are_a_run():
    runs = runs_of({"0": .2, "0.1": .2, "0.2": None, "0.3": .25, "0.4": None})
    assert runs.runs() == [[0, F("0.1")], [F("0.3")]]


def test_the_first_torus_of_a_run_is_looked_for_at_its_upper_end():
    runs = runs_of({"0": None, "0.1": None, "0.2": .2, "0.3": .2, "0.4": .2, "0.5": None})
    for effort in some.EFFORTS[1]:
        assert runs._proofs() == [some.Task(F("0.4"), effort, F("0.2"))]
        runs.tried[F("0.4")] = effort
    assert runs._proofs() == [some.Task(F("0.3"), some.EFFORTS[1][0], F("0.2"))]


def test_beyond_a_torus_at_the_end_of_a_run_it_is_tried_half_of_the_way(monkeypatch):
    """An orbit may be taken for chaotic where there is a torus."""
    runs = runs_of({"0": .2, "0.4": .2, "0.5": None})
    monkeypatch.setattr(runs, "_proved", lambda: [F("0.4")])
    assert runs._proofs() == [some.Task(F("0.45"), some.EFFORTS[1][0], F("0.4"))]
    monkeypatch.setattr(Diagram, "none", [(F("0.44"), F(1))])
    assert runs._proofs() == [some.Task(F("0.42"), some.EFFORTS[1][0], F("0.4"))]


@pytest.mark.parametrize("last", [F("0.8"), F("0.55"), F("0.41")])
def test_a_run_is_proved_up_to_the_last_value_that_can_be(monkeypatch, last):
    """Tries fail beyond a value, which no look is near; with less effort sooner."""
    proved = [F(0)]
    monkeypatch.setattr(some.Runs, "_proved", lambda self: proved)
    runs = runs_of({"0": .2, "0.2": .2, "0.4": .2, "0.8": .2, "0.81": .2, "0.9": None})
    for _ in range(100):
        for value, effort, back, _ in runs._proofs():
            assert back == max(proved)
            runs.tried[value] = effort
            if value <= last * effort / some.EFFORTS[1][-1]:
                proved.append(value)
    assert 0 <= last - max(proved) <= 3 * runs.grain and not runs._proofs()


def test_tori_are_tried_for_every_value_between_proved_ones(monkeypatch):
    """Then for the lower half, or the lowest quarter."""
    runs = runs_of({"0": .2, "0.2": .2, "0.6": .2, "0.8": None})
    tori_of = [Existence(F(value), F(value), None, name) for value, name in (
        ("0.2", "low"), ("0.6", "high"))]
    monkeypatch.setattr(Diagram, "tori", tori_of)
    low, high = ("low", "0", "0.2"), ("high", "0.2", "0.6")
    for ends in ("0.2", "0.6"), ("0.1", "0.4"), ("0.05", "0.3"), ():
        asked = [task for _, task in runs._of_ranges(7)]
        assert not any(task.start for task in runs._proofs())   # first, beyond the last torus
        assert asked == [some.Task(F(end), 5, F(back), start) for end, (start, back, _) in zip(
            ends, (low, high))]
        for task in asked:
            runs.take(task, some.Outcome(1, None, None))
    again = some.Runs(runs.diagram, [line.split() for line in runs.lines()])
    assert again.ranges == runs.ranges and not again.tried and not again._of_ranges(7)
    again.ranges.clear()
    tori_of.append(Existence(F("0.2"), F("0.4"), None, "every"))
    assert [task.start for _, task in again._of_ranges(7)] == ["low"] and not runs._of_ranges(1)
    assert again._is_known(F("0.3")) and not again._is_known(F("0.5"))
    again.take(some.Task(F("0.3")), some.Outcome(1, (.2,), None))
    assert [each.value for each in again.diagram.seen] == [(F(0),)]     # the others are proved


@pytest.mark.parametrize("low", [0, "0.1"])
def test_tori_of_a_range_are_proved_from_the_torus_at_its_end(low):
    """Where V is 0 there is no way from a torus, but one to it."""
    found = Diagram.of(FourierMap({1: {"K": 1}}, K=(0, 2)))
    start = tori.prove(found.over(((F("0.3"), F("0.3")),)), "golden")._text()
    task = some.Task(F("0.2"), 5, F(low), start)
    member = found.add(some.attempt(found.over((task.ends,)), task).torus)
    assert member.box == ((F(low), F("0.2")),) and found.verify()


@pytest.mark.slow
def test_a_torus_is_tried_as_soon_as_one_is_seen_and_then_the_grid_is_looked_at():
    runs = some.Runs(Diagram.of(cosines(K1=(0, 1))), [])
    assert [task.effort for task in runs.round()] == [0] * (some.BORDERS + some.LOOKS)
    for task in runs.round():
        runs.take(task, some.Outcome(1, (0.2,), None))
    first, *looks = runs.round()
    assert first.effort == some.EFFORTS[1][0] and not any(task.effort for task in looks)
    runs.diagram.add(tori.prove(cosines(K1=("0.1", "0.1")), points=1 << 12))
    assert not any(task.effort for task in runs.round())


def test_gaps_are_looked_at_down_to_a_share_of_what_is_open(monkeypatch):
    """Circles come back in windows that are small parts of the range."""
    runs = runs_of({})
    runs.looks.update({F(i, 300): None for i in range(61)})
    assert not runs._looks()            # The whole range is open, and these gaps are small.
    monkeypatch.setattr(Diagram, "none", [(F("0.2"), F(1))])
    assert len(runs._looks()) == some.LOOKS
    assert all(task.value < F("0.2") for task in runs._looks())


def test_an_end_of_a_run_is_looked_at_as_finely_as_tori_are_proved_near_it(monkeypatch):
    runs, proved = runs_of({"0": .2, "0.5": .3, "0.52": None}), []
    monkeypatch.setattr(runs, "_proved", lambda: proved)
    found = []
    for nearest in "0.3", "0.4", "0.5":
        found.append(F("0.51") in {task.value for task in runs._looks()})
        proved.append(F(nearest))
    assert found == [False, False, True]


def test_between_values_with_tori_looks_are_sparse(monkeypatch):
    runs = runs_of({"0": .2, "0.5": .3, "0.52": None, "0.56": None, "1": .2})
    monkeypatch.setattr(runs, "_proved", lambda: [F("0.4")])
    assert {task.value for task in runs._looks()} == {F("0.25"), F("0.78"), F("0.51"), F("0.54")}
    runs.looks.update({F(i, 60): (.2,) for i in range(61)})
    assert not [task for task in runs._looks() if task.value < F("0.5")]


def test_a_try_has_more_effort_than_those_on_the_way(monkeypatch):
    runs = runs_of({"0": .2, "0.4": .2, "0.5": .2, "0.6": None})
    monkeypatch.setattr(runs, "_proved", lambda: [F("0.3")])
    runs.tried.update({F("0.3"): 5, F("0.4"): 20})
    assert runs._proofs() == [some.Task(F("0.5"), 80, F("0.3"))]
    runs.tried.update({F("0.5"): 80})
    assert runs._proofs() == [some.Task(F("0.4"), 80, F("0.3"))]
    runs.tried.update({F("0.4"): 80})
    assert runs._proofs() == [some.Task(F("0.35"), 5, F("0.3"))]


def test_no_try_takes_more_than_is_left():
    runs = runs_of({"0": .2, "0.1": .2, "0.2": None})
    assert runs._proofs(some.LEAST[1])[0].effort == some.LEAST[1] and not runs._proofs(1.9)
    runs.tried[F("0.1")] = 5
    assert runs._proofs(6) == [some.Task(F("0.1"), 6, F(0))]
    assert runs._proofs(4) == [some.Task(F("0.05"), 4, F(0))]
    assert not runs.round(0.6) and len(runs.round(1.9)) == 2 and not runs.round(-1)


def test_tori_that_never_end(tmp_path):
    """Nor is any value found above which there are none: the parameter bends V too little."""
    found = diagram.explore(FourierMap({1: {"K": "1e-9"}}, K=(1, 3)), budget=2, jobs=1)
    assert not found.none and "no absence of tori was proved" in found.report()


def test_nothing_is_looked_for_where_v_is_0():
    runs = some.Runs(Diagram.of(FourierMap({(1, "+cos"): {"k": 1}}, k=(-1, 1))), [])
    assert runs._is_known(F(0)) and not runs._is_known(F(1, 8))
    family = runs.diagram.over(((F(0), F(0)),))
    assert none.exclude(family, [], 2000)[1:] == (None, ())


@pytest.mark.slow
def test_a_try_at_a_torus_ends_at_the_step_after_it_is_told_to():
    """Two angles may take minutes, and Ctrl-C waits for the try."""
    family, asked = FourierMap({1: "0.9"}), []
    assert some.attempt(family, some.Task(F(0), 60), lambda: asked.append(1) or False).torus
    steps = len(asked)
    for last in 1, steps // 2:
        asked.clear()
        assert some.attempt(family, some.Task(F(0), 60),
                            lambda: asked.append(1) or len(asked) == last) is None
        assert len(asked) == last


def test_a_try_takes_no_more_than_its_effort():
    """The circle at 0.96 is too dear; the proof comes from a smaller value."""
    family = FourierMap({1: {"K": 1}}, K=("0.5", "0.96"))
    found = some.attempt(family, some.Task(F("0.96"), F("2.3"), F("0.5")))
    assert found.points <= F("2.3") * POINTS_A_SECOND
    (wave, value), = zip(*found.torus.torus.potential[:2])
    assert F("0.5") < value < F("0.96")
    assert some.attempt(family, some.Task(F("0.96"), F("0.5"), F("0.5"))).torus is None


def test_values_have_few_decimals():
    assert some.nice(F(1, 3), F(1, 100)) == F("0.33")
    assert some.nice(F(0), F(1, 100)) == 0 and some.nice(F("0.5"), F(1, 10)) == F("0.5")


# ---- the whole

@pytest.mark.skipif(TORTURE <= 1, reason="a minute; make torture has it")
def test_there_are_circles_above_values_without_circles(tmp_path):
    found = diagram.explore(cosines(K1=("0.31", "0.45")), path=tmp_path / "two.map", budget=45,
                            jobs=1)
    inside = [ends for ends in found.none if ends[0] <= F("0.315") <= ends[1]]
    assert inside and any(each.low > inside[0][1] for each in found.tori)
    assert found.verify()


@pytest.mark.slow
def test_a_diagram_does_not_depend_on_the_workers(tmp_path):
    first, second = (diagram.explore(cosines(K1=("0.28", "0.7")), path=tmp_path / name, budget=1,
                                     jobs=jobs) for name, jobs in (("1.map", 1), ("2.map", 2)))
    assert (first.members, first.search) == (second.members, second.search)


@pytest.mark.parametrize("jobs", [1, 3])
def test_no_search_takes_more_than_its_budget(jobs):
    """What is broken off is done anew by a search that continues with more."""
    found = diagram.explore(cosines(K1=("0.5", "0.6")), budget="0.4", jobs=jobs)
    assert found.points == 0.4 * POINTS_A_SECOND
    work = line._Line(found)
    parts = sorted((cell.low, cell.high) for cell in work.cells)
    assert sum(high - low for low, high in [*parts, *found.none[1:-1]]) == F("0.1")


def test_a_try_that_is_stopped_tells_nothing():
    """Not even that the middle is excluded, and the cell is not: it is to be done anew."""
    def tried(most):
        calls = itertools.count()
        return none.exclude(cosines(K1=("0.6", "0.65")), [("1.8", "0")], 20000,
                            stop=lambda: next(calls) >= most)

    whole = tried(10 ** 6)
    assert whole.xstars and not whole.proof and tried(0) is None
    assert all(found in (None, whole) for found in map(tried, range(1, 40)))


def test_what_exceeds_the_budget_is_dropped(monkeypatch):
    work = line._Line(Diagram.of(cosines(K1=("0.3", "0.6"))))
    cell = line.Cell(F("0.3"), F("0.4"), 1, F(1))
    work.take(cell, none.Outcome(100, None, ()), 99)
    assert work.diagram.points == 99 and work.cells[-1] == cell
    work.take(cell, none.Outcome(100, None, ()), 100)
    assert work.diagram.points == 199 and cell.halves(True) == work.cells[-2:]


def test_a_cell_next_to_excluded_values_comes_first(monkeypatch):
    work = line._Line(Diagram.of(cosines(K1=("0.3", "0.6"))))
    work.cells = [line.Cell(F(low), F(high), 1, F(1)) for low, high in (
        ("0.3", "0.4"), ("0.4", "0.5"), ("0.5", "0.501"), ("0.501", "0.502"))]
    monkeypatch.setattr(Diagram, "none", [(F("0.502"), F("0.6"))])
    assert [cell.low for cell in work._cells()] == [F("0.4"), F("0.3"), F("0.501")]


def test_a_cell_between_values_with_tori_comes_last():
    """Even below the first value with a torus, from where V is 0 on."""
    work = line._Line(Diagram.of(FourierMap({1: {"k": 1}}, k=(0, 2))))
    work.cells = [line.Cell(F(low), F(high), 1, F(1)) for low, high in (
        ("0", "0.1"), ("0.3", "0.4"), ("1.31", "1.32"))]
    work.tori.looks.update({F("0.125"): (.2,), F("1.25"): (.2,), F("1.3"): None})
    assert [cell.low for cell in work._cells()] == [F("1.31")] and not work._cells()
    assert [cell.low for cell in work._cells(True)] == [F("0.3"), F(0)] and work.cells == []


def test_a_cell_with_a_torus_is_halved_and_not_tried(monkeypatch):
    work = line._Line(Diagram.of(cosines(K1=("0.3", "0.5"))))
    monkeypatch.setattr(Diagram, "tori", [Existence(F("0.4"), F("0.4"), None, "")])
    chosen = work._cells()
    assert chosen and not any(cell.low <= F("0.4") <= cell.high for cell in chosen)
