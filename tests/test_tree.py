"""Trees as text: the leaves tile the region, exactly."""

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from converse import Problem
from converse.tree import Leaf, TreeError, Walk, cells, complete, leaves

TREES = st.recursive(st.sampled_from("PSU"),
                     lambda sub: st.tuples(st.sampled_from("01"), sub, sub).map("".join),
                     max_leaves=40)
SMALL = Problem((Fraction(0),) * 3 + (Fraction("0.3"), Fraction("-0.7")),
                (Fraction(0),) * 3 + (Fraction("0.1"), Fraction("2.5")))


def rectangle(leaf):
    return tuple((c - h, c + h) for c, h in zip(leaf.centre, leaf.half))


def test_root():
    assert list(leaves(SMALL, "P")) == [
        Leaf("P", (Fraction("0.3"), Fraction("-0.7")), (Fraction("0.1"), Fraction("2.5")), 0)]


def test_order_and_halves():
    # cut v0; the lower half is proved; the upper one is cut along v1
    lower, below, above = leaves(SMALL, "0P1SU")
    assert rectangle(lower) == ((Fraction("0.2"), Fraction("0.3")),
                                (Fraction("-3.2"), Fraction("1.8")))
    assert rectangle(below) == ((Fraction("0.3"), Fraction("0.4")),
                                (Fraction("-3.2"), Fraction("-0.7")))
    assert rectangle(above) == ((Fraction("0.3"), Fraction("0.4")),
                                (Fraction("-0.7"), Fraction("1.8")))
    assert [leaf.kind for leaf in (lower, below, above)] == ["P", "S", "U"]
    assert [leaf.depth for leaf in (lower, below, above)] == [1, 2, 2]


@given(TREES, st.data())
def test_leaves_tile_the_region(text, data):
    assert complete(text)
    text = text[:data.draw(st.integers(0, len(text)))]
    tiles = [rectangle(leaf) for leaf in leaves(SMALL, text)]
    area = sum((b - a) * (d - c) for (a, b), (c, d) in tiles)
    assert area == Fraction("0.2") * 5
    for n, ((a, b), (c, d)) in enumerate(tiles):
        assert a < b and c < d
        assert not any(a < f and e < b and c < h and g < d for (e, f), (g, h) in tiles[n + 1:])


@given(TREES, st.data())
def test_unfinished(text, data):
    cut = data.draw(st.integers(0, len(text) - 1))
    assert not complete(text[:cut])
    kinds = [kind for kind, _ in cells(text[:cut])]
    assert kinds == sorted(kinds, key=lambda kind: kind == "?")     # untried ones at the end
    assert kinds.count("?") == 1 + sum(text[:cut].count(c) for c in "01") \
        - sum(text[:cut].count(c) for c in "PSU")


@given(TREES)
def test_growing(text):
    walk = Walk()
    assert [leaf for c in text for leaf in walk.feed(c)] == list(cells(text))


def test_choice_of_kinds():
    assert [leaf.kind for leaf in leaves(SMALL, "0PU", "U")] == ["U"]
    assert list(leaves(SMALL, "0PS", "U")) == []
    assert [leaf.kind for leaf in leaves(SMALL, "0P", "?")] == ["?"]


@pytest.mark.parametrize("text", ["2", "0P?", "PP", "0PSU", "P ", "p"])
def test_not_a_tree(text):
    with pytest.raises(TreeError):
        complete(text)
    with pytest.raises(TreeError):
        list(leaves(SMALL, text))


def test_zero_widths_and_deep_cuts():
    point = Problem((Fraction(0),) * 5, (Fraction(0),) * 5)
    assert [leaf.half for leaf in leaves(point, "01PSU")] == [(0, 0)] * 3
    deepest = list(leaves(SMALL, "0" * 5000 + "P"))[0]
    assert deepest.depth == 5000 and deepest.half[0] == Fraction("0.1") / 2 ** 5000
