"""Tables of the states, or of the onsets, of many rotation vectors.

    python experiments/sweep.py POTENTIAL FILE [EPS ...] --vectors FILE | --farey W0,W1 | --random N

writes a table of the states of many types at each EPS or, without EPS, of the onset of each type
(orbits.onset).  The same command continues a table that was interrupted.

The rows follow the vectors in the order given, whichever worker computes them.  So the same sweep
always gives the same bytes.  Its file is at any time the beginning of the table.
"""

import argparse
import concurrent.futures
import contextlib
import csv
import functools
import io
import itertools
import math
import os
import random
import signal
import sys

import farey
import numpy as np

from converse import ConverseError, orbits
from converse.commands.common import ended
from converse.commands.orbits import AT, _check_type, _eps, _value, _vector, read_potential
from converse.storage import files

COLUMNS = ("potential", "p", "q", "eps", "label", "action", "shadow", "grad_size", "exponent_1",
           "exponent_2", "deviation_point", "deviation_start", "undetermined")
LOST = "lost"                           # in place of a label: continuation has lost the branch
ONSET_COLUMNS = ("potential", "p", "q", "label", "eps_below", "eps_above", "exponent_below",
                 "exponent_above")
AHEAD = 64                              # vectors that are given to the workers ahead


def row(state):
    """Of a table, in the order of COLUMNS."""
    exponents = [repr(float(x)) for x in state.exponents] + [""] * (2 - state.potential.n)
    return [state.potential.name, " ".join(map(str, state.p)), state.q, repr(state.eps),
            state.label, repr(state.action), repr(state.shadow), repr(state.grad_size), *exponents,
            *map(repr, state.deviation), state.undetermined]


def sweep(potential, vectors, eps, executor=None, file=None, progress=None, jobs=None):
    """The families of many rotation vectors.

    Parameters
    ----------
    potential : SymplecticMap or Potential
    vectors : sequence of (p, q)
    eps : sequence of float
        For each vector the states at these.
    executor : concurrent.futures.Executor, optional
        By default processes of this machine work.
    file : str or path, optional
        A CSV file that grows with every vector.  If the file exists, its rows must be of these
        vectors and eps, and the sweep continues after them.
    progress : callable, optional
        progress(done, of) is called with the number of vectors that are finished.
    jobs : int, optional
        How many processes work, by default one for each core.

    Returns
    -------
    structured array
        A row for each vector and eps, whose fields have the names of the columns.  Where
        continuation loses a branch, the rest of its rows has the label "lost" and no numbers.
    """
    return _sweep(functools.partial(_family, potential, eps), COLUMNS, potential, vectors,
                  [[repr(x)] for x in eps], executor, file, progress, jobs)


def onsets(potential, vectors, executor=None, file=None, progress=None, jobs=None, **how):
    """The onsets of many rotation vectors.

    Parameters
    ----------
    potential, vectors, executor, file, progress, jobs
        As of sweep().
    how
        As of orbits.onset: exponent, step, width and top.

    Returns
    -------
    structured array
        A row for each vector.  eps_below and eps_above enclose the onset; eps_above is inf where
        there is none.  The exponents are the first ones there, and the label is the upper state's.
    """
    return _sweep(functools.partial(_onset, potential, how), ONSET_COLUMNS, potential, vectors,
                  [[]], executor, file, progress, jobs)


def table_of(text):
    """The table of a text: an array with the columns' names as its fields, p an array of integers;
    a number that is missing is NaN.  ValueError: the text is another."""
    header, *rows = csv.reader(io.StringIO(text))
    if tuple(header) not in (COLUMNS, ONSET_COLUMNS) or any(len(row) != len(header)
                                                            for row in rows):
        raise ValueError("no such columns")
    words = "U%d" % max((len(word) for row in rows for word in row), default=1)
    n = len(rows[0][header.index("p")].split()) if rows else 1
    kinds = {"potential": (str, words), "label": (str, words), "q": (int, "i8"),
             "p": (lambda word: tuple(map(int, word.split())), ("i8", (n,))),
             "undetermined": (int, "i8")}
    read, kind = zip(*(kinds.get(name, (lambda word: float(word or "nan"), "f8"))
                       for name in header))
    return np.array([tuple(convert(word) for convert, word in zip(read, row)) for row in rows],
                    dtype=list(zip(header, kind)))


def _text(rows):
    text = io.StringIO(newline="")
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue()


def _type(potential, vector):
    return [orbits.potential.known(potential).name, " ".join(map(str, vector[0])), vector[1]]


def _family(potential, eps, vector):
    states = []
    with contextlib.suppress(ConverseError):
        orbits.follow(potential, *vector, eps, progress=lambda _, state: states.append(state))
    lost = [[*_type(potential, vector), repr(x), LOST] + [""] * (len(COLUMNS) - 6) + [0]
            for x in eps[len(states):]]
    return _text([*map(row, states), *lost])


def _onset(potential, how, vector):
    try:
        below, above = orbits.onset(potential, *vector, **how)
    except ConverseError:
        found = LOST, "", "", "", ""
    else:
        ends = [(state.eps, state.exponents[0]) if state else (math.inf, math.nan)
                for state in (below, above)]
        found = (above or below).label, *(repr(float(x)) for pair in zip(*ends) for x in pair)
    return _text([[*_type(potential, vector), *found]])


