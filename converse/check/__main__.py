"""python -m converse.check: the command."""

import sys

if not __package__:
    sys.exit("converse-check: this folder is a package; run it by python -m converse.check, or "
             "make one file of it that runs alone: make checker")

from .command import main  # noqa: E402  (only then)

sys.exit(main())
