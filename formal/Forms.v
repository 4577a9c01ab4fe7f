(* Polynomials of third order in the symbols e, each from -1 to 1, with intervals for coefficients.

   All that is said of one is which number it holds at one point e: `hold1 e l v` for a form1 form
   l, `hold2` and `hold3` for form2 and form3 ones.  So a proof about polynomials is a proof about
   numbers.  A list that is shorter than e stands for zeros. *)

From Coq Require Import Reals List Lra Lia.
From Interval.Real Require Import Xreal.
From Interval.Float Require Import Basic Sig.
From Interval.Interval Require Import Interval.
From Converse Require Import Torus.
Import ListNotations.
Open Scope R_scope.

Module Forms (F : FloatOps with Definition radix := Zaux.radix2
                           with Definition sensible_format := true).
Include Torus F.

Definition form1 := list I.type.           (* of e[i] *)
Definition form2 := list form1.        (* of e[i] e[j], j >= i: row i begins at j = i *)
Definition form3 := list form2.         (* of e[i] times a quadratic form *)

Fixpoint hold1 (e : list R) (l : form1) (v : R) : Prop :=
  match l, e with
  | [], _ => v = 0
  | a :: l, x :: e => exists c r, cont a c /\ hold1 e l r /\ v = c * x + r
  | _, [] => False
  end.

Fixpoint hold2 (e : list R) (q : form2) (v : R) : Prop :=
  match q, e with
  | [], _ => v = 0
  | row :: q, x :: e => exists c r, hold1 (x :: e) row c /\ hold2 e q r /\ v = c * x + r
  | _, [] => False
  end.

Fixpoint hold3 (all e : list R) (t : form3) (v : R) : Prop :=
  match t, e with
  | [], _ => v = 0
  | q :: t, x :: e => exists c r, hold2 all q c /\ hold3 all e t r /\ v = c * x + r
  | _, [] => False
  end.

Definition cube (e : list R) : Prop := Forall (fun x => -1 <= x <= 1) e.

(* ---- sums and products *)

(* Adds lists that may be of unlike lengths. *)
Fixpoint zip {A} (f : A -> A -> A) (a b : list A) : list A :=
  match a, b with
  | x :: a, y :: b => f x y :: zip f a b
  | [], _ => b
  | _, [] => a
  end.

Section Precision.
Variable prec : F.precision.
Notation add := (add prec).
Notation mul := (mul prec).

Definition add1 : form1 -> form1 -> form1 := zip add.
Definition add2 : form2 -> form2 -> form2 := zip add1.
Definition add3 : form3 -> form3 -> form3 := zip add2.
Definition scale1 (c : I.type) : form1 -> form1 := map (mul c).
Definition scale2 (c : I.type) : form2 -> form2 := map (scale1 c).

(* The product of two linear forms. *)
Fixpoint product (a b : form1) : form2 :=
  match a, b with
  | x :: a', y :: b' => (mul x y :: add1 (scale1 x b') (scale1 y a')) :: product a' b'
  | _, _ => []
  end.

(* The square of one. *)
Fixpoint square (a : form1) : form2 :=
  match a with
  | x :: a' => (sqr prec x :: scale1 (add x x) a') :: square a'
  | [] => []
  end.

(* A linear form times a quadratic one. *)
Definition product3 (a : form1) (q : form2) : form3 := map (fun x => scale2 x q) a.

Lemma hold1_eq e l v w : hold1 e l v -> v = w -> hold1 e l w.
Proof. now intros H <-. Qed.
Lemma hold2_eq e q v w : hold2 e q v -> v = w -> hold2 e q w.
Proof. now intros H <-. Qed.
Lemma hold3_eq a e t v w : hold3 a e t v -> v = w -> hold3 a e t w.
Proof. now intros H <-. Qed.

Lemma hold1_none e v : hold1 e [] v -> v = 0.
Proof. now destruct e. Qed.
Lemma hold2_none e v : hold2 e [] v -> v = 0.
Proof. now destruct e. Qed.
Lemma hold3_none a e v : hold3 a e [] v -> v = 0.
Proof. now destruct e. Qed.

