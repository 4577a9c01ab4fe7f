"""Potentials of one's own: the JSON that describes them, and the maps it is to describe."""

import dataclasses
import io
import json
import math
import time
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from converse import ConverseError, InputError, Problem, prove, read_input
from converse.model.map import LINE, SymplecticMap

from truth import TORTURE

A, B, C = ({"k": k, "amplitude": amplitude} for k, amplitude in (
    ([1, 0], ["0.30725", "0.30975"]), ([0, 1], ["0.30725", "0.30975"]),
    ([1, 1], ["0.6145", "0.6195"])))


def read(value):
    return read_input(io.StringIO(value if isinstance(value, str) else json.dumps(value)))


def one(**fields):
    """An input of one harmonic with these fields."""
    return {"harmonics": [{"k": [1, 0], "amplitude": 1, **fields}]}


def test_the_thesis_in_both_formats(root):
    """Three ranges are the thesis's input, and one name for all is --together."""
    thesis = read_input(root / "inputs" / "trig274.in")
    ours = read({"harmonics": [A, B, C], "comments": list(thesis.comments)})
    assert ours == thesis and not ours.together
    low, high = (LINE * Fraction(x) for x in ("0.0148", "0.0280"))
    line = read({"parameters": {"epsilon": ["0.0148", "0.0280"]}, "harmonics": [
        {"k": k, "amplitude": {"epsilon": factor}} for k, factor in (
            ([1, 0], "11.21436"), ([0, 1], "11.21436"), ([1, 1], "22.42872"))]})
    assert line.together and line.abc == ((low, high),) * 2 + ((2 * low, 2 * high),)
    assert line.parameters == (("epsilon", Fraction("0.0148"), Fraction("0.028")),)


def test_parameters():
    """The amplitudes are what the file says they are, at the ends of all parameters."""
    problem = read({"parameters": {"e": [1, "1.5"], "f": ["-0.5", "0.25"]}, "v1": ["0", "0.5"],
                    "harmonics": [
        {"k": [1, 0], "amplitude": {"e": "2", "constant": "-0.1"}, "phase": "-cos"},
        {"k": [-3, 2], "amplitude": {"f": "0.5", "e": "-1e-1"}, "phase": "-1/3"},
        {"k": [0, 1], "amplitude": ["7", 8]}, {"k": [1, 1], "amplitude": 5e-1, "phase": 2.5}]})
    assert problem.waves == ((1, 0, Fraction(1, 2)), (-3, 2, Fraction(-1, 3)), (0, 1, 0),
                             (1, 1, Fraction(1, 2)))
    assert (problem.v0, problem.v1) == ((0, 2), (0, Fraction(1, 2)))
    assert problem.parameters == (
        ("e", 1, Fraction("1.5")), ("f", Fraction("-0.5"), Fraction("0.25")),
        ("amplitude[3]", 7, 8))
    for e, f, own in ((-1, -1, -1), (1, -1, 1), (-1, 1, 1), (1, 1, -1)):
        p = [p + sum(t * x for t, x in zip((e, f, own), parts))
             for p, *parts in zip(problem.amplitude, *problem.parts)]
        e, f = Fraction("1.25") + e * Fraction("0.25"), Fraction("-0.125") + f * Fraction("0.375")
        assert p == [2 * e - Fraction("0.1"), f / 2 - e / 10, 7 if own < 0 else 8, Fraction("0.5")]


def test_numbers_are_exact():
    problem = read('{"harmonics": [{"k": [1], "amplitude": '
                   '0.1000000000000000000000000000000000001}]}')
    assert problem.amplitude == (Fraction("0.1000000000000000000000000000000000001"),)
    low, high = (problem.amplitude[0] + sign * problem.half[0] for problem in [read(one(
        amplitude="4/3"))] for sign in (-1, 1))
    assert low < Fraction(4, 3) < high and high - low == Fraction(1, 10 ** 40)


def test_files(tmp_path):
    for name, text in (("a.json", "\ufeff \n" + json.dumps(one())), ("b", json.dumps(one()))):
        (tmp_path / name).write_text(text, encoding="utf-8")
        assert read_input(tmp_path / name) == Problem(SymplecticMap([(1, 0)], [1]))
    (tmp_path / "c.json").write_text("[1,\n 2")
    with pytest.raises(InputError, match="c.json, line 2: this is not valid JSON"):
        read_input(tmp_path / "c.json")


def test_files_that_are_no_inputs(tmp_path):
    """An input error is one of the package's errors; long files and UTF-16 are told as such."""
    path = tmp_path / "a.json"
    for data, words in (
            (json.dumps(one()).encode("utf-16"), "is not text in UTF-8, perhaps in UTF-16"),
            (json.dumps({**one(), "comments": "x" * 10 ** 7}).encode(), "longer than 262144 bytes"),
            (b'{"harmonics": [' + b'{"k": [1], "amplitude": 1},' * 300000, "longer than")):
        path.write_bytes(data)
        began = time.process_time()
        with pytest.raises(ConverseError, match=words):
            read_input(path)
        assert time.process_time() - began < 1


