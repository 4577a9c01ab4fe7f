"""Computer-assisted proofs that a four-dimensional symplectic map has no invariant tori.

    import converse
    problem = converse.Problem(a=("0.3072", "0.3097"), b=("0.3072", "0.3097"), c=("0.6145", "0.6195"))
    proof = converse.prove(problem)
    print(proof.report())
"""

import importlib
from typing import TYPE_CHECKING

from .version import __version__

if TYPE_CHECKING:
    from . import kernels
    from .core import Counts
    from .files import ConverseError
    from .problem import InputError, Problem, read_input
    from .proof import Proof
    from .run import prove
    from .settings import Settings

_HOMES = {"ConverseError": "files", "Counts": "core", "InputError": "problem",
          "Problem": "problem", "Proof": "proof", "Settings": "settings", "prove": "run",
          "read_input": "problem"}

__all__ = ["ConverseError", "Counts", "InputError", "Problem", "Proof", "Settings", "__version__",
           "kernels", "prove", "read_input"]


def __getattr__(name):
    """Imports what is asked for when it is asked for: the checker must run without the C core."""
    if name == "kernels":
        return importlib.import_module(".kernels", __name__)
    if name in _HOMES:
        return getattr(importlib.import_module("." + _HOMES[name], __name__), name)
    raise AttributeError("module 'converse' has no attribute %r" % name)


def __dir__():
    return __all__
