"""About how long calculations take, in seconds of a processor, for those who wait, and how much
memory."""

# Seconds for each point of a grid: Newton's method in doubles, and an error with many digits.
SOLVING, BALLS = 4e-6, 1.0e-5
SHORT, LONGER = 128, 1.6    # bits of balls up to which these are the times; how much longer it is
# About so many errors take as long as refining a torus, and one that is a polynomial in the
# parameter.
SINGLE, REFINING = 2.5, 2
REFINING_BYTES = 750        # Bytes for each point of a grid, while a torus is refined.


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
