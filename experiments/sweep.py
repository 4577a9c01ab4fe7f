"""The onsets (orbits.onset) of many rotation vectors, in a table that a second run continues.

The rows follow the vectors in the order given, whichever process computes them.  So the same
vectors always give the same bytes, and the file is at any time the beginning of the table."""

import concurrent.futures
import contextlib
import csv
import functools
import io
import itertools
import math
import os
import signal

import numpy as np

from converse import ConverseError, orbits
from converse.storage import files

LOST = "lost"                           # in place of a label: continuation has lost the branch
COLUMNS = ("potential", "p", "q", "label", "eps_below", "eps_above", "exponent_below",
           "exponent_above")
AHEAD = 64                              # vectors that are given to the workers ahead


def onsets(potential, vectors, file=None, jobs=None, **how):
    """The onsets of many rotation vectors.

    Parameters
    ----------
    potential : SymplecticMap or Potential
    vectors : sequence of (p, q)
    file : str or path, optional
        A CSV file that grows with every vector.  If the file exists, its rows must be of these
        vectors, and the table continues after them.
    jobs : int, optional
        How many processes work, by default one for each core.
    how
        As of orbits.onset: exponent, step, width and top.

    Returns
    -------
    structured array
        A row for each vector.  eps_below and eps_above enclose the onset; eps_above is inf where
        there is none.  The exponents are the first ones there, and the label is the upper state's.
    """
    types = [[orbits.potential.known(potential).name, " ".join(map(str, p)), str(q)]
             for p, q in vectors]
    with contextlib.ExitStack() as closed:
        lines, out = [_line(COLUMNS)], io.StringIO()
        if file is not None:
            files.check_writable(file, regular=True)
            closed.enter_context(files.Lock(file))
            lines = _finished(file, types) or lines
            files.write(file, "".join(lines).encode())
            out = closed.enter_context(open(file, "a", newline="", encoding="utf-8"))
        begin = len(lines) - 1
        task = functools.partial(_onset, potential, how)
        for each, found in zip(types[begin:], _in_order(task, vectors[begin:], jobs)):
            lines.append(_line([*each, *found]))
            out.write(lines[-1])
            out.flush()
        return table_of("".join(lines))


def table_of(text):
    """The table of a text: an array with the columns' names as its fields, p an array of integers;
    a number that is missing is NaN."""
    _, *rows = csv.reader(io.StringIO(text))
    words = "U%d" % max((len(word) for row in rows for word in row), default=1)
    kinds = [("potential", words), ("p", "i8", (len(rows[0][1].split()) if rows else 1,)),
             ("q", "i8"), ("label", words), *((name, "f8") for name in COLUMNS[4:])]
    return np.array([(name, tuple(map(int, p.split())), int(q), label,
                      *(float(word or "nan") for word in numbers))
                     for name, p, q, label, *numbers in rows], dtype=kinds)


def _line(cells):
    text = io.StringIO(newline="")
    csv.writer(text, lineterminator="\n").writerow(cells)
    return text.getvalue()


def _onset(potential, how, vector):
    """The cells of a row after the type."""
    try:
        below, above = orbits.onset(potential, *vector, **how)
    except ConverseError:
        return LOST, "", "", "", ""
    ends = [(state.eps, state.exponents[0]) if state else (math.inf, math.nan)
            for state in (below, above)]
    return (above or below).label, *(repr(float(x)) for pair in zip(*ends) for x in pair)


def _in_order(task, vectors, jobs):
    """The results, in the order of the vectors; tasks are given ahead to keep the workers busy."""
    executor = concurrent.futures.ProcessPoolExecutor(
        jobs, initializer=signal.signal, initargs=(signal.SIGINT, signal.SIG_IGN))
    try:
        rest = iter(vectors)
        given = [executor.submit(task, vector) for vector in itertools.islice(rest, AHEAD)]
        while given:
            yield given.pop(0).result()
            given += [executor.submit(task, vector) for vector in itertools.islice(rest, 1)]
    finally:
        executor.shutdown(cancel_futures=True)


def _finished(path, types):
    """The whole lines of a file, if there is one.  ConverseError: they are not of these columns and
    types."""
    if not os.path.exists(path):
        return []
    with open(path, encoding="utf-8", errors="replace", newline="") as stream:
        lines = stream.read().splitlines(keepends=True)
    if lines and not lines[-1].endswith("\n"):
        lines.pop()
    starts = [_line(COLUMNS), *(_line(each)[:-1] + "," for each in types)]
    if len(lines) > len(starts) or not all(map(str.startswith, lines, starts)):
        raise ConverseError("%s: is not the beginning of this table; name another file, or remove "
                            "it" % path)
    return lines
