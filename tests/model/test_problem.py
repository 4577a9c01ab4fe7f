"""Reading the input: exact numbers, tolerant layout, one clear line for every mistake."""

import io
import itertools
from dataclasses import replace
from decimal import Decimal
from fractions import Fraction
from operator import mul

import pytest
from conftest import around
from hypothesis import given
from hypothesis import strategies as st

from converse import ConverseError, Problem, prove
from converse.model import inputs
from converse.model.exact import decimal_text
from converse.model.inputs import read_input
from converse.model.lattice import determinant
from converse.model.map import THESIS, MuldoonMap, SymplecticMap
from converse.model.problem import IDENTITY, InputError, inverse, rows
from converse.prover import native

GOOD = "0.3085 0.00125\n0.3085 0.00125\n0.617 0.0025\n\n1.0 1.0\n1.0 1.0\n\n"


def read(text):
    return read_input(io.BytesIO(text.encode("utf-8")))


def test_sample(root):
    problem = read_input(root / "inputs" / "trig274.in")
    assert problem.centre == tuple(map(Fraction, ("0.3085", "0.3085", "0.617", "1", "1")))
    assert problem.half == tuple(map(Fraction, ("0.00125", "0.00125", "0.0025", "1", "1")))
    assert problem.comments == ("0.0274 < epsilon < 0.0276", "Run on kastor", "May 2nd, 1989")
    assert problem.full_torus
    assert problem == read_input(str(root / "inputs" / "trig274.in"))


@pytest.mark.parametrize("name", ["trig272", "trig274", "trig276", "trig278"])
def test_inputs_are_full_torus(root, name):
    problem = read_input(root / "inputs" / (name + ".in"))
    assert problem.full_torus and problem.comments
    assert problem.centre[2] == 2 * problem.centre[0] == 2 * problem.centre[1]


@pytest.mark.parametrize("text", [
    GOOD.replace("\n", "\r\n"), GOOD.replace(" ", "\t"), GOOD.replace(" ", " \t  "),
    "\n\n \n" + GOOD.replace("\n", "\n\t\n"), GOOD.rstrip("\n"), "\ufeff" + GOOD,
    GOOD.replace("0.3085", "+3085e-4").replace("1.0", "1."), GOOD.replace("0.", "."),
])
def test_layouts(text):
    assert read(text) == read(GOOD)


def test_text_streams_and_latin_1():
    assert read_input(io.StringIO(GOOD)) == read(GOOD)
    comment = "Fran\u00e7ois \u2264 \u03b5"
    assert read(GOOD + comment).comments == (comment,)
    assert read_input(io.BytesIO((GOOD + "Fran\u00e7ois").encode("latin-1"))).comments \
        == ("Fran\u00e7ois",)


def test_comments_keep_their_inner_blank_lines():
    assert read(GOOD + "\n\none\n\n  two  \n\n").comments == ("one", "", "  two")
    assert read(GOOD).comments == ()


def test_zero_half_widths():
    problem = read("0.3 0\n0.3 0\n0.6 0.0\n0.5 0\n0.5 0e5")
    assert problem.half == (0,) * 5
    assert not problem.full_torus


@pytest.mark.parametrize("v0, v1, full", [("1", "1", True), ("1", "0.999", False),
                                          ("0.5", "1", False), ("1.5", "2", True)])
def test_full_torus(v0, v1, full):
    assert read("1 0\n1 0\n1 0\n1 %s\n1 %s" % (v0, v1)).full_torus is full


LINES = GOOD.split("\n")


def changed(number, line):
    return "\n".join(LINES[:number - 1] + [line] + LINES[number:])


