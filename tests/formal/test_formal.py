"""How theorems for Coq are written down: what they say is in Map.v's words, and nobody else's, and
what they assume is looked at.  (make formal-quick builds what is used here.)"""

import importlib
import re
import shutil
import subprocess
import sys

import pytest
import test_parts as by_hand
from conftest import ROOT

from converse import Problem, prove, read_input, tori
from converse.model.map import SymplecticMap

FORMAL = ROOT / "formal"
needs_coq = pytest.mark.skipif(
    not shutil.which("coqc") or not (FORMAL / "Plain.vo").exists(),
    reason="make formal-quick was not run")

@pytest.fixture(scope="module")
def proof(tmp_path_factory):
    """Finished proof files."""
    def proof(name):
        path = tmp_path_factory.mktemp("proofs") / "proof"
        problem = read_input(ROOT / "inputs" / (name + ".in")).tied()
        prove(problem, method="loewner").save(path)
        return path
    return proof


@pytest.fixture
def folder(tmp_path):
    """A folder like formal/, with its library, for theorems of our own."""
    for path in FORMAL.glob("*.vo"):
        (tmp_path / path.name).symlink_to(path)
    (tmp_path / "build").mkdir()
    return tmp_path


def write(proof, name, folder, *options):
    """What theorem.py makes of a proof file; the paths of what it wrote."""
    subprocess.run([sys.executable, FORMAL / "theorem.py", *options, proof, name, folder / "build"],
                   check=True)
    return {path.stem: path for path in (folder / "build").glob("*.v")}


def compiled(folder, file):
    """Does Coq accept it?  What it says of it."""
    done = subprocess.run(["coqc", "-q", "-Q", ".", "Converse", file], cwd=folder, text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          stdin=subprocess.DEVNULL)
    return done.returncode == 0, done.stdout


def test_who_reads_map_and_says_has_read_enough(proof, tmp_path):
    """The proposition imports Map.v alone; the theorem's file that and Map.v, and nothing else."""
    (tmp_path / "build").mkdir()
    files = write(proof("trig278"), "trig278", tmp_path, "--parts", "3")
    assert sorted(files) == ["trig278",
                             *("trig278_%s" % end for end in ("0", "1", "2", "claim", "says"))]
    says, theorem = (files[name].read_text() for name in ("trig278_says", "trig278"))
    imports = re.compile(r"From Converse(?:\.build)? Require Import (.*)\.")
    assert says.count("Converse ") == 1 and imports.findall(says) == ["Map"]
    assert imports.findall(theorem) == ["Map", "trig278_says"]
    commands = re.findall(r"^(?!From|Open|Import|Proof|Qed|Check|Print|Set|Add| |\(\*)(.+)$",
                          says + theorem, re.M)
    assert commands == ["Definition trig278_says : Prop :=", "Theorem trig278 : trig278_says."]


def test_linked_parts(tmp_path):
    """They are in the claim's file, where a is the next part; what is said is in the same words."""
    found = by_hand.linked(by_hand.found(), (by_hand.OTHER, "0.85 0.87"))
    (tmp_path / "build").mkdir()
    for v0, said in ((found["v0"], "(forall t, in_cube t -> no_invariant_graph (waves patch t))"),
                     ("0.5364 0.2502", "no_invariant_graph_into (Region 1 1 1 (-1) 0.5364 0.2502 "
                      "0.5 0.5) (waves patch t) (point (0.858, 0.858))")):
        (tmp_path / "proof").write_text(by_hand.file_of(**{**found, "v0": v0}))
        files = write(tmp_path / "proof", "linked", tmp_path)
        assert said.strip("()") in files["linked_says"].read_text()
        claim = files["linked_claim"].read_text()
        parts = claim.partition("the_parts")[2].split("Part (")[1:]
        assert [text[:14] for text in parts] == ["0.875, 0.875) ", "0.85, 0.87) (0"]
        assert "a" in claim.partition("the_tree")[2].partition("]")[0]
        hints = claim.partition("the_hints")[2].partition("the_tree")[0]
        assert re.findall(r"\(\[(.*?)\], \(", hints) == [""]       # no parameter
        assert [re.search(r'\["(.*)"\]', text)[1] for text in parts] == [
            found["parts"][0][3].replace("b", "a"), found["parts"][1][3]]


