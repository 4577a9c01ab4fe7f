"""Computer-assisted proofs that a four-dimensional symplectic map has no invariant tori.

    import converse
    problem = converse.Problem(a=("0.3072", "0.3097"), b=("0.3072", "0.3097"),
                               c=("0.6145", "0.6195"))
    proof = converse.prove(problem)
    print(proof.report())
"""

import importlib
from typing import TYPE_CHECKING

from .version import __version__

if TYPE_CHECKING:
    from .model.inputs import read_input
    from .model.problem import InputError, Problem
    from .prover.native import Counts
    from .prover.proof import Proof
    from .prover.run import prove
    from .prover.settings import Settings
    from .storage.files import ConverseError

_HOMES = {"ConverseError": "storage.files", "Counts": "prover.native",
          "InputError": "model.problem",
          "Problem": "model.problem", "Proof": "prover.proof", "Settings": "prover.settings",
          "prove": "prover.run", "read_input": "model.inputs"}

__all__ = ["ConverseError", "Counts", "InputError", "Problem", "Proof", "Settings", "__version__",
           "prove", "read_input"]


def __getattr__(name):
    """Imports what is asked for when it is asked for: the checker must run without the C core."""
    if name in _HOMES:
        return getattr(importlib.import_module("." + _HOMES[name], __name__), name)
    raise AttributeError("module 'converse' has no attribute %r" % name)


def __dir__():
    return __all__
