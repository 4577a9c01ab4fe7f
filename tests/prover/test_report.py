"""The reports: the thesis's words to the letter, and no claim beyond what was examined."""

import itertools
import math
import re
from dataclasses import replace
from fractions import Fraction

import pytest

from converse import Counts, Problem, Proof, prove
from converse.model.map import MuldoonMap, SymplecticMap, from_patch
from converse.model.problem import IDENTITY
from converse.model.statement import conditions, map_lines, potential_text
from converse.prover import run
from converse.prover.report import report, verdict
from converse.version import __version__

COUNTS = Counts(quick_tries=322, tries=318, Rtries=156, cuts=166, proved=156, symmetric=11,
                HermSuccess=0, LLSuccess=156, ll_used=(155, 0, 1), reasons=(4, 158, 4, 0, 0, 0),
                most_cuts=13, max_steps=5, max_NTsteps=4)
COMMENTS = ("0.0274 < epsilon < 0.0276", "Run on kastor", "May 2, 1989")


def test_the_thesis_to_the_letter(root, made_up):
    proof = made_up("P", comments=COMMENTS, counts=COUNTS, as_printed=True, seconds=2697.53)
    thesis = (root / "golden_outputs" / "thesis" / "trig274.out").read_text("utf-8")
    assert "apmValidate : null APM value in map.c at line 296.\n" + proof.report() == thesis
    assert proof.all_decided and not proof.no_tori


def test_sound_labels_are_right(made_up):
    text = made_up("P", counts=COUNTS).report()
    assert "the maxBlam criterion 99.4% of the time,\nthe minBlam criterion 0.0%" in text


def test_sound_mode_adds_its_grounds(made_up):
    text = made_up("P", counts=COUNTS, digits=50, xstar=("1.5", "1.625")).report()
    assert text.startswith("Parameters :\n")
    end = text[text.index("seconds.\n"):]
    for words in ("converse " + __version__, "50 decimal places", "x* : 1.5 1.625", "T : 1.25",
                  "B : 1.25",
                  "Tries that failed : 166", "158 : an image prism grew too big"):
        assert words in end
    assert "\n0 : " not in end


def test_the_sharper_method_in_its_own_words(made_up):
    """The theorem comes first; the method has no images, and what it excludes is closed.  (The
    golden outputs have whole reports.)"""
    text = made_up("P", method="loewner", counts=COUNTS, comments=("A line.",)).report()
    assert text.startswith("THEOREM\n") and "image" not in text and " < " not in text
    for name, words in ("a.proof", "a.proof"), ("a b.proof", "'a b.proof'"):
        assert "converse-check %s\n" % words in verdict(made_up("P", method="loewner"), name)


def test_header_without_comments(made_up):
    assert (
        "v[1] : 3.14159265358979e+00 \t 3.14159265358979e+00\n\nComments :\n\n\n"
        + "+" * 48 + "\n") in report(made_up("P"))


def test_no_trailing_blanks(made_up):
    for method in "thesis", "loewner":
        proof = made_up("0PU", method=method, counts=COUNTS, comments=("one", "", "two"))
        for line in proof.report().split("\n"):
            assert line == line.rstrip()


def test_bounds_are_exact(made_up):
    text = verdict(made_up("P", a="0.30851234567"))
    assert "0.30726234567 < a < 0.30976234567" in text
    assert "0.61452469134 < c < 0.61952469134" in text


def test_single_values(made_up):
    proof = made_up("P")
    text = verdict(proof.with_tree(0, problem=Problem(MuldoonMap("0.3085", "0.3085", "0.617"))))
    assert "a = 0.308500\nb = 0.308500\nc = 0.617000\n" in text and "<" not in text


