"""The checker: it confirms what is proved, rejects everything else, and its bounds are bounds."""

import gzip
import hashlib
import itertools
import random
import re
import subprocess
import sys
from fractions import Fraction

import mpmath
import pytest

from converse import check, prove, read_input

INPUTS = ("trig272", "trig274", "trig276", "trig278")
mp = mpmath.mp.clone()
mp.dps = 60


# ---- files to check

@pytest.fixture(scope="module")
def texts(root, tmp_path_factory):
    """The proof files of the four inputs, as text."""
    found = {}
    for name in INPUTS:
        path = tmp_path_factory.mktemp("proofs") / name
        prove(read_input(root / "inputs" / (name + ".in"))).save(path)
        found[name] = path.read_text(encoding="utf-8")
    return found


@pytest.fixture
def run(tmp_path, capsys):
    """Checks a text or bytes: (status, stdout, stderr)."""
    def run(data, *options, name="some.proof"):
        path = tmp_path / name
        path.write_bytes(data if isinstance(data, bytes) else data.encode("utf-8"))
        status = check.main([*options, str(path)])
        out, err = capsys.readouterr()
        return status, out, err.replace(str(path), "FILE")      # its directory names the test
    return run


def sealed(text):
    """The text with the right checksum."""
    body = text[:text.rindex("checksum: ")]
    return body + "checksum: sha256 %s\nend\n" % hashlib.sha256(body.encode()).hexdigest()


def with_field(text, name, value):
    text, n = re.subn("(?m)^%s: .*$" % re.escape(name), "%s: %s" % (name, value), text)
    assert n == 1
    return text


def tree_of(text):
    return text.partition("\ntree:\n")[2].partition("checksum")[0].replace("\n", "")


def with_tree(text, tree, counted=True):
    """The text with another tree, and the counts of that tree."""
    head, middle, rest = text.partition("\ntree:\n")
    text = head + middle + tree + "\n" + rest[rest.rindex("checksum"):]
    if counted:
        for name, kinds in (("cuts", "01"), ("proved", "P"), ("symmetric", "S"), ("undecided", "U")):
            text = with_field(text, name, sum(map(tree.count, kinds)))
        try:
            text = with_field(text, "most_cuts", max(
                [k + l for at, (_, k, _, l) in check.leaves(tree) if tree[at] == "P"] + [0]))
        except check.Rejected:
            pass
    return text


def built(a, half, depth, text):
    """A proof file whose leaves need orbits; the tree is cut until one attempt settles a leaf."""
    for name, factor in (("a", 1), ("b", 1), ("c", 2)):
        text = with_field(text, name, "%s %s" % (check.decimal_text(factor * Fraction(a)),
                                                 check.decimal_text(factor * Fraction(half))))
    text = with_tree(with_field(with_field(text, "depth", 99), "most_cuts", depth), "P", False)
    claim = check.parse(text.split("\ntree:")[0].split("\n")[1:], "P", "")
    criterion, tree, todo = check.Criterion(claim), [], [(0, 0, 0, 0)]
    while todo:
        i, k, j, l = cell = todo.pop()
        failed = None
        if j << k >= i + 1 << l:
            tree.append("S")
        elif k + l == depth or not (failed := criterion.attempt(criterion.piece(cell))):
            tree.append("P")
        elif abs(failed[1][3]) > abs(failed[1][4]):
            tree.append("0")
            todo += (2 * i + 1, k + 1, j, l), (2 * i, k + 1, j, l)
        else:
            tree.append("1")
            todo += (i, k, 2 * j + 1, l + 1), (i, k, 2 * j, l + 1)
    return sealed(with_tree(text, "".join(tree)))


@pytest.fixture(scope="module")
def deep(texts):
    """a = b = c/2 = 0.2: beyond the thesis's method; no leaf is settled at once."""
    return built("0.2", "0.0001", 30, texts["trig274"])


# ---- confirmed

