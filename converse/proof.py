"""A proof: the tree of prisms with its statistics; how it is found, saved and loaded."""

import contextlib
import gzip
import hashlib
import math
import os
import time
import zlib
from dataclasses import asdict, dataclass, field, fields
from decimal import Decimal
from typing import Dict, Tuple

from . import __version__, files, tree
from ._native import ffi, lib
from .files import ConverseError
from .problem import NAMES, Problem, decimal_text, parse_number

STEP_SECONDS = 0.1                  # between two looks at the clock, at Ctrl-C, at the bar
BACKUP_SECONDS = 1.0
MANY = 2 ** 30
LIMIT = 100000                      # of the depth and of the digits

FIRST_LINE = "converse proof 1"
METHOD = "thesis"
KINDS = {False: "sound", True: "as printed, not a proof"}       # by as_printed
CONSTANTS = {"T": 2, "Tr-": 3, "Tr+": 4, "B": 5, "lambda-min": 6, "lambda-max": 7}

MESSAGES = {
    lib.CV_ENUMBER: "a number is malformed or out of range",
    lib.CV_EARGUMENT: "an argument makes no sense",
    lib.CV_ETREE: "the tree does not belong to a search of this kind",
    lib.CV_EARITHMETIC: "the arithmetic failed: a division by zero, a root of a negative number "
                        "or lost precision; try more digits",
    lib.CV_ESINGULAR: "the matrix could not be inverted at any sensible precision",
    lib.CV_EMACHINE: "this machine's floating-point arithmetic, or the way the program was "
                     "built, breaks the rules that the proof relies on",
}


@dataclass(frozen=True)
class Counts:
    """The statistics of a search; the names are those of csrc/converse.h."""

    quick_tries: int = 0
    tries: int = 0
    Rtries: int = 0
    cuts: int = 0
    proved: int = 0
    symmetric: int = 0
    undecided: int = 0
    HermSuccess: int = 0
    LLSuccess: int = 0
    ll_used: Tuple[int, ...] = (0, 0, 0)
    reasons: Tuple[int, ...] = (0,) * lib.CV_N_REASONS
    most_cuts: int = 0
    max_steps: int = 0
    max_NTsteps: int = 0


@dataclass(frozen=True)
class Proof:
    """A search and its result, finished or not."""

    problem: Problem
    depth: int
    digits: int
    stubborn: bool
    as_printed: bool
    tree: str
    counts: Counts
    xstar: Tuple[str, str]              # the starting point, in radians
    constants: Dict[str, str] = field(default_factory=dict)
    seconds: float = 0.0
    version: str = __version__          # of the program that did the work

    @property
    def all_decided(self):
        """Is the tree whole and without an undecided prism?"""
        return "U" not in self.tree and tree.complete(self.tree)

    @property
    def no_tori(self):
        """Is it proved that there are no invariant tori?"""
        return self.all_decided and not self.as_printed

    @property
    def undecided(self):
        """The prisms on which the search gave up."""
        return list(tree.leaves(self.problem, self.tree, "U"))

    def report(self):
        from .report import report
        return report(self)

    def figure(self, path):
        from .figure import figure
        figure(self, path)

    def save(self, path):
        """Writes the proof file; compressed when the name ends in .gz."""
        data = self._text().encode("utf-8")
        if os.fspath(path).endswith(".gz"):
            data = gzip.compress(data, 6, mtime=0)
        files.write(path, data)

    def _text(self):
        lines = [FIRST_LINE, "kind: " + KINDS[self.as_printed],
                 "program: converse " + self.version, "method: " + METHOD]
        lines += ["%s: %s %s" % (name, decimal_text(centre), decimal_text(half))
                  for name, centre, half in zip(NAMES, self.problem.centre, self.problem.half)]
        lines += ["xstar: %s %s" % self.xstar, "depth: %d" % self.depth,
                  "digits: %d" % self.digits, "stubborn: %s" % ("yes" if self.stubborn else "no"),
                  "seconds: %.2f" % self.seconds]
        for name, value in asdict(self.counts).items():
            values = value if isinstance(value, tuple) else (value,)
            lines.append("%s: %s" % (name, " ".join(map(str, values))))
        lines += ["%s: %s" % item for item in self.constants.items()]
        lines += ["comment: " + comment for comment in self.problem.comments]
        lines += ["tree:"]
        lines += [self.tree[i:i + 78] for i in range(0, len(self.tree), 78)]
        text = "\n".join(lines) + "\n"
        return text + "checksum: sha256 %s\nend\n" % _sha256(text)

    @classmethod
    def load(cls, path):
        """Reads a proof file; ConverseError says in one line what is wrong with it."""
        text = _read(path)
        lines = text.split("\n")

        def fail(number, wrong):
            raise ConverseError("%s, line %d: %s; use an intact copy or start anew"
                                % (path, number, wrong))

        if lines[0] != FIRST_LINE:
            fail(1, "this is not a proof file of this program")
        if lines[-2:] != ["end", ""]:
            fail(len(lines), "the file is truncated")
        body = text[:text.rfind("\n", 0, len(text) - len("\nend\n")) + 1]
        if lines[-3] != "checksum: sha256 " + _sha256(body):
            fail(len(lines) - 2, "the file was changed or damaged (wrong checksum)")

        start = lines.index("tree:") if "tree:" in lines else fail(len(lines), "there is no tree")
        values, comments = {}, []
        for number, line in enumerate(lines[1:start], 2):
            key, colon, value = line.partition(": ")
            if not colon:
                fail(number, "'%s' is not 'name: value'" % line)
            elif key == "comment":
                comments.append(value)
            else:
                values[key] = value
        try:
            pairs = [[parse_number(word) for word in values[name].split()] for name in NAMES]
            centre, half = zip(*pairs)
            counts = {}
            for item in fields(Counts):
                numbers = tuple(int(word) for word in values[item.name].split())
                counts[item.name] = numbers if isinstance(item.default, tuple) else numbers[0]
            x0, x1 = values["xstar"].split()
            proof = cls(Problem(centre, half, tuple(comments)), int(values["depth"]),
                        int(values["digits"]), values["stubborn"] == "yes",
                        {kind: printed for printed, kind in KINDS.items()}[values["kind"]],
                        "".join(lines[start + 1:-3]), Counts(**counts), (x0, x1),
                        {name: values[name] for name in CONSTANTS}, float(values["seconds"]),
                        values["program"].split()[1])
            tree.complete(proof.tree)
        except (KeyError, IndexError, ValueError) as error:
            fail(start + 1, "the header or the tree makes no sense (%s)" % error)
        return proof


