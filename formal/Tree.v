(* The tree of a proof file (docs/reference/proof-file.md): the boxes that it cuts the claim's region into, the
   ones that are skipped for the sake of their mirror image, and why all the region is excluded if
   the boxes of its proved leaves are.  Everything here is in units of the region: each axis goes
   from -1 to 1. *)

From Coq Require Import Reals ZArith QArith Qreals List Permutation Ascii Bool Lra Lia.
From Converse Require Import Map Criterion.
Import ListNotations.
Open Scope R_scope.

(* ---- trees and their text *)

(* The axes are 0 and 1 for v0 and v1, then the parameters.  The lower half comes first.  A leaf
   that is linked leads to the k-th of the later parts: only to later ones.  A leaf that is undecided
   has no tree. *)
Inductive tree := Proved | Skipped | Linked (k : nat) | Cut (axis : nat) (lower upper : tree).

(* From the last character to the first: a leaf is put on the stack, and a cut takes its two parts
   from there. *)
Definition read_node (node : ascii) (stack : list tree) : option (list tree) :=
  let cut axis := match stack with
                  | lower :: upper :: stack => Some (Cut axis lower upper :: stack)
                  | _ => None
                  end in
  match node with
  | "P"%char => Some (Proved :: stack)
  | "S"%char => Some (Skipped :: stack)
  | "0"%char => cut 0%nat
  | "1"%char => cut 1%nat
  | "2"%char => cut 2%nat
  | "3"%char => cut 3%nat
  | "4"%char => cut 4%nat
  | _ => let code := N_of_ascii node in       (* a is the next part, b the one after it *)
         if ((97 <=? code) && (code <=? 122))%N then Some (Linked (N.to_nat (code - 97)) :: stack)
         else None
  end.

Fixpoint read_backwards (text : list ascii) (stack : list tree) : option tree :=
  match text with
  | [] => match stack with [t] => Some t | _ => None end
  | node :: text => match read_node node stack with
                    | Some stack => read_backwards text stack
                    | None => None
                    end
  end.

(* Nothing rests on how a tree is read: it is only a proposal how to divide the work. *)
Definition parse_list (text : list ascii) : option tree := read_backwards (rev_append text []) [].

(* ---- cells *)

(* Slice i of the 2^c equal ones of [-1, 1], as (i, c). *)
Definition slice : Type := Z * nat.
Definition cell : Type := list slice.

Definition power (c : nat) : R := IZR (2 ^ Z.of_nat c).

Definition in_slice (s : slice) (u : R) : Prop :=
  -1 + 2 * IZR (fst s) / power (snd s) <= u <= -1 + 2 * (IZR (fst s) + 1) / power (snd s).

Definition in_cell (c : cell) (u : list R) : Prop := Forall2 in_slice c u.

Definition root (n : nat) : cell := repeat (0%Z, 0%nat) n.

(* Slices 2i and 2i + 1 of twice as many. *)
Definition half (upper : bool) (s : slice) : slice :=
  ((if upper then Z.succ_double (fst s) else Z.double (fst s)), S (snd s)).

(* The list with its a-th element changed; as it was, if there is none. *)
Fixpoint change {A} (f : A -> A) (a : nat) (l : list A) {struct l} : list A :=
  match l, a with
  | [], _ => []
  | x :: l, O => f x :: l
  | x :: l, S a => x :: change f a l
  end.

(* The lower or the upper half of a cell, cut along axis a. *)
Definition half_cell (upper : bool) (a : nat) (c : cell) : cell := change (half upper) a c.

Lemma power_pos c : 0 < power c.
Proof. apply IZR_lt. apply Z.pow_pos_nonneg; lia. Qed.

Lemma power_succ c : power (S c) = 2 * power c.
Proof.
  unfold power. rewrite Nat2Z.inj_succ, Z.pow_succ_r, mult_IZR by lia. reflexivity.
Qed.

Lemma in_cell_length c u : in_cell c u -> List.length c = List.length u.
Proof. intros H. induction H; cbn; congruence. Qed.

(* A slice has a middle, and all else of it is within 1 / 2^c. *)
Lemma slice_symbol : forall i c u, in_slice (i, c) u -> exists s, -1 <= s <= 1 /\
  u = (2 * IZR i + 1) / IZR (2 ^ Z.of_nat c) - 1 + s / IZR (2 ^ Z.of_nat c).
Proof.
  intros i c u H. unfold in_slice in H; cbn [fst snd] in H. fold (power c).
  pose proof (power_pos c) as Hc.
  exists ((u + 1) * power c - (2 * IZR i + 1)). split; [|field; lra].
  destruct H as [Hl Hu].
  apply (Rmult_le_compat_r (power c)) in Hl, Hu; try lra.
  replace ((-1 + 2 * IZR i / power c) * power c) with (2 * IZR i - power c) in Hl
    by (field; lra).
  replace ((-1 + 2 * (IZR i + 1) / power c) * power c) with (2 * IZR i + 2 - power c) in Hu
    by (field; lra).
  lra.
Qed.

Lemma in_half upper s u : in_slice (half upper s) u <->
  -1 + (2 * IZR (fst s) + (if upper then 1 else 0)) / power (snd s) <= u
  <= -1 + (2 * IZR (fst s) + (if upper then 2 else 1)) / power (snd s).
