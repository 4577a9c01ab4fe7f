"""python -m converse: the command."""

import sys

from .commands.prove import main

sys.exit(main())
