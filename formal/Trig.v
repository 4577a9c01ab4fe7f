(* How far sine and cosine are from the first terms of their Taylor series, for all real z. *)

From Coq Require Import Reals Lra.
Open Scope R_scope.

(* What is zero at zero and has a derivative >= 0 to the right of it is >= 0 there. *)
Lemma grows f f' : f 0 = 0 -> (forall x, derivable_pt_lim f x (f' x)) ->
  (forall x, 0 <= x -> 0 <= f' x) -> forall x, 0 <= x -> 0 <= f x.
Proof.
  intros H0 D Pos x [Hx | <-]; [| lra].
  destruct (MVT_cor2 f f' 0 x Hx) as (c & E & Hc); [auto |].
  assert (0 <= f' c) by (apply Pos; lra). nra.
Qed.

Lemma power_derivative n (c : R) x :
  derivable_pt_lim (fun x => c * x ^ S n) x (c * (INR (S n) * x ^ n)).
Proof. apply (derivable_pt_lim_scal (fun x => x ^ S n)). apply derivable_pt_lim_pow. Qed.

Lemma up1 x : 0 <= x -> sin x <= x.
Proof.
  intros Hx. enough (E : 0 <= 1 * x ^ 1 - sin x) by (simpl in E; lra).
  apply (grows (fun x => 1 * x ^ 1 - sin x) (fun x => 1 * (INR 1 * x ^ 0) - cos x)); auto.
  - simpl. rewrite sin_0. lra.
  - intro. apply derivable_pt_lim_minus; [apply power_derivative | apply derivable_pt_lim_sin].
  - intros u _. generalize (COS_bound u). simpl. lra.
Qed.

Lemma down2 x : 0 <= x -> 1 - x ^ 2 / 2 <= cos x.
Proof.
  intros Hx. enough (E : 0 <= cos x - 1 + / 2 * x ^ 2) by lra.
  apply (grows (fun x => cos x - 1 + / 2 * x ^ 2)
               (fun x => - sin x - 0 + / 2 * (INR 2 * x ^ 1))); auto.
  - simpl. rewrite cos_0. lra.
  - intro. apply derivable_pt_lim_plus; [| apply power_derivative].
    apply derivable_pt_lim_minus; [apply derivable_pt_lim_cos | apply derivable_pt_lim_const].
  - intros u Hu. generalize (up1 u Hu). simpl. lra.
Qed.

Lemma down3 x : 0 <= x -> x - x ^ 3 / 6 <= sin x.
Proof.
  intros Hx. enough (E : 0 <= sin x - 1 * x ^ 1 + / 6 * x ^ 3) by (simpl in *; lra).
  apply (grows (fun x => sin x - 1 * x ^ 1 + / 6 * x ^ 3)
               (fun x => cos x - 1 * (INR 1 * x ^ 0) + / 6 * (INR 3 * x ^ 2))); auto.
  - simpl. rewrite sin_0. lra.
  - intro. apply derivable_pt_lim_plus; [| apply power_derivative].
    apply derivable_pt_lim_minus; [apply derivable_pt_lim_sin | apply power_derivative].
  - intros u Hu. generalize (down2 u Hu). simpl. lra.
Qed.

Lemma up4 x : 0 <= x -> cos x <= 1 - x ^ 2 / 2 + x ^ 4 / 24.
Proof.
  intros Hx. enough (E : 0 <= 1 - / 2 * x ^ 2 + / 24 * x ^ 4 - cos x) by lra.
  apply (grows (fun x => 1 - / 2 * x ^ 2 + / 24 * x ^ 4 - cos x)
               (fun x => 0 - / 2 * (INR 2 * x ^ 1) + / 24 * (INR 4 * x ^ 3) - - sin x)); auto.
  - simpl. rewrite cos_0. lra.
  - intro. apply derivable_pt_lim_minus; [| apply derivable_pt_lim_cos].
    apply derivable_pt_lim_plus; [| apply power_derivative].
    apply derivable_pt_lim_minus; [apply derivable_pt_lim_const | apply power_derivative].
  - intros u Hu. generalize (down3 u Hu). simpl. lra.
Qed.

Lemma up5 x : 0 <= x -> sin x <= x - x ^ 3 / 6 + x ^ 5 / 120.
Proof.
  intros Hx. enough (E : 0 <= 1 * x ^ 1 - / 6 * x ^ 3 + / 120 * x ^ 5 - sin x)
    by (simpl in *; lra).
  apply (grows (fun x => 1 * x ^ 1 - / 6 * x ^ 3 + / 120 * x ^ 5 - sin x)
               (fun x => 1 * (INR 1 * x ^ 0) - / 6 * (INR 3 * x ^ 2) + / 120 * (INR 5 * x ^ 4)
                         - cos x)); auto.
  - simpl. rewrite sin_0. lra.
  - intro. apply derivable_pt_lim_minus; [| apply derivable_pt_lim_sin].
    apply derivable_pt_lim_plus; [| apply power_derivative].
    apply derivable_pt_lim_minus; apply power_derivative.
  - intros u Hu. generalize (up4 u Hu). simpl. lra.
Qed.

(* f = g + kappa m with kappa between 0 and c, where f - g lies between 0 and c m. *)
Lemma between f g m c : 0 <= c -> (m = 0 -> f = g) -> (0 < m -> 0 <= f - g <= c * m) ->
  (m < 0 -> c * m <= f - g <= 0) -> exists kappa, 0 <= kappa <= c /\ f = g + kappa * m.
Proof.
  intros Hc Zero Pos Neg. destruct (Req_dec m 0) as [E | E].
  { exists 0. rewrite (Zero E). split; lra. }
  exists ((f - g) / m). split; [| field; exact E].
  assert (D : (f - g) / m * m = f - g) by (field; exact E).
  destruct (Rlt_dec 0 m) as [P | N].
  - specialize (Pos P). split; apply Rmult_le_reg_r with m; lra.
  - specialize (Neg ltac:(lra)). split; apply Rmult_le_reg_r with (- m); lra.
Qed.

(* From E, that a product of factors z is zero. *)
Ltac factor_zero E := repeat (apply Rmult_integral in E; destruct E as [E | E]); exact E.

(* Even and odd in z, so known for z >= 0. *)
Lemma by_sign (P : R -> Prop) : (forall z, P z -> P (- z)) -> (forall z, 0 <= z -> P z) ->
  forall z, P z.
Proof.
  intros E H z. destruct (Rle_dec 0 z) as [Hz | Hz]; [now apply H |].
  rewrite <- (Ropp_involutive z). apply E, H. lra.
Qed.

Lemma cos2 z : exists kappa, 0 <= kappa <= / 2 /\ cos z = 1 - kappa * (z * z).
Proof.
  revert z. apply by_sign.
  - intros z (kappa & B & H). exists kappa. rewrite cos_neg, H. split; [exact B | ring].
  - intros z Hz. assert (0 <= z * z) by nra.
    destruct (between 1 (cos z) (z * z) (/ 2)) as (kappa & B & Hk); try lra.
    + intros E. assert (E' : z = 0) by factor_zero E. rewrite E'. symmetry. exact cos_0.
    + generalize (down2 z Hz), (COS_bound z). simpl. intros. lra.
    + exists kappa. split; [exact B | lra].
Qed.

Lemma sin3 z : exists kappa, 0 <= kappa <= / 6 /\ sin z = z - kappa * (z * (z * z)).
Proof.
  revert z. apply by_sign.
  - intros z (kappa & B & H). exists kappa. rewrite sin_neg, H. split; [exact B | ring].
  - intros z Hz. assert (0 <= z * (z * z)) by (apply Rmult_le_pos; nra).
    destruct (between z (sin z) (z * (z * z)) (/ 6)) as (kappa & B & Hk); try lra.
    + intros E. assert (E' : z = 0) by factor_zero E. rewrite E'. symmetry. exact sin_0.
    + generalize (down3 z Hz), (up1 z Hz). simpl. intros. lra.
    + exists kappa. split; [exact B | lra].
Qed.

Lemma cos4 z : exists kappa, 0 <= kappa <= / 24 /\
  cos z = 1 - z * z / 2 + kappa * ((z * z) * (z * z)).
Proof.
  revert z. apply by_sign.
  - intros z (kappa & B & H). exists kappa. rewrite cos_neg, H. split; [exact B | field].
  - intros z Hz. assert (0 <= (z * z) * (z * z)) by (apply Rmult_le_pos; nra).
    destruct (between (cos z) (1 - z * z / 2) ((z * z) * (z * z)) (/ 24)) as (kappa & B & Hk);
      try lra.
    + intros E. assert (E' : z = 0) by factor_zero E. rewrite E', cos_0. lra.
    + generalize (down2 z Hz), (up4 z Hz). simpl. intros. lra.
    + exists kappa. split; [exact B | lra].
Qed.

Lemma sin5 z : exists kappa, 0 <= kappa <= / 120 /\
  sin z = z - z * (z * z) / 6 + kappa * ((z * (z * z)) * (z * z)).
Proof.
  revert z. apply by_sign.
  - intros z (kappa & B & H). exists kappa. rewrite sin_neg, H. split; [exact B | field].
  - intros z Hz. assert (0 <= (z * (z * z)) * (z * z)) by (repeat apply Rmult_le_pos; nra).
    destruct (between (sin z) (z - z * (z * z) / 6) ((z * (z * z)) * (z * z)) (/ 120))
      as (kappa & B & Hk); try lra.
    + intros E. assert (E' : z = 0) by factor_zero E.
      rewrite E', sin_0. lra.
    + generalize (down3 z Hz), (up5 z Hz). simpl. intros. lra.
    + exists kappa. split; [exact B | lra].
Qed.
