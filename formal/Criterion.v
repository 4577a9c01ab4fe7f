(* From finitely many sites to orbits that are not minimizing: what is true of every map of Map.v,
   by real analysis alone.  docs/proofs/argument.md has the same in words, sections 3, 4 and 7. *)

From Coq Require Import Reals ZArith QArith Qreals List Permutation Lra Lia.
From Converse Require Import Map.
Import ListNotations.
Open Scope R_scope.

(* ---- sums, vectors and the second variation *)

Lemma sum_ext {A} (f g : A -> R) l : (forall a, In a l -> f a = g a) -> sum f l = sum g l.
Proof.
  induction l as [|a l IH]; intros H; [reflexivity|].
  cbn. rewrite (H a) by now left. f_equal. apply IH. intros b Hb. apply H. now right.
Qed.

Lemma sum_le {A} (f g : A -> R) l : (forall a, In a l -> f a <= g a) -> sum f l <= sum g l.
Proof.
  induction l as [|a l IH]; intros H; [apply Rle_refl|].
  apply Rplus_le_compat; [apply H; now left | apply IH; intros b Hb; apply H; now right].
Qed.

Lemma sum_map {A B} (f : B -> R) (g : A -> B) l : sum f (map g l) = sum (fun a => f (g a)) l.
Proof. induction l as [|a l IH]; [reflexivity | cbn; now f_equal]. Qed.

Lemma sum_scale {A} (f : A -> R) c l : sum (fun a => c * f a) l = c * sum f l.
Proof. induction l as [|a l IH]; cbn; [ring | fold (sum f l); setoid_rewrite IH; ring]. Qed.

Lemma sum_plus {A} (f g : A -> R) l : sum (fun a => f a + g a) l = sum f l + sum g l.
Proof. induction l as [|a l IH]; cbn; [ring | setoid_rewrite IH; unfold sum; ring]. Qed.

Lemma sum_permutation {A} (f : A -> R) l l' : Permutation l l' -> sum f l = sum f l'.
Proof. induction 1; cbn in *; unfold sum in *; lra. Qed.

Lemma dot_scale a v : dot (scale a v) (scale a v) = a * a * dot v v.
Proof. unfold dot, scale; cbn; ring. Qed.

Lemma dot_zero_r v : dot v (0, 0) = 0.
Proof. unfold dot; cbn; ring. Qed.

Lemma dot_pos v : 0 <= dot v v.
Proof. unfold dot; nra. Qed.

Lemma vec_eq (u v : vec) : fst u = fst v -> snd u = snd v -> u = v.
Proof. destruct u, v; cbn; congruence. Qed.

Lemma beta_zero ws y : beta ws y (0, 0) = 0.
Proof.
  unfold beta. rewrite (sum_ext _ (fun w => 0 * amplitude w)), sum_scale.
  - unfold dot; cbn; ring.
  - intros w _. unfold along; cbn; ring.
Qed.

