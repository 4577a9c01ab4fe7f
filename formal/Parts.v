(* From one x* to another, in intervals: where an invariant graph's successor of one point is, if that
   of another one is known (Link.links), and whether what leads into a cell over the one point leads
   into a region over the other.  docs/proofs/argument.md, section 10. *)

From Coq Require Import Reals ZArith QArith Qreals List Bool Lra Lia.
From Interval.Real Require Import Xreal.
From Interval.Float Require Import Basic Sig.
From Interval.Interval Require Import Interval.
From Converse Require Import Map Criterion Tree Torus Reduce Cover Prism.
From Converse Require Graph Link.
Import ListNotations.
Open Scope R_scope.

Definition between (a b : vec) (s : R) : vec := plus a (scale s (minus b a)).

Definition stepped (y d : Q * Q) : Q * Q := (Qred (fst y + fst d), Qred (snd y + snd d)).

Lemma point_stepped y d : point (stepped y d) = plus (point y) (point d).
Proof.
  unfold point, stepped, plus. cbn [fst snd].
  now rewrite !(Qeq_eqR _ _ (Qred_correct _)), !Q2R_plus.
Qed.

(* So often the segment from one point to the other is cut. *)
Definition pieces : nat := 16.
Definition piece_of (y z : Q * Q) : Q * Q :=
  let n := inject_Z (Z.of_nat pieces) in
  (Qred ((fst z - fst y) / n), Qred ((snd z - snd y) / n)).

Lemma point_piece y z : plus (point y) (scale (INR pieces) (point (piece_of y z))) = point z.
Proof.
  unfold point, piece_of, plus, scale. cbn [fst snd].
  rewrite !(Qeq_eqR _ _ (Qred_correct _)). unfold Qdiv. rewrite !Q2R_mult, !Q2R_minus, Q2R_inv by easy.
  rewrite Reduce.Q2R_inject_Z, <- INR_IZR_INZ. assert (INR pieces <> 0) by (apply not_0_INR; easy).
  f_equal; field; assumption.
Qed.

Module Parts (F : FloatOps with Definition radix := Zaux.radix2
                           with Definition sensible_format := true).
Include Prism F.

Section Precision.
Variable prec : F.precision.
Variable K : constants.
Hypothesis K_ok : constants_ok K.

Notation "a [+] b" := (add prec a b) (at level 50, left associativity).
Notation "a [-] b" := (sub prec a b) (at level 50, left associativity).
Notation "a [*] b" := (mul prec a b) (at level 40, left associativity).

(* ---- beta on a piece of the segment *)

(* The angle of a wave, in turns, and its amplitude for any parameters. *)
Definition turns_at (w : term) (y : Q * Q) : I.type :=
  div prec (rational prec (along_Q w y)) (two_pi K) [+] half prec (rational prec (of_phase w)).
Definition any_amplitude (w : term) : I.type :=
  fold_right (fun g i => i [+] rational prec g [*] from_minus_1_to_1 K) (rational prec (middle w))
    (parts w).

(* The most that its -p sin may be from y to z. *)
Definition crest (w : term) (y z : Q * Q) : I.type :=
  high (neg (any_amplitude w [*]
             fst (sincos prec K (join (turns_at w y) (turns_at w z))))).

Lemma turns_at_ok w t y : cont (turns_at w y) (angle (wave_at t w) (point y) / (2 * PI)).
Proof.
  replace (angle (wave_at t w) (point y) / (2 * PI)) with
    (Q2R (along_Q w y) / (2 * PI) + Q2R (of_phase w) / 2).
  - apply cont_add; [| apply cont_half, cont_rational].
    apply cont_div; [pose proof PI_neq0; lra | apply cont_rational | apply K_ok].
  - rewrite Q2R_along. unfold angle, along, wave_at, point. cbn [k0 k1 phase fst snd].
    field. apply PI_neq0.
Qed.

