(* The checker with the processor's floating-point numbers: fast, and Coq's axioms that describe them
   are among what is assumed. *)

From Interval.Float Require Import Primitive_ops.
From Converse Require Import Check.

Include Check PrimitiveFloat.
