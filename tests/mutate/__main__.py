"""Makes small mistakes in the code that proofs rest on, one at a time, and sees whether a test
notices.

    python tests/mutate [--sample N] [--seed SEED] [--list] [WHERE ...]

WHERE is a file (loewner/bound.c), a function of it (loewner/bound.c:weigh) or one mutant
("loewner/bound.c:weigh term 2"); without it, all files.  --sample tries N of the mutants there:
each of a function, an operator and a place that the seed chooses.  All of them take days.  Prints
what became of each; exit status 1 if one survived that accepted.py has no reason for, or if a test
failed that fails without it, too.
"""

import argparse
import os
import random
import shutil
import subprocess
import sys
import tempfile
import threading
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

HOME = Path(__file__).resolve().parent
sys.path[:0] = [str(HOME), str(HOME.parent / "kernels")]
from accepted import ACCEPTED  # noqa: E402
from operators import OPERATORS, mutants  # noqa: E402

import build  # noqa: E402

ROOT = HOME.parent.parent
PATIENCE = 900                          # seconds, for the tests of one file

# The files that are mutated: all of csrc, and these files of the folders of converse.  The files
# that guess where to start are left out, because no proof rests on them.
PYTHON = {"orbits": ("enclosure", "exponents"),
          "check": ("arith", "claim", "container", "cover", "criterion", "exact", "field", "links",
                    "lockstep", "diagram", "portrait", "proof_file", "series", "tori", "torus",
                    "torus_file", "tree"),
          "tori": ("certificate", "field", "proved")}
GUESSES = ("thesis/start.c", "loewner/start.c", "loewner/score.c",
           "model/stationary.c")

# The tests that may notice, by what a file's name begins with; the likely one first.  After a colon
# stands which tests of a file, as pytest's -k takes it.
NUMBERS = ["test_apm.py", "test_special.py", "test_bounding.py", "test_bd_trig.py",
           "test_bounds.py",
           "test_images.py", "test_promises.py", "test_search.py"]
SHARP = ["test_loewner.py", "test_waves.py", "test_search.py"]
TORI = ["test_certificate.py", "tori/test_proved.py"]
FINDERS = ["test_orbits.py", "test_orbits_fail.py", "orbits/test_proved.py"]
PARTS = ["test_parts.py", "test_part_shifts.py"]
BOTH_PATHS = "test_check*.py: both_paths or confirms or forged or minimizes"
TESTS = {
    "arith/apm": NUMBERS, "arith/special": ["test_special.py", *NUMBERS],
    "arith/sine": ["test_loewner.py", "test_gappa.py", "test_waves.py"], "arith/lanes": SHARP,
    "arith/sum2": ["test_turns.py", *SHARP], "arith/turns": ["test_turns.py", *SHARP],
    "arith/sym": ["test_bounds.py", *SHARP],
    "arith/interval": ["test_interval.py", "test_bounds.py"],
    "arith/guard": ["test_rigor.py", "test_search.py", "test_orbits.py"],
    "arith/machine": ["test_rigor.py"],
    "thesis/bounding": ["test_bounding.py", *NUMBERS],
    "thesis/bd_trig": ["test_bd_trig.py", *NUMBERS],
    "thesis/trace": ["test_bounds.py", *NUMBERS], "thesis/lambda": ["test_bounds.py", *NUMBERS],
    "thesis/lipschitz": ["test_bounds.py", *NUMBERS], "model/region": ["test_search.py", *NUMBERS],
    "thesis/follow": ["test_search.py", *NUMBERS], "thesis": ["test_images.py", *NUMBERS],
    "model": ["test_bounds.py", *SHARP], "search": ["test_search.py", *SHARP, "test_rigor.py"],
    "loewner/waves": ["test_waves.py", "test_margins.py", *SHARP],
    "loewner": [*SHARP, "test_margins.py"], "loewner/bound": [*SHARP, "test_turns.py"],
    "orbits/enclosure": ["orbits/test_proved.py"],
    "orbits/exponents": ["orbits/test_proved.py"], "orbits": FINDERS,
    "check/field": ["test_tori_bounds.py", "test_tori.py"],
    "check/series": ["test_tori_bounds.py", "test_tori.py"],
    "check/tori": ["test_tori_bounds.py", "test_tori.py"], "check/torus_file": ["test_tori.py"],
    "check/arith": ["check/test_angles.py: matrices or frames_of",
                    "test_check*.py: sincos or taylor or roots",
                    "check/test_exact.py", "check/test_angles.py"],
    "check/claim": ["test_check*.py: numbers or cells or prisms_cover or corners or header",
                    *PARTS, "check/test_angles.py: one_angle or wrong", BOTH_PATHS],
    "check/cover": ["test_parts.py: enough or centre or reversal",
                    "check/test_angles.py: periods or too_short", "test_portrait.py"],
    "check/criterion": ["test_check*.py: pivot or at_once or prisms_cover or halve or weak",
                        *PARTS, BOTH_PATHS],
    "check/exact": ["check/test_exact.py", "test_check*.py: exact or one_bound", BOTH_PATHS],
    "check/links": PARTS,
    "check/lockstep": ["test_check*.py: lockstep or lanes or roundings or term or turns or sums or "
                       "slopes or centres", "test_mirror.py", *PARTS, BOTH_PATHS],
    "check/container": ["test_check*.py: header or numbers or control or versions",
                        "check/test_diagram.py", "test_portrait.py: altered"],
    "check/diagram": ["check/test_diagram.py", "test_value.py"],
    "check/portrait": ["test_portrait.py"],
    "check/proof_file": ["test_check*.py: header or numbers or trees or theorem or potentials or "
                         "versions or at_once", *PARTS],
    "check/torus": ["test_check*.py: bound_over or at_once", "check/test_exact.py: few_bits"],
    "check/tree": ["test_check*.py: trees or flipped or mirror or header or symmetric or "
                   "coefficients or halved", *PARTS],
    "tori": TORI, "tori/field": ["test_rotation.py", *TORI],
}


