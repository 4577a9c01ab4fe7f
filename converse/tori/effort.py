"""About how long calculations take, in seconds of a processor, for those who wait, and how much
memory."""

from .torus import Torus

SOLVING = 5e-6              # for each point of a mesh: Newton's method in floating-point numbers
BALLS = 1.2e-5              # for each point of a grid: a residual in ball arithmetic
# About so many residuals take as long as refining a torus, refining one that is a polynomial in the
# parameter, and a proof.
SINGLE, REFINING, PROVING = 1.4, 2, 3
BYTES = 250                 # of memory for each point of a grid: a ball in two arrays
POINTS = {1: 4, 2: 9}       # of the grid of the residual for each mode, by the number of angles


def proving(torus: Torus) -> float:
    """Seconds."""
    layers = 1 if torus.part is None else 2 << torus.degree.bit_length()
    return PROVING * BALLS * POINTS[torus.dimension] * len(torus.modes) * layers


def some(seconds: float) -> str:
    """Such as ", some 40 s" or ", some 3 min"; nothing below two seconds."""
    for unit, name in ((3600, "h"), (60, "min"), (1, "s")):
        if seconds >= 2 * unit:
            count = seconds / unit
            return ", some %s %s" % ("%.0f" % count if count >= 10 else "%.2g" % count, name)
    return ""


def free_memory() -> int:
    """Bytes; 4 GB if the system does not say."""
    try:
        with open("/proc/meminfo") as file:
            for line in file:
                if line.startswith("MemAvailable:"):
                    return int(line.split()[1]) * 1024
    except (OSError, ValueError, IndexError):
        pass
    return 4 << 30
