"""Numbers of README.md and docs/ that stand in the golden outputs, in docs/data/ and in constants
of the program are those; a number that stands in several pages is the same there.  Nothing is
proved anew: test_numbers.py does that."""

import csv
import re
from pathlib import Path

import pytest

from converse.check import limits
from converse.model import map as maps
from converse.prover import run

ROOT = Path(__file__).resolve().parent.parent.parent
DOCS = ROOT / "docs"
PAGES = {page.name: page.read_text("utf-8")
         for page in (ROOT / "README.md", *DOCS.rglob("*.md"))}


def golden(name):
    return (ROOT / "golden_outputs" / (name + ".out")).read_text("utf-8")


def table(name):
    with open(DOCS / "data" / (name + ".csv"), encoding="ascii", newline="") as file:
        return list(csv.DictReader(file))


def words(page):
    """The text of a page as one line."""
    return " ".join(PAGES[page].split())


def rows(page, first):
    """The cells of the table whose head begins with this cell, without the head."""
    lines = re.search(r"^\| *%s *\|.*?(?=\n\n)" % re.escape(first), PAGES[page],
                      re.MULTILINE | re.DOTALL)[0].split("\n")[2:]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]


def test_the_tutorial_quotes_the_report():
    """Of the first proof: the theorem, and the numbers of its lines."""
    report, page = golden("loewner/standard-63-64"), PAGES["first-proof.md"]
    theorem = report.split("\n\n")[0]
    assert "\n".join("    " + line for line in theorem.split("\n")) in page
    quoted = re.findall(r"`((?:Start|Bound|Search) {2,}[^`]*)`", " ".join(
        line.strip() for line in page.split("\n")))
    assert len(quoted) == 3
    for line in quoted:
        assert re.sub(" +", " ", line) in re.sub(" +", " ", report), line
    prisms, points = re.search(r"([0-9]+) prisms proved.*?([0-9]+) points", report).groups()
    assert re.findall("(?:all|into) ([0-9]+) (?:prisms|boxes)", page) == [prisms, prisms]
    assert "up to %s points" % points in words("first-proof.md")


def test_the_readme_says_what_its_commands_prove():
    assert "every a in [0.984375, 0.985], b = 0" in golden("loewner/standard-63-64")
    assert "for any k from 63/64 to 0.985" in PAGES["README.md"] and 63 / 64 == 0.984375
    assert "every epsilon in [0.0148, 0.028] and every" in golden("loewner/trig148")
    assert "no torus for any epsilon >= 0.0148" in PAGES["README.md"]


def test_the_table_of_1989():
    """Its columns are orbit, cut and prisms, as printed and sound."""
    found = rows("1989.md", "theorem")
    assert len(found) == 4
    for theorem, _, printed, sound in found:
        name = re.search(r"`(.*?)\.in`", theorem)[1]
        for cell, kind in ((printed, "as_printed"), (sound, "sound")):
            report = golden("%s/%s" % (kind, name))
            assert cell.split(" / ") == [re.search(pattern, report)[1] for pattern in (
                r"longest successful orbit, (\d+) iter", r"was cut (\d+) times",
                r"Of the (\d+) successful prisms")], (name, kind)
    numbers = re.findall(r"\d+", golden("as_printed/trig274").split("Did ")[1].split("Of the")[0])
    assert "`--as-printed` counts %s." % ", ".join(numbers) in words("1989.md")


def test_one_proof_has_one_number_of_prisms():
    """In all pages that name the proof, the prisms of the table of speed.md."""
    lines = dict(re.findall(r"^\| (0\.01\d+)[^|]* \| [0-9.]+ \| ([0-9,]+) \|", PAGES["speed.md"],
                            re.MULTILINE))
    verified = {**lines, "0.0140": re.search("the proof for 0.0140 took ([0-9,]+) prisms",
                                             words("speed.md"))[1],
                **dict(zip(("0.01391", "0.0139", "0.01389"), re.search(
                    "In release 2.0.0 the proofs took ([0-9,]+), ([0-9,]+) and ([0-9,]+) prisms",
                    words("speed.md")).groups()))}
    assert verified.keys() == lines.keys() and "0.0140" in lines
    for epsilon, leaves, *_ in rows("trust.md", "epsilon"):
        if epsilon.startswith("from"):
            assert verified[epsilon.split()[1]] == leaves, epsilon
    linked, = [row[4] for row in rows("inputs.md", "file") if row[0] == "`trig139.in`"]
    found = re.search(r"Search +(\S+) prisms", golden("loewner/trig139"))[1]
    assert linked.startswith(found + ",") and lines["0.0139"] == found
    alone, = [leaves for epsilon, leaves, *_ in rows("trust.md", "epsilon") if epsilon == "0.0139"]
    assert "with release 4.0.0 it took %s." % alone in words("method.md")


