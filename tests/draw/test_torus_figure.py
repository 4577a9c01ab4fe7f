"""Pictures of tori: they are drawn, in every format, and show what they should."""

from fractions import Fraction
from types import SimpleNamespace

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


def proved(*tori):
    return SimpleNamespace(pieces=[SimpleNamespace(
        torus=torus, rho=Fraction(1, 10), needed=1e-8, residual=1e-11,
        tried=((Fraction(1, 20), 1e-12, 1e-10), (Fraction(1, 10), 1e-11, 1e-8),
               (Fraction(1, 5), 1e-3, 1e-7), (Fraction(2, 5), float("inf"), 1e-9)))
        for torus in tori])


ONE = proved(Torus(CIRCLE, None, read_rotation("golden"), 20, {
    (k,): ((10 ** 6 >> 2 * k, -k),) for k in range(1, 9)}))
TWO = proved(Torus(WAVES, None, read_rotation("T49"), 20, {
    (1, 0): ((90000, 0, 9000, 10),), (0, 1): ((0, 10, 80000, -9),), (2, -1): ((1, 2, 3, 4),)}))
RANGE = proved(*(Torus(CIRCLE, (Fraction(1, 4),), read_rotation("golden"), 20,
                       {(1,): ((10 ** 5, 0), (10 ** 4, 3)), (2,): ((10 ** 3, 9),)},
                       (Fraction(low), Fraction(low + 1))) for low in (-1, 0)))


def test_a_proved_torus_is_drawn_as_the_name_says(tmp_path):
    for name, start in (("a.png", b"\x89PNG"), ("a.svg", b"<?xml"), ("a.pdf", b"%PDF")):
        torus_figure.draw(ONE, str(tmp_path / name))
        assert (tmp_path / name).read_bytes().startswith(start)
    with pytest.raises(ConverseError, match="drawn as .svg"):
        torus_figure.draw(ONE, str(tmp_path / "a.ps"))


def test_the_widths_that_were_tried_are_shown():
    """The residual that is needed and the one that was reached, over rho; infinite ones are not."""
    from matplotlib.figure import Figure
    axes = Figure().subplots()
    torus_figure._errors(axes, ONE.pieces)
    needed, reached, chosen = axes.lines
    assert 10 ** needed.get_xdata() == pytest.approx([0.05, 0.1, 0.2])
    assert 10 ** needed.get_ydata() == pytest.approx([1e-10, 1e-8, 1e-7])
    assert 10 ** reached.get_ydata() == pytest.approx([1e-12, 1e-11, 1e-3])
    assert [line.get_label() for line in (needed, reached)] == ["needed", "reached"]
    assert chosen.get_xdata() == pytest.approx([-1, -1])


@pytest.mark.slow
@pytest.mark.parametrize("proof", [ONE, TWO, RANGE], ids=["one angle", "two angles", "a range"])
def test_the_same_picture_is_the_same_file(proof):
    first, second = (torus_figure.picture([p.torus for p in proof.pieces], "svg", proof.pieces)
                     for _ in range(2))
    assert first == second


def test_a_torus_draws_itself_in_a_notebook(monkeypatch):
    torus = ONE.pieces[0].torus
    words = "<pre>%s</pre>" % repr(torus).replace("<", "&lt;").replace(">", "&gt;")
    assert torus._repr_html_().startswith(words + '<img alt="the torus" src="data:image/png;base64')

    def missing():
        raise ConverseError("no matplotlib")

    monkeypatch.setattr(torus_figure.plot, "check", missing)
    assert torus._repr_html_() == words


@pytest.mark.slow
def test_the_copies_of_a_torus_fill_the_square(tmp_path):
    """However far u moves it: no corner is left white."""
    import matplotlib.image
    far = Torus(WAVES, None, read_rotation("T49"), 20, {(1, 1): ((400000, 0, 0, 300000),)})
    path = tmp_path / "a.png"
    path.write_bytes(torus_figure.picture([far]))
    image = matplotlib.image.imread(str(path))
    height, width = image.shape[:2]
    inner = image[height // 3:height // 2, width // 10:width // 5, :3]     # of the first panel
    assert (inner.min(-1) < 0.97).all()
