(* The checker as OCaml, for verified.ml.

   Trusted beyond Coq: its extraction, the OCaml compiler, verified.ml, and that the processor's
   doubles are those of IEEE 754 (which Coq's kernel believes, too, when it computes with floats).
   Integers, rationals and lists stay Coq's own inductive types; only booleans, pairs, lists and options
   become OCaml's, and PrimFloat's and Uint63's operations become those of Coq's own kernel. *)

From Coq Require Import ZArith QArith Extraction.
From Coq Require Import ExtrOcamlBasic ExtrOCamlFloats ExtrOCamlInt63.
From Converse Require Import Tree Share Torus Reduce Check Doubles.

(* The same operations, put where they are called, for OCaml to compile them there. *)
Extract Inlined Constant PrimFloat.abs => "Float64.abs".
Extract Inlined Constant PrimFloat.sqrt => "Float64.sqrt".
Extract Inlined Constant PrimFloat.opp => "Float64.opp".
Extract Inlined Constant PrimFloat.eqb => "Float64.eq".
Extract Inlined Constant PrimFloat.ltb => "Float64.lt".
Extract Inlined Constant PrimFloat.leb => "Float64.le".
Extract Inlined Constant PrimFloat.compare => "Float64.compare".
Extract Inlined Constant PrimFloat.mul => "Float64.mul".
Extract Inlined Constant PrimFloat.add => "Float64.add".
Extract Inlined Constant PrimFloat.sub => "Float64.sub".
Extract Inlined Constant PrimFloat.div => "Float64.div".
Extract Inlined Constant PrimFloat.next_up => "Float64.next_up".
Extract Inlined Constant PrimFloat.next_down => "Float64.next_down".

(* The functor's formats of numbers name real numbers, which no computation asks for. *)
Extract Constant ClassicalDedekindReals.sig_forall_dec => "(fun _ -> assert false)".

(* Is beta of these waves at most B everywhere?  Only what is said of a wrong file hangs on it. *)
Definition below := patch_below prec.

Set Warnings "-extraction-opaque-accessed".
Extraction "checker.ml" header_ok leaf_ok every_leaf all_parts at_part covers felt odd_about
  alone_ok mirrored all_links linked_ok axes orders_of plain_problem parameters below
  Z.add Z.mul Z.opp Z.div_eucl Z.compare Qplus Qminus Qmult Qcompare Qred.
