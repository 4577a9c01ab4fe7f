(* The left side of (1) of docs/proofs/argument.md, bounded over a prism.  At each site of a lane a
   multiplier mu of the equation of motion is added to it, affine in the symbols, such that what is
   linear in D cancels; what is left is a polynomial of third order in the symbols and an
   interval. *)

From Coq Require Import Reals ZArith List Lra Lia.
From Interval.Real Require Import Xreal.
From Interval.Float Require Import Basic Sig.
From Interval.Interval Require Import Interval.
From Converse Require Import Map Trig Window Lane.
Import ListNotations.
Open Scope R_scope.

Module Bound (F : FloatOps with Definition radix := Zaux.radix2
                           with Definition sensible_format := true).
Include Lane F.

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
Variable K : limits.
Hypothesis K_ok : limits_ok K.
Notation range1 := (range1 prec (unit K)).
Notation dir := (dir prec).
Notation dir1 := (dir1 prec).

(* What is affine in the symbols: a number and a linear form. *)
Definition affine := (I.type * form1)%type.
Definition hold_affine e (a : affine) (v : R) : Prop :=
  exists x y, cont (fst a) x /\ hold1 e (snd a) y /\ v = x + y.

Definition range_affine (a : affine) : I.type := add (fst a) (range1 (snd a)).

