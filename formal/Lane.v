(* One half of a prism's orbits, followed site by site to second order in the symbols e: at a site an
   orbit is at D = L e + T(e) + c + r from a centre, with columns L, a quadratic form T, a number c,
   and r known to an interval.  docs/proofs/checker.md, steps C4 to C6, in interval arithmetic.

   What is computed here on floats alone (the next centre, L, T and c, the matrices d and M) is chosen,
   not proved: whatever these floats are, the intervals hold. *)

From Coq Require Import Reals ZArith List Lra Lia.
From Interval.Real Require Import Xreal.
From Interval.Float Require Import Basic Sig.
From Interval.Interval Require Import Interval.
From Converse Require Import Map Trig Window Forms.
Import ListNotations.
Open Scope R_scope.

Lemma sum_ext {A} (f g : A -> R) l : (forall a, In a l -> f a = g a) -> sum f l = sum g l.
Proof.
  induction l as [| a l IH]; intros H; [easy |]. simpl.
  rewrite (H a) by now left. rewrite IH; [easy |]. intros b Hb. apply H. now right.
Qed.

Lemma sum_plus {A} (f g : A -> R) l : sum f l + sum g l = sum (fun a => f a + g a) l.
Proof. induction l as [| a l IH]; simpl; [ring | rewrite <- IH; ring]. Qed.

Lemma sum_scale {A} c (f : A -> R) l : c * sum f l = sum (fun a => c * f a) l.
Proof. induction l as [| a l IH]; simpl; [ring | rewrite <- IH; ring]. Qed.

Lemma sum_map {A B} (f : B -> R) (g : A -> B) l : sum f (map g l) = sum (fun a => f (g a)) l.
Proof. induction l as [| a l IH]; simpl; [easy | now rewrite IH]. Qed.

(* A wave of the true potential: its amplitude is the middle one and what the parameters add. *)
Record moving := Moving { its : wave; mid_amp : R; more_amp : R }.

Definition entire (a : moving) : Prop := amplitude (its a) = mid_amp a + more_amp a.

Module Lane (F : FloatOps with Definition radix := Zaux.radix2
                          with Definition sensible_format := true).
Include Forms F.

(* ---- waves and constants as intervals *)

Record pwave := PWave {
  z0 : Z; z1 : Z;                           (* k *)
  i0 : I.type; i1 : I.type;                 (* the same *)
  turns : I.type;                           (* the phase *)
  amp : I.type;                             (* of the middle *)
  move : form1                             (* what the parameters add *)
}.

Definition held (e : list R) (i : pwave) (a : moving) : Prop :=
  z0 i = k0 (its a) /\ z1 i = k1 (its a) /\
  cont (i0 i) (IZR (k0 (its a))) /\ cont (i1 i) (IZR (k1 (its a))) /\
  cont (turns i) (phase (its a) / (2 * PI)) /\
  cont (amp i) (mid_amp a) /\ hold1 e (move i) (more_amp a).

(* Intervals that begin or end at these numbers. *)
Record limits := Limits {
  unit : I.type;                            (* -1 to 1 *)
  upto1 : I.type; upto2 : I.type; upto6 : I.type;   (* 0 to 1, to 1/2, to 1/6, *)
  upto24 : I.type; upto120 : I.type;        (* to 1/24, to 1/120 *)
  ihalf : I.type; isixth : I.type; ione : I.type; itwo : I.type; itwo_pi : I.type;
  per_turn : F.type; fone : F.type; fhalf : F.type  (* about 1/(2 pi), 1, 1/2 *)
}.

Definition limits_ok (k : limits) : Prop :=
  (forall x, -1 <= x <= 1 -> cont (unit k) x) /\ (forall x, 0 <= x <= 1 -> cont (upto1 k) x) /\
  (forall x, 0 <= x <= / 2 -> cont (upto2 k) x) /\ (forall x, 0 <= x <= / 6 -> cont (upto6 k) x) /\
  (forall x, 0 <= x <= / 24 -> cont (upto24 k) x) /\
  (forall x, 0 <= x <= / 120 -> cont (upto120 k) x) /\
  cont (ihalf k) (/ 2) /\ cont (isixth k) (/ 6) /\ cont (ione k) 1 /\ cont (itwo k) 2 /\
  cont (itwo_pi k) (2 * PI).

Section Precision.
Variable prec : F.precision.
Notation add := (add prec).
Notation sub := (sub prec).
Notation mul := (mul prec).
Notation sqr := (sqr prec).
Notation add1 := (add1 prec).
Notation add2 := (add2 prec).
Notation add3 := (add3 prec).
Notation scale1 := (scale1 prec).
Notation scale2 := (scale2 prec).
Notation product := (product prec).
Notation product3 := (product3 prec).
Notation square := (square prec).

Variable K : limits.
Hypothesis K_ok : limits_ok K.
Notation range1 := (range1 prec (unit K)).
Notation range2 := (range2 prec (unit K) (upto1 K)).

(* Sine and cosine of an angle in turns. *)
Variable sincos : I.type -> I.type * I.type.
Hypothesis sincos_ok : forall tau x, cont tau x ->
  cont (fst (sincos tau)) (sin (2 * PI * x)) /\ cont (snd (sincos tau)) (cos (2 * PI * x)).

Lemma cont_range1' e l v : cube e -> hold1 e l v -> cont (range1 l) v.
Proof. apply cont_range1. apply K_ok. Qed.

Lemma cont_range2' e q v : cube e -> hold2 e q v -> cont (range2 q) v.
Proof. apply cont_range2; apply K_ok. Qed.

(* ---- sums over the waves *)

(* An integer k times x, ik being an interval for k. *)
Definition times (k : Z) (ik x : I.type) : I.type :=
  match k with 0%Z => I.zero | 1%Z => x | (-1)%Z => neg x | _ => mul ik x end.

Definition times1 (k : Z) (ik : I.type) (l : form1) : form1 :=
  match k with 0%Z => [] | 1%Z => l | (-1)%Z => negate1 l | _ => scale1 ik l end.

Definition times2 (k : Z) (ik : I.type) (q : form2) : form2 :=
  match k with 0%Z => [] | 1%Z => q | (-1)%Z => negate2 q | _ => scale2 ik q end.

Lemma cont_times k ik x v : cont ik (IZR k) -> cont x v -> cont (times k ik x) (IZR k * v).
Proof.
  intros Hk Hx. unfold times. destruct k as [| [p | p |] | [p | p |]];
    try now apply cont_mul.
  - rewrite Rmult_0_l. exact cont_zero.
  - now rewrite Rmult_1_l.
  - replace (-1 * v) with (- v) by ring. now apply cont_neg.
Qed.

Lemma hold_times1 e k ik l v : cont ik (IZR k) -> hold1 e l v -> hold1 e (times1 k ik l) (IZR k * v).
Proof.
  intros Hk Hx. unfold times1. destruct k as [| [p | p |] | [p | p |]];
    try now apply hold_scale1.
  - rewrite Rmult_0_l. apply hold1_nil.
  - now rewrite Rmult_1_l.
  - replace (-1 * v) with (- v) by ring. now apply hold_negate1.
Qed.

Lemma hold_times2 e k ik q v : cont ik (IZR k) -> hold2 e q v -> hold2 e (times2 k ik q) (IZR k * v).
Proof.
  intros Hk Hx. unfold times2. destruct k as [| [p | p |] | [p | p |]];
    try now apply hold_scale2.
  - rewrite Rmult_0_l. apply hold2_nil.
  - now rewrite Rmult_1_l.
  - replace (-1 * v) with (- v) by ring. now apply hold_negate2.
