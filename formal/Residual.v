(* The residual of a trigonometric polynomial u0, bounded with integers.

   A list p of integers and the number k of its first mode stand for the sum of p[j] e^{i (k + j) t};
   `re` and `im` are the real and the imaginary part of the sum.  i u0 is such a list, W, divided by 2 D.
   Each term of the series of e^{i u0} is computed from the term before, in units of 1/one.  The
   remainders of the divisions are bounded in the norm of Fourier.v. *)

From Coq Require Import Reals ZArith List Lra Lia Psatz.
From Coquelicot Require Import Coquelicot.
From Converse Require Import Fourier Taylor Newton.
From Converse Require Sine.
Import ListNotations.
Open Scope R_scope.

Fixpoint re (k : Z) (p : list Z) (t : R) : R :=
  match p with [] => 0 | a :: p => IZR a * cos (IZR k * t) + re (k + 1) p t end.
Fixpoint im (k : Z) (p : list Z) (t : R) : R :=
  match p with [] => 0 | a :: p => IZR a * sin (IZR k * t) + im (k + 1) p t end.
Fixpoint norm (r : R) (k : Z) (p : list Z) : R :=
  match p with [] => 0 | a :: p => Rabs (IZR a) * weight r k + norm r (k + 1) p end.

Fixpoint add (p q : list Z) : list Z :=
  match p, q with
  | [], _ => q
  | _, [] => p
  | a :: p, b :: q => (a + b)%Z :: add p q
  end.
Fixpoint mul (p q : list Z) : list Z :=
  match p with [] => [] | a :: p => add (map (Z.mul a) q) (0%Z :: mul p q) end.

Lemma add_re_im p q k t : re k (add p q) t = re k p t + re k q t /\ im k (add p q) t = im k p t + im k q t.
Proof.
  revert q k. induction p as [| a p IH]; intros [| b q] k; simpl; try lra.
  destruct (IH q (k + 1)%Z) as [-> ->]. rewrite plus_IZR. lra.
Qed.

Lemma scale_re_im a p k t : re k (map (Z.mul a) p) t = IZR a * re k p t /\
  im k (map (Z.mul a) p) t = IZR a * im k p t.
Proof.
  revert k. induction p as [| b p IH]; intros k; simpl; [lra |].
  destruct (IH (k + 1)%Z) as [-> ->]. rewrite mult_IZR. lra.
Qed.

(* The modes by k further. *)
Lemma moved_re_im k l p t : re (k + l) p t = cos (IZR k * t) * re l p t - sin (IZR k * t) * im l p t
                        /\ im (k + l) p t = sin (IZR k * t) * re l p t + cos (IZR k * t) * im l p t.
Proof.
  revert l. induction p as [| a p IH]; intros l; simpl; [lra |].
  replace (k + l + 1)%Z with (k + (l + 1))%Z by ring. destruct (IH (l + 1)%Z) as [-> ->].
  rewrite plus_IZR, Rmult_plus_distr_r, cos_plus, sin_plus. split; ring.
Qed.

Lemma mul_re_im p q k l t : re (k + l) (mul p q) t = re k p t * re l q t - im k p t * im l q t
                        /\ im (k + l) (mul p q) t = im k p t * re l q t + re k p t * im l q t.
Proof.
  revert k. induction p as [| a p IH]; intros k; cbn [mul re im]; [lra |].
  destruct (add_re_im (map (Z.mul a) q) (0%Z :: mul p q) (k + l) t) as [-> ->].
  destruct (scale_re_im a q (k + l) t) as [-> ->]. destruct (moved_re_im k l q t) as [-> ->].
  cbn [re im]. replace (k + l + 1)%Z with (k + 1 + l)%Z by ring. destruct (IH (k + 1)%Z) as [-> ->].
  split; ring.
Qed.

Lemma app_re_im p q k t : re k (p ++ q) t = re k p t + re (k + Z.of_nat (length p)) q t
                      /\ im k (p ++ q) t = im k p t + im (k + Z.of_nat (length p)) q t.
Proof.
  revert k. induction p as [| a p IH]; intros k.
  - cbn [app length re im]. replace (k + Z.of_nat 0)%Z with k by lia. lra.
  - cbn [app length re im]. destruct (IH (k + 1)%Z) as [-> ->].
    replace (k + 1 + Z.of_nat (length p))%Z with (k + Z.of_nat (S (length p)))%Z by lia. lra.
Qed.

Lemma rev_re_im p k t : re k (rev p) t = re (1 - k - Z.of_nat (length p)) p t
                    /\ im k (rev p) t = - im (1 - k - Z.of_nat (length p)) p t.