def _sha256(text):
    return hashlib.sha256(text.encode("utf-8")).hexdigest()


def _read(path):
    try:
        with open(path, "rb") as file:
            data = file.read()
        if data[:2] == b"\x1f\x8b":
            data = gzip.decompress(data)
        return data.decode("utf-8")
    except OSError as error:
        raise ConverseError("%s: cannot be read (%s); name a readable proof file"
                            % (path, files.reason(error))) from None
    except (EOFError, zlib.error, UnicodeDecodeError):
        raise ConverseError("%s, line 1: the file is truncated or not a proof file of this "
                            "program; use an intact copy or start anew" % path) from None


def check(code):
    """Turns an error code of the C core into an exception; passes any other code on."""
    if code == lib.CV_ENOMEM:
        raise MemoryError("there is not enough memory")
    if code < 0:
        raise ConverseError(MESSAGES.get(code, "the C core failed with code %d" % code))
    return code


def _strings(texts):
    """The texts as a C array of C strings, which lives as long as the result."""
    owners = [ffi.new("char[]", text.encode("ascii")) for text in texts]
    return ffi.new("char *[]", owners), owners


class _Search:
    """The search in the C core, in terms of Python."""

    def __init__(self, problem, depth, digits, stubborn, as_printed, xstar=None):
        (centre, keep1), (half, keep2) = map(_strings, problem.decimals())
        start, keep3 = _strings(xstar) if xstar else (ffi.NULL, None)
        handle = ffi.new("cv_search **")
        check(lib.cv_search_new(handle, centre, half, start, digits, depth, stubborn, as_printed))
        self.handle = ffi.gc(handle[0], lib.cv_search_free)

    def restore(self, proof):
        text = proof.tree.encode("ascii")
        check(lib.cv_restore(self.handle, text, len(text),
                             ffi.new("cv_counts *", asdict(proof.counts))))

    def step(self, max_leaves):
        """Works a while; is there more to do?"""
        return check(lib.cv_step(self.handle, max_leaves, STEP_SECONDS)) == lib.CV_RUNNING

    def tree(self, start=0):
        """The text of the tree from this position on."""
        length = ffi.new("size_t *")
        text = lib.cv_tree(self.handle, length)
        return ffi.unpack(text + start, length[0] - start).decode("ascii") \
            if length[0] > start else ""

    def counts(self):
        counts = lib.cv_get_counts(self.handle)
        values = {item.name: getattr(counts, item.name) for item in fields(Counts)}
        return Counts(**{name: value if isinstance(value, int) else tuple(value)
                         for name, value in values.items()})

    def constant(self, which):
        text = lib.cv_constant(self.handle, which)
        if not text:
            raise MemoryError("there is not enough memory")
        text = ffi.gc(text, lib.cv_free)
        return str(Decimal(ffi.string(text).decode("ascii")))


