(* A bound B of beta over the whole torus, v.beta(y)v <= B v.v, for all potentials of a patch: by
   branch and bound at each corner of the cube of parameters.  And what else is checked of a patch
   once: the factor l of the tails, a place where beta is small, a point of symmetry. *)

From Coq Require Import Reals ZArith QArith Qreals List Lra Lia Bool.
From Interval.Real Require Import Xreal.
From Interval.Float Require Import Basic Sig.
From Interval.Interval Require Import Interval Float Float_full.
From Converse Require Import Map Numbers Sine.
Import ListNotations.
Open Scope R_scope.

(* ---- rationals and sums *)

Lemma Q2R_0_1 : Q2R 0 = 0 /\ Q2R 1 = 1.
Proof. unfold Q2R. simpl. split; field. Qed.

Lemma Q2R_inject_Z n : Q2R (inject_Z n) = IZR n.
Proof. unfold Q2R. simpl. field. Qed.

Lemma sum_le {A} (f g : A -> R) l : (forall x, In x l -> f x <= g x) -> sum f l <= sum g l.
Proof.
  intros H. induction l as [| x l IH]; simpl; [lra |].
  apply Rplus_le_compat; [apply H; now left | apply IH; intros y Hy; apply H; now right].
Qed.

Lemma sum_ext {A} (f g : A -> R) l : (forall x, f x = g x) -> sum f l = sum g l.
Proof. intros H. induction l as [| x l IH]; simpl; [| rewrite H, IH]; reflexivity. Qed.

Lemma sum_linear {A} (f g : A -> R) a b l :
  sum (fun x => a * f x + b * g x) l = a * sum f l + b * sum g l.
Proof. induction l as [| x l IH]; simpl; [| rewrite IH]; ring. Qed.

Lemma sum_opp {A} (f : A -> R) l : sum (fun x => - f x) l = - sum f l.
Proof. induction l as [| x l IH]; simpl; [| rewrite IH]; ring. Qed.

(* ---- beta has the periods of the torus *)

Lemma beta_period ws y v (n0 n1 : Z) :
  beta ws (fst y + 2 * PI * IZR n0, snd y + 2 * PI * IZR n1) v = beta ws y v.
Proof.
  unfold beta. f_equal. apply sum_ext. intros w. f_equal. f_equal.
  replace (angle w (fst y + 2 * PI * IZR n0, snd y + 2 * PI * IZR n1))
    with (2 * PI * (angle w y / (2 * PI) + IZR (k0 w * n0 + k1 w * n1))).
  - rewrite sin_turns. f_equal. field. apply PI_neq0.
  - unfold angle, along. cbn [fst snd]. rewrite plus_IZR, !mult_IZR. field. apply PI_neq0.
Qed.

Lemma fraction x : exists n : Z, 0 <= x - IZR n <= 1.
Proof. exists (Int_part x). pose proof (base_Int_part x). lra. Qed.

(* ---- convex functions of the plane *)

Definition convex (f : vec -> R) : Prop := forall u w l, 0 <= l <= 1 ->
  f (plus (scale l u) (scale (1 - l) w)) <= l * f u + (1 - l) * f w.

Lemma between a x b : a <= x <= b -> exists l, 0 <= l <= 1 /\ x = l * a + (1 - l) * b.
Proof.
  intros H. destruct (Req_dec a b) as [-> | N].
  - exists 1. lra.
  - exists ((b - x) / (b - a)). assert (0 < b - a) by lra. split; [| field; lra].
    split; apply Rmult_le_reg_l with (b - a); trivial;
      replace ((b - a) * ((b - x) / (b - a))) with (b - x) by (field; lra); lra.
Qed.

(* Over a rectangle they are largest at a corner. *)
Lemma convex_rectangle f X a0 b0 a1 b1 x0 x1 : convex f ->
  a0 <= x0 <= b0 -> a1 <= x1 <= b1 ->
  f (a0, a1) <= X -> f (a0, b1) <= X -> f (b0, a1) <= X -> f (b0, b1) <= X -> f (x0, x1) <= X.
Proof.
  intros C H0 H1 Haa Hab Hba Hbb.
  destruct (between a0 x0 b0 H0) as (l & Hl & ->), (between a1 x1 b1 H1) as (k & Hk & ->).
  assert (S : forall z, f (a0, z) <= X -> f (b0, z) <= X -> f (l * a0 + (1 - l) * b0, z) <= X).
  { intros z Ha Hb. pose proof (C (a0, z) (b0, z) l Hl) as E. unfold plus, scale in E.
    cbn [fst snd] in E. replace (l * z + (1 - l) * z) with z in E by ring. nra. }
  pose proof (C (l * a0 + (1 - l) * b0, a1) (l * a0 + (1 - l) * b0, b1) k Hk) as E.
  unfold plus, scale in E. cbn [fst snd] in E.
  replace (k * (l * a0 + (1 - l) * b0) + (1 - k) * (l * a0 + (1 - l) * b0))
    with (l * a0 + (1 - l) * b0) in E by ring.
  pose proof (S a1 Haa Hba). pose proof (S b1 Hab Hbb). nra.
Qed.

(* ---- one cell: z its centre, r what is added *)

(* A function g that is above -p sin in the cell, p and sin those of the wave w. *)
Definition covers (z : vec) (wg : wave * (vec -> R)) : Prop :=
  let (w, g) := wg in
  convex g /\ forall r, - (amplitude w * sin (angle w (plus z r))) <= g r.

Definition quadratic_form (w : wave) (c0 c1 c2 : R) (r : vec) : R :=
  c0 + along w r * (c1 + along w r * c2).