def sources():
    """{name: path} of what is mutated."""
    found = {path.relative_to(ROOT / "csrc").as_posix(): path
             for path in sorted([*ROOT.glob("csrc/**/*.[ch]"), *ROOT.glob("csrc/**/*.inc")])}
    for folder, names in PYTHON.items():
        found.update(("%s/%s.py" % (folder, name), ROOT / "converse" / folder / (name + ".py"))
                     for name in names)
    return {name: path for name, path in found.items() if name not in GUESSES}


def tests_of(name):
    longest = max((prefix for prefix in TESTS if name.startswith(prefix)), key=len,
                  default="thesis")
    return list(dict.fromkeys(TESTS[longest]))


@dataclass
class Place:
    """A mutant of a file."""

    name: str
    path: Path
    mutant: object

    @property
    def key(self):
        return "%s:%s" % (self.name, self.mutant.key)


def places(where=()):
    """The mutants there."""
    files = {word.partition(":")[0] for word in where}
    found = [Place(name, path, mutant) for name, path in sources().items()
             if name in files or not where
             for mutant in mutants(name, path.read_text("utf-8"))]
    if not where:
        return found
    chosen = [place for place in found
              if {place.name, "%s:%s" % (place.name, place.mutant.function),
                  place.key} & set(where)]
    if not chosen:
        sys.exit("there is nothing to mutate in %s" % ", ".join(where))
    return chosen


def sample(found, count, seed):
    """So many of them, or all: a function, one of its operators, one of its places."""
    rng, tree, chosen = random.Random(seed), {}, []
    for place in found:
        by_operator = tree.setdefault((place.name, place.mutant.function), {})
        by_operator.setdefault(place.mutant.operator, []).append(place)
    while tree and len(chosen) < count:
        function = rng.choice(sorted(tree))
        operator = rng.choice(sorted(tree[function]))
        left = tree[function][operator]
        chosen.append(left.pop(rng.randrange(len(left))))
        if not left:
            del tree[function][operator]
        if not tree[function]:
            del tree[function]
    return chosen


class Same(Exception):
    """The mutant is no other program."""


class Base:
    """The unchanged core: its objects, which the console's build has left, and the product's
    module."""

    def __init__(self, directory):
        self.objects = build.path().parent
        self.made = build.product()
        native = directory / "native"
        native.mkdir()
        with build.contextlib.redirect_stdout(sys.stderr):
            self.made["ffi"].emit_c_code(str(native / "native.c"))
        self.native = build.compile_unit("native", (native / "native.c").read_text("utf-8"), native,
                                         ROOT / "csrc", self.made["FLAGS"])
        self.texts = build.units(self.made["SOURCES"], ROOT / "csrc")
        self.unchanged, self.passed, self.lock = directory / "unchanged", {}, threading.Lock()
        self.package(self.unchanged)
        self.link(self.unchanged, {path.stem: path for path in self.objects.glob("*.o")})

    def package(self, work):
        """A copy of the Python package, without the core."""
        shutil.copytree(ROOT / "converse", work / "converse",
                        ignore=shutil.ignore_patterns("__pycache__", "_native*"))

    def link(self, work, objects):
        """Links package and console of these objects."""
        mine = [path for name, path in objects.items() if name not in ("module", "stand-ins")]
        build.link([*mine, self.native], work / "converse" / "_native.abi3.so")
        build.link(objects.values(), work / "console.so")

    def core(self, place, work):
        """Builds package and console with a mutant of the C core in work.  False: it does not
        compile."""
        csrc = work / "csrc"
        shutil.copytree(ROOT / "csrc", csrc)
        (csrc / place.name).write_text(place.mutant.text, "utf-8")
        objects, changed = {path.stem: path for path in self.objects.glob("*.o")}, []
        for name, text in self.texts.items():
            words = (self.objects / (name + ".d")).read_text("utf-8").replace("\\\n", " ").split()
            if any(word.endswith("csrc/" + place.name) for word in words):
                changed.append(name)
        (work / "units").mkdir()
        for name in changed:
            text = self.texts[name]
            try:
                objects[name] = build.compile_unit(name, text, work / "units", csrc,
                                                   self.made["FLAGS"])
            except SystemExit:
                return False
        if all(objects[name].read_bytes() == (self.objects / (name + ".o")).read_bytes()
               for name in changed):
            raise Same
        self.link(work, objects)
        return True

    def tried(self, place):
        """What becomes of a mutant: 'caught by ...', 'survived', 'no C', 'the same program', or
        'no verdict: ...' if the test that fails does so without it, too."""
        with tempfile.TemporaryDirectory() as directory:
            work = Path(directory)
            self.package(work)
            if place.name.endswith(".py"):
                path = work / place.path.relative_to(ROOT)
                path.write_text(place.mutant.text, "utf-8")
                self.link(work, {path.stem: path for path in self.objects.glob("*.o")})
            else:
                try:
                    if not self.core(place, work):
                        return "no C"
                except Same:
                    return "the same program"
            for name in tests_of(place.name):
                name, _, words = name.partition(": ")
                files = sorted((ROOT / "tests").rglob(name))
                why = failure(files, work, words)
                if why is None:
                    continue
                if not self.passes(files, why):
                    return "no verdict: %s fails without it, too, in %s" % (name, why)
                return "caught by " + (why.replace("::", ", ", 1) if "::" in why else
                                       "%s, %s" % (name, why))
        return "survived"

    def passes(self, files, why):
        """Does the test that failed, or all of the files that crashed, pass without a mutant?"""
        tests = files if why in (CRASH, ENDLESS) else [
            file.with_name(why) for file in files if why.startswith(file.name)]
        with self.lock:
            if why not in self.passed:
                self.passed[why] = failure(tests, self.unchanged) is None
        return self.passed[why]


