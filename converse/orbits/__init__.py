"""The orbits that tori leave behind: periodic minimizing orbits of maps of the thesis's chapter 2.

    from converse import orbits
    family = orbits.follow(orbits.trig, (1432, 1897), 2513, [0.0025, 0.005, 0.0075, 0.01])
    print(family[-1].label, family[-1].exponents)

The states of a SymplecticMap have its units, angles of period 2 pi.  The potentials with names have
states with angles of period 1, as in the thesis.  All functions and methods raise ValueError if a
map, a type or a number is not as described.
"""

try:
    from .minimax import Pair
    from .onset import Onset, onset
    from .potential import Potential, froeschle, standard, trig
    from .proved import NotProved, ProvedOrbit, prove
    from .solver import Family, follow, straight
    from .state import PeriodicOrbit
except ImportError as _error:           # raised when a name is used: the command needs a line
    _MISSING = ("converse.orbits needs numpy and the C core (%s); pip install "
                "'converse-kam[orbits]'" % _error)

    def __getattr__(name):
        from ..storage.files import ConverseError
        if name.startswith("__"):
            raise AttributeError(name)
        from ..prover import native  # noqa: F401, which says more if it is the core that is missing
        raise ConverseError(_MISSING)

__all__ = ["Family", "NotProved", "Onset", "Pair", "PeriodicOrbit", "Potential", "ProvedOrbit",
           "follow", "froeschle", "onset", "prove", "standard", "straight", "trig"]
