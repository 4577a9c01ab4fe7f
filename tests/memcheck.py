"""What make memcheck runs under valgrind: proofs of both kinds and every sort of kernel."""

from fractions import Fraction
from pathlib import Path

import converse

import kernels

INPUTS = Path(__file__).resolve().parent.parent / "inputs"

for as_printed in (False, True):
    problem = converse.read_input(INPUTS / "trig276.in")
    proof = converse.prove(problem, digits=20, as_printed=as_printed)
    assert proof.all_decided
    assert not converse.prove(problem, digits=1, as_printed=as_printed, stubborn=True,
                              depth=4).all_decided

for name, together, decided in (("trig180", True, True), ("standard-63-64", False, True),
                                ("standard-972", False, False)):
    problem = converse.read_input(INPUTS / (name + ".in"))
    problem = problem.tied() if together else problem
    proof = converse.prove(problem, method="loewner", jobs=2, time_limit=300 if decided else 5)
    assert proof.all_decided == decided

centre = [Fraction(x) for x in ("0.3", "0.3", "0.6", "0.8", "0.8", "2", "1")]
prism = (centre, [[Fraction(j == k and j not in (3, 4), 100) for k in range(7)]
                  for j in range(7)])
for arithmetic in ("apm", "double"):
    image = kernels.image(prism, 30, arithmetic=arithmetic)
    kernels.image(image, 30, arithmetic=arithmetic)
    kernels.bound_sin("-1", "2", 30, arithmetic=arithmetic)
kernels.pi(500)
kernels.sin("1e30", 100)
kernels.sqrt("2", 100)
try:
    kernels.inverse([[0] * 4] * 4, 30)
except ArithmeticError:
    print("memcheck is through")
