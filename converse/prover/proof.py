"""A proof: the tree of prisms with its statistics, and its file."""

import os
import re
import zlib
from dataclasses import asdict, dataclass, field, fields
from functools import cached_property
from typing import TYPE_CHECKING, Any, Dict, List, Optional, Tuple, Union

from ..model.exact import DECIMAL, decimal_text, exact
from ..model.problem import IDENTITY, NAMES, Problem
from ..storage import files
from ..storage.files import ConverseError
from ..version import __version__
from . import tree
from .native import CONSTANTS, Counts
from .settings import AS_PRINTED, REGION, THEOREM, UNDECIDED, Settings
from .tree import Leaf

if TYPE_CHECKING:
    from .. import check

FIRST_LINE, BEFORE = "converse proof 3", "converse proof 2"     # written, and read as well
PROGRAM = re.compile(r"converse ([0-9A-Za-z.+-]{1,40})")
KINDS = {False: "sound", True: "as printed, not a proof"}       # by as_printed


@dataclass(frozen=True, repr=False)
class Proof:
    """A search and its result, finished or not: true if it proves that there are no invariant tori.

    What it proves rests on its tree, which prove() grew; a Proof that was loaded, or made by hand,
    is believed.  verify() believes nothing.

    problem, settings: what was asked.
    tree: one character for each prism, in preorder (docs/format.md).
    counts: the statistics of the search.
    xstar: the two angles of the starting point, in radians, as decimal strings; None: not yet chosen.
    constants: the numbers of the theorem, as decimal strings: B, a bound of the largest eigenvalue of
    beta, and with the thesis's method T, of its trace, and the limits of the uniform cones.
    seconds: that the search took, as far as is known.
    version: of the program that did the work.
    pending: what is known of the untried prisms, in their order.
    at_once: nor have any s times these amplitudes tori, s > 1 (if there is one parameter, as where
    a, b and c move together: s times those at its upper end).
    restored: how many leaves of the tree come from a file.
    sha256: of the proof's file, uncompressed; "" if there is none.
    """

    problem: Problem
    settings: Settings = Settings()
    tree: str = ""
    counts: Counts = Counts()
    xstar: Optional[Tuple[str, str]] = None
    constants: Dict[str, str] = field(default_factory=dict)
    seconds: float = field(default=0.0, compare=False)
    version: str = __version__
    pending: Tuple[int, ...] = ()
    at_once: bool = False
    restored: int = field(default=0, compare=False)
    sha256: str = field(default="", compare=False)

    def __bool__(self):
        return self.no_tori

    def __repr__(self):
        return "<Proof: %s; %d prisms proved, %d skipped, %d undecided; %s, %s>" % (
            {THEOREM: "no invariant tori", REGION: "none through a part of the torus",
             UNDECIDED: "undecided", AS_PRINTED: "as printed, not a proof"}[self.conclusion],
            self.counts.proved, self.counts.symmetric, self.counts.undecided, self.method,
            self.arithmetic)

    @property
    def method(self) -> str:
        return self.settings.method

    @property
    def depth(self) -> int:
        return self.settings.depth or 0

    @property
    def digits(self) -> int:
        return self.settings.digits

    @property
    def as_printed(self) -> bool:
        return self.settings.as_printed

    @cached_property
    def all_decided(self) -> bool:
        """Is the tree whole and without an undecided prism?"""
        return "U" not in self.tree and tree.complete(self.tree)

    @property
    def conclusion(self) -> str:
        """What the search came to: "theorem", that there are no invariant tori; "region", that none
        goes through the successors of x* which the problem names, only a part of the torus;
        "undecided"; or "as printed", decided as the listing of 1989 would, which is no proof."""
        if not self.all_decided:
            return UNDECIDED
        if self.as_printed:
            return AS_PRINTED
        return THEOREM if self.problem.full_torus else REGION

    @property
    def no_tori(self) -> bool:
        """Is it proved that there are no invariant tori?"""
        return self.conclusion == THEOREM

    @property
    def arithmetic(self) -> str:
        """What the bounds were computed in, in words."""
        return "%d decimal places" % self.digits if self.method == "thesis" else "double precision"

    @property
    def undecided(self) -> List[Leaf]:
        """The prisms on which the search gave up: a list of Leaf, angles in units of pi."""
        return list(tree.leaves(self.problem, self.tree, "U")) if "U" in self.tree else []

    def report(self) -> str:
        """The report of 1989, and what a reader needs beside it."""
        from .report import report
        return report(self)

    def figure(self, target=None, *, ax=None, format: Optional[str] = None, caption: bool = True):
        """Draws the prisms: see figure.figure."""
        from ..draw.figure import figure
        return figure(self, target, ax, format, caption)

    def verify(self, jobs: int = 1) -> "check.Result":
        """Verifies the proof anew by the code of converse-check, which believes nothing of it and
        shares nothing with the program that found it; jobs: processes.

        The Result is true if the theorem is verified; its text is the checker's report.
        check.Rejected, check.NotConfirmed, check.Unusable: it is not, and why.
        """
        import tempfile

        from .. import check
        with tempfile.TemporaryDirectory() as directory:
            path = os.path.join(directory, "proof")
            self.save(path)
            return check.verify(path, jobs)

    def _repr_svg_(self):
        from ..draw.figure import svg
        return svg(self)

    def _repr_html_(self):
        from ..draw.figure import html
        return html(self)

    def save(self, path: Union[str, "os.PathLike[str]"]) -> str:
        """Writes the proof file, compressed when the name ends in .gz; returns its SHA-256 (that
        of the uncompressed file).  However it was interrupted and continued, and whoever did the
        work, the same search gives the same file."""
        text = data = self._text().encode("utf-8")
        if os.fspath(path).endswith(".gz"):
            import gzip
            data = gzip.compress(text, 6, mtime=0)
        files.write(path, data)
        return _sha256(text)

    def _text(self):
        lines = [FIRST_LINE, "kind: " + KINDS[self.as_printed],
                 "program: converse " + self.version, "method: " + self.method]
        lines += _problem_lines(self.problem)
        lines += ["xstar: " + " ".join(self.xstar)] if self.xstar else []
        lines += ["depth: %d" % self.depth, "digits: %d" % self.digits,
                  "stubborn: " + _yes(self.settings.stubborn), "at once: " + (
                      "upper end" if self.at_once and len(self.problem.parts) == 1
                      else _yes(self.at_once))]
        lines += [] if self.all_decided else ["seconds: %.2f" % self.seconds]
        lines += ["pending: " + " ".join(map(str, self.pending))]
        for name, value in asdict(self.counts).items():
            values = value if isinstance(value, tuple) else (value,)
            lines.append("%s: %s" % (name, " ".join(map(str, values))))
        lines += ["%s: %s" % item for item in self.constants.items()]
        lines += ["comment: " + comment for comment in self.problem.comments]
        lines += ["tree:"]
        lines += [self.tree[i:i + 78] for i in range(0, len(self.tree), 78)]
        text = "\n".join(lines) + "\n"
        return text + "checksum: sha256 %s\nend\n" % _sha256(text.encode("utf-8"))

    @classmethod
    def load(cls, path: Union[str, "os.PathLike[str]"]) -> "Proof":
        """Reads a proof file; ConverseError says in one line what is wrong with it.  Its leaves are
        believed: verify() and converse-check do not believe them."""
        text = _read(path)
        lines = text.split("\n")

        def fail(number, wrong):
            raise ConverseError("%s, line %d: %s; use an intact copy or start anew"
                                % (path, number, wrong))

        if lines[0] not in (FIRST_LINE, BEFORE):
            fail(1, "this is not a proof file of this program")
        if lines[-2:] != ["end", ""]:
            fail(len(lines), "the file is truncated")
        body = text[:text.rfind("\n", 0, len(text) - len("\nend\n")) + 1]
        if lines[-3] != "checksum: sha256 " + _sha256(body.encode("utf-8")):
            fail(len(lines) - 2, "the file was changed or damaged (wrong checksum)")

        start = lines.index("tree:") if "tree:" in lines else fail(len(lines), "there is no tree")
        values, comments, waves = {}, [], []
        for number, line in enumerate(lines[1:start], 2):
            key, colon, value = line.partition(": ")
            if not colon:
                fail(number, "'%s' is not 'name: value'" % line)
            elif key == "comment":
                comments.append(value)
            elif key == "wave":
                waves.append(value.split())
            else:
                values[key] = value
        try:
            problem = _problem(values, waves, comments) if lines[0] == FIRST_LINE \
                else _older_problem(values, comments)
            counts: Dict[str, Any] = {}
            for item in fields(Counts):
                numbers = tuple(int(word) for word in values[item.name].split())
                counts[item.name] = numbers if isinstance(item.default, tuple) else numbers[0]
            xstar = None
            if "xstar" in values:
                x0, x1 = values["xstar"].split()
                xstar = _number(x0), _number(x1)
            program = PROGRAM.fullmatch(values["program"])
            if program is None:
                raise ValueError("of an unknown program")
            nodes = "".join(lines[start + 1:-3])
            settings = Settings(values["method"], int(values["depth"]), int(values["digits"]),
                                values["stubborn"] == "yes",
                                {kind: printed for printed, kind in KINDS.items()}[values["kind"]])
            proof = cls(
                problem, settings, nodes, Counts(**counts), xstar,
                {name: _number(values[name]) for name in CONSTANTS[settings.method]
                 if name in values},
                float(values.get("seconds", 0)), program[1],
                tuple(map(int, values["pending"].split())), _at_once(values, problem),
                nodes.count("P") + nodes.count("S"), _sha256(text.encode("utf-8")))
            tree.complete(proof.tree)
        except (KeyError, IndexError, TypeError, ValueError) as error:
            fail(start + 1, "the header or the tree makes no sense (%s)" % error)
        return proof


