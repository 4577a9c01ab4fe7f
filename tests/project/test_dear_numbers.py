"""Numbers of the pages that take from seconds to minutes each, computed anew by `make torture`; and
the two cheapest of them, always.

The numbers of test_numbers.py are cheap.  Seconds are those of the machine and the day that a page
names, and are not looked at."""

import re
from fractions import Fraction

import chart
import pytest
from conftest import ROOT, around
from pages import PAGES, missing, number, rows
from test_numbers import POINTS, sharper

from converse import Problem, portray, tori
from converse.model.inputs import read_input
from converse.model.map import MuldoonMap

from truth import TORTURE

dear = pytest.mark.skipif(TORTURE <= 1, reason="minutes; make torture has it")


def linked_points():
    """(map, value, prisms) of the table of other maps."""
    for name, *cells in rows("method.md", "map")[1:]:
        name = name.partition(":")[0]
        values = re.findall(r"0\.\d+", cells[4])
        prisms = [cell.strip() for cell in cells[5].split(";")] if cells[5] else []
        assert len(values) == len(prisms), name
        yield from ((name, value, number(count)) for value, count in zip(values, prisms))


CHEAP = "two harmonics, K2 = 0.4", "0.6"
XSTAR = {"0.5887": ("1.84", "0")}           # where the program's does not do


@pytest.mark.parametrize("name, value, prisms", [
    pytest.param(*row, marks=() if row[:2] == CHEAP else dear) for row in linked_points()])
@pytest.mark.slow
def test_linked_points_of_other_maps(name, value, prisms):
    counts = sharper(POINTS[name][1](value))
    assert counts.linked and counts.proved == prisms


def windows():
    """(K1, rotation number or "", marks) of the circles that come back."""
    for values, proved, rotation, _ in rows("frontier.md", "K1")[1:]:
        assert proved in ("a circle", "no circle")
        assert bool(rotation) == (proved == "a circle")
        for at in values.split("; "):
            yield pytest.param(at, rotation.strip("`"), id=at,
                               marks=() if at in ("0.207", "0.28", "0.42", "0.52") else dear)


@pytest.mark.slow
@pytest.mark.parametrize("K1, rotation", list(windows()))
def test_circles_that_come_back(K1, rotation):
    """Where the straight way from the map without potential is barred, by a bend; two come from
    orbits, which are not followed here."""
    name = "two harmonics, K2 = 0.4"
    problem = POINTS[name][1](K1)
    if not rotation:
        sharper(problem, xstar=XSTAR.get(K1))
    elif K1 in ("0.207", "0.212"):
        tori.prove(tori.find(problem.map, rotation))
    elif K1 == "0.42":
        start = tori.find(POINTS["standard map"][1](K1).map, rotation)
        tori.prove(tori.find(problem.map, rotation, start=start))


def test_a_range_without_circles(tmp_path):
    """The page's commands write its input, and choose its x*."""
    old, new, *xstar = re.search(r"sed 's/(.*?)/(.*?)/' inputs/two-harmonics.json > windows.json\n"
                                 r" *converse --method loewner --xstar (\S+) (\S+) windows.json",
                                 PAGES["frontier.md"]).groups()
    text = (ROOT / "inputs" / "two-harmonics.json").read_text("utf-8")
    assert old in text
    (tmp_path / "windows.json").write_text(text.replace(old, new))
    counts = sharper(read_input(tmp_path / "windows.json"), xstar=tuple(xstar))
    assert not counts.linked
    assert missing("frontier.md", *new.replace('"', "").split(", "), counts.proved) == []


@dear
@pytest.mark.parametrize("problem", [
    POINTS["Froeschlé, B = 0.3"][1]("0.62"), chart.on_line("0.0139", together=True),
    *(Problem(MuldoonMap(k, 0, 0)) for k in ("0.9717", "0.97165"))], ids=str)
def test_prisms_of_single_values(problem):
    assert missing("method.md", sharper(problem).proved) == []


@dear
@pytest.mark.parametrize("epsilon, prisms, points", [
    (row[0].partition(" ")[0], *map(number, row[2:4])) for row in rows(
        "speed.md", "down to epsilon | CPU seconds | prisms proved | longest orbit | confirmed by "
        "`converse-check`, CPU seconds")[1:]])
def test_the_end_of_the_line(epsilon, prisms, points):
    counts = sharper(chart.on_line(epsilon, "0.0280", together=True))
    assert (counts.proved, counts.max_NTsteps) == (prisms, points)


# The rows of portrait.md whose maps are drawn: k, columns, depth, and how they are asked for.
PORTRAITS = {
    "strips, 15": lambda k: portray(MuldoonMap(k, 0, 0), depth=15),
    "strips, 16": lambda k: portray(MuldoonMap(k, 0, 0), depth=16),
    "lines, 17": lambda k: portray(MuldoonMap(k, 0, 0), depth=17, strips=False),
    "300 strips, 14": lambda k: portray(around(
        ("0.9005", 0, 0, 1, 1), ("0.0005", 0, 0, 1, 1)), columns=300, depth=14),
}


@dear
@pytest.mark.parametrize("k, kind, share", [
    (row[0], ", ".join(row[1:3]), row[3]) for row in rows("portrait.md", "k")[1:]])
def test_shares_of_portraits(k, kind, share):
    """Rounded up to the places of the table."""
    digits, exact = share.split()[0], 100 * PORTRAITS[kind](k).undecided
    assert 0 <= Fraction(digits) - exact <= Fraction(1, 10 ** len(digits.partition(".")[2]))


def rows_of_tori():
    """(map, parameter, rotation, modes or pieces, residual, needed) of those of a minute or less,
    of today's release."""
    map_ = rotation = ""
    for name, vector, size, residual, needed, seconds, day in rows("tori.md", "map")[1:]:
        map_ = "standard" if "standard" in name else "line" if "thesis" in name else map_
        rotation = vector.strip("`") or rotation
        value = re.findall(r"0\.\d+", name)
        ends = ("0", *value)[-2:] if "every" in name else value[:1]
        if day.startswith("20") and float(seconds.replace(",", "")) < 60:
            yield (map_ if "every k" not in name else "standard", ends, rotation, size, residual,
                   needed)


@dear
@pytest.mark.parametrize("name, ends, rotation, size, residual, needed",
                         list(rows_of_tori()))
def test_tori(name, ends, rotation, size, residual, needed):
    """Modes differ by a few per cent between machines, and residuals by a factor of two."""
    def end(value):
        return MuldoonMap(value, 0, 0) if name == "standard" else chart.on_line(value).map

    if len(ends) == 1:
        problem = end(ends[0])
    elif name == "standard":
        low, high = map(Fraction, ends)
        problem = around(((low + high) / 2, 0, 0, 1, 1), ((high - low) / 2, 0, 0, 1, 1))
    else:
        problem = chart.on_line(*ends, together=True)
    found = tori.find(problem, rotation)
    proof = tori.prove(found)
    assert float(residual) / 2 < proof.residual < 2 * float(residual)
    assert float(needed) / 2 < proof.needed < 2 * float(needed)
    if "piece" in size:
        assert len(found) == int(size.split()[0])
    else:
        assert abs(len(found.k) / number(size) - 1) < 0.05
