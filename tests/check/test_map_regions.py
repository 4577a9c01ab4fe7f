"""Maps of version 2: each proof names the region that it searched, and the checker finds out
whether that holds enough of the torus.  What is too small by a bit, of another frame or of another
version is refused, in a line."""

import hashlib
import json
from fractions import Fraction

import mpmath
import pytest

from converse.model.map import THESIS, SymplecticMap
from converse.model.problem import Problem
from converse.model.region import DIAGONALS, reduced
from converse.parameters import region

from checker import check

BIT = Fraction(1, 10 ** 60)
SHEARED, ALONG, IDENTITY = (1, 0, -1, 1), (1, -1, 1, 1), (1, 0, 0, 1)
# A region, the number of a face, a tree of its cells with one that is proved, the cell's ends, x*.
CELLS = {
    "a=b": ("a=b", 1, "0O01PO1OO", ((1, 0), (Fraction(3, 2), Fraction(1, 2))), ("0.7854",) * 2),
    "b=0": ("b=0", 0, "0O01O1POO", ((1, Fraction(1, 2)), (Fraction(3, 2), Fraction(3, 4))),
            ("1.3", "0.4")),
    "c=0": ("c=0", 0, "0O01O1POO", ((1, Fraction(1, 2)), (Fraction(3, 2), Fraction(3, 4))),
            ("1.570796",) * 2)}


def sealed(content):
    content = {key: value for key, value in content.items() if key != "sha256"}
    text = json.dumps(content, sort_keys=True, separators=(",", ":"))
    return json.dumps({**content, "sha256": hashlib.sha256(text.encode()).hexdigest()})


def problem_of(name, frame=None):
    """What is searched for the proved cell, and x*."""
    plane, face, _, ends, xstar = CELLS[name]
    cell = region.Cell(face, *[tuple(map(Fraction, end)) for end in ends])
    middle, parts = region.patch(region.REGIONS[plane][face], cell)
    return reduced(Problem(SymplecticMap(THESIS, middle, parts)), xstar, frame), xstar


def content_of(name, axes=None, version=2, **changes):
    """A map with one proved cell, or what changes make of its proof; v0 and v1 are (low, high)."""
    problem, xstar = problem_of(name, axes)
    plane, at, tree, _, _ = CELLS[name]
    proof = {"xstar": list(xstar), "frame": list(problem.frame), "tree": "P", "v0": problem.v0,
             "v1": problem.v1, "alone": "no" if problem.factor is None else str(problem.factor),
             **changes}
    for key in ("v0", "v1"):
        if isinstance(proof[key], tuple):
            low, high = proof[key]
            proof[key] = list(map(check.decimal_text, ((low + high) / 2, (high - low) / 2)))
    proof = {key: value for key, value in proof.items() if value is not None}
    faces = [{"directions": [list(map(str, d)) for d in directions], "radius": "2", "tree": "O",
              "proofs": []} for directions in check.REGIONS[plane]]
    faces[at].update(tree=tree, proofs=[proof])
    return {"format": "converse map %s" % version, "program": "by hand", "region": plane,
            "down to": "1.05", "faces": faces}


@pytest.fixture
def refused(tmp_path, capsys):
    """The line that says why a map is refused."""
    def refused(content, status=1):
        path = tmp_path / "map.json"
        path.write_text(sealed(content))
        assert check.main([str(path)]) == status
        out, err = capsys.readouterr()
        assert out == "" and err.count("\n") == 1
        return err
    return refused


