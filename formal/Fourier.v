(* Trigonometric polynomials and their norms.  A polynomial is a list of modes a cos(k t + p), where
   the same k may occur several times; its size, with the weight r > 1, is the sum of all |a| r^|k|.
   A function is `bounded` by M if it is a polynomial of size at most M.  Sums, products and
   translations are bounded as in a Banach algebra (docs/proofs/existence.md, section 2), and the two
   operators that lose a part d of r, the derivative and division by small divisors, as well.

   There are no limits in this file, and no infinite sums.  That a function is bounded is a pair of the
   polynomial and a proof, so that a sequence of functions may be chosen without an axiom of choice. *)

From Coq Require Import Reals ZArith List Lra Lia Psatz.
From Coquelicot Require Import Coquelicot.
Import ListNotations.
Open Scope R_scope.

Record mode := Mode { number : Z; height : R; shift : R }.

Definition value (m : mode) (t : R) : R := height m * cos (IZR (number m) * t + shift m).
Definition weight (r : R) (k : Z) : R := r ^ Z.abs_nat k.

Fixpoint eval (p : list mode) (t : R) : R :=
  match p with [] => 0 | m :: p => value m t + eval p t end.
Fixpoint size (r : R) (p : list mode) : R :=
  match p with [] => 0 | m :: p => Rabs (height m) * weight r (number m) + size r p end.

Definition bounded (r M : R) (f : R -> R) : Type :=
  {p : list mode | (forall t, f t = eval p t) /\ size r p <= M}.

(* ---- sums, products, translations *)

Lemma weight_1 r k : 1 <= r -> 1 <= weight r k.
Proof. intros H. now apply pow_R1_Rle. Qed.

Lemma weight_product r k l : 1 <= r -> weight r (k + l) <= weight r k * weight r l.
Proof. intros H. unfold weight. rewrite <- pow_add. apply Rle_pow; [exact H | lia]. Qed.

Lemma size_0 r p : 1 <= r -> 0 <= size r p.
Proof.
  intros Hr. induction p as [| m p IH]; simpl; [lra |].
  pose proof (Rabs_pos (height m)). pose proof (weight_1 r (number m) Hr). nra.
Qed.

Lemma bounded_0 {r M f} : 1 <= r -> bounded r M f -> 0 <= M.
Proof. intros Hr (p & _ & S). pose proof (size_0 r p Hr). lra. Qed.

Lemma bounded_ext {r M N f g} : bounded r M f -> (forall t, g t = f t) -> M <= N -> bounded r N g.
Proof. intros (p & E & S) H L. exists p. split; [intros t; now rewrite H | lra]. Qed.

Lemma bounded_everywhere {r M f} t : 1 <= r -> bounded r M f -> Rabs (f t) <= M.
Proof.
  intros Hr (p & E & S). rewrite E. apply Rle_trans with (size r p); [| exact S]. clear E S.
  induction p as [| m p IH]; simpl; [rewrite Rabs_R0; lra |].
  eapply Rle_trans; [apply Rabs_triang |]. apply Rplus_le_compat; [| exact IH].
  unfold value. rewrite Rabs_mult. apply Rmult_le_compat_l; [apply Rabs_pos |].
  apply Rle_trans with 1; [apply Rabs_le, COS_bound | now apply weight_1].
Qed.

Lemma bounded_periodic {r M f} t : bounded r M f -> f (t + 2 * PI) = f t.
Proof.
  intros (p & E & _). rewrite !E. clear E. induction p as [| m p IH]; simpl; [reflexivity |]. rewrite IH.
  f_equal. unfold value. f_equal.
  replace (IZR (number m) * (t + 2 * PI) + shift m)
    with (IZR (number m) * t + shift m + 2 * IZR (number m) * PI) by ring.
  generalize (IZR (number m) * t + shift m). intros x. destruct (Z_le_gt_dec 0 (number m)) as [H | H].
  - rewrite <- (Z2Nat.id (number m)), <- INR_IZR_INZ by exact H. apply cos_period.
  - rewrite <- (cos_period (x + _) (Z.to_nat (- number m))), INR_IZR_INZ, Z2Nat.id, opp_IZR by lia.
    f_equal. ring.
Qed.

