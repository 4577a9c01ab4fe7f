(* The theorem trig180 in words that need no definition of this folder: sin, PI, the derivative
   (derivable_pt_lim f x l: f has the derivative l at x) and the rest are of Coq's library of the real
   numbers.

   V is the potential on the line a = b = c/2 of its amplitudes; the map takes (x, y, p, q) to
   (x', y', p', q'), and a torus is p = P + S_x(x, y), q = Q + S_y(x, y), S periodic, S_x and S_y its
   partial derivatives, continuous.  For no a from 0.20185848 = 11.21436 x 0.0180 on is one mapped
   into itself. *)

From Coq Require Import Reals Qreals Lra.
Open Scope R_scope.
(* Not imported: no name of theirs hides one of the library. *)
From Converse Require Plain.
From Converse.build Require trig180.

Theorem no_torus : forall a : R, 0.20185848 <= a ->
  forall V Vx Vy : R -> R -> R,
  (forall x y, V x y = - a * sin x - a * sin y - 2 * a * sin (x + y)) ->
  (forall x y, derivable_pt_lim (fun u => V u y) x (Vx x y)) ->
  (forall x y, derivable_pt_lim (fun v => V x v) y (Vy x y)) ->
  forall (P Q : R) (S Sx Sy : R -> R -> R),
  (forall x y, S (x + 2 * PI) y = S x y) ->
  (forall x y, S x (y + 2 * PI) = S x y) ->
  (forall x y, derivable_pt_lim (fun u => S u y) x (Sx x y)) ->
  (forall x y, derivable_pt_lim (fun v => S x v) y (Sy x y)) ->
  (forall x y eps, 0 < eps -> exists delta, 0 < delta /\ forall u v,
     Rabs (u - x) < delta -> Rabs (v - y) < delta -> Rabs (Sx u v - Sx x y) < eps) ->
  (forall x y eps, 0 < eps -> exists delta, 0 < delta /\ forall u v,
     Rabs (u - x) < delta -> Rabs (v - y) < delta -> Rabs (Sy u v - Sy x y) < eps) ->
  ~ (forall x y p q x' y' p' q', p = P + Sx x y -> q = Q + Sy x y ->
     p' = p - Vx x y -> q' = q - Vy x y -> x' = x + p' -> y' = y + q' ->
     p' = P + Sx x' y' /\ q' = Q + Sy x' y').
Proof.
  intros a Ha. apply Plain.no_graph. refine (Plain.line_from _ _ _ _ trig180.trig180 _ _ _ a _);
    unfold Q2R; cbn; lra.
Qed.

Set Printing Width 100.
Check no_torus.
