"""The ways in which a check fails."""

import contextlib

from .limits import NOT_CONFIRMED, REJECTED, UNUSABLE


class Failure(Exception):
    """Nothing was verified; the text says why."""


class Rejected(Failure):
    """The file is wrong, whatever the truth about the map may be."""

    status, word = REJECTED, "rejected: "


class NotConfirmed(Failure):
    """The checker has reached a limit: the claim of the file may be true or false."""

    status, word = NOT_CONFIRMED, "not confirmed: "


class Unusable(Failure):
    """The arguments or the file cannot be used at all."""

    status, word = UNUSABLE, ""


@contextlib.contextmanager
def named(name):
    """A context in which messages about failures begin with this name, if there is one."""
    try:
        yield
    except Failure as error:
        if name:
            error.args = "%s: %s" % (name, error),
        raise
