(* One prism: the orbits of a cell of parameters and of x1, from an exact problem in rationals. *)

From Coq Require Import Reals ZArith QArith Qreals List Lra Lia.
From Interval.Real Require Import Xreal.
From Interval.Float Require Import Basic Sig.
From Interval.Interval Require Import Interval.
From Converse Require Import Map Trig Window Tree Reduce Lane Bound.
Import ListNotations.
Open Scope R_scope.

Module Prism (F : FloatOps with Definition radix := Zaux.radix2
                           with Definition sensible_format := true).
Include Bound F.

(* The problem in intervals, made once. *)
Record ready := Ready {
  plain : list (pwave * list I.type);               (* waves, and the parts that move them *)
  X0 : plane; rest_0 : I.type * I.type;             (* of x0 *)
  base : I.type * I.type;                           (* x1 for u = 0, in radians *)
  sides : (I.type * I.type) * (I.type * I.type);    (* what u0 and u1 add to it *)
  shears : list I.type * list I.type;                (* and the parameters; [] where they shift nothing *)
  end_ : I.type                                     (* l *)
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

(* a s + b s', in rationals. *)
Definition shearing (a : Q) (s : list Q) (b : Q) (s' : list Q) : list Q :=
  map Qred (added b (map (Qmult a) s) s').

Definition prepare (p : problem) (l : Q) : ready :=
  let x := rational (fst (start p)) in
  let y := rational (snd (start p)) in
  let tx := in_turns x in
  let ty := in_turns y in
  let row a b := mul pi (add (mul (rational a) (rational (mid0 p)))
                             (mul (rational b) (rational (mid1 p)))) in
  let side a w := mul pi (mul (rational a) (rational w)) in
  let row_shears a b := map (fun g => mul pi (rational g)) (shearing a (shift0 p) b (shift1 p)) in
  Ready (map prepare_wave (terms p)) (fst tx, fst ty) (beyond_turns x tx, beyond_turns y ty)
    (row (f00 p) (f01 p), row (f10 p) (f11 p))
    ((side (f00 p) (wid0 p), side (f01 p) (wid1 p)), (side (f10 p) (wid0 p), side (f11 p) (wid1 p)))
    (row_shears (f00 p) (f01 p), row_shears (f10 p) (f11 p)) (rational l).

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

(* A column for each of the parameters. *)
Fixpoint sheared (gs : list I.type) (ts : list (I.type * I.type)) : form1 :=
  match ts, gs with
  | t :: ts, g :: gs => mul g (snd t) :: sheared gs ts
  | _ :: ts, [] => I.zero :: sheared [] ts
  | [], _ => []
  end.

(* x1 along one coordinate: its centre, columns and rest; the parameters come first. *)
Definition placed (ts : list (I.type * I.type)) (base : I.type) (shears : list I.type)
    (side : I.type * I.type) (u0 u1 : I.type * I.type) : F.type * form1 * I.type :=
  let x := centred shears ts (add base (add (mul (fst side) (fst u0)) (mul (snd side) (fst u1)))) in
  let t := in_turns x in
  let c := sheared shears ts ++ [mul (fst side) (snd u0); mul (snd side) (snd u1)] in
  let l := centers c in
  (fst t, l, add (beyond_turns x t) (range1 prec (unit K) (add1 c (negate1 l)))).

(* ---- the choice of n, on floats: by the recursion d' = beta - 1/d from both ends *)

Definition zero3 : symmetric := (F.zero, F.zero, F.zero).

(* A lane's first site and the one before it. *)
Definition begin (O X : plane) (P L : form1 * form1) (ro r : I.type * I.type) : state :=
  State O X P L ([], []) ([], []) (F.zero, F.zero) (F.zero, F.zero) ro r r zero3 zero3.

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

(* From one end: of each site d, at which site the recursion began, and what takes n outwards from the
   next.  It begins anew behind a site where d is not positive; next_ goes on behind the last. *)
Fixpoint scan (l : F.type) (next_ : nat -> nat -> symmetric -> list (symmetric * (nat * symmetric)))
    (at_ begun : nat) (before : symmetric) (blocks : list symmetric) :
    list (symmetric * (nat * symmetric)) :=
  match blocks with
  | [] => next_ at_ begun before
  | b :: blocks =>
    let d := sub3 b before in
    let inv := inverted prec d in
    (d, (begun, inv)) :: (if definite d then scan l next_ (S at_) begun inv blocks
                          else scan l next_ (S at_) (S at_) (l, F.zero, l) blocks)
  end.

(* Along two lanes, anew in the second if it did so in the first. *)
Definition scan_both (l : F.type) (one two : list symmetric) : list (symmetric * (nat * symmetric)) :=
  let tail := (l, F.zero, l) in
  scan l (fun at_ begun before =>
      let '(begun, before) := match begun with O => (begun, before) | _ => (at_, tail) end in
      scan l (fun _ _ _ => []) at_ begun before two)
    0 0 tail one.

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

(* Where the two scans together have a negative eigenvalue: the eigenvalue, the site, where they began,
   and the matrix. *)
Definition candidate : Type := F.type * nat * (nat * nat) * symmetric.

Definition lowest (a b : option candidate) : option candidate :=
  match a, b with
  | Some (x, _, _, _), Some (y, _, _, _) => if above y x then a else b
  | None, _ => b
  | _, None => a
  end.

(* Has the scan from a lane's own end come from there?  back: so many sites are of the lane back. *)
Definition from_end (back begun ended : nat) : bool :=
  match back with O => Nat.eqb ended 0 | _ => Nat.eqb begun 0 end.

(* Of each part of the orbit over which neither scan begins anew the place where the eigenvalue is next
   to zero, and of these parts the one where it is lowest. *)
Fixpoint choose (back : nat) (blocks : list symmetric)
    (lefts rights : list (symmetric * (nat * symmetric))) (at_ : nat) (best run : option candidate) :
    option candidate :=
  match blocks, lefts, rights with
  | b :: blocks, (d, (begun, _)) :: lefts, (d', (ended, _)) :: rights =>
    let joint := sub3 (add3' d d') b in
    let low := least joint in
    let go := choose (pred back) blocks lefts rights (S at_) in
    let new := Some (low, at_, (begun, ended), joint) in
    if from_end back begun ended && above F.zero low then
      match run with
      | Some (other, _, (begun', ended'), _) =>
        if Nat.eqb begun begun' && Nat.eqb ended ended'
        then go best (if above low other then new else run)
        else go (lowest run best) new
      | None => go best new
      end
    else go best run
  | _, _, _ => lowest run best
  end.

(* n outwards from v, for so many sites by the scan's inverses, then by the tail. *)
Fixpoint spread (l : F.type) (count : nat) (v : plane) (scans : list symmetric) : list plane :=
  match scans with
  | [] => []
  | inv :: scans =>
    let n := match count with O => (fmul l (fst v), fmul l (snd v)) | _ => apply3 inv v end in
    n :: spread l (pred count) n scans
  end.

(* Of the sites ahead and back: of the part that contradicts most plainly, and on towards the middle if
   it ends before. *)
Definition witness (h : manner) (l : F.type) (ahead back : list site) :
    option (list plane * list plane) :=
  let b := length back in
  let back := map (blocked h) back in
  let ahead := map (blocked h) ahead in
  let blocks := rev_append back ahead in
  let lefts := scan_both l (rev_append back []) ahead in
  let rights := rev_append (scan_both l (rev_append ahead []) back) [] in
  match choose b blocks lefts rights 0 None None with
  | None => None
  | Some (_, at_, (begun, ended), joint) =>
    let v := eigenvector joint in
    let below := (at_ - begun)%nat in
    let beyond := (length blocks - S at_ - ended)%nat in
    let lower := spread l below v (firstn (Nat.max below (S at_ - b))
                                     (map (fun x => snd (snd x)) (rev_append (firstn at_ lefts) []))) in
    let upper := spread l beyond v (firstn (Nat.max beyond (b - S at_))
                                      (map (fun x => snd (snd x)) (skipn (S at_) rights))) in
    let all := rev_append lower (v :: upper) in
    let b := (b - (at_ - length lower))%nat in
    Some (skipn b all, rev_append (firstn b all) [])
  end.

(* ---- the bound *)

(* Both lanes together, less more:  D(x1) = l e + r,  D(x0) = o. *)
Definition joint (l : form1 * form1) (r o : I.type * I.type) (a b : sum_of) (more : I.type) :
    I.type * form1 * form2 * form3 :=
  let a0 := minus_affine prec (fst (on_D a)) (fst (mult b)) in
  let a1 := minus_affine prec (snd (on_D a)) (snd (mult b)) in
  let b0 := minus_affine prec (fst (on_D b)) (fst (mult a)) in
  let b1 := minus_affine prec (snd (on_D b)) (snd (mult a)) in
  let lost := add (add (mul (range_affine prec K a0) (fst r)) (mul (range_affine prec K a1) (snd r)))
                  (add (mul (range_affine prec K b0) (fst o)) (mul (range_affine prec K b1) (snd o))) in
  (sub (sub (add (add (value a) (value b)) lost)
            (mul (itwo K) (inner prec (vector a) (vector b)))) more,
   add1 (add1 (sum1 a) (sum1 b)) (add1 (scale1 (fst a0) (fst l)) (scale1 (fst a1) (snd l))),
   add2 prec (add2 prec (sum2 a) (sum2 b))
             (add2 prec (product prec (snd a0) (fst l)) (product prec (snd a1) (snd l))),
   add3 prec (sum3 a) (sum3 b)).

Definition top (n : nat) (p : I.type * form1 * form2 * form3) : I.type :=
  let '(v, p1, p2, p3) := p in summit prec (unit K) (upto1 K) n v p1 p2 p3.

(* ---- which symbol a bound suffers from: on floats, nothing rests on it *)

Definition size_of (i : I.type) : F.type := F.max (F.abs (I.upper i)) (F.abs (I.lower i)).
Definition fsum (l : list F.type) : F.type := fold_right fadd F.zero l.

Fixpoint felt2 (q : form2) : list F.type :=
  match q with
  | [] => []
  | row :: q => let m := map size_of row in fsum m :: zip fadd (tl m) (felt2 q)
  end.
Fixpoint felt3 (before : list F.type) (t : form3) : list F.type :=
  match t with
  | [] => []
  | q :: t =>
    let m := felt2 q in
    zip fadd (zip fadd m (before ++ [fsum m])) (felt3 (F.zero :: before) t)
  end.

(* How far each symbol moves the last site of a lane. *)
Definition stretch (sites : list site) : list F.type :=
  match rev_append sites [] with
  | [] => []
  | s :: _ => fold_right (fun w a => zip fadd (map size_of (xi w)) a) [] (view s)
  end.

(* Of the axes of a cell, in their order: the angles are the last symbols. *)
Definition blame (n : nat) (sa sb : list site) (i : I.type) (p1 : form1) (p2 : form2) (p3 : form3) :
    list F.type :=
  let ends := zip fadd (stretch sa) (stretch sb) in
  let rest := fdiv (fsub (I.upper i) (center i)) (fsum ends) in
  let all := zip fadd (zip fadd (map size_of p1) (zip fadd (felt2 p2) (felt3 [] p3)))
                 (map (fmul rest) ends) in
  skipn n all ++ firstn n all.

Definition prism_bound (h : manner) (rd : ready) (c : cell) : option (I.type * list F.type) :=
  match map span c with
  | u0 :: u1 :: ts =>
    let ws := map (wave_in ts) (plain rd) in
    let '(x, l0, r0) := placed ts (fst (base rd)) (fst (shears rd)) (fst (sides rd)) u0 u1 in
    let '(y, l1, r1) := placed ts (snd (base rd)) (snd (shears rd)) (snd (sides rd)) u0 u1 in
    let sa := follow prec K sincos (longest h) (limit h) ws
      (begin (X0 rd) (x, y) ([], []) (l0, l1) (rest_0 rd) (r0, r1)) in
    let sb := follow prec K sincos (longest h) (limit h) ws
      (begin (x, y) (X0 rd) (l0, l1) ([], []) (r0, r1) (rest_0 rd)) in
    match witness h (center (end_ rd)) sa sb with
    | Some (na, (n0 :: _) as nb) =>
      if (Nat.leb (length na) (length sa) && Nat.leb (length nb) (length sb))%bool then
        let p := joint (l0, l1) (r0, r1) (rest_0 rd)
                   (backward prec K (end_ rd) sa (map exact2 na))
                   (backward prec K (end_ rd) sb (map exact2 nb))
                   (match na with
                    | [] => mul (end_ rd) (square_sum prec (exact2 n0))
                    | _ => I.zero
                    end) in
        let i := top (length c) p in
        let '(v, p1, p2, p3) := p in
        Some (i, if negative i then [] else blame (length ts) sa sb v p1 p2 p3)
      else None
    | _ => Some (I.nai, blame (length ts) sa sb (unit K) (add1 l0 l1) [] [])
    end
  | _ => None
  end.

(* ---- that it holds *)

Lemma span_ok s u : in_slice s u -> exists a r e, cont (fst (span s)) a /\ cont (snd (span s)) r /\
  -1 <= e <= 1 /\ u = a + r * e.
Proof.
  destruct s as (i, c). intros H. destruct (slice_symbol _ _ _ H) as (e & He & E).
  assert (P : IZR (2 ^ Z.of_nat c) <> 0) by (apply not_0_IZR, Z.pow_nonzero; lia).
  exists ((2 * IZR i + 1) / IZR (2 ^ Z.of_nat c) - 1), (1 / IZR (2 ^ Z.of_nat c)), e.
  unfold span. cbn [fst snd].
  assert (One : cont (ione K) 1) by apply K_ok.
  split; [| split; [| split; [exact He |]]].
  - apply cont_sub; [| exact One]. apply cont_div; [exact P | | apply cont_integer].
    replace (2 * IZR i + 1) with (IZR (2 * i + 1)) by (rewrite plus_IZR, mult_IZR; ring).
    apply cont_integer.
  - apply cont_div; [exact P | exact One | apply cont_integer].
  - rewrite E. field. exact P.
Qed.

Fixpoint located (ts : list (I.type * I.type)) (t es : list R) : Prop :=
  match ts, t, es with
  | [], [], [] => True
  | i :: ts, x :: t, e :: es =>
    (exists a r, cont (fst i) a /\ cont (snd i) r /\ x = a + r * e) /\ located ts t es
  | _, _, _ => False
  end.

Lemma cell_located c u : in_cell c u ->
  exists es, located (map span c) u es /\ cube es /\ length es = length c.
Proof.
  induction 1 as [| s u c us H HH IH]; [exists []; repeat split; constructor |].
  destruct IH as (es & L & C & N), (span_ok s u H) as (a & r & e & Ha & Hr & He & E).
  exists (e :: es). split; [split; [now exists a, r | exact L] |].
  split; [now constructor | simpl; now rewrite N].
Qed.

Lemma parts_ok parts ts t es more isum x : located ts t es -> cont isum x ->
  exists m h, cont (centred (map rational parts) ts isum) (x + m) /\
  hold1 (es ++ more) (moved (map rational parts) ts) h /\ combined parts t = m + h.
Proof.
  revert ts t es isum x. induction parts as [| g parts IH]; intros ts t es isum x L Hx.
  { exists 0, 0. rewrite Rplus_0_r. split; [exact Hx |]. split; [apply hold1_nil |].
    unfold combined. simpl. ring. }
  destruct ts as [| i ts], t as [| t0 t], es as [| e es]; try easy.
  { exists 0, 0. rewrite Rplus_0_r. split; [exact Hx |]. split; [apply hold1_nil |].
    unfold combined. simpl. ring. }
  destruct L as ((a & r & Ha & Hr & E) & L).
  destruct (IH ts t es (add isum (mul (rational g) (fst i))) (x + Q2R g * a) L)
    as (m & h & Hm & Hh & Eq).
  { apply cont_add; [exact Hx |]. apply cont_mul; [apply cont_rational | exact Ha]. }
  exists (Q2R g * a + m), (Q2R g * r * e + h). split; [now rewrite <- Rplus_assoc |].
  split.
  - exists (Q2R g * r), h. split; [apply cont_mul; [apply cont_rational | exact Hr] |].
    now split.
  - change (combined (g :: parts) (t0 :: t)) with (Q2R g * t0 + combined parts t).
    rewrite Eq, E. ring.
Qed.

Definition wave_of (w : term) (t : list R) : wave :=
  Wave (of_k0 w) (of_k1 w) (Q2R (of_phase w) * PI) (Q2R (middle w) + combined (parts w) t).

Lemma waves_held ts t es more ws : located ts t es -> exists ms,
  Forall2 (held (es ++ more)) (map (wave_in ts) (map prepare_wave ws)) ms /\ Forall entire ms /\
  map its ms = waves ws t.
Proof.
  intros L. induction ws as [| w ws IH]; [exists []; repeat split; constructor |].
  destruct IH as (ms & H & W & E).
  destruct (parts_ok (parts w) ts t es more (rational (middle w)) (Q2R (middle w)) L
    (cont_rational prec _)) as (m & h & Hm & Hh & Eq).
  exists (Moving (wave_of w t) (Q2R (middle w) + m) h :: ms).
  split; [| split].
  - cbn [map]. constructor; [| exact H]. unfold prepare_wave, wave_in.
    split; [reflexivity |]. split; [reflexivity |].
    split; [apply cont_integer |]. split; [apply cont_integer |].
    split; [| split; [exact Hm | exact Hh]]. unfold wave_of. cbn [turns its phase].
    replace (Q2R (of_phase w) * PI / (2 * PI)) with (/ 2 * Q2R (of_phase w))
      by (field; apply PI_neq0).
    apply cont_mul; [apply K_ok | apply cont_rational].
  - constructor; [| exact W]. unfold entire, wave_of. cbn [its amplitude mid_amp more_amp].
    rewrite Eq. ring.
  - cbn [map its]. now rewrite E.
Qed.

Lemma beyond_turns_ok i x t : cont i x ->
  cont (beyond_turns i t) (x - 2 * PI * (number (fst t) + IZR (snd t))).
Proof.
  intros H. apply cont_sub; [exact H |]. apply cont_mul; [apply K_ok |].
  apply cont_add; [apply cont_exactly | apply cont_integer].
Qed.

Definition shears_by (g : I.type) (q : Q) : Prop := cont g (PI * Q2R q).

Lemma shearing_ok a s b s' t :
  combined (shearing a s b s') t = Q2R a * combined s t + Q2R b * combined s' t.
Proof.
  unfold shearing. rewrite <- combined_scaled, <- combined_added.
  generalize (added b (map (Qmult a) s) s'). intros l. revert t.
  induction l as [| q l IH]; intros [| x t]; try reflexivity.
  change (Q2R (Qred q) * x + combined (map Qred l) t = Q2R q * x + combined l t).
  now rewrite IH, (Qeq_eqR _ _ (Qred_correct q)).
Qed.

Lemma sheared_ok e l v gs qs : Forall2 shears_by gs qs -> hold1 e l v ->
  forall ts t es isum x, located ts t es -> cont isum x ->
  exists m h, cont (centred gs ts isum) (x + m) /\ hold1 (es ++ e) (sheared gs ts ++ l) (h + v) /\
  PI * combined qs t = m + h.
Proof.
  intros Hg Hl. induction Hg as [| g q gs qs Hq Hg IH]; intros ts t es isum x L Hx.
  - exists 0, 0. rewrite Rplus_0_r, Rplus_0_l. split; [now destruct ts |]. split.
    + revert t es L. induction ts as [| i ts IH]; intros [| t0 t] [| e0 es] L; try easy.
      exists 0, v. split; [exact cont_zero |]. split; [now apply (IH t), L | ring].
    + unfold combined. simpl. ring.
  - destruct ts as [| i ts], t as [| t0 t], es as [| e0 es]; try easy.
    { exists 0, 0. rewrite Rplus_0_r, Rplus_0_l. split; [exact Hx |]. split; [exact Hl |].
      unfold combined. simpl. ring. }
    destruct L as ((a & r & Ha & Hr & E) & L).
    destruct (IH ts t es (add isum (mul g (fst i))) (x + PI * Q2R q * a) L)
      as (m & h & Hm & Hh & Eq).
    { apply cont_add; [exact Hx |]. now apply cont_mul. }
    exists (PI * Q2R q * a + m), (PI * Q2R q * r * e0 + h). split; [now rewrite <- Rplus_assoc |].
    split.
    + exists (PI * Q2R q * r), (h + v). split; [now apply cont_mul |]. split; [exact Hh | ring].
    + change (combined (q :: qs) (t0 :: t)) with (Q2R q * t0 + combined qs t).
      rewrite Rmult_plus_distr_l, Eq, E. ring.
Qed.

Lemma placed_ok ts t es e0 e1 ib gs qs (iside u0 u1 : I.type * I.type) b s0 s1 a0 r0 a1 r1 :
  cube (es ++ [e0; e1]) -> located ts t es -> Forall2 shears_by gs qs ->
  cont ib b -> cont (fst iside) s0 -> cont (snd iside) s1 ->
  cont (fst u0) a0 -> cont (snd u0) r0 -> cont (fst u1) a1 -> cont (snd u1) r1 ->
  let '(X, l, r) := placed ts ib gs iside u0 u1 in
  exists (n : Z) lv rv, hold1 (es ++ [e0; e1]) l lv /\ cont r rv /\
  b + (s0 * (a0 + r0 * e0) + s1 * (a1 + r1 * e1)) + PI * combined qs t
    = 2 * PI * (number X + IZR n) + (lv + rv).
Proof.
  intros C L Hg Hb H0 H1 Ha0 Hr0 Ha1 Hr1. unfold placed.
  assert (Hc : hold1 [e0; e1] [mul (fst iside) (snd u0); mul (snd iside) (snd u1)]
    (s0 * r0 * e0 + s1 * r1 * e1)).
  { exists (s0 * r0), (s1 * r1 * e1). split; [now apply cont_mul |].
    split; [| reflexivity]. exists (s1 * r1), 0. split; [now apply cont_mul |].
    split; [reflexivity | ring]. }
  destruct (sheared_ok _ _ _ _ _ Hg Hc ts t es
    (add ib (add (mul (fst iside) (fst u0)) (mul (snd iside) (fst u1))))
    (b + (s0 * a0 + s1 * a1)) L) as (m & h & Hx & Hc' & Ed);
    [auto using cont_add, cont_mul |].
  clear Hc. rename Hc' into Hc. rewrite Ed. clear Ed.
  set (ix := centred gs ts _) in *. generalize (in_turns ix). clear t L. intros t.
  destruct (hold_centers _ _ _ Hc) as (lv & Hl).
  exists (snd t), lv. eexists. split; [exact Hl |].
  split; [apply cont_add; [apply (beyond_turns_ok _ _ t Hx) |] |].
  - apply (cont_range1' prec K K_ok _ _ _ C). apply hold_add1; [exact Hc |].
    apply hold_negate1, Hl.
  - ring.
Qed.

Lemma number_zero : number F.zero = 0.
Proof.
  unfold number, F.toR. pose proof F.zero_correct as H. unfold F.toX in *.
  now rewrite H.
Qed.

(* The lane from o to y, both placed. *)
Lemma start_good e o y X Y Lo L ro r lov lv rov rv :
  hold_vec e Lo lov -> hold_vec e L lv -> cont_vec ro rov -> cont_vec r rv ->
  near (real_of X) (minus o (plus lov rov)) -> near (real_of Y) (minus y (plus lv rv)) ->
  good e o y (plus lov rov) (plus lv rv) (begin X Y Lo L ro r).
Proof.
  intros HLo HL Hro Hr HX HY. exists lov, lv, (0, 0), (0, 0), rov, rv, rv.
  repeat (split; [assumption |]). split; [split; apply hold2_nil |]. split; [split; apply hold2_nil |].
  repeat (split; [assumption |]).
  unfold real_of, plus. cbn. rewrite number_zero. destruct rov, rv.
  split; [| split]; simpl; f_equal; ring.
Qed.

(* What backward_ok says of one lane. *)
Definition sums e (t : sum_of) (n0 D Do : vec) (total : R) : Prop :=
  exists v0 v1 v2 v3 H mu, cont (value t) v0 /\ hold1 e (sum1 t) v1 /\ hold2 e (sum2 t) v2 /\
  hold3 e e (sum3 t) v3 /\ hold_both e (on_D t) H /\ hold_both e (mult t) mu /\
  cont_vec (vector t) n0 /\ total = v0 + v1 + v2 + v3 + dot H D - dot mu Do.

Lemma joint_ok e l r o a b lv rv ov na nb va vb : cube e -> hold_vec e l lv -> cont_vec r rv ->
  cont_vec o ov -> sums e a na (plus lv rv) (plus (0, 0) ov) va ->
  sums e b nb (plus (0, 0) ov) (plus lv rv) vb ->
  forall m x, cont m x -> cont (top (length e) (joint l r o a b m)) (va + vb - 2 * dot na nb - x).
Proof.
  intros C (Hl0 & Hl1) (Hr0 & Hr1) (Ho0 & Ho1)
    (v0 & v1 & v2 & v3 & H & mu & A0 & A1 & A2 & A3 & (AH0 & AH1) & (AM0 & AM1) & AV & EA)
    (w0 & w1 & w2 & w3 & H' & mu' & B0 & B1 & B2 & B3 & (BH0 & BH1) & (BM0 & BM1) & BV & EB) m x Hm.
  pose proof (hold_minus_affine prec e _ _ _ _ AH0 BM0) as G0.
  pose proof (hold_minus_affine prec e _ _ _ _ AH1 BM1) as G1.
  pose proof (hold_minus_affine prec e _ _ _ _ BH0 AM0) as G2.
  pose proof (hold_minus_affine prec e _ _ _ _ BH1 AM1) as G3.
  assert (R0 := cont_range_affine prec K K_ok e _ _ C G0).
  assert (R1 := cont_range_affine prec K K_ok e _ _ C G1).
  assert (R2 := cont_range_affine prec K K_ok e _ _ C G2).
  assert (R3 := cont_range_affine prec K K_ok e _ _ C G3).
  destruct G0 as (c0 & x0 & Hc0 & Hx0 & E0), G1 as (c1 & x1 & Hc1 & Hx1 & E1).
  assert (K2 : cont (itwo K) 2) by apply K_ok.
  assert (HV := cont_mul prec _ _ _ _ K2 (cont_inner prec _ _ _ _ AV BV)).
  unfold joint, top. cbv beta iota zeta.
  match goal with |- cont (summit _ _ _ _ ?c ?l1 ?l2 ?l3) _ =>
    assert (Z0 : cont c (v0 + w0 + ((fst H - fst mu') * fst rv + (snd H - snd mu') * snd rv
      + ((fst H' - fst mu) * fst ov + (snd H' - snd mu) * snd ov)) - 2 * dot na nb - x))
      by (apply cont_sub; [| exact Hm]; apply cont_sub; [apply cont_add; [now apply cont_add |] | exact HV];
          apply cont_add; apply cont_add; now apply cont_mul);
    assert (Z1 : hold1 e l1 (v1 + w1 + (c0 * fst lv + c1 * snd lv)))
      by (apply hold_add1; [now apply hold_add1 |]; apply hold_add1; now apply hold_scale1);
    assert (Z2 : hold2 e l2 (v2 + w2 + (x0 * fst lv + x1 * snd lv)))
      by (apply hold_add2; [now apply hold_add2 |]; apply hold_add2; now apply hold_product);
    assert (Z3 : hold3 e e l3 (v3 + w3)) by now apply hold_add3
  end.
  replace (va + vb - 2 * dot na nb - x) with
    (v0 + w0 + ((fst H - fst mu') * fst rv + (snd H - snd mu') * snd rv
      + ((fst H' - fst mu) * fst ov + (snd H' - snd mu) * snd ov)) - 2 * dot na nb - x
     + (v1 + w1 + (c0 * fst lv + c1 * snd lv)) + (v2 + w2 + (x0 * fst lv + x1 * snd lv)) + (v3 + w3)).
  - apply cont_summit; auto; apply K_ok.
  - rewrite EA, EB.
    assert (P0 : c0 * fst lv + x0 * fst lv = (fst H - fst mu') * fst lv) by (rewrite E0; ring).
    assert (P1 : c1 * snd lv + x1 * snd lv = (snd H - snd mu') * snd lv) by (rewrite E1; ring).
    generalize (dot na nb). intros q. unfold dot, plus. cbn [fst snd]. lra.
Qed.

Lemma some_pair {A B} (x y : A) (a b : B) : Some (x, a) = Some (y, b) -> x = y.
Proof. now injection 1. Qed.

Lemma exact2_all l : Forall2 cont_vec (map exact2 l) (map real_of l).
Proof. induction l as [| p l IH]; constructor; [apply cont_exact2 | exact IH]. Qed.

Ltac in_rationals :=
  cbn [fst snd]; repeat first [exact pi_ok | apply cont_mul | apply cont_add | apply cont_rational].

(* What the intervals hold. *)
Record ready_ok (p : problem) (l : Q) (rd : ready) : Prop := {
  ok_plain : plain rd = map prepare_wave (terms p);
  ok_start : exists ov, cont_vec (rest_0 rd) ov /\
    near (real_of (X0 rd)) (minus (point (start p)) (plus (0, 0) ov));
  ok_base0 : cont (fst (base rd)) (PI * (Q2R (f00 p) * Q2R (mid0 p) + Q2R (f01 p) * Q2R (mid1 p)));
  ok_base1 : cont (snd (base rd)) (PI * (Q2R (f10 p) * Q2R (mid0 p) + Q2R (f11 p) * Q2R (mid1 p)));
  ok_side00 : cont (fst (fst (sides rd))) (PI * (Q2R (f00 p) * Q2R (wid0 p)));
  ok_side01 : cont (snd (fst (sides rd))) (PI * (Q2R (f01 p) * Q2R (wid1 p)));
  ok_side10 : cont (fst (snd (sides rd))) (PI * (Q2R (f10 p) * Q2R (wid0 p)));
  ok_side11 : cont (snd (snd (sides rd))) (PI * (Q2R (f11 p) * Q2R (wid1 p)));
  ok_shear0 : Forall2 shears_by (fst (shears rd)) (shearing (f00 p) (shift0 p) (f01 p) (shift1 p));
  ok_shear1 : Forall2 shears_by (snd (shears rd)) (shearing (f10 p) (shift0 p) (f11 p) (shift1 p));
  ok_end : cont (end_ rd) (Q2R l)
}.

Lemma prepare_ok p l : ready_ok p l (prepare p l).
Proof.
  unfold prepare. generalize (in_turns (rational (fst (start p)))).
  generalize (in_turns (rational (snd (start p)))). intros ty tx.
  assert (Shears : forall qs, Forall2 shears_by (map (fun g => mul pi (rational g)) qs) qs).
  { intros qs. induction qs as [| q qs IH]; constructor; [unfold shears_by; in_rationals | exact IH]. }
  constructor; cbn [plain rest_0 X0 base sides shears end_ fst snd];
    [reflexivity | | in_rationals .. | apply Shears | apply Shears | in_rationals].
  exists (Q2R (fst (start p)) - 2 * PI * (number (fst tx) + IZR (snd tx)),
          Q2R (snd (start p)) - 2 * PI * (number (fst ty) + IZR (snd ty))).
  split; [split; apply beyond_turns_ok, cont_rational |].
  exists (snd tx), (snd ty). unfold point, minus, plus, real_of. apply vec_eq; cbn [fst snd]; ring.
Qed.

Theorem bound_ok p l B h rd c u i b : 0 < Q2R l < 1 -> B <= Q2R l + / Q2R l ->
  (forall t, in_cube t -> forall y v, beta (waves (terms p) t) y v <= B * dot v v) ->
  ready_ok p l rd -> prism_bound h rd c = Some (i, b) -> negative i = true -> in_cell c u ->
  excluded p u.
Proof.
  intros Hl HBl HB R E Neg HC.
  destruct u as [| u0 [| u1 t]]; try exact Logic.I. intros Ht x Ox X0x X1x.
  unfold prism_bound in E.
  destruct (cell_located _ _ HC) as (es' & L & C & N).
  destruct (map span c) as [| i0 [| i1 ts]] eqn:EC; try easy.
  destruct es' as [| e0 [| e1 es]]; try (simpl in L; tauto).
  destruct L as ((a0 & r0 & Ha0 & Hr0 & E0) & (a1 & r1 & Ha1 & Hr1 & E1) & L).
  assert (C' : cube (es ++ [e0; e1])).
  { inversion C as [| ? ? Q0 C1]. inversion C1 as [| ? ? Q1 C2]. apply Forall_app.
    split; [exact C2 |]. constructor; [exact Q0 | constructor; [exact Q1 | constructor]]. }
  assert (Ne : length c = length (es ++ [e0; e1])) by (rewrite app_length; simpl in *; lia).
  destruct (waves_held ts t es [e0; e1] (terms p) L) as (ms & HW & Wms & Ems).
  rewrite Ne, (ok_plain _ _ _ R) in E.
  set (e := es ++ [e0; e1]) in *.
  set (ws := map (wave_in ts) _) in *.
  (* where x1 and x0 are *)
  assert (PX := placed_ok ts t es e0 e1 _ _ _ _ i0 i1 _ _ _ a0 r0 a1 r1 C' L (ok_shear0 _ _ _ R)
    (ok_base0 _ _ _ R) (ok_side00 _ _ _ R) (ok_side01 _ _ _ R) Ha0 Hr0 Ha1 Hr1).
  destruct (placed _ (fst (base rd)) _ (fst (sides rd)) i0 i1) as ((X, l0), rr0).
  destruct PX as (n0 & lv0 & rv0 & Hl0 & Hrr0 & EX).
  assert (PY := placed_ok ts t es e0 e1 _ _ _ _ i0 i1 _ _ _ a0 r0 a1 r1 C' L (ok_shear1 _ _ _ R)
    (ok_base1 _ _ _ R) (ok_side10 _ _ _ R) (ok_side11 _ _ _ R) Ha0 Hr0 Ha1 Hr1).
  destruct (placed _ (snd (base rd)) _ (snd (sides rd)) i0 i1) as ((Y, l1), rr1).
  destruct PY as (n1 & lv1 & rv1 & Hl1 & Hrr1 & EY).
  rewrite <- E0, <- E1, shearing_ok in EX, EY. fold e in Hl0, Hl1.
  destruct (ok_start _ _ _ R) as (ov & HO & N0). rewrite <- X0x in N0.
  assert (N1 : near (real_of (X, Y)) (minus (x 1%Z) (plus (lv0, lv1) (rv0, rv1)))).
  { exists n0, n1. rewrite X1x. unfold second, minus, plus, real_of. cbn [fst snd].
    apply vec_eq; cbn [fst snd]; [clear EY | clear EX]; lra. }
  assert (None' : hold_vec e ([], []) (0, 0)) by (split; apply hold1_nil).
  pose proof (start_good e (x 0%Z) (x 1%Z) (X0 rd) (X, Y) ([], []) (l0, l1) (rest_0 rd) (rr0, rr1)
    (0, 0) (lv0, lv1) ov (rv0, rv1) None' (conj Hl0 Hl1) HO (conj Hrr0 Hrr1) N0 N1) as GA.
  pose proof (start_good e (x 1%Z) (x 0%Z) (X, Y) (X0 rd) (l0, l1) ([], []) (rr0, rr1) (rest_0 rd)
    (lv0, lv1) (0, 0) (rv0, rv1) ov (conj Hl0 Hl1) None' (conj Hrr0 Hrr1) HO N1 N0) as GB.
  apply (follow_ok prec K K_ok sincos sincos_ok (longest h) (limit h) e ws ms) in GA; auto.
  apply (follow_ok prec K K_ok sincos sincos_ok (longest h) (limit h) e ws ms) in GB; auto.
  set (sa := follow _ _ _ _ _ ws (begin (X0 rd) _ _ _ _ _)) in *.
  set (sb := follow _ _ _ _ _ ws (begin (X, Y) _ _ _ _ _)) in *.
  destruct (witness h _ sa sb) as [(na, [| nb0 nb]) |];
    try (apply some_pair in E; rewrite <- E in Neg; discriminate Neg).
  cbv beta iota in E.
  destruct (Nat.leb_spec (length na) (length sa)) as [La |]; [| easy].
  destruct (Nat.leb_spec (length (nb0 :: nb)) (length sb)) as [Lb |]; [| easy].
  cbv beta iota delta [andb] in E.
  destruct (joint _ _ _ _ _ _) as (((v, p1), p2), p3) eqn:J in E. cbv zeta in E.
  apply some_pair in E. rewrite <- J in E.
  assert (EJ := joint_ok e (l0, l1) (rr0, rr1) (rest_0 rd) _ _ (lv0, lv1) (rv0, rv1) ov _ _ _ _ C'
    (conj Hl0 Hl1) (conj Hrr0 Hrr1) HO
    (backward_ok prec K K_ok e ms (end_ rd) (Q2R l) (map exact2 na) C'
      (ok_end _ _ _ R) sa (map real_of na) _ _ _ _ GA (exact2_all _)
      ltac:(now rewrite map_length))
    (backward_ok prec K K_ok e ms (end_ rd) (Q2R l) (map exact2 (nb0 :: nb)) C'
      (ok_end _ _ _ R) sb (map real_of (nb0 :: nb)) _ _ _ _ GB (exact2_all _)
      ltac:(now rewrite map_length))).
  destruct na as [| na0 na].
  - specialize (EJ _ _ (cont_mul prec _ _ _ _ (ok_end _ _ _ R)
      (cont_square_sum prec _ _ (cont_exact2 nb0)))).
    rewrite E in EJ. apply (negative_correct _ _ Neg) in EJ. rewrite Ems in EJ.
    apply (back_refuted (waves (terms p) t) x B (Q2R l) (map real_of (nb0 :: nb))); auto;
      try discriminate.
    simpl part at 1 in EJ. simpl hd in EJ |- *. unfold dot at 1 in EJ. simpl in EJ |- *. lra.
  - specialize (EJ _ _ cont_zero).
    rewrite E in EJ. apply (negative_correct _ _ Neg) in EJ. rewrite Ems in EJ.
    apply (lanes_refuted (waves (terms p) t) x B (Q2R l) (map real_of (na0 :: na))
      (map real_of (nb0 :: nb))); auto; try discriminate. lra.
Qed.
End Precision.
End Prism.
