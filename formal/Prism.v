(* One prism: the orbits of a cell of parameters and of x1, from an exact problem in rationals. *)

From Coq Require Import Reals ZArith QArith Qreals List Lra Lia.
From Interval.Real Require Import Xreal.
From Interval.Float Require Import Basic Sig.
From Interval.Interval Require Import Interval.
From Converse Require Import Map Trig Window Tree Bound.
Import ListNotations.
Open Scope R_scope.

(* x0 is the start, x1 is pi times the matrix applied to v, v = middle + half-width times u, and u and
   the parameters are from -1 to 1. *)
Record problem := Problem {
  terms : list term;
  start : Q * Q;
  f00 : Q; f01 : Q; f10 : Q; f11 : Q;
  mid0 : Q; wid0 : Q; mid1 : Q; wid1 : Q
}.

(* x1, for the u of both angles. *)
Definition second (p : problem) (u0 u1 : R) : vec :=
  let v0 := Q2R (mid0 p) + Q2R (wid0 p) * u0 in
  let v1 := Q2R (mid1 p) + Q2R (wid1 p) * u1 in
  (PI * (Q2R (f00 p) * v0 + Q2R (f01 p) * v1), PI * (Q2R (f10 p) * v0 + Q2R (f11 p) * v1)).

(* For the point u = (u0, u1, parameters) of the problem's cube. *)
Definition excluded (p : problem) (u : list R) : Prop :=
  match u with
  | u0 :: u1 :: t => forall x, orbit (waves (terms p) t) x -> x 0%Z = point (start p) ->
                     x 1%Z = second p u0 u1 -> refuted (waves (terms p) t) x
  | _ => True
  end.

Module Prism (F : FloatOps with Definition radix := Zaux.radix2
                           with Definition sensible_format := true).
Include Bound F.

(* The problem in intervals, made once. *)
Record ready := Ready {
  plain : list (pwave * list I.type);               (* waves, and the parts that move them *)
  X0 : plane; rest_0 : I.type * I.type;             (* of x0 *)
  base : I.type * I.type;                           (* x1 for u = 0, in radians *)
  sides : (I.type * I.type) * (I.type * I.type);    (* what u0 and u1 add to it *)
  tail : I.type                                     (* l *)
}.

(* How a prism is tried; nothing rests on it. *)
Record manner := Manner {
  longest : nat;                                    (* sites of a lane *)
  limit : F.type;                                   (* of every wave's k.D *)
  caution1 : F.type; caution2 : F.type              (* of the choice of n, for this and its square *)
}.

Section Precision.
Variable prec : F.precision.
Notation add := (add prec).
Notation sub := (sub prec).
Notation mul := (mul prec).
Notation div := (div prec).
Notation rational := (rational prec).
Notation integer := (integer prec).
Notation add1 := (add1 prec).
Notation scale1 := (scale1 prec).
Notation fadd := (fadd prec).
Notation fsub := (fsub prec).
Notation fmul := (fmul prec).
Notation fdiv := (fdiv prec).
Variable K : limits.
Hypothesis K_ok : limits_ok K.
Variable sincos : I.type -> I.type * I.type.
Hypothesis sincos_ok : forall tau x, cont tau x ->
  cont (fst (sincos tau)) (sin (2 * PI * x)) /\ cont (snd (sincos tau)) (cos (2 * PI * x)).
Variable pi : I.type.
Hypothesis pi_ok : cont pi PI.

Definition prepare_wave (w : term) : pwave * list I.type :=
  (PWave (of_k0 w) (of_k1 w) (integer (of_k0 w)) (integer (of_k1 w))
         (mul (ihalf K) (rational (of_phase w))) (rational (middle w)) [],
   map rational (parts w)).

Definition in_turns (x : I.type) : F.type * Z := wrap prec K 512 (fmul (center x) (per_turn K)) 0.

(* What x is more than so many turns. *)
Definition beyond_turns (x : I.type) (t : F.type * Z) : I.type :=
  sub x (mul (itwo_pi K) (add (exactly (fst t)) (integer (snd t)))).

Definition prepare (p : problem) (l : Q) : ready :=
  let x := rational (fst (start p)) in
  let y := rational (snd (start p)) in
  let tx := in_turns x in
  let ty := in_turns y in
  let row a b := mul pi (add (mul (rational a) (rational (mid0 p)))
                             (mul (rational b) (rational (mid1 p)))) in
  let side a w := mul pi (mul (rational a) (rational w)) in
  Ready (map prepare_wave (terms p)) (fst tx, fst ty) (beyond_turns x tx, beyond_turns y ty)
    (row (f00 p) (f01 p), row (f10 p) (f11 p))
    ((side (f00 p) (wid0 p), side (f01 p) (wid1 p)), (side (f10 p) (wid0 p), side (f11 p) (wid1 p)))
    (rational l).

(* The middle and the half-width of a slice. *)
Definition span (s : slice) : I.type * I.type :=
  let p := integer (2 ^ Z.of_nat (snd s)) in
  (sub (div (integer (2 * fst s + 1)) p) (ione K), div (ione K) p).

Fixpoint centred (gs : list I.type) (ts : list (I.type * I.type)) (sum : I.type) : I.type :=
  match gs, ts with
  | g :: gs, t :: ts => centred gs ts (add sum (mul g (fst t)))
  | _, _ => sum
  end.
Fixpoint moved (gs : list I.type) (ts : list (I.type * I.type)) : form1 :=
  match gs, ts with
  | g :: gs, t :: ts => mul g (snd t) :: moved gs ts
  | _, _ => []
  end.

Definition wave_in (ts : list (I.type * I.type)) (w : pwave * list I.type) : pwave :=
  let '(w, gs) := w in
  PWave (z0 w) (z1 w) (i0 w) (i1 w) (turns w) (centred gs ts (amp w)) (moved gs ts).

(* x1 along one coordinate: its centre, columns and rest; n parameters come first. *)
Definition placed (n : nat) (base : I.type) (side : I.type * I.type) (u0 u1 : I.type * I.type) :
    F.type * form1 * I.type :=
  let x := add base (add (mul (fst side) (fst u0)) (mul (snd side) (fst u1))) in
  let t := in_turns x in
  let c := repeat I.zero n ++ [mul (fst side) (snd u0); mul (snd side) (snd u1)] in
  let l := centers c in
  (fst t, l, add (beyond_turns x t) (range1 prec (unit K) (add1 c (negate1 l)))).

(* ---- the choice of n, on floats: by the recursion d' = beta - 1/d from both ends *)

Definition zero3 : symmetric := (F.zero, F.zero, F.zero).
Definition add3' (a b : symmetric) : symmetric :=
  let '(a0, a1, a2) := a in let '(b0, b1, b2) := b in (fadd a0 b0, fadd a1 b1, fadd a2 b2).
Definition sub3 (a b : symmetric) : symmetric :=
  let '(a0, a1, a2) := a in let '(b0, b1, b2) := b in (fsub a0 b0, fsub a1 b1, fsub a2 b2).
Definition apply3 (a : symmetric) (v : plane) : plane :=
  let '(p, q, r) := a in
  (fadd (fmul p (fst v)) (fmul q (snd v)), fadd (fmul q (fst v)) (fmul r (snd v))).
Definition above (x y : F.type) : bool := match F.cmp x y with Xgt => true | _ => false end.
Definition definite (a : symmetric) : bool :=
  let '(p, q, r) := a in above p F.zero && above (fmul p r) (fmul q q).

(* beta and something for what the bound will add to a site. *)
Definition blocked (h : manner) (s : site) : symmetric :=
  let '(b00, b01, b11) := block s in
  fold_right (fun w a =>
      let reach := F.max (I.upper (z w)) (F.neg (I.lower (z w))) in
      let p := F.max (I.upper (amp (of w))) (F.neg (I.lower (amp (of w)))) in
      let m := fmul p (fmul reach (fadd (caution1 h) (fmul (caution2 h) reach))) in
      let k0 := center (i0 (of w)) in let k1 := center (i1 (of w)) in
      add3' a (fmul m (fmul k0 k0), fmul m (fmul k0 k1), fmul m (fmul k1 k1)))
    (center b00, center b01, center b11) (view s).

(* From one end: of each site d, whether it is definite, and what takes n outwards from the next. *)
Fixpoint scan (l : F.type) (before : symmetric) (blocks : list symmetric) :
    list (symmetric * (bool * symmetric)) :=
  match blocks with
  | [] => []
  | b :: blocks =>
    let d := sub3 b before in
    let good := definite d in
    let inv := if good then inverted prec d else (l, F.zero, l) in
    (d, (good, inv)) :: scan l inv blocks
  end.

Definition least (a : symmetric) : F.type :=
  let '(p, q, r) := a in
  let m := fsub p r in
  let root := F.sqrt_UP prec (fadd (fmul m m) (fmul (fadd q q) (fadd q q))) in
  fmul (fhalf K) (fsub (fadd p r) root).

(* The unit eigenvector of the least eigenvalue. *)
Definition eigenvector (a : symmetric) : plane :=
  let '(p, q, r) := a in
  let low := least a in
  let v := if above p r then (q, fsub low p) else (fsub low r, q) in
  let length := F.sqrt_UP prec (fadd (fmul (fst v) (fst v)) (fmul (snd v) (snd v))) in
  if above length F.zero then (fdiv (fst v) length, fdiv (snd v) length)
  else if above p r then (F.zero, fone K) else (fone K, F.zero).

(* Where the two scans together have the negative eigenvalue next to zero. *)
Fixpoint choose (blocks : list symmetric) (lefts rights : list (symmetric * (bool * symmetric)))
    (at_ : nat) (best : option (F.type * nat * symmetric)) : option (F.type * nat * symmetric) :=
  match blocks, lefts, rights with
  | b :: blocks, l :: lefts, r :: rights =>
    let joint := sub3 (add3' (fst l) (fst r)) b in
    let low := least joint in
    let better := above F.zero low &&
      match best with Some (other, _, _) => above low other | None => true end in
    choose blocks lefts rights (S at_) (if better then Some (low, at_, joint) else best)
  | _, _, _ => best
  end.

(* n outwards from v, by the scan's inverses as far as they are good, then by the tail. *)
Fixpoint spread (l : F.type) (good : bool) (v : plane) (scans : list (bool * symmetric)) :
    list plane :=
  match scans with
  | [] => []
  | (ok, inv) :: scans =>
    let good := good && ok in
    let n := if good then apply3 inv v else (fmul l (fst v), fmul l (snd v)) in
    n :: spread l good n scans
  end.

(* Of the sites ahead and back. *)
Definition witness (h : manner) (l : F.type) (ahead back : list site) : option (list plane * list plane) :=
  let blocks := rev_append (map (blocked h) back) (map (blocked h) ahead) in
  let end_ := (l, F.zero, l) in
  let lefts := scan l end_ blocks in
  let rights := rev_append (scan l end_ (rev_append blocks [])) [] in
  match choose blocks lefts rights 0 None with
  | None => None
  | Some (_, at_, joint) =>
    let v := eigenvector joint in
    let lower := spread l true v (map snd (rev_append (firstn at_ lefts) [])) in
    let upper := spread l true v (map snd (skipn (S at_) rights)) in
    let all := rev_append lower (v :: upper) in
    let b := length back in
    Some (skipn b all, rev_append (firstn b all) [])
  end.

(* ---- the bound *)

Definition bound (h : manner) (rd : ready) (c : cell) : option (I.type * list F.type) :=
  match map span c with
  | u0 :: u1 :: ts =>
    let ws := map (wave_in ts) (plain rd) in
    let '(x, l0, r0) := placed (length ts) (fst (base rd)) (fst (sides rd)) u0 u1 in
    let '(y, l1, r1) := placed (length ts) (snd (base rd)) (snd (sides rd)) u0 u1 in
    let none := ([], []) in
    let sa := follow prec K sincos (longest h) (limit h) ws
      (State (X0 rd) (x, y) none (l0, l1) (rest_0 rd) (r0, r1) (r0, r1) zero3 zero3) in
    let sb := follow prec K sincos (longest h) (limit h) ws
      (State (x, y) (X0 rd) (l0, l1) none (r0, r1) (rest_0 rd) (rest_0 rd) zero3 zero3) in
    match witness h (center (tail rd)) sa sb with
    | None => None
    | Some (na, nb) =>
      match na, nb with
      | _ :: _, _ :: _ =>
        if (Nat.leb (length na) (length sa) && Nat.leb (length nb) (length sb))%bool then
        let a := backward prec K (tail rd) sa (map exact2 na) in
        let b := backward prec K (tail rd) sb (map exact2 nb) in
        let a0 := minus_affine prec (fst (on_D a)) (fst (mult b)) in
        let a1 := minus_affine prec (snd (on_D a)) (snd (mult b)) in
        let b0 := minus_affine prec (fst (on_D b)) (fst (mult a)) in
        let b1 := minus_affine prec (snd (on_D b)) (snd (mult a)) in
        let lost := add (add (mul (range_affine prec K a0) r0) (mul (range_affine prec K a1) r1))
                        (add (mul (range_affine prec K b0) (fst (rest_0 rd)))
                             (mul (range_affine prec K b1) (snd (rest_0 rd)))) in
        let v := sub (add (add (value a) (value b)) lost)
                     (mul (itwo K) (inner prec (vector a) (vector b))) in
        let p1 := add1 (add1 (sum1 a) (sum1 b)) (add1 (scale1 (fst a0) l0) (scale1 (fst a1) l1)) in
        let p2 := add2 prec (add2 prec (sum2 a) (sum2 b))
                    (add2 prec (product prec (snd a0) l0) (product prec (snd a1) l1)) in
        let p3 := add3 prec (sum3 a) (sum3 b) in
        Some (summit prec (unit K) (upto1 K) (length c) v p1 p2 p3, [])
        else None
      | _, _ => None
      end
    end
  | _ => None
  end.
End Precision.
End Prism.