@pytest.mark.parametrize("value, words", [
    ("{", "line 1: this is not valid JSON"),
    ('{"a":' + "[" * 10 ** 5, "too many brackets"), ({"harmonic": []}, 'no field "harmonic"'),
    ({}, "harmonics is missing"),
    ({"harmonics": []}, "there are 0 harmonics; give 1 to 16"),
    ({"harmonics": [5]}, "harmonic 1: this is not an object"),
    (one(Phase=0), 'harmonic 1: there is no field "Phase"'),
    ('{"harmonics": [], "harmonics": []}', '"harmonics" is in one object twice'),
    (one(amplitude=float("nan")), "amplitude of harmonic 1: 'NaN' is not"),
    (one(amplitude=True), '"amplitude": this is true'),
    (one(amplitude="1/0"), "'1/0' is not"), (one(amplitude=[1]), "one number, not 1 numbers"),
    ('{"harmonics": [{"k": [1], "amplitude": 1e999999999}]}', "out of range"),
    (one(amplitude={"e": 1}), "no parameter 'e'; the parameters are none"),
    ({"parameters": {"e": 1}, **one()}, "no amplitude depends on the parameter 'e'"),
    ({"parameters": {"e": 1}, **one(amplitude={"e": "1/3"})},
     "amplitude of harmonic 1: 1/3 is not a finite decimal"),
    ({"parameters": {"e": "1e200"}, **one(amplitude={"e": "1e200"})}, "out of range"),
    ({"parameters": {"constant": 1}, **one()}, "'constant' is not a name for a parameter"),
    ({"parameters": {"a\n": 1}, **one()}, r"'a\n' is not a name"),
    ({"parameters": {"e": [1, 2], "f": [1, 2]}, "harmonics": [
        {"k": [k], "amplitude": [1, 2] if k < 3 else {"e": 1, "f": 1}} for k in (1, 2, 3)]},
     "there are 4 parameters; give 3 at most"),
    (one(phase="tan"), "phase of harmonic 1: 'tan' is not"),
    (one(k=[1, 2, 3, 4]), "k: maps have one to three angles, not 4"), (one(k=[]), "angles, not 0"),
    (one(k=[1.5, 0]), "k: this is not a list of integers"),
    (one(amplitude="0." + "3" * 1000), "the number 0.333333333333333333... has 1002"),
    (one(k=[True, 0]), '"k": this is true'),
    ({"harmonics": [A, {"k": [1], "amplitude": 1}]}, "harmonic 2, k: the number of angles is not"),
    ({"v1": 1, **one(k=[1])}, "v1: the map has no such angle; leave it"),
    ({"v2": 1, **one()}, "v2: the map has no such angle; leave it"),
    ({"v2": 1, **one(k=[1, 0, 0])}, "no wave depends on a third angle; leave v2 out"),
    ({"v0": [1, 0], **one()}, "v0: the lower end, 1, is above"),
    ({"comments": {}, **one()}, "comments: this value has another type")])
def test_mistakes(value, words):
    with pytest.raises(InputError) as caught:
        read(value)
    message = str(caught.value)
    assert message.startswith("<stdin>") and words in message and "; " in message
    assert "\n" not in message and len(message) < 250


values = st.recursive(
    st.one_of(st.none(), st.booleans(), st.integers(-3, 3), st.floats(), st.text(max_size=5),
              st.sampled_from(["0.3", "1/3", "-sin", "cos", "+cos", "-1/2", "1e400", "e"])),
    lambda inner: st.one_of(st.lists(inner, max_size=3), st.dictionaries(
        st.sampled_from(["k", "amplitude", "phase", "e", "constant", "x"]), inner, max_size=3)),
    max_leaves=8)
harmonics = st.fixed_dictionaries(
    {"k": st.one_of(st.lists(st.integers(-2, 2), min_size=1, max_size=2), values),
     "amplitude": st.one_of(st.sampled_from(["0.5", {"e": 2}, ["0.1", "0.2"]]), values)},
    optional={"phase": values, "x": values})


@settings(max_examples=500 * TORTURE, deadline=None)
@given(st.fixed_dictionaries(
    {"harmonics": st.one_of(st.lists(harmonics, max_size=4), values)},
    optional={"parameters": st.one_of(st.just({"e": ["0.1", 1]}), values), "v0": values,
              "comments": values, "other": values}), st.integers(0, 300), st.booleans())
@pytest.mark.slow
def test_anything(value, length, cut):
    """Whatever is read, the answer is a problem or one line."""
    text = json.dumps(value)
    try:
        problem = read("{" + text[1:length] if cut else text)
    except InputError as error:
        assert "\n" not in str(error)
    else:
        assert isinstance(problem, Problem) and not cut or text[:length].endswith("}")


# ---- the maps of the inputs, in the conventions in which they are known