Proof.
  revert k. induction p as [| a p IH]; intros k; [simpl; lra |]. cbn [rev].
  destruct (app_re_im (rev p) [a] k t) as [-> ->]. destruct (IH k) as [-> ->].
  rewrite rev_length. cbn [length re im].
  replace (1 - k - Z.of_nat (S (length p)) + 1)%Z with (1 - k - Z.of_nat (length p))%Z by lia.
  replace (1 - k - Z.of_nat (S (length p)))%Z with (- (k + Z.of_nat (length p)))%Z by lia.
  rewrite opp_IZR, <- Ropp_mult_distr_l, cos_neg, sin_neg. lra.
Qed.

Lemma bounded_re_im r k p : bounded r (norm r k p) (re k p) * bounded r (norm r k p) (im k p).
Proof.
  revert k. induction p as [| a p IH]; intros k; cbn [norm].
  - split; apply (bounded_ext (bounded_const r 0)); reflexivity || (rewrite Rabs_R0; lra).
  - destruct (IH (k + 1)%Z) as [Hr Hi]. split.
    + exact (bounded_plus (bounded_scal (IZR a) (bounded_cos r k)) Hr).
    + exact (bounded_plus (bounded_scal (IZR a) (bounded_sin r k)) Hi).
Qed.

(* ---- norms, in integers, with r = rn/rd *)
Section Run.
Variables rn rd : Z.
Hypotheses (Hrd : (0 < rd)%Z) (Hr : (rd <= rn)%Z).
Let r : R := IZR rn / IZR rd.

Definition ceil (a b : Z) : Z := (- ((- a) / b))%Z.

Lemma ceil_above a b : (0 < b)%Z -> IZR a / IZR b <= IZR (ceil a b).
Proof.
  intros H. unfold ceil. rewrite opp_IZR. pose proof (Z.mul_div_le (- a) b H) as L.
  apply IZR_le in L. rewrite mult_IZR, opp_IZR in L. apply IZR_lt in H.
  apply Rmult_le_reg_r with (IZR b); [exact H |]. replace (IZR a / IZR b * IZR b) with (IZR a)
    by (field; lra). lra.
Qed.

Lemma r_1 : 1 <= r.
Proof.
  unfold r. apply IZR_lt in Hrd. apply IZR_le in Hr.
  apply Rmult_le_reg_r with (IZR rd); [exact Hrd |].
  replace (IZR rn / IZR rd * IZR rd) with (IZR rn) by (field; lra). lra.
Qed.

Definition times_r (a : Z) : Z := ceil (rn * a) rd.

Lemma times_r_above a : r * IZR a <= IZR (times_r a).
Proof.
  eapply Rle_trans; [| now apply ceil_above]. rewrite mult_IZR. unfold r, Rdiv. apply Req_le. ring.
Qed.

(* From the mode 0 on, *)
Fixpoint size_up (p : list Z) : Z := match p with [] => 0 | a :: p => Z.abs a + times_r (size_up p) end.
(* and from -c on; `before` is what has been passed. *)
Fixpoint size_from (c : nat) (before : Z) (p : list Z) : Z :=
  match c, p with
  | O, _ => before + size_up p
  | S c, [] => size_from c (times_r before) []
  | S c, a :: p => size_from c (times_r (before + Z.abs a)) p
  end.

Lemma weight_up k : (0 <= k)%Z -> weight r (k + 1) = r * weight r k.
Proof. intros H. unfold weight. replace (Z.abs_nat (k + 1)) with (S (Z.abs_nat k)) by lia. reflexivity. Qed.

Lemma norm_up k p : (0 <= k)%Z -> norm r k p <= weight r k * IZR (size_up p).
Proof.
  pose proof r_1 as R1. revert k. induction p as [| a p IH]; intros k Hk; cbn [norm size_up]; [lra |].
  specialize (IH (k + 1)%Z ltac:(lia)). rewrite weight_up in IH by exact Hk.
  pose proof (times_r_above (size_up p)). rewrite plus_IZR, abs_IZR.
  pose proof (weight_1 r k R1). nra.
Qed.

Lemma norm_from c before p :
  IZR before * weight r (Z.of_nat c) + norm r (- Z.of_nat c) p <= IZR (size_from c before p).
Proof.
  pose proof r_1 as R1. revert before p. induction c as [| c IH]; intros before p.
  - cbn [size_from]. rewrite plus_IZR. pose proof (norm_up 0 p ltac:(lia)) as H.
    change (weight r (Z.of_nat 0)) with 1. change (weight r 0) with 1 in H. simpl (- Z.of_nat 0)%Z. lra.
  - assert (E : weight r (Z.of_nat (S c)) = r * weight r (Z.of_nat c)).
    { replace (Z.of_nat (S c)) with (Z.of_nat c + 1)%Z by lia. apply weight_up. lia. }
    pose proof (weight_1 r (Z.of_nat c) R1). destruct p as [| a p].
    + cbn [size_from]. eapply Rle_trans; [| apply IH]. rewrite E. cbn [norm].
      pose proof (times_r_above before). nra.
    + cbn [size_from]. eapply Rle_trans; [| apply IH]. rewrite E. cbn [norm].
      replace (weight r (- Z.of_nat (S c))) with (r * weight r (Z.of_nat c))
        by (rewrite <- E; unfold weight; f_equal; lia).
      replace (- Z.of_nat (S c) + 1)%Z with (- Z.of_nat c)%Z by lia.
      pose proof (times_r_above (before + Z.abs a)) as T. rewrite plus_IZR, abs_IZR in T. nra.
