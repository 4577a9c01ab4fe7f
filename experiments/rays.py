"""Tori along the rays of a map of a plane, of rotation vectors that suit each ray.

    python experiments/rays.py MAP DIRECTORY [--points N] [--named]

On some rays of the map (converse-map) a search (vectors.py) looks for rotation vectors whose tori
last long, and writes them to DIRECTORY/vectors.txt.  With --named a few vectors that suit the line
a = b = c/2 are tried instead of a search.  On each ray the torus that is seen to last longest is
proved, for amplitudes as large as a search on a grid of N points reaches.  Its certificate is
written into the directory.  A list or a certificate that exists is not made again.
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
from converse.parameters.tori import ENDING
from converse.storage import files
from converse.tori.torus import family

FINEST = 8                              # The rays cut a face into at most this many intervals.
SEARCHED = 2                            # The rays of a search cut it into at most this many.
POINTS = 1 << 18
NAMED = {1: ("golden",), 2: ("T49", "V1", "seven")}     # by the number of angles
UNIT = Fraction(1, 10 ** 5)             # Radii are multiples of it.
REACH = 0.6                             # A proof is tried at this part of the radius where a torus
                                        # is seen to end.


def potential(d, radius):
    """In the direction d, at a radius."""
    problem = Problem(SymplecticMap(THESIS, [Fraction("%.5g" % radius) * each for each in d]))
    return orbits.potential.Fourier.of(family(problem)[0])


def rays(found):
    """The (face, s) of the directions in which tori are looked for, each direction once, those of a
    coarse grid first."""
    known = set()
    places = [(s.denominator, face, s) for face, estimate in enumerate(found.estimate)
              for s in estimate]
    for denominator, face, s in sorted(places):
        d = direction(found.directions[face], s)
        if denominator <= FINEST and d not in known:
            known.add(d)
            yield face, s


def prove_tori(found, directory, rotations, points):
    """Proves a torus on each ray of a map that lacks a certificate in the directory, and writes its
    certificate there, named by the face and the place of the ray.

    rotations(d, estimate) -- the rotation vectors that are tried along the direction d, where the
        frontier is estimated at so many times it, and the radius up to which each is tried
    points -- of the grid on which a torus is looked for, at most

    A ray on which nothing is proved stays without a certificate."""
    for face, s in rays(found):
        path = os.path.join(directory, "%d-%s%s" % (face, float(s), ENDING))
        if not os.path.exists(path):
            d = direction(found.directions[face], s)
            best, reached = None, 0.0
            for rotation, top in rotations(d, found.estimated(face, s)):
                proof, reached = vectors.highest(lambda radius: problem(d, radius), rotation, top,
                                                 points, reached)
                best = proof or best
            if best:
                best.save(path)


def problem(d, radius):
    exact = max(1, round(radius / UNIT)) * UNIT         # at 0 the map has no waves
    return Problem(SymplecticMap(THESIS, [exact * x for x in d]))


def named(d, estimate):
    """The rotation vectors of --named, up to the estimate."""
    n = potential(d, 1).n
    return [(tori.read_rotation(name, n), estimate) for name in NAMED[n]]


def catalogue(found, path):
    """The rotation vectors that last longest on some of the map's rays, from a file or written
    there."""
    if not os.path.exists(path):
        known = set()
        for face, s in rays(found):
            d = direction(found.directions[face], s)
            if s.denominator <= SEARCHED and potential(d, 1).n == 2:
                for multiple, rotation in vectors.choose(
                        potential(d, found.estimate[face][s]), ("V1", "seven")):
                    known.add(rotation.text())
                    print("(%s): %.4f  %s" % (", ".join(map(str, d)), multiple, rotation.text()),
                          flush=True)
        files.write_text(path, "".join("%s\n" % text for text in sorted(known)))
    return [tori.read_rotation(line) for line in files.read_text(
        path, "list of rotation vectors", ": is no such list").splitlines()]


def run(options):
    found = ParameterMap.load(options.map)
    os.makedirs(options.directory, exist_ok=True)
    if options.named:
        prove_tori(found, options.directory, named, options.points)
        return 0
    known = catalogue(found, os.path.join(options.directory, "vectors.txt"))

    def chosen(d, estimate):
        here = potential(d, estimate)
        if here.n == 1:
            return [(tori.read_rotation("golden"), estimate)]
        multiple, best = vectors.ranked(here, known)[0]
        print("(%s), up to %.4f: %.4f  %s" % (", ".join(map(str, d)), estimate, multiple,
                                              best.text()), flush=True)
        return [(best, REACH * multiple * estimate)]

    prove_tori(found, options.directory, chosen, options.points)
    return 0


def parser():
    p = Parser(prog="rays.py", description="Proves tori along the rays of a map.")
    p.add_argument("map", metavar="MAP", help="of a plane, by converse-map")
    p.add_argument("directory", metavar="DIRECTORY", help="of certificates")
    p.add_argument("--named", action="store_true", help="try golden, or T49, V1 and seven")
    p.add_argument("--points", type=int, default=POINTS, metavar="N",
                   help="of the grid on which a torus is looked for, at most (%(default)s)")
    return p


def main(argv=None):
    return ended("rays.py", lambda: run(parser().parse_args(argv)),
                 lambda: "the certificates that were written are kept")


if __name__ == "__main__":
    sys.exit(main())