Lemma bounded_less r s {M f} : 0 <= s <= r -> bounded r M f -> bounded s M f.
Proof.
  intros H (p & E & S). exists p. split; [exact E |]. apply Rle_trans with (size r p); [| exact S].
  clear E S. induction p as [| m p IH]; simpl; [lra |]. apply Rplus_le_compat; [| exact IH].
  apply Rmult_le_compat_l; [apply Rabs_pos | now apply pow_incr].
Qed.

Lemma bounded_plus {r M N f g} : bounded r M f -> bounded r N g -> bounded r (M + N) (fun t => f t + g t).
Proof.
  intros (p & E & S) (q & E' & S'). exists (p ++ q). split.
  - intros t. rewrite E, E'. clear. induction p as [| m p IH]; simpl; [ring |]. rewrite <- IH. ring.
  - apply Rle_trans with (size r p + size r q); [| lra]. apply Req_le. clear.
    induction p as [| m p IH]; simpl; [ring |]. rewrite IH. ring.
Qed.


Lemma size_map r s c (h : mode -> mode) p :
  (forall m, Rabs (height (h m)) * weight s (number (h m))
             <= c * (Rabs (height m) * weight r (number m))) ->
  size s (map h p) <= c * size r p.
Proof. intros H. induction p as [| m p IH]; simpl; [lra |]. specialize (H m). lra. Qed.

Lemma bounded_scal {r M} c {f} : bounded r M f -> bounded r (Rabs c * M) (fun t => c * f t).
Proof.
  intros (p & E & S). exists (map (fun m => Mode (number m) (c * height m) (shift m)) p). split.
  - intros t. rewrite E. clear. induction p as [| m p IH]; simpl; [ring |]. rewrite <- IH.
    unfold value. simpl. ring.
  - apply Rle_trans with (Rabs c * size r p); [| apply Rmult_le_compat_l; [apply Rabs_pos | exact S]].
    apply size_map. intros m. simpl. rewrite Rabs_mult. lra.
Qed.

Lemma bounded_opp {r M f} : bounded r M f -> bounded r M (fun t => - f t).
Proof.
  intros H. apply (bounded_ext (bounded_scal (-1) H)); [intros t; ring |].
  rewrite Rabs_left by lra. lra.
Qed.

Lemma bounded_minus {r M N f g} : bounded r M f -> bounded r N g -> bounded r (M + N) (fun t => f t - g t).
Proof. intros F G. exact (bounded_plus F (bounded_opp G)). Qed.

Lemma bounded_moved {r M} w {f} : bounded r M f -> bounded r M (fun t => f (t + w)).
Proof.
  intros (p & E & S).
  exists (map (fun m => Mode (number m) (height m) (IZR (number m) * w + shift m)) p). split.
  - intros t. rewrite E. clear. induction p as [| m p IH]; simpl; [ring |]. rewrite <- IH.
    unfold value. simpl.
    replace (IZR (number m) * (t + w) + shift m)
      with (IZR (number m) * t + (IZR (number m) * w + shift m)) by ring.
    reflexivity.
  - apply Rle_trans with (1 * size r p); [| lra]. apply size_map. intros m. simpl. lra.
Qed.

Lemma bounded_reflected {r M f} : bounded r M f -> bounded r M (fun t => f (- t)).
Proof.
  intros (p & E & S). exists (map (fun m => Mode (number m) (height m) (- shift m)) p). split.
  - intros t. rewrite E. clear. induction p as [| m p IH]; simpl; [ring |]. rewrite <- IH.
    unfold value. simpl. rewrite <- (cos_neg (IZR (number m) * t + - shift m)).
    replace (- (IZR (number m) * t + - shift m)) with (IZR (number m) * - t + shift m) by ring. reflexivity.
  - apply Rle_trans with (1 * size r p); [| lra]. apply size_map. intros m. simpl. lra.
Qed.

Lemma bounded_mode r k a b : bounded r (Rabs a * weight r k) (fun t => a * cos (IZR k * t + b)).
Proof. exists [Mode k a b]. split; [intros t; unfold eval, value; simpl; ring | simpl; lra]. Qed.

Lemma bounded_const r c : bounded r (Rabs c) (fun _ => c).
Proof.
  apply (bounded_ext (bounded_mode r 0 c 0)); [intros t | unfold weight; simpl; lra].
  rewrite Rmult_0_l, Rplus_0_l, cos_0. ring.
