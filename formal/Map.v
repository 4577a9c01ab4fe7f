(* What is proved, and nothing else.  To know what the theorems of this folder say it is enough to
   read this file: there are no proofs in it, and what the others define appears in no statement.

   Angles are in radians, R^2 is the lifted torus.  The potential, the map and the second variation
   are those of docs/proofs/argument.md, sections 1 and 2. *)

From Coq Require Import Reals ZArith QArith Qreals List.
Import ListNotations.
Open Scope R_scope.

(* ---- vectors of the plane *)

Definition vec : Type := R * R.

Definition dot (u v : vec) : R := fst u * fst v + snd u * snd v.
Definition plus (u v : vec) : vec := (fst u + fst v, snd u + snd v).
Definition minus (u v : vec) : vec := (fst u - fst v, snd u - snd v).
Definition scale (a : R) (v : vec) : vec := (a * fst v, a * snd v).

Definition sum {A : Type} (f : A -> R) (l : list A) : R := fold_right (fun x total => f x + total) 0 l.

(* ---- the potential V(y) = - sum of amplitude sin(k.y + phase), and what the map is made of *)

Record wave := Wave { k0 : Z; k1 : Z; phase : R; amplitude : R }.

Definition along (w : wave) (y : vec) : R := IZR (k0 w) * fst y + IZR (k1 w) * snd y.
Definition angle (w : wave) (y : vec) : R := along w y + phase w.

Definition V (ws : list wave) (y : vec) : R := - sum (fun w => amplitude w * sin (angle w y)) ws.

(* V', the gradient. *)
Definition V' (ws : list wave) (y : vec) : vec :=
  (- sum (fun w => IZR (k0 w) * (amplitude w * cos (angle w y))) ws,
   - sum (fun w => IZR (k1 w) * (amplitude w * cos (angle w y))) ws).

(* v.beta(y)v, where beta = 2I - V''. *)
Definition beta (ws : list wave) (y v : vec) : R :=
  2 * dot v v - sum (fun w => amplitude w * sin (angle w y) * (along w v * along w v)) ws.

(* The amplitudes times s. *)
Definition scaled (s : R) (ws : list wave) : list wave :=
  map (fun w => Wave (k0 w) (k1 w) (phase w) (s * amplitude w)) ws.

(* The map (y, J) -> (y + J', J'), J' = J - V'(y), and its orbits, by their angles. *)
Definition F (ws : list wave) (yJ : vec * vec) : vec * vec :=
  let J' := minus (snd yJ) (V' ws (fst yJ)) in (plus (fst yJ) J', J').

