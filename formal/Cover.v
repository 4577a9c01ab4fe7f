(* Which regions of x1 are enough: every orbit through x*, or the same backwards, has an x1 in them,
   modulo 2 pi and perhaps with the angles exchanged.  docs/proofs/argument.md has the same in words, section
   2.

   x1 is pi times the integer matrix F applied to v, so v counts modulo the lattice F^-1 (2 Z^2).  It
   has a vector (0, 2/g) and a vector (2g/D, something), D the determinant of F and g the greatest
   common divisor of its second column.  So v0 is taken off first, then v1. *)

From Coq Require Import Reals ZArith QArith Qreals List Bool Lra Lia Classical.
From Coquelicot Require Import Rcomplements.
From Converse Require Import Map Criterion Tree Reduce.
From Converse Require Graph Link.
Import ListNotations.
Open Scope R_scope.

(* ---- kinds of orbits *)

(* Of a kind of orbits, for any t, are those reversed, too, and where the exchange of the angles maps
   the patch to itself those exchanged. *)
Record kind (patch : list term) (K : list R -> (Z -> vec) -> Prop) : Prop := Kind {
  is_orbit : forall t x, K t x -> orbit (waves patch t) x;
  back : forall t x, K t x -> K t (reversed x);
  across : forall order t x, symmetric patch order = true -> K t x ->
           K (reordered 0 order t) (fun j => swap (x j))
}.

(* Those that may minimize, *)
Definition minimizing (patch : list term) (t : list R) (x : Z -> vec) : Prop :=
  orbit (waves patch t) x /\ ~ refuted (waves patch t) x.

Lemma minimizing_kind patch : kind patch (minimizing patch).
Proof.
  split.
  - now intros t x [H _].
  - intros t x [Hx H]. split; [now apply orbit_reversed |]. intros Hr. now apply H, refuted_reversed.
  - intros order t x Ho [Hx H]. destruct (exchanged_orbit patch order t x Ho Hx) as [Hs Hr].
    split; [exact Hs | tauto].
Qed.

(* and those on invariant graphs. *)
Definition on_graph (patch : list term) (t : list R) (x : Z -> vec) : Prop :=
  exists c S S', periodic S /\ has_gradient S S' /\ invariant_graph (waves patch t) c S' /\
  forall j, x (j + 1)%Z = Link.on_graph (waves patch t) c S' (x j).