Qed.

(* ---- the terms of the series *)
Variables (b : list Z) (D one : Z).
Hypotheses (HD : (0 < D)%Z) (Hone : (0 < one)%Z).

Definition u0 (t : R) : R := im 1 b t / IZR D.
Definition W : list Z := rev (map (Z.mul (-1)) b) ++ 0%Z :: b.
Definition top : Z := times_r (size_up b).

Lemma u0_bounded : bounded r (IZR top / IZR D) u0.
Proof.
  refine (bounded_ext (bounded_scal (/ IZR D) (snd (bounded_re_im r 1 b))) _ _).
  - intros t. unfold u0. field. apply IZR_lt in HD. lra.
  - apply IZR_lt in HD. rewrite Rabs_right by (apply Rle_ge, Rlt_le, Rinv_0_lt_compat; lra).
    unfold Rdiv. rewrite Rmult_comm. apply Rmult_le_compat_r; [apply Rlt_le, Rinv_0_lt_compat; lra |].
    pose proof (norm_up 1 b ltac:(lia)) as H. unfold top. pose proof (times_r_above (size_up b)).
    unfold weight in H. simpl in H. lra.
Qed.

Lemma W_re_im t : re (- Z.of_nat (length b)) W t = 0 /\ im (- Z.of_nat (length b)) W t = 2 * IZR D * u0 t.
Proof.
  unfold W, u0.
  destruct (app_re_im (rev (map (Z.mul (-1)) b)) (0%Z :: b) (- Z.of_nat (length b)) t) as [-> ->].
  destruct (rev_re_im (map (Z.mul (-1)) b) (- Z.of_nat (length b)) t) as [-> ->].
  rewrite rev_length, map_length.
  replace (1 - - Z.of_nat (length b) - Z.of_nat (length b))%Z with 1%Z by lia.
  replace (- Z.of_nat (length b) + Z.of_nat (length b))%Z with 0%Z by lia.
  destruct (scale_re_im (-1) b 1 t) as [-> ->]. cbn [re im]. change (0 + 1)%Z with 1%Z.
  split; [ring | field]. apply IZR_lt in HD. lra.
Qed.

(* Lists whose first mode is -c, without zeros at their ends; *)
Fixpoint without_first (c : nat) (p : list Z) : nat * list Z :=
  match c, p with S c, 0%Z :: p => without_first c p | _, _ => (c, p) end.
Fixpoint without_last (p : list Z) : list Z :=
  match p with
  | [] => []
  | a :: p => match a, without_last p with 0%Z, [] => [] | _, p => a :: p end
  end.
(* and their sum. *)
Definition sum_of (p q : nat * list Z) : nat * list Z :=
  let c := Nat.max (fst p) (fst q) in
  (c, add (repeat 0%Z (c - fst p) ++ snd p) (repeat 0%Z (c - fst q) ++ snd q)).

Fixpoint series (j : nat) : (nat * list Z) * (nat * list Z) * Z * Z :=
  match j with
  | O => ((0%nat, [one]), (0%nat, [one]), 0, 0)%Z
  | S m =>
      let '(T, sum, eT, e) := series m in
      let q := (2 * D * Z.of_nat (S m))%Z in
      let c := (length b + fst T)%nat in
      let X := mul W (snd T) in
      let T' := without_first c (without_last (map (fun a => Z.quot a q) X)) in
      let eT' := ceil (2 * top * eT + size_from c 0 (map (fun a => Z.rem a q) X)) q in
      (T', sum_of sum T', eT', e + eT')%Z
  end.

(* Two functions by the list p with the unit 1/one, up to e. *)
Definition by_list (p : nat * list Z) (e : Z) (f g : R -> R) : Type :=
  (bounded r (IZR e / IZR one) (fun t => f t - re (- Z.of_nat (fst p)) (snd p) t / IZR one) *
   bounded r (IZR e / IZR one) (fun t => g t - im (- Z.of_nat (fst p)) (snd p) t / IZR one))%type.

Lemma quot_re_im q p k t :
  re k p t = IZR q * re k (map (fun a => Z.quot a q) p) t + re k (map (fun a => Z.rem a q) p) t /\
  im k p t = IZR q * im k (map (fun a => Z.quot a q) p) t + im k (map (fun a => Z.rem a q) p) t.
