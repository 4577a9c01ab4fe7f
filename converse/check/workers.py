"""The leaves of all claims, divided among processes."""

import math

from .arith import dot
from .claim import LETTERS
from .criterion import Criterion
from .failures import named
from .limits import MAX_SITES
from .lockstep import import_numpy_if_sound, least_in_double
from .tree import leaves


class Problems:
    """The claims of a file: of its proofs and their parts, or of a portrait's columns; and their
    fast path, if there is one."""

    def __init__(self, proofs):
        """proofs: Claims, each followed by its parts."""
        self.claims, self.heads = [], []    # heads: by claim, the number of its proof's first
        for proof in proofs:
            self.heads += [len(self.claims)] * (1 + len(proof.parts))
            self.claims += proof, *proof.parts
        self.fast, self.known = None, {}    # known: by claim, its Criterion
        self.bent = {}                      # by claim: no eigenvalue of V'' is above it

    def criterion(self, n):
        if n not in self.known:
            claim, head = self.claims[n], self.heads[n]
            if n != head:
                self.known[n] = self.criterion(head).of_part(claim)
            else:
                with named(claim.where):
                    self.known[n] = Criterion(claim)
        return self.known[n]

    def excluded(self, leaf):
        if self.hopeless(leaf):
            return "the waves are so weak that %d points contradict nothing" % (2 * MAX_SITES), 0
        return self.criterion(leaf[0]).excluded(leaf[1])

    def hopeless(self, leaf):
        """Is (C3) false of all orbits for every n on at most N = 2 MAX_SITES sites?  Near equality
        the errors of either path are larger than what this test loses in doubles, so it refuses
        no leaf that could be confirmed.

        beta >= 2 cos t = 2 - bent for bent <= 4.  v[j] = cos((j - (N + 1)/2) t) is positive for
        0 <= j <= N + 1 if (N + 1) t < pi, and v[0]/v[1] falls with N.  2 |n[j]| |n[j+1]| is at most
        |n[j]|^2 v[j+1]/v[j] + |n[j+1]|^2 v[j]/v[j+1].  So the left side of (C3) is
        at least (v[0]/v[1] - l) (|n[1]|^2 + |n[N]|^2).
        """
        (n, cell), criterion = leaf, self.criterion(leaf[0])
        if n not in self.bent:
            self.bent[n] = float(sum([(abs(wave.middle) + sum(map(abs, wave.parts)))
                                      * dot(wave.k, wave.k)
                                      for wave in self.claims[n].examined]))
        t = 2 * math.asin(min(math.sqrt(self.bent[n]) / 2, 1))
        far, l = (MAX_SITES + 0.5) * t, criterion.least_pivot(cell) / criterion.fixed.one
        return far < math.pi / 2 and math.cos(far) >= l * math.cos(far - t)

    def leaves(self):
        """The leaves P of all claims, as (number of the claim, cell), in their order."""
        for n, claim in enumerate(self.claims):
            for position, cell in leaves(claim.tree, kinds="PSU" + LETTERS):
                if claim.tree[position] == "P":
                    yield n, cell

    def check_chunk(self, chunk):
        """Checks leaves in order: (how many are confirmed, their pieces, whether they were tried in
        doubles, what then fails).

        The rounding of numpy is looked at each time, in the process and thread that use it.
        """
        cells, refused, pieces = [leaf for _, leaf in chunk], None, []
        fast = bool(self.fast) and import_numpy_if_sound()
        if fast:
            refused, pieces = self.fast.settle(
                cells, [None if self.hopeless(leaf) else
                        least_in_double(self.criterion(leaf[0]), leaf[1]) for leaf in cells],
                lambda n: self.excluded(cells[n]))
        else:
            for n, leaf in enumerate(cells):
                why, tried = self.excluded(leaf)
                if why:
                    refused = n, why
                    break
                pieces.append(tried)
        n = refused[0] if refused else len(cells)
        return n, sum(pieces[:n]), fast, refused and (*chunk[n], refused[1])