def _sweep(task, columns, potential, vectors, eps, executor, file, progress, jobs):
    """Does all tasks.  eps: for each row of a vector, the cells that follow its type."""
    texts, tell = [_text([columns])], progress or (lambda *_: None)
    with contextlib.ExitStack() as closed:
        out = io.StringIO()
        if file is not None:
            files.check_writable(file, regular=True)
            closed.enter_context(files.Lock(file))
            texts += _finished(file, texts[0], potential, vectors, eps)
            files.write(file, "".join(texts).encode())
            out = closed.enter_context(open(file, "a", newline="", encoding="utf-8"))
        tell(len(texts) - 1, len(vectors))
        for text in _in_order(task, vectors[len(texts) - 1:], executor, jobs):
            texts.append(text)
            out.write(text)
            out.flush()
            tell(len(texts) - 1, len(vectors))
        return table_of("".join(texts))


def _in_order(task, vectors, executor, jobs):
    """The results, in the order of the vectors; tasks are given ahead to keep the workers busy."""
    own = executor is None
    if own:
        executor = concurrent.futures.ProcessPoolExecutor(
            jobs, initializer=signal.signal, initargs=(signal.SIGINT, signal.SIG_IGN))
    try:
        rest = iter(vectors)
        given = [executor.submit(task, vector) for vector in itertools.islice(rest, AHEAD)]
        while given:
            yield given.pop(0).result()
            given += [executor.submit(task, vector) for vector in itertools.islice(rest, 1)]
    finally:
        if own:
            executor.shutdown(cancel_futures=True)


def _finished(path, header, potential, vectors, eps):
    """The texts of the vectors that a file has, whole ones only.  ConverseError if its rows are not
    of these columns, vectors and eps."""
    if not os.path.exists(path):
        return []
    with open(path, "rb") as stream:
        lines = stream.read().decode("utf-8", "replace").split("\n")

    def refuse(why):
        raise ConverseError("%s: is not the beginning of this sweep: %s; name another file, or "
                            "remove it" % (path, why))

    lines, torn = [line + "\n" for line in lines[:-1]], lines[-1]
    if not lines and header.startswith(torn):
        return []
    if lines[:1] != [header]:
        refuse("its columns are others")
    rows = lines[1:]
    if len(rows) > len(eps) * len(vectors):
        refuse("it has more rows")
    for k, line in enumerate(rows):
        key = _type(potential, vectors[k // len(eps)]) + eps[k % len(eps)]
        if not line.startswith(_text([key])[:-1] + ","):
            refuse("its line %d is of another potential, type or eps" % (k + 2))
    try:
        table_of("".join([header, *rows]))
    except (ValueError, IndexError, csv.Error):
        refuse("it is damaged")
    return ["".join(rows[k:k + len(eps)]) for k in range(0, len(rows) - len(eps) + 1, len(eps))]


# ---- the command

def vectors_of(options, potential):
    """The rotation vectors: from a file, along the Farey tree or triangle, or random."""
    low, high = options.sizes
    if options.vectors is not None:
        with open(options.vectors, encoding="utf-8") as file:
            lines = [line.partition("#")[0].strip() for line in file]
        try:
            return [_check_type(potential, _vector(line)) for line in lines if line]
        except ValueError as error:
            raise ConverseError("%s: %s" % (options.vectors, error)) from None
    if options.farey is not None:
        mediants = farey.triangle(options.farey) if potential.n == 2 else farey.tree(*options.farey)
        return [(each.p, each.q) for each in itertools.takewhile(lambda each: each.q <= high,
                                                                 mediants) if each.q >= low]
    rng, vectors, tries = random.Random(options.seed), [], 0
    while len(vectors) < options.random:
        q = rng.randint(low, high)
        p = tuple(rng.randrange(q) for _ in range(potential.n))
        tries += 1
        if math.gcd(*p, q) == 1 or tries > 100 * options.random:
            vectors.append((p, q))
    return vectors


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("potential", metavar="POTENTIAL")
    parser.add_argument("csv", metavar="FILE")
    parser.add_argument("eps", metavar="EPS", type=_eps, nargs="*", default=[])
    parser.add_argument("--at", type=_value, metavar="NAME=VALUE", action="append", default=[],
                        help=AT)
    which = parser.add_mutually_exclusive_group(required=True)
    which.add_argument("--vectors", metavar="FILE", help="types from a file, one in each line")
    which.add_argument("--farey", metavar="W0,W1", type=lambda text: text.split(","),
                       help="the mediants of the Farey triangles (one angle: intervals) that "
                       "contain these numbers, exactly")
    which.add_argument("--random", type=int, metavar="N", help="N random types")
    parser.add_argument("--sizes", type=lambda text: tuple(map(int, text.split(":"))),
                        default=(300, 1200), metavar="LOW:HIGH", help="of q (300:1200)")
    parser.add_argument("--seed", type=int, default=0, help="of --random (0)")
    parser.add_argument("--jobs", type=int, help="processes (default: one per core)")
    options = parser.parse_args(argv)

    def run():
        potential = read_potential(options.potential, options.at)
        vectors = vectors_of(options, potential)
        common = {"file": options.csv, "jobs": options.jobs}
        eps = [x for each in options.eps for x in each]
        table = sweep(potential, vectors, eps, **common) if eps else \
            onsets(potential, vectors, **common)
        lost = int((table["label"] == LOST).sum())
        print("written: %s, %d types, %d rows%s" % (
            options.csv, len(vectors), len(table), ", %d of them lost" % lost if lost else ""))
        return int(lost > 0)

    return ended("sweep.py", run, lambda: "the same command continues it")


if __name__ == "__main__":
    sys.exit(main())
