(* The checker with floating-point numbers that are made of Coq's own integers: slow, but nothing is
   assumed but the axioms of the real numbers. *)

From Interval.Float Require Import Specific_stdz Specific_ops.
From Converse Require Import Check.

Module IntegerFloats := SpecificFloat StdZRadix2.
Include Check IntegerFloats.
