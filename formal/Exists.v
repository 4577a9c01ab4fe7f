(* Existence of an invariant graph from a certificate: integers b, and the computation that shows that
   u0(t) = sum of b[k]/D sin(k t), k from 1 on, has a residual that is small enough for the theorem.  The
   potential is V(y) = eps cos(y_0), the rotation that of the golden mean. *)

From Coq Require Import Reals ZArith QArith Qreals List Lra Lia Bool Psatz.
From Coquelicot Require Import Coquelicot.
From Interval.Real Require Import Xreal.
From Converse Require Import Map.
From Converse Require Circle Fourier Newton Kam Residual Divisors Numbers Sine.
Import ListNotations.
Open Scope R_scope.

Module N := Numbers.Numbers Sine.Wide.

Definition omega : R := 2 * PI * Divisors.golden.

(* ---- the numbers 2 cos(k omega) - 2 *)

Section Cosines.
Variables (one : Z) (prec : Sine.Wide.precision).

Definition angle_up : N.I.type :=
  N.mul prec (N.pi prec) (N.sub prec (N.sqrt prec (N.integer prec 5)) (N.integer prec 1)).
Definition multiplier (k : Z) : N.I.type :=
  let two := N.integer prec 2 in
  N.mul prec (N.integer prec one)
    (N.sub prec (N.mul prec two (N.I.cos prec (N.mul prec (N.integer prec k) angle_up))) two).

Lemma cont_multiplier k : N.cont (multiplier k) (IZR one * (2 * cos (IZR k * omega) - 2)).
Proof.
  assert (A : N.cont angle_up omega).
  { replace omega with (PI * (sqrt 5 - 1)) by (unfold omega, Divisors.golden; field).
    apply N.cont_mul; [apply N.cont_pi |]. apply N.cont_sub; [| apply N.cont_integer].
    exact (N.I.sqrt_correct prec _ (Xreal 5) (N.cont_integer prec 5)). }
  apply N.cont_mul; [apply N.cont_integer |]. apply N.cont_sub; [| apply N.cont_integer].
  apply N.cont_mul; [apply N.cont_integer |].
  apply (N.I.cos_correct prec _ (Xreal (IZR k * omega))).
  apply N.cont_mul; [apply N.cont_integer | exact A].
Qed.

(* cs has them, up to 1. *)
Fixpoint closely (k : Z) (cs : list Z) : bool :=
  match cs with
  | [] => true
  | c :: cs => N.non_negative (N.sub prec (N.integer prec 1)
                 (N.I.abs (N.sub prec (multiplier k) (N.integer prec c)))) && closely (k + 1) cs
  end.

Lemma closely_close k b cs : length b = length cs -> closely k cs = true -> Residual.close one omega k b cs.
Proof.
  revert k b. induction cs as [| c cs IH]; intros k [| a b] L H; try discriminate; [exact I |].
  cbn [closely] in H. apply andb_prop in H as [H0 H1]. injection L as L. split; [| now apply IH].
  apply N.non_negative_correct with (x := 1 - Rabs (IZR one * (2 * cos (IZR k * omega) - 2) - IZR c))
    in H0; [lra |].
  apply N.cont_sub; [apply N.cont_integer |]. apply N.cont_abs, N.cont_sub;
    [apply cont_multiplier | apply N.cont_integer].
Qed.
End Cosines.

(* 2 cos(omega) in units of 2^-240, about.  Digits that are wrong where they matter make `closely` false. *)
Definition cos_omega : Z := -2605636075783219719737706859929130536190120032339722978415607386094439475.

(* The numbers cs, by the recurrence of 2 cos(k omega). *)
Fixpoint chebyshev (n : nat) (x y : Z) (one : Z) : list Z :=
  match n with
  | O => []
  | S n => (Z.shiftr (y * one) 240 - 2 * one)%Z :: chebyshev n y (Z.shiftr (cos_omega * y) 240 - x)%Z one
  end.

(* ---- the theorem *)

Record certificate := Certificate {
  rn : Z; rd : Z;              (* r = rn/rd *)
  en : Z; ed : Z;              (* eps = en/ed *)
  b : list Z; D : Z;
  digits : Z;                  (* binary, of the computation *)
  terms : nat }.               (* of the series *)