def test_regions_that_move(tmp_path):
    """What the parameters shift is in the claim's file: v0 by each of them, then v1."""
    moves = "0.5362 0.2802 0.01 0.02", "0.5 0.535 -0.03 0.005"
    text = by_hand.file_of("a", waves=by_hand.APART, parts=[(by_hand.XSTAR, *moves, "P")])
    (tmp_path / "build").mkdir()
    (tmp_path / "proof").write_text(text)
    claim = write(tmp_path / "proof", "moving", tmp_path)["moving_claim"].read_text()
    assert "Part (0.858, 0.858) (0.5362, 0.2802) (0.5, 0.535) ([0.01; 0.02], [(-0.03); 0.005]) (" \
        in claim
    assert claim.count("([], [])") == 1         # the header's

    text = by_hand.file_of("a", waves=by_hand.APART, parts=[(by_hand.XSTAR, *moves, "2PS")])
    (tmp_path / "proof").write_text(text)
    done = subprocess.run([sys.executable, FORMAL / "theorem.py", tmp_path / "proof", "wrong",
                           tmp_path / "build"], stderr=subprocess.PIPE, text=True)
    assert done.returncode == 1 and done.stderr.count("\n") == 1
    assert "part a: symmetric leaf 1 of 1" in done.stderr


@needs_coq
def test_words_that_mean_something_else(proof, folder):
    """A file like the written ones that gives Map.v's words another meaning: what it proves is the
    proposition to the letter, and not the proposition."""
    files = write(proof("trig278"), "trig278", folder)
    claim, says, theorem = (files["trig278" + end] for end in ("_claim", "_says", ""))
    too_much, changed = re.subn(r"Term (\d \d 0) [0-9.]+ \[[0-9.]+\]", r"Term \1 0 [0.25]",
                                says.read_text())
    assert changed == 3
    says.write_text(too_much)
    claim.write_text(claim.read_text() +
                     "\nDefinition waves (patch : list term) := Map.waves (of_patch the_claim).\n")
    for name in ("trig278_says", "trig278_claim", "trig278_0"):
        assert compiled(folder, "build/%s.v" % name) == (True, "")
    accepted, said = compiled(folder, "build/trig278.v")
    assert not accepted and re.search(
        r'"Check\.statement trig278_claim\.the_claim trig278_claim\.the_parts"\s+while it is\s+'
        r'expected to have type\s+"trig278_says"', said), said
    # The trick is one: with the proposition in a file that imports the others it is proved.
    proposition = re.search(r"(?s):=(.*)\.", too_much)[1]
    text = theorem.read_text().partition("Add Printing")[0]
    text = text.replace("Require trig278_claim", "Require Import trig278_claim")
    (folder / "build" / "fooled.v").write_text(
        text.replace("Theorem trig278 : trig278_says", "Theorem trig278 : " + proposition))
    assert compiled(folder, "build/fooled.v") == (True, "")


@needs_coq
def test_a_theorem_of_another_proposition_of_the_name(folder):
    """How docs/proofs/coq.md has Coq asked, for him who does not read the theorem's file
    either."""
    says = "From Converse Require Import Map.\n" \
        "Definition x_says : Prop := no_invariant_graph nil.\n"
    (folder / "build" / "x_says.v").write_text(says)
    (folder / "build" / "x.v").write_text(
        "From Converse.build Require Import x_says.\nDefinition x_says : Prop := True.\n"
        "Module x_says. Definition x_says : Prop := True. End x_says.\n"
        "Theorem x : x_says. Proof. exact I. Qed.\nCheck x. Print Assumptions x.\n")
    question = re.search(r"(?m)^    (From Converse\.build Require NAME.*)\n    (Check .*)\n",
                         (ROOT / "docs/proofs/coq.md").read_text("utf-8"))
    (folder / "build" / "asked.v").write_text("\n".join(question.groups()).replace("NAME", "x"))
    for name in "x_says", "x":
        assert compiled(folder, "build/%s.v" % name)[0]
    accepted, said = compiled(folder, "build/asked.v")
    assert not accepted and 'expected to have type\n "x_says.x_says"' in said, said