Lemma hold1_nil e : hold1 e [] 0.
Proof. now destruct e. Qed.
Lemma hold2_nil e : hold2 e [] 0.
Proof. now destruct e. Qed.
Lemma hold3_nil a e : hold3 a e [] 0.
Proof. now destruct e. Qed.

Lemma hold_add1 e a b v w : hold1 e a v -> hold1 e b w -> hold1 e (add1 a b) (v + w).
Proof.
  revert e b v w. induction a as [| x a IH]; intros e [| y b] v w Ha Hb.
  - rewrite (hold1_none _ _ Ha), (hold1_none _ _ Hb), Rplus_0_l. apply hold1_nil.
  - now rewrite (hold1_none _ _ Ha), Rplus_0_l.
  - now rewrite (hold1_none _ _ Hb), Rplus_0_r.
  - destruct e as [| s e]; [easy |].
    destruct Ha as (c & r & Hc & Hr & ->), Hb as (d & t & Hd & Ht & ->).
    exists (c + d), (r + t). split; [now apply cont_add |]. split; [now apply IH | ring].
Qed.

Lemma hold_add2 e a b v w : hold2 e a v -> hold2 e b w -> hold2 e (add2 a b) (v + w).
Proof.
  revert e b v w. induction a as [| x a IH]; intros e [| y b] v w Ha Hb.
  - rewrite (hold2_none _ _ Ha), (hold2_none _ _ Hb), Rplus_0_l. apply hold2_nil.
  - now rewrite (hold2_none _ _ Ha), Rplus_0_l.
  - now rewrite (hold2_none _ _ Hb), Rplus_0_r.
  - destruct e as [| s e]; [easy |].
    destruct Ha as (c & r & Hc & Hr & ->), Hb as (d & t & Hd & Ht & ->).
    exists (c + d), (r + t). split; [now apply hold_add1 |]. split; [now apply IH | ring].
Qed.

Lemma hold_add3 all e a b v w :
  hold3 all e a v -> hold3 all e b w -> hold3 all e (add3 a b) (v + w).
Proof.
  revert e b v w. induction a as [| x a IH]; intros e [| y b] v w Ha Hb.
  - rewrite (hold3_none _ _ _ Ha), (hold3_none _ _ _ Hb), Rplus_0_l. apply hold3_nil.
  - now rewrite (hold3_none _ _ _ Ha), Rplus_0_l.
  - now rewrite (hold3_none _ _ _ Hb), Rplus_0_r.
  - destruct e as [| s e]; [easy |].
    destruct Ha as (c & r & Hc & Hr & ->), Hb as (d & t & Hd & Ht & ->).
    exists (c + d), (r + t). split; [now apply hold_add2 |]. split; [now apply IH | ring].
Qed.

Lemma hold_scale1 e c x l v : cont c x -> hold1 e l v -> hold1 e (scale1 c l) (x * v).
Proof.
  intros Hc. revert e v. induction l as [| a l IH]; intros e v H.
  - rewrite (hold1_none _ _ H), Rmult_0_r. apply hold1_nil.
  - destruct e as [| s e]; [easy |]. destruct H as (d & r & Hd & Hr & ->).
    exists (x * d), (x * r). split; [now apply cont_mul |]. split; [now apply IH | ring].
Qed.

Lemma hold_scale2 e c x q v : cont c x -> hold2 e q v -> hold2 e (scale2 c q) (x * v).
Proof.
  intros Hc. revert e v. induction q as [| a q IH]; intros e v H.
  - rewrite (hold2_none _ _ H), Rmult_0_r. apply hold2_nil.
  - destruct e as [| s e]; [easy |]. destruct H as (d & r & Hd & Hr & ->).
    exists (x * d), (x * r). split; [now apply hold_scale1 |]. split; [now apply IH | ring].
Qed.