def _problem_lines(problem):
    """The fields of the header that say which problem it is."""
    lines = ["wave: %d %d %s" % wave + "".join(" " + decimal_text(x) for x in numbers)
             for wave, *numbers in zip(problem.waves, problem.amplitude, *problem.parts)]
    lines += ["frame: %d %d %d %d" % problem.frame,
              "alone: %s" % ("no" if problem.kept is None else problem.kept),
              "odd about: " + ("no" if problem.odd is None else "%s %s" % problem.odd)]
    return lines + ["%s: %s %s" % (name, decimal_text(centre), decimal_text(half))
                    for name, centre, half in zip(NAMES[3:], problem.centre[-2:], problem.half[-2:])]


def _problem(values, waves, comments):
    """The problem of such fields, given all the words of each wave."""
    amplitude, *parts = zip(*(words[3:] for words in waves))
    if len({len(words) for words in waves}) != 1:
        raise ValueError("the waves do not agree in how many parameters there are")
    alone = values["alone"]
    if "odd about" not in values:
        raise KeyError("odd about")
    v0, v1 = (_ends(values, name) for name in NAMES[3:])
    return Problem.patch(amplitude, parts, [(*map(int, words[:2]), words[2]) for words in waves],
                         v0, v1, comments, tuple(map(int, values["frame"].split())),
                         alone if alone == "no" else int(alone))