Proof.
  unfold in_slice, half; cbn [fst snd]. rewrite power_succ. pose proof (power_pos (snd s)) as Hc.
  destruct upper; rewrite ?Z.succ_double_spec, ?Z.double_spec, ?plus_IZR, ?mult_IZR.
  - replace (2 * (2 * IZR (fst s) + 1) / (2 * power (snd s)))
      with ((2 * IZR (fst s) + 1) / power (snd s)) by (field; lra).
    replace (2 * (2 * IZR (fst s) + 1 + 1) / (2 * power (snd s)))
      with ((2 * IZR (fst s) + 2) / power (snd s)) by (field; lra).
    reflexivity.
  - replace (2 * (2 * IZR (fst s)) / (2 * power (snd s)))
      with ((2 * IZR (fst s) + 0) / power (snd s)) by (field; lra).
    replace (2 * (2 * IZR (fst s) + 1) / (2 * power (snd s)))
      with ((2 * IZR (fst s) + 1) / power (snd s)) by (field; lra).
    reflexivity.
Qed.

Lemma slice_halves s u : in_slice s u <-> in_slice (half false s) u \/ in_slice (half true s) u.
Proof.
  rewrite !in_half. unfold in_slice. pose proof (power_pos (snd s)) as Hc.
  assert (Hstep : 0 < / power (snd s)) by now apply Rinv_0_lt_compat.
  unfold Rdiv. rewrite !Rmult_plus_distr_r, !Rmult_assoc.
  destruct (Rle_dec u (-1 + (2 * (IZR (fst s) * / power (snd s)) + 1 * / power (snd s)))); lra.
Qed.

(* A point of a cell lies in one of its halves. *)
Lemma cell_halves a c u : in_cell c u ->
  in_cell (half_cell false a c) u \/ in_cell (half_cell true a c) u.
Proof.
  intros H. revert a. induction H as [|s x c u Hs Hc IH]; intros a; [left; constructor|].
  destruct a as [|a]; cbn.
  - apply slice_halves in Hs as [Hs|Hs]; [left | right]; now constructor.
  - destruct (IH a) as [H|H]; [left | right]; now constructor.
Qed.

(* What lies in a half lies in the cell. *)
Lemma half_cell_inside upper a c u : in_cell (half_cell upper a c) u -> in_cell c u.
Proof.
  revert a u. induction c as [|s c IH]; intros a u H; [exact H|].
  destruct a as [|a]; cbn in H; inversion H; subst; constructor; eauto.
  - apply slice_halves. destruct upper; auto.
  - eapply IH; eassumption.
Qed.

(* Every point is in the root. *)
Lemma in_root u : Forall (fun x => -1 <= x <= 1) u -> in_cell (root (List.length u)) u.
Proof.
  intros H. induction H as [|x u Hx Hu IH]; cbn; constructor; [|exact IH].
  unfold in_slice, power; cbn. lra.
Qed.

(* ---- leaves *)

(* The cells of the proved leaves in their order, before the rest. *)
Fixpoint leaves_before (rest : list cell) (c : cell) (t : tree) : list cell :=
  match t with
  | Proved => c :: rest
  | Skipped | Linked _ => rest
  | Cut a lower upper =>
      leaves_before (leaves_before rest (half_cell true a c) upper) (half_cell false a c) lower
  end.

Definition leaves (c : cell) (t : tree) : list cell := leaves_before [] c t.

Lemma leaves_before_app t : forall rest c, leaves_before rest c t = leaves c t ++ rest.
Proof.
  induction t as [| | |a lower IHl upper IHu]; intros rest c; try reflexivity.
  unfold leaves; cbn. rewrite !IHl, !IHu. now rewrite app_nil_r, app_assoc.
Qed.

(* A leaf below a cut is a leaf of its lower or of its upper half. *)
Lemma in_leaves_cut a lower upper c l : In l (leaves c (Cut a lower upper)) <->
  In l (leaves (half_cell false a c) lower) \/ In l (leaves (half_cell true a c) upper).
Proof. unfold leaves at 1; cbn. rewrite !leaves_before_app, app_nil_r. apply in_app_iff. Qed.

(* The linked ones: does f hold of each, of what it is linked to and its cell? *)
Fixpoint all_links (f : nat -> cell -> bool) (c : cell) (t : tree) : bool :=
  match t with
  | Proved | Skipped => true
  | Linked k => f k c
  | Cut a lower upper =>
      all_links f (half_cell false a c) lower && all_links f (half_cell true a c) upper
  end.

(* ---- mirror images *)

(* A slice as the way to it: which halves are taken. *)
Notation way := (list bool).

(* The slice at the end of a way that begins at s; the cell, if there is a way along each axis. *)
Definition follow (s : slice) (w : way) : slice := fold_left (fun s upper => half upper s) w s.
Fixpoint within (c : cell) (ways : list way) : cell :=
  match c, ways with
  | s :: c, w :: ways => follow s w :: within c ways
  | _, _ => []
  end.

(* Does the cell at the end of these ways, which begin at the tree's own cell, overlap only proved
   leaves?  Where a way has come to its end the cell has both halves of what is cut. *)
Fixpoint covered (ways : list way) (t : tree) : bool :=
  match t with
  | Proved => true
  | Skipped | Linked _ => false
  | Cut a lower upper =>
      match nth a ways [] with
      | [] => covered ways lower && covered ways upper
      | false :: _ => covered (change (@tl bool) a ways) lower
      | true :: _ => covered (change (@tl bool) a ways) upper
      end
  end.

(* The m-th of the parameters in another order is the order[m]-th of before. *)
Definition reordered {A} (missing : A) (order : list nat) (l : list A) : list A :=
  map (fun m => nth m l missing) order.

(* The mirror image of a point or a cell: v0 and v1 are exchanged, the parameters reordered. *)
Definition image {A} (missing : A) (order : list nat) (l : list A) : list A :=
  match l with
  | v0 :: v1 :: t => v1 :: v0 :: reordered missing order t
  | _ => l
  end.