@needs_coq
def test_no_torus(proof, folder):
    """It follows from the theorem trig180, down to where that begins and no further."""
    write(proof("trig180"), "trig180", folder)
    (folder / "build" / "trig180.v").write_text(
        "From Converse.build Require Import trig180_says.\nAxiom trig180 : trig180_says.\n")
    for name in ("trig180_says", "trig180"):
        assert compiled(folder, "build/%s.v" % name)[0]
    text = (FORMAL / "NoTorus.v").read_text()
    assert re.findall("Import (.*)", text) == ["Reals Qreals Lra."]
    lower = "0.20185847"
    for file, wanted in ("NoTorus", text), ("Lower", text.replace("0.20185848", lower)):
        (folder / (file + ".v")).write_text(wanted)
        accepted, said = compiled(folder, file + ".v")
        assert accepted == (file == "NoTorus"), said
    status, said, err = gate(folder, "Integers", "Converse.NoTorus.no_torus")
    assert status == 1 and said.startswith("NoTorus.no_torus")
    assert err.endswith(" with Integers: trig180.trig180 : trig180_says.trig180_says\n")


# Of the standard map with the parameter 0.1: sine coefficients of u0 in units of 2^-64.
SINES = [-530926405919999403, 14564366147133731, -1172480179637604, 17704148907037, -6233377838905,
         141275608745, -4627202103, 4441242788, -62899253, 6151008, -366845, 9769, -28836, 482]


@needs_coq
def test_certificates_of_existence(folder):
    """One of them holds; it does not with an integer altered, nor for another sign or amplitude."""
    altered = [*SINES[:3], SINES[3] + 10 ** 5, *SINES[4:]]
    (folder / "build" / "certificates.v").write_text(
        "From Coq Require Import ZArith List.\nFrom Converse Require Exists.\n"
        "Import ListNotations.\n" + "".join(
            "Goal Exists.holds (Exists.Certificate 5 4 (%d) %d %s%%Z (2 ^ 64) 60 10) = %s.\n"
            "Proof. vm_compute. reflexivity. Qed.\n" % (sign, over, str(sines).replace(",", ";"),
                                                       holds)
            for sines, sign, over, holds in [
                (SINES, 1, 10, "true"), (altered, 1, 10, "false"), (SINES, -1, 10, "false"),
                (SINES, 1, 9, "false")]))
    assert compiled(folder, "build/certificates.v") == (True, "")


def refused(file, folder):
    """What theorem.py says of it, in one line."""
    done = subprocess.run([sys.executable, FORMAL / "theorem.py", file, "x", folder / "build"],
                          stderr=subprocess.PIPE, text=True)
    assert done.returncode == 1 and done.stderr.count("\n") == 1
    assert not list((folder / "build").glob("x*"))
    return done.stderr


def torus_file(path, k, margin=100, rotation="golden", phase="0"):
    """A certificate of existence for the standard map, in the place of one that is there."""
    path.unlink(missing_ok=True)
    problem = Problem(SymplecticMap([(1, 0, phase)], [k]))
    tori.prove(tori.find(problem, tori.read_rotation(rotation), margin=margin)).save(path)
    return path


def test_certificates_of_which_there_is_no_theorem(tmp_path):
    (tmp_path / "build").mkdir()
    for changes, said in [
            ({"rotation": "silver"}, "has another rotation than `--rotation golden`"),
            ({"phase": "0.25"}, "has another potential than p sin(y) or p cos(y)"),
            ({"k": "0.9"}, "the norms of its torus and of the derivative are 0.4551 and 1.1154"),
            ({}, "the residual of its torus is 8.9e+07 times as large as Coq's theorem of "
                 "existence allows: let converse-tori prove it with a --margin 1e9 times as large"),
            ({"margin": 2e10}, "let converse-tori prove it with a --margin 1e2 times as large")]:
        file = torus_file(tmp_path / "x.torus", **{"k": "0.3", **changes})
        assert said in refused(file, tmp_path)


@needs_coq
@pytest.mark.parametrize("flag", ["--parts=2", "--numbers=Doubles"])
def test_a_certificate_takes_no_flags(tmp_path, flag):
    done = subprocess.run([
        sys.executable, FORMAL / "theorem.py", ROOT / "golden_outputs" / "tori" /
        "standard-0.9.torus", "x", tmp_path, flag], capture_output=True, text=True, check=False)
    assert done.returncode and "leave out --numbers and --parts" in done.stderr
    assert done.stderr.count("\n") == 1 and not list(tmp_path.iterdir())


