"""Messages on stderr: how a check failed, and how far it is."""

import contextlib
import sys
import threading
import time

BAR_SECONDS, LINE_SECONDS = 0.2, 60     # of the progress: on a terminal, elsewhere
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
    """The progress on stderr, which a thread writes: on a terminal one line again and again,
    elsewhere a line a minute."""

    def __init__(self, wanted, total):
        self.total, self.done, self.step, self.width = total, 0, "", 0
        self.began, self.over = time.monotonic(), threading.Event()
        self.on = wanted and sys.stderr is not None
        self.terminal = self.on and sys.stderr.isatty()
        self.thread = threading.Thread(target=self.repeat, daemon=True)

    def __enter__(self):
        if self.on:
            self.thread.start()
        return self

    def advance(self, leaves):
        self.done += leaves

    def tell(self, text):
        """Shows the step that begins; it can take minutes."""
        self.step = text
        if self.on and (self.terminal or time.monotonic() > self.began + QUIET_SECONDS):
            self.draw(text)

    def repeat(self):
        pause = BAR_SECONDS if self.terminal else LINE_SECONDS
        first = 5 * pause if self.terminal else pause       # a short check has none
        while not self.over.wait(pause if self.width else first):
            passed = int(time.monotonic() - self.began)
            self.draw("%d:%02d:%02d %s" % (
                passed // 3600, passed // 60 % 60, passed % 60,
                self.step or "{:,} of {:,} leaves".format(self.done, self.total)))

    def draw(self, text):
        if not self.terminal:
            complain(text)
            return
        with contextlib.suppress(OSError):
            print("\r" + text.ljust(self.width), end="\r", file=sys.stderr, flush=True)
        self.width = len(text)

    def __exit__(self, *_):
        self.over.set()
        if self.on:
            self.thread.join()
        if self.width:
            self.draw("")