(* Does the image of every skipped leaf overlap only proved leaves, for at least one of the orders?
   The ways lead, backwards, from the leaf to the root of the whole tree. *)
Fixpoint skips_ok (orders : list (list nat)) (whole : tree) (ways : list way) (t : tree) : bool :=
  match t with
  | Proved | Linked _ => true
  | Skipped => existsb (fun order => covered (map (@rev bool) (image [] order ways)) whole) orders
  | Cut a lower upper => skips_ok orders whole (change (cons false) a ways) lower
                         && skips_ok orders whole (change (cons true) a ways) upper
  end.

Definition mirrored (n : nat) (orders : list (list nat)) (t : tree) : bool :=
  forallb (fun order => (2 + List.length order =? n)%nat) orders
  && skips_ok orders t (repeat [] n) t.

Lemma change_length {A} (f : A -> A) l : forall a, List.length (change f a l) = List.length l.
Proof. induction l as [|x l IH]; intros [|a]; cbn; auto. Qed.

Lemma image_length {A} (missing : A) order l :
  (2 + List.length order)%nat = List.length l ->
  List.length (image missing order l) = List.length l.
Proof.
  destruct l as [|x [|y l]]; cbn; [easy | easy |].
  unfold reordered. rewrite map_length. lia.
Qed.

(* A step of the way along one axis. *)
Lemma within_step upper rest : forall c ways a, nth a ways [] = upper :: rest ->
  within c ways = within (half_cell upper a c) (change (@tl bool) a ways).
Proof.
  induction c as [|s c IH]; intros ways a H; [reflexivity|].
  destruct ways as [|w ways]; [destruct a; discriminate H|].
  destruct a as [|a]; cbn in *; [now subst w|]. f_equal. now apply IH.
Qed.

(* Where a way has come to its end, halving its end is halving its beginning. *)
Lemma within_both upper : forall c ways a, nth a ways [] = [] ->
  half_cell upper a (within c ways) = within (half_cell upper a c) ways.
Proof.
  induction c as [|s c IH]; intros ways a H; [reflexivity|].
  destruct ways as [|w ways]; [destruct a; reflexivity|].
  destruct a as [|a]; cbn in *; [now subst w|]. f_equal. now apply IH.
Qed.

(* What lies at the end of a way lies in its beginning. *)
Lemma follow_inside w : forall s u, in_slice (follow s w) u -> in_slice s u.
Proof.
  induction w as [|upper w IH]; intros s u H; [exact H|].
  apply IH in H. apply slice_halves. destruct upper; auto.
Qed.

Lemma within_inside : forall c ways u, List.length ways = List.length c ->
  in_cell (within c ways) u -> in_cell c u.
Proof.
  induction c as [|s c IH]; intros [|w ways] u Hlength H; try discriminate; [exact H|].
  inversion H; subst. constructor; [eapply follow_inside; eassumption|].
  apply IH with ways; [now injection Hlength | assumption].
Qed.

(* Each point of a covered cell lies in a proved leaf. *)
Lemma covered_correct t : forall ways c u, List.length ways = List.length c ->
  covered ways t = true -> in_cell (within c ways) u -> exists l, In l (leaves c t) /\ in_cell l u.
Proof.
  induction t as [| | |a lower IHl upper IHu]; intros ways c u Hlength Hcovered Hu.
  - exists c. split; [now left | now apply within_inside in Hu].
  - discriminate.
  - discriminate.
  - cbn in Hcovered.
    assert (Hl : List.length ways = List.length (half_cell false a c)) by
      (unfold half_cell; now rewrite change_length).
    assert (Hr : List.length ways = List.length (half_cell true a c)) by
      (unfold half_cell; now rewrite change_length).
    setoid_rewrite in_leaves_cut.
    destruct (nth a ways []) as [|[] rest] eqn:Hway.
    + apply andb_prop in Hcovered as [Hlower Hupper].
      destruct (cell_halves a _ u Hu) as [H|H]; rewrite within_both in H by assumption.
      * destruct (IHl ways _ u Hl Hlower H) as (l & ? & ?). eauto.
      * destruct (IHu ways _ u Hr Hupper H) as (l & ? & ?). eauto.
    + rewrite (within_step true rest c ways a Hway) in Hu.
      destruct (IHu (change (@tl bool) a ways) (half_cell true a c) u) as (l & ? & ?); eauto.
      now rewrite change_length.
    + rewrite (within_step false rest c ways a Hway) in Hu.
      destruct (IHl (change (@tl bool) a ways) (half_cell false a c) u) as (l & ? & ?); eauto.
      now rewrite change_length.
Qed.

(* The cell whose way back to the root this is. *)
Definition cell_of (ways : list way) : cell := map (fun w => follow (0%Z, 0%nat) (rev w)) ways.

Lemma cell_of_cut upper : forall ways a,
  cell_of (change (cons upper) a ways) = half_cell upper a (cell_of ways).
Proof.
  induction ways as [|w ways IH]; intros [|a]; cbn; [reflexivity | reflexivity | | now rewrite IH].
  f_equal. unfold follow. now rewrite fold_left_app.
Qed.

Lemma cell_of_root n : cell_of (repeat [] n) = root n.
Proof. induction n as [|n IH]; cbn; [reflexivity | now f_equal]. Qed.

Lemma within_root ways : within (root (List.length ways)) (map (@rev bool) ways) = cell_of ways.
Proof. induction ways as [|w ways IH]; cbn; [reflexivity | now f_equal]. Qed.

(* The image of a point lies in the image of its cell; parameters that are not there are 0. *)
Lemma in_image order ways u : in_cell (cell_of ways) u ->
  in_cell (cell_of (image [] order ways)) (image 0 order u).
