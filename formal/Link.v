(* Two points on one invariant graph.  Let f be the graph's map, which takes each angle to the next
   one on its orbit.  It is the gradient of a convex function, and its derivative, if it has one, is
   at least l and at most beta - l, l + 1/l >= B.  Without derivatives this says that two functions
   are convex with something to spare; and from that it follows how far f may move from x to x'
   (theorem link; docs/proofs/argument.md, Lemmas 9 and 10). *)

From Coq Require Import Reals ZArith List Lra Lia.
From Coquelicot Require Import Coquelicot.
From Converse Require Import Map.
From Converse Require Graph Criterion.
Import ListNotations.
Open Scope R_scope.

Ltac coordinates :=
  unfold dot, plus, minus, scale in *; simpl fst in *; simpl snd in *.

(* ---- one derivative after the other *)

(* The sum of what a step forwards and a step backwards cost, and its gradient; beta is the
   quadratic form of the second derivative. *)
Definition energy (ws : list wave) (y : vec) : R := dot y y - V ws y.
Definition energy' (ws : list wave) (y : vec) : vec := minus (scale 2 y) (V' ws y).

Definition line (y d : vec) (t : R) : vec := plus y (scale t d).

Lemma energy_line ws y d t :
  is_derive (fun t => energy ws (line y d t)) t (dot (energy' ws (line y d t)) d).
Proof.
  apply (Graph.derive_ext (fun t => dot y y + t * (2 * dot y d) + t * t * dot d d
                                    - V ws (line y d t))).
  { intros s. unfold energy, line. coordinates. ring. }
  eapply Graph.derive_minus; [| apply Graph.V_line |].
  - instantiate (1 := 2 * dot y d + 2 * t * dot d d). auto_derive; [exact I | ring].
  - unfold energy', line. coordinates. ring.
Qed.

Lemma energy_line' ws y d t :
  is_derive (fun t => dot (energy' ws (line y d t)) d) t (beta ws (line y d t) d).
Proof.
  apply (Graph.derive_ext (fun t => 2 * dot y d + 2 * t * dot d d - dot (V' ws (line y d t)) d)).
  { intros s. unfold energy', line. coordinates. ring. }
  eapply Graph.derive_minus; [| apply Graph.V_line' |].
  - instantiate (1 := 2 * dot d d). auto_derive; [exact I | ring].
  - unfold line. ring.
Qed.

(* What a bound of the second derivative is good for. *)
Lemma energy_rises ws y d k : (forall t, 0 <= t <= 1 -> beta ws (line y d t) d <= k) ->
  energy ws (plus y d) <= energy ws y + dot (energy' ws y) d + k / 2.
Proof.
  intros Hk. set (slope t := dot (energy' ws (line y d t)) d).
  assert (Hslope : forall t, 0 <= t <= 1 -> slope t <= slope 0 + k * t).
  { intros t Ht. destruct (Req_dec t 0) as [-> | Ht0]; [lra |].
    destruct (MVT_cor2 slope (fun t => beta ws (line y d t) d) 0 t) as (s & E & Hs); [lra | |].
    - intros s _. apply is_derive_Reals, energy_line'.
    - specialize (Hk s ltac:(lra)). rewrite Rminus_0_r in E. nra. }
  destruct (MVT_cor2 (fun t => energy ws (line y d t) - t * slope 0 - k * t * t / 2)
              (fun t => slope t - slope 0 - k * t) 0 1) as (s & E & Hs); [lra | |].
  - intros s _. apply is_derive_Reals.
    apply (Graph.derive_ext (fun t => energy ws (line y d t) - (t * slope 0 + k * t * t / 2)));
      [intros; ring |].
    eapply Graph.derive_minus; [apply energy_line | |].
    + instantiate (1 := slope 0 + k * s). auto_derive; [exact I | field].
    + unfold slope. ring.
  - specialize (Hslope s ltac:(lra)). cbv beta in E.
    assert (E1 : line y d 1 = plus y d) by (apply Graph.vec_eq; unfold line; coordinates; ring).
    assert (E0 : line y d 0 = y) by (apply Graph.vec_eq; unfold line; coordinates; ring).
    unfold slope at 1 in E. unfold slope in Hslope. unfold slope in E. rewrite E0, E1 in *. lra.
Qed.

(* ---- convex functions with the gradients f and its inverse g *)

Record dual (ws : list wave) (Phi Psi : vec -> R) (f g : vec -> vec) : Prop := Dual {
  below : forall y z, dot y z <= Phi y + Psi z;
  touch : forall y, Phi y + Psi (f y) = dot y (f y);
  f_g : forall z, f (g z) = z;
  g_f : forall y, g (f y) = y;
  total : exists M, forall y, Phi y + Psi y = energy ws y + M;
  slopes : forall y, plus (f y) (g y) = energy' ws y
}.

Lemma dual_sym ws Phi Psi f g : dual ws Phi Psi f g -> dual ws Psi Phi g f.
Proof.
  intros [below touch f_g g_f [M total] slopes]. constructor; auto.
  - intros y z. specialize (below z y). coordinates. lra.
  - intros z. specialize (touch (g z)). rewrite f_g in touch. coordinates. lra.
  - exists M. intros y. rewrite Rplus_comm. apply total.
  - intros y. rewrite <- slopes. apply Graph.vec_eq; coordinates; ring.
Qed.

(* Above its tangents by m/2 times the square of the distance. *)
Definition strong (m : R) (Phi : vec -> R) (f : vec -> vec) : Prop :=
  forall y d, Phi y + dot (f y) d + m / 2 * dot d d <= Phi (plus y d).

Section Dual.
Variables (ws : list wave) (Phi Psi : vec -> R) (f g : vec -> vec).
Hypothesis both : dual ws Phi Psi f g.

Lemma strong_0 : strong 0 Phi f.
Proof.
  intros y d. pose proof (touch _ _ _ _ _ both y) as E.
  pose proof (below _ _ _ _ _ both (plus y d) (f y)) as H. coordinates. lra.
Qed.

(* Below its tangents by as much as the energy, less what the other one is above them. *)
Lemma smooth m y d k : strong m Psi g -> (forall t, 0 <= t <= 1 -> beta ws (line y d t) d <= k) ->
  Phi (plus y d) <= Phi y + dot (f y) d + (k - m * dot d d) / 2.
Proof.
  intros Hm Hk. apply energy_rises in Hk. specialize (Hm y d).
  destruct (total _ _ _ _ _ both) as (M & E). pose proof (E y) as E0. pose proof (E (plus y d)) as E1.
  pose proof (slopes _ _ _ _ _ both y) as F.
  assert (F' : dot (f y) d + dot (g y) d = dot (energy' ws y) d) by
    (rewrite <- F; unfold dot, plus; simpl; ring).
  lra.
Qed.

Variables (B l : R).
Hypothesis largest : forall y v, beta ws y v <= B * dot v v.
Hypothesis l_range : 0 < l < 1.
Hypothesis B_le : B <= l + / l.

Lemma stronger m : 0 <= m <= l -> strong m Psi g -> strong (/ (l + / l - m)) Psi g.
Proof.
  intros Hmr Hm z e. set (b := l + / l - m).
  assert (Hl : 1 < / l) by (rewrite <- Rinv_1; apply Rinv_lt_contravar; lra).
  assert (Hb : 0 < b) by (unfold b; lra).
  set (y := g z). set (d := scale (/ b) e).
  assert (Hf : f y = z) by apply (f_g _ _ _ _ _ both).
  assert (Hs := smooth m y d (B * dot d d) Hm (fun t _ => largest _ d)).
  pose proof (below _ _ _ _ _ both (plus y d) (plus z e)) as Hbelow.
  pose proof (touch _ _ _ _ _ both y) as E. rewrite Hf in E, Hs.
  assert (Hd : dot d e = b * dot d d) by (unfold d; coordinates; field; lra).
  assert (He : / b * dot e e = b * dot d d) by (unfold d; coordinates; field; lra).
  assert (Hdd : 0 <= dot d d) by (unfold dot; nra).
  assert (Hbd : (B - m) * dot d d <= b * dot d d) by (apply Rmult_le_compat_r; unfold b; lra).
  change (Psi z + dot y e + / b / 2 * dot e e <= Psi (plus z e)).
  replace (/ b / 2 * dot e e) with (b * dot d d / 2) by (rewrite <- He; field; lra).
  replace (dot (plus y d) (plus z e)) with (dot y z + dot y e + dot z d + dot d e) in Hbelow
    by (unfold dot, plus; simpl; ring).
  lra.
Qed.

(* What is true of all numbers below is true of the least upper bound. *)
Theorem strong_l : strong l Psi g.
Proof.
  set (good m := 0 <= m <= l /\ strong m Psi g).
  assert (Hzero : good 0).
  { split; [lra |]. intros z e. pose proof (touch _ _ _ _ _ (dual_sym _ _ _ _ _ both) z) as E.
    pose proof (below _ _ _ _ _ (dual_sym _ _ _ _ _ both) (plus z e) (g z)) as H. coordinates. lra. }
  destruct (completeness good) as (s & Hub & Hleast).
  - exists l. intros m Hm. apply Hm.
  - now exists 0.
  - assert (Hs : 0 <= s <= l).
    { split; [now apply Hub | apply Hleast; intros m Hm; apply Hm]. }
    assert (Hgood : strong s Psi g).
    { intros z e. apply Rnot_lt_le. intros Hlt.
      set (gap := Psi z + dot (g z) e + s / 2 * dot e e - Psi (plus z e)) in *.
      assert (Hgap : 0 < gap) by (unfold gap; lra).
      assert (Hee : 0 <= dot e e) by (unfold dot; nra).
      assert (Hstep : 0 < gap / (dot e e + 1)) by (apply Rdiv_lt_0_compat; lra).
      assert (exists m, good m /\ s - gap / (dot e e + 1) < m) as (m & (_ & Hm) & Hms).
      { apply Classical_Prop.NNPP. intros Hnone. enough (s <= s - gap / (dot e e + 1)) by lra.
        apply Hleast. intros m Hm. apply Rnot_lt_le. intros H. apply Hnone. now exists m. }
      specialize (Hm z e). apply (Rmult_lt_compat_r (dot e e + 1)) in Hms; [| lra].
      replace ((s - gap / (dot e e + 1)) * (dot e e + 1)) with (s * (dot e e + 1) - gap) in Hms
        by (field; lra).
      unfold gap in *. nra. }
    destruct (Rle_lt_or_eq_dec s l) as [Hsl | ->]; [apply Hs | | exact Hgood].
    assert (Hl : 1 < / l) by (rewrite <- Rinv_1; apply Rinv_lt_contravar; lra).
    assert (Hb : 0 < l + / l - s) by lra.
    assert (good (/ (l + / l - s))) as H.
    { split; [split |].
      - apply Rlt_le. now apply Rinv_0_lt_compat.
      - rewrite <- (Rinv_inv l) at 3. apply Rinv_le_contravar; lra.
      - now apply stronger. }
    apply Hub in H. exfalso.
    apply (Rmult_le_compat_r (l + / l - s)) in H; [| lra]. rewrite Rinv_l in H by lra.
    assert (l * / l = 1) by (field; lra). nra.
Qed.
End Dual.

(* ---- how beta changes from place to place *)

Lemma sin_slow a b : Rabs (sin a - sin b) <= Rabs (a - b).
Proof.
  destruct (MVT_abs sin cos b a) as (c & E & _); [intros c _; apply derivable_pt_lim_sin |].
  rewrite E. pose proof (Rabs_pos (a - b)). assert (Rabs (cos c) <= 1) by
    (apply Rabs_le; pose proof (COS_bound c); lra). nra.
Qed.

Definition distance (y z : vec) : R := Rabs (fst y - fst z) + Rabs (snd y - snd z).

Lemma beta_slow ws : exists L, 0 <= L /\ forall y z v,
  beta ws y v <= beta ws z v + L * distance y z * dot v v.
Proof.
  induction ws as [| w ws (L & HL & IH)].
  { exists 0. split; [lra |]. intros y z v. unfold beta; simpl. lra. }
  set (s := Rabs (IZR (k0 w)) + Rabs (IZR (k1 w))).
  set (more := Rabs (amplitude w) * s * (s * s)).
  assert (Hs : 0 <= s) by (unfold s; pose proof (Rabs_pos (IZR (k0 w)));
    pose proof (Rabs_pos (IZR (k1 w))); lra).
  assert (Hmore : 0 <= more).
  { unfold more. apply Rmult_le_pos; [| nra]. apply Rmult_le_pos; [apply Rabs_pos | exact Hs]. }
  exists (L + more). split; [lra |]. intros y z v. rewrite !Graph.beta_cons. specialize (IH y z v).
  set (a := along w v).
  enough (amplitude w * (sin (angle w z) - sin (angle w y)) * (a * a)
          <= more * distance y z * dot v v) by lra.
  assert (Ha : a * a <= s * s * dot v v).
  { unfold a, s, along, dot.
    pose proof (Rabs_pos (IZR (k0 w))). pose proof (Rabs_pos (IZR (k1 w))).
    assert (E0 : IZR (k0 w) * IZR (k0 w) = Rabs (IZR (k0 w)) * Rabs (IZR (k0 w)))
      by (rewrite <- Rabs_mult; symmetry; apply Rabs_right; nra).
    assert (E1 : IZR (k1 w) * IZR (k1 w) = Rabs (IZR (k1 w)) * Rabs (IZR (k1 w)))
      by (rewrite <- Rabs_mult; symmetry; apply Rabs_right; nra).
    set (p := IZR (k0 w)) in *. set (q := IZR (k1 w)) in *. set (P := Rabs p) in *.
    set (Q := Rabs q) in *. set (v0 := fst v). set (v1 := snd v).
    pose proof (Rle_0_sqr (p * v1 - q * v0)) as Hsq. unfold Rsqr in Hsq.
    assert (0 <= 2 * (P * Q) * (v0 * v0 + v1 * v1)) by
      (apply Rmult_le_pos; [nra | nra]).
    replace ((P + Q) * (P + Q) * (v0 * v0 + v1 * v1)) with
      ((p * p + q * q) * (v0 * v0 + v1 * v1) + 2 * (P * Q) * (v0 * v0 + v1 * v1))
      by (rewrite E0, E1; ring).
    nra. }
  assert (Hsin : Rabs (sin (angle w z) - sin (angle w y)) <= s * distance y z).
  { eapply Rle_trans; [apply sin_slow |].
    replace (angle w z - angle w y) with
      (- (IZR (k0 w) * (fst y - fst z) + IZR (k1 w) * (snd y - snd z)))
      by (unfold angle, along; ring).
    rewrite Rabs_Ropp. eapply Rle_trans; [apply Rabs_triang |]. rewrite !Rabs_mult.
    unfold s, distance. pose proof (Rabs_pos (IZR (k0 w))). pose proof (Rabs_pos (IZR (k1 w))).
    pose proof (Rabs_pos (fst y - fst z)). pose proof (Rabs_pos (snd y - snd z)). nra. }
  assert (Hdist : 0 <= distance y z) by (unfold distance;
    pose proof (Rabs_pos (fst y - fst z)); pose proof (Rabs_pos (snd y - snd z)); lra).
  assert (Haa : 0 <= a * a) by nra.
  assert (Hvv : 0 <= dot v v) by (unfold dot; nra).
  eapply Rle_trans; [apply Rle_abs |].
  rewrite Rabs_mult, (Rabs_mult (amplitude w)), (Rabs_right (a * a)) by lra.
  apply Rle_trans with (Rabs (amplitude w) * (s * distance y z) * (s * s * dot v v)).
  - apply Rmult_le_compat; [| exact Haa | | exact Ha].
    + apply Rmult_le_pos; apply Rabs_pos.
    + apply Rmult_le_compat_l; [apply Rabs_pos | exact Hsin].
  - unfold more. apply Req_le. ring.
Qed.

(* ---- two points near each other *)

(* Symmetric matrices (a b; b d). *)
Definition form : Type := R * R * R.

Definition bil (D : form) (u v : vec) : R :=
  let '(a, b, d) := D in
  a * (fst u * fst v) + b * (fst u * snd v + snd u * fst v) + d * (snd u * snd v).

(* eps more along the diagonal. *)
Definition wider (D : form) (eps : R) : form := let '(a, b, d) := D in (a + eps, b, d + eps).

Lemma bil_wider D eps u v : bil (wider D eps) u v = bil D u v + eps * dot u v.
Proof. destruct D as [[a b] d]. unfold wider, bil, dot. ring. Qed.

Section Near.
Variables (ws : list wave) (Phi Psi : vec -> R) (f g : vec -> vec) (l : R).
Hypothesis both : dual ws Phi Psi f g.
Hypothesis strong_Phi : strong l Phi f.
Hypothesis strong_Psi : strong l Psi g.

(* The functions are between their bounds at a - v and at a + e + v. *)
Lemma between D a e v :
  (forall t, 0 <= t <= 1 -> beta ws (line (plus a e) v t) v <= bil D v v + 2 * l * dot v v) ->
  (forall t, 0 <= t <= 1 ->
   beta ws (line a (scale (-1) v) t) (scale (-1) v) <= bil D v v + 2 * l * dot v v) ->
  0 <= dot (minus (minus (f (plus a e)) (f a)) (scale l e)) (plus e (scale 2 v)) + bil D v v.
Proof.
  intros Hb Ha. set (b := plus a e) in *.
  apply (smooth ws Phi Psi f g both l b v _ strong_Psi) in Hb.
  apply (smooth ws Phi Psi f g both l a (scale (-1) v) _ strong_Psi) in Ha.
  pose proof (strong_Phi a (plus e v)) as Hb'.
  pose proof (strong_Phi b (minus (scale (-1) v) e)) as Ha'.
  replace (plus a (plus e v)) with (plus b v) in Hb'
    by (apply Graph.vec_eq; unfold b; coordinates; ring).
  replace (plus b (minus (scale (-1) v) e)) with (plus a (scale (-1) v)) in Ha'
    by (apply Graph.vec_eq; unfold b; coordinates; ring).
  generalize dependent (Phi (plus b v)). generalize dependent (Phi (plus a (scale (-1) v))).
  intros P HP HP' Q HQ HQ'. generalize dependent (Phi a). generalize dependent (Phi b).
  intros. generalize dependent (f a). generalize dependent (f b). generalize dependent (bil D v v).
  intros. clear - HP HP' HQ HQ'. destruct e, v, v0, v1. coordinates. lra.
Qed.

Variables (x w : vec) (D : form) (eps delta : R).
Hypothesis eps_pos : 0 < eps.
Hypothesis D_pos : forall v, 0 <= bil D v v.
Hypothesis w_pos : 0 < dot w w.
Let De := wider D eps.
Hypothesis nearby : forall p s v, 0 <= s <= 1 -> distance p (line x w s) <= delta ->
  beta ws p v <= bil De v v + 2 * l * dot v v.

Let rho : R := bil De w w / (4 * eps) + 1.

Lemma De_pos v : eps * dot v v <= bil De v v.
Proof. unfold De. rewrite bil_wider. specialize (D_pos v). lra. Qed.

Lemma rho_pos : 1 <= rho.
Proof.
  unfold rho. pose proof (De_pos w). assert (0 <= bil De w w / (4 * eps)); [| lra].
  apply Rmult_le_pos; [nra | apply Rlt_le, Rinv_0_lt_compat; lra].
Qed.

Lemma tested s h q : 0 < h -> 0 <= s -> s + h <= 1 ->
  h * (2 * rho + (Rabs (fst w) + Rabs (snd w))) <= delta ->
  Rabs (fst q) <= h * rho -> Rabs (snd q) <= h * rho ->
  0 <= 2 * dot (minus (minus (f (line x w (s + h))) (f (line x w s))) (scale (l * h) w)) q
       - h * bil De w q + bil De q q + h * h * bil De w w / 4.
Proof.
  intros Hh Hs Hsh Hdelta Hq0 Hq1. set (a := line x w s). set (e := scale h w).
  set (v := minus q (scale (/ 2) e)).
  assert (Eb : plus a e = line x w (s + h))
    by (apply Graph.vec_eq; unfold a, e, line; coordinates; ring).
  assert (Hdist : forall t sign, 0 <= t <= 1 -> sign * sign = 1 ->
    Rabs (t * sign * (fst q - / 2 * (h * fst w))) + Rabs (t * sign * (snd q - / 2 * (h * snd w)))
    <= delta).
  { intros t sign Ht Hsign. assert (Hts : Rabs (t * sign) <= 1).
    { apply Rabs_le. assert (-1 <= sign <= 1) by nra. nra. }
    assert (Hpart : forall c c', Rabs c <= h * rho ->
      Rabs (t * sign * (c - / 2 * (h * c'))) <= h * rho + h * Rabs c').
    { intros c c' Hc. rewrite Rabs_mult.
      assert (Rabs (c - / 2 * (h * c')) <= h * rho + h * Rabs c').
      { replace (c - / 2 * (h * c')) with (c + - (/ 2 * h * c')) by ring.
        eapply Rle_trans; [apply Rabs_triang |]. rewrite Rabs_Ropp, !Rabs_mult, (Rabs_right (/ 2)),
          (Rabs_right h) by lra. pose proof (Rabs_pos c'). nra. }
      pose proof (Rabs_pos (t * sign)). pose proof (Rabs_pos (c - / 2 * (h * c'))). nra. }
    pose proof (Hpart _ (fst w) Hq0). pose proof (Hpart _ (snd w) Hq1). lra. }
  assert (H := between De a e v). rewrite Eb in H.
  replace (dot _ _ + bil De v v) with
    (2 * dot (minus (minus (f (line x w (s + h))) (f a)) (scale (l * h) w)) q
     - h * bil De w q + bil De q q + h * h * bil De w w / 4) in H.
  - apply H; intros t Ht.
    + apply (nearby _ (s + h)); [lra |]. specialize (Hdist t 1 Ht ltac:(ring)).
      unfold distance. eapply Rle_trans; [| exact Hdist]. apply Req_le.
      f_equal; f_equal; unfold v, e, line; coordinates; ring.
    + replace (bil De v v + 2 * l * dot v v) with
        (bil De (scale (-1) v) (scale (-1) v) + 2 * l * dot (scale (-1) v) (scale (-1) v))
        by (destruct De as [[? ?] ?]; unfold bil; coordinates; ring).
      apply (nearby _ s); [lra |]. specialize (Hdist t (-1) Ht ltac:(ring)).
      unfold distance. eapply Rle_trans; [| exact Hdist]. apply Req_le.
      f_equal; f_equal; unfold a, v, e, line; coordinates; ring.
  - destruct De as [[? ?] ?]. generalize (f (line x w (s + h))) (f a). intros F F'.
    unfold v, e, bil. coordinates. field.
Qed.

(* So the f of two points near each other are as far apart as they should be, in any direction. *)
Lemma piece s h u : 0 < h -> 0 <= s -> s + h <= 1 ->
  h * (2 * rho + (Rabs (fst w) + Rabs (snd w))) <= delta ->
  Rabs (dot (minus (minus (f (line x w (s + h))) (f (line x w s))) (scale (l * h) w)) u
        - h * bil De w u / 2) <= h * (sqrt (bil De u u * bil De w w) / 2).
Proof.
  intros Hh Hs Hsh Hdelta. set (P := minus _ _). set (X := dot P u - h * bil De w u / 2).
  pose proof (De_pos w) as HW. pose proof (De_pos u) as HU. pose proof rho_pos as Hrho.
  set (U := bil De u u) in *. set (W := bil De w w) in *.
  assert (HW0 : 0 < W) by nra. assert (Huu : 0 <= dot u u) by (unfold dot; nra).
  assert (HU0 : 0 <= U) by nra.
  assert (HUW : sqrt (U * W) * sqrt (U * W) = U * W) by (apply sqrt_sqrt; nra).
  pose proof (sqrt_pos (U * W)) as Hroot.
  destruct (Rle_lt_or_eq_dec 0 (dot u u) Huu) as [Hu | Hu].
  2: { assert (u = (0, 0)) as ->.
       { unfold dot in Hu. apply Graph.vec_eq; simpl; nra. }
       assert (X = 0) as ->.
       { unfold X. destruct De as [[? ?] ?]. unfold bil. coordinates. field. }
       rewrite Rabs_R0. nra. }
  assert (HU1 : 0 < U) by nra.
  set (sigma := sqrt (W / (4 * U))).
  assert (Hss : sigma * sigma = W / (4 * U)).
  { apply sqrt_sqrt. apply Rlt_le, Rdiv_lt_0_compat; lra. }
  assert (Hsigma : 0 < sigma) by (apply sqrt_lt_R0, Rdiv_lt_0_compat; lra).
  assert (HsU : sigma * sigma * U = W / 4) by (rewrite Hss; field; lra).
  assert (Htest : forall sign, sign * sign = 1 -> 0 <= 2 * sign * sigma * X + h * W / 2).
  { intros sign Hsign. set (q := scale (h * sign * sigma) u).
    assert (Hsize : sigma * sigma * dot u u <= rho * rho).
    { apply Rle_trans with (W / (4 * eps)).
      - rewrite Hss. apply Rmult_le_reg_r with (4 * eps * U); [nra |].
        replace (W / (4 * U) * dot u u * (4 * eps * U)) with (W * (eps * dot u u)) by (field; lra).
        replace (W / (4 * eps) * (4 * eps * U)) with (W * U) by (field; lra). nra.
      - assert (E : W / (4 * eps) = rho - 1) by (unfold rho; ring). rewrite E. nra. }
    assert (Hpart : forall c, c * c <= dot u u -> Rabs (h * sign * sigma * c) <= h * rho).
    { intros c Hc. replace (h * sign * sigma * c) with (h * (sign * sigma * c)) by ring.
      rewrite Rabs_mult, (Rabs_right h) by lra. apply Rmult_le_compat_l; [lra |].
      rewrite <- (Rabs_right rho) by lra. apply Rsqr_le_abs_0. unfold Rsqr.
      replace (sign * sigma * c * (sign * sigma * c)) with (sign * sign * (sigma * sigma * (c * c)))
        by ring. rewrite Hsign. nra. }
    assert (T := tested s h q Hh Hs Hsh Hdelta). fold P in T.
    specialize (T (Hpart (fst u) ltac:(unfold dot; nra)) (Hpart (snd u) ltac:(unfold dot; nra))).
    replace (_ + _) with (h * (2 * sign * sigma * X) + h * h * (sign * sign * (sigma * sigma * U))
                          + h * h * W / 4) in T.
    - rewrite Hsign, HsU in T. apply Rmult_le_reg_l with h; [exact Hh |]. lra.
    - unfold X, U, W, q. generalize P. intros P'. destruct De as [[? ?] ?]. unfold bil. coordinates.
      field. }
  pose proof (Htest 1 ltac:(ring)) as H1. pose proof (Htest (-1) ltac:(ring)) as H2.
  assert (Hc : 4 * (sigma * sqrt (U * W)) = 2 * W).
  { assert (E : sigma * sqrt (U * W) = W / 2); [| lra].
    unfold sigma. rewrite <- sqrt_mult_alt by (apply Rlt_le, Rdiv_lt_0_compat; lra).
    replace (W / (4 * U) * (U * W)) with (W / 2 * (W / 2)) by (field; lra).
    apply sqrt_square. lra. }
  apply Rabs_le. split; apply Rmult_le_reg_l with (2 * sigma); try lra; nra.
Qed.
End Near.

(* ---- from x to x + w, in many pieces *)

Lemma telescoped (T : R -> R) h c :
  (forall i, Rabs (T (h * INR (S i)) - T (h * INR i)) <= c \/ 1 < h * INR (S i)) ->
  forall n, h * INR n <= 1 -> 0 < h -> Rabs (T (h * INR n) - T 0) <= INR n * c.
Proof.
  intros Hstep n. induction n as [| n IH]; intros Hn Hh.
  - simpl INR. rewrite Rmult_0_r, Rminus_eq_0, Rabs_R0. lra.
  - destruct (Hstep n) as [H | H]; [| lra].
    assert (h * INR n <= h * INR (S n)) by (rewrite S_INR; nra).
    specialize (IH ltac:(lra) Hh). rewrite (S_INR n) at 2.
    replace (T (h * INR (S n)) - T 0) with
      ((T (h * INR (S n)) - T (h * INR n)) + (T (h * INR n) - T 0)) by ring.
    eapply Rle_trans; [apply Rabs_triang |]. lra.
Qed.

Section Pieces.
Variables (ws : list wave) (Phi Psi : vec -> R) (f g : vec -> vec) (l : R).
Hypothesis both : dual ws Phi Psi f g.
Hypothesis strong_Phi : strong l Phi f.
Hypothesis strong_Psi : strong l Psi g.
Variables (x w : vec) (D : form).
Hypothesis D_pos : forall v, 0 <= bil D v v.
Hypothesis along_w : forall s v, 0 <= s <= 1 ->
  beta ws (line x w s) v <= bil D v v + 2 * l * dot v v.

Let X (D : form) (u : vec) : R :=
  dot (minus (minus (f (plus x w)) (f x)) (scale l w)) u - bil D w u / 2.

Lemma pieces eps u : 0 < eps -> 0 < dot w w ->
  Rabs (X (wider D eps) u) <= sqrt (bil (wider D eps) u u * bil (wider D eps) w w) / 2.
Proof.
  intros Heps Hw. set (De := wider D eps). destruct (beta_slow ws) as (L & HL & Hslow).
  set (delta := eps / (L + 1)). assert (Hdelta : 0 < delta) by (apply Rdiv_lt_0_compat; lra).
  assert (HLd : L * delta <= eps).
  { unfold delta. apply Rmult_le_reg_r with (L + 1); [lra |].
    replace (L * (eps / (L + 1)) * (L + 1)) with (L * eps) by (field; lra). nra. }
  assert (Hnear : forall p s v, 0 <= s <= 1 -> distance p (line x w s) <= delta ->
    beta ws p v <= bil De v v + 2 * l * dot v v).
  { intros p s v Hs Hp. specialize (Hslow p (line x w s) v). specialize (along_w s v Hs).
    unfold De. rewrite bil_wider. assert (0 <= dot v v) by (unfold dot; nra).
    assert (L * distance p (line x w s) <= eps) by nra. nra. }
  set (c := 2 * (bil De w w / (4 * eps) + 1) + (Rabs (fst w) + Rabs (snd w))).
  assert (Hc : 0 < c).
  { unfold c. pose proof (Rabs_pos (fst w)). pose proof (Rabs_pos (snd w)).
    assert (0 <= bil De w w / (4 * eps)); [| lra]. apply Rmult_le_pos.
    - unfold De. rewrite bil_wider. specialize (D_pos w). nra.
    - apply Rlt_le, Rinv_0_lt_compat. lra. }
  destruct (archimed_cor1 (delta / c)) as (n & Hn & Hn0); [now apply Rdiv_lt_0_compat |].
  apply lt_INR in Hn0. simpl in Hn0. set (h := / INR n) in *.
  assert (Hh : 0 < h) by now apply Rinv_0_lt_compat.
  assert (Hhn : h * INR n = 1) by (apply Rinv_l; lra).
  assert (Hhc : h * c <= delta).
  { apply (Rmult_lt_compat_r c) in Hn; [| exact Hc].
    replace (delta / c * c) with delta in Hn by (field; lra). lra. }
  set (root := sqrt (bil De u u * bil De w w) / 2).
  set (T s := dot (minus (minus (f (line x w s)) (f x)) (scale (l * s) w)) u - s * bil De w u / 2).
  assert (HT : Rabs (T (h * INR n) - T 0) <= INR n * (h * root)).
  { apply telescoped; [| lra | exact Hh]. intros i.
    destruct (Rle_dec (h * INR (S i)) 1) as [Hi | Hi]; [left | right; lra].
    pose proof (pos_INR i) as Hi0.
    assert (Hsum : h * INR i + h = h * INR (S i)) by (rewrite S_INR; ring).
    pose proof (piece ws Phi Psi f g l both strong_Phi strong_Psi x w D eps delta Heps D_pos Hw Hnear
      (h * INR i) h u Hh ltac:(nra) ltac:(lra) Hhc) as H.
    fold De root in H. rewrite Hsum in H. eapply Rle_trans; [| exact H]. apply Req_le. f_equal.
    unfold T. rewrite S_INR. generalize (f (line x w (h * (INR i + 1)))) (f (line x w (h * INR i))).
    intros F F'. coordinates. field. }
  rewrite Hhn in HT.
  replace (INR n * (h * root)) with (h * INR n * root) in HT by ring. rewrite Hhn in HT.
  assert (E1 : line x w 1 = plus x w) by (apply Graph.vec_eq; unfold line; coordinates; ring).
  assert (E0 : line x w 0 = x) by (apply Graph.vec_eq; unfold line; coordinates; ring).
  replace (X De u) with (T 1 - T 0); [lra |]. unfold X, T. rewrite E0, E1. coordinates. field.
Qed.

Lemma all_pieces u : X D u * X D u <= bil D u u * bil D w w / 4.
Proof.
  assert (Hww : 0 <= dot w w) by (unfold dot; nra).
  destruct (Rle_lt_or_eq_dec 0 (dot w w) Hww) as [Hw | Hw].
  2: { assert (w = (0, 0)) as E.
       { unfold dot in Hw. apply Graph.vec_eq; simpl; nra. }
       assert (X D u = 0) as ->.
       { unfold X. rewrite E. replace (plus x (0, 0)) with x
           by (apply Graph.vec_eq; coordinates; ring).
         destruct D as [[? ?] ?]. unfold bil. coordinates. field. }
       pose proof (D_pos u). pose proof (D_pos w). nra. }
  set (U := bil D u u). set (W := bil D w w). set (k := dot w u).
  assert (HU : 0 <= U) by apply D_pos. assert (HW : 0 <= W) by apply D_pos.
  assert (Huu : 0 <= dot u u) by (unfold dot; nra).
  set (C := (U * dot w w + W * dot u u + dot u u * dot w w) / 4 + Rabs (X D u * k)).
  assert (HC : 0 <= C) by (unfold C; pose proof (Rabs_pos (X D u * k)); nra).
  apply le_epsilon. intros gap Hgap.
  set (eps := Rmin 1 (gap / (C + 1))).
  assert (Heps : 0 < eps) by (apply Rmin_glb_lt; [lra | apply Rdiv_lt_0_compat; lra]).
  assert (Heps1 : eps <= 1) by apply Rmin_l.
  assert (HepsC : eps * (C + 1) <= gap).
  { pose proof (Rmin_r 1 (gap / (C + 1)) : eps <= _) as H.
    apply (Rmult_le_compat_r (C + 1)) in H; [| lra].
    replace (gap / (C + 1) * (C + 1)) with gap in H by (field; lra). exact H. }
  pose proof (pieces eps u Heps Hw) as H. rewrite !bil_wider in H. fold U W in H.
  assert (EX : X (wider D eps) u = X D u - eps * k / 2)
    by (unfold X, k; rewrite bil_wider; field).
  rewrite EX in H. set (Z := X D u) in *.
  set (Q := (U + eps * dot u u) * (W + eps * dot w w)) in *.
  assert (HQ : 0 <= Q) by (apply Rmult_le_pos; nra).
  assert (Hroot : sqrt Q * sqrt Q = Q) by now apply sqrt_sqrt.
  assert (Hsq : (Z - eps * k / 2) * (Z - eps * k / 2) <= Q / 4).
  { apply Rabs_le_between in H. pose proof (sqrt_pos Q). nra. }
  assert (Hk : Z * k <= Rabs (Z * k)) by apply Rle_abs.
  assert (HQ' : Q <= U * W + eps * (U * dot w w + W * dot u u + dot u u * dot w w)).
  { unfold Q. assert (0 <= dot u u * dot w w) by now apply Rmult_le_pos.
    assert (eps * eps * (dot u u * dot w w) <= eps * (dot u u * dot w w))
      by (apply Rmult_le_compat_r; nra). lra. }
  unfold C in HepsC. nra.
Qed.
End Pieces.

(* ---- invariant graphs *)

(* The map on the graph of c + S'. *)
Definition on_graph (ws : list wave) (c : vec) (S' : vec -> vec) (y : vec) : vec :=
  fst (F ws (y, plus c (S' y))).

Section Invariant.
Variables (ws : list wave) (c : vec) (S : vec -> R) (S' : vec -> vec).
Hypothesis period : periodic S.
Hypothesis gradient : has_gradient S S'.
Hypothesis invariant : invariant_graph ws c S'.

(* H of docs/proofs/argument.md, Lemma 1, less its least value is Phi(y) + Psi(y') - y.y'. *)
Lemma graph_dual : exists Phi Psi g, dual ws Phi Psi (on_graph ws c S') g.
Proof.
  set (f := on_graph ws c S'). set (g y := minus y (plus c (S' y))).
  set (P y := dot y y / 2 - V ws y + S y + dot c y). set (Psi z := dot z z / 2 - S z - dot c z).
  assert (HH : forall y z, Graph.h ws y z + S y - S z + dot c (minus y z) = P y + Psi z - dot y z).
  { intros y z. unfold Graph.h, P, Psi. coordinates. field. }
  assert (Hstep : forall x y z, P x + Psi (f x) - dot x (f x) <= P y + Psi z - dot y z).
  { intros x y z. rewrite <- !HH. exact (Graph.H_step ws c S S' period gradient invariant x y z). }
  set (M := P (0, 0) + Psi (f (0, 0)) - dot (0, 0) (f (0, 0))).
  exists (fun y => P y - M), Psi, g. constructor.
  - intros y z. specialize (Hstep (0, 0) y z). fold M in Hstep. lra.
  - intros y. pose proof (Hstep y (0, 0) (f (0, 0))) as H. fold M in H.
    pose proof (Hstep (0, 0) y (f y)) as H'. fold M in H'. lra.
  - exact (Graph.f_g ws c S S' period gradient invariant).
  - exact (Graph.g_f ws c S' invariant).
  - exists (- M). intros y. unfold P, Psi, energy. coordinates. field.
  - intros y. unfold f, g, on_graph, F, energy'. apply Graph.vec_eq; coordinates; ring.
Qed.

Variables (B l : R).
Hypothesis largest : forall y v, beta ws y v <= B * dot v v.
Hypothesis l_range : 0 < l < 1.
Hypothesis B_le : B <= l + / l.

(* f is the gradient of a function that is convex with l to spare, and so is its inverse. *)
Theorem graph_strong : exists Phi Psi g, dual ws Phi Psi (on_graph ws c S') g /\
  strong l Phi (on_graph ws c S') /\ strong l Psi g.
Proof.
  destruct graph_dual as (Phi & Psi & g & both). exists Phi, Psi, g.
  split; [exact both |]. split.
  - exact (strong_l ws Psi Phi g _ (dual_sym _ _ _ _ _ both) B l largest l_range B_le).
  - exact (strong_l ws Phi Psi _ g both B l largest l_range B_le).
Qed.

(* So beta is at least 2l everywhere. *)
Lemma beta_least y v : 2 * l * dot v v <= beta ws y v.
Proof.
  destruct graph_strong as (Phi & Psi & g & both & HPhi & HPsi).
  apply Rnot_lt_le. intros Hlt. destruct (beta_slow ws) as (L & HL & Hslow).
  assert (Hvv : 0 <= dot v v) by (unfold dot; nra).
  set (size := Rabs (fst v) + Rabs (snd v)).
  assert (Hsize : 0 <= size) by
    (unfold size; pose proof (Rabs_pos (fst v)); pose proof (Rabs_pos (snd v)); lra).
  set (gap := 2 * l * dot v v - beta ws y v) in *. assert (Hgap : 0 < gap) by (unfold gap; lra).
  set (m := L * size * dot v v). assert (Hm : 0 <= m) by (unfold m; apply Rmult_le_pos; nra).
  set (h := gap / (2 * (m + 1))). assert (Hh : 0 < h) by (apply Rdiv_lt_0_compat; lra).
  assert (Hmh : m * h <= gap / 2).
  { unfold h. apply Rmult_le_reg_r with (2 * (m + 1)); [lra |].
    replace (m * (gap / (2 * (m + 1))) * (2 * (m + 1))) with (m * gap) by (field; lra). nra. }
  pose proof (energy_rises ws y (scale h v) (h * h * (beta ws y v + gap / 2))) as H.
  assert (Hk : forall t, 0 <= t <= 1 ->
    beta ws (line y (scale h v) t) (scale h v) <= h * h * (beta ws y v + gap / 2)).
  { intros t Ht. specialize (Hslow (line y (scale h v) t) y v).
    rewrite Criterion.beta_homogeneous. apply Rmult_le_compat_l; [nra |].
    assert (Hd : distance (line y (scale h v) t) y <= h * size).
    { unfold distance, line, plus, scale, size. simpl.
      replace (fst y + t * (h * fst v) - fst y) with (t * h * fst v) by ring.
      replace (snd y + t * (h * snd v) - snd y) with (t * h * snd v) by ring.
      rewrite !(Rabs_mult (t * h)), (Rabs_right (t * h)) by nra.
      rewrite <- Rmult_plus_distr_l. apply Rmult_le_compat_r; [exact Hsize | nra]. }
    assert (L * distance (line y (scale h v) t) y * dot v v <= m * h); [| lra].
    unfold m. replace (L * size * dot v v * h) with (L * (h * size) * dot v v) by ring.
    apply Rmult_le_compat_r; [exact Hvv |]. now apply Rmult_le_compat_l. }
  specialize (H Hk). pose proof (HPhi y (scale h v)) as HP. pose proof (HPsi y (scale h v)) as HQ.
  destruct (total _ _ _ _ _ both) as (M & E). pose proof (E y) as E0.
  pose proof (E (plus y (scale h v))) as E1. pose proof (slopes _ _ _ _ _ both y) as F.
  assert (F' : dot (on_graph ws c S' y) (scale h v) + dot (g y) (scale h v)
               = dot (energy' ws y) (scale h v)) by (rewrite <- F; unfold dot, plus; simpl; ring).
  assert (D : dot (scale h v) (scale h v) = h * h * dot v v) by (unfold dot, scale; simpl; ring).
  rewrite D in HP, HQ. assert (Hhh : 0 < h * h) by nra.
  assert (l * (h * h * dot v v) <= h * h * (beta ws y v + gap / 2) / 2) by lra.
  assert (h * h * gap <= h * h * gap / 2) by (unfold gap in *; lra). nra.
Qed.

(* Where D + 2l is above beta from x to x + w, f(x + w) - f(x) is (l + D/2) w but for
   (sqrt (u.D u) sqrt (w.D w))/2 along any u. *)
Theorem link : forall x w D,
  (forall s v, 0 <= s <= 1 -> beta ws (plus x (scale s w)) v <= bil D v v + 2 * l * dot v v) ->
  let moved := minus (on_graph ws c S' (plus x w)) (on_graph ws c S' x) in
  forall u, Rabs (dot (minus moved (scale l w)) u - bil D w u / 2) <= sqrt (bil D u u * bil D w w) / 2.
Proof.
  intros x w D Hbeta moved u.
  assert (HD : forall v, 0 <= bil D v v).
  { intros v. pose proof (beta_least (plus x (scale 0 w)) v). specialize (Hbeta 0 v ltac:(lra)). lra. }
  destruct graph_strong as (Phi & Psi & g & both & HPhi & HPsi).
  pose proof (all_pieces ws Phi Psi _ g l both HPhi HPsi x w D HD Hbeta u) as H. cbv beta zeta in H.
  fold moved in H. set (X := _ - bil D w u / 2) in *.
  assert (HQ : 0 <= bil D u u * bil D w w) by (apply Rmult_le_pos; apply HD).
  pose proof (sqrt_pos (bil D u u * bil D w w)) as Hpos.
  pose proof (sqrt_sqrt _ HQ) as Hroot.
  rewrite <- (Rabs_right (sqrt _ / 2)) by lra. apply Rsqr_le_abs_0. unfold Rsqr. lra.
Qed.

(* From x on in steps d, each with a K of its own that is above beta there. *)
Fixpoint steps (x d : vec) (Ks : list form) : Prop :=
  match Ks with
  | [] => True
  | K :: Ks => (forall s v, 0 <= s <= 1 -> beta ws (plus x (scale s d)) v <= bil K v v)
               /\ steps (plus x d) d Ks
  end.

Definition middle_of (d u : vec) (K : form) : R := bil K d u / 2.
Definition radius_of (d u : vec) (K : form) : R :=
  let D := wider K (-2 * l) in sqrt (bil D u u * bil D d d) / 2.

Theorem links d u : forall Ks x, steps x d Ks ->
  let moved := minus (on_graph ws c S' (plus x (scale (INR (length Ks)) d))) (on_graph ws c S' x) in
  Rabs (dot moved u - sum (middle_of d u) Ks) <= sum (radius_of d u) Ks.
Proof.
  induction Ks as [| K Ks IH]; intros x; cbv zeta.
  - intros _. simpl length. simpl INR.
    replace (plus x (scale 0 d)) with x by (apply Graph.vec_eq; coordinates; ring).
    simpl sum. generalize (on_graph ws c S' x). intros F. coordinates.
    replace (_ - _) with 0 by ring. rewrite Rabs_R0. lra.
  - intros [HK Hs]. specialize (IH (plus x d) Hs). cbv zeta in IH.
    assert (H := link x d (wider K (-2 * l))). cbv zeta in H. specialize (fun A => H A u).
    assert (Hb : forall s v, 0 <= s <= 1 -> beta ws (plus x (scale s d)) v
      <= bil (wider K (-2 * l)) v v + 2 * l * dot v v).
    { intros s v Hss. rewrite bil_wider. specialize (HK s v Hss). lra. }
    specialize (H Hb). cbn [length]. rewrite S_INR.
    replace (plus x (scale (INR (length Ks) + 1) d)) with
      (plus (plus x d) (scale (INR (length Ks)) d)) by (apply Graph.vec_eq; coordinates; ring).
    cbn [sum fold_right]. fold (sum (middle_of d u) Ks). fold (sum (radius_of d u) Ks).
    fold (radius_of d u K) in H. rewrite bil_wider in H.
    set (F2 := on_graph ws c S' (plus (plus x d) _)) in *. set (F1 := on_graph ws c S' (plus x d)) in *.
    set (F0 := on_graph ws c S' x) in *. clearbody F0 F1 F2.
    eapply Rle_trans; [| exact (Rplus_le_compat _ _ _ _ H IH)].
    eapply Rle_trans; [| apply Rabs_triang]. apply Req_le. f_equal.
    unfold middle_of at 1. coordinates. field.
Qed.
End Invariant.
