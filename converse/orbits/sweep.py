"""Sweeps over many rotation vectors: their families, and the onsets of their orbits.

The rows of a sweep follow its vectors in the order given, whichever worker computes them.  So the
same sweep always gives the same bytes.  Its file is at any time the beginning of the table, and an
interrupted sweep continues after the rows of the file.
"""

import concurrent.futures
import contextlib
import csv
import functools
import io
import math
import os
import threading
from typing import Any, Callable, NamedTuple, Optional, Sequence, Tuple, Union

import numpy as np

from ..prover.workers import LOOK_SECONDS, WorkerPool, WorkersGone
from ..storage import files
from ..storage.files import ConverseError
from ..storage.signals import interruptible
from .limits import (MAX_EPS_STEPS, MAX_ONSET_GRADIENT, MAX_ONSET_HALVINGS, MAX_ONSET_STEPS,
                     MAX_PIVOTS, ONSET_TIMES_CURVATURE, TASKS_PER_WORKER)
from .potential import Numerators, Source, finite, known, obey, told
from .solver import COLUMNS, follow, reached, row, straight
from .state import PeriodicOrbit, type_of

LOST = "lost"                           # in place of a label: continuation has lost the branch

ONSET_COLUMNS = ("potential", "p", "q", "label", "eps_below", "eps_above", "exponent_below",
                 "exponent_above")
TABLELESS = ValueError, IndexError, csv.Error       # raised by _table for any other text


# ---- onsets

Type = Tuple[Tuple[int, ...], int]


class Onset(NamedTuple):
    """The states on both sides of an onset.

    Attributes
    ----------
    below : PeriodicOrbit
        The last state below the onset.
    above : PeriodicOrbit or None
        The first state above the onset; None if none was found.
    """

    below: PeriodicOrbit
    above: Optional[PeriodicOrbit]


def onset(potential: Source, p: Numerators, q: int, exponent: Optional[float] = None,
          step: Optional[float] = None, width: Optional[float] = None,
          top: Optional[float] = None) -> Onset:
    """The onset of the orbit of type (p, q) that continuation from eps 0 follows.

    Above its onset the orbit is a minimum whose first Lyapunov exponent, the largest, exceeds
    `exponent`.  (Minima are usually hyperbolic before their onset, with exponents that may be far
    below what doubles see; prove() encloses them.)

    Parameters
    ----------
    potential : SymplecticMap or Potential
    p : int or sequence of int, shape (n,)
    q : int
    exponent : float, optional
        Per iterate; by default 1/q, so that one period stretches e-fold.
    step : float, optional
        Of eps: the steps with which the first such minimum is looked for.
    width : float, optional
        To this difference of eps the onset is cut down.
    top : float, optional
        The eps where the search ends.  Defaults of these three are ONSET_TIMES_CURVATURE divided by
        potential.curvature, to one digit.

    Returns
    -------
    Onset
        The states below and above; their eps are at most `width` apart.

    Raises
    ------
    ValueError
        The exponent is too small for doubles to show.
    ConverseError
        Continuation loses the branch.

    Notes
    -----
    With growing q the stretching along the orbits beside a smooth torus vanishes, and beside the
    remnants of a torus it grows.  At break-up it does neither.  For the golden torus of
    the standard map (Greene: residue -1/4) it is e^0.96.  So the onsets of approximants tend to
    where the torus breaks up: there they are within 3e-4 for q >= 233.  An exponent that is the
    same for all q is early for small and late for large ones.  Onsets are evidence, not proof, that
    a torus is near an orbit, or that none is.
    """
    potential = known(potential)
    step, width, top = finite("step, width and top", [
        float("%.0e" % (x / (potential.curvature or 1))) if y is None else y
        for x, y in zip(ONSET_TIMES_CURVATURE, (step, width, top))])
    if not (0 < width <= step and 0 < top <= MAX_EPS_STEPS * step):
        raise ValueError("step, width and top are positive, the width at most the step, and the "
                         "top at most %d steps, not %r, %r, %r"
                         % (MAX_EPS_STEPS, step, width, top))
    q = straight(potential, p, q).q
    limit, = finite("exponent", [1 / q if exponent is None else exponent])
    if not limit >= 2 / max(MAX_PIVOTS, 5 * q):
        raise ValueError("an exponent of %r is too small to be seen" % limit)
    below, above, k = straight(potential, p, q), None, 0
    while above is None or above.eps - below.eps > width:
        if above is None:
            if below.eps >= top:
                break
            k += 1
            eps = min(k * step, top)
        else:
            eps = (below.eps + above.eps) / 2
            if not below.eps < eps < above.eps:         # no double is between them
                break
        state = _further(below, eps)
        if state.exponents[0] > limit and state.label == "minimum":
            above = state
        else:
            below = state
    return Onset(below, above)


