"""Verifying a whole file."""

import contextlib
import itertools
import random
from dataclasses import dataclass

from .criterion import check_at_once
from .failures import NotConfirmed, Unusable
from .limits import PART, SPOT_CHECK, VERIFIED
from .links import check_links
from .lockstep import make_lockstep
from .maps import Map, check_map, mapped, read_map
from .portrait import Portrait, portrayed, read_portrait
from .progress import Bar
from .proof_file import PORTRAIT_MAGIC, TORUS_MAGIC, load, read_proof
from .state import State
from .tori import verify_torus
from .torus_file import TorusClaim, read_torus
from .tree import check_mirror_images, check_tree
from .words import claimed, not_excluded, report
from .workers import Problems, check_all

CHUNKS, CHUNK = 8, 16                   # tasks of a process, about; leaves of one, with --exact
FAST_CHUNK = 1 << 8, 1 << 14            # least and most of the fast path
VERDICTS = {VERIFIED: "verified", PART: "verified in part", SPOT_CHECK: "spot check"}


@dataclass(frozen=True)
class Result:
    """What came of a check in which nothing failed: true only if the whole claim is verified and
    its region is the whole torus, or all that a map or a portrait says is proved.  (All else is an
    exception.)
    """

    status: int                         # VERIFIED, PART or SPOT_CHECK: the exit status, too
    verdict: str                        # "verified", "verified in part" or "spot check"
    text: str                           # the report
    facts: tuple = ()                   # of a certificate of existence: of each piece a Verified

    def __bool__(self):
        return self.status == VERIFIED


def read(path):
    """Reads a proof file, a map, a portrait or a certificate of existence; nothing in it is
    believed but what the claim is."""
    data = load(path)
    if data.startswith(TORUS_MAGIC):
        return read_torus(data)
    if data.startswith(PORTRAIT_MAGIC):
        return read_portrait(data)
    return read_map(data) if data.startswith(b"{") else read_proof(data)


def verify(path, jobs=1, sample=None, state=None, bar=False, exact=False):
    """Verifies a proof file, a map, a portrait or a certificate of existence: a Result; else
    Rejected, NotConfirmed or Unusable is raised.

    jobs: processes.  sample: so many leaves only, chosen by chance: a spot check.
    state: a file that remembers what was confirmed, so that an interrupted check can go on; it
    is kept in the end.  (A certificate of existence is verified whole: its pieces by jobs
    processes.)  bar: show
    the progress on stderr.  exact: in integers alone, as where
    there is no numpy.
    """
    if jobs < 1 or sample is not None and sample < 1:
        raise ValueError("jobs and sample are 1 or more")
    if sample is not None and state is not None:
        raise Unusable("a spot check keeps no state; give --sample or --state")
    file = read(path)
    if isinstance(file, TorusClaim):
        if sample is not None or state is not None:
            raise Unusable("a certificate of existence is verified as a whole: no --sample, no "
                           "--state")
        with Bar((file,) if bar else (), 1) as progress:
            lines, facts = verify_torus(file, progress.tell, jobs)
        return Result(VERIFIED, "verified", "\n".join([*lines, "SHA-256 : " + file.sha256]), facts)
    if isinstance(file, Map):
        problems = Problems(file.claims, check_map(file))
    elif isinstance(file, Portrait):
        problems = Problems(file.claims)
    else:
        check_tree(file)
        check_mirror_images(file)
        problems = Problems((file, *file.parts))
        check_links(file, problems.criterion(0))
        check_at_once(problems.criterion(0))
    if not exact and problems.claims:
        problems.fast = make_lockstep(problems.claims)
    proved = [claim.counts["proved"] for claim in problems.claims]
    done = State(state, file.sha256, sum(proved))
    earlier = done.confirmed
    chosen = range(earlier, sum(proved))
    if sample is not None:
        chosen = set(random.SystemRandom().sample(chosen, min(sample, sum(proved))))

    def work():
        return ((n, leaf) for n, leaf in enumerate(problems.leaves()) if n in chosen)

    queue = work()
    size = CHUNK
    if problems.fast:
        fewest, most = FAST_CHUNK
        size = min(max(len(chosen) // (CHUNKS * jobs), fewest), most)
    chunks = iter(lambda: list(itertools.islice(queue, size)), [])
    try:
        with Bar(work() if bar else (), len(chosen)) as progress, \
                contextlib.closing(check_all(chunks, jobs, problems)) as results:
            for n, spent, pieces, failure in results:
                done.advance(n, pieces)
                progress.advance(n, spent)
                if failure:
                    n, (at, cell), why = failure
                    claim = problems.claims[at]
                    raise NotConfirmed(not_excluded(claim, n - sum(proved[:at]), cell, why))
    finally:
        done.save()
    theorem_of = {Map: mapped, Portrait: portrayed}.get(type(file), claimed)
    status, lines = report(problems.claims, theorem_of(file),
                           problems.criterion(0) if theorem_of is claimed else None,
                           done.confirmed, done.pieces, bool(problems.fast))
    if sample is not None:
        status = SPOT_CHECK
        lines[:1] = ["Spot check of %d of %d proved leaves, NOT a verification: none of them fails."
                     % (done.confirmed, sum(proved)), "What is claimed and NOT verified :"]
    elif earlier:
        lines[0] = lines[0].replace(" :", ", %d of %d leaves by an earlier run :"
                                    % (earlier, sum(proved)))
        lines += ["Of these, by an earlier run whose state was believed : %d" % earlier]
    return Result(status, VERDICTS[status], "\n".join([*lines, "SHA-256 : " + file.sha256]))
