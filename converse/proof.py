"""A proof: the tree of prisms with its statistics; how it is found, saved and loaded."""

import concurrent.futures
import contextlib
import gzip
import hashlib
import math
import os
import time
import zlib
from dataclasses import asdict, dataclass, field, fields, replace
from typing import Dict, Tuple

from . import __version__, files, tree
from .files import ConverseError
from .problem import NAMES, Problem, decimal_text, parse_number
from .search import (ALONE_SECONDS, LOOK_SECONDS, METHODS, Counts, Growth, Part, Search, Task,
                     count_workers)

BACKUP_SECONDS = 1.0
BACKUP_SHARE = 20                   # of the time, at most one part in so many goes into backups
LIMIT = 100000                      # of the depth and of the digits

FIRST_LINE = "converse proof 2"
KINDS = {False: "sound", True: "as printed, not a proof"}       # by as_printed
CONSTANTS = {                       # by method, the numbers of the theorem that are recorded
    "thesis": {"T": 2, "Tr-": 3, "Tr+": 4, "B": 5, "lambda-min": 6, "lambda-max": 7},
    "loewner": {"B": 5},
}


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
    method: str = "thesis"
    pending: Tuple[int, ...] = ()       # what is known of the untried prisms, in their order
    at_once: bool = False               # method Loewner: larger parameters cannot have tori, either
    sha256: str = field(default="", compare=False)      # of its file, if there is one

    @property
    def all_decided(self):
        """Is the tree whole and without an undecided prism?"""
        return "U" not in self.tree and tree.complete(self.tree)

    @property
    def no_tori(self):
        """Is it proved that there are no invariant tori?"""
        return self.all_decided and not self.as_printed

    @property
    def conclusion(self):
        if not self.all_decided:
            return "undecided"
        if self.as_printed:
            return "as printed"
        return "theorem" if self.problem.full_torus else "region"

    @property
    def arithmetic(self):
        return "%d decimal places" % self.digits if self.method == "thesis" else "double precision"

    @property
    def undecided(self):
        """The prisms on which the search gave up."""
        return list(tree.leaves(self.problem, self.tree, "U"))

    def report(self):
        from .report import report
        return report(self)

    def figure(self, target=None, *, ax=None, format=None):
        from .figure import figure
        return figure(self, target, ax, format)

    def _repr_svg_(self):
        from .figure import svg
        return svg(self)

    def _repr_html_(self):
        from .figure import html
        return html(self)

    def save(self, path):
        """Writes the proof file, compressed when the name ends in .gz; returns its SHA-256 (that
        of the uncompressed file)."""
        text = data = self._text().encode("utf-8")
        if os.fspath(path).endswith(".gz"):
            data = gzip.compress(text, 6, mtime=0)
        files.write(path, data)
        return hashlib.sha256(text).hexdigest()

    def _text(self):
        lines = [FIRST_LINE, "kind: " + KINDS[self.as_printed],
                 "program: converse " + self.version, "method: " + self.method,
                 "together: " + _yes(self.problem.together)]
        lines += ["%s: %s %s" % (name, decimal_text(centre), decimal_text(half))
                  for name, centre, half in zip(NAMES, self.problem.centre, self.problem.half)]
        lines += ["xstar: %s %s" % self.xstar, "depth: %d" % self.depth,
                  "digits: %d" % self.digits, "stubborn: " + _yes(self.stubborn),
                  "at once: " + _yes(self.at_once), "seconds: %.2f" % self.seconds,
                  "pending: " + " ".join(map(str, self.pending))]
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
            proof = cls(Problem(centre, half, tuple(comments), values["together"] == "yes"),
                        int(values["depth"]), int(values["digits"]), values["stubborn"] == "yes",
                        {kind: printed for printed, kind in KINDS.items()}[values["kind"]],
                        "".join(lines[start + 1:-3]), Counts(**counts), (x0, x1),
                        {name: values[name] for name in CONSTANTS[values["method"]]},
                        float(values["seconds"]), values["program"].split()[1], values["method"],
                        tuple(map(int, values["pending"].split())), values["at once"] == "yes",
                        _sha256(text))
            tree.complete(proof.tree)
        except (KeyError, IndexError, ValueError) as error:
            fail(start + 1, "the header or the tree makes no sense (%s)" % error)
        return proof


