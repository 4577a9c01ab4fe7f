"""The thesis's prelude: its two eps_c, and the first step of the sharper method."""

import numpy as np
import pytest
from thesis.potentials import ff, poly
from thesis.prelude import prelude

import converse
from converse import Problem, orbits
from converse.model.map import MuldoonMap


@pytest.mark.parametrize("potential, numbers", [
    (orbits.trig, (0.0385586, 0.0377680, 0.025179)), (poly, (1 / 24, 1 / 48, 0.010545)),
    (ff, (1 / 30, 1 / 30, 0.020962)),
    (orbits.froeschle, (2 / 49.3480, 2 / 49.3480, 0.025487)),
    (orbits.standard, (2, 2, 4 / 3))], ids=str)
def test_prelude(potential, numbers):
    """The thesis's two eps_c; above the second and the third no state and no torus goes
    everywhere."""
    found = prelude(potential)
    assert found[:2] == pytest.approx(numbers[:2], abs=1e-7)
    assert found.graphs == pytest.approx(numbers[2], abs=6e-7)
    assert found.graphs < found.worst <= found.lowest * (1 + 1e-12)


def test_prelude_is_the_other_method_s_first_step():
    """Without a single cut the Loewner criterion proves what the prelude says, and bounds 2 - eps
    V'' by the same number."""
    bound = prelude(orbits.trig).graphs
    for eps, proved in ((1.004 * bound, True), (0.9996 * bound, False)):
        a = 2 * np.pi ** 2 * orbits.trig.scale * eps
        proof = converse.prove(Problem(MuldoonMap(*map(repr, (a, a, 2 * a)))), method="loewner",
                               depth=0)
        assert proof.no_tori == proved
        largest = 2 - eps * np.linalg.eigvalsh(orbits.trig.evaluate(
            np.full((1, 2), 1 - 0.131738))[2])[0, 0]
        assert float(proof.constants["B"]) == pytest.approx(largest, abs=1e-6)