Definition orbit (ws : list wave) (x : Z -> vec) : Prop :=
  forall j, x (j + 1)%Z = minus (minus (scale 2 (x j)) (x (j - 1)%Z)) (V' ws (x j)).

(* The second variation of the action along x for n, which is zero but at the sites s, s + 1, ...,
   s + k - 1. *)
Fixpoint variation (ws : list wave) (x n : Z -> vec) (s : Z) (k : nat) : R :=
  match k with
  | O => 0
  | S k => beta ws (x s) (n s) - 2 * dot (n s) (n (s + 1)%Z) + variation ws x n (s + 1) k
  end.

Definition zero_outside (n : Z -> vec) (s : Z) (k : nat) : Prop :=
  forall j, (j < s \/ s + Z.of_nat k <= j)%Z -> n j = (0, 0).

(* ---- a patch of potentials: each amplitude is middle + sum of part t, the t from -1 to 1 *)

Record term := Term { of_k0 : Z; of_k1 : Z; of_phase : Q;       (* in units of pi *)
                      middle : Q; parts : list Q }.

Definition combined (parts : list Q) (t : list R) : R :=
  sum (fun gt => Q2R (fst gt) * snd gt) (combine parts t).

Definition waves (patch : list term) (t : list R) : list wave :=
  map (fun w => Wave (of_k0 w) (of_k1 w) (Q2R (of_phase w) * PI)
                     (Q2R (middle w) + combined (parts w) t)) patch.

Definition in_cube (t : list R) : Prop := Forall (fun x => -1 <= x <= 1) t.

Definition point (q : Q * Q) : vec := (Q2R (fst q), Q2R (snd q)).

(* ---- the theorems *)

(* This orbit is not minimizing: for some n its second variation is negative. *)
Definition refuted (ws : list wave) (x : Z -> vec) : Prop :=
  exists n s k, zero_outside n s k /\ variation ws x n s k < 0.

(* For no potential of the patch is there a minimizing orbit through x*. *)
Definition no_minimizing_orbit (patch : list term) (xstar : Q * Q) : Prop :=
  forall t, in_cube t -> forall x, orbit (waves patch t) x -> x 0%Z = point xstar ->
  refuted (waves patch t) x.

(* The same for orbits that go on to a region of x1, modulo 2 pi: the image under the integer matrix
   (m00 m01; m10 m11) of the rectangle of these centres and half-widths, in units of pi. *)
Record region := Region { m00 : Z; m01 : Z; m10 : Z; m11 : Z;
                          centre0 : Q; half0 : Q; centre1 : Q; half1 : Q }.

Definition into (r : region) (y : vec) : Prop :=
  exists v0 v1 (i j : Z),
  Rabs (v0 - Q2R (centre0 r)) <= Q2R (half0 r) /\ Rabs (v1 - Q2R (centre1 r)) <= Q2R (half1 r) /\
  y = (PI * (IZR (m00 r) * v0 + IZR (m01 r) * v1) + 2 * PI * IZR i,
       PI * (IZR (m10 r) * v0 + IZR (m11 r) * v1) + 2 * PI * IZR j).

Definition no_minimizing_orbit_into (r : region) (patch : list term) (xstar : Q * Q) : Prop :=
  forall t, in_cube t -> forall x, orbit (waves patch t) x -> x 0%Z = point xstar ->
  into r (x 1%Z) -> refuted (waves patch t) x.

(* A graph is the set of all (y, c + S'(y)), c in R^2, S of class C^1 and periodic. *)
Definition periodic (S : vec -> R) : Prop :=
  forall y (m0 m1 : Z), S (plus y (scale (2 * PI) (IZR m0, IZR m1))) = S y.

Definition continuous (f : vec -> R) : Prop :=
  forall y eps, 0 < eps -> exists delta, 0 < delta /\
  forall z, dot (minus z y) (minus z y) < delta -> Rabs (f z - f y) < eps.

(* S has the continuous partial derivatives fst (S' y) and snd (S' y). *)
Definition has_gradient (S : vec -> R) (S' : vec -> vec) : Prop :=
  (forall y, derivable_pt_lim (fun a => S (a, snd y)) (fst y) (fst (S' y))) /\
  (forall y, derivable_pt_lim (fun b => S (fst y, b)) (snd y) (snd (S' y))) /\
  continuous (fun y => fst (S' y)) /\ continuous (fun y => snd (S' y)).

Definition invariant_graph (ws : list wave) (c : vec) (S' : vec -> vec) : Prop :=
  forall y, snd (F ws (y, plus c (S' y))) = plus c (S' (fst (F ws (y, plus c (S' y))))).

Definition no_invariant_graph (ws : list wave) : Prop :=
  forall c S S', periodic S -> has_gradient S S' -> ~ invariant_graph ws c S'.

(* The opposite: there is one, for some c. *)
Definition has_invariant_graph (ws : list wave) : Prop :=
  exists c S S', periodic S /\ has_gradient S S' /\ invariant_graph ws c S'.

(* None whose orbit leads from x to the region. *)
Definition no_invariant_graph_into (r : region) (ws : list wave) (x : vec) : Prop :=
  forall c S S', periodic S -> has_gradient S S' -> invariant_graph ws c S' ->
  ~ into r (fst (F ws (x, plus c (S' x)))).