@pytest.mark.parametrize("text, line, words", [
    ("", 1, "empty"), ("\n\n \n", 3, "empty"),
    ("0.3085 0.00125\n", 1, "too early"), ("\n".join(LINES[:5]), 5, "too early"),
    (changed(2, "three 0.00125"), 2, "'three' is not a decimal number"),
    (changed(6, "May 2nd, 1989"), 6, "'May' is not"),
    (changed(1, "nan 0.1"), 1, "'nan'"), (changed(1, "0.3 inf"), 1, "'inf'"),
    (changed(1, "0.3 -Infinity"), 1, "Infinity"), (changed(3, "1e400 1"), 3, "out of range"),
    (changed(3, "1 1e-400"), 3, "out of range"), (changed(3, "1 1e9999999999999"), 3, "1e99"),
    (changed(2, "0." + "3" * 1000 + " 0"), 2, "1002 characters; give at most 1000"),
    (changed(2, "0.3085 -0.00125"), 2, "negative"), (changed(6, "1 -1"), 6, "negative"),
    (changed(1, "\u0661 1"), 1, "not a decimal"), (changed(1, "1/0 1"), 1, "1/0"),
])
def test_mistakes(text, line, words):
    with pytest.raises(InputError) as caught:
        read(text)
    message = str(caught.value)
    assert message.startswith("<stdin>, line %d: " % line)
    assert words in message and "; give the centre and the half-width of " in message
    assert "\n" not in message


def test_messages_name_the_file(tmp_path, monkeypatch):
    path = tmp_path / "bad.in"
    path.write_text("1 2 3\n")
    with pytest.raises(InputError, match="bad.in, line 1: "):
        read_input(path)
    for missing in tmp_path / "missing.in", tmp_path:
        with pytest.raises(InputError, match="cannot be read"):
            read_input(missing)
    monkeypatch.setattr(inputs, "MOST_BYTES", 5)
    with pytest.raises(InputError, match="bad.in: is longer than 5 bytes; name an input file"):
        read_input(path)


# ---- named ranges

def test_named_ranges(root):
    problem = read_input(root / "inputs" / "trig274.in")
    named = Problem(MuldoonMap(("0.30725", "0.30975"), (Decimal("0.30725"), Fraction("0.30975")),
                               ("6145e-4", "0.6195")), comments=problem.comments)
    assert named == problem == around(problem.centre, problem.half, problem.comments)
    assert repr(named) == "<Problem: Muldoon map, a = 0.30725..0.30975, " \
        "b = 0.30725..0.30975, c = 0.6145..0.6195; v0=0..2, v1=0..2>"
    point = Problem(MuldoonMap("63/64", 0, 0).tied())
    assert point.abc[0] == (Fraction(63, 64),) * 2 and point.half[:3] == (0, 0, 0)
    assert point.full_torus and point.together


def test_what_is_no_decimal_is_enclosed():
    """4/3 is no finite decimal: the range that is covered holds it, and is hardly wider."""
    for third in "4/3", Fraction(4, 3):
        low, high = Problem(MuldoonMap(third, 0, 0)).abc[0]
        assert low < Fraction(4, 3) < high and high - low == Fraction(1, 10 ** 40)
    low, high = Problem(MuldoonMap(("-4/3", "-2/3"), 0, 0)).abc[0]
    assert low < Fraction(-4, 3) and high > Fraction(-2, 3)
    assert decimal_text(low) and decimal_text(high)
    assert read(GOOD.replace("0.3085 0.00125", "4/3 1/7",
                             1)).abc[0][0] < Fraction(4, 3) - Fraction(1, 7)
    assert prove(Problem(MuldoonMap(("4/3", "3/2"), 0, 0)), method="loewner").no_tori


