"""Numbers of README.md and docs/ that stand in the golden outputs, in docs/data/ and in constants
of the program are those, in whatever words.  Nothing is proved anew: test_numbers.py does that."""

import re

import pytest
from pages import PAGES, ROOT, golden, missing, rows, table

from converse.check import limits
from converse.model import map as maps
from converse.prover import run


def of_report(name, *patterns):
    """The numbers of a golden output, those of each pattern."""
    report = golden(name)
    return [word for pattern in patterns
            for word in re.search(pattern, report, re.DOTALL).groups()]


def of_1989():
    """Orbit, cut and prisms of the four proofs, as printed and sound, and a failed one."""
    for kind in "as_printed", "sound":
        for name in "trig272", "trig274", "trig276", "trig278":
            yield from of_report("%s/%s" % (kind, name), r"longest successful orbit, (\d+) iter",
                                 r"was cut (\d+) times", r"Of the (\d+) successful prisms")
    yield from re.findall(r"\d+", golden("as_printed/trig274").split("Did ")[1].split("Of the")[0])


def of_toughest():
    """The shares of vectors before their onset, and the one that lasts longest."""
    rows = table("toughest")
    onsets = [(float(row["eps_below"]) + float(row["eps_above"])) / 2
              for row in rows if row["set"] == "sweep"]
    assert len(onsets) == 1000
    latest = max((row for row in rows if row["set"] == "search"),
                 key=lambda row: float(row["eps_below"]))
    return [*(round(sum(onset > eps for onset in onsets) / 10) for eps in (0.006, 0.008, 0.01)),
            *latest["p"].split(), latest["q"]]


def of_minimizing():
    """What continuation loses of the action, as a share at eps 0.04 and by eps."""
    gains = {float(row["eps"]): row for row in table("minimizing")
             if (row["potential"], row["p"], row["q"]) == ("trig", "1432 1897", "2513")}
    yield "%.1f" % (100 * float(gains[0.04]["gain"]) / -float(gains[0.04]["best"]))
    yield from (re.sub("e-0", "e-", "%.1e" % float(gains[eps]["gain"]))
                for eps in (0.01, 0.015, 0.02, 0.03, 0.04))


def of_successors():
    last, = [row for row in table("successors") if row["parameter"] == "0.01389"]
    return ["%.2f" % (100 * float(last["undecided"]))]


NUMBERS = [
    (["first-proof.md"], of_report("loewner/standard-63-64",
                                   "([0-9]+) prisms proved.*?([0-9]+) points")),
    (["README.md"], of_report("loewner/standard-63-64", r"every a in \[0.984375, (0\.985)\]")),
    (["README.md"], of_report("loewner/trig148", r"every epsilon in \[(\S+),")),
    (["1989.md"], [*of_1989()]),
    (["method.md", "inputs.md"], of_report("loewner/standard-9719-up",
                                           "Search +([0-9,]+) prisms proved, ")),
    (["speed.md", "inputs.md"], of_report("loewner/trig139", r"Search +(\S+) prisms")),
    (["questions-of-1989.md"], of_toughest()),
    (["questions-of-1989.md"], [*of_minimizing()]),
    (["portrait.md"], of_successors()),
    (["README.md", "inputs.md"], [maps.MOST_WAVES]), (["inputs.md"], [maps.HIGHEST]),
    (["method.md"], [run.LONG, run.MAX_PROOF_LEAVES]), (["trust.md"], [limits.MAX_SITES]),
    (["method.md", "frontier.md", "trust.md"], [1 << int(re.search(
        r"MAX_POINTS = 1 << (\d+)", (ROOT / "csrc/loewner/loewner.h").read_text())[1])]),
]


@pytest.mark.parametrize("pages, numbers", NUMBERS, ids=lambda each: str(each)[:40])
def test_a_page_names_these_numbers(pages, numbers):
    assert numbers and [(page, missing(page, *numbers)) for page in pages] == [
        (page, []) for page in pages]


def test_the_tutorial_quotes_the_report():
    """Of the first proof: the theorem, the lines that it shows."""
    report, page = golden("loewner/standard-63-64"), PAGES["first-proof.md"]
    assert "\n".join("    " + line for line in report.split("\n\n")[0].split("\n")) in page
    for line in re.findall(r"`((?:Start|Bound|Search) {2,}[^`]*)`", " ".join(page.split("\n"))):
        assert re.sub(" +", " ", line) in re.sub(" +", " ", report), line


def test_the_ratios_of_the_two_sides():
    """Of the values beside it, rounded to the digits that are given."""
    found = [[re.search(r"[0-9.]*", cell)[0] for cell in (torus, none, ratio)]
             for _, _, torus, _, none, ratio in rows("frontier.md", "map | parameter")[1:]]
    assert len(found) >= 7
    for torus, none, ratio in found:
        assert not ratio or float(ratio) == round(
            float(none) / float(torus), len(ratio.partition(".")[2]))


def test_a_torus_that_is_named_has_a_row():
    """The values of the line and of the standard map at which a torus is proved, in the README's
    table, are those of the proved tori."""
    listed = "\n".join(row[0] for row in rows("tori.md", "map"))
    cells = [row[1] for row in rows("README.md", "")[1:3]]
    values = [value for cell in cells for value in re.findall(r"0\.\d+", cell)]
    assert len(values) >= 7
    assert [value for value in values if value not in listed] == []
    assert missing("frontier.md", *values) == []