@pytest.mark.parametrize("name", INPUTS)
def test_confirms(texts, run, name):
    status, out, err = run(texts[name])
    assert (status, err) == (0, "")
    assert out.startswith("Verified :")
    assert hashlib.sha256(texts[name].encode()).hexdigest() in out
    assert "%d proved" % tree_of(texts[name]).count("P") in out
    if name == "trig274":
        assert "\n0.30725 <= a <= 0.30975\n" in out and "\n0.6145 <= c <= 0.6195\n" in out
        assert "region" not in out


def test_confirms_what_needs_orbits(deep, run):
    assert tree_of(deep).count("P") > 300
    status, out, _ = run(deep)
    assert status == 0 and "\n0.1999 <= a <= 0.2001\n" in out
    pieces = int(re.search("in ([0-9]+) pieces", out).group(1))
    assert pieces == tree_of(deep).count("P")


def test_halves_leaves_that_are_too_large(deep, texts, run):
    tree = tree_of(deep)
    while "0PP" in tree and tree.count("P") > 200:
        tree = tree.replace("0PP", "P").replace("1PP", "P")
    status, out, _ = run(sealed(with_tree(deep, tree)))
    assert status == 0
    assert int(re.search("in ([0-9]+) pieces", out).group(1)) > tree.count("P")


def test_same_output_for_any_jobs(deep, run):
    one, two, three = (run(deep, "--jobs", str(n)) for n in (1, 2, 3))
    assert one == two == three
    bad = sealed(with_field(deep, "xstar", "-1.5 -1.5"))
    assert run(bad) == run(bad, "--jobs", "2")


def test_gzip(texts, run):
    data = gzip.compress(texts["trig278"].encode())
    status, out, _ = run(data, name="some.proof.gz")
    assert status == 0 and hashlib.sha256(data).hexdigest() in out
    assert run(data, name="named.otherwise")[0] == 0


def test_quiet(texts, run):
    assert run(texts["trig276"], "--quiet") == (0, "", "")
    assert "SPOT CHECK" in run(texts["trig276"], "--quiet", "--sample", "3")[1]


def test_sample_says_so(deep, run):
    first, again = run(deep, "--sample", "20"), run(deep, "--sample", "20", "--jobs", "2")
    assert first == again and first[0] == 0
    assert "SPOT CHECK of 20 of" in first[1] and "NOT a verification" in first[1]
    assert "Verified" not in first[1]
    assert "SPOT CHECK" in run(deep, "--sample", "999999")[1]


def test_part_of_the_torus_is_said_to_be_a_part(texts, run):
    text = texts["trig274"]
    for name in ("v0", "v1"):
        text = with_field(text, name, "1 0.25")
    status, out, _ = run(sealed(text))
    assert status == 0
    assert "only successors in this region were examined" in out
    assert "\n0.75 <= v0 / pi <= 1.25\n" in out


@pytest.mark.parametrize("centre", ["1e30", "-123456789012345678901234567890.5", "0", "3"])
def test_angles_count_modulo_the_circle(texts, run, centre):
    text = texts["trig278"]
    for name in ("v0", "v1"):
        text = with_field(text, name, centre + " 1.5")
    assert run(sealed(text))[0] == 0


# ---- rejected

