(* The iteration (docs/proofs/existence.md, section 6) and its limit.  The radii are 1 + rho h, h = 2^-i.  The
   induction claims only that each step divides the residual by 64, which is simple and enough. *)

From Coq Require Import Reals ZArith List Lra Lia Psatz.
From Coquelicot Require Import Coquelicot.
From Converse Require Import Fourier Taylor Newton.
Open Scope R_scope.

Lemma sine_lipschitz x y : Rabs (sin x - sin y) <= Rabs (x - y).
Proof.
  destruct (MVT_gen sin y x cos) as (z & _ & ->).
  - intros t _. apply is_derive_sin.
  - intros t _. apply continuity_sin.
  - rewrite Rabs_mult. rewrite <- (Rmult_1_l (Rabs (x - y))) at 2.
    apply Rmult_le_compat_r; [apply Rabs_pos | apply Rabs_le, COS_bound].
Qed.

Lemma small_product b c x : Rabs b <= 1 -> Rabs c <= x -> Rabs (b * c) <= x.
Proof.
  intros Hb Hc. rewrite Rabs_mult, <- (Rmult_1_l x). apply Rmult_le_compat; assumption || apply Rabs_pos.
Qed.

Section Iteration.
Variables w eps rho K e : R.
Hypothesis divisor : forall k : Z, k <> 0%Z -> 1 / Rabs (IZR k) <= Rabs (2 * sin (IZR k * w / 2)).
Hypotheses (Heps : Rabs eps <= 1) (Hrho : 0 < rho <= 1) (HK : 6 * (1 + rho) <= K * rho).
Hypotheses (He : 0 < e) (small : 512000000 * (K * K * K * K) * e <= 1).
Variables (u0 u0' : R -> R) (U a : R).
Hypotheses (HU : U + 1 / 500 <= 1 / 2) (Ha : a + 1 / 1000 <= 2 / 3).
Hypotheses (odd0 : odd u0) (D0 : forall t, is_derive u0 t (u0' t)).
Hypotheses (B0 : bounded (1 + rho) U u0) (B0' : bounded (1 + rho) a u0') (S0 : solved w eps (1 + rho) e u0).

Fixpoint half (i : nat) : R := match i with O => 1 | S i => half i / 2 end.

Lemma half_pos i : 0 < half i <= 1.
Proof. induction i as [| i IH]; simpl; lra. Qed.

Lemma half_small x : 0 < x -> exists i, half i <= x.
Proof.
  intros Hx. destruct (small_power x Hx) as (N & H). exists N.
  apply Rle_trans with ((2 / 3) ^ N); [| exact H]. clear. induction N as [| N IH]; simpl; [lra |].
  pose proof (pow_le (2 / 3) N). lra.
Qed.

Lemma K12 : 12 <= K.
Proof. apply Rmult_le_reg_r with rho; nra. Qed.

Lemma e_1 : e <= 1.
Proof.
  pose proof K12 as H. assert (H2 : 1 <= K * K) by nra. assert (H4 : 1 <= K * K * (K * K)) by nra.
  assert (0 <= (K * K * (K * K) - 1) * e) by (apply Rmult_le_pos; lra). lra.
Qed.

(* What is below each h is zero. *)
Lemma below_all x : (forall i, x <= 10 * half i) -> x <= 0.
Proof.
  intros H. apply Rnot_lt_le. intros Hx. destruct (half_small (x / 20)) as (i & Hi); [lra |].
  specialize (H i). lra.
Qed.

(* u after i steps. *)
Definition state (i : nat) : Type := let h := half i in
  {u : R -> R & {u' : R -> R & {_ : odd u /\ (forall t, is_derive u t (u' t)) &
    (bounded (1 + rho * h) (U + (1 - h) / 1000) u * bounded (1 + rho * h) (a + (1 - h) / 1000) u' *
     solved w eps (1 + rho * h) (e * h ^ 6) u)%type}}}.

Lemma next i (s : state i) :
  {s' : state (S i) | forall t, Rabs (projT1 s' t - projT1 s t) <= half i / 2000}.
