(* The small divisors of the golden mean: |2 sin(pi k golden)| is at least 1/|k|.

   The norm (k golden - p) (k golden' - p) of Q(sqrt 5) is an integer, golden' the conjugate of golden, and
   not zero if k is not: so k golden is not near an integer p, and the sine is not small. *)

From Coq Require Import Reals ZArith Lra Lia Psatz.
From Converse Require Trig Sine.
Open Scope R_scope.

Definition golden : R := (sqrt 5 - 1) / 2.

Lemma sqrt5 : sqrt 5 * sqrt 5 = 5 /\ 2 < sqrt 5 < 9 / 4.
Proof.
  assert (E : sqrt 5 * sqrt 5 = 5) by (apply sqrt_sqrt; lra). split; [exact E |].
  pose proof (sqrt_pos 5). split; nra.
Qed.

(* If the norm is zero, k and p are even, and so are their halves, and so on. *)
Lemma no_zero n k p : (0 <= n)%Z -> (Z.abs k <= n)%Z -> (p * p + p * k - k * k = 0)%Z -> k = 0%Z.
Proof.
  intros Hn. revert k p. pattern n. apply Z_lt_induction; [| exact Hn]. clear n Hn.
  intros n IH k p Hk E. destruct (Z.eq_dec k 0) as [-> | Hk0]; [reflexivity | exfalso].
  destruct (Z.Even_or_Odd k) as [[i ->] | [i ->]]; destruct (Z.Even_or_Odd p) as [[j ->] | [j ->]];
    try nia.
  assert (i = 0%Z); [| lia]. apply (IH (Z.abs i) ltac:(lia) i j); [lia | nia].
Qed.

Lemma golden_norm k p : k <> 0%Z ->
  1 <= Rabs (IZR k * golden - IZR p) * Rabs (IZR k * ((- sqrt 5 - 1) / 2) - IZR p).
Proof.
  intros Hk. rewrite <- Rabs_mult. destruct sqrt5 as [E _].
  replace ((IZR k * golden - IZR p) * (IZR k * ((- sqrt 5 - 1) / 2) - IZR p))
    with (IZR (p * p + p * k - k * k)).
  - rewrite <- abs_IZR. apply IZR_le. enough (p * p + p * k - k * k <> 0)%Z by lia.
    intros Z0. apply Hk. now apply (no_zero (Z.abs k) k p); [lia | lia |].
  - rewrite minus_IZR, plus_IZR, !mult_IZR. unfold golden.
    replace ((IZR k * ((sqrt 5 - 1) / 2) - IZR p) * (IZR k * ((- sqrt 5 - 1) / 2) - IZR p))
      with (IZR k * IZR k * (1 - sqrt 5 * sqrt 5) / 4 + IZR p * IZR k + IZR p * IZR p) by field.
    rewrite E. field.
Qed.

(* How far k golden is from all integers. *)
Lemma golden_far k p : k <> 0%Z -> 1 / 3 <= Rabs (IZR k * golden - IZR p) * Rabs (IZR k).
Proof.
  intros Hk. assert (H1 : 1 <= Rabs (IZR k)) by (rewrite <- abs_IZR; apply IZR_le; lia).
  set (d := Rabs (IZR k * golden - IZR p)).
  pose proof (Rabs_pos (IZR k * golden - IZR p) : 0 <= d).
  destruct (Rle_lt_dec (1 / 2) d) as [L | L]; [nra |].
  pose proof (golden_norm k p Hk) as N. fold d in N. destruct sqrt5 as [_ [_ S]].
  assert (Rabs (IZR k * ((- sqrt 5 - 1) / 2) - IZR p) <= 11 / 4 * Rabs (IZR k)); [| nra].
  replace (IZR k * ((- sqrt 5 - 1) / 2) - IZR p) with ((IZR k * golden - IZR p) - IZR k * sqrt 5)
    by (unfold golden; field).
  eapply Rle_trans; [apply Rabs_triang |].
  rewrite Rabs_Ropp, Rabs_mult, (Rabs_right (sqrt 5)) by (apply Rle_ge, sqrt_pos). fold d. nra.
Qed.

(* On [0, pi/2] the sine is above half of its argument. *)
Lemma sine_half y : 0 <= y <= PI / 2 -> y / 2 <= sin y.
Proof. intros H. pose proof Sine.pi_bounds. pose proof (Trig.down3 y ltac:(lra)). nra. Qed.

Theorem golden_divisor k : k <> 0%Z -> 1 / Rabs (IZR k) <= Rabs (2 * sin (IZR k * (2 * PI * golden) / 2)).
Proof.
  intros Hk. assert (H1 : 1 <= Rabs (IZR k)) by (rewrite <- abs_IZR; apply IZR_le; lia).
  set (p := up (IZR k * golden - / 2)).
  destruct (archimed (IZR k * golden - / 2)) as [A B]. fold p in A, B.
  set (d := IZR k * golden - IZR p). assert (Hd : - / 2 <= d <= / 2) by (unfold d; lra).
  assert (far := golden_far k p Hk). fold d in far. pose proof Sine.pi_bounds as HPI.
  assert (Es : Rabs (sin (IZR k * (2 * PI * golden) / 2)) = Rabs (sin (PI * d))).
  { replace (IZR k * (2 * PI * golden) / 2) with (PI * d + IZR p * PI) by (unfold d; field).
    rewrite sin_plus. assert (Sp : sin (IZR p * PI) = 0) by (apply sin_eq_0_1; now exists p).
    rewrite Sp, Rmult_0_r, Rplus_0_r, Rabs_mult.
    assert (C1 : Rabs (cos (IZR p * PI)) = 1); [| rewrite C1; ring].
    pose proof (sin2_cos2 (IZR p * PI)) as T. rewrite Sp in T. unfold Rsqr in T.
    rewrite <- (Rabs_pos_eq 1) by lra. apply Rsqr_eq_abs_0. unfold Rsqr. lra. }
  assert (Hs : Rabs d * 3 / 2 <= Rabs (sin (PI * d))).
  { destruct (Rle_lt_dec 0 d) as [L | L].
    - rewrite (Rabs_right d) by lra. pose proof (sine_half (PI * d) ltac:(split; nra)).
      pose proof (Rle_abs (sin (PI * d))). nra.
    - rewrite (Rabs_left d) by lra. pose proof (sine_half (PI * - d) ltac:(split; nra)) as S.
      replace (PI * - d) with (- (PI * d)) in S by ring. rewrite sin_neg in S.
      pose proof (Rle_abs (- sin (PI * d))) as T. rewrite Rabs_Ropp in T. nra. }
  rewrite Rabs_mult, Es, (Rabs_right 2) by lra. apply Rmult_le_reg_r with (Rabs (IZR k)); [lra |].
  replace (1 / Rabs (IZR k) * Rabs (IZR k)) with 1 by (field; lra). pose proof (Rabs_pos d). nra.
Qed.
