(* Trees from files, and how their leaves are shared out: nothing is lost when K files take every
   K-th, nor when a tree is gone through without a list of its leaves. *)

From Coq Require Import List Bool Lia Ascii String.
From Converse Require Import Tree.
Import ListNotations.
Open Scope nat_scope.
Open Scope list_scope.

(* A tree in lines of text; they are short, since long strings take the parser too deep.  A text that
   is no tree is a leaf that excludes nothing. *)
Definition read_tree (lines : list string) : tree :=
  match parse_list (flat_map list_ascii_of_string lines) with Some t => t | None => Skipped end.

(* The i-th element of the list, and from there on every K-th. *)
Fixpoint share {A} (i K : nat) (l : list A) : list A :=
  match l, i with
  | [], _ => []
  | x :: l, O => x :: share (K - 1) K l
  | _ :: l, S i => share i K l
  end.

Theorem shares_all : forall A (f : A -> bool) K l,
  Forall (fun i => forallb f (share i K l) = true) (seq 0 K) -> 0 < K -> forallb f l = true.
Proof.
  intros A f K l H HK. assert (H' : forall i, i < K -> forallb f (share i K l) = true).
  { intros i Hi. rewrite Forall_forall in H. apply H, in_seq. lia. }
  clear H. induction l as [| x l IH]; [easy |].
  assert (H0 := H' 0 HK). simpl in H0. apply andb_prop in H0. destruct H0 as [Hx Hl].
  simpl. rewrite Hx. apply IH. intros i Hi. destruct (PeanoNat.Nat.eq_dec i (K - 1)) as [-> | Hne].
  - exact Hl.
  - apply (H' (S i)). lia.
Qed.

(* The same of several lists, of which each file takes its share. *)
Corollary shares_all_of : forall A B (f : B -> A -> bool) (l : B -> list A) K bs,
  Forall (fun i => forallb (fun b => forallb (f b) (share i K (l b))) bs = true) (seq 0 K) -> 0 < K ->
  forallb (fun b => forallb (f b) (l b)) bs = true.
Proof.
  intros A B f l K bs H HK. apply forallb_forall. intros b Hb.
  apply (shares_all _ _ K); [| exact HK]. revert H. apply Forall_impl. intros i H.
  rewrite forallb_forall in H. exact (H b Hb).
Qed.

(* Does f hold of each proved leaf's cell?  The tree's own cell is c. *)
Fixpoint all_leaves (f : cell -> bool) (c : cell) (t : tree) : bool :=
  match t with
  | Proved => f c
  | Skipped | Linked _ => true
  | Cut a lower upper =>
    all_leaves f (half_cell false a c) lower && all_leaves f (half_cell true a c) upper
  end.

Lemma all_leaves_before f t : forall rest c,
  forallb f (leaves_before rest c t) = all_leaves f c t && forallb f rest.
Proof.
  induction t as [| | | a lower IHl upper IHu]; intros rest c; simpl; try easy.
  now rewrite IHl, IHu, andb_assoc.
Qed.

Theorem all_leaves_correct : forall f c t, all_leaves f c t = forallb f (leaves c t).
Proof. intros f c t. unfold leaves. rewrite all_leaves_before. symmetry. apply andb_true_r. Qed.
