"""Draws pictures of docs/ anew:  python docs/figures.py [--draw] [NAME ...]

docs/figures.csv has a row for each picture: the release that drew it, the table in docs/data/ that
it shows, if there is one, and the command, which writes NAME.svg and that table into build/.  A
proof is drawn from its file, without a caption.  A picture without a command was made by hand, or
by a script that only earlier releases have.  Each picture carries the SHA-256 of its table, so that
a test sees whether it was drawn from that table.  With --draw nothing is measured: the table in
docs/data/ is drawn.  Without a NAME all pictures with a command are drawn, which takes about an
hour; charts of times want a quiet machine.
"""

import csv
import hashlib
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

from converse import Proof
from converse.draw import plot
from converse.version import __version__

DOCS = Path(__file__).resolve().parent
BUILD = DOCS.parent / "build"
TABLE = DOCS / "figures.csv"


def rows():
    with open(TABLE, encoding="ascii", newline="") as file:
        return list(csv.DictReader(file))


def seal(data):
    """The line by which a picture says from what table it was drawn."""
    return "<!-- drawn from docs/data/%s.csv, SHA-256 %s -->\n" % (
        data, hashlib.sha256((DOCS / "data" / (data + ".csv")).read_bytes()).hexdigest())


def run(command):
    """Runs a command of the table in the clone, with this environment's programs."""
    words = [word if k else {"python": sys.executable}.get(
        word, str(Path(sys.executable).with_name(word))) for k, word in enumerate(command)]
    subprocess.run(words, cwd=DOCS.parent, check=True)


def draw(row, measure):
    name, data = row["picture"], row["data"]
    proof, picture = BUILD / (name + ".proof"), BUILD / (name + ".svg")
    proof.unlink(missing_ok=True)               # a backup is a new file
    commands = [shlex.split(command) for command in row["command"].split(" && ")]
    if not measure:
        shutil.copy(DOCS / "data" / (data + ".csv"), BUILD)
        commands = [commands[-1] + ["--draw"]]
    for command in commands:
        run(command)
    if proof.exists():
        plot.write(Proof.load(proof), picture, caption=False)
    text = picture.read_text("utf-8")
    if data:
        shutil.copy(BUILD / (data + ".csv"), DOCS / "data")
        text += seal(data)
    (DOCS / (name + ".svg")).write_text(text, "utf-8")


def main(arguments):
    measure = "--draw" not in arguments
    names = [name for name in arguments if name != "--draw"]
    table = rows()
    unknown = set(names) - {row["picture"] for row in table}
    if unknown:
        sys.exit("figures.py: %s has no row for %s" % (TABLE, ", ".join(sorted(unknown))))
    by_hand = [row["picture"] for row in table if row["picture"] in names and not row["command"]]
    if by_hand:
        sys.exit("figures.py: %s has no command that draws %s" % (TABLE, ", ".join(by_hand)))
    BUILD.mkdir(exist_ok=True)
    for row in table:
        if row["picture"] in names or not names and row["command"] and (measure or row["data"]):
            draw(row, measure)
            row["release"] = __version__
    with open(TABLE, "w", encoding="ascii", newline="") as file:
        out = csv.DictWriter(file, table[0], lineterminator="\n")
        out.writeheader()
        out.writerows(table)


if __name__ == "__main__":
    main(sys.argv[1:])
