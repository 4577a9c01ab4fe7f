(* The checker, and that it is right.  What a claim says is in the words of Map.v; a tree of cells and
   some hints are to make it plausible, and whatever they are, where `check` says true the statement
   holds. *)

From Coq Require Import Reals ZArith QArith Qreals List Bool Lra Lia.
From Interval.Real Require Import Xreal.
From Interval.Float Require Import Basic Sig.
From Interval.Interval Require Import Interval.
From Converse Require Import Map Tree Share Torus Reduce Lane Prism.
Import ListNotations.
Open Scope R_scope.

(* What is claimed: if x1 may be anywhere, that there is no invariant graph, else that no minimizing
   orbit goes from x* to the region; and perhaps that there is no graph for larger amplitudes. *)
Definition of_orbits (c : claim) : Prop :=
  if whole (of_region c) then forall t, in_cube t -> no_invariant_graph (waves (of_patch c) t)
  else no_minimizing_orbit_into (of_region c) (of_patch c) (of_xstar c).

Definition statement (c : claim) : Prop :=
  match of_once c with
  | No => of_orbits c
  | Whole_patch =>
    of_orbits c /\
    (forall t s, in_cube t -> 1 <= s -> no_invariant_graph (scaled s (waves (of_patch c) t)))
  | Upper_end =>
    of_orbits c /\
    (forall s, 1 <= s ->
     no_invariant_graph (scaled s (waves (of_patch c) (repeat 1 (parameters (of_patch c))))))
  end.

(* A bound of beta's eigenvalues and l for the tails, l + 1/l >= bound; for larger amplitudes a place,
   in units of pi, and a vector. *)
Record hints := Hints { bound : Q; tail : Q; place : (Q * Q) * (Q * Q) }.

(* The problem of a claim; its waves that are felt; and perhaps in the frame of x0 + x1 and x0 - x1,
   which is better where waves that feel both coordinates count. *)
Definition plain_problem (c : claim) : problem :=
  let p := problem_of (of_region c) (of_patch c) (of_xstar c) in
  with_terms p (felt (of_alone c) (of_patch c)).

Definition strength (w : term) : Q := Qabs.Qabs (middle w).
Definition better_turned (patch : list term) : bool :=
  let along k := fold_right (fun w q => q + inject_Z (k w) * strength w)%Q 0%Q patch in
  negb (Qle_bool (6 * along (fun w => Z.abs (of_k0 w * of_k1 w)))
                 (along (fun w => of_k0 w * of_k0 w + of_k1 w * of_k1 w)%Z)).

Definition final_problem (c : claim) : problem :=
  let p := plain_problem c in if better_turned (terms p) then turned_problem p else p.

Module Check (F : FloatOps with Definition radix := Zaux.radix2
                           with Definition sensible_format := true).
Include Prism F.

(* Of the arithmetic; doubles have 53 bits whatever this is. *)
Definition prec : F.precision := F.PtoP 60.

