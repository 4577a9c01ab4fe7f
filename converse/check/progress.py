"""Messages on stderr: how a check failed, and how far it is."""

import contextlib
import sys
import time

BAR_SECONDS, LINE_SECONDS = 0.2, 30     # of the progress: on a terminal, elsewhere
QUIET_SECONDS = 2                       # Elsewhere no step of a shorter check is told.


def reason(error):
    """An OSError in words."""
    return getattr(error, "strerror", None) or str(error)


def shown(text):
    """The text without anything that could steer a terminal, on one line.

    Parameters
    ----------
    text : str

    Returns
    -------
    str
        Each character that cannot be printed is written as an escape, such as ``\\x1b``.
    """
    return "".join([x if x.isprintable() else x.encode("unicode_escape").decode() for x in text])


def complain(text):
    """Prints the text on stderr as a message of the command."""
    with contextlib.suppress(OSError, AttributeError):      # closed, or there is none
        print("converse-check: " + shown(text), file=sys.stderr, flush=True)


def cost(cell):
    """About what it takes to confirm a leaf: orbits are as long as their leaves are deep, and the
    work grows with the square of their length."""
    return 1 + sum(cell[1]) ** 2


class Bar:
    """The progress on stderr: leaves, and by their cost what is left.  On a terminal one line that
    is written again and again, elsewhere a new line now and then."""

    def __init__(self, work, total):
        self.total, self.done, self.spent, self.began = total, 0, 0, time.monotonic()
        self.work, self.cost, self.width = work, 0, 0
        self.on = bool(work) and sys.stderr is not None
        self.terminal = self.on and sys.stderr.isatty()
        self.pause = BAR_SECONDS if self.terminal else LINE_SECONDS
        self.drawn = self.began + 5 * BAR_SECONDS * self.terminal   # a short check has none

    def __enter__(self):
        return self

    def advance(self, leaves, spent):
        self.done, self.spent = self.done + leaves, self.spent + spent
        now = time.monotonic()
        if self.on and self.spent and now > self.drawn + self.pause:
            self.drawn = now
            self.cost = self.cost or sum(cost(cell) for _, (_, cell) in self.work)
            self.draw("{:,} of {:,} leaves, {:.0%}, about {} left".format(
                self.done, self.total, self.spent / self.cost,
                duration((now - self.began) * (self.cost / self.spent - 1))))

    def tell(self, text):
        """Shows the step that begins; it can take minutes."""
        if self.on and (self.terminal or time.monotonic() > self.began + QUIET_SECONDS):
            self.draw(text)

    def draw(self, text):
        if not self.terminal:
            complain(text)
            return
        with contextlib.suppress(OSError):
            print("\r" + text.ljust(self.width), end="\r", file=sys.stderr, flush=True)
        self.width = len(text)

    def __exit__(self, *_):
        if self.width:
            self.draw("")


def duration(seconds):
    for unit, length in (("days", 86400), ("h", 3600), ("min", 60)):
        if seconds >= 2 * length:
            return "%d %s" % (seconds / length, unit)
    return "%d s" % seconds