Qed.

Lemma bounded_cos r k : bounded r (weight r k) (fun t => cos (IZR k * t)).
Proof.
  apply (bounded_ext (bounded_mode r k 1 0)); [intros t | rewrite Rabs_R1; lra].
  now rewrite Rmult_1_l, Rplus_0_r.
Qed.

Lemma bounded_sin r k : bounded r (weight r k) (fun t => sin (IZR k * t)).
Proof.
  apply (bounded_ext (bounded_mode r k 1 (- (PI / 2)))); [intros t | rewrite Rabs_R1; lra].
  rewrite Rmult_1_l, <- cos_neg. replace (- (IZR k * t + - (PI / 2))) with (PI / 2 - IZR k * t) by ring.
  symmetry. apply cos_shift.
Qed.

Lemma bounded_cos1 r : bounded r r cos.
Proof.
  apply (bounded_ext (bounded_cos r 1));
    [intros t; now rewrite Rmult_1_l | unfold weight; simpl; lra].
Qed.

Lemma bounded_sin1 r : bounded r r sin.
Proof.
  apply (bounded_ext (bounded_sin r 1));
    [intros t; now rewrite Rmult_1_l | unfold weight; simpl; lra].
Qed.

Fixpoint product_one (m : mode) (q : list mode) : list mode :=
  match q with
  | [] => []
  | n :: q => Mode (number m + number n) (height m * height n / 2) (shift m + shift n)
           :: Mode (number m - number n) (height m * height n / 2) (shift m - shift n) :: product_one m q
  end.
Fixpoint product (p q : list mode) : list mode :=
  match p with [] => [] | m :: p => product_one m q ++ product p q end.

Lemma eval_app p q t : eval (p ++ q) t = eval p t + eval q t.
Proof. induction p as [| m p IH]; simpl; [ring |]. rewrite IH. ring. Qed.

Lemma size_app r p q : size r (p ++ q) = size r p + size r q.
Proof. induction p as [| m p IH]; simpl; [ring |]. rewrite IH. ring. Qed.

Lemma eval_product p q t : eval (product p q) t = eval p t * eval q t.
Proof.
  induction p as [| m p IH]; simpl; [ring |]. rewrite eval_app, IH.
  assert (E : eval (product_one m q) t = value m t * eval q t); [| rewrite E; ring].
  clear. induction q as [| n q IH]; simpl; [ring |]. rewrite IH. unfold value. simpl.
  rewrite plus_IZR, minus_IZR.
  replace ((IZR (number m) + IZR (number n)) * t + (shift m + shift n))
    with ((IZR (number m) * t + shift m) + (IZR (number n) * t + shift n)) by ring.
  replace ((IZR (number m) - IZR (number n)) * t + (shift m - shift n))
    with ((IZR (number m) * t + shift m) - (IZR (number n) * t + shift n)) by ring.
  rewrite cos_plus, cos_minus. field.
Qed.

Lemma size_product r p q : 1 <= r -> size r (product p q) <= size r p * size r q.
Proof.
  intros Hr. induction p as [| m p IH]; simpl; [lra |]. rewrite size_app.
  assert (E : size r (product_one m q) <= Rabs (height m) * weight r (number m) * size r q); [| lra].
  clear IH. induction q as [| n q IH]; simpl; [lra |].
  unfold Rdiv. rewrite !Rabs_mult, (Rabs_right (/ 2)) by lra.
  pose proof (weight_product r (number m) (number n) Hr) as W.
  pose proof (weight_product r (number m) (- number n) Hr) as W'.
  replace (weight r (- number n)) with (weight r (number n)) in W' by (unfold weight; f_equal; lia).
  change (number m + - number n)%Z with (number m - number n)%Z in W'.
  assert (0 <= Rabs (height m) * Rabs (height n)) by (apply Rmult_le_pos; apply Rabs_pos).
  nra.
Qed.

Lemma bounded_mult {r M N f g} : 1 <= r ->
  bounded r M f -> bounded r N g -> bounded r (M * N) (fun t => f t * g t).
Proof.
  intros Hr (p & E & S) (q & E' & S'). exists (product p q). split.
  - intros t. now rewrite E, E', eval_product.
  - pose proof (size_product r p q Hr). pose proof (size_0 r p Hr). pose proof (size_0 r q Hr). nra.
