"""What several tests share."""

import os
import signal
import subprocess
import sys
from collections import Counter
from dataclasses import fields
from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

import converse
from converse import Counts, MuldoonMap, Problem, Proof, Settings, Tree

from moments import PATIENCE
from truth import TORTURE

ROOT = Path(__file__).resolve().parent.parent

COMMAND = str(Path(sys.executable).parent / "converse")

# What takes long takes long: a machine that is slow, or busy, is no failure.  And the same cases
# at every run, so that none fails, or takes longer, by chance; `make torture` draws others.
settings.register_profile("timeless", deadline=None, derandomize=TORTURE <= 1,
                          max_examples=min(100, 100 * TORTURE),
                          suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("timeless")

# The children test the package that is tested here.  Where that is installed elsewhere, they must
# not take the sources here, which have no core, for it (before Python 3.11 this is not heard).
if not Path(converse.__file__).is_relative_to(ROOT):
    os.environ["PYTHONSAFEPATH"] = "1"

# A shell without job control starts what it puts in the background with Ctrl-C ignored, nohup with
# SIGHUP ignored, and so would be all that is started here.
signal.signal(signal.SIGINT, signal.default_int_handler)
signal.signal(signal.SIGHUP, signal.SIG_DFL)


# Files that `make check` leaves out, except tests marked quick.
SLOW = ("check/test_check", "check/test_fuzz", "commands/test_orbits_cli", "formal/",
        "project/test_install", "project/test_mutate", "project/test_numbers",
        "project/test_types", "project/test_where_methods_fail", "prover/test_parallel",
        "storage/test_faults", "storage/test_signals")

# Of the cases of one test `make check` takes 3 at most, the first, the last and one between.
QUICK_CASES = 3


def pytest_collection_modifyitems(items):
    cases = {}
    for item in items:
        if not item.get_closest_marker("slow"):
            cases.setdefault(item.nodeid.partition("[")[0], []).append(item)
    for of_one in cases.values():
        last = len(of_one) - 1
        taken = {k * last // (QUICK_CASES - 1) for k in range(QUICK_CASES)}
        for k, item in enumerate(of_one):
            place = item.path.relative_to(ROOT / "tests").as_posix()
            slow = place.startswith(SLOW) and not item.get_closest_marker("quick")
            if slow or k not in taken:
                item.add_marker("slow")


def pytest_terminal_summary(terminalreporter):
    """A line for each reason why tests were skipped, which names what to make or install."""
    reasons = Counter(report.longrepr[2].partition(": ")[2]
                      for report in terminalreporter.stats.get("skipped", ()))
    for reason, count in reasons.most_common():
        terminalreporter.write_line("%d skipped: %s" % (count, reason))


@pytest.fixture(scope="session")
def root():
    """The project's directory, for its inputs and golden outputs."""
    return ROOT


@pytest.fixture(scope="session")
def start():
    """Starts the command; the streams are binary."""
    def start(*arguments, **options):
        options = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE,
                   "stderr": subprocess.PIPE, **options}
        return subprocess.Popen([COMMAND, *map(str, arguments)], **options)
    return start


@pytest.fixture(scope="session")
def command(start):
    """Runs the command to its end: (exit status, stdout, stderr)."""
    def command(*arguments, stdin=b"", **options):
        with start(*arguments, stdin=subprocess.PIPE, **options) as process:
            out, err = process.communicate(stdin, timeout=PATIENCE)
        return (process.returncode, out.decode("utf-8") if out is not None else None,
                err.decode("utf-8"))
    return command


def around(centre, half, comments=(), together=False):
    """The problem of five centres and half-widths: of a, b, c, v0 and v1."""
    ranges = [(Fraction(c) - Fraction(h), Fraction(c) + Fraction(h))
              for c, h in zip(centre, half)]
    made = Problem(MuldoonMap(*ranges[:3]), *ranges[3:], comments)
    return made.tied() if together else made


@pytest.fixture(scope="session")
def made_up():
    """A proof from a tree that the test makes up; its other numbers serve the format only."""
    def made_up(tree, a="0.3085", v=("1", "1", "1", "1"), comments=(), counts=None, **options):
        a, (c0, c1, h0, h1) = Fraction(a), map(Fraction, v)
        problem = around((a, a, 2 * a, c0, c1),
                                 ("0.00125", "0.00125", "0.0025", h0, h1), comments)
        counts = counts or Counts(cuts=tree.count("0") + tree.count("1"), proved=tree.count("P"),
                                  symmetric=tree.count("S"), undecided=tree.count("U"))
        settings = Settings(**{"method": "thesis"} | {
            each.name: options.pop(each.name) for each in fields(Settings) if each.name in options})
        names = "T", "Tr-", "Tr+", "B", "lambda-min", "lambda-max"
        facts = {"xstar": ("1.5", "1.5"), "seconds": 12.5,
                 "constants": dict.fromkeys(names, "1.25"), **options}
        first = Tree(problem, *(facts.pop(name, empty) for name, empty in (
            ("xstar", None), ("text", tree), ("pending", ()))))
        return Proof((first,), settings, counts, **facts)
    return made_up
