(* What a claim is reduced to: problems in rationals, which are to be excluded point by point, and
   what may be changed about a problem before.  Only waves that are felt are left, the frame may be
   turned, mirror images need not be looked at twice.  At the end what follows for invariant graphs.
   All this is real analysis and exact arithmetic of rationals. *)

From Coq Require Import Reals ZArith QArith Qreals List Bool Lra Lia.
From Converse Require Import Map Criterion Tree.
From Converse Require Graph.
Import ListNotations.
Open Scope R_scope.

(* ---- what a file claims *)

(* Are both coordinates looked at, or is it a product map, of which one is? *)
Inductive alone := Both | First | Second.

(* Are there no graphs for all larger amplitudes either: of the whole patch, of its upper end? *)
Inductive once := No | Whole_patch | Upper_end.

Record claim := Claim {
  of_patch : list term; of_region : region;
  shifts : list Q * list Q;        (* what the parameters add to the centres of v0 and of v1 *)
  of_xstar : Q * Q;
  of_whole : bool;                                  (* is the region said to be enough for all x1? *)
  of_alone : alone; of_once : once;
  odd : option (Q * Q)                              (* V is odd about this point *)
}.

(* ---- problems *)

(* x0 is the start, x1 is pi times the matrix applied to v, v = middle + what the parameters shift it
   by + half-width times u, and u and the parameters are from -1 to 1. *)
Record problem := Problem {
  terms : list term;
  start : Q * Q;
  f00 : Q; f01 : Q; f10 : Q; f11 : Q;
  mid0 : Q; shift0 : list Q; wid0 : Q;
  mid1 : Q; shift1 : list Q; wid1 : Q
}.

(* x1, for the parameters and the u of both angles. *)
Definition second (p : problem) (t : list R) (u0 u1 : R) : vec :=
  let v0 := Q2R (mid0 p) + combined (shift0 p) t + Q2R (wid0 p) * u0 in
  let v1 := Q2R (mid1 p) + combined (shift1 p) t + Q2R (wid1 p) * u1 in
  (PI * (Q2R (f00 p) * v0 + Q2R (f01 p) * v1), PI * (Q2R (f10 p) * v0 + Q2R (f11 p) * v1)).