(* The second variation depends on n at its sites and the next, and on x through the betas. *)
Lemma variation_ext ws ws' x x' n n' k : forall s,
  (forall j v, (s <= j < s + Z.of_nat k)%Z -> beta ws (x j) v = beta ws' (x' j) v) ->
  (forall j, (s <= j <= s + Z.of_nat k)%Z -> n j = n' j) ->
  variation ws x n s k = variation ws' x' n' s k.
Proof.
  induction k as [|k IH]; intros s Hx Hn; [reflexivity|].
  cbn [variation]. rewrite Hx, !Hn by lia. f_equal. apply IH; intros; [apply Hx | apply Hn]; lia.
Qed.

(* One site more at the end. *)
Lemma variation_snoc ws x n k : forall s,
  variation ws x n s (S k) =
  variation ws x n s k
  + (beta ws (x (s + Z.of_nat k)%Z) (n (s + Z.of_nat k)%Z)
     - 2 * dot (n (s + Z.of_nat k)%Z) (n (s + Z.of_nat k + 1)%Z)).
Proof.
  induction k as [|k IH]; intros s; [cbn; rewrite Z.add_0_r; ring|].
  change (variation ws x n s (S (S k))) with
    (beta ws (x s) (n s) - 2 * dot (n s) (n (s + 1)%Z) + variation ws x n (s + 1) (S k)).
  rewrite IH. cbn [variation]. replace (s + 1 + Z.of_nat k)%Z with (s + Z.of_nat (S k))%Z by lia.
  ring.
Qed.

(* ---- tails *)

Definition put (n : Z -> vec) (j : Z) (v : vec) : Z -> vec := fun i => if Z.eqb i j then v else n i.

Lemma put_here n j v : put n j v j = v.
Proof. unfold put. now rewrite Z.eqb_refl. Qed.

Lemma put_else n j v i : i <> j -> put n j v i = n i.
Proof. intros H. unfold put. now rewrite (proj2 (Z.eqb_neq i j) H). Qed.

(* What is negative in (1) of docs/proofs/argument.md. *)
Definition ended ws x l (n : Z -> vec) s k : R :=
  variation ws x n s (S k)
  - l * (dot (n s) (n s) + dot (n (s + Z.of_nat k)%Z) (n (s + Z.of_nat k)%Z)).

Section Tails.
Variables (ws : list wave) (x : Z -> vec) (B l : R).
Hypothesis largest : forall y v, beta ws y v <= B * dot v v.
Hypothesis l_range : 0 < l < 1.
Hypothesis B_le : B <= l + / l.

(* What one more vector adds: l times the last one, at the next place, does not raise [ended]. *)
Lemma tail_step y v : beta ws y (scale l v) <= l * dot v v + l * dot (scale l v) (scale l v).
Proof.
  eapply Rle_trans; [apply largest|]. rewrite dot_scale.
  apply Rle_trans with ((l + / l) * (l * l * dot v v)).
  - apply Rmult_le_compat_r; [|assumption]. pose proof (dot_pos v). nra.
  - apply Req_le. field. lra.
Qed.

Lemma extend_right n s k : zero_outside n s (S k) ->
  let n' := put n (s + Z.of_nat (S k)) (scale l (n (s + Z.of_nat k)%Z)) in
  zero_outside n' s (S (S k)) /\ ended ws x l n' s (S k) <= ended ws x l n s k.
Proof.
  intros Hn n'. set (t := (s + Z.of_nat k)%Z) in *.
  assert (Hlast : n' (t + 1)%Z = scale l (n t)).
  { unfold n'. replace (s + Z.of_nat (S k))%Z with (t + 1)%Z by (unfold t; lia). apply put_here. }
  assert (Hother : forall j, j <> (t + 1)%Z -> n' j = n j).
  { intros j Hj. apply put_else. unfold t in Hj. lia. }
  split.
  - intros j Hj. rewrite Hother by (unfold t; lia). apply Hn. lia.
  - unfold ended. fold t. rewrite 3!variation_snoc. fold t.
    replace (s + Z.of_nat (S k))%Z with (t + 1)%Z by (unfold t; lia).
    rewrite (variation_ext ws ws x x n' n) by (intros; (apply Hother; unfold t; lia) || easy).
    rewrite Hlast, (Hother t), (Hother s), (Hother (t + 1 + 1)%Z) by (unfold t; lia).
    rewrite (Hn (t + 1)%Z), (Hn (t + 1 + 1)%Z), !dot_zero_r by (unfold t; lia).
    pose proof (tail_step (x (t + 1)%Z) (n t)) as Hstep.
    replace (dot (n t) (scale l (n t))) with (l * dot (n t) (n t))
      by (unfold dot, scale; cbn; ring).
    lra.
Qed.

Lemma extend_left n s k : zero_outside n s (S k) ->
  let n' := put n (s - 1) (scale l (n s)) in
  zero_outside n' (s - 1) (S (S k)) /\ ended ws x l n' (s - 1) (S k) <= ended ws x l n s k.
Proof.
  intros Hn n'.
  assert (Hfirst : n' (s - 1)%Z = scale l (n s)) by apply put_here.
  assert (Hother : forall j, j <> (s - 1)%Z -> n' j = n j) by (intros; now apply put_else).
  split.
  - intros j Hj. rewrite Hother by lia. apply Hn. lia.
  - unfold ended. replace (s - 1 + Z.of_nat (S k))%Z with (s + Z.of_nat k)%Z by lia.
    change (variation ws x n' (s - 1) (S (S k))) with
      (beta ws (x (s - 1)%Z) (n' (s - 1)%Z) - 2 * dot (n' (s - 1)%Z) (n' (s - 1 + 1)%Z)
       + variation ws x n' (s - 1 + 1) (S k)).
    replace (s - 1 + 1)%Z with s by lia.
    rewrite (variation_ext ws ws x x n' n) by (intros; (apply Hother; lia) || easy).
    rewrite Hfirst, (Hother s), (Hother (s + Z.of_nat k)%Z) by lia.
    pose proof (tail_step (x (s - 1)%Z) (n s)) as Hstep.
    replace (dot (scale l (n s)) (n s)) with (l * dot (n s) (n s))
      by (unfold dot, scale; cbn; ring).
    lra.
Qed.

(* With tails of K vectors on both sides the ends are as small as one likes. *)
Lemma extend K n s k : zero_outside n s (S k) ->
  exists n' s' k', zero_outside n' s' (S k') /\ ended ws x l n' s' k' <= ended ws x l n s k /\
  dot (n' s') (n' s') + dot (n' (s' + Z.of_nat k')%Z) (n' (s' + Z.of_nat k')%Z)
  = (l * l) ^ K * (dot (n s) (n s) + dot (n (s + Z.of_nat k)%Z) (n (s + Z.of_nat k)%Z)).
Proof.
  intros Hn. induction K as [|K (n1 & s1 & k1 & H1 & Hle1 & Hends)].
  - exists n, s, k. split; [exact Hn | split; [apply Rle_refl | cbn; ring]].
  - destruct (extend_right n1 s1 k1 H1) as [H2 Hle2].
    set (n2 := put n1 _ _) in *.
    destruct (extend_left n2 s1 (S k1) H2) as [H3 Hle3].
    set (n3 := put n2 _ _) in *.
    exists n3, (s1 - 1)%Z, (S (S k1)). split; [exact H3 | split; [lra |]].
    replace (s1 - 1 + Z.of_nat (S (S k1)))%Z with (s1 + Z.of_nat (S k1))%Z by lia.
    unfold n3. rewrite put_here, put_else by lia.
    unfold n2. rewrite put_here, put_else by lia.
    rewrite !dot_scale, <- Rmult_plus_distr_l, Hends. cbn [pow]. ring.
Qed.

Lemma ended_refuted n s k : zero_outside n s (S k) -> ended ws x l n s k < 0 -> refuted ws x.
Proof.
  intros Hn Hneg.
  set (e := dot (n s) (n s) + dot (n (s + Z.of_nat k)%Z) (n (s + Z.of_nat k)%Z)) in *.
  assert (He : 0 <= e) by (apply Rplus_le_le_0_compat; apply dot_pos).
  assert (Hgap : 0 < - ended ws x l n s k / (e + 1)) by (apply Rdiv_lt_0_compat; lra).
  destruct (pow_lt_1_zero (l * l)) with (2 := Hgap) as [K HK]; [rewrite Rabs_pos_eq; nra|].
  specialize (HK K (le_n K)).
  destruct (extend K n s k Hn) as (n' & s' & k' & Hn' & Hle & Hends).
  exists n', s', (S k'). split; [assumption|].
  unfold ended at 1 in Hle. rewrite Hends in Hle. fold e in Hle.
  assert (Hp : 0 <= (l * l) ^ K) by (apply pow_le; nra).
  rewrite Rabs_pos_eq in HK by assumption.
  apply (Rmult_lt_compat_r (e + 1)) in HK; [|lra].
  unfold Rdiv in HK. rewrite Rmult_assoc, Rinv_l, Rmult_1_r in HK by lra.
  assert (l * ((l * l) ^ K * e) <= (l * l) ^ K * e)
    by (pose proof (Rmult_le_pos _ _ Hp He); nra).
  nra.
Qed.

End Tails.

(* A negative window, with l for the infinite tails on either side, refutes.  x is any sequence. *)
Theorem window_refuted : forall ws x B l, (forall y v, beta ws y v <= B * dot v v) ->
  0 < l < 1 -> B <= l + / l -> forall n s k, zero_outside n s (S k) ->
  variation ws x n s (S k)
  - l * (dot (n s) (n s) + dot (n (s + Z.of_nat k)%Z) (n (s + Z.of_nat k)%Z)) < 0 ->
  refuted ws x.
Proof. intros ws x B l HB Hl HBl n s k. exact (ended_refuted ws x B l HB Hl HBl n s k). Qed.

(* ---- what orbits and refutations depend on *)

Lemma refuted_ext ws ws' x x' : (forall j v, beta ws (x j) v = beta ws' (x' j) v) ->
  refuted ws x -> refuted ws' x'.
Proof.
  intros Hbeta (n & s & k & Hn & Hneg). exists n, s, k. split; [assumption|].
  rewrite <- (variation_ext ws ws' x x' n n); auto.
Qed.

Lemma orbit_ext ws ws' x : (forall y, V' ws y = V' ws' y) -> orbit ws x -> orbit ws' x.
Proof. intros HV Hx j. now rewrite <- HV. Qed.

(* ---- everything is periodic *)

Lemma sin_turns a (m : Z) : sin (a + 2 * PI * IZR m) = sin a.
Proof.
  assert (Hnat : forall b k, sin (b + 2 * PI * INR k) = sin b).
  { intros b k. rewrite <- (sin_period b k). f_equal. ring. }
  destruct (Z.le_gt_cases 0 m) as [Hm|Hm].
  - rewrite <- (Z2Nat.id m Hm), <- INR_IZR_INZ. apply Hnat.
  - rewrite <- (Hnat _ (Z.to_nat (- m))), INR_IZR_INZ, Z2Nat.id, opp_IZR by lia. f_equal. ring.
Qed.

Lemma cos_turns a (m : Z) : cos (a + 2 * PI * IZR m) = cos a.
Proof.
  rewrite !cos_sin. replace (PI / 2 + (a + 2 * PI * IZR m)) with (PI / 2 + a + 2 * PI * IZR m)
    by ring. apply sin_turns.
Qed.

Definition turns (i j : Z) : vec := (2 * PI * IZR i, 2 * PI * IZR j).

Lemma angle_turns w y i j :
  angle w (minus y (turns i j)) = angle w y + 2 * PI * IZR (- (k0 w * i + k1 w * j)).
Proof.
  unfold angle, along, minus, turns; cbn [fst snd]. rewrite opp_IZR, plus_IZR, !mult_IZR. ring.
Qed.

Lemma V'_turns ws y i j : V' ws (minus y (turns i j)) = V' ws y.
Proof.
  unfold V'. f_equal; f_equal; apply sum_ext; intros w _; now rewrite angle_turns, cos_turns.
Qed.

Lemma beta_turns ws y i j v : beta ws (minus y (turns i j)) v = beta ws y v.
Proof.
  unfold beta. f_equal. apply sum_ext. intros w _. now rewrite angle_turns, sin_turns.
Qed.

(* The orbit with x1 less some turns, and x0 as it was. *)
Definition shift (i j : Z) (x : Z -> vec) : Z -> vec :=
  fun m => minus (x m) (turns (i * m) (j * m)).

Lemma shifted ws x i j : orbit ws x ->
  orbit ws (shift i j x) /\ shift i j x 0%Z = x 0%Z /\
  (refuted ws (shift i j x) -> refuted ws x).
Proof.
  intros Hx. split; [|split].
  - intros m. unfold shift. rewrite (Hx m), V'_turns.
    apply vec_eq; unfold minus, scale, turns; cbn [fst snd];
      rewrite !mult_IZR, plus_IZR, minus_IZR; ring.
  - apply vec_eq; unfold shift, minus, turns; cbn [fst snd]; rewrite mult_IZR; ring.
  - apply refuted_ext. intros m v. apply beta_turns.
Qed.

(* ---- backwards in time *)

Definition reversed (x : Z -> vec) : Z -> vec := fun j => x (- j)%Z.

Lemma orbit_reversed ws x : orbit ws x -> orbit ws (reversed x).
Proof.
  intros Hx j. unfold reversed. replace (- (j + 1))%Z with (- j - 1)%Z by ring.
  replace (- (j - 1))%Z with (- j + 1)%Z by ring. rewrite (Hx (- j)%Z).
  apply vec_eq; unfold minus, scale; cbn [fst snd]; ring.
Qed.

(* What a sequence and its reversal add up to differs by the products at the two ends. *)
Lemma variation_reversed ws x n s k :
  variation ws (reversed x) (reversed n) (1 - s - Z.of_nat k) k =
  variation ws x n s k
  + 2 * dot (n (s + Z.of_nat k - 1)%Z) (n (s + Z.of_nat k)%Z) - 2 * dot (n (s - 1)%Z) (n s).
Proof.
  induction k as [|k IH]; [cbn; rewrite Z.add_0_r; ring|].
  rewrite (variation_snoc ws x n k s). cbn [variation].
  replace (1 - s - Z.of_nat (S k) + 1)%Z with (1 - s - Z.of_nat k)%Z by lia. rewrite IH.
  unfold reversed. replace (- (1 - s - Z.of_nat (S k)))%Z with (s + Z.of_nat k)%Z by lia.
  replace (- (1 - s - Z.of_nat k))%Z with (s + Z.of_nat k - 1)%Z by lia.
  replace (s + Z.of_nat (S k) - 1)%Z with (s + Z.of_nat k)%Z by lia.
  replace (s + Z.of_nat (S k))%Z with (s + Z.of_nat k + 1)%Z by lia.
  unfold dot. ring.
Qed.

Lemma refuted_reversed ws x : refuted ws (reversed x) -> refuted ws x.
Proof.
  intros (n & s & k & Hn & Hneg). exists (reversed n), (1 - s - Z.of_nat k)%Z, k. split.
  - intros j Hj. apply Hn. lia.
  - replace (variation ws x _ _ k)
      with (variation ws (reversed (reversed x)) (reversed n) (1 - s - Z.of_nat k) k).
    + rewrite (variation_reversed ws (reversed x) n s k), (Hn (s - 1)%Z), (Hn (s + Z.of_nat k)%Z)
        by lia.
      rewrite dot_zero_r. unfold dot in *; cbn [fst snd]. lra.
    + apply variation_ext; [|reflexivity]. intros j v _. unfold reversed.
      now rewrite Z.opp_involutive.
Qed.

(* ---- the regions of x1 *)

(* It is enough to look at the x1 of the region itself, not moved by turns. *)
Lemma into_rectangle r patch xstar :
  (forall t, in_cube t -> forall x, orbit (waves patch t) x -> x 0%Z = point xstar ->
   (exists v0 v1,
    Rabs (v0 - Q2R (centre0 r)) <= Q2R (half0 r) /\ Rabs (v1 - Q2R (centre1 r)) <= Q2R (half1 r) /\
    x 1%Z = (PI * (IZR (m00 r) * v0 + IZR (m01 r) * v1),
             PI * (IZR (m10 r) * v0 + IZR (m11 r) * v1))) ->
   refuted (waves patch t) x) ->
  no_minimizing_orbit_into r patch xstar.
Proof.
  intros H t Ht x Hx Hx0 (v0 & v1 & i & j & Hv0 & Hv1 & Hx1).
  destruct (shifted _ _ i j Hx) as (Hx' & Hx0' & Hrefuted).
  apply Hrefuted, (H t Ht); [assumption | now rewrite Hx0' |].
  exists v0, v1. repeat split; try assumption.
  unfold shift. rewrite Hx1, !Z.mul_1_r.
  apply vec_eq; unfold minus, turns; cbn [fst snd]; ring.
Qed.

(* ---- the turned frame: the sum and the difference of the angles, halved *)

Definition turned (ws : list wave) : list wave :=
  map (fun w => Wave (k0 w + k1 w) (k0 w - k1 w) (phase w) (amplitude w / 2)) ws.

Definition turn (y : vec) : vec := ((fst y + snd y) / 2, (fst y - snd y) / 2).

Definition turn_back (v : vec) : vec := (fst v + snd v, fst v - snd v).

Lemma turn_back_turn y : turn_back (turn y) = y.
Proof. apply vec_eq; unfold turn, turn_back; cbn; field. Qed.

Lemma V'_turned ws y : V' (turned ws) (turn y) = turn (V' ws y).
Proof.
  assert (Hangle : forall w : wave,
    angle (Wave (k0 w + k1 w) (k0 w - k1 w) (phase w) (amplitude w / 2)) (turn y) = angle w y).
  { intros w. unfold angle, along, turn; cbn. rewrite plus_IZR, minus_IZR. field. }
  unfold V', turned, turn; cbn [fst snd]. rewrite !sum_map; cbn [k0 k1 amplitude]. f_equal.
  - rewrite (sum_ext _ (fun w => / 2 * (IZR (k0 w) * (amplitude w * cos (angle w y))
                                        + IZR (k1 w) * (amplitude w * cos (angle w y))))).
    + rewrite sum_scale, sum_plus. field.
    + intros w _. fold (turn y). rewrite Hangle, plus_IZR. field.
  - rewrite (sum_ext _ (fun w => / 2 * (IZR (k0 w) * (amplitude w * cos (angle w y))
                                        + - 1 * (IZR (k1 w) * (amplitude w * cos (angle w y)))))).
    + rewrite sum_scale, sum_plus, sum_scale. field.
    + intros w _. fold (turn y). rewrite Hangle, minus_IZR. field.
Qed.

Lemma beta_turned ws y v : 2 * beta (turned ws) y v = beta ws (turn_back y) (turn_back v).
Proof.
  unfold beta, turned. rewrite sum_map.
  rewrite (sum_ext _ (fun w => / 2 * (amplitude w * sin (angle w (turn_back y))
                                      * (along w (turn_back v) * along w (turn_back v))))).
  - rewrite sum_scale. unfold dot, turn_back; cbn [fst snd]. field.
  - intros w _. unfold angle, along, turn_back; cbn [k0 k1 phase amplitude fst snd].
    rewrite plus_IZR, minus_IZR.
    replace ((IZR (k0 w) + IZR (k1 w)) * fst y + (IZR (k0 w) - IZR (k1 w)) * snd y + phase w)
      with (IZR (k0 w) * (fst y + snd y) + IZR (k1 w) * (fst y - snd y) + phase w) by ring.
    field.
Qed.

Lemma dot_turn_back u v : dot (turn_back u) (turn_back v) = 2 * dot u v.
Proof. unfold dot, turn_back; cbn; ring. Qed.

Lemma orbit_turned ws x : orbit ws x -> orbit (turned ws) (fun j => turn (x j)).
Proof.
  intros Hx j. cbn beta. rewrite V'_turned, (Hx j).
  apply vec_eq; unfold turn, minus, scale; cbn [fst snd]; field.
Qed.

Lemma refuted_turned ws x : refuted (turned ws) (fun j => turn (x j)) -> refuted ws x.
Proof.
  intros (nu & s & k & Hnu & Hneg). exists (fun j => turn_back (nu j)), s, k. split.
  - intros j Hj. rewrite (Hnu j Hj). apply vec_eq; unfold turn_back; cbn; ring.
  - enough (H : variation ws x (fun j => turn_back (nu j)) s k =
                2 * variation (turned ws) (fun j => turn (x j)) nu s k) by lra.
    clear Hnu Hneg. revert s. induction k as [|k IH]; intros s; cbn [variation]; [ring|].
    rewrite IH, dot_turn_back, Rmult_plus_distr_l, Rmult_minus_distr_l, beta_turned, turn_back_turn.
    reflexivity.
Qed.

Lemma largest_turned ws B : (forall y v, beta ws y v <= B * dot v v) ->
  forall y v, beta (turned ws) y v <= B * dot v v.
Proof.
  intros HB y v. pose proof (HB (turn_back y) (turn_back v)) as H.
  rewrite <- beta_turned, dot_turn_back in H. lra.
Qed.

(* ---- the mirror: the coordinates exchanged *)

Definition swap (y : vec) : vec := (snd y, fst y).

Definition exchange (w : wave) : wave := Wave (k1 w) (k0 w) (phase w) (amplitude w).

Lemma along_exchange w y : along (exchange w) (swap y) = along w y.
Proof. unfold along, exchange, swap; cbn. ring. Qed.

Lemma angle_exchange w y : angle (exchange w) (swap y) = angle w y.
Proof. unfold angle. now rewrite along_exchange. Qed.

Lemma swap_swap y : swap (swap y) = y.
Proof. now destruct y. Qed.

Lemma V'_swap ws y : V' (map exchange ws) (swap y) = swap (V' ws y).
Proof.
  unfold V', swap at 3; cbn [fst snd]. rewrite !sum_map.
  f_equal; f_equal; apply sum_ext; intros w _; now rewrite angle_exchange.
Qed.

Lemma beta_swap ws y v : beta (map exchange ws) (swap y) (swap v) = beta ws y v.
Proof.
  unfold beta. rewrite sum_map. f_equal.
  - unfold dot, swap; cbn. ring.
  - apply sum_ext. intros w _. now rewrite angle_exchange, along_exchange.
Qed.

Lemma orbit_swap ws x : orbit ws x -> orbit (map exchange ws) (fun j => swap (x j)).
Proof. intros Hx j. cbn beta. now rewrite V'_swap, (Hx j). Qed.

Lemma refuted_swap ws x : refuted (map exchange ws) (fun j => swap (x j)) -> refuted ws x.
Proof.
  intros (n & s & k & Hn & Hneg). exists (fun j => swap (n j)), s, k. split.
  - intros j Hj. now rewrite (Hn j Hj).
  - enough (H : variation ws x (fun j => swap (n j)) s k =
                variation (map exchange ws) (fun j => swap (x j)) n s k) by lra.
    clear Hn Hneg. revert s. induction k as [|k IH]; intros s; cbn [variation]; [reflexivity|].
    rewrite IH, <- (beta_swap ws (x s)), swap_swap. unfold dot, swap; cbn. ring.
Qed.

Lemma largest_swap ws B : (forall y v, beta ws y v <= B * dot v v) ->
  forall y v, beta (map exchange ws) y v <= B * dot v v.
Proof.
  intros HB y v. rewrite <- (swap_swap y), <- (swap_swap v), beta_swap.
  eapply Rle_trans; [apply HB|]. unfold dot, swap; cbn. lra.
Qed.

(* ---- product maps: each coordinate is alone *)

(* The orbit whose second coordinate is free. *)
Definition free1 (x : Z -> vec) : Z -> vec :=
  fun j => (fst (x j), snd (x 0%Z) + IZR j * (snd (x 1%Z) - snd (x 0%Z))).
Definition free0 (x : Z -> vec) : Z -> vec :=
  fun j => (fst (x 0%Z) + IZR j * (fst (x 1%Z) - fst (x 0%Z)), snd (x j)).

(* The waves that the one coordinate feels. *)
Definition feels0 (w : wave) : bool := negb (Z.eqb (k0 w) 0).
Definition feels1 (w : wave) : bool := negb (Z.eqb (k1 w) 0).

Lemma sum_filter {A} (p : A -> bool) f g l :
  (forall a, In a l -> p a = true -> g a = f a) -> (forall a, In a l -> p a = false -> g a = 0) ->
  sum f (filter p l) = sum g l.
Proof.
  induction l as [|a l IH]; intros Hin Hout; [reflexivity|].
  assert (IH' : sum f (filter p l) = sum g l)
    by (apply IH; intros b Hb; [apply Hin | apply Hout]; now right).
  cbn. destruct (p a) eqn:Hp.
  - cbn. rewrite (Hin a (or_introl eq_refl) Hp). now f_equal.
  - rewrite (Hout a (or_introl eq_refl) Hp), Rplus_0_l. exact IH'.
Qed.

(* A sequence of numbers that ends with 0 has a positive free second variation. *)
Fixpoint free_variation (b : Z -> R) (s : Z) (k : nat) : R :=
  match k with
  | O => 0
  | S k => 2 * (b s * b s) - 2 * (b s * b (s + 1)%Z) + free_variation b (s + 1) k
  end.

Lemma free_variation_pos b k : forall s, b (s + Z.of_nat k)%Z = 0 -> 0 <= free_variation b s k.
Proof.
  assert (H : forall s, b s * b s - b (s + Z.of_nat k)%Z * b (s + Z.of_nat k)%Z
                        <= free_variation b s k).
  { induction k as [|k IH]; intros s; cbn [free_variation].
    - rewrite Z.add_0_r. lra.
    - specialize (IH (s + 1)%Z).
      replace (s + 1 + Z.of_nat k)%Z with (s + Z.of_nat (S k))%Z in IH by lia.
      pose proof (Rle_0_sqr (b s - b (s + 1)%Z)) as Hsqr. unfold Rsqr in Hsqr. lra. }
  intros s Hs. specialize (H s). rewrite Hs in H. nra.
Qed.

Section Alone.
Variable ws : list wave.
Hypothesis product : forall w, In w ws -> (k0 w * k1 w = 0)%Z.

(* A wave is felt by the first coordinate alone, or not at all. *)
Lemma felt_or_not w : In w ws ->
  (feels0 w = true -> k1 w = 0%Z) /\ (feels0 w = false -> k0 w = 0%Z).
Proof.
  intros Hw. specialize (product w Hw). unfold feels0. destruct (Z.eqb_spec (k0 w) 0); split.
  - discriminate.
  - auto.
  - intros _. nia.
  - discriminate.
Qed.

Lemma V'_felt y y' : fst y' = fst y -> V' (filter feels0 ws) y' = (fst (V' ws y), 0).
Proof.
  intros Hy. unfold V'; cbn [fst]. f_equal.
  - f_equal. apply sum_filter; intros w Hw Hp; destruct (felt_or_not w Hw) as [H1 H0].
    + unfold angle, along. now rewrite (H1 Hp), Hy, !Rmult_0_l.
    + rewrite (H0 Hp). ring.
  - rewrite (sum_filter _ _ (fun _ => 0 * 0)), sum_scale; [ring | | intros; ring].
    intros w Hw Hp. rewrite (proj1 (felt_or_not w Hw) Hp). ring.
Qed.

Lemma beta_felt y y' v : fst y' = fst y ->
  beta (filter feels0 ws) y' v = beta ws y (fst v, 0) + 2 * (snd v * snd v).
Proof.
  intros Hy. unfold beta.
  rewrite (sum_filter _ _ (fun w => amplitude w * sin (angle w y)
                                    * (along w (fst v, 0) * along w (fst v, 0)))).
  - unfold dot; cbn [fst snd]. ring.
  - intros w Hw Hp. unfold angle, along; cbn [fst snd].
    rewrite (proj1 (felt_or_not w Hw) Hp), Hy, !Rmult_0_l. ring.
  - intros w Hw Hp. unfold along; cbn [fst snd].
    rewrite (proj2 (felt_or_not w Hw) Hp). ring.
Qed.

Lemma variation_felt x x' n k : (forall j, fst (x' j) = fst (x j)) -> forall s,
  variation (filter feels0 ws) x' n s k =
  variation ws x (fun j => (fst (n j), 0)) s k + free_variation (fun j => snd (n j)) s k.
Proof.
  intros Hx. induction k as [|k IH]; intros s; cbn [variation free_variation]; [ring|].
  rewrite IH, (beta_felt (x s)) by apply Hx. unfold dot; cbn [fst snd]. ring.
Qed.

Lemma refuted_felt x x' : (forall j, fst (x' j) = fst (x j)) ->
  refuted (filter feels0 ws) x' -> refuted ws x.
Proof.
  intros Hx (n & s & k & Hn & Hneg). exists (fun j => (fst (n j), 0)), s, k. split.
  - intros j Hj. now rewrite (Hn j Hj).
  - rewrite (variation_felt x x') in Hneg by assumption.
    assert (0 <= free_variation (fun j => snd (n j)) s k); [|lra].
    apply free_variation_pos. rewrite Hn by lia. reflexivity.
Qed.

End Alone.

Theorem alone0 : forall ws x, (forall w, In w ws -> (k0 w * k1 w = 0)%Z) -> orbit ws x ->
  orbit (filter feels0 ws) (free1 x) /\ (refuted (filter feels0 ws) (free1 x) -> refuted ws x).
Proof.
  intros ws x Hws Hx. split; [|now apply refuted_felt].
  intros j. rewrite (V'_felt ws Hws (x j)) by reflexivity.
  apply vec_eq; unfold free1, minus, scale; cbn [fst snd].
  - now rewrite (Hx j).
  - rewrite plus_IZR, minus_IZR. ring.
Qed.

Lemma filter_exchange ws :
  filter feels0 (map exchange ws) = map exchange (filter feels1 ws).
Proof.
  induction ws as [|w ws IH]; [reflexivity|]. cbn. rewrite IH.
  change (feels0 (exchange w)) with (feels1 w). now destruct (feels1 w).
Qed.

Theorem alone1 : forall ws x, (forall w, In w ws -> (k0 w * k1 w = 0)%Z) -> orbit ws x ->
  orbit (filter feels1 ws) (free0 x) /\ (refuted (filter feels1 ws) (free0 x) -> refuted ws x).
Proof.
  intros ws x Hws Hx.
  assert (Hws' : forall w, In w (map exchange ws) -> (k0 w * k1 w = 0)%Z).
  { intros w' Hw'. apply in_map_iff in Hw' as (w & <- & Hw). cbn. rewrite Z.mul_comm. auto. }
  destruct (alone0 _ _ Hws' (orbit_swap ws x Hx)) as [Ho Hr].
  rewrite filter_exchange in Ho, Hr. split.
  - apply orbit_swap in Ho. rewrite map_map, (map_ext _ (fun w => w)), map_id in Ho.
    + exact Ho.
    + now intros [].
  - intros H. apply refuted_swap, Hr, refuted_swap.
    rewrite map_map, (map_ext _ (fun w => w)), map_id; [exact H | now intros []].
Qed.

(* ---- at once: all larger amplitudes, too *)

(* V is odd about z, but for a constant. *)
Definition odd_about (z : vec) (ws : list wave) : Prop :=
  forall w, In w ws -> exists m : Z, angle w z = IZR m * PI.

Lemma beta_scaled s ws y v : beta (scaled s ws) y v = 2 * dot v v - s * (2 * dot v v - beta ws y v).
Proof.
  unfold beta, scaled. rewrite sum_map.
  rewrite (sum_ext _ (fun w => s * (amplitude w * sin (angle w y) * (along w v * along w v)))).
  - rewrite sum_scale. ring.
  - intros w _. unfold angle, along; cbn [k0 k1 phase amplitude]. ring.
Qed.

Lemma beta_homogeneous ws y a v : beta ws y (scale a v) = a * a * beta ws y v.
Proof.
  unfold beta. rewrite dot_scale.
  rewrite (sum_ext _ (fun w => a * a * (amplitude w * sin (angle w y) * (along w v * along w v)))).
  - rewrite sum_scale. ring.
  - intros w _. unfold along, scale; cbn [fst snd]. ring.
Qed.

(* At the mirrored place beta - 2I is the opposite. *)
Lemma beta_mirrored z ws y v : odd_about z ws ->
  beta ws (minus (scale 2 z) y) v = 4 * dot v v - beta ws y v.
Proof.
  intros Hodd. unfold beta.
  rewrite (sum_ext _ (fun w => - 1 * (amplitude w * sin (angle w y) * (along w v * along w v)))).
  - rewrite sum_scale. ring.
  - intros w Hw. destruct (Hodd w Hw) as [m Hm].
    replace (angle w (minus (scale 2 z) y)) with (- angle w y + 2 * PI * IZR m).
    + rewrite sin_turns, sin_neg. ring.
    + replace (2 * PI * IZR m) with (2 * angle w z) by (rewrite Hm; ring).
      unfold angle, along, minus, scale; cbn [fst snd]. ring.
Qed.

(* 2 + sum of |p| |k|^2 bounds the eigenvalues. *)
Definition weight (w : wave) : R :=
  Rabs (amplitude w) * (IZR (k0 w) * IZR (k0 w) + IZR (k1 w) * IZR (k1 w)).

Lemma wave_bounded w a v :
  - 1 * (amplitude w * sin a * (along w v * along w v)) <= dot v v * weight w.
Proof.
  assert (Hsin : - (amplitude w * sin a) <= Rabs (amplitude w)).
  { eapply Rle_trans; [apply Rle_abs|]. rewrite Rabs_Ropp, Rabs_mult.
    rewrite <- (Rmult_1_r (Rabs (amplitude w))) at 2.
    apply Rmult_le_compat_l; [apply Rabs_pos|]. apply Rabs_le. pose proof (SIN_bound a). lra. }
  assert (Hcauchy : along w v * along w v
                    <= dot v v * (IZR (k0 w) * IZR (k0 w) + IZR (k1 w) * IZR (k1 w))).
  { unfold along, dot. pose proof (Rle_0_sqr (IZR (k0 w) * snd v - IZR (k1 w) * fst v)) as H.
    unfold Rsqr in H. lra. }
  apply (Rmult_le_compat_r (along w v * along w v)) in Hsin; [|nra].
  apply (Rmult_le_compat_l (Rabs (amplitude w))) in Hcauchy; [|apply Rabs_pos].
  unfold weight. lra.
Qed.

Lemma beta_bounded ws y v : beta ws y v <= (2 + sum weight ws) * dot v v.
Proof.
  pose proof (sum_le _ _ ws (fun w _ => wave_bounded w (angle w y) v)) as H.
  rewrite !sum_scale in H. unfold beta. lra.
Qed.

(* Every vector but zero is a multiple of a unit vector. *)
Lemma unit_vector v : 0 < dot v v -> exists a u, dot u u = 1 /\ v = scale a u.
Proof.
  intros Hv. set (a := sqrt (dot v v)).
  assert (Ha : 0 < a) by now apply sqrt_lt_R0.
  assert (Haa : a * a = dot v v) by (apply sqrt_sqrt; lra).
  exists a, (scale (/ a) v). split.
  - rewrite dot_scale, <- Haa. field. lra.
  - apply vec_eq; unfold scale; cbn; field; lra.
Qed.

(* The least bound of beta's eigenvalues, and places as near to it as one likes. *)
Lemma least_bound ws : exists B, (forall y v, beta ws y v <= B * dot v v) /\
  forall eps, 0 < eps -> exists y u, dot u u = 1 /\ B - eps < beta ws y u.
Proof.
  set (values := fun b => exists y u, dot u u = 1 /\ b = beta ws y u).
  destruct (completeness values) as [B [Hub Hleast]].
  - eexists. intros b (y & u & Hu & ->). pose proof (beta_bounded ws y u) as H.
    rewrite Hu, Rmult_1_r in H. exact H.
  - exists (beta ws (0, 0) (1, 0)), (0, 0), (1, 0). split; [unfold dot; cbn; ring | reflexivity].
  - exists B. split.
    + intros y v. destruct (Rle_lt_or_eq_dec 0 (dot v v) (dot_pos v)) as [Hv|Hv].
      * destruct (unit_vector v Hv) as (a & u & Hu & ->).
        rewrite beta_homogeneous, dot_scale, Hu.
        assert (beta ws y u <= B) by (apply Hub; now exists y, u).
        nra.
      * replace v with ((0, 0) : vec); [rewrite beta_zero, dot_zero_r; lra|].
        unfold dot in Hv. apply vec_eq; cbn; nra.
    + intros eps Heps. apply Classical_Prop.NNPP. intros Hnone.
      enough (B <= B - eps) by lra. apply Hleast. intros b (y & u & Hu & ->).
      apply Rnot_lt_le. intros H. apply Hnone. now exists y, u.
Qed.

(* For B above 10/3 the lesser root of l + 1/l = B is below 1/3. *)
Lemma lesser_root B : 10 / 3 < B -> exists l, 0 < l < 1 / 3 /\ B = l + / l.
Proof.
  intros HB. set (r := sqrt (B * B - 4)).
  assert (Hr : r * r = B * B - 4) by (apply sqrt_sqrt; nra).
  assert (Hr0 : 0 <= r) by apply sqrt_pos.
  exists ((B - r) / 2).
  assert (r < B) by nra.
  assert (B - 2 / 3 < r) by nra.
  split; [lra|].
  apply Rmult_eq_reg_r with ((B - r) / 2); [|lra].
  rewrite Rmult_plus_distr_r, Rinv_l by lra. nra.
Qed.

(* One site is enough: the mirror image of a place where beta has nearly its largest eigenvalue.
   This is Mather's 4/3 at both ends. *)
Lemma at_once_here ws z : odd_about z ws -> forall y v, beta ws y v < 2 / 3 * dot v v ->
  exists y', forall x, x 0%Z = y' -> refuted ws x.
Proof.
  intros Hodd y v Hyv.
  destruct (least_bound ws) as (B & HB & Hnear).
  assert (HB3 : 10 / 3 < B).
  { pose proof (HB (minus (scale 2 z) y) v) as H. rewrite (beta_mirrored z) in H by assumption.
    pose proof (dot_pos v). nra. }
  destruct (lesser_root B HB3) as (l & Hl & HBl).
  assert (Hroom : 0 < B - 4 + 2 * l).
  { apply Rmult_lt_reg_l with l; [lra|]. rewrite HBl.
    replace (l * (l + / l - 4 + 2 * l)) with ((1 - 3 * l) * (1 - l)) by (field; lra). nra. }
  destruct (Hnear _ Hroom) as (y1 & u & Hu & Hy1).
  exists (minus (scale 2 z) y1). intros x Hx.
  set (n := put (fun _ => (0, 0)) 0 u).
  apply (window_refuted ws x B l) with (n := n) (s := 0%Z) (k := 0%nat);
    [assumption | lra | lra | |].
  - intros j Hj. apply put_else. lia.
  - cbn [variation]. rewrite Z.add_0_l, Z.add_0_r.
    unfold n. rewrite put_here, put_else by lia. rewrite dot_zero_r, Hu, Hx.
    rewrite (beta_mirrored z) by assumption. lra.
Qed.

(* If for some place and vector beta is below 2/3, then for all larger amplitudes some point lies
   on no minimizing orbit. *)
Theorem at_once : forall ws z, odd_about z ws ->
  forall y v, beta ws y v < 2 / 3 * dot v v -> forall s, 1 <= s ->
  exists y', forall x, x 0%Z = y' -> refuted (scaled s ws) x.
Proof.
  intros ws z Hodd y v Hyv s Hs. apply (at_once_here _ z) with (y := y) (v := v).
  - intros w' Hw'. apply in_map_iff in Hw' as (w & <- & Hw). exact (Hodd w Hw).
  - rewrite beta_scaled. pose proof (dot_pos v). nra.
Qed.