Proof.
  destruct s as (u & u' & (Hodd & Du) & ((Bu & Bu') & Su)). cbv beta zeta in *.
  pose proof (half_pos i) as Hh. unfold state. cbn [half]. set (h := half i) in *.
  pose proof K12 as K12.
  (* In terms of the first step's numbers. *)
  assert (K2 : 144 <= K * K) by nra. assert (K3 : 1728 <= K * K * K) by nra.
  assert (small2 : 700 * (K * K) * e <= / 2000) by nra.
  assert (small3 : 700 * (K * K * K) * e <= / 2000) by nra.
  assert (h2 : h * h <= 1) by nra.
  assert (e2 : 700 * (K / h * (K / h)) * (e * h ^ 6) <= h / 2000).
  { replace (700 * (K / h * (K / h)) * (e * h ^ 6)) with (700 * (K * K) * e * (h * h * h * h))
      by (field; lra).
    assert (h * h * h * h <= h) by nra.
    assert (0 <= h * h * h * h) by (repeat apply Rmult_le_pos; lra). nra. }
  assert (e3 : 700 * (K / h * (K / h) * (K / h)) * (e * h ^ 6) <= h / 2000).
  { replace (700 * (K / h * (K / h) * (K / h)) * (e * h ^ 6))
      with (700 * (K * K * K) * e * (h * h * h)) by (field; lra).
    assert (h * h * h <= h) by nra. assert (0 <= h * h * h) by (repeat apply Rmult_le_pos; lra). nra. }
  assert (e4 : 8000000 * (K / h * (K / h) * (K / h) * (K / h)) * (e * h ^ 6 * (e * h ^ 6))
               <= e * (h / 2) ^ 6).
  { replace (8000000 * (K / h * (K / h) * (K / h) * (K / h)) * (e * h ^ 6 * (e * h ^ 6)))
      with (512000000 * (K * K * K * K) * e * (h * h) * (e * (h / 2) ^ 6)) by (field; lra).
    assert (0 <= e * (h / 2) ^ 6) by (apply Rmult_le_pos; [lra | apply pow_le; lra]).
    rewrite <- (Rmult_1_l (e * (h / 2) ^ 6)) at 2. apply Rmult_le_compat_r; [exact H |].
    assert (0 <= K * K * K * K * e) by (repeat apply Rmult_le_pos; lra). nra. }
  assert (Hdh : 0 < rho * h) by (apply Rmult_lt_0_compat; lra).
  destruct (step w eps divisor Heps (1 + rho * h) (rho * h / 6) (K / h) (e * h ^ 6))
    with (u := u) (u' := u') (U := U + (1 - h) / 1000)
    as (v & v' & (Hv & Dv) & ((Bv & Bv') & Sv)); try assumption.
  - lra.
  - lra.
  - replace (K / h * (rho * h / 6)) with (K * rho / 6) by (field; lra). nra.
  - nra.
  - apply Rmult_lt_0_compat; [exact He | apply pow_lt; lra].
  - lra.
  - apply (bounded_ext Bu'); [reflexivity | lra].
  - replace (1 + rho * h - 3 * (rho * h / 6)) with (1 + rho * (h / 2)) in * by field.
    assert (Hr1 : 0 <= 1 + rho * (h / 2) <= 1 + rho * h) by lra.
    unshelve eexists; [exists (fun t => u t + v t), (fun t => u' t + v' t);
      unshelve eexists; [| split; [split |]] |].
    + split; [intros t; rewrite Hodd, Hv; ring | intros t].
      exact (is_derive_plus (V := R_NormedModule) u v t _ _ (Du t) (Dv t)).
    + apply (bounded_ext (bounded_plus (bounded_less _ _ Hr1 Bu) Bv)); [reflexivity | lra].
    + apply (bounded_ext (bounded_plus (bounded_less _ _ Hr1 Bu') Bv')); [reflexivity | lra].
    + destruct Sv as (N0 & HN). exists N0. intros N H.
      apply (bounded_ext (HN N H)); [reflexivity | exact e4].
    + intros t. simpl. replace (u t + v t - u t) with (v t) by ring.
      apply Rle_trans with (700 * (K / h * (K / h)) * (e * h ^ 6)); [| exact e2].
      apply (bounded_everywhere (r := 1 + rho * (h / 2))); [lra | exact Bv].
Qed.

Lemma start : state 0.
Proof.
  exists u0, u0'. unshelve eexists; [now split |]. simpl half. rewrite Rmult_1_r. split; [split |].
  - apply (bounded_ext B0); [reflexivity | lra].
  - apply (bounded_ext B0'); [reflexivity | lra].
  - replace (e * 1 ^ 6) with e by ring. exact S0.
Qed.

Fixpoint states (i : nat) : state i :=
  match i with O => start | S i => proj1_sig (next i (states i)) end.

Definition u (i : nat) : R -> R := projT1 (states i).

Lemma u_step i t : Rabs (u (S i) t - u i t) <= half i / 2000.
Proof. unfold u. cbn [states]. destruct (next i (states i)) as [s' H]. apply H. Qed.

Lemma u_far i k t : Rabs (u (k + i) t - u i t) <= half i / 1000 - half (k + i) / 1000.
Proof.
  induction k as [| k IH]; [cbn [Nat.add]; rewrite Rminus_eq_0, Rabs_R0; lra |].
  cbn [Nat.add half]. pose proof (u_step (k + i) t) as H.
  replace (u (S (k + i)) t - u i t) with ((u (S (k + i)) t - u (k + i) t) + (u (k + i) t - u i t)) by ring.
  eapply Rle_trans; [apply Rabs_triang |]. lra.
Qed.

Lemma u_converges t : {l : R | Un_cv (fun i => u i t) l}.
Proof.
  apply Rcomplete.R_complete. intros x Hx. destruct (half_small x Hx) as (N & HN). exists N.
  assert (F : forall n, (n >= N)%nat -> Rabs (u n t - u N t) <= x / 1000).
  { intros n Hn. replace n with ((n - N) + N)%nat by lia. pose proof (u_far N (n - N) t).
    pose proof (half_pos (n - N + N)). lra. }
  intros n m Hn Hm. unfold R_dist. pose proof (F n Hn) as Fn. pose proof (F m Hm) as Fm.
  replace (u n t - u m t) with ((u n t - u N t) - (u m t - u N t)) by ring.
  eapply Rle_lt_trans; [apply Rabs_triang |]. rewrite Rabs_Ropp. lra.
Qed.

Definition limit (t : R) : R := proj1_sig (u_converges t).

Lemma limit_near i t : Rabs (limit t - u i t) <= half i.
Proof.
  unfold limit. destruct (u_converges t) as [l H]. simpl. pose proof (half_pos i) as Hi.
  destruct (H (half i / 2)) as (N & HN); [lra |]. specialize (HN (N + i)%nat ltac:(lia)).
  unfold R_dist in HN.
  pose proof (u_far i N t) as F. pose proof (half_pos (N + i)).
  replace (l - u i t) with ((u (N + i) t - u i t) - (u (N + i) t - l)) by ring.
  eapply Rle_trans; [apply Rabs_triang |]. rewrite Rabs_Ropp. lra.
Qed.

(* What u has of each step's. *)
Lemma u_periodic i t : u i (t + 2 * PI) = u i t.
Proof.
  unfold u. destruct (states i) as (f & f' & D & ((B & B') & S)). exact (bounded_periodic t B).
Qed.

Lemma u_lipschitz i s t : Rabs (u i s - u i t) <= 2 / 3 * Rabs (s - t).
Proof.
  unfold u. destruct (states i) as (f & f' & (O & D) & ((A & B) & S)). cbv beta zeta in *. simpl.
  destruct (MVT_gen f t s f') as (z & _ & ->).
  - intros x _. apply D.
  - intros x _. apply continuity_pt_filterlim, (ex_derive_continuous (V := R_NormedModule)). eexists.
    apply D.
  - rewrite Rabs_mult. apply Rmult_le_compat_r; [apply Rabs_pos |]. pose proof (half_pos i).
    apply Rle_trans with (a + (1 - half i) / 1000); [| lra].
    apply (bounded_everywhere (r := 1 + rho * half i)); [| exact B]. assert (0 <= rho * half i) by nra. lra.
Qed.

Lemma u_solves i t : Rabs (u i (t + w) - 2 * u i t + u i (t - w) - eps * sin (t + u i t)) <= half i.
Proof.
  unfold u. destruct (states i) as (f & f' & D & ((B & B') & (N0 & S))). cbv beta zeta in *. simpl.
  pose proof (half_pos i) as Hh. set (h := half i) in *. clearbody h.
  assert (Hr : 1 <= 1 + rho * h) by nra.
  apply le_epsilon. intros x Hx. destruct (small_power (x / 2)) as (N1 & HN1); [lra |].
  set (N := (N0 + N1)%nat). specialize (S N ltac:(lia)).
  pose proof (bounded_everywhere t Hr S) as R0. pose proof (bounded_everywhere t Hr B) as F0.
  assert (F1 : Rabs (f t) <= 1 / 2) by lra.
  destruct (near N (f t) F1) as [Nc Ns].
  assert (HN : (1 / 2) ^ N <= x / 2).
  { apply Rle_trans with ((2 / 3) ^ N); [apply pow_incr; lra |].
    unfold N. rewrite pow_add. pose proof (pow_le (2 / 3) N1 ltac:(lra)).
    assert ((2 / 3) ^ N0 <= 1) by (rewrite <- (pow1 N0); apply pow_incr; lra).
    pose proof (pow_le (2 / 3) N0 ltac:(lra)). nra. }
  assert (He6 : e * h ^ 6 <= h).
  { pose proof e_1 as E1.
    assert (0 <= h ^ 5 <= 1) by (split; [apply pow_le; lra | rewrite <- (pow1 5); apply pow_incr; lra]).
    assert (e * h ^ 5 <= 1) by nra.
    replace (e * h ^ 6) with (h * (e * h ^ 5)) by ring. nra. }
  replace (f (t + w) - 2 * f t + f (t - w) - eps * sin (t + f t))
    with (residual w eps N f t
          - eps * (sin t * (cos (f t) - Cos N (f t)) + cos t * (sin (f t) - Sin N (f t))))
    by (unfold residual, kick; rewrite sin_plus; ring).
  eapply Rle_trans; [apply Rabs_triang |]. rewrite Rabs_Ropp. apply Rplus_le_compat; [lra |].
  apply small_product; [exact Heps |]. eapply Rle_trans; [apply Rabs_triang |].
  pose proof (small_product (sin t) _ _ (Rabs_le _ _ (SIN_bound t)) (Rle_trans _ _ _ Nc HN)).
  pose proof (small_product (cos t) _ _ (Rabs_le _ _ (COS_bound t)) (Rle_trans _ _ _ Ns HN)). lra.
Qed.

(* ---- the limit's *)

Theorem conjugacy : exists x : R -> R, (forall s t, s < t -> x s < x t) /\
  (forall t, x (t + 2 * PI) = x t + 2 * PI) /\
  (forall t, continuous x t) /\ (forall t, x (t + w) - 2 * x t + x (t - w) - eps * sin (x t) = 0).
Proof.
  assert (L : forall s t, Rabs (limit s - limit t) <= 2 / 3 * Rabs (s - t)).
  { intros s t. apply Rminus_le. apply below_all. intros i. pose proof (u_lipschitz i s t) as H.
    pose proof (limit_near i s) as A1. pose proof (limit_near i t) as A2. pose proof (half_pos i).
    enough (Rabs (limit s - limit t) <= 2 / 3 * Rabs (s - t) + 2 * half i) by lra.
    apply Rabs_le_between in H, A1, A2. apply Rabs_le. lra. }
  assert (zero : forall x, (forall i, Rabs x <= 10 * half i) -> x = 0).
  { intros x H. apply below_all in H. destruct (Req_dec x 0) as [| N]; [assumption |].
    apply Rabs_pos_lt in N. lra. }
  exists (fun t => t + limit t). split; [| split; [| split]].
  - intros s t H. specialize (L s t). rewrite (Rabs_minus_sym s t), (Rabs_right (t - s)) in L by lra.
    apply Rabs_le_between in L. lra.
  - intros t. enough (limit (t + 2 * PI) - limit t = 0) by lra. apply zero. intros i.
    pose proof (limit_near i (t + 2 * PI)) as A. pose proof (limit_near i t) as B. rewrite u_periodic in A.
    replace (limit (t + 2 * PI) - limit t) with ((limit (t + 2 * PI) - u i t) - (limit t - u i t)) by ring.
    eapply Rle_trans; [apply Rabs_triang |]. rewrite Rabs_Ropp. pose proof (half_pos i). lra.
  - intros t. apply (continuous_plus (V := R_NormedModule) (fun t => t) limit); [apply continuous_id |].
    apply continuity_pt_filterlim. intros x Hx. exists x. split; [exact Hx |]. intros s [_ Hs].
    unfold dist in *. simpl in *. unfold R_dist in *. specialize (L s t).
    pose proof (Rabs_pos (s - t)). lra.
  - intros t. apply zero. intros i. pose proof (u_solves i t) as S. pose proof (half_pos i) as Hh.
    pose proof (limit_near i (t + w)) as A1. pose proof (limit_near i t) as A2.
    pose proof (limit_near i (t - w)) as A3.
    pose proof (sine_lipschitz (t + limit t) (t + u i t)) as A4.
    replace (t + limit t - (t + u i t)) with (limit t - u i t) in A4 by ring.
    assert (A5 : Rabs (eps * (sin (t + limit t) - sin (t + u i t))) <= half i).
    { apply small_product; [exact Heps | lra]. }
    replace (t + w + limit (t + w) - 2 * (t + limit t) + (t - w + limit (t - w)) - eps * sin (t + limit t))
      with ((u i (t + w) - 2 * u i t + u i (t - w) - eps * sin (t + u i t))
        + ((limit (t + w) - u i (t + w)) - 2 * (limit t - u i t) + (limit (t - w) - u i (t - w))
        - eps * (sin (t + limit t) - sin (t + u i t)))) by ring.
    apply Rabs_le_between in S, A1, A2, A3, A5. apply Rabs_le. lra.
Qed.
End Iteration.
