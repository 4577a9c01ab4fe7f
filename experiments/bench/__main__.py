"""What docs/explanation/speed.md says of times, measured anew.

    python experiments/bench [--repeat N] [--older DIRECTORY] [--whole] [WHAT ...]

Prints figures and judges nothing.  Machines differ and are shared: a time is the least of N runs
(3), and ratios within one run say more than seconds.  So --older has the sharper method timed in
turn with that of another commit, built in place in DIRECTORY.  With --whole
the checker verifies all proof files whole, which takes hours; without it, the files that take a
minute or less.
"""

import argparse
import math
import os
import platform
import subprocess
import sys
import tempfile
import time
from fractions import Fraction
from pathlib import Path

from converse.model.exact import decimal_text
from converse.model.map import LINE
from converse.prover import workers

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path.append(str(ROOT / "tests"))
import kernels  # noqa: E402

COMMAND = str(Path(sys.executable).parent / "converse")
DIGITS = (10, 20, 35, 50, 100, 200)
LOWS = ("0.0272", "0.0180", "0.0160", "0.0152", "0.0148", "0.0144", "0.0142", "0.0141", "0.0140")
APART = ("standard-63-64.in", "trig160.in")     # inputs whose parameters do not move together
LONG = 60                               # seconds, after which nothing is repeated


def run(arguments):
    """A process: seconds of wall time, peak memory in MB, seconds of the processor.  Its output is
    dropped."""
    begin = time.perf_counter()
    pid = os.fork()
    if pid == 0:
        null = os.open(os.devnull, os.O_RDWR)
        os.dup2(null, 1)
        os.dup2(null, 2)
        os.execv(arguments[0], arguments)
    _, status, usage = os.wait4(pid, 0)
    assert os.WIFEXITED(status) and os.WEXITSTATUS(status) in (0, 1, 4), arguments
    return time.perf_counter() - begin, usage.ru_maxrss / 1024, usage.ru_utime + usage.ru_stime


def processes(repeat):
    import converse
    empty = min(run([COMMAND, "--version"])[0] for _ in range(repeat))
    print("whole processes; starting Python and importing alone takes %.3f s" % empty)
    print("%-8s %6s %9s %9s %8s %8s" % ("input", "digits", "seconds", "search", "MB", "prisms"))
    for path in sorted((ROOT / "inputs").glob("trig27*.in")):
        for digits in DIGITS:
            runs = [run([COMMAND, "-d30", "-p%d" % digits, str(path)]) for _ in range(repeat)]
            searches = []
            for _ in range(repeat):
                proof = converse.prove(converse.read_input(path), digits=digits)
                searches.append(proof.seconds)
            print("%-8s %6d %9.3f %9.3f %8.1f %8d" % (
                path.stem, digits, min(r[0] for r in runs), min(searches),
                max(r[1] for r in runs), proof.counts.proved))


def images(repeat):
    """Nanoseconds for the image of a prism of the list, and of that image."""
    centre = [Fraction(x) for x in ("0.3085", "0.3085", "0.617", "0.82", "0.82", "2.5", "2.1")]
    widths = ("0.00125", "0.00125", "0.0025", "0", "0", "0.02", "0.02")
    first = (centre, [[Fraction(w) if j == k else Fraction(0) for k in range(7)]
                      for j, w in enumerate(widths)])
    print("nanoseconds per image of a prism (without bounding its sines)")
    print("%-10s %12s %12s" % ("", "fixed form", "column rotor"))
    rows = [("double", 35, {"arithmetic": "double"})]
    rows += [("%d digits" % digits, digits, {}) for digits in DIGITS]
    for name, digits, options in rows:
        figures = []
        for prism in (first, kernels.image(first, digits, **options)):
            values = [*prism[0], *(x for row in prism[1] for x in row)]
            times = 20000 if options else 2000
            figures.append(min(kernels.call("image_ns", values + [times], 1, digits, **options)[0]
                               for _ in range(repeat)))
        print("%-10s %12.0f %12.0f" % (name, *figures))


# One thread of whichever converse is found there: seconds of the processor, the least of a few
# runs, if they are short.
TIMED = """
import sys, time
from dataclasses import replace
import converse
problem = converse.read_input(sys.argv[1])
if sys.argv[2] == "together":
    problem = problem.tied() if hasattr(problem, "tied") else replace(problem, together=True)
seconds = []
while len(seconds) < 5 and sum(seconds) < 1:
    began = time.process_time()
    assert converse.prove(problem, method="loewner", jobs=1).no_tori
    seconds.append(time.process_time() - began)
print(min(seconds))
"""


def one_thread(commits, path, how, repeat):
    """The seconds that each of some commits takes for a proof, run in turn."""
    least, began = [math.inf] * len(commits), time.monotonic()
    for _ in range(repeat):
        for k, commit in enumerate(commits):
            found = subprocess.run([sys.executable, "-c", TIMED, path, how], check=True, cwd=commit,
                                   env={**os.environ, "PYTHONPATH": commit}, stdout=subprocess.PIPE)
            least[k] = min(least[k], float(found.stdout))
        if time.monotonic() - began > LONG:
            break
    return least


