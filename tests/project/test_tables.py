"""Numbers of README.md and docs/ that stand in the golden outputs, in docs/data/ and in constants
of the program are those; a number that stands in several pages is the same there.  Nothing is
proved anew: test_numbers.py does that."""

import re

import pytest
from pages import DOCS, PAGES, ROOT, golden, missing, number
from pages import rows as rows_with_head
from pages import table

from converse.check import limits
from converse.model import map as maps
from converse.prover import run


def rows(page, first):
    return rows_with_head(page, first)[1:]


def test_the_tutorial_quotes_the_report():
    """Of the first proof: the theorem, the lines that it shows, and their numbers."""
    report, page = golden("loewner/standard-63-64"), PAGES["first-proof.md"]
    assert "\n".join("    " + line for line in report.split("\n\n")[0].split("\n")) in page
    for line in re.findall(r"`((?:Start|Bound|Search) {2,}[^`]*)`", " ".join(page.split("\n"))):
        assert re.sub(" +", " ", line) in re.sub(" +", " ", report), line
    assert missing("first-proof.md", *re.search(r"([0-9]+) prisms proved.*?([0-9]+) points",
                                                report).groups()) == []


def test_the_readme_says_what_its_commands_prove():
    assert "every a in [0.984375, 0.985], b = 0" in golden("loewner/standard-63-64")
    assert "every epsilon in [0.0148, 0.028] and every" in golden("loewner/trig148")
    assert missing("README.md", "63", "64", "0.985", "0.0148") == [] and 63 / 64 == 0.984375


def test_the_table_of_1989():
    """Its columns are orbit, cut and prisms, as printed and sound."""
    for theorem, _, printed, sound in rows("1989.md", "theorem"):
        name = re.search(r"`(.*?)\.in`", theorem)[1]
        for cell, kind in ((printed, "as_printed"), (sound, "sound")):
            report = golden("%s/%s" % (kind, name))
            assert cell.split(" / ") == [re.search(pattern, report)[1] for pattern in (
                r"longest successful orbit, (\d+) iter", r"was cut (\d+) times",
                r"Of the (\d+) successful prisms")], (name, kind)
    assert missing("1989.md", *re.findall(
        r"\d+", golden("as_printed/trig274").split("Did ")[1].split("Of the")[0])) == []


def test_one_proof_has_one_number_of_prisms():
    """In all pages that name the proof, the prisms of the table of speed.md."""
    lines = dict(re.findall(r"^\| (0\.01\d+)[^|]* \| [0-9.]+ \| ([0-9,]+) \|", PAGES["speed.md"],
                            re.MULTILINE))
    assert "0.0140" in lines
    for epsilon, leaves, *_ in rows("trust.md", "epsilon"):
        if epsilon.startswith("from"):
            assert missing("speed.md", leaves) == [], epsilon
    linked, = [row[4] for row in rows("inputs.md", "file") if row[0] == "`trig139.in`"]
    found = re.search(r"Search +(\S+) prisms", golden("loewner/trig139"))[1]
    assert linked.startswith(found + ",") and lines["0.0139"] == found
    alone, = [leaves for epsilon, leaves, *_ in rows("trust.md", "epsilon") if epsilon == "0.0139"]
    assert missing("method.md", alone) == []


def test_the_links_of_the_standard_map():
    """Of the range whose prisms test_numbers.py compares with its golden output."""
    counts = re.search(r"Search +([0-9,]+) prisms proved, ([0-9,]+) linked",
                       golden("loewner/standard-9719-up")).groups()
    assert missing("method.md", *counts) == []
    row, = [row[4] for row in rows("inputs.md", "file") if row[0] == "`standard-9719-up.in`"]
    assert row.startswith(counts[0])


def test_leaves_are_what_is_proved_and_what_is_linked():
    """Of the files that converse-verified has read: coq.md counts both, trust.md and method.md what
    is proved."""
    proved = [number(row[1]) for row in rows("trust.md", "epsilon")]
    page = PAGES["coq.md"]
    linked = re.findall(r"^\| epsilon (?:=|>=) 0.*?\| ([0-9,]+) \| ([0-9]+) \|", page, re.MULTILINE)
    assert len(linked) == 3
    for leaves, links in linked:
        assert number(leaves) - int(links) in proved, leaves
    leaves, links = re.search(r"^\| 0\.5, 0\.08 \| ([0-9,]+) \| ([0-9]+) \|", page,
                              re.MULTILINE).groups()
    froeschle, = [row for row in rows("method.md", "map") if row[0] == "Froeschlé, B = 0.5"]
    assert froeschle[5].startswith("0.08;")
    assert number(froeschle[6].split(";")[0]) == number(leaves) - int(links)