Definition series : constants := make_constants prec.
Definition upto (n : positive) : I.type := join (integer prec 0) (rational prec (1 # n)).
Definition turn_around : I.type := mul prec (integer prec 2) (sharp_pi prec).
Definition one_float : F.type := center (integer prec 1).
Definition exact : limits :=
  Limits (join (integer prec (-1)) (integer prec 1)) (upto 1) (upto 2) (upto 6) (upto 24) (upto 120)
    (rational prec (1 # 2)) (rational prec (1 # 6)) (integer prec 1) (integer prec 2) turn_around
    (center (div prec (integer prec 1) turn_around)) one_float (center (rational prec (1 # 2))).

Definition sines : I.type -> I.type * I.type := sincos prec series.

Lemma upto_ok n x : 0 <= x <= / IZR (Zpos n) -> cont (upto n) x.
Proof.
  intros H. unfold upto. apply (cont_convex _ 0 x (/ IZR (Zpos n))); [| | exact H];
    apply cont_join; [left; apply cont_integer | right].
  replace (/ IZR (Zpos n)) with (Q2R (1 # n)) by (unfold Q2R; simpl; ring).
  apply cont_rational.
Qed.

Lemma exact_ok : limits_ok exact.
Proof.
  unfold limits_ok, exact.
  cbn [unit upto1 upto2 upto6 upto24 upto120 ihalf isixth ione itwo itwo_pi].
  split; [| split; [| split; [| split; [| split; [| split]]]]].
  - intros x H. apply (cont_convex _ (-1) x 1); [| | exact H]; apply cont_join;
      [left | right]; apply cont_integer.
  - intros x H. apply upto_ok. rewrite Rinv_1. exact H.
  - intros x H. now apply upto_ok.
  - intros x H. now apply upto_ok.
  - intros x H. now apply upto_ok.
  - intros x H. now apply upto_ok.
  - repeat split.
    + replace (/ 2) with (Q2R (1 # 2)) by (unfold Q2R; simpl; ring). apply cont_rational.
    + replace (/ 6) with (Q2R (1 # 6)) by (unfold Q2R; simpl; ring). apply cont_rational.
    + apply cont_integer.
    + apply cont_integer.
    + apply cont_mul; [apply cont_integer | apply sharp_pi_ok].
Qed.

Lemma sines_ok tau x : cont tau x ->
  cont (fst (sines tau)) (sin (2 * PI * x)) /\ cont (snd (sines tau)) (cos (2 * PI * x)).
Proof. apply sincos_correct, make_constants_ok. Qed.

(* ---- a leaf *)

(* n is chosen boldly and cautiously in turn; orbits are as long as their cells are deep. *)
Definition manner_of (cuts : nat) : manner :=
  if Nat.even cuts then Manner (2 * cuts * cuts) one_float F.zero (center (rational prec (1 # 5)))
  else Manner (2 * cuts * cuts) one_float (center (rational prec (3 # 10))) F.zero.

Fixpoint greatest (l : list F.type) (at_ : nat) (best : F.type * nat) : nat :=
  match l with
  | [] => snd best
  | x :: l => greatest l (S at_) (if above x (fst best) then (x, at_) else best)
  end.

(* The axis that is cut least among those that are blamed at all, and how often it is. *)
Fixpoint hindmost (blames : list F.type) (cuts : list nat) (at_ : nat) (best : nat * nat) :
    nat * nat :=
  match blames, cuts with
  | x :: blames, cut :: cuts =>
    hindmost blames cuts (S at_)
      (if above x F.zero && (cut <? snd best)%nat then (at_, cut) else best)
  | _, _ => best
  end.

(* The axis that matters most, but none that matters is left more than four halvings behind. *)
Definition axis_of (blames : list F.type) (cuts : list nat) : nat :=
  let worst := greatest blames 0 (F.zero, 0%nat) in
  let cut := nth worst cuts 0%nat in
  let (last, least) := hindmost blames cuts 0 (worst, cut) in
  if (least + 4 <? cut)%nat then last else worst.

Definition cuts_of (c : cell) : list nat := map snd c.

(* None if the cell, of a leaf, is excluded, else the axis along which to halve it. *)
Definition attempt (rd : ready) (leaf c : cell) : option nat :=
  match prism_bound prec exact sines (manner_of (list_sum (cuts_of c))) rd c with
  | Some (i, blames) =>
    if negative i then None
    else Some (axis_of blames (zip Nat.sub (cuts_of c) (cuts_of leaf)))
  | None => Some (length c)
  end.

(* How often a leaf may be halved, one piece of it and all. *)
Definition most_deep : nat := 24.
Definition most_cuts : nat := 2 ^ 14.

Definition leaf_ok (c : claim) (h : hints) : cell -> bool :=
  let rd := prepare prec exact (sharp_pi prec) (final_problem c) (tail h) in
  fun leaf => settled (attempt rd leaf) most_deep most_cuts leaf.

(* ---- what is decided once *)

Definition axes (c : claim) : nat := 2 + parameters (of_patch c).

Definition once_ok (c : claim) (h : hints) : bool :=
  let patch := felt (of_alone c) (of_patch c) in
  match of_once c, odd c with
  | No, _ => true
  | _, None => false
  | Whole_patch, Some z =>
    Torus.odd_about patch z && at_once_ok prec patch (fst (place h)) (snd (place h))
  | Upper_end, Some z =>
    Torus.odd_about patch z && at_once_end_ok prec patch (fst (place h)) (snd (place h))
    && Nat.eqb (parameters patch) (parameters (of_patch c))
  end.

Definition header_ok (c : claim) (h : hints) (t : tree) : bool :=
  alone_ok (of_alone c) (of_patch c) && tail_ok (bound h) (tail h)
  && patch_below prec (terms (plain_problem c)) (bound h)
  && mirrored (axes c) (orders_of (plain_problem c) (parameters (of_patch c))) t && once_ok c h.

Definition leaves_of (c : claim) (t : tree) : list cell := leaves (root (axes c)) t.

(* The same leaves without a list of them: see Share.all_leaves_correct. *)
Definition every_leaf (c : claim) (f : cell -> bool) (t : tree) : bool :=
  all_leaves f (root (axes c)) t.

Definition check (c : claim) (h : hints) (t : tree) : bool :=
  header_ok c h t && forallb (leaf_ok c h) (leaves_of c t).

(* ---- that it is right *)

Lemma parameters_most patch w : In w patch -> (length (parts w) <= parameters patch)%nat.
Proof.
  unfold parameters. induction patch as [| v patch IH]; [easy |].
  intros [-> | H]; simpl; [apply Nat.le_max_l |].
  apply (Nat.le_trans _ _ _ (IH H)). apply Nat.le_max_r.
Qed.

(* For a proof in which the limits are any. *)
Lemma leaf_ok_settled c h leaf : leaf_ok c h leaf =
  settled (attempt (prepare prec exact (sharp_pi prec) (final_problem c) (tail h)) leaf)
          most_deep most_cuts leaf.
Proof. reflexivity. Qed.

Lemma leaf_excluded c h leaf u : tail_ok (bound h) (tail h) = true ->
  patch_below prec (terms (plain_problem c)) (bound h) = true -> leaf_ok c h leaf = true ->
  in_cell leaf u -> excluded (plain_problem c) u.
Proof.
  intros Ht Hp Hleaf Hu. destruct (tail_ok_correct _ _ Ht) as (Hl & HB).
  assert (Below := patch_below_correct prec _ _ Hp).
  rewrite leaf_ok_settled in Hleaf. revert Hleaf u Hu. generalize most_deep most_cuts.
  intros deep cuts Hleaf. refine (settled_covers (excluded (plain_problem c)) _ _ _ _ leaf Hleaf).
  clear Hleaf. intros piece Hleaf u Hu. unfold attempt in Hleaf.
  destruct (prism_bound _ _ _ _ _ piece) as [(i, b) |] eqn:E in Hleaf; [| discriminate].
  destruct (negative i) eqn:Neg; [| discriminate].
  assert (Final : excluded (final_problem c) u).
  { eapply (bound_ok prec exact exact_ok sines sines_ok);
      [exact Hl | exact HB | | apply prepare_ok; auto using exact_ok, sharp_pi_ok
       | exact E | exact Neg | exact Hu].
    unfold final_problem. destruct (better_turned _); [now apply turned_largest | exact Below]. }
  unfold final_problem in Final. destruct (better_turned _); [| exact Final].
  now apply turned_excluded.
Qed.

Theorem check_orbits c h t : check c h t = true ->
  no_minimizing_orbit_into (of_region c) (of_patch c) (of_xstar c).
Proof.
  unfold check, header_ok. rewrite !andb_true_iff.
  intros (((((Ha & Ht) & Hp) & Hm) & _) & Hleaves).
  apply (into_of_problem _ _ _ (parameters (of_patch c))); [apply parameters_most |].
  intros u Hu Cube.
  apply (felt_excluded (problem_of (of_region c) (of_patch c) (of_xstar c)) (of_alone c) Ha).
  apply (tree_covers (axes c) (excluded (plain_problem c)) t _ Hm); auto.
  - intros leaf Hleaf v Hv. rewrite forallb_forall in Hleaves.
    exact (leaf_excluded c h leaf v Ht Hp (Hleaves leaf Hleaf) Hv).
  - intros order Horder v Hv. now apply (orders_excluded _ (parameters (of_patch c))).
Qed.

Theorem check_sound c h t : check c h t = true -> statement c.
Proof.
  intros H. assert (Orbits := check_orbits c h t H). unfold statement.
  assert (Here : of_orbits c).
  { unfold of_orbits. destruct (whole (of_region c)) eqn:W;
      [exact (graphs _ _ _ W Orbits) | exact Orbits]. }
  unfold check, header_ok, once_ok in H. rewrite !andb_true_iff in H.
  destruct H as (((((Ha & _) & _) & _) & Ho) & _).
  destruct (of_once c); [exact Here | |]; (destruct (odd c) as [z |]; [| discriminate]);
    (split; [exact Here |]); rewrite !andb_true_iff in Ho.
  - destruct Ho as (Hz & Hy). intros t' s Ht' Hs.
    apply (felt_graphs_at_once (of_alone c) (of_patch c) t' (scale PI (point z))
      (scale PI (point (fst (place h)))) (point (snd (place h))) Ha); auto.
    + intros w Hw. exact (odd_about_correct _ _ Hz t' w Hw).
    + exact (at_once_ok_correct prec _ _ _ Hy t' Ht').
  - destruct Ho as ((Hz & Hy) & Hn). intros s Hs. apply Nat.eqb_eq in Hn. rewrite <- Hn.
    apply (felt_graphs_at_once (of_alone c) (of_patch c) _ (scale PI (point z))
      (scale PI (point (fst (place h)))) (point (snd (place h))) Ha); auto.
    + intros w Hw. exact (odd_about_correct _ _ Hz _ w Hw).
    + exact (at_once_end_ok_correct prec _ _ _ Hy).
Qed.
End Check.
