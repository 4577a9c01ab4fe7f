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

(* ---- sums *)

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

Definition coefficient (z : vec) (w : wave) (r : vec) : R :=
  - (amplitude w * sin (angle w z)) +
  along w r * (- (amplitude w * cos (angle w z)) + along w r * (Rabs (amplitude w) / 2)).

Lemma coefficient_above z w r :
  - (amplitude w * sin (angle w (plus z r))) <= coefficient z w r.
Proof.
  replace (angle w (plus z r)) with (angle w z + along w r)
    by (unfold angle, along, plus; cbn [fst snd]; ring).
  unfold coefficient. set (a := angle w z). set (d := along w r). set (p := amplitude w).
  pose proof (sin_near a d) as N.
  apply Rle_trans with (- (p * (sin a + d * cos a)) + Rabs p * (d * d / 2)); [| lra].
  assert (E : - (p * (sin (a + d) - (sin a + d * cos a))) <= Rabs p * (d * d / 2)); [| lra].
  eapply Rle_trans; [apply Rle_abs |]. rewrite Rabs_Ropp, Rabs_mult.
  apply Rmult_le_compat_l; [apply Rabs_pos | exact N].
Qed.

Lemma coefficient_convex z w : convex (coefficient z w).
Proof.
  intros u u' l Hl. unfold coefficient. pose proof (Rabs_pos (amplitude w)) as P.
  replace (along w (plus (scale l u) (scale (1 - l) u'))) with (l * along w u + (1 - l) * along w u')
    by (unfold along, plus, scale; cbn [fst snd]; ring).
  set (d := along w u). set (d' := along w u').
  assert (0 <= Rabs (amplitude w) / 2 * (l * (1 - l) * ((d - d') * (d - d')))).
  { apply Rmult_le_pos; [lra |]. apply Rmult_le_pos; [nra | apply Rle_0_sqr]. }
  lra.
Qed.

(* What is above v.beta(z + r)v. *)
Definition above (ws : list wave) (z v r : vec) : R :=
  2 * dot v v + sum (fun w => coefficient z w r * (along w v * along w v)) ws.

Lemma beta_above ws z v r : beta ws (plus z r) v <= above ws z v r.
Proof.
  unfold beta, above. unfold Rminus. rewrite <- sum_opp. apply Rplus_le_compat_l, sum_le.
  intros w _. pose proof (coefficient_above z w r).
  pose proof (Rle_0_sqr (along w v)) as S. unfold Rsqr in S. nra.
Qed.

Lemma above_convex ws z v : convex (above ws z v).
Proof.
  intros u u' l Hl. unfold above.
  apply Rle_trans with (2 * dot v v +
    sum (fun w => l * (coefficient z w u * (along w v * along w v)) +
                  (1 - l) * (coefficient z w u' * (along w v * along w v))) ws).
  - apply Rplus_le_compat_l, sum_le. intros w _.
    pose proof (coefficient_convex z w u u' l Hl).
    pose proof (Rle_0_sqr (along w v)) as S. unfold Rsqr in S. nra.
  - rewrite sum_linear. right. ring.
Qed.

(* Its matrix, (a b; b c). *)
Definition entry (ws : list wave) (z : vec) (kk : wave -> Z) (r : vec) : R :=
  sum (fun w => coefficient z w r * IZR (kk w)) ws.

Definition k00 (w : wave) : Z := k0 w * k0 w.
Definition k01 (w : wave) : Z := k0 w * k1 w.
Definition k11 (w : wave) : Z := k1 w * k1 w.

Lemma above_matrix ws z v r : above ws z v r =
  (2 + entry ws z k00 r) * (fst v * fst v) + 2 * entry ws z k01 r * (fst v * snd v) +
  (2 + entry ws z k11 r) * (snd v * snd v).
Proof.
  unfold above, entry, dot. induction ws as [| w ws IH]; simpl; [ring |].
  apply (Rplus_eq_compat_r (coefficient z w r * (along w v * along w v))) in IH.
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
  affine : forall p x r, f (p ++ x :: r) = f (p ++ 0 :: r) + x * (f (p ++ 1 :: r) - f (p ++ 0 :: r));
  no_more : forall t, f t = f (firstn m t);
  absent_is_zero : forall t, f t = f (t ++ [0]) }.

Definition signs (l : list bool) : list R := map (fun b : bool => if b then 1 else -1) l.

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

(* ---- what rational arithmetic decides *)

(* Does 0 < l < 1 and B <= l + 1/l? *)
Definition tail_ok (B l : Q) : bool :=
  negb (Qle_bool l 0) && negb (Qle_bool 1 l) && Qle_bool (B * l) (l * l + 1).

Lemma Qle_bool_false a b : negb (Qle_bool a b) = true -> Q2R b < Q2R a.
Proof.
  intros H. apply negb_true_iff in H. apply Qlt_Rlt, Qnot_le_lt. intros L.
  apply Qle_bool_iff in L. congruence.
Qed.

Lemma Q2R_0_1 : Q2R 0 = 0 /\ Q2R 1 = 1.
Proof. unfold Q2R. simpl. split; field. Qed.

Theorem tail_ok_correct B l : tail_ok B l = true ->
  0 < Q2R l < 1 /\ Q2R B <= Q2R l + / Q2R l.
Proof.
  unfold tail_ok. rewrite !andb_true_iff. intros [[H0 H1] H].
  apply Qle_bool_false in H0, H1. apply Qle_bool_iff, Qle_Rle in H.
  rewrite Q2R_plus, !Q2R_mult in H. destruct Q2R_0_1 as [E0 E1]. rewrite E0, E1 in *.
  split; [lra |]. apply Rmult_le_reg_r with (Q2R l); [lra |].
  rewrite Rmult_plus_distr_r, Rinv_l by lra. exact H.
Qed.

(* Are all waves' angles multiples of pi at pi z? *)
Definition integral (q : Q) : bool := Qeq_bool q (inject_Z (Qnum (Qred q))).

Lemma integral_correct q : integral q = true -> exists m : Z, Q2R q = IZR m.
Proof.
  intros H. apply Qeq_bool_iff, Qeq_eqR in H. exists (Qnum (Qred q)). rewrite H.
  unfold Q2R. simpl. field.
Qed.

Definition odd_about (patch : list term) (z : Q * Q) : bool :=
  forallb (fun w => integral (inject_Z (of_k0 w) * fst z + inject_Z (of_k1 w) * snd z + of_phase w))
    patch.

Lemma Q2R_inject_Z n : Q2R (inject_Z n) = IZR n.
Proof. unfold Q2R. simpl. field. Qed.

Theorem odd_about_correct patch z : odd_about patch z = true ->
  forall t w, In w (waves patch t) -> exists m : Z, angle w (scale PI (point z)) = IZR m * PI.
Proof.
  unfold odd_about, waves. rewrite forallb_forall. intros H t w Hw.
  apply in_map_iff in Hw. destruct Hw as (u & <- & Hu).
  destruct (integral_correct _ (H u Hu)) as [m E]. exists m. rewrite <- E.
  rewrite !Q2R_plus, !Q2R_mult, !Q2R_inject_Z.
  unfold angle, along, scale, point. cbn [k0 k1 phase fst snd]. ring.
Qed.