@pytest.mark.parametrize("ranges, error, words", [
    ({"a": 0.3}, TypeError, "a: 0.3 is not an exact number"),
    ({"a": ("0.3", 0.4)}, TypeError, "a: 0.4 is not an exact number"),
    ({"a": True}, TypeError, "True"), ({"b": None}, TypeError, "b: None"),
    ({"b": ()}, ValueError, "not 0 numbers"), ({"c": (1, 2, 3)}, ValueError, "not 3 numbers"),
    ({"c": ("0.4", "0.3")}, ValueError, "lower end, 0.4, is above"),
    ({"v0": "x"}, ValueError, "v0: 'x' is not a decimal number"),
    ({"v1": 10 ** 309}, ValueError, "out of range"), ({"a": "1e309"}, ValueError, "out of range"),
    ({"a": Decimal("nan")}, ValueError, "'NaN'"), ({"a": Decimal("inf")}, ValueError, "Infinity"),
    ({"a": Fraction(1, 10 ** 301)}, ValueError, "out of range"),
])
def test_bad_ranges(ranges, error, words):
    with pytest.raises(error) as caught:
        region = {name: ranges.pop(name) for name in ("v0", "v1") if name in ranges}
        Problem(MuldoonMap(**{"a": 0, "b": 0, "c": 0, **ranges}), **region)
    assert words in str(caught.value) and "\n" not in str(caught.value)


def test_arguments_of_another_type():
    with pytest.raises(TypeError):
        Problem("1", "1")
    with pytest.raises(TypeError, match="c: None"):
        MuldoonMap("1", "1")


@pytest.mark.parametrize("text", ["1e309", "-1e309", "1e99999", "nan", "", "1e400000"])
def test_the_core_refuses_what_no_problem_can_say(text, monkeypatch):
    """Also when it is asked behind the back of Problem, whichever number it is."""
    given, told = native.native_text, []

    def told_instead(number, owners):
        told.append(number)
        return given(text if len(told) - 1 == wrong else number, owners)

    monkeypatch.setattr(native, "native_text", told_instead)
    for wrong in range(19):         # of three waves the phase, the amplitude, three parts; v0, v1
        told.clear()
        with pytest.raises(ConverseError, match="malformed or out of range|no sense"):
            prove(Problem(MuldoonMap(1, 1, 1)), method="thesis")
        assert len(told) > wrong


def test_comments_are_lines(tmp_path):
    problem = Problem(MuldoonMap(2, 2, 2), comments=(
        "one\ntwo\r\nthree", "", "a\udc80b", "tree:", "\x1b[31mred\x00\x9b"))
    assert problem.comments == (
        "one", "two", "three", "", "a\\udc80b", "tree:", r"\x1b[31mred\x00\x9b")
    proof = prove(problem, method="loewner", backup=tmp_path / "a.proof")
    assert type(proof).load(tmp_path / "a.proof") == replace(proof, seconds=0)
    assert Problem(MuldoonMap(2, 2, 2), comments="one line").comments == ("one line",)


def test_comments_are_strings():
    with pytest.raises(TypeError):
        Problem(MuldoonMap(1, 1, 1), comments=(5,))


# ---- patches and other potentials

def test_ranges_are_patches():
    """What three ranges, or a segment, can say is the same Problem."""
    for parts, together in (([["0.01", 0, 0], [0, "0.02", 0], [0, 0, 0]], False), ([], False),
                            ([["0.01", "0.02", 0]], True)):
        problem = Problem(SymplecticMap(THESIS, ["0.4", "0.3", "0.2"], parts))
        assert problem.by_ranges and problem.together is together
        halves = [sum(map(Fraction, column)) for column in zip([0] * 3, *parts)]
        assert problem == around(
            (*map(Fraction, ("0.4", "0.3", "0.2")), 1, 1), (*halves, 1, 1), together=together)
        again = Problem(SymplecticMap(problem.waves, problem.amplitude, problem.parts))
        assert again == problem and replace(problem) == problem


@pytest.mark.parametrize("parts", [
    [["0.01", "-0.02", 0]], [["-0.01", 0, 0], [0, 0, 0], [0, 0, 0]],
    [["0.01", 0, 0], [0, "0.02", 0]],
    [["0.01", "0.01", 0], [0, "0.02", 0], [0, 0, "0.02"]],
    [[0, "0.01", 0], ["0.02", 0, 0], [0, 0, 1]]])
