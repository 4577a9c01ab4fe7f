"""About how long calculations take, in seconds of a processor, for those who wait, and how much
memory; and their end when the time is up."""

import math
import os
import time
from typing import Callable, Optional

from ..storage.files import ConverseError

Tell = Callable[[str], None]

# Seconds for each point of a grid: Newton's method in doubles, and an error with many digits.
SOLVING, BALLS = 4e-6, 1.0e-5
SHORT, LONGER = 128, 1.6    # Balls of more than SHORT bits take LONGER times as long.
# Refining a torus takes as long as SINGLE errors with many digits.  If it is a polynomial in the
# parameter, each point of sigma takes REFINING.
SINGLE, REFINING = 2.5, 2
# Bytes for each point of a grid while a torus is refined, and more for each point of sigma.
REFINING_BYTES, LAYER_BYTES = 1300, 100


class TimeIsUp(ConverseError):
    """The time limit of find() or prove() is over; the text names the step that was to begin."""


def limited(progress: Optional[Tell], time_limit: float) -> Tell:
    """progress, or a function that does nothing; from time_limit seconds on it raises TimeIsUp."""
    if not time_limit >= 0:
        raise ValueError("time_limit is a number of seconds, not %r" % (time_limit,))
    end = time.monotonic() + time_limit

    def tell(step: str) -> None:
        if time.monotonic() >= end:
            raise TimeIsUp("the %g seconds of the time limit are over; the next step was: %s"
                           % (time_limit, step))
        if progress is not None:
            progress(step)
    return tell


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
    """Bytes that are free on the machine and in all control groups of this process, such as a
    container; 4 GB if the system does not say."""
    free = [1024 * _number(os.path.join(root, "proc/meminfo"), "MemAvailable:")]
    for group in _control_groups(root):
        for limit, usage, cache in (
                ("memory.max", "memory.current", "inactive_file"),
                ("memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file")):
            most, used = _number(os.path.join(group, limit)), _number(os.path.join(group, usage))
            kept = _number(os.path.join(group, "memory.stat"), cache)
            if used < math.inf:         # what files occupy and nobody uses is given back
                free.append(max(0, most - used + (kept if kept < used else 0)))
    return min(free) if min(free) < math.inf else 4 << 30


def _control_groups(root):
    """The folders of this process's control groups for memory, of version 1 or 2, and of those that
    hold them."""
    try:
        with open(os.path.join(root, "proc/self/cgroup")) as file:
            lines = [line.rstrip("\n").split(":", 2) for line in file]
    except OSError:
        return
    for number, controllers, path in lines:
        if number == "0" or "memory" in controllers.split(","):
            mount = os.path.join(root, "sys/fs/cgroup", "memory" if controllers else "")
            names = [name for name in path.split("/") if name]
            for depth in range(len(names) + 1):
                yield os.path.join(mount, *names[:depth])


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
