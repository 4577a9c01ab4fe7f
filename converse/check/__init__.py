"""The checker: it verifies the theorems of proof files, maps, portraits and certificates of
existence, independently of the program that wrote them.

It shares no mathematics with the prover and imports nothing of the rest of converse, which uses of
it how calls run in processes (processes.py).  It needs nothing but Python, and takes numpy for
speed where there is one.  docs/proofs/checker.md has its proof, in steps that the modules cite, and
a table of the modules.
"""

from .command import main, parser
from .failures import Failure, NotConfirmed, Rejected, Unusable
from .limits import INTERRUPTED, NOT_CONFIRMED, PART, REJECTED, SPOT_CHECK, UNUSABLE, VERIFIED
from .progress import shown
from .run import Result, load, read, verify
from .torus_file import TorusClaim, read_torus
from .tree import check_tree
from .version import __version__
from .words import decimal_text

TYPE_CHECKING = False                   # as in typing
if TYPE_CHECKING:
    from .maps import ParameterMap
    from .tori import Verified, verify_torus

__all__ = ["Failure", "INTERRUPTED", "NOT_CONFIRMED", "NotConfirmed", "PART", "ParameterMap",
           "REJECTED", "Rejected", "Result", "SPOT_CHECK", "TorusClaim", "UNUSABLE", "Unusable",
           "VERIFIED", "Verified", "__version__", "check_tree", "decimal_text", "load", "main",
           "parser", "read", "read_torus", "shown", "verify", "verify_torus"]


def __getattr__(name):
    """Imports what only maps and certificates of existence need when it is asked for."""
    if name == "ParameterMap":
        from . import maps as home
    elif name in ("Verified", "verify_torus"):
        from . import tori as home
    else:
        raise AttributeError("module %r has no attribute %r" % (__name__, name))
    return getattr(home, name)
