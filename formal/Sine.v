(* Sine and cosine of an angle given in turns, both at once and fast: the point in the middle by the
   Taylor series, then what is near it to second order. *)

From Coq Require Import Reals ZArith QArith List Lra Lia Bool.
From Coquelicot Require Import Coquelicot.
From Interval.Real Require Import Xreal.
From Interval.Float Require Import Basic Sig Specific_stdz Specific_ops.
From Interval.Interval Require Import Interval Float Float_full.
From Converse Require Import Numbers.
Import ListNotations.
Open Scope R_scope.

(* ---- the series, with a last coefficient that makes them exact *)

(* n!, as an integer that computes. *)
Fixpoint factorial (n : nat) : Z :=
  match n with O => 1%Z | S k => (Z.of_nat n * factorial k)%Z end.

Lemma fact_factorial n : INR (fact n) = IZR (factorial n).
Proof.
  induction n as [| n IH]; [reflexivity |].
  change (fact (S n)) with (S n * fact n)%nat.
  change (factorial (S n)) with (Z.of_nat (S n) * factorial n)%Z.
  now rewrite mult_INR, mult_IZR, IH, INR_IZR_INZ.
Qed.

Lemma factorial_inv_pos n : 0 < / IZR (factorial n).
Proof. rewrite <- fact_factorial. apply Rinv_0_lt_compat, INR_fact_lt_0. Qed.

Lemma factorial_0_1 : IZR (factorial 0) = 1.
Proof. reflexivity. Qed.

Opaque factorial.

(* c0 - z (c1 - z (c2 - ... z last)). *)
Definition series (l : list R) (last z : R) : R := fold_right (fun c rest => c - z * rest) last l.

(* 1/s!, 1/(s+2)!, ..., n of them. *)
Definition inverses (s n : nat) : list R :=
  map (fun i => / IZR (factorial (s + 2 * i))) (seq 0 n).

Ltac spell_out := unfold inverses, series in *; 
  cbn [sum_f_R0 seq map fold_right Nat.add Nat.mul] in *.

(* A sum f that lies between two partial sums is exact with one last coefficient between theirs. *)
Lemma last_coefficient f p y c c' : 0 < y -> p + y * (c - c') <= f <= p + y * c ->
  exists e, c - c' <= e <= c /\ f = p + y * e.
Proof.
  intros Hy [L U]. exists ((f - p) / y). split.
  - split; apply Rmult_le_reg_l with y; trivial; replace (y * ((f - p) / y)) with (f - p);
      try lra; field; lra.
  - field. lra.
Qed.

Lemma smaller_power x n c : 0 < x <= 1 -> 0 < c -> 0 < x ^ n /\ x ^ (n + 2) * c <= x ^ n * c.
Proof.
  intros H Hc. assert (0 < x ^ n) by (apply pow_lt; lra). split; [trivial |].
  apply Rmult_le_compat_r; [lra |]. rewrite pow_add. rewrite <- (Rmult_1_r (x ^ n)) at 2.
  apply Rmult_le_compat_l; [lra |]. simpl. nra.
Qed.

Lemma sin_series_pos r : 0 < r <= 1 -> exists e,
  / IZR (factorial 17) - / IZR (factorial 19) <= e <= / IZR (factorial 17) /\
  sin r = r * series (inverses 1 8) e (r * r).
Proof.
  intros Hr.
  destruct (pre_sin_bound r 4 ltac:(lra) ltac:(lra)) as [L _].
  destruct (pre_sin_bound r 3 ltac:(lra) ltac:(lra)) as [_ U].
  destruct (smaller_power r 17 _ Hr (factorial_inv_pos 19)) as [P D].
  destruct (last_coefficient (sin r) (r * series (inverses 1 8) 0 (r * r)) (r ^ 17)
              (/ IZR (factorial 17)) (/ IZR (factorial 19)) P) as [e [E S]].
  { unfold sin_approx, sin_term, Rdiv in *. spell_out.
    rewrite !fact_factorial in *. split.
    - eapply Rle_trans; [| apply L]. ring_simplify. lra.
    - eapply Rle_trans; [apply U |]. right. ring. }
  exists e. split; [exact E |]. rewrite S. spell_out. ring.
Qed.