Proof.
  destruct ways as [|w0 [|w1 ways]]; intros H; inversion H as [|? v0 ? t0 H0 Ht0]; subst;
    [constructor | inversion Ht0; now subst |].
  inversion Ht0 as [|? v1 ? t H1 Ht]; subst. constructor; [assumption|]. constructor; [assumption|].
  induction order as [|m order IH]; cbn; constructor; [|exact IH].
  clear - Ht. revert t Ht. revert m.
  induction ways as [|w ways IH]; intros m t Ht; inversion Ht; subst.
  - destruct m; unfold in_slice, power; cbn; lra.
  - destruct m as [|m]; cbn; [assumption | now apply IH].
Qed.

Section Covers.
Variables (n : nat) (excluded leads : list R -> Prop) (linked : nat -> cell -> bool) (whole : tree)
  (orders : list (list nat)).
Hypothesis lengths : forall order, In order orders -> (2 + List.length order)%nat = n.
Hypothesis proved : forall c, In c (leaves (root n) whole) -> forall u, in_cell c u -> excluded u.
Hypothesis symmetry : forall order, In order orders -> forall u, List.length u = n ->
  excluded (image 0 order u) -> excluded u.
Hypothesis lead : forall k c, linked k c = true -> forall u, in_cell c u -> leads u.

(* A skipped leaf is excluded, as its image is. *)
Lemma skipped_covers ways u : List.length ways = n -> skips_ok orders whole ways Skipped = true ->
  in_cell (cell_of ways) u -> excluded u.
Proof.
  intros Hways Hskip Hu. apply existsb_exists in Hskip as (order & Horder & Hcovered).
  pose proof (lengths order Horder) as Hn.
  assert (Hlength : List.length u = n).
  { apply in_cell_length in Hu. unfold cell_of in Hu. rewrite map_length in Hu. congruence. }
  apply (symmetry order Horder u Hlength). apply (in_image order) in Hu.
  rewrite <- within_root, image_length, Hways in Hu by congruence.
  destruct (covered_correct whole (map (@rev bool) (image [] order ways)) (root n)
              (image 0 order u)) as (l & Hl & Hul); [|assumption|assumption|eauto].
  unfold root. rewrite map_length, repeat_length, image_length; congruence.
Qed.

(* So is all below a node. *)
Lemma part_covers t : forall ways u, List.length ways = n -> skips_ok orders whole ways t = true ->
  (forall c, In c (leaves (cell_of ways) t) -> In c (leaves (root n) whole)) ->
  all_links linked (cell_of ways) t = true -> in_cell (cell_of ways) u -> excluded u \/ leads u.
Proof.
  induction t as [| |k |a lower IHl upper IHu]; intros ways u Hways Hskips Hin Hlinks Hu.
  - left. apply (proved (cell_of ways)); [|assumption]. apply Hin. now left.
  - left. now apply skipped_covers with ways.
  - right. now apply (lead k (cell_of ways)).
  - cbn in Hskips, Hlinks. apply andb_prop in Hskips as [Hlower Hupper], Hlinks as [Hl Hr].
    rewrite <- !cell_of_cut in Hl, Hr. setoid_rewrite in_leaves_cut in Hin.
    destruct (cell_halves a _ u Hu) as [H|H]; rewrite <- cell_of_cut in H.
    + apply IHl with (change (cons false) a ways); auto; [now rewrite change_length|].
      rewrite cell_of_cut. auto.
    + apply IHu with (change (cons true) a ways); auto; [now rewrite change_length|].
      rewrite cell_of_cut. auto.
Qed.

End Covers.

(* If the proved leaves are excluded, and every skipped one is the mirror image of proved ones, then
   the whole region is excluded but for what leads elsewhere.  (What is cut along an axis that is not there would be wrong in a
   file, but does no harm.) *)
Theorem tree_covers : forall n (excluded leads : list R -> Prop) linked t orders,
  mirrored n orders t = true ->
  (forall c, In c (leaves (root n) t) -> forall u, in_cell c u -> excluded u) ->
  (forall order, In order orders -> forall u, List.length u = n ->
   excluded (image 0 order u) -> excluded u) ->
  all_links linked (root n) t = true ->
  (forall k c, linked k c = true -> forall u, in_cell c u -> leads u) ->
  forall u, List.length u = n -> Forall (fun x => -1 <= x <= 1) u -> excluded u \/ leads u.
Proof.
  intros n excluded leads linked t orders Hmirrored Hproved Hsymmetry Hlinks Hlead u Hn Hu.
  apply andb_prop in Hmirrored as [Hlengths Hskips].
  apply (part_covers n excluded leads linked t orders) with t (repeat [] n); auto.
  - intros order Horder. rewrite forallb_forall in Hlengths.
    now apply Nat.eqb_eq, Hlengths.
  - apply repeat_length.
  - now rewrite cell_of_root.
  - now rewrite cell_of_root.
  - rewrite cell_of_root, <- Hn. now apply in_root.
Qed.

