"""python -m converse: the command."""

import sys

from .commands import start_prove

sys.exit(start_prove())
