"""Files of states: their points and momenta, and all that a state is made of, as CSV or NPZ.

CSV: a row for each point, doubles as the shortest decimals that give them back.  NPZ: arrays of
numpy, with those names of STORED that depend on a state stacked.  x and momenta are for others to
read; a state is read from its displacements u and its origin, and compared with them.
"""

import csv
import io
import os
import zipfile
import zlib
from typing import Optional, Union

import numpy as np

from ..storage import files
from ..storage.files import ConverseError
from .potential import STUDIED, Potential, known
from .solver import Family
from .state import State

ENDINGS = "csv", "npz"
FORMAT = "states 1"
AGREE = 1e-9                # of x and momenta in a file, and those of the state
ORBIT = ("potential", "p", "q", "eps", "searches", "j")
ARRAYS = "x", "momentum", "u", "origin"
STORED = ("converse", "potential", "p", "q", "eps", "searches", "x", "momentum", "u", "origin")
KINDS = {**dict.fromkeys(STORED, "f"), **dict.fromkeys(("converse", "potential"), "U"),
         **dict.fromkeys(("p", "q", "searches"), "iu")}


def columns(n):
    return (*ORBIT, *("%s_%d" % (name, i + 1) for name in ARRAYS for i in range(n)))


def save(states, path):
    """See State.save."""
    path = os.fspath(path)
    files.check_output(path, "file of points", ENDINGS)
    files.write(path, encoded(states, path))


def encoded(states, path):
    """The bytes of a file of states of one type, CSV or NPZ by the ending of its name.  ValueError:
    they are none, or of several."""
    if len({(id(state.potential), state.p, state.q) for state in states}) != 1:
        raise ValueError("a file holds states of one potential and one type, at least one")
    return (_csv if ending(path) == "csv" else _npz)(states)


def ending(path):
    return os.path.splitext(path)[1][1:].lower()


def _csv(states):
    text = io.StringIO(newline="")
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(columns(states[0].potential.n))
    for state in states:
        head = (state.potential.name, " ".join(map(str, state.p)), state.q, repr(state.eps),
                state.searches)
        origin = tuple(map(repr, state.origin))
        for j, (x, p, u) in enumerate(zip(*(array.tolist() for array in (
                state.x, state.momenta, state.u)))):
            rows.writerow((*head, j, *map(repr, x), *map(repr, p), *map(repr, u), *origin))
    return text.getvalue().encode("utf-8")


def _npz(states):
    data, first = io.BytesIO(), states[0]
    np.savez(data, converse=FORMAT, potential=first.potential.name, p=first.p, q=first.q,
             eps=[state.eps for state in states], searches=[state.searches for state in states],
             x=[state.x for state in states], momentum=[state.momenta for state in states],
             u=[state.u for state in states], origin=[state.origin for state in states])
    return data.getvalue()


def load(path: Union[str, "os.PathLike[str]"], potential: Optional[Potential] = None) -> Family:
    """The Family of states in a file that State.save, Family.save or converse-orbits find --points
    wrote, to the last bit.

    potential -- that of the states, unless it is one with a name of its own (trig, standard, ...)

    ConverseError: the file cannot be read, is none of these, or its momenta are not those of the
    potential."""
    if potential is not None:
        known(potential)
    path = os.fspath(path)
    try:
        with open(path, "rb") as file:
            data = file.read()
    except OSError as error:
        raise ConverseError("%s: cannot be read (%s); name a readable file"
                            % (path, files.reason(error))) from None
    try:
        name, found = (_from_npz if data[:2] == b"PK" else _from_csv)(data)
    except (ValueError, KeyError, IndexError, TypeError, OverflowError, EOFError, csv.Error,
            zipfile.BadZipFile, MemoryError, RuntimeError, zlib.error):
        raise ConverseError("%s: is no file of states, or damaged: name one that find --points or "
                            "save() wrote" % path) from None
    if potential is None:
        potential = STUDIED.get(name)
        if potential is None:
            raise ConverseError("%s: its potential is '%s', which has no name here: give it too "
                                "(potential=)" % (path, files.plain(name)))
    if potential.name != name:
        raise ConverseError("%s: its potential is '%s', not %s" % (path, files.plain(name),
                                                                  potential.name))
    states = []
    for p, q, eps, searches, origin, u, x, momenta in found:
        try:
            states.append(State(potential, p, q, eps, u, origin, searches))
        except ValueError as error:
            raise ConverseError("%s: is damaged: %s" % (path, error)) from None
        away = states[-1].x - x
        if not ((abs(x) < 2) & (np.abs(away - np.round(away)) < AGREE)).all():
            raise ConverseError("%s: its x are not origin + (j p mod q)/q + u: the file was "
                                "changed; a state is made of these" % path)
        if not (np.abs(states[-1].momenta - momenta) < AGREE * (1 + np.abs(momenta))).all():
            raise ConverseError("%s: its momenta are not those of the potential %s at its points: "
                                "it is another potential of this name, or the file was changed"
                                % (path, name))
    return Family(tuple(states))


def _from_npz(data):
    with np.load(io.BytesIO(data), allow_pickle=False) as stored:
        if set(stored.files) != set(STORED) or str(stored["converse"]) != FORMAT:
            raise ValueError
        arrays = {name: stored[name] for name in STORED}
    if any(array.dtype.kind not in KINDS[name] for name, array in arrays.items()):
        raise ValueError
    p, q = tuple(arrays["p"].tolist()), int(arrays["q"])
    m, n = len(arrays["eps"]), len(p)
    if m < 1 or any(arrays[name].shape != (m, q, n) for name in ("x", "momentum", "u")) or \
            arrays["origin"].shape != (m, n) or arrays["searches"].shape != (m,):
        raise ValueError
    return str(arrays["potential"]), [
        (p, q, float(eps), int(searches), tuple(origin.tolist()), u, x, momenta)
        for eps, searches, origin, u, x, momenta in zip(*(arrays[name] for name in (
            "eps", "searches", "origin", "u", "x", "momentum")))]


def _from_csv(data):
    header, *rows = csv.reader(io.StringIO(data.decode("utf-8"), newline=""))
    n = (len(header) - len(ORBIT)) // len(ARRAYS)
    if n not in (1, 2) or tuple(header) != columns(n) or not rows:
        raise ValueError
    found, first = [], rows[0]
    while rows:
        q = int(rows[0][2])
        own, rows = rows[:q], rows[q:]
        head, origin = own[0][:5], own[0][-n:]
        if not len(own) == q >= 1 or head[:3] != first[:3]:
            raise ValueError
        for j, row in enumerate(own):
            if len(row) != len(header) or row[:6] + row[-n:] != [*head, str(j), *origin]:
                raise ValueError
        numbers = np.array([row[6:-n] for row in own], dtype=float)
        found.append((tuple(map(int, head[1].split())), q, float(head[3]), int(head[4]),
                      tuple(map(float, origin)), numbers[:, 2 * n:], numbers[:, :n],
                      numbers[:, n:2 * n]))
    return first[0], found
