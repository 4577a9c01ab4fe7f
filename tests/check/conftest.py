import random
from fractions import Fraction

import pytest

from converse import StandardMap, prove, tori
from converse.diagram import Diagram

from checker import check, says_the_same
from truth import TORTURE

BOUNDS = {}             # found by torus_bound in this process, by what was asked


@pytest.fixture(scope="module", autouse=True)
def bounds_once():
    """Bounds B over the torus once where several tests ask for the same."""
    torus_bound = check.torus_bound

    def bound(fixed, waves, corners):
        key = fixed.bits, tuple(waves), tuple(sorted(set(corners)))
        if key not in BOUNDS:
            BOUNDS[key] = torus_bound(fixed, waves, corners)
        return BOUNDS[key]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(check, "torus_bound", bound)
        yield


@pytest.fixture(scope="session")
def diagram():
    """A diagram of the standard map, as text: proofs for two ranges, and the golden circle for
    another."""
    found = Diagram.of(StandardMap((0, 2)))
    for ends in ("1.2", "1.3"), ("1.6", "1.7"):
        found.add(prove(StandardMap(ends)))
    found.add(tori.prove(StandardMap(("0.1", "0.2")), "golden"))
    found.sides["above"] = Fraction("2.5"), (Fraction(1, 2), Fraction(0)), (1, 0)
    return found._text()


@pytest.fixture
def generator(request):
    return random.Random(request.node.name)


@pytest.fixture
def run(tmp_path, capsys):
    """Checks a text or bytes: (status, stdout, stderr).  A short proof file is checked by both
    checkers."""
    def run(data, *options, name="some.proof"):
        path = tmp_path / name
        data = data if isinstance(data, bytes) else data.encode("utf-8")
        path.write_bytes(data)
        status = check.main([*options, str(path)])
        out, err = capsys.readouterr()
        if data.startswith(b"converse proof 6") and len(data) < 20000 and not options:
            assert says_the_same(path, status, err)
        return status, out, err.replace(str(path), "FILE")      # its directory names the test
    return run


@pytest.fixture
def impatient(monkeypatch):
    """Fewer pieces than the checker would try in vain, with shorter orbits: of the fast path, and
    still fewer of the exact one, which halves them as often as ever, but not all of them.  And no
    line of progress that would depend on the clock."""
    monkeypatch.setattr(check, "LINE_SECONDS", 1e9)
    if TORTURE <= 1:
        excluded = check.Criterion.excluded

        def few(self, cell):
            with pytest.MonkeyPatch.context() as patch:
                patch.setattr(check, "MAX_PIECES", min(check.MAX_PIECES, 28))
                patch.setattr(check, "MAX_SITES", min(check.MAX_SITES, 30))
                return excluded(self, cell)

        monkeypatch.setattr(check, "MAX_PIECES", 128)
        monkeypatch.setattr(check, "MAX_SITES", 150)
        monkeypatch.setattr(check.Criterion, "excluded", few)