(* ---- a search of one's own *)

(* Is the cell excluded, by cuts that are chosen on the way?  attempt says that it is (None), or
   which axis to cut.  No piece is cut more than depth times, and no more are made than cuts allows:
   those that are left of them, or None if that was not enough. *)
Fixpoint settle (attempt : cell -> option nat) (depth cuts : nat) (c : cell) : option nat :=
  match attempt c with
  | None => Some cuts
  | Some a =>
    match depth, cuts with
    | S depth, S cuts =>
      if (a <? List.length c)%nat then
        match settle attempt depth cuts (half_cell false a c) with
        | Some cuts => settle attempt depth cuts (half_cell true a c)
        | None => None
        end
      else None
    | _, _ => None
    end
  end.

Theorem settle_covers : forall (excluded : list R -> Prop) attempt,
  (forall c, attempt c = None -> forall u, in_cell c u -> excluded u) ->
  forall depth cuts c left, settle attempt depth cuts c = Some left ->
  forall u, in_cell c u -> excluded u.
Proof.
  intros excluded attempt Hattempt depth.
  induction depth as [|depth IH]; intros cuts c left H u Hu; cbn [settle] in H;
    (destruct (attempt c) as [a|] eqn:Ha; [|now apply (Hattempt c)]); [discriminate|].
  destruct cuts as [|cuts]; [discriminate|].
  destruct (a <? List.length c)%nat; [|discriminate].
  destruct (settle attempt depth cuts (half_cell false a c)) as [rest|] eqn:Hlower; [|discriminate].
  destruct (cell_halves a c u Hu); eauto.
Qed.

Definition settled attempt depth cuts (c : cell) : bool :=
  match settle attempt depth cuts c with Some _ => true | None => false end.

Corollary settled_covers : forall (excluded : list R -> Prop) attempt depth cuts,
  (forall c, attempt c = None -> forall u, in_cell c u -> excluded u) ->
  forall c, settled attempt depth cuts c = true -> forall u, in_cell c u -> excluded u.
Proof.
  intros excluded attempt depth cuts Hattempt c H. unfold settled in H.
  destruct (settle attempt depth cuts c) as [left|] eqn:Hc; [|discriminate].
  exact (settle_covers excluded attempt Hattempt depth cuts c left Hc).
Qed.

(* ---- the symmetry of a patch *)

(* Is this number an even integer? *)
Definition even (q : Q) : bool := (Qnum q mod (2 * Zpos (Qden q)) =? 0)%Z.

(* A term's function is another one's with this sign: sin(x) = sin(x + 2 pi) = - sin(x + pi) and
   sin(x) = sin(pi - x).  None: with neither. *)
Definition sign_of (phase : Q) : option Q :=
  if even phase then Some 1%Q else if even (phase - 1) then Some (-1)%Q else None.

Definition relation (w w' : term) : option Q :=
  if (of_k0 w' =? of_k0 w)%Z && (of_k1 w' =? of_k1 w)%Z then sign_of (of_phase w' - of_phase w)
  else if (of_k0 w' =? - of_k0 w)%Z && (of_k1 w' =? - of_k1 w)%Z
  then sign_of (of_phase w' + of_phase w - 1)
  else None.

(* l + s l', as if the shorter one ended with zeros. *)
Fixpoint added (s : Q) (l l' : list Q) : list Q :=
  match l, l' with
  | _, [] => l
  | [], _ => map (Qmult s) l'
  | q :: l, q' :: l' => (q + s * q')%Q :: added s l l'
  end.

(* One term for w and all of a list that w can stand for, and the others. *)
Fixpoint collected (w : term) (l : list term) : term * list term :=
  match l with
  | [] => (w, [])
  | w' :: l =>
      let (total, rest) := collected w l in
      match relation w w' with
      | Some s => (Term (of_k0 w) (of_k1 w) (of_phase w) (middle total + s * middle w')
                        (added s (parts total) (parts w')), rest)
      | None => (total, w' :: rest)
      end
  end.

(* Is V zero for all parameters? *)
Fixpoint vanish (fuel : nat) (l : list term) : bool :=
  match fuel, l with
  | _, [] => true
  | O, _ => false
  | S fuel, w :: l =>
      let (total, rest) := collected w l in
      forallb (Qeq_bool 0) (middle total :: parts total) && vanish fuel rest
  end.

Definition opposite (w : term) : term :=
  Term (of_k0 w) (of_k1 w) (of_phase w) (- middle w) (map Qopp (parts w)).

Definition exchanged (order : list nat) (w : term) : term :=
  Term (of_k1 w) (of_k0 w) (of_phase w) (middle w) (reordered 0%Q order (parts w)).

(* Is V, its coordinates exchanged, V with its parameters in this order? *)
Definition symmetric (patch : list term) (order : list nat) : bool :=
  forallb (fun m => existsb (Nat.eqb m) order) (seq 0 (List.length order))
  && forallb (fun w => List.length (parts w) <=? List.length order)%nat patch
  && vanish (2 * List.length patch) (map (exchanged order) patch ++ map opposite patch).

(* What V' and beta are sums of, for amplitude 1; s times as much for another wave. *)
Definition alike (s : R) (w w' : wave) : Prop := forall y v,
  IZR (k0 w') * cos (angle w' y) = s * (IZR (k0 w) * cos (angle w y)) /\
  IZR (k1 w') * cos (angle w' y) = s * (IZR (k1 w) * cos (angle w y)) /\
  sin (angle w' y) * (along w' v * along w' v) = s * (sin (angle w y) * (along w v * along w v)).

Lemma alike_turned w w' (m : Z) : k0 w' = k0 w -> k1 w' = k1 w ->
  phase w' = phase w + 2 * PI * IZR m -> alike 1 w w'.
Proof.
  intros H0 H1 Hphase y v.
  assert (Hangle : angle w' y = angle w y + 2 * PI * IZR m).
  { unfold angle, along. rewrite H0, H1, Hphase. ring. }
  assert (Halong : along w' v = along w v) by (unfold along; now rewrite H0, H1).
  rewrite Hangle, Halong, cos_turns, sin_turns, H0, H1. repeat split; ring.
Qed.

Lemma alike_half w w' : k0 w' = k0 w -> k1 w' = k1 w -> phase w' = phase w + PI ->
  alike (-1) w w'.
Proof.
  intros H0 H1 Hphase y v.
  assert (Hangle : angle w' y = angle w y + PI).
  { unfold angle, along. rewrite H0, H1, Hphase. ring. }
  assert (Halong : along w' v = along w v) by (unfold along; now rewrite H0, H1).
  rewrite Hangle, Halong, neg_cos, neg_sin, H0, H1. repeat split; ring.
Qed.

Lemma alike_reversed w w' : k0 w' = (- k0 w)%Z -> k1 w' = (- k1 w)%Z -> phase w' = PI - phase w ->
  alike 1 w w'.
Proof.
  intros H0 H1 Hphase y v.
  assert (Hangle : angle w' y = PI - angle w y).
  { unfold angle, along. rewrite H0, H1, Hphase, !opp_IZR. ring. }
  assert (Halong : along w' v = - along w v).
  { unfold along. rewrite H0, H1, !opp_IZR. ring. }
  rewrite Hangle, Halong, H0, H1, !opp_IZR, sin_PI_x, Rtrigo_facts.cos_pi_minus.
  repeat split; ring.
Qed.

Lemma alike_trans s s' w w' w'' : alike s w w' -> alike s' w' w'' -> alike (s' * s) w w''.
Proof.
  intros H H' y v. destruct (H y v) as (H0 & H1 & H2), (H' y v) as (-> & -> & ->).
  rewrite H0, H1, H2. repeat split; ring.
Qed.

Lemma even_correct q : even q = true -> exists m : Z, Q2R q = 2 * IZR m.
Proof.
  intros H. apply Z.eqb_eq, Z.mod_divide in H as [m Hm]; [|lia]. exists m.
  unfold Q2R. rewrite Hm, !mult_IZR. field. apply not_0_IZR. lia.
Qed.

(* A phase that differs from another by a whole number: of turns, or of turns and a half. *)
Lemma sign_of_correct q s w w' : sign_of q = Some s -> k0 w' = k0 w -> k1 w' = k1 w ->
  phase w' = phase w + Q2R q * PI -> alike (Q2R s) w w'.
Proof.
  unfold sign_of. intros H H0 H1 Hphase. destruct (even q) eqn:Hq.
  - injection H as <-. apply even_correct in Hq as [m Hm].
    replace (Q2R 1) with 1 by (unfold Q2R; cbn; lra).
    apply (alike_turned _ _ m); try assumption. rewrite Hphase, Hm. ring.
  - destruct (even (q - 1)) eqn:Hq1; [|discriminate]. injection H as <-.
    apply even_correct in Hq1 as [m Hm]. rewrite Q2R_minus in Hm.
    replace (Q2R 1) with 1 in Hm by (unfold Q2R; cbn; lra).
    replace (Q2R (-1)) with (-1 * 1) by (unfold Q2R; cbn; lra).
    apply (alike_trans _ _ _ (Wave (k0 w) (k1 w) (phase w + 2 * PI * IZR m) 0)).
    + now apply (alike_turned _ _ m).
    + apply alike_half; try assumption. cbn. rewrite Hphase.
      replace (Q2R q) with (1 + 2 * IZR m) by lra. ring.
Qed.

Definition wave_at (t : list R) (w : term) : wave :=
  Wave (of_k0 w) (of_k1 w) (Q2R (of_phase w) * PI) (Q2R (middle w) + combined (parts w) t).

Lemma relation_correct t w w' s : relation w w' = Some s ->
  alike (Q2R s) (wave_at t w) (wave_at t w').
Proof.
  unfold relation. intros H.
  destruct ((of_k0 w' =? of_k0 w)%Z && (of_k1 w' =? of_k1 w)%Z) eqn:Hsame.
  - apply andb_prop in Hsame as [H0 H1]. apply Z.eqb_eq in H0, H1.
    apply (sign_of_correct _ _ _ _ H); try assumption. cbn [wave_at phase].
    rewrite Q2R_minus. ring.
  - destruct ((of_k0 w' =? - of_k0 w)%Z && (of_k1 w' =? - of_k1 w)%Z) eqn:Hopposite;
      [|discriminate].
    apply andb_prop in Hopposite as [H0 H1]. apply Z.eqb_eq in H0, H1.
    replace (Q2R s) with (Q2R s * 1) by ring.
    apply (alike_trans _ _ _ (Wave (of_k0 w') (of_k1 w') (PI - Q2R (of_phase w) * PI) 0)).
    + now apply alike_reversed.
    + apply (sign_of_correct _ _ _ _ H); try reflexivity. cbn [wave_at phase].
      rewrite Q2R_minus, Q2R_plus. replace (Q2R 1) with 1 by (unfold Q2R; cbn; lra). ring.
Qed.

Lemma combined_scaled s l t : combined (map (Qmult s) l) t = Q2R s * combined l t.
Proof.
  unfold combined. revert t. induction l as [|q l IH]; intros [|x t]; cbn; try ring.
  unfold sum in IH. rewrite IH, Q2R_mult. ring.
Qed.

Lemma combined_opposite l t : combined (map Qopp l) t = - combined l t.
Proof.
  unfold combined. revert t. induction l as [|q l IH]; intros [|x t]; cbn; try ring.
  unfold sum in IH. rewrite IH, Q2R_opp. ring.
Qed.

Lemma combined_added s l l' t : combined (added s l l') t = combined l t + Q2R s * combined l' t.
Proof.
  revert l' t. induction l as [|q l IH]; intros [|q' l'] t.
  - cbn. ring.
  - change (added s [] (q' :: l')) with (map (Qmult s) (q' :: l')). rewrite combined_scaled.
    cbn. ring.
  - cbn. ring.
  - destruct t as [|x t]; [cbn; ring|]. specialize (IH l' t). unfold combined, sum in *. cbn.
    rewrite IH, Q2R_plus, Q2R_mult. ring.
Qed.

Lemma combined_zero l t : forallb (Qeq_bool 0) l = true -> combined l t = 0.
Proof.
  unfold combined. revert t. induction l as [|q l IH]; intros [|x t] H; try reflexivity. cbn in *.
  apply andb_prop in H as [Hq H]. apply Qeq_bool_eq, Qeq_eqR in Hq. unfold sum in IH.
  rewrite (IH t H), <- Hq. unfold Q2R; cbn. ring.
Qed.

(* A sum of amplitudes times something is the same for terms that are collected, and zero if they
   all vanish. *)
Section Collected.
Variables (t : list R) (g : wave -> R).
Hypothesis g_alike : forall s w w', alike s w w' -> g w' = s * g w.

Definition share (w : term) : R := amplitude (wave_at t w) * g (wave_at t w).

Lemma collected_correct w l : forall total rest, collected w l = (total, rest) ->
  g (wave_at t total) = g (wave_at t w) /\
  share w + sum share l = share total + sum share rest.
Proof.
  induction l as [|w' l IH]; intros total rest H; cbn [collected] in H.
  - injection H as <- <-. repeat split; auto.
  - destruct (collected w l) as [total' rest'] eqn:Hl.
    destruct (IH _ _ eq_refl) as (Hg & Hsum).
    unfold sum in Hsum. destruct (relation w w') as [s|] eqn:Hs; injection H as <- <-.
    + apply (relation_correct t), g_alike in Hs.
      assert (Hsame : g (wave_at t (Term (of_k0 w) (of_k1 w) (of_phase w)
                (middle total' + s * middle w') (added s (parts total') (parts w'))))
              = g (wave_at t w)).
      { rewrite (g_alike 1 (wave_at t w)); [ring|]. apply (alike_turned _ _ 0); try reflexivity.
        cbn. ring. }
      split; [assumption|].
      unfold sum; cbn. unfold share in *. rewrite Hsame, Hs, Hg in *.
      cbn [wave_at amplitude middle parts] in *. rewrite combined_added, Q2R_plus, Q2R_mult. nra.
    + split; [assumption|]. unfold sum; cbn. lra.
Qed.

Lemma vanish_correct n : forall l, vanish n l = true -> sum share l = 0.
Proof.
  induction n as [|n IH]; intros [|w l] H; try reflexivity; try discriminate. cbn [vanish] in H.
  destruct (collected w l) as [total rest] eqn:Hl. apply andb_prop in H as [Hzero H].
  apply collected_correct in Hl as (_ & Hsum). cbn [forallb] in Hzero.
  apply andb_prop in Hzero as [Hmiddle Hparts]. apply Qeq_bool_eq, Qeq_eqR in Hmiddle.
  change (share w + sum share l = 0). rewrite Hsum, (IH _ H). unfold share at 1.
  cbn [wave_at amplitude]. rewrite (combined_zero _ _ Hparts), <- Hmiddle. unfold Q2R; cbn. ring.
Qed.

End Collected.

(* What is combined is a sum over all numbers that are not beyond the parts. *)
Lemma combined_sum m : forall parts t, (List.length parts <= m)%nat ->
  combined parts t = sum (fun i => Q2R (nth i parts 0%Q) * nth i t 0) (seq 0 m).
Proof.
  assert (Hzero : forall l t, sum (fun i : nat => Q2R (nth i [] 0%Q) * nth i t 0) l = 0).
  { intros l t. induction l as [|i l IH]; [reflexivity|]. cbn in *. unfold sum in IH. rewrite IH.
    destruct i; unfold Q2R; cbn; ring. }
  induction m as [|m IH]; intros [|q parts] t Hm; try (cbn in Hm; lia); [reflexivity | |].
  - symmetry. apply Hzero.
  - cbn [seq]. rewrite <- seq_shift. destruct t as [|x t].
    + rewrite (sum_ext _ (fun _ => 0 * 0)), sum_scale by (intros [|i] _; cbn; ring).
      unfold combined; cbn. ring.
    + change (combined (q :: parts) (x :: t)) with (Q2R q * x + combined parts t).
      rewrite (IH parts t) by (cbn in Hm; lia). cbn [sum fold_right]. f_equal.
      symmetry. apply sum_map.
Qed.

Lemma combined_map {A} (f : A -> Q) (g : A -> R) l :
  combined (map f l) (map g l) = sum (fun a => Q2R (f a) * g a) l.
Proof. induction l as [|a l IH]; [reflexivity|]. cbn. f_equal. exact IH. Qed.

(* Parts and parameters in the same order are combined to the same. *)
Lemma combined_reordered order parts t : Permutation (seq 0 (List.length order)) order ->
  (List.length parts <= List.length order)%nat ->
  combined (reordered 0%Q order parts) (reordered 0 order t) = combined parts t.
Proof.
  intros Horder Hparts. unfold reordered. rewrite combined_map, (combined_sum _ parts t Hparts).
  symmetry. now apply sum_permutation.
Qed.

(* A list that holds all of 0, 1, .., and no more of them, has them in some order. *)
Lemma order_correct order :
  forallb (fun m => existsb (Nat.eqb m) order) (seq 0 (List.length order)) = true ->
  Permutation (seq 0 (List.length order)) order.
Proof.
  intros H. rewrite forallb_forall in H.
  apply NoDup_Permutation_bis; [apply seq_NoDup | now rewrite seq_length |].
  intros m Hm. apply H, existsb_exists in Hm as (m' & Hin & Hm). apply Nat.eqb_eq in Hm. now subst.
Qed.

Lemma sum_app {A} (f : A -> R) l l' : sum f (l ++ l') = sum f l + sum f l'.
Proof.
  induction l as [|a l IH]; [change (sum f l' = 0 + sum f l'); ring|].
  change (f a + sum f (l ++ l') = f a + sum f l + sum f l'). rewrite IH. ring.
Qed.

(* A sum over the waves, exchanged, is that for the parameters in the other order. *)
Lemma symmetric_sums patch order t g : symmetric patch order = true ->
  (forall s w w', alike s w w' -> g w' = s * g w) ->
  sum (fun w => amplitude w * g w) (map exchange (waves patch t))
  = sum (fun w => amplitude w * g w) (waves patch (reordered 0 order t)).
Proof.
  intros H Hg. unfold symmetric in H. apply andb_prop in H as [H Hvanish].
  apply andb_prop in H as [Horder Hparts]. apply order_correct in Horder.
  rewrite forallb_forall in Hparts.
  apply (vanish_correct (reordered 0 order t) g Hg) in Hvanish.
  rewrite sum_app, !sum_map in Hvanish. unfold waves. rewrite !sum_map.
  rewrite (sum_ext (fun w => share _ g (opposite w))
             (fun w => -1 * (amplitude (wave_at (reordered 0 order t) w)
                             * g (wave_at (reordered 0 order t) w)))) in Hvanish.
  - rewrite sum_scale in Hvanish.
    rewrite (sum_ext _ (fun w => share (reordered 0 order t) g (exchanged order w))).
    + change (fun w => amplitude _ * g _) with
        (fun w => let w := wave_at (reordered 0 order t) w in amplitude w * g w). lra.
    + intros w Hw. unfold share, wave_at, exchange, exchanged.
      cbn [of_k0 of_k1 of_phase middle parts k0 k1 phase amplitude].
      rewrite combined_reordered; [reflexivity | assumption |]. now apply Nat.leb_le, Hparts.
  - intros w _. unfold share. rewrite (Hg 1 (wave_at (reordered 0 order t) w)).
    + cbn [wave_at amplitude opposite middle parts]. rewrite combined_opposite, Q2R_opp. ring.
    + apply (alike_turned _ _ 0); try reflexivity. cbn. ring.
Qed.

Theorem symmetric_correct : forall patch order, symmetric patch order = true -> forall t y v,
  V' (map exchange (waves patch t)) y = V' (waves patch (reordered 0 order t)) y /\
  beta (map exchange (waves patch t)) y v = beta (waves patch (reordered 0 order t)) y v.
Proof.
  intros patch order H t y v.
  assert (Hsums := fun g => symmetric_sums patch order t g H).
  assert (H0 := Hsums (fun w => IZR (k0 w) * cos (angle w y))
                 (fun s w w' Hw => proj1 (Hw y v))).
  assert (H1 := Hsums (fun w => IZR (k1 w) * cos (angle w y))
                 (fun s w w' Hw => proj1 (proj2 (Hw y v)))).
  assert (H2 := Hsums (fun w => sin (angle w y) * (along w v * along w v))
                 (fun s w w' Hw => proj2 (proj2 (Hw y v)))).
  split.
  - unfold V'. f_equal; f_equal; [etransitivity; [etransitivity; [|exact H0]|] |
      etransitivity; [etransitivity; [|exact H1]|]]; apply sum_ext; intros w _; ring.
  - unfold beta. f_equal. etransitivity; [etransitivity; [|exact H2]|];
      apply sum_ext; intros w _; ring.
Qed.

(* So the exchange maps orbits to orbits, and refuted ones to refuted ones. *)
Lemma exchanged_orbit patch order t x : symmetric patch order = true -> orbit (waves patch t) x ->
  orbit (waves patch (reordered 0 order t)) (fun j => swap (x j)) /\
  (refuted (waves patch (reordered 0 order t)) (fun j => swap (x j)) -> refuted (waves patch t) x).
Proof.
  intros Hsymmetric Hx. pose proof (symmetric_correct _ _ Hsymmetric t) as Hsame. split.
  - apply orbit_swap in Hx. revert Hx. apply orbit_ext. intros y. apply (Hsame y y).
  - intros H. apply refuted_swap. revert H. apply refuted_ext. intros j v. symmetry. apply Hsame.
Qed.

(* No minimizing orbit goes from x* to this point, for these parameters; u has first the place of x1
   between its bounds, the same for both angles. *)
Definition excluded (patch : list term) (xstar : vec) (c h : R) (u : list R) : Prop :=
  forall x, orbit (waves patch (tl (tl u))) x -> x 0%Z = xstar ->
  x 1%Z = (PI * (c + h * nth 0 u 0), PI * (c + h * nth 1 u 0)) ->
  refuted (waves patch (tl (tl u))) x.

Theorem mirror_excluded : forall patch xstar c h order u, symmetric patch order = true ->
  fst xstar = snd xstar -> excluded patch xstar c h (image 0 order u) -> excluded patch xstar c h u.
Proof.
  intros patch xstar c h order u Hsymmetric Hxstar Himage x Hx Hx0 Hx1.
  destruct u as [|v0 [|v1 t]]; [now apply Himage | now apply Himage |].
  cbn [tl] in *. destruct (exchanged_orbit patch order t x Hsymmetric Hx) as [Ho Hr].
  apply Hr, Himage; [assumption | |]; unfold swap; cbn [image nth].
  - rewrite Hx0, Hxstar. rewrite <- Hxstar at 1. now destruct xstar.
  - now rewrite Hx1.
Qed.
