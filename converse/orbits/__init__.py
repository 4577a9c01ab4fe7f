"""The orbits that tori leave behind: periodic minimizing orbits of maps of the thesis's chapter 2.

    from converse import orbits
    family = orbits.follow(orbits.trig, (1432, 1897), 2513, [0.0025, 0.005, 0.0075, 0.01])
    print(family[-1].label, family[-1].exponents)

The torus has period 1 here, 2 pi in the rest of the package; potential.parameters converts.
"""

try:
    import numpy  # noqa: F401
except ImportError:
    from ..files import ConverseError
    raise ConverseError("converse.orbits needs numpy; pip install 'converse-kam[orbits]'") from None

from .measures import Prelude, gram_schmidt_exponents, prelude
from .potential import (Fourier, FromPython, Potential, ff, froeschle, parameters, poly, standard,
                        trig)
from .solver import Family, flow, follow, newton, straight
from .state import State

__all__ = ["Family", "Fourier", "FromPython", "Potential", "Prelude", "State", "ff", "flow",
           "follow", "froeschle", "gram_schmidt_exponents", "newton", "parameters", "poly",
           "prelude", "standard", "straight", "trig"]
