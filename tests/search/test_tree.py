"""Trees as text: the leaves tile the region, exactly."""

from fractions import Fraction
from math import prod

import pytest
from conftest import around
from hypothesis import given
from hypothesis import strategies as st

from converse.prover.tree import Leaf, TreeError, Walk, cells, complete, leaves

TREES = st.recursive(st.sampled_from("PSU"),
                     lambda sub: st.tuples(st.sampled_from("01234"), sub, sub).map("".join),
                     max_leaves=40)
SMALL = around((Fraction(0),) * 3 + (Fraction("0.3"), Fraction("-0.7")),
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


BOXES = around(tuple(map(Fraction, (1, 2, 3, 0, "-0.7"))),
                tuple(map(Fraction, ("0.5", "0.25", 1, "0.1", "2.5"))))


def box(cell):
    """The cell as five exact ranges."""
    index, cuts = cell
    order = (3, 4, 0, 1, 2)                 # of the problem's ranges, by axis
    return [(BOXES.centre[n] - BOXES.half[n] + 2 * BOXES.half[n] * Fraction(i, 2 ** k),
             BOXES.centre[n] - BOXES.half[n] + 2 * BOXES.half[n] * Fraction(i + 1, 2 ** k))
            for n, i, k in zip(order, index, cuts)]


@given(TREES, st.data())
@pytest.mark.slow
def test_leaves_tile_the_region(text, data):
    assert complete(text)
    text = text[:data.draw(st.integers(0, len(text)))]
    tiles = [box(cell) for _, cell in cells(text)]
    volume = sum(prod(b - a for a, b in tile) for tile in tiles)
    assert volume == prod(2 * half for half in BOXES.half)
    for n, tile in enumerate(tiles):
        assert all(a < b for a, b in tile)
        assert not any(all(a < d and c < b for (a, b), (c, d) in zip(tile, other))
                       for other in tiles[n + 1:])


@given(TREES, st.data())
def test_unfinished(text, data):
    cut = data.draw(st.integers(0, len(text) - 1))
    assert not complete(text[:cut])
    kinds = [kind for kind, _ in cells(text[:cut])]
    assert kinds == sorted(kinds, key=lambda kind: kind == "?")     # untried ones at the end
    assert kinds.count("?") == 1 + sum(text[:cut].count(c) for c in "01234") \
        - sum(text[:cut].count(c) for c in "PSU")


@given(TREES)
def test_growing(text):
    walk = Walk()
    assert [leaf for c in text for leaf in walk.feed(c)] == list(cells(text))


def test_untried_in_the_middle():
    assert not complete("0?P") and complete("0PP")
    assert [kind for kind, _ in cells("00?PP")] == ["?", "P", "P"]


def test_choice_of_kinds():
    assert [leaf.kind for leaf in leaves(SMALL, "0PU", "U")] == ["U"]
    assert list(leaves(SMALL, "0PS", "U")) == []
    assert [leaf.kind for leaf in leaves(SMALL, "0P", "?")] == ["?"]


@pytest.mark.parametrize("text", ["6", "0P!", "PP", "0PSU", "P ", "\u00e4"])
def test_not_a_tree(text):
    with pytest.raises(TreeError):
        complete(text)
    with pytest.raises(TreeError):
        list(leaves(SMALL, text))


def test_zero_widths_and_deep_cuts():
    point = around((Fraction(0),) * 5, (Fraction(0),) * 5)
    assert [leaf.half for leaf in leaves(point, "01PSU")] == [(0, 0)] * 3
    deepest = list(leaves(SMALL, "0" * 5000 + "P"))[0]
    assert deepest.depth == 5000 and deepest.half[0] == Fraction("0.1") / 2 ** 5000
