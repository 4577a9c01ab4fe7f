(* From Map.v's words to those of the real numbers alone: what NoTorus.v needs for a theorem in which no
   definition of this folder appears.  The thesis's potential, and graphs by two functions of two
   numbers each. *)

From Coq Require Import Reals ZArith QArith Qreals List Lra Lia.
From Converse Require Import Map.
From Converse Require Graph.
Import ListNotations.
Open Scope R_scope.

Definition thesis (a b c : R) : list wave := [Wave 1 0 0 a; Wave 0 1 0 b; Wave 1 1 0 c].

(* A function with the period T has the periods m T, m any integer. *)
Lemma periods (f : R -> R) T : (forall x, f (x + T) = f x) ->
  forall (m : Z) x, f (x + T * IZR m) = f x.
Proof.
  intros H. assert (up : forall (n : nat) x, f (x + T * INR n) = f x).
  { induction n as [| n IH]; intros x; [f_equal; simpl; ring |].
    rewrite <- (IH x), <- (H (x + T * INR n)), S_INR. f_equal; ring. }
  intros m x. destruct (Z_le_gt_dec 0 m) as [Hm | Hm].
  - rewrite <- (up (Z.to_nat m) x), INR_IZR_INZ, Z2Nat.id by lia. reflexivity.
  - rewrite <- (up (Z.to_nat (- m)) (x + _)), INR_IZR_INZ, Z2Nat.id, opp_IZR by lia. f_equal; ring.
Qed.

Lemma continuous_box (f : R -> R -> R) :
  (forall x y eps, 0 < eps -> exists delta, 0 < delta /\ forall u v,
     Rabs (u - x) < delta -> Rabs (v - y) < delta -> Rabs (f u v - f x y) < eps) ->
  continuous (fun y => f (fst y) (snd y)).
Proof.
  intros C y eps Heps. destruct (C (fst y) (snd y) eps Heps) as (d & Hd & near).
  exists (d * d); split; [now apply Rmult_lt_0_compat |].
  intros z Hz. now apply near; apply (Graph.legs_below _ _ _ Hd Hz).
Qed.

Theorem no_graph (a b c : R) : no_invariant_graph (thesis a b c) ->
  forall V Vx Vy : R -> R -> R,
  (forall x y, V x y = - a * sin x - b * sin y - c * sin (x + y)) ->
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
  intros none V Vx Vy HV DVx DVy P Q S Sx Sy period0 period1 DSx DSy Cx Cy invariant.
  assert (same : forall y, Map.V (thesis a b c) y = V (fst y) (snd y)).
  { intros y. rewrite HV. unfold thesis, Map.V, angle, along, sum; simpl.
    rewrite !Rmult_1_l, !Rmult_0_l, !Rplus_0_r, Rplus_0_l. ring. }
  assert (gradient : forall x y, Vx x y = fst (V' (thesis a b c) (x, y))
                              /\ Vy x y = snd (V' (thesis a b c) (x, y))).
  { intros x y. destruct (Graph.V_gradient (thesis a b c)) as (D0 & D1 & _). split.
    - apply (uniqueness_limite (fun u => V u y) x); [apply DVx |]. specialize (D0 (x, y)).
      intros eps Heps. destruct (D0 eps Heps) as (d & H). exists d. intros h Hh Hd.
      specialize (H h Hh Hd). now rewrite !same in H.
    - apply (uniqueness_limite (fun v => V x v) y); [apply DVy |]. specialize (D1 (x, y)).
      intros eps Heps. destruct (D1 eps Heps) as (d & H). exists d. intros h Hh Hd.
      specialize (H h Hh Hd). now rewrite !same in H. }
  apply (none (P, Q) (fun y => S (fst y) (snd y)) (fun y => (Sx (fst y) (snd y), Sy (fst y) (snd y)))).
  - intros [x y] m0 m1. unfold plus, scale; cbn [fst snd].
    rewrite (periods (fun u => S u (y + 2 * PI * IZR m1)) (2 * PI)) by (intros u; apply period0).
    apply (periods (fun v => S x v) (2 * PI)). intros v. apply period1.
  - repeat split; try (intros y; cbn [fst snd]; auto).
    + now apply continuous_box.
    + now apply continuous_box.
  - intros [x y]. destruct (gradient x y) as [Gx Gy]. unfold F, plus, minus.
    cbn [fst snd] in *. rewrite <- Gx, <- Gy.
    destruct (invariant x y _ _ _ _ _ _ eq_refl eq_refl eq_refl eq_refl eq_refl eq_refl) as [Hp Hq].
    now rewrite <- Hp, <- Hq.
Qed.

(* On the thesis's line a = b = c/2: none from middle - part on, if there is none between that and
   middle + part, nor at a multiple, not below 1, of this upper end. *)
Theorem line_from (m p m2 p2 : Q) :
  let patch := [Term 1 0 0 m [p]; Term 0 1 0 m [p]; Term 1 1 0 m2 [p2]] in
  (forall t, in_cube t -> no_invariant_graph (waves patch t)) /\
  (forall s, 1 <= s -> no_invariant_graph (scaled s (waves patch [1]))) ->
  Q2R m2 = 2 * Q2R m -> Q2R p2 = 2 * Q2R p -> 0 < Q2R p < Q2R m ->
  forall a, Q2R m - Q2R p <= a -> no_invariant_graph (thesis a a (2 * a)).
Proof.
  intros patch [inside beyond] Hm Hp H a Ha.
  assert (at_ : forall t, waves patch [t] = thesis (Q2R m + Q2R p * t) (Q2R m + Q2R p * t)
                                                   (2 * (Q2R m + Q2R p * t))).
  { intros t. unfold patch, waves, thesis, combined, sum; cbn -[Q2R]. rewrite Hm, Hp.
    assert (zero : Q2R 0 = 0) by (unfold Q2R; cbn; ring). rewrite zero, Rmult_0_l, !Rplus_0_r.
    now rewrite Rmult_plus_distr_l, Rmult_assoc. }
  destruct (Rle_dec a (Q2R m + Q2R p)) as [Hle | Hgt].
  - replace a with (Q2R m + Q2R p * ((a - Q2R m) / Q2R p)) by (field; lra).
    rewrite <- at_. apply inside. constructor; [| constructor].
    split; apply (Rmult_le_reg_r (Q2R p)); try lra; unfold Rdiv; rewrite Rmult_assoc, Rinv_l; lra.
  - replace (thesis a a (2 * a)) with (scaled (a / (Q2R m + Q2R p)) (waves patch [1])).
    + apply beyond. apply (Rmult_le_reg_r (Q2R m + Q2R p)); [lra |].
      unfold Rdiv. rewrite Rmult_assoc, Rinv_l; lra.
    + rewrite at_. unfold thesis, scaled; cbn [map k0 k1 phase amplitude].
      replace (a / _ * (Q2R m + _)) with a by (field; lra).
      now replace (a / _ * (2 * _)) with (2 * a) by (field; lra).
Qed.
