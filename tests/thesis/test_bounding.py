"""Products and squares of bounded numbers are the exact ranges."""

from hypothesis import example, given
from hypothesis import strategies as st

import kernels

intervals = st.tuples(*[st.decimals(-100, 100, places=15)] * 2).map(sorted)


@given(intervals, intervals)
@example([-1, 2], [-3, 1])
@example([-2, -1], [-3, 3])
@example([0, 0], [-1, 1])
def test_product(x, y):
    ends = [kernels.call("mul", [a, b], 1, 35)[0] for a in x for b in y]
    assert kernels.call("product", [*x, *y], 2, 35) == [min(ends), max(ends)]


@given(intervals)
@example([-1, 2])
@example([-2, 1])
@example([-2, -1])
@example([0, 3])
@example([-3, 0])
def test_square(x):
    ends = [kernels.call("mul", [a, a], 1, 35)[0] for a in x]
    low = 0 if x[0] <= 0 <= x[1] else min(ends)
    assert kernels.call("square", x, 2, 35) == [low, max(ends)]
