"""What csrc promises, by the rows of accuracy.py: it is kept in random cases, and the bounds are no
looser than docs/development/accuracy.md says."""

import re
from statistics import median

import accuracy
import mpmath
import pytest
from conftest import ROOT

from truth import TORTURE

PRINTED = {line.split(" | ")[0][2:]: line.split(" | ")[4:7] for line in (
    ROOT / "docs/development/accuracy.md").read_text("utf-8").splitlines() if line[:2] == "| "}


@pytest.mark.slow
@pytest.mark.parametrize("row", accuracy.ROWS, ids=lambda row: row[0])
def test_what_is_promised_is_kept(row):
    operation, high, arithmetics = row[0], row[4], row[8]
    with mpmath.workdps(accuracy.DIGITS):
        for name, cell in zip(accuracy.DP, PRINTED[operation]):
            if name in arithmetics and (name != "double" or arithmetics is accuracy.DOUBLE):
                seen = accuracy.measured(row, TORTURE / 5, name)
                assert seen and accuracy.kept(row, name, seen)
                usual = float(re.search(r"\((.*)\)", cell)[1]) if high is None else 0
                assert high is not None or usual > 100 or median(seen) <= 4 * usual