def test_the_links_of_the_standard_map():
    """Of the range whose prisms test_numbers.py compares with its golden output."""
    proved, linked = re.search(r"Search +([0-9,]+) prisms proved, ([0-9,]+) linked",
                               golden("loewner/standard-9719-up")).groups()
    assert re.search("It proves %s prisms in [0-9]+ CPU seconds, and links %s more" % (
        proved, linked), words("method.md"))
    row, = [row[4] for row in rows("inputs.md", "file") if row[0] == "`standard-9719-up.in`"]
    assert row.startswith(proved)


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


def number(text):
    return int(text.replace(",", ""))


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
    """Each value without tori is in the table of the method, or in the text below it."""
    text = PAGES["frontier.md"][PAGES["frontier.md"].index("## Other maps"):]
    least = re.findall(r"^\| ([a-zFé, K0-9.=B]+) \| (?:K|K1|s) \|.*\| (.*?) \| [0-9.]* ?\|$",
                       text, re.MULTILINE)
    points = {row[0].partition(":")[0]: row for row in rows("method.md", "map")}
    assert len(least) == 6
    assert "also proves k = %s," % dict(least).pop("standard map") in words("method.md")
    for name, value in least:
        if name == "standard map":
            continue
        known = " ".join(points[name][3:6]) + re.search(
            r"B = 0.5, K = ([0-9., and]+) need no links", words("method.md"))[1]
        for at in re.findall(r"0\.\d+", value):
            assert at in known, (name, at)


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
    text = words("questions-of-1989.md")
    assert len(onsets) == 1000 and "a thousand rotation vectors were followed" in text
    said = re.search(r"their onset is (\d+) % at eps (0\.006), (\d+) % at (0\.008), (\d+) % at "
                     r"(0\.010), and (0) at (0\.0125)", text).groups()
    for share, eps in zip(said[::2], said[1::2]):
        assert round(sum(onset > float(eps) for onset in onsets) / 10) == int(share), eps
    latest = max((row for row in table("toughest") if row["set"] == "search"),
                 key=lambda row: float(row["eps_below"]))
    assert "(%s)/%s, at 0.0126" % (latest["p"].replace(" ", ", "), latest["q"]) in text
    assert 0.01255 < float(latest["eps_below"]) < 0.01265


def test_what_continuation_loses():
    gains = {float(row["eps"]): row for row in table("minimizing")
             if (row["potential"], row["p"], row["q"]) == ("trig", "1432 1897", "2513")}
    head, line = re.search(r"\| eps \| (0\.010 .*?) \|\n.*\n\| less by \| (.*) \|\n",
                           PAGES["questions-of-1989.md"]).groups()
    assert len(head.split(" | ")) == len(line.split(" | ")) == 5
    for eps, gain in zip(head.split(" | "), line.split(" | ")):
        assert "%.1e" % float(gains[float(eps)]["gain"]) == "%.1e" % float(gain), eps
    last = gains[0.04]
    share = 100 * float(last["gain"]) / -float(last["best"])
    assert "At 0.04 this is %.1f %%" % share in words("questions-of-1989.md")


def test_the_successors_that_are_left():
    last, = [row for row in table("successors") if row["parameter"] == "0.01389"]
    assert "leaves %.2f %% of the successors" % (100 * float(last["undecided"])) \
        in words("portrait.md")


def test_the_portrait_shows_the_share_of_its_table():
    """Rounded up to a tenth in the picture, and to a hundredth in the table."""
    shown = re.search(r"undecided: ([0-9.]+)% of", (DOCS / "portrait.svg").read_text("utf-8"))[1]
    share, = [row[3].split()[0] for row in rows("portrait.md", "k") if row[:3] == ["0.9", "strips",
                                                                                  "15"]]
    assert 0 <= round(10 * float(shown)) - 10 * float(share) < 1


@pytest.mark.parametrize("page, text", [
    ("README.md", "at most %d Fourier terms and three parameters" % maps.MOST_WAVES),
    ("inputs.md", "| `harmonics` | 1 to %d of them |" % maps.MOST_WAVES),
    ("inputs.md", "two integers up to %d" % maps.HIGHEST),
    ("method.md", "needs orbits of %d points" % run.LONG),
    ("method.md", "the search has proved {:,} prisms".format(run.MAX_PROOF_LEAVES)),
    ("trust.md", "| {:,} points each way |".format(limits.MAX_SITES)),
])
def test_limits_of_the_program(page, text):
    assert text in words(page) and maps.MOST_PARAMETERS == 3


def test_the_longest_orbits():
    most = 1 << int(re.search(r"MAX_POINTS = 1 << (\d+)", (
        ROOT / "csrc" / "loewner" / "loewner.h").read_text())[1])
    for page in "method.md", "frontier.md", "trust.md":
        assert "{:,} points".format(most) in words(page), page
