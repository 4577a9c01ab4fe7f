"""Results that have a file: proofs, portraits, maps of parameter space, tori."""

import os
import re
import shlex
from typing import TYPE_CHECKING, List, Optional, Tuple, Type, TypeVar

from . import files
from .files import ConverseError, Path

if TYPE_CHECKING:
    from .. import check

Result = TypeVar("Result", bound="Kept")


class Kept:
    """A result that has a file."""

    def _text(self) -> str:
        """The content of the file."""
        raise NotImplementedError

    def save(self, path: Path) -> str:
        """Writes the file.

        Parameters
        ----------
        path
            The file; the text is compressed if the name ends in .gz.

        Returns
        -------
        str
            The SHA-256 of the uncompressed text.

        Raises
        ------
        ConverseError
            The file cannot be written; an older one is as it was.
        """
        return files.write_text(path, self._text())

    @classmethod
    def load(cls: Type[Result], path: Path) -> Result:
        """Reads a file that save() or a run wrote.  What it claims is believed; verify() and
        converse-check do not believe it.

        Parameters
        ----------
        path
            The file, compressed or not.

        Raises
        ------
        ConverseError
            The file cannot be read, is of another kind, or is damaged; the text says where.
        """
        raise NotImplementedError

    def verify(self, jobs: int = 1) -> "check.Result":
        """Verifies the result anew by the code of converse-check, which believes nothing of it and
        shares nothing with the program that found it.

        Parameters
        ----------
        jobs
            The number of processes.

        Returns
        -------
        check.Result
            True if the theorem is verified; its text is the checker's report.

        Raises
        ------
        check.Rejected, check.NotConfirmed, check.Unusable
            The theorem is not verified; the text says why.
        """
        return files.verified(self, jobs)


def headline(theorem: str, restored: int, noun: str) -> str:
    """The first line of a theorem, which says how much of it this run only read."""
    return theorem + (", of which %s %s%s read from a file that is believed" % (
        format(restored, ","), noun, "s were" if restored > 1 else " was")) * bool(restored)


def verify_text(file: Optional[Path], what: str) -> str:
    """How to verify the file of a theorem, or how to get one: the line Verify of reports.

    file: its name; "": a command was given none; None: a Python program has the result."""
    if file:
        return "converse-check " + shlex.quote(files.plain(os.fspath(file)))
    keeps = "save(FILE) keeps" if file is None else "with -b FILE the run keeps"
    return "%s the %s; converse-check FILE verifies it" % (keeps, what)


# ---- files that end with their checksum

def sealed(lines: List[str]) -> str:
    """The text of such lines, with the checksum."""
    text = "\n".join(lines) + "\n"
    return text + "checksum: sha256 %s\nend\n" % files.sha256(text)


def read_sealed(path: Path, what: str) -> str:
    """The text of such a file.  ConverseError: it cannot be read, or is not text; the message
    calls it by the word `what`."""
    return files.read_text(path, what, ", line 1: the file is truncated or not a %s of this program"
                           % what)


def unsealed(text: str, path: Path, first_line: str, what: str) -> Tuple[List[str], str]:
    """The lines of such a text without the checksum, and the text's SHA-256.

    ConverseError: it does not begin with this line, or is damaged; the message calls it by the word
    `what`, and names its path."""
    lines, (kind, _, version) = text.split("\n"), first_line.rpartition(" ")
    if re.fullmatch(kind + " [0-9]+", lines[0]) and lines[0] != first_line:
        raise ConverseError("%s: is a %s of another format; this release reads format %s, so "
                            "continue it with the release that wrote it" % (path, what, version))
    if lines[0] != first_line:
        raise damaged(path, 1, "the lines end in CR LF, so the file was altered on its way"
                      if lines[0].startswith(kind) and lines[0].endswith("\r") else
                      "this is not a %s of this program" % what)
    if lines[-2:] != ["end", ""]:
        raise damaged(path, len(lines), "something follows the end" if "end" in lines else
                      "the file is truncated")
    if sealed(lines[:-3]) != text:
        raise damaged(path, len(lines) - 2, "the file was changed or damaged (wrong checksum)")
    return lines[:-3], files.sha256(text)


def damaged(path: Path, number: int, wrong: str) -> ConverseError:
    """The error that a line of a file is wrong."""
    return ConverseError("%s, line %d: %s; use an intact copy or start anew"
                         % (path, number, wrong))
