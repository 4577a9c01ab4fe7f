"""The checker: it verifies the theorems of proof files, diagrams, portraits and certificates of
existence, independently of the program that wrote them.

It shares no mathematics with the prover and imports nothing of the rest of converse, which uses of
it the reader of files (container.py) and how calls run in processes (processes.py).  It needs
nothing but Python, and takes numpy for speed where there is one.  docs/proofs/checker.md has its
proof, in steps that the modules cite, and a table of the modules.
"""

from .command import main, parser
from .diagram import Diagram, Family, box_words, overlap, solution, union
from .failures import Failure, NotConfirmed, Rejected, Unusable
from .limits import INTERRUPTED, NOT_CONFIRMED, PART, REJECTED, SPOT_CHECK, UNUSABLE, VERIFIED
from .progress import shown
from .run import Result, content, load, read, verify
from .torus_file import TorusClaim
from .tree import check_tree
from .version import __version__
from .words import decimal_text, exact_text

TYPE_CHECKING = False                   # as in typing
if TYPE_CHECKING:
    from .tori import Verified, verify_torus

__all__ = ["Diagram", "Failure", "Family", "INTERRUPTED", "NOT_CONFIRMED", "NotConfirmed", "PART",
           "REJECTED", "Rejected", "Result", "SPOT_CHECK", "TorusClaim", "UNUSABLE", "Unusable",
           "VERIFIED", "Verified", "__version__", "box_words", "check_tree", "content",
           "decimal_text", "exact_text", "load", "main", "overlap", "parser", "read", "shown",
           "solution", "union", "verify", "verify_torus"]


def __getattr__(name):
    """Imports what only certificates of existence need when it is asked for."""
    if name in ("Verified", "verify_torus"):
        from . import tori
        return getattr(tori, name)
    raise AttributeError("module %r has no attribute %r" % (__name__, name))
