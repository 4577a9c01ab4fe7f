"""The orbits that tori leave behind: periodic minimizing orbits of maps of the thesis's chapter 2.

    from converse import orbits
    family = orbits.follow(orbits.trig, (1432, 1897), 2513, [0.0025, 0.005, 0.0075, 0.01])
    print(family[-1].label, family[-1].exponents)

The states of a SymplecticMap have its units, angles of period 2 pi.  The potentials with names have
states with angles of period 1, as in the thesis.  All functions and methods raise ValueError if a
map, a type or a number is not as described.
"""

from ..storage.files import ConverseError
from ..storage.methods import absent

try:
    from .minimax import Pair
    from .onset import Onset, onset
    from .potential import Potential, froeschle, standard, trig
    from .proved import NotProved, ProvedOrbit, prove
    from .solver import Family, follow, straight
    from .state import PeriodicOrbit
except (ImportError, ConverseError) as _error:      # said when something is asked for
    __getattr__ = absent("converse.orbits needs numpy", "orbits", _error)

__all__ = ["Family", "NotProved", "Onset", "Pair", "PeriodicOrbit", "Potential", "ProvedOrbit",
           "follow", "froeschle", "onset", "prove", "standard", "straight", "trig"]