Lemma any_amplitude_ok w t : in_cube t -> cont (any_amplitude w) (amplitude (wave_at t w)).
Proof.
  intros Ht. unfold any_amplitude, wave_at. cbn [amplitude].
  revert t Ht. induction (parts w) as [| g l IH]; intros t Ht; cbn [fold_right].
  - unfold combined. cbn. rewrite Rplus_0_r. apply cont_rational.
  - destruct t as [| x t].
    + replace (combined (g :: l) []) with (combined l [] + Q2R g * 0)
        by (unfold combined; rewrite !combine_nil; cbn; ring).
      rewrite <- Rplus_assoc. apply cont_add; [now apply IH |].
      apply cont_mul; [apply cont_rational | apply K_ok; lra].
    + inversion Ht as [| ? ? Hx Ht']; subst.
      change (combined (g :: l) (x :: t)) with (Q2R g * x + combined l t).
      rewrite (Rplus_comm (Q2R g * x)), <- Rplus_assoc. apply cont_add; [now apply IH |].
      apply cont_mul; [apply cont_rational | now apply K_ok].
Qed.

(* Where it has no bound in this format, any number will do. *)
Lemma crest_ok w y z : exists m, cont (crest w y z) m /\ forall t s, in_cube t -> 0 <= s <= 1 ->
  - (amplitude (wave_at t w) * sin (angle (wave_at t w) (between (point y) (point z) s))) <= m.
Proof.
  unfold crest. set (i := neg _).
  assert (Hall : forall t s, in_cube t -> 0 <= s <= 1 -> cont i
    (- (amplitude (wave_at t w) * sin (angle (wave_at t w) (between (point y) (point z) s))))).
  { intros t s Ht Hs. apply cont_neg, cont_mul; [now apply any_amplitude_ok |].
    set (a := angle _ _). replace a with (2 * PI * (a / (2 * PI))) by (field; apply PI_neq0).
    apply (sincos_correct prec K K_ok).
    pose proof (turns_at_ok w t y) as Hy. pose proof (turns_at_ok w t z) as Hz.
    assert (E : a / (2 * PI) = angle (wave_at t w) (point y) / (2 * PI) + s *
      (angle (wave_at t w) (point z) / (2 * PI) - angle (wave_at t w) (point y) / (2 * PI))).
    { unfold a, between, angle, along, plus, minus, scale. cbn [fst snd]. field. apply PI_neq0. }
    rewrite E. clear E. set (p := angle _ (point y) / _) in *.
    set (q := angle _ (point z) / _) in *.
    destruct (Rle_dec p q).
    - apply (cont_between _ p _ q); [apply cont_join; now left | apply cont_join; now right | nra].
    - apply (cont_between _ q _ p); [apply cont_join; now right | apply cont_join; now left | nra]. }
  unfold high. destruct (F.real (I.upper i)) eqn:E.
  - exists (number (I.upper i)). split; [apply cont_exactly |]. intros t s Ht Hs.
    specialize (Hall t s Ht Hs). pose proof (I.upper_correct i (ex_intro _ _ Hall)) as L.
    rewrite F.real_correct in E. unfold cont, number, F.toR in *.
    change (I.F.toX (I.upper i)) with (F.toX (I.upper i)) in L.
    destruct (F.toX (I.upper i)); [discriminate |].
    destruct (I.convert i); simpl in *; [discriminate |]. subst. apply Hall.
  - exists (Rabs (Q2R (middle w)) + sum (fun g => Rabs (Q2R g)) (parts w)).
    split; [unfold exactly; rewrite E; apply cont_nai |]. intros t s Ht _.
    assert (A : Rabs (amplitude (wave_at t w))
                <= Rabs (Q2R (middle w)) + sum (fun g => Rabs (Q2R g)) (parts w)).
    { unfold wave_at. cbn [amplitude]. eapply Rle_trans; [apply Rabs_triang |].
      apply Rplus_le_compat_l. revert t Ht. clear. induction (parts w) as [| g l IH]; intros t Ht.
      - unfold combined. cbn. rewrite Rabs_R0. lra.
      - cbn [sum fold_right]. fold (sum (fun g => Rabs (Q2R g)) l).
        destruct t as [| x t].
        + unfold combined. cbn. rewrite Rabs_R0. specialize (IH [] Ht). unfold combined in IH.
          pose proof (Rabs_pos (Q2R g)).
          enough (0 <= sum (fun g => Rabs (Q2R g)) l) by lra. clear.
          induction l as [| h l IH]; cbn; [lra |]. pose proof (Rabs_pos (Q2R h)).
          unfold sum in IH. lra.
        + inversion Ht as [| ? ? Hx Ht']; subst. specialize (IH t Ht').
          change (combined (g :: l) (x :: t)) with (Q2R g * x + combined l t).
          eapply Rle_trans; [apply Rabs_triang |]. apply Rplus_le_compat; [| exact IH].
          rewrite Rabs_mult. pose proof (Rabs_pos (Q2R g)).
          assert (Rabs x <= 1) by (apply Rabs_le; lra). nra. }
    set (sn := sin _). assert (Hs : Rabs sn <= 1) by (apply Rabs_le, SIN_bound).
    eapply Rle_trans; [apply Rle_abs |]. rewrite Rabs_Ropp, Rabs_mult.
    pose proof (Rabs_pos (amplitude (wave_at t w))). pose proof (Rabs_pos sn). nra.
Qed.

(* ---- symmetric matrices, in intervals *)

Definition iform : Type := I.type * I.type * I.type.

Definition holds (i : iform) (D : Link.form) : Prop :=
  let '(a, b, d) := i in let '(p, q, r) := D in cont a p /\ cont b q /\ cont d r.

Definition ibil (i : iform) (u v : I.type * I.type) : I.type :=
  let '(a, b, d) := i in
  a [*] (fst u [*] fst v) [+] b [*] (fst u [*] snd v [+] snd u [*] fst v)
  [+] d [*] (snd u [*] snd v).

Definition iwider (i : iform) (e : I.type) : iform :=
  let '(a, b, d) := i in (a [+] e, b, d [+] e).

Lemma ibil_ok i D iu u iv v : holds i D -> cont_vec iu u -> cont_vec iv v ->
  cont (ibil i iu iv) (Link.bil D u v).
Proof.
  destruct i as [[a b] d], D as [[p q] r]. intros (Ha & Hb & Hd) [Hu0 Hu1] [Hv0 Hv1].
  unfold ibil, Link.bil. repeat (apply cont_add || apply cont_mul); assumption.
Qed.

Lemma iwider_ok i D ie e : holds i D -> cont ie e -> holds (iwider i ie) (Link.wider D e).
Proof.
  destruct i as [[a b] d], D as [[p q] r]. intros (Ha & Hb & Hd) He.
  repeat split; try assumption; now apply cont_add.
Qed.

(* Above beta from y to z, for all parameters. *)
Definition upper_beta (patch : list term) (y z : Q * Q) : iform :=
  fold_right (fun w '(a, b, d) =>
      let m := crest w y z in
      (a [+] m [*] integer prec (of_k0 w * of_k0 w), b [+] m [*] integer prec (of_k0 w * of_k1 w),
       d [+] m [*] integer prec (of_k1 w * of_k1 w)))
    (integer prec 2, I.zero, integer prec 2) patch.

Lemma upper_beta_ok patch y z : exists D, holds (upper_beta patch y z) D /\
  forall t s v, in_cube t -> 0 <= s <= 1 ->
  beta (waves patch t) (between (point y) (point z) s) v <= Link.bil D v v.
Proof.
  induction patch as [| w patch (D & HD & Hbeta)].
  - exists (2, 0, 2). split.
    + repeat split; try apply cont_integer. apply cont_zero.
    + intros t s v _ _. unfold beta, Link.bil, dot. cbn. lra.
  - destruct (crest_ok w y z) as (m & Hm & Hmost). destruct D as [[p q] r].
    exists (p + m * IZR (of_k0 w * of_k0 w), q + m * IZR (of_k0 w * of_k1 w),
            r + m * IZR (of_k1 w * of_k1 w)). split.
    + cbn [upper_beta fold_right]. fold (upper_beta patch y z).
      destruct (upper_beta patch y z) as [[a b] d]. destruct HD as (Ha & Hb & Hd).
      repeat split; apply cont_add; try assumption; apply cont_mul; try assumption;
        apply cont_integer.
    + intros t s v Ht Hs. change (waves (w :: patch) t) with (wave_at t w :: waves patch t).
      rewrite Graph.beta_cons. specialize (Hbeta t s v Ht Hs). specialize (Hmost t s Ht Hs).
      set (sn := amplitude _ * sin _) in *. set (al := along (wave_at t w) v) in *.
      assert (E : al = IZR (of_k0 w) * fst v + IZR (of_k1 w) * snd v) by reflexivity.
      assert (Hsq : 0 <= al * al) by nra.
      assert (Link.bil (p + m * IZR (of_k0 w * of_k0 w), q + m * IZR (of_k0 w * of_k1 w),
                        r + m * IZR (of_k1 w * of_k1 w)) v v
              = Link.bil (p, q, r) v v + m * (al * al)) as ->
        by (unfold Link.bil; rewrite E, !mult_IZR; ring).
      assert (- sn * (al * al) <= m * (al * al)) by (apply Rmult_le_compat_r; assumption).
      lra.
Qed.

Fixpoint betas (patch : list term) (y d : Q * Q) (n : nat) : list iform :=
  match n with
  | O => []
  | S n => upper_beta patch y (stepped y d) :: betas patch (stepped y d) d n
  end.

Lemma betas_ok patch d n : forall y, exists Ds, length Ds = n /\
  Forall2 holds (betas patch y d n) Ds /\
  forall t, in_cube t -> Link.steps (waves patch t) (point y) (point d) Ds.
Proof.
  induction n as [| n IH]; intros y.
  - exists []. repeat split. constructor.
  - destruct (IH (stepped y d)) as (Ds & Hn & HDs & Hsteps).
    destruct (upper_beta_ok patch y (stepped y d)) as (D & HD & Hbeta).
    exists (D :: Ds). cbn [length betas]. split; [now rewrite Hn |].
    split; [now constructor |]. intros t Ht. split.
    + intros s v Hs. specialize (Hbeta t s v Ht Hs). unfold between in Hbeta.
      rewrite point_stepped in Hbeta.
      now replace (minus (plus (point y) (point d)) (point y)) with (point d) in Hbeta
        by (unfold minus, plus; apply vec_eq; cbn [fst snd]; ring).
    + rewrite <- point_stepped. now apply Hsteps.
Qed.

(* ---- by how much the successors differ *)

(* From a root up: the processor's root is only a proposal, of which the square tells. *)
Definition root_above (q : I.type) : I.type :=
  let r := exactly (I.upper (sqrt prec q [*] rational prec (1000000000001 # 1000000000000)
                             [+] rational prec (1 # 2 ^ 200))) in
  if non_negative r && non_negative (sqr prec r [-] q) then r else I.nai.

Lemma root_above_ok q x : cont q x -> exists r, cont (root_above q) r /\ R_sqrt.sqrt x <= r.
Proof.
  intros Hx. unfold root_above. set (f := I.upper _).
  destruct (non_negative (exactly f) && _) eqn:E.
  - apply andb_prop in E as [Hpos Hsq]. pose proof (cont_exactly f) as Hf.
    exists (number f). split; [exact Hf |].
    pose proof (non_negative_correct _ _ Hpos Hf) as H0.
    pose proof (non_negative_correct _ _ Hsq
      (cont_sub prec _ _ _ _ (cont_sqr prec _ _ Hf) Hx)) as H1.
    rewrite <- (sqrt_square (number f)) by exact H0. apply sqrt_le_1_alt. lra.
  - exists (R_sqrt.sqrt x). split; [apply cont_nai | lra].
Qed.

(* Along u. *)
Definition moved_along (l : I.type) (d u : I.type * I.type) (betas : list iform) : I.type :=
  fold_right (fun b total =>
      let D := iwider b (neg (integer prec 2 [*] l)) in
      total [+] half prec (ibil b d u [+] from_minus_1_to_1 K [*]
                                         root_above (ibil D u u [*] ibil D d d)))
    I.zero betas.

Lemma moved_along_ok il l id d iu u is Ds X : cont il l -> cont_vec id d -> cont_vec iu u ->
  Forall2 holds is Ds ->
  Rabs (X - sum (Link.middle_of d u) Ds) <= sum (Link.radius_of l d u) Ds ->
  cont (moved_along il id iu is) X.
Proof.
  intros Hl Hd Hu H HX.
  assert (exists h, -1 <= h <= 1 /\ X = sum (Link.middle_of d u) Ds
                                       + h * sum (Link.radius_of l d u) Ds) as (h & Hh & ->).
  { destruct (in_units X _ _ HX) as (h & Hh & E). exists h. split; [exact Hh |]. lra. }
  clear HX. induction H as [| i D is Ds HD _ IH]; cbn [moved_along fold_right sum].
  - rewrite Rmult_0_r, Rplus_0_l. apply cont_zero.
  - fold (moved_along il id iu is). fold (sum (Link.middle_of d u) Ds).
    fold (sum (Link.radius_of l d u) Ds). unfold Link.middle_of at 1, Link.radius_of at 1.
    set (W := Link.wider D (-2 * l)).
    replace (_ + _ + _) with (sum (Link.middle_of d u) Ds + h * sum (Link.radius_of l d u) Ds
      + (Link.bil D d u + h * R_sqrt.sqrt (Link.bil W u u * Link.bil W d d)) / 2) by field.
    apply cont_add; [exact IH |]. apply cont_half, cont_add; [now apply ibil_ok |].
    assert (HW : holds (iwider i (neg (integer prec 2 [*] il))) W).
    { apply iwider_ok; [exact HD |]. replace (-2 * l) with (- (2 * l)) by ring.
      apply cont_neg, cont_mul; [apply cont_integer | exact Hl]. }
    destruct (root_above_ok _ _ (cont_mul prec _ _ _ _ (ibil_ok _ _ _ _ _ _ HW Hu Hu)
      (ibil_ok _ _ _ _ _ _ HW Hd Hd))) as (r & Hr & Hle).
    set (root := R_sqrt.sqrt _) in *. assert (H0 : 0 <= root) by apply sqrt_pos.
    destruct (in_units (h * root) 0 r) as (e & He & ->).
    { rewrite Rminus_0_r, Rabs_mult, (Rabs_right root) by lra.
      assert (Rabs h <= 1) by (apply Rabs_le; lra). nra. }
    rewrite Rplus_0_l, Rmult_comm. apply cont_mul; [now apply K_ok | exact Hr].
Qed.

(* In v0 and v1; None between equal points, where it is 0 and not only near it. *)
Definition displacement (patch : list term) (r : region) (l : Q) (y z : Q * Q) :
    option (I.type * I.type) :=
  if Qeq_bool (fst y) (fst z) && Qeq_bool (snd y) (snd z) then None else
  let d := piece_of y z in
  let bs := betas patch y d pieces in
  let turn := sharp_pi prec [*] integer prec (determinant r) in
  let along u0 u1 :=
    div prec (moved_along (rational prec l) (rational prec (fst d), rational prec (snd d))
                (integer prec u0, integer prec u1) bs) turn in
  Some (along (m11 r) (- m01 r)%Z, along (- m10 r)%Z (m00 r)).

Definition moved_by (i : option (I.type * I.type)) (d0 d1 : R) : Prop :=
  match i with
  | None => d0 = 0 /\ d1 = 0
  | Some i => cont (fst i) d0 /\ cont (snd i) d1
  end.

Theorem displacement_ok patch r l B y z t c S S' : determinant r <> 0%Z ->
  0 < Q2R l < 1 -> B <= Q2R l + / Q2R l ->
  (forall x v, beta (waves patch t) x v <= B * dot v v) -> in_cube t ->
  periodic S -> has_gradient S S' -> invariant_graph (waves patch t) c S' ->
  let moved := minus (Link.on_graph (waves patch t) c S' (point z))
                     (Link.on_graph (waves patch t) c S' (point y)) in
  moved_by (displacement patch r l y z) (v0_of r moved) (v1_of r moved).
Proof.
  intros Hr Hl HBl HB Ht HS HS' Hinv moved.
  unfold displacement. destruct (Qeq_bool (fst y) (fst z) && _) eqn:Esame.
  { apply andb_prop in Esame as [E0 E1]. apply Qeq_bool_eq, Qeq_eqR in E0, E1.
    assert (Ep : point z = point y) by (unfold point; now rewrite E0, E1).
    assert (Em : moved = (0, 0))
      by (unfold moved; rewrite Ep; unfold minus; apply vec_eq; cbn [fst snd]; ring).
    rewrite Em. split; unfold v0_of, v1_of, Rdiv; cbn [fst snd]; ring. }
  clear Esame. assert (A : forall u0 u1, cont
    (moved_along (rational prec l)
       (rational prec (fst (piece_of y z)), rational prec (snd (piece_of y z)))
       (integer prec u0, integer prec u1) (betas patch y (piece_of y z) pieces))
    (dot moved (IZR u0, IZR u1))).
  { intros u0 u1. destruct (betas_ok patch (piece_of y z) pieces y) as (Ds & Hn & HDs & Hsteps).
    apply moved_along_ok with (l := Q2R l) (d := point (piece_of y z)) (u := (IZR u0, IZR u1))
      (Ds := Ds); [apply cont_rational | split; apply cont_rational | split; apply cont_integer
      | exact HDs |].
    pose proof (Link.links _ c S S' HS HS' Hinv B (Q2R l) HB Hl HBl (point (piece_of y z))
      (IZR u0, IZR u1) Ds (point y) (Hsteps t Ht)) as H.
    cbv zeta in H. rewrite Hn, point_piece in H. exact H. }
  assert (Hturn : cont (sharp_pi prec [*] integer prec (determinant r)) (PI * IZR (determinant r)))
    by (apply cont_mul; [apply sharp_pi_ok | apply cont_integer]).
  assert (Hnot : PI * IZR (determinant r) <> 0).
  { apply Rmult_integral_contrapositive. split; [apply PI_neq0 | now apply not_0_IZR]. }
  cbn [moved_by fst snd]. split.
  - replace (v0_of r moved) with (dot moved (IZR (m11 r), IZR (- m01 r)) / (PI * IZR (determinant r)))
      by (unfold v0_of, dot; rewrite opp_IZR; cbn [fst snd]; f_equal; ring).
    now apply cont_div.
  - replace (v1_of r moved) with (dot moved (IZR (- m10 r), IZR (m00 r)) / (PI * IZR (determinant r)))
      by (unfold v1_of, dot; rewrite opp_IZR; cbn [fst snd]; f_equal; ring).
    now apply cont_div.
Qed.

(* ---- from cells into regions *)

(* The end of a slice of c - h .. c + h, the lower for i. *)
Definition end_of (c h : Q) (i : Z) (cuts : nat) : Q :=
  c + h * (inject_Z (2 * i) / inject_Z (2 ^ Z.of_nat cuts) - 1).

Lemma Q2R_end c h i cuts : Q2R (end_of c h i cuts) = Q2R c + Q2R h * (-1 + 2 * IZR i / power cuts).
Proof.
  unfold end_of, Qdiv. pose proof (power_pos cuts) as Hp. unfold power in *.
  rewrite Q2R_plus, Q2R_mult, Q2R_minus, Q2R_mult, Q2R_inv, !Reduce.Q2R_inject_Z, mult_IZR.
  - destruct Q2R_0_1 as [_ ->]. field. lra.
  - intros E. apply Qeq_eqR in E. rewrite Reduce.Q2R_inject_Z in E.
    destruct Q2R_0_1 as [E0 _]. rewrite E0 in E. lra.
Qed.

(* Is a slice of one range, moved so far or not at all, between these ends? *)
Definition slice_in (i : option I.type) (s : slice) (c h : Q) (ends : Q * Q) : bool :=
  let below := (end_of c h (fst s) (snd s) - fst ends)%Q in
  let above := (snd ends - end_of c h (fst s + 1) (snd s))%Q in
  match i with
  | None => Qle_bool 0 below && Qle_bool 0 above
  | Some i => non_negative (i [+] rational prec below) && non_negative (rational prec above [-] i)
  end.

Lemma slice_in_ok i x s c h ends u : slice_in i s c h ends = true ->
  match i with None => x = 0 | Some i => cont i x end -> 0 <= Q2R h ->
  in_slice s u -> Q2R (fst ends) <= Q2R c + Q2R h * u + x <= Q2R (snd ends).
Proof.
  unfold slice_in, in_slice. set (below := Qminus _ _). set (above := Qminus _ _).
  intros Hin Hx Hh [Ul Uu].
  assert (0 <= x + Q2R below /\ 0 <= Q2R above - x) as [L U].
  { destruct i as [i |]; apply andb_prop in Hin as [Hlow Hhigh].
    - split.
      + apply (non_negative_correct _ _ Hlow), cont_add; [exact Hx | apply cont_rational].
      + apply (non_negative_correct _ _ Hhigh), cont_sub; [apply cont_rational | exact Hx].
    - apply Qle_bool_iff, Qle_Rle in Hlow, Hhigh. replace (Q2R 0) with 0 in * by (unfold Q2R; cbn; ring).
      lra. }
  unfold below, above in *. rewrite Q2R_minus, Q2R_end in L. rewrite Q2R_minus, Q2R_end, plus_IZR in U.
  apply (Rmult_le_compat_l (Q2R h)) in Ul, Uu; [lra | exact Hh | exact Hh].
Qed.

(* What is combined from these numbers, for parameters in these slices, is within a half-width of a
   middle. *)
Fixpoint spread_over (gs : list Q) (ts : list slice) : Q * Q :=
  match gs, ts with
  | g :: gs, s :: ts =>
    let (m, h) := spread_over gs ts in
    (m + g * slice_middle s, h + Qabs.Qabs g * slice_half s)
  | _, _ => (0, 0)
  end%Q.

Lemma Q2R_abs q : Q2R (Qabs.Qabs q) = Rabs (Q2R q).
Proof.
  destruct q as [n d]. unfold Q2R. cbn [Qabs.Qabs Qnum Qden]. rewrite abs_IZR, Rabs_mult. f_equal.
  symmetry. apply Rabs_right, Rle_ge, Rlt_le, Rinv_0_lt_compat, IZR_lt. reflexivity.
Qed.

Lemma spread_over_ok ts t : Forall2 in_slice ts t -> forall gs,
  Rabs (combined gs t - Q2R (fst (spread_over gs ts))) <= Q2R (snd (spread_over gs ts)).
Proof.
  assert (Z : Q2R 0 = 0) by (unfold Q2R; cbn; ring).
  induction 1 as [| s u ts t Hs H IH]; intros [| g gs];
    try (unfold combined; cbn; rewrite Z, Rminus_0_r, Rabs_R0; lra).
  specialize (IH gs). cbn [spread_over]. destruct (spread_over gs ts) as [m h]. cbn [fst snd] in *.
  change (combined (g :: gs) (u :: t)) with (Q2R g * u + combined gs t).
  destruct (slice_in_Q s u Hs) as (e & He & ->). rewrite !Q2R_plus, !Q2R_mult, Q2R_abs.
  assert (Hh : 0 <= Q2R (slice_half s)).
  { unfold slice_half. pose proof (power_pos (snd s)) as Hp. unfold power in Hp.
    rewrite Q2R_inv, Reduce.Q2R_inject_Z; [now apply Rlt_le, Rinv_0_lt_compat |].
    intros E. apply Qeq_eqR in E. rewrite Reduce.Q2R_inject_Z, Z in E. lra. }
  replace (_ - _) with (combined gs t - Q2R m + Q2R g * Q2R (slice_half s) * e) by ring.
  eapply Rle_trans; [apply Rabs_triang |]. apply Rplus_le_compat; [exact IH |].
  rewrite !Rabs_mult, (Rabs_right (Q2R (slice_half s))) by lra.
  assert (Rabs e <= 1) by (apply Rabs_le; lra).
  assert (0 <= Rabs (Q2R g) * Q2R (slice_half s)) by (apply Rmult_le_pos; [apply Rabs_pos | exact Hh]).
  nra.
Qed.

(* Where a number must be, if what the parameters of these slices add to it, s, and to c, s', is to
   leave it within h of c. *)
Definition ends_within (s s' : list Q) (ts : list slice) (c h : Q) : Q * Q :=
  let (m, w) := spread_over (added (-1) s s') ts in (Qred (c - h - m + w), Qred (c + h - m - w)).

Lemma ends_within_ok s s' ts c h t v : Forall2 in_slice ts t ->
  Q2R (fst (ends_within s s' ts c h)) <= v <= Q2R (snd (ends_within s s' ts c h)) ->
  Rabs (v + combined s t - (Q2R c + combined s' t)) <= Q2R h.
Proof.
  intros H. pose proof (spread_over_ok ts t H (added (-1) s s')) as S. rewrite combined_added in S.
  unfold ends_within. destruct (spread_over _ ts) as [m w]. cbn [fst snd] in *.
  rewrite !(Qeq_eqR _ _ (Qred_correct _)), Q2R_minus, !Q2R_plus, !Q2R_minus, Q2R_plus.
  replace (Q2R (-1)) with (-1) in S by (unfold Q2R; cbn; lra).
  intros Hv. apply Rcomplements.Rabs_le_between in S. apply Rabs_le. lra.
Qed.

(* Is a point in the region that the parameters t have shifted? *)
Definition into_shifted (r : region) (s : list Q * list Q) (t : list R) (y : vec) : Prop :=
  exists v0 v1 (i j : Z),
  Rabs (v0 - (Q2R (centre0 r) + combined (fst s) t)) <= Q2R (half0 r) /\
  Rabs (v1 - (Q2R (centre1 r) + combined (snd s) t)) <= Q2R (half1 r) /\
  y = plus (at_v r v0 v1) (Criterion.turns i j).

(* The region where nothing is shifted. *)
Lemma into_unshifted r t y : into r y -> into_shifted r ([], []) t y.
Proof.
  intros (v0 & v1 & i & j & H0 & H1 & E). exists v0, v1, i, j. cbn [fst snd].
  change (combined [] t) with 0. rewrite !Rplus_0_r. repeat split; assumption.
Qed.

(* From a cell over one point into the region over another one, whose ranges have these ends where
   those of the first are not shifted. *)
Definition ends_of (r' : region) (s s' : list Q * list Q) (ts : list slice) : (Q * Q) * (Q * Q) :=
  (ends_within (fst s) (fst s') ts (centre0 r') (half0 r'),
   ends_within (snd s) (snd s') ts (centre1 r') (half1 r')).

Definition leads_into (i : option (I.type * I.type)) (r : region) (ends : (Q * Q) * (Q * Q))
    (cl : cell) : bool :=
  match cl with
  | s0 :: s1 :: _ => slice_in (option_map fst i) s0 (centre0 r) (half0 r) (fst ends)
                     && slice_in (option_map snd i) s1 (centre1 r) (half1 r) (snd ends)
  | _ => false
  end.

Lemma leads_into_ok i r r' s s' cl u0 u1 t y z p q : determinant r <> 0%Z ->
  m00 r' = m00 r -> m01 r' = m01 r -> m10 r' = m10 r -> m11 r' = m11 r ->
  0 <= Q2R (half0 r) -> 0 <= Q2R (half1 r) ->
  leads_into i r (ends_of r' s s' (skipn 2 cl)) cl = true -> in_cell cl (u0 :: u1 :: t) ->
  y = plus (at_v r (Q2R (centre0 r) + combined (fst s) t + Q2R (half0 r) * u0)
                   (Q2R (centre1 r) + combined (snd s) t + Q2R (half1 r) * u1))
           (Criterion.turns p q) ->
  moved_by i (v0_of r (minus z y)) (v1_of r (minus z y)) -> into_shifted r' s' t z.
Proof.
  intros Hr E00 E01 E10 E11 H0 H1 Hin Hu Hy Hi.
  assert (match option_map fst i with None => v0_of r (minus z y) = 0
                                    | Some i => cont i (v0_of r (minus z y)) end) as Hi0
    by (destruct i; apply Hi).
  assert (match option_map snd i with None => v1_of r (minus z y) = 0
                                    | Some i => cont i (v1_of r (minus z y)) end) as Hi1
    by (destruct i; apply Hi).
  clear Hi.
  inversion Hu as [| s0 ? cl0 ? Hs0 Hu0]; subst cl. inversion Hu0 as [| s1 ? cl1 ? Hs1 Ht]; subst cl0.
  cbn [leads_into skipn] in Hin. apply andb_prop in Hin as [Hin0 Hin1]. unfold ends_of in Hin0, Hin1.
  pose proof (ends_within_ok _ _ _ _ _ t _ Ht (slice_in_ok _ _ _ _ _ _ _ Hin0 Hi0 H0 Hs0)) as R0.
  pose proof (ends_within_ok _ _ _ _ _ t _ Ht (slice_in_ok _ _ _ _ _ _ _ Hin1 Hi1 H1 Hs1)) as R1.
  exists (Q2R (centre0 r) + Q2R (half0 r) * u0 + v0_of r (minus z y) + combined (fst s) t),
    (Q2R (centre1 r) + Q2R (half1 r) * u1 + v1_of r (minus z y) + combined (snd s) t), p, q.
  split; [exact R0 |]. split; [exact R1 |]. pose proof (at_v_of r Hr (minus z y)) as E.
  clear R0 R1 Hi0 Hi1. unfold at_v at 1. rewrite E00, E01, E10, E11.
  generalize dependent (v0_of r (minus z y)). generalize dependent (v1_of r (minus z y)).
  intros d1 d0 E. unfold at_v, plus, minus, Criterion.turns in *. injection E as Ez0 Ez1.
  rewrite Hy in Ez0, Ez1. cbn [fst snd] in *. apply vec_eq; cbn [fst snd]; lra.
Qed.
End Precision.
End Parts.