CRASH, ENDLESS = "a crash", "which has no end"


def failure(tests, work, words=""):
    """The first of these tests that fails with what was built in work, of those with the words;
    CRASH, ENDLESS or None."""
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", "--no-header",
               "--rootdir", str(ROOT), "-c", str(ROOT / "pyproject.toml"), "-k", words,
               *map(str, tests)]
    csrc = work / "csrc"                # of a mutant of the core
    environment = {**os.environ, "PYTEST_ADDOPTS": "", "PYTHONPATH": str(work),
                   "PYTHONDONTWRITEBYTECODE": "1", "CONVERSE_CONSOLE": str(work / "console.so"),
                   "CONVERSE_CSRC": str(csrc if csrc.exists() else ROOT / "csrc")}
    try:
        done = subprocess.run(command, cwd=work, env=environment, text=True, capture_output=True,
                              timeout=PATIENCE)
    except subprocess.TimeoutExpired:
        return ENDLESS
    if done.returncode in (0, 5):       # 5: all were skipped
        return None
    failed = [line for line in done.stdout.splitlines()
              if line.startswith(("FAILED", "ERROR")) and "::" in line]
    if not failed:
        return CRASH
    path, _, test = failed[0].split(" ", 1)[1].split(" - ")[0].partition("::")
    return "%s::%s" % (Path(path).name, test)


def reason(place):
    """Why a survivor is accepted, or None."""
    function = "%s:%s" % (place.name, place.mutant.function)
    for key in (place.key, "%s %s" % (function, place.mutant.operator), function):
        if key in ACCEPTED:
            return ACCEPTED[key]
    return None


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="python tests/mutate", description="Mutation tests.",
                                     epilog=(
        "Operators: " + "; ".join("%s: %s" % item for item in OPERATORS.items()) + "."))
    parser.add_argument("where", nargs="*", metavar="WHERE", help="FILE, FILE:FUNCTION or a mutant")
    parser.add_argument("--sample", type=int, metavar="N", help="try N of them")
    parser.add_argument("--seed", default="0", help="of the sample")
    parser.add_argument("--list", action="store_true", help="print the mutants and try none")
    options = parser.parse_args(arguments)
    found = places(options.where)
    if options.sample is not None:
        found = sample(found, options.sample, options.seed)
    if options.list:
        for place in found:
            print("%s, line %d: %s" % (place.key, place.mutant.line, place.mutant.change))
        return 0
    counts = {}
    print("%d mutants" % len(found), flush=True)
    with tempfile.TemporaryDirectory() as directory, ThreadPoolExecutor(os.cpu_count()) as pool:
        base = Base(Path(directory))
        for place, fate in zip(found, pool.map(base.tried, found)):
            if fate == "survived" and reason(place):
                fate = "accepted: " + reason(place)
            kind = fate.partition(" by")[0].partition(":")[0]
            counts[kind] = counts.get(kind, 0) + 1
            print("%s, line %d: %s\n    %s" % (place.key, place.mutant.line, place.mutant.change,
                                             fate.replace("survived", "SURVIVED")), flush=True)
    print(", ".join("%d %s" % (n, kind) for kind, n in sorted(counts.items())))
    return 1 if {"survived", "no verdict"} & counts.keys() else 0


if __name__ == "__main__":
    sys.exit(main())
