"""The notebooks of docs/: each runs from its first cell to its last, and shows what it says."""

import ast
import json

import pytest
from conftest import ROOT

pytest.importorskip("matplotlib").use("Agg")


def cells(name):
    """The notebook as it is in the file: without results, which are made anew."""
    notebook = json.loads((ROOT / "docs/tutorials" / name).read_text("utf-8"))
    assert (notebook["nbformat"], notebook["nbformat_minor"]) == (4, 5)
    ids = [cell["id"] for cell in notebook["cells"]]
    assert len(set(ids)) == len(ids)
    for cell in notebook["cells"]:
        if cell["cell_type"] == "code":
            assert cell["outputs"] == [] and cell["execution_count"] is None
            yield "".join(cell["source"])


def run(name):
    """The names that the notebook leaves, and what its cells show."""
    names, shown = {}, []
    for source in cells(name):
        *body, last = ast.parse(source).body
        assert max(map(len, source.splitlines())) <= 110
        if not isinstance(last, ast.Expr):
            body, last = [*body, last], None
        exec(compile(ast.Module(body, []), name, "exec"), names)
        if last is not None:
            shown.append(eval(compile(ast.Expression(last.value), name, "eval"), names))
    return names, shown


@pytest.mark.slow
def test_orbits(capsys):
    import matplotlib.figure

    names, shown = run("ghosts.ipynb")
    assert sum(len(source.splitlines()) for source in cells("ghosts.ipynb")) < 50
    figures = [value for value in shown if isinstance(value, matplotlib.figure.Figure)]
    assert len(figures) == 4
    for figure in figures:
        assert any(ax.has_data() for ax in figure.axes)
    pair, proved, flux = names["pair"], names["proved"], names["flux"]
    assert pair.minimum.residue < 0 < pair.minimax.residue
    assert proved.flux[0] > 0 and float(proved.flux[0]) == pytest.approx(pair.flux, rel=1e-6)
    assert names["ghost"].label == "minimum" and names["gaps"].max() > 0.01
    assert flux[0.65][-1] < flux[0.65][0] / 1000 and flux[1.0][-1] > flux[1.0][0] / 10
    out = capsys.readouterr().out
    assert "residues" in out and "one negative direction" in out
