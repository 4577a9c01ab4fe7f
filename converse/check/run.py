"""Verifying a whole file."""

import contextlib
import gzip
import itertools
import operator
import random
import zlib
from dataclasses import dataclass
from fractions import Fraction

from .claim import Claim
from .container import read_container
from .cover import symmetries_used
from .criterion import check_at_once
from .diagram import DIAGRAM, Diagram, drawn, proofs_of
from .failures import NotConfirmed, Rejected, Unusable, named
from .limits import MAX_BYTES, PART, SPOT_CHECK, VERIFIED
from .links import check_links
from .lockstep import make_lockstep
from .portrait import PORTRAIT, Portrait, portrayed
from .processes import mapped
from .progress import Bar, reason
from .proof_file import PROOF
from .torus_file import TORUS, TorusClaim
from .tree import check_mirror_images, check_tree, leaf_text
from .version import __version__
from .words import claimed, decimal_text, frame_text, range_text, successors
from .workers import Problems

CHUNKS, CHUNK = 8, 16                   # tasks of a process, about; leaves of one, with --exact
FAST_CHUNK = 1 << 10, 1 << 14           # least (a batch of Lockstep) and most of the fast path
FIRST_WORD = b"converse "               # of a file
VERDICTS = {VERIFIED: "verified", PART: "verified in part", SPOT_CHECK: "spot check"}


@dataclass(frozen=True)
class Result:
    """The result of a check in which nothing failed: true only if the whole claim is verified and
    its region is the whole torus, or all that a diagram or a portrait says is proved.  (All else is
    an exception.)

    Attributes
    ----------
    status
        VERIFIED, PART or SPOT_CHECK: the exit status of the command.
    verdict
        "verified", "verified in part" or "spot check".
    text
        The report.
    facts
        Of a certificate of existence, for each piece a Verified; else ().
    """

    status: int
    verdict: str
    text: str
    facts: tuple = ()

    def __bool__(self):
        return self.status == VERIFIED


def load(path):
    """The bytes of a proof file, a diagram, a portrait or a certificate of existence, uncompressed.

    Parameters
    ----------
    path
        The file, compressed by gzip or not.

    Raises
    ------
    Unusable, NotConfirmed
        The file cannot be read or is of another kind; or it exceeds the checker's limit.
    """
    try:
        with open(path, "rb") as file:
            packed = file.peek(2)[:2] == b"\x1f\x8b"
            stream = gzip.GzipFile(fileobj=file) if packed else file
            data = bytearray(stream.read(len(FIRST_WORD)))
            if data != FIRST_WORD and data[:1] != b"{":         # a map of 5.2.0
                raise Unusable("is not a proof file, a diagram, a portrait or a certificate")
            while (more := stream.read(1 << 20)) and len(data) <= MAX_BYTES:
                data += more
    except (EOFError, zlib.error, gzip.BadGzipFile):
        raise Unusable("the compressed file is damaged or truncated") from None
    except (OSError, ValueError) as error:
        raise Unusable("cannot be read (%s)" % reason(error)) from None
    if len(data) > MAX_BYTES:
        raise NotConfirmed("the file is larger than %d bytes, the checker's limit" % MAX_BYTES)
    return data


def read(path, *kinds):
    """Reads a proof file, a diagram, a portrait or a certificate of existence.  Nothing is
    verified.

    Parameters
    ----------
    path
        As of load().
    kinds
        Of these "proof", "diagram", "portrait" and "torus", the files that suit; by default all.

    Returns
    -------
    Claim, Diagram, Portrait or TorusClaim
        The content of the file, exact.

    Raises
    ------
    Rejected, NotConfirmed, Unusable
        The file is wrong, exceeds the checker's limits, or cannot be used.
    """
    return content(load(path), *kinds)


def content(data, *kinds):
    """As read(), of the bytes of a file, uncompressed."""
    return read_container(data, *[form for form in (PROOF, DIAGRAM, PORTRAIT, TORUS)
                                  if not kinds or form.kind in kinds])


