"""About how long calculations take, in seconds of a processor, for those who wait, and how much
memory; and their end when the time is up."""

import math
import os
import time
from typing import Callable, Optional

from ..storage.files import ConverseError

Tell = Callable[[str], None]

# Seconds to look for regular orbits, and to follow one and plan its torus, by the number of angles;
# to choose vectors near one orbit.
LOOKING, PLANNING, CHOOSING = {1: 0.65, 2: 4.5}, {1: 0.25, 2: 1.5}, 1.2
# Seconds for each point of a grid: Newton's method in doubles, and an error with many digits.
SOLVING, BALLS = 2e-6, 1.0e-5
SHORT, LONGER = 128, 1.6    # Balls of more than SHORT bits take LONGER times as long.
# Refining a torus takes as long as SINGLE errors with many digits.  If it is a polynomial in the
# parameter, each point of sigma takes REFINING.
SINGLE, REFINING = 2.5, 2
# Seconds for each mode of a torus, to verify it, by the number of angles.
VERIFYING = {1: 2.5e-4, 2: 5e-4}
# Bytes for each point of a grid while a torus is refined, and more for each point of sigma.
REFINING_BYTES, LAYER_BYTES = 1300, 100


class TimeIsUp(ConverseError):
    """The time limit of find() or prove(), or the effort of a Work, is over; the text names the
    step that was to begin."""


class Work:
    """Tells of the steps of a calculation when they begin, and ends it.

    Parameters
    ----------
    progress
        progress(text) is called with each step.
    time_limit
        Seconds from now on, after which no step begins.
    most
        No step begins that would take the estimates of all steps above this, in seconds.

    Attributes
    ----------
    spent
        The sum of the estimates, which depend on sizes alone and not on the machine.
    """

    def __init__(self, progress: Optional[Tell] = None, time_limit: float = math.inf,
                 most: float = math.inf) -> None:
        if not time_limit >= 0:
            raise ValueError("time_limit is a number of seconds, not %r" % (time_limit,))
        self.progress, self.limit, self.end = progress, time_limit, time.monotonic() + time_limit
        self.most, self.spent = most, 0.0

    def __call__(self, step: str, seconds: float = 0.0, later: float = 0.0) -> None:
        """Begins a step of about `seconds`, which is in vain without the later ones."""
        if time.monotonic() >= self.end:
            raise TimeIsUp("the %g seconds of the time limit are over; the next step was: %s"
                           % (self.limit, step))
        if self.spent + seconds + later > self.most:
            raise TimeIsUp("more than %g seconds are needed; the next step was: %s" % (
                self.most, step))
        self.spent += seconds
        if self.progress is not None:
            self.progress(step + some(seconds))


def limited(progress: Optional[Tell], time_limit: float) -> Work:
    """The Work that tells `progress` of its steps, which may be such a Work itself."""
    return progress if isinstance(progress, Work) and time_limit == math.inf else Work(
        progress, time_limit)


def balls(points: int, bits: int) -> float:
    """Seconds, of an error with many digits."""
    return BALLS * points * (1 if bits <= SHORT else LONGER)


def some(seconds: float) -> str:
    """Such as ", some 40 s" or ", some 3 min"; nothing below two seconds."""
    for unit, name in ((3600, "h"), (60, "min"), (1, "s")):
        if seconds >= 2 * unit:
            count = seconds / unit
            return ", some %s %s" % ("%.0f" % count if count >= 10 else "%.2g" % count, name)
    return ""


def free_memory(root: str = "/") -> float:
    """Bytes that are free on the machine and in the container, if this is one; 4 GB if the system
    does not say."""
    free = [1024 * _number(os.path.join(root, "proc/meminfo"), "MemAvailable:")]
    for group, limit, usage, cache in (
            ("", "memory.max", "memory.current", "inactive_file"),
            ("memory", "memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file")):
        folder = os.path.join(root, "sys/fs/cgroup", group)
        most, used = (_number(os.path.join(folder, name)) for name in (limit, usage))
        kept = _number(os.path.join(folder, "memory.stat"), cache)
        if used < math.inf:             # files that nobody uses give their memory back
            free.append(max(0, most - used + (kept if kept < used else 0)))
    return min(free) if min(free) < math.inf else 4 << 30


def _number(path, name=""):
    """The number after that name in a file, or the only one; infinity if there is none."""
    try:
        with open(path) as file:
            for line in file:
                if not name or line.split()[:1] == [name]:
                    return int(line.split()[-2 if line.endswith("kB\n") else -1])
    except (OSError, ValueError, IndexError):
        pass
    return math.inf
