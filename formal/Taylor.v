(* The Taylor polynomials of cosine and sine: their derivatives, how far they are from cosine and sine,
   and their second order remainder, as functions of trigonometric polynomials. *)

From Coq Require Import Reals ZArith List Lra Lia Psatz.
From Coquelicot Require Import Coquelicot.
From Converse Require Import Fourier.
Open Scope R_scope.

Fixpoint sum_below (a : nat -> R) (N : nat) (x : R) : R :=
  match N with O => 0 | S n => sum_below a n x + a n * x ^ n end.

(* Of x^n in the series of cosine and of sine. *)
Fixpoint cos_sin (n : nat) : R * R :=
  match n with
  | O => (1, 0)
  | S n => (- snd (cos_sin n) / (INR n + 1), fst (cos_sin n) / (INR n + 1))
  end.

Definition Cos (N : nat) (x : R) : R := sum_below (fun n => fst (cos_sin n)) N x.
Definition Sin (N : nat) (x : R) : R := sum_below (fun n => snd (cos_sin n)) N x.

Lemma coefficients n : Rabs (fst (cos_sin n)) <= / INR (fact n) /\ Rabs (snd (cos_sin n)) <= / INR (fact n).
Proof.
  induction n as [| n [IHc IHs]]; [simpl; rewrite Rabs_R1, Rabs_R0; lra |].
  assert (F : 0 < INR (fact n)) by apply INR_fact_lt_0. pose proof (pos_INR n).
  assert (D : forall a, Rabs a <= / INR (fact n) -> Rabs (a / (INR n + 1)) <= / INR (fact (S n))).
  { intros a Ha. rewrite fact_simpl, mult_INR, S_INR, Rinv_mult.
    unfold Rdiv. rewrite Rabs_mult, (Rabs_right (/ (INR n + 1))), Rmult_comm
      by (apply Rle_ge, Rlt_le, Rinv_0_lt_compat; lra).
    apply Rmult_le_compat_l; [apply Rlt_le, Rinv_0_lt_compat; lra | exact Ha]. }
  split; simpl; apply D; [rewrite Rabs_Ropp; exact IHs | exact IHc].
Qed.

Lemma factorials n m : (n <= m)%nat -> / INR (fact m) <= / INR (fact n).
Proof.
  intros H. apply Rinv_le_contravar; [apply INR_fact_lt_0 |]. now apply le_INR, fact_le.
Qed.

Lemma sum_below_S a N x : sum_below a (S N) x = sum_below a N x + a N * x ^ N.
Proof. reflexivity. Qed.

Lemma derive_below a b N x : (forall n, (INR n + 1) * a (S n) = b n) ->
  is_derive (sum_below a (S N)) x (sum_below b N x).
Proof.
  intros H. induction N as [| N IH].
  - apply (is_derive_ext (fun _ => a O)); [intros t; simpl; ring |].
    exact (is_derive_const (V := R_NormedModule) _ x).
  - apply (is_derive_plus (V := R_NormedModule) (sum_below a (S N)) (fun x => _ * x ^ _)); [exact IH |].
    rewrite <- H. auto_derive; [exact I |]. destruct N; simpl; ring.
Qed.

Lemma Cos_slope n : (INR n + 1) * fst (cos_sin (S n)) = - snd (cos_sin n).
Proof. simpl. field. pose proof (pos_INR n). lra. Qed.

Lemma Sin_slope n : (INR n + 1) * snd (cos_sin (S n)) = fst (cos_sin n).
Proof. simpl. field. pose proof (pos_INR n). lra. Qed.

Lemma minus_Sin N x : sum_below (fun n => - snd (cos_sin n)) N x = - Sin N x.
Proof. unfold Sin. induction N as [| N IH]; simpl; [ring |]. rewrite IH. ring. Qed.

Lemma derive_Cos N x : is_derive (Cos (S N)) x (- Sin N x).
Proof. rewrite <- minus_Sin. apply derive_below, Cos_slope. Qed.

Lemma derive_Sin N x : is_derive (Sin (S N)) x (Cos N x).
Proof. apply derive_below, Sin_slope. Qed.

Lemma parity N x : Cos N (- x) = Cos N x /\ Sin N (- x) = - Sin N x.
Proof.
  assert (H : forall n, fst (cos_sin n) * (- x) ^ n = fst (cos_sin n) * x ^ n
                     /\ snd (cos_sin n) * (- x) ^ n = - (snd (cos_sin n) * x ^ n)).
  { intros n. induction n as [| n [IHc IHs]]; [simpl; lra |]. pose proof (pos_INR n). simpl. split.
    - replace (- snd (cos_sin n) / (INR n + 1) * (- x * (- x) ^ n))
        with (x / (INR n + 1) * (snd (cos_sin n) * (- x) ^ n)) by (field; lra).
      rewrite IHs. field. lra.
    - replace (fst (cos_sin n) / (INR n + 1) * (- x * (- x) ^ n))
        with (- x / (INR n + 1) * (fst (cos_sin n) * (- x) ^ n)) by (field; lra).
      rewrite IHc. field. lra. }
  unfold Cos, Sin. induction N as [| N [IHc IHs]]; simpl; [lra |]. destruct (H N) as [-> ->].
  rewrite IHc, IHs. split; ring.
