"""Speed against accuracy of the three ways to find an orbit (thesis, Appendix A).

    python experiments/finders.py [--draw] [DIRECTORY]

trig, (1432, 1897)/2513, from the minimum at 0.96 eps: gradient flow, Newton's method as it is, and
damped.  Each is told to stop at ever smaller gradients; the time, the shadow there, and the
distance to the proved orbit that damped Newton leads to from there.  Writes orbit-finders.svg and
.csv into DIRECTORY (build).  A minute.  The picture shows the first eps, without undamped Newton.
"""

import argparse
import os
import time
from dataclasses import replace

import numpy as np
import output

from converse import orbits
from converse.draw import plot
from converse.orbits.solver import newton
from converse.storage import files

TYPE = (1432, 1897), 2513
EPS = 0.0125, 0.02
DRAWN = EPS[0]
GUESS = 0.96                # of eps
TOLERANCES = [10.0 ** -k for k in range(3, 14)]
FLOW_SECONDS = 10.0
REPEAT = 20
# Curves of the picture: method, column, line, colour; words, and where they begin.
CURVES = (
    ("damped Newton", 5, "o-", plot.BLUE, ":\ndistance to the orbit", (2.8e-3, 1e-9)),
    ("gradient flow", 5, "s-", plot.VERMILLION, ": distance to the orbit", (1.6e-2, 5e-2)),
    ("gradient flow", 4, "s:", plot.VERMILLION, r": largest $|\partial L/\partial x_j|$",
     (1.6e-2, 1e-6)))


def flow(state, eps=None, grad_size=1e-6, max_steps=10000, dt=0.5):
    """Gradient flow (thesis, Appendix A), for comparison: du/dtau = -dL/du until the gradient's
    root mean square is at most grad_size.  The kinetic part is taken implicitly, so that dt may be
    large.  Returns the state, "not stationary" perhaps, and the number of steps."""
    state = replace(state, eps=state.eps if eps is None else eps)
    wave = 2 - 2 * np.cos(2 * np.pi * np.fft.rfftfreq(state.q))
    damping = 1 / (1 + dt * wave)[:, None]
    for steps in range(max_steps):
        if state.grad_size <= grad_size:
            return state, steps
        force = state.u + dt * state.eps * state._local[1]
        u = np.fft.irfft(np.fft.rfft(force, axis=0) * damping, n=state.q, axis=0)
        state = state.moved(u)
    return state, max_steps


def timed(function):
    """The result of a call, and the least time of REPEAT calls, in seconds."""
    seconds = []
    for _ in range(REPEAT):
        begun = time.perf_counter()
        result = function()
        seconds.append(time.perf_counter() - begun)
    return result, min(seconds)


def runs(guess, eps):
    """Yields name, tolerance, seconds and the state there."""
    state, total = replace(guess, eps=eps), 0.0
    for tolerance in TOLERANCES:
        begun = time.perf_counter()
        while state.grad_size > tolerance and total + time.perf_counter() - begun < FLOW_SECONDS:
            state, _ = flow(state, grad_size=tolerance, max_steps=100)
        total += time.perf_counter() - begun
        yield "gradient flow", tolerance, total, state
        if total > FLOW_SECONDS:
            break
    for tolerance in TOLERANCES:
        (state, _), seconds = timed(lambda: newton(guess, eps, tol=tolerance))
        yield "Newton", tolerance, seconds, state
    for tolerance in TOLERANCES:
        yield ("damped Newton", tolerance,
               *reversed(timed(lambda: guess.relax(eps, tol=tolerance))))


def distance(state, known):
    """To the proved orbit that damped Newton leads to from there."""
    if state.shadow > 1:
        return float("inf")                     # it has diverged
    end = state.relax()
    for orbit, points in known:
        if np.abs(orbit.u - end.u).max() < 1e-6:
            break
    else:
        points = np.array(orbits.prove(end).displacements, dtype=float)
        known.append((end, points))
    return float(np.sqrt(((state.u - points) ** 2).sum(1)).max())


def measure(eps):
    guess, known = orbits.follow(orbits.trig, *TYPE, [GUESS * eps])[0], []
    for name, tolerance, seconds, state in runs(guess, eps):
        row = (eps, name, tolerance, seconds, state.shadow, distance(state, known), state.label)
        print("%g, %s to %.0e: %.4f s, shadow %.1e, distance %.1e, %s" % row, flush=True)
        yield row


def draw(rows):
    """The figure, as the bytes of an SVG file."""
    with output.figure(output.CHART, figsize=(6, 3.8)) as figure:
        axes = figure.subplots()
        for name, column, line, colour, words, place in CURVES:
            mine = [row for row in rows if row[:2] == (DRAWN, name)]
            axes.plot([row[3] for row in mine], [row[column] for row in mine], line, color=colour)
            axes.text(*place, name + words, color=colour)
        axes.set(xscale="log", yscale="log", ylim=(1e-13, 1), xlabel="time (seconds)",
                 ylabel="turns",
                 title="Gradient flow: a small gradient does not mean that the orbit is near")
        return plot.encode(figure, "svg")


COLUMNS = "eps", "method", "tolerance", "seconds", "shadow", "distance", "label"


def read(path):
    """The rows of a table."""
    return [(float(eps), name, *map(float, numbers), label)
            for eps, name, *numbers, label in output.read(COLUMNS, path)]


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("directory", nargs="?", default="build")
    parser.add_argument("--draw", action="store_true",
                        help="draw orbit-finders.csv, which is there")
    options = parser.parse_args()
    os.makedirs(options.directory, exist_ok=True)
    name = os.path.join(options.directory, "orbit-finders")
    rows = read(name + ".csv") if options.draw else [row for eps in EPS for row in measure(eps)]
    files.write(name + ".svg", draw(rows))
    if not options.draw:
        files.write_text(name + ".csv", output.text(COLUMNS, rows))


if __name__ == "__main__":
    main()