(* For the point u = (u0, u1, parameters) of the problem's cube. *)
Definition excluded (p : problem) (u : list R) : Prop :=
  match u with
  | u0 :: u1 :: t => in_cube t -> forall x, orbit (waves (terms p) t) x ->
                     x 0%Z = point (start p) -> x 1%Z = second p t u0 u1 ->
                     refuted (waves (terms p) t) x
  | _ => True
  end.

(* ---- the problem of a region *)

Definition problem_of (r : region) (s : list Q * list Q) (patch : list term) (xstar : Q * Q) :
    problem :=
  Problem patch xstar (inject_Z (m00 r)) (inject_Z (m01 r)) (inject_Z (m10 r)) (inject_Z (m11 r))
          (centre0 r) (fst s) (half0 r) (centre1 r) (snd s) (half1 r).

Lemma Q2R_inject_Z z : Q2R (inject_Z z) = IZR z.
Proof. unfold Q2R; cbn. field. Qed.

(* A number as near to c as h is c + h u, u from -1 to 1. *)
Lemma in_units v c h : Rabs (v - c) <= h -> exists u, -1 <= u <= 1 /\ v = c + h * u.
Proof.
  intros H. pose proof (Rle_abs (v - c)). pose proof (Rle_abs (- (v - c))) as Hopp.
  rewrite Rabs_Ropp in Hopp. destruct (Req_dec h 0) as [->|Hh].
  - exists 0. lra.
  - exists ((v - c) / h). split; [|field; assumption].
    assert (Hpos : 0 < h) by lra.
    split; apply Rmult_le_reg_r with h; try assumption;
      unfold Rdiv; rewrite ?Rmult_assoc, ?Rinv_l; lra.
Qed.

(* n parameters: those that are missing are 0, those beyond are left out. *)
Definition fitted (n : nat) (t : list R) : list R := map (fun i => nth i t 0) (seq 0 n).

Lemma fitted_length n t : length (fitted n t) = n.
Proof. unfold fitted. now rewrite map_length, seq_length. Qed.

(* A parameter that is missing, too, is from -1 to 1. *)
Lemma nth_in_cube t i : in_cube t -> -1 <= nth i t 0 <= 1.
Proof.
  intros Ht. destruct (nth_in_or_default i t 0) as [Hin| ->]; [|lra].
  unfold in_cube in Ht. rewrite Forall_forall in Ht. auto.
Qed.

Lemma reordered_in_cube order t : in_cube t -> in_cube (reordered 0 order t).
Proof.
  intros Ht. apply Forall_forall. intros x Hx. apply in_map_iff in Hx as (i & <- & _).
  now apply nth_in_cube.
Qed.

Lemma fitted_in_cube n t : in_cube t -> in_cube (fitted n t).
Proof. exact (reordered_in_cube (seq 0 n) t). Qed.

(* Patches of at most n parts do not see the difference. *)
Lemma combined_fitted n parts t : (length parts <= n)%nat ->
  combined parts (fitted n t) = combined parts t.
Proof.
  intros Hn. rewrite !(combined_sum n) by assumption. apply sum_ext. intros i Hi.
  apply in_seq in Hi. f_equal. unfold fitted.
  rewrite (nth_indep _ 0 (nth 0 t 0)) by (rewrite map_length, seq_length; lia).
  rewrite (map_nth (fun i => nth i t 0)), seq_nth by lia. reflexivity.
Qed.

Lemma waves_fitted n patch t : (forall w, In w patch -> (length (parts w) <= n)%nat) ->
  waves patch (fitted n t) = waves patch t.
Proof.
  intros Hn. apply map_ext_in. intros w Hw. now rewrite combined_fitted by now apply Hn.
Qed.

(* If all points of the problem's cube are excluded, so is the region, where nothing is shifted. *)
Theorem into_of_problem : forall r patch xstar (n : nat),
  (forall w, In w patch -> (length (parts w) <= n)%nat) ->
  (forall u, length u = (2 + n)%nat -> Forall (fun x => -1 <= x <= 1) u ->
   excluded (problem_of r ([], []) patch xstar) u) ->
  no_minimizing_orbit_into r patch xstar.
Proof.
  intros r patch xstar n Hn Hexcluded. apply into_rectangle.
  intros t Ht x Hx Hx0 (v0 & v1 & Hv0 & Hv1 & Hx1).
  apply in_units in Hv0 as (u0 & Hu0 & ->). apply in_units in Hv1 as (u1 & Hu1 & ->).
  rewrite <- (waves_fitted n patch t Hn) in *. apply (fitted_in_cube n) in Ht.
  apply (Hexcluded (u0 :: u1 :: fitted n t)); try assumption.
  - cbn. now rewrite fitted_length.
  - constructor; [assumption|]. now constructor.
  - rewrite Hx1. unfold second, problem_of.
    cbn [f00 f01 f10 f11 mid0 shift0 wid0 mid1 shift1 wid1 fst snd].
    change (combined [] (fitted n t)) with 0. now rewrite !Q2R_inject_Z, !Rplus_0_r.
Qed.

(* ---- the waves that are felt *)

(* Is the term other than zero? *)
Definition present (w : term) : bool :=
  negb (Qeq_bool (middle w) 0 && forallb (fun q => Qeq_bool q 0) (parts w)).

Definition feels (a : alone) (w : term) : bool :=
  match a with
  | Both => true
  | First => negb (of_k0 w =? 0)%Z
  | Second => negb (of_k1 w =? 0)%Z
  end.

Definition felt (a : alone) (patch : list term) : list term :=
  filter (fun w => present w && feels a w) patch.

(* May a coordinate be looked at alone? *)
Definition alone_ok (a : alone) (patch : list term) : bool :=
  match a with
  | Both => true
  | _ => forallb (fun w => negb (present w) || (of_k0 w * of_k1 w =? 0)%Z) patch
  end.

Lemma Q2R_zero q : Qeq_bool q 0 = true -> Q2R q = 0.
Proof. intros H. apply Qeq_bool_eq, Qeq_eqR in H. rewrite H. unfold Q2R; cbn. ring. Qed.

(* Terms that are not present have no amplitude. *)
Lemma combined_zero parts t : forallb (fun q => Qeq_bool q 0) parts = true -> combined parts t = 0.
Proof.
  revert t. induction parts as [|q parts IH]; intros [|x t] H; try reflexivity.
  cbn in H. apply andb_prop in H as [Hq H].
  change (Q2R q * x + combined parts t = 0). rewrite (Q2R_zero q Hq), (IH t H). ring.
Qed.

Lemma absent w t : present w = false -> Q2R (middle w) + combined (parts w) t = 0.
Proof.
  unfold present. intros H. apply negb_false_iff, andb_prop in H as [Hm Hp].
  rewrite (Q2R_zero _ Hm), (combined_zero _ t Hp). ring.
Qed.

(* So they contribute nothing to sums over waves, for whatever amplitudes. *)
Lemma sum_present (f : wave -> R) s patch t : (forall w, amplitude w = 0 -> f w = 0) ->
  sum f (scaled s (waves (filter present patch) t)) = sum f (scaled s (waves patch t)).
Proof.
  intros Hf. unfold scaled, waves. rewrite !sum_map.
  apply sum_filter; [reflexivity|]. intros w _ Hw. apply Hf. cbn [amplitude].
  rewrite absent by assumption. ring.
Qed.

Lemma V'_present s patch t y :
  V' (scaled s (waves (filter present patch) t)) y = V' (scaled s (waves patch t)) y.
Proof.
  unfold V'. f_equal; f_equal; apply sum_present; intros w Hw; rewrite Hw; ring.
Qed.

Lemma beta_present s patch t y v :
  beta (scaled s (waves (filter present patch) t)) y v = beta (scaled s (waves patch t)) y v.
Proof.
  unfold beta. f_equal. apply sum_present. intros w Hw. rewrite Hw. ring.
Qed.

(* The same for waves, and the orbit whose other coordinate is free. *)
Definition feels_wave (a : alone) : wave -> bool :=
  match a with Both => fun _ => true | First => feels0 | Second => feels1 end.

Definition freed (a : alone) (x : Z -> vec) : Z -> vec :=
  match a with Both => x | First => free1 x | Second => free0 x end.

Lemma freed_0 a x : freed a x 0%Z = x 0%Z.
Proof. destruct a; [reflexivity | |]; apply vec_eq; unfold freed, free0, free1; cbn; ring. Qed.

Lemma freed_1 a x : freed a x 1%Z = x 1%Z.
Proof. destruct a; [reflexivity | |]; apply vec_eq; unfold freed, free0, free1; cbn; ring. Qed.

Lemma filter_all {A} (l : list A) : filter (fun _ => true) l = l.
Proof. induction l as [|x l IH]; cbn; congruence. Qed.

Lemma feels_scaled a s ws :
  filter (feels_wave a) (scaled s ws) = scaled s (filter (feels_wave a) ws).
Proof.
  unfold scaled. induction ws as [|w ws IH]; [reflexivity|]. cbn. rewrite IH.
  replace (feels_wave a (Wave (k0 w) (k1 w) (phase w) (s * amplitude w))) with (feels_wave a w)
    by now destruct a.
  now destruct (feels_wave a w).
Qed.

Lemma waves_felt a patch t :
  waves (felt a patch) t = filter (feels_wave a) (waves (filter present patch) t).
Proof.
  change (map (wave_at t) (felt a patch)
          = filter (feels_wave a) (map (wave_at t) (filter present patch))).
  unfold felt. induction patch as [|w patch IH]; [reflexivity|]. cbn -[wave_at].
  destruct (present w); cbn -[wave_at]; [|exact IH].
  replace (feels_wave a (wave_at t w)) with (feels a w) by now destruct a.
  destruct (feels a w); cbn -[wave_at]; now rewrite IH.
Qed.

Lemma product_present a patch t s : alone_ok a patch = true -> a <> Both ->
  forall w, In w (scaled s (waves (filter present patch) t)) -> (k0 w * k1 w = 0)%Z.
Proof.
  intros Hok Ha w' Hw'. apply in_map_iff in Hw' as (w'' & <- & Hw'').
  apply in_map_iff in Hw'' as (w & <- & Hw). apply filter_In in Hw as [Hin Hw]. cbn [k0 k1].
  destruct a; [easy | |]; cbn in Hok; rewrite forallb_forall in Hok;
    specialize (Hok w Hin); rewrite Hw in Hok; now apply Z.eqb_eq in Hok.
Qed.

(* Each orbit has one of the felt waves with the same x0 and x1, and if that is refuted so is it. *)
Lemma felt_orbit a patch t s x : alone_ok a patch = true -> orbit (scaled s (waves patch t)) x ->
  orbit (scaled s (waves (felt a patch) t)) (freed a x) /\
  (refuted (scaled s (waves (felt a patch) t)) (freed a x) -> refuted (scaled s (waves patch t)) x).
Proof.
  intros Hok Hx. rewrite waves_felt, <- feels_scaled.
  pose proof (product_present a patch t s Hok) as Hproduct.
  set (ws := scaled s (waves (filter present patch) t)) in *.
  assert (Hback : refuted ws x -> refuted (scaled s (waves patch t)) x).
  { apply refuted_ext. intros j v. apply beta_present. }
  apply (orbit_ext _ ws) in Hx; [|intros y; symmetry; apply V'_present].
  destruct a; cbn [feels_wave freed].
  - rewrite filter_all. auto.
  - destruct (alone0 ws x (Hproduct ltac:(discriminate)) Hx). auto.
  - destruct (alone1 ws x (Hproduct ltac:(discriminate)) Hx). auto.
Qed.

Lemma scaled_1 ws : scaled 1 ws = ws.
Proof.
  unfold scaled. rewrite <- (map_id ws) at 2. apply map_ext. intros []; cbn. now rewrite Rmult_1_l.
Qed.

(* So it is enough to refute the orbits of the felt waves, whatever is known of x1. *)
Theorem felt_refuted : forall a patch x0 (P : vec -> Prop), alone_ok a patch = true ->
  (forall t, in_cube t -> forall x, orbit (waves (felt a patch) t) x -> x 0%Z = x0 -> P (x 1%Z) ->
   refuted (waves (felt a patch) t) x) ->
  forall t, in_cube t -> forall x, orbit (waves patch t) x -> x 0%Z = x0 -> P (x 1%Z) ->
  refuted (waves patch t) x.
Proof.
  intros a patch x0 P Hok H t Ht x Hx Hx0 Hx1.
  rewrite <- (scaled_1 (waves patch t)) in *.
  destruct (felt_orbit a patch t 1 x Hok Hx) as [Ho Hr]. apply Hr.
  rewrite scaled_1 in *.
  apply (H t Ht); [assumption | now rewrite freed_0 | now rewrite freed_1].
Qed.

(* ---- the turned frame *)

Definition halved (q : Q) : Q := Qred (q * (1 # 2)).

Definition turned_term (w : term) : term :=
  Term (of_k0 w + of_k1 w) (of_k0 w - of_k1 w) (of_phase w) (halved (middle w))
       (map halved (parts w)).

Definition turned_problem (p : problem) : problem :=
  Problem (map turned_term (terms p))
    (halved (fst (start p) + snd (start p)), halved (fst (start p) - snd (start p)))
    (halved (f00 p + f10 p)) (halved (f01 p + f11 p))
    (halved (f00 p - f10 p)) (halved (f01 p - f11 p))
    (mid0 p) (shift0 p) (wid0 p) (mid1 p) (shift1 p) (wid1 p).

Lemma Q2R_halved q : Q2R (halved q) = Q2R q / 2.
Proof.
  unfold halved. rewrite (Qeq_eqR _ _ (Qred_correct _)), Q2R_mult. unfold Q2R at 2; cbn. field.
Qed.

Lemma combined_halved parts t : combined (map halved parts) t = combined parts t / 2.
Proof.
  revert t. induction parts as [|q parts IH]; intros [|x t]; try (unfold combined; cbn; lra).
  change (Q2R (halved q) * x + combined (map halved parts) t
          = (Q2R q * x + combined parts t) / 2).
  rewrite IH, Q2R_halved. field.
Qed.

Lemma waves_turned patch t : waves (map turned_term patch) t = turned (waves patch t).
Proof.
  unfold waves, turned. rewrite !map_map. apply map_ext. intros w.
  unfold turned_term; cbn [of_k0 of_k1 of_phase middle parts k0 k1 phase amplitude].
  rewrite Q2R_halved, combined_halved. f_equal. field.
Qed.

Lemma start_turned p : point (start (turned_problem p)) = turn (point (start p)).
Proof.
  unfold point, turn, turned_problem; cbn [start fst snd].
  now rewrite !Q2R_halved, Q2R_plus, Q2R_minus.
Qed.

Lemma second_turned p t u0 u1 : second (turned_problem p) t u0 u1 = turn (second p t u0 u1).
Proof.
  unfold second, turn, turned_problem.
  cbn [f00 f01 f10 f11 mid0 shift0 wid0 mid1 shift1 wid1 fst snd].
  rewrite !Q2R_halved, !Q2R_plus, !Q2R_minus. f_equal; field.
Qed.

Theorem turned_excluded : forall p u, excluded (turned_problem p) u -> excluded p u.
Proof.
  intros p [|u0 [|u1 t]]; try easy. intros H Ht x Hx Hx0 Hx1.
  apply refuted_turned. cbn [excluded] in H. rewrite start_turned, second_turned in H.
  change (terms (turned_problem p)) with (map turned_term (terms p)) in H.
  rewrite waves_turned in H. apply (H Ht).
  - now apply orbit_turned.
  - now rewrite Hx0.
  - now rewrite Hx1.
Qed.

Theorem turned_largest : forall p B,
  (forall t, in_cube t -> forall y v, beta (waves (terms p) t) y v <= B * dot v v) ->
  (forall t, in_cube t -> forall y v,
   beta (waves (terms (turned_problem p)) t) y v <= B * dot v v).
Proof.
  intros p B HB t Ht.
  change (terms (turned_problem p)) with (map turned_term (terms p)).
  rewrite waves_turned. apply largest_turned. now apply HB.
Qed.

(* ---- parameters that move nothing *)

(* Those of n parameters that do: waves or angles, by their parts or shifts. *)
Definition effective (moves : list (list Q)) (n : nat) : list bool :=
  map (fun m => existsb (fun gs => negb (Qnum (nth m gs 0%Q) =? 0)%Z) moves) (seq 0 n).

Definition moves_of (p : problem) : list (list Q) := shift0 p :: shift1 p :: map parts (terms p).

(* The elements that are to be kept, and all beyond. *)
Fixpoint kept {A} (keep : list bool) (l : list A) : list A :=
  match keep, l with
  | b :: keep, x :: l => if b then x :: kept keep l else kept keep l
  | _, _ => l
  end.

(* Zeros put in where kept leaves out. *)
Fixpoint filled (keep : list bool) (t : list R) : list R :=
  match keep, t with
  | false :: keep, _ => 0 :: filled keep t
  | true :: keep, x :: t => x :: filled keep t
  | _, _ => t
  end.

(* Of points and cells: the angles come first. *)
Definition kept_axes {A} (keep : list bool) (l : list A) : list A :=
  match l with
  | u0 :: u1 :: t => u0 :: u1 :: kept keep t
  | _ => l
  end.

Definition kept_term (keep : list bool) (w : term) : term :=
  Term (of_k0 w) (of_k1 w) (of_phase w) (middle w) (kept keep (parts w)).

Definition kept_problem (keep : list bool) (p : problem) : problem :=
  Problem (map (kept_term keep) (terms p)) (start p) (f00 p) (f01 p) (f10 p) (f11 p)
    (mid0 p) (kept keep (shift0 p)) (wid0 p) (mid1 p) (kept keep (shift1 p)) (wid1 p).

Definition still (keep : list bool) (gs : list Q) : Prop :=
  forall m, nth m keep true = false -> Qnum (nth m gs 0%Q) = 0%Z.

Lemma combined_kept keep parts t : still keep parts ->
  combined (kept keep parts) (kept keep t) = combined parts t.
Proof.
  unfold still. revert parts t. induction keep as [|b keep IH]; intros parts t H; [reflexivity|].
  destruct parts as [|q parts]; [reflexivity|].
  destruct t as [|x t]; [unfold combined; now rewrite !combine_nil|].
  assert (E := IH parts t (fun m => H (S m))). specialize (H 0%nat).
  change (combined (q :: parts) (x :: t)) with (Q2R q * x + combined parts t). cbn [kept].
  destruct b.
  - change (combined (q :: kept keep parts) (x :: kept keep t))
      with (Q2R q * x + combined (kept keep parts) (kept keep t)). now rewrite E.
  - cbn in H. assert (Z : Q2R q = 0) by (unfold Q2R; rewrite H by reflexivity; ring).
    rewrite E, Z. ring.
Qed.

Lemma waves_kept keep patch t : Forall (still keep) (map parts patch) ->
  waves (map (kept_term keep) patch) (kept keep t) = waves patch t.
Proof.
  unfold waves. rewrite map_map. intros H. apply map_ext_in. intros w Hw.
  rewrite Forall_forall in H. cbn [kept_term of_k0 of_k1 of_phase middle parts].
  now rewrite (combined_kept keep (parts w) t (H _ (in_map parts _ _ Hw))).
Qed.

Lemma effective_still moves n : Forall (still (effective moves n)) moves.
Proof.
  apply Forall_forall. intros gs Hgs m H. destruct (Nat.lt_ge_cases m n) as [Hm|Hm].
  - unfold effective in H. rewrite (nth_indep _ true (existsb (fun gs => negb (Qnum (nth 0 gs 0%Q)
      =? 0)%Z) moves)) in H by now rewrite map_length, seq_length.
    rewrite (map_nth (fun m => existsb (fun gs => negb (Qnum (nth m gs 0%Q) =? 0)%Z) moves)) in H.
    rewrite seq_nth in H by assumption. cbn [Nat.add] in H.
    destruct (Z.eqb_spec (Qnum (nth m gs 0%Q)) 0) as [E|E]; [exact E|].
    assert (existsb (fun gs => negb (Qnum (nth m gs 0%Q) =? 0)%Z) moves = true); [|congruence].
    apply existsb_exists. exists gs. split; [exact Hgs|]. now apply negb_true_iff, Z.eqb_neq.
  - rewrite nth_overflow in H; [discriminate|]. unfold effective. now rewrite map_length, seq_length.
Qed.

Lemma Forall_kept {A} (P : A -> Prop) keep l : Forall P l -> Forall P (kept keep l).
Proof.
  intros H. revert keep. induction H as [|x l Hx Hl IH]; intros [|b keep]; try now constructor.
  cbn. destruct b; [constructor|]; auto.
Qed.

Lemma kept_filled keep t : kept keep (filled keep t) = t.
Proof.
  revert t. induction keep as [|[] keep IH]; intros t; [now destruct t| |exact (IH t)].
  destruct t as [|x t]; [reflexivity|]. cbn. now rewrite IH.
Qed.

Lemma filled_in_cube keep t : in_cube t -> in_cube (filled keep t).
Proof.
  revert t. induction keep as [|[] keep IH]; intros t H; [now destruct t| |].
  - destruct H; [constructor|]. constructor; [assumption|]. now apply IH.
  - constructor; [lra|]. now apply IH.
Qed.

Theorem kept_excluded : forall keep p u, Forall (still keep) (moves_of p) ->
  excluded (kept_problem keep p) (kept_axes keep u) -> excluded p u.
Proof.
  intros keep p [|u0 [|u1 t]] Hstill; try easy. intros H Ht x Hx Hx0 Hx1.
  inversion Hstill as [|? ? H0 Hrest]; subst. inversion Hrest as [|? ? H1 Hwaves]; subst.
  cbn [kept_axes excluded] in H. unfold second in H.
  cbn [kept_problem terms start f00 f01 f10 f11 mid0 shift0 wid0 mid1 shift1 wid1] in H.
  rewrite waves_kept in H by exact Hwaves. rewrite !combined_kept in H by assumption.
  apply H; trivial. now apply Forall_kept.
Qed.

Theorem kept_largest : forall keep p B, Forall (still keep) (moves_of p) ->
  (forall t, in_cube t -> forall y v, beta (waves (terms p) t) y v <= B * dot v v) ->
  (forall t, in_cube t -> forall y v,
   beta (waves (terms (kept_problem keep p)) t) y v <= B * dot v v).
Proof.
  intros keep p B Hstill HB t Ht. cbn [kept_problem terms].
  rewrite <- (kept_filled keep t), waves_kept by exact (Forall_inv_tail (Forall_inv_tail Hstill)).
  now apply HB, filled_in_cube.
Qed.

Lemma kept_in_cell keep c u : in_cell c u -> in_cell (kept_axes keep c) (kept_axes keep u).
Proof.
  intros H. destruct H as [|s0 x0 c u H0 H]; [constructor|].
  destruct H as [|s1 x1 c u H1 H]; [now constructor; [|constructor]|].
  cbn [kept_axes]. constructor; [assumption|]. constructor; [assumption|].
  revert keep. induction H as [|s x c u Hs H IH]; intros [|b keep]; cbn; try now constructor.
  destruct b; [constructor; [assumption|]|]; exact (IH keep).
Qed.

(* ---- slices of the parameters *)

(* Of a slice the middle and the half-width. *)
Definition slice_middle (s : slice) : Q := (inject_Z (2 * fst s + 1) / inject_Z (2 ^ Z.of_nat (snd s)) - 1)%Q.
Definition slice_half (s : slice) : Q := (/ inject_Z (2 ^ Z.of_nat (snd s)))%Q.

Fixpoint sliced_middle (gs : list Q) (ts : list slice) (middle : Q) : Q :=
  match gs, ts with
  | g :: gs, s :: ts => sliced_middle gs ts (Qred (middle + g * slice_middle s))
  | _, _ => middle
  end.
Fixpoint sliced_parts (gs : list Q) (ts : list slice) : list Q :=
  match gs, ts with
  | g :: gs, s :: ts => Qred (g * slice_half s) :: sliced_parts gs ts
  | _, _ => []
  end.

(* The patch for parameters in these slices, which are the cube of it. *)
Definition sliced (ts : list slice) (patch : list term) : list term :=
  map (fun w => Term (of_k0 w) (of_k1 w) (of_phase w) (sliced_middle (parts w) ts (middle w))
                     (sliced_parts (parts w) ts)) patch.

Lemma slice_in_Q s u : in_slice s u ->
  exists e, -1 <= e <= 1 /\ u = Q2R (slice_middle s) + Q2R (slice_half s) * e.
Proof.
  destruct s as [i c]. intros H. destruct (slice_symbol i c u H) as (e & He & E).
  exists e. split; [exact He|]. unfold slice_middle, slice_half, Qdiv. cbn [fst snd].
  pose proof (power_pos c) as Hp. unfold power in Hp.
  assert (Hq : ~ (inject_Z (2 ^ Z.of_nat c) == 0)%Q).
  { intros Z. apply Qeq_eqR in Z. rewrite Q2R_inject_Z in Z. change 0%Q with (inject_Z 0) in Z.
    rewrite Q2R_inject_Z in Z. lra. }
  change 1%Q with (inject_Z 1).
  rewrite Q2R_minus, Q2R_mult, Q2R_inv, !Q2R_inject_Z, plus_IZR, mult_IZR by exact Hq.
  rewrite E. field. lra.
Qed.

Lemma sliced_waves ts t : Forall2 in_slice ts t ->
  exists s, in_cube s /\ forall patch, waves (sliced ts patch) s = waves patch t.
Proof.
  intros H. assert (exists s, in_cube s /\ forall gs m,
    Q2R (sliced_middle gs ts m) + combined (sliced_parts gs ts) s = Q2R m + combined gs t)
    as (s & Hs & E).
  { induction H as [|i u ts t Hi H (s & Hs & E)].
    - exists []. split; [constructor|]. intros [|g gs] m; reflexivity.
    - destruct (slice_in_Q i u Hi) as (e & He & Eu). exists (e :: s).
      split; [now constructor|]. intros [|g gs] m; [reflexivity|].
      cbn [sliced_middle sliced_parts].
      change (combined (g :: gs) (u :: t)) with (Q2R g * u + combined gs t).
      change (combined (Qred (g * slice_half i) :: sliced_parts gs ts) (e :: s))
        with (Q2R (Qred (g * slice_half i)) * e + combined (sliced_parts gs ts) s).
      specialize (E gs (Qred (m + g * slice_middle i))).
      rewrite !(Qeq_eqR _ _ (Qred_correct _)), ?Q2R_plus, !Q2R_mult in *. rewrite Eu. lra. }
  exists s. split; [exact Hs|]. intros patch. unfold waves, sliced. rewrite map_map.
  apply map_ext. intros w. cbn [of_k0 of_k1 of_phase middle parts]. now rewrite E.
Qed.

(* ---- mirror images *)

Definition permutations (n : nat) : list (list nat) :=
  match n with
  | 0 => [[]]
  | 1 => [[0]]
  | 2 => [[0; 1]; [1; 0]]
  | 3 => [[0; 1; 2]; [0; 2; 1]; [1; 0; 2]; [1; 2; 0]; [2; 0; 1]; [2; 1; 0]]
  | _ => []
  end%nat.

(* Does the mirror map x0 to itself, and the region of x1, which is not to be shifted, to itself by
   exchanging v0 and v1? *)
Definition even_sided (p : problem) : bool :=
  Qeq_bool (f00 p) 1 && Qeq_bool (f01 p) 0 && Qeq_bool (f10 p) 0 && Qeq_bool (f11 p) 1
  && Qeq_bool (mid0 p) (mid1 p) && Qeq_bool (wid0 p) (wid1 p)
  && forallb (fun q => Qeq_bool q 0) (shift0 p) && forallb (fun q => Qeq_bool q 0) (shift1 p)
  && Qeq_bool (fst (start p)) (snd (start p)).

(* The orders of n parameters for which the problem is its own mirror image. *)
Definition orders_of (p : problem) (n : nat) : list (list nat) :=
  if even_sided p then filter (symmetric (terms p)) (permutations n) else [].

Lemma even_sided_correct p : even_sided p = true ->
  fst (point (start p)) = snd (point (start p)) /\
  forall t u0 u1, second p t u0 u1 = (PI * (Q2R (mid0 p) + Q2R (wid0 p) * u0),
                                      PI * (Q2R (mid0 p) + Q2R (wid0 p) * u1)).
Proof.
  unfold even_sided. rewrite !andb_true_iff.
  intros ((((((((H00 & H01) & H10) & H11) & Hm) & Hw) & S0) & S1) & Hs).
  apply Qeq_bool_eq, Qeq_eqR in H00, H01, H10, H11, Hm, Hw, Hs.
  split; [exact Hs|]. intros t u0 u1. unfold second. rewrite H00, H01, H10, H11, Hm, Hw.
  rewrite (combined_zero _ t S0), (combined_zero _ t S1).
  replace (Q2R 0) with 0 by (unfold Q2R; cbn; lra).
  replace (Q2R 1) with 1 by (unfold Q2R; cbn; lra).
  f_equal; ring.
Qed.

Theorem orders_excluded : forall p n order, In order (orders_of p n) -> forall u,
  length u = (2 + n)%nat -> excluded p (image 0 order u) -> excluded p u.
Proof.
  intros p n order Horder [|u0 [|u1 t]] _; try easy. unfold orders_of in Horder.
  destruct (even_sided p) eqn:Heven; [|easy]. apply filter_In in Horder as [_ Hsymmetric].
  apply even_sided_correct in Heven as [Hstart Hsecond].
  intros Himage Ht x Hx Hx0 Hx1. rewrite Hsecond in Hx1.
  apply (mirror_excluded (terms p) (point (start p)) (Q2R (mid0 p)) (Q2R (wid0 p)) order
           (u0 :: u1 :: t)); try assumption.
  intros x' Hx' Hx0' Hx1'. apply (Himage (reordered_in_cube order t Ht)); try assumption.
  rewrite Hsecond. exact Hx1'.
Qed.

(* ---- invariant graphs *)

(* There is no graph if all orbits through some point are refuted. *)
Lemma no_graph_through ws y : (forall x, orbit ws x -> x 0%Z = y -> refuted ws x) ->
  no_invariant_graph ws.
Proof.
  intros H c S S' Hperiodic Hgradient Hgraph.
  destruct (Graph.graphs_minimize ws c S S' Hperiodic Hgradient Hgraph y) as (x & Hx & Hx0 & Hmin).
  destruct (H x Hx Hx0) as (n & s & k & Hn & Hneg). specialize (Hmin n s k Hn). lra.
Qed.

Theorem graphs_at_once : forall ws z, odd_about z ws ->
  forall y v, beta ws y v < 2 / 3 * dot v v -> forall s, 1 <= s -> no_invariant_graph (scaled s ws).
Proof.
  intros ws z Hodd y v Hyv s Hs. destruct (at_once ws z Hodd y v Hyv s Hs) as [y' Hy'].
  apply (no_graph_through _ y'). auto.
Qed.

(* For this, too, it is enough to look at the waves that are felt. *)
Theorem felt_graphs_at_once : forall a patch t z y v, alone_ok a patch = true ->
  odd_about z (waves (felt a patch) t) -> beta (waves (felt a patch) t) y v < 2 / 3 * dot v v ->
  forall s, 1 <= s -> no_invariant_graph (scaled s (waves patch t)).
Proof.
  intros a patch t z y v Hok Hodd Hyv s Hs.
  destruct (at_once _ z Hodd y v Hyv s Hs) as [y' Hy'].
  apply (no_graph_through _ y'). intros x Hx Hx0.
  apply (felt_orbit a patch t s x Hok Hx). apply Hy'. now rewrite freed_0.
Qed.
