"""Pictures of tori: they are drawn, in every format, and show what they should."""

from fractions import Fraction
from types import SimpleNamespace

import numpy as np
import pytest

from converse.draw import torus_figure
from converse.model.potential import FourierSum
from converse.storage.files import ConverseError
from converse.tori.rotation import read_rotation
from converse.tori.torus import Torus

pytest.importorskip("matplotlib")
NONE = Fraction(0)
CIRCLE = FourierSum(((1, 0, NONE),), (Fraction(1, 2),), 1)
WAVES = FourierSum(((1, 0, NONE), (0, 1, NONE)), (Fraction(1, 20), Fraction(1, 30)), 2)


def torus(potential, part, modes, *piece):
    """Of modes {k: of each power of sigma (re_0, im_0, ...)}."""
    n, rows = potential.dimension, sorted(modes.items())
    numbers = np.array([series for _, series in rows], object).reshape(len(rows), -1, n, 2)
    return Torus(potential, part, read_rotation("golden" if n == 1 else "T49"), 20,
                 np.array([k for k, _ in rows]), numbers.transpose(3, 1, 2, 0), None, *piece)


def proved(*tori):
    return SimpleNamespace(pieces=[SimpleNamespace(
        torus=torus, needed=Fraction(1, 10 ** 8), residual=Fraction(1, 10 ** 11))
        for torus in tori])


ONE = proved(torus(CIRCLE, None, {(k,): ((10 ** 6 >> 2 * k, -k),) for k in range(1, 9)}))
TWO = proved(torus(WAVES, None, {
    (1, 0): ((90000, 0, 9000, 10),), (0, 1): ((0, 10, 80000, -9),), (2, -1): ((1, 2, 3, 4),)}))
RANGE = proved(*(torus(CIRCLE, (Fraction(1, 4),),
                       {(1,): ((10 ** 5, 0), (10 ** 4, 3)), (2,): ((10 ** 3, 9), (0, 0))},
                       (Fraction(low), Fraction(low + 1))) for low in (-1, 0)))


def drawn(proof, path):
    torus_figure.draw([piece.torus for piece in proof.pieces], None, proof.pieces, path)


@pytest.mark.slow
def test_a_proved_torus_is_drawn_as_the_name_says(tmp_path):
    for name, start in (("a.png", b"\x89PNG"), ("a.svg", b"<?xml"), ("a.pdf", b"%PDF")):
        drawn(ONE, str(tmp_path / name))
        assert (tmp_path / name).read_bytes().startswith(start)
    with pytest.raises(ConverseError, match="ends in .svg"):
        drawn(ONE, str(tmp_path / "a.ps"))


def test_what_is_needed_and_what_was_reached_is_shown():
    """Of a range over the parameter, of a single torus in the title."""
    from matplotlib.figure import Figure
    axes = Figure().subplots()
    torus_figure._errors(axes, RANGE.pieces)
    needed, reached = axes.patches
    assert [each.get_label() for each in (needed, reached)] == ["needed", "reached"]
    assert 10 ** needed.get_data().values == pytest.approx([1e-8, 1e-8])
    assert 10 ** reached.get_data().values == pytest.approx([1e-11, 1e-11])
    title = torus_figure._title([ONE.pieces[0].torus], 500, ONE.pieces)
    assert "at most 1.00e-11, admissible 1.00e-8" in title


def test_the_amplitudes_of_a_title_are_those_of_the_torus():
    """To all digits, since no torus is proved beyond them."""
    for amplitude, part, words in (("0.12345678", None, "amplitude 0.12345678"),
                                   ("0.12345678", "0.00000001", "amplitude 0.12345677..0.12345679"),
                                   ("0.12345678", "-0.00000001",
                                    "amplitude 0.12345677..0.12345679")):
        tori = [torus(FourierSum(((1, 0, NONE),), (Fraction(amplitude),), 1),
                      part and (Fraction(part),), {(1,): ((1, 0), (1, 0))},
                      *[(Fraction(-1), Fraction(1))] * bool(part))]
        assert torus_figure._title(tori, 500, ()).endswith(words)


@pytest.mark.slow
@pytest.mark.parametrize("proof", [ONE, TWO, RANGE], ids=["one angle", "two angles", "a range"])
def test_the_same_picture_is_the_same_file(proof, tmp_path):
    paths = [tmp_path / name for name in ("a.svg", "b.svg")]
    for path in paths:
        drawn(proof, path)
    assert paths[0].read_bytes() == paths[1].read_bytes()


@pytest.mark.slow
def test_the_copies_of_a_torus_fill_the_square(tmp_path):
    """However far u moves it: no corner is left white."""
    import matplotlib.image
    far = torus(WAVES, None, {(1, 1): ((400000, 0, 0, 300000),)})
    path = tmp_path / "a.png"
    torus_figure.draw([far], path=path)
    image = matplotlib.image.imread(str(path))
    height, width = image.shape[:2]
    inner = image[height // 3:height // 2, width // 10:width // 5, :3]     # of the first panel
    assert (inner.min(-1) < 0.97).all()
