"""The tool of make mutate: what it makes is another program, places keep their names, and a mistake
that matters is caught."""

import random
import re
import runpy
import subprocess

import pytest
from conftest import ROOT
from mutate.operators import OPERATORS, mutants

from truth import TORTURE

TOOL = runpy.run_path(str(ROOT / "tests" / "mutate" / "__main__.py"))
SMALL = """
enum { SOME = 3 };                      /* no function: + - < are safe here */
#define TWICE(x) ((x) + (x))
static int R(width)(const int *x, int n)
{
    int sum = 0;
    for (int j = 0; j < n && x[j]; j++)
        sum += APM_UP;                  /* a + b */
    note("a + b", sum);
    return sum - 2 * n;
}
"""


def test_places_of_c():
    found = {(m.operator, m.number): m for m in mutants("small.c", SMALL)}
    assert {m.function for m in found.values()} == {"width"}
    assert {key: m.change for key, m in found.items()} == {
        ("constant", 1): "0 -> 1", ("constant", 2): "0 -> 1", ("constant", 3): "2 -> (2 * 2)",
        ("compare", 1): "< -> <=", ("logic", 1): "&& -> ||", ("index", 1): " -> + 1",
        ("sign", 1): "+= -> -=", ("sign", 2): "- -> +", ("term", 1): "- 2 * n -> nothing",
        ("direction", 1): "APM_UP -> APM_DOWN", ("drop", 1): "sum += APM_UP; -> ;",
        ("drop", 2): 'note("a + b", sum); -> ;'}
    assert "    return sum ;\n" in found["term", 1].text and "x[j + 1]" in found["index", 1].text
    assert {operator for operator, _ in found} == set(OPERATORS) - {"factor"}


def test_formatting_and_names_of_variables_do_not_matter():
    other = SMALL.replace("\n    ", " ").replace("sum", "total").replace(" - 2", "\n- 2")
    assert [m.key for m in mutants("small.c", other)] == [m.key for m in mutants("small.c", SMALL)]


def test_places_of_python():
    text = ("def width(x, n):\n    if x < n and min(x, 1) == n:\n        x += 0.5\n"
            "    return x - 3 * n\n")
    found = [(m.operator, m.text) for m in mutants("small.py", text)]
    assert sorted(operator for operator, _ in found) == [
        "compare", "compare", "constant", "constant", "constant", "direction", "factor", "factor",
        "logic", "sign", "sign", "term"]
    assert all(other != text and compile(other, "small.py", "exec") for _, other in found)
    assert len({other for _, other in found}) == len(found)


def test_every_mutant_of_the_core_differs_and_most_compile(tmp_path):
    rng, compiled = random.Random(1), []
    for name, path in TOOL["sources"]().items():
        text = path.read_text("utf-8")
        found = mutants(name, text)
        assert len({m.key for m in found}) == len(found)
        assert all(m.text != text for m in found)
        if name in ("arith/apm.c", "arith/special.c", "model/torus.c", "search/tree.c",
                    "loewner/problem.c"):
            for mutant in rng.sample(found, 6):
                (tmp_path / "mutant.c").write_text(mutant.text, "utf-8")
                compiled.append(subprocess.run(
                    ["gcc", "-std=c11", "-fsyntax-only", "-w", "-I", ROOT / "csrc", "-I",
                     path.parent, "mutant.c"], cwd=tmp_path, capture_output=True).returncode == 0)
    assert len(compiled) == 30 and compiled.count(True) >= 27


def test_what_is_accepted_exists():
    found = TOOL["places"]()
    keys = {key for place in found for key in (
        place.key, "%s:%s" % (place.name, place.mutant.function),
        "%s:%s %s" % (place.name, place.mutant.function, place.mutant.operator))}
    assert set(TOOL["ACCEPTED"]) <= keys


def test_samples():
    found = TOOL["places"](["thesis/lambda.inc", "thesis/trace.inc:bound_btrace"])
    keys = [[place.key for place in TOOL["sample"](found, 20, seed)] for seed in "112"]
    assert keys[0] == keys[1] != keys[2] and len(set(keys[0])) == 20
    assert sorted(place.key for place in TOOL["sample"](found, 10 ** 6, "1")) == sorted(
        place.key for place in found)


@pytest.mark.skipif(TORTURE <= 1, reason="compiles a core; make torture has it")
def test_a_fatal_mistake_is_caught(tmp_path, monkeypatch):
    """And nothing fails with the unchanged core, so that it is the mistake that is noticed; a test
    that fails anyhow says nothing.  What the user asks of pytest is not asked of these tests."""
    monkeypatch.setenv("PYTEST_ADDOPTS", "-m slow")
    base = TOOL["Base"](tmp_path)
    fatal, = TOOL["places"](["arith/apm.c:apm_cmp drop 1"])
    assert base.tried(fatal).startswith("caught by test_apm.py, test_")
    fatal_too, = TOOL["places"](["check/series.py:sizes sign 1"])
    assert base.tried(fatal_too).startswith("caught by test_tori_bounds.py, test_norms_are_sums")
    base.passed = dict.fromkeys(base.passed, False)
    monkeypatch.setitem(TOOL["Base"].tried.__globals__, "failure", lambda *_: "test_norms")
    base.passed["test_norms"] = False
    assert base.tried(fatal_too).startswith("no verdict: test_tori_bounds.py fails without it, too")


def test_the_tests_that_are_named_exist():
    """One file for each name, and in it a test for each word behind a colon."""
    for named in {each for tests in TOOL["TESTS"].values() for each in tests}:
        name, _, words = named.partition(": ")
        text = "".join([path.read_text("utf-8") for path in (ROOT / "tests").rglob(name)])
        tests = re.findall(r"(?m)^def (test_\w+)", text)
        assert tests and all(any(word in test for test in tests)
                             for word in words.split(" or ")), named
    assert all(any(map(name.startswith, TOOL["TESTS"])) for name in TOOL["sources"]()
               if TOOL["mutants"](name, TOOL["sources"]()[name].read_text("utf-8")))