@pytest.mark.parametrize("kind", "01PS")
@pytest.mark.parametrize("into", "01PSUx")
def test_flipped_nodes(texts, run, kind, into):
    text = texts["trig274"]
    tree = tree_of(text)
    if kind == into:
        return
    places = [n for n, node in enumerate(tree) if node == kind]
    for place in (places[0], places[len(places) // 2], places[-1]):
        other = tree[:place] + into + tree[place + 1:]
        changed = with_tree(text, other, counted=False)
        status, _, err = run(changed)
        assert status == 1 and "wrong checksum" in err
        if {kind, into} != set("01"):
            assert run(sealed(changed))[0] == 1
        status, _, err = run(sealed(with_tree(text, other)))
        if {kind, into} == set("01"):       # another tree, with as many leaves
            assert status == 0 or "mirror" in err or "most_cuts" in err
        elif (kind, into) == ("S", "P"):    # one more leaf proved: a good proof
            assert status == 0
        elif (kind, into) == ("P", "S"):
            assert status == 0 or "mirror image is not proved" in err
        else:
            wrong = {"U": "undecided", "x": "not a node"}.get(into, "tree")
            assert status == 1 and (wrong in err or "tree" in err)


def test_a_leaf_without_a_proved_mirror_image(texts, run):
    text = texts["trig274"]
    tree = tree_of(text)
    refused = 0
    for place in range(0, len(tree), 5):
        if tree[place] == "P":
            swapped = list(tree)
            first = tree.index("S")
            swapped[place], swapped[first] = "S", "P"
            status, _, err = run(sealed(with_tree(text, "".join(swapped))), "--quiet")
            refused += status
            assert status == 0 or "mirror image is not proved" in err
    assert refused > 10


@pytest.mark.parametrize("tree, why", [
    ("S", "mirror image"), ("0PS", "mirror image"), ("0SS", "mirror"), ("", "incomplete"),
    ("0P", "incomplete"), ("PP", "ends before"), ("0PPP", "ends before"), ("U", "undecided"),
    ("0PU", "undecided"), ("2PPP", "not a node"), ("p", "not a node"), ("0 PP", "not a node"),
    ("0" * 1200, "lies below"), ("0" * 40 + "P" * 41, "depth")])
def test_trees(texts, run, tree, why):
    status, _, err = run(sealed(with_tree(texts["trig278"], tree)))
    assert status == 1 and why in err


@pytest.mark.parametrize("name", ["trig272", "deep"])
def test_shortened_and_lengthened(texts, deep, run, name):
    text = texts.get(name, deep)
    tree = tree_of(text)
    for other in (tree[:-1], tree[1:], tree + "P", "0" + tree, tree[:50] + tree[51:]):
        for counted in (True, False):
            status, _, err = run(sealed(with_tree(text, other, counted)))
            assert status == 1 and "tree" in err
    assert "truncated" in run(text[:-1])[2]
    assert run(text + "\n")[0] == 1


@pytest.mark.parametrize("name", ["cuts", "proved", "symmetric", "undecided", "most_cuts"])
def test_counts(texts, run, name):
    text = texts["trig274"]
    old = int(re.search("(?m)^%s: (.*)$" % name, text).group(1))
    for value in (old + 1, 10 * old + 1, "-1", "x", "1.0", ""):
        status, _, err = run(sealed(with_field(text, name, value)))
        assert status == 1 and name in err


@pytest.mark.parametrize("name, value, why", [
    ("a", "0.3085 0.3", "not excluded"), ("b", "0.3086 0.00125", "symmetric"),
    ("c", "0.617 0.617", "not excluded"), ("c", "0 0.0025", "not excluded"),
    ("c", "0.617 -0.0025", "negative"), ("a", "0.3085", "two decimal"), ("a", "nan 0", "two"),
    ("v0", "1 0.5", "symmetric"), ("v1", "0.5 1", "symmetric"), ("v0", "1.1 1", "symmetric"),
    ("xstar", "0.8 0.82773291385109182", "symmetric"), ("xstar", "0 0", "not excluded"),
    ("xstar", "-0.8 -0.8", "not excluded"), ("xstar", "1e300 1e300", "arithmetic"),
    ("c", "1e999 0", "out of range"), ("v0", "1 1e301", "out of range"),
    ("kind", "as printed, not a proof", "not meant as a proof"), ("depth", "11", "depth"),
    ("kind", "Sound", "not meant"), ("a", "0.3085 0.00125 0", "two decimal")])
def test_header(texts, run, name, value, why):
    text = with_field(texts["trig274"], name, value)
    status, out, err = run(text)
    assert (status, out) == (1, "") and "wrong checksum" in err
    status, out, err = run(sealed(text))
    assert (status, out) == (1, "") and why in err and err.count("\n") == 1


def test_widened_and_moved_where_orbits_are_needed(deep, run):
    for name, value in (("a", "0.2 0.12"), ("b", "0.2 0.12")):
        deep = with_field(deep, name, value)
    assert "not excluded" in run(sealed(deep))[2]


def test_header_lines(texts, run):
    text = texts["trig278"]
    for other, why in ((text.replace("depth:", "deepth:"), "unknown meaning"),
                       (text.replace("depth: 30\n", ""), "lacks depth"),
                       (text.replace("depth: 30\n", "depth: 30\ndepth: 30\n"), "twice"),
                       (text.replace("converse proof 1", "converse proof 2"), "version 1"),
                       (text.replace("\ntree:\n", "\ntrees:\n"), "no tree")):
        status, _, err = run(sealed(other))
        assert status == 1 and why in err
    status, _, err = run(re.sub("sha256 .", "sha256 g", text))
    assert status == 1 and "checksum" in err


@pytest.mark.parametrize("data", [b"", b"\x00\xff\xfe junk" * 99, b"\x1f\x8b", b"\x1f\x8b\x08junk",
                                  b"converse proof 1\n\xff", b"tree", bytes(range(256)) * 10])
def test_unreadable(run, data):
    status, out, err = run(data)
    assert (status, out) == (2, "") and err.count("\n") == 1


def test_damaged_gzip(texts, run):
    data = gzip.compress(texts["trig272"].encode())
    for n in (len(data) - 1, len(data) - 9, len(data) // 2, 12, 5):
        assert run(data[:n])[0] == 2
    generator = random.Random(1)
    for _ in range(100):
        n = generator.randrange(10, len(data))
        bad = data[:n] + bytes([data[n] ^ 1 << generator.randrange(8)]) + data[n + 1:]
        assert run(bad)[0] in (1, 2)


def test_no_random_damage_passes(texts, run):
    text, generator = texts["trig276"].encode(), random.Random(2)
    for _ in range(200):
        n = generator.randrange(len(text))
        bad = text[:n] + bytes([text[n] ^ 1 << generator.randrange(8)]) + text[n + 1:]
        status, out, err = run(bad)
        assert status in (1, 2) and out == "" and err.count("\n") == 1


def test_arguments(tmp_path, capsys):
    for arguments in ([], ["a", "b"], ["--jobs", "0", "x"], ["--sample", "x", "x"], ["--what"],
                      [str(tmp_path)], [str(tmp_path / "missing")], ["a\0b"], [""]):
        assert check.main(arguments) == 2
        out, err = capsys.readouterr()
        assert out == "" and err.count("\n") == 1
    assert check.main(["--version"]) == 0


def test_as_a_command(texts, tmp_path, root):
    path = tmp_path / "x"
    path.write_text(texts["trig274"], encoding="utf-8")
    for command in (["-m", "converse.check"], [str(root / "converse" / "check.py")]):
        done = subprocess.run([sys.executable, *command, path, "--jobs", "2"], cwd=tmp_path,
                              capture_output=True)
        assert done.returncode == 0 and done.stdout.startswith(b"Verified") and not done.stderr


# ---- where tori exist there is no theorem

@pytest.mark.parametrize("a", ["0", "0.0011", "0.011", "0.05", "0.11", "0.15"])
@pytest.mark.parametrize("tree", ["P", "01PP1PP"])
def test_forged(texts, run, a, tree):
    text = texts["trig278"]
    for name, factor in (("a", 1), ("b", 1), ("c", 2)):
        text = with_field(text, name, "%s 0" % check.decimal_text(factor * Fraction(a)))
    status, out, err = run(sealed(with_tree(text, tree)))
    assert (status, out) == (1, "") and "leaf 1 of" in err and "not excluded" in err


def test_nearly_everything_is_not_everything(deep, run):
    """Among boxes that are excluded, hide one whose parameters are not."""
    text = with_field(with_field(with_field(deep, "a", "0.13 0.071"), "b", "0.13 0.071"),
                      "c", "0.26 0.142")
    assert run(sealed(text))[0] == 1


# ---- the arithmetic against mpmath

FIXED = {bits: check.Fixed(bits) for bits in (64, 96, 131)}


@pytest.fixture
def generator(request):
    return random.Random(request.node.name)


def near(generator, places=60):
    """A random number in [-1, 1], exact, often special."""
    return Fraction(generator.choice((generator.randint(-2 ** places, 2 ** places),
                                      generator.choice((-1, 0, 1)) << places)), 1 << places)


def real(x):
    return mp.mpf(x.numerator) / x.denominator


@pytest.mark.parametrize("bits", FIXED)
def test_sincos(bits, generator):
    fixed = FIXED[bits]
    unit = mp.mpf(2) ** -bits
    assert abs(fixed.pi - mp.pi / unit) < 2
    worst = 0
    for n in range(5000):
        x = generator.randint(-1 << bits + n % 24, 1 << bits + n % 24)
        if n % 4 == 0:                      # next to the ends of the steps of the table
            x = generator.randint(-600, 600) * (fixed.step >> check.GUARD + 1) + x % 7 - 3
        s, c = fixed.sincos(x)
        worst = max(worst, abs(s - mp.sin(x * unit) / unit), abs(c - mp.cos(x * unit) / unit))
    assert 0.5 < worst < check.SINE_ERROR
    with pytest.raises(OverflowError):
        fixed.sincos(1 << bits + 40)


def test_roots_and_eigenvalues(generator):
    one = 1 << 64
    for _ in range(4000):
        n = generator.randint(0, 1 << generator.randint(1, 200))
        root = check.upper_sqrt(n)
        assert root * root >= n and (root == 0 or (root - 1) ** 2 < n)
        p, q, r = (generator.randint(-1 << 66, 1 << 66) for _ in range(3))
        bound = check.largest(p, q, r, one)
        # bound I - [p q; q r] is positive semidefinite, and a little less is not
        assert bound >= max(p, r) and (bound - p) * (bound - r) >= q * q
        less = bound - 2
        assert less < max(p, r) or (less - p) * (less - r) < q * q


@pytest.mark.parametrize("bits", FIXED)
def test_model(bits, generator):
    unit = mp.mpf(2) ** -bits
    for _ in range(3000):
        size, wide = Fraction(10) ** generator.randint(-9, 3), 2 ** generator.randint(0, bits)
        p, h, rho = (int(abs(near(generator)) * k * 2 ** bits) for k in (size, size / wide,
                                                                         Fraction(2, wide)))
        p *= generator.choice((1, -1))
        angle = near(generator) * 4
        s, c = FIXED[bits].sincos(int(angle * 2 ** bits))
        wave, f, g = generator.choice(((mp.sin, s, c), (mp.cos, c, -s)))
        if generator.random() < 0.5:        # as far from the truth as the contract allows
            f, g = ((k + generator.choice((-12, 12)) for k in (f, g)))
        value, slope, tilt, error = check.model(bits, p, h, f, g, rho)
        e, d = near(generator), near(generator) * rho
        y = real(Fraction(int(angle * 2 ** bits))) * unit + real(d) * unit
        true = (p + real(h * e)) * wave(y)
        linear = value + real(slope * e) + real(tilt * d) * unit
        assert abs(true - linear) <= error
        assert error <= 40 * (abs(p) + h) * unit + 20 + (
            (abs(p) + h) * (rho * unit) ** 2 + h * rho * unit)


def v_prime(abc, y):
    wave = abc[2] * mp.cos(y[0] + y[1])
    return [-abc[0] * mp.cos(y[0]) - wave, -abc[1] * mp.cos(y[1]) - wave]


def random_piece(generator, bits):
    width = Fraction(1, 2 ** generator.randint(3, 30))
    centre = [int(near(generator) * k * 2 ** bits) for k in (1, 1, 1, 4, 4)]
    half = [int(abs(near(generator)) * width * 2 ** bits) for _ in range(5)]
    return centre, half, [int(near(generator) * 4 * 2 ** bits) for _ in range(2)]


def test_orbits(generator):
    """Forwards and backwards, at random points of a piece, with the part that is known exactly."""
    cases = 0
    for _ in range(400):
        bits = generator.choice(list(FIXED))
        fixed, unit = FIXED[bits], mp.mpf(2) ** -bits
        centre, half, xstar = random_piece(generator, bits)
        parameters = list(zip(centre[:3], half[:3]))
        first = check.Point(fixed, parameters, xstar, ([0] * 5 + [1, 0], [0] * 5 + [0, 1]))
        second = check.Point(fixed, parameters, centre[3:], ([0, 0, 0, half[3], 0, 0, 0],
                                                             [0, 0, 0, 0, half[4], 0, 0]))
        eta = [near(generator) for _ in range(7)]
        point = [real(c + h * e) * unit for c, h, e in zip(centre, half, eta)]
        inside = [real(c + e) * unit for c, e in zip(xstar, eta[5:])]
        abc, x1 = point[:3], point[3:]
        for orbit, true in (([first, second], [inside, x1]), ([second, first], [x1, inside])):
            known = 7
            while max(orbit[-1].reach) < fixed.one and len(orbit) < 9:
                orbit.append(check.step(fixed, parameters, orbit[-1], orbit[-2], known))
                known += 3
                force = v_prime(abc, true[-1])
                true.append([2 * x - w - f for x, w, f in zip(true[-1], true[-2], force)])
                for axis in range(2):
                    row, x = orbit[-1].rows[axis], orbit[-1].x[axis]
                    exact = x + sum(real(k * e) for k, e in zip(row, eta))
                    assert abs(true[-1][axis] / unit - exact) <= sum(map(abs, row[7:]))
                    assert sum(map(abs, row)) == orbit[-1].reach[axis]
                    cases += 1
    assert cases > 5000


def test_errors_of_orbits_are_of_second_order():
    fixed = FIXED[96]
    errors = []
    for shrink in (10, 12):
        half = [fixed.one >> shrink] * 5
        parameters = [(fixed.one // 3, half[0])] * 3
        orbit = [check.Point(fixed, parameters, [fixed.one] * 2, ([0] * 7, [0] * 7)),
                 check.Point(fixed, parameters, [fixed.one * 2] * 2,
                             ([0, 0, 0, half[3], 0, 0, 0], [0, 0, 0, 0, half[4], 0, 0]))]
        for n in range(4):
            orbit.append(check.step(fixed, parameters, orbit[-1], orbit[-2], 7 + 3 * n))
        errors.append(sum(map(abs, orbit[-1].rows[0][7:])) / sum(map(abs, orbit[-1].rows[0][:7])))
    assert errors[0] < 0.02 and errors[1] < errors[0] / 3.5


def test_second_variation(generator):
    """At random points of pieces and for random vectors, the true value is below the bound."""
    cases = 0
    for _ in range(300):
        bits = generator.choice(list(FIXED))
        fixed, unit = FIXED[bits], mp.mpf(2) ** -bits
        centre, half, _ = random_piece(generator, bits)
        parameters = list(zip(centre[:3], half[:3]))
        orbit = [check.Point(fixed, parameters, [int(near(generator) * 4 * 2 ** bits) for _ in "01"],
                             [[int(near(generator) * 2 ** (bits - 4)) for _ in range(12)]
                              for _ in "01"]) for _ in range(generator.randint(1, 5))]
        vectors = [[float(near(generator)) for _ in "01"] for _ in orbit]
        l = int(abs(near(generator)) * 2 ** bits)
        bound, columns = check.second_variation(fixed, l, orbit, vectors)
        nu = [[mp.mpf(round(u * 2 ** check.NU_BITS)) for u in n] for n in vectors]
        for _ in range(12):
            eta = [near(generator) for _ in range(12)]
            abc = [real(c + h * e) * unit for c, h, e in zip(centre, half, eta)]
            total = -l * unit * sum(u * u for u in nu[0] + nu[-1])
            total -= 2 * sum(m[0] * n[0] + m[1] * n[1] for m, n in zip(nu, nu[1:]))
            for point, (n0, n1) in zip(orbit, nu):
                y = [real(c + sum(k * e for k, e in zip(row, eta))) * unit
                     for c, row in zip(point.x, point.rows)]
                total += 2 * (n0 * n0 + n1 * n1) - (abc[0] * mp.sin(y[0]) * n0 * n0
                                                    + abc[1] * mp.sin(y[1]) * n1 * n1
                                                    + abc[2] * mp.sin(y[0] + y[1]) * (n0 + n1) ** 2)
            assert total <= bound * unit ** 2
            cases += 1
    assert cases > 3000


def test_pieces_cover_their_cells(texts, generator):
    text = texts["trig274"]
    lines = text.split("\ntree:")[0].split("\n")[1:]
    for _ in range(30):
        c, h = ("%d.%06d" % (generator.randint(-9, 9), generator.randint(0, 999999)) for _ in "01")
        h = h.lstrip("-")
        changed = [re.sub("^(v[01]): .*", r"\1: %s %s" % (c, h), line) for line in lines]
        criterion = check.Criterion(check.parse(changed, "P", ""))
        unit = mp.mpf(2) ** -criterion.fixed.bits
        c, h = Fraction(c), Fraction(h)
        shift = c % 2 - c
        for _ in range(100):
            k = generator.randint(0, 40)
            i = generator.choice((0, (1 << k) - 1, generator.randrange(1 << k)))
            centre, half = criterion.piece((i, k, 0, 0))
            low = real(c + shift - h + 2 * h * i / (1 << k)) * mp.pi / unit
            high = real(c + shift - h + 2 * h * (i + 1) / (1 << k)) * mp.pi / unit
            assert centre[3] - half[3] <= low and high <= centre[3] + half[3]
            assert low - (centre[3] - half[3]) < 200
        for n, (p, width) in enumerate((("0.3085", "0.00125"), ("0.3085", "0.00125"),
                                        ("0.617", "0.0025"))):
            low, high = (Fraction(p) + k * Fraction(width) for k in (-1, 1))
            assert Fraction(centre[n] - half[n]) / criterion.fixed.one <= low
            assert Fraction(centre[n] + half[n]) / criterion.fixed.one >= high


def definite(abc, x0, x1, steps):
    """Is the second variation along the true orbit, steps to either side, positive definite?"""
    back, ahead = [x1, x0], [x0, x1]
    for _ in range(steps):
        for orbit in (back, ahead):
            force = v_prime(abc, orbit[-1])
            orbit.append([2 * x - w - f for x, w, f in zip(orbit[-1], orbit[-2], force)])
    d = None
    for y in back[:0:-1] + ahead[1:]:
        m0, m1, m2 = (p * mp.sin(t) for p, t in zip(abc, (y[0], y[1], y[0] + y[1])))
        p, q, r = 2 - m0 - m2, -m2, 2 - m1 - m2
        if d:
            det = d[0] * d[2] - d[1] ** 2
            p, q, r = p - d[2] / det, q + d[1] / det, r - d[0] / det
        if p <= 0 or p * r <= q * q:
            return False
        d = p, q, r
    return True


def test_no_orbit_of_a_proved_leaf_minimizes(deep, generator):
    """The checker's word against exact orbits; and there are orbits on which it says nothing."""
    lines = deep.split("\ntree:")[0].split("\n")[1:]
    criterion = check.Criterion(check.parse(lines, tree_of(deep), ""))
    unit = mp.mpf(2) ** -criterion.fixed.bits
    x0 = [mp.mpf("0.82773291385109182")] * 2
    cells = [cell for at, cell in check.leaves(tree_of(deep)) if tree_of(deep)[at] == "P"]
    for _ in range(300):
        centre, half = criterion.piece(generator.choice(cells))
        point = [real(c + h * near(generator)) * unit for c, h in zip(centre, half)]
        assert not definite(point[:3], x0, point[3:], 20)
    weak = [mp.mpf("0.01"), mp.mpf("0.01"), mp.mpf("0.02")]
    assert definite(weak, x0, [x + mp.mpf("3.9") for x in x0], 20)


# ---- the bound B

def eigenvalue(abc, y):
    m0, m1, m2 = (-p * mpmath.fp.sin(t) for p, t in zip(abc, (y[0], y[1], y[0] + y[1])))
    return 2 + m2 + (m0 + m1) / 2 + ((m0 - m1) ** 2 / 4 + m2 * m2) ** 0.5


def test_bound_over_a_cell(generator):
    fixed, one = FIXED[96], FIXED[96].one
    for n in range(2000):
        abc = [int(near(generator) * 2 ** generator.randint(-6, 3) * one) for _ in range(3)]
        y = [int(near(generator) * 4 * one) for _ in range(2)]
        w = one * 3 >> n % 24
        bound, value = (x / one for x in check.cell_bound(fixed, abc, y, w))
        scale = 1 + max(map(abs, abc)) / one
        for _ in range(4):
            at = [(c + near(generator) * w) / one for c in y]
            true = eigenvalue([p / one for p in abc], [float(t) for t in at])
            assert true <= bound + 1e-14 * scale
        assert abs(eigenvalue([p / one for p in abc], [t / one for t in y]) - value) < 1e-14 * scale


def test_bound_over_the_torus(generator):
    fixed, one = FIXED[96], FIXED[96].one
    step = 2 * mpmath.fp.pi / 48
    for n in range(30):
        low = [int(near(generator) * one) for _ in range(3)]
        high = [p + int(abs(near(generator)) * one / 8) * (n % 3) for p in low]
        bound = check.torus_bound(fixed, low, high) / one
        best = 2
        for abc in itertools.product(*zip((p / one for p in low), (p / one for p in high))):
            y = max(((i * step, j * step) for i in range(48) for j in range(48)),
                    key=lambda y: eigenvalue(abc, y))
            best, reach = max(best, eigenvalue(abc, y)), step
            for _ in range(12):             # on to the maximum, where there is no looseness
                y = max(((y[0] + p * reach / 2, y[1] + q * reach / 2) for p in range(-2, 3)
                         for q in range(-2, 3)), key=lambda y: eigenvalue(abc, y))
                reach /= 2
            best = max(best, eigenvalue(abc, y))
        assert -1e-13 <= bound - best < 1e-5


# ---- the tree

def random_tree(generator, depth):
    if depth == 0 or generator.random() < 0.25:
        return generator.choice("PPPS")
    return generator.choice("01") + "".join(random_tree(generator, depth - 1) for _ in "01")


def test_mirror_images_against_rectangles(texts, generator):
    lines = texts["trig274"].split("\ntree:")[0].split("\n")[1:]
    seen = set()
    for _ in range(600):
        tree = random_tree(generator, generator.randint(1, 7))
        mirror = check.Mirror(check.parse(lines, tree, ""))
        boxes = [(tree[at], Fraction(i, 2 ** k), Fraction(i + 1, 2 ** k), Fraction(j, 2 ** l),
                  Fraction(j + 1, 2 ** l), (i, k, j, l))
                 for at, (i, k, j, l) in check.leaves(tree)]
        assert sum((b - a) * (d - c) for _, a, b, c, d, _ in boxes) == 1
        for node, a, b, c, d, cell in boxes:
            if node == "S":
                clear = all(kind == "P" for kind, e, f, g, h, _ in boxes
                            if e < d and c < f and g < b and a < h)
                assert (mirror.refusal(cell) is None) == clear
                seen.add(clear)
    assert seen == {True, False}
