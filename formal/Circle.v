(* From a conjugacy to an invariant graph, for one angle (docs/proofs/existence.md, section 7).  Let x be a
   continuous, increasing function, x(a + 2 pi) = x(a) + 2 pi, and x(a + w) - 2 x(a) + x(a - w) + V'(x(a)) = 0.
   Then J = x(a) - x(a - w) at y = x(a) is an invariant graph.  Nothing is said of derivatives of x. *)

From Coq Require Import Reals ZArith List Lra Lia.
From Coquelicot Require Import Coquelicot.
From Converse Require Import Map.
From Converse Require Graph Plain.
Import ListNotations.
Open Scope R_scope.

(* Waves of the first angle alone, and their V'. *)
Definition first_only (ws : list wave) : Prop := forall w, In w ws -> k1 w = 0%Z.
Definition force (ws : list wave) (a : R) : R := fst (V' ws (a, 0)).

Lemma force_of ws y : first_only ws -> V' ws y = (force ws (fst y), 0).
Proof.
  intros H. unfold force, V'. cbn [fst snd]. induction ws as [| w ws IH].
  - cbn. now rewrite Ropp_0.
  - specialize (IH (fun v Hv => H v (or_intror Hv))). injection IH as E0 E1.
    specialize (H w (or_introl eq_refl)).
    cbn [sum fold_right]. fold (sum (fun w : wave => IZR (k0 w) * (amplitude w * cos (angle w y))) ws).
    fold (sum (fun w : wave => IZR (k1 w) * (amplitude w * cos (angle w y))) ws).
    fold (sum (fun w : wave => IZR (k0 w) * (amplitude w * cos (angle w (fst y, 0)))) ws).
    assert (A : angle w y = angle w (fst y, 0)) by (unfold angle, along; rewrite H; cbn [fst snd]; ring).
    rewrite A, H. f_equal; lra.
Qed.

Section Circle.
Variables (x : R -> R) (omega : R).
Hypothesis increasing : forall a b, a < b -> x a < x b.
Hypothesis turn : forall a, x (a + 2 * PI) = x a + 2 * PI.
Hypothesis cont : forall a, Continuity.continuous x a.

Lemma turn_Z (m : Z) a : x (a + 2 * PI * IZR m) = x a + 2 * PI * IZR m.
Proof.
  assert (P := Plain.periods (fun a => x a - a) (2 * PI)). cbv beta in P.
  specialize (P ltac:(intros b; rewrite turn; ring) m a). lra.
Qed.

Lemma onto y : {a : R | x a = y}.
Proof.
  pose proof PI_RGT_0. set (m := (- Int_part ((y - x 0) / (2 * PI)))%Z).
  assert (Hm : 0 <= y - x 0 + 2 * PI * IZR m <= 2 * PI).
  { unfold m. rewrite opp_IZR. destruct (base_Int_part ((y - x 0) / (2 * PI))) as [h0 h1].
    assert (y - x 0 = (y - x 0) / (2 * PI) * (2 * PI)) as E by (field; lra).
    set (q := (y - x 0) / (2 * PI)) in *. set (i := IZR (Int_part q)) in *. clearbody q i. rewrite E. nra. }
  set (lo := - (2 * PI * IZR m)).
  assert (E : x lo = x 0 - 2 * PI * IZR m).
  { unfold lo. pose proof (turn_Z (- m) 0) as T. rewrite opp_IZR in T.
    replace (0 + 2 * PI * - IZR m) with (- (2 * PI * IZR m)) in T by ring. lra. }
  assert (E' : x (lo + 2 * PI) = x lo + 2 * PI) by apply turn.
  destruct (IVT_gen x lo (lo + 2 * PI) y) as (a & _ & Ha).
  - intros a. apply continuity_pt_filterlim, cont.
  - rewrite E'. unfold Rmin, Rmax. destruct (Rle_dec _ _); lra.
  - now exists a.
Qed.

Lemma injective a b : x a = x b -> a = b.
Proof.
  intros E. destruct (Rtotal_order a b) as [H | [H | H]]; [| exact H |];
    apply increasing in H; lra.
Qed.

Definition phase_of (y : R) : R := proj1_sig (onto y).

Lemma x_phase y : x (phase_of y) = y.
Proof. unfold phase_of. now destruct (onto y). Qed.

Lemma phase_x a : phase_of (x a) = a.
Proof. apply injective, x_phase. Qed.

Lemma phase_turn y : phase_of (y + 2 * PI) = phase_of y + 2 * PI.
Proof. apply injective. now rewrite x_phase, turn, x_phase. Qed.

Lemma phase_increasing a b : a < b -> phase_of a < phase_of b.
Proof.
  intros H. destruct (Rlt_le_dec (phase_of a) (phase_of b)) as [L | L]; [exact L |].
  destruct L as [L | L]; [apply increasing in L | apply (f_equal x) in L];
    rewrite !x_phase in L; lra.
Qed.

Lemma phase_continuous y : Continuity.continuous phase_of y.
Proof.
  apply continuity_pt_filterlim. intros eps Heps. set (a := phase_of y).
  set (d := Rmin (y - x (a - eps)) (x (a + eps) - y)).
  assert (x (a - eps) < y /\ y < x (a + eps)) as [Hl Hu].
  { unfold a. rewrite <- (x_phase y) at 2 3. split; apply increasing; lra. }
  exists d. split; [unfold d; apply Rmin_glb_lt; lra |].
  intros z [_ Hz]. unfold dist, R_met, R_dist in *. apply Rabs_def2 in Hz.
  assert (d <= y - x (a - eps)) by apply Rmin_l. assert (d <= x (a + eps) - y) by apply Rmin_r.
  assert (A : a - eps < phase_of z) by (rewrite <- (phase_x (a - eps)); apply phase_increasing; lra).
  assert (B : phase_of z < a + eps) by (rewrite <- (phase_x (a + eps)); apply phase_increasing; lra).
  apply Rabs_def1; fold a; lra.
Qed.

(* The momentum at an angle, and its mean. *)
Definition psi (y : R) : R := y - x (phase_of y - omega).

Lemma psi_continuous y : Continuity.continuous psi y.
Proof.
  unfold psi. apply (continuous_minus (V := R_NormedModule)); [apply continuous_id |].
  apply (continuous_comp (fun y => phase_of y - omega) x); [| apply cont].
  apply (continuous_minus (V := R_NormedModule)); [apply phase_continuous | apply continuous_const].
Qed.

Lemma psi_turn y : psi (y + 2 * PI) = psi y.
Proof.
  unfold psi. rewrite phase_turn.
  replace (phase_of y + 2 * PI - omega) with (phase_of y - omega + 2 * PI) by ring.
  rewrite turn. ring.
Qed.

Definition mean : R := RInt psi 0 (2 * PI) / (2 * PI).
Definition U (y : R) : R := RInt (fun a => psi a - mean) 0 y.

Lemma U_derive y : is_derive U y (psi y - mean).
Proof.
  apply (is_derive_RInt (V := R_CompleteNormedModule) (fun a => psi a - mean) U 0 y).
  - exists (mkposreal 1 Rlt_0_1). intros z _. apply (RInt_correct (V := R_CompleteNormedModule)).
    apply (ex_RInt_continuous (V := R_CompleteNormedModule)). intros a _.
    apply (continuous_minus (V := R_NormedModule)); [apply psi_continuous | apply continuous_const].
  - apply (continuous_minus (V := R_NormedModule)); [apply psi_continuous | apply continuous_const].
Qed.

Lemma U_0 : U 0 = 0.
Proof. unfold U. now rewrite RInt_point. Qed.

Lemma U_2PI : U (2 * PI) = 0.
Proof.
  assert (H0 : ex_RInt psi 0 (2 * PI)).
  { apply (ex_RInt_continuous (V := R_CompleteNormedModule)). intros a _. apply psi_continuous. }
  assert (H1 : ex_RInt (fun _ : R => mean) 0 (2 * PI)) by apply ex_RInt_const.
  pose proof (RInt_minus (V := R_CompleteNormedModule) psi (fun _ => mean) 0 (2 * PI) H0 H1) as E.
  rewrite RInt_const in E. change (U (2 * PI) = RInt psi 0 (2 * PI) - (2 * PI - 0) * mean) in E.
  rewrite E. unfold mean. field. apply PI_neq0.
Qed.

Lemma U_turn y : U (y + 2 * PI) = U y.
Proof.
  set (D := fun y => U (y + 2 * PI) - U y).
  assert (HD : forall z, is_derive D z 0).
  { intros z. unfold D. replace 0 with ((1 * (psi (z + 2 * PI) - mean)) - (psi z - mean))
      by (rewrite psi_turn; ring).
    apply (is_derive_minus (V := R_NormedModule)); [| apply U_derive].
    apply (is_derive_comp U (fun z => z + 2 * PI)); [apply U_derive |].
    auto_derive; [exact I | ring]. }
  assert (E : D y = D 0).
  { destruct (MVT_gen D 0 y (fun _ => 0)) as (c & _ & Hc).
    - intros z _. apply HD.
    - intros z _. apply continuity_pt_filterlim, (ex_derive_continuous (V := R_NormedModule)).
      exists 0. apply HD.
    - lra. }
  unfold D in E. rewrite Rplus_0_l, U_2PI, U_0 in E. lra.
Qed.

(* ---- the graph *)
Variable ws : list wave.
Hypothesis first : first_only ws.
Hypothesis solves : forall a, x (a + omega) - 2 * x a + x (a - omega) + force ws (x a) = 0.

Definition S2 (y : vec) : R := U (fst y).
Definition S2' (y : vec) : vec := (psi (fst y) - mean, 0).

Theorem circle_graph : has_invariant_graph ws.
Proof.
  exists (mean, 0), S2, S2'. split; [| split].
  - intros y m0 m1. unfold S2, plus, scale. cbn [fst snd]. apply (Plain.periods U), U_turn.
  - repeat split.
    + intros y. unfold S2, S2'. cbn [fst snd]. apply is_derive_Reals, U_derive.
    + intros y. unfold S2, S2'. cbn [fst snd]. apply derivable_pt_lim_const.
    + apply Graph.continuous_ball. intros y. unfold S2'. cbn [fst].
      apply (continuous_comp (U := prod_UniformSpace R_UniformSpace R_UniformSpace)
        fst (fun a => psi a - mean)); [apply continuous_fst |].
      apply (continuous_minus (V := R_NormedModule)); [apply psi_continuous | apply continuous_const].
    + apply Graph.continuous_ball. intros y. unfold S2'. cbn [snd]. apply continuous_const.
  - intros y. unfold F. cbn [fst snd]. rewrite !force_of by exact first.
    set (a := phase_of (fst y)). assert (Ea : x a = fst y) by apply x_phase.
    unfold S2', Map.plus, Map.minus. cbn [fst snd].
    assert (E : mean + (psi (fst y) - mean) - force ws (fst y) = x (a + omega) - fst y).
    { unfold psi. fold a. pose proof (solves a) as H. rewrite Ea in H. lra. }
    rewrite E. replace (fst y + (x (a + omega) - fst y)) with (x (a + omega)) by ring.
    f_equal; [| ring]. unfold psi. rewrite phase_x. replace (a + omega - omega) with a by ring.
    rewrite Ea. ring.
Qed.
End Circle.