def verify(path, jobs=1, sample=None, bar=False, exact=False):
    """Verifies a proof file, a diagram, a portrait or a certificate of existence.

    Parameters
    ----------
    path
        As of load().
    jobs
        The number of processes.
    sample
        Check only this number of leaves, chosen by chance: a spot check.  None: check all.  A
        certificate of existence takes no sample.
    bar
        Whether to show the progress on stderr.
    exact
        Whether to use integers alone, as without numpy.

    Returns
    -------
    Result
        True if the whole claim is verified.

    Raises
    ------
    TypeError, ValueError
        jobs or sample is not a whole number, or is below 1.
    Rejected, NotConfirmed, Unusable
        The theorem is not verified; the text says why.
    """
    if operator.index(jobs) < 1 or sample is not None and operator.index(sample) < 1:
        raise ValueError("jobs and sample are 1 or more")
    file = read(path)
    if isinstance(file, TorusClaim):
        if sample is not None:
            raise Unusable("a certificate of existence is verified as a whole: no --sample")
        (lines, facts), = check_tori([file], jobs, bar)
        return verdict(VERIFIED, lines, file, len(facts), len(file.pieces), facts)
    problems, theorem_of = problems_of(file)
    try:
        theorem = theorem_of(file)
    except ValueError:                  # of an integer that Python does not print
        raise NotConfirmed("a number of the theorem has too many digits for this checker") from None
    total = due = sum([claim.tree.count("P") for claim in problems.claims])
    chosen = range(total)
    if sample is not None:
        chosen = set(random.SystemRandom().sample(chosen, min(sample, total)))
    if chosen and not exact:
        problems.fast = make_lockstep(problems.claims)
    confirmed, pieces, doubles = check_leaves(problems, chosen, jobs, bar)
    status, lines = report(problems.claims, theorem,
                           problems.criterion(0) if theorem_of is claimed else None,
                           confirmed, pieces, doubles)
    if isinstance(file, Diagram) and sample is None:
        tori = [member.claim for member in file.tori]
        confirmed += sum([len(facts) for _, facts in check_tori(tori, jobs, bar)])
        due += sum([len(claim.pieces) for claim in tori])
        lines += ["Certificates of tori checked : %d" % len(tori)]
    if sample is not None:
        status, due = SPOT_CHECK, len(chosen)
        lines[:1] = ["Spot check of %d of %d proved leaves, NOT a verification: none of them fails."
                     % (confirmed, total), "What is claimed and NOT verified :"]
    return verdict(status, lines, file, confirmed, due)


def verdict(status, lines, file, confirmed, due, facts=()):
    """The Result, with this status only if as many leaves P, or pieces of a certificate, are
    confirmed as are due: all of the file, unless the check was a spot check.

    Raises RuntimeError otherwise, as the checker is at fault.
    """
    if confirmed != due:
        raise RuntimeError("%d of %d parts of the proof are confirmed" % (confirmed, due))
    return Result(status, VERDICTS[status], "\n".join([*lines, "SHA-256 : " + file.sha256]), facts)


def problems_of(file):
    """The Problems of a proof file, a diagram or a portrait, and the function that words its
    theorem.  Everything except the leaves, and the tori of a diagram, has been checked."""
    if isinstance(file, Portrait):
        if not any("P" in claim.tree for claim in file.claims):
            raise Rejected("no prism of the portrait is proved: it claims no theorem")
        return Problems(file.claims[:1]), portrayed
    if isinstance(file, Claim):
        check_tree(file)
        proofs, words = [file], claimed
    else:                               # whose trees were checked when it was read
        proofs, words = proofs_of(file), drawn
    problems = Problems(proofs)
    for proof, head in zip(proofs, sorted(set(problems.heads))):
        check_mirror_images(proof)
        check_links(proof, problems.criterion(head))
        with named(proof.where):
            check_at_once(problems.criterion(head))
    return problems, words


def check_tori(claims, jobs, bar):
    """What verify_torus returns of each certificate of existence."""
    if not claims:
        return []
    from .tori import verify_torus  # here, as its modules would delay all other checks
    with Bar(bar, len(claims)) as progress:
        found = []
        for n, claim in enumerate(claims, 1):
            with named("torus %d" % n if len(claims) > 1 else ""):
                found.append(verify_torus(claim, progress.tell, jobs))
    return found


