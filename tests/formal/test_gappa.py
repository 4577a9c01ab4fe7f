"""What sine.h promises is proved from its text, and of no other text."""

import importlib
import math
import re
import shutil
import struct
import sys
from fractions import Fraction

import mpmath
import pytest

import kernels
from truth import TORTURE, rng_for

needs_gappa = pytest.mark.skipif(not shutil.which("gappa"),
                                 reason="needs Gappa (Debian's package gappa)")


@pytest.fixture(scope="module")
def tools(root):
    """formal/gappa.py and formal/ctext.py."""
    sys.path.insert(0, str(root / "formal"))
    try:
        yield importlib.import_module("gappa"), importlib.import_module("ctext")
    finally:
        sys.path.pop(0)


@pytest.fixture(scope="module")
def header(root):
    return (root / "csrc" / "arith" / "sine.h").read_text("utf-8")


@needs_gappa
def test_the_promise_is_proved(tools, header, root, tmp_path):
    proof = tools[0].prove(header, tmp_path)
    rows = re.findall(r"^\| `?sine`? \|.*\| ([0-9.]+) \|",
                      (root / "docs/proofs/argument.md").read_text("utf-8"), re.MULTILINE)
    assert len(rows) == 2 and float(rows[1]) <= proof.error / max(proof.sine, proof.cosine)
    assert proof.turns < 2 ** 20 and proof.far < 0.7854
    assert max(proof.sine, proof.cosine) <= proof.error == Fraction(1, 2 ** 51)
    assert 1 < max(proof.sine, proof.cosine) / Fraction(1, 2 ** 53)     # it is no less than u


MUTATIONS = [                           # what stands there, what to put in its place, what is said
    ("-1.0 / 5040 ", "-1.0 / 5041 ", "promises"),
    ("1.0 / 20922789888000.0", "1.0 / 20922789888001.0", None),         # too little to matter
    ("1.0 / 24 +", "1.0 / 25 +", "promises"),
    ("0x1.0b4611a6p-34", "0x1.0b4611a7p-34", "promises"),
    ("0x1.921fb544p0", "0x1.921fb54442d18p0", "promises"),              # n times it is rounded
    (" - n * 0x1.3198a2e037073p-69", "", "promises"),
    ("((x - n * 0x1.921fb544p0) - n * 0x1.0b4611a6p-34) - n * 0x1.3198a2e037073p-69",
     "x - (n * 0x1.921fb544p0 + (n * 0x1.0b4611a6p-34 + n * 0x1.3198a2e037073p-69))", "promises"),
    ("0x1.45f306dc9c883p-1", "0x1.45f306dc9c883p-2", "promises"),
    ("sine = r + r * (z * p)", "sine = r * (1.0 + z * p)", None),       # worse, but good enough
    ("0.5 * z - z * (z * q)", "(0.5 - z * q) * z", None),
    ("SINE_ERROR 0x1p-51", "SINE_ERROR 0x1p-52", None),                 # that is proved, too
    ("SINE_ERROR 0x1p-51", "SINE_ERROR 0x1.9p-53", "promises"),
    ("SINE_LIMIT 1.5e6 ", "SINE_LIMIT 1.5e7 ", "n may be"),
    ("SINE_LIMIT 1.5e6 ", "SINE_LIMIT 1.5e17 ", "gappa"),
    ("SHIFT = 0x1.8p52", "SHIFT = 0x1.8p53", "gappa"),
    ("SHIFT = 0x1.8p52", "SHIFT = 0x1.8p51", "gappa"),
    ("(bits & 2) << 62", "(bits & 1) << 63", "modulo 4"),
    ("((bits + 1) & 2) << 62", "(bits & 2) << 62", "modulo 4"),
    ("pick(odd, sine, cosine)", "pick(odd, cosine, sine)", "modulo 4"),
    ("z = r * r", "z = r * r / 2", "not known here"),
]


