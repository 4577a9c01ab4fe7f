"""Computer-assisted proofs that a four-dimensional symplectic map has no invariant tori."""

__version__ = "1.0.0"

from . import kernels
from .files import ConverseError
from .problem import InputError, Problem, read_input
from .proof import Proof, prove
from .search import Counts

__all__ = ["ConverseError", "Counts", "InputError", "Problem", "Proof", "kernels", "prove",
           "read_input"]