Lemma cos_series_pos r : 0 < r <= 1 -> exists e,
  / IZR (factorial 18) - / IZR (factorial 20) <= e <= / IZR (factorial 18) /\
  cos r = series (inverses 0 9) e (r * r).
Proof.
  intros Hr.
  destruct (pre_cos_bound r 4 ltac:(lra) ltac:(lra)) as [L U].
  destruct (smaller_power r 18 _ Hr (factorial_inv_pos 20)) as [P D].
  destruct (last_coefficient (- cos r) (- series (inverses 0 9) 0 (r * r)) (r ^ 18)
              (/ IZR (factorial 18)) (/ IZR (factorial 20)) P) as [e [E S]].
  { unfold cos_approx, cos_term, Rdiv in *. spell_out.
    rewrite !fact_factorial in *. apply Ropp_le_contravar in L, U. split.
    - eapply Rle_trans; [| apply U]. ring_simplify. lra.
    - eapply Rle_trans; [apply L |]. right. ring. }
  exists e. split; [exact E |]. rewrite <- (Ropp_involutive (cos r)), S. spell_out. ring.
Qed.

Lemma inverse_in_range n :
  / IZR (factorial n) - / IZR (factorial (n + 2)) <= / IZR (factorial n) <= / IZR (factorial n).
Proof. pose proof (factorial_inv_pos (n + 2)). lra. Qed.

Lemma sin_series r : -1 <= r <= 1 -> exists e,
  / IZR (factorial 17) - / IZR (factorial 19) <= e <= / IZR (factorial 17) /\
  sin r = r * series (inverses 1 8) e (r * r).
Proof.
  intros Hr. destruct (Rtotal_order r 0) as [N | [-> | P]].
  - destruct (sin_series_pos (- r) ltac:(lra)) as [e [E S]]. exists e. split; [exact E |].
    rewrite <- (Ropp_involutive r) at 1. rewrite sin_neg, S.
    replace (- r * - r) with (r * r) by ring. ring.
  - exists (/ IZR (factorial 17)). split; [exact (inverse_in_range 17) |]. rewrite sin_0. ring.
  - apply sin_series_pos. lra.
Qed.

Lemma cos_series r : -1 <= r <= 1 -> exists e,
  / IZR (factorial 18) - / IZR (factorial 20) <= e <= / IZR (factorial 18) /\
  cos r = series (inverses 0 9) e (r * r).
Proof.
  intros Hr. destruct (Rtotal_order r 0) as [N | [-> | P]].
  - destruct (cos_series_pos (- r) ltac:(lra)) as [e [E S]]. exists e. split; [exact E |].
    rewrite <- cos_neg, S. now replace (- r * - r) with (r * r) by ring.
  - exists (/ IZR (factorial 18)). split; [exact (inverse_in_range 18) |].
    rewrite cos_0. spell_out. rewrite factorial_0_1, Rinv_1. ring.
  - apply cos_series_pos. lra.
Qed.

