(* The two lanes of an orbit, x1, x2, ... and x0, x-1, ..., with vectors at their sites, make one
   window of the second variation. *)

From Coq Require Import Reals ZArith List Lra Lia.
From Converse Require Import Map Criterion.
Import ListNotations.
Open Scope R_scope.

Definition next (ws : list wave) (o y : vec) : vec := minus (minus (scale 2 y) o) (V' ws y).

(* One lane, whose first site is y, reached from o, with vectors ns; the last one ends in a tail. *)
Fixpoint part (ws : list wave) (l : R) (ns : list vec) (o y : vec) : R :=
  match ns with
  | [] => 0
  | n :: ns =>
    beta ws y n - 2 * dot n (hd (0, 0) ns)
    - match ns with [] => l * dot n n | _ => 0 end + part ws l ns y (next ws o y)
  end.

Section Window.
Variables (ws : list wave) (x : Z -> vec) (n : Z -> vec).
Hypothesis Orbit : orbit ws x.

Lemma next_ahead j : next ws (x (j - 1)%Z) (x j) = x (j + 1)%Z.
Proof. symmetry. apply Orbit. Qed.

Lemma next_back j : next ws (x (j + 1)%Z) (x j) = x (j - 1)%Z.
Proof.
  rewrite (Orbit j). unfold next, minus, scale. destruct (x (j - 1)%Z), (x j), (V' _ _).
  simpl. f_equal; ring.
Qed.

Lemma dot_0 v : dot v (0, 0) = 0.
Proof. unfold dot. simpl. ring. Qed.

Lemma part_ahead l (ns : list vec) j : (forall m, n (j + Z.of_nat m)%Z = nth m ns (0, 0)) ->
  part ws l ns (x (j - 1)%Z) (x j) =
  variation ws x n j (length ns) -
  match ns with [] => 0 | _ => l * dot (last ns (0, 0)) (last ns (0, 0)) end.
Proof.
  revert j. induction ns as [| v ns IH]; intros j H; [simpl; ring |].
  assert (H0 : n j = v) by (rewrite <- (Z.add_0_r j); exact (H O)).
  assert (H' : forall m, n (j + 1 + Z.of_nat m)%Z = nth m ns (0, 0)).
  { intros m. replace (j + 1 + Z.of_nat m)%Z with (j + Z.of_nat (S m))%Z by lia. apply (H (S m)). }
  assert (H1 : n (j + 1)%Z = hd (0, 0) ns).
  { pose proof (H' O) as E. rewrite Z.add_0_r in E. rewrite E. now destruct ns. }
  assert (E := IH (j + 1)%Z H'). replace (j + 1 - 1)%Z with j in E by ring.
  cbn [part length variation]. rewrite next_ahead, E, H0, H1.
  destruct ns as [| w ns]; [simpl; rewrite dot_0; ring |].
  change (last (v :: w :: ns) (0, 0)) with (last (w :: ns) (0, 0)). ring.
Qed.

Lemma variation_snoc s k : variation ws x n s (S k) = variation ws x n s k +
  (beta ws (x (s + Z.of_nat k)%Z) (n (s + Z.of_nat k)%Z)
   - 2 * dot (n (s + Z.of_nat k)%Z) (n (s + Z.of_nat k + 1)%Z)).
Proof.
  revert s. induction k as [| k IH]; intros s.
  - simpl. rewrite !Z.add_0_r. ring.
  - change (variation ws x n s (S (S k))) with (beta ws (x s) (n s) - 2 * dot (n s) (n (s + 1)%Z)
      + variation ws x n (s + 1) (S k)).
    rewrite IH. cbn [variation]. rewrite Nat2Z.inj_succ.
    replace (s + 1 + Z.of_nat k)%Z with (s + Z.succ (Z.of_nat k))%Z by lia. ring.
Qed.

Lemma part_back l (ns : list vec) j : (forall m, n (j - Z.of_nat m)%Z = nth m ns (0, 0)) ->
  part ws l ns (x (j + 1)%Z) (x j) =
  variation ws x n (j + 1 - Z.of_nat (length ns)) (length ns)
  + match ns with [] => 0 | _ => 2 * dot (n j) (n (j + 1)%Z) end
  - match ns with [] => 0 | _ => l * dot (last ns (0, 0)) (last ns (0, 0)) end.
Proof.
  revert j. induction ns as [| v ns IH]; intros j H; [simpl; ring |].
  assert (H0 : n j = v) by (rewrite <- (Z.sub_0_r j); exact (H O)).
  assert (H' : forall m, n (j - 1 - Z.of_nat m)%Z = nth m ns (0, 0)).
  { intros m. replace (j - 1 - Z.of_nat m)%Z with (j - Z.of_nat (S m))%Z by lia. apply (H (S m)). }
  assert (H1 : n (j - 1)%Z = hd (0, 0) ns).
  { pose proof (H' O) as E. rewrite Z.sub_0_r in E. rewrite E. now destruct ns. }
  assert (E := IH (j - 1)%Z H'). replace (j - 1 + 1)%Z with j in E by ring.
  cbn [length]. rewrite variation_snoc.
  replace (j + 1 - Z.of_nat (S (length ns)))%Z with (j - Z.of_nat (length ns))%Z by lia.
  replace (j - Z.of_nat (length ns) + Z.of_nat (length ns))%Z with j by ring.
  cbn [part]. rewrite next_back, E, H0, H1.
  assert (Com : dot v (hd (0, 0) ns) = dot (hd (0, 0) ns) v) by (unfold dot; ring).
  destruct ns as [| w ns]; [simpl; rewrite dot_0; ring |].
  change (last (v :: w :: ns) (0, 0)) with (last (w :: ns) (0, 0)).
  rewrite Com. simpl hd. ring.
Qed.
End Window.

Definition joined (ahead back : list vec) (j : Z) : vec :=
  if (1 <=? j)%Z then nth (Z.to_nat (j - 1)) ahead (0, 0) else nth (Z.to_nat (- j)) back (0, 0).

Lemma last_nth (l : list vec) k : length l = S k -> last l (0, 0) = nth k l (0, 0).
Proof.
  revert k. induction l as [| v l IH]; intros k E; [easy |].
  destruct l as [| w l]; [destruct k; [reflexivity | discriminate] |].
  destruct k; [discriminate |]. apply IH. simpl in E |- *. lia.
Qed.

(* Criterion (1) of docs/proofs/argument.md, from the two lanes. *)
Theorem lanes_refuted ws x B l ahead back : (forall y v, beta ws y v <= B * dot v v) ->
  0 < l < 1 -> B <= l + / l -> orbit ws x -> ahead <> [] -> back <> [] ->
  part ws l ahead (x 0%Z) (x 1%Z) + part ws l back (x 1%Z) (x 0%Z)
  - 2 * dot (hd (0, 0) ahead) (hd (0, 0) back) < 0 -> refuted ws x.
Proof.
  intros HB Hl HBl HO Ha Hb Neg. set (n := joined ahead back).
  assert (A : forall m, n (1 + Z.of_nat m)%Z = nth m ahead (0, 0)).
  { intros m. unfold n, joined. destruct (Z.leb_spec 1 (1 + Z.of_nat m)); [| lia].
    f_equal. lia. }
  assert (Bk : forall m, n (0 - Z.of_nat m)%Z = nth m back (0, 0)).
  { intros m. unfold n, joined. destruct (Z.leb_spec 1 (0 - Z.of_nat m)); [lia |]. f_equal. lia. }
  assert (PA := part_ahead ws x n HO l ahead 1 A). assert (PB := part_back ws x n HO l back 0 Bk).
  simpl (1 - 1)%Z in PA. simpl (0 + 1)%Z in PB.
  set (a := length ahead) in *. set (b := length back) in *.
  assert (a <> 0%nat) by (unfold a; now destruct ahead).
  assert (b <> 0%nat) by (unfold b; destruct back; easy).
  assert (Split : forall s k m, variation ws x n s (k + m) =
    variation ws x n s k + variation ws x n (s + Z.of_nat k) m).
  { intros s k m. revert s. induction k as [| k IH]; intros s.
    - simpl. rewrite Z.add_0_r. ring.
    - cbn [plus Nat.add variation]. rewrite IH, Nat2Z.inj_succ.
      replace (s + Z.succ (Z.of_nat k))%Z with (s + 1 + Z.of_nat k)%Z by lia. ring. }
  apply (window_refuted ws x B l HB Hl HBl n (1 - Z.of_nat b)%Z (b + a - 1)).
  - intros j Hj. unfold n, joined. destruct (Z.leb_spec 1 j); apply nth_overflow; lia.
  - replace (S (b + a - 1)) with (b + a)%nat by lia. rewrite Split.
    replace (1 - Z.of_nat b + Z.of_nat b)%Z with 1%Z by ring.
    replace (1 - Z.of_nat b + Z.of_nat (b + a - 1))%Z with (1 + Z.of_nat (a - 1))%Z by lia.
    replace (1 - Z.of_nat b)%Z with (0 - Z.of_nat (b - 1))%Z at 2 3 by lia.
    rewrite A, Bk, <- (last_nth ahead (a - 1)%nat), <- (last_nth back (b - 1)%nat) by lia.
    assert (N0 : n 0%Z = hd (0, 0) back).
    { pose proof (Bk O) as E. change (n 0%Z = nth 0 back (0, 0)) in E. rewrite E. now destruct back. }
    assert (N1 : n 1%Z = hd (0, 0) ahead).
    { pose proof (A O) as E. change (n 1%Z = nth 0 ahead (0, 0)) in E. rewrite E. now destruct ahead. }
    rewrite N0, N1 in PB.
    rewrite PA, PB in Neg. destruct ahead, back; try easy.
    assert (Com : forall u v, dot u v = dot v u) by (intros; unfold dot; ring).
    simpl hd in Neg. rewrite (Com v0) in Neg. lra.
Qed.

(* The same if nothing is known of x1 and what follows: x0 ends in a tail, too. *)
Theorem back_refuted ws x B l back : (forall y v, beta ws y v <= B * dot v v) ->
  0 < l < 1 -> B <= l + / l -> orbit ws x -> back <> [] ->
  part ws l back (x 1%Z) (x 0%Z) - l * dot (hd (0, 0) back) (hd (0, 0) back) < 0 -> refuted ws x.
Proof.
  intros HB Hl HBl HO Hb Neg. set (n := joined [] back).
  assert (Bk : forall m, n (0 - Z.of_nat m)%Z = nth m back (0, 0)).
  { intros m. unfold n, joined. destruct (Z.leb_spec 1 (0 - Z.of_nat m)); [lia |]. f_equal. lia. }
  assert (PB := part_back ws x n HO l back 0 Bk). simpl (0 + 1)%Z in PB.
  set (b := length back) in *. assert (b <> 0%nat) by (unfold b; now destruct back).
  assert (N0 : n 0%Z = hd (0, 0) back).
  { pose proof (Bk O) as E. change (n 0%Z = nth 0 back (0, 0)) in E. rewrite E. now destruct back. }
  assert (N1 : n 1%Z = (0, 0)) by reflexivity.
  rewrite N0, N1, dot_0 in PB.
  apply (window_refuted ws x B l HB Hl HBl n (1 - Z.of_nat b)%Z (b - 1)).
  - intros j Hj. unfold n, joined. destruct (Z.leb_spec 1 j); apply nth_overflow; simpl; lia.
  - replace (S (b - 1)) with b by lia.
    replace (1 - Z.of_nat b + Z.of_nat (b - 1))%Z with 0%Z by lia.
    replace (1 - Z.of_nat b)%Z with (0 - Z.of_nat (b - 1))%Z at 2 3 by lia.
    rewrite N0, Bk, <- (last_nth back (b - 1)%nat) by lia.
    rewrite PB in Neg. destruct back; [easy |]. simpl hd in *. lra.
Qed.
