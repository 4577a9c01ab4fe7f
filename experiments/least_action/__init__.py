"""Proved bounds of the action of all orbits: of a type by branch and bound, of a rotation vector by
the Lax-Oleinik operator (Mather's beta).

    from least_action import least_action, mather_beta
    found = least_action(orbits.trig, (5, 7), 9, 0.06)          # found.low <= least <= found.high
    mather_beta(orbits.trig, 0.04, (0.56984029, 0.75487767)).low

The first import compiles minplus.c.  experiments/hedlund.py and experiments/minimizing.py are the
commands that use this package.  Actions are those of
angles with period 1, also for a SymplecticMap.
"""

from .action import enclosed_action
from .branch_and_bound import LeastAction, least_action
from .mather import MatherBeta, mather_beta

__all__ = ["LeastAction", "MatherBeta", "enclosed_action", "least_action", "mather_beta"]