def test_part_of_the_torus(made_up):
    text = verdict(made_up("P", v=("0.5", "1", "0.25", "1")))
    assert text.startswith(
        "I find no invariant tori whose successor of x* lies in the region :\n"
        "0.250000 < v[0] / pi < 0.750000\n0.000000 < v[1] / pi < 2.000000\n"
        "(only a part of the torus: other successors were not examined)\n"
        "for the range of parameters :\n0.307250 < a < 0.309750\n")
    text = verdict(made_up("P", v=("0.5", "1", "0.25", "1"), method="loewner"))
    assert text.startswith("THEOREM, for a part of the torus only\n")
    assert "\n  whose orbit goes from x* = (1.5, 1.5) to y' = (v0, v1), where\n" \
        "  0.25 pi <= v0 <= 0.75 pi, 0 <= v1 <= 2 pi (no other y' was examined)\n" in text


@pytest.mark.parametrize("tree, stubborn, number, deepest, ended", [
    ("0PU", True, 1, 1, False), ("0P1UU", True, 2, 2, False), ("00U", False, 1, 2, True),
    ("0P", False, 0, None, True), ("", False, 0, None, True), ("U", False, 1, 0, False),
])
def test_undecided(made_up, tree, stubborn, number, deepest, ended):
    for as_printed in False, True:
        proof = made_up(tree, stubborn=stubborn, as_printed=as_printed)
        text = verdict(proof)
        assert not proof.no_tori and not proof.all_decided
        assert len(proof.undecided) == number
        assert text.startswith("I could not decide whether there are invariant tori")
        assert "I find no" not in text
        assert "Undecided prisms : %d\n" % number in text
        assert ("The deepest of them was cut %s times.\n" % deepest in text) == (number > 0)
        assert ("before the whole region was examined" in text) == ended
        assert ("To try : " in text) == (not as_printed)
        assert bool(re.search(r"\nThe first of them : [0-9.]+ < v\[0\] / pi < [0-9.]+, ",
                              text)) == (
            number > 0 and not as_printed)
        assert ("method='loewner'" in text) == (not as_printed)
        assert ("--method loewner" in verdict(proof, "")) == (not as_printed)


def test_the_deepest_of_the_undecided_prisms_is_told(made_up):
    text = made_up("0U1UU", method="loewner", stubborn=True).report()
    assert "3 prisms, the deepest cut 2 times" in text



@pytest.mark.parametrize("tree, words", [
    ("0PU", "Undecided  1 prism, the deepest cut 1 time\n           the first of them: "),
    ("00U", "\nEnded      at the limit of doubles: "),
    ("", "To try     more time (save(FILE), then prove(resume=FILE))\n"),
])
def test_undecided_by_the_sharper_method(made_up, tree, words):
    text = made_up(tree, method="loewner", stubborn=tree == "0PU").report()
    assert text.startswith("UNDECIDED: nothing is proved.  There may be an invariant torus (see "
                           "converse-tori).\n  The map  ")
    assert "  was examined for every a in [0.30725, 0.30975], " in text and words in text
    assert "THEOREM" not in text and "has no" not in text and "Verify" not in text


@pytest.mark.slow
def test_where_x_star_may_be_the_cause(monkeypatch):
    """For these two harmonics another x* proves it (docs/explanation/method.md), as it does where
    several are not linked; a lack of depth is another thing."""
    monkeypatch.setattr(run._Run, "_may_link", lambda self: False)
    waves = [(1, 0, "-1/2"), (2, 0, "-1/2")]
    problem = Problem(SymplecticMap(waves, ["0.6", "0.2"]))
    stuck = prove(problem, method="loewner", xstar=("1.856", "0"))
    text = stuck.report()
    low, high = re.search(r"the first of them: ([0-9.]+) pi <= v0 <= ([0-9.]+) pi\n",
                          text).groups()
    (c, _), (h, _) = stuck.undecided[0].centre, stuck.undecided[0].half
    assert abs(Fraction(low) - c + h) <= h / 100 and abs(Fraction(high) - c - h) <= h / 100
    assert "one of them is as small as doubles can tell: " in text
    assert "\nTo try     another x* (xstar=(X0, X1)), or other parameters\n" in text
    wide = Problem(SymplecticMap(waves, ["0.6", "0.2"], [["0.00001", 0]]))
    assert ", or a narrower range of parameters, or other parameters" in verdict(prove(
        wide, method="loewner", xstar=("1.856", "0")), "a.proof")
    assert prove(problem, method="loewner", xstar=("1.836", "0")).no_tori
    assert "x* (" not in prove(problem, method="loewner", xstar=("1.856", "0"), depth=5).report()
    point = prove(Problem(SymplecticMap(waves, ["0.06", "0.02"]), v0=Fraction(9, 8)),
                  method="loewner", depth=0, xstar=("1.856", "0"))
    assert re.search("the first of them: v0 = 1.1[0-9]* pi", point.report())


