"""Tori along the rays of a map of a plane, of rotation vectors that suit each ray.

    python experiments/rays.py MAP DIRECTORY [--points N]

On some rays of the map (converse-map) rotation vectors are looked for whose tori last long
(vectors.py), and written to DIRECTORY/vectors.txt.  On all rays the one seen to last longest
is proved, for amplitudes as large as a search on a grid of N points reaches, and its certificate
written into the directory.  What is there, the list or a certificate, is not made again.
`converse-map --tori DIRECTORY -g FILE MAP` draws the tori.
"""

import os
import sys
from fractions import Fraction

import vectors

from converse import orbits, tori
from converse.commands.common import Parser, ended
from converse.model.map import THESIS, SymplecticMap
from converse.model.problem import Problem
from converse.parameters.map import ParameterMap
from converse.parameters.region import direction
from converse.parameters.tori import prove_tori, rays
from converse.storage import files
from converse.tori.torus import family

SEARCHED = 2                            # intervals of a face between the rays of a search, at most
POINTS = 1 << 18
REACH = 0.6                             # of where a torus is seen to end: where a proof is tried


def potential(d, radius):
    """In the direction d, at a radius."""
    problem = Problem(SymplecticMap(THESIS, [Fraction("%.5g" % radius) * each for each in d]))
    return orbits.potential.Fourier.of(family(problem)[0])


def catalogue(found, path):
    """The rotation vectors that last longest on some of the map's rays, from a file or written
    there."""
    if not os.path.exists(path):
        known = set()
        for face, place in rays(found):
            d = direction(found.directions[face], place)
            if place[0].denominator <= SEARCHED and potential(d, 1).n == 2:
                for multiple, rotation in vectors.choose(
                        potential(d, found.estimate[face][place]), ("V1", "seven")):
                    known.add(rotation.text())
                    print("(%s): %.4f  %s" % (", ".join(map(str, d)), multiple, rotation.text()),
                          flush=True)
        files.write_text(path, "".join("%s\n" % text for text in sorted(known)))
    return [tori.read_rotation(line) for line in files.read_text(
        path, "list of rotation vectors", ": is no such list").splitlines()]


def run(options):
    found = ParameterMap.load(options.map)
    os.makedirs(options.directory, exist_ok=True)
    known = catalogue(found, os.path.join(options.directory, "vectors.txt"))

    def chosen(d, estimate):
        here = potential(d, estimate)
        if here.n == 1:
            return [(tori.read_rotation("golden"), estimate)]
        multiple, best = vectors.ranked(here, known)[0]
        print("(%s), up to %.4f: %.4f  %s" % (", ".join(map(str, d)), estimate, multiple,
                                              best.text()), flush=True)
        return [(best, REACH * multiple * estimate)]

    prove_tori(found, options.directory, vectors=chosen, points=options.points)
    return 0


def parser():
    p = Parser(prog="rays.py", description="Proves tori along the rays of a map.")
    p.add_argument("map", metavar="MAP", help="of a plane, by converse-map")
    p.add_argument("directory", metavar="DIRECTORY", help="of certificates")
    p.add_argument("--points", type=int, default=POINTS, metavar="N",
                   help="of the grid on which a torus is looked for, at most (%(default)s)")
    return p


def main(argv=None):
    return ended("rays.py", lambda: run(parser().parse_args(argv)),
                 lambda: "the certificates that were written are kept")


if __name__ == "__main__":
    sys.exit(main())