Lemma hold_product e a b v w : hold1 e a v -> hold1 e b w -> hold2 e (product a b) (v * w).
Proof.
  revert e b v w. induction a as [| x a IH]; intros e b v w Ha Hb.
  { rewrite (hold1_none _ _ Ha), Rmult_0_l. apply hold2_nil. }
  destruct b as [| y b].
  { rewrite (hold1_none _ _ Hb), Rmult_0_r. apply hold2_nil. }
  destruct e as [| s e]; [easy |].
  destruct Ha as (c & r & Hc & Hr & ->), Hb as (d & t & Hd & Ht & ->).
  exists (c * d * s + (c * t + d * r)), (r * t). split; [| split; [now apply IH | ring]].
  exists (c * d), (c * t + d * r). split; [now apply cont_mul |].
  split; [| ring]. apply hold_add1; now apply hold_scale1.
Qed.

Lemma hold_square e a v : hold1 e a v -> hold2 e (square a) (v * v).
Proof.
  revert e v. induction a as [| x a IH]; intros e v Ha.
  - rewrite (hold1_none _ _ Ha), Rmult_0_r. apply hold2_nil.
  - destruct e as [| s e]; [easy |]. destruct Ha as (c & r & Hc & Hr & ->).
    exists (c * c * s + (c + c) * r), (r * r). split; [| split; [now apply IH | ring]].
    exists (c * c), ((c + c) * r). split; [now apply cont_sqr |].
    split; [| ring]. apply hold_scale1; [now apply cont_add | easy].
Qed.

Lemma hold_product3 all e a q v w :
  hold1 e a v -> hold2 all q w -> hold3 all e (product3 a q) (v * w).
Proof.
  intros Ha Hq. revert e v Ha. induction a as [| x a IH]; intros e v Ha.
  - rewrite (hold1_none _ _ Ha), Rmult_0_l. apply hold3_nil.
  - destruct e as [| s e]; [easy |]. destruct Ha as (c & r & Hc & Hr & ->).
    exists (c * w), (r * w). split; [now apply hold_scale2 |]. split; [now apply IH | ring].
Qed.

(* ---- ranges over the cube *)

Variable unit : I.type.
Hypothesis unit_ok : forall x, -1 <= x <= 1 -> cont unit x.
Variable proper : I.type.                       (* from 0 to 1 *)
Hypothesis proper_ok : forall x, 0 <= x <= 1 -> cont proper x.

Definition range1 (l : form1) : I.type := fold_right (fun a r => add (mul a unit) r) I.zero l.

Lemma cont_range1 e l v : cube e -> hold1 e l v -> cont (range1 l) v.
Proof.
  intros C. revert l v. induction C as [| s e Hs C IH]; intros [| a l] v H; try easy.
  - rewrite (hold1_none _ _ H). exact cont_zero.
  - rewrite (hold1_none _ _ H). exact cont_zero.
  - destruct H as (c & r & Hc & Hr & ->). simpl. auto using cont_add, cont_mul.
Qed.

(* The square of a symbol is not below zero. *)
Fixpoint range2 (q : form2) : I.type :=
  match q with
  | (a :: row) :: q => add (add (mul a proper) (range1 row)) (range2 q)
  | [] :: q => range2 q
  | [] => I.zero
  end.

Lemma hold1_times x e l v : hold1 e l v -> hold1 (map (Rmult x) e) l (x * v).
Proof.
  revert l v. induction e as [| s e IH]; intros [| a l] v H; try easy; try (simpl in *; rewrite H; ring).
  destruct H as (c & r & Hc & Hr & ->). exists c, (x * r). split; [exact Hc |].
  split; [now apply IH | ring].
Qed.