Qed.

(* k.x *)
Definition dir (w : pwave) (x : I.type * I.type) : I.type :=
  add (times (z0 w) (i0 w) (fst x)) (times (z1 w) (i1 w) (snd x)).
Definition dir1 (w : pwave) (x : form1 * form1) : form1 :=
  add1 (times1 (z0 w) (i0 w) (fst x)) (times1 (z1 w) (i1 w) (snd x)).
Definition dir2 (w : pwave) (x : form2 * form2) : form2 :=
  add2 (times2 (z0 w) (i0 w) (fst x)) (times2 (z1 w) (i1 w) (snd x)).

Definition cont_vec (i : I.type * I.type) (v : vec) : Prop :=
  cont (fst i) (fst v) /\ cont (snd i) (snd v).
Definition hold_vec e (l : form1 * form1) (v : vec) : Prop :=
  hold1 e (fst l) (fst v) /\ hold1 e (snd l) (snd v).
Definition hold_quads e (q : form2 * form2) (v : vec) : Prop :=
  hold2 e (fst q) (fst v) /\ hold2 e (snd q) (snd v).

Lemma cont_dir e i a x v : held e i a -> cont_vec x v -> cont (dir i x) (along (its a) v).
Proof.
  intros (E0 & E1 & H0 & H1 & _) (Hx & Hy). unfold dir, along. rewrite E0, E1.
  apply cont_add; now apply cont_times.
Qed.

Lemma hold_dir1 e i a x v : held e i a -> hold_vec e x v -> hold1 e (dir1 i x) (along (its a) v).
Proof.
  intros (E0 & E1 & H0 & H1 & _) (Hx & Hy). unfold dir1, along. rewrite E0, E1.
  apply hold_add1; now apply hold_times1.
Qed.

Lemma hold_dir2 e i a x v : held e i a -> hold_quads e x v -> hold2 e (dir2 i x) (along (its a) v).
Proof.
  intros (E0 & E1 & H0 & H1 & _) (Hx & Hy). unfold dir2, along. rewrite E0, E1.
  apply hold_add2; now apply hold_times2.
Qed.

(* What a wave is at a site: y = 2 pi X + D, D = L e + T(e) + c + r. *)
Record seen := Seen {
  of : pwave;
  sn : I.type; cs : I.type;                 (* sine and cosine at X *)
  ps : I.type; pc : I.type;                 (* the middle amplitude times these *)
  xi : form1; size : I.type;               (* k.L e and its range, *)
  sq : form2;                               (* its square *)
  tau : form2;                              (* k.T *)
  off : I.type;                             (* k.(T(e) + c + r) *)
  z : I.type                                (* k.D *)
}.

(* l = L e, q = T(e), w = T(e) + c + r. *)
Definition sees (e : list R) (Y l q w : vec) (s : seen) (a : moving) : Prop :=
  entire a /\ held e (of s) a /\
  cont (sn s) (sin (angle (its a) Y)) /\ cont (cs s) (cos (angle (its a) Y)) /\
  cont (ps s) (mid_amp a * sin (angle (its a) Y)) /\
  cont (pc s) (mid_amp a * cos (angle (its a) Y)) /\
  hold1 e (xi s) (along (its a) l) /\ hold2 e (sq s) (along (its a) l * along (its a) l) /\
  hold2 e (tau s) (along (its a) q) /\ cont (size s) (along (its a) l) /\
  cont (off s) (along (its a) w) /\ cont (z s) (along (its a) l + along (its a) w).

(* r holds c + r. *)
Definition look (X : I.type * I.type) (L : form1 * form1) (T : form2 * form2) (r : I.type * I.type)
    (w : pwave) : seen :=
  let '(s, c) := sincos (add (dir w X) (turns w)) in
  let xi := dir1 w L in
  let size := range1 xi in
  let tau := dir2 w T in
  let off := add (range2 tau) (dir w r) in
  Seen w s c (mul (amp w) s) (mul (amp w) c) xi size (square xi) tau off (add size off).

(* Y is X turns, but for whole turns. *)
Definition near (X Y : vec) : Prop :=
  exists i j : Z, Y = (2 * PI * (fst X + IZR i), 2 * PI * (snd X + IZR j)).

Lemma angle_near w X Y : near X Y -> exists n : Z,
  angle w Y = 2 * PI * (along w X + phase w / (2 * PI)) + 2 * PI * IZR n.
Proof.
  intros (i & j & ->). exists (k0 w * i + k1 w * j)%Z.
  unfold angle, along. simpl. rewrite plus_IZR, !mult_IZR. field.
  generalize PI_neq0. lra.
Qed.

Lemma sin_whole x (n : Z) : sin (x + 2 * PI * IZR n) = sin x.
Proof.
  destruct (Z_le_dec 0 n) as [H | H].
  - rewrite <- (Z2Nat.id n H), <- INR_IZR_INZ.
    replace (2 * PI * INR (Z.to_nat n)) with (2 * INR (Z.to_nat n) * PI) by ring.
    apply sin_period.
  - rewrite <- (sin_period (x + 2 * PI * IZR n) (Z.to_nat (- n))).
    f_equal. rewrite INR_IZR_INZ, Z2Nat.id by lia. rewrite opp_IZR. ring.
Qed.

Lemma cos_whole x (n : Z) : cos (x + 2 * PI * IZR n) = cos x.
Proof.
  rewrite <- !sin_shift. replace (PI / 2 - (x + 2 * PI * IZR n))
    with (PI / 2 - x + 2 * PI * IZR (- n)) by (rewrite opp_IZR; ring).
  apply sin_whole.
Qed.

Lemma along_plus w u v : along w (plus u v) = along w u + along w v.
Proof. unfold along, plus. simpl. ring. Qed.

Lemma look_sees e X Xi Y L l T q r ri w a : cube e -> entire a -> held e w a -> cont_vec Xi X ->
  near X Y -> hold_vec e L l -> hold_quads e T q -> cont_vec ri r ->
  sees e Y l q (plus q r) (look Xi L T ri w) a.
