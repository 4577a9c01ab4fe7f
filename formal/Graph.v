(* Orbits on invariant graphs minimize the action (Katok; MacKay, Meiss and Stark), so where no
   orbit through a point does there is no invariant graph: docs/proofs/argument.md, lemmas 1 to 3, but without
   invariance of domain.  On the graph of psi = c + S' a step leads from y to
   f(y) = y + psi(y) - V'(y), and as the graph is invariant psi(f(y)) = f(y) - y: a step back leads
   from z to g(z) = z - psi(z).  For each z the function H of docs/proofs/argument.md has a least value, and
   where it is f(y) = z; so y = g(f(y)) = g(z).

   The theorems are at the end.  Besides, V_gradient, V_second, F_orbit and second_variation say
   that Map.v's V', beta, orbit and variation are what they are called. *)

From Coq Require Import Reals ZArith QArith Qreals List Lra Lia Classical FunctionalExtensionality.
From Coquelicot Require Import Coquelicot.
From Converse Require Import Map.
Import ListNotations.
Open Scope R_scope.

(* What Map.v says of vectors, in coordinates. *)
Ltac coordinates :=
  unfold beta, angle, along, dot, plus, minus, scale in *; simpl fst in *; simpl snd in *.

Lemma vec_eq (v w : vec) : fst v = fst w -> snd v = snd w -> v = w.
Proof. destruct v, w; simpl; intros -> ->; reflexivity. Qed.

(* ---- continuous functions of the plane *)

(* Squares of small numbers, and numbers of small squares. *)
Lemma square_below (a e : R) : Rabs a < e -> e <= 1 -> a * a < e.
Proof. intros H ?; apply Rabs_def2 in H; assert (0 < e) by lra; nra. Qed.

Lemma legs_below (a b d : R) : 0 < d -> a * a + b * b < d * d -> Rabs a < d /\ Rabs b < d.
Proof. split; apply Rabs_def1; nra. Qed.

(* Map.v's continuity, of Euclidean distances, is Coquelicot's. *)
Lemma continuous_ball (f : vec -> R) :
  continuous f <-> forall y, Continuity.continuous f y.
Proof.
  split; intros C y.
  - apply filterlim_locally; intros eps.
    destruct (C y eps (cond_pos eps)) as [d [Hd near]].
    assert (He : 0 < Rmin 1 (d / 2)) by (apply Rmin_glb_lt; lra).
    exists (mkposreal _ He); intros z [b0 b1]; apply near.
    unfold ball in b0, b1; simpl in b0, b1; unfold AbsRing_ball, abs in b0, b1; simpl in b0, b1.
    change (Rabs (fst z - fst y) < Rmin 1 (d / 2)) in b0.
    change (Rabs (snd z - snd y) < Rmin 1 (d / 2)) in b1.
    pose proof (square_below _ _ b0 (Rmin_l _ _)); pose proof (square_below _ _ b1 (Rmin_l _ _)).
    pose proof (Rmin_r 1 (d / 2)); coordinates; lra.
  - intros eps Heps; specialize (proj1 (filterlim_locally _ _) (C y) (mkposreal _ Heps)).
    intros [d near]; exists (d * d); split; [apply Rmult_lt_0_compat; apply cond_pos | intros z Hz].
    apply (near z); exact (legs_below _ _ _ (cond_pos d) Hz).
Qed.

(* Sums, products and compositions of continuous functions are continuous. *)
Local Notation everywhere f := (forall y : vec, Continuity.continuous f y).

Lemma c_const (a : R) : everywhere (fun _ : vec => a).
Proof. intros y; apply continuous_const. Qed.

Lemma c_fst : everywhere (fun y : vec => fst y).
Proof. intros [a b]; apply continuous_fst. Qed.

Lemma c_snd : everywhere (fun y : vec => snd y).
Proof. intros [a b]; apply continuous_snd. Qed.

Lemma c_plus (f g : vec -> R) : everywhere f -> everywhere g -> everywhere (fun y => f y + g y).
Proof. intros Cf Cg y; exact (continuous_plus f g y (Cf y) (Cg y)). Qed.

Lemma c_minus (f g : vec -> R) : everywhere f -> everywhere g -> everywhere (fun y => f y - g y).
Proof. intros Cf Cg y; exact (continuous_minus f g y (Cf y) (Cg y)). Qed.

Lemma c_mult (f g : vec -> R) : everywhere f -> everywhere g -> everywhere (fun y => f y * g y).
Proof. intros Cf Cg y; exact (continuous_mult f g y (Cf y) (Cg y)). Qed.

Lemma c_opp (f : vec -> R) : everywhere f -> everywhere (fun y => - f y).
Proof. intros Cf y; exact (continuous_opp f y (Cf y)). Qed.

Lemma c_pair (f a b : vec -> R) : everywhere f -> everywhere a -> everywhere b ->
  everywhere (fun y => f (a y, b y)).
Proof.
  intros Cf Ca Cb y; apply (continuous_comp_2 a b (fun s t => f (s, t)) y (Ca y) (Cb y)).
  apply (continuous_ext f); [now intros [? ?] | apply Cf].
Qed.

Ltac continuity := repeat (cbv beta; match goal with
  | |- forall z, Continuity.continuous (fun _ => ?a) z => apply (c_const a)
  | |- forall z, Continuity.continuous (fun y => fst y) z => apply c_fst
  | |- forall z, Continuity.continuous (fun y => snd y) z => apply c_snd
  | |- forall z, Continuity.continuous (fun y => @?f y + @?g y) z => apply (c_plus f g)
  | |- forall z, Continuity.continuous (fun y => @?f y - @?g y) z => apply (c_minus f g)
  | |- forall z, Continuity.continuous (fun y => @?f y * @?g y) z => apply (c_mult f g)
  | |- forall z, Continuity.continuous (fun y => @?f y / ?a) z => apply (c_mult f (fun _ => / a))
  | |- forall z, Continuity.continuous (fun y => ?f (@?a y, @?b y)) z => apply (c_pair f a b)
  | |- _ => assumption
  end).

(* A way to find limits without sequences: if a property of sets of numbers passes from a set to
   larger ones and from a union to one of its parts, and an interval has it, then there is a point
   all neighbourhoods of which have it. *)