def test_tori_of_the_frontier_are_rows_of_the_tori():
    cells = [re.search(r"^\| %s.*?\| (.*?) \|" % name, PAGES["frontier.md"], re.MULTILINE)[1]
             for name in ("standard map", "the thesis's line")]
    proved = [row[0].strip("* ") for row in rows("tori.md", "map")]
    for cell, letter, count in zip(cells, ("k", "epsilon"), (3, 5)):
        end, singles = re.search("every %s from 0 to ([0-9.]+); (.*)" % letter, cell).groups()
        assert "every %s from 0 to %s" % (letter, end) in proved
        values = re.findall(r"0\.\d+", singles)
        assert len(values) == count
        for value in values:
            assert any(re.search(r"\b%s\b" % value, row) for row in proved), value
        assert re.search("every %s from 0 to %s" % (letter, end), PAGES["README.md"])


def test_the_other_maps_of_the_frontier():
    """Each value without tori is among the numbers of the method's page."""
    text = PAGES["frontier.md"][PAGES["frontier.md"].index("## Other maps"):]
    least = re.findall(r"^\| ([a-zFé, K0-9.=B]+) \| (?:K|K1|s) \|.*\| (.*?) \| [0-9.]* ?\|$",
                       text, re.MULTILINE)
    assert len(least) == 6
    for name, value in least:
        assert missing("method.md", *re.findall(r"0\.\d+", value)) == [], name


def test_the_ratios_of_the_two_sides():
    """That of the values beside it, rounded to the digits that are given."""
    found = re.findall(
        r"^\| [^|]+ \| (?:K|K1|s|epsilon) \| ([0-9.]+),[^|]* \|[^|]*\| ([0-9.]+)[^|]* \| (.*?) \|$",
        PAGES["frontier.md"], re.MULTILINE)
    assert len(found) == 6
    for torus, none, ratio in found:
        assert float(ratio) == round(float(none) / float(torus), len(ratio.partition(".")[2]))


def test_the_share_of_vectors_before_their_onset():
    onsets = [(float(row["eps_below"]) + float(row["eps_above"])) / 2
              for row in table("toughest") if row["set"] == "sweep"]
    assert len(onsets) == 1000
    shares = [round(sum(onset > eps for onset in onsets) / 10) for eps in (0.006, 0.008, 0.01)]
    latest = max((row for row in table("toughest") if row["set"] == "search"),
                 key=lambda row: float(row["eps_below"]))
    assert missing("questions-of-1989.md", *shares, *latest["p"].split(), latest["q"]) == []


def test_what_continuation_loses():
    gains = {float(row["eps"]): row for row in table("minimizing")
             if (row["potential"], row["p"], row["q"]) == ("trig", "1432 1897", "2513")}
    head, line = re.search(r"\| eps \| (0\.010 .*?) \|\n.*\n\|[^|]*\| (.*) \|\n",
                           PAGES["questions-of-1989.md"]).groups()
    for eps, gain in zip(head.split(" | "), line.split(" | ")):
        assert "%.1e" % float(gains[float(eps)]["gain"]) == "%.1e" % float(gain), eps
    share = 100 * float(gains[0.04]["gain"]) / -float(gains[0.04]["best"])
    assert missing("questions-of-1989.md", "%.1f" % share) == []


def test_the_successors_that_are_left():
    last, = [row for row in table("successors") if row["parameter"] == "0.01389"]
    assert missing("portrait.md", "%.2f" % (100 * float(last["undecided"]))) == []


def test_the_portrait_shows_the_share_of_its_table():
    """Rounded up to a tenth in the picture, and to a hundredth in the table."""
    shown = re.search(r"undecided: ([0-9.]+)% of", (DOCS / "portrait.svg").read_text("utf-8"))[1]
    share, = [row[3].split()[0] for row in rows("portrait.md", "k") if row[:3] == ["0.9", "strips",
                                                                                  "15"]]
    assert 0 <= round(10 * float(shown)) - 10 * float(share) < 1


@pytest.mark.parametrize("page, value", [
    ("README.md", maps.MOST_WAVES), ("inputs.md", maps.MOST_WAVES), ("inputs.md", maps.HIGHEST),
    ("method.md", str(run.LONG)), ("method.md", run.MAX_PROOF_LEAVES),
    ("trust.md", limits.MAX_SITES)])
def test_limits_of_the_program(page, value):
    assert missing(page, value) == []


def test_the_longest_orbits():
    most = 1 << int(re.search(r"MAX_POINTS = 1 << (\d+)", (
        ROOT / "csrc" / "loewner" / "loewner.h").read_text())[1])
    assert [page for page in ("method.md", "frontier.md", "trust.md") if missing(page, most)] == []
