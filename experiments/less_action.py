"""A search for the state of least action of a type: is continuation's orbit the minimizing one?

    python experiments/less_action.py POTENTIAL TYPE EPS [--searches N] [--seed N] [--points FILE]

prints the state of least action that N searches find.  `converse-orbits find --from FILE` goes on
from it.

Continuation (orbits.follow) keeps to one branch of minima.  Here damped Newton descends from many
guesses, as in basin hopping (Wales and Doye 1997).  That alone fails for long orbits, whose minima
are too many; but the action is a sum along the orbit, and so
- the better pieces of two states of a type make a third, by dynamic programming (_recombined); the
  second may be the first begun at another of its points, which passes close by;
- the least states of two shorter types, one after the other, are nearly a state of the sum of the
  types (_joint).  Those of the two are searched for in the same way.
"""

import argparse
import math
from dataclasses import replace

import numpy as np

from converse import ConverseError
from converse.commands.orbits import _vector, read_potential
from converse.orbits import PeriodicOrbit, follow, straight

MAX_SEARCH_STEPS = 1000         # Newton steps in one search; few take more than a hundred.
MAX_TURNS_TRIED = 50            # Turns of the best state that are tried before random changes.
MAX_JOINTS_TRIED = 12           # Joints of two shorter states that are tried before random changes.
SHORT_WORK = 10000              # Points times searches for a shorter type, but two for each joint.
MAX_SHORT_SEARCHES = 100        # Searches for a shorter type.
JOINT_SAMPLE = 1000             # Points of a state that are compared with another's for a joint.
PIECE_SPACING = 60              # The mean distance, in points, of pieces that are moved together.
PIECE_LENGTH = 10               # The mean length of a piece, in points.
MOVE_SIZES = 0.1, 0.3, 0.6      # A piece moves by a normal deviate times one of these.
JOINT_RELIEF = 0.4              # The part of a joint's cost that relaxing takes away: _recombined.


def search(potential, p, q, eps=1.0, searches=200, seed=0, progress=None):
    """The state of type (p, q) of least action that many searches find; it is not proved to be the
    least.

    Parameters
    ----------
    potential : SymplecticMap or Potential
    p : int or sequence of int, shape (n,)
    q : int
    eps : float
    searches : int
        How many at most.
    seed : int
        Of numpy's random numbers.  Searches with several seeds, in any executor, are independent of
        each other.
    progress : callable, optional
        progress(searches, best) is called after each search.

    Returns
    -------
    PeriodicOrbit

    Raises
    ------
    ConverseError
        No search ends at a state.

    Notes
    -----
    A search is a descent of the action of type (p, q) to a state whose gradient vanishes.  The
    first is continuation's, so that none worse is returned.  Then come orbits composed of the best
    of shorter types, whose own searches are not counted; turns of the best state so far; pieces of
    it moved; and straight orbits elsewhere, some relaxed at a larger eps first.
    """
    guess = replace(straight(potential, p, q), eps=eps)
    of_type = _TypeSearch(guess, searches, np.random.default_rng(seed), {}, progress)
    of_type.run()
    if of_type.best is None:
        raise ConverseError("no orbit of type %s found at eps %r: none of %d searches ended"
                            % (guess.type_text, eps, of_type.begun))
    return of_type.best