def test_theorem_of_existence(folder):
    """Of a certificate with the margin that the line of the other test asks for; Coq does not
    accept it with the sign of an integer altered."""
    files = write(torus_file(folder / "x.torus", "-0.3", 1e11, phase="0.5"), "x", folder)
    says, proof = files["x_exists_says"], files["x_exists"]
    assert re.findall("Converse.* Import (.*)", says.read_text()) == ["Map."]
    assert re.findall("Converse.* Import (.*)", proof.read_text()) == ["Map.", "x_exists_says."]
    assert compiled(folder, "build/x_exists_says.v") == (True, "")
    accepted, said = compiled(folder, "build/x_exists.v")
    assert accepted and "has_invariant_graph (waves [Term 1 0 0.5 (-0.3) []] [])" in said, said
    status, said, err = gate(folder, "Integers", "Converse.build.x_exists_says.x_exists_says",
                             "Converse.build.x_exists.x_exists")
    assert (status, err) == (0, "") and said.startswith(
        "x_exists.x_exists : x_exists_says.x_exists_says\n")
    before, _, after = proof.read_text().partition("    [")
    proof.write_text(before + "    [" + (after[1:] if after[0] == "-" else "-" + after))
    accepted, said = compiled(folder, "build/x_exists.v")
    assert not accepted and 'expected to have type\n "Exists.holds' in said, said


@needs_coq
def test_golden(folder):
    """It says what it says in Map.v's words alone, and it is about this potential."""
    says, golden = ((FORMAL / name).read_text() for name in ("golden_says.v", "golden.v"))
    assert re.findall("Converse.* Import (.*)", says) == ["Map."]
    assert re.findall("Converse.* Import (.*)", golden) == ["golden_says."]
    golden, changed = re.subn(r"(?s)Lemma (conjugated : .*?)Proof.*?Qed\.", r"Axiom \1", golden)
    assert changed == 1     # what takes Coq half a minute
    text = golden.replace("Converse Require Import", "Converse.build Require Import")
    for amplitude in "0.8", "(-0.8)", "0.9":
        (folder / "build" / "golden_says.v").write_text(says.replace("0.8]", amplitude + "]"))
        (folder / "build" / "golden.v").write_text(text)
        assert compiled(folder, "build/golden_says.v") == (True, "")
        accepted, said = compiled(folder, "build/golden.v")
        assert accepted == (amplitude == "0.8"), said
        assert accepted or 'expected to have type "golden_says"' in " ".join(said.split()), said


@needs_coq
def test_what_links_two_points_of_a_graph(folder):
    """It is true of every invariant graph of Map.v, and assumes no more than the reals."""
    (folder / "build" / "link.v").write_text(
        "From Converse Require Import Map Link.\n"
        "Check (link : forall ws c S S', periodic S -> has_gradient S S' ->\n"
        "       invariant_graph ws c S' -> _).\n")
    accepted, said = compiled(folder, "build/link.v")
    assert accepted, said
    status, said, err = gate(folder, "Integers", "Converse.Link.link")
    assert (status, err) == (0, "") and "\nAxioms:\n" in said
    status, said, err = gate(folder, "Integers", "Converse.Map.in_cube", "Converse.Link.link")
    assert (status, said) == (1, "")
    assert err.endswith(": Coq does not accept it as the theorem that it should be\n")


