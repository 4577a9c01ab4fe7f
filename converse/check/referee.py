"""The exact part of the checker: it verifies the theorem of one proof file in integers, leaf after
leaf, in one process; of maps it reads none.

It needs nothing but Python, and imports nothing of the program that wrote the file.  Its proof is
docs/checker.md, whose steps are cited.
"""

import sys

from .criterion import Criterion, check_at_once
from .failures import Failure, NotConfirmed, complain
from .limits import INTERRUPTED, UNUSABLE
from .links import check_links
from .proof_file import load, read_proof
from .tree import check_mirror_images, check_tree, leaves, trees
from .words import claimed, not_excluded, report


def referee(path):
    """Verifies a proof file: (exit status, report); else a Failure is raised."""
    claim = read_proof(load(path))
    check_tree(claim)
    check_mirror_images(claim)
    criterion = Criterion(claim)
    check_links(claim, criterion)
    check_at_once(criterion)
    confirmed = pieces = 0
    for part, letters in trees(claim):
        ours, before = criterion.of_part(part), confirmed
        for position, cell in leaves(part.tree, kinds="PS" + letters):
            if part.tree[position] == "P":
                why, tried = ours.excluded(cell)
                if why:
                    raise NotConfirmed(not_excluded(part, confirmed - before, cell, why))
                confirmed, pieces = confirmed + 1, pieces + tried
    status, lines = report((claim, *claim.parts), claimed(claim), criterion, confirmed, pieces)
    return status, "\n".join([*lines, "SHA-256 : " + claim.sha256])


def referee_main(argv=None):
    """Runs the command and returns its exit status, one of those of converse-check."""
    paths = sys.argv[1:] if argv is None else argv
    if len(paths) != 1 or paths[0].startswith("-"):
        complain("usage: python referee.py FILE")
        return UNUSABLE
    try:
        status, text = referee(paths[0])
        print(text, flush=True)
        return status
    except Failure as error:
        status, message = error.status, error.word + str(error)
    except KeyboardInterrupt:
        status, message = INTERRUPTED + 2, "interrupted; nothing was verified"
    except Exception as error:                  # whatever went wrong must not look like success
        status, message = UNUSABLE, "the checker failed (%s: %s)" % (type(error).__name__, error)
    complain(paths[0] + ": " + message)
    return status