Lemma cont_range_affine e a v : cube e -> hold_affine e a v -> cont (range_affine a) v.
Proof.
  intros C (x & y & Hx & Hy & ->). apply cont_add; [exact Hx |].
  now apply (cont_range1' prec K K_ok e).
Qed.

(* What a wave has in the sum, with m = m0 + m1 = k.mu and o = k.n:  see wave_expanded. *)
Section Wave.
Variables (s : seen) (n : I.type * I.type) (mu0 : I.type * I.type) (mu1 : form1 * form1).
Let om := sqr (dir (of s) n).
Let m0 := dir (of s) mu0.
Let m1 := dir1 (of s) mu1.
Let P := amp (of s).
Let h := move (of s).
Let A := sub (mul m0 (cs s)) (mul om (sn s)).
Let B := neg (add (mul om (cs s)) (mul m0 (sn s))).
Let alpha := scale1 (cs s) m1.
Let beta' := scale1 (neg (sn s)) m1.
Let PA := mul P A.
Let PB := mul P B.

Definition with_1 : form1 := scale1 A h.
Definition with_2 : form2 :=
  add2 (scale2 (mul (ihalf K) PA) (sq s)) (product h alpha).
Definition with_3 : form3 :=
  let first := negate1 (add1 (scale1 (mul (ihalf K) P) alpha)
    (add1 (scale1 (mul (isixth K) PB) (xi s)) (scale1 (mul (ihalf K) A) h))) in
  add3 (product3 first (sq s)) (product3 h (product beta' (xi s))).
(* what D is multiplied with *)
Definition turning : affine :=
  (PB, add1 (scale1 P beta') (add1 (negate1 (scale1 PA (xi s))) (scale1 B h))).

Definition left_over : I.type :=
  let z := z s in let w := off s in let x := size s in
  let z2 := sqr z in
  let c2 := neg (mul (upto2 K) z2) in                       (* cos z - 1 *)
  let s3 := neg (mul (upto6 K) (mul z z2)) in               (* sin z - z *)
  let c4 := mul (upto24 K) (sqr z2) in                      (* cos z - 1 + z^2/2 *)
  let s5 := mul (upto120 K) (mul (mul z z2) z2) in          (* sin z - z + z^3/6 *)
  let far := sub c4 (mul (mul (ihalf K) w) (add z x)) in
  let cube := sub s5 (mul (mul (isixth K) w) (add (add z2 (mul z x)) (sqr x))) in
  let ra := range1 alpha in let rb := range1 beta' in let rh := range1 h in
  add (neg (mul om (ps s)))
    (add (mul PA (sub c4 (mul (ihalf K) (sqr w))))
      (add (mul (add (mul P ra) (mul rh A)) far)
        (add (mul PB cube)
          (add (mul (mul P rb) s3)
            (mul rh (add (mul ra c2) (add (mul B s3) (mul rb (add w s3))))))))).
End Wave.

(* n^2 less the wave's force on the multiplier. *)
Definition wave_real (Y y nu mu : vec) (a : moving) : R :=
  along (its a) mu * (amplitude (its a) * cos (angle (its a) y)
                      - mid_amp a * cos (angle (its a) Y))
  - amplitude (its a) * sin (angle (its a) y) * (along (its a) nu * along (its a) nu).

Lemma wave_ok e Y l q r s a n nu mi0 mi1 mu0 mu1 : cube e -> sees e Y l q r s a ->
  cont_vec n nu -> cont_vec mi0 mu0 -> hold_vec e mi1 mu1 ->
  exists v1 v2 v3 c g, hold1 e (with_1 s n mi0) v1 /\ hold2 e (with_2 s n mi0 mi1) v2 /\
    hold3 e e (with_3 s n mi0 mi1) v3 /\ cont (left_over s n mi0 mi1) c /\
    hold_affine e (turning s n mi0 mi1) g /\
    wave_real Y (plus Y (plus l r)) nu (plus mu0 mu1) a =
      v1 + v2 + v3 + c + g * (along (its a) l + along (its a) r).
Proof.
  intros C (Ha & Hw & Hsn & Hcs & Hps & Hpc & Hxi & Hsq & _ & Hsize & Hoff & Hz) Hn Hm0 Hm1.
  pose proof K_ok as (_ & _ & _ & _ & _ & _ & Khalf & Ksixth & _).
  assert (Hom := cont_sqr prec _ _ (cont_dir prec e _ a n nu Hw Hn)).
  assert (H0 := cont_dir prec e _ a mi0 mu0 Hw Hm0).
  assert (H1 := hold_dir1 prec e _ a mi1 mu1 Hw Hm1).
  assert (HP : cont (amp (of s)) (mid_amp a)) by apply Hw.
  assert (Hh : hold1 e (move (of s)) (more_amp a)) by apply Hw.
  set (theta := angle (its a) Y) in *.
  set (x := along (its a) l) in *. set (w := along (its a) r) in *.
  set (o := along (its a) nu * along (its a) nu) in *.
  set (p0 := along (its a) mu0) in *. set (p1 := along (its a) mu1) in *.
  set (P := mid_amp a) in *. set (h := more_amp a) in *.
  set (z := x + w) in *.
  assert (HA : cont _ (p0 * cos theta - o * sin theta)) by
    exact (cont_sub prec _ _ _ _ (cont_mul prec _ _ _ _ H0 Hcs) (cont_mul prec _ _ _ _ Hom Hsn)).
  assert (HB : cont _ (- (o * cos theta + p0 * sin theta))) by
    exact (cont_neg _ _ (cont_add prec _ _ _ _ (cont_mul prec _ _ _ _ Hom Hcs)
                                             (cont_mul prec _ _ _ _ H0 Hsn))).
  assert (Hal : hold1 e _ (cos theta * p1)) by exact (hold_scale1 prec e _ _ _ _ Hcs H1).
  assert (Hbe : hold1 e _ (- sin theta * p1)) by
    exact (hold_scale1 prec e _ _ _ _ (cont_neg _ _ Hsn) H1).
  set (A := p0 * cos theta - o * sin theta) in *. set (B := - (_ + _)) in *.
  set (al := cos theta * p1) in *. set (be := - sin theta * p1) in *.
  destruct (cos2 z) as (t2 & T2 & E2), (sin3 z) as (t3 & T3 & E3), (cos4 z) as (t4 & T4 & E4),
    (sin5 z) as (t5 & T5 & E5).
  destruct K_ok as (_ & _ & Up2 & Up6 & Up24 & Up120 & _).
  assert (U2 := Up2 t2 T2). assert (U6 := Up6 t3 T3).
  assert (U24 := Up24 t4 T4). assert (U120 := Up120 t5 T5).
  assert (Ra := cont_range1' prec K K_ok e _ _ C Hal).
  assert (Rb := cont_range1' prec K K_ok e _ _ C Hbe).
  assert (Rh := cont_range1' prec K K_ok e _ _ C Hh).
  eexists _, _, _, _, _.
  split; [apply hold_scale1; [exact HA | exact Hh] |].
  split.
  { apply hold_add2; [apply hold_scale2; [| exact Hsq] |
      apply hold_product; [exact Hh | exact Hal]].
    apply cont_mul; [exact Khalf |]. apply cont_mul; [exact HP | exact HA]. }
  split.
  { apply hold_add3; apply hold_product3; [| exact Hsq | exact Hh |
      apply hold_product; [exact Hbe | exact Hxi]].
    apply hold_negate1, hold_add1; [| apply hold_add1]; apply hold_scale1;
      try exact Hal; try exact Hxi; try exact Hh; apply cont_mul; try exact Khalf; try exact Ksixth;
      try exact HP; try exact HA. apply cont_mul; [exact HP | exact HB]. }
  split.
  { unfold left_over. cbv zeta.
    assert (Hz2 := cont_sqr prec _ _ Hz).
    assert (Hc2 := cont_neg _ _ (cont_mul prec _ _ _ _ U2 Hz2)).
    assert (Hs3 := cont_neg _ _ (cont_mul prec _ _ _ _ U6 (cont_mul prec _ _ _ _ Hz Hz2))).
    assert (Hc4 := cont_mul prec _ _ _ _ U24 (cont_sqr prec _ _ Hz2)).
    assert (Hs5 := cont_mul prec _ _ _ _ U120
      (cont_mul prec _ _ _ _ (cont_mul prec _ _ _ _ Hz Hz2) Hz2)).
    assert (Hfar := cont_sub prec _ _ _ _ Hc4 (cont_mul prec _ _ _ _
      (cont_mul prec _ _ _ _ Khalf Hoff) (cont_add prec _ _ _ _ Hz Hsize))).
    assert (Hcube := cont_sub prec _ _ _ _ Hs5 (cont_mul prec _ _ _ _
      (cont_mul prec _ _ _ _ Ksixth Hoff) (cont_add prec _ _ _ _ (cont_add prec _ _ _ _ Hz2
        (cont_mul prec _ _ _ _ Hz Hsize)) (cont_sqr prec _ _ Hsize)))).
    repeat first [ exact Hc4 | exact Hs3 | exact Hc2 | exact Hfar | exact Hcube | exact Ra | exact Rb
      | exact Rh | exact HA | exact HB | exact HP | exact Hom | exact Hps | exact Khalf | exact Hoff
      | apply cont_add | apply cont_neg | apply cont_sub | apply cont_mul | apply cont_sqr ]. }
  split.
  { eexists _, _. split; [apply cont_mul; [exact HP | exact HB] |]. split; [| reflexivity].
    apply hold_add1; [apply hold_scale1; [exact HP | exact Hbe] |].
    apply hold_add1; [| apply hold_scale1; [exact HB | exact Hh]].
    apply hold_negate1, hold_scale1; [apply cont_mul; [exact HP | exact HA] | exact Hxi]. }
  unfold wave_real. rewrite angle_plus, !along_plus, Ha.
  fold theta x w o p0 p1 P h z. rewrite (sin_plus theta z), (cos_plus theta z).
  replace (t4 * _) with (cos z - 1 + z * z / 2) by lra.
  replace (t5 * _) with (sin z - z + z * (z * z) / 6) by lra.
  replace (t3 * _) with (z - sin z) by lra. replace (t2 * _) with (1 - cos z) by lra.
  unfold A, B, al, be. generalize (cos z), (sin z). intros c s'. unfold z. field.
Qed.

(* ---- a lane, from its last site inwards *)

Record sum_of := SumOf {
  value : I.type; sum1 : form1; sum2 : form2; sum3 : form3;
  on_D : affine * affine;                   (* D of the last site looked at is multiplied with this *)
  mult : affine * affine;                   (* its multiplier *)
  vector : I.type * I.type                  (* its n *)
}.

Definition nothing : affine := (I.zero, []).
Definition no_sum : sum_of :=
  SumOf I.zero [] [] [] (nothing, nothing) (nothing, nothing) (I.zero, I.zero).

Definition affine_centers (a : affine) : affine := (exactly (center (fst a)), centers (snd a)).
Definition minus_affine (a b : affine) : affine :=
  (sub (fst a) (fst b), add1 (snd a) (negate1 (snd b))).
Definition plus_affine (a b : affine) : affine := (add (fst a) (fst b), add1 (snd a) (snd b)).
Definition scale_affine (c : I.type) (a : affine) : affine := (mul c (fst a), scale1 c (snd a)).
Definition negate_affine (a : affine) : affine := (neg (fst a), negate1 (snd a)).

Notation gather_affine0 := (gather nothing plus_affine negate_affine scale_affine z0 i0).
Notation gather_affine1 := (gather nothing plus_affine negate_affine scale_affine z1 i1).

Definition square_sum (v : I.type * I.type) : I.type := add (sqr (fst v)) (sqr (snd v)).
Definition inner (u v : I.type * I.type) : I.type :=
  add (mul (fst u) (fst v)) (mul (snd u) (snd v)).

(* Adds a site, with its n; l is there if it is the last. *)
Definition add_site (s : site) (n : I.type * I.type) (l : option I.type) (t : sum_of) : sum_of :=
  let mu0 := affine_centers (fst (on_D t)) in
  let mu1 := affine_centers (snd (on_D t)) in
  let lost0 := mul (range_affine (minus_affine (fst (on_D t)) mu0)) (fst (beyond s)) in
  let lost1 := mul (range_affine (minus_affine (snd (on_D t)) mu1)) (snd (beyond s)) in
  let c := (fst mu0, fst mu1) in
  let l1 := (snd mu0, snd mu1) in
  let long := square_sum n in
  let ends := match l with Some l => mul l long | None => I.zero end in
  let own := sub (sub (add long long) (mul (itwo K) (inner n (vector t)))) ends in
  let drive := add (mul (fst (err s)) (fst mu0)) (mul (snd (err s)) (fst mu1)) in
  let waves := total I.zero add (fun w => left_over w n c l1) (view s) in
  SumOf
    (add (value t) (add (add lost0 lost1) (add own (add drive waves))))
    (add1 (sum1 t) (add1 (add1 (scale1 (fst (err s)) (snd mu0)) (scale1 (snd (err s)) (snd mu1)))
                         (total [] add1 (fun w => with_1 w n c) (view s))))
    (add2 (sum2 t) (total [] add2 (fun w => with_2 w n c l1) (view s)))
    (add3 (sum3 t) (total [] add3 (fun w => with_3 w n c l1) (view s)))
    (plus_affine (minus_affine (plus_affine mu0 mu0) (fst (mult t)))
                 (gather_affine0 (fun w => turning w n c l1) (view s)),
     plus_affine (minus_affine (plus_affine mu1 mu1) (snd (mult t)))
                 (gather_affine1 (fun w => turning w n c l1) (view s)))
    (mu0, mu1) n.

Fixpoint backward (l : I.type) (sites : list site) (ns : list (I.type * I.type)) : sum_of :=
  match sites, ns with
  | s :: sites, n :: ns =>
    add_site s n (match ns with [] => Some l | _ => None end) (backward l sites ns)
  | _, _ => no_sum
  end.

Definition hold_both e (a : affine * affine) (v : vec) : Prop :=
  hold_affine e (fst a) (fst v) /\ hold_affine e (snd a) (snd v).

Lemma hold_centers_affine e a v : hold_affine e a v ->
  exists x y, cont (fst (affine_centers a)) x /\ hold1 e (snd (affine_centers a)) y.
Proof.
  intros (x & y & Hx & Hy & _). destruct (hold_centers _ _ _ Hy) as (w & Hw).
  eexists _, w. split; [apply cont_exactly | exact Hw].
Qed.

Lemma hold_plus_affine e a b v w :
  hold_affine e a v -> hold_affine e b w -> hold_affine e (plus_affine a b) (v + w).
Proof.
  intros (x & y & Hx & Hy & ->) (x' & y' & Hx' & Hy' & ->).
  exists (x + x'), (y + y'). split; [now apply cont_add |]. split; [now apply hold_add1 | ring].
Qed.

Lemma hold_negate_affine e a v : hold_affine e a v -> hold_affine e (negate_affine a) (- v).
Proof.
  intros (x & y & Hx & Hy & ->). exists (- x), (- y).
  split; [now apply cont_neg |]. split; [now apply hold_negate1 | ring].
Qed.

Lemma hold_scale_affine e c a x v : cont c x -> hold_affine e a v ->
  hold_affine e (scale_affine c a) (x * v).
Proof.
  intros Hc (y & w & Hy & Hw & ->). exists (x * y), (x * w).
  split; [now apply cont_mul |]. split; [now apply hold_scale1 | ring].
Qed.

Lemma hold_minus_affine e a b v w :
  hold_affine e a v -> hold_affine e b w -> hold_affine e (minus_affine a b) (v - w).
Proof.
  intros (x & y & Hx & Hy & ->) (x' & y' & Hx' & Hy' & ->).
  exists (x - x'), (y + - y'). split; [now apply cont_sub |].
  split; [now apply hold_add1, hold_negate1 | ring].
Qed.

Lemma hold_nothing e : hold_affine e nothing 0.
Proof. exists 0, 0. split; [exact cont_zero |]. split; [apply hold1_nil | ring]. Qed.

Lemma waves_ok e Y l q r n nu mi0 mi1 mu0 mu1 ss ws : cube e -> Forall2 (sees e Y l q r) ss ws ->
  cont_vec n nu -> cont_vec mi0 mu0 -> hold_vec e mi1 mu1 ->
  exists v1 v2 v3 c g0 g1,
  hold1 e (total [] add1 (fun s => with_1 s n mi0) ss) v1 /\
  hold2 e (total [] add2 (fun s => with_2 s n mi0 mi1) ss) v2 /\
  hold3 e e (total [] add3 (fun s => with_3 s n mi0 mi1) ss) v3 /\
  cont (total I.zero add (fun s => left_over s n mi0 mi1) ss) c /\
  hold_affine e (gather_affine0 (fun s => turning s n mi0 mi1) ss) g0 /\
  hold_affine e (gather_affine1 (fun s => turning s n mi0 mi1) ss) g1 /\
  sum (wave_real Y (plus Y (plus l r)) nu (plus mu0 mu1)) ws =
    v1 + v2 + v3 + c + g0 * (fst l + fst r) + g1 * (snd l + snd r).
Proof.
  intros C S Hn Hm0 Hm1. induction S as [| s a ss ws Hs S IH].
  { exists 0, 0, 0, 0, 0, 0. repeat split; simpl;
      auto using hold1_nil, hold2_nil, hold3_nil, cont_zero, hold_nothing. ring. }
  destruct IH as (v1 & v2 & v3 & c & g0 & g1 & H1 & H2 & H3 & Hc & Hg0 & Hg1 & E).
  destruct (wave_ok e Y l q r s a n nu mi0 mi1 mu0 mu1 C Hs Hn Hm0 Hm1)
    as (w1 & w2 & w3 & x & g & J1 & J2 & J3 & Jc & Jg & E').
  exists (w1 + v1), (w2 + v2), (w3 + v3), (x + c), (IZR (k0 (its a)) * g + g0),
    (IZR (k1 (its a)) * g + g1).
  split; [now apply hold_add1 |]. split; [now apply hold_add2 |]. split; [now apply hold_add3 |].
  split; [now apply cont_add |].
  destruct (k0_ok _ _ _ _ _ _ _ Hs) as (Ek0 & Hk0), (k1_ok _ _ _ _ _ _ _ Hs) as (Ek1 & Hk1).
  split; [| split].
  - apply (gather_step _ _ _ _ (hold_affine e)); auto using hold_plus_affine, hold_negate_affine.
    intros. now apply hold_scale_affine.
  - apply (gather_step _ _ _ _ (hold_affine e)); auto using hold_plus_affine, hold_negate_affine.
    intros. now apply hold_scale_affine.
  - simpl sum. rewrite E, E'. unfold along. ring.
Qed.

Lemma wave_sum ws Y y nu mu : sum (wave_real Y y nu mu) ws =
  fst mu * pull k0 ws Y y + snd mu * pull k1 ws Y y
  - sum (fun a => amplitude (its a) * sin (angle (its a) y)
                  * (along (its a) nu * along (its a) nu)) ws.
Proof.
  unfold pull, Rminus. rewrite <- (Rmult_1_l (sum (fun a => _ * sin _ * _) ws)), Ropp_mult_distr_l.
  rewrite !sum_scale, !sum_plus. apply sum_ext. intros. unfold wave_real, along. ring.
Qed.

Lemma cont_square_sum v x : cont_vec v x -> cont (square_sum v) (dot x x).
Proof. intros (H0 & H1). apply cont_add; now apply cont_sqr. Qed.

Lemma cont_inner u v x y : cont_vec u x -> cont_vec v y -> cont (inner u v) (dot x y).
Proof. intros (H0 & H1) (J0 & J1). apply cont_add; now apply cont_mul. Qed.

Theorem backward_ok e ws il l ns : cube e -> cont il l -> forall sites nus o y Do D,
  lane_ok e ws sites o y Do D -> Forall2 cont_vec ns nus -> (length ns <= length sites)%nat ->
  let t := backward il sites ns in
  exists v0 v1 v2 v3 H mu, cont (value t) v0 /\ hold1 e (sum1 t) v1 /\ hold2 e (sum2 t) v2 /\
  hold3 e e (sum3 t) v3 /\ hold_both e (on_D t) H /\ hold_both e (mult t) mu /\
  cont_vec (vector t) (hd (0, 0) nus) /\
  part (map its ws) l nus o y = v0 + v1 + v2 + v3 + dot H D - dot mu Do.
Proof.
  intros C Hl. induction ns as [| n ns IH]; intros [| s sites] nus o y Do D Lane Hns Length;
    try (simpl in Length; lia);
    try (inversion Hns; exists 0, 0, 0, 0, (0, 0), (0, 0);
         repeat split; auto using cont_zero, hold1_nil, hold2_nil, hold3_nil, hold_nothing;
         unfold dot; simpl; ring).
  inversion Hns as [| n' nu ns' nus' Hn Hns' E1 E2]. subst n' ns' nus. clear Hns.
  destruct Lane as (Y & lx & q & r & E & Dn & Ey & ED & S & (HE0 & HE1) & (HB0 & HB1) & EDn & Lane).
  destruct (IH sites nus' y (next (map its ws) o y) D Dn Lane Hns') as
    (t0 & t1 & t2 & t3 & H & mu & T0 & T1 & T2 & T3 & (TH0 & TH1) & (TM0 & TM1) & TV & ET).
  { simpl in Length. lia. }
  simpl backward. set (t := backward il sites ns) in *. clearbody t. clear IH.
  cbv zeta.
  destruct (hold_centers_affine _ _ _ TH0) as (c0 & w0 & Hc0 & Hw0).
  destruct (hold_centers_affine _ _ _ TH1) as (c1 & w1 & Hc1 & Hw1).
  assert (HM0 : hold_affine e (affine_centers (fst (on_D t))) (c0 + w0)) by now exists c0, w0.
  assert (HM1 : hold_affine e (affine_centers (snd (on_D t))) (c1 + w1)) by now exists c1, w1.
  destruct (waves_ok e Y lx q r n nu (fst (affine_centers (fst (on_D t))),
    fst (affine_centers (snd (on_D t)))) (snd (affine_centers (fst (on_D t))),
    snd (affine_centers (snd (on_D t)))) (c0, c1) (w0, w1) (view s) ws C S Hn (conj Hc0 Hc1)
    (conj Hw0 Hw1)) as (v1 & v2 & v3 & x & g0 & g1 & V1 & V2 & V3 & Hx & G0 & G1 & EW).
  rewrite <- ED, <- Ey, wave_sum in EW.
  set (ends := match ns with [] => l * dot nu nu | _ => 0 end).
  assert (Hends : cont (match (match ns with [] => Some il | _ => None end) with
    Some l => mul l (square_sum n) | None => I.zero end) ends).
  { unfold ends. destruct ns; [| exact cont_zero].
    apply cont_mul; [exact Hl | now apply cont_square_sum]. }
  pose proof K_ok as (_ & _ & _ & _ & _ & _ & _ & _ & _ & K2 & _).
  eexists _, _, _, _, (_, _), (_, _). unfold add_site. cbn [value sum1 sum2 sum3 on_D mult vector].
  split; [| split; [| split; [| split; [| split; [| split; [| split]]]]]].
  - apply cont_add; [exact T0 |]. apply cont_add; [apply cont_add; apply cont_mul |
      apply cont_add; [apply cont_sub; [apply cont_sub; [apply cont_add |] |] |
      apply cont_add; [apply cont_add; apply cont_mul |]]].
    + apply (cont_range_affine e); [exact C |]. exact (hold_minus_affine e _ _ _ _ TH0 HM0).
    + exact HB0.
    + apply (cont_range_affine e); [exact C |]. exact (hold_minus_affine e _ _ _ _ TH1 HM1).
    + exact HB1.
    + apply cont_square_sum; exact Hn.
    + apply cont_square_sum; exact Hn.
    + apply cont_mul; [exact K2 |]. apply cont_inner; [exact Hn | exact TV].
    + exact Hends.
    + exact HE0.
    + exact Hc0.
    + exact HE1.
    + exact Hc1.
    + exact Hx.
  - apply hold_add1; [exact T1 |]. apply hold_add1; [apply hold_add1; apply hold_scale1 | exact V1].
    + exact HE0.
    + exact Hw0.
    + exact HE1.
    + exact Hw1.
  - apply hold_add2; [exact T2 | exact V2].
  - apply hold_add3; [exact T3 | exact V3].
  - split; cbn [fst snd]; apply hold_plus_affine; try (apply hold_minus_affine;
      [apply hold_plus_affine |]); try exact HM0; try exact HM1; try exact TM0; try exact TM1;
      try exact G0; try exact G1.
  - split; [exact HM0 | exact HM1].
  - exact Hn.
  - simpl part. rewrite ET.
    assert (EB : Map.beta (map its ws) y nu = 2 * dot nu nu - sum (fun a =>
      amplitude (its a) * sin (angle (its a) y) * (along (its a) nu * along (its a) nu)) ws)
      by (unfold Map.beta; now rewrite sum_map).
    rewrite EB. fold ends.
    assert (EN : match nus' with [] => l * dot nu nu | _ => 0 end = ends)
      by (unfold ends; destruct Hns'; reflexivity).
    rewrite EN.
    apply (f_equal fst) in EDn as D0. apply (f_equal snd) in EDn as D1.
    unfold next_D in D0, D1. simpl in D0, D1. simpl in EW.
    assert (Dl0 : fst lx + fst r = fst D) by (now rewrite ED).
    assert (Dl1 : snd lx + snd r = snd D) by (now rewrite ED). rewrite Dl0, Dl1 in EW.
    set (push := sum _ ws) in *.
    replace (pull k0 ws Y y) with (fst Dn - 2 * fst D + fst Do - fst E) in EW by lra.
    replace (pull k1 ws Y y) with (snd Dn - 2 * snd D + snd Do - snd E) in EW by lra.
    replace push with ((c0 + w0) * (fst Dn - 2 * fst D + fst Do - fst E)
      + (c1 + w1) * (snd Dn - 2 * snd D + snd Do - snd E)
      - (v1 + v2 + v3 + x + g0 * fst D + g1 * snd D)) by lra.
    unfold dot. simpl. ring.
Qed.

End Precision.
End Bound.
