"""Rotation vectors whose tori last long, and how far these tori are proved, for any potential.

    python experiments/vectors.py FILE NAME VALUE [--points N] [--save FILE]

Of the potential of an input file the parameter NAME varies, from VALUE down.  The onsets of
rational rotation vectors (orbits.onset) tell in floating-point numbers for which vectors tori last
longest; near the best ones vectors of number fields are taken (near.py) and judged by their own
approximants.  The best is proved for values of NAME as large as a search on
a grid of N points reaches.  All but the proof is seen, not proved.
"""

import math
import random
import sys
import time
from fractions import Fraction

import numpy as np
from near import near
from toughest import SPREAD, rational

from converse import orbits, tori
from converse.commands.common import Parser, ended
from converse.model.exact import exact, short_text
from converse.model.map import SymplecticMap
from converse.storage.files import ConverseError

COUNT, ROUNDS, PARENTS, CHILDREN = 300, 4, 6, 4     # of a search
SIZES = 150, 300                        # of the q that are tried first
JUDGED = 200, 700                      # of the q of approximants
APPROXIMANTS = 3
PLACES, TOLERANCES = 2, ("0.003", "0.001")          # where vectors are taken, and how near
APART = 0.004                           # of these places
TOP = 1.1                               # times the amplitudes given: where a search ends
BISECTIONS = 6
POINTS = 1 << 20
PARTS = 0.985, 0.95, 0.9, 0.8, 0.65     # of the value to which tori are found: proofs are tried


def onset(potential, w, q):
    """The onset of an orbit of size about q near the rotation vector w, as a multiple of the
    potential; 0 where continuation loses it."""
    try:
        return orbits.onset(potential, *rational(w, q), step=0.06 * TOP, width=0.002 * TOP,
                            top=TOP)[0].eps
    except ConverseError:
        return 0.0


def search(potential, enough=math.inf):
    """(onset, w) of the rational vectors that last longest, as far as a search sees, which ends
    with one that lasts for `enough` times the potential; the best first."""
    rng = random.Random(1)

    def tried(w, q):
        p, q = rational(w, q)
        w = tuple(Fraction(each, q) for each in p)
        return onset(potential, w, q), w

    found = []
    for k in range(1, COUNT + 1):
        w = [k * x % 1 for x in SPREAD[:potential.n]]
        if w[-1] > 0.5:                 # time's direction turns one into the other
            w = [1 - x for x in w]
        found.append(tried(w, rng.randint(*SIZES)))
        if found[-1][0] >= enough:
            return found[-1:]
    best = sorted(found, reverse=True)[:PARENTS]
    for k in range(ROUNDS):
        if best[0][0] >= enough:
            break
        best += [tried([rng.gauss(float(x), 0.02 / 2 ** k) for x in w],
                       (k + 1) * rng.randint(250, 500))
                 for _, w in best for _ in range(CHILDREN)]
        best = sorted(set(best), reverse=True)[:PARENTS]
    return best


def judge(potential, rotation):
    """About the multiple of the potential up to which a torus of this rotation vector lasts: the
    median of its best approximants' onsets."""
    w = np.array(rotation.floats)
    q = np.arange(*JUDGED)
    p = np.round(q[:, None] * w)
    off = abs(q[:, None] * w - p).max(1) * q ** (1 / len(w))
    best = [i for i in np.argsort(off, kind="stable")[:8] if math.gcd(*map(int, p[i]), int(q[i]))
            == 1][:APPROXIMANTS]
    return float(np.median([onset(potential, p[i] / q[i], int(q[i])) for i in best]))


def choose(potential, names=()):
    """(multiple, Rotation) of vectors of number fields near the best of a search, and of those that
    are named; the best first."""
    places = []
    for _, w in search(potential):
        if all(max(abs(x - y) for x, y in zip(w, other)) > APART for other in places):
            places.append(w)
    vectors = [tori.read_rotation(name, potential.n) for name in names]
    for w in places[:PLACES]:
        for tolerance in TOLERANCES:
            try:
                vectors.append(near(*(round(x, 6) for x in w), tolerance=tolerance))
            except ValueError:          # there is none so near
                pass
    return ranked(potential, {rotation.text(): rotation for rotation in vectors}.values())


def ranked(potential, vectors):
    """(multiple, Rotation) of rotation vectors, the best first."""
    return sorted(((judge(potential, rotation), rotation) for rotation in vectors),
                  key=lambda each: -each[0])


def last(path, name, value):
    """About the largest value of the parameter below the given one for which a vector is seen whose
    torus is there; None: for none that was tried."""
    low, high = 0.0, value
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        seen = search(potential_at(path, name, middle), enough=1.0)[0][0] >= 1
        low, high = (middle, high) if seen else (low, middle)
        print("%s = %.4g: %s" % (name, middle, "tori are seen" if seen else "none is seen"),
              flush=True)
    return low or None


def potential_at(path, name, value):
    return orbits.potential.known(map_at(path, name, value))


def highest(problem_at, rotation, top, points, least=0.0):
    """A proof of a torus of this rotation vector for the problem at a value above `least` and not
    above `top`, the largest of a few values that are tried, and the value; or (None, least).

    points -- of the grid on which the torus is looked for, at most: effort"""
    whole = top
    parts = (1.0, *PARTS)
    while parts and top * parts[0] > least:
        value, parts = top * parts[0], parts[1:]
        try:
            return tori.prove(problem_at(value), rotation, points=points), value
        except tori.NotFound as failure:
            if failure.reached and top == whole:        # the search got so far
                top, parts = value * failure.reached, PARTS
        except tori.NotProved:
            pass
    return None, least


def map_at(path, name, value):
    return SymplecticMap.read(path).at(**{name: exact("%.6g" % value)})


def run(options):
    path, name = options.file, options.name
    value = last(path, name, float(options.value))
    if value is None:
        print("no torus is seen for %s from 0 to %s" % (name, short_text(options.value)))
        return 1
    here = potential_at(path, name, value)
    found = choose(here, ("golden", "silver") if here.n == 1 else ("V1", "seven"))
    print("%s = %.4g: tori are seen up to so many times the potential" % (name, value))
    for multiple, rotation in found:
        print("    %.4f  (%s)  %s" % (multiple, ", ".join("%.6f" % w for w in rotation.floats),
                                      rotation.text()), flush=True)
    began = time.process_time()
    proof, reached = highest(lambda x: map_at(path, name, x), found[0][1], value,
                             options.points)
    if proof is None:
        print("nothing is proved")
        return 1
    print("proved at %s = %.4g: %d modes, residual %.1e, needed %.1e, %.0f s\n    --rotation '%s'"
          % (name, reached, len(proof.torus.k), proof.residual, proof.needed,
             time.process_time() - began, proof.rotation.text()))
    if options.save:
        proof.save(options.save)
    return 0


def parser():
    p = Parser(prog="vectors.py", description="Looks for rotation vectors whose tori last long.")
    p.add_argument("file", metavar="FILE", help="an input file")
    p.add_argument("name", metavar="NAME", help="a parameter of it")
    p.add_argument("value", metavar="VALUE", type=exact, help="above which there are no tori")
    p.add_argument("--points", type=int, default=POINTS, metavar="N",
                   help="of the grid on which a torus is looked for, at most (%(default)s)")
    p.add_argument("--save", metavar="FILE", help="write the certificate")
    return p


def main(argv=None):
    return ended("vectors.py", lambda: run(parser().parse_args(argv)),
                 lambda: "nothing is proved")


if __name__ == "__main__":
    sys.exit(main())
