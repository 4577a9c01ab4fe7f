"""Files of states: all that a state is made of, and its points and momenta, as arrays of NumPy.

The arrays of states of one type are stacked.  A state is made of its displacements u and its
origin; x and momenta are for others to read.
"""

import io
import os

import numpy as np

from ..storage import files

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
