(* Intervals, and the relation "this interval holds this number" by which all else is proved: the
   operations of the library Interval, for any of its formats of floating-point numbers. *)

From Coq Require Import Reals ZArith QArith Qreals List Lra.
From Interval.Real Require Import Xreal.
From Interval.Float Require Import Basic Sig.
From Interval.Interval Require Import Interval Float Float_full.
Open Scope R_scope.

Module Numbers (F : FloatOps with Definition radix := Zaux.radix2
                             with Definition sensible_format := true).

Module I := FloatIntervalFull F.

Definition cont (i : I.type) (x : R) : Prop := contains (I.convert i) (Xreal x).

Section Precision.
Variable prec : F.precision.

Definition add := I.add prec.
Definition sub := I.sub prec.
Definition mul := I.mul prec.
Definition div := I.div prec.
Definition sqr := I.sqr prec.
Definition sqrt := I.sqrt prec.
Definition neg := I.neg.
Definition join := I.join.
Definition integer := I.fromZ prec.                         (* any size *)
Definition rational (q : Q) : I.type := div (integer (Qnum q)) (integer (Zpos (Qden q))).
Definition pi := I.pi prec.
Definition half (i : I.type) : I.type := div i (integer 2).
(* Of one float; NaN is the whole line. *)
Definition exactly (x : F.type) : I.type := if F.real x then I.bnd x x else I.nai.

Lemma cont_add i j x y : cont i x -> cont j y -> cont (add i j) (x + y).
Proof. exact (I.add_correct prec i j (Xreal x) (Xreal y)). Qed.
Lemma cont_sub i j x y : cont i x -> cont j y -> cont (sub i j) (x - y).
Proof. exact (I.sub_correct prec i j (Xreal x) (Xreal y)). Qed.
Lemma cont_mul i j x y : cont i x -> cont j y -> cont (mul i j) (x * y).
Proof. exact (I.mul_correct prec i j (Xreal x) (Xreal y)). Qed.
Lemma cont_neg i x : cont i x -> cont (neg i) (- x).
Proof. exact (I.neg_correct i (Xreal x)). Qed.
Lemma cont_sqr i x : cont i x -> cont (sqr i) (x * x).
Proof. exact (I.sqr_correct prec i (Xreal x)). Qed.
Lemma cont_join i j x : cont i x \/ cont j x -> cont (join i j) x.
Proof. exact (I.join_correct i j (Xreal x)). Qed.
Lemma cont_integer n : cont (integer n) (IZR n).
Proof. apply I.fromZ_correct. Qed.
Lemma cont_abs i x : cont i x -> cont (I.abs i) (Rabs x).
Proof. exact (I.abs_correct i (Xreal x)). Qed.
Lemma cont_zero : cont I.zero 0.
Proof. unfold cont. rewrite I.zero_correct. simpl. lra. Qed.
Lemma cont_pi : cont pi PI.
Proof. apply I.pi_correct. Qed.

Lemma cont_div i j x y : y <> 0 -> cont i x -> cont j y -> cont (div i j) (x / y).
Proof.
  intros Hy Hx Hj. pose proof (I.div_correct prec i j (Xreal x) (Xreal y) Hx Hj) as H.
  unfold cont. simpl in H. unfold Xdiv' in H. now rewrite (is_zero_false y Hy) in H.
Qed.

Lemma cont_half i x : cont i x -> cont (half i) (x / 2).
Proof. intros H. apply cont_div; [lra | exact H | apply cont_integer]. Qed.

Lemma cont_rational q : cont (rational q) (Q2R q).
Proof.
  unfold Q2R, rational. apply cont_div; try apply cont_integer.
  apply not_0_IZR. discriminate.
Qed.

Lemma cont_nai x : cont I.nai x.
Proof. unfold cont. now rewrite I.nai_correct. Qed.

(* Any float is some number, if only to name one. *)
Definition number (x : F.type) : R := F.toR x.

Lemma cont_exactly x : cont (exactly x) (number x).
Proof.
  unfold exactly. destruct (F.real x) eqn:H; [| apply cont_nai].
  unfold cont. rewrite F.real_correct in H.
  assert (B : F.valid_lb x = true /\ F.valid_ub x = true).
  { rewrite F.valid_lb_correct, F.valid_ub_correct.
    assert (H' : F.real x = true) by now rewrite F.real_correct.
    rewrite F.classify_correct in H'. destruct (F.classify x); easy. }
  rewrite I.bnd_correct by apply B. unfold number, F.toR, I.F.toX in *.
  change (I.F.toF x) with (F.toF x). destruct (FtoX (F.toF x)); [discriminate |].
  simpl. lra.
Qed.

(* Does the interval lie below zero? *)
Definition negative (i : I.type) : bool :=
  match I.sign_strict i with Xlt => true | _ => false end.

Lemma negative_correct i x : negative i = true -> cont i x -> x < 0.
Proof.
  unfold negative, cont. intros H C. pose proof (I.sign_strict_correct i) as S.
  destruct (I.sign_strict i); try discriminate. now destruct (S (Xreal x) C).
Qed.

(* Does it lie above zero, or at least touch it from there? *)
Definition non_negative (i : I.type) : bool :=
  match I.sign_large i with Xgt | Xeq => true | _ => false end.

Lemma non_negative_correct i x : non_negative i = true -> cont i x -> 0 <= x.
Proof.
  unfold non_negative, cont. intros H C. pose proof (I.sign_large_correct i) as S.
  destruct (I.sign_large i); try discriminate; specialize (S (Xreal x) C).
  - injection S as ->. apply Rle_refl.
  - apply S.
Qed.

(* What lies between two numbers of an interval lies in it, too. *)
Lemma cont_between i x y z : cont i x -> cont i z -> x <= y <= z -> cont i y.
Proof. intros Hx Hz H. exact (contains_connected (I.convert i) x z Hx Hz y H). Qed.

(* The interval from one number to another. *)
Lemma cont_range i j x y z : cont i x -> cont j z -> x <= y <= z -> cont (join i j) y.
Proof.
  intros Hx Hz. apply cont_between; apply cont_join; [left | right]; assumption.
Qed.

(* From -1 to 1. *)
Definition unit_ : I.type := join (integer (-1)) (integer 1).
End Precision.

End Numbers.
