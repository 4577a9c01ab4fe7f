(* What the theorem of golden.v says.  It is enough to read this and Map.v. *)

From Coq Require Import Reals List.
From Converse Require Import Map.
Import ListNotations.
Open Scope R_scope.

(* V(y) = 0.8 cos(y_0): the standard map with the parameter 0.8, times the rotations of the second angle. *)
Definition golden_says : Prop := has_invariant_graph [Wave 1 0 (- (PI / 2)) 0.8].