Lemma invariant_ext ws ws' c S' : (forall y, V' ws y = V' ws' y) ->
  invariant_graph ws c S' -> invariant_graph ws' c S'.
Proof. intros E H y. specialize (H y). unfold F in *. cbn [fst snd] in *. now rewrite <- !E. Qed.

Lemma on_graph_ext ws ws' c S' y : (forall y, V' ws y = V' ws' y) ->
  Link.on_graph ws c S' y = Link.on_graph ws' c S' y.
Proof. intros E. unfold Link.on_graph, F. cbn [fst snd]. now rewrite E. Qed.

Lemma dot_swap u v : dot (swap u) (swap v) = dot u v.
Proof. unfold dot, swap. cbn [fst snd]. ring. Qed.

Lemma minus_swap u v : minus (swap u) (swap v) = swap (minus u v).
Proof. reflexivity. Qed.

Lemma continuous_swap f : continuous f -> continuous (fun y => f (swap y)).
Proof.
  intros C y eps He. destruct (C (swap y) eps He) as (d & Hd & H). exists d. split; [exact Hd |].
  intros z Hz. apply H. now rewrite minus_swap, dot_swap.
Qed.

Lemma continuous_minus f g : continuous f -> continuous g -> continuous (fun y => f y - g y).
Proof.
  rewrite !Graph.continuous_ball. apply Graph.c_minus.
Qed.

Lemma V_periodic ws : periodic (V ws).
Proof.
  intros y m0 m1. unfold V. f_equal. apply sum_ext. intros w _. f_equal.
  replace (angle w (plus y (scale (2 * PI) (IZR m0, IZR m1)))) with
    (angle w y + 2 * PI * IZR (k0 w * m0 + k1 w * m1)); [apply sin_turns |].
  unfold angle, along, plus, scale. cbn [fst snd]. rewrite plus_IZR, !mult_IZR. ring.
Qed.

Lemma on_graph_reversed patch t x : on_graph patch t x -> on_graph patch t (reversed x).
Proof.
  intros (c & S & S' & HS & HS' & Hinv & Hx). set (ws := waves patch t) in *.
  pose proof (Graph.g_f ws c S' Hinv) as Hgf.
  pose proof (Graph.f_g ws c S S' HS HS' Hinv) as Hfg.
  set (g y := minus y (plus c (S' y))).
  set (c' := scale (-1) c). set (T' y := minus (V' ws y) (S' y)).
  assert (Hg : forall y, fst (F ws (y, plus c' (T' y))) = g y).
  { intros y. unfold F, g, c', T', plus, minus, scale. apply vec_eq; cbn [fst snd]; ring. }
  exists c', (fun y => V ws y - S y), T'. split; [| split; [| split]].
  - intros y m0 m1. now rewrite V_periodic, HS.
  - destruct (Graph.V_gradient ws) as (D0 & D1 & C0 & C1), HS' as (E0 & E1 & G0 & G1).
    repeat split.
    + intros y. exact (derivable_pt_lim_minus _ _ _ _ _ (D0 y) (E0 y)).
    + intros y. exact (derivable_pt_lim_minus _ _ _ _ _ (D1 y) (E1 y)).
    + exact (continuous_minus _ _ C0 G0).
    + exact (continuous_minus _ _ C1 G1).
  - intros y. fold ws. rewrite Hg. specialize (Hfg y). change (minus y (plus c (S' y))) with (g y) in Hfg.
    assert (E : minus (plus c (S' (g y))) (V' ws (g y)) = plus c (S' y)).
    { transitivity (minus y (g y)).
      - enough (A : forall u v w : vec, plus u v = w -> v = minus w u) by exact (A _ _ _ Hfg).
        intros u v w <-. unfold plus, minus. apply vec_eq; cbn [fst snd]; ring.
      - unfold g, plus, minus. apply vec_eq; cbn [fst snd]; ring. }
    transitivity (scale (-1) (plus c (S' y))).
    + unfold F, c', T', plus, minus, scale. apply vec_eq; cbn [fst snd]; ring.
    + transitivity (scale (-1) (minus (plus c (S' (g y))) (V' ws (g y)))); [now rewrite E |].
      unfold c', T', plus, minus, scale. apply vec_eq; cbn [fst snd]; ring.
  - intros k. fold ws. unfold Link.on_graph. rewrite Hg. unfold reversed.
    assert (E : g (Link.on_graph ws c S' (x (- (k + 1))%Z)) = x (- (k + 1))%Z) by apply Hgf.
    rewrite <- E, <- Hx. f_equal. f_equal. ring.
Qed.

(* The image of a graph with the angles exchanged is one for the parameters in the other order. *)
Lemma graph_exchanged patch order t c S S' : symmetric patch order = true ->
  periodic S -> has_gradient S S' -> invariant_graph (waves patch t) c S' ->
  let ws' := waves patch (reordered 0 order t) in let T' y := swap (S' (swap y)) in
  periodic (fun y => S (swap y)) /\ has_gradient (fun y => S (swap y)) T' /\
  invariant_graph ws' (swap c) T' /\
  forall y, Link.on_graph ws' (swap c) T' (swap y) = swap (Link.on_graph (waves patch t) c S' y).
Proof.
  intros Ho HS HS' Hinv ws' T'. set (ws := waves patch t) in *.
  assert (HV : forall y, V' ws' (swap y) = swap (V' ws y)).
  { intros y. rewrite <- V'_swap. symmetry. apply (symmetric_correct _ _ Ho t _ y). }
  assert (HF : forall y p, F ws' (swap y, swap p)
                           = (swap (fst (F ws (y, p))), swap (snd (F ws (y, p))))).
  { intros y p. unfold F. cbn [fst snd]. now rewrite HV. }
  unfold T'. split; [| split; [| split]].
  - intros y m0 m1. exact (HS (swap y) m1 m0).
  - destruct HS' as (E0 & E1 & G0 & G1). repeat split.
    + intros y. exact (E1 (swap y)).
    + intros y. exact (E0 (swap y)).
    + exact (continuous_swap _ G1).
    + exact (continuous_swap _ G0).
  - intros y. rewrite <- (swap_swap y) at 1 3.
    change (plus (swap c) (swap (S' (swap y)))) with (swap (plus c (S' (swap y)))).
    rewrite HF. cbn [fst snd]. rewrite swap_swap. now rewrite (Hinv (swap y)).
  - intros y. unfold Link.on_graph. rewrite swap_swap.
    change (plus (swap c) (swap (S' y))) with (swap (plus c (S' y))). now rewrite HF.
Qed.

Lemma on_graph_exchanged patch order t x : symmetric patch order = true -> on_graph patch t x ->
  on_graph patch (reordered 0 order t) (fun j => swap (x j)).
Proof.
  intros Ho (c & S & S' & HS & HS' & Hinv & Hx).
  destruct (graph_exchanged patch order t c S S' Ho HS HS' Hinv) as (A & B & C & D).
  eexists _, _, _. split; [exact A |]. split; [exact B |]. split; [exact C |].
  intros k. rewrite D. now rewrite Hx.
Qed.

Lemma on_graph_kind patch : kind patch (on_graph patch).
Proof.
  split.
  - intros t x (c & S & S' & HS & HS' & Hinv & Hx). exact (Graph.is_orbit _ c S' Hinv x Hx).
  - apply on_graph_reversed.
  - apply on_graph_exchanged.
Qed.

(* ---- the lattice *)

Definition determinant (r : region) : Z := (m00 r * m11 r - m01 r * m10 r)%Z.
Definition divisor (r : region) : Z := Z.gcd (m01 r) (m11 r).

Definition at_v (r : region) (v0 v1 : R) : vec :=
  (PI * (IZR (m00 r) * v0 + IZR (m01 r) * v1), PI * (IZR (m10 r) * v0 + IZR (m11 r) * v1)).

(* The v of a point. *)
Definition v0_of (r : region) (y : vec) : R :=
  (IZR (m11 r) * fst y - IZR (m01 r) * snd y) / (PI * IZR (determinant r)).
Definition v1_of (r : region) (y : vec) : R :=
  (IZR (m00 r) * snd y - IZR (m10 r) * fst y) / (PI * IZR (determinant r)).

Definition within0 (r : region) (v0 : R) : Prop := Rabs (v0 - Q2R (centre0 r)) <= Q2R (half0 r).
Definition within1 (r : region) (v1 : R) : Prop := Rabs (v1 - Q2R (centre1 r)) <= Q2R (half1 r).

(* Some number that is u modulo a period is within half of it of c. *)
Lemma near u c period : 0 < period -> exists p : Z, Rabs (u - period * IZR p - c) <= period / 2.
Proof.
  intros H. set (a := (u - c) / period - / 2). exists (up a). destruct (archimed a) as [Ha Hb].
  assert (E : u - c = period * (a + / 2)) by (unfold a; field; lra).
  apply Rabs_le. replace (u - period * IZR (up a) - c) with (period * (a + / 2 - IZR (up a))) by lra.
  nra.
Qed.

Section Lattice.
Variable r : region.
Hypothesis regular : determinant r <> 0%Z.

Lemma determinant_not_0 : IZR (determinant r) <> 0.
Proof. now apply not_0_IZR. Qed.

Lemma determinant_IZR :
  IZR (determinant r) = IZR (m00 r) * IZR (m11 r) - IZR (m01 r) * IZR (m10 r).
Proof. unfold determinant. now rewrite minus_IZR, !mult_IZR. Qed.

Lemma at_v_of y : at_v r (v0_of r y) (v1_of r y) = y.
Proof.
  pose proof determinant_not_0 as H. pose proof PI_neq0. unfold at_v, v0_of, v1_of.
  rewrite determinant_IZR in *. apply vec_eq; cbn [fst snd]; field; auto.
Qed.

Lemma divisor_pos : (0 < divisor r)%Z.
Proof.
  pose proof (Z.gcd_nonneg (m01 r) (m11 r)) as H. fold (divisor r) in H.
  enough (divisor r <> 0)%Z by lia. intros E. apply Z.gcd_eq_0 in E as [E0 E1].
  apply regular. unfold determinant. rewrite E0, E1. ring.
Qed.

(* v1 may be taken to any place of length 2/g, *)
Lemma taken1 c v0 v1 : exists v1' i j, Rabs (v1' - c) <= / IZR (divisor r) /\
  at_v r v0 v1 = plus (at_v r v0 v1') (turns i j).
Proof.
  pose proof (IZR_lt _ _ divisor_pos) as Hg.
  destruct (Z.gcd_divide_l (m01 r) (m11 r)) as [a Ha].
  destruct (Z.gcd_divide_r (m01 r) (m11 r)) as [b Hb].
  fold (divisor r) in Ha, Hb. apply (f_equal IZR) in Ha, Hb. rewrite mult_IZR in Ha, Hb.
  set (g := IZR (divisor r)) in *.
  destruct (near v1 c (2 / g)) as [p Hp]; [apply Rdiv_lt_0_compat; lra|].
  exists (v1 - 2 / g * IZR p), (a * p)%Z, (b * p)%Z. split.
  - eapply Rle_trans; [exact Hp|]. apply Req_le. field. lra.
  - unfold at_v, plus, turns. rewrite Ha, Hb, !mult_IZR.
    apply vec_eq; cbn [fst snd]; field; lra.
Qed.

(* and v0 to any place of length 2g/D. *)
Lemma taken0 c v0 v1 : exists v0' v1' i j,
  Rabs (v0' - c) <= IZR (divisor r) / IZR (Z.abs (determinant r)) /\
  at_v r v0 v1 = plus (at_v r v0' v1') (turns i j).
Proof.
  pose proof (IZR_lt _ _ divisor_pos) as Hg.
  assert (Habs : (0 < Z.abs (determinant r))%Z) by lia. apply IZR_lt in Habs.
  destruct (Z.gcd_bezout (m01 r) (m11 r) (divisor r) eq_refl) as (a & b & E).
  apply (f_equal IZR) in E. rewrite plus_IZR, !mult_IZR in E.
  set (g := IZR (divisor r)) in *. set (s := Z.sgn (determinant r)).
  assert (Hs : IZR (Z.abs (determinant r)) = IZR s * IZR (determinant r)).
  { rewrite <- mult_IZR. f_equal. unfold s. rewrite Z.mul_comm. symmetry. apply Z.sgn_abs. }
  assert (Hss : IZR s * IZR s = 1).
  { rewrite <- mult_IZR. f_equal. unfold s. destruct (determinant r); [easy | |]; reflexivity. }
  pose proof determinant_not_0 as HD.
  destruct (near v0 c (2 * g / IZR (Z.abs (determinant r)))) as [p Hp];
    [apply Rdiv_lt_0_compat; lra|].
  exists (v0 - 2 * g / IZR (Z.abs (determinant r)) * IZR p),
    (v1 + 2 * (IZR (m10 r) * IZR b + IZR (m00 r) * IZR a) / IZR (determinant r)
          * (IZR s * IZR p)), (s * b * p)%Z, (- (s * a * p))%Z. split.
  - eapply Rle_trans; [exact Hp|]. apply Req_le. field. lra.
  - assert (Hr : 2 * g / IZR (Z.abs (determinant r)) = IZR s * (2 * g / IZR (determinant r))).
    { rewrite Hs. assert (IZR s <> 0) by (intros Z; rewrite Z in Hss; lra).
      replace (IZR s) with (/ IZR s) at 2; [field; auto|].
      apply Rmult_eq_reg_r with (IZR s); [|assumption]. now rewrite Rinv_l. }
    rewrite Hr, <- E. unfold at_v, plus, turns. rewrite opp_IZR, !mult_IZR.
    rewrite determinant_IZR in *. apply vec_eq; cbn [fst snd]; field; assumption.
Qed.

Lemma turned_back r' v0 v1 i j y : y = plus (at_v r' v0 v1) (turns i j) ->
  within0 r' v0 -> within1 r' v1 -> into r' y.
Proof. intros -> H0 H1. exists v0, v1, i, j. repeat split; assumption. Qed.

Lemma turns_turns i j i' j' : plus (turns i j) (turns i' j') = turns (i + i') (j + j').
Proof.
  unfold plus, turns. rewrite !plus_IZR. apply vec_eq; cbn [fst snd]; ring.
Qed.

Lemma plus_assoc u v w : plus (plus u v) w = plus u (plus v w).
Proof. unfold plus. apply vec_eq; cbn [fst snd]; ring. Qed.

(* ---- v1: all of it, or half *)

Definition exchangeable (patch : list term) (xstar : Q * Q) : Prop :=
  m00 r = 1%Z /\ m01 r = 1%Z /\ m10 r = 1%Z /\ m11 r = (-1)%Z /\
  Q2R (fst xstar) = Q2R (snd xstar) /\ (exists order, symmetric patch order = true) /\
  forall v1, 0 <= v1 <= 1 -> within1 r v1.

Definition all1 (patch : list term) (xstar : Q * Q) : Prop :=
  1 <= Q2R (half1 r) * IZR (divisor r) \/ exchangeable patch xstar.

Variables (patch : list term) (xstar : Q * Q) (K : list R -> (Z -> vec) -> Prop).
Hypothesis is_kind : kind patch K.
Hypothesis none : forall t x, in_cube t -> K t x -> x 0%Z = point xstar -> ~ into r (x 1%Z).

(* So it is enough that v0 is in its range. *)
Lemma any_v1 : all1 patch xstar -> forall t, in_cube t -> forall x, K t x ->
  x 0%Z = point xstar -> forall v0 v1 i j, within0 r v0 ->
  x 1%Z <> plus (at_v r v0 v1) (turns i j).
Proof.
  intros [Hall | (E00 & E01 & E10 & E11 & Hdiagonal & (order & Horder) & Hhalf)]
    t Ht x Hx Hx0 v0 v1 i j Hv0 Hx1.
  - destruct (taken1 (Q2R (centre1 r)) v0 v1) as (v1' & i' & j' & Hv1 & E).
    apply (none t x Ht Hx Hx0). rewrite E, plus_assoc, turns_turns in Hx1.
    apply (turned_back r _ _ _ _ _ Hx1 Hv0). eapply Rle_trans; [exact Hv1|].
    pose proof (IZR_lt _ _ divisor_pos) as Hg.
    apply Rmult_le_reg_r with (IZR (divisor r)); [assumption|]. rewrite Rinv_l; lra.
  - destruct (taken1 0 v0 v1) as (v1' & i' & j' & Hv1 & E).
    rewrite E, plus_assoc, turns_turns in Hx1. clear E.
    assert (Hg : divisor r = 1%Z) by (unfold divisor; now rewrite E01, E11).
    rewrite Hg, Rinv_1, Rminus_0_r in Hv1. apply Rabs_le_between in Hv1.
    destruct (Rle_dec 0 v1') as [Hpos | Hneg].
    + apply (none t x Ht Hx Hx0), (turned_back r _ _ _ _ _ Hx1 Hv0), Hhalf. lra.
    + apply (none _ _ (reordered_in_cube order t Ht) (across _ _ is_kind order t x Horder Hx)).
      * rewrite Hx0. unfold swap, point. cbn [fst snd]. now rewrite Hdiagonal.
      * apply (turned_back r v0 (- v1') (j' + j) (i' + i)); [| assumption | apply Hhalf; lra].
        rewrite Hx1. unfold swap, plus, at_v, turns. rewrite E00, E01, E10, E11.
        apply vec_eq; cbn [fst snd]; ring.
Qed.

(* ---- v0: all of it, or half *)

(* Half way between the v0 of x1 and of x-1. *)
Definition turning_point (t : list R) : R :=
  v0_of r (minus (point xstar) (scale (/ 2) (V' (waves patch t) (point xstar)))).

Definition reach : R := IZR (divisor r) / IZR (Z.abs (determinant r)).

Definition all0 : Prop :=
  reach <= Q2R (half0 r) \/
  forall t, in_cube t -> Q2R (centre0 r) - Q2R (half0 r) <= turning_point t /\
                         turning_point t + reach <= Q2R (centre0 r) + Q2R (half0 r).

Theorem whole_torus : all0 -> all1 patch xstar ->
  forall t x, in_cube t -> K t x -> x 0%Z <> point xstar.
Proof.
  intros H0 H1 t x Ht Hx Hx0. pose proof (any_v1 H1 t Ht) as Hany.
  set (y := x 1%Z) in *. assert (Hy := at_v_of y). destruct H0 as [Hall | Hhalf].
  - destruct (taken0 (Q2R (centre0 r)) (v0_of r y) (v1_of r y)) as (v0 & v1 & i & j & Hv0 & E).
    rewrite Hy in E. apply (Hany x Hx Hx0 v0 v1 i j); [|exact E].
    eapply Rle_trans; [exact Hv0 | exact Hall].
  - destruct (Hhalf t Ht) as [Hlow Hhigh]. set (c := turning_point t) in *.
    destruct (taken0 c (v0_of r y) (v1_of r y)) as (v0 & v1 & i & j & Hv0 & E).
    rewrite Hy in E. fold reach in Hv0. apply Rabs_le_between in Hv0.
    destruct (Rle_dec c v0) as [Hpos | Hneg].
    + apply (Hany x Hx Hx0 v0 v1 i j); [|exact E]. apply Rabs_le. lra.
    + set (z := minus (point xstar) (scale (/ 2) (V' (waves patch t) (point xstar)))).
      pose proof (at_v_of z) as Hz. change (v0_of r z) with c in Hz.
      apply (Hany _ (back _ _ is_kind _ _ Hx) Hx0 (2 * c - v0) (2 * v1_of r z - v1)
               (- i)%Z (- j)%Z).
      * apply Rabs_le. lra.
      * apply (is_orbit _ _ is_kind) in Hx.
        specialize (Hx 0%Z). change (0 + 1)%Z with 1%Z in Hx. change (0 - 1)%Z with (-1)%Z in Hx.
        change (reversed x 1%Z) with (x (-1)%Z). fold y in Hx. rewrite Hx0, E in Hx.
        generalize dependent (v1_of r z). intros w Hz. unfold z in Hz.
        destruct (V' (waves patch t) (point xstar)) as [F0 F1], (x (-1)%Z) as [X0 X1].
        unfold at_v, plus, minus, scale, turns in *. cbn [fst snd] in *.
        injection Hx as Hx Hx'. injection Hz as Hz Hz'. rewrite !opp_IZR. f_equal; lra.
Qed.

End Lattice.

Theorem whole_orbits r patch xstar : determinant r <> 0%Z -> all0 r patch xstar ->
  all1 r patch xstar -> no_minimizing_orbit_into r patch xstar -> no_minimizing_orbit patch xstar.
Proof.
  intros Hr H0 H1 Hnone t Ht x Hx Hx0. apply NNPP. intros Hmin.
  refine (whole_torus r Hr patch xstar _ (minimizing_kind patch) _ H0 H1 t x Ht (conj Hx Hmin) Hx0).
  intros t' x' Ht' [Hx' Hmin'] Hx0' Hinto. now apply Hmin', (Hnone t').
Qed.

Theorem whole_graphs r patch xstar : determinant r <> 0%Z -> all0 r patch xstar ->
  all1 r patch xstar ->
  (forall t, in_cube t -> no_invariant_graph_into r (waves patch t) (point xstar)) ->
  forall t, in_cube t -> no_invariant_graph (waves patch t).
Proof.
  intros Hr H0 H1 Hnone t Ht c S S' HS HS' Hinv.
  destruct (Graph.graph_orbits_minimize _ c S S' HS HS' Hinv (point xstar)) as (x & _ & Hx0 & Hx & _).
  refine (whole_torus r Hr patch xstar _ (on_graph_kind patch) _ H0 H1 t x Ht _ Hx0).
  - intros t' x' Ht' (c' & T & T' & HT & HT' & Hinv' & Hx') Hx0' Hinto.
    apply (Hnone t' Ht' c' T T' HT HT' Hinv'). rewrite <- Hx0'. change 1%Z with (0 + 1)%Z in Hinto.
    now rewrite Hx' in Hinto.
  - now exists c, S, S'.
Qed.

(* ---- the same, to be computed; turning_point in Check.v *)

Definition direct0 (r : region) : bool :=
  Qle_bool (inject_Z (divisor r)) (half0 r * inject_Z (Z.abs (determinant r))).

Definition direct1 (r : region) : bool := Qle_bool 1 (half1 r * inject_Z (divisor r)).

(* May a region with these shifts stand for its image, too, in which v1 has the other sign?  n is the
   number of parameters. *)
Definition folds (r : region) (patch : list term) (xstar : Q * Q) (s : list Q * list Q) (n : nat) :
    bool :=
  (m00 r =? 1)%Z && (m01 r =? 1)%Z && (m10 r =? 1)%Z && (m11 r =? -1)%Z
  && Qeq_bool (fst xstar) (snd xstar)
  && existsb (fun order => symmetric patch order && (length (fst s) <=? length order)%nat
                && forallb (fun q => Qeq_bool q 0) (added (-1) (fst s) (reordered 0%Q order (fst s))))
             (permutations n)
  && forallb (fun q => Qeq_bool q 0) (snd s)
  && Qle_bool (centre1 r - half1 r) 0 && Qle_bool 0 (centre1 r + half1 r).

Definition exchanges (r : region) (patch : list term) (xstar : Q * Q) (n : nat) : bool :=
  folds r patch xstar ([], []) n && Qle_bool 1 (centre1 r + half1 r).

(* The region and its image together. *)
Definition folded (r : region) : region :=
  Region (m00 r) (m01 r) (m10 r) (m11 r) (centre0 r) (half0 r) 0 (Qabs.Qabs (centre1 r) + half1 r).

Lemma Q2R_0 : Q2R 0 = 0.
Proof. unfold Q2R; cbn; lra. Qed.

Lemma Q2R_1 : Q2R 1 = 1.
Proof. unfold Q2R; cbn; lra. Qed.

Lemma direct0_correct r : determinant r <> 0%Z -> direct0 r = true -> reach r <= Q2R (half0 r).
Proof.
  intros Hr H. apply Qle_bool_iff, Qle_Rle in H. rewrite Q2R_mult, !Q2R_inject_Z in H.
  assert (Hpos : (0 < Z.abs (determinant r))%Z) by lia. apply IZR_lt in Hpos. unfold reach.
  apply Rmult_le_reg_r with (IZR (Z.abs (determinant r))); [assumption|].
  unfold Rdiv. rewrite Rmult_assoc, Rinv_l; lra.
Qed.

Lemma permutations_length n order : In order (permutations n) -> length order = n.
Proof.
  destruct n as [| [| [| [| n]]]]; cbn [permutations In]; intros H;
    repeat (destruct H as [<- | H]; [reflexivity |]); destruct H.
Qed.

Lemma folds_correct r patch xstar s n : folds r patch xstar s n = true ->
  m00 r = 1%Z /\ m01 r = 1%Z /\ m10 r = 1%Z /\ m11 r = (-1)%Z /\
  Q2R (fst xstar) = Q2R (snd xstar) /\
  (exists order, length order = n /\ symmetric patch order = true /\
   forall t, combined (fst s) (reordered 0 order t) = combined (fst s) t) /\
  (forall t, combined (snd s) t = 0) /\ - Q2R (half1 r) <= Q2R (centre1 r) <= Q2R (half1 r).
Proof.
  unfold folds. rewrite !andb_true_iff, !Z.eqb_eq.
  intros ((((((((H00 & H01) & H10) & H11) & Hs) & Ho) & H1) & Hlow) & Hhigh).
  apply Qle_bool_iff, Qle_Rle in Hlow, Hhigh. rewrite Q2R_minus, Q2R_0 in Hlow.
  rewrite Q2R_plus, Q2R_0 in Hhigh. repeat split; try assumption; try lra.
  - now apply Qeq_eqR, Qeq_bool_eq.
  - apply existsb_exists in Ho as (order & Hin & H). rewrite !andb_true_iff in H.
    destruct H as ((Hsym & Hlength) & H0). exists order.
    split; [now apply permutations_length |]. split; [exact Hsym |]. intros t.
    apply combined_zero with (t := reordered 0 order t) in H0. rewrite combined_added in H0.
    rewrite <- (combined_reordered order (fst s) t); [replace (Q2R (-1)) with (-1) in H0 by
      (unfold Q2R; cbn; lra); lra | | now apply Nat.leb_le].
    unfold symmetric in Hsym. apply andb_prop in Hsym as [Hsym _]. apply andb_prop in Hsym as [Hsym _].
    now apply order_correct.
  - intros t. now apply combined_zero.
Qed.

Lemma exchanges_correct r patch xstar n : exchanges r patch xstar n = true ->
  exchangeable r patch xstar.
Proof.
  intros H. apply andb_prop in H as [H Hhigh].
  apply folds_correct in H as (H00 & H01 & H10 & H11 & Hs & (order & _ & Ho & _) & _ & _ & Hlow).
  apply Qle_bool_iff, Qle_Rle in Hhigh. rewrite Q2R_plus, Q2R_1 in Hhigh.
  repeat split; try assumption; [now exists order |]. intros v1 Hv1. apply Rabs_le. lra.
Qed.

Lemma all1_correct r patch xstar n : direct1 r || exchanges r patch xstar n = true ->
  all1 r patch xstar.
Proof.
  intros H. apply orb_prop in H as [H | H]; [left | right; now apply exchanges_correct in H].
  apply Qle_bool_iff, Qle_Rle in H. now rewrite Q2R_mult, Q2R_inject_Z, Q2R_1 in H.
Qed.

(* Where turning_point lies: it is linear in the parameters. *)
Definition push (r : region) (w : term) : Z := (m11 r * of_k0 w - m01 r * of_k1 w)%Z.

(* The sum over the waves of what they push, for amplitudes f. *)
Definition pushed (r : region) (patch : list term) (z : vec) (f : term -> Q) : R :=
  sum (fun w => IZR (push r w) * cos (angle (wave_at [] w) z) * Q2R (f w)) patch.

Lemma sum_sum {A B} (f : A -> B -> R) l l' :
  sum (fun a => sum (f a) l') l = sum (fun b => sum (fun a => f a b) l) l'.
Proof.
  induction l as [|a l IH]; cbn.
  - rewrite (sum_ext _ (fun _ => 0 * 0)), sum_scale by (intros; cbn; ring). ring.
  - fold (sum (fun a => sum (f a) l') l). rewrite IH, <- sum_plus. reflexivity.
Qed.

Lemma V'_pushed a b ws y : a * snd (V' ws y) - b * fst (V' ws y) =
  sum (fun w => (b * IZR (k0 w) - a * IZR (k1 w)) * cos (angle w y) * amplitude w) ws.
Proof.
  unfold V'; cbn [fst snd]. induction ws as [|w ws IH]; cbn in *; [ring|]. unfold sum in IH.
  rewrite <- IH. ring.
Qed.

Lemma turning_point_linear r patch xstar n t :
  (forall w, In w patch -> (length (parts w) <= n)%nat) ->
  turning_point r patch xstar t =
  (IZR (m11 r) * fst (point xstar) - IZR (m01 r) * snd (point xstar)
   + / 2 * (pushed r patch (point xstar) middle
            + sum (fun i => pushed r patch (point xstar) (fun w => nth i (parts w) 0%Q) * nth i t 0)
                  (seq 0 n))) / (PI * IZR (determinant r)).
Proof.
  intros Hn. unfold turning_point, v0_of. f_equal. set (z := point xstar).
  transitivity (IZR (m11 r) * fst z - IZR (m01 r) * snd z + / 2 *
    (IZR (m01 r) * snd (V' (waves patch t) z) - IZR (m11 r) * fst (V' (waves patch t) z)));
    [unfold minus, scale; cbn [fst snd]; field|].
  do 2 f_equal. rewrite V'_pushed. unfold waves, pushed at 1. rewrite sum_map.
  rewrite (sum_ext _ (fun i => sum (fun w => IZR (push r w) * cos (angle (wave_at [] w) z)
    * (Q2R (nth i (parts w) 0%Q) * nth i t 0)) patch) (seq 0 n)).
  - rewrite sum_sum, <- sum_plus. apply sum_ext. intros w Hw.
    rewrite sum_scale, <- (combined_sum n) by auto. unfold push. rewrite minus_IZR, !mult_IZR.
    cbn [k0 k1 amplitude]. change (angle (Wave _ _ _ _) z) with (angle (wave_at [] w) z). ring.
  - intros i _. unfold pushed. rewrite Rmult_comm, <- sum_scale. apply sum_ext. intros w _. ring.
Qed.