Lemma cont_range2 e q v : cube e -> hold2 e q v -> cont (range2 q) v.
Proof.
  intros C. revert q v. induction C as [| s e Hs C IH]; intros [| row q] v H; try easy;
    try (rewrite (hold2_none _ _ H); exact cont_zero).
  destruct H as (c & r & Hc & Hr & ->). specialize (IH _ _ Hr). destruct row as [| a row].
  { rewrite (hold1_none _ _ Hc), Rmult_0_l, Rplus_0_l. exact IH. }
  destruct Hc as (x & y & Hx & Hy & ->). cbn [range2].
  replace ((x * s + y) * s + r) with (x * (s * s) + s * y + r) by ring.
  apply cont_add; [| exact IH]. apply cont_add.
  - apply cont_mul; [exact Hx |]. apply proper_ok. nra.
  - apply (cont_range1 (map (Rmult s) e)); [| now apply hold1_times].
    apply Forall_map. revert C. apply Forall_impl. intros t Ht. nra.
Qed.

(* ---- the largest value over the cube *)

Lemma cont_convex i x y z : cont i x -> cont i z -> x <= y <= z -> cont i y.
Proof. unfold cont. destruct (I.convert i) as [| [| l] [| u]]; simpl; intuition lra. Qed.

Definition head1 (l : form1) : I.type := hd I.zero l.
Definition head2 (q : form2) : form1 := hd [] q.
Definition negate1 : form1 -> form1 := map neg.
Definition negate2 : form2 -> form2 := map negate1.

(* The quadratic form  sum of e[i] row i,  of rows that all begin with the first symbol;  n is at
   least their number. *)
Fixpoint triangle (n : nat) (rows : list form1) : form2 :=
  match n, rows with
  | S n, row :: rows =>
    add1 row (I.zero :: map head1 rows) :: triangle n (map (@tl I.type) rows)
  | _, _ => []
  end.

(* Let s be the first symbol of the polynomial  c + l + q + t.  It is  p + s r - (1 - s^2) u,  where
   p and r are polynomials in the other symbols.  What is form1 in s is largest at s = 1 or at
   s = -1, where p + r and p - r are bounded by the same way; and u, in which the symbols are left, by
   its range. *)
Fixpoint summit (n : nat) (c : I.type) (l : form1) (q : form2) (t : form3) : I.type :=
  match n with
  | O => c
  | S n =>
    let first := hd [] t in                                     (* with s *)
    let second := head2 first in                                (* with s^2 *)
    let twice := add1 (map (fun q => head1 (head2 q)) (tl t)) (tl second) in
    let bend := head1 (head2 q) in
    let cubed := head1 second in
    let p0 := add c bend in
    let p1 := add1 (tl l) twice in
    let p2 := tl q in
    let r0 := add (head1 l) cubed in
    let r1 := tl (head2 q) in
    let r2 := add2 (tl first) (triangle n (map (fun q => tl (head2 q)) (tl t))) in
    let rest := map (@tl form1) (tl t) in
    let u := add bend (add (mul cubed unit) (range1 twice)) in
    sub prec
      (join (summit n (add p0 r0) (add1 p1 r1) (add2 p2 r2) rest)
            (summit n (sub prec p0 r0) (add1 p1 (negate1 r1)) (add2 p2 (negate2 r2)) rest))
      (mul proper u)
  end.

Lemma hold_negate1 e l v : hold1 e l v -> hold1 e (negate1 l) (- v).
Proof.
  revert e v. induction l as [| a l IH]; intros e v H.
  - rewrite (hold1_none _ _ H), Ropp_0. apply hold1_nil.
  - destruct e as [| s e]; [easy |]. destruct H as (d & r & Hd & Hr & ->).
    exists (- d), (- r). split; [now apply cont_neg |]. split; [now apply IH | ring].
Qed.

Lemma hold_negate2 e q v : hold2 e q v -> hold2 e (negate2 q) (- v).
Proof.
  revert e v. induction q as [| a q IH]; intros e v H.
  - rewrite (hold2_none _ _ H), Ropp_0. apply hold2_nil.
  - destruct e as [| s e]; [easy |]. destruct H as (d & r & Hd & Hr & ->).
    exists (- d), (- r). split; [now apply hold_negate1 |]. split; [now apply IH | ring].