def test_other_patches_are_not_ranges(parts):
    problem = Problem(SymplecticMap(THESIS, ["0.4", "0.3", "0.2"], parts))
    assert problem.abc is None and not problem.together
    assert problem.amplitude == tuple(map(Fraction, ("0.4", "0.3", "0.2")))
    assert problem.parts == tuple(tuple(map(Fraction, part)) for part in parts)
    assert problem.half[:3] == tuple(sum(abs(Fraction(x)) for x in column)
                                     for column in zip(*parts))
    assert replace(problem) == problem and hash(replace(problem)) == hash(problem)
    assert replace(problem, v0=(0, 1)).v0 == (0,
                                              1) and problem != Problem(MuldoonMap("0.4", "0.3",
                                                                                   "0.2"))
    assert repr(problem).startswith("<Problem: V(y) = -(0.4 ")


def test_the_thesis_in_waves():
    problem = Problem(MuldoonMap(("0.3", "0.4"), "0.2", ("0.5", "0.7")))
    assert problem.waves == tuple((*k, 0) for k in THESIS) and problem.odd == (0, 0)
    assert problem.amplitude == (Fraction("0.35"), Fraction("0.2"), Fraction("0.6"))
    assert problem.parts == ((Fraction("0.05"), 0, 0), (0, 0, 0), (0, 0, Fraction("0.1")))
    assert problem.tied().parts == ((Fraction("0.05"), 0, Fraction("0.1")),)
    assert (problem.frame, problem.factor, problem.searched) == (IDENTITY, None, problem.terms)


WAVE = {"amplitude": [1], "waves": [(1, 0)]}


@pytest.mark.parametrize("arguments, error, words", [
    ({"amplitude": [1, 1]}, ValueError, "2 numbers for 3 harmonics"),
    ({**WAVE, "amplitude": ["1/3"]}, ValueError, "harmonic 1: 1/3 is not a finite decimal"),
    ({"amplitude": [0.1, 1, 1]}, TypeError, "harmonic 1: 0.1 is not an exact number"),
    ({"amplitude": 5}, TypeError, "sequences"),
    ({"amplitude": [1] * 3, "parts": [5]}, TypeError, "seq"),
    ({"amplitude": [1] * 3, "parts": [[1, 1]]}, ValueError, "parameter 1 has 2 numbers"),
    ({"amplitude": [1] * 3, "parts": [[1, 1, "x"]]}, ValueError,
     "parameter 1 of harmonic 3: 'x' is not"),
    ({"amplitude": [1] * 3, "parts": [[1, 1, 1]] * 4}, ValueError, "4 parameters; give 3"),
    ({"amplitude": [1], "waves": [(0, 0)]}, ValueError, "harmonic 1: k = (0, 0) is not a harmonic"),
    ({"amplitude": [1], "waves": [(1.0, 0)]}, TypeError, "harmonic 1: k is two integers"),
    ({"amplitude": [1], "waves": [(True, 0)]}, TypeError, "harmonic 1: k is two integers"),
    ({"amplitude": [1], "waves": [(0, -101)]}, ValueError, "out of range"),
    ({"amplitude": [1], "waves": [(1,)]}, ValueError, "not 1 numbers"),
    ({"amplitude": [1], "waves": [(1, 0, "pi")]}, ValueError,
     "the phase of harmonic 1: 'pi' is not"),
    ({"amplitude": [], "waves": []}, ValueError, "there are 0 harmonics; give 1 to 16"),
    ({"amplitude": [1] * 17, "waves": [(k, 1) for k in range(17)]}, ValueError, "17 harmonics"),
    ({"amplitude": [1, 1], "waves": [(1, 0, "2"), (1, 0)]}, ValueError,
     "harmonics 1 and 2 are the same"),
    ({**WAVE, "v0": (1, 0)}, ValueError, "v0: the lower end"),
    ({**WAVE, "axes": (1, 1, 1, 1)}, ValueError, "determinant"),
    ({**WAVE, "axes": (1, 0, 0)}, ValueError, "four integers"),
    ({**WAVE, "axes": (1, 0, 101, 1)}, ValueError, "up to 100"),
    ({**WAVE, "axes": (1, 0, 0, True)}, ValueError, "four integers"),
    ({**WAVE, "alone": 2}, ValueError, "alone is 0, 1 or 'no'"),
    ({**WAVE, "alone": True}, ValueError, "alone is 0, 1 or 'no'"),
    ({**WAVE, "alone": 0}, ValueError, "no coordinate stands alone"),
    ({"amplitude": [1] * 3, "alone": 1}, ValueError, "no coordinate stands alone")])
