"""Files of states: all that a state is made of, and its points and momenta, as arrays of NumPy.

The arrays of states of one type are stacked.  A state is made of its displacements u and its
origin; x and momenta are for others to read.
"""

import io
import os
import zipfile
import zlib

import numpy as np

from ..storage import files
from ..storage.files import ConverseError
from .potential import STUDIED, known
from .solver import Family
from .state import PeriodicOrbit

ENDINGS = ("npz",)
FORMAT = "states 2"


def save(states, path):
    """See PeriodicOrbit.save.  ValueError: there are no states, or they are of several types."""
    path = os.fspath(path)
    files.check_output(path, "file of points", ENDINGS)
    if len({(state.potential.name, state.p, state.q) for state in states}) != 1:
        raise ValueError("a file holds states of one potential and one type, at least one")
    data, first = io.BytesIO(), states[0]
    np.savez(data, converse=FORMAT, potential=first.potential.name, p=first.p, q=first.q,
             eps=[state.eps for state in states], x=[state.x for state in states],
             momentum=[state.momenta for state in states],
             u=[state.u for state in states], origin=[state.origin for state in states])
    files.write(path, data.getvalue())


def load(path, potential=None):
    """See Family.load."""
    if potential is not None:
        potential = known(potential)
    path = os.fspath(path)
    try:
        with open(path, "rb") as file:
            data = file.read()
    except OSError as error:
        raise ConverseError("%s: cannot be read (%s); name a readable file"
                            % (path, files.reason(error))) from None
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as stored:
            if str(stored["converse"]) != FORMAT:
                raise ValueError
            name = str(stored["potential"])
            p, q = tuple(int(x) for x in stored["p"]), int(stored["q"])
            found = [(float(eps), u.astype(float, casting="same_kind"),
                      tuple(map(float, origin)))
                     for eps, u, origin in zip(*(stored[key] for key in ("eps", "u", "origin")))]
    except (ValueError, KeyError, IndexError, TypeError, OverflowError, EOFError,
            zipfile.BadZipFile, MemoryError, RuntimeError, zlib.error):
        found = []
    if not found:
        raise ConverseError("%s: is not a file of states, or damaged: name one that --points "
                            "or save() wrote" % path)
    if potential is None:
        potential = STUDIED.get(name)
        if potential is None:
            raise ConverseError("%s: its potential is '%s', which has no name here: give it too "
                                "(potential=)" % (path, files.plain(name)))
    if potential.name != name:
        raise ConverseError("%s: its potential is '%s', not %s" % (path, files.plain(name),
                                                                  potential.name))
    try:
        return Family(tuple(PeriodicOrbit(potential, p, q, eps, u, origin)
                            for eps, u, origin in found))
    except ValueError as error:
        raise ConverseError("%s: is damaged: %s" % (path, error)) from None