@needs_gappa
@pytest.mark.parametrize("old, new, said", MUTATIONS if TORTURE > 1 else MUTATIONS[::2])
def test_no_other_text_is_proved(tools, header, tmp_path, old, new, said):
    gappa, ctext = tools
    assert header.count(old) == 1
    if said is None:
        gappa.prove(header.replace(old, new), tmp_path)
        return
    with pytest.raises((gappa.NotProved, ctext.CTextError)) as caught:
        gappa.prove(header.replace(old, new), tmp_path)
    assert re.search(said, str(caught.value)) and "\n" not in str(caught.value)


def test_coq_has_the_same_numbers(tools, header, root):
    """Sine.v puts the text's operations together by their constants."""
    definitions = tools[0].definitions(header)
    theorem = (root / "formal" / "sine" / "Sine.v").read_text("utf-8")
    for number in re.findall(r"Float[12] \(?(-?\d{8,})\)?", theorem):
        K = 4175892906503776358826876457663557747               # the sum of three
        assert "(%s)" % number in definitions or int(number) == K
    assert re.findall(r"^Definition (\w+)", definitions, re.MULTILINE) == [
        "rnd", "shifted_", "n_", "r_", "r_exact", "z_", "p_", "q_", "sine_", "cosine_",
        "z_exact", "p_exact", "q_exact", "sine_exact", "cosine_exact"]


def executed(ctext, header, x):
    """What the text of double_sincos makes of a double, executed with Python's."""
    found = {}

    def bits_of(y):
        return struct.unpack("<Q", struct.pack("<d", y))[0]

    def vec_of(bits):
        return struct.unpack("<d", struct.pack("<Q", bits % 2 ** 64))[0]

    names = {"bits_of": bits_of, "vec_of": vec_of, "mag": abs, "TRUTH": lambda truth: -int(truth),
             "pick": lambda m, x, y: vec_of(bits_of(x) & m | bits_of(y) & ~m),
             "SINE_LIMIT": ctext.defined(header, "SINE_LIMIT")}
    names.update((name, ctext.Place(None, lambda value, name=name: found.update({name: value})))
                 for name in "sc")
    ctext.function(header, "double_sincos").bound(names)(names["s"], names["c"], x)
    return found["s"], found["c"]


def test_the_text_is_read_as_the_compiler_reads_it(tools, header):
    """The core has the same bits as the text that the proof is about."""
    rng = rng_for("gappa")
    angles = [0.0, -0.0, -1e-290, 1e-8, 0.5, math.pi / 4, -math.pi / 2, 1.5e6, -1.5e6]
    angles += [k * math.pi / 4 * (1 + e * 2.0 ** -52) for k in range(-40, 40) for e in (-1, 0, 1)]
    for _ in range(50 * TORTURE):
        angles += rng.uniform(-4, 4), rng.uniform(-1.5e6, 1.5e6), rng.choice([-1, 1]) * 10.0 ** \
            rng.uniform(-30, 6)
    for x in angles:
        assert [*map(Fraction, executed(tools[1], header, x))] == \
            kernels.call("double_sincos", [Fraction(x)], 2, 10), x
    for x in (1.5000001e6, -1e300, math.inf, math.nan):
        assert all(map(math.isnan, executed(tools[1], header, x)))


def test_exact_arithmetic(tools):
    """The enclosure of pi/2 and the distances from Taylor's polynomials, against other sources."""
    gappa, _ = tools
    low, high = gappa.half_pi()
    with mpmath.workdps(80):
        assert low < high < low + Fraction(1, 10 ** 60)
        assert mpmath.mpf(low.numerator) / low.denominator < mpmath.pi / 2
        assert mpmath.mpf(high.numerator) / high.denominator > mpmath.pi / 2
    r = gappa.symbol("r")
    radius = Fraction(3, 4)
    for polynomial, first, function in ((r - r * r * r * Fraction(1, 7), 1, mpmath.sin),
                                        (1 - r * r * Fraction(1, 2), 0, mpmath.cos)):
        bound = gappa.distance_from_taylor(polynomial, first, radius)
        worst = max(abs(sum(float(c) * x ** len(key) for key, c in polynomial.terms.items())
                        - function(x)) for x in (0.75 * k / 100 for k in range(-100, 101)))
        assert 0.6 * bound < worst <= bound