Qed.

(* Both are near. *)
Lemma near N x : Rabs x <= 1 / 2 -> Rabs (cos x - Cos N x) <= (1 / 2) ^ N /\
  Rabs (sin x - Sin N x) <= (1 / 2) ^ N.
Proof.
  revert x. induction N as [| N IH]; intros x Hx.
  - simpl. unfold Cos, Sin. simpl. rewrite !Rminus_0_r. split; apply Rabs_le;
      [apply COS_bound | apply SIN_bound].
  - assert (M : forall f f', f 0 = 0 -> (forall y, is_derive f y (f' y)) ->
      (forall y, Rabs y <= 1 / 2 -> Rabs (f' y) <= (1 / 2) ^ N) -> Rabs (f x) <= (1 / 2) ^ S N).
    { intros f f' H0 D B. destruct (MVT_gen f 0 x f') as (y & Hy & E).
      - intros y _. apply D.
      - intros y _. apply continuity_pt_filterlim, (ex_derive_continuous (V := R_NormedModule)).
        eexists. apply D.
      - assert (Y : Rabs y <= 1 / 2).
        { apply Rabs_le. apply Rabs_le_between in Hx. unfold Rmin, Rmax in Hy.
          destruct (Rle_dec 0 x); lra. }
        rewrite H0, Rminus_0_r in E. rewrite E, Rminus_0_r, Rabs_mult. simpl.
        specialize (B y Y). pose proof (Rabs_pos (f' y)). pose proof (Rabs_pos x).
        pose proof (pow_le (1 / 2) N ltac:(lra)). nra. }
    assert (Z : Cos (S N) 0 = 1 /\ Sin (S N) 0 = 0).
    { clear. unfold Cos, Sin. induction N as [| N [IHc IHs]]; [simpl; lra |].
      rewrite !(sum_below_S _ (S N)), IHc, IHs. simpl. lra. }
    split.
    + apply (M (fun x => cos x - Cos (S N) x) (fun x => - sin x - - Sin N x)).
      * rewrite cos_0. lra.
      * intros y. apply (is_derive_minus (V := R_NormedModule)); [apply is_derive_cos | apply derive_Cos].
      * intros y Hy. replace (- sin y - - Sin N y) with (- (sin y - Sin N y)) by ring.
        rewrite Rabs_Ropp. now apply IH.
    + apply (M (fun x => sin x - Sin (S N) x) (fun x => cos x - Cos N x)).
      * rewrite sin_0. lra.
      * intros y. apply (is_derive_minus (V := R_NormedModule)); [apply is_derive_sin | apply derive_Sin].
      * intros y Hy. now apply IH.
Qed.

(* ---- functions of trigonometric polynomials *)

Lemma bounded_power {r M u} n : 1 <= r -> bounded r M u -> bounded r (M ^ n) (fun t => u t ^ n).
Proof.
  intros Hr H. induction n as [| n IH]; [| now apply bounded_mult].
  apply (bounded_ext (bounded_const r 1)); [reflexivity | rewrite Rabs_R1; simpl; lra].
Qed.

(* The terms from N to N + k. *)
Lemma bounded_tail r M u a alpha N k : 1 <= r -> M <= 1 / 2 -> bounded r M u ->
  (forall n, (N <= n)%nat -> Rabs (a n) <= alpha) ->
  bounded r (2 * alpha * (M ^ N - M ^ (k + N))) (fun t => sum_below a (k + N) (u t) - sum_below a N (u t)).
Proof.
  intros Hr HM Hu Ha. pose proof (bounded_0 Hr Hu) as M0. induction k as [| k IH].
  - apply (bounded_ext (bounded_const r 0)); [intros t; simpl; ring | rewrite Rabs_R0; simpl;
      lra].
  - refine (bounded_ext (bounded_plus IH
      (bounded_scal (a (k + N)%nat) (bounded_power (k + N) Hr Hu))) _ _).
    + intros t. cbn [Nat.add sum_below]. ring.
    + cbn [Nat.add pow]. specialize (Ha (k + N)%nat ltac:(lia)). pose proof (pow_le M (k + N) M0).
      pose proof (Rabs_pos (a (k + N)%nat)).
      assert (0 <= alpha * (M ^ (k + N) * (1 / 2 - M))) by (repeat apply Rmult_le_pos; lra). nra.
Qed.

Lemma bounded_below r M u a alpha N : 1 <= r -> M <= 1 / 2 -> bounded r M u ->
  (forall n, Rabs (a n) <= alpha) -> bounded r (2 * alpha) (fun t => sum_below a N (u t)).
Proof.
  intros Hr HM Hu Ha. apply (bounded_ext (bounded_tail r M u a alpha 0 N Hr HM Hu (fun n _ =>
    Ha n))).
  - intros t. rewrite Nat.add_0_r. simpl. ring.
  - pose proof (pow_le M (N + 0) (bounded_0 Hr Hu)). specialize (Ha O). pose proof (Rabs_pos (a O)).
    simpl (M ^ 0). nra.
Qed.

(* (x + y)^n = x^n + n x^(n-1) y + (rest n x y) y^2. *)
Fixpoint rest (n : nat) (x y : R) : R :=
  match n with O => 0 | S n => (x + y) * rest n x y + INR n * x ^ pred n end.

Lemma rest_power n x y : (x + y) ^ n = x ^ n + INR n * x ^ pred n * y + rest n x y * y ^ 2.
Proof.
  induction n as [| n IH]; [simpl; ring |]. cbn [rest pow]. rewrite IH, S_INR.
  destruct n as [| n]; [simpl; ring |]. cbn [pred pow]. ring.
Qed.

Fixpoint rest_below (a : nat -> R) (N : nat) (x y : R) : R :=
  match N with O => 0 | S n => rest_below a n x y + a n * rest n x y end.

Lemma second_order a b N x y : (forall n, (INR n + 1) * a (S n) = b n) ->
  sum_below a (S N) (x + y)
  = sum_below a (S N) x + sum_below b N x * y + rest_below a (S N) x y * y ^ 2.
Proof.
  intros H. induction N as [| N IH]; [simpl; ring |].
  rewrite !(sum_below_S a (S N)), IH, rest_power. cbn [sum_below rest_below pred].
  rewrite <- H, S_INR. ring.
Qed.

Definition rest_Cos := rest_below (fun n => fst (cos_sin n)).
Definition rest_Sin := rest_below (fun n => snd (cos_sin n)).

Lemma second_Cos N x y : Cos (S N) (x + y) = Cos (S N) x - Sin N x * y + rest_Cos (S N) x y * y ^ 2.
Proof. unfold Cos. rewrite (second_order _ _ N x y Cos_slope), minus_Sin. unfold rest_Cos. ring. Qed.

Lemma second_Sin N x y : Sin (S N) (x + y) = Sin (S N) x + Cos N x * y + rest_Sin (S N) x y * y ^ 2.
Proof. exact (second_order _ _ N x y Sin_slope). Qed.

Lemma bounded_rest r u v n : 1 <= r -> bounded r (1 / 2) u -> bounded r (1 / 2) (fun t => u t + v t) ->
  bounded r (2 * (INR n * (INR n - 1)) * (1 / 2) ^ n) (fun t => rest n (u t) (v t)).
Proof.
  intros Hr Hu Huv. induction n as [| n IH].
  - apply (bounded_ext (bounded_const r 0)); [reflexivity | rewrite Rabs_R0; simpl; lra].
  - refine (bounded_ext (bounded_plus (bounded_mult Hr Huv IH)
      (bounded_scal (INR n) (bounded_power (pred n) Hr Hu))) _ _); [reflexivity |].
    rewrite Rabs_right by (apply Rle_ge, pos_INR). rewrite S_INR.
    destruct n as [| n]; [simpl; lra |]. cbn [pred pow]. rewrite S_INR. apply Req_le. field.
Qed.

Lemma bounded_rest_below {r u v a} N : 1 <= r -> bounded r (1 / 2) u ->
  bounded r (1 / 2) (fun t => u t + v t) ->
  (forall n, Rabs (a n) <= / INR (fact n)) -> bounded r 4 (fun t => rest_below a N (u t) (v t)).
Proof.
  intros Hr Hu Huv Ha.
  assert (F : forall n, 0 <= INR n * (INR n - 1) <= INR (fact n)).
  { intros [| [| n]]; [simpl; lra | simpl; lra |]. rewrite !fact_simpl, !mult_INR, !S_INR.
    pose proof (pos_INR n). assert (1 <= INR (fact n)) by (apply (le_INR 1); exact (lt_O_fact n)).
    split; [apply Rmult_le_pos; lra |].
    replace (INR n + 1 + 1 - 1) with ((INR n + 1) * 1) by ring. apply Rmult_le_compat_l; [lra |].
    apply Rmult_le_compat_l; lra. }
  cut (bounded r (4 * (1 - (1 / 2) ^ N)) (fun t => rest_below a N (u t) (v t))).
  { intros H. apply (bounded_ext H); [reflexivity |]. pose proof (pow_le (1 / 2) N). lra. }
  induction N as [| N IH].
  - apply (bounded_ext (bounded_const r 0)); [reflexivity | rewrite Rabs_R0; simpl; lra].
  - refine (bounded_ext (bounded_plus IH
      (bounded_scal (a N) (bounded_rest _ _ _ N Hr Hu Huv))) _ _); [reflexivity |].
    cbn [pow]. pose proof (pow_le (1 / 2) N ltac:(lra)). destruct (F N) as [F0 F1].
    assert (Rabs (a N) * (INR N * (INR N - 1)) <= 1).
    { apply Rle_trans with (/ INR (fact N) * INR (fact N)).
      - apply Rmult_le_compat; [apply Rabs_pos | exact F0 | apply Ha | exact F1].
      - rewrite Rinv_l; [lra | apply INR_fact_neq_0]. }
    nra.
Qed.