class _TypeSearch:
    """The search for one type, which a guess has: the straight orbit at its eps."""

    def __init__(self, guess, searches, rng, known, progress=None):
        self.guess, self.searches, self.rng = guess, searches, rng
        self.known, self.progress = known, progress         # known: the best of shorter types
        self.best, self.begun, self.ended = None, 0, 0
        self.turns, self.shifts = _turns(guess.p, guess.q, 0.0)

    @property
    def goes_on(self):
        return self.begun < self.searches

    def run(self):
        guess = self.guess
        try:
            self.begun += 1
            self.record(follow(guess.potential, guess.p, guess.q, [guess.eps])[0])
        except ConverseError:
            pass
        joints = self.joints()
        for _ in range(MAX_JOINTS_TRIED):
            self.joint(joints)
        for r in self.turns[1:1 + MAX_TURNS_TRIED]:
            self.turn(r)
        while self.goes_on:
            move = self.rng.integers(4) if self.best is not None else 3
            if move == 0:
                self.joint(joints)
            elif move == 1 and guess.q > 1:
                self.turn(self.turns[self.random_index(1, guess.q)])
            elif move == 2:
                self.move_pieces()
            else:
                self.start_anywhere()

    def descend(self, guess):
        """One search, from a guess: the state where it ends, or None."""
        if not self.goes_on:
            return None
        self.begun += 1
        try:
            return self.record(guess.relax(max_steps=MAX_SEARCH_STEPS))
        except ConverseError:
            return None

    def record(self, state):
        self.ended += 1
        if self.best is None or state.action < self.best.action:
            self.best = state
        if self.progress is not None:
            self.progress(self.ended, self.best)
        return state

    def random_index(self, first, end):
        """A random index from first up to end, more often small than large."""
        return first + int((end - first) * self.rng.random() ** 3)

    # ---- guesses

    def recombine(self, other, r=0, shift=0.0):
        """The better pieces of the best state and another's, turned by r."""
        if self.best is not None:
            u = _recombined(self.best, np.roll(other.u, -r, 0) + shift)
            if u is not None:
                self.descend(self.best.moved(u))

    def turn(self, r):
        if self.goes_on and self.best is not None:
            self.recombine(self.best, r, self.shifts[r])

    def move_pieces(self):
        """Basin hopping in many places together; then each piece is kept where it is better."""
        best, q = self.best, self.guess.q
        u = best.u.copy()
        for start in self.rng.integers(q, size=max(1, q // PIECE_SPACING)):
            piece = (start + np.arange(min(q, self.rng.geometric(1 / PIECE_LENGTH)))) % q
            u[piece] += self.rng.normal(size=u.shape[1]) * self.rng.choice(MOVE_SIZES)
        other = self.descend(best.moved(u))
        if other is not None:
            self.recombine(best if other is self.best else other)

    def start_anywhere(self):
        """A search from a straight orbit with a random origin; some are perturbed at random, and
        some relaxed at a larger eps first."""
        guess, rng = self.guess, self.rng
        n, q = guess.u.shape[1], guess.q
        guess = replace(guess, origin=rng.random(n),
                        u=rng.normal(size=(q, n)) * rng.choice((0.0, 0.0) + MOVE_SIZES))
        try:
            if rng.random() < 0.3:
                there = guess.relax(guess.eps * rng.uniform(1.1, 2.0), max_steps=MAX_SEARCH_STEPS)
                guess = replace(there, eps=guess.eps)
        except ConverseError:
            pass
        before = self.best
        other = self.descend(guess)
        if other is not None and before is not None:
            other = before if other is self.best else other
            turns, shifts = _turns(guess.p, q, np.subtract(other.origin, self.best.origin))
            r = turns[self.random_index(0, q)]
            self.recombine(other, r, shifts[r])

    def joint(self, joints):
        if self.goes_on:
            for guess in joints:
                self.descend(guess)
                break

    def joints(self):
        """Guesses made of the best states of shorter types, most promising first."""
        p, q = self.guess.p, self.guess.q
        copies = math.gcd(q, *p)
        if copies > 1:
            part = self.shorter([k // copies for k in p], q // copies)
            if part is not None:
                yield part.repeat(copies)
        residue = _residues(p, q)
        turns = [r for r in self.turns if residue[r].any()]
        if not turns:
            return
        r = int(turns[0])
        first = [(r * k - int(c)) // q for k, c in zip(p, residue[r])]
        parts = (self.shorter(first, r), self.shorter([k - i for k, i in zip(p, first)], q - r))
        if None not in parts:
            yield from _joints(p, q, *parts, self.rng)

    def shorter(self, p, q):
        """The best state of a shorter type, by a shorter search; None if none is found."""
        key = tuple(p), q
        if key not in self.known:
            guess = replace(self.guess, p=p, q=q, u=np.zeros((q, len(p))))
            searches = min(self.searches, MAX_SHORT_SEARCHES,
                           max(2 * MAX_JOINTS_TRIED, SHORT_WORK // q))
            inner = _TypeSearch(guess, searches, self.rng, self.known)
            inner.run()
            self.known[key] = inner.best
        return self.known[key]


def _residues(p, q):
    """The whole numbers c from -q/2 up to q/2 with c = r p mod q, for each r from 0 up to q."""
    c = np.arange(q, dtype=np.int64)[:, None] * (np.array(p) % q) % q
    return np.where(2 * c >= q, c - q, c)


def _turns(p, q, away):
    """How a state begun at x_r instead of x_0, a turn of it, lies beside another of its type: an
    array of the r, nearest first, and for each r the displacement between the two straight orbits,
    an array (q, n).  away: the displacement of their origins."""
    shifts = _residues(p, q) / q + away
    shifts -= np.round(shifts)
    return np.argsort((shifts ** 2).sum(1), kind="stable"), shifts


def _recombined(state, u):
    """The displacements, an array (q, n), of a path of least action; None if it is the state.

    Point j of the path is the state's, or has the displacement u[j] instead, for each j.  The path
    is found by dynamic programming along the orbit (Viterbi 1967).

    A step from one to the other costs less by JOINT_RELIEF times half the square of the gap between
    them: relaxing the path takes away about that part of its action."""
    v, eps = state.u, state.eps
    heights = (-eps * state._local[0], -eps * state.potential.evaluate(state.base + u)[0])
    gap = ((u - v) ** 2).sum(1)
    near = int(np.argmin(gap))                          # where the path starts, on the state
    relief = JOINT_RELIEF / 2 * np.minimum(gap, np.roll(gap, -1))
    steps = [((np.roll(b, -1, 0) - a) ** 2).sum(1) / 2 + np.roll(h, -1) - relief * (a is not b)
             for a in (v, u) for b, h in zip((v, u), heights)]
    here, there, came = 0.0, math.inf, []
    for stay, leave, back, go_on in zip(*(np.roll(step, -near).tolist() for step in steps)):
        came.append((there + back < here + stay, there + go_on <= here + leave))
        here, there = min(here + stay, there + back), min(here + leave, there + go_on)
    away, now = np.zeros(state.q, bool), False
    for j in range(state.q - 1, -1, -1):
        away[(near + j + 1) % state.q] = now
        now = came[j][now]
    return np.where(away[:, None], u, v) if away.any() else None


def _joints(p, q, first, second, rng):
    """Guesses of type (p, q): the points of first, then those of second, cut where points of both
    are near each other.  The nearest pair comes first; of pairs that follow each other along both
    orbits, which give the same guess, only one is used."""
    some = [rng.permutation(state.q)[:JOINT_SAMPLE] for state in (first, second)]
    apart = first.turns[some[0]][:, None] - second.turns[some[1]]
    apart -= np.round(apart)
    nearest = np.argsort((apart ** 2).sum(2), axis=None, kind="stable")[:JOINT_SAMPLE]
    cut = []
    for i, j in zip(*np.unravel_index(nearest, apart.shape[:2])):
        i, j = int(some[0][i]), int(some[1][j])
        if not any((i - a) % first.q == (j - b) % second.q
                   or (a - i) % first.q == (b - j) % second.q for a, b in cut):
            cut.append((i, j))
            yield _joint(p, q, first, i, second, j)


def _joint(p, q, first, i, second, j):
    """The points of first, beginning with x_i, then those of second, beginning with x_j, as one
    state."""
    path = np.concatenate([
        np.roll(state.u, -k, 0) - state.u[k] + np.arange(state.q)[:, None] * state.rotation + begin
        for state, k, begin in ((first, i, 0.0), (second, j, np.array(first.p)))])
    return PeriodicOrbit(first.potential, p, q, first.eps,
                 path - np.arange(q)[:, None] * (np.array(p) / q), first.turns[i])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("potential", metavar="POTENTIAL")
    parser.add_argument("type", metavar="TYPE", type=_vector)
    parser.add_argument("eps", metavar="EPS", type=float)
    parser.add_argument("--searches", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--points", metavar="FILE")
    options = parser.parse_args()
    best = search(read_potential(options.potential), *options.type, options.eps, options.searches,
                  options.seed)
    print(best.report(), end="")
    if options.points is not None:
        best.save(options.points)


if __name__ == "__main__":
    main()
