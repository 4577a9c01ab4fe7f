(* A theorem of Kolmogorov, Arnold and Moser: the standard map with the parameter 0.5 has an invariant graph,
   on which it is conjugate to the rotation of the golden mean.  The integers are the sine coefficients of
   u0(t) in units of 2^-76, found by Newton's method; nothing depends on how. *)

From Coq Require Import Reals ZArith List Lra.
From Converse Require Import golden_says.
(* Not imported: no name of theirs hides one of those above. *)
From Converse Require Exists.
Import ListNotations.

Definition certificate : Exists.certificate := Exists.Certificate 21 20 5 10
  [-10899938501115822919380; 1541918156123800742215; -603078338909686048595; 49659156826482235373;
   -80573205916029319006; 9170372680135843667; -2027356229440660097; 7171412545329876539;
   -514296755775116815; 252391110169557139; -77413240282303882; 18966295525811418; -146573348834359798;
   12251602756222001; -2937701847017593; 3150318581850953; -292350463006970; 335515235980185;
   -69658447109123; 42592242285314; -432783217843210; 30836694810144; -10632104342180; 4780856951135;
   -644465163998; 2111147963515; -239562538538; 57900959563; -138050581789; 12180705067; -9271506524;
   3274092694; -3307733196; 42614446361; -3236042996; 853726456; -625728841; 64198085; -103706525; 16518772;
   -5056413; 29706179; -2293986; 1055999; -398431; 75898; -449309; 45186; -11504; 17547; -1697; 1869; -673;
   1173; -15261; 1073]%Z
  (2 ^ 76) 72 15.

Lemma conjugated : exists x, Exists.conjugacy 0.5 x.
Proof.
  replace 0.5%R with (IZR 5 / IZR 10)%R by lra. apply (Exists.conjugacy_exists certificate).
  vm_cast_no_check (eq_refl true).
Qed.

Theorem golden : golden_says.
Proof. destruct conjugated as [x H]. exact (Exists.graph_exists _ x H). Qed.
