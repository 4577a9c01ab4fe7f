"""Draws anew the pictures of docs/ that are computed within some minutes:  make figures

Their captions are those of the pages.
"""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

from converse import orbits, prove, read_input
from converse.orbits.pictures import states_picture
from converse.storage import files

DOCS = Path(__file__).resolve().parent
BUILD = DOCS.parent / "build"
PROOFS = {                              # the options of each
    "trig274": {}, "trig148": {"method": "loewner", "together": True},
    "standard-63-64": {"method": "loewner"},
}
GHOST = 0.0075, 0.0175
SPIRAL = (1432, 1897), 2513             # a rotation vector near the spiral mean's
EXPERIMENTS = {                         # what each writes, and its arguments
    "smoothness": [BUILD], "minimizing": [BUILD],
    "hedlund": ["--figure", BUILD / "hedlund.svg"],
}


def main():
    for name, options in PROOFS.items():
        problem = read_input(DOCS.parent / "inputs" / (name + ".in"))
        problem = replace(problem, together=options.pop("together", False))
        proof = prove(problem, **options)
        if not proof.no_tori:
            sys.exit("%s: nothing is proved that could be drawn" % name)
        proof.figure(DOCS / (name + ".svg"), caption=False)
    family = orbits.follow(orbits.trig, *SPIRAL, GHOST)
    files.write(DOCS / "ghost.svg", states_picture(family, caption=False))
    BUILD.mkdir(exist_ok=True)
    for name, arguments in EXPERIMENTS.items():
        script = DOCS.parent / "experiments" / (name + ".py")
        subprocess.run([sys.executable, script, *arguments], check=True)
        files.write(DOCS / (name + ".svg"), (BUILD / (name + ".svg")).read_bytes())


if __name__ == "__main__":
    main()
