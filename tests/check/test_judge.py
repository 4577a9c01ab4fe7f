"""The judge of tori, and the checker beside it: what one verifies the other does."""

import re

import judge_of_tori as judge
import pytest
from files import sealed, with_line

from converse import check

from truth import TORTURE

CHEAP = "standard-0.9.torus"


@pytest.fixture(scope="module")
def folder(root):
    return root / "golden_outputs/tori"


@pytest.mark.slow
@pytest.mark.parametrize("name", [CHEAP, *(
    pytest.param(name, marks=pytest.mark.slow) for name in (
        "standard-0.95.torus.gz", "phases.torus", *["line-0.004.torus"] * (TORTURE > 1)))])
def test_golden_certificates(folder, name):
    """Error and distance are bounded by very different means, and are of one size."""
    error, distance = judge.verify((folder / name).read_bytes())
    result = check.verify(folder / name)
    fact, = result.facts
    for ours, theirs in (error, fact.residual), (distance, fact.distance):
        assert result and 0 < float(theirs) / 1000 < ours < 1000 * float(theirs)


def hexadecimal(text, change):
    """With another first coefficient."""
    return re.sub("(?m)^(1 0 )(-?[0-9a-f]+) ", lambda line: "%s%x " % (
        line[1], int(line[2], 16) + change), text)


WRONG = {
    "a coefficient": lambda text: hexadecimal(text, 1 << 30),
    "a mode less": lambda text: re.sub("(?m)^5 0 .*\n", "", text).replace("0 63 0 318\n",
                                                                         "0 63 0 317\n"),
    "the amplitude": lambda text: with_line(text, "wave", "1 0 0 0.9000001"),
    "the number": lambda text: with_line(text, "rotation", "1/10000000 1"),
    "a rational number": lambda text: with_line(text, "rotation", "13/21 0"),
    "a reducible polynomial": lambda text: with_line(text, "polynomial", "-4 0 1"),
    "two roots": lambda text: with_line(text, "root", "-3 3"),
    "no strip": lambda text: with_line(text, "rho", "0"),
    "half of the size": lambda text: text.replace("0 63 0 318", "0 64 0 318"),
}


@pytest.mark.slow
@pytest.mark.parametrize("wrong", WRONG)
def test_both_refuse(folder, tmp_path, wrong):
    text = (folder / CHEAP).read_text()
    changed = WRONG[wrong](text)
    assert changed != text
    path = tmp_path / "wrong.torus"
    path.write_text(sealed(changed))
    with pytest.raises(judge.Refused):
        judge.verify(path.read_bytes())
    with pytest.raises((check.Rejected, check.NotConfirmed, check.Unusable)):
        check.verify(path)


def test_a_byte_less_is_no_certificate(folder):
    with pytest.raises(judge.Refused, match="checksum"):
        judge.verify((folder / CHEAP).read_bytes()[:-1])