Qed.

Lemma split1 s e l v : hold1 (s :: e) l v ->
  exists a r, cont (head1 l) a /\ hold1 e (tl l) r /\ v = a * s + r.
Proof.
  destruct l as [| a l]; intros H; [| exact H].
  exists 0, 0. rewrite (hold1_none _ _ H). split; [exact cont_zero |].
  split; [apply hold1_nil | ring].
Qed.

Lemma split2 s e q v : hold2 (s :: e) q v ->
  exists a b w, cont (head1 (head2 q)) a /\ hold1 e (tl (head2 q)) b /\ hold2 e (tl q) w /\
                v = a * (s * s) + b * s + w.
Proof.
  intros H.
  assert (exists c r, hold1 (s :: e) (head2 q) c /\ hold2 e (tl q) r /\ v = c * s + r)
    as (c & w & Hc & Hw & ->).
  { destruct q as [| row q]; [| exact H].
    exists 0, 0. rewrite (hold2_none _ _ H). repeat split; [apply hold2_nil | ring]. }
  destruct (split1 _ _ _ _ Hc) as (a & b & Ha & Hb & ->).
  exists a, b, w. repeat split; auto. ring.
Qed.

(* The sum of e[i] times the value of row i, a linear form in all. *)
Fixpoint hold_rows (all e : list R) (rows : list form1) (v : R) : Prop :=
  match rows, e with
  | [], _ => v = 0
  | row :: rows, x :: e => exists c r, hold1 all row c /\ hold_rows all e rows r /\ v = c * x + r
  | _, [] => False
  end.

Lemma split_rows s all e rows v : hold_rows (s :: all) e rows v ->
  exists f g, hold1 e (map head1 rows) f /\ hold_rows all e (map (@tl I.type) rows) g /\
              v = f * s + g.
Proof.
  revert e v. induction rows as [| row rows IH]; intros e v H.
  - exists 0, 0. destruct e; simpl in *; rewrite H; repeat split; ring.
  - destruct e as [| x e]; [easy |]. destruct H as (c & r & Hc & Hr & ->).
    destruct (IH _ _ Hr) as (f & g & Hf & Hg & ->), (split1 _ _ _ _ Hc) as (a & b & Ha & Hb & ->).
    exists (a * x + f), (b * x + g). repeat split; [| | ring].
    + now exists a, f.
    + now exists b, g.
Qed.

Lemma hold_triangle n e rows v :
  (length rows <= n)%nat -> hold_rows e e rows v -> hold2 e (triangle n rows) v.
Proof.
  revert e rows v. induction n as [| n IH]; intros e [| row rows] v Hn H;
    try (destruct e; exact H); [simpl in Hn; lia |].
  destruct e as [| s e]; [easy |]. destruct H as (c & r & Hc & Hr & ->).
  destruct (split_rows _ _ _ _ _ Hr) as (f & g & Hf & Hg & ->).
  exists (c + f), g. repeat split; [| | ring].
  - apply hold_add1; [exact Hc |]. exists 0, f. repeat split; [exact cont_zero | exact Hf | ring].
  - apply IH; [rewrite map_length; exact (le_S_n _ _ Hn) | exact Hg].
Qed.

Lemma split3 s all e t v : hold3 (s :: all) e t v ->
  exists f g h, hold1 e (map (fun q => head1 (head2 q)) t) f /\
                hold_rows all e (map (fun q => tl (head2 q)) t) g /\
                hold3 all e (map (@tl form1) t) h /\ v = f * (s * s) + g * s + h.
Proof.
  revert e v. induction t as [| q t IH]; intros e v H.
  - exists 0, 0, 0. destruct e; simpl in *; rewrite H; repeat split; ring.
  - destruct e as [| x e]; [easy |]. destruct H as (c & r & Hc & Hr & ->).
    destruct (IH _ _ Hr) as (f & g & h & Hf & Hg & Hh & ->).
    destruct (split2 _ _ _ _ Hc) as (a & b & w & Ha & Hb & Hw & ->).
    exists (a * x + f), (b * x + g), (w * x + h). repeat split; [| | | ring].
    + now exists a, f.
    + now exists b, g.
    + now exists w, h.
