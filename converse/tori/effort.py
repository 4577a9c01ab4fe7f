"""About how long calculations take, in seconds of a processor, for those who wait, and how much
memory."""

from .torus import Torus

# Seconds for each point of a grid: Newton's method in floating-point numbers, a residual in balls,
# and an inverse.
SOLVING, BALLS, INVERSE = 4e-6, 1.2e-5, 2.5e-5
SHORT, LONGER = 128, 1.6    # bits of balls up to which these are the times; how much longer it is
# About so many residuals take as long as refining a torus, and one that is a polynomial in the
# parameter.
SINGLE, REFINING = 2.5, 2
# Bytes of memory for each point of a grid: a residual, all that a torus takes that is refined, and
# an inverse.
BYTES, REFINING_BYTES, INVERTING = 350, 750, 850
# By the number of angles: points of the grid of the residual for each mode, at least, before they
# are a power of two, and that part of them that the grid of the inverse has.
GRIDS = {1: (2.3, 1 / 4), 2: (10, 1 / 32)}


def balls(points: int, bits: int) -> float:
    """Seconds, of a residual."""
    return BALLS * points * (1 if bits <= SHORT else LONGER)


def proving(torus: Torus) -> float:
    """Seconds.  The inverse is tried on smaller grids before, which takes as long again."""
    each, part = GRIDS[torus.dimension]
    points = 1 << max(0, int(each * len(torus.modes)) - 1).bit_length()
    layers = 1 if torus.part is None else 1 << torus.degree.bit_length()
    return layers * (balls(points, torus.bits) + 2 * INVERSE * points * part)


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
