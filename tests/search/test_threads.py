"""The same tree, statistics and place of the end, however many threads work on it."""

import random
import threading
from dataclasses import replace

import pytest
from files import line

from converse.prover.native import Search, Task, WrongTree, chosen_start, grow
from converse.prover.settings import Settings
from converse.prover.shared import take_up

from truth import TORTURE

LOEWNER = Task(line("0.0160", "0.0280"), Settings("loewner"))
THESIS = Task(line("0.0272", "0.0273", together=False), Settings("thesis", digits=20))
TASKS = [LOEWNER, replace(LOEWNER, settings=Settings("loewner", 13)),
         replace(LOEWNER, settings=Settings("loewner", 13, stubborn=True)),
         THESIS, replace(THESIS, settings=Settings("thesis", 9, digits=20)),
         replace(THESIS, settings=Settings("thesis", 9, digits=20, stubborn=True))]


@pytest.mark.parametrize("task", TASKS)
def test_any_number_of_threads(task):
    """The text, the lengths of orbits and all statistics, also where an undecided prism ends the
    search."""
    one = grow(task)
    assert len(one.text) > 20 and not one.cells
    for threads in 2, 3, 7, 100:
        assert grow(task, threads=threads) == one


@pytest.mark.parametrize("task", [LOEWNER, TASKS[2], THESIS])
def test_a_limit_ends_every_search_at_the_same_prism(task):
    """Of leaves or of points of orbits: it counts in preorder, whatever was tried beyond it."""
    whole = grow(task)
    points = sum(whole.steps)
    assert whole.points > points        # Prisms that were cut were tried, too.
    for limit in {"leaves": 1}, {"leaves": 57}, {"points": 1.0}, {"points": 0.3 * points}:
        one = grow(task, **limit)
        assert one.cells and whole.text.startswith(one.text)
        assert "leaves" not in limit or sum(map(one.text.count, "PSU")) == limit["leaves"]
        assert "points" not in limit or sum(one.steps) <= limit["points"] + max(one.steps)
        for threads in 2, 5:
            assert grow(task, **limit, threads=threads) == one


@pytest.mark.slow
@pytest.mark.parametrize("task", [LOEWNER, replace(
    THESIS, settings=Settings("thesis", digits=2000))])
def test_threads_wait_until_the_search_is_set_up(task):
    """Though they are asked for before, and the setting up takes long."""
    one = grow(task, leaves=50)
    for _ in range(2):
        search = Search(task)
        assert search.work(5, bool, leaves=50)
        assert search.view(True).text == one.text and search.view().counts == one.counts


@pytest.mark.slow
def test_what_is_left_goes_on_in_another_search():
    """By its cells, or by its text and hints: the parts together are the whole."""
    whole, one = grow(LOEWNER), grow(LOEWNER, leaves=300)
    rest = Search(LOEWNER).grow(one.cells, threads=3)
    assert one.text + rest.text == whole.text and one.steps + rest.steps == whole.steps
    assert one.counts + rest.counts == whole.counts
    search = Search(LOEWNER)
    search.work(0, bool)
    take_up(search, LOEWNER.settings.depth, one.text, [hint for _, _, hint in one.cells])
    search.work(2, bool)
    again = search.view(True)
    assert again.text == whole.text and not again.cells and again.counts == rest.counts
    assert again.steps == [0] * len(one.text) + rest.steps


def gaps(text, rng):
    """The tree with some of its leaves untried, and what remains of it at its end cut off."""
    text = "".join("?" if node in "PU" and rng.random() < 0.1 else node for node in text)
    return text[:rng.randrange(len(text))]


@pytest.mark.slow
@pytest.mark.parametrize("task", TASKS)
def test_gaps_are_filled(task):
    """Whatever was left untried, the tree is the same in the end."""
    rng, whole, search = random.Random("gaps"), grow(task), Search(task)
    search.work(0, bool)
    for _ in range(10 * TORTURE):
        text = gaps(whole.text, rng)
        take_up(search, task.settings.depth, text, [])
        assert search.view(True).text == text.rstrip("?")
        search.work(3, bool, rng.randrange(1, 40))
        if rng.random() < 0.5:
            text = search.view(True).text
            take_up(search, task.settings.depth, text, [])
        search.work(2, bool)
        part = view = search.view(True)
        assert not part.cells
        assert view.finished and (view.examined == 1.0 or part.text.endswith("U"))
        if task.settings.method == "thesis":    # its tries do not depend on hints
            assert part.text == whole.text
        if "U" not in whole.text:
            for name, kinds in ("proved", "P"), ("cuts", "01234"):
                assert getattr(view.counts, name) == sum(map(part.text.count, kinds)) - sum(
                    map(text.count, kinds))


def test_what_lies_beyond_an_undecided_prism_of_an_earlier_run_does_not_count():
    """A gap before it is filled; what follows it is dropped."""
    task = TASKS[1]
    whole = grow(task)
    assert whole.text.endswith("U") and whole.text.count("U") == 1
    open_cuts = len(whole.text) - 2 * sum(map(whole.text.count, "PSU")) + 1
    text = whole.text + "P" * open_cuts
    first = text.index("P")
    search = Search(task)
    search.work(0, bool)
    take_up(search, task.settings.depth, text[:first] + "?" + text[first + 1:], [])
    search.work(2, bool)
    view = search.view(True)
    assert view.text == whole.text and view.finished and not view.cells
    assert (view.counts.proved, view.counts.cuts) == (1, 0)


def test_linked_leaves_are_kept():
    search = Search(LOEWNER)
    search.work(0, bool)
    take_up(search, LOEWNER.settings.depth, "02a?b", [5])
    view = search.view(True)
    assert view.text == "02a?b" and view.cells[0][2] == 5
    with pytest.raises(WrongTree):
        take_up(search, LOEWNER.settings.depth, "02a?A", [])


def test_the_prisms_tried_ahead_are_tried_once():
    """A search that is stopped and goes on again and again does not try them anew."""
    search, task = Search(LOEWNER), LOEWNER
    search.work(0, bool)
    while not search.view().finished:
        search.work(2, bool, leaves=10)
    assert search.view(True).text == grow(task).text
    assert search.view().counts == grow(task).counts


@pytest.mark.slow
def test_searches_in_several_threads_of_python():
    """Each has threads of its own."""
    tasks = [LOEWNER, TASKS[2], THESIS, replace(LOEWNER, xstar=chosen_start(LOEWNER))]
    alone, found = [grow(task) for task in tasks], [None] * 4

    def work(i):
        found[i] = grow(tasks[i], threads=2)

    threads = [threading.Thread(target=work, args=(i,)) for i in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == alone
