"""Results that have a file: proofs, portraits, diagrams, tori."""

import os
import re
import shlex
from typing import TYPE_CHECKING, Any, ClassVar, Dict, List, Optional, Type, TypeVar

from . import files
from .files import ConverseError, Path

if TYPE_CHECKING:
    from .. import check

Result = TypeVar("Result", bound="Kept")


class Kept:
    """A result that has a file."""

    KIND: ClassVar[str]                 # of the file, as its first line says

    @classmethod
    def _of(cls: Type[Result], content: Any) -> Result:
        """The result that is the content of a file, as the checker reads it.  KeyError, ValueError:
        it makes no sense."""
        raise NotImplementedError

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
        """Reads a file that save() or a run wrote.  Its claims are believed; verify() and
        converse-check do not believe it.

        Parameters
        ----------
        path
            The file, compressed or not.

        Raises
        ------
        ConverseError
            The file cannot be read, is of another kind or release, or is damaged.
        """
        content = read(path, cls.KIND)
        try:
            return cls._of(content)
        except (KeyError, IndexError, TypeError, ValueError) as error:
            raise unsound(path, "the file makes no sense (%s)" % error) from None

    def verify(self, jobs: int = 1) -> "check.Result":
        """Verifies the result anew by the code of converse-check, which believes nothing of it and
        shares no mathematics with the program that found it.

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
        import tempfile

        from .. import check

        with tempfile.TemporaryDirectory() as directory:
            path = os.path.join(directory, "saved")
            self.save(path)
            return check.verify(path, jobs)


def read(path: Path, kind: str) -> Any:
    """The content of a file of this kind.  The checker's reader is the only one.

    ConverseError: the file cannot be read, is of another kind or release, or is damaged."""
    from .. import check
    files.check_name(path)
    try:
        return check.read(os.fspath(path), kind)
    except check.Unusable as error:
        raise ConverseError("%s: %s" % (path, error)) from None
    except check.Failure as error:
        raise unsound(path, error) from None


def unsound(path: Path, wrong: object) -> ConverseError:
    """The error that a file is wrong."""
    return ConverseError("%s: %s; use an intact copy or start anew" % (path, wrong))


def program_of(header: Dict[str, Any]) -> str:
    """The release that wrote a file.  ValueError: it is none of this program."""
    name, _, release = header["program"].partition(" ")
    if name != "converse" or not re.fullmatch("[0-9A-Za-z.+-]{1,40}", release):
        raise ValueError("of an unknown program")
    return release


def headline(theorem: str, restored: int, noun: str) -> str:
    """The first line of a theorem, which says how much of it this run only read."""
    return theorem + (", of which " + believed(restored, noun)) * bool(restored)


def believed(restored: int, noun: str) -> str:
    """How many things a run only read."""
    return "%s %s%s read from a file that is believed" % (
        format(restored, ","), noun, "s were" if restored > 1 else " was")


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