Qed.

Lemma hold3_length all e t v : hold3 all e t v -> (length t <= length e)%nat.
Proof.
  revert e v. induction t as [| q t IH]; intros e v H; [simpl; lia |].
  destruct e as [| x e]; [easy |]. destruct H as (c & r & Hc & Hr & ->).
  exact (le_n_S _ _ (IH _ _ Hr)).
Qed.

Theorem cont_summit e c l q t w0 w1 w2 w3 : cube e -> cont c w0 -> hold1 e l w1 ->
  hold2 e q w2 -> hold3 e e t w3 -> cont (summit (length e) c l q t) (w0 + w1 + w2 + w3).
Proof.
  intros C. revert c l q t w0 w1 w2 w3.
  induction C as [| s e Hs C IH]; intros c l q t w0 w1 w2 w3 H0 H1 H2 H3.
  { destruct l, q, t; try easy. simpl in *. subst. now rewrite !Rplus_0_r. }
  assert (exists x r, hold2 (s :: e) (hd [] t) x /\ hold3 (s :: e) e (tl t) r /\ w3 = x * s + r)
    as (x & r & Hx & Hr & ->).
  { destruct t as [| t0 t]; [| exact H3].
    exists 0, 0. rewrite (hold3_none _ _ _ H3). repeat split; [apply hold3_nil | ring]. }
  pose proof (hold3_length _ _ _ _ Hr) as Length.
  destruct (split1 _ _ _ _ H1) as (l0 & l1 & Hl0 & Hl1 & ->).
  destruct (split2 _ _ _ _ H2) as (a & b & w & Ha & Hb & Hw & ->).
  destruct (split2 _ _ _ _ Hx) as (a' & b' & w' & Ha' & Hb' & Hw' & ->).
  destruct (split3 _ _ _ _ _ Hr) as (f & g & h & Hf & Hg & Hh & ->).
  apply (hold_triangle (length e)) in Hg; [| now rewrite map_length].
  set (p := w0 + a + (l1 + (f + b')) + w + h). set (r := l0 + a' + b + (w' + g)).
  set (u := a + (a' * s + (f + b'))).
  replace (w0 + _ + _ + _) with (p + s * r - (1 - s * s) * u) by (unfold p, r, u; ring).
  apply cont_sub; [| apply cont_mul; [apply proper_ok; nra |]].
  2:{ unfold u. repeat apply cont_add; auto.
      - apply cont_mul; auto.
      - apply (cont_range1 e); [exact C | now apply hold_add1]. }
  (* p + s r  is between  p - r  and  p + r. *)
  assert (Up : cont (summit (length e) _ _ _ _) (p + r)) by
    (replace (p + r) with ((w0 + a + (l0 + a')) + (l1 + (f + b') + b) + (w + (w' + g)) + h)
       by (unfold p, r; ring);
     apply IH; [apply cont_add; [apply cont_add | apply cont_add] | | | exact Hh];
     eauto using hold_add1, hold_add2).
  assert (Down : cont (summit (length e) _ _ _ _) (p - r)) by
    (replace (p - r) with ((w0 + a - (l0 + a')) + (l1 + (f + b') + - b) + (w + - (w' + g)) + h)
       by (unfold p, r; ring);
     apply IH; [apply cont_sub; [apply cont_add | apply cont_add] | | | exact Hh];
     eauto using hold_add1, hold_add2, hold_negate1, hold_negate2).
  assert (B : p - r <= p + s * r <= p + r \/ p + r <= p + s * r <= p - r)
    by (destruct (Rle_dec 0 r); [left | right]; nra).
  destruct B as [B | B];
    eapply cont_convex; [| | exact B | | | exact B]; apply cont_join; eauto.
Qed.

End Precision.
End Forms.