def test_amplitudes_that_are_too_large_are_to_become_smaller():
    for amplitude, words in (
            ("1e19", "amplitudes below 2^60, near 10^18: "), ("0.1", "other parameters")):
        proof = prove(Problem(SymplecticMap([(1, 0), (1, 1)], [amplitude, amplitude])), depth=0)
        assert not proof.no_tori and "\nTo try     " + words in proof.report()


def test_comments_are_not_the_programs_words(made_up):
    """Neither what a terminal obeys nor a sentence of the program's can be smuggled in."""
    claim = "I find no invariant tori for the range of parameters :"
    comments = claim, "\x1b]0;x\x07 \u202e \x9b2J", "tab\tstays", "THEOREM\nlines"
    for method, blank in ("thesis", ""), ("loewner", " " * 11):
        proof = made_up("U", comments=comments, method=method)
        text = proof.report()
        assert claim not in text.split("\n") and "> " + claim in text and "\nTHEOREM" not in text
        assert not set("\x1b\x07\x9b\u202e") & set(text)
        assert "\n".join(blank + line for line in (
            "> \\x1b]0;x\\x07 \\u202e \\x9b2J", "> tab\tstays", "> THEOREM", "> lines")) in text
    assert proof.problem.comments[3:] == ("THEOREM", "lines")


def test_a_loaded_proof_says_whence_it_is(made_up):
    assert "believed" not in made_up("0PS").report()
    assert "\nRestored : 2 prisms were read from a file that is believed\n" in \
        made_up("0PS", restored=2).report()
    assert "THEOREM, of which 2 prisms were read from a file that is believed\n" in \
        made_up("0PS", restored=2, method="loewner").report()


def test_the_map_is_stated(made_up):
    for tree in "P", "U":
        assert "\nMap : y' = y + J', J' = J - dV(y), V(y) = -a sin y0" in made_up(tree).report()


# ---- the theorem of the sharper method, in the parameters of the input

SIN, COS = (1, 0), (1, 0, "-1/2")
K, B = ("K", Fraction("0.9"), Fraction("1.4")), ("B", Fraction("0.1"), Fraction("0.1"))


def of_K(slope, constant=0):
    """What patch() takes of an amplitude constant + slope K."""
    low, high = K[1:]
    return constant + slope * (low + high) / 2, slope * (high - low) / 2


def named(*forms, waves=(COS, (0, 1, "-1/2"))):
    """A patch with the parameter K, each amplitude as of_K takes it."""
    amplitude, part = zip(*(of_K(*map(Fraction, form)) for form in forms))
    return Problem(from_patch(waves[:len(forms)], amplitude, [part], [K]))


def value(text, **names):
    """The number that a potential's text stands for."""
    text = re.sub(r"(sin|cos) (\w+)", r"\1(\2)", text)
    text = re.sub(r"(?<=[\w)\]]) (?=[\w(])", "*", text)
    return eval(text, {"sin": math.sin, "cos": math.cos, "pi": math.pi, **names})