Definition holds (c : certificate) : bool :=
  let one := Z.shiftl 1 (digits c) in
  let cs := chebyshev (length (b c)) (Z.shiftl 1 241) cos_omega one in
  let e := Residual.residual_up (rn c) (rd c) (b c) (D c) one (en c) (ed c) cs (terms c) in
  (0 <? rd c)%Z && (rd c <? rn c)%Z && (rn c <=? 2 * rd c)%Z && (0 <? D c)%Z && (0 <? one)%Z &&
  (0 <? ed c)%Z && (Z.abs (en c) <=? ed c)%Z &&
  (Nat.eqb (length (b c)) (length cs)) && closely one (Sine.Wide.PtoP (Z.to_pos (digits c + 32))) 1 cs &&
  (500 * Residual.top (rn c) (rd c) (b c) <=? 249 * D c)%Z &&
  (3000 * Residual.slope_top (rn c) (rd c) (b c) <=? 1997 * D c)%Z &&
  (0 <? e)%Z && (512000000 * (6 * rn c) ^ 4 * e <=? one * (rn c - rd c) ^ 4)%Z.

(* The conjugacy to the rotation. *)
Definition conjugacy (eps : R) (x : R -> R) : Prop :=
  (forall s t, s < t -> x s < x t) /\ (forall t, x (t + 2 * PI) = x t + 2 * PI) /\
  (forall t, Continuity.continuous x t) /\
  (forall t, x (t + omega) - 2 * x t + x (t - omega) - eps * sin (x t) = 0).