def check_leaves(problems, chosen, jobs, bar):
    """Checks the leaves P with these numbers: how many are confirmed, of how many pieces, and how
    many were tried in doubles.  NotConfirmed: one is not excluded."""
    queue = ((n, leaf) for n, leaf in enumerate(problems.leaves()) if n in chosen)
    size = CHUNK
    if problems.fast:
        fewest, most = FAST_CHUNK
        if jobs == 1 and len(chosen) <= 4 * fewest:
            fewest = 4 * fewest         # one chunk: the last batches of each are small and dear
        size = min(max(len(chosen) // (CHUNKS * jobs), fewest), most)
    jobs = max(min(jobs, -(-len(chosen) // size)), 1)       # no more processes than chunks
    if problems.fast:
        problems.fast.memory = 2 * problems.fast.memory // max(jobs, 2)
    chunks = iter(lambda: list(itertools.islice(queue, size)), [])
    confirmed = [0, 0, 0]
    with Bar(bar, len(chosen)) as progress, \
            contextlib.closing(mapped(problems.check_chunk, chunks, jobs)) as results:
        for n, pieces, fast, failure in results:
            confirmed = [a + b for a, b in zip(confirmed, (n, pieces, n * fast))]
            progress.advance(n)
            if failure:
                n, (at, cell), why = failure
                before = sum([claim.counts["proved"] for claim in problems.claims[:at]])
                raise NotConfirmed(not_excluded(problems.claims[at], n - before, cell, why))
    return confirmed


def not_excluded(claim, ordinal, cell, why):
    """The message that a leaf is not confirmed, with the reason."""
    return "%s is not excluded: %s; the claim is false or its proof beyond the limits of this " \
        "checker" % (leaf_text(claim, "P", ordinal, cell), why)


def report(claims, theorem, criterion, confirmed, pieces, doubles):
    """The exit status and the lines of a report: the theorem, exactly as far as it was verified.

    claims: of the cells of a map, of the columns of a portrait, or of a proof file and its parts;
    theorem: what is claimed, in lines; criterion: of a proof file only; doubles: the number of
    leaves that were tried in doubles.
    """
    proved, skipped, linked, undecided = [
        sum([claim.counts.get(kind, 0) for claim in claims])
        for kind in ("proved", "symmetric", "linked", "undecided")]
    used = symmetries_used(claims[0]) if criterion else []      # else a part was rejected
    lines = ["Verified" + ", for a part of the torus only" * (used is None) + " :", *theorem, "",
             "Checker : converse-check " + __version__,
             "Method : Loewner criterion, multipliers, %s%sin integers%s" % (
                 "links between starting points, " * (linked > 0),
                 ("in doubles%s and where these fail " % (
                     " (%d leaves)" % doubles * (doubles < confirmed))) * (doubles > 0),
                 " of %d bits" % criterion.fixed.bits if criterion else "")]
    if criterion:
        places, claim = 9, criterion.claim
        bound = -(-criterion.B * 10 ** places // criterion.fixed.one)       # rounded up
        if used:
            lines += ["Successors : %s; all others by %s" % (", ".join(
                ["y' = " + frame_text(claim.rows)] * (claim.dimension > 1)
                + [range_text(*ends) for ends in successors(claim)]), " and ".join(used))]
        lines += ["x*%s : %s" % (part.where and " of " + part.where, " ".join(
            map(decimal_text, part.xstar[:claim.dimension]))) for part in claims]
        lines += ["B : %s" % decimal_text(Fraction(bound, 10 ** places))]
        if claim.alone is not None and claim.dimension == 2:
            lines += ["Alone : y%d, since no wave depends on both angles" % claim.alone]
    lines += ["Leaves : %d, of which %d proved%s%s and %d symmetric" % (
        proved + skipped + linked + undecided, proved,
        ", %d linked to other parts" % linked * (linked > 0),
        ", %d undecided" % undecided * (undecided > 0), skipped),
        "Proved leaves checked : %d, in %d piece%s" % (confirmed, pieces, "s" * (pieces != 1))]
    return PART if used is None else VERIFIED, lines
