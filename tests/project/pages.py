"""README.md and docs/: their tables, and whether a number stands in a page, in whatever words."""

import csv
import re
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
DOCS = ROOT / "docs"
PAGES = {page.name: page.read_text("utf-8") for page in (ROOT / "README.md", *DOCS.rglob("*.md"))}


def rows(page, first):
    """The table whose head begins with this cell: its rows, a list of cells each; with the head."""
    table = re.search(r"^\| *%s *\|.*?(?=\n\n)" % re.escape(first), PAGES[page],
                      re.MULTILINE | re.DOTALL)[0].split("\n")
    return [[cell.strip() for cell in row.strip("|").split("|")] for row in table
            if not row.startswith("|-")]


def columns(page, first):
    """The same of a table that runs to the right."""
    return list(zip(*rows(page, first)))


def table(name):
    """The rows of a table of docs/data/."""
    with open(DOCS / "data" / (name + ".csv"), encoding="ascii", newline="") as file:
        return list(csv.DictReader(file))


def golden(name):
    return (ROOT / "golden_outputs" / (name + ".out")).read_text("utf-8")


def number(text):
    return int(text.replace(",", ""))


def numbers_of(page):
    return set(re.findall(r"[0-9][0-9.,]*(?:e-?[0-9]+|[0-9])|[0-9]", PAGES[page]))


def missing(page, *values):
    """Those of the numbers, integers or as they are written, that the page does not name."""
    words = [format(value, ",") if isinstance(value, int) else value for value in values]
    return [word for word in words if word not in numbers_of(page)]


def is_near(page, value, factor):
    """Does the page name a number that is the value but for a factor?"""
    return any(1 / factor < float(word.replace(",", "")) / value < factor
               for word in numbers_of(page) if word.count(".") < 2)
