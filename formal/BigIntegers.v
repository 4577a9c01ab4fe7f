(* The checker with floating-point numbers that are made of the library Bignums' integers, of
   63-bit words: several times as fast as with Coq's own integers.  Assumed beside the axioms of the
   real numbers is what the processor's operations on such words compute, and nothing of its
   floating-point numbers. *)

From Interval.Float Require Import Specific_bigint Specific_ops.
From Converse Require Import Check.

Module BigIntegerFloats := SpecificFloat BigIntRadix2.
Include Check BigIntegerFloats.
