"""experiments/sides.py: what proofs cost near the frontier.  Measured where it takes no time."""

import xml.etree.ElementTree as ET

import output
import pytest
import sides

from converse.commands import common
from converse.storage.files import ConverseError

ROWS = [("standard", "torus", "0.9", 0.55, 136.6, 5762, 318, "", "1.12.0"),
        ("standard", "torus", "0.9716", 725.0, 3800.0, 0, 1539249, "", "1.11.0"),
        ("standard", "none", "1", 0.0012, 140.0, 1200, 148, 57, "1.12.0"),
        ("line", "torus", "0.004", 1.9, 150.0, 30000, 695, "", "1.12.0"),
        ("line", "none", "0.0160", 0.004, 141.0, 2500, 901, 18, "1.12.0")]


@pytest.fixture
def few(monkeypatch):
    monkeypatch.setattr(sides, "POINTS", {("standard", "torus"): ("0.5", "0.971"),
                                          ("standard", "none"): ("1.1",),
                                          ("line", "torus"): ("0.002",),
                                          ("line", "none"): ("0.0240",)})


def test_proofs_are_measured(few, capsys):
    rows = list(sides.measure(quick=True))
    assert [row[:3] for row in rows] == [("standard", "torus", "0.5"), ("standard", "none", "1.1"),
                                         ("line", "torus", "0.002"), ("line", "none", "0.0240")]
    assert all(0 < row[3] < 60 and row[4] > 10 and row[5] > 100 for row in rows)
    assert [bool(row[7]) for row in rows] == [False, True, False, True]
    assert all(row[8] == sides.converse.__version__ for row in rows)
    assert capsys.readouterr().out == ""                        # k = 0.971 is left out


def test_the_frontier_lies_between():
    """No torus is to be proved above, none to be excluded below; and a curve ends nearest to it."""
    ends = [sides.nearer(ROWS, "standard", side)[-1][2] for side in ("torus", "none")]
    assert ends == ["0.9716", "1"]
    for (name, side), values in sides.POINTS.items():
        for value in values:
            assert (float(value) < sides.FRONTIER[name]) == (side == "torus")
    problem = sides.problem_of("line", "0.0140")
    a, b, c = problem.amplitude
    assert a == b == c / 2 == sides.LINE * 14 / 1000


def test_the_table_is_drawn(tmp_path):
    pytest.importorskip("matplotlib")
    path = tmp_path / "chart-sides.csv"
    path.write_text(output.text(sides.COLUMNS, ROWS))
    assert [row[:6] for row in sides.read(path)] == [row[:6] for row in ROWS]
    assert sides.main([str(tmp_path), "--draw"]) == 0
    ET.parse(tmp_path / "chart-sides.svg")
    path.write_text("a,b\n")
    with pytest.raises(ConverseError, match="measure anew"):
        sides.read(path)
    path.unlink()
    assert sides.main([str(tmp_path), "--draw"]) == common.BAD