def _yes(truth):
    return "yes" if truth else "no"


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


def prove(problem, depth=None, digits=35, stubborn=False, as_printed=False, progress=None,
          backup=None, resume=None, on_leaf=None, time_limit=math.inf, method="thesis", jobs=None,
          executor=None):
    """Tries to prove that there are no invariant tori, and returns a Proof either way.

    method: "thesis", in decimals of so many digits, or "loewner", the sharper criterion in doubles.
    depth: the most cuts of a prism, by default 30, or 120 with the sharper method.
    A stubborn search goes on after an undecided prism.  as_printed follows the
    listing of the thesis to the letter, which proves nothing.
    progress(fraction, counts) is called a few times a second.
    backup names a file that is kept up to date, and resume a proof (or its file) to continue.
    on_leaf(leaf, steps) is called for every leaf of the tree as it is decided.
    time_limit: after about so many seconds of this run the search is left as it is.
    jobs: how many workers at a time, by default one per core; executor: a
    concurrent.futures.Executor whose workers they are, by default threads of this process (with
    on_leaf there is only one).  The result does not depend on either.

    ConverseError, MemoryError: nothing is lost of the backup; ValueError: an argument is wrong.
    """
    if method not in METHODS:
        raise ValueError("the method is one of %s, not %r" % (", ".join(METHODS), method))
    if depth is None:
        depth = 30 if method == "thesis" else 120
    if not 1 <= digits <= LIMIT:
        raise ValueError("digits must be from 1 to %d" % LIMIT)
    if not 0 <= depth <= LIMIT:
        raise ValueError("depth must be from 0 to %d" % LIMIT)
    if method == "thesis" and problem.together:
        raise ValueError("parameters that move together need the method loewner")
    if method == "loewner" and as_printed:
        raise ValueError("only the method thesis was ever printed")
    if jobs is None:
        jobs = count_workers(executor)
    if jobs < 1:
        raise ValueError("there must be a worker: jobs must be 1 or more")
    began = time.monotonic()
    end = began + time_limit
    keep = backup is not None
    if keep:
        check_backup(backup)
    with contextlib.ExitStack() as stack:
        if keep:
            stack.enter_context(files.lock(backup))
        name = "the proof to resume"
        if resume is not None and not isinstance(resume, Proof):
            name, resume = os.fspath(resume), Proof.load(resume)
        if resume:
            _check_same(name, resume, problem, method, depth, digits, as_printed)
            began -= resume.seconds
        centre, half = map(tuple, problem.decimals())
        xstar = resume.xstar if resume else None
        before = time.monotonic()
        search = Search(Task(centre, half, xstar, problem.together, method, depth, digits,
                             stubborn, as_printed))
        # Every worker makes a search of its own: that must pay.
        alone = time.monotonic() + max(ALONE_SECONDS, 10 * (time.monotonic() - before))
        xstar = search.constant(0), search.constant(1)
        task = Task(centre, half, xstar, problem.together, method, depth, digits, stubborn,
                    as_printed)
        growth = Growth(task, search, _parts(name, resume, search) if resume
                        else [Part([(*tree.ROOT, 0)])], executor, jobs)
        if resume:
            growth.counts = resume.counts
            growth.volume = sum(math.ldexp(1.0, -sum(cuts)) for kind, (_, cuts)
                                in tree.cells(resume.tree) if kind != tree.UNTRIED)
        constants = {name: search.constant(which) for name, which in CONSTANTS[method].items()}
        walk, prism = tree.Walk(), tree.prisms(problem)
        seen = 0

        def snapshot():
            text, pending = growth.text()
            return Proof(problem, depth, digits, stubborn, as_printed, text, growth.counts, xstar,
                         constants, time.monotonic() - began, method=method,
                         pending=tuple(pending), at_once=search.at_once)

        def look(new=True):
            """Follows the tree since the last look."""
            nonlocal seen
            text, _ = growth.text()
            for kind, cell in walk.feed(text[seen:]):
                if new:
                    on_leaf(tree.Leaf(kind, *prism(cell), sum(cell[1])), growth.steps)
            seen = len(text)

        if on_leaf:
            look(new=False)             # the part that was restored
        if progress:
            progress(growth.volume, growth.counts)
        pause = BACKUP_SECONDS
        saved = time.monotonic()
        if keep:
            snapshot().save(backup)
        try:
            while not growth.finished and time.monotonic() < end:
                now = time.monotonic()
                if on_leaf:
                    growth.alone(LOOK_SECONDS, 1)
                    look()
                elif jobs == 1 and executor is None:
                    growth.alone(min(LOOK_SECONDS, end - now))
                elif growth.executor is None and now < alone:
                    growth.alone(min(LOOK_SECONDS, alone - now, end - now))
                else:
                    if growth.executor is None:
                        growth.executor = stack.enter_context(
                            concurrent.futures.ThreadPoolExecutor(jobs))
                    growth.together(min(LOOK_SECONDS, end - now))
                if progress:
                    progress(growth.volume, growth.counts)
                if keep and time.monotonic() - saved >= pause:
                    now = time.monotonic()
                    snapshot().save(backup)
                    saved = time.monotonic()
                    pause = max(BACKUP_SECONDS, BACKUP_SHARE * (saved - now))
        except BaseException:           # what stands is saved, if it is whole; else the last backup
            with contextlib.suppress(AssertionError):
                growth.settle()
                if keep:
                    snapshot().save(backup)
            raise
        growth.settle()
        proof = snapshot()
        return replace(proof, sha256=proof.save(backup)) if keep else proof


