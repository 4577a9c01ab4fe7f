(* One step of Newton's method (docs/proofs/existence.md, sections 4 and 5), for one angle and the potential
   V(y) = eps cos y: x(t) = t + u(t) is looked for such that x(t + w) - 2 x(t) + x(t - w) = eps sin x(t).

   All functions are trigonometric polynomials: sine and cosine of u are replaced by Taylor polynomials
   of a degree that grows from step to step, and the inverse of 1 + u' by the first terms of Neumann's
   series.  There are so many terms that the omitted ones are less than the square of the residual.
   u is odd, so Lemma 1 of the page (the mean of L E is zero) follows by symmetry. *)

From Coq Require Import Reals ZArith List Lra Lia Psatz ConstructiveEpsilon.
From Coquelicot Require Import Coquelicot.
From Converse Require Import Fourier Taylor.
Open Scope R_scope.

Definition odd (f : R -> R) : Prop := forall t, f (- t) = - f t.
Definition even (f : R -> R) : Prop := forall t, f (- t) = f t.

Lemma odd_derivative f f' : (forall t, is_derive f t (f' t)) -> odd f -> even f'.
Proof.
  intros D H t. assert (E : is_derive f t (f' (- t)));
    [| now rewrite <- (is_derive_unique _ _ _ E), (is_derive_unique _ _ _ (D t))].
  apply (is_derive_ext (fun s => - f (- s))); [intros s; now rewrite H, Ropp_involutive |].
  pose proof (D (- t)) as D'. auto_derive; [now exists (f' (- t)) |].
  change (fun x => f x) with f. rewrite (is_derive_unique _ _ _ D'). ring.
Qed.

(* A power that is small. *)
Lemma small_power e : 0 < e -> {N : nat | (2 / 3) ^ N <= e}.
Proof.
  intros He. apply constructive_indefinite_ground_description_nat;
    [intros N; destruct (Rle_dec ((2 / 3) ^ N) e); auto |].
  destruct (pow_lt_1_zero (2 / 3)) with (y := e) as (N & H); [rewrite Rabs_right; lra | exact He |].
  exists N. specialize (H N (Nat.le_refl N)). rewrite Rabs_right in H; [lra |]. apply Rle_ge, pow_le. lra.
Qed.

(* A function that is a difference, up to a constant m: m is its mean along an orbit, and at least each
   lower bound of the function. *)
Lemma mean_above w f g m c A : (forall t, g (t + w) - g t = f t - m) -> (forall t, c <= f t) ->
  (forall t, Rabs (g t) <= A) -> c <= m.
Proof.
  intros E Hf Hg. apply Rnot_lt_le. intros H.
  assert (S : forall n, INR n * (c - m) <= g (INR n * w) - g 0).
  { induction n as [| n IH]; [simpl; rewrite !Rmult_0_l; lra |]. rewrite S_INR.
    specialize (E (INR n * w)). specialize (Hf (INR n * w)).
    replace ((INR n + 1) * w) with (INR n * w + w) by ring. lra. }
  destruct (archimed_cor1 ((c - m) / (2 * A + 1))) as (n & Hn & Hn0).
  { apply Rdiv_lt_0_compat; [lra |]. specialize (Hg 0). pose proof (Rabs_pos (g 0)). lra. }
  specialize (S n). pose proof (Hg (INR n * w)) as A1. pose proof (Hg 0) as A2.
  assert (A0 : 0 <= A) by (pose proof (Rabs_pos (g 0)); lra). apply Rabs_le_between in A1, A2.
  apply (lt_INR 0) in Hn0. simpl in Hn0. apply (Rmult_lt_compat_r (INR n * (2 * A + 1))) in Hn; [| nra].
  replace (/ INR n * (INR n * (2 * A + 1))) with (2 * A + 1) in Hn by (field; lra).
  replace ((c - m) / (2 * A + 1) * (INR n * (2 * A + 1))) with (INR n * (c - m)) in Hn by (field; lra). lra.
Qed.

Section Step.
Variables w eps : R.
Hypothesis divisor : forall k : Z, k <> 0%Z -> 1 / Rabs (IZR k) <= Rabs (2 * sin (IZR k * w / 2)).
Hypothesis Heps : Rabs eps <= 1.

(* The residual of u, with N terms of the Taylor series. *)
Definition kick (N : nat) (u : R -> R) (t : R) : R := sin t * Cos N (u t) + cos t * Sin N (u t).
Definition residual (N : nat) (u : R -> R) (t : R) : R :=
  u (t + w) - 2 * u t + u (t - w) - eps * kick N u t.

(* It is at most e for all N large enough. *)
Definition solved (r e : R) (u : R -> R) : Type :=
  {N0 : nat & forall N, (N0 <= N)%nat -> bounded r e (residual N u)}.

Lemma odd_residual N u : odd u -> odd (residual N u).
Proof.
  intros H t. unfold residual, kick. rewrite sin_neg, cos_neg, H.
  destruct (parity N (u t)) as [-> ->].
  replace (- t + w) with (- (t - w)) by ring. replace (- t - w) with (- (t + w)) by ring.
  rewrite !H. ring.
Qed.

(* More terms. *)
Lemma kick_tail r U u N k alpha : 1 <= r -> U <= 1 / 2 -> bounded r U u ->
  / INR (fact N) <= alpha -> bounded r (4 * alpha * r * U ^ N) (fun t => kick (k + N) u t - kick N u t).
Proof.
  intros Hr HU Hu Ha.
  assert (U0 := bounded_0 Hr Hu).
  assert (A0 : 0 < / INR (fact N)) by (apply Rinv_0_lt_compat, INR_fact_lt_0).
  assert (Hc : forall a, (forall n, Rabs (a n) <= / INR (fact n)) -> bounded r (2 * alpha * U ^ N)
     (fun t => sum_below a (k + N) (u t) - sum_below a N (u t))).
  { intros a H. refine (bounded_ext (bounded_tail r U u a alpha N k Hr HU Hu _) _ _); [| reflexivity |].
    - intros n Hn. eapply Rle_trans; [apply H |].
      apply Rle_trans with (/ INR (fact N)); [now apply factorials | exact Ha].
    - apply Rmult_le_compat_l; [lra |]. pose proof (pow_le U (k + N) U0). lra. }
  refine (bounded_ext (bounded_plus
    (bounded_mult Hr (bounded_sin1 r) (Hc _ (fun n => proj1 (coefficients n))))
    (bounded_mult Hr (bounded_cos1 r) (Hc _ (fun n => proj2 (coefficients n))))) _ _).
  - intros t. unfold kick, Cos, Sin. ring.
  - apply Req_le. ring.
Qed.

Variables (r d K e : R).
Hypotheses (Hr : 1 <= r - 3 * d) (Hd : 0 < d) (HK : r <= K * d) (Hr2 : r <= 2) (He : 0 < e).
Variables (u u' : R -> R) (U : R).
Hypotheses (Du : forall t, is_derive u t (u' t)) (Hodd : odd u).
Hypotheses (Hu : bounded r U u) (HU : U + 700 * (K * K) * e <= 1 / 2) (Hu' : bounded r (2 / 3) u').
Hypothesis E : solved r e u.

Theorem step : {v : R -> R & {v' : R -> R & {_ : odd v /\ (forall t, is_derive v t (v' t)) &
  (bounded (r - 3 * d) (700 * (K * K) * e) v * bounded (r - 3 * d) (700 * (K * K * K) * e) v' *
   solved (r - 3 * d) (8000000 * (K * K * K * K) * (e * e)) (fun t => (u t + v t)%R))%type}}}.
Proof.
  assert (Hr1 : 1 <= r) by lra.
  assert (Hrd : 1 <= r - d) by lra. assert (Hrdd : 1 <= r - d - d) by lra.
  assert (K3 : 3 <= K) by (apply Rmult_le_reg_r with d; lra).
  assert (U0 := bounded_0 Hr1 Hu).
  assert (K9 : 9 <= K * K) by nra.
  assert (He1 : e <= 1 / 100) by nra.
  destruct E as (N0 & HN0).
  destruct (small_power (e * e / 4)) as (N1 & HN1); [nra |].
  set (N := Nat.max N0 N1).
  assert (HN3 : (2 / 3) ^ N <= e * e / 4).
  { apply Rle_trans with ((2 / 3) ^ N1); [| exact HN1].
    replace N with ((N - N1) + N1)%nat by lia. rewrite pow_add.
    pose proof (pow_le (2 / 3) N1 ltac:(lra)).
    assert ((2 / 3) ^ (N - N1) <= 1) by (rewrite <- (pow1 (N - N1)); apply pow_incr; lra).
    rewrite <- (Rmult_1_l ((2 / 3) ^ N1)) at 2. now apply Rmult_le_compat_r. }
  assert (HN : (1 / 2) ^ N <= e * e / 4).
  { apply Rle_trans with ((2 / 3) ^ N); [apply pow_incr; lra | exact HN3]. }
  assert (Hee : e * e / 4 <= e / 4) by nra.
  assert (HP := HN0 (S N) ltac:(lia)). set (P := residual (S N) u) in *. clear E HN0 HN1.
  (* L, and M, nearly its inverse. *)
  set (L := fun t => 1 + u' t). set (M := fun t => sum_below (fun n => (-1) ^ n) N (u' t)).
  set (mu := fun t => 1 - L t * M t).
  assert (evenu' := odd_derivative _ _ Du Hodd).
  assert (HL : bounded r (5 / 3) L).
  { refine (bounded_ext (bounded_plus (bounded_const r 1) Hu') _ _); [reflexivity | rewrite Rabs_R1; lra]. }
  assert (Hmu : bounded r e mu).
  { refine (bounded_ext (bounded_scal ((-1) ^ N) (bounded_power N Hr1 Hu')) _ _).
    - intros t. unfold mu, L, M. clear. induction N as [| n IH]; [simpl; ring |].
      rewrite sum_below_S. set (s := sum_below _ n (u' t)) in *.
      replace (1 - (1 + u' t) * (s + (-1) ^ n * u' t ^ n))
        with (1 - (1 + u' t) * s - (1 + u' t) * ((-1) ^ n * u' t ^ n)) by ring.
      rewrite IH. simpl. ring.
    - rewrite pow_1_abs. lra. }
  assert (HM : bounded r 3 M).
  { cut (bounded r (3 * (1 - (2 / 3) ^ N)) M).
    { intros H. apply (bounded_ext H); [reflexivity |]. pose proof (pow_le (2 / 3) N). lra. }
    unfold M. clear -Hr1 Hu'. induction N as [| n IH].
    - apply (bounded_ext (bounded_const r 0)); [reflexivity | rewrite Rabs_R0; simpl; lra].
    - refine (bounded_ext (bounded_plus IH (bounded_scal ((-1) ^ n) (bounded_power n Hr1 Hu'))) _ _);
        [reflexivity |]. rewrite pow_1_abs. simpl. lra. }
  assert (evenM : even M) by (intros t; unfold M; now rewrite evenu').
  assert (M_above : forall t, 59 / 100 <= M t).
  { intros t. pose proof (bounded_everywhere t Hr1 Hmu) as B1.
    pose proof (bounded_everywhere t Hr1 Hu') as B2.
    apply Rabs_le_between in B1, B2. unfold mu, L in B1. nra. }
  (* B, nearly the inverse of A = L_- L, and its mean mB. *)
  set (B := fun t => M (t - w) * M t).
  assert (B_above : forall t, 1 / 3 <= B t).
  { intros t. unfold B. pose proof (M_above t). pose proof (M_above (t - w)). nra. }
  assert (HB : bounded r 9 B).
  { refine (bounded_ext (bounded_mult Hr1 (bounded_moved (- w) HM) HM) _ _); [reflexivity | lra]. }
  assert (symB : forall t, B (w - t) = B t).
  { intros t. unfold B. rewrite <- (evenM t), <- (evenM (t - w)).
    replace (- (t - w)) with (w - t) by ring. replace (w - t - w) with (- t) by ring. ring. }
  destruct (bounded_difference w divisor (r - d) d K ltac:(lra) Hd ltac:(lra)
    (bounded_less r (r - d) ltac:(lra) HB)) as (mB & beta & (_ & Ebeta) & Hbeta).
  (* g = R_+ (L P). *)
  destruct (bounded_difference w divisor r d K ltac:(lra) Hd HK
    (bounded_mult Hr1 HL HP)) as (mg & g0 & (_ & Eg0) & Hg0).
  set (g := fun t => / 2 * (g0 t + g0 (w - t))).
  assert (Eg : forall t, g (t + w) = g t + L t * P t).
  { intros t. unfold g. replace (w - (t + w)) with (- t) by ring.
    pose proof (Eg0 t) as E1. pose proof (Eg0 (- t)) as E2.
    replace (- t + w) with (w - t) in E2 by ring.
    unfold P in E2. rewrite (odd_residual (S N) u Hodd t) in E2. fold P in E2.
    unfold L at 1 in E2. rewrite evenu' in E2. fold (L t) in E2. lra. }
  assert (symg : forall t, g (w - t) = g t).
  { intros t. unfold g. replace (w - (w - t)) with t by ring. ring. }
  assert (Hg : bounded (r - d) (5 / 3 * (K * e)) g).
  { refine (bounded_ext (bounded_scal (/ 2) (bounded_plus Hg0 (bounded_reflected (bounded_moved w Hg0)))) _ _).
    - intros t. unfold g. do 3 f_equal. ring.
    - rewrite Rabs_right by lra. apply Req_le. field. }
  (* C, and z = R_- (B (C - g)). *)
  destruct (bounded_difference w divisor (r - d) d K ltac:(lra) Hd ltac:(lra)
    (bounded_mult Hrd (bounded_less r (r - d) ltac:(lra) HB) Hg))
    as (mBg & gamma & (HmBg & Egamma) & Hgamma).
  assert (HmB : 1 / 3 <= mB).
  { apply (mean_above w B beta mB (1 / 3) (K * 9) Ebeta B_above). intros t.
    now apply (bounded_everywhere (r := r - d - d)). }
  set (C := mBg / mB).
  assert (EC : C * mB = mBg) by (unfold C; field; lra).
  assert (HC : Rabs C <= 45 * (K * e)).
  { unfold C, Rdiv. rewrite Rabs_mult, (Rabs_right (/ mB))
      by (apply Rle_ge, Rlt_le, Rinv_0_lt_compat; lra).
    apply Rmult_le_reg_r with mB; [lra |]. rewrite Rmult_assoc, Rinv_l, Rmult_1_r by lra.
    assert (0 <= K * e) by nra. nra. }
  set (y := fun t => B t * (C - g t)).
  assert (symy : forall t, y (w - t) = y t) by (intros t; unfold y; now rewrite symB, symg).
  set (z0 := fun t => C * beta t - gamma t).
  assert (Ez0 : forall t, z0 (t + w) - z0 t = y t).
  { intros t. unfold z0, y. pose proof (Ebeta t). pose proof (Egamma t).
    replace (C * beta (t + w) - gamma (t + w) - (C * beta t - gamma t))
      with (C * (beta (t + w) - beta t) - (gamma (t + w) - gamma t)) by ring.
    rewrite H, H0, <- EC. ring. }
  set (z := fun t => / 2 * (z0 (t + w) - z0 (- t + w))).
  assert (Ez : forall t, z t - z (t - w) = y t).
  { intros t. unfold z. pose proof (Ez0 t) as E1. pose proof (Ez0 (w - t)) as E2. rewrite symy in E2.
    pose proof (Ez0 (- t)) as E3.
    replace (t - w + w) with t by ring. replace (- (t - w) + w) with (w - t + w) by ring.
    replace (- t + w) with (w - t) by ring. lra. }
  assert (oddz : odd z).
  { intros t. unfold z. rewrite Ropp_involutive. ring. }
  assert (HK2 : 0 <= K * e) by nra.
  assert (Hz : bounded (r - d - d) (420 * (K * K) * e) z).
  { assert (H0 : bounded (r - d - d) (420 * (K * K) * e) z0).
    { refine (bounded_ext (bounded_minus (bounded_scal C Hbeta) Hgamma) _ _); [reflexivity |].
      assert (0 <= K * (K * e)) by nra. nra. }
    refine (bounded_ext (bounded_scal (/ 2) (bounded_minus (bounded_moved w H0)
      (bounded_reflected (bounded_moved w H0)))) _ _); [reflexivity |].
    rewrite Rabs_right by lra. apply Req_le. field. }
  assert (zplus : forall t, z (t + w) = z t + M t * M (t + w) * (C - (g t + L t * P t))).
  { intros t. pose proof (Ez (t + w)) as E1. unfold y, B in E1.
    replace (t + w - w) with t in E1 by ring. rewrite Eg in E1. lra. }
  assert (zminus : forall t, z (t - w) = z t - M (t - w) * M t * (C - g t)).
  { intros t. pose proof (Ez t) as E1. unfold y, B in E1. lra. }
  set (v := fun t => L t * z t).
  assert (Hv : bounded (r - d - d) (700 * (K * K) * e) v).
  { refine (bounded_ext (bounded_mult Hrdd (bounded_less r (r - d - d) ltac:(lra) HL) Hz) _ _);
      [reflexivity | lra]. }
  assert (oddv : odd v).
  { intros t. unfold v, L. rewrite evenu', oddz. ring. }
  (* The derivative of P. *)
  set (c := fun t => cos t * Cos N (u t) - sin t * Sin N (u t)).
  set (tau := fun t => cos t * (Cos (S N) (u t) - Cos N (u t)) - sin t * (Sin (S N) (u t) - Sin N (u t))).
  set (P' := fun t => L (t + w) - 2 * L t + L (t - w) - eps * (c t * L t + tau t)).
  assert (DP : forall t, is_derive P t (P' t)).
  { intros t. unfold P, residual, kick.
    pose proof (Du (t + w)) as D1. pose proof (Du t) as D2. pose proof (Du (t - w)) as D3.
    pose proof (derive_Cos N (u t)) as D4. pose proof (derive_Sin N (u t)) as D5.
    auto_derive.
    - repeat split; eexists; eassumption.
    - change (t + - w) with (t - w). change (fun x => u x) with u.
      change (fun x => Cos (S N) x) with (Cos (S N)). change (fun x => Sin (S N) x) with (Sin (S N)).
      rewrite (is_derive_unique _ _ _ D1), (is_derive_unique _ _ _ D2), (is_derive_unique _ _ _ D3),
        (is_derive_unique _ _ _ D4), (is_derive_unique _ _ _ D5).
      unfold P', L, c, tau. ring. }
  assert (HP' := bounded_derivative r d K e P P' ltac:(lra) HK DP HP).
  assert (Hu2 : bounded r (1 / 2) u) by (apply (bounded_ext Hu); [reflexivity | nra]).
  assert (Hr0 : r * (1 / 2) ^ N <= e / 2).
  { pose proof (pow_le (1 / 2) N ltac:(lra)). nra. }
  assert (Htau : bounded r e tau).
  { assert (T : forall a, (forall n, Rabs (a n) <= / INR (fact n)) ->
      bounded r ((1 / 2) ^ N) (fun t => sum_below a (S N) (u t) - sum_below a N (u t))).
    { intros a Ha. refine (bounded_ext (bounded_scal (a N) (bounded_power N Hr1 Hu2)) _ _).
      - intros t. simpl. ring.
      - pose proof (pow_le (1 / 2) N ltac:(lra)). specialize (Ha N).
        pose proof (factorials 0 N ltac:(lia)). simpl (/ INR (fact 0)) in H0. rewrite Rinv_1 in H0.
        rewrite <- (Rmult_1_l ((1 / 2) ^ N)) at 2. apply Rmult_le_compat_r; lra. }
    refine (bounded_ext (bounded_minus
      (bounded_mult Hr1 (bounded_cos1 r) (T _ (fun n => proj1 (coefficients n))))
      (bounded_mult Hr1 (bounded_sin1 r) (T _ (fun n => proj2 (coefficients n))))) _ _);
      [reflexivity | lra]. }
  (* The new residual. *)
  set (q := fun t => sin t * rest_Cos (S N) (u t) (v t) + cos t * rest_Sin (S N) (u t) (v t)).
  assert (Hnew : forall t, residual (S N) (fun t => u t + v t) t =
    P' t * z t + eps * tau t * z t + mu t * P t
    + M t * (mu (t - w) * (C - g t) - mu (t + w) * (C - (g t + L t * P t))) - eps * (q t * (v t * v t))).
  { intros t.
    transitivity (P t + (v (t + w) - 2 * v t + v (t - w)) - eps * (c t * v t + q t * (v t * v t))).
    - unfold P, residual, kick, c, q. rewrite second_Cos, second_Sin. ring.
    - unfold v. rewrite zplus, zminus. unfold P', mu. ring. }
  assert (HCg : bounded (r - d) (47 * (K * e)) (fun t => C - g t)).
  { refine (bounded_ext (bounded_minus (bounded_const _ C) Hg) _ _); [reflexivity | lra]. }
  assert (HCg' : bounded (r - d) (47 * (K * e)) (fun t => C - (g t + L t * P t))).
  { apply (bounded_ext (bounded_moved w HCg)); [intros t; now rewrite Eg | lra]. }
  assert (Huv : bounded (r - d - d) (1 / 2) (fun t => u t + v t)).
  { apply (bounded_ext (bounded_plus (bounded_less r (r - d - d) ltac:(lra) Hu) Hv));
      [reflexivity | exact HU]. }
  assert (Hu2' := bounded_less r (r - d - d) ltac:(lra) Hu2).
  assert (Hq : bounded (r - d - d) 16 q).
  { refine (bounded_ext (bounded_plus
      (bounded_mult Hrdd (bounded_sin1 _)
        (bounded_rest_below (S N) Hrdd Hu2' Huv (fun n => proj1 (coefficients n))))
      (bounded_mult Hrdd (bounded_cos1 _)
        (bounded_rest_below (S N) Hrdd Hu2' Huv (fun n => proj2 (coefficients n))))) _ _);
      [reflexivity | lra]. }
  assert (Ke0 : 0 <= K * K * e) by nra.
  assert (HR : bounded (r - d - d) (7999999 * (K * K * K * K) * (e * e))
                       (residual (S N) (fun t => u t + v t))).
  { assert (dn : forall M f, bounded r M f -> bounded (r - d - d) M f)
      by (intros; apply (bounded_less r); [lra | assumption]).
    assert (dd : forall M f, bounded (r - d) M f -> bounded (r - d - d) M f)
      by (intros; apply (bounded_less (r - d)); [lra | assumption]).
    refine (bounded_ext (bounded_minus (bounded_plus (bounded_plus (bounded_plus
      (bounded_mult Hrdd (dd _ _ HP') Hz)
      (bounded_mult Hrdd (bounded_scal eps (dn _ _ Htau)) Hz))
      (bounded_mult Hrdd (dn _ _ Hmu) (dn _ _ HP)))
      (bounded_mult Hrdd (dn _ _ HM) (bounded_minus
        (bounded_mult Hrdd (dn _ _ (bounded_moved (- w) Hmu)) (dd _ _ HCg))
        (bounded_mult Hrdd (dn _ _ (bounded_moved w Hmu)) (dd _ _ HCg')))))
      (bounded_scal eps (bounded_mult Hrdd Hq (bounded_mult Hrdd Hv Hv)))) Hnew _).
    set (k := Rabs eps) in *. assert (0 <= k) by apply Rabs_pos.
    assert (E2 : 0 <= e * e) by nra.
    assert (A1 : k * e * (420 * (K * K) * e) <= 420 * (K * K) * (e * e)).
    { replace (k * e * (420 * (K * K) * e)) with (k * (420 * (K * K) * (e * e))) by ring.
      rewrite <- (Rmult_1_l (420 * (K * K) * (e * e))) at 2. apply Rmult_le_compat_r; nra. }
    assert (A2 : k * (16 * (700 * (K * K) * e * (700 * (K * K) * e)))
                 <= 7840000 * (K * K * K * K) * (e * e)).
    { replace (16 * (700 * (K * K) * e * (700 * (K * K) * e)))
        with (7840000 * (K * K * K * K) * (e * e)) by ring.
      rewrite <- (Rmult_1_l (7840000 * (K * K * K * K) * (e * e))) at 2.
      apply Rmult_le_compat_r; [apply Rmult_le_pos; [nra | exact E2] | exact Heps]. }
    assert (A3 : 420 * (K * K * K) + 420 * (K * K) + 1 + 282 * K <= 159999 * (K * K * K * K)).
    { assert (27 <= K * K * K) by nra. nra. }
    apply (Rmult_le_compat_r (e * e)) in A3; [| exact E2]. lra. }
  destruct (bounded_smooth Hv) as (v' & Dv).
  exists v, v'. unshelve eexists; [now split |]. split; [split |].
  - exact (bounded_less (r - d - d) (r - 3 * d) ltac:(lra) Hv).
  - apply (bounded_ext (r := r - 3 * d) (M := K * (700 * (K * K) * e)) (f := v')); [| reflexivity | lra].
    apply (bounded_less (r - d - d - d)); [lra |].
    apply (bounded_derivative (r - d - d) d K _ v); [lra | lra | exact Dv | exact Hv].
  - exists (S N). intros N' HN'.
    assert (H : bounded (r - d - d) (e * e)
                        (fun t => kick N' (fun t => u t + v t) t - kick (S N) (fun t => u t + v t) t)).
    { replace N' with ((N' - S N) + S N)%nat by lia.
      refine (bounded_ext (kick_tail (r - d - d) (1 / 2) _ (S N) _ 1 Hrdd ltac:(lra) Huv _) _ _);
        [| reflexivity |].
      - pose proof (factorials 0 (S N) ltac:(lia)). simpl (/ INR (fact 0)) in H. lra.
      - simpl. pose proof (pow_le (1 / 2) N ltac:(lra)). nra. }
    apply (bounded_less (r - d - d)); [lra |].
    refine (bounded_ext (bounded_minus HR (bounded_scal eps H)) _ _).
    + intros t. unfold residual. ring.
    + assert (1 <= K * K * K * K) by nra. nra.
Qed.
End Step.