Qed.

(* ---- what loses a part of r *)

Lemma bernoulli x d n : 0 <= x -> 0 <= d -> x ^ n * (x + (INR n + 1) * d) <= (x + d) ^ S n.
Proof.
  intros Hx Hd. induction n as [| n IH]; [simpl; lra |].
  change ((x + d) ^ S (S n)) with ((x + d) * (x + d) ^ S n).
  apply Rle_trans with ((x + d) * (x ^ n * (x + (INR n + 1) * d))).
  - rewrite S_INR. simpl. pose proof (pow_le x n Hx). pose proof (pos_INR n).
    assert (0 <= x ^ n * ((INR n + 1) * d * d)); [| lra].
    repeat apply Rmult_le_pos; lra.
  - apply Rmult_le_compat_l; [lra | exact IH].
Qed.

(* |k| (r - d)^|k| is at most (r/d) r^|k|. *)
Lemma weight_loss r d K k : 0 < d <= r -> r <= K * d ->
  Rabs (IZR k) * weight (r - d) k <= K * weight r k.
Proof.
  intros Hd HK. unfold weight.
  replace (Rabs (IZR k)) with (INR (Z.abs_nat k)) by (rewrite INR_IZR_INZ, Zabs2Nat.id_abs; apply abs_IZR).
  set (n := Z.abs_nat k). pose proof (bernoulli (r - d) d n ltac:(lra) ltac:(lra)) as B.
  replace (r - d + d) with r in B by ring. simpl in B.
  pose proof (pow_le (r - d) n ltac:(lra)). pose proof (pow_le r n ltac:(lra)). pose proof (pos_INR n).
  apply Rmult_le_reg_l with d; [lra |].
  apply Rle_trans with (r * r ^ n); [nra |].
  replace (d * (K * r ^ n)) with (K * d * r ^ n) by ring. now apply Rmult_le_compat_r.
Qed.

Definition derivative (p : list mode) : list mode :=
  map (fun m => Mode (number m) (IZR (number m) * height m) (shift m + PI / 2)) p.

Lemma derive_eval p t : is_derive (eval p) t (eval (derivative p) t).
Proof.
  induction p as [| m p IH]; [exact (is_derive_const (V := R_NormedModule) 0 t) |].
  apply (is_derive_plus (V := R_NormedModule) (value m) (eval p)); [| exact IH].
  unfold value. simpl.
  replace (IZR (number m) * t + (shift m + PI / 2)) with (PI / 2 + (IZR (number m) * t + shift m)) by ring.
  auto_derive; [exact I |]. rewrite cos_plus, cos_PI2, sin_PI2. ring.
Qed.

Lemma bounded_smooth {r M f} : bounded r M f -> {f' : R -> R | forall t, is_derive f t (f' t)}.
Proof.
  intros (p & E & _). exists (eval (derivative p)). intros t.
  apply (is_derive_ext (eval p)); [intros s; now rewrite E | apply derive_eval].
Qed.