def gate(folder, *arguments):
    """Asks Coq as `make formal` does: the exit status, the answer, and why it was refused."""
    done = subprocess.run([sys.executable, FORMAL / "assumed.py", *arguments], cwd=folder,
                          text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    return done.returncode, done.stdout, done.stderr


# The files that an attacker adds, how they prove anything, and which of their axioms is found.  In
# the second attack the axiom is printed as the library's, but of other integers it is false.
ATTACKS = [
    ({"Uint63": "Axiom any_proposition : forall P : Prop, P."}, "Uint63.any_proposition _",
     ["Uint63.any_proposition : forall P : Prop, P"]),
    ({"PrimInt63": "Definition int := bool.\nDefinition eqb (i j : int) := true.",
      "Uint63": "From Converse.build Require Import PrimInt63.\n"
                "Axiom eqb_correct : forall i j : int, eqb i j = true -> i = j."},
     "False_ind _ (Bool.diff_true_false (Uint63.eqb_correct true false eq_refl))", [])]


@needs_coq
@pytest.mark.parametrize("files, proof, found", ATTACKS)
def test_a_file_that_has_the_name_of_one_of_coq(folder, files, proof, found):
    """Its axioms are none of Coq's, whatever they are called."""
    files = {**files, "x_says": "From Converse Require Import Map.\n"
                                "Definition x_says : Prop := no_invariant_graph nil.",
             "x": "From Coq Require Bool.\nFrom Converse.build Require x_says %s.\n"
                  "Theorem x : x_says.x_says.\nProof. exact (%s). Qed." % (" ".join(files), proof)}
    for name, text in files.items():
        (folder / "build" / (name + ".v")).write_text(text)
        assert compiled(folder, "build/%s.v" % name) == (True, "")
    status, said, err = gate(folder, "BigIntegers", "Converse.build.x_says.x_says",
                             "Converse.build.x.x")
    found = ["a library of the name Converse.build." + name for name in files
             if not name.startswith("x")] + found
    assert status == 1 and said.startswith("x.x : x_says.x_says\n")
    assert err == "Converse.build.x.x: this may not be assumed with BigIntegers: %s\n" % (
        "; ".join(found))


def assumed():
    sys.path.insert(0, str(FORMAL))
    try:
        return importlib.import_module("assumed")
    finally:
        sys.path.pop(0)


ANSWER = """\
x.x : x_says.x_says
     : x_says.x_says
Loaded library files:\x20
  Coq.Init.Prelude
  Coq.Numbers.Cyclic.Int63.Uint63
  Flocq.IEEE754.PrimFloat
  Converse.Map
  Converse.build.x

Axioms:
ClassicalDedekindReals.sig_not_dec : forall P : Prop, {~ ~ P} + {~ P}
ClassicalDedekindReals.sig_forall_dec
  : forall P : nat -> Prop,
    (forall n : nat, {P n} + {~ P n}) -> {n : nat | ~ P n} + {forall n : nat, P n}
FunctionalExtensionality.functional_extensionality_dep
  : forall (A : Type) (B : A -> Type) (f g : forall x : A, B x), (forall x : A, f x = g x) -> f = g
Classical_Prop.classic : forall P : Prop, P \\/ ~ P
"""
REFLEXIVE = "Uint63.eqb_refl : forall x : PrimInt63.int, PrimInt63.eqb x x = %s\n"
ROOT_OF = "PrimFloat.sqrt\n  : PrimFloat.float ->\n    PrimFloat.float\n"


@pytest.mark.parametrize("numbers, more, found", [
    ("Integers", "", 0), ("Integers", "PrimInt63.int : Set\n", 1),
    ("BigIntegers", "PrimInt63.int : Set\n", 0), ("BigIntegers", REFLEXIVE % "true", 0),
    ("BigIntegers", REFLEXIVE % "false", 1), ("BigIntegers", "Uint63.any : False\n", 1),
    ("BigIntegers", ROOT_OF, 1), ("Doubles", ROOT_OF + REFLEXIVE % "true", 0),
    ("Doubles", "FloatAxioms.mul_spec\n  : forall x y : PrimFloat.float, x = y\n", 1),
    ("Doubles", "trig278_0.leaves\n  : forallb f l = true\n", 1),
    ("Doubles", "leaves : forallb f l = true\n", 1), ("Doubles", "Reals.classic : False\n", 1),
    ("Doubles", "x relies on an unsafe hierarchy.\n", 1)])
def test_what_may_be_assumed(numbers, more, found):
    assert len(assumed().others(numbers, ANSWER + more)) == found


@pytest.mark.parametrize("library", ["Uint63", "BinInt", "Z", "x.SpecFloat"])
def test_libraries_that_are_called_the_same(library):
    """Coq leaves out the names of their folders."""
    library = "Converse.build." + library
    said = ANSWER.replace("Converse.build.x\n", library + "\n")
    assert assumed().others("Doubles", said) == ["a library of the name " + library]


@pytest.mark.parametrize("change", [
    ("Axioms:", "Closed under the global context"), ("  Coq.Init.Prelude\n", "  And more:\n"),
    ("\nAxioms:", "\nTheory: Type hierarchy is collapsed (logic is inconsistent)\nAxioms:")])
def test_no_list_of_axioms_is_no_good_news(change):
    assert assumed().others("Doubles", ANSWER) == []
    assert assumed().others("Doubles", ANSWER.replace(*change)) == ["no list of axioms"]