@pytest.mark.parametrize("problem", [
    Problem(SymplecticMap([(1, 0), (1, -1, "1/2"), (-2, 3, "-1/3")], ["0.4", "-1e-8", "2"],
                          [["0.01", 0, "-1"], [0, "1.23456789", 0]])),
    Problem(SymplecticMap([(1, 0, "1/2"), (1, 1, "1"), (2, 0), (0, 3, "-1/2")],
                          [1, "0.5", "-0.25", 1])),
    Problem(SymplecticMap([(1, 0, "3/4"), (2, 0, "1")], ["-1", 1], [[0, "-0.5"]])),
    named((1, 0), ("-0.5", "0.25"), ("0.5", 0), (0, 0), waves=(SIN, COS, (0, 1), (1, 1))),
], ids=range(4))
def test_the_potential_is_the_maps(problem):
    """At the ends of all parameters and several angles, and so is the force."""
    text = potential_text(problem)
    forces = re.findall(r"J[01]?' = J[01]?( [+-] [^,]*|)(?=,)", " ".join(
        " ".join(map_lines(problem)[1:]).split()))
    assert len(forces) == problem.map.dimension
    for t in itertools.product((-1, 1), repeat=len(problem.parts)):
        ends = {name: float(high if sign > 0 else low)
                for (name, low, high), sign in zip(problem.parameters, t)}
        for y0, y1 in ((0.3, 1.1), (2.5, -0.7), (4.0, 5.5)):
            V = -sum(float(p + sum(x * part for x, part in zip(t, parts)))
                     * math.sin(k0 * y0 + k1 * y1 + math.pi * float(phase))
                     for (k0, k1, phase), p, *parts
                     in zip(problem.waves, problem.amplitude, *problem.parts))
            assert abs(value(text, y=y0, y0=y0, y1=y1, t=(0, *t), **ends) - V) < 1e-12
            for i, force in enumerate(forces):
                push = sum(wave[i] * float(p + sum(x * part for x, part in zip(t, parts)))
                           * math.cos(wave[0] * y0 + wave[1] * y1 + math.pi * float(wave[2]))
                           for wave, p, *parts
                           in zip(problem.waves, problem.amplitude, *problem.parts))
                assert abs(value("0" + force, y=y0, y0=y0, y1=y1, t=(0, *t), **ends) - push) < 1e-12


@pytest.mark.parametrize("problem, V, lines", [
    (named((1, 0)), "K cos y", ["for every K in [0.9, 1.4]", "and for every K > 1.4"]),
    (named((1, 0), ("0.5", 0)), "K cos y0 + 0.5 K cos y1",
     ["for every K in [0.9, 1.4]", "and for every K > 1.4"]),
    (named((1, 0), (0, "0.1")), "K cos y0 + 0.1 cos y1",
     ["for every K in [0.9, 1.4]", "and for every multiple s >= 1 of the amplitudes at K = 1.4"]),
    (named((1, "-0.1")), "(-0.1 + K) cos y",
     ["for every K in [0.9, 1.4]", "and for every multiple s >= 1 of the amplitudes at K = 1.4"]),
    (Problem(from_patch([COS], [-1], [["0.1"]], [("K", Fraction("-1.1"), Fraction("-0.9"))])),
     "K cos y", ["for every K in [-1.1, -0.9]",
                 "and for every multiple s >= 1 of the amplitudes at K = -0.9"]),
    (Problem(from_patch([COS, (2, 0, "-1/2")], [1, "0.1"], [["0.1", 0], [0, 0]], [
        ("K", Fraction("0.9"), Fraction("1.1")), B])),
     "K cos y + 0.1 cos(2 y)", ["for every K in [0.9, 1.1]",
                                "and for every multiple s >= 1 of these amplitudes"]),
    (Problem(SymplecticMap([COS, (2, 0)], [1, 1], [["0.1", 0], [0, "0.1"]])),
     "(1 + 0.1 t[1]) cos y - (1 + 0.1 t[2]) sin(2 y)",
     ["for every t[1] in [-1, 1], t[2] in [-1, 1]",
      "and for every multiple s >= 1 of these amplitudes"]),
    (Problem(SymplecticMap([(1, 1)], [1])), "-sin(y0 + y1)",
     ["and for every multiple s >= 1 of these amplitudes"]),
    (Problem(MuldoonMap(("0.9", 1), 0, 0)), "-a sin y0 - b sin y1 - c sin(y0 + y1)",
     ["for every a in [0.9, 1], b = 0, c = 0", "and for every a > 1"]),
    (Problem(MuldoonMap(("0.9", 1), (-1, 0), 0)), "-a sin y0 - b sin y1 - c sin(y0 + y1)",
     ["for every a in [0.9, 1], b in [-1, 0], c = 0",
      "and for every multiple s (a, b, c), s >= 1"]),
    (Problem(MuldoonMap(("0.9", 1), ("0.9", 1), ("1.8", 2)).tied()),
     "-a sin y0 - b sin y1 - c sin(y0 + y1)",
     ["for every (a, b, c) on the segment from (0.9, 0.9, 1.8) to (1, 1, 2)",
      "and for every multiple s >= 1 of the upper end"]),
    (Problem(MuldoonMap(*(("0.165972528", "0.31400208"),) * 2,
                        ("0.331945056", "0.62800416")).tied()),
     "-a sin y0 - b sin y1 - c sin(y0 + y1)",
     ["for every (a, b, c) on the segment from (0.165972528, 0.165972528, 0.331945056) to "
      "(0.31400208, 0.31400208, 0.62800416)", "and for every multiple s >= 1 of the upper end",
      "that is, with a = b = c/2 = 11.21436 epsilon, for every epsilon in [0.0148, 0.028] and "
      "every epsilon > 0.028"]),
], ids=range(12))
def test_for_which_parameters(problem, V, lines):
    """A multiple s >= 1 of all amplitudes, or of those at the upper end, and no more."""
    assert potential_text(problem) == V
    assert [line.replace("\xa0", " ") for line in conditions(problem, True)] == lines
    without = [line.replace("\xa0", " ").partition(" and every")[0] for line in conditions(problem)]
    assert without == [line.partition(" and every")[0] for line in lines if line[:3] != "and"]