def test_bad_patches(arguments, error, words):
    with pytest.raises(error) as caught:
        waves, amplitude, parts = (arguments.pop(name, default) for name, default in (
            ("waves", THESIS), ("amplitude", None), ("parts", ())))
        Problem(SymplecticMap(waves, amplitude, parts), **arguments)
    assert words in str(caught.value) and "\n" not in str(caught.value)


@given(st.lists(st.tuples(st.integers(-4, 4), st.integers(-4, 4),
                          st.fractions(-2, 2, max_denominator=4))
                .filter(lambda wave: wave[:2] != (0, 0)), min_size=1, max_size=4,
                unique_by=lambda wave: (*wave[:2], wave[2] % 2)))
@pytest.mark.slow
def test_odd_about_a_point(waves):
    """A point that is named is one; if none is, none of those that two waves leave is one."""
    problem = Problem(SymplecticMap(waves, [1] * len(waves)))

    def odd(s):
        return all((k0 * s[0] + k1 * s[1] + phase).denominator == 1 for k0, k1, phase in waves)

    if problem.odd is not None:
        assert odd(problem.odd) and all(0 <= x < 1 for x in problem.odd)
        return
    for (p0, p1, p), (q0, q1, q) in itertools.combinations(waves, 2):
        size = p0 * q1 - p1 * q0
        if size:
            assert not any(odd(((q1 * (i - p) - p1 * (j - q)) / size,
                                (p0 * (j - q) - q0 * (i - p)) / size))
                           for i in range(abs(size)) for j in range(abs(size)))
            return
    k0, k1, phase = waves[0]                # all are parallel: a line of points does as one does
    assert not any(odd(((i - phase) / k0, Fraction(0)) if k0 else (Fraction(0), (i - phase) / k1))
                   for i in range(abs(k0 or k1) * 12))


@pytest.mark.parametrize("waves, shifts", [
    ([(1, 0), (0, 1), (1, 1)], (0, 0)), ([(1, 0, "1/2"), (0, 1, "1/2")], ("1/2", "1/2")),
    ([(1, 0, "1/2"), (0, 1, "1/2"), (1, 1, "1/2")], None),
    ([(2, 0, "1/3"), (4, 0, "2/3")], ("5/6", 0)),
    ([(1, 0), (2, 0, "1/2")], None), ([(1, -1, "1/2"), (1, 1)], ("3/4", "1/4")),
    ([(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1)], (0, 0, 0)),
    ([(1, 0, 0), (0, 1, 0, "1/2"), (0, 0, 1, "+cos"), (1, 1, 1, "1/2")], None),
    ([(1, 1, 0, "1/2"), (0, 1, -2), (3, 0, 1, "1/4")], (0, "1/2", "3/4"))])
def test_what_is_odd(waves, shifts):
    problem = Problem(SymplecticMap(waves, [1] * len(waves)))
    assert problem.odd == (shifts and tuple(map(Fraction, shifts)))
    assert not shifts or all((sum(map(mul, k, problem.odd)) + phase).denominator == 1
                             for *k, phase in problem.waves)


