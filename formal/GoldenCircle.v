(* The theorem golden in words that need no definition of this folder: sin, PI, continuity and the rest are of
   Coq's library of the real numbers.

   The standard map with the parameter 0.8 takes (y, p) to (y', p').  The curve p = psi(y) goes round the
   cylinder and is mapped into itself; x is an order-preserving, continuous parametrization of it, in which
   the map is the rotation by 2 pi (sqrt 5 - 1)/2. *)

From Coq Require Import Reals Lra.
Open Scope R_scope.
(* Not imported: no name of theirs hides one of the library. *)
From Converse Require Exists golden.

Theorem golden_circle : exists x psi : R -> R,
  (forall s t, s < t -> x s < x t) /\ continuity x /\ (forall t, x (t + 2 * PI) = x t + 2 * PI) /\
  (forall y, exists t, y = x t) /\ continuity psi /\ (forall y, psi (y + 2 * PI) = psi y) /\
  (forall t y p y' p', y = x t -> p = psi y -> p' = p + 0.8 * sin y -> y' = y + p' ->
     y' = x (t + 2 * PI * ((sqrt 5 - 1) / 2)) /\ p' = psi y').
Proof.
  destruct golden.conjugated as [x H].
  destruct (Exists.curve_exists _ x H) as (psi & cont_x & cont_psi & period & onto & maps).
  destruct H as (increasing & turn & _). exists x, psi. exact (conj increasing (conj cont_x (conj turn
    (conj onto (conj cont_psi (conj period maps)))))).
Qed.

Set Printing Width 100.
Check golden_circle.
