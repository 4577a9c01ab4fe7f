"""python -m converse: the command."""

import sys

from .cli import main

sys.exit(main())
