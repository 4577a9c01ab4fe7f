"""Draws the figures of the thesis's chapter 2 and Appendix A into a directory; half a minute.

    python experiments/thesis DIR [--format svg|png|pdf]
"""

import argparse
import sys
from pathlib import Path

from converse.draw import plot
from converse.storage.files import ConverseError

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from thesis import figures  # noqa: E402


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("directory", metavar="DIR", help="where to write them")
    parser.add_argument("--format", choices=plot.FORMATS, default=plot.FORMATS[0],
                        help="of the figures (%(default)s)")
    options = parser.parse_args()
    try:
        figures(options.directory, kind=options.format, progress=print)
    except ConverseError as error:
        sys.exit("experiments/thesis: %s" % error)


if __name__ == "__main__":
    main()