def frontier(repeat, older=None, whole=False):
    """The theorems of the sharper method: one thread, beside another commit's; all cores; the
    checker."""
    import converse
    jobs = workers.count_workers()
    print("method loewner, together, down to epsilon; its seconds and the checker's on one core")
    print("%-17s %9s %9s %6s | %9s %6s %9s %7s %7s | %9s %9s" % (
        "", "1 thread", "older", "ratio", "%d cores" % jobs, "ratio", "prisms", "points", "deepest",
        "checked/s", "whole"))
    with tempfile.TemporaryDirectory() as directory:
        checked = 0
        for name in LOWS + APART:
            path, how = str(ROOT / "inputs" / name), "apart"
            if name in LOWS:
                path, how = os.path.join(directory, name + ".in"), "together"
                low, high = (Fraction(e) * LINE for e in (name, "0.0280"))
                centre, half = (low + high) / 2, (high - low) / 2
                Path(path).write_text("".join("%s %s\n" % tuple(map(decimal_text, row)) for row in (
                    (centre, half), (centre, half), (2 * centre, 2 * half), (1, 1), (1, 1))))
            alone, *others = one_thread([str(ROOT)] + [older] * bool(older), path, how, repeat)
            problem = converse.read_input(path)
            problem = problem.tied() if how == "together" else problem
            proof = min((converse.prove(problem, method="loewner")
                         for _ in range(repeat if alone < LONG / repeat else 1)),
                        key=lambda proof: proof.seconds)
            assert proof.no_tori
            file = os.path.join(directory, name + ".proof")
            proof.save(file)
            check = [COMMAND + "-check", "--quiet", file]
            rate = [run(check + ["--sample", str(k)])[2] for k in (1, 401)]
            if whole or checked < LONG / 10:
                checked = run(check)[2]
                words = "%.1f" % checked
            else:
                words = ""
            print("%-17s %9.4f %9s %6s | %9.4f %6.2f %9d %7d %7d | %9.0f %9s" % (
                name, alone, *("%.4f" % x for x in others), *("%.2f" % (x / alone) for x in others),
                *[""] * (2 - 2 * len(others)), proof.seconds, alone / proof.seconds,
                proof.counts.proved, proof.counts.max_NTsteps, proof.counts.most_cuts,
                min(400, proof.counts.proved) / max(rate[1] - rate[0], 1e-3), words), flush=True)


def steps(repeat):
    """Nanoseconds per orbit step and prism of the sharper method, with each number of lanes, and
    of six sines in plain doubles."""
    a = Fraction("0.166")
    prism = [a, a, 2 * a, Fraction("3.1"), Fraction("2.9"), *[Fraction(1, 10 ** 9)] * 5,
             Fraction("0.858"), Fraction("0.858")]
    numbers = [kernels.arguments(kernels.thesis([*prism, together])) for together in (1, 0)]
    for most in ("2", "4", "8"):
        os.environ["CONVERSE_LANES"] = most
        *_, lanes = kernels.call("waves_step", [*numbers[0], 18, 1], 4, 20)
        print("nanoseconds per orbit step, %d prisms at once: "
              "%.0f with one parameter, %.0f with three" % (lanes, *(
                  min(kernels.call("waves_step", [*each, 18, 20000], 4, 20)[2]
                      for _ in range(repeat)) for each in numbers)))
    del os.environ["CONVERSE_LANES"]
    print("six sines in plain doubles: %.0f" % min(
        kernels.call("double_sincos_ns", [3, 300000], 1, 20)[0] for _ in range(repeat)))


PARTS = {part.__name__: part for part in (processes, images, steps, frontier)}


def main():
    p = argparse.ArgumentParser(description="Measures the times in docs/explanation/speed.md.")
    p.add_argument("--repeat", type=int, default=3, metavar="N",
                   help="runs, of which the least counts")
    p.add_argument("--older", metavar="DIRECTORY", help="another commit, built in place: frontier")
    p.add_argument("--whole", action="store_true", help="check all proof files whole: frontier")
    p.add_argument("what", nargs="*", metavar="WHAT",
                   help="of %s (default: all)" % ", ".join(PARTS))
    options = p.parse_args()
    if not set(options.what) <= set(PARTS) or options.repeat < 1:
        p.error("WHAT is any of %s, and N is 1 or more" % ", ".join(PARTS))
    if options.older and not list(Path(options.older).glob("converse/_native.*")):
        p.error("%s: holds no converse that is built in place" % options.older)
    print("%s, %s, Python %s" % (platform.machine(), platform.system(), platform.python_version()))
    for name in options.what or PARTS:
        if name == "frontier":
            older = options.older and os.path.abspath(options.older)
            frontier(options.repeat, older, options.whole)
        else:
            PARTS[name](options.repeat)


if __name__ == "__main__":
    main()
