"""docs/reference/reports.md explains each line of each report: the labels of the golden outputs and
of reports that the commands print here.  (Those of diagrams are in tests/diagram.)"""

import re

import pytest
from conftest import ROOT

from converse import check
from converse.commands import orbits as orbits_cli
from converse.commands import portrait as portrait_cli
from converse.commands import prove as cli
from converse.commands import tori as tori_cli

INPUTS, GOLDEN = ROOT / "inputs", ROOT / "golden_outputs"
LABEL = r"(?m)^([A-Zx][^:\n>]*?)\.?(?: {2,}| : | :$)"


def explained():
    """The labels in the first columns of the page's tables, where bars are escaped."""
    page = (ROOT / "docs" / "reference" / "reports.md").read_text("utf-8")
    cells = re.findall(r"(?m)^\| (`.*?`) \| ", page)
    return {label.replace("\\|", "|") for cell in cells for label in re.findall("`([^`]+)`", cell)}


def labels(text):
    """Of a report, with "a" for the letter of a part."""
    return {re.sub("^(Part|x\\* of) [a-z]$", r"\1 a", label)
            for label in re.findall(LABEL, text)}


def test_the_labels_of_the_golden_outputs():
    texts = {path: path.read_text("utf-8") for path in sorted(GOLDEN.glob("*/*.out"))}
    assert len(texts) >= 29
    found = set().union(*map(labels, texts.values()))
    assert {"Verify", "Searched", "Part a", "Initial region", "Tries that failed"} <= found
    assert found - explained() == set()


# What is run, $ being the folder of the inputs; exit statuses; labels that the report has.
PROVED, PARTLY = (0,), (0, 1)
RUNS = {
    "no circle": [(cli, "--method loewner $/standard-63-64.in -b x.proof", PROVED, {"Verify"}),
                  (check, "x.proof", PROVED, {"Leaves", "x*"})],
    "undecided": [(cli, "--method loewner -d 6 $/standard-k090.in -b x.proof", PARTLY,
                   {"Undecided", "Tries", "To try"}),
                  (cli, "-r x.proof", PARTLY, {"Tries"})],
    "1989": [(cli, "-d 3 $/trig274.in", PARTLY, {"Undecided prisms", "To try"})],
    "a circle": [(tori_cli, "$/standard-k090.in --rotation golden -b x.torus", PROVED,
                  {"Constants", "Series"}),
                 (check, "x.torus", PROVED, {"Small divisors", "Strip"})],
    "no circle found": [(tori_cli, "$/standard-k090.in --rotation golden --points 64", PARTLY,
                         {"Not found", "By hand"})],
    "orbits": [(orbits_cli, "trig 3,5/7 0.01 --prove", PROVED,
                {"Stability indices", "Second variation", "Exponent"}),
               (orbits_cli, "standard 3/8 0.5 --minimax --prove", PROVED,
                {"Residue", "Pass", "Flux"}),
               (orbits_cli, "$/standard-k090.in 3,0/8 1", PROVED, {"Map", "Potential"})],
    "a portrait": [(portrait_cli, "$/standard-k090.in --columns 8 --depth 6 -b x.portrait", PARTLY,
                    {"Verify", "Columns", "Undecided in a column"}),
                   (check, "x.portrait", PROVED, {"Area without circles"})],
}


@pytest.mark.parametrize("name", RUNS)
@pytest.mark.slow
def test_the_labels_of_reports(name, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for command, words, statuses, expected in RUNS[name]:
        status = command.main(words.replace("$", str(INPUTS)).split())
        out, err = capsys.readouterr()
        assert status in statuses, err
        found = labels(out)
        assert expected <= found and found - explained() == set()