Theorem conjugacy_exists c : holds c = true -> exists x, conjugacy (IZR (en c) / IZR (ed c)) x.
Proof.
  unfold holds. cbv zeta. set (one := Z.shiftl 1 (digits c)).
  set (cs := chebyshev _ _ _ _). set (e := Residual.residual_up _ _ _ _ _ _ _ _ _).
  rewrite !andb_true_iff, !Z.ltb_lt, !Z.leb_le, Nat.eqb_eq.
  intros ((((((((((((Hrd & Hr) & Hr2) & HD) & Hone) & Hed) & Hen) & Hl) & Hclose) & HU) & Ha) & He)
    & Hsmall).
  clearbody cs. assert (Hr' : (rd c <= rn c)%Z) by lia.
  assert (HU' : (2 * Residual.top (rn c) (rd c) (b c) <= D c)%Z) by lia.
  assert (Hs := Residual.residual_solved (rn c) (rd c) Hrd Hr' (b c) (D c) one HD Hone omega
    (en c) (ed c) cs Hed (terms c) (closely_close one _ 1 (b c) cs Hl Hclose) HU'). fold e in Hs.
  assert (Bu := Residual.u0_bounded (rn c) (rd c) Hrd Hr' (b c) (D c) HD).
  assert (Bu' := Residual.u0'_bounded (rn c) (rd c) Hrd Hr' (b c) (D c) HD).
  apply IZR_lt in Hrd as Hrd1. apply IZR_lt in Hr as Hr1. apply IZR_le in Hr2 as Hr3.
  rewrite mult_IZR in Hr3.
  apply IZR_lt in HD as HD1. apply IZR_lt in Hone as Hone1. apply IZR_lt in Hed as Hed1.
  apply IZR_lt in He as He1.
  set (rho := IZR (rn c) / IZR (rd c) - 1).
  replace (IZR (rn c) / IZR (rd c)) with (1 + rho) in * by (unfold rho; ring).
  assert (Hrho : 0 < rho <= 1).
  { unfold rho.
    split; apply Rmult_lt_reg_r with (IZR (rd c)) || apply Rmult_le_reg_r with (IZR (rd c)); try lra;
      replace ((IZR (rn c) / IZR (rd c) - 1) * IZR (rd c)) with (IZR (rn c) - IZR (rd c))
        by (field; lra); lra. }
  set (K := 6 * IZR (rn c) / (IZR (rn c) - IZR (rd c))).
  apply (Kam.conjugacy omega (IZR (en c) / IZR (ed c)) rho K (IZR e / IZR one) Divisors.golden_divisor) with
    (u0 := Residual.u0 (b c) (D c)) (u0' := Residual.u0' (b c) (D c))
    (U := IZR (Residual.top (rn c) (rd c) (b c)) / IZR (D c))
    (a := IZR (Residual.slope_top (rn c) (rd c) (b c)) / IZR (D c));
    try assumption.
  - unfold Rdiv.
    rewrite Rabs_mult, <- abs_IZR, (Rabs_right (/ _)) by (apply Rle_ge, Rlt_le, Rinv_0_lt_compat; lra).
    apply Rmult_le_reg_r with (IZR (ed c)); [lra |]. rewrite Rmult_assoc, Rinv_l by lra.
    apply IZR_le in Hen. lra.
  - apply Req_le. unfold K, rho. field. lra.
  - apply Rdiv_lt_0_compat; lra.
  - change 4%Z with (Z.of_nat 4) in Hsmall. apply IZR_le in Hsmall.
    rewrite !mult_IZR, <- !pow_IZR, mult_IZR, minus_IZR in Hsmall.
    set (d := IZR (rn c) - IZR (rd c)) in *. assert (Hd : 0 < d) by (unfold d; lra).
    assert (Hd4 : 0 < d ^ 4) by now apply pow_lt.
    replace (512000000 * (K * K * K * K) * (IZR e / IZR one))
      with (512000000 * (6 * IZR (rn c)) ^ 4 * IZR e * / (IZR one * d ^ 4)) by (unfold K; field; lra).
    apply Rmult_le_reg_r with (IZR one * d ^ 4); [now apply Rmult_lt_0_compat |].
    rewrite Rmult_assoc, Rinv_l, Rmult_1_r, Rmult_1_l
      by (apply Rgt_not_eq; now apply Rmult_lt_0_compat). exact Hsmall.
  - apply IZR_le in HU. rewrite !mult_IZR in HU. apply Rmult_le_reg_r with (IZR (D c)); [lra |].
    rewrite Rmult_plus_distr_r. unfold Rdiv at 1. rewrite Rmult_assoc, Rinv_l by lra. lra.
  - apply IZR_le in Ha. rewrite !mult_IZR in Ha. apply Rmult_le_reg_r with (IZR (D c)); [lra |].
    rewrite Rmult_plus_distr_r. unfold Rdiv at 1. rewrite Rmult_assoc, Rinv_l by lra. lra.
  - exact (Residual.odd_u0 (b c) (D c) HD).
  - exact (Residual.derive_u0 (b c) (D c) HD).
Qed.

Theorem graph_exists phi eps x : conjugacy eps x -> has_invariant_graph [Wave 1 0 phi eps].
Proof.
  intros (increasing & turn & cont & solves). set (c := phi + PI / 2).
  apply (Circle.circle_graph (fun t => x t - c) omega).
  - intros s t L. apply increasing in L. lra.
  - intros t. rewrite turn. ring.
  - intros t. apply (continuous_minus (V := R_NormedModule)); [apply cont | apply continuous_const].
  - intros w [<- | []]. reflexivity.
  - intros t. rewrite <- (solves t). unfold Circle.force, V', angle, along, sum; simpl.
    replace (1 * (x t - c) + 0 * 0 + phi) with (- (PI / 2 - x t)) by (unfold c; ring).
    rewrite cos_neg, cos_shift. ring.
Qed.

(* Of a wave with any phase, in units of pi, and the amplitude p. *)
Theorem certified rn rd b D digits terms phase p :
  holds (Certificate rn rd (Qnum p) (Zpos (Qden p)) b D digits terms) = true ->
  has_invariant_graph (waves [Term 1 0 phase p []] []).
Proof.
  intros H. destruct (conjugacy_exists _ H) as [x Hx]. cbn [en ed] in Hx.
  apply (graph_exists _ _ x). unfold combined, sum, Q2R. cbn. now rewrite Rplus_0_r.
Qed.

(* The same on the circle alone, for maps of one angle: the curve p = psi(y), and x onto it. *)
Theorem curve_exists eps x : conjugacy eps x -> exists psi : R -> R,
  continuity x /\ continuity psi /\ (forall y, psi (y + 2 * PI) = psi y) /\
  (forall y, exists t, y = x t) /\
  (forall t y p y' p', y = x t -> p = psi y -> p' = p + eps * sin y -> y' = y + p' ->
    y' = x (t + omega) /\ p' = psi y').
Proof.
  intros (increasing & turn & cont & solves). exists (Circle.psi x omega turn cont).
  split; [intros t; apply continuity_pt_filterlim, cont |].
  split; [intros y; apply continuity_pt_filterlim, Circle.psi_continuous, increasing |].
  split; [now apply Circle.psi_turn |]. split.
  - intros y. destruct (Circle.onto x turn cont y) as [t E]. now exists t.
  - intros t y p y' p' -> -> -> ->. specialize (solves t).
    assert (at_x : forall s, Circle.psi x omega turn cont (x s) = x s - x (s - omega)).
    { intros s. unfold Circle.psi. now rewrite Circle.phase_x. }
    rewrite at_x. replace (x t + (x t - x (t - omega) + eps * sin (x t))) with (x (t + omega)) by lra.
    split; [reflexivity |]. rewrite at_x. replace (t + omega - omega) with t by ring. lra.
Qed.
