"""Invariant tori that are graphs: found in doubles, refined, and proved by the checker.

    from converse import StandardMap, tori
    torus = tori.find(StandardMap("0.9"), "golden")
    proof = tori.prove(torus)
"""

from ..storage.methods import absent

try:
    from .certificate import Certificate, read
    from .effort import TimeIsUp
    from .find import NotFound, find
    from .nearest import nearest
    from .proved import NotProved, ProvedTorus, prove
    from .rotation import Rotation, read_rotation
    from .torus import Strip, Torus
except ImportError as _error:           # said when something is asked for: the command needs a line
    __getattr__ = absent("converse.tori needs numpy and python-flint", "tori", _error)

__all__ = ["Certificate", "NotFound", "NotProved", "ProvedTorus", "Rotation", "Strip", "TimeIsUp",
           "Torus", "find", "nearest", "prove", "read", "read_rotation"]