def _further(state, eps, halvings=MAX_ONSET_HALVINGS):
    """The state at a larger eps, in smaller steps if the solver fails."""
    try:
        return state.relax(eps, tol=MAX_ONSET_GRADIENT, max_steps=MAX_ONSET_STEPS)
    except ConverseError:
        if not halvings:
            raise
    middle = _further(state, (state.eps + eps) / 2, halvings - 1)
    return _further(middle, eps, halvings - 1)


# ---- sweeps

def sweep(potential: Source, vectors: Sequence[Type], eps: Union[float, Sequence[float]],
          executor: Optional[concurrent.futures.Executor] = None,
          file: Union[str, "os.PathLike[str]", None] = None,
          progress: Optional[Callable[[int, int], object]] = None,
          jobs: Optional[int] = None) -> np.ndarray:
    """The families of many rotation vectors.

    Parameters
    ----------
    potential : SymplecticMap or Potential
    vectors : sequence of (p, q)
    eps : float or sequence of float
        For each vector the states at these.
    executor : concurrent.futures.Executor, optional
        By default threads of this process work.
    file : str or path, optional
        A CSV file that grows with every vector.  If the file exists, its rows must be of these
        vectors and eps, and the sweep continues after them.
    progress : callable, optional
        progress(done, of) is called with the number of vectors that are finished.
    jobs : int, optional
        How many threads work, by default one for each core.

    Returns
    -------
    structured array
        A row for each vector and eps, whose fields have the names of the columns.  Where
        continuation loses a branch, the rest of its rows has the label "lost" and no numbers.

    Raises
    ------
    ConverseError
        The file cannot be written, or is not the beginning of this sweep.
    """
    values = finite("eps", eps)
    potential = known(potential)
    reached(potential, values)
    if not values:
        raise ValueError("eps is a list of finite numbers, one at least, not %r" % (eps,))
    return _sweep(functools.partial(_family, potential, values), COLUMNS, potential, vectors,
                  [[repr(x)] for x in values], executor, file, progress, jobs)


def onsets(potential: Source, vectors: Sequence[Type],
           executor: Optional[concurrent.futures.Executor] = None,
           file: Union[str, "os.PathLike[str]", None] = None,
           progress: Optional[Callable[[int, int], object]] = None,
           jobs: Optional[int] = None, **how: Any) -> np.ndarray:
    """The onsets of many rotation vectors.

    Parameters
    ----------
    potential, vectors, executor, file, progress, jobs
        As of sweep().
    how
        As of onset(): exponent, step, width and top.

    Returns
    -------
    structured array
        A row for each vector.  eps_below and eps_above enclose the onset; eps_above is inf where
        there is none.  The exponents are the first ones there, and the label is the upper state's.
    """
    potential = known(potential)
    return _sweep(functools.partial(_onset, potential, how), ONSET_COLUMNS, potential, vectors,
                  [[]], executor, file, progress, jobs)


def _table(text):
    """The table of a text: an array with the columns' names as its fields, p an array of integers;
    a number that is missing is NaN.  An exception of TABLELESS: the text is another."""
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
    return [potential.name, " ".join(map(str, vector[0])), vector[1]]


