"""Reading the input: exact numbers, tolerant layout, one clear line for every mistake."""

import io
from decimal import Decimal
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from converse.problem import InputError, decimal_text, exact_decimal, read_input

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
    (changed(3, "1 1e999999999"), 3, "out of range"), (changed(3, "0e999999999 0"), 3, "range"),
    (changed(3, "1" + "0" * 400 + " 0"), 3, "out of range"),
    (changed(2, "0.3085 -0.00125"), 2, "negative"), (changed(6, "1 -1"), 6, "negative"),
    (changed(5, "1.0"), 5, "1 number where two"), (changed(5, "1 1 1"), 5, "3 numbers where two"),
    (changed(1, "0x10 1"), 1, "0x10"), (changed(1, "1_0 1"), 1, "1_0"),
    (changed(1, "\u0661 1"), 1, "not a decimal"), (changed(1, "1/0 1"), 1, "1/0"), (changed(1, "1/3/5 1"), 1, "1/3/5"),
    (changed(1, "0.3,1"), 1, "0.3,1"), (changed(1, ". 1"), 1, "'.'"),
])
def test_mistakes(text, line, words):
    with pytest.raises(InputError) as caught:
        read(text)
    message = str(caught.value)
    assert message.startswith("<stdin>, line %d: " % line)
    assert words in message and "; give the centre and the half-width of " in message
    assert "\n" not in message


def test_messages_name_the_file(tmp_path):
    path = tmp_path / "bad.in"
    path.write_text("1 2 3\n")
    with pytest.raises(InputError, match="bad.in, line 1: "):
        read_input(path)
    for missing in tmp_path / "missing.in", tmp_path:
        with pytest.raises(InputError, match="cannot be read"):
            read_input(missing)


@given(st.decimals(allow_nan=False, allow_infinity=False, min_value=-10**9, max_value=10**9))
def test_decimal_text_is_exact(x):
    assert Fraction(decimal_text(Fraction(x))) == Fraction(x)
    assert exact_decimal(x) == x


def test_decimal_text():
    assert decimal_text(Fraction(617, 1000)) == "0.617"
    assert decimal_text(Fraction(1, 2 ** 30)) == str(Decimal(5 ** 30).scaleb(-30))
    long = Fraction(3, 5 ** 20000)          # longer than Python's limit on int <-> str
    assert Fraction(Decimal(decimal_text(long))) == long
    with pytest.raises(ValueError):
        decimal_text(Fraction(1, 3))
