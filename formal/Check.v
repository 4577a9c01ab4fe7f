(* The checker, and that it is right.  What a claim says is in the words of Map.v; a tree of cells and
   some hints are to make it plausible, and whatever they are, where `check` says true the statement
   holds. *)

From Coq Require Import Reals ZArith QArith Qreals List Bool Lra Lia.
From Interval.Real Require Import Xreal.
From Interval.Float Require Import Basic Sig.
From Interval.Interval Require Import Interval.
From Converse Require Import Map Criterion Tree Share Torus Reduce Cover Lane Prism Parts.
From Converse Require Graph Link.
Import ListNotations.
Open Scope R_scope.

(* A further part of a proof: its own x*, ranges of v0 and v1 (centres and half-widths), what the
   parameters shift their centres by, and tree; the waves, the parameters and the frame are the
   claim's. *)
Record part := Part { starts_at : Q * Q; range0 : Q * Q; range1 : Q * Q;
                      its_shifts : list Q * list Q; its_tree : tree }.

(* What is claimed: of the whole torus, that there is no invariant graph, else that no minimizing
   orbit goes from x* to the region, or, where parts are linked, no orbit of an invariant graph; and
   perhaps that there is no graph for larger amplitudes. *)
Definition of_orbits (c : claim) (ps : list part) : Prop :=
  if of_whole c then forall t, in_cube t -> no_invariant_graph (waves (of_patch c) t)
  else match ps with
       | [] => no_minimizing_orbit_into (of_region c) (of_patch c) (of_xstar c)
       | _ => forall t, in_cube t ->
              no_invariant_graph_into (of_region c) (waves (of_patch c) t) (point (of_xstar c))
       end.

Definition statement (c : claim) (ps : list part) : Prop :=
  match of_once c with
  | No => of_orbits c ps
  | Whole_patch =>
    of_orbits c ps /\
    (forall t s, in_cube t -> 1 <= s -> no_invariant_graph (scaled s (waves (of_patch c) t)))
  | Upper_end =>
    of_orbits c ps /\
    (forall s, 1 <= s ->
     no_invariant_graph (scaled s (waves (of_patch c) (repeat 1 (parameters (of_patch c))))))
  end.

(* The claim with the part's x* and region, and all trees with theirs. *)
Definition at_part (c : claim) (p : part) : claim :=
  let r := of_region c in
  Claim (of_patch c)
    (Region (m00 r) (m01 r) (m10 r) (m11 r) (fst (range0 p)) (snd (range0 p))
            (fst (range1 p)) (snd (range1 p)))
    (its_shifts p) (starts_at p) (of_whole c) (of_alone c) (of_once c) (odd c).

Definition all_parts (c : claim) (t : tree) (ps : list part) : list (claim * tree) :=
  (c, t) :: map (fun p => (at_part c p, its_tree p)) ps.

(* A bound of beta's eigenvalues and l for the tails, l + 1/l >= bound; for larger amplitudes a place,
   in units of pi, and a vector; and of the parameters of linked leaves, in slices, the same bound and l. *)
Record hints := Hints {
  bound : Q; tail : Q; place : (Q * Q) * (Q * Q); nearer : list (list slice * (Q * Q))
}.

(* The waves of a claim that are felt, its problem; and perhaps in the frame of x0 + x1 and x0 - x1,
   which is better where waves that feel both coordinates count. *)
Definition examined (c : claim) : list term := felt (of_alone c) (of_patch c).

Definition plain_problem (c : claim) : problem :=
  problem_of (of_region c) (shifts c) (examined c) (of_xstar c).

Definition strength (w : term) : Q := Qabs.Qabs (middle w).
Definition better_turned (patch : list term) : bool :=
  let along k := fold_right (fun w q => q + inject_Z (k w) * strength w)%Q 0%Q patch in
  negb (Qle_bool (6 * along (fun w => Z.abs (of_k0 w * of_k1 w)))
                 (along (fun w => of_k0 w * of_k0 w + of_k1 w * of_k1 w)%Z)).

(* Without the parameters that move no wave and shift nothing. *)
Definition felt_axes (c : claim) : list bool :=
  effective (moves_of (plain_problem c)) (parameters (of_patch c)).

Definition final_problem (c : claim) : problem :=
  let p := kept_problem (felt_axes c) (plain_problem c) in
  if better_turned (terms p) then turned_problem p else p.

Module Check (F : FloatOps with Definition radix := Zaux.radix2
                           with Definition sensible_format := true).
Include Parts F.

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

(* Orbits may be as long as their cells are deep; n is chosen more and less cautiously in turn, as a
   leaf is halved. *)
Definition manner_of (cuts halved : nat) : manner :=
  let '(c1, c2) := nth (halved mod 4) [(0, 1 # 5); (3 # 10, 0); (0, 1); (1, 0)]%Q (0, 0)%Q in
  Manner (2 * cuts * cuts) one_float (center (rational prec c1)) (center (rational prec c2)).

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
  let cuts := cuts_of c in
  let halved := zip Nat.sub cuts (cuts_of leaf) in
  match prism_bound prec exact sines (manner_of (list_sum cuts) (list_sum halved)) rd c with
  | Some (i, blames) => if negative i then None else Some (axis_of blames halved)
  | None => Some (length c)
  end.

(* How often a leaf may be halved, one piece of it and all. *)
Definition most_deep : nat := 24.
Definition most_cuts : nat := 2 ^ 14.

Definition leaf_ok (c : claim) (h : hints) : cell -> bool :=
  let rd := prepare prec exact (sharp_pi prec) (final_problem c) (tail h) in
  let keep := felt_axes c in
  fun leaf => let leaf := kept_axes keep leaf in settled (attempt rd leaf) most_deep most_cuts leaf.

(* ---- what is decided once *)

Definition axes (c : claim) : nat := 2 + parameters (of_patch c).

Definition once_ok (c : claim) (h : hints) : bool :=
  let patch := examined c in
  match of_once c, odd c with
  | No, _ => true
  | _, None => false
  | Whole_patch, Some z =>
    Torus.odd_about patch z && at_once_ok prec patch (fst (place h)) (snd (place h))
  | Upper_end, Some z =>
    Torus.odd_about patch z && at_once_end_ok prec patch (fst (place h)) (snd (place h))
    && Nat.eqb (parameters patch) (parameters (of_patch c))
  end.

(* cos(k.z + phase) of a term. *)
Definition cosine_at (z : Q * Q) (w : term) : I.type :=
  let along := add prec (mul prec (integer prec (of_k0 w)) (rational prec (fst z)))
                        (mul prec (integer prec (of_k1 w)) (rational prec (snd z))) in
  snd (sines (add prec (div prec along turn_around) (half prec (rational prec (of_phase w))))).

(* Cover.pushed and turning_point, the latter for all parameters of the cube. *)
Definition pushed_of (r : region) (patch : list term) (z : Q * Q) (f : term -> Q) : I.type :=
  fold_right (fun w total =>
      add prec (mul prec (mul prec (integer prec (push r w)) (cosine_at z w)) (rational prec (f w))) total)
    I.zero patch.

Definition turning_points (r : region) (patch : list term) (z : Q * Q) : I.type :=
  let moved := fold_right (fun i total =>
      add prec (mul prec (pushed_of r patch z (fun w => nth i (parts w) 0%Q)) (unit exact)) total)
    I.zero (seq 0 (parameters patch)) in
  let at_rest := sub prec (mul prec (integer prec (m11 r)) (rational prec (fst z)))
                          (mul prec (integer prec (m01 r)) (rational prec (snd z))) in
  div prec (add prec at_rest (half prec (add prec (pushed_of r patch z middle) moved)))
           (mul prec (sharp_pi prec) (integer prec (determinant r))).

(* Is v0's range enough, as orbits may be reversed? *)
Definition reverses (r : region) (patch : list term) (z : Q * Q) : bool :=
  let v0 := turning_points r patch z in
  let more := div prec (integer prec (divisor r)) (integer prec (Z.abs (determinant r))) in
  non_negative (sub prec v0 (rational prec (centre0 r - half0 r)))
  && non_negative (sub prec (rational prec (centre0 r + half0 r)) (add prec v0 more)).

(* Is the region enough for all x1? *)
Definition covers (c : claim) : bool :=
  let r := of_region c in let patch := examined c in let z := of_xstar c in
  negb (determinant r =? 0)%Z && (direct0 r || reverses r patch z)
  && (direct1 r || exchanges r patch z (parameters (of_patch c))).

(* Graphs are not followed to waves of one coordinate. *)
Definition may_link (c : claim) (ps : list part) : bool :=
  match ps, of_alone c with
  | [], _ => true
  | _, Both => negb (determinant (of_region c) =? 0)%Z
  | _, _ => false
  end.

(* The region that a link may lead into: with its image where that is excluded, too. *)
Definition reached (c : claim) : region :=
  if folds (of_region c) (examined c) (of_xstar c) (shifts c) (parameters (of_patch c))
  then folded (of_region c) else of_region c.

(* How far f moves for parameters in these slices, to each of the later parts, and between which ends
   it is to lead; nothing if the bound or l is wrong. *)
Definition ways_for (c : claim) (later : list claim) (ts : list slice) (Bl : Q * Q) :
    list (option (I.type * I.type) * ((Q * Q) * (Q * Q))) :=
  let patch := sliced ts (examined c) in
  if tail_ok (fst Bl) (snd Bl) && patch_below prec patch (fst Bl)
  then map (fun c' => (displacement prec series patch (of_region c) (snd Bl)
                         (of_xstar c) (of_xstar c'), ends_of (reached c') (shifts c) (shifts c') ts))
         later
  else [].

Definition same_slice (s s' : slice) : bool := (fst s =? fst s')%Z && (snd s =? snd s')%nat.
Fixpoint same_slices (ts ts' : list slice) : bool :=
  match ts, ts' with
  | [], [] => true
  | s :: ts, s' :: ts' => same_slice s s' && same_slices ts ts'
  | _, _ => false
  end.

(* Does a linked leaf lead into the region of one of the later parts? *)
Definition linked_ok (c : claim) (h : hints) (later : list claim) : nat -> cell -> bool :=
  let ways := map (fun n => (fst n, ways_for c later (fst n) (snd n))) (nearer h) in
  fun k leaf => match find (fun w => same_slices (fst w) (skipn 2 leaf)) ways with
                | Some (_, ways) =>
                  match nth_error ways k with
                  | Some (i, ends) => leads_into prec i (of_region c) ends leaf
                  | None => false
                  end
                | None => false
                end.

Fixpoint trees_ok (h : hints) (trees : list (claim * tree)) : bool :=
  match trees with
  | [] => true
  | (c, t) :: later =>
    mirrored (axes c) (orders_of (plain_problem c) (parameters (of_patch c))) t
    && all_links (linked_ok c h (map fst later)) (root (axes c)) t && trees_ok h later
  end.

(* Only the regions of further parts may be shifted. *)
Definition unshifted (c : claim) : bool :=
  match shifts c with ([], []) => true | _ => false end.

Definition header_ok (c : claim) (h : hints) (t : tree) (ps : list part) : bool :=
  unshifted c && (covers c || negb (of_whole c)) && alone_ok (of_alone c) (of_patch c)
  && tail_ok (bound h) (tail h)
  && patch_below prec (terms (plain_problem c)) (bound h)
  && may_link c ps && trees_ok h (all_parts c t ps) && once_ok c h.

Definition leaves_of (c : claim) (t : tree) : list cell := leaves (root (axes c)) t.

(* The same leaves without a list of them: see Share.all_leaves_correct. *)
Definition every_leaf (c : claim) (f : cell -> bool) (t : tree) : bool :=
  all_leaves f (root (axes c)) t.

Definition check (c : claim) (h : hints) (t : tree) (ps : list part) : bool :=
  header_ok c h t ps
  && forallb (fun ct => forallb (leaf_ok (fst ct) h) (leaves_of (fst ct) (snd ct)))
             (all_parts c t ps).

(* ---- that it is right *)

Lemma parameters_most patch w : In w patch -> (length (parts w) <= parameters patch)%nat.
Proof.
  unfold parameters. induction patch as [| v patch IH]; [easy |].
  intros [-> | H]; simpl; [apply Nat.le_max_l |].
  apply (Nat.le_trans _ _ _ (IH H)). apply Nat.le_max_r.
Qed.

(* For a proof in which the limits are any. *)
Lemma leaf_ok_settled c h leaf : leaf_ok c h leaf =
  settled (attempt (prepare prec exact (sharp_pi prec) (final_problem c) (tail h))
                   (kept_axes (felt_axes c) leaf))
          most_deep most_cuts (kept_axes (felt_axes c) leaf).
Proof. reflexivity. Qed.

Lemma leaf_excluded c h leaf u : tail_ok (bound h) (tail h) = true ->
  patch_below prec (terms (plain_problem c)) (bound h) = true -> leaf_ok c h leaf = true ->
  in_cell leaf u -> excluded (plain_problem c) u.
Proof.
  intros Ht Hp Hleaf Hu. destruct (tail_ok_correct _ _ Ht) as (Hl & HB).
  assert (Below := patch_below_correct prec _ _ Hp).
  rewrite leaf_ok_settled in Hleaf.
  assert (Hstill : Forall (still (felt_axes c)) (moves_of (plain_problem c)))
    by apply effective_still.
  apply (kept_excluded _ _ _ Hstill). apply (kept_in_cell (felt_axes c)) in Hu.
  revert Hleaf Hu. generalize (kept_axes (felt_axes c) u), (kept_axes (felt_axes c) leaf).
  clear u leaf. intros u leaf. generalize most_deep most_cuts. intros deep cuts Hleaf. revert u.
  refine (settled_covers (excluded (kept_problem (felt_axes c) (plain_problem c))) _ _ _ _ leaf Hleaf).
  clear Hleaf. intros piece Hleaf u Hu. unfold attempt in Hleaf.
  destruct (prism_bound _ _ _ _ _ piece) as [(i, b) |] eqn:E in Hleaf; [| discriminate].
  destruct (negative i) eqn:Neg; [| discriminate].
  assert (Final : excluded (final_problem c) u).
  { eapply (bound_ok prec exact exact_ok sines sines_ok);
      [exact Hl | exact HB | | apply prepare_ok; auto using exact_ok, sharp_pi_ok
       | exact E | exact Neg | exact Hu].
    pose proof (kept_largest _ _ _ Hstill Below) as Below'.
    unfold final_problem. destruct (better_turned _); [now apply turned_largest | exact Below']. }
  unfold final_problem in Final. destruct (better_turned _); [| exact Final].
  now apply turned_excluded.
Qed.

Lemma header_parts c h t ps : header_ok c h t ps = true -> shifts c = ([], []) /\
  (covers c || negb (of_whole c)) = true /\ alone_ok (of_alone c) (of_patch c) = true /\
  tail_ok (bound h) (tail h) = true /\
  patch_below prec (terms (plain_problem c)) (bound h) = true /\
  may_link c ps = true /\ trees_ok h (all_parts c t ps) = true /\ once_ok c h = true.
Proof.
  unfold header_ok, unshifted. rewrite !andb_true_iff.
  destruct (shifts c) as [[| ? ?] [| ? ?]]; [tauto | | |]; intros; exfalso;
    intuition discriminate.
Qed.

Lemma waves_few c w : In w (examined c) -> (length (parts w) <= parameters (of_patch c))%nat.
Proof. intros Hw. apply filter_In in Hw. now apply parameters_most. Qed.

Lemma same_slices_eq ts ts' : same_slices ts ts' = true -> ts = ts'.
Proof.
  revert ts'. induction ts as [| [i k] ts IH]; intros [| [i' k'] ts']; try discriminate; [reflexivity |].
  cbn [same_slices]. unfold same_slice. cbn [fst snd].
  rewrite !andb_true_iff, Z.eqb_eq, Nat.eqb_eq. intros ((-> & ->) & H). now rewrite (IH _ H).
Qed.

(* What a leaf that is linked is linked by. *)
Lemma linked_way c h later k leaf : linked_ok c h later k leaf = true -> exists B l c',
  nth_error later k = Some c' /\ tail_ok B l = true /\
  patch_below prec (sliced (skipn 2 leaf) (examined c)) B = true /\
  leads_into prec (displacement prec series (sliced (skipn 2 leaf) (examined c)) (of_region c) l
                     (of_xstar c) (of_xstar c')) (of_region c)
    (ends_of (reached c') (shifts c) (shifts c') (skipn 2 leaf)) leaf = true.
Proof.
  unfold linked_ok. destruct (find _ _) as [[ts ways] |] eqn:Hfind; [| discriminate].
  apply find_some in Hfind as [Hin Hsame]. apply same_slices_eq in Hsame. cbn [fst] in Hsame.
  apply in_map_iff in Hin as ([ts' [B l]] & E & _). cbn [fst snd] in E. injection E as -> <-.
  rewrite <- Hsame. unfold ways_for. cbn [fst snd].
  destruct (tail_ok B l && _) eqn:Hok; [| now destruct k].
  apply andb_prop in Hok as [Ht Hp]. rewrite nth_error_map.
  destruct (nth_error later k) as [c' |]; [| discriminate]. intros H.
  now exists B, l, c'.
Qed.

(* Without parts no orbit minimizes, whether or not it lies on a graph, *)
Theorem check_examined c h t : check c h t [] = true ->
  no_minimizing_orbit_into (of_region c) (examined c) (of_xstar c).
Proof.
  unfold check. rewrite andb_true_iff. intros [Hheader Hleaves].
  apply header_parts in Hheader as (Hs & _ & _ & Ht & Hp & _ & Htrees & _).
  cbn [all_parts map forallb fst snd] in Hleaves. rewrite andb_true_r in Hleaves.
  cbn [all_parts map trees_ok] in Htrees. rewrite !andb_true_iff in Htrees.
  destruct Htrees as ((Hm & Hlinks) & _).
  apply (into_of_problem _ _ _ (parameters (of_patch c))); [apply waves_few |].
  intros u Hu Cube. rewrite <- Hs. fold (plain_problem c).
  destruct (tree_covers (axes c) (excluded (plain_problem c)) (fun _ => False)
              (linked_ok c h []) t _ Hm) with (u := u) as [H | []]; auto.
  - intros leaf Hleaf v Hv. rewrite forallb_forall in Hleaves.
    exact (leaf_excluded c h leaf v Ht Hp (Hleaves leaf Hleaf) Hv).
  - intros order Horder v Hv. now apply (orders_excluded _ (parameters (of_patch c))).
  - intros k leaf Hlink. apply linked_way in Hlink as (B & l & c' & Hc' & _).
    destruct k; discriminate.
Qed.

(* with parts none that lies on a graph. *)
Lemma excluded_graph c u0 u1 t k S S' p q : excluded (plain_problem c) (u0 :: u1 :: t) ->
  in_cube t -> periodic S -> has_gradient S S' -> invariant_graph (waves (examined c) t) k S' ->
  Link.on_graph (waves (examined c) t) k S' (point (of_xstar c))
  <> plus (second (plain_problem c) t u0 u1) (Criterion.turns p q).
Proof.
  intros Hex Ht HS HS' Hinv E.
  destruct (Graph.graph_orbits_minimize _ k S S' HS HS' Hinv (point (of_xstar c)))
    as (x & Hx & Hx0 & Hstep & Hmin).
  destruct (shifted _ _ p q Hx) as (Hx' & Hx0' & Hrefuted).
  destruct Hrefuted as (n & s & m & Hn & Hneg); [| specialize (Hmin n s m Hn); lra].
  apply (Hex Ht _ Hx'); [now rewrite Hx0' |].
  assert (E1 : x 1%Z = Link.on_graph (waves (examined c) t) k S' (point (of_xstar c))).
  { rewrite <- Hx0. exact (Hstep 0%Z). }
  unfold shift. rewrite E1, E, !Z.mul_1_r.
  apply vec_eq; unfold minus, plus, Criterion.turns; cbn [fst snd]; ring.
Qed.

(* No graph whose orbit leads from x* to a region, for the claim's parameters; where it is the claim's
   and nothing is shifted this is no_invariant_graph_into (unshifted_graphs). *)
Definition no_graph_to (c : claim) (r : region) : Prop :=
  forall t, length t = parameters (of_patch c) ->
  in_cube t -> forall k S S', periodic S -> has_gradient S S' ->
  invariant_graph (waves (examined c) t) k S' ->
  ~ into_shifted r (shifts c) t
      (Link.on_graph (waves (examined c) t) k S' (point (of_xstar c))).
Definition no_graph_of (c : claim) : Prop := no_graph_to c (of_region c).

Lemma reached_graphs c : no_graph_of c -> no_graph_to c (reached c).
Proof.
  unfold reached. destruct (folds _ _ _ _ _) eqn:Hfolds; [| easy].
  apply folds_correct in Hfolds
    as (E00 & E01 & E10 & E11 & Hdiagonal & (order & Hn & Ho & H0) & H1 & Hlow & Hhigh).
  intros H t Ht Cube k S S' HS HS' Hinv (v0 & v1 & i & j & Hv0 & Hv1 & E).
  cbn [folded centre0 half0 centre1 half1] in Hv0, Hv1. rewrite H1, Q2R_0, Q2R_plus in Hv1.
  apply Rcomplements.Rabs_le_between in Hv1. set (r := of_region c) in *.
  assert (Rabs (v1 - Q2R (centre1 r)) <= Q2R (half1 r)
          \/ Rabs (- v1 - Q2R (centre1 r)) <= Q2R (half1 r)) as [Hin | Hin].
  { rewrite Q2R_abs in Hv1. unfold Rabs in *.
    repeat destruct (Rcase_abs _); lra. }
  - apply (H t Ht Cube k S S' HS HS' Hinv). exists v0, v1, i, j.
    rewrite H1, Rplus_0_r. now repeat split.
  - destruct (graph_exchanged _ order t k S S' Ho HS HS' Hinv) as (A & B & C & D).
    apply (H (reordered 0 order t)) with (4 := B) (5 := C);
      [unfold reordered; now rewrite map_length | now apply reordered_in_cube | exact A |].
    assert (Hx : point (of_xstar c) = swap (point (of_xstar c)))
      by (unfold swap, point; cbn [fst snd]; now rewrite Hdiagonal).
    rewrite Hx, D, E. exists v0, (- v1), j, i. fold r. rewrite H0, H1, Rplus_0_r.
    split; [exact Hv0 |]. split; [exact Hin |].
    unfold swap, plus, at_v, Criterion.turns, folded. cbn [m00 m01 m10 m11].
    rewrite E00, E01, E10, E11. apply vec_eq; cbn [fst snd]; ring.
Qed.

Lemma unshifted_graphs c : shifts c = ([], []) -> no_graph_of c -> forall t, in_cube t ->
  no_invariant_graph_into (of_region c) (waves (examined c) t) (point (of_xstar c)).
Proof.
  intros Hs H t Ht k S S' HS HS' Hinv Hinto. set (n := parameters (of_patch c)).
  rewrite <- (waves_fitted n (examined c) t (waves_few c)) in Hinv, Hinto.
  apply (H (fitted n t) (fitted_length n t) (fitted_in_cube n t Ht) k S S' HS HS' Hinv).
  rewrite Hs. now apply into_unshifted.
Qed.

(* Of the same map and in the same frame. *)
Definition alike (c c' : claim) : Prop :=
  of_patch c' = of_patch c /\ of_alone c' = of_alone c /\
  m00 (of_region c') = m00 (of_region c) /\ m01 (of_region c') = m01 (of_region c) /\
  m10 (of_region c') = m10 (of_region c) /\ m11 (of_region c') = m11 (of_region c).

Lemma trees_graphs c0 h trees : determinant (of_region c0) <> 0%Z ->
  tail_ok (bound h) (tail h) = true -> patch_below prec (examined c0) (bound h) = true ->
  trees_ok h trees = true ->
  forallb (fun ct => forallb (leaf_ok (fst ct) h) (leaves_of (fst ct) (snd ct))) trees = true ->
  Forall (fun ct => alike c0 (fst ct)) trees -> Forall (fun ct => no_graph_of (fst ct)) trees.
Proof.
  intros Hdet Hh Hbelow. induction trees as [| [c t] later IH]; intros Htrees Hleaves Halike;
    [constructor |].
  inversion Halike as [| ? ? Hc Hlater]; subst. cbn [fst] in Hc.
  cbn [trees_ok] in Htrees. cbn [forallb fst snd] in Hleaves.
  rewrite !andb_true_iff in Htrees. rewrite andb_true_iff in Hleaves.
  destruct Htrees as ((Hm & Hlinks) & Htrees), Hleaves as (Hleaf & Hleaves).
  specialize (IH Htrees Hleaves Hlater). constructor; [| exact IH]. cbn [fst].
  destruct Hc as (Epatch & Ealone & E00 & E01 & E10 & E11).
  assert (Eex : examined c = examined c0) by (unfold examined; now rewrite Epatch, Ealone).
  assert (Hp : patch_below prec (terms (plain_problem c)) (bound h) = true)
    by (unfold plain_problem; cbn [terms problem_of]; now rewrite Eex).
  assert (Hr : determinant (of_region c) <> 0%Z)
    by (unfold determinant in *; now rewrite E00, E01, E10, E11).
  destruct (tail_ok_correct _ _ Hh) as (Hl & HB). assert (Below := patch_below_correct prec _ _ Hp).
  intros ts Hn Ht' k S S' HS HS' Hinv (v0 & v1 & i & j & Hv0 & Hv1 & Hx1).
  set (n := parameters (of_patch c)) in *.
  destruct (in_units _ _ _ Hv0) as (u0 & Hu0 & E0).
  destruct (in_units _ _ _ Hv1) as (u1 & Hu1 & E1).
  pose proof (Rle_trans _ _ _ (Rabs_pos _) Hv0) as Hh0.
  pose proof (Rle_trans _ _ _ (Rabs_pos _) Hv1) as Hh1. rewrite E0, E1 in Hx1.
  set (r := of_region c) in *. set (sh := shifts c) in *.
  set (leads := fun u => forall a b s, u = a :: b :: s -> length s = n -> in_cube s ->
    forall k S S' p q,
    periodic S -> has_gradient S S' -> invariant_graph (waves (examined c) s) k S' ->
    Link.on_graph (waves (examined c) s) k S' (point (of_xstar c)) <>
    plus (at_v r (Q2R (centre0 r) + combined (fst sh) s + Q2R (half0 r) * a)
                 (Q2R (centre1 r) + combined (snd sh) s + Q2R (half1 r) * b))
         (Criterion.turns p q)).
  destruct (tree_covers (axes c) (excluded (plain_problem c)) leads
              (linked_ok c h (map fst later)) t _ Hm)
    with (u := u0 :: u1 :: ts) as [Hex | Hlead]; try exact Hlinks.
  - intros leaf Hin v Hv. rewrite forallb_forall in Hleaf.
    exact (leaf_excluded c h leaf v Hh Hp (Hleaf leaf Hin) Hv).
  - intros order Horder v Hv. now apply (orders_excluded _ (parameters (of_patch c))).
  - intros m leaf Hlink u Hu a b s -> Hm' Hs k' T T' p q HT HT' Hinv' E.
    apply linked_way in Hlink as (B & l & c' & Hnth & HBl & HB' & Hlink).
    apply nth_error_In in Hnth. apply in_map_iff in Hnth as (ct & <- & Hin).
    destruct leaf as [| s0 [| s1 slices]]; try discriminate Hlink.
    assert (Hslices : Forall2 in_slice slices s).
    { inversion Hu as [| ? ? ? ? _ Hu']. now inversion Hu'. }
    destruct (sliced_waves _ _ Hslices) as (s' & Hs' & Es). specialize (Es (examined c)).
    cbn [skipn] in HB', Hlink. destruct (tail_ok_correct _ _ HBl) as (Hl' & HBl').
    assert (Below' := patch_below_correct prec _ _ HB').
    rewrite Forall_forall in IH, Hlater. specialize (Hlater ct Hin).
    pose proof (reached_graphs _ (IH ct Hin)) as Here.
    destruct ct as [c' tr]. cbn [fst] in *. destruct Hlater as (P & A & F00 & F01 & F10 & F11).
    assert (Ex' : examined c' = examined c) by (rewrite Eex; unfold examined; now rewrite P, A).
    unfold no_graph_to in Here. rewrite P, <- Epatch, Ex' in Here.
    apply (Here s Hm' Hs k' T T' HT HT' Hinv').
    rewrite <- Es in Hinv', E |- *.
    pose proof (displacement_ok prec series (make_constants_ok prec) (sliced slices (examined c)) r l _
      (of_xstar c) (of_xstar c') s' k' T T' Hr Hl' HBl' (Below' s' Hs') Hs' HT HT' Hinv') as D.
    refine (leads_into_ok prec _ r _ sh _ (s0 :: s1 :: slices) a b s _ _ p q Hr _ _ _ _ Hh0 Hh1
              Hlink Hu E D);
      unfold reached; destruct (folds _ _ _ _ _); cbn [folded m00 m01 m10 m11]; congruence.
  - cbn. now rewrite Hn.
  - constructor; [assumption |]. now constructor.
  - apply (excluded_graph c u0 u1 ts k S S' i j Hex Ht' HS HS' Hinv). rewrite Hx1. f_equal.
    unfold at_v, second, plain_problem, problem_of.
    cbn [f00 f01 f10 f11 mid0 shift0 wid0 mid1 shift1 wid1]. now rewrite !Reduce.Q2R_inject_Z.
  - exact (Hlead u0 u1 ts eq_refl Hn Ht' k S S' i j HS HS' Hinv Hx1).
Qed.

Theorem check_graphs c h t p ps : check c h t (p :: ps) = true -> of_alone c = Both /\
  forall t, in_cube t ->
  no_invariant_graph_into (of_region c) (waves (examined c) t) (point (of_xstar c)).
Proof.
  unfold check. rewrite andb_true_iff. intros [Hheader Hleaves].
  apply header_parts in Hheader as (Hs & _ & _ & Ht & Hp & Hlink & Htrees & _).
  unfold may_link in Hlink. destruct (of_alone c) eqn:Ealone; try discriminate. split; [reflexivity |].
  apply negb_true_iff, Z.eqb_neq in Hlink.
  assert (H := trees_graphs c h _ Hlink Ht Hp Htrees Hleaves). unfold all_parts in H.
  apply Forall_inv in H; [exact (unshifted_graphs c Hs H) |]. constructor; [repeat split |].
  apply Forall_map, Forall_forall. intros x _. repeat split.
Qed.

(* The waves that are not felt, where both coordinates are, change nothing of the map. *)
Lemma felt_force c t y : of_alone c = Both ->
  V' (waves (of_patch c) t) y = V' (waves (examined c) t) y.
Proof.
  intros E. unfold examined. rewrite E, waves_felt. cbn [feels_wave]. rewrite filter_all.
  rewrite <- (scaled_1 (waves (filter _ _) t)), V'_present. now rewrite scaled_1.
Qed.

Lemma cosine_at_ok z w : cont (cosine_at z w) (cos (angle (wave_at [] w) (point z))).
Proof.
  assert (Hpi : 2 * PI <> 0) by (pose proof PI_neq0; lra).
  replace (angle (wave_at [] w) (point z)) with (2 * PI *
    ((IZR (of_k0 w) * Q2R (fst z) + IZR (of_k1 w) * Q2R (snd z)) / (2 * PI) + Q2R (of_phase w) / 2))
    by (unfold angle, along; cbn [wave_at k0 k1 phase point fst snd]; field; apply PI_neq0).
  apply sines_ok, cont_add; [|apply cont_half, cont_rational].
  apply cont_div; [exact Hpi | | apply cont_mul; [apply cont_integer | apply sharp_pi_ok]].
  apply cont_add; apply cont_mul; try apply cont_integer; apply cont_rational.
Qed.

Lemma pushed_ok r patch z f : cont (pushed_of r patch z f) (pushed r patch (point z) f).
Proof.
  induction patch as [| w patch IH]; [exact cont_zero |].
  apply cont_add; [|exact IH]. apply cont_mul; [|apply cont_rational].
  apply cont_mul; [apply cont_integer | apply cosine_at_ok].
Qed.

Lemma turning_points_ok r patch z t : determinant r <> 0%Z -> in_cube t ->
  cont (turning_points r patch z) (turning_point r patch z t).
Proof.
  intros Hr Ht. rewrite (turning_point_linear _ _ _ (parameters patch)) by apply parameters_most.
  apply cont_div.
  - apply Rmult_integral_contrapositive. split; [apply PI_neq0 | now apply not_0_IZR].
  - apply cont_add; [apply cont_sub; apply cont_mul; try apply cont_integer; apply cont_rational |].
    rewrite Rmult_comm. apply cont_half, cont_add; [apply pushed_ok |].
    induction (seq 0 _) as [| i l IH]; [exact cont_zero |].
    apply cont_add; [| exact IH]. apply cont_mul; [apply pushed_ok |].
    apply exact_ok. now apply nth_in_cube.
  - apply cont_mul; [apply sharp_pi_ok | apply cont_integer].
Qed.

Lemma reverses_correct r patch z t : determinant r <> 0%Z -> reverses r patch z = true ->
  in_cube t -> Q2R (centre0 r) - Q2R (half0 r) <= turning_point r patch z t /\
               turning_point r patch z t + reach r <= Q2R (centre0 r) + Q2R (half0 r).
Proof.
  intros Hr H Ht. apply andb_prop in H as [Hlow Hhigh].
  pose proof (turning_points_ok r patch z t Hr Ht) as Hv0.
  assert (Hmore : cont (div prec (integer prec (divisor r)) (integer prec (Z.abs (determinant r))))
                       (reach r)).
  { apply cont_div; try apply cont_integer. apply not_0_IZR. lia. }
  pose proof (non_negative_correct _ _ Hlow (cont_sub prec _ _ _ _ Hv0 (cont_rational prec _))) as L.
  pose proof (non_negative_correct _ _ Hhigh (cont_sub prec _ _ _ _ (cont_rational prec _)
    (cont_add prec _ _ _ _ Hv0 Hmore))) as U.
  rewrite Q2R_minus in L. rewrite Q2R_plus in U. lra.
Qed.

Lemma covers_correct c : covers c = true ->
  determinant (of_region c) <> 0%Z /\ all0 (of_region c) (examined c) (of_xstar c) /\
  all1 (of_region c) (examined c) (of_xstar c).
Proof.
  unfold covers. rewrite !andb_true_iff, negb_true_iff, Z.eqb_neq. intros ((Hr & H0) & H1).
  split; [exact Hr |]. split; [| now apply all1_correct in H1].
  apply orb_prop in H0 as [H0 | H0]; [left; now apply direct0_correct | right].
  intros t Ht. now apply reverses_correct.
Qed.

Theorem check_orbits c h t ps : check c h t ps = true -> of_orbits c ps.
Proof.
  intros H. assert (Hheader := H). apply andb_prop in Hheader as [Hheader _].
  apply header_parts in Hheader as (_ & Hw & Ha & _). unfold of_orbits.
  destruct ps as [| p ps].
  - assert (Examined := check_examined c h t H). destruct (of_whole c).
    + rewrite orb_false_r in Hw. destruct (covers_correct c Hw) as (Hr & H0 & H1).
      apply (Graph.no_graph _ (of_xstar c)).
      assert (Hnone := whole_orbits _ _ _ Hr H0 H1 Examined). intros t' Ht' x Hx Hx0.
      refine (felt_refuted (of_alone c) _ (point (of_xstar c)) (fun _ => True) Ha _ t' Ht' x Hx Hx0 I).
      intros t'' Ht'' x' Hx' Hx0' _. exact (Hnone t'' Ht'' x' Hx' Hx0').
    + exact (felt_refuted (of_alone c) _ _ (into (of_region c)) Ha Examined).
  - destruct (check_graphs c h t p ps H) as [Ealone Hgraphs].
    assert (Esame := fun t' y => felt_force c t' y Ealone). destruct (of_whole c).
    + rewrite orb_false_r in Hw. destruct (covers_correct c Hw) as (Hr & H0 & H1).
      intros t' Ht' k S S' HS HS' Hinv.
      apply (whole_graphs _ _ _ Hr H0 H1 Hgraphs t' Ht' k S S' HS HS').
      now apply (invariant_ext (waves (of_patch c) t')).
    + intros t' Ht' k S S' HS HS' Hinv Hinto.
      apply (Hgraphs t' Ht' k S S' HS HS');
        [now apply (invariant_ext (waves (of_patch c) t')) |].
      unfold F in *. cbn [fst snd] in *. now rewrite <- Esame.
Qed.

Theorem check_sound c h t ps : check c h t ps = true -> statement c ps.
Proof.
  intros H. assert (Here := check_orbits c h t ps H). unfold statement.
  apply andb_prop in H as [H _]. apply header_parts in H as (_ & _ & Ha & _ & _ & _ & _ & Ho).
  unfold once_ok in Ho.
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
