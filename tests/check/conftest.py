import math

import pytest

from checker import check
from truth import TORTURE

BOUNDS = {}             # found by torus_bound in this process, by what was asked


@pytest.fixture(scope="module", autouse=True)
def bounds_once():
    """Bounds B over the torus once where several tests ask for the same."""
    torus_bound = check.torus_bound

    def bound(fixed, waves, corners, most=None):
        key = fixed.bits, tuple(waves), tuple(sorted(set(corners))), most
        if key not in BOUNDS:
            BOUNDS[key] = torus_bound(fixed, waves, corners, most)
        return BOUNDS[key]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(check, "torus_bound", bound)
        yield


@pytest.fixture
def impatient(monkeypatch):
    """Fewer pieces than the checker would try in vain, with shorter orbits: of the fast path, and
    still fewer of the exact one, which halves them as often as ever, but not all of them.  And no
    line of progress that would depend on the clock."""
    monkeypatch.setattr(check, "LINE_SECONDS", math.inf)
    if TORTURE == 1:
        excluded = check.Criterion.excluded

        def few(self, cell):
            with pytest.MonkeyPatch.context() as patch:
                patch.setattr(check, "MAX_PIECES", min(check.MAX_PIECES, 28))
                patch.setattr(check, "MAX_SITES", min(check.MAX_SITES, 30))
                return excluded(self, cell)

        monkeypatch.setattr(check, "MAX_PIECES", 128)
        monkeypatch.setattr(check, "MAX_SITES", 150)
        monkeypatch.setattr(check.Criterion, "excluded", few)