Lemma bounded_derivative r d K M f f' : 0 < d <= r -> r <= K * d ->
  (forall t, is_derive f t (f' t)) -> bounded r M f -> bounded (r - d) (K * M) f'.
Proof.
  intros Hd HK D (p & E & S). exists (derivative p). split.
  - intros t. rewrite <- (is_derive_unique f t _ (D t)). apply is_derive_unique.
    apply (is_derive_ext (eval p)); [intros s; now rewrite E | apply derive_eval].
  - assert (0 < K) by nra.
    apply Rle_trans with (K * size r p); [| apply Rmult_le_compat_l; lra].
    apply size_map. intros m. simpl. rewrite Rabs_mult.
    pose proof (weight_loss r d K (number m) Hd HK). pose proof (Rabs_pos (height m)). nra.
Qed.

(* Division by e^{i k w} - 1, which is at least 1/|k|: up to a constant each polynomial is a
   difference. *)
Section Divisors.
Variable w : R.
Hypothesis divisor : forall k : Z, k <> 0%Z -> 1 / Rabs (IZR k) <= Rabs (2 * sin (IZR k * w / 2)).

Lemma bounded_difference r d K {M f} : 1 <= r - d -> 0 < d -> r <= K * d -> bounded r M f ->
  {c : R & {g : R -> R & {_ : Rabs c <= M /\ forall t, g (t + w) - g t = f t - c &
    bounded (r - d) (K * M) g}}}.
Proof.
  intros H1 Hd HK (p & E & S).
  assert (HK0 : 0 < K) by nra.
  cut {c : R & {q : list mode | Rabs c <= size r p /\
                 (forall t, eval q (t + w) - eval q t = eval p t - c) /\
                 size (r - d) q <= K * size r p}}.
  { intros (c & q & Hc & Hq & Sq). exists c, (eval q).
    unshelve eexists; [split; [lra | intros t; now rewrite E] |].
    exists q. split; [reflexivity |]. apply Rle_trans with (K * size r p); [exact Sq |].
      apply Rmult_le_compat_l; lra. }
  clear E S. induction p as [| m p (c & q & Hc & Hq & Sq)].
  - exists 0, []. simpl. rewrite Rabs_R0. split; [lra |]. split; [intros; ring | lra].
  - destruct m as [k a b]. destruct (Z.eq_dec k 0) as [-> | Hk].
    + exists (a * cos b + c), q. simpl. split; [| split].
      * eapply Rle_trans; [apply Rabs_triang |]. apply Rplus_le_compat; [| exact Hc].
        rewrite Rabs_mult. apply Rmult_le_compat_l; [apply Rabs_pos |].
        unfold weight. simpl. apply Rabs_le, COS_bound.
      * intros t. rewrite Hq. unfold value. simpl. rewrite Rmult_0_l, Rplus_0_l. ring.
      * unfold weight at 1. simpl. pose proof (Rabs_pos a). nra.
    + set (s := 2 * sin (IZR k * w / 2)). specialize (divisor k Hk). fold s in divisor.
      assert (Hk1 : 1 <= Rabs (IZR k)) by (rewrite <- abs_IZR; apply IZR_le; lia).
      assert (Hs : 0 < Rabs s).
      { eapply Rlt_le_trans; [| exact divisor]. apply Rdiv_lt_0_compat; lra. }
      assert (Hs0 : s <> 0) by (intros Z0; rewrite Z0, Rabs_R0 in Hs; lra).
      exists c, (Mode k (a / s) (b - IZR k * w / 2 - PI / 2) :: q). simpl. split; [| split].
      * pose proof (Rabs_pos a). pose proof (weight_1 r k ltac:(lra)). nra.
      * intros t. replace (value (Mode k a b) t + eval p t - c)
          with (value (Mode k a b) t + (eval p t - c)) by ring.
        rewrite <- Hq.
        assert (A : value (Mode k (a / s) (b - IZR k * w / 2 - PI / 2)) (t + w)
                  - value (Mode k (a / s) (b - IZR k * w / 2 - PI / 2)) t = value (Mode k a b) t); [| lra].
        unfold value. simpl. set (x := IZR k * t + b). set (y := IZR k * w / 2).
        replace (IZR k * (t + w) + (b - y - PI / 2)) with (- (PI / 2 - (x + y))) by (unfold x, y; field).
        replace (IZR k * t + (b - y - PI / 2)) with (- (PI / 2 - (x - y))) by (unfold x, y; field).
        rewrite !cos_neg, !cos_shift, sin_plus, sin_minus. unfold s. fold y. field.
        fold y in s. intros Z0. apply Hs0. unfold s. rewrite Z0. ring.
      * pose proof (weight_loss r d K k ltac:(lra) HK) as L.
        assert (Q : Rabs (a / s) <= Rabs a * Rabs (IZR k)).
        { unfold Rdiv. rewrite Rabs_mult, Rabs_inv. apply Rmult_le_compat_l; [apply Rabs_pos |].
          apply Rmult_le_reg_r with (Rabs s); [exact Hs |]. rewrite Rinv_l by lra.
          apply (Rmult_le_compat_l (Rabs (IZR k))) in divisor; [| lra].
          unfold Rdiv in divisor. rewrite Rmult_1_l, Rinv_r in divisor by lra. exact divisor. }
        assert (0 <= weight (r - d) k) by (pose proof (weight_1 (r - d) k H1); lra).
        pose proof (Rabs_pos a). nra.
Qed.
End Divisors.