(* ---- pi to eighteen digits; the library's own, in doubles, has fourteen *)

Module Wide := SpecificFloat StdZRadix2.
Module WideI := FloatIntervalFull Wide.

Lemma pi_bounds : 3141592653589793238 / 1000000000000000000 <= PI <=
                  3141592653589793239 / 1000000000000000000.
Proof.
  pose proof (WideI.pi_correct (Wide.PtoP 80)) as H.
  set (i := WideI.pi _) in H. vm_compute in i. subst i. simpl in H.
  unfold StdZRadix2.MtoP in H. change (Z.pow_pos 2 78) with 302231454903657293676544%Z in H. lra.
Qed.

(* ---- sine and cosine near a point, to second order *)

Lemma cos_lipschitz a c : 0 < c -> Rabs (cos (a + c) - cos a) <= c.
Proof.
  intros Hc.
  destruct (MVT_cor2 (fun t => cos (a + t)) (fun t => - sin (a + t)) 0 c Hc) as [t [E _]].
  - intros t _. apply is_derive_Reals. auto_derive; trivial. ring.
  - rewrite Rplus_0_r, Rminus_0_r in E. rewrite E.
    pose proof (SIN_bound (a + t)). apply Rabs_le. nra.
Qed.

Lemma sin_near_pos s a d : s = 1 \/ s = -1 -> 0 < d ->
  s * (sin (a + d) - sin a - d * cos a) <= d * d / 2.
Proof.
  intros Hs Hd.
  destruct (MVT_cor2 (fun t => t * t / 2 - s * (sin (a + t) - sin a - t * cos a))
              (fun t => t - s * (cos (a + t) - cos a)) 0 d Hd) as [t [E Ht]].
  - intros t _. apply is_derive_Reals. auto_derive; trivial. field.
  - rewrite Rplus_0_r, Rminus_0_r in E.
    pose proof (cos_lipschitz a t (proj1 Ht)) as L. apply Rabs_le_between in L.
    assert (0 <= t - s * (cos (a + t) - cos a)) by (destruct Hs; subst s; lra). nra.
Qed.

Lemma sin_near a d : Rabs (sin (a + d) - (sin a + d * cos a)) <= d * d / 2.
Proof.
  assert (P : forall a d, 0 < d -> Rabs (sin (a + d) - (sin a + d * cos a)) <= d * d / 2).
  { intros b e He. pose proof (sin_near_pos 1 b e (or_introl eq_refl) He).
    pose proof (sin_near_pos (-1) b e (or_intror eq_refl) He). apply Rabs_le. lra. }
  destruct (Rtotal_order d 0) as [N | [-> | Q]]; [| | now apply P].
  - specialize (P (- a) (- d) ltac:(lra)).
    replace (- a + - d) with (- (a + d)) in P by ring. rewrite !sin_neg, cos_neg in P.
    rewrite <- Rabs_Ropp. replace (d * d) with (- d * - d) by ring.
    now replace (- (sin (a + d) - (sin a + d * cos a)))
      with (- sin (a + d) - (- sin a + - d * cos a)) by ring.
  - rewrite Rplus_0_r, Rmult_0_l, Rplus_0_r, Rminus_diag_eq, Rabs_R0 by reflexivity. lra.
Qed.

Lemma cos_near a d : Rabs (cos (a + d) - (cos a - d * sin a)) <= d * d / 2.
Proof.
  pose proof (sin_near (PI / 2 + a) d) as H.
  rewrite Rplus_assoc, <- !cos_sin in H. rewrite (cos_sin (PI / 2 + a)) in H.
  replace (PI / 2 + (PI / 2 + a)) with (a + PI) in H by field. rewrite neg_sin in H.
  now replace (cos a - d * sin a) with (cos a + d * - sin a) by ring.
Qed.

(* What is at most d^2/2 is some h of [-1/2, 1/2] times d^2. *)
Lemma as_multiple u d : Rabs u <= d * d / 2 -> exists h, - / 2 <= h <= / 2 /\ u = h * (d * d).
Proof.
  intros H. apply Rabs_le_between in H. destruct (Req_dec d 0) as [-> | D].
  - exists 0. lra.
  - assert (0 < d * d) by nra. exists (u / (d * d)). split; [| field; lra].
    split; apply Rmult_le_reg_l with (d * d); trivial;
      replace (d * d * (u / (d * d))) with u by (field; lra); lra.
Qed.

(* ---- whole turns and quarters *)

Lemma sin_turns x (n : Z) : sin (2 * PI * (x + IZR n)) = sin (2 * PI * x).
Proof.
  assert (P : forall y k, sin (2 * PI * (y + INR k)) = sin (2 * PI * y)).
  { intros y k. rewrite <- (sin_period (2 * PI * y) k). f_equal. ring. }
  destruct (Z_le_gt_dec 0 n) as [H | H].
  - rewrite <- (Z2Nat.id n H), <- INR_IZR_INZ. apply P.
  - rewrite <- (P (x + IZR n) (Z.to_nat (- n))), INR_IZR_INZ, Z2Nat.id, opp_IZR by lia.
    f_equal. ring.
Qed.

Lemma cos_turns x (n : Z) : cos (2 * PI * (x + IZR n)) = cos (2 * PI * x).
Proof.
  assert (Q : forall y, cos (2 * PI * y) = sin (2 * PI * (y + / 4))).
  { intros y. rewrite cos_sin. f_equal. field. }
  rewrite !Q, <- (sin_turns (x + / 4) n). f_equal. ring.
Qed.

Inductive quarter := Zero | One | Two | Three.

Definition turns_of (q : quarter) : R :=
  match q with Zero => 0 | One => / 4 | Two => / 2 | Three => - / 4 end.

(* From the sine and cosine of x to those of a number of quarters more. *)
Definition rotate {A : Type} (opp : A -> A) (q : quarter) (sc : A * A) : A * A :=
  let (s, c) := sc in
  match q with
  | Zero => (s, c) | One => (c, opp s) | Two => (opp s, opp c) | Three => (opp c, s)
  end.

Lemma rotate_turns x q (n : Z) :
  rotate Ropp q (sin (2 * PI * x), cos (2 * PI * x)) =
  (sin (2 * PI * (x + turns_of q + IZR n)), cos (2 * PI * (x + turns_of q + IZR n))).
Proof.
  rewrite sin_turns, cos_turns. destruct q; simpl.
  - now rewrite Rplus_0_r.
  - replace (2 * PI * (x + / 4)) with (PI / 2 + 2 * PI * x) by field.
    now rewrite <- cos_sin, sin_cos, Ropp_involutive.
  - replace (2 * PI * (x + / 2)) with (2 * PI * x + PI) by field.
    now rewrite neg_sin, neg_cos.
  - replace (2 * PI * (x + - / 4)) with (- (PI / 2 - 2 * PI * x)) by field.
    now rewrite sin_neg, cos_neg, sin_shift, cos_shift.
Qed.

(* ---- in intervals *)

Module Sine (F : FloatOps with Definition radix := Zaux.radix2
                          with Definition sensible_format := true).

Include Numbers F.

(* What is computed once for each precision. *)
Record constants := Constants {
  two_pi : I.type;
  one : I.type;
  from_minus_1_to_1 : I.type;
  from_minus_half_to_half : I.type;
  sine_coefficients : list I.type;
  sine_last : I.type;
  cosine_coefficients : list I.type;
  cosine_last : I.type;
  whole_turns : list (F.type * I.type);  (* 64, 32, ..., 1, with what must be passed for each *)
  one_quarter : I.type;
  one_half : I.type;
  eighth : F.type;                       (* three floats that need not be exact *)
  three_eighths : F.type;
  four_eighths : F.type }.

Record constants_ok (K : constants) : Prop := ConstantsOk {
  two_pi_ok : cont (two_pi K) (2 * PI);
  one_ok : cont (one K) 1;
  unit_ok : forall x, -1 <= x <= 1 -> cont (from_minus_1_to_1 K) x;
  half_unit_ok : forall x, - / 2 <= x <= / 2 -> cont (from_minus_half_to_half K) x;
  sine_ok : Forall2 cont (sine_coefficients K) (inverses 1 8);
  sine_last_ok : forall e,
    / IZR (factorial 17) - / IZR (factorial 19) <= e <= / IZR (factorial 17) ->
    cont (sine_last K) e;
  cosine_ok : Forall2 cont (cosine_coefficients K) (inverses 0 9);
  cosine_last_ok : forall e,
    / IZR (factorial 18) - / IZR (factorial 20) <= e <= / IZR (factorial 18) ->
    cont (cosine_last K) e;
  whole_turns_ok : List.Forall (fun hn => exists n : Z, cont (snd hn) (IZR n)) (whole_turns K);
  one_quarter_ok : cont (one_quarter K) (/ 4);
  one_half_ok : cont (one_half K) (/ 2) }.

Section Precision.
Variable prec : F.precision.

(* The better of two for each precision. *)
Definition sharp_pi : I.type :=
  I.meet (pi prec) (join (rational prec (3141592653589793238 # 1000000000000000000))
                         (rational prec (3141592653589793239 # 1000000000000000000))).

Definition inverse (n : nat) : I.type :=
  if (factorial n =? 1)%Z then integer prec 1
  else div prec (integer prec 1) (integer prec (factorial n)).
Definition last_inverse (n : nat) : I.type :=
  join (sub prec (inverse n) (inverse (n + 2))) (inverse n).
Definition power_of_2 (k : Z) : F.type * I.type :=
  (I.upper (half prec (integer prec (2 ^ k))), integer prec (2 ^ k)).
Definition eighths (n : Z) : F.type := I.upper (rational prec (n # 8)).

Definition make_constants : constants := Constants
  (mul prec (integer prec 2) sharp_pi)
  (integer prec 1)
  (unit_ prec)
  (join (rational prec (-1 # 2)) (rational prec (1 # 2)))
  (map (fun i => inverse (1 + 2 * i)) (seq 0 8)) (last_inverse 17)
  (map (fun i => inverse (0 + 2 * i)) (seq 0 9)) (last_inverse 18)
  (map power_of_2 [6; 5; 4; 3; 2; 1; 0]%Z)
  (rational prec (1 # 4)) (rational prec (1 # 2))
  (eighths 1) (eighths 3) (eighths 4).

Lemma sharp_pi_ok : cont sharp_pi PI.
Proof.
  apply I.meet_correct; [apply cont_pi |].
  eapply cont_range; [apply cont_rational | apply cont_rational | exact pi_bounds].
Qed.

Lemma inverse_ok n : cont (inverse n) (/ IZR (factorial n)).
Proof.
  unfold inverse. destruct (Z.eqb_spec (factorial n) 1) as [-> |].
  { rewrite Rinv_1. apply cont_integer. }
  replace (/ IZR (factorial n)) with (1 / IZR (factorial n)) by (unfold Rdiv; ring).
  apply cont_div; try apply cont_integer. intros E.
  pose proof (factorial_inv_pos n) as H. rewrite E, Rinv_0 in H. lra.
Qed.

Lemma inverses_ok s n :
  Forall2 cont (map (fun i => inverse (s + 2 * i)) (seq 0 n)) (inverses s n).
Proof.
  unfold inverses. induction (seq 0 n) as [| i l IH]; constructor; [apply inverse_ok | exact IH].
Qed.

Lemma last_inverse_ok n e :
  / IZR (factorial n) - / IZR (factorial (n + 2)) <= e <= / IZR (factorial n) ->
  cont (last_inverse n) e.
Proof. apply cont_range; [apply cont_sub |]; apply inverse_ok. Qed.

Lemma cont_Q q x : Q2R q = x -> cont (rational prec q) x.
Proof. intros <-. apply cont_rational. Qed.

Lemma make_constants_ok : constants_ok make_constants.
Proof.
  constructor; unfold make_constants; cbn [two_pi one from_minus_1_to_1 from_minus_half_to_half
    sine_coefficients sine_last cosine_coefficients cosine_last whole_turns one_quarter one_half].
  - apply cont_mul; [apply cont_integer | apply sharp_pi_ok].
  - apply cont_integer.
  - intros x. apply cont_range; apply cont_integer.
  - intros x. apply cont_range; apply cont_Q; unfold Q2R; simpl; field.
  - apply inverses_ok.
  - intros e. apply last_inverse_ok.
  - apply inverses_ok.
  - intros e. apply last_inverse_ok.
  - apply Forall_map, List.Forall_forall. intros k _. exists (2 ^ k)%Z. apply cont_integer.
  - apply cont_Q. unfold Q2R; simpl; field.
  - apply cont_Q. unfold Q2R; simpl; field.
Qed.

Variable K : constants.
Hypothesis ok : constants_ok K.

Definition evaluate (l : list I.type) (last z : I.type) : I.type :=
  fold_right (fun c rest => sub prec c (mul prec z rest)) last l.

Lemma evaluate_ok l rs last e z x :
  Forall2 cont l rs -> cont last e -> cont z x -> cont (evaluate l last z) (series rs e x).
Proof.
  intros H Hl Hz. induction H; [exact Hl |]. apply cont_sub; [assumption |].
  now apply cont_mul.
Qed.

(* So many whole turns less or more, or none; which, is for nobody to prove. *)
Definition turn (t : I.type) (hn : F.type * I.type) : I.type :=
  let m := I.lower t in
  match F.cmp (F.abs m) (fst hn), F.cmp m F.zero with
  | Xgt, Xgt => sub prec t (snd hn)
  | Xgt, _ => add prec t (snd hn)
  | _, _ => t
  end.

Definition turn_back (t : I.type) : I.type := fold_left turn (whole_turns K) t.

Lemma turn_ok t x hn (k : Z) : cont t x -> cont (snd hn) (IZR k) ->
  exists n : Z, cont (turn t hn) (x - IZR n).
Proof.
  intros H Hk. unfold turn.
  assert (A : exists n : Z, cont (add prec t (snd hn)) (x - IZR n)).
  { exists (- k)%Z. rewrite opp_IZR. unfold Rminus. rewrite Ropp_involutive. now apply cont_add. }
  assert (S : exists n : Z, cont (sub prec t (snd hn)) (x - IZR n)).
  { exists k. now apply cont_sub. }
  assert (N : exists n : Z, cont t (x - IZR n)) by (exists 0%Z; now rewrite Rminus_0_r).
  destruct (F.cmp (F.abs _) _); trivial. destruct (F.cmp _ F.zero); trivial.
Qed.

Lemma turn_back_ok t x : cont t x -> exists n : Z, cont (turn_back t) (x - IZR n).
Proof.
  unfold turn_back. revert t x. induction (whole_turns_ok K ok) as [| hn l [k Hk] _ IH].
  - intros t x H. exists 0%Z. now rewrite Rminus_0_r.
  - intros t x H. destruct (turn_ok t x hn k H Hk) as [n Hn], (IH _ _ Hn) as [n' Hn'].
    exists (n + n')%Z. rewrite plus_IZR. 
    now replace (x - (IZR n + IZR n')) with (x - IZR n - IZR n') by ring.
Qed.

(* Nearer than an eighth to zero, with the quarters that were taken away. *)
Definition reduce (t : I.type) : I.type * quarter :=
  let t := match F.cmp (F.abs (I.lower t)) (four_eighths K) with Xgt => turn_back t | _ => t end in
  let m := I.lower t in
  match F.cmp (F.abs m) (eighth K) with
  | Xgt =>
    match F.cmp (F.abs m) (three_eighths K), F.cmp m F.zero with
    | Xgt, Xgt => (sub prec t (one_half K), Two)
    | Xgt, _ => (add prec t (one_half K), Two)
    | _, Xgt => (sub prec t (one_quarter K), One)
    | _, _ => (add prec t (one_quarter K), Three)
    end
  | _ => (t, Zero)
  end.

Lemma reduce_ok t x : cont t x ->
  exists r (n : Z), cont (fst (reduce t)) r /\ x = r + turns_of (snd (reduce t)) + IZR n.
Proof.
  intros H. unfold reduce.
  assert (T : exists n : Z, cont match F.cmp (F.abs (I.lower t)) (four_eighths K) with
                                 | Xgt => turn_back t | _ => t end (x - IZR n)).
  { destruct (F.cmp _ _); try now apply turn_back_ok; trivial.
    all: exists 0%Z; now rewrite Rminus_0_r. }
  destruct T as [n T]. revert T. generalize (match F.cmp (F.abs (I.lower t)) (four_eighths K) with
                                 | Xgt => turn_back t | _ => t end). intros t' T.
  assert (H0 : exists r (n : Z), cont t' r /\ x = r + 0 + IZR n).
  { exists (x - IZR n), n. split; [exact T | ring]. }
  assert (H1 : exists r (n : Z), cont (sub prec t' (one_quarter K)) r /\ x = r + / 4 + IZR n).
  { exists (x - IZR n - / 4), n. split; [| ring]. apply cont_sub, one_quarter_ok; assumption. }
  assert (H2 : exists r (n : Z), cont (sub prec t' (one_half K)) r /\ x = r + / 2 + IZR n).
  { exists (x - IZR n - / 2), n. split; [| ring]. apply cont_sub, one_half_ok; assumption. }
  assert (H2' : exists r (n : Z), cont (add prec t' (one_half K)) r /\ x = r + / 2 + IZR n).
  { exists (x - IZR n + / 2), (n - 1)%Z. split; [apply cont_add, one_half_ok; assumption |].
    rewrite minus_IZR. field. }
  assert (H3 : exists r (n : Z), cont (add prec t' (one_quarter K)) r /\ x = r + - / 4 + IZR n).
  { exists (x - IZR n + / 4), n. split; [| ring]. apply cont_add, one_quarter_ok; assumption. }
  destruct (F.cmp (F.abs _) (eighth K)); trivial.
  destruct (F.cmp (F.abs _) (three_eighths K)), (F.cmp _ F.zero); trivial.
Qed.

(* Of a point, in turns, or nearly one; nothing where it is not near enough to zero. *)
Definition sincos_point (t : I.type) : option (I.type * I.type) :=
  let (t, q) := reduce t in
  let r := mul prec (two_pi K) t in
  let z := sqr prec r in
  if non_negative (sub prec (one K) z) then
    Some (rotate neg q (mul prec r (evaluate (sine_coefficients K) (sine_last K) z),
                        evaluate (cosine_coefficients K) (cosine_last K) z))
  else None.

Definition both (sc : I.type * I.type) (p : R * R) : Prop :=
  cont (fst sc) (fst p) /\ cont (snd sc) (snd p).

Lemma both_rotate q sc p : both sc p -> both (rotate neg q sc) (rotate Ropp q p).
Proof.
  destruct sc, p, q; intros [Hs Hc]; split; simpl in *; trivial; now apply cont_neg.
Qed.

Lemma sincos_point_ok t x : cont t x ->
  match sincos_point t with
  | Some sc => both sc (sin (2 * PI * x), cos (2 * PI * x))
  | None => True
  end.
Proof.
  intros H. unfold sincos_point. destruct (reduce_ok t x H) as (r & n & Hr & ->).
  destruct (reduce t) as [t' q]. cbn [fst snd] in *.
  destruct (non_negative _) eqn:N; [| exact I].
  rewrite <- rotate_turns. apply both_rotate.
  set (a := 2 * PI * r).
  assert (Ha : cont (mul prec (two_pi K) t') a) by (apply cont_mul; [apply ok | exact Hr]).
  assert (Hz := cont_sqr prec _ _ Ha).
  assert (B : 0 <= 1 - a * a).
  { apply (non_negative_correct _ _ N), cont_sub; [apply ok | exact Hz]. }
  assert (U : -1 <= a <= 1) by nra.
  destruct (sin_series a U) as (e & He & ->), (cos_series a U) as (e' & He' & ->).
  split; cbn [fst snd].
  - apply cont_mul; [exact Ha |]. apply evaluate_ok; [| | exact Hz]; now apply ok.
  - apply evaluate_ok; [| | exact Hz]; now apply ok.
Qed.

(* The sine and cosine of an angle of tau turns. *)
Definition sincos (tau : I.type) : I.type * I.type :=
  let point := exactly (I.midpoint tau) in
  let d := mul prec (two_pi K) (sub prec tau point) in
  let dd := sqr prec d in
  match sincos_point point, non_negative (sub prec (one K) dd) with
  | Some (s, c), true =>
    let e := mul prec (from_minus_half_to_half K) dd in
    (add prec s (add prec e (mul prec d c)), add prec c (sub prec e (mul prec d s)))
  | _, _ => (from_minus_1_to_1 K, from_minus_1_to_1 K)
  end.

Lemma sincos_correct tau x : cont tau x ->
  cont (fst (sincos tau)) (sin (2 * PI * x)) /\ cont (snd (sincos tau)) (cos (2 * PI * x)).
Proof.
  intros H. unfold sincos.
  assert (W : cont (from_minus_1_to_1 K) (sin (2 * PI * x)) /\
              cont (from_minus_1_to_1 K) (cos (2 * PI * x))).
  { split; apply ok; [apply SIN_bound | apply COS_bound]. }
  set (point := exactly _). set (m := number (I.midpoint tau)).
  assert (Hm : cont point m) by apply cont_exactly.
  assert (Hd : cont (mul prec (two_pi K) (sub prec tau point)) (2 * PI * (x - m))).
  { apply cont_mul; [apply ok | now apply cont_sub]. }
  pose proof (sincos_point_ok point m Hm) as P.
  destruct (sincos_point point) as [[s c] |]; [| exact W].
  destruct (non_negative _); [| exact W].
  destruct P as [Hs Hc]. cbn [fst snd] in *. clear W.
  set (a := 2 * PI * m) in *. set (d := 2 * PI * (x - m)) in *.
  replace (2 * PI * x) with (a + d) by (unfold a, d; ring).
  assert (Hdd := cont_sqr prec _ _ Hd). split.
  - destruct (as_multiple _ _ (sin_near a d)) as (h & Hh & E).
    replace (sin (a + d)) with (sin a + (h * (d * d) + d * cos a)) by (rewrite <- E; ring).
    apply cont_add; [exact Hs |].
    apply cont_add; apply cont_mul; trivial. now apply ok.
  - destruct (as_multiple _ _ (cos_near a d)) as (h & Hh & E).
    replace (cos (a + d)) with (cos a + (h * (d * d) - d * sin a)) by (rewrite <- E; ring).
    apply cont_add; [exact Hc |].
    apply cont_sub; apply cont_mul; trivial. now apply ok.
Qed.

End Precision.
End Sine.