def test_the_theorem_of_a_circle(made_up):
    proof = made_up("P", method="loewner", xstar=("1.5", "0")).with_tree(0, problem=named((1, 0)))
    assert "circle" in report(proof) and "circle" in report(proof.with_tree(0, text="U"))
    for problem, words in ((Problem(MuldoonMap(1, 0, 0)),
                            "So the map of y0 alone has no rotational"),
                           (Problem(MuldoonMap(0, 1, 0)),
                            "So the map of y1 alone has no rotational"),
                           (Problem(MuldoonMap(1, 1, 0)), None),
                           (Problem(MuldoonMap(1, 0, 1)), None)):
        text = report(proof.with_tree(0, problem=problem))
        assert (words or "has no invariant torus") in text and (words is not None) == (
            "circle" in text)


def test_names_of_parameters_are_kept(made_up, tmp_path):
    proof = made_up("P", method="loewner").with_tree(0, problem=named((1, 0)))
    proof.save(tmp_path / "a.proof")
    assert "\nparameter: K 0.9 1.4\n" in (tmp_path / "a.proof").read_text()
    again = Proof.load(tmp_path / "a.proof")
    assert again.problem.parameters == (K,) and "for every K in [0.9, 1.4].\n" in again.report()
    for wrong in ((), (B,)), ((K, K), (K,)):
        with pytest.raises(ValueError, match="K|B|parameters"):
            Problem(from_patch([COS], [1], [["0.1"]], wrong[0] or wrong[1]))


@pytest.mark.parametrize("problem, words", [
    (Problem(MuldoonMap(0, 0, 1)), "Searched   the y' = (v0, -v0 + v1) that follow x*, "),
    (Problem(SymplecticMap([(3, -2)], [1])), "the y' = (2 v0 - v1, 3 v0 - 2 v1) that follow x*, "),
    (Problem(MuldoonMap(1, 1, 0)),
     "           y0 alone was examined: no wave depends on both angles\n"),
    (Problem(MuldoonMap(1, 2, 0)),
     "           y1 alone was examined: no wave depends on both angles\n")])
def test_what_was_chosen(made_up, problem, words):
    proof = made_up("P", method="loewner")
    text = verdict(proof.with_tree(0, problem=problem))
    assert words in text
    plain = verdict(proof.with_tree(0, problem=replace(problem, axes=IDENTITY, alone="no")))
    assert words not in plain and "Searched   all y' that follow x*\n" in plain