def _parts(name, proof, search):
    """The parts of an unfinished tree, if it is one of such a search."""
    found = dict.fromkeys(("cuts", "proved", "symmetric", "undecided", "most_cuts"), 0)
    kinds = {"P": "proved", "S": "symmetric", "U": "undecided"}
    axes = "01" if proof.method == "thesis" else "012" if proof.problem.together else tree.CUTS
    walk, hints, parts, begin = tree.Walk(), iter(proof.pending), [], 0
    good = True
    for position, node in enumerate(proof.tree):
        if node in tree.CUTS:
            found["cuts"] += 1
            good = good and node in axes
        for kind, (index, cuts) in walk.feed(node):
            if kind == tree.UNTRIED:
                parts += [Part([], proof.tree[begin:position]),
                          Part([(index, cuts, next(hints, 0))])]
                begin = position + 1
                continue
            found[kinds[kind]] += 1
            good = good and sum(cuts) <= proof.depth
            if kind == "P":
                found["most_cuts"] = max(found["most_cuts"], sum(cuts))
            elif kind == "S":
                good = good and search.symmetric and tree.above_diagonal((index, cuts))
    if not good or any(getattr(proof.counts, name) != value for name, value in found.items()):
        raise ConverseError("%s: %s; use an intact copy or start anew"
                            % (name, "the tree does not belong to a search of this kind"))
    return parts + [Part([], proof.tree[begin:]),
                    Part([(*cell, next(hints, 0)) for cell in reversed(walk.pending)])]


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


def _check_same(name, proof, problem, method, depth, digits, as_printed):
    """Refuses to continue the proof of anything else, and names the first difference."""
    def facts(problem, **others):
        ranges = {key: "%s +- %s" % (centre, half)
                  for key, centre, half in zip(NAMES, *problem.decimals())}
        return {**others, **ranges, "together": _yes(problem.together)}

    theirs = facts(proof.problem, kind=KINDS[proof.as_printed], program=proof.version,
                   method=proof.method, digits=proof.digits, depth=proof.depth)
    ours = facts(problem, kind=KINDS[as_printed], program=__version__, method=method,
                 digits=digits, depth=depth)
    for key, value in ours.items():
        if theirs[key] != value:
            raise ConverseError("%s: is of another run: its %s is %s, this one's is %s; "
                                "name the backup of this run or start anew"
                                % (name, key, theirs[key], value))