Lemma quadratic_form_convex w c0 c1 c2 : 0 <= c2 -> convex (quadratic_form w c0 c1 c2).
Proof.
  intros P u u' l Hl. unfold quadratic_form.
  replace (along w (plus (scale l u) (scale (1 - l) u')))
    with (l * along w u + (1 - l) * along w u')
    by (unfold along, plus, scale; cbn [fst snd]; ring).
  set (d := along w u). set (d' := along w u').
  assert (0 <= c2 * (l * (1 - l) * ((d - d') * (d - d')))).
  { apply Rmult_le_pos; [lra |]. apply Rmult_le_pos; [nra | apply Rle_0_sqr]. }
  lra.
Qed.

(* Near the centre, the second-order bound. *)
Lemma covers_near z w : covers z (w, quadratic_form w (- (amplitude w * sin (angle w z)))
  (- (amplitude w * cos (angle w z))) (Rabs (amplitude w) / 2)).
Proof.
  pose proof (Rabs_pos (amplitude w)) as P. split; [apply quadratic_form_convex; lra |].
  intros r. unfold quadratic_form.
  replace (angle w (plus z r)) with (angle w z + along w r)
    by (unfold angle, along, plus; cbn [fst snd]; ring).
  set (a := angle w z). set (d := along w r). set (p := amplitude w).
  pose proof (sin_near a d) as N.
  apply Rle_trans with (- (p * (sin a + d * cos a)) + Rabs p * (d * d / 2)); [| lra].
  assert (E : - (p * (sin (a + d) - (sin a + d * cos a))) <= Rabs p * (d * d / 2)); [| lra].
  eapply Rle_trans; [apply Rle_abs |]. rewrite Rabs_Ropp, Rabs_mult.
  apply Rmult_le_compat_l; [apply Rabs_pos | exact N].
Qed.

(* Anywhere, |p|. *)
Lemma covers_crude z w : covers z (w, quadratic_form w (Rabs (amplitude w)) 0 0).
Proof.
  split; [apply quadratic_form_convex; lra |]. intros r. unfold quadratic_form.
  replace (Rabs (amplitude w) + along w r * (0 + along w r * 0)) with (Rabs (amplitude w) * 1)
    by ring.
  eapply Rle_trans; [apply Rle_abs |]. rewrite Rabs_Ropp, Rabs_mult.
  apply Rmult_le_compat_l; [apply Rabs_pos | apply Rabs_le, SIN_bound].
Qed.

(* What is above v.beta(z + r)v. *)
Definition above (wgs : list (wave * (vec -> R))) (v r : vec) : R :=
  2 * dot v v + sum (fun wg => snd wg r * (along (fst wg) v * along (fst wg) v)) wgs.

Lemma beta_above wgs z v r : Forall (covers z) wgs ->
  beta (map fst wgs) (plus z r) v <= above wgs v r.
Proof.
  intros H. unfold beta, above. unfold Rminus. rewrite <- sum_opp. apply Rplus_le_compat_l.
  induction H as [| [w g] wgs [_ C] _ IH]; simpl; [lra |]. apply Rplus_le_compat; [| exact IH].
  pose proof (C r). pose proof (Rle_0_sqr (along w v)) as S. unfold Rsqr in S. nra.
Qed.

Lemma above_convex wgs z v : Forall (covers z) wgs -> convex (above wgs v).
Proof.
  intros H u u' l Hl. unfold above.
  apply Rle_trans with (2 * dot v v +
    sum (fun wg => l * (snd wg u * (along (fst wg) v * along (fst wg) v)) +
                   (1 - l) * (snd wg u' * (along (fst wg) v * along (fst wg) v))) wgs).
  - apply Rplus_le_compat_l, sum_le. intros [w g] Hw. cbn [fst snd].
    rewrite Forall_forall in H. destruct (H _ Hw) as [C _]. specialize (C u u' l Hl).
    pose proof (Rle_0_sqr (along w v)) as S. unfold Rsqr in S. nra.
  - rewrite sum_linear. right. ring.
Qed.

(* Its matrix is 2I and these. *)
Definition entry (kk : wave -> Z) (wgs : list (wave * (vec -> R))) (r : vec) : R :=
  sum (fun wg => snd wg r * IZR (kk (fst wg))) wgs.

Definition k00 (w : wave) : Z := k0 w * k0 w.
Definition k01 (w : wave) : Z := k0 w * k1 w.
Definition k11 (w : wave) : Z := k1 w * k1 w.

Lemma above_matrix wgs v r : above wgs v r =
  (2 + entry k00 wgs r) * (fst v * fst v) + 2 * entry k01 wgs r * (fst v * snd v) +
  (2 + entry k11 wgs r) * (snd v * snd v).
Proof.
  unfold above, entry, dot. induction wgs as [| [w g] wgs IH]; simpl; [ring |].
  apply (Rplus_eq_compat_r (g r * (along w v * along w v))) in IH.
  unfold k00, k01, k11 in *. rewrite !mult_IZR. unfold along in *. lra.
Qed.

Lemma positive_matrix a b c x y : 0 <= a -> 0 <= c -> 0 <= a * c - b * b ->
  0 <= a * (x * x) - 2 * b * (x * y) + c * (y * y).
Proof.
  intros Ha Hc D. destruct (Req_dec a 0) as [-> | N].
  - assert (b = 0) by nra. subst b. nra.
  - apply Rmult_le_reg_l with a; [lra |]. rewrite Rmult_0_r.
    replace (a * (a * (x * x) - 2 * b * (x * y) + c * (y * y)))
      with (Rsqr (a * x - b * y) + (a * c - b * b) * Rsqr y) by (unfold Rsqr; ring).
    pose proof (Rle_0_sqr (a * x - b * y)). pose proof (Rle_0_sqr y). nra.
Qed.

(* ---- the parameters: functions that are affine in each of m of them and depend on no other *)

Record multiaffine (m : nat) (f : list R -> R) : Prop := Multiaffine {
  affine : forall p x r,
    f (p ++ x :: r) = f (p ++ 0 :: r) + x * (f (p ++ 1 :: r) - f (p ++ 0 :: r));
  no_more : forall t, f t = f (firstn m t);
  absent_is_zero : forall t, f t = f (t ++ [0]) }.

Definition signs (l : list bool) : list R := map (fun b : bool => if b then 1 else -1) l.

Lemma signs_repeat m : signs (repeat true m) = repeat 1 m.
Proof. induction m; simpl; [| f_equal]; trivial. Qed.

Fixpoint corners (m : nat) : list (list bool) :=
  match m with
  | O => [[]]
  | S m => map (cons true) (corners m) ++ map (cons false) (corners m)
  end.

(* Over the cube they are largest at a corner. *)
Lemma largest_at_corner m : forall f, multiaffine m f -> forall t, in_cube t ->
  exists s, In s (corners m) /\ f t <= f (signs s).
Proof.
  induction m as [| m IH]; intros f [A N Z] t Ht.
  - exists []. split; [now left |]. rewrite N. simpl. lra.
  - assert (E : exists x r, -1 <= x <= 1 /\ in_cube r /\ f t = f (x :: r)).
    { destruct t as [| x r].
      - exists 0, []. split; [lra |]. split; [constructor | apply Z].
      - inversion Ht. now exists x, r. }
    destruct E as (x & r & Hx & Hr & ->).
    assert (B : forall b : bool, exists s, In s (corners (S m)) /\
      f ((if b then 1 else -1) :: r) <= f (signs s)).
    { intros b. destruct (IH (fun u => f ((if b then 1 else -1) :: u))) with (t := r)
        as (s & Hs & L); [| exact Hr |].
      - split; intros.
        + apply (A ((if b then 1 else -1) :: p)).
        + rewrite N, (N (_ :: firstn m _)). simpl. now rewrite firstn_firstn, Nat.min_id.
        + apply (Z (_ :: _)).
      - exists (b :: s). split; [| exact L]. simpl. apply in_or_app.
        destruct b; [left | right]; now apply in_map. }
    pose proof (A [] x r) as Ax. pose proof (A [] (-1) r) as A1. simpl in Ax, A1.
    destruct (B true) as (s & Hs & Ls), (B false) as (s' & Hs' & Ls').
    destruct (Rle_dec (f (-1 :: r)) (f (1 :: r))).
    + exists s. split; [exact Hs |]. nra.
    + exists s'. split; [exact Hs' |]. nra.
Qed.

Lemma multiaffine_constant m c : multiaffine m (fun _ => c).
Proof. split; intros; ring. Qed.

Lemma multiaffine_plus m f g a : multiaffine m f -> multiaffine m g ->
  multiaffine m (fun t => f t + a * g t).
Proof.
  intros [A N Z] [A' N' Z']. split; intros.
  - rewrite (A p x r), (A' p x r). ring.
  - now rewrite N, N'.
  - now rewrite Z, Z'.
Qed.

Lemma multiaffine_ext m f g : (forall t, f t = g t) -> multiaffine m f -> multiaffine m g.
Proof.
  intros E [A N Z]. split; intros; rewrite <- !E; trivial.
Qed.

Lemma combined_multiaffine m g : (length g <= m)%nat -> multiaffine m (combined g).
Proof.
  unfold combined. intros L. split.
  - clear L. induction g as [| a g IH]; intros p x r.
    + simpl. ring.
    + destruct p as [| y p]; simpl; [ring |]. rewrite IH. ring.
  - intros t. revert g L t. induction m as [| m IH]; intros g L t.
    + now destruct g; [| inversion L].
    + destruct g as [| a g], t as [| x t]; trivial. simpl in *. f_equal. apply IH. lia.
  - clear L. induction g as [| a g IH]; intros t; trivial.
    destruct t as [| x t]; simpl; [destruct g; simpl; ring |]. now rewrite <- IH.
Qed.

(* The number of a patch's parameters. *)
Definition parameters (patch : list term) : nat :=
  fold_right (fun w => Nat.max (length (parts w))) O patch.

Lemma beta_multiaffine patch m y v : (parameters patch <= m)%nat ->
  multiaffine m (fun t => beta (waves patch t) y v).
Proof.
  intros L. unfold beta.
  apply multiaffine_ext with (f := fun t => 2 * dot v v + (-1) *
    sum (fun w => amplitude w * sin (angle w y) * (along w v * along w v)) (waves patch t)).
  { intros t. ring. }
  apply multiaffine_plus; [apply multiaffine_constant |].
  unfold waves. induction patch as [| w patch IH]; simpl in *; [apply multiaffine_constant |].
  set (u := Wave (of_k0 w) (of_k1 w) (Q2R (of_phase w) * PI) 0).
  apply multiaffine_ext with (f := fun t =>
    (sum (fun w => amplitude w * sin (angle w y) * (along w v * along w v))
       (map (fun w => Wave (of_k0 w) (of_k1 w) (Q2R (of_phase w) * PI)
                        (Q2R (middle w) + combined (parts w) t)) patch) +
     sin (angle u y) * (along u v * along u v) * combined (parts w) t) +
    Q2R (middle w) * (sin (angle u y) * (along u v * along u v))).
  { intros t. unfold u, angle, along. cbn [k0 k1 phase]. ring. }
  apply multiaffine_plus; [apply multiaffine_plus | apply multiaffine_constant].
  - apply IH. lia.
  - apply combined_multiaffine. lia.
Qed.

(* The sum of a wave's parts at a corner. *)
Fixpoint at_corner (parts : list Q) (s : list bool) : Q :=
  match parts, s with
  | g :: parts, b :: s => (if b then g else - g) + at_corner parts s
  | _, _ => 0
  end.

Lemma at_corner_combined g : forall s, Q2R (at_corner g s) = combined g (signs s).
Proof.
  unfold combined. induction g as [| a g IH]; intros s; [apply Q2R_0_1 |].
  destruct s as [| b s]; [apply Q2R_0_1 |]. simpl. rewrite Q2R_plus, IH. simpl.
  destruct b; rewrite ?Q2R_opp; ring.
Qed.

(* ---- what rational arithmetic decides *)

(* Does 0 < l < 1 and B <= l + 1/l? *)
Definition tail_ok (B l : Q) : bool :=
  negb (Qle_bool l 0) && negb (Qle_bool 1 l) && Qle_bool (B * l) (l * l + 1).

Lemma Qle_bool_false a b : negb (Qle_bool a b) = true -> Q2R b < Q2R a.
Proof.
  intros H. apply negb_true_iff in H. apply Qlt_Rlt, Qnot_le_lt. intros L.
  apply Qle_bool_iff in L. congruence.
Qed.

Theorem tail_ok_correct B l : tail_ok B l = true ->
  0 < Q2R l < 1 /\ Q2R B <= Q2R l + / Q2R l.
Proof.
  unfold tail_ok. rewrite !andb_true_iff. intros [[H0 H1] H].
  apply Qle_bool_false in H0, H1. apply Qle_bool_iff, Qle_Rle in H.
  rewrite Q2R_plus, !Q2R_mult in H. destruct Q2R_0_1 as [E0 E1]. rewrite E0, E1 in *.
  split; [lra |]. apply Rmult_le_reg_r with (Q2R l); [lra |].
  rewrite Rmult_plus_distr_r, Rinv_l by lra. exact H.
Qed.

Definition along_Q (w : term) (u : Q * Q) : Q :=
  (inject_Z (of_k0 w) * fst u + inject_Z (of_k1 w) * snd u)%Q.

Lemma Q2R_along w u : Q2R (along_Q w u) = IZR (of_k0 w) * Q2R (fst u) + IZR (of_k1 w) * Q2R (snd u).
Proof. unfold along_Q. now rewrite Q2R_plus, !Q2R_mult, !Q2R_inject_Z. Qed.

(* Are all waves' angles multiples of pi at pi z? *)
Definition integral (q : Q) : bool := Qeq_bool q (inject_Z (Qnum (Qred q))).

Lemma integral_correct q : integral q = true -> exists m : Z, Q2R q = IZR m.
Proof.
  intros H. apply Qeq_bool_iff, Qeq_eqR in H. exists (Qnum (Qred q)). rewrite H.
  unfold Q2R. simpl. field.
Qed.

Definition odd_about (patch : list term) (z : Q * Q) : bool :=
  forallb (fun w => integral (along_Q w z + of_phase w)) patch.

Theorem odd_about_correct patch z : odd_about patch z = true ->
  forall t w, In w (waves patch t) -> exists m : Z, angle w (scale PI (point z)) = IZR m * PI.
Proof.
  unfold odd_about, waves. rewrite forallb_forall. intros H t w Hw.
  apply in_map_iff in Hw. destruct Hw as (u & <- & Hu).
  destruct (integral_correct _ (H u Hu)) as [m E]. exists m. rewrite <- E.
  rewrite Q2R_plus, Q2R_along.
  unfold angle, along, scale, point. cbn [k0 k1 phase fst snd]. ring.
Qed.

(* ---- in intervals *)

Module Torus (F : FloatOps with Definition radix := Zaux.radix2
                           with Definition sensible_format := true).

Include Sine F.

(* A wave whose phase, in turns, and whose amplitude are known to lie in intervals. *)
Record iwave := IWave { wk0 : Z; wk1 : Z; wphase : I.type; wamp : I.type }.

Record matches (iw : iwave) (w : wave) : Prop := Matches {
  same_k0 : wk0 iw = k0 w;
  same_k1 : wk1 iw = k1 w;
  phase_ok : cont (wphase iw) (phase w / (2 * PI));
  amplitude_ok : cont (wamp iw) (amplitude w) }.

(* The end of an interval below, or above, a number of it; nothing is known where there is none. *)
Definition low (i : I.type) : I.type := exactly (I.lower i).
Definition high (i : I.type) : I.type := exactly (I.upper i).

Lemma cont_low i x : cont i x -> exists l, cont (low i) l /\ l <= x.
Proof.
  intros H. unfold low. destruct (F.real (I.lower i)) eqn:E.
  - exists (number (I.lower i)). split; [apply cont_exactly |].
    pose proof (I.lower_correct i (ex_intro _ x H)) as L.
    rewrite F.real_correct in E. unfold cont, number, F.toR in *.
    change (I.F.toX (I.lower i)) with (F.toX (I.lower i)) in L.
    destruct (F.toX (I.lower i)); [discriminate |].
    destruct (I.convert i); simpl in *; [discriminate |]. subst. apply H.
  - exists x. split; [| lra]. unfold exactly. rewrite E. apply cont_nai.
Qed.

Lemma cont_high i x : cont i x -> exists u, cont (high i) u /\ x <= u.
Proof.
  intros H. unfold high. destruct (F.real (I.upper i)) eqn:E.
  - exists (number (I.upper i)). split; [apply cont_exactly |].
    pose proof (I.upper_correct i (ex_intro _ x H)) as L.
    rewrite F.real_correct in E. unfold cont, number, F.toR in *.
    change (I.F.toX (I.upper i)) with (F.toX (I.upper i)) in L.
    destruct (F.toX (I.upper i)); [discriminate |].
    destruct (I.convert i); simpl in *; [discriminate |]. subst. apply H.
  - exists x. split; [| lra]. unfold exactly. rewrite E. apply cont_nai.
Qed.

Section Precision.
Variable prec : F.precision.
Variable K : constants.
Hypothesis ok : constants_ok K.

Notation "a [+] b" := (add prec a b) (at level 50, left associativity).
Notation "a [-] b" := (sub prec a b) (at level 50, left associativity).
Notation "a [*] b" := (mul prec a b) (at level 40, left associativity).

(* A wave in one cell: its k, the products of k, and the three numbers of its coefficient. *)
Record local := Local {
  lk0 : I.type; lk1 : I.type; l00 : I.type; l01 : I.type; l11 : I.type;
  constant : I.type; linear : I.type; quadratic : I.type }.

(* c0, c1: the cell's centre, in turns; h0, h1: what is added at most, in radians.  The second-order
   bound, or |p| where that seems to be less somewhere. *)
Definition localize (c0 c1 : I.type) (h0 h1 : F.type) (w : iwave) : local :=
  let i0 := integer prec (wk0 w) in
  let i1 := integer prec (wk1 w) in
  let (s, c) := sincos prec K (i0 [*] c0 [+] i1 [*] c1 [+] wphase w) in
  let p := I.abs (wamp w) in
  let a := neg (wamp w [*] s) in
  let b := neg (wamp w [*] c) in
  let h := I.upper p in
  let d := F.add_UP prec (F.mul_UP prec h0 (I.upper (I.abs i0)))
                         (F.mul_UP prec h1 (I.upper (I.abs i1))) in
  let most := F.add_UP prec (I.upper a) (F.mul_UP prec d
    (F.add_UP prec (I.upper (I.abs b)) (F.mul_UP prec d (F.div2 h)))) in
  let '(a, b, c) := match F.cmp most h with
                    | Xgt => (p, I.zero, I.zero)
                    | _ => (a, b, half prec p)
                    end in
  Local i0 i1 (integer prec (wk0 w * wk0 w)) (integer prec (wk0 w * wk1 w))
    (integer prec (wk1 w * wk1 w)) a b c.

(* What a local wave stands for. *)
Record stands_for (z : vec) (l : local) (wg : wave * (vec -> R)) : Prop := StandsFor {
  covers_ok : covers z wg;
  lk0_ok : cont (lk0 l) (IZR (k0 (fst wg)));
  lk1_ok : cont (lk1 l) (IZR (k1 (fst wg)));
  l00_ok : cont (l00 l) (IZR (k00 (fst wg)));
  l01_ok : cont (l01 l) (IZR (k01 (fst wg)));
  l11_ok : cont (l11 l) (IZR (k11 (fst wg)));
  form_ok : exists a b c, cont (constant l) a /\ cont (linear l) b /\ cont (quadratic l) c /\
    snd wg = quadratic_form (fst wg) a b c }.

Lemma localize_ok c0 c1 h0 h1 x0 x1 iw w : cont c0 x0 -> cont c1 x1 -> matches iw w ->
  exists g, stands_for (2 * PI * x0, 2 * PI * x1) (localize c0 c1 h0 h1 iw) (w, g).
Proof.
  intros H0 H1 [E0 E1 P A]. unfold localize. rewrite E0, E1.
  set (z := (2 * PI * x0, 2 * PI * x1)).
  assert (T : cont (integer prec (k0 w) [*] c0 [+] integer prec (k1 w) [*] c1 [+] wphase iw)
                (angle w z / (2 * PI))).
  { replace (angle w z / (2 * PI)) with (IZR (k0 w) * x0 + IZR (k1 w) * x1 + phase w / (2 * PI))
      by (unfold angle, along, z; cbn [fst snd]; field; apply PI_neq0).
    repeat apply cont_add; trivial; apply cont_mul; trivial; apply cont_integer. }
  pose proof (sincos_correct prec K ok _ _ T) as S.
  replace (2 * PI * (angle w z / (2 * PI))) with (angle w z) in S by (field; apply PI_neq0).
  destruct (sincos prec K _) as [s c]. destruct S as [Hs Hc]. cbn [fst snd] in Hs, Hc.
  assert (Hp := cont_abs _ _ A).
  set (crude := F.cmp _ _). set (near := (neg (wamp iw [*] s), _, half prec (I.abs (wamp iw)))).
  assert (C : exists a b c, covers z (w, quadratic_form w a b c) /\
    let '(ia, ib, ic) :=
      match crude with Xgt => (I.abs (wamp iw), I.zero, I.zero) | _ => near end in
    cont ia a /\ cont ib b /\ cont ic c).
  { assert (N : exists a b c, covers z (w, quadratic_form w a b c) /\
      let '(ia, ib, ic) := near in cont ia a /\ cont ib b /\ cont ic c).
    { do 3 eexists. split; [apply covers_near |].
      split; [now apply cont_neg, cont_mul |]. split; [now apply cont_neg, cont_mul |].
      now apply cont_half. }
    destruct crude; try exact N. do 3 eexists. split; [apply covers_crude |].
    split; [exact Hp |]. split; apply cont_zero. }
  destruct C as (a & b & q & Cov & C). exists (quadratic_form w a b q).
  destruct (match crude with Xgt => _ | _ => near end) as [[ia ib] ic].
  split; cbn [lk0 lk1 l00 l01 l11 constant linear quadratic fst snd]; trivial;
    try apply cont_integer.
  now exists a, b, q.
Qed.

(* The sums of coefficients times k0 k0, k0 k1 and k1 k1 at (r0, r1) from the centre, in radians. *)
Fixpoint entries (ls : list local) (r0 r1 : I.type) : I.type * I.type * I.type :=
  match ls with
  | [] => (I.zero, I.zero, I.zero)
  | l :: ls =>
    let '(a, b, c) := entries ls r0 r1 in
    let d := lk0 l [*] r0 [+] lk1 l [*] r1 in
    let m := constant l [+] d [*] (linear l [+] d [*] quadratic l) in
    (a [+] m [*] l00 l, b [+] m [*] l01 l, c [+] m [*] l11 l)
  end.

Lemma entries_ok z ls wgs i0 i1 r0 r1 : Forall2 (stands_for z) ls wgs ->
  cont i0 r0 -> cont i1 r1 ->
  let '(a, b, c) := entries ls i0 i1 in
  cont a (entry k00 wgs (r0, r1)) /\ cont b (entry k01 wgs (r0, r1)) /\
  cont c (entry k11 wgs (r0, r1)).
Proof.
  intros H H0 H1. induction H as [| l wg ls wgs [_ K0 K1 K00 K01 K11 Q] _ IH]; simpl.
  - repeat split; apply cont_zero.
  - destruct (entries ls i0 i1) as [[a b] c]. destruct IH as (Ha & Hb & Hc).
    destruct Q as (qa & qb & qc & Qa & Qb & Qc & E).
    unfold entry in *. simpl. rewrite E.
    set (m := quadratic_form _ _ _ _ _).
    assert (D : cont (lk0 l [*] i0 [+] lk1 l [*] i1) (along (fst wg) (r0, r1)))
      by (apply cont_add; now apply cont_mul).
    set (d := lk0 l [*] i0 [+] lk1 l [*] i1) in *.
    assert (M : cont (constant l [+] d [*] (linear l [+] d [*] quadratic l)) m).
    { apply cont_add; trivial. apply cont_mul; trivial. apply cont_add; trivial.
      now apply cont_mul. }
    rewrite !(Rplus_comm (m * _)).
    repeat split; apply cont_add; trivial; now apply cont_mul.
Qed.

(* Is B - above surely nowhere negative at this place?  D is B - 2. *)
Definition below_at (D : I.type) (ls : list local) (r0 r1 : I.type) : bool :=
  let '(a, b, c) := entries ls r0 r1 in
  let a := D [-] a in
  let c := D [-] c in
  non_negative a && non_negative c && non_negative (a [*] c [-] sqr prec b).

Lemma below_at_ok B D z ls wgs i0 i1 r0 r1 v : cont D (B - 2) ->
  Forall2 (stands_for z) ls wgs -> cont i0 r0 -> cont i1 r1 ->
  below_at D ls i0 i1 = true -> above wgs v (r0, r1) <= B * dot v v.
Proof.
  intros HD H H0 H1. unfold below_at. pose proof (entries_ok z ls wgs i0 i1 r0 r1 H H0 H1) as E.
  destruct (entries ls i0 i1) as [[a b] c]. destruct E as (Ha & Hb & Hc).
  assert (Ha' := cont_sub prec _ _ _ _ HD Ha). assert (Hc' := cont_sub prec _ _ _ _ HD Hc).
  rewrite !andb_true_iff. intros [[Na Nc] Nd].
  apply non_negative_correct with (1 := Na) in Ha' as Pa.
  apply non_negative_correct with (1 := Nc) in Hc' as Pc.
  assert (Pd := non_negative_correct _ _ Nd
    (cont_sub prec _ _ _ _ (cont_mul prec _ _ _ _ Ha' Hc') (cont_sqr prec _ _ Hb))).
  rewrite above_matrix. unfold dot.
  pose proof (positive_matrix _ _ _ (fst v) (snd v) Pa Pc Pd). lra.
Qed.

(* In the whole cell, turns i0 and i1? *)
Definition below_cell (D : I.type) (ws : list iwave) (i0 i1 : I.type) : bool :=
  let c0 := exactly (I.midpoint i0) in
  let c1 := exactly (I.midpoint i1) in
  let r0 := two_pi K [*] (i0 [-] c0) in
  let r1 := two_pi K [*] (i1 [-] c1) in
  let ls := map (localize c0 c1 (I.upper r0) (I.upper r1)) ws in
  if below_at D ls (low r0) (low r1) then
  if below_at D ls (low r0) (high r1) then
  if below_at D ls (high r0) (low r1) then below_at D ls (high r0) (high r1)
  else false else false else false.

Lemma localize_all c0 c1 h0 h1 x0 x1 ws rws : cont c0 x0 -> cont c1 x1 ->
  Forall2 matches ws rws -> exists wgs, map fst wgs = rws /\
  Forall2 (stands_for (2 * PI * x0, 2 * PI * x1)) (map (localize c0 c1 h0 h1) ws) wgs.
Proof.
  intros H0 H1 H. induction H as [| iw w ws rws M _ (wgs & <- & IH)].
  { exists []. now split; [| constructor]. }
  destruct (localize_ok c0 c1 h0 h1 x0 x1 iw w H0 H1 M) as [g G].
  exists ((w, g) :: wgs). split; [reflexivity | now constructor].
Qed.

Lemma all_cover z ls wgs : Forall2 (stands_for z) ls wgs -> Forall (covers z) wgs.
Proof. intros H. induction H as [| l wg ls wgs [C _ _ _ _ _ _] _ IH]; now constructor. Qed.

Lemma below_cell_ok B D ws rws i0 i1 x0 x1 v : cont D (B - 2) -> Forall2 matches ws rws ->
  below_cell D ws i0 i1 = true -> cont i0 x0 -> cont i1 x1 ->
  beta rws (2 * PI * x0, 2 * PI * x1) v <= B * dot v v.
Proof.
  intros HD HW. unfold below_cell. set (c0 := exactly (I.midpoint i0)).
  set (c1 := exactly (I.midpoint i1)). set (r0 := two_pi K [*] (i0 [-] c0)).
  set (r1 := two_pi K [*] (i1 [-] c1)). intros T H0 H1.
  assert (Z0 : cont c0 (number (I.midpoint i0))) by apply cont_exactly.
  assert (Z1 : cont c1 (number (I.midpoint i1))) by apply cont_exactly.
  set (z0 := number (I.midpoint i0)) in *. set (z1 := number (I.midpoint i1)) in *.
  assert (R0 : cont r0 (2 * PI * (x0 - z0))) by (apply cont_mul; [apply ok | now apply cont_sub]).
  assert (R1 : cont r1 (2 * PI * (x1 - z1))) by (apply cont_mul; [apply ok | now apply cont_sub]).
  destruct (localize_all c0 c1 (I.upper r0) (I.upper r1) z0 z1 ws rws Z0 Z1 HW) as (wgs & <- & S).
  set (ls := map _ ws) in *. set (z := (2 * PI * z0, 2 * PI * z1)) in *.
  assert (C := all_cover z ls wgs S).
  replace (2 * PI * x0, 2 * PI * x1) with (plus z (2 * PI * (x0 - z0), 2 * PI * (x1 - z1)))
    by (unfold plus, z; cbn [fst snd]; f_equal; ring).
  eapply Rle_trans; [now apply beta_above |].
  destruct (cont_low _ _ R0) as (a0 & A0 & L0), (cont_high _ _ R0) as (b0 & B0 & U0).
  destruct (cont_low _ _ R1) as (a1 & A1 & L1), (cont_high _ _ R1) as (b1 & B1 & U1).
  pose proof (fun i0 i1 r0 r1 => below_at_ok B D z ls wgs i0 i1 r0 r1 v HD S) as P.
  destruct (below_at D ls (low r0) (low r1)) eqn:Taa; [| discriminate].
  destruct (below_at D ls (low r0) (high r1)) eqn:Tab; [| discriminate].
  destruct (below_at D ls (high r0) (low r1)) eqn:Tba; [| discriminate].
  apply (convex_rectangle (above wgs v) _ a0 b0 a1 b1);
    [now apply above_convex with z | now split | now split | | | |]; eauto.
Qed.

(* How much the waves feel each angle, to choose where to cut. *)
Definition influence (k : iwave -> Z) (ws : list iwave) : F.type :=
  I.upper (fold_right (fun w i => i [+] I.abs (wamp w) [*] integer prec (Z.abs (k w))) I.zero ws).

Definition cut_first (f0 f1 : F.type) (i0 i1 : I.type) : bool :=
  match F.cmp (F.mul_UP prec f0 (F.sub_UP prec (I.upper i0) (I.lower i0)))
              (F.mul_UP prec f1 (F.sub_UP prec (I.upper i1) (I.lower i1))) with
  | Xlt => false | _ => true
  end.

Fixpoint branch (fuel : nat) (D : I.type) (ws : list iwave) (f0 f1 : F.type) (i0 i1 : I.type)
  : bool :=
  if below_cell D ws i0 i1 then true else
  match fuel with
  | O => false
  | S fuel =>
    if cut_first f0 f1 i0 i1 then
      let (j, k) := I.bisect i0 in
      if branch fuel D ws f0 f1 j i1 then branch fuel D ws f0 f1 k i1 else false
    else
      let (j, k) := I.bisect i1 in
      if branch fuel D ws f0 f1 i0 j then branch fuel D ws f0 f1 i0 k else false
  end.

Lemma branch_ok B D ws rws f0 f1 v : cont D (B - 2) -> Forall2 matches ws rws ->
  forall fuel i0 i1 x0 x1, branch fuel D ws f0 f1 i0 i1 = true -> cont i0 x0 -> cont i1 x1 ->
  beta rws (2 * PI * x0, 2 * PI * x1) v <= B * dot v v.
Proof.
  intros HD HW fuel. induction fuel as [| fuel IH]; intros i0 i1 x0 x1; simpl;
    destruct (below_cell D ws i0 i1) eqn:E; try discriminate; intros T H0 H1.
  1, 2: now apply below_cell_ok with (3 := E).
  destruct (cut_first f0 f1 i0 i1).
  - pose proof (I.bisect_correct i0 (Xreal x0) H0) as C. destruct (I.bisect i0) as [j k].
    destruct (branch fuel D ws f0 f1 j i1) eqn:J; [| discriminate].
    destruct C as [C | C]; [now apply (IH j i1) | now apply (IH k i1)].
  - pose proof (I.bisect_correct i1 (Xreal x1) H1) as C. destruct (I.bisect i1) as [j k].
    destruct (branch fuel D ws f0 f1 i0 j) eqn:J; [| discriminate].
    destruct C as [C | C]; [now apply (IH i0 j) | now apply (IH i0 k)].
Qed.

(* Cells are halved so many times at most, both ways together. *)
Definition depth : nat := 64.

Definition torus_below (ws : list iwave) (B : I.type) : bool :=
  let whole := join (integer prec 0) (integer prec 1) in
  branch depth (B [-] integer prec 2) ws (influence wk0 ws) (influence wk1 ws) whole whole.

Theorem torus_below_correct ws rws iB B : torus_below ws iB = true ->
  Forall2 matches ws rws -> cont iB B -> forall y v, beta rws y v <= B * dot v v.
Proof.
  unfold torus_below. set (whole := join _ _). intros T HW HB y v.
  destruct (fraction (fst y / (2 * PI))) as [n0 F0], (fraction (snd y / (2 * PI))) as [n1 F1].
  set (x0 := fst y / (2 * PI) - IZR n0) in *. set (x1 := snd y / (2 * PI) - IZR n1) in *.
  rewrite <- (beta_period rws y v (- n0) (- n1)).
  replace (fst y + 2 * PI * IZR (- n0)) with (2 * PI * x0)
    by (unfold x0; rewrite opp_IZR; field; apply PI_neq0).
  replace (snd y + 2 * PI * IZR (- n1)) with (2 * PI * x1)
    by (unfold x1; rewrite opp_IZR; field; apply PI_neq0).
  apply branch_ok with (2 := HW) (3 := T).
  - apply cont_sub; [exact HB | apply cont_integer].
  - now apply (cont_range _ _ 0 _ 1); try apply cont_integer.
  - now apply (cont_range _ _ 0 _ 1); try apply cont_integer.
Qed.

(* ---- at the corners of a patch *)

Definition iwave_at (s : list bool) (w : term) : iwave :=
  IWave (of_k0 w) (of_k1 w) (half prec (rational prec (of_phase w)))
    (rational prec (middle w + at_corner (parts w) s)).

Lemma iwaves_match patch s : Forall2 matches (map (iwave_at s) patch) (waves patch (signs s)).
Proof.
  unfold waves. induction patch as [| w patch IH]; constructor; [| exact IH].
  split; cbn [wk0 wk1 wphase wamp iwave_at k0 k1 phase amplitude]; trivial.
  - replace (Q2R (of_phase w) * PI / (2 * PI)) with (Q2R (of_phase w) / 2)
      by (field; apply PI_neq0).
    apply cont_half, cont_rational.
  - rewrite <- at_corner_combined, <- Q2R_plus. apply cont_rational.
Qed.

(* 4/3 v.v - (2 v.v - v.beta v), at the place pi y. *)
Definition excess (patch : list term) (y v : Q * Q) (s : list bool) : I.type :=
  fold_right (fun w i => i [-] rational prec (middle w + at_corner (parts w) s) [*]
      fst (sincos prec K (rational prec ((along_Q w y + of_phase w) / 2))) [*]
      rational prec (along_Q w v * along_Q w v))
    (rational prec ((4 # 3) * (fst v * fst v + snd v * snd v))) patch.

Lemma excess_ok patch y v s : cont (excess patch y v s)
  (beta (waves patch (signs s)) (scale PI (point y)) (point v) - 2 / 3 * dot (point v) (point v)).
Proof.
  unfold beta. set (k := fun w : wave => _).
  replace (2 * dot (point v) (point v) - sum k (waves patch (signs s)) -
      2 / 3 * dot (point v) (point v))
    with (4 / 3 * dot (point v) (point v) - sum k (waves patch (signs s))) by field.
  unfold waves, excess. induction patch as [| w patch IH]; simpl.
  - rewrite Rminus_0_r. apply cont_Q. rewrite Q2R_mult, Q2R_plus, !Q2R_mult.
    unfold dot, point, Q2R at 1. simpl. field.
  - match goal with |- cont _ (?d - (?a + ?b)) =>
      replace (d - (a + b)) with (d - b - a) by ring end.
    apply cont_sub; [exact IH |]. unfold k. cbn [amplitude].
    apply cont_mul; [apply cont_mul |].
    + rewrite <- at_corner_combined, <- Q2R_plus. apply cont_rational.
    + set (a := angle _ _).
      assert (A : cont (rational prec ((along_Q w y + of_phase w) / 2)) (a / (2 * PI))).
      { apply cont_Q. unfold Qdiv. rewrite Q2R_mult, Q2R_plus, Q2R_along.
        unfold a, angle, along, scale, point. cbn [k0 k1 phase fst snd].
        replace (Q2R (/ 2)) with (/ 2) by (unfold Q2R; simpl; field). field. apply PI_neq0. }
      apply (sincos_correct prec K ok) in A. destruct A as [A _].
      now replace (2 * PI * (a / (2 * PI))) with a in A by (field; apply PI_neq0).
    + apply cont_Q. rewrite Q2R_mult, !Q2R_along.
      unfold along, point. reflexivity.
Qed.

End Precision.

(* ---- what is checked of a patch *)

Section Patch.
Variable prec : F.precision.
Variable patch : list term.

(* v.beta v <= B v.v everywhere, for all potentials? *)
Definition patch_below (B : Q) : bool :=
  let K := make_constants prec in
  forallb (fun s => torus_below prec K (map (iwave_at prec s) patch) (rational prec B))
    (corners (parameters patch)).

Theorem patch_below_correct B : patch_below B = true ->
  forall t, in_cube t -> forall y v, beta (waves patch t) y v <= Q2R B * dot v v.
Proof.
  unfold patch_below. rewrite forallb_forall. intros H t Ht y v.
  destruct (largest_at_corner _ _ (beta_multiaffine patch _ y v (le_n _)) t Ht) as (s & Hs & L).
  eapply Rle_trans; [exact L |].
  apply (torus_below_correct prec _ (make_constants_ok prec) _ _ _ _ (H s Hs)).
  - apply iwaves_match.
  - apply cont_rational.
Qed.

(* v.beta(pi y)v < 2/3 v.v at a corner? *)
Definition at_once_at (y v : Q * Q) (s : list bool) : bool :=
  negative (excess prec (make_constants prec) patch y v s).

Lemma at_once_at_correct y v s : at_once_at y v s = true ->
  beta (waves patch (signs s)) (scale PI (point y)) (point v) < 2 / 3 * dot (point v) (point v).
Proof.
  intros H. pose proof (negative_correct _ _ H (excess_ok prec _ (make_constants_ok prec) _ _ _ _)).
  lra.
Qed.

(* For all potentials? *)
Definition at_once_ok (y v : Q * Q) : bool :=
  forallb (at_once_at y v) (corners (parameters patch)).

Theorem at_once_ok_correct y v : at_once_ok y v = true -> forall t, in_cube t ->
  beta (waves patch t) (scale PI (point y)) (point v) < 2 / 3 * dot (point v) (point v).
Proof.
  unfold at_once_ok. rewrite forallb_forall. intros H t Ht.
  destruct (largest_at_corner _ _ (beta_multiaffine patch _ (scale PI (point y)) (point v) (le_n _))
              t Ht) as (s & Hs & L).
  eapply Rle_lt_trans; [exact L |]. now apply at_once_at_correct, H.
Qed.

(* For the last one, all t = 1? *)
Definition at_once_end_ok (y v : Q * Q) : bool := at_once_at y v (repeat true (parameters patch)).

Theorem at_once_end_ok_correct y v : at_once_end_ok y v = true ->
  beta (waves patch (repeat 1 (parameters patch))) (scale PI (point y)) (point v)
    < 2 / 3 * dot (point v) (point v).
Proof.
  intros H. apply at_once_at_correct in H. now rewrite signs_repeat in H.
Qed.

End Patch.
End Torus.