def _older_problem(values, comments):
    """The problem of a file of format 2, of before there were frames and other waves."""
    return Problem(*(_ends(values, name) for name in NAMES), comments, values["together"] == "yes",
                   axes=IDENTITY, alone="no")


def _at_once(values, problem):
    """Is such a claim made, and one that may be made of the problem?"""
    word = values["at once"]
    if word == "no":
        return False
    if problem.odd is None or (word != "yes" and (word, len(problem.parts)) != ("upper end", 1)):
        raise ValueError("at once: %.40s" % word)
    return True


def _ends(values, name):
    centre, half = map(exact, values[name].split())
    if half < 0:
        raise ValueError("the half-width of %s is negative" % name)
    return centre - half, centre + half


def _number(text):
    """The text, which must be that of a decimal number."""
    if not DECIMAL.fullmatch(text):
        raise ValueError("'%.40s' is not a decimal number" % text)
    return text


def _yes(truth):
    return "yes" if truth else "no"


def _sha256(data):
    import hashlib  # for OpenSSL a tenth of a short run, as gzip is
    return hashlib.sha256(data).hexdigest()


def _read(path):
    try:
        with open(path, "rb") as file:
            data = file.read()
        if data[:2] == b"\x1f\x8b":
            import gzip
            data = gzip.decompress(data)
        return data.decode("utf-8")
    except OSError as error:
        raise ConverseError("%s: cannot be read (%s); name a readable proof file"
                            % (path, files.reason(error))) from None
    except (EOFError, zlib.error, UnicodeDecodeError):
        raise ConverseError("%s, line 1: the file is truncated or not a proof file of this "
                            "program; use an intact copy or start anew" % path) from None
