(* The checker as OCaml, for verified.ml.

   Trusted beyond Coq: its extraction, the OCaml compiler, verified.ml, and that the processor's
   doubles are those of IEEE 754 (which Coq's kernel believes, too, when it computes with floats).
   Integers, rationals and lists stay Coq's own inductive types; only booleans, pairs, lists and options
   become OCaml's, and PrimFloat's and Uint63's operations become those of Coq's own kernel. *)

From Coq Require Import ZArith QArith Extraction.
From Coq Require Import ExtrOcamlBasic ExtrOCamlFloats ExtrOCamlInt63.
From Converse Require Import Tree Share Torus Reduce Check Doubles.

(* The functor's formats of numbers name real numbers, which no computation asks for. *)
Extract Constant ClassicalDedekindReals.sig_forall_dec => "(fun _ -> assert false)".

(* Is beta of these waves at most B everywhere?  Only what is said of a wrong file hangs on it. *)
Definition below := patch_below prec.

Set Warnings "-extraction-opaque-accessed".
Extraction "checker.ml" header_ok leaf_ok every_leaf all_parts at_part covers felt odd_about
  alone_ok mirrored all_links linked_ok axes orders_of plain_problem parameters below
  Z.add Z.mul Z.opp Z.div_eucl Z.compare Qplus Qminus Qmult Qcompare Qred.
