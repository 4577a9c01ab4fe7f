"""The figure: rendered by Ghostscript, it shows the tree's areas where they belong."""

import random
import re
import shutil
import subprocess

import pytest

from converse import prove, read_input
from converse.figure import ABOVE, HEIGHT, LEFT, SIDE, WIDTH, postscript
from converse.tree import leaves

RESOLUTION = 288                        # four pixels a point
needs_gs = pytest.mark.skipif(not shutil.which("gs"), reason="ghostscript is not installed")


def render(proof, directory):
    """The pixels of the prisms' square as rows of (red, green, blue), the top one first."""
    path = directory / "figure.ps"
    proof.figure(path)
    data = subprocess.run(
        ["gs", "-q", "-dSAFER", "-dBATCH", "-dNOPAUSE", "-dEPSCrop", "-r%d" % RESOLUTION,
         "-sDEVICE=ppmraw", "-sOutputFile=-", str(path)],
        check=True, stdout=subprocess.PIPE).stdout
    header = re.match(rb"P6\n(?:#.*\n)?(\d+) (\d+)\n255\n", data)
    width, height = map(int, header.groups())
    scale = RESOLUTION // 72
    assert (width, height) == (WIDTH * scale, HEIGHT * scale)
    data = data[header.end():]
    rows = []
    for y in range(ABOVE * scale, (ABOVE + SIDE) * scale):
        row = data[3 * (y * width + LEFT * scale):3 * (y * width + (LEFT + SIDE) * scale)]
        rows.append([row[x:x + 3] for x in range(0, len(row), 3)])
    return rows


def share(rows, test):
    return sum(test(pixel) for row in rows for pixel in row) / (len(rows) * len(rows[0]))


def is_dark(pixel):
    return max(pixel) < 100


def is_red(pixel):
    return pixel[0] > 200 and pixel[1] < 50


def area(proof, kind):
    """The share of the region that leaves of this kind cover."""
    whole = 4 * proof.problem.half[3] * proof.problem.half[4]
    return float(sum(4 * leaf.half[0] * leaf.half[1]
                     for leaf in leaves(proof.problem, proof.tree, kind)) / whole)


def random_tree(rng, depth):
    if depth == 0 or rng.random() < 0.1:
        return rng.choice("PPSS")
    return rng.choice("01") + random_tree(rng, depth - 1) + random_tree(rng, depth - 1)


@needs_gs
def test_a_real_proof(root, tmp_path):
    proof = prove(read_input(root / "inputs" / "trig274.in"))
    rows = render(proof, tmp_path)
    assert share(rows, is_dark) == pytest.approx(area(proof, "P"), abs=0.01)
    assert share(rows, is_red) == 0


@needs_gs
@pytest.mark.parametrize("seed", [1, 2])
def test_areas_of_random_trees(made_up, tmp_path, seed):
    proof = made_up(random_tree(random.Random(seed), 7))
    assert share(render(proof, tmp_path), is_dark) == pytest.approx(area(proof, "P"), abs=0.01)


@needs_gs
def test_each_kind_in_its_place(made_up, tmp_path):
    # the lower left quarter proved, the upper left skipped, the lower right undecided,
    # the upper right untried
    rows = render(made_up("01PS1U", v=("0.5", "0.5", "0.25", "0.25"), xstar=("9", "9")), tmp_path)
    half = len(rows) // 2
    quarters = {(x, y): [row[x * half + 9:x * half + half - 9]
                         for row in rows[y * half + 9:y * half + half - 9]]
                for x in (0, 1) for y in (0, 1)}

    def only(place, value):
        return all(pixel == bytes([value] * 3) for row in quarters[place] for pixel in row)

    assert only((0, 1), round(0.35 * 255)) and only((0, 0), round(0.85 * 255))
    assert only((1, 0), 255)
    assert 0 < share(quarters[1, 1], is_red) < 0.1
    assert share(rows, is_dark) == pytest.approx(0.25, abs=0.01)


@needs_gs
def test_tiny_undecided_prisms_are_seen(made_up, tmp_path):
    rows = render(made_up("0P" * 25 + "U"), tmp_path)
    assert share(rows, is_red) > 1e-5


@needs_gs
def test_starting_point(made_up, tmp_path):
    scale = RESOLUTION // 72
    rows = render(made_up("S", xstar=("1.5707963", "1.5707963")), tmp_path)
    at = SIDE * scale // 4
    assert is_dark(rows[-at][at])
    assert share(rows, is_dark) < 0.01
    part = ("1.5", "1.5", "0.1", "0.1")
    assert render(made_up("S", xstar=("1.5707963", "1.5707963"), v=part), tmp_path) \
        == render(made_up("S", xstar=("3", "3"), v=part), tmp_path)     # both lie elsewhere


@needs_gs
@pytest.mark.parametrize("tree", ["P", "", "01PSU", "0" * 200])
def test_bounding_box(made_up, tmp_path, tree):
    """Nothing lies outside the bounding box, and hardly any room is lost."""
    path = tmp_path / "figure.ps"
    made_up(tree, as_printed=True).figure(path)
    found = subprocess.run(["gs", "-q", "-dBATCH", "-dNOPAUSE", "-sDEVICE=bbox", str(path)],
                           check=True, stderr=subprocess.PIPE).stderr.decode()
    ink = list(map(int, re.search("BoundingBox: (.*)", found).group(1).split()))
    assert min(ink) >= 0 and ink[2] <= WIDTH and ink[3] <= HEIGHT
    assert max(ink[0], ink[1], WIDTH - ink[2], HEIGHT - ink[3]) <= 6


def test_conventions(made_up):
    text = postscript(made_up("01PSU", comments=("a) b\\",)))
    lines = text.split("\n")
    assert lines[0] == "%!PS-Adobe-3.0 EPSF-3.0"
    assert "%%%%BoundingBox: 0 0 %d %d" % (WIDTH, HEIGHT) in lines
    assert lines[-2:] == ["%%EOF", ""] and lines[-4] == "showpage"
    assert max(map(len, lines)) < 200
    assert lines.index("%%EndComments") < lines.index("%%EndProlog") < lines.index("%%Page: 1 1")


def test_labels(made_up):
    text = postscript(made_up("P"))
    assert "() (0) 0 -16" in text and "(p) () %d -16" % (SIDE // 2) in text
    assert "(p) (2) %d -16" % SIDE in text
    assert "0.30725 < a < 0.30975" in text
    assert "not a proof" in postscript(made_up("P", as_printed=True)) and "not a proof" not in text
    assert "(p) (0.25)" in postscript(made_up("P", v=("0.5", "1", "0.25", "1")))


def test_size(made_up):
    n = 2 ** 17
    text = postscript(made_up("0" * 17 + "".join(      # a complete binary tree of depth 17
        "P" + "0" * ((i & -i).bit_length() - 1) for i in range(1, n)) + "P"))
    assert len(text) < 25 * n


@pytest.mark.parametrize("ending", [".svg", ".png", ".pdf"])
def test_other_formats(made_up, tmp_path, ending):
    """The name decides; the same proof gives the same file."""
    pytest.importorskip("matplotlib")
    paths = [tmp_path / (name + ending) for name in "ab"]
    for path in paths:
        made_up("0P1US").figure(str(path))
    first, second = (path.read_bytes() for path in paths)
    assert first == second
    start = {".svg": b"<?xml", ".png": b"\x89PNG", ".pdf": b"%PDF"}[ending]
    assert first.startswith(start)