Lemma cluster (good : (R -> Prop) -> Prop) (lo hi : R) :
  (forall A B : R -> Prop, (forall t, A t -> B t) -> good A -> good B) ->
  (forall A B : R -> Prop, good (fun t => A t \/ B t) -> good A \/ good B) ->
  good (fun t => lo <= t <= hi) ->
  exists a, forall eps, 0 < eps -> good (fun t => Rabs (t - a) < eps).
Proof.
  intros larger part whole.
  destruct (classic (good (fun _ => False))) as [empty | empty].
  { exists 0; intros eps _; apply (larger (fun _ => False)); tauto. }
  destruct (completeness (fun t => ~ good (fun s => lo <= s <= t))) as [a [upper least]].
  - exists hi; intros t Ht; apply Rnot_lt_le; intro; apply Ht.
    revert whole; apply larger; intros s Hs; lra.
  - exists (lo - 1); intros H; apply empty; revert H; apply larger; intros s Hs; lra.
  - exists a; intros eps Heps.
    assert (exists t, a - eps < t /\ ~ good (fun s => lo <= s <= t)) as [t [Ht bad]].
    { apply NNPP; intro none; assert (a <= a - eps); [| lra].
      apply least; intros t Ht; apply Rnot_lt_le; intro; apply none; exists t; tauto. }
    destruct (part (fun s => lo <= s <= t) (fun s => t < s <= a + eps / 2)) as [H | H].
    + apply (larger (fun s => lo <= s <= a + eps / 2)); [intros s Hs; lra |].
      apply NNPP; intro H; specialize (upper _ H); lra.
    + contradiction.
    + revert H; apply larger; intros s Hs; apply Rabs_def1; lra.
Qed.

(* f is somewhere in P at least as small as anywhere in the plane. *)
Definition low (f : vec -> R) (P : vec -> Prop) : Prop := forall y, exists z, P z /\ f z <= f y.

(* Like the property of `cluster` it passes to larger sets, and to one of two parts. *)
Lemma low_larger f (P Q : vec -> Prop) : (forall z, P z -> Q z) -> low f P -> low f Q.
Proof. intros H G y; destruct (G y) as [z Hz]; exists z; split; [apply H |]; apply Hz. Qed.

Lemma low_part f (P Q : vec -> Prop) : low f (fun z => P z \/ Q z) -> low f P \/ low f Q.
Proof.
  intros H; apply NNPP; intros none; apply not_or_and in none; destruct none as [n1 n2].
  apply not_all_ex_not in n1; apply not_all_ex_not in n2.
  destruct n1 as [y1 n1], n2 as [y2 n2].
  destruct (Rle_dec (f y1) (f y2));
    [destruct (H y1) as [z [[Hz | Hz] less]] | destruct (H y2) as [z [[Hz | Hz] less]]];
    (apply n1 + apply n2); exists z; (split; [exact Hz | lra]).
Qed.

(* A continuous function that is low in a square has a minimum. *)
Lemma minimum (f : vec -> R) (m : vec) (r : R) :
  continuous f -> low f (fun z => Rabs (fst z - fst m) <= r /\ Rabs (snd z - snd m) <= r) ->
  exists p, forall y, f p <= f y.