@pytest.mark.parametrize("waves, frame", [
    ([(1, 1)], (1, 0, -1, 1)), ([(1, -1)], (1, 0, 1, -1)), ([(-1, 1)], None),
    ([(2, -4), (-3, 6)], None),
    ([(5, 3), (-10, -6, "1/2")], None), ([(2, -3, 5), (-4, 6, -10)], None),
    ([(0, 3, 1)], None), ([(1, 0)], IDENTITY), ([(0, 3), (0, -1)], IDENTITY),
    ([(1, 1), (1, -1)], IDENTITY), (THESIS, IDENTITY)])
def test_frames(waves, frame):
    """The first column moves nothing that a wave feels, where there is a use for that."""
    f = Problem(SymplecticMap(waves, [1] * len(waves))).frame
    if len(f) == 9:
        columns = [f[i::3] for i in range(3)]
        felt = [[sum(map(mul, k, column)) for column in columns] for k in waves]
        assert all(not first and not second and third for first, second, third in felt)
        assert determinant(rows(f)) in (1, -1)
        return
    assert abs(f[0] * f[3] - f[1] * f[2]) == 1
    if frame is None:
        assert all(k0 * f[0] + k1 * f[2] == 0 for k0, k1, *_ in waves)
    else:
        assert f == frame


@given(st.lists(st.integers(-5, 5), min_size=9, max_size=9))
def test_the_inverse_of_a_frame(frame):
    matrix = rows(tuple(frame))
    (a, b, c), (d, e, f), (g, h, i) = matrix
    size = a * e * i + b * f * g + c * d * h - c * e * g - b * d * i - a * f * h
    assert determinant(matrix) == size
    if size:
        assert [[sum(map(mul, row, column)) for column in zip(*inverse(tuple(frame)))]
                for row in matrix] == [[1, 0, 0], [0, 1, 0], [0, 0, 1]]


def test_frames_of_the_thesis():
    # the standard map in y0 + y1
    assert Problem(MuldoonMap(0, 0, ("0.4", "0.5"))).frame == (1, 0, -1, 1)
    # x_1 as it was asked for
    assert Problem(MuldoonMap(0, 0, ("0.4", "0.5")), v0=(0, 1)).frame == IDENTITY
    for problem in Problem(MuldoonMap(0, 0,
                                      0)), Problem(MuldoonMap(1, 0, 0)), Problem(MuldoonMap("0.1",
                                                                                            0, 1)):
        assert problem.frame == IDENTITY
    plain = replace(Problem(MuldoonMap(0, 0, "0.5")), axes=IDENTITY)
    assert plain.frame == IDENTITY and plain != Problem(MuldoonMap(0, 0, "0.5"))
    # what is chosen anyhow
    assert replace(plain, axes=(1, 0, -1, 1)) == Problem(MuldoonMap(0, 0, "0.5"))


@pytest.mark.parametrize("amplitude, waves, kept", [
    ((1, "0.9", 0), THESIS, 0), (("0.9", 1, 0), THESIS, 1), ((1, 1, 0), THESIS, 0),
    ((1, 1, "1e-9"), THESIS, None), ((1, 0, 0), THESIS, None), ((0, 0, 1), THESIS, None),
    ((1, "0.3"), [(1, 0), (0, 2)], 1), ((1, "-2"), [(1, 0), (0, 1)], 1),
    ((1, 1), [(1, 0), (1, 1)], None)])
def test_a_coordinate_alone(amplitude, waves, kept):
    problem = Problem(SymplecticMap(waves, amplitude))
    assert problem.factor == kept
    assert [term.k for term in problem.searched] == [
        k for k in waves if kept is None or k[1 - kept] == 0]
    both = replace(problem, alone="no")
    assert both.factor is None and len(both.searched) == len(waves)
    assert (both == problem) == (kept is None) and replace(both, alone=kept) == problem


def test_the_circle():
    assert Problem(SymplecticMap([(1, 0), (2, 0)], [1, "0.1"])).map.dimension == 1
    assert Problem(SymplecticMap([(1, 0), (0, 1)], [1, "0.1"])).map.dimension == 2
    assert Problem(MuldoonMap(1, 0, 0)).map.dimension == 2