Proof.
  intros C Ha Hw HX HY HL HT Hr. unfold look.
  destruct (angle_near (its a) X Y HY) as (n & E).
  pose proof Hw as (_ & _ & _ & _ & Hphase & Hamp & _).
  destruct (sincos_ok (add (dir w Xi) (turns w)) (along (its a) X + phase (its a) / (2 * PI)))
    as (Hs & Hc). { apply cont_add; [now apply (cont_dir e) | exact Hphase]. }
  destruct (sincos _) as (s, c). simpl in Hs, Hc.
  rewrite <- (sin_whole _ n), <- E in Hs. rewrite <- (cos_whole _ n), <- E in Hc.
  assert (Hxi := hold_dir1 e w a L l Hw HL). assert (Hsq := hold_square prec e _ _ Hxi).
  assert (Htau := hold_dir2 e w a T q Hw HT).
  assert (Hoff := cont_add prec _ _ _ _ (cont_range2' e _ _ C Htau) (cont_dir e w a ri r Hw Hr)).
  rewrite <- along_plus in Hoff. assert (Hsize := cont_range1' e _ _ C Hxi).
  repeat split; simpl; auto using cont_mul, cont_add.
  all: try apply Hw.
Qed.

(* The sum of k0 f, or k1 f, over the waves. *)
Section Gather.
Context {A : Type} (zero : A) (plus : A -> A -> A) (minus : A -> A) (by_ : I.type -> A -> A).
Definition gather (k : pwave -> Z) (ik : pwave -> I.type) (f : seen -> A) : list seen -> A :=
  fold_right (fun s rest => match k (of s) with
    | 0%Z => rest | 1%Z => plus (f s) rest | (-1)%Z => plus (minus (f s)) rest
    | _ => plus (by_ (ik (of s)) (f s)) rest end) zero.

Variable holds : A -> R -> Prop.
Hypothesis zero_ok : holds zero 0.
Hypothesis plus_ok : forall a b x y, holds a x -> holds b y -> holds (plus a b) (x + y).
Hypothesis minus_ok : forall a x, holds a x -> holds (minus a) (- x).
Hypothesis by_ok : forall c a x y, cont c x -> holds a y -> holds (by_ c a) (x * y).

Lemma gather_step k ik f s ss kz g G : k (of s) = kz -> cont (ik (of s)) (IZR kz) ->
  holds (f s) g -> holds (gather k ik f ss) G -> holds (gather k ik f (s :: ss)) (IZR kz * g + G).
Proof.
  intros Ek Hik Hf IH. simpl. rewrite Ek.
  destruct kz as [| [p | p |] | [p | p |]]; try (apply plus_ok; auto; now apply by_ok).
  - now rewrite Rmult_0_l, Rplus_0_l.
  - rewrite Rmult_1_l. now apply plus_ok.
  - replace (-1 * g) with (- g) by ring. apply plus_ok; auto.
Qed.

Lemma gather_ok k ik (kr : wave -> Z) (P : seen -> moving -> Prop) f g ss ws :
  (forall s a, P s a -> k (of s) = kr (its a) /\ cont (ik (of s)) (IZR (kr (its a)))) ->
  (forall s a, P s a -> holds (f s) (g a)) -> Forall2 P ss ws ->
  holds (gather k ik f ss) (sum (fun a => IZR (kr (its a)) * g a) ws).
Proof.
  intros Hk Hf. induction 1 as [| s a ss ws H HH IH]; [exact zero_ok |].
  destruct (Hk s a H). apply gather_step; auto.
Qed.

Definition total (f : seen -> A) : list seen -> A :=
  fold_right (fun s rest => plus (f s) rest) zero.

End Gather.

Notation gather0 := (gather I.zero add neg mul z0 i0).
Notation gather1 := (gather I.zero add neg mul z1 i1).
Notation gather_lin0 := (gather [] add1 negate1 scale1 z0 i0).
Notation gather_lin1 := (gather [] add1 negate1 scale1 z1 i1).
Notation gather_quad0 := (gather [] add2 negate2 scale2 z0 i0).
Notation gather_quad1 := (gather [] add2 negate2 scale2 z1 i1).

Definition k0_ok e Y l q r s a : sees e Y l q r s a ->
  z0 (of s) = k0 (its a) /\ cont (i0 (of s)) (IZR (k0 (its a))).
Proof. intros (_ & (E & _ & H & _) & _). now split. Qed.
Definition k1_ok e Y l q r s a : sees e Y l q r s a ->
  z1 (of s) = k1 (its a) /\ cont (i1 (of s)) (IZR (k1 (its a))).
Proof. intros (_ & (_ & E & _ & H & _) & _). now split. Qed.

Lemma gather0_ok e Y l q r f g ss ws : (forall s a, sees e Y l q r s a -> cont (f s) (g a)) ->
  Forall2 (sees e Y l q r) ss ws ->
  cont (gather0 f ss) (sum (fun a => IZR (k0 (its a)) * g a) ws).
Proof.
  intros Hf HH. apply (gather_ok _ _ _ _ cont cont_zero (cont_add prec) cont_neg (cont_mul prec) _ _ k0 (sees e Y l q r)); auto.
  exact (k0_ok e Y l q r).
Qed.
Lemma gather1_ok e Y l q r f g ss ws : (forall s a, sees e Y l q r s a -> cont (f s) (g a)) ->
  Forall2 (sees e Y l q r) ss ws ->
  cont (gather1 f ss) (sum (fun a => IZR (k1 (its a)) * g a) ws).
Proof.
  intros Hf HH. apply (gather_ok _ _ _ _ cont cont_zero (cont_add prec) cont_neg (cont_mul prec) _ _ k1 (sees e Y l q r)); auto.
  exact (k1_ok e Y l q r).
Qed.
Lemma gather_lin0_ok e Y l q r f g ss ws : (forall s a, sees e Y l q r s a -> hold1 e (f s) (g a)) ->
  Forall2 (sees e Y l q r) ss ws ->
  hold1 e (gather_lin0 f ss) (sum (fun a => IZR (k0 (its a)) * g a) ws).
Proof.
  intros Hf HH. apply (gather_ok _ _ _ _ (hold1 e) (hold1_nil e) (hold_add1 prec e)
    (hold_negate1 e) (fun c a x y => hold_scale1 prec e c x a y) _ _ k0 (sees e Y l q r)); auto.
  exact (k0_ok e Y l q r).
Qed.
Lemma gather_lin1_ok e Y l q r f g ss ws : (forall s a, sees e Y l q r s a -> hold1 e (f s) (g a)) ->
  Forall2 (sees e Y l q r) ss ws ->
  hold1 e (gather_lin1 f ss) (sum (fun a => IZR (k1 (its a)) * g a) ws).
Proof.
  intros Hf HH. apply (gather_ok _ _ _ _ (hold1 e) (hold1_nil e) (hold_add1 prec e)
    (hold_negate1 e) (fun c a x y => hold_scale1 prec e c x a y) _ _ k1 (sees e Y l q r)); auto.
  exact (k1_ok e Y l q r).
Qed.
Lemma gather_quad0_ok e Y l q r f g ss ws : (forall s a, sees e Y l q r s a -> hold2 e (f s) (g a)) ->
  Forall2 (sees e Y l q r) ss ws ->
  hold2 e (gather_quad0 f ss) (sum (fun a => IZR (k0 (its a)) * g a) ws).
Proof.
  intros Hf HH. apply (gather_ok _ _ _ _ (hold2 e) (hold2_nil e) (hold_add2 prec e)
    (hold_negate2 e) (fun c a x y => hold_scale2 prec e c x a y) _ _ k0 (sees e Y l q r)); auto.
  exact (k0_ok e Y l q r).
Qed.
Lemma gather_quad1_ok e Y l q r f g ss ws : (forall s a, sees e Y l q r s a -> hold2 e (f s) (g a)) ->
  Forall2 (sees e Y l q r) ss ws ->
  hold2 e (gather_quad1 f ss) (sum (fun a => IZR (k1 (its a)) * g a) ws).
Proof.
  intros Hf HH. apply (gather_ok _ _ _ _ (hold2 e) (hold2_nil e) (hold_add2 prec e)
    (hold_negate2 e) (fun c a x y => hold_scale2 prec e c x a y) _ _ k1 (sees e Y l q r)); auto.
  exact (k1_ok e Y l q r).
Qed.

(* ---- the next site *)

Definition plane := (F.type * F.type)%type.
Definition symmetric := (F.type * F.type * F.type)%type.        (* entries 00, 01, 11 *)

Definition real_of (p : plane) : vec := (number (fst p), number (snd p)).
Definition exact2 (p : plane) : I.type * I.type := (exactly (fst p), exactly (snd p)).

Lemma cont_exact2 p : cont_vec (exact2 p) (real_of p).
Proof. split; apply cont_exactly. Qed.

Record state := State {
  before : plane; here : plane;                     (* centres, in turns *)
  columns0 : form1 * form1; columns : form1 * form1;
  quads0 : form2 * form2; quads : form2 * form2;
  mean0 : plane; mean : plane;                      (* c *)
  rest0 : I.type * I.type; rest : I.type * I.type;
  force : I.type * I.type;                          (* what rest is more than d rest0 *)
  d : symmetric; M : symmetric                      (* M is about the inverse of d *)
}.

Record site := Site {
  view : list seen;
  err : I.type * I.type;                            (* E, by which the centre is no orbit *)
  beyond : I.type * I.type;                         (* the next D *)
  block : I.type * I.type * I.type                  (* beta at the centre: 00, 01, 11 *)
}.

Definition center (i : I.type) : F.type := I.midpoint i.
Definition centers (l : form1) : form1 := map (fun i => exactly (center i)) l.
Definition centers2 (q : form2) : form2 := map centers q.
Definition fadd := F.add_UP prec.
Definition fsub := F.sub_UP prec.
Definition fmul := F.mul_UP prec.
Definition fdiv := F.div_UP prec.

Definition inverted (m : symmetric) : symmetric :=
  let '(p, q, r) := m in
  let det := fsub (fmul p r) (fmul q q) in
  (fdiv r det, fdiv (F.neg q) det, fdiv p det).

(* x less n, the result between -1/2 and 1/2 if fuel lasts. *)
Fixpoint wrap (fuel : nat) (x : F.type) (n : Z) : F.type * Z :=
  match fuel with
  | O => (x, n)
  | S fuel =>
    match F.cmp x (fhalf K) with
    | Xgt => wrap fuel (fsub x (fone K)) (n + 1)
    | _ => match F.cmp x (F.neg (fhalf K)) with
           | Xlt => wrap fuel (fadd x (fone K)) (n - 1)
           | _ => (x, n)
           end
    end
  end.

(* cos z - 1, sin z - z and cos z - 1 + z^2/2 *)
Definition less2 (s : seen) : I.type := neg (mul (upto2 K) (sqr (z s))).
Definition less3 (s : seen) : I.type := neg (mul (upto6 K) (mul (z s) (sqr (z s)))).
Definition less4 (s : seen) : I.type := mul (upto24 K) (sqr (sqr (z s))).

Lemma cont_less2 s x : cont (z s) x -> cont (less2 s) (cos x - 1).
Proof.
  intros H. destruct (cos2 x) as (kappa & B & E).
  replace (cos x - 1) with (- (kappa * (x * x))) by lra.
  apply cont_neg, cont_mul; [now apply K_ok | now apply cont_sqr].
Qed.

Lemma cont_less3 s x : cont (z s) x -> cont (less3 s) (sin x - x).
Proof.
  intros H. destruct (sin3 x) as (kappa & B & E).
  replace (sin x - x) with (- (kappa * (x * (x * x)))) by lra.
  apply cont_neg, cont_mul; [now apply K_ok |]. apply cont_mul; [exact H | now apply cont_sqr].
Qed.

Lemma cont_less4 s x : cont (z s) x -> cont (less4 s) (cos x - 1 + x * x / 2).
Proof.
  intros H. destruct (cos4 x) as (kappa & B & E).
  replace (cos x - 1 + x * x / 2) with (kappa * ((x * x) * (x * x))) by lra.
  apply cont_mul; [now apply K_ok | now apply cont_sqr, cont_sqr].
Qed.

(* What a wave's force is, less its value at X, less what is linear in D and in the parameters, less
   what is of second order in the symbols; with xi = k.l, w = z - xi.  Note that
   cos z - 1 + xi^2/2  is  cos z - 1 + z^2/2  less  w (z + xi)/2. *)
Definition bent (s : seen) : I.type :=
  let s3 := less3 s in
  let far := sub (less4 s) (mul (mul (ihalf K) (off s)) (add (z s) (size s))) in
  add (sub (mul (pc s) far) (mul (ps s) s3))
      (mul (range1 (move (of s))) (sub (mul (cs s) (less2 s)) (mul (sn s) (add (off s) s3)))).

Definition bent_real (Y l w : vec) (a : moving) : R :=
  let theta := angle (its a) Y in
  let xi := along (its a) l in let z := xi + along (its a) w in
  mid_amp a * cos theta * (cos z - 1 + z * z / 2 - / 2 * along (its a) w * (z + xi))
  - mid_amp a * sin theta * (sin z - z)
  + more_amp a * (cos theta * (cos z - 1) - sin theta * (along (its a) w + (sin z - z))).

Lemma angle_plus w u v : angle w (plus u v) = angle w u + along w v.
Proof. unfold angle. rewrite along_plus. ring. Qed.

Lemma cont_bent e Y l q w s a : cube e -> sees e Y l q w s a -> cont (bent s) (bent_real Y l w a).
Proof.
  intros C (Ha & Hw & Hsn & Hcs & Hps & Hpc & Hxi & Hsq & Htau & Hsize & Hoff & Hz).
  assert (H2 := cont_less2 _ _ Hz). assert (H3 := cont_less3 _ _ Hz).
  assert (H4 := cont_less4 _ _ Hz).
  assert (Hm : cont (range1 (move (of s))) (more_amp a))
    by (apply (cont_range1' e); [exact C | apply Hw]).
  assert (Hh : cont (ihalf K) (/ 2)) by apply K_ok.
  unfold bent, bent_real. auto 12 using cont_add, cont_sub, cont_mul.
Qed.

(* What of a wave's force is linear in l and in the parameters. *)
Definition slope_real (Y l : vec) (a : moving) : R :=
  - (mid_amp a * sin (angle (its a) Y) * along (its a) l) + more_amp a * cos (angle (its a) Y).

(* What of it is of second order in the symbols. *)
Definition curve_real (Y l q : vec) (a : moving) : R :=
  let theta := angle (its a) Y in let xi := along (its a) l in
  - (/ 2 * (mid_amp a * cos theta) * (xi * xi) + (sin theta * more_amp a * xi
     + mid_amp a * sin theta * along (its a) q)).

Lemma force_expanded Y l q r a : entire a ->
  amplitude (its a) * cos (angle (its a) (plus Y (plus l (plus q r)))) =
  mid_amp a * cos (angle (its a) Y) + slope_real Y l a + curve_real Y l q a
  - mid_amp a * sin (angle (its a) Y) * along (its a) r + bent_real Y l (plus q r) a.
Proof.
  intros Ha. rewrite angle_plus, along_plus, cos_plus, Ha.
  unfold slope_real, curve_real, bent_real. rewrite along_plus. field.
Qed.

Definition slope (s : seen) : form1 :=
  add1 (negate1 (scale1 (ps s) (xi s))) (scale1 (cs s) (move (of s))).

Definition curve (s : seen) : form2 :=
  negate2 (add2 (scale2 (mul (ihalf K) (pc s)) (sq s))
                (add2 (product (scale1 (sn s) (move (of s))) (xi s)) (scale2 (ps s) (tau s)))).

Lemma hold_slope e Y l q w s a : sees e Y l q w s a -> hold1 e (slope s) (slope_real Y l a).
Proof.
  intros (Ha & Hw & Hsn & Hcs & Hps & Hpc & Hxi & _).
  unfold slope, slope_real. apply hold_add1.
  - now apply hold_negate1, hold_scale1.
  - rewrite Rmult_comm. apply hold_scale1; [exact Hcs | apply Hw].
Qed.

Lemma hold_curve e Y l q w s a : sees e Y l q w s a -> hold2 e (curve s) (curve_real Y l q a).
Proof.
  intros (Ha & Hw & Hsn & Hcs & Hps & Hpc & Hxi & Hsq & Htau & _).
  apply hold_negate2, hold_add2; [| apply hold_add2].
  - apply hold_scale2; [| exact Hsq]. apply cont_mul; [apply K_ok | exact Hpc].
  - apply hold_product; [| exact Hxi]. apply hold_scale1; [exact Hsn | apply Hw].
  - now apply hold_scale2.
Qed.

(* One coordinate of the next site: its centre, E, its columns, T and c, and all that r obeys besides. *)
Record axis := Axis {
  T : F.type; E : I.type; next_l : form1; next_q : form2; next_c : F.type; source : I.type
}.

(* carried: what beta makes of c, less the c before. *)
Definition ahead (sum0 : (seen -> I.type) -> I.type) (sum1 : (seen -> form1) -> form1)
    (sum2 : (seen -> form2) -> form2) (X O : F.type) (L P : form1) (Q N : form2) (carried : I.type) :
    axis :=
  let bends := sum0 bent in
  let raw := add (mul (itwo_pi K) (sub (add (exactly X) (exactly X)) (exactly O))) (sum0 pc) in
  let col := add1 (add1 L L) (add1 (negate1 P) (sum1 slope)) in
  let l := centers col in
  let quad := add2 (add2 Q Q) (add2 (negate2 N) (sum2 curve)) in
  let q := centers2 quad in
  (* c + T(e) is as often below zero as above *)
  let c := F.neg (center (range2 q)) in
  let more := sub (add bends carried) (exactly c) in
  (* the centre is where the enclosure's middle is *)
  let '(t, n) := wrap 64 (fmul (center (add raw more)) (per_turn K)) 0 in
  let E := sub raw (mul (itwo_pi K) (add (exactly t) (integer prec n))) in
  Axis t E l q c (add (add E more) (add (range1 (add1 col (negate1 l))) (range2 (add2 quad (negate2 q))))).

(* The sum of k0^2, k0 k1 and k1^2 times P sin over the waves, subtracted from 2I. *)
Definition beta_of (ss : list seen) : I.type * I.type * I.type :=
  (sub (itwo K) (gather0 (fun s => times (z0 (of s)) (i0 (of s)) (ps s)) ss),
   neg (gather0 (fun s => times (z1 (of s)) (i1 (of s)) (ps s)) ss),
   sub (itwo K) (gather1 (fun s => times (z1 (of s)) (i1 (of s)) (ps s)) ss)).

Definition matrix (m : symmetric) : I.type * I.type * I.type :=
  let '(p, q, r) := m in (exactly p, exactly q, exactly r).

(* The next d, force and rest:  d = beta - M,  f = M f0 + source + (beta - M - d) r - (I - M d0) r0. *)
Definition rests (b : I.type * I.type * I.type) (M d0 : symmetric)
    (r o f source : I.type * I.type) : symmetric * (I.type * I.type) * (I.type * I.type) :=
  let '(b00, b01, b11) := b in
  let '(m00, m01, m11) := matrix M in
  let '(k00, k01, k11) := matrix d0 in
  let c00 := sub b00 m00 in let c01 := sub b01 m01 in let c11 := sub b11 m11 in
  let d := (center c00, center c01, center c11) in
  let '(e00, e01, e11) := matrix d in
  let q00 := sub c00 e00 in let q01 := sub c01 e01 in let q11 := sub c11 e11 in
  let i00 := sub (ione K) (add (mul m00 k00) (mul m01 k01)) in
  let i01 := add (mul m00 k01) (mul m01 k11) in
  let i10 := add (mul m01 k00) (mul m11 k01) in
  let i11 := sub (ione K) (add (mul m01 k01) (mul m11 k11)) in
  let g0 := add (add (add (mul m00 (fst f)) (mul m01 (snd f))) (fst source))
                (sub (add (mul q00 (fst r)) (mul q01 (snd r)))
                     (sub (mul i00 (fst o)) (mul i01 (snd o)))) in
  let g1 := add (add (add (mul m01 (fst f)) (mul m11 (snd f))) (snd source))
                (sub (add (mul q01 (fst r)) (mul q11 (snd r)))
                     (sub (mul i11 (snd o)) (mul i10 (fst o)))) in
  (d, (g0, g1), (add (add (mul e00 (fst r)) (mul e01 (snd r))) g0,
                 add (add (mul e01 (fst r)) (mul e11 (snd r))) g1)).

(* c + r *)
Definition drift (st : state) : I.type * I.type :=
  (add (exactly (fst (mean st))) (fst (rest st)), add (exactly (snd (mean st))) (snd (rest st))).

Definition beyond_of (a : axis) (r : I.type) : I.type :=
  add (range1 (next_l a)) (add (range2 (next_q a)) (add (exactly (next_c a)) r)).

Definition step (ss : list seen) (st : state) : site * state :=
  let '(b00, b01, b11) as beta := beta_of ss in
  let '(c0, c1) := exact2 (mean st) in
  let '(o0, o1) := exact2 (mean0 st) in
  let a := ahead (fun f => gather0 f ss) (fun f => gather_lin0 f ss) (fun f => gather_quad0 f ss)
                 (fst (here st)) (fst (before st)) (fst (columns st)) (fst (columns0 st))
                 (fst (quads st)) (fst (quads0 st))
                 (sub (add (mul b00 c0) (mul b01 c1)) o0) in
  let b := ahead (fun f => gather1 f ss) (fun f => gather_lin1 f ss) (fun f => gather_quad1 f ss)
                 (snd (here st)) (snd (before st)) (snd (columns st)) (snd (columns0 st))
                 (snd (quads st)) (snd (quads0 st))
                 (sub (add (mul b01 c0) (mul b11 c1)) o1) in
  let '(d', f, r) := rests beta (M st) (d st) (rest st) (rest0 st) (force st)
                           (source a, source b) in
  (Site ss (E a, E b) (beyond_of a (fst r), beyond_of b (snd r)) beta,
   State (here st) (T a, T b) (columns st) (next_l a, next_l b) (quads st) (next_q a, next_q b)
         (mean st) (next_c a, next_c b) (rest st) r f d' (inverted d')).

(* ---- what the orbits y do *)

(* The force at y less that of the middle amplitudes at Y, and the same for all. *)
Definition pull (k : wave -> Z) (ws : list moving) (Y y : vec) : R :=
  sum (fun a => IZR (k (its a)) * (amplitude (its a) * cos (angle (its a) y)
                                   - mid_amp a * cos (angle (its a) Y))) ws.

Definition next_D (ws : list moving) (Do D E Y y : vec) : vec :=
  (2 * fst D - fst Do + fst E + pull k0 ws Y y, 2 * snd D - snd Do + snd E + pull k1 ws Y y).

Definition times_vec (m : symmetric) (v : vec) : vec :=
  let '(p, q, r) := m in
  (number p * fst v + number q * snd v, number q * fst v + number r * snd v).

Definition good (e : list R) (o y Do D : vec) (st : state) : Prop :=
  exists lo l qo q ro r f,
  near (real_of (before st)) (minus o Do) /\ near (real_of (here st)) (minus y D) /\
  hold_vec e (columns0 st) lo /\ hold_vec e (columns st) l /\
  hold_quads e (quads0 st) qo /\ hold_quads e (quads st) q /\
  cont_vec (rest0 st) ro /\ cont_vec (rest st) r /\ cont_vec (force st) f /\
  Do = plus lo (plus qo (plus (real_of (mean0 st)) ro)) /\
  D = plus l (plus q (plus (real_of (mean st)) r)) /\ r = plus (times_vec (d st) ro) f.

Lemma hold1_length e l v : hold1 e l v -> (length l <= length e)%nat.
Proof.
  revert e v. induction l as [| a l IH]; intros e v H; [apply Nat.le_0_l |].
  destruct e as [| x e]; [easy |]. destruct H as (c & r & Hc & Hr & ->).
  exact (le_n_S _ _ (IH _ _ Hr)).
Qed.

Lemma hold_centers e l v : hold1 e l v -> exists w, hold1 e (centers l) w.
Proof.
  revert e v. induction l as [| a l IH]; intros e v H; [exists 0; apply hold1_nil |].
  destruct e as [| x e]; [easy |]. destruct H as (c & r & Hc & Hr & ->).
  destruct (IH _ _ Hr) as (w & Hw). exists (number (center a) * x + w).
  exists (number (center a)), w. repeat split; [apply cont_exactly | exact Hw].
Qed.

Lemma hold_centers2 e q v : hold2 e q v -> exists w, hold2 e (centers2 q) w.
Proof.
  revert e v. induction q as [| row q IH]; intros e v H; [exists 0; apply hold2_nil |].
  destruct e as [| x e]; [easy |]. destruct H as (c & r & Hc & Hr & ->).
  destruct (hold_centers _ _ _ Hc) as (u & Hu), (IH _ _ Hr) as (w & Hw).
  exists (u * x + w), u, w. now repeat split.
Qed.

Lemma vec_eq (u v : vec) : fst u = fst v -> snd u = snd v -> u = v.
Proof. destruct u, v. simpl. now intros -> ->. Qed.

(* The pull, split into what the columns and T carry, what beta makes of the rest, and the bent part. *)
Lemma pull_expanded k ws Y l q r : Forall entire ws ->
  pull k ws Y (plus Y (plus l (plus q r))) =
  sum (fun a => IZR (k (its a)) * slope_real Y l a) ws
  + sum (fun a => IZR (k (its a)) * curve_real Y l q a) ws
  - fst r * sum (fun a => IZR (k (its a)) *
                  (IZR (k0 (its a)) * (mid_amp a * sin (angle (its a) Y)))) ws
  - snd r * sum (fun a => IZR (k (its a)) *
                  (IZR (k1 (its a)) * (mid_amp a * sin (angle (its a) Y)))) ws
  + sum (fun a => IZR (k (its a)) * bent_real Y l (plus q r) a) ws.
Proof.
  intros Hw. unfold pull, Rminus. rewrite <- (Rmult_1_l (sum (fun a => _ * bent_real _ _ _ _) _)).
  rewrite <- (Rmult_1_l (sum (fun a => _ * curve_real _ _ _ _) _)).
  rewrite 2!Ropp_mult_distr_l, !sum_scale, !sum_plus. apply sum_ext. intros a Ha.
  rewrite force_expanded by (eapply Forall_forall; eauto). unfold along. ring.
Qed.

Lemma force_split k ws Y y :
  sum (fun a => IZR (k (its a)) * (amplitude (its a) * cos (angle (its a) y))) ws =
  sum (fun a => IZR (k (its a)) * (mid_amp a * cos (angle (its a) Y))) ws + pull k ws Y y.
Proof. unfold pull. rewrite sum_plus. apply sum_ext. intros. ring. Qed.

Lemma view_sees e iws ws Xi X Y L l T q ri r : cube e -> Forall2 (held e) iws ws ->
  Forall entire ws -> cont_vec Xi X -> near X Y -> hold_vec e L l -> hold_quads e T q ->
  cont_vec ri r -> Forall2 (sees e Y l q (plus q r)) (map (look Xi L T ri) iws) ws.
Proof.
  intros C HH W HX HY HL HT Hr. induction HH as [| w a iws ws Hw HH IH]; simpl; constructor.
  - inversion W. eapply look_sees; eauto.
  - inversion W. auto.
Qed.

(* Along one coordinate: x, o and so on are what the orbit has there. *)
Lemma ahead_ok e (sum0 : (seen -> I.type) -> I.type) sum1 sum2 X O L P Q N carried l lo q qo
  (f b s u v : R) : cube e ->
  hold1 e L l -> hold1 e P lo -> hold2 e Q q -> hold2 e N qo -> cont carried v ->
  cont (sum0 pc) f -> cont (sum0 bent) b -> hold1 e (sum1 slope) s -> hold2 e (sum2 curve) u ->
  let a := ahead sum0 sum1 sum2 X O L P Q N carried in
  exists (n : Z) E' l' q' c,
  E' = 2 * PI * (number X + number X - number O) + f - 2 * PI * (number (T a) + IZR n) /\
  cont (E a) E' /\ hold1 e (next_l a) l' /\ hold2 e (next_q a) q' /\
  c = E' + (b + v - number (next_c a)) + (l + l + (- lo + s) - l' + (q + q + (- qo + u) - q')) /\
  cont (source a) c.
Proof.
  intros C HL HP HQ HN Hv Hf Hb Hs Hu. unfold ahead. cbv zeta.
  set (c := F.neg _). set (quad := add2 (add2 Q Q) _).
  destruct (wrap _ _ _) as (t, n). cbn [T E next_l next_q next_c source].
  assert (Hcol : hold1 e (add1 (add1 L L) (add1 (negate1 P) (sum1 slope))) (l + l + (- lo + s)))
    by auto using hold_add1, hold_negate1.
  assert (Hquad : hold2 e quad (q + q + (- qo + u)))
    by (unfold quad; auto using hold_add2, hold_negate2).
  destruct (hold_centers _ _ _ Hcol) as (l' & Hl'), (hold_centers2 _ _ _ Hquad) as (q' & Hq').
  assert (HE : cont (sub (add (mul (itwo_pi K) (sub (add (exactly X) (exactly X)) (exactly O)))
      (sum0 pc)) (mul (itwo_pi K) (add (exactly t) (integer prec n))))
    (2 * PI * (number X + number X - number O) + f - 2 * PI * (number t + IZR n))).
  { apply cont_sub; [apply cont_add; [| exact Hf] |]; (apply cont_mul; [apply K_ok |]);
      auto using cont_add, cont_sub, cont_exactly, cont_integer. }
  eexists n, _, l', q', _. split; [reflexivity |]. split; [exact HE |]. split; [exact Hl' |].
  split; [exact Hq' |]. split; [reflexivity |]. apply cont_add; [apply cont_add; [exact HE |] |].
  - apply cont_sub; [now apply cont_add | apply cont_exactly].
  - apply cont_add.
    + apply (cont_range1' e); [exact C |]. now apply hold_add1, hold_negate1.
    + apply (cont_range2' e); [exact C |]. now apply hold_add2, hold_negate2.
Qed.

Lemma beta_ok e Y l q r ss ws : Forall2 (sees e Y l q r) ss ws ->
  let sines k k' := sum (fun a => IZR (k (its a)) * (IZR (k' (its a))
                                  * (mid_amp a * sin (angle (its a) Y)))) ws in
  let '(b00, b01, b11) := beta_of ss in
  cont b00 (2 - sines k0 k0) /\ cont b01 (- sines k0 k1) /\ cont b11 (2 - sines k1 k1).
Proof.
  intros S. cbv beta zeta delta [beta_of].
  split; [| split]; [apply cont_sub; [apply K_ok |] | apply cont_neg | apply cont_sub; [apply K_ok |]];
    (eapply gather0_ok || eapply gather1_ok); try exact S; intros s a Q; cbv beta.
  - destruct (k0_ok _ _ _ _ _ _ _ Q) as (-> & ?). apply cont_times; auto. apply Q.
  - destruct (k1_ok _ _ _ _ _ _ _ Q) as (-> & ?). apply cont_times; auto. apply Q.
  - destruct (k1_ok _ _ _ _ _ _ _ Q) as (-> & ?). apply cont_times; auto. apply Q.
Qed.

Lemma rests_ok b M d0 ri oi fi si (b00 b01 b11 : R) r o f s :
  (let '(i00, i01, i11) := b in cont i00 b00 /\ cont i01 b01 /\ cont i11 b11) ->
  cont_vec ri r -> cont_vec oi o -> cont_vec fi f -> cont_vec si s -> r = plus (times_vec d0 o) f ->
  let '(d', gi, ri') := rests b M d0 ri oi fi si in
  exists g r', cont_vec gi g /\ cont_vec ri' r' /\ r' = plus (times_vec d' r) g /\
  r' = (b00 * fst r + b01 * snd r - fst o + fst s, b01 * fst r + b11 * snd r - snd o + snd s).
Proof.
  destruct b as ((i00, i01), i11), M as ((M00, M01), M11), d0 as ((d00, d01), d11).
  intros (H00 & H01 & H11) (Hr0 & Hr1) (Ho0 & Ho1) (Hf0 & Hf1) (Hs0 & Hs1) Er.
  unfold rests. cbv beta iota zeta delta [matrix].
  set (c00 := center _). set (c01 := center (sub i01 _)). set (c11 := center (sub i11 _)).
  pose proof (cont_exactly M00) as X1. pose proof (cont_exactly M01) as X2.
  pose proof (cont_exactly M11) as X3. pose proof (cont_exactly d00) as X4.
  pose proof (cont_exactly d01) as X5. pose proof (cont_exactly d11) as X6.
  pose proof (cont_exactly c00) as X7. pose proof (cont_exactly c01) as X8.
  pose proof (cont_exactly c11) as X9.
  assert (One : cont (ione K) 1) by apply K_ok.
  match goal with |- exists g r', cont_vec (?G0, ?G1) g /\ _ =>
    assert (Hg0 : cont G0 (number M00 * fst f + number M01 * snd f + fst s +
      ((b00 - number M00 - number c00) * fst r + (b01 - number M01 - number c01) * snd r -
       ((1 - (number M00 * number d00 + number M01 * number d01)) * fst o
        - (number M00 * number d01 + number M01 * number d11) * snd o))))
      by auto 8 using cont_add, cont_sub, cont_mul;
    assert (Hg1 : cont G1 (number M01 * fst f + number M11 * snd f + snd s +
      ((b01 - number M01 - number c01) * fst r + (b11 - number M11 - number c11) * snd r -
       ((1 - (number M01 * number d01 + number M11 * number d11)) * snd o
        - (number M01 * number d00 + number M11 * number d01) * fst o))))
      by auto 8 using cont_add, cont_sub, cont_mul
  end.
  eexists (_, _), (_, _). split; [split; [exact Hg0 | exact Hg1] |].
  split; [split; simpl fst; simpl snd; eauto 6 using cont_add, cont_mul |].
  split; [apply vec_eq; simpl; ring |].
  apply (f_equal fst) in Er as Er0. apply (f_equal snd) in Er as Er1.
  unfold plus, times_vec in Er0, Er1. simpl in Er0, Er1.
  apply vec_eq; simpl; rewrite Er0, Er1; ring.
Qed.

Notation sines k k' Y ws := (sum (fun a => IZR (k (its a)) * (IZR (k' (its a))
                              * (mid_amp a * sin (angle (its a) Y)))) ws).

(* The waves at a state's site. *)
Definition view_at (iws : list pwave) (st : state) : list seen :=
  map (look (exact2 (here st)) (columns st) (quads st) (drift st)) iws.

Theorem step_good e iws ws o y Do D st : cube e -> Forall2 (held e) iws ws -> Forall entire ws ->
  good e o y Do D st ->
  let '(s, st') := step (view_at iws st) st in
  exists Y l q w E Dn, y = plus Y D /\ D = plus l w /\ Forall2 (sees e Y l q w) (view s) ws /\
    cont_vec (err s) E /\ cont_vec (beyond s) Dn /\ Dn = next_D ws Do D E Y y /\
    good e y (next (map its ws) o y) D Dn st'.
Proof.
  intros C HH W (lo & l & qo & q & ro & r & f & Ho & Hy & Hlo & Hl & Hqo & Hq & Hro & Hr & Hf & EDo &
    ED & Er).
  set (c := real_of (mean st)) in *. set (co := real_of (mean0 st)) in *.
  assert (Hdrift : cont_vec (drift st) (plus c r)).
  { split; (apply cont_add; [apply cont_exactly | apply Hr]). }
  assert (S := view_sees e iws ws _ _ _ _ l _ q _ _ C HH W (cont_exact2 (here st)) Hy Hl Hq Hdrift).
  fold (view_at iws st) in S. set (ss := view_at iws st) in *. clearbody ss.
  set (Y := minus y D) in *. set (w := plus q (plus c r)) in *.
  assert (Ey : y = plus Y D) by (apply vec_eq; unfold Y, plus, minus; simpl; ring).
  assert (HB := beta_ok e Y l q w ss ws S). cbv zeta in HB. cbv beta in HB.
  unfold step. destruct (beta_of ss) as ((b00, b01), b11) eqn:EB. destruct HB as (HB0 & HB1 & HB2).
  destruct (cont_exact2 (mean st)) as (Hc0 & Hc1). destruct (cont_exact2 (mean0 st)) as (Hco0 & Hco1).
  destruct (exact2 (mean st)) as (ic0, ic1). destruct (exact2 (mean0 st)) as (io0, io1).
  cbn [fst snd] in Hc0, Hc1, Hco0, Hco1. fold c in Hc0, Hc1. fold co in Hco0, Hco1.
  destruct (ahead_ok e (fun f => gather0 f ss) (fun f => gather_lin0 f ss)
    (fun f => gather_quad0 f ss) (fst (here st)) (fst (before st)) (fst (columns st))
    (fst (columns0 st)) (fst (quads st)) (fst (quads0 st)) (sub (add (mul b00 ic0) (mul b01 ic1)) io0)
    (fst l) (fst lo) (fst q) (fst qo) _ _ _ _ _ C
    (proj1 Hl) (proj1 Hlo) (proj1 Hq) (proj1 Hqo)
    (cont_sub prec _ _ _ _ (cont_add prec _ _ _ _ (cont_mul prec _ _ _ _ HB0 Hc0)
      (cont_mul prec _ _ _ _ HB1 Hc1)) Hco0)
    (gather0_ok e Y l q w pc (fun a => mid_amp a * cos (angle (its a) Y)) ss ws
      ltac:(intros ? ? Q; apply Q) S)
    (gather0_ok e Y l q w bent _ ss ws (fun s a => cont_bent e Y l q w s a C) S)
    (gather_lin0_ok e Y l q w slope _ ss ws (hold_slope e Y l q w) S)
    (gather_quad0_ok e Y l q w curve _ ss ws (hold_curve e Y l q w) S))
    as (n0 & E0 & l0 & q0 & s0 & EE0 & HE0 & Hl0 & Hq0 & Es0 & Hs0).
  destruct (ahead_ok e (fun f => gather1 f ss) (fun f => gather_lin1 f ss)
    (fun f => gather_quad1 f ss) (snd (here st)) (snd (before st)) (snd (columns st))
    (snd (columns0 st)) (snd (quads st)) (snd (quads0 st)) (sub (add (mul b01 ic0) (mul b11 ic1)) io1)
    (snd l) (snd lo) (snd q) (snd qo) _ _ _ _ _ C
    (proj2 Hl) (proj2 Hlo) (proj2 Hq) (proj2 Hqo)
    (cont_sub prec _ _ _ _ (cont_add prec _ _ _ _ (cont_mul prec _ _ _ _ HB1 Hc0)
      (cont_mul prec _ _ _ _ HB2 Hc1)) Hco1)
    (gather1_ok e Y l q w pc (fun a => mid_amp a * cos (angle (its a) Y)) ss ws
      ltac:(intros ? ? Q; apply Q) S)
    (gather1_ok e Y l q w bent _ ss ws (fun s a => cont_bent e Y l q w s a C) S)
    (gather_lin1_ok e Y l q w slope _ ss ws (hold_slope e Y l q w) S)
    (gather_quad1_ok e Y l q w curve _ ss ws (hold_curve e Y l q w) S))
    as (n1 & E1 & l1 & q1 & s1 & EE1 & HE1 & Hl1 & Hq1 & Es1 & Hs1).
  set (a := ahead (fun f => gather0 f ss) _ _ _ _ _ _ _ _ _) in *. clearbody a.
  set (b := ahead (fun f => gather1 f ss) _ _ _ _ _ _ _ _ _) in *. clearbody b. cbv zeta.
  assert (HR := rests_ok (b00, b01, b11) (M st) (d st) (rest st) (rest0 st) (force st)
    (source a, source b) _ _ _ r ro f (s0, s1) (conj HB0 (conj HB1 HB2)) Hr Hro Hf
    (conj Hs0 Hs1) Er).
  destruct (rests _ _ _ _ _ _ _) as ((d', gi), ri'). destruct HR as (g & r' & Hg & Hr' & Ed & Er').
  assert (P0 := pull_expanded k0 ws Y l q (plus c r) W).
  assert (P1 := pull_expanded k1 ws Y l q (plus c r) W).
  assert (N0 : sines k1 k0 Y ws = sines k0 k1 Y ws) by (apply sum_ext; intros; ring).
  fold w in P0, P1. rewrite <- ED, <- Ey in P0, P1. rewrite N0 in P1. clear N0.
  set (c' := real_of (next_c a, next_c b)).
  assert (D0 : fst (next_D ws Do D (E0, E1) Y y) = l0 + (q0 + (fst c' + fst r'))).
  { unfold next_D. simpl. rewrite P0, Er', Es0, ED, EDo. unfold w. simpl. ring. }
  assert (D1 : snd (next_D ws Do D (E0, E1) Y y) = l1 + (q1 + (snd c' + snd r'))).
  { unfold next_D. simpl. rewrite P1, Er', Es1, ED, EDo. unfold w. simpl. ring. }
  exists Y, l, q, w, (E0, E1), (next_D ws Do D (E0, E1) Y y).
  split; [exact Ey |]. split; [exact ED |]. split; [exact S |]. split; [now split |].
  split.
  { split; unfold beyond_of; cbn [fst snd beyond]; [rewrite D0 | rewrite D1];
      (apply cont_add; [now apply (cont_range1' e) |]; apply cont_add; [now apply (cont_range2' e) |];
       apply cont_add; [apply cont_exactly | apply Hr']). }
  split; [reflexivity |].
  exists l, (l0, l1), q, (q0, q1), r, r', g.
  split; [exact Hy |]. split.
  { (* where the next centre is *)
    destruct Ho as (i & j & Ho), Hy as (i' & j' & Hy).
    apply (f_equal fst) in Ho as Ho0. apply (f_equal snd) in Ho as Ho1.
    apply (f_equal fst) in Hy as Hy0. apply (f_equal snd) in Hy as Hy1.
    unfold minus in Ho0, Ho1, Hy0, Hy1. simpl in Ho0, Ho1, Hy0, Hy1.
    exists (2 * i' - i + n0)%Z, (2 * j' - j + n1)%Z.
    rewrite !plus_IZR, !minus_IZR, !mult_IZR.
    assert (V0 : fst (V' (map its ws) y) = - sum (fun a => IZR (k0 (its a)) *
      (amplitude (its a) * cos (angle (its a) y))) ws) by (unfold V'; simpl; now rewrite sum_map).
    assert (V1 : snd (V' (map its ws) y) = - sum (fun a => IZR (k1 (its a)) *
      (amplitude (its a) * cos (angle (its a) y))) ws) by (unfold V'; simpl; now rewrite sum_map).
    rewrite (force_split k0 ws Y y) in V0. rewrite (force_split k1 ws Y y) in V1.
    apply vec_eq; unfold next, next_D, minus, scale, real_of; cbn [fst snd here].
    - rewrite V0, EE0. lra.
    - rewrite V1, EE1. lra. }
  repeat split; simpl; auto; try apply Hl; try apply Hq; try apply Hr; try apply Hr'; try apply Hg.
  now apply vec_eq.
Qed.


(* ---- the whole lane *)

(* What a list of sites says of the orbit through o and y, at Do and Do from the centres. *)
Fixpoint lane_ok (e : list R) (ws : list moving) (sites : list site) (o y Do D : vec) : Prop :=
  match sites with
  | [] => True
  | s :: sites =>
    exists Y l q w E Dn, y = plus Y D /\ D = plus l w /\ Forall2 (sees e Y l q w) (view s) ws /\
    cont_vec (err s) E /\ cont_vec (beyond s) Dn /\ Dn = next_D ws Do D E Y y /\
    lane_ok e ws sites y (next (map its ws) o y) D Dn
  end.

(* Is z within the limits?  If not, an orbit is followed no further; nothing rests on it. *)
Definition is_near (limit : F.type) (s : seen) : bool :=
  match F.cmp (I.upper (z s)) limit, F.cmp (I.lower (z s)) (F.neg limit) with
  | Xlt, Xgt => true
  | _, _ => false
  end.

Fixpoint follow (fuel : nat) (limit : F.type) (iws : list pwave) (st : state) : list site :=
  match fuel with
  | O => []
  | S fuel =>
    let ss := view_at iws st in
    if forallb (is_near limit) ss then
      let '(s, st') := step ss st in s :: follow fuel limit iws st'
    else []
  end.

Theorem follow_ok fuel limit e iws ws o y Do D st : cube e -> Forall2 (held e) iws ws ->
  Forall entire ws -> good e o y Do D st -> lane_ok e ws (follow fuel limit iws st) o y Do D.
Proof.
  intros C HH W. revert o y Do D st. induction fuel as [| fuel IH]; intros o y Do D st G; simpl.
  { exact Logic.I. }
  destruct (forallb _ _); [| exact Logic.I].
  pose proof (step_good e iws ws o y Do D st C HH W G) as S.
  destruct (step _ _) as (s, st'). simpl.
  destruct S as (Y & l & q & w & E & Dn & Ey & ED & HS & HE & HD & EDn & G').
  exists Y, l, q, w, E, Dn. repeat (split; [assumption |]). now apply IH.
Qed.

End Precision.
End Lane.