Proof.
  intros C square.
  destruct (cluster (fun A => low f (fun z => A (fst z) /\ Rabs (snd z - snd m) <= r))
                    (fst m - r) (fst m + r)) as [a Ha].
  - intros A B H; apply low_larger; intros z Hz; split; [apply H |]; apply Hz.
  - intros A B H; apply low_part; revert H; apply low_larger; intros z Hz; tauto.
  - revert square; apply low_larger; intros z [h0 h1].
    split; [apply Rabs_le_between in h0; lra | exact h1].
  - destruct (cluster (fun B => forall eps, 0 < eps ->
                       low f (fun z => Rabs (fst z - a) < eps /\ B (snd z)))
                      (snd m - r) (snd m + r)) as [b Hb].
    + intros A B H G eps Heps; generalize (G eps Heps); apply low_larger.
      intros z Hz; split; [| apply H]; apply Hz.
    + intros A B H; apply NNPP; intros none; apply not_or_and in none; destruct none as [n1 n2].
      apply not_all_ex_not in n1; apply not_all_ex_not in n2.
      destruct n1 as [e1 n1], n2 as [e2 n2].
      apply imply_to_and in n1; apply imply_to_and in n2; destruct n1 as [p1 n1], n2 as [p2 n2].
      pose proof (Rmin_l e1 e2); pose proof (Rmin_r e1 e2).
      assert (D : low f (fun z => (Rabs (fst z - a) < Rmin e1 e2 /\ A (snd z)) \/
                                  (Rabs (fst z - a) < Rmin e1 e2 /\ B (snd z)))).
      { generalize (H (Rmin e1 e2) (Rmin_glb_lt _ _ _ p1 p2)); apply low_larger; tauto. }
      destruct (low_part _ _ _ D) as [G | G]; [apply n1 | apply n2]; revert G; apply low_larger;
        intros z [h h']; split; solve [assumption | lra].
    + intros eps Heps; generalize (Ha eps Heps); apply low_larger; intros z [h0 h1].
      split; [assumption | apply Rabs_le_between in h1; lra].
    + exists (a, b); intros y; apply le_epsilon; intros eps Heps.
      destruct (C (a, b) eps Heps) as [d [Hd near]].
      pose (e := Rmin 1 (d / 2)).
      assert (e1 : e <= 1) by apply Rmin_l.
      assert (ed : e <= d / 2) by apply Rmin_r.
      assert (He : 0 < e) by (apply Rmin_glb_lt; lra).
      destruct (Hb e He e He y) as [z [[h0 h1] less]].
      assert (Rabs (f z - f (a, b)) < eps) as H.
      { apply near; pose proof (square_below _ _ h0 e1); pose proof (square_below _ _ h1 e1).
        coordinates; lra. }
      apply Rabs_def2 in H; lra.
Qed.

(* A continuous function of one number that nowhere starts to grow at a positive slope, to either
   side, is constant: less a small slope it would have a minimum between a and b. *)
Lemma no_growth_le (m : R -> R) :
  (forall t, continuity_pt m t) ->
  (forall t eps, 0 < eps -> exists d, 0 < d /\
     forall s, Rabs (s - t) < d -> m s - m t <= eps * Rabs (s - t)) ->
  forall a b, a < b -> m b <= m a.
Proof.
  intros C slow a b Hab; apply Rnot_lt_le; intros rise.
  pose (k := (m b - m a) / (2 * (b - a))).
  assert (Hk : 0 < k) by (apply Rdiv_lt_0_compat; lra).
  assert (Hk' : k * (b - a) * 2 = m b - m a) by (unfold k; field; lra).
  destruct (continuity_ab_min (fun t => m t - k * t) a b) as [t [least Ht]]; [lra | |].
  { intros t _; apply continuity_pt_minus; [apply C |].
    apply continuity_pt_scal, derivable_continuous_pt, derivable_pt_id. }
  assert (t <> b) by (intros ->; specialize (least a); lra).
  destruct (slow t (k / 2)) as [d [Hd grow]]; [lra |].
  pose (s := Rmin (t + d / 2) b).
  assert (t < s) by (apply Rmin_glb_lt; lra).
  pose proof (Rmin_l (t + d / 2) b : s <= _); pose proof (Rmin_r (t + d / 2) b : s <= _).
  specialize (least s ltac:(lra)); specialize (grow s).
  rewrite Rabs_right in grow by lra; specialize (grow ltac:(lra)); nra.
Qed.

(* Neither does it fall: the same for -t. *)
Lemma no_growth (m : R -> R) :
  (forall t, continuity_pt m t) ->
  (forall t eps, 0 < eps -> exists d, 0 < d /\
     forall s, Rabs (s - t) < d -> m s - m t <= eps * Rabs (s - t)) ->
  forall a b, m b <= m a.
Proof.
  intros C slow a b; destruct (Rtotal_order a b) as [H | [-> | H]]; [| lra |].
  - now apply no_growth_le.
  - rewrite <- (Ropp_involutive a), <- (Ropp_involutive b).
    apply (no_growth_le (fun t => m (- t))); [intros t | intros t eps Heps | lra].
    + apply (continuity_pt_comp Ropp m); [| apply C].
      apply continuity_pt_opp, derivable_continuous_pt, derivable_pt_id.
    + destruct (slow (- t) eps Heps) as [d [Hd grow]]; exists d; split; [exact Hd | intros s Hs].
      replace (Rabs (s - t)) with (Rabs (- s - - t)) in * by (rewrite <- Rabs_Ropp; f_equal; ring).
      now apply grow.
Qed.

(* ---- the derivatives that are used *)

(* Where a function is least its derivative is zero. *)
Lemma least_derivative (f : R -> R) (t l : R) :
  is_derive f t l -> (forall s, f t <= f s) -> l = 0.
Proof.
  intros D least; apply is_derive_Reals in D.
  pose (pr := exist _ l D : derivable_pt f t).
  rewrite <- (derive_pt_eq_0 _ _ _ pr D).
  apply (deriv_minimum f (t - 1) (t + 1)); [lra | lra | intros; apply least].
Qed.

(* Where a derivative is zero the function is flatter than any positive slope. *)
Lemma flat (f : R -> R) (t eps : R) :
  is_derive f t 0 -> 0 < eps ->
  exists d, 0 < d /\ forall s, Rabs (s - t) < d -> f s - f t <= eps * Rabs (s - t).
Proof.
  intros D Heps; apply is_derive_Reals in D; destruct (D eps Heps) as [d near].
  exists d; split; [apply cond_pos | intros s Hs].
  destruct (Req_dec s t) as [-> | H]; [rewrite !Rminus_eq_0, Rabs_R0; lra |].
  specialize (near (s - t) ltac:(lra) Hs).
  replace (t + (s - t)) with s in near by ring.
  rewrite Rminus_0_r in near; unfold Rdiv in near.
  rewrite Rabs_mult, Rabs_inv in near.
  assert (0 < Rabs (s - t)) by (apply Rabs_pos_lt; lra).
  apply (Rmult_lt_compat_r _ _ _ H0) in near.
  rewrite Rmult_assoc, Rinv_l, Rmult_1_r in near by lra.
  pose proof (Rle_abs (f s - f t)); lra.
Qed.

(* The second derivative is not negative where a function is least. *)
Lemma least_second (f f' : R -> R) (l : R) :
  (forall t, is_derive f t (f' t)) -> (forall t, f 0 <= f t) -> is_derive f' 0 l -> 0 <= l.
Proof.
  intros D least D'; apply Rnot_lt_le; intros neg.
  assert (f0 : f' 0 = 0) by (eapply least_derivative; [apply D | exact least]).
  apply is_derive_Reals in D'; destruct (D' (- l / 2)) as [d near]; [lra |].
  pose proof (cond_pos d).
  destruct (MVT_cor2 f f' 0 (d / 2)) as [t [E Ht]]; [lra | intros; apply is_derive_Reals, D |].
  specialize (near t ltac:(lra)); rewrite Rabs_right in near by lra.
  specialize (near ltac:(lra)); rewrite Rplus_0_l, f0 in near; apply Rabs_def2 in near.
  assert (f' t < 0).
  { replace (f' t) with ((f' t - 0) / t * t) by (field; lra); nra. }
  specialize (least (d / 2)); nra.
Qed.

(* Coquelicot's, for functions of a number. *)
Lemma derive_ext (f g : R -> R) (t l : R) :
  (forall s, f s = g s) -> is_derive f t l -> is_derive g t l.
Proof. exact (is_derive_ext f g t l). Qed.

Lemma derive_const (a t : R) : is_derive (fun _ : R => a) t 0.
Proof. exact (is_derive_const a t). Qed.

Lemma derive_minus (f g : R -> R) (t a b c : R) :
  is_derive f t a -> is_derive g t b -> c = a - b -> is_derive (fun s => f s - g s) t c.
Proof. intros Df Dg ->; exact (is_derive_minus f g t a b Df Dg). Qed.

Lemma derive_plus (f g : R -> R) (t a b c : R) :
  is_derive f t a -> is_derive g t b -> c = a + b -> is_derive (fun s => f s + g s) t c.
Proof. intros Df Dg ->; exact (is_derive_plus f g t a b Df Dg). Qed.

(* The form that H has in each coordinate. *)
Lemma quadratic (A B : R -> R) (p q k t a b : R) :
  is_derive A t a -> is_derive B t b ->
  is_derive (fun s => (p - s) * (p - s) / 2 + q * s + k - A s + B s) t (t - p + q - a + b).
Proof.
  intros DA DB; auto_derive; [now split; [eexists; exact DA | split; [eexists; exact DB |]] |].
  apply is_derive_unique in DA; apply is_derive_unique in DB.
  change (Derive (fun x => A x) t) with (Derive A t).
  change (Derive (fun x => B x) t) with (Derive B t).
  rewrite DA, DB; field.
Qed.

(* ---- the potential *)

(* One wave more; *)
Lemma V_cons w ws y : V (w :: ws) y = V ws y - amplitude w * sin (angle w y).
Proof. unfold V; simpl; ring. Qed.

Lemma V'_cons w ws y v :
  dot (V' (w :: ws) y) v = dot (V' ws y) v - amplitude w * cos (angle w y) * along w v.
Proof. unfold V'; coordinates; simpl sum; ring. Qed.

Lemma beta_cons w ws y v :
  beta (w :: ws) y v = beta ws y v - amplitude w * sin (angle w y) * (along w v * along w v).
Proof. unfold beta; simpl sum; ring. Qed.

(* one wave along a line. *)
Lemma wave_line (w : wave) (y v : vec) (t : R) :
  is_derive (fun t => amplitude w * sin (angle w (plus y (scale t v)))) t
            (amplitude w * cos (angle w (plus y (scale t v))) * along w v).
Proof. coordinates; auto_derive; [exact I | ring]. Qed.

Lemma wave_line' (w : wave) (y v : vec) (t : R) :
  is_derive (fun t => amplitude w * cos (angle w (plus y (scale t v))) * along w v) t
            (- (amplitude w * sin (angle w (plus y (scale t v))) * (along w v * along w v))).
Proof. coordinates; auto_derive; [exact I | ring]. Qed.

(* The derivative of V along a line, *)
Lemma V_line ws (y v : vec) (t : R) :
  is_derive (fun t => V ws (plus y (scale t v))) t (dot (V' ws (plus y (scale t v))) v).
Proof.
  induction ws as [| w ws IH].
  - replace (dot _ v) with 0 by (unfold V'; coordinates; simpl sum; ring).
    apply (derive_ext (fun _ => V [] y)); [reflexivity | apply derive_const].
  - rewrite V'_cons; apply (derive_ext (fun t => V ws (plus y (scale t v)) -
      amplitude w * sin (angle w (plus y (scale t v))))).
    + intros s; now rewrite V_cons.
    + eapply derive_minus; [apply IH | apply wave_line | reflexivity].
Qed.

(* and the second one: beta is the quadratic form of 2I - V''. *)
Lemma V_line' ws (y v : vec) (t : R) :
  is_derive (fun t => dot (V' ws (plus y (scale t v))) v) t
            (2 * dot v v - beta ws (plus y (scale t v)) v).
Proof.
  induction ws as [| w ws IH].
  - replace (_ - _) with 0 by (unfold beta; simpl sum; ring).
    apply (derive_ext (fun _ => 0)); [| apply derive_const].
    intros s; unfold V'; coordinates; simpl sum; ring.
  - rewrite beta_cons; apply (derive_ext (fun t => dot (V' ws (plus y (scale t v))) v -
      amplitude w * cos (angle w (plus y (scale t v))) * along w v)).
    + intros s; now rewrite V'_cons.
    + eapply derive_minus; [apply IH | apply wave_line' | ring].
Qed.

Lemma sum_waves_continuous (f : wave -> R) ws :
  everywhere (fun y => sum (fun w => f w * (amplitude w * cos (angle w y))) ws).
Proof.
  induction ws as [| w ws IH]; simpl; [apply c_const |].
  assert (C : everywhere (angle w)) by (coordinates; continuity).
  pose proof (fun y => continuous_comp (angle w) cos y (C y) (continuous_cos _)); continuity.
Qed.

(* V' is the gradient of V, and continuous, *)
Theorem V_gradient ws : has_gradient (V ws) (V' ws).
Proof.
  split; [| split; [| split]].
  - intros y; apply is_derive_Reals.
    apply (derive_ext (fun a => V ws (plus (0, snd y) (scale a (1, 0))))).
    { intros a; f_equal; apply vec_eq; coordinates; ring. }
    replace (fst (V' ws y)) with (dot (V' ws (plus (0, snd y) (scale (fst y) (1, 0)))) (1, 0)).
    + apply V_line.
    + replace (plus _ _) with y by (apply vec_eq; coordinates; ring); coordinates; ring.
  - intros y; apply is_derive_Reals.
    apply (derive_ext (fun b => V ws (plus (fst y, 0) (scale b (0, 1))))).
    { intros b; f_equal; apply vec_eq; coordinates; ring. }
    replace (snd (V' ws y)) with (dot (V' ws (plus (fst y, 0) (scale (snd y) (0, 1)))) (0, 1)).
    + apply V_line.
    + replace (plus _ _) with y by (apply vec_eq; coordinates; ring); coordinates; ring.
  - apply continuous_ball; apply c_opp, sum_waves_continuous.
  - apply continuous_ball; apply c_opp, sum_waves_continuous.
Qed.

(* and V has along the line y + t v the second derivative 2 |v|^2 - v.beta v. *)
Theorem V_second ws (y v : vec) (t : R) :
  derivable_pt_lim (fun t => V ws (plus y (scale t v))) t
                   (dot (V' ws (plus y (scale t v))) v) /\
  derivable_pt_lim (fun t => dot (V' ws (plus y (scale t v))) v) t
                   (2 * dot v v - beta ws (plus y (scale t v)) v).
Proof. split; apply is_derive_Reals; [apply V_line | apply V_line']. Qed.

(* Orbits of F, the momenta being the differences of the angles, are what Map.v calls orbits. *)
Theorem F_orbit ws (x : Z -> vec) :
  orbit ws x <-> forall j, F ws (x j, minus (x j) (x (j - 1)%Z)) =
                           (x (j + 1)%Z, minus (x (j + 1)%Z) (x j)).
Proof.
  split; intros O j; specialize (O j).
  - unfold F; rewrite O; f_equal; apply vec_eq; coordinates; ring.
  - apply (f_equal fst) in O; simpl in O; rewrite <- O; apply vec_eq; coordinates; ring.
Qed.

(* V is bounded above. *)
Lemma V_bounded ws : exists B, forall y, V ws y <= B.
Proof.
  induction ws as [| w ws [B IH]].
  - exists 0; intros y; unfold V; simpl; lra.
  - exists (B + Rabs (amplitude w)); intros y; rewrite V_cons; specialize (IH y).
    enough (- (amplitude w * sin (angle w y)) <= Rabs (amplitude w)) by lra.
    pose proof (SIN_bound (angle w y)); unfold Rabs; destruct (Rcase_abs (amplitude w)); nra.
Qed.

(* ---- functions of class C^1 *)

(* They are continuous. *)
Lemma gradient_continuous (u : vec -> R) (u' : vec -> vec) :
  has_gradient u u' -> forall y, Continuity.continuous u y.
Proof.
  intros [D0 [D1 [C0 _]]] [a b].
  apply (continuous_ext (fun y : vec => u (fst y, snd y))); [now intros [? ?] |].
  apply (filterdiff_continuous (K := R_AbsRing) (V := R_NormedModule)
           (U := prod_NormedModule R_AbsRing R_NormedModule R_NormedModule)).
  eexists; apply (is_derive_filterdiff (fun a b => u (a, b)) a b (fun a b => fst (u' (a, b)))).
  - exists (mkposreal _ Rlt_0_1); intros [s t] _; apply is_derive_Reals, (D0 (s, t)).
  - apply is_derive_Reals, (D1 (a, b)).
  - apply (continuous_ext (fun y => fst (u' y))); [now intros [? ?] |].
    now apply (proj1 (continuous_ball _)).
Qed.

(* Every number is by a multiple of 2 pi between 0 and 2 pi. *)
Lemma modulo_2pi (a : R) : exists m, 0 <= a + 2 * PI * IZR m <= 2 * PI.
Proof.
  pose proof PI_RGT_0; exists (- Int_part (a / (2 * PI)))%Z; rewrite opp_IZR.
  destruct (base_Int_part (a / (2 * PI))) as [h0 h1].
  assert (a = a / (2 * PI) * (2 * PI)) as E by (field; lra).
  set (q := a / (2 * PI)) in *; set (i := IZR (Int_part q)) in *; clearbody q i; subst a; nra.
Qed.

(* Continuous periodic functions are bounded below. *)
Lemma periodic_bounded (u : vec -> R) :
  periodic u -> continuous u -> exists B, forall y, B <= u y.
Proof.
  intros P C; destruct (minimum u (0, 0) (2 * PI) C) as [p Hp]; [| now exists (u p)].
  intros y; destruct (modulo_2pi (fst y)) as [m0 H0], (modulo_2pi (snd y)) as [m1 H1].
  exists (plus y (scale (2 * PI) (IZR m0, IZR m1))); rewrite P; coordinates.
  repeat split; try apply Rabs_le; lra.
Qed.

(* ---- the action *)

(* What a step from y to z adds to the action, *)
Definition h (ws : list wave) (y z : vec) : R := dot (minus z y) (minus z y) / 2 - V ws y.

(* the action of the steps from x s to x (s + 1), ..., from x (s + k - 1) to x (s + k), *)
Fixpoint action (ws : list wave) (x : Z -> vec) (s : Z) (k : nat) : R :=
  match k with
  | O => 0
  | S k => h ws (x s) (x (s + 1)%Z) + action ws x (s + 1) k
  end.

(* and x + t n. *)
Definition moved (x n : Z -> vec) (t : R) (j : Z) : vec := plus (x j) (scale t (n j)).

(* The derivatives of the action with respect to t: for any piece of x, *)
Lemma action_variation ws (x n : Z -> vec) (k : nat) : forall s, exists slope : R -> R,
  (forall t, is_derive (fun t => action ws (moved x n t) s k) t (slope t)) /\
  is_derive slope 0 (variation ws x n s k + dot (n (s + Z.of_nat k)%Z) (n (s + Z.of_nat k)%Z)
                     - dot (n s) (n s)).
Proof.
  induction k as [| k IH]; intros s.
  - exists (fun _ => 0); split; [intros t; exact (derive_const 0 t) |].
    replace (s + Z.of_nat 0)%Z with s by lia; simpl variation.
    replace (_ - _) with 0 by ring; exact (derive_const 0 0).
  - destruct (IH (s + 1)%Z) as [slope [D D']].
    pose (d := minus (x (s + 1)%Z) (x s)); pose (e := minus (n (s + 1)%Z) (n s)).
    exists (fun t => dot d e + t * dot e e - dot (V' ws (moved x n t s)) (n s) + slope t); split.
    + intros t; simpl action.
      eapply derive_plus; [| apply D | reflexivity].
      apply (derive_ext (fun t => dot d d / 2 + t * dot d e + t * t / 2 * dot e e
                                  - V ws (moved x n t s))).
      { intros r; unfold h, moved, d, e; coordinates; field. }
      eapply derive_minus; [| apply V_line | reflexivity].
      auto_derive; [exact I | field].
    + eapply derive_plus; [| exact D' |].
      * eapply derive_minus; [| apply V_line' | reflexivity].
        instantiate (1 := dot e e); auto_derive; [exact I | ring].
      * simpl variation; replace (s + 1 + Z.of_nat k)%Z with (s + Z.of_nat (S k))%Z by lia.
        replace (plus (x s) (scale 0 (n s))) with (x s) by (apply vec_eq; coordinates; ring).
        unfold e; coordinates; ring.
Qed.

(* A site that does not move adds nothing. *)
Lemma beta_zero ws y : beta ws y (0, 0) = 0.
Proof.
  induction ws as [| w ws IH]; [unfold beta; simpl sum | rewrite beta_cons, IH];
    coordinates; ring.
Qed.

(* and if n is zero but at s, ..., s + k - 1: then the second one, of the action from s - 1 to
   s + k, is the second variation. *)
Theorem second_variation ws (x n : Z -> vec) (s : Z) (k : nat) :
  zero_outside n s k -> exists slope : R -> R,
  (forall t, derivable_pt_lim (fun t => action ws (moved x n t) (s - 1) (S k)) t (slope t)) /\
  derivable_pt_lim slope 0 (variation ws x n s k).
Proof.
  intros Z; destruct (action_variation ws x n (S k) (s - 1)) as [slope [D D']].
  exists slope; split; [intros t; apply is_derive_Reals, D | apply is_derive_Reals].
  simpl variation in D'; replace (s - 1 + Z.of_nat (S k))%Z with (s + Z.of_nat k)%Z in D' by lia.
  replace (s - 1 + 1)%Z with s in D' by ring.
  rewrite (Z (s - 1)%Z), (Z (s + Z.of_nat k)%Z) in D' by lia.
  rewrite beta_zero in D'; replace (variation ws x n s k) with
    (0 - 2 * dot (0, 0) (n s) + variation ws x n s k + dot (0, 0) (0, 0) - dot (0, 0) (0, 0))
    by (coordinates; ring).
  exact D'.
Qed.

(* So where the action is least the second variation is not negative. *)
Lemma least_variation ws (x n : Z -> vec) (s : Z) (k : nat) :
  zero_outside n s k ->
  (forall z, z (s - 1)%Z = x (s - 1)%Z -> z (s + Z.of_nat k)%Z = x (s + Z.of_nat k)%Z ->
             action ws x (s - 1) (S k) <= action ws z (s - 1) (S k)) ->
  0 <= variation ws x n s k.
Proof.
  intros Z least; destruct (second_variation ws x n s k Z) as [slope [D D']].
  apply (least_second (fun t => action ws (moved x n t) (s - 1) (S k)) slope);
    [intros t; apply is_derive_Reals, D | | apply is_derive_Reals, D'].
  intros t; replace (moved x n 0) with x.
  - apply least; unfold moved; rewrite Z by lia; apply vec_eq; coordinates; ring.
  - apply functional_extensionality; intros j; apply vec_eq; unfold moved; coordinates; ring.
Qed.

(* ---- invariant graphs *)

Section Graph.

Variables (ws : list wave) (c : vec) (u : vec -> R) (u' : vec -> vec).
Hypotheses (period : periodic u) (gradient : has_gradient u u').
Hypothesis invariant : invariant_graph ws c u'.

Let psi (y : vec) : vec := plus c (u' y).
Let f (y : vec) : vec := plus y (minus (psi y) (V' ws y)).
Let g (y : vec) : vec := minus y (psi y).
Let H (y z : vec) : R := h ws y z + u y - u z + dot c (minus y z).

(* That the graph is invariant, in these terms. *)
Lemma psi_f y : psi (f y) = minus (psi y) (V' ws y).
Proof. symmetry; apply invariant. Qed.

Lemma g_f y : g (f y) = y.
Proof. unfold g; rewrite psi_f; apply vec_eq; unfold f; coordinates; ring. Qed.

(* The derivatives of H with respect to the coordinates of the first point *)
Lemma H_first0 y z :
  is_derive (fun a : R => H (a, snd y) z) (fst y) (fst y - fst z - fst (V' ws y) + fst (psi y)).
Proof.
  destruct (V_gradient ws) as [DV _], gradient as [Du _].
  specialize (DV y); specialize (Du y); apply is_derive_Reals in DV; apply is_derive_Reals in Du.
  pose (k := (snd z - snd y) * (snd z - snd y) / 2 - u z + snd c * (snd y - snd z)).
  replace (_ + fst (psi y)) with (fst y - fst z + fst c - fst (V' ws y) + fst (u' y))
    by (unfold psi; coordinates; ring).
  generalize (quadratic _ _ (fst z) (fst c) (k - fst c * fst z) _ _ _ DV Du); apply derive_ext.
  intros a; unfold k, H, h; coordinates; field.
Qed.

Lemma H_first1 y z :
  is_derive (fun b : R => H (fst y, b) z) (snd y) (snd y - snd z - snd (V' ws y) + snd (psi y)).
Proof.
  destruct (V_gradient ws) as [_ [DV _]], gradient as [_ [Du _]].
  specialize (DV y); specialize (Du y); apply is_derive_Reals in DV; apply is_derive_Reals in Du.
  pose (k := (fst z - fst y) * (fst z - fst y) / 2 - u z + fst c * (fst y - fst z)).
  replace (_ + snd (psi y)) with (snd y - snd z + snd c - snd (V' ws y) + snd (u' y))
    by (unfold psi; coordinates; ring).
  generalize (quadratic _ _ (snd z) (snd c) (k - snd c * snd z) _ _ _ DV Du); apply derive_ext.
  intros b; unfold k, H, h; coordinates; field.
Qed.

(* and of the second. *)
Lemma H_second0 y z :
  is_derive (fun a : R => H y (a, snd z)) (fst z) (fst z - fst y - fst (psi z)).
Proof.
  destruct gradient as [Du _]; specialize (Du z); apply is_derive_Reals in Du.
  pose (k := (snd z - snd y) * (snd z - snd y) / 2 - V ws y + u y + snd c * (snd y - snd z)).
  replace (_ - fst (psi z)) with (fst z - fst y + - fst c - fst (u' z) + 0)
    by (unfold psi; coordinates; ring).
  generalize (quadratic _ _ (fst y) (- fst c) (k + fst c * fst y) _ _ _ Du (derive_const 0 _)).
  apply derive_ext; intros a; unfold k, H, h; coordinates; field.
Qed.

Lemma H_second1 y z :
  is_derive (fun b : R => H y (fst z, b)) (snd z) (snd z - snd y - snd (psi z)).
Proof.
  destruct gradient as [_ [Du _]]; specialize (Du z); apply is_derive_Reals in Du.
  pose (k := (fst z - fst y) * (fst z - fst y) / 2 - V ws y + u y + fst c * (fst y - fst z)).
  replace (_ - snd (psi z)) with (snd z - snd y + - snd c - snd (u' z) + 0)
    by (unfold psi; coordinates; ring).
  generalize (quadratic _ _ (snd y) (- snd c) (k + snd c * snd y) _ _ _ Du (derive_const 0 _)).
  apply derive_ext; intros b; unfold k, H, h; coordinates; field.
Qed.

(* H is continuous in the first point. *)
Lemma H_continuous z : continuous (fun y => H y z).
Proof.
  apply continuous_ball; unfold H, h; coordinates.
  pose proof (gradient_continuous _ _ gradient).
  pose proof (gradient_continuous _ _ (V_gradient ws)); continuity.
Qed.

(* A square about z holds a point where H y z is as small as anywhere, *)
Lemma H_grows z : exists r, low (fun y => H y z)
  (fun p => Rabs (fst p - fst z) <= r /\ Rabs (snd p - snd z) <= r).
Proof.
  destruct (V_bounded ws) as [A HA], (periodic_bounded u period) as [B HB].
  { apply continuous_ball, (gradient_continuous _ _ gradient). }
  pose (s := fst c * fst c + snd c * snd c + Rabs (A - B + u z - V ws z)).
  assert (s0 : 0 <= s) by (pose proof (Rabs_pos (A - B + u z - V ws z)); unfold s; nra).
  assert (far : forall a, 2 * (1 + s) < Rabs a -> s <= a * a / 4).
  { intros a Ha; replace (a * a) with (Rabs a * Rabs a) by (rewrite <- Rabs_mult;
      apply Rabs_right; nra); nra. }
  exists (2 * (1 + s)); intros y; specialize (HA y); specialize (HB y).
  destruct (Rle_or_lt (Rabs (fst y - fst z)) (2 * (1 + s))) as [h0 | h0];
    [destruct (Rle_or_lt (Rabs (snd y - snd z)) (2 * (1 + s))) as [h1 | h1];
      [exists y; repeat split; auto with real |] |];
    exists z; rewrite !Rminus_eq_0, Rabs_R0; (split; [split; lra |]).
  - apply far in h1; clear far; pose proof (Rle_abs (A - B + u z - V ws z)); unfold s in *.
    unfold H, h; coordinates.
    pose proof (Rle_0_sqr ((snd y - snd z) / 2 + snd c)); unfold Rsqr in *.
    pose proof (Rle_0_sqr (fst y - fst z + fst c)); unfold Rsqr in *; nra.
  - apply far in h0; clear far; pose proof (Rle_abs (A - B + u z - V ws z)); unfold s in *.
    unfold H, h; coordinates.
    pose proof (Rle_0_sqr ((fst y - fst z) / 2 + fst c)); unfold Rsqr in *.
    pose proof (Rle_0_sqr (snd y - snd z + snd c)); unfold Rsqr in *; nra.
Qed.

(* so H y z has a minimum for each z; it is where f(y) = z. *)
Lemma H_minimum z : exists p, f p = z /\ forall y, H p z <= H y z.
Proof.
  destruct (H_grows z) as [r square].
  destruct (minimum (fun y => H y z) z r (H_continuous z) square) as [p least].
  exists p; split; [| exact least].
  pose proof (least_derivative _ _ _ (H_first0 p z)) as E0.
  pose proof (least_derivative _ _ _ (H_first1 p z)) as E1.
  destruct p as [p0 p1]; specialize (E0 (fun s => least (s, p1))).
  specialize (E1 (fun s => least (p0, s))).
  apply vec_eq; unfold f; coordinates; lra.
Qed.

(* Hence f is a bijection with the inverse g, and H y z is least at y = g(z). *)
Lemma f_g z : f (g z) = z.
Proof. destruct (H_minimum z) as [p [<- _]]; now rewrite g_f. Qed.

Lemma H_least y z : H (g z) z <= H y z.
Proof. destruct (H_minimum z) as [p [<- least]]; rewrite g_f; apply least. Qed.

(* This least value does not depend on z. *)
Let M (z : vec) : R := H (g z) z.

(* M is continuous, being made of continuous functions; *)
Lemma M_continuous : everywhere M.
Proof.
  unfold M, H, h, g, psi; coordinates.
  pose proof (gradient_continuous _ _ gradient).
  pose proof (gradient_continuous _ _ (V_gradient ws)).
  destruct gradient as [_ [_ [C0 C1]]].
  rewrite continuous_ball in C0; rewrite continuous_ball in C1; continuity.
Qed.

(* and M(z) - M(y) is at most H(g(y), z) - H(g(y), y), which has the derivative zero at z = y along
   the lines e of the two coordinates. *)
Lemma M_line (e : R -> vec) :
  (forall t, Continuity.continuous (e : R -> R * R) t) ->
  (forall t, is_derive (fun s => H (g (e t)) (e s)) t 0) -> forall a b, M (e b) <= M (e a).
Proof.
  intros C D; apply (no_growth (fun t => M (e t))).
  - intros t; apply continuity_pt_filterlim.
    apply (continuous_comp e M t (C t)), M_continuous.
  - intros t eps Heps; destruct (flat _ t eps (D t) Heps) as [d [Hd near]].
    exists d; split; [exact Hd | intros s Hs; specialize (near s Hs)].
    pose proof (H_least (g (e t)) (e s)); unfold M; lra.
Qed.

(* One coordinate after the other. *)
Lemma M_constant y z : M z = M y.
Proof.
  enough (forall y z, M z <= M y) by (apply Rle_antisym; auto); clear y z.
  intros [y0 y1] [z0 z1]; apply Rle_trans with (M (y0, z1)).
  - apply (M_line (fun a => (a, z1))); intros t.
    + apply (continuous_comp_2 (fun t => t) (fun _ => z1) pair);
        [apply continuous_id | apply continuous_const |].
      apply (continuous_ext (fun y => y)); [now intros [? ?] | apply continuous_id].
    + replace 0 with (t - fst (g (t, z1)) - fst (psi (t, z1))).
      * exact (H_second0 (g (t, z1)) (t, z1)).
      * unfold g; coordinates; ring.
  - apply (M_line (fun b => (y0, b))); intros t.
    + apply (continuous_comp_2 (fun _ => y0) (fun t => t) pair);
        [apply continuous_const | apply continuous_id |].
      apply (continuous_ext (fun y => y)); [now intros [? ?] | apply continuous_id].
    + replace 0 with (t - snd (g (y0, t)) - snd (psi (y0, t))).
      * exact (H_second1 (g (y0, t)) (y0, t)).
      * unfold g; coordinates; ring.
Qed.

(* So H has its least value at each step of an orbit on the graph. *)
Lemma H_step x y z : H x (f x) <= H y z.
Proof.
  apply Rle_trans with (M z); [| apply H_least].
  rewrite (M_constant (f x) z); unfold M; rewrite g_f; lra.
Qed.

(* ---- orbits on the graph *)

(* Every point has one, both ways. *)
Lemma graph_orbit y : exists x : Z -> vec, x 0%Z = y /\ forall j, x (j + 1)%Z = f (x j).
Proof.
  exists (fun j => match j with Z0 => y | Zpos p => Pos.iter f y p | Zneg p => Pos.iter g y p end).
  split; [reflexivity | intros [| p | p]].
  - reflexivity.
  - change (Z.pos p + 1)%Z with (Z.pos (p + 1)); rewrite Pos.add_1_r; apply Pos.iter_succ.
  - destruct (Pos.succ_pred_or p) as [-> | E]; [symmetry; apply f_g |].
    rewrite <- E; replace (Z.neg (Pos.succ (Pos.pred p)) + 1)%Z with (Z.neg (Pos.pred p)) by lia.
    rewrite Pos.iter_succ; symmetry; apply f_g.
Qed.

(* It is one of the map. *)
Lemma is_orbit x : (forall j, x (j + 1)%Z = f (x j)) -> orbit ws x.
Proof.
  intros step j; pose proof (psi_f (x (j - 1)%Z)) as E.
  assert (prev : x j = f (x (j - 1)%Z)) by (rewrite <- step; f_equal; ring).
  rewrite step; rewrite <- prev in E; unfold f at 1; rewrite E.
  apply (f_equal (fun v => minus v (x (j - 1)%Z))) in prev.
  unfold f in prev; apply vec_eq; [apply (f_equal fst) in prev | apply (f_equal snd) in prev];
    coordinates; lra.
Qed.

(* Each finite piece has the least action among all sequences with the same ends. *)
Lemma graph_least x : (forall j, x (j + 1)%Z = f (x j)) -> forall z k s,
  z s = x s -> z (s + Z.of_nat k)%Z = x (s + Z.of_nat k)%Z ->
  action ws x s k <= action ws z s k.
Proof.
  intros step z k s; set (U y := u y + dot c y).
  enough (E : action ws x s k + U (x s) - U (x (s + Z.of_nat k)%Z) <=
          action ws z s k + U (z s) - U (z (s + Z.of_nat k)%Z))
    by (intros E0 E1; rewrite E0, E1 in E; lra).
  revert s; induction k as [| k IH]; intros s.
  - replace (s + Z.of_nat 0)%Z with s by lia; simpl action; lra.
  - specialize (IH (s + 1)%Z); simpl action.
    replace (s + 1 + Z.of_nat k)%Z with (s + Z.of_nat (S k))%Z in IH by lia.
    pose proof (H_step (x s) (z s) (z (s + 1)%Z)) as E; rewrite <- step in E.
    unfold H in E; unfold U in *; coordinates; lra.
Qed.

End Graph.

(* ---- the theorems *)

(* The graph's orbit through any of its points: its second variation is nowhere negative. *)
Theorem graph_orbits_minimize ws c S S' :
  periodic S -> has_gradient S S' -> invariant_graph ws c S' ->
  forall y, exists x : Z -> vec, orbit ws x /\ x 0%Z = y /\
  (forall j, x (j + 1)%Z = fst (F ws (x j, plus c (S' (x j))))) /\
  forall n s k, zero_outside n s k -> 0 <= variation ws x n s k.
Proof.
  intros period gradient invariant y.
  destruct (graph_orbit ws c S S' period gradient invariant y) as [x [start step]].
  exists x; split; [| split; [exact start | split; [exact step |]]].
  - exact (is_orbit ws c S' invariant x step).
  - intros n s k Z; apply least_variation; [exact Z | intros z E0 E1].
    apply (graph_least ws c S S' period gradient invariant x step); [exact E0 |].
    replace (s - 1 + Z.of_nat (Datatypes.S k))%Z with (s + Z.of_nat k)%Z by lia; exact E1.
Qed.

Theorem graphs_minimize ws c S S' :
  periodic S -> has_gradient S S' -> invariant_graph ws c S' ->
  forall y, exists x : Z -> vec, orbit ws x /\ x 0%Z = y /\
  forall n s k, zero_outside n s k -> 0 <= variation ws x n s k.
Proof.
  intros period gradient invariant y.
  destruct (graph_orbits_minimize ws c S S' period gradient invariant y) as [x [O [start [_ G]]]].
  now exists x.
Qed.

(* So there is no invariant graph where no orbit through some point minimizes, *)
Theorem no_graph patch xstar :
  no_minimizing_orbit patch xstar -> forall t, in_cube t -> no_invariant_graph (waves patch t).
Proof.
  intros none t cube c S S' period gradient invariant.
  destruct (graphs_minimize _ c S S' period gradient invariant (point xstar))
    as [x [O [start least]]].
  destruct (none t cube x O start) as [n [s [k [Z neg]]]].
  specialize (least n s k Z); lra.
Qed.

(* and none that leads from the point into a region into which no minimizing orbit goes. *)
Theorem no_graph_into r patch xstar :
  no_minimizing_orbit_into r patch xstar -> forall t, in_cube t ->
  forall c S S', periodic S -> has_gradient S S' -> invariant_graph (waves patch t) c S' ->
  ~ into r (fst (F (waves patch t) (point xstar, plus c (S' (point xstar))))).
Proof.
  intros none t cube c S S' period gradient invariant inside.
  destruct (graph_orbits_minimize _ c S S' period gradient invariant (point xstar))
    as [x [O [start [step least]]]].
  rewrite <- start, <- step in inside.
  destruct (none t cube x O start inside) as [n [s [k [Z neg]]]].
  specialize (least n s k Z); lra.
Qed.

(* The two statements of Map.v exclude each other. *)
Theorem none_or_one ws : no_invariant_graph ws <-> ~ has_invariant_graph ws.
Proof.
  split.
  - intros none (c & S & S' & period & gradient & invariant); exact (none c S S' period gradient invariant).
  - intros none c S S' period gradient invariant; apply none; now exists c, S, S'.
Qed.
