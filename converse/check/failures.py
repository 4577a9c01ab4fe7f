"""The ways in which a check fails, and how they are said in one line."""

import contextlib
import sys

from .limits import NOT_CONFIRMED, REJECTED, UNUSABLE


class Failure(Exception):
    """Nothing was verified; the text says why."""


class Rejected(Failure):
    """The file is wrong, whatever the truth about the map may be."""

    status, word = REJECTED, "rejected: "


class NotConfirmed(Failure):
    """The checker has reached a limit: the claim of the file may be true or false.

    residual, needed: of a torus, if it is not accurate enough.
    """

    residual = needed = None

    status, word = NOT_CONFIRMED, "not confirmed: "


class Unusable(Failure):
    """The arguments or the file cannot be used at all."""

    status, word = UNUSABLE, ""


def reason(error):
    """An OSError in words."""
    return getattr(error, "strerror", None) or str(error)


@contextlib.contextmanager
def named(name):
    """What fails within is told by this name, if there is one."""
    try:
        yield
    except Failure as error:
        if name:
            error.args = "%s: %s" % (name, error),
        raise


def shown(text):
    """The text without anything that could steer a terminal, on one line."""
    return "".join([x if x.isprintable() else x.encode("unicode_escape").decode() for x in text])


def complain(text):
    with contextlib.suppress(OSError, AttributeError):      # closed, or there is none
        print("converse-check: " + shown(text), file=sys.stderr, flush=True)