def centres(name, frame):
    """c0 at the corners of the patch, with sixty digits and more."""
    problem, xstar = problem_of(name, frame)
    f00, f01, f10, f11 = problem.frame
    det = f00 * f11 - f01 * f10
    with mpmath.workdps(90):
        star = [mpmath.mpf(x) for x in xstar]

        def shift(amplitudes):
            """What these amplitudes add to pi c0."""
            return sum(mpmath.mpf(p.numerator) / p.denominator * (f11 * k0 - f01 * k1)
                       * mpmath.cos(k0 * star[0] + k1 * star[1])
                       for j, ((k0, k1, _), p) in enumerate(zip(problem.waves, amplitudes))
                       if j in problem.searched) / (2 * det)

        middle = (f11 * star[0] - f01 * star[1]) / det + shift(problem.amplitude)
        moved = sum(abs(shift(part)) for part in problem.parts)
        return [Fraction(int(mpmath.floor((middle + x) / mpmath.pi * 10 ** 80)), 10 ** 80)
                for x in (-moved, moved)]


@pytest.mark.parametrize("name, frame, period, symmetries", [
    ("a=b", DIAGONALS, 1, ["reversal of time", "exchange of the angles"]),
    ("a=b", ALONG, 1, ["reversal of time"]), ("b=0", SHEARED, 2, ["reversal of time"]),
    ("b=0", IDENTITY, 2, ["reversal of time"]), ("b=0", ALONG, 1, ["reversal of time"]),
    ("c=0", None, 2, ["reversal of time"])])
def test_the_regions_that_are_enough(refused, tmp_path, capsys, name, frame, period, symmetries):
    """What the prover finds, and what just reaches c0 and c0 + P0/2 at sixty digits, is verified;
    what is too small by a bit at either end of either angle is refused."""
    path = tmp_path / "map.json"
    path.write_text(sealed(content_of(name, frame)))
    assert check.main([str(path)]) == 0
    assert "in the 1 proved cells" in capsys.readouterr().out
    claim, = check.read_map(bytearray(path.read_bytes())).claims
    assert check.symmetries_used(claim) == symmetries
    least, most = centres(name, frame)
    most += Fraction(period, 2)
    good = content_of(name, frame, v0=(least - BIT, most + BIT))
    assert len(check.read_map(bytearray(sealed(good).encode())).claims) == 1
    v1 = problem_of(name, frame)[0].v1
    for changes in ({"v0": (least + BIT, most + BIT)}, {"v0": (least - BIT, most - BIT)},
                    {"v1": (v1[0] + BIT, v1[1])}, {"v1": (v1[0], v1[1] - BIT)}):
        why = refused(content_of(name, frame, **changes))
        assert "face %d: cell" % (1 + CELLS[name][1]) in why and "enough of the torus" in why


@pytest.mark.parametrize("changes, why", [
    ({"frame": list(ALONG)}, "enough of the torus"),            # half of v1, and no exchange
    ({"frame": [1, -1, 1, 1], "v1": (Fraction(-1), Fraction(1))}, None),
    ({"frame": [1, 1, 2, 2]}, "determinant 0"), ({"frame": [101, 0, 0, 1]}, "beyond 100"),
    ({"xstar": ["0.7854", "0.7855"]}, "enough of the torus"),   # no exchange
    ({"xstar": ["2.7854", "2.7854"]}, "enough of the torus"),   # another c0
    ({"alone": "0"}, "both"), ({"v0": ["0.5", "-0.5"]}, "half-width is negative"),
    ({"v0": ["0.5"]}, "a list of 2"), ({"v0": [0.5, 0.5]}, "a list of 2"),
    ({"v0": ["0.5", "x"]}, "not a decimal"), ({"v0": None}, "no other"),
    ({"v2": ["1", "1"]}, "no other"), ({"tree": "PP"}, "ends before its text"),
    ({"tree": "0SP"}, "not symmetric"), ({"tree": "0aP"}, "node")])
def test_wrong_proofs(refused, changes, why):
    content = content_of("a=b", DIAGONALS, **changes)
    if why is None:
        assert len(check.read_map(bytearray(sealed(content).encode())).claims) == 1
    else:
        assert why in refused(content)


def test_another_version_is_refused(refused):
    for version in (0, 1, 3, "2 ", "", None):
        assert "knows, converse map 2\n" in refused(content_of("a=b", DIAGONALS, version), 2)