def _family(potential, eps, vector):
    states = []
    with contextlib.suppress(ConverseError):
        follow(potential, *vector, eps, progress=lambda _, state: states.append(state))
    lost = [[*_type(potential, vector), repr(x), LOST] + [""] * (len(COLUMNS) - 6) + [0]
            for x in eps[len(states):]]
    return _text([*map(row, states), *lost])


def _onset(potential, how, vector):
    try:
        below, above = onset(potential, *vector, **how)
    except ConverseError:
        found = LOST, "", "", "", ""
    else:
        ends = [(state.eps, state.exponents[0]) if state else (math.inf, math.nan)
                for state in (below, above)]
        found = (above or below).label, *(repr(float(x)) for pair in zip(*ends) for x in pair)
    return _text([[*_type(potential, vector), *found]])


def _sweep(task, columns, potential, vectors, eps, executor, file, progress, jobs):
    """Does all tasks.  eps: for each row of a vector, the cells that follow its type."""
    told(progress)
    if executor is not None and not hasattr(executor, "submit"):
        raise TypeError("the executor is a concurrent.futures.Executor, not %r" % (executor,))
    try:
        vectors = [_vector(potential, vector) for vector in vectors]
    except TypeError:
        raise ValueError("the rotation vectors are a list of pairs (p, q), not %r"
                         % (vectors,)) from None
    texts, tell = [_text([columns])], progress or (lambda *_: None)
    with contextlib.ExitStack() as closed:
        closed.enter_context(interruptible())
        out = None
        if file is not None:
            files.check_writable(file, regular=True)
            closed.enter_context(files.Lock(file))
            texts += _finished(file, texts[0], potential, vectors, eps)
            out = closed.enter_context(
                contextlib.closing(files.AppendedFile(file, "".join(texts))))
        tell(len(texts) - 1, len(vectors))
        results = closed.enter_context(
            contextlib.closing(_in_order(task, vectors[len(texts) - 1:], executor, jobs)))
        for text in results:
            texts.append(text)
            if out is not None:
                out.append(text)
            tell(len(texts) - 1, len(vectors))
        return _table("".join(texts))


def _vector(potential, vector):
    try:
        p, q = vector
    except (TypeError, ValueError):
        raise ValueError("a rotation vector is a pair (p, q), not %r" % (vector,)) from None
    return type_of(potential, p, q)


def _in_order(task, vectors, executor, jobs):
    """The results, in the order of the vectors; tasks are given ahead to keep the workers busy."""
    given, results = 0, {}
    try:
        with WorkerPool(executor, jobs, threading.Event()) as pool:
            for wanted in range(len(vectors)):
                while wanted not in results:
                    room = TASKS_PER_WORKER * pool.size - len(pool.running) - len(results)
                    for key in range(given, min(given + room, len(vectors))):
                        pool.give(key, _caught, task, vectors[key])
                        given = key + 1
                    results.update(pool.take(LOOK_SECONDS))
                result = results.pop(wanted)
                if isinstance(result, Exception):
                    raise result
                yield result
    except WorkersGone as error:
        raise WorkersGone("%s; what was finished is kept, try again" % error) from None


def _caught(task, vector, stop=None):
    """The result of the task or the exception that it raises: such a failure would happen again,
    unlike the death of a worker.  stop: of the threads of this process."""
    obey(stop)
    try:
        return task(vector)
    except Exception as error:
        return error


def _finished(path, header, potential, vectors, eps):
    """The texts of the vectors that a file has, whole ones only.  ConverseError if its rows are not
    of these columns, vectors and eps."""
    try:
        with open(path, "rb") as stream:
            lines = stream.read().decode("utf-8", "replace").split("\n")
    except FileNotFoundError:
        return []
    except OSError as error:
        raise ConverseError("%s: cannot be read (%s)" % (path, files.reason(error))) from None

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
        _table("".join([header, *rows]))
    except TABLELESS:
        refuse("it is damaged")
    return ["".join(rows[k:k + len(eps)]) for k in range(0, len(rows) - len(eps) + 1, len(eps))]