def of_period_one(problem, t):
    """x, p -> x', p' of period 1, as the literature has it, from the waves for these parameters."""
    p = [p + sum(s * part for s, part in zip(t, parts))
         for p, *parts in zip(problem.amplitude, *problem.parts)]

    def step(x, momentum):
        y, J = ([2 * math.pi * u for u in point] for point in (x, momentum))
        force = [sum(float(a) * k[i] * math.cos(k[0] * y[0] + k[1] * y[1] + float(k[2]) * math.pi)
                     for a, k in zip(p, problem.waves)) for i in range(2)]      # - dV
        J = [u + f for u, f in zip(J, force)]
        return [(u + v) / (2 * math.pi) for u, v in zip(y, J)], [u / (2 * math.pi) for u in J]

    return step


def sin(x):
    return math.sin(2 * math.pi * x) / (2 * math.pi)


def standard(K):
    return lambda x: (K * sin(x[0]), 0)


def two_harmonics(K1, K2):
    return lambda x: (K1 * sin(x[0]) + K2 * sin(2 * x[0]), 0)


def froeschle(K0, K1, coupling):
    return lambda x: (K0 * sin(x[0]) + coupling * sin(x[0] + x[1]),
                      K1 * sin(x[1]) + coupling * sin(x[0] + x[1]))


@pytest.mark.parametrize("name, ends, force", [
    ("standard", {-1: "0.976", 1: "1.34"}, standard),
    ("two-harmonics", {-1: "0.59", 1: "0.592"}, lambda K: two_harmonics(K, 0.4)),
    ("froeschle-0.1", {-1: "0.86", 1: "0.865"}, lambda K: froeschle(K, K, 0.1)),
    ("froeschle-0.3", {-1: "0.6", 1: "0.602"}, lambda K: froeschle(K, K, 0.3)),
    ("froeschle-0.5", {-1: "0.22", 1: "0.23"}, lambda K: froeschle(K, K, 0.5))])
def test_the_usual_conventions(root, name, ends, force):
    """The input's map, with y = 2 pi x, is the one of its comment: both go the same way."""
    problem = read_input(root / "inputs" / (name + ".json"))
    assert problem.full_torus and len(problem.parts) == 1
    for t, K in ends.items():
        ours, theirs = of_period_one(problem, [t]), force(float(K))
        here = there = ([0.123, 0.371 * (problem.map.dimension - 1)],
                        [0.3, 0.17 * (problem.map.dimension - 1)])
        for _ in range(6):
            here = ours(*here)
            p = [u + f for u, f in zip(there[1], theirs(there[0]))]
            there = [x + u for x, u in zip(there[0], p)], p
            assert max(abs(u - v) for a, b in zip(here, there) for u, v in zip(a, b)) < 1e-12


def test_the_crossed_input(root):
    problem = read_input(root / "inputs" / "crossed.json")
    assert problem.odd == (0, 0) and problem.waves[3][:2] == (1, -1)
    assert problem.amplitude == tuple(       # s from 0.75 to 2
        Fraction(11, 5) * part for part in problem.parts[0])


def test_what_is_odd_of_the_inputs(root):
    """Only then larger parameters may be excluded at once."""
    odd = {path.stem for path in (root / "inputs").glob("*.json")
           if read_input(path).odd is not None}
    assert odd == {"standard", "crossed", "line", "plane-ab", "plane-b0", "third-harmonic",
                   "line-three", "froeschle-three"}


@pytest.mark.parametrize("name",
                         ["standard", "two-harmonics", "froeschle-0.1", "froeschle-0.3",
                          "froeschle-0.5",
                                  "crossed"])
@pytest.mark.slow
def test_the_inputs_are_theorems(root, name, tmp_path):
    """Proved; and of a sixteenth of the successors verified by the checker, which takes longer."""
    problem = read_input(root / "inputs" / (name + ".json"))
    proof = prove(problem, method="loewner")
    assert proof.no_tori and proof.at_once == (problem.odd is not None)
    part = prove(dataclasses.replace(problem, v0=("0.25", "0.375")), method="loewner")
    assert part.verify().verdict == "verified in part"


@pytest.mark.slow
def test_one_map_in_both_inputs():
    """The same theorem of the standard map, shifted, mirrored, in either angle, along y0 + y1."""
    for amplitude, k, phase in (("1", (1, 0), 0), ("1", (1, 0), "-1/2"), ("-1", (1, 0), "1/3"),
                                ("1", (0, 1), "-cos"), ("1/2", (1, 1), 0), ("1/2", (1, -1), "1/7")):
        proof = prove(read({"harmonics": [{"k": k, "amplitude": amplitude, "phase": phase}]}),
                      method="loewner")
        assert proof.no_tori and not proof.at_once and proof.counts.proved < 300
    lower = prove(read({"harmonics": [{"k": [1], "amplitude": "0.95"}]}), method="loewner",
                  depth=23)             # with more, other starting points are looked for
    assert lower.conclusion == "undecided"      # its golden circle lives to 0.9716


def test_the_thesis_gives_one_proof_in_both_inputs(root):
    thesis = read_input(root / "inputs" / "trig274.in")
    ours = read({"harmonics": [A, B, C], "comments": list(thesis.comments)})
    for method in "thesis", "loewner":
        assert prove(ours, method=method).tree == prove(thesis, method=method).tree
