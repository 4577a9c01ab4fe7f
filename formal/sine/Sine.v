(* What sine.h promises: double_sincos is within 1.86 u of sine and cosine, u = 2^-53.

   formal/gappa.py --coq makes the other files: header.v, the operations of the C text, rounded
   (name_) and without roundings (name_exact), and Gappa's proofs: turns.v of n, reduced_after.v and
   reduced_before.v of r, sine.v and cosine.v of the polynomials.  Here they are put together. *)

Require Import Reals Lra Lia Classical.
From Flocq Require Import Core.
From Interval Require Import Tactic.
From Gappa Require Import Gappa_library.
Require Import header.
Require turns reduced_before reduced_after sine cosine.
Open Scope R_scope.

Definition u := / 9007199254740992.

(* Numbers of Gappa's as quotients of integers. *)
Lemma value m e : float2R (Float2 m e) =
  match e with
  | Z0 => IZR m
  | Zpos p => IZR (m * Z.pow_pos 2 p)
  | Zneg p => IZR m / IZR (Z.pow_pos 2 p)
  end.
Proof.
unfold float2R, Defs.F2R; simpl; destruct e as [|p|p]; simpl.
- ring.
- now rewrite mult_IZR.
- reflexivity.
Qed.

Ltac numbers :=
  unfold BND, Float1, u in *;
  repeat match goal with
  | |- context [float2R ?f] =>
      let g := eval vm_compute in f in
      change (float2R f) with (float2R g);
      match g with Float2 ?m ?e => rewrite (value m e) end
  | H : context [float2R ?f] |- _ =>
      let g := eval vm_compute in f in
      change (float2R f) with (float2R g) in H;
      match g with Float2 ?m ?e => rewrite (value m e) in H end
  end;
  simpl in *.

(* A Gappa proof refutes its hypotheses together with the negation of a conclusion. *)
Ltac one_of := first [assumption | left; one_of | right; one_of].
Ltac refuted := apply NNPP; intro.

Lemma turns_hypothesis x : Rabs (rnd x) <= 1500000 -> BND (Rabs (rnd x)) turns.i1.
Proof. intros H. pose proof (Rabs_pos (rnd x)). numbers. lra. Qed.

Section Turns.
Variable x : R.
Hypothesis limit : Rabs (rnd x) <= 1500000.

Lemma shifted_integer : FIX (shifted_ (rnd x)) 0.
Proof. refuted; apply (turns.l1 x); split; [now apply turns_hypothesis | one_of]. Qed.

Lemma shifted_range : BND (shifted_ (rnd x)) turns.i2.
Proof. refuted; apply (turns.l1 x); split; [now apply turns_hypothesis | one_of]. Qed.

Lemma n_exact : BND (n_ (rnd x) - (shifted_ (rnd x) - Float1 6755399441055744)) turns.i3.
Proof. refuted; apply (turns.l1 x); split; [now apply turns_hypothesis | one_of]. Qed.

Lemma n_range : BND (n_ (rnd x)) turns.i4.
Proof. refuted; apply (turns.l1 x); split; [now apply turns_hypothesis | one_of]. Qed.

Lemma n_near :
  Rabs (n_ (rnd x) - Float2 5734161139222659 (-53) * rnd x) <= 4294967297 / 8589934592.
Proof.
assert (BND (n_ (rnd x) - ((rnd x * Float2 5734161139222659 (-53) + Float1 6755399441055744)
                           - Float1 6755399441055744)) turns.i5) as H.
{ refuted; apply (turns.l1 x); split; [now apply turns_hypothesis | one_of]. }
apply Rabs_le. revert H; generalize (n_ (rnd x)), (rnd x); intros n y H.
numbers. lra.
Qed.
End Turns.

(* ---- n *)

Lemma rnd_double y : rnd (rnd y) = rnd y.
Proof.
unfold rnd; apply Generic_fmt.round_generic; [apply Generic_fmt.valid_rnd_N|].
apply Generic_fmt.generic_format_round;
  [now apply FLT.FLT_exp_valid | apply Generic_fmt.valid_rnd_N].
Qed.

Lemma rnd_0 : rnd 0 = 0.
Proof. unfold rnd; apply Generic_fmt.round_0; apply Generic_fmt.valid_rnd_N. Qed.

Lemma FIX_integer y : FIX y 0 -> exists k, y = IZR k.
Proof.
intros [[m e] [<- H]]; exists (m * Z.pow radix2 e)%Z; simpl in H.
unfold float2R, Defs.F2R; cbn [Gappa_definitions.Fnum Gappa_definitions.Fexp Defs.Fnum Defs.Fexp].
now rewrite mult_IZR, IZR_Zpower.
Qed.

Lemma n_integer x : Rabs (rnd x) <= 1500000 ->
  exists k, n_ (rnd x) = IZR k /\ shifted_ (rnd x) = IZR (k + 6755399441055744)
            /\ (Z.abs k <= 954930)%Z.
Proof.
intros limit.
destruct (FIX_integer _ (shifted_integer x limit)) as [z Hz].
exists (z - 6755399441055744)%Z.
assert (n_ (rnd x) = IZR (z - 6755399441055744)) as E.
{ pose proof (n_exact x limit) as H; rewrite Hz in H. revert H.
  generalize (n_ (rnd x)); intros n H; rewrite minus_IZR. numbers. lra. }
split; [exact E|split].
- rewrite Hz; f_equal; ring.
- pose proof (n_range x limit) as H; rewrite E in H; revert H.
  generalize (z - 6755399441055744)%Z; intros k H.
  unfold BND in H. destruct H as [H1 H2].
  apply le_IZR. rewrite abs_IZR. apply Rabs_le. numbers. lra.
Qed.

(* ---- r *)

Definition K := Float2 4175892906503776358826876457663557747 (-121).

Lemma K_parts :
  float2R K = Float2 1686629713 (-30) + Float2 2242054355 (-65) + Float2 5376105825661043 (-121).
Proof. unfold K. numbers. lra. Qed.

Lemma K_near : Rabs (PI / 2 - K) <= 2473044213727809433 / 2 ^ 184.
Proof.
unfold K. numbers. interval with (i_prec 250).
Qed.

Lemma BND_abs y i b :
  Rabs y <= b -> float2R (lower i) = 0 -> b <= float2R (upper i) -> BND (Rabs y) i.
Proof. intros H1 H2 H3; unfold BND; rewrite H2; split; [apply Rabs_pos | lra]. Qed.

Lemma BND_symmetric y i :
  BND y i -> - float2R (upper i) <= float2R (lower i) -> Rabs y <= upper i.
Proof. intros [H1 H2] H; apply Rabs_le; lra. Qed.

Section Reduced.
Variables (x : R) (k : Z).
Hypothesis limit : Rabs (rnd x) <= 1500000.
Hypothesis is_n : n_ (rnd x) = IZR k.
Hypothesis size : (Z.abs k <= 954930)%Z.
Let delta := PI / 2 - K.
Let rho := rnd x - IZR k * (PI / 2).
Let r := r_ (rnd x) (IZR k).

Lemma FIX_k : FIX (IZR k) 0.
Proof.
exists (Float2 k 0); split; [ | simpl; lia].
now rewrite value.
Qed.


Lemma near_k : Rabs (IZR k - Float2 5734161139222659 (-53) * rnd x) <= 4294967297 / 8589934592.
Proof. rewrite <- is_n. now apply n_near. Qed.

(* The rest of 2x/pi, and what r is off it, as Gappa has them; its hints are identities. *)
Ltac reduced lemma :=
  refuted; apply (lemma x (IZR k) delta);
  [ unfold Float1; ring
  | unfold Float1; field; rewrite value; simpl; lra
  | pose proof K_parts as E; unfold K in E; rewrite E; ring
  | split; [split; [split; [split; [exact FIX_k|]|]|] | one_of];
    [ | apply BND_abs with (1 := near_k); numbers; lra
      | apply BND_abs with (1 := K_near); numbers; lra]].

Ltac interval_of_k := split; numbers; apply IZR_le; lia.

Lemma after : (1 <= k)%Z ->
  BND (rnd x - IZR k * (K + delta)) reduced_after.i4
  /\ BND (r - (rnd x - IZR k * (K + delta))) reduced_after.i5.
Proof. intros positive; split; reduced reduced_after.l1; interval_of_k. Qed.

Lemma before : (k <= -1)%Z ->
  BND (rnd x - IZR k * (K + delta)) reduced_before.i4
  /\ BND (r - (rnd x - IZR k * (K + delta))) reduced_before.i5.
Proof. intros negative; split; reduced reduced_before.l1; interval_of_k. Qed.

Lemma at_zero : k = 0%Z -> r = rnd x.
Proof.
intros zero; unfold r, r_; rewrite zero, !Rmult_0_l, rnd_0, !Rminus_0_r.
now rewrite !rnd_double.
Qed.

(* x - n pi/2 is at most about pi/4, r is u off it, and such that Gappa bounds the polynomials. *)
Lemma reduced_rho :
  Rabs rho <= 78539817 / 100000000 /\ Rabs (r - rho) <= 10001 / 10000 * u
  /\ Rabs r <= upper sine.i1.
Proof.
assert (rho = rnd x - IZR k * (K + delta)) as E by (unfold rho, delta; ring).
assert (Rabs r <= Rabs rho + Rabs (r - rho)) as T
  by (replace r with (rho + (r - rho)) at 1 by ring; apply Rabs_triang).
destruct (Z.lt_trichotomy k 0) as [H|[H|H]].
- destruct before as [A B]; [lia|]. rewrite <- E in A, B.
  apply BND_symmetric in A; [|numbers; lra].
  apply BND_symmetric in B; [|numbers; lra].
  revert T A B; generalize (Rabs r) (Rabs rho) (Rabs (r - rho)); clear; intros a b c T A B.
  repeat split; numbers; lra.
- pose proof near_k as A. rewrite (at_zero H). rewrite H in A.
  unfold rho; rewrite H, !Rmult_0_l, Rminus_0_r.
  apply Rabs_le_inv in A. revert A; generalize (rnd x); clear; intros y A.
  unfold Rminus at 1; rewrite Rplus_opp_r, Rabs_R0.
  repeat split; try apply Rabs_le; numbers; lra.
- destruct after as [A B]; [lia|]. rewrite <- E in A, B.
  apply BND_symmetric in A; [|numbers; lra].
  apply BND_symmetric in B; [|numbers; lra].
  revert T A B; generalize (Rabs r) (Rabs rho) (Rabs (r - rho)); clear; intros a b c T A B.
  repeat split; numbers; lra.
Qed.
End Reduced.

(* ---- sine and cosine of r *)

Section Polynomials.
Variable y : R.
Let r := rnd y.
Hypothesis small : Rabs r <= upper sine.i1.

Lemma sine_roundings : Rabs (sine_ r - sine_exact r) <= 744 / 1000 * u.
Proof.
assert (BND (sine_ r - sine_exact r) sine.i2) as H.
{ refuted; apply (sine.l1 y); split; [ | one_of].
  apply BND_abs with (1 := small); numbers; lra. }
revert H; generalize (sine_ r - sine_exact r); intros a H.
apply Rabs_le; numbers; lra.
Qed.

Lemma cosine_roundings : Rabs (cosine_ r - cosine_exact r) <= 1064 / 1000 * u.
Proof.
assert (BND (cosine_ r - cosine_exact r) cosine.i2) as H.
{ refuted; apply (cosine.l1 y); split; [ | one_of].
  apply BND_abs with (1 := small); numbers; lra. }
revert H; generalize (cosine_ r - cosine_exact r); intros a H.
apply Rabs_le; numbers; lra.
Qed.
End Polynomials.

(* Without roundings they are Taylor's, but for their coefficients and what is left out. *)
Lemma sine_taylor r :
  Rabs r <= 785399 / 1000000 -> Rabs (sine_exact r - sin r) <= 42 / 1000 * u.
Proof.
intros H; apply Rabs_le_inv in H.
unfold sine_exact, p_exact, z_exact. numbers.
interval with (i_prec 120, i_taylor r, i_degree 24).
Qed.

Lemma cosine_taylor r :
  Rabs r <= 785399 / 1000000 -> Rabs (cosine_exact r - cos r) <= 9 / 1000 * u.
Proof.
intros H; apply Rabs_le_inv in H.
unfold cosine_exact, q_exact, z_exact. numbers.
interval with (i_prec 120, i_taylor r, i_degree 24).
Qed.

(* ---- all together *)

Lemma Rabs_sin_le t : Rabs (sin t) <= Rabs t.
Proof.
assert (forall a, 0 <= a -> Rabs (sin a) <= a) as P.
{ intros a H. destruct (Rle_lt_dec 1 a) as [L|L].
  - pose proof (SIN_bound a); apply Rabs_le; lra.
  - assert (0 <= sin a) by (apply sin_ge_0; [lra | pose proof PI2_1; lra]).
    rewrite Rabs_right by lra.
    destruct H as [H|<-]; [left; now apply sin_lt_x | rewrite sin_0; lra]. }
destruct (Rle_lt_dec 0 t) as [H|H].
- rewrite (Rabs_right t) by lra; now apply P.
- assert (0 <= - t) as Q by lra. apply P in Q. rewrite sin_neg, Rabs_Ropp in Q.
  now rewrite (Rabs_left t) by lra.
Qed.

Lemma sin_near a b : Rabs (sin a - sin b) <= Rabs (a - b).
Proof.
rewrite form4, !Rabs_mult, (Rabs_right 2) by lra.
pose proof (COS_bound ((a + b) / 2)) as C. pose proof (Rabs_sin_le ((a - b) / 2)) as S.
assert (Rabs (cos ((a + b) / 2)) <= 1) by (apply Rabs_le; lra).
replace ((a - b) / 2) with ((a - b) * / 2) in S by reflexivity.
rewrite (Rabs_mult (a - b)), (Rabs_right (/ 2)) in S by lra.
pose proof (Rabs_pos (cos ((a + b) / 2))). pose proof (Rabs_pos (sin ((a - b) / 2))).
unfold Rdiv in *. nra.
Qed.

Lemma cos_near a b c : Rabs a <= c -> Rabs b <= c -> Rabs (cos a - cos b) <= c * Rabs (a - b).
Proof.
intros A B.
rewrite form2, !Rabs_mult, (Rabs_left (-2)) by lra.
pose proof (Rabs_sin_le ((a + b) / 2)) as C. pose proof (Rabs_sin_le ((a - b) / 2)) as S.
unfold Rdiv in *. rewrite (Rabs_mult (a - b)), (Rabs_right (/ 2)) in S by lra.
rewrite (Rabs_mult (a + b)), (Rabs_right (/ 2)) in C by lra.
pose proof (Rabs_triang a b). pose proof (Rabs_pos (a - b)).
pose proof (Rabs_pos (sin ((a - b) * / 2))). pose proof (Rabs_pos (sin ((a + b) * / 2))).
assert (Rabs (sin ((a + b) * / 2)) <= c) by lra. nra.
Qed.

Lemma r_rounded x n : exists y, r_ x n = rnd y.
Proof. now eexists. Qed.

(* What double_sincos takes for sine and cosine of x is near sine and cosine of x - n pi/2. *)
Theorem reduced_sincos x : rnd x = x -> Rabs x <= 1500000 ->
  exists n : Z,
  n_ x = IZR n /\ shifted_ x = IZR (n + 6755399441055744) /\ (Z.abs n <= 954930)%Z /\
  Rabs (sine_ (r_ x (n_ x)) - sin (x - IZR n * (PI / 2))) <= 179 / 100 * u /\
  Rabs (cosine_ (r_ x (n_ x)) - cos (x - IZR n * (PI / 2))) <= 186 / 100 * u.
Proof.
intros double limit. rewrite <- double in limit |- *.
destruct (n_integer x limit) as [n [is_n [is_shifted size]]]. exists n.
split; [exact is_n|split; [exact is_shifted|split; [exact size|]]].
rewrite is_n.
destruct (reduced_rho x n limit is_n size) as [A [B C]]. revert A B C.
generalize (rnd x - IZR n * (PI / 2)); intros rho A B C.
destruct (r_rounded (rnd x) (IZR n)) as [y E]. rewrite E in *.
pose proof (sine_roundings y C) as D1. pose proof (cosine_roundings y C) as D2.
assert (Rabs (rnd y) <= 785399 / 1000000) as F
  by (revert C; clear; intros C; numbers; lra).
pose proof (sine_taylor _ F) as G1. pose proof (cosine_taylor _ F) as G2.
pose proof (sin_near (rnd y) rho) as I1.
assert (Rabs rho <= 785399 / 1000000) as A' by lra.
pose proof (cos_near _ _ _ F A') as I2.
split.
- replace (sine_ (rnd y) - sin rho) with ((sine_ (rnd y) - sine_exact (rnd y))
    + ((sine_exact (rnd y) - sin (rnd y)) + (sin (rnd y) - sin rho))) by ring.
  eapply Rle_trans; [apply Rabs_triang|].
  eapply Rle_trans; [apply Rplus_le_compat_l, Rabs_triang|]. unfold u in *; lra.
- replace (cosine_ (rnd y) - cos rho) with ((cosine_ (rnd y) - cosine_exact (rnd y))
    + ((cosine_exact (rnd y) - cos (rnd y)) + (cos (rnd y) - cos rho))) by ring.
  eapply Rle_trans; [apply Rabs_triang|].
  eapply Rle_trans; [apply Rplus_le_compat_l, Rabs_triang|]. unfold u in *; lra.
Qed.

(* ---- the quadrants: what the last two bits of n choose *)

Definition quadrant_sine (n : Z) (s c : R) : R :=
  (if Z.odd n then c else s) * (if Z.testbit n 1 then -1 else 1).
Definition quadrant_cosine (n : Z) (s c : R) : R :=
  (if Z.odd n then s else c) * (if Z.testbit (n + 1) 1 then -1 else 1).

Lemma sin_turns x m : sin (x + 2 * IZR m * PI) = sin x.
Proof.
destruct (Z.le_gt_cases 0 m) as [H|H].
- rewrite <- (Z2Nat.id m H), <- INR_IZR_INZ. apply sin_period.
- rewrite <- (sin_period (x + 2 * IZR m * PI) (Z.to_nat (- m))).
  f_equal. rewrite INR_IZR_INZ, Z2Nat.id by lia. rewrite opp_IZR. ring.
Qed.

Lemma sin_quadrant rho n : sin (rho + IZR n * (PI / 2)) = quadrant_sine n (sin rho) (cos rho).
Proof.
unfold quadrant_sine.
pose proof (Z.div_mod n 4 ltac:(lia)) as D. pose proof (Z.mod_pos_bound n 4 ltac:(lia)) as M.
set (m := (n / 4)%Z) in *. set (j := (n mod 4)%Z) in *.
assert (Z.odd n = Z.odd j) as O.
{ rewrite D, Z.odd_add, Z.odd_mul. now destruct (Z.odd j). }
assert (Z.testbit n 1 = Z.testbit j 1) as T.
{ unfold j. change 4%Z with (2 ^ 2)%Z. now rewrite Z.mod_pow2_bits_low by lia. }
rewrite O, T, D, plus_IZR, mult_IZR.
replace (rho + (4 * IZR m + IZR j) * (PI / 2))
  with ((rho + IZR j * (PI / 2)) + 2 * IZR m * PI) by field.
rewrite sin_turns. clear - M. clearbody j.
assert (j = 0 \/ j = 1 \/ j = 2 \/ j = 3)%Z as [->|[->|[->| ->]]] by lia; simpl.
- rewrite Rmult_0_l, Rplus_0_r; ring.
- rewrite Rmult_1_l, sin_plus, cos_PI2, sin_PI2; ring.
- replace (rho + 2 * (PI / 2)) with (rho + PI) by field. rewrite neg_sin; ring.
- replace (rho + 3 * (PI / 2)) with ((rho + PI / 2) + PI) by field.
  rewrite neg_sin, sin_plus, cos_PI2, sin_PI2; ring.
Qed.

Lemma cos_quadrant rho n : cos (rho + IZR n * (PI / 2)) = quadrant_cosine n (sin rho) (cos rho).
Proof.
rewrite cos_sin.
replace (PI / 2 + (rho + IZR n * (PI / 2))) with (rho + IZR (n + 1) * (PI / 2))
  by (rewrite plus_IZR; ring).
rewrite sin_quadrant. unfold quadrant_sine, quadrant_cosine.
now rewrite Z.odd_add; destruct (Z.odd n).
Qed.

Lemma quadrant_near n s c s' c' e : Rabs (s - s') <= e -> Rabs (c - c') <= e ->
  Rabs (quadrant_sine n s c - quadrant_sine n s' c') <= e
  /\ Rabs (quadrant_cosine n s c - quadrant_cosine n s' c') <= e.
Proof.
intros S C. unfold quadrant_sine, quadrant_cosine.
apply Rabs_le_inv in S, C.
destruct (Z.odd n), (Z.testbit n 1), (Z.testbit (n + 1) 1); split; apply Rabs_le; lra.
Qed.

(* The promise of sine.h: n has the last two bits of shifted, as 4 divides 6755399441055744. *)
Theorem double_sincos x : rnd x = x -> Rabs x <= 1500000 ->
  exists n : Z, shifted_ x = IZR (n + 6755399441055744) /\
  let sine := sine_ (r_ x (n_ x)) in
  let cosine := cosine_ (r_ x (n_ x)) in
  Rabs (quadrant_sine n sine cosine - sin x) <= 186 / 100 * u /\
  Rabs (quadrant_cosine n sine cosine - cos x) <= 186 / 100 * u.
Proof.
intros double limit.
destruct (reduced_sincos x double limit) as [n [_ [is_shifted [_ [S C]]]]].
exists n; split; [exact is_shifted|]; intros sine cosine; fold sine cosine in S, C.
assert (x = (x - IZR n * (PI / 2)) + IZR n * (PI / 2)) as E by ring.
replace (sin x) with (sin ((x - IZR n * (PI / 2)) + IZR n * (PI / 2))) by now rewrite <- E.
replace (cos x) with (cos ((x - IZR n * (PI / 2)) + IZR n * (PI / 2))) by now rewrite <- E.
rewrite sin_quadrant, cos_quadrant.
apply quadrant_near; [unfold u in *; lra | exact C].
Qed.
