import pytest

from checker import check

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
