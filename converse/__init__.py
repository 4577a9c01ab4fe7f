"""Computer-assisted proofs about invariant tori of symplectic maps: where they end, where they are.

    import converse
    proof = converse.prove(converse.StandardMap("0.99"))
    print(proof.report())
    torus = converse.tori.prove(converse.StandardMap("0.9"), "golden")
"""

from . import results  # noqa: F401
from .version import __version__

TYPE_CHECKING = False           # as in typing, whose import would delay the handlers of signals
if TYPE_CHECKING:
    from . import check, diagram, orbits, tori
    from .model.inputs import read_input
    from .model.map import FourierMap, FroeschleMap, MuldoonMap, StandardMap, SymplecticMap
    from .model.problem import InputError, Problem
    from .prover.native import Counts
    from .prover.portrait import Portrait, portray
    from .prover.proof import Proof, Tree
    from .prover.run import prove
    from .prover.settings import Settings
    from .storage.files import ConverseError

_HOMES = {"ConverseError": "storage.files", "Counts": "prover.native",
          "FourierMap": "model.map", "FroeschleMap": "model.map", "InputError": "model.problem",
          "MuldoonMap": "model.map", "Portrait": "prover.portrait", "Problem": "model.problem",
          "Proof": "prover.proof",
          "Settings": "prover.settings", "StandardMap": "model.map", "SymplecticMap": "model.map",
          "Tree": "prover.proof", "portray": "prover.portrait", "prove": "prover.run",
          "read_input": "model.inputs"}
_ROOMS = "check", "diagram", "orbits", "tori"

__all__ = ["ConverseError", "Counts", "FourierMap", "FroeschleMap", "InputError", "MuldoonMap",
           "Portrait", "Problem", "Proof", "Settings", "StandardMap", "SymplecticMap", "Tree",
           "__version__", "check", "diagram", "orbits", "portray", "prove", "read_input", "tori"]


def __getattr__(name):
    """Imports what is asked for when it is asked for: the checker must run without the C core."""
    import importlib

    if name in _ROOMS:
        return importlib.import_module("." + name, __name__)
    if name in _HOMES:
        return getattr(importlib.import_module("." + _HOMES[name], __name__), name)
    raise AttributeError("module 'converse' has no attribute %r" % name)


def __dir__():
    return __all__
