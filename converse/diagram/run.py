"""explore(): one run of the search, which adds to a diagram."""

import concurrent.futures
import math
import os
from typing import Callable, Optional

from ..model.exact import Number, exact
from ..model.map import SymplecticMap
from ..prover.resume import check_release
from ..prover.workers import Filling, WorkerPool
from ..storage.backup import Backup
from ..storage.files import ConverseError, Path
from ..storage.signals import interruptible
from . import cells, line
from .sides import sides_of
from .value import POINTS_A_SECOND, Diagram

BUDGET = 300                            # seconds of one core, about


def explore(family: Optional[SymplecticMap] = None, *, path: Optional[Path] = None,
            resume: bool = False, budget: Number = BUDGET, jobs: Optional[int] = None,
            executor: Optional[concurrent.futures.Executor] = None, time_limit: float = math.inf,
            tell: Optional[Callable[[str], None]] = None,
            progress: Optional[Callable[[Diagram], None]] = None) -> Diagram:
    """Looks for proofs along one or two parameters of a family of maps.

    Parameters
    ----------
    family
        A map with one or two parameters that have a range.  With resume it may be left out.
    path
        The file that keeps the diagram: a new file or, with resume, the file of the diagram to
        continue.  None: there is none.
    resume
        Whether the diagram of the file is continued.
    budget
        Of the work of all runs together, in seconds of one core, about: it stands for
        POINTS_A_SECOND points of orbits a second.  So the result does not depend on the machine's
        speed; the modes of a torus may differ by some per cent between processors.
    jobs, executor
        The number of tasks at a time, by default one per core; the executor that works on them, by
        default threads of this process.  The result does not depend on them.
    time_limit
        The search ends after about this number of seconds on the clock.
    tell
        tell(text) is called with a line about each proof as soon as it is found.
    progress
        progress(diagram) is called a few times a second.

    Returns
    -------
    Diagram

    Raises
    ------
    TypeError, ValueError
        An argument is wrong.
    ConverseError, MemoryError
        The run ended; what was proved is in the file.
    """
    pool = WorkerPool(executor, jobs, time_limit)
    seconds = exact(budget)
    if seconds <= 0:
        raise ValueError("the budget is a number of seconds above 0, not %s" % (budget,))
    asked = None if family is None else Diagram.of(family)
    with interruptible(), Backup(path, resumed=path if resume else None) as backup:
        if path is not None and resume:
            diagram = Diagram.load(path)
            _check_resumed(diagram, asked, os.fspath(path))
        elif asked is not None and not resume:
            diagram = asked
        else:
            raise TypeError("there must be a family, or the file of a diagram to continue")
        if len(diagram.ranges) == 1 and not diagram.members:
            diagram.sides = sides_of(diagram.family)
        with Filling(diagram, backup, pool,
                     lambda: progress and progress(diagram)) as filling:
            search = line.search if len(diagram.ranges) == 1 else cells.search
            search(diagram, filling, int(seconds * POINTS_A_SECOND), tell or (lambda text: None))
    return diagram


def _check_resumed(diagram, asked, name):
    """ConverseError, unless the diagram of a file can be continued as it is asked for."""
    if asked is not None and (asked.family, asked.ranges) != (diagram.family, diagram.ranges):
        raise ConverseError("%s: is of another family or range, %s; name its own input, or leave "
                            "the input out" % (name, diagram.family))
    check_release(diagram, name)
