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


class Bar:
    """The progress on stderr.  On a terminal one line that is written again and again, elsewhere a
    new line now and then."""

    def __init__(self, wanted, total):
        self.total, self.done, self.width, self.began = total, 0, 0, time.monotonic()
        self.on = wanted and sys.stderr is not None
        self.terminal = self.on and sys.stderr.isatty()
        self.pause = BAR_SECONDS if self.terminal else LINE_SECONDS
        self.drawn = self.began + 5 * BAR_SECONDS * self.terminal   # a short check has none

    def __enter__(self):
        return self

    def advance(self, leaves):
        self.done += leaves
        now = time.monotonic()
        if self.on and now > self.drawn + self.pause:
            self.drawn = now
            self.draw("{:,} of {:,} leaves".format(self.done, self.total))

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
