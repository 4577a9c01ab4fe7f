"""Proofs in ball arithmetic, whose precision is one number for all threads."""

import sys
import threading

import pytest
from flint import ctx

from converse import Problem, orbits, tori
from converse.model.balls import precision
from converse.model.map import SymplecticMap


@pytest.mark.slow
def test_proofs_side_by_side(monkeypatch):
    """Tori and orbits in threads of one process: each proof is what it is alone, whatever the user
    has set, and that is set again afterwards."""
    golden = tori.read_rotation("golden")
    torus = tori.find(Problem(SymplecticMap([(1, 0)], ["0.8"])), golden)
    state = orbits.follow(orbits.standard, (3,), 8, [0.5])[0]

    def of_torus():
        piece, = tori.prove(torus).pieces
        return piece.residual, piece.needed, piece.distance, piece.modes, piece.bits

    def of_orbit():
        orbit = orbits.prove(state, 40)
        return orbit.radius, orbit.action, orbit.exponents, orbit.displacements

    kinds = [of_torus, of_orbit]
    alone = [kind() for kind in kinds]
    monkeypatch.setattr(ctx, "prec", 20)
    assert [kind() for kind in kinds] == alone and ctx.prec == 20
    found = [None] * 6

    def work(n):
        found[n] = kinds[n % 2]()

    interval = sys.getswitchinterval()
    sys.setswitchinterval(1e-5)
    try:
        threads = [threading.Thread(target=work, args=(n,)) for n in range(6)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    finally:
        sys.setswitchinterval(interval)
    assert found == 3 * alone and ctx.prec == 20


def test_a_precision_inside_another(monkeypatch):
    monkeypatch.setattr(ctx, "prec", 77)
    with precision():
        assert ctx.prec == 53
        with precision(200):
            assert ctx.prec == 200
        assert ctx.prec == 53
    assert ctx.prec == 77