def prove(problem, depth=30, digits=35, stubborn=False, as_printed=False, progress=None,
          backup=None, resume=None, on_leaf=None, time_limit=math.inf):
    """Tries to prove that there are no invariant tori, and returns a Proof either way.

    depth and digits are the most cuts of a prism and the decimal places of the rigorous
    arithmetic; a stubborn search goes on after an undecided prism.  as_printed follows the
    listing of the thesis to the letter, which proves nothing.
    progress(fraction, counts, depth) is called a few times a second.
    backup names a file that is kept up to date, and resume a proof (or its file) to continue.
    on_leaf(leaf, steps) is called for every leaf of the tree as it is decided.
    time_limit: after about so many seconds of this run the search is left as it is.
    """
    if not 1 <= digits <= LIMIT:
        raise ValueError("digits must be from 1 to %d" % LIMIT)
    if not 0 <= depth <= LIMIT:
        raise ValueError("depth must be from 0 to %d" % LIMIT)
    began = time.monotonic()
    end = began + time_limit
    keep = backup is not None
    if keep:
        check_backup(backup)
    with files.lock(backup) if keep else contextlib.nullcontext():
        name = "the proof to resume"
        if resume is not None and not isinstance(resume, Proof):
            name, resume = os.fspath(resume), Proof.load(resume)
        if resume:
            _check_same(name, resume, problem, depth, digits, as_printed)
            began -= resume.seconds
        search = _Search(problem, depth, digits, stubborn, as_printed,
                         resume.xstar if resume else None)
        if resume:
            try:
                search.restore(resume)
            except ConverseError as error:
                raise ConverseError("%s: %s; use an intact copy or start anew"
                                    % (name, error)) from None
        xstar = search.constant(0), search.constant(1)
        constants = {name: search.constant(which) for name, which in CONSTANTS.items()}

        def snapshot():
            return Proof(problem, depth, digits, stubborn, as_printed, search.tree(),
                         search.counts(), xstar, constants, time.monotonic() - began)

        walk, prism = tree.Walk(), tree.prisms(problem)
        seen = 0

        def look(on_leaf=on_leaf):
            """Follows the tree since the last look."""
            nonlocal seen
            text = search.tree(seen)
            seen += len(text)
            for kind, cell in walk.feed(text):
                if on_leaf:
                    on_leaf(tree.Leaf(kind, *prism(cell), cell[1] + cell[3]),
                            lib.cv_last_steps(search.handle))
            if progress:
                _, k, _, l = walk.pending[-1] if walk.pending else (0, 0, 0, 0)
                progress(lib.cv_volume_decided(search.handle), search.counts(), k + l)

        look(on_leaf=None)              # the part that was restored
        if keep:
            snapshot().save(backup)
        try:
            saved = time.monotonic()
            running = True
            while running and time.monotonic() < end:
                running = search.step(1 if on_leaf else MANY)
                if on_leaf or progress:
                    look()
                if keep and running and time.monotonic() - saved >= BACKUP_SECONDS:
                    snapshot().save(backup)
                    saved = time.monotonic()
        finally:
            if keep:
                snapshot().save(backup)
        return snapshot()


def check_backup(path):
    """Refuses to write a backup where it cannot be written or would destroy something else."""
    files.check_writable(path, regular=True)
    if os.path.exists(path) and os.path.getsize(path):
        opener = gzip.open if os.fspath(path).endswith(".gz") else open
        try:
            with opener(path, "rb") as file:
                ours = file.read(len(FIRST_LINE)) == FIRST_LINE.encode("ascii")
        except (OSError, EOFError, zlib.error):
            ours = False
        if not ours:
            raise ConverseError("%s: exists and is not a backup of this program; "
                                "name another file or remove it" % path)


def _check_same(name, proof, problem, depth, digits, as_printed):
    """Refuses to continue the proof of anything else, and names the first difference."""
    def facts(problem, **others):
        ranges = {key: "%s +- %s" % (centre, half)
                  for key, centre, half in zip(NAMES, *problem.decimals())}
        return {**others, **ranges}

    theirs = facts(proof.problem, kind=KINDS[proof.as_printed], program=proof.version,
                   digits=proof.digits, depth=proof.depth)
    ours = facts(problem, kind=KINDS[as_printed], program=__version__, digits=digits, depth=depth)
    for key, value in ours.items():
        if theirs[key] != value:
            raise ConverseError("%s: is of another run: its %s is %s, this one's is %s; "
                                "name the backup of this run or start anew"
                                % (name, key, theirs[key], value))
