(* The checker with floating-point numbers that are made of integers: slow, but nothing is assumed but
   the axioms of the real numbers. *)

From Bignums Require Import BigZ.
From Interval.Float Require Import Specific_bigint Specific_ops.
From Converse Require Import Check.

Module BigIntegers := SpecificFloat BigIntRadix2.
Include Check BigIntegers.
