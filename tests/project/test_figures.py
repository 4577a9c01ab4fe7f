"""docs/figures.csv lists the pictures of docs/, pictures show the tables of docs/data/, and the
values that are proved are the same in all pictures, pages and scripts."""

import re
import runpy

import chart
import pytest
import sides
from pages import DOCS, PAGES, ROOT

FIGURES = runpy.run_path(str(DOCS / "figures.py"))
ROWS = {row["picture"]: row for row in FIGURES["rows"]()}
WORDS = {path.stem: "\n".join(re.findall("<!-- (.*?) -->", path.read_text("utf-8"), re.DOTALL))
         for path in DOCS.glob("*.svg")}

# No torus of the line, and of the standard map, for all larger parameters; a torus; 1989.
NO_TORUS, TORUS, NO_CIRCLE, CIRCLE, THESIS = "0.01389", "0.0122", "0.9717", "0.9716", "0.0272"
NO_CIRCLE_ALONE = "0.97165"             # of the standard map, for this k alone
SHOWN = {
    "chart-bound.svg": (NO_TORUS, TORUS), "frontier.svg": (NO_TORUS, TORUS, THESIS),
    "chart-sides.svg": (TORUS, NO_CIRCLE_ALONE, CIRCLE),
    "README.md": (NO_TORUS, TORUS, NO_CIRCLE, NO_CIRCLE_ALONE, CIRCLE),
    "frontier.md": (NO_TORUS, TORUS, NO_CIRCLE, NO_CIRCLE_ALONE, CIRCLE),
    "speed.md": (NO_TORUS,), "trust.md": (NO_TORUS,), "questions-of-1989.md": (NO_TORUS, TORUS),
    "tori.md": (TORUS, CIRCLE), "method.md": (NO_CIRCLE, NO_CIRCLE_ALONE),
    "limits.md": (NO_CIRCLE, NO_CIRCLE_ALONE), "first-proof.md": (NO_CIRCLE_ALONE, CIRCLE)}


def text_of(name):
    return WORDS[name[:-4]] if name.endswith(".svg") else PAGES[name]


def test_every_picture_has_a_row_and_every_table_a_picture():
    assert set(ROWS) == set(WORDS) and list(ROWS) == sorted(ROWS)
    assert {row["data"] for row in ROWS.values()} - {""} == {
        path.stem for path in (DOCS / "data").iterdir()}


@pytest.mark.parametrize("name", sorted(WORDS))
def test_a_picture_is_of_its_release_and_table(name):
    row, text = ROWS[name], (DOCS / (name + ".svg")).read_text("utf-8")
    drawn_by = re.findall("<dc:title>converse (.*?)</dc:title>", text)
    assert drawn_by in ([row["release"]], [])       # [] if a script drew it without converse.draw
    assert text.endswith(FIGURES["seal"](row["data"]) if row["data"] else "</svg>\n")


def test_every_release_of_a_picture_is_in_the_changelog():
    """By a section of its own, or in the one of the first releases, "1.0.0 to 1.12.0"."""
    def order(release):
        return [*map(int, release.split("."))]

    sections = [title.split(" to ") for title in re.findall(
        "^## ([0-9. to]+)$", (ROOT / "CHANGELOG.md").read_text("utf-8"), re.MULTILINE)]
    assert ["1.0.0", "1.12.0"] in sections
    for name, row in ROWS.items():
        assert any(order(ends[0]) <= order(row["release"]) <= order(ends[-1])
                   for ends in sections), name


@pytest.mark.parametrize("name", SHOWN)
def test_the_values_that_are_proved(name):
    text = text_of(name)
    assert [value for value in SHOWN[name] if value not in text] == []


def test_scripts_draw_these_values():
    toughest = runpy.run_path(str(ROOT / "experiments" / "toughest.py"))
    assert toughest["NO_TORI"] == (float(NO_TORUS), float(THESIS))
    assert toughest["TORUS_AT"][-1] == float(TORUS)
    assert chart.LAST[0] == NO_TORUS
    assert [row[2] for row in sides.LONGEST] == [CIRCLE, "0.0120", "0.0121", TORUS, NO_CIRCLE_ALONE]
