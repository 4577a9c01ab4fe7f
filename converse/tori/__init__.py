"""Invariant tori that are graphs: found in doubles, proved in ball arithmetic.

    from converse import tori
    rotation = tori.read_rotation("golden", 1)
"""

try:
    from .divisors import Divisors, Norm, lattice_basis
    from .near import near
    from .rotation import Rotation, read_rotation
except ImportError as _error:           # said when something is asked for: the command needs a line
    _MISSING = ("converse.tori needs numpy and python-flint (%s); pip install 'converse-kam[tori]'"
                % _error)

    def __getattr__(name):
        from ..storage.files import ConverseError
        if name.startswith("__"):
            raise AttributeError(name)
        raise ConverseError(_MISSING)

__all__ = ["Divisors", "Norm", "Rotation", "lattice_basis", "near", "read_rotation"]