Proof.
  revert k. induction p as [| a p IH]; intros k; simpl; [lra |].
  destruct (IH (k + 1)%Z) as [E1 E2]. rewrite E1, E2. pose proof (Z.quot_rem' a q) as E.
  apply (f_equal IZR) in E. rewrite plus_IZR, mult_IZR in E. rewrite E. lra.
Qed.

Lemma zeros_re_im n p k t : re k (repeat 0%Z n ++ p) t = re (k + Z.of_nat n) p t /\
  im k (repeat 0%Z n ++ p) t = im (k + Z.of_nat n) p t.
Proof.
  revert k. induction n as [| n IH]; intros k; cbn [repeat app re im].
  - replace (k + Z.of_nat 0)%Z with k by lia. lra.
  - destruct (IH (k + 1)%Z) as [-> ->]. replace (k + 1 + Z.of_nat n)%Z with (k + Z.of_nat (S n))%Z
      by lia. lra.
Qed.

Lemma without_first_re_im c p t : let p' := without_first c p in
  re (- Z.of_nat (fst p')) (snd p') t = re (- Z.of_nat c) p t /\
    im (- Z.of_nat (fst p')) (snd p') t = im (- Z.of_nat c) p t.
Proof.
  revert p. induction c as [| c IH]; intros p; [now split |].
  destruct p as [| [| a | a] p]; try now split. cbv zeta in *. cbn [without_first].
  destruct (IH p) as [-> ->].
  cbn [re im]. replace (- Z.of_nat (S c) + 1)%Z with (- Z.of_nat c)%Z by lia. lra.
Qed.

Lemma without_last_re_im k p t : re k (without_last p) t = re k p t /\ im k (without_last p) t = im k p t.
Proof.
  revert k. induction p as [| a p IH]; intros k; [now split |]. cbn [without_last].
  destruct (IH (k + 1)%Z) as [E1 E2]. cbn [re im]. rewrite <- E1, <- E2.
  destruct a; destruct (without_last p); cbn [re im]; lra.
Qed.

Lemma sum_of_re_im p q t : let s := sum_of p q in
  re (- Z.of_nat (fst s)) (snd s) t
    = re (- Z.of_nat (fst p)) (snd p) t + re (- Z.of_nat (fst q)) (snd q) t /\
  im (- Z.of_nat (fst s)) (snd s) t
    = im (- Z.of_nat (fst p)) (snd p) t + im (- Z.of_nat (fst q)) (snd q) t.
Proof.
  unfold sum_of. cbn [fst snd]. set (c := Nat.max _ _).
  destruct (add_re_im (repeat 0%Z (c - fst p) ++ snd p) (repeat 0%Z (c - fst q) ++ snd q)
    (- Z.of_nat c) t) as [-> ->].
  destruct (zeros_re_im (c - fst p) (snd p) (- Z.of_nat c) t) as [-> ->].
  destruct (zeros_re_im (c - fst q) (snd q) (- Z.of_nat c) t) as [-> ->].
  replace (- Z.of_nat c + Z.of_nat (c - fst p))%Z with (- Z.of_nat (fst p))%Z by lia.
  replace (- Z.of_nat c + Z.of_nat (c - fst q))%Z with (- Z.of_nat (fst q))%Z by lia. now split.
Qed.

Lemma series_right j : let '(T, sum, eT, e) := series j in
  by_list T eT (fun t => fst (cos_sin j) * u0 t ^ j) (fun t => snd (cos_sin j) * u0 t ^ j) *
  by_list sum e (fun t => Cos (S j) (u0 t)) (fun t => Sin (S j) (u0 t)).
Proof.
  apply IZR_lt in HD as HD'. apply IZR_lt in Hone as Hone'.
  induction j as [| j IH].
  - cbn [series].
    assert (H : forall f : R -> R, (forall t, f t = 0) -> bounded r (0 / IZR one) f).
    { intros f E. apply (bounded_ext (bounded_const r 0)); [exact E | rewrite Rabs_R0; lra]. }
    split; split; apply H; intros t; unfold Cos, Sin; simpl; rewrite (Rmult_0_l t), ?cos_0, ?sin_0;
      field; lra.
  - cbn [series]. destruct (series j) as [[[T sum] eT] e]. destruct IH as [[Tr Ti] [Sr Si]].
    set (q := (2 * D * Z.of_nat (S j))%Z). set (n := length b). set (c := (n + fst T)%nat).
    set (X := mul W (snd T)).
    set (Q := map (fun a => Z.quot a q) X). set (Rm := map (fun a => Z.rem a q) X).
    set (T' := without_first c (without_last Q)). set (eT' := ceil _ q).
    set (k := (- Z.of_nat (fst T))%Z) in *. set (k' := (- Z.of_nat c)%Z).
    assert (Ek : k' = (- Z.of_nat n + k)%Z) by (unfold k', k, c; lia).
    assert (EQ : forall t, re (- Z.of_nat (fst T')) (snd T') t = re k' Q t /\
                           im (- Z.of_nat (fst T')) (snd T') t = im k' Q t).
    { intros t. destruct (without_first_re_im c (without_last Q) t) as [E1 E2]. fold T' k' in E1, E2.
      destruct (without_last_re_im k' Q t) as [E3 E4]. rewrite E1, E2, E3, E4. now split. }
    assert (Hq : (0 < q)%Z) by (unfold q; nia). apply IZR_lt in Hq as Hq'.
    assert (Eq : IZR q = 2 * IZR D * (INR j + 1))
      by (unfold q; now rewrite !mult_IZR, <- INR_IZR_INZ, S_INR).
    assert (Hj : 0 < INR j + 1) by (pose proof (pos_INR j); lra).
    assert (HR := bounded_re_im r k' Rm).
    assert (HRn : norm r k' Rm <= IZR (size_from c 0 Rm)).
    { pose proof (norm_from c 0 Rm). fold k' in H. lra. }
    assert (EX : forall t, re k' X t = - (2 * IZR D * u0 t) * im k (snd T) t /\
                           im k' X t = 2 * IZR D * u0 t * re k (snd T) t).
    { intros t. rewrite Ek. unfold X. destruct (mul_re_im W (snd T) (- Z.of_nat n) k t) as [-> ->].
      destruct (W_re_im t) as [E1 E2]. fold n in E1, E2. rewrite E1, E2. split; ring. }
    assert (HT : by_list T' eT' (fun t => fst (cos_sin (S j)) * u0 t ^ S j)
                                (fun t => snd (cos_sin (S j)) * u0 t ^ S j)).
    { assert (L : IZR top / IZR D * (IZR eT / IZR one) / (INR j + 1)
                  + IZR (size_from c 0 Rm) / (IZR q * IZR one) <= IZR eT' / IZR one).
      { pose proof (ceil_above (2 * top * eT + size_from c 0 Rm) q Hq) as H. fold eT' in H.
        rewrite plus_IZR, !mult_IZR in H. apply (Rmult_le_compat_r (/ IZR one)) in H;
          [| apply Rlt_le, Rinv_0_lt_compat; lra].
        eapply Rle_trans; [| exact H]. apply Req_le. rewrite Eq. field. lra. }
      assert (HU := u0_bounded). assert (Hn0 : 0 < / (IZR q * IZR one)) by (apply Rinv_0_lt_compat; nra).
      assert (Hj0 : 0 < / (INR j + 1)) by (apply Rinv_0_lt_compat; lra).
      split.
      - refine (bounded_ext (bounded_plus (bounded_scal (- / (INR j + 1)) (bounded_mult r_1 HU Ti))
          (bounded_scal (/ (IZR q * IZR one)) (fst HR))) _ _).
        + intros t. destruct (quot_re_im q X k' t) as [E1 _]. destruct (EX t) as [E2 _]. rewrite E2 in E1.
          fold Q Rm in E1.
          assert (E3 : re k' Q t = (- (2 * IZR D * u0 t) * im k (snd T) t - re k' Rm t) / IZR q)
            by (rewrite E1; field; lra).
          destruct (EQ t) as [-> _]. rewrite E3. cbn [cos_sin fst pow]. rewrite Eq. field. lra.
        + rewrite Rabs_Ropp, !Rabs_right by lra. eapply Rle_trans; [| exact L]. unfold Rdiv at 4.
          unfold Rdiv in *. nra.
      - refine (bounded_ext (bounded_plus (bounded_scal (/ (INR j + 1)) (bounded_mult r_1 HU Tr))
          (bounded_scal (/ (IZR q * IZR one)) (snd HR))) _ _).
        + intros t. destruct (quot_re_im q X k' t) as [_ E1]. destruct (EX t) as [_ E2]. rewrite E2 in E1.
          fold Q Rm in E1.
          assert (E3 : im k' Q t = (2 * IZR D * u0 t * re k (snd T) t - im k' Rm t) / IZR q)
            by (rewrite E1; field; lra).
          destruct (EQ t) as [_ ->]. rewrite E3. cbn [cos_sin snd pow]. rewrite Eq. field. lra.
        + rewrite !Rabs_right by lra. eapply Rle_trans; [| exact L]. unfold Rdiv in *. nra. }
    split; [exact HT |]. destruct HT as [Tr' Ti'].
    split.
    + refine (bounded_ext (bounded_plus Sr Tr') _ _).
      * intros t. destruct (sum_of_re_im sum T' t) as [-> _].
        change (Cos (S (S j)) (u0 t)) with (Cos (S j) (u0 t) + fst (cos_sin (S j)) * u0 t ^ S j).
        field. lra.
      * rewrite plus_IZR. apply Req_le. field. lra.
    + refine (bounded_ext (bounded_plus Si Ti') _ _).
      * intros t. destruct (sum_of_re_im sum T' t) as [_ ->].
        change (Sin (S (S j)) (u0 t)) with (Sin (S j) (u0 t) + snd (cos_sin (S j)) * u0 t ^ S j).
        field. lra.
      * rewrite plus_IZR. apply Req_le. field. lra.
Qed.

(* ---- the residual *)

(* The sine of t + u0, as a sum of sines from the mode 1 on: each mode -k is turned round.  `done` has
   those that have been. *)
Fixpoint folded (c : nat) (done p : list Z) : list Z :=
  match c, p with
  | O, [] => done
  | O, _ :: p => add done p
  | S c, [] => folded c (0%Z :: done) []
  | S c, a :: p => folded c ((- a)%Z :: done) p
  end.

Lemma folded_im c done p t : im 1 (folded c done p) t = im (Z.of_nat c + 1) done t + im (- Z.of_nat c) p t.
Proof.
  revert done p. induction c as [| c IH]; intros done p.
  - destruct p as [| a p]; cbn [folded]; [simpl; lra |].
    destruct (add_re_im done p 1 t) as [_ ->]. simpl. rewrite Rmult_0_l, sin_0. ring.
  - destruct p as [| a p]; cbn [folded]; rewrite IH; cbn [im];
      replace (Z.of_nat c + 1 + 1)%Z with (Z.of_nat (S c) + 1)%Z by lia.
    + lra.
    + replace (- Z.of_nat (S c) + 1)%Z with (- Z.of_nat c)%Z by lia.
      replace (- Z.of_nat (S c))%Z with (- (Z.of_nat c + 1))%Z by lia.
      replace (IZR (- (Z.of_nat c + 1)) * t) with (- (IZR (Z.of_nat c + 1) * t)) by (rewrite opp_IZR; ring).
      rewrite sin_neg, opp_IZR. ring.
Qed.

(* The amplitude is en/ed; c has the numbers (2 cos(k w) - 2) one, nearly. *)
Variables (w : R) (en ed : Z) (cs : list Z).
Hypotheses (Hed : (0 < ed)%Z).

Fixpoint close (k : Z) (b cs : list Z) : Prop :=
  match b, cs with
  | [], _ => True
  | _ :: _, [] => False
  | _ :: b, c :: cs => Rabs (IZR one * (2 * cos (IZR k * w) - 2) - IZR c) <= 1 /\ close (k + 1) b cs
  end.

Fixpoint products (b cs : list Z) : list Z :=
  match b, cs with a :: b, c :: cs => (a * c)%Z :: products b cs | _, _ => [] end.

Lemma second_difference k p q : close k p q -> bounded r (norm r k p)
  (fun t => IZR one * (im k p (t + w) - 2 * im k p t + im k p (t - w)) - im k (products p q) t).
Proof.
  revert k q. induction p as [| a p IH]; intros k [| c q] H; try contradiction;
    [| | destruct H as [Hc H]; specialize (IH (k + 1)%Z q H)];
    try (apply (bounded_ext (bounded_const r 0));
         [intros t; simpl; ring | rewrite Rabs_R0; simpl; lra]).
  cbn [products im norm].
  refine (bounded_ext (bounded_plus IH (bounded_scal
    (IZR a * (IZR one * (2 * cos (IZR k * w) - 2) - IZR c)) (bounded_sin r k))) _ _).
  - intros t. replace (IZR k * (t + w)) with (IZR k * t + IZR k * w) by ring.
    replace (IZR k * (t - w)) with (IZR k * t - IZR k * w) by ring.
    rewrite sin_plus, sin_minus, mult_IZR. ring.
  - rewrite Rabs_mult. pose proof (weight_1 r k r_1). pose proof (Rabs_pos (IZR a)).
    assert (Rabs (IZR a) * Rabs (IZR one * (2 * cos (IZR k * w) - 2) - IZR c) <= Rabs (IZR a)) by nra. nra.
Qed.

Definition kick_list (sum : nat * list Z) : list Z :=
  match sum with (O, p) => p | (S c, p) => folded c [] p end.
Definition residual_list (sum : nat * list Z) : list Z :=
  add (map (Z.mul ed) (products b cs)) (map (Z.mul (- (en * D))) (kick_list sum)).

Lemma kick_list_im sum t : im 1 (kick_list sum) t
  = sin t * re (- Z.of_nat (fst sum)) (snd sum) t + cos t * im (- Z.of_nat (fst sum)) (snd sum) t.
Proof.
  replace (sin t) with (sin (IZR 1 * t)) by (f_equal; ring).
  replace (cos t) with (cos (IZR 1 * t)) by (f_equal; ring).
  destruct (moved_re_im 1 (- Z.of_nat (fst sum)) (snd sum) t) as [_ <-].
  destruct sum as [[| c] p]; cbn [kick_list fst snd]; [reflexivity |]. rewrite folded_im. cbn [im].
  replace (1 + - Z.of_nat (S c))%Z with (- Z.of_nat c)%Z by lia. ring.
Qed.

Definition size_residual (s : (nat * list Z) * (nat * list Z) * Z * Z) : Z :=
  times_r (size_up (residual_list (snd (fst (fst s))))).

Lemma residual_bounded j : close 1 b cs ->
  let h := size_residual (series j) in let e := snd (series j) in
  bounded r (IZR h / (IZR D * IZR ed * IZR one) + IZR top / (IZR D * IZR one)
             + 2 * r * (Rabs (IZR en / IZR ed) * (IZR e / IZR one)))
    (residual w (IZR en / IZR ed) (S j) u0).
Proof.
  intros Hcs. apply IZR_lt in HD as HD'. apply IZR_lt in Hone as Hone'. apply IZR_lt in Hed as Hed'.
  pose proof (series_right j) as Hs. unfold size_residual. destruct (series j) as [[[T sum] eT] e].
  destruct Hs as [_ [Sr Si]]. set (k := (- Z.of_nat (fst sum))%Z) in *.
  cbn [fst snd]. set (l := residual_list sum). set (amp := IZR en / IZR ed).
  assert (r1 := r_1). assert (Htop : norm r 1 b <= IZR top).
  { pose proof (norm_up 1 b ltac:(lia)) as H. pose proof (times_r_above (size_up b)).
    unfold weight in H. simpl in H. unfold top. lra. }
  assert (Hl : norm r 1 l <= IZR (times_r (size_up l))).
  { pose proof (norm_up 1 l ltac:(lia)) as H. pose proof (times_r_above (size_up l)).
    unfold weight in H. simpl in H. lra. }
  set (er := IZR e / IZR one) in *.
  assert (P1 : 0 < / (IZR D * IZR one)) by (apply Rinv_0_lt_compat; nra).
  assert (P2 : 0 < / (IZR D * IZR ed * IZR one))
    by (apply Rinv_0_lt_compat; repeat apply Rmult_lt_0_compat; lra).
  refine (bounded_ext (bounded_plus (bounded_plus
    (bounded_scal (/ (IZR D * IZR ed * IZR one)) (snd (bounded_re_im r 1 l)))
    (bounded_scal (/ (IZR D * IZR one)) (second_difference 1 b cs Hcs)))
    (bounded_scal (- amp) (bounded_plus
      (bounded_mult r1 (bounded_sin1 r) Sr) (bounded_mult r1 (bounded_cos1 r) Si)))) _ _).
  - intros t. unfold residual, kick, u0.
    assert (El : im 1 l t = IZR ed * im 1 (products b cs) t
                            - IZR en * IZR D * (sin t * re k (snd sum) t + cos t * im k (snd sum) t)).
    { unfold l, residual_list.
      destruct (add_re_im (map (Z.mul ed) (products b cs)) (map (Z.mul (- (en * D))) (kick_list sum))
        1 t) as [_ ->].
      destruct (scale_re_im ed (products b cs) 1 t) as [_ ->].
      destruct (scale_re_im (- (en * D)) (kick_list sum) 1 t) as [_ ->].
      rewrite kick_list_im, opp_IZR, mult_IZR. fold k. ring. }
    rewrite El. unfold amp. field. lra.
  - rewrite Rabs_Ropp, !Rabs_right by lra. fold amp. pose proof (Rabs_pos amp).
    apply Rplus_le_compat; [apply Rplus_le_compat |].
    + unfold Rdiv. rewrite (Rmult_comm (IZR (times_r (size_up l)))). apply Rmult_le_compat_l; lra.
    + unfold Rdiv. rewrite (Rmult_comm (IZR top)). apply Rmult_le_compat_l; lra.
    + apply Req_le. ring.
Qed.

(* In units of 1/one: the residual of the lists, the errors of the cosines, the remainders of the
   divisions, and the rest of the series. *)
Definition residual_up (j : nat) : Z :=
  (let s := series j in
   ceil (size_residual s) (D * ed) + ceil top D + ceil (2 * rn * (Z.abs en * snd s)) (rd * ed)
   + ceil (4 * rn * Z.abs en * Z.pow top (Z.of_nat (S j)) * one)
          (ed * rd * Z.pow D (Z.of_nat (S j)) * Sine.factorial (S j)))%Z.

Theorem residual_solved j : close 1 b cs -> (2 * top <= D)%Z ->
  solved w (IZR en / IZR ed) r (IZR (residual_up j) / IZR one) u0.
Proof.
  intros Hcs Ht. apply IZR_lt in HD as HD'. apply IZR_lt in Hone as Hone'. apply IZR_lt in Hed as Hed'.
  apply IZR_lt in Hrd as Hrd'.
  assert (HU : IZR top / IZR D <= 1 / 2).
  { apply IZR_le in Ht. rewrite mult_IZR in Ht. apply Rmult_le_reg_r with (IZR D); [exact HD' |].
    replace (IZR top / IZR D * IZR D) with (IZR top) by (field; lra). lra. }
  assert (Hf := INR_fact_lt_0 (S j)).
  exists (S j). intros N HN. replace N with ((N - S j) + S j)%nat by lia.
  refine (bounded_ext (bounded_minus (residual_bounded j Hcs)
    (bounded_scal (IZR en / IZR ed)
      (kick_tail r _ _ (S j) (N - S j) _ r_1 HU u0_bounded (Rle_refl _)))) _ _).
  - intros t. unfold residual. ring.
  - assert (Hamp : Rabs (IZR en / IZR ed) = IZR (Z.abs en) / IZR ed).
    { unfold Rdiv. rewrite Rabs_mult, abs_IZR, (Rabs_right (/ IZR ed)); [reflexivity |].
      apply Rle_ge, Rlt_le, Rinv_0_lt_compat, Hed'. }
    rewrite Hamp. unfold residual_up. cbv zeta. rewrite !plus_IZR.
    assert (scaled : forall a d x, (0 < d)%Z -> x = IZR a / IZR d / IZR one ->
                     x <= IZR (ceil a d) / IZR one).
    { intros a d x Hd ->. pose proof (ceil_above a d Hd). apply Rmult_le_compat_r; [| assumption].
      apply Rlt_le, Rinv_0_lt_compat, Hone'. }
    assert (HDp : (0 < D ^ Z.of_nat (S j))%Z) by (apply Z.pow_pos_nonneg; lia).
    assert (Hfz : (0 < Sine.factorial (S j))%Z) by (apply lt_IZR; rewrite <- Sine.fact_factorial; exact Hf).
    rewrite !Rdiv_plus_distr.
    repeat apply Rplus_le_compat; apply scaled; try nia.
    + rewrite mult_IZR. field. lra.
    + field. lra.
    + rewrite !mult_IZR. unfold r. field. lra.
    + rewrite !mult_IZR, <- Sine.fact_factorial, <- !pow_IZR. unfold r, Rdiv.
      rewrite Rpow_mult_distr, pow_inv. field. repeat split; try lra. apply pow_nonzero. lra.
Qed.

(* ---- the derivative *)

Fixpoint slopes (k : Z) (p : list Z) : list Z :=
  match p with [] => [] | a :: p => (k * a)%Z :: slopes (k + 1) p end.

Lemma derive_im k p t : is_derive (im k p) t (re k (slopes k p) t).
Proof.
  revert k. induction p as [| a p IH]; intros k; [exact (is_derive_const (V := R_NormedModule) 0 t) |].
  apply (is_derive_plus (V := R_NormedModule) (fun t => IZR a * sin (IZR k * t)) (im (k + 1) p));
    [| apply IH].
  auto_derive; [exact I |]. rewrite mult_IZR. ring.
Qed.

Definition u0' (t : R) : R := re 1 (slopes 1 b) t / IZR D.

Lemma derive_u0 t : is_derive u0 t (u0' t).
Proof.
  unfold u0, u0'. pose proof (derive_im 1 b t) as H. auto_derive; [now eexists; exact H |].
  change (fun x => im 1 b x) with (im 1 b). rewrite (is_derive_unique _ _ _ H). field.
  apply IZR_lt in HD. lra.
Qed.

Definition slope_top : Z := times_r (size_up (slopes 1 b)).

Lemma u0'_bounded : bounded r (IZR slope_top / IZR D) u0'.
Proof.
  apply IZR_lt in HD as HD'.
  refine (bounded_ext (bounded_scal (/ IZR D) (fst (bounded_re_im r 1 (slopes 1 b)))) _ _).
  - intros t. unfold u0'. field. lra.
  - rewrite Rabs_right by (apply Rle_ge, Rlt_le, Rinv_0_lt_compat; lra).
    unfold Rdiv. rewrite Rmult_comm. apply Rmult_le_compat_r; [apply Rlt_le, Rinv_0_lt_compat; lra |].
    pose proof (norm_up 1 (slopes 1 b) ltac:(lia)) as H. unfold slope_top.
    pose proof (times_r_above (size_up (slopes 1 b))).
    unfold weight in H. simpl in H. lra.
Qed.

Lemma odd_u0 : odd u0.
Proof.
  intros t. unfold u0. assert (H : forall p k, im k p (- t) = - im k p t).
  { induction p as [| a p IH]; intros k; cbn [im]; [ring |]. rewrite IH.
    replace (IZR k * - t) with (- (IZR k * t)) by ring. rewrite sin_neg. ring. }
  rewrite H. field. apply IZR_lt in HD. lra.
Qed.
End Run.
