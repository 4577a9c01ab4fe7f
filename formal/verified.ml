(* converse-verified: the checker that Check.v proves, as a command.

   Three parts of it are not proved, and all of them are here: what the file says is read, leaves
   are shared out among processes, and what was verified is said.  Whether it is true is decided by
   Coq's functions alone (Checker, extracted): header_ok and, of every leaf, leaf_ok.  They are given
   the claim, and the theorem that is printed is that of the same claim.  The tree and the hints are
   no part of it: with wrong ones nothing is verified that is false.

   The format of the file, and the exit statuses: docs/reference/proof-file.md. *)

open Checker
open Stdlib                                     (* its lists and numbers, not Coq's *)

let program = "converse-verified"
let verified, rejected, unusable, part, spot_check, not_confirmed = 0, 1, 2, 3, 4, 5
let interrupted = 128                           (* and the number of the signal *)

let max_bytes = 1 lsl 28                        (* of a proof file, uncompressed *)
let max_line = 1 lsl 24                         (* of the header *)
let max_cuts = 1000                             (* of a leaf *)
let max_characters = 3000                       (* of a number *)

exception Failed of int * string                (* nothing was verified; why *)
exception Interrupted of int

let fail status word = Printf.ksprintf (fun text -> raise (Failed (status, word ^ text)))
let reject form = fail rejected "rejected: " form
let beyond form = fail not_confirmed "not confirmed: " form
let refuse form = fail unusable "" form

(* ---- exact numbers: Coq's own, to and from text and doubles *)

(* Of a word without a sign, as -min_int is one. *)
let rec positive_of n =
  if n = 1 then XH
  else if n land 1 = 0 then XO (positive_of (n lsr 1)) else XI (positive_of (n lsr 1))

let z_of n = if n = 0 then Z0 else if n > 0 then Zpos (positive_of n) else Zneg (positive_of (-n))
let ten = z_of 10
let rec power z n = if n = 0 then z_of 1 else Z.mul z (power z (n - 1))
let power_of_10 = power ten

(* m / n *)
let ratio m = function
  | Zpos n -> { qnum = m; qden = n }
  | _ -> invalid_arg "a denominator that is not positive"

let whole n = ratio (z_of n) (z_of 1)
let less x y = qcompare x y = Lt
let absolute x = if less x (whole 0) then qminus (whole 0) x else x
let vanishes x = qcompare x (whole 0) = Eq

(* m 2^e with 1 <= m < 2 *)
let rec scaled = function
  | XH -> 1.0, 0
  | XO p -> let m, e = scaled p in m, e + 1
  | XI p -> let m, e = scaled p in m +. ldexp 1.0 (-e - 1), e + 1

let float_of x =
  let over p = let m, e = scaled p and n, f = scaled x.qden in ldexp (m /. n) (e - f) in
  match x.qnum with Z0 -> 0.0 | Zpos p -> over p | Zneg p -> -. over p

let is_digit c = '0' <= c && c <= '9'
let is_sign c = c = '+' || c = '-'
let all_digits word = word <> "" && String.for_all is_digit word

let z_of_digits = String.fold_left (fun z c -> Z.add (Z.mul ten z) (z_of (Char.code c - 48))) Z0

(* The sign of a word, and the rest of it. *)
let signed word =
  let rest = String.length word - 1 in
  if rest >= 0 && is_sign word.[0] then word.[0] = '-', String.sub word 1 rest else false, word

let cut_at c word =
  Option.map (fun i -> String.sub word 0 i, String.sub word (i + 1) (String.length word - i - 1))
    (String.index_opt word c)

let with_sign (negative, z) = if negative then Z.opp z else z

(* A decimal: a sign, digits with a point, an exponent of three digits at most.  None if it is none. *)
let decimal word =
  let negative, word = signed word in
  let mantissa, (down, exponent) =
    match cut_at 'e' (String.map (fun c -> if c = 'E' then 'e' else c) word) with
    | Some (mantissa, exponent) -> mantissa, signed exponent
    | None -> word, (false, "0") in
  let before, after = Option.value (cut_at '.' mantissa) ~default:(mantissa, "") in
  if not (all_digits (before ^ after) && all_digits exponent && String.length exponent <= 3) then None
  else
    let exponent = int_of_string ("0u" ^ exponent) * (if down then -1 else 1) in
    let places = exponent - String.length after in
    let digits = with_sign (negative, z_of_digits (before ^ after)) in
    Some (if places >= 0 then ratio (Z.mul digits (power_of_10 places)) (z_of 1)
          else ratio digits (power_of_10 (-places)))

let decimal_or_ratio word =
  let negative, unsigned = signed word in
  match cut_at '/' unsigned with
  | Some (m, n) when all_digits m && all_digits n && String.exists (fun c -> c <> '0') n ->
    Some (ratio (with_sign (negative, z_of_digits m)) (z_of_digits n))
  | _ -> decimal word

let rec text_of_z z =
  match z with
  | Zneg p -> "-" ^ text_of_z (Zpos p)
  | _ ->
    let above, digit = Z.div_eucl z ten in
    (if above = Z0 then "" else text_of_z above) ^
    List.nth ["0"; "1"; "2"; "3"; "4"; "5"; "6"; "7"; "8"; "9"]
      (match digit with Zpos p -> truncate (let m, e = scaled p in ldexp m e) | _ -> 0)

let text_of_ratio x =
  let x = qred x in
  text_of_z x.qnum ^ (if x.qden = XH then "" else "/" ^ text_of_z (Zpos x.qden))

(* The exponents of 2 and 5 in a number that has no other prime factors. *)
let rec twos_and_fives = function
  | XO p -> let twos, fives = twos_and_fives p in twos + 1, fives
  | p ->
    let rec fives n z = if Z.compare z (Zpos p) = Lt then fives (n + 1) (Z.mul (z_of 5) z) else n in
    0, fives 0 (z_of 1)

(* A finite decimal, exactly, without zeros at its end. *)
let text_of x =
  let twos, fives = twos_and_fives x.qden in
  let places = max twos fives in
  let digits = Z.mul (absolute x).qnum
      (Z.mul (power (z_of 2) (places - twos)) (power (z_of 5) (places - fives))) in
  let digits = text_of_z digits in
  let digits = String.make (max 0 (places + 1 - String.length digits)) '0' ^ digits in
  let point = String.length digits - places in
  let rec last k = if k > point && digits.[k - 1] = '0' then last (k - 1) else k in
  let last = last (String.length digits) in
  (if less x (whole 0) then "-" else "") ^ String.sub digits 0 point ^
  (if last = point then "" else "." ^ String.sub digits point (last - point))

(* ---- the file *)

(* Its bytes, uncompressed. *)
let load path =
  let all channel =
    let data = Buffer.create 65536 in
    (try
       while Buffer.length data <= max_bytes do Buffer.add_channel data channel 65536 done
     with End_of_file -> ());                   (* what was there before it is added *)
    if Buffer.length data > max_bytes then
      beyond "the file is larger than %d bytes, the checker's limit" max_bytes;
    Buffer.contents data in
  try
    let channel = Unix.in_channel_of_descr (Unix.openfile path [Unix.O_RDONLY] 0) in
    let data = Fun.protect ~finally:(fun () -> close_in channel) (fun () -> all channel) in
    if not (String.starts_with ~prefix:"\x1f\x8b" data) then data
    else
      let unpacked, output = Unix.pipe ~cloexec:true () in
      let silence = Unix.openfile "/dev/null" [Unix.O_WRONLY] 0 in
      let gzip = Unix.create_process "gzip" [| "gzip"; "-dc"; "--"; path |] Unix.stdin output
          silence in
      List.iter Unix.close [output; silence];
      let unpacked = Unix.in_channel_of_descr unpacked in
      let data = Fun.protect ~finally:(fun () -> close_in unpacked) (fun () -> all unpacked) in
      if snd (Unix.waitpid [] gzip) = Unix.WEXITED 0 then data
      else refuse "the compressed file is damaged or truncated"
  with Sys_error why -> refuse "cannot be read (%s)" why
     | Unix.Unix_error (error, _, _) -> refuse "cannot be read (%s)" (Unix.error_message error)

(* A tree and how many leaves it has; of the claim itself, without a name, or of a part. *)
type grown = { name : string; its : claim; tree : tree; proved : int; symmetric : int; linked : int }

type file = {
  claim : claim;
  further : part list;
  trees : grown list;                           (* the claim's, then those of the parts *)
  sha256 : string
}

let total f file = List.fold_left (fun n tree -> n + f tree) 0 file.trees
let letters = "abcdefghijklmnopqrstuvwxyz"      (* of parts, and of leaves linked to them *)

let counts = ["depth"; "cuts"; "proved"; "symmetric"; "linked"; "undecided"; "most_cuts"]
let ignored = ["program"; "method"; "digits"; "stubborn"; "quick_tries"; "tries"; "Rtries";
               "HermSuccess"; "LLSuccess"; "ll_used"; "reasons"; "max_steps"; "max_NTsteps"; "B";
               "pending"]
let optional = ["T"; "Tr-"; "Tr+"; "lambda-min"; "lambda-max"; "seconds"; "hopeless";
                "long orbits"; "parameter"; "comment"]
let known = ["v0"; "v1"; "kind"; "xstar"; "at once"; "wave"; "frame"; "alone"; "odd about"]
            @ counts @ ignored

(* The fields of the header, each once, and its waves. *)
let fields lines =
  let found = Hashtbl.create 64 and waves = ref [] in
  List.iteri (fun i line ->
      let at = i + 2 in
      if String.length line >= max_line then
        beyond "line %d is longer than the checker's limit, %d bytes" at (max_line - 1);
      if cut_at ':' line = Some ("angles", " 3") then
        beyond "the file is of three angles, and this checker is for two";
      let name, value = match cut_at ':' line with
        | Some (name, value) when value <> "" && value.[0] = ' '
                                  && List.mem name (known @ optional) ->
          name, String.sub value 1 (String.length value - 1)
        | _ -> reject "line %d, in the header, is of unknown meaning" at in
      if name = "wave" then waves := value :: !waves
      else if Hashtbl.mem found name && name <> "comment" && name <> "parameter" then
        reject "the header gives %s twice" name;
      Hashtbl.replace found name value) lines;
  if not (Hashtbl.mem found "xstar") then
    reject "the search had not begun when it was left: there is no x* yet";
  List.iter (fun name -> if not (Hashtbl.mem found name) then reject "the header lacks %s" name) known;
  Hashtbl.find found, List.rev !waves

let number form name word =
  if String.length word > max_characters then
    beyond "%s has more than %d characters, the checker's limit" name max_characters;
  match form word with
  | None -> reject "%s is not a number" name
  | Some x when less (ratio (power_of_10 300) (z_of 1)) (absolute x) ->
    beyond "%s is out of range: the checker's limit is 1e300" name
  | Some x -> x

(* An integer from -100 to 100. *)
let small name word =
  let negative, digits = signed word in
  if not (all_digits digits && String.length digits <= 3) then reject "%s is not an integer" name;
  let n = int_of_string ("0u" ^ digits) in
  if n > 100 then reject "%s is beyond 100" name;
  z_of (if negative then -n else n)

let wave at line =
  let name = Printf.sprintf "the header's wave %d" at in
  match String.split_on_char ' ' line with
  | k0 :: k1 :: phase :: amplitude :: parts when List.length parts <= 3 ->
    let k0 = small (name ^ "'s k") k0 and k1 = small (name ^ "'s k") k1 in
    if k0 = Z0 && k1 = Z0 then reject "%s has a k that is zero" name;
    { of_k0 = k0; of_k1 = k1; of_phase = number decimal_or_ratio name phase;
      middle = number decimal name amplitude; parts = List.map (number decimal name) parts }
  | _ -> reject "%s is not K0 K1 PHASE AMPLITUDE and at most three parts" name

let pair ?(form = decimal) name text =
  match String.split_on_char ' ' text with
  | [x; y] -> number form name x, number form name y
  | _ -> reject "%s is not two numbers" name

(* A centre and a half-width. *)
let range name text =
  let centre, half = pair name text in
  if less half (whole 0) then reject "%s: the half-width is negative" name;
  centre, half

(* The same of a part, and perhaps a shift for each of the parameters. *)
let shifted_range parameters name text =
  match String.split_on_char ' ' text with
  | centre :: half :: (_ :: _ as shifts) ->
    if List.length shifts <> parameters then
      reject "%s is not two numbers, nor %d with shifts" name (2 + parameters);
    let range = range name (centre ^ " " ^ half) in
    range, List.map (number decimal name) shifts
  | _ -> range name text, []

(* Does a parameter move the region? *)
let is_shifted { shifts = s0, s1; _ } = not (List.for_all vanishes (s0 @ s1))

(* The claim, and the counts.  Of the whole torus is said what Coq's `covers` lets be said of it. *)
let claim_of lines =
  let field, lines = fields lines in
  if field "kind" <> "sound" then
    reject "the file's kind is not 'sound': it is not meant as a proof";
  let given ?form name = pair ?form ("the header's " ^ name) (field name) in
  let ranged name = range ("the header's " ^ name) (field name) in
  let one_of name values =
    match List.assoc_opt (field name) values with
    | Some value -> value
    | None -> reject "the header's %s is neither %s" name
                (String.concat " nor " (List.map fst values)) in
  let count name =
    if not (all_digits (field name) && String.length (field name) <= 18) then
      reject "the header's %s is not a count" name;
    int_of_string ("0u" ^ field name) in
  let (centre0, half0), (centre1, half1) = ranged "v0", ranged "v1" in
  let of_xstar = given "xstar" in
  let counted = List.map (fun name -> name, count name) counts in
  let count_of_waves = List.length lines in
  if count_of_waves > 16 || count_of_waves = 0 then
    reject "the header has %d waves, not 1 to 16" count_of_waves;
  let of_patch = List.mapi (fun i line -> wave (i + 1) line) lines in
  let m00, m01, m10, m11 =
    match List.map (small "an entry of the header's frame")
            (String.split_on_char ' ' (field "frame")) with
    | [a; b; c; d] ->
      (match Z.add (Z.mul a d) (Z.opp (Z.mul b c)) with
       | Z0 -> reject "the header's frame has determinant 0"
       | _ -> a, b, c, d)
    | _ -> reject "the header's frame is not four integers" in
  let of_alone = one_of "alone" ["no", Both; "0", First; "1", Second] in
  let of_once = one_of "at once" ["no", No; "yes", Whole_patch; "upper end", Upper_end] in
  let odd =
    if field "odd about" = "no" then None else Some (given ~form:decimal_or_ratio "odd about") in
  if of_once = Upper_end && List.length (List.hd of_patch).parts <> 1 then
    reject "without exactly one parameter there is no upper end";
  if of_once <> No && odd = None then
    reject "larger parameters are excluded at once only where V is odd about a point";
  (match odd with
   | Some point when not (odd_about (felt of_alone of_patch) point) ->
     reject "V is not odd about the point that the header names"
   | _ -> ());
  let claim = { of_patch; of_xstar; shifts = [], []; of_alone; of_once; odd; of_whole = true;
                of_region = { m00; m01; m10; m11; centre0; half0; centre1; half1 } } in
  { claim with of_whole = covers claim }, counted

(* Where a text begins in the data, from a position on; or before the end. *)
let find text data start =
  let n = String.length text in
  let rec from i =
    if i + n > String.length data then None
    else if String.sub data i n = text then Some i else
      Option.bind (String.index_from_opt data (i + 1) text.[0]) from in
  Option.bind (String.index_from_opt data start text.[0]) from

(* The text in pieces, between which another text stood: so many at most, of which the last is the
   rest. *)
let split_at separator most text =
  let rec pieces count start =
    match if count = most then None else find separator text start with
    | None -> [String.sub text start (String.length text - start)]
    | Some at ->
      String.sub text start (at - start) :: pieces (count + 1) (at + String.length separator) in
  pieces 1 0

(* The tree of a text without lines, if it is whole and decided, with the depth of its deepest leaf,
   and of its deepest leaf P.  Leaves may be linked to the parts from the one of number `first` on. *)
let tree_of name its text first parts parameters =
  let reject form = reject ("%s" ^^ form) (if name = "" then "" else name ^ ": ") in
  let position = ref 0 and proved = ref 0 and symmetric = ref 0 and linked = ref 0
  and most_cuts = ref 0 and deepest = ref 0 in
  let axis = [| O; S O; S (S O); S (S (S O)); S (S (S (S O))) |] in
  let rec nat_of n = if n = 0 then O else S (nat_of (n - 1)) in
  let rec node cuts =
    if cuts > max_cuts then
      beyond "node %d lies below %d cuts, the checker's limit" !position max_cuts;
    if !position = String.length text then reject "the tree is incomplete";
    let c = text.[!position] in
    incr position;
    let leaf count kind = incr count; deepest := max cuts !deepest; kind in
    match c with
    | 'P' -> most_cuts := max cuts !most_cuts; leaf proved Proved
    | 'S' when is_shifted its ->
      reject "a leaf is symmetric, and the region has shifts: it is not its own mirror image"
    | 'S' -> leaf symmetric Skipped
    | 'U' -> reject "a leaf is undecided: the file claims no theorem"
    | '0' .. '4' ->
      let k = Char.code c - 48 in
      if k >= 2 + parameters then reject "the tree cuts a parameter that there is not";
      let lower = node (cuts + 1) in
      let upper = node (cuts + 1) in
      Cut (axis.(k), lower, upper)
    | _ ->
      match String.index_opt letters c with
      | Some k when first <= k && k < parts -> leaf linked (Linked (nat_of (k - first)))
      | Some _ -> reject "node %d is linked to part %c, which is no later part" (!position - 1) c
      | None -> reject "node %d is not one of a finished tree" (!position - 1) in
  let tree = node 0 in
  if !position < String.length text then
    reject "the tree ends before its text does, at node %d" !position;
  { name; its; tree; proved = !proved; symmetric = !symmetric; linked = !linked },
  !deepest, !most_cuts

(* A part but for its tree, and the text of that, from what follows `part: `. *)
let part_of parameters letter text =
  let name = Printf.sprintf "part %c" letter in
  let lacking () =
    reject "%s is not 'part: %c', xstar, v0, v1 and a tree, each on its line" name letter in
  let value form key line =
    let prefix = key ^ ": " in
    if not (String.starts_with ~prefix line) then lacking ();
    let from = String.length prefix in
    fun () -> form (name ^ "'s " ^ key) (String.sub line from (String.length line - from)) in
  match String.split_on_char '\n' text with
  | first :: xstar :: v0 :: v1 :: "tree:" :: (_ :: _ as tree) when first = String.make 1 letter ->
    let range = shifted_range parameters in
    let xstar = value (fun name -> pair name) "xstar" xstar
    and v0 = value range "v0" v0 and v1 = value range "v1" v1 in
    let starts_at = xstar () in
    let range0, shifts0 = v0 () in
    let range1, shifts1 = v1 () in
    { starts_at; range0; range1; its_shifts = shifts0, shifts1; its_tree = Proved },
    String.concat "" tree
  | _ -> lacking ()

let sha256 data = Sha256.(to_hex (string data))

(* The claim, and what follows the header: a tree, and perhaps parts. *)
let file_of claim counted text sha256 =
  let parameters = List.length (List.hd claim.of_patch).parts in
  let most = String.length letters + 2 in       (* the claim's own tree, and one part too many *)
  let first, parts = match split_at "\npart: " most ("\n" ^ text) with
    | first :: parts -> String.concat "" (String.split_on_char '\n' first), parts
    | [] -> "", [] in
  let count = List.length parts in
  if count > String.length letters then reject "there are more parts than letters";
  if count > 0 && claim.of_alone <> Both then
    reject "a coordinate is alone, and there are parts: links are of whole graphs";
  let parts = List.mapi (fun n text -> part_of parameters letters.[n] text) parts in
  let texts = first :: List.map snd parts in
  let claims = ("", claim) :: List.mapi (fun n (part, _) ->
      Printf.sprintf "part %c" letters.[n], at_part claim part) parts in
  let grown = List.mapi (fun n (name, its) ->
      tree_of name its (List.nth texts n) n count parameters) claims in
  let trees = List.map (fun (tree, _, _) -> tree) grown in
  let further = List.map2 (fun (part, _) { tree; _ } -> { part with its_tree = tree })
      parts (List.tl trees) in
  let file = { claim; further; trees; sha256 } in
  if List.exists (fun (_, deepest, _) -> deepest > List.assoc "depth" counted) grown then
    reject "a leaf was cut more often than the depth allows";
  let proved = total (fun tree -> tree.proved) file and linked = total (fun tree -> tree.linked) file
  and symmetric = total (fun tree -> tree.symmetric) file in
  let found = ["cuts", proved + symmetric + linked - List.length trees; "proved", proved;
               "symmetric", symmetric; "undecided", 0; "linked", linked;
               "most_cuts", List.fold_left (fun n (_, _, most) -> max n most) 0 grown] in
  List.iter (fun (name, count) ->
      match List.assoc_opt name found with
      | Some value when value <> count ->
        reject "the header's %s is %d, the tree's %d" name count value
      | _ -> ()) counted;
  List.iteri (fun n _ ->
      if not (List.exists (fun text -> String.contains text letters.[n]) texts) then
        reject "no leaf is linked to part %c" letters.[n]) parts;
  file

let magic = "converse proof "

let read path =
  let data = load path in
  if not (String.starts_with ~prefix:magic data) then
    refuse "is not a proof file; converse-check verifies all other files";
  let start = String.length magic in
  let first = match String.index_from_opt data start '\n' with
    | Some stop when stop - start <= 9 -> String.sub data start (stop - start)
    | _ -> "" in
  if String.ends_with ~suffix:"\r" first then
    reject "its lines end in CR LF: it was altered on its way; ask for the original";
  if first <> "6" then refuse "is a proof file of another version; this checker knows version 6";
  let seal = "checksum: sha256 " and length = String.length data in
  let stop = length - (String.length seal + 64 + String.length "\nend\n") in
  if stop < 1 || String.sub data (stop - 1) (1 + String.length seal) <> "\n" ^ seal
     || not (String.ends_with ~suffix:"\nend\n" data) then
    reject "the file does not end with its checksum; it is truncated or altered";
  if String.sub data (stop + String.length seal) 64 <> sha256 (String.sub data 0 stop) then
    reject "wrong checksum: the file was changed or damaged";
  let marker = "\ntree:\n" in
  let head, tree = match find marker data 0 with
    | Some at when at + String.length marker <= stop ->
      let from = at + String.length marker in
      String.sub data 0 at, String.sub data from (stop - from)
    | _ -> reject "there is no tree" in
  let claim, counted = claim_of (List.tl (String.split_on_char '\n' head)) in
  let parameters = List.length (List.hd claim.of_patch).parts in
  if List.exists (fun w -> List.length w.parts <> parameters) claim.of_patch then
    reject "a wave of the header has not as many parts as the first";
  file_of claim counted tree (sha256 data)

(* ---- what the proof needs beside the claim, from doubles: wrong hints prove nothing *)

let pi = 4.0 *. atan 1.0

(* beta - 2I at y, of waves (k0, k1, phase, amplitude): its eigenvalues, least and largest, and a
   vector of the least. *)
let eigen waves (y0, y1) =
  let a, b, d = List.fold_left (fun (a, b, d) (k0, k1, phase, p) ->
      let s = -. p *. sin (k0 *. y0 +. k1 *. y1 +. phase) in
      a +. s *. k0 *. k0, b +. s *. k0 *. k1, d +. s *. k1 *. k1) (0.0, 0.0, 0.0) waves in
  let middle = (a +. d) /. 2.0 and radius = Float.hypot ((a -. d) /. 2.0) b in
  let least = middle -. radius in
  least, middle +. radius, if a < d then (least -. d, b) else (b, least -. a)

(* Where the function is least on the torus, about. *)
let minimum waves f =
  let k = List.fold_left (fun k (k0, k1, _, _) -> max k (max (abs_float k0) (abs_float k1)))
      1.0 waves in
  let count = min 128 (16 * truncate k) in
  let width = 2.0 *. pi /. float count in
  let better x y = if f y < f x then y else x in
  let around (y0, y1) width =
    List.concat_map (fun u -> List.map (fun v -> y0 +. u *. width, y1 +. v *. width)
                        [-1.0; 0.0; 1.0]) [-1.0; 0.0; 1.0] in
  let grid = List.concat_map (fun i -> List.init count (fun j -> float i *. width, float j *. width))
      (List.init count Fun.id) in
  let rec refined x width =
    if width < 1e-9 then x
    else refined (List.fold_left better x (around x width)) (width /. 1.5) in
  refined (List.fold_left better (0.0, 0.0) grid) width

(* The waves at a corner, or at any t, of the patch. *)
let at claim t =
  let float_of_z z = float_of (ratio z (z_of 1)) in
  List.map (fun w ->
      float_of_z w.of_k0, float_of_z w.of_k1, pi *. float_of w.of_phase,
      List.fold_left2 (fun p g t -> p +. t *. float_of g) (float_of w.middle) w.parts t)
    (felt claim.of_alone claim.of_patch)

let rec corners = function
  | [] -> [[]]
  | (low, high) :: ends -> List.concat_map (fun t -> [low :: t; high :: t]) (corners ends)

(* A double in units of 10^-9. *)
let billionths x = ratio (z_of (truncate x)) (power_of_10 9)

(* A bound of beta's eigenvalues and l for the tails, for parameters between these ends. *)
let bound_and_tail claim ends =
  let largest waves =
    let level y = let _, largest, _ = eigen waves y in -. largest in
    2.0 -. level (minimum waves level) in
  let b = List.fold_left (fun b t -> max b (largest (at claim t))) 2.0 (corners ends) in
  let b = ceil (1e9 *. (b *. (1.0 +. 1e-6))) in
  let l = let b = b /. 1e9 in 2.0 /. (b +. sqrt (b *. b -. 4.0)) in
  billionths b, billionths (floor (1e9 *. l) -. 1.0)

let rec number_of = function O -> 0 | S k -> 1 + number_of k

let ends_of (i, cuts) =
  let end_of i = ldexp (float_of (ratio i (z_of 1))) (1 - number_of cuts) -. 1.0 in
  end_of i, end_of (Z.add i (z_of 1))

(* The parameters' slices of all leaves that are linked, each once. *)
let linked_slices trees =
  let found = Hashtbl.create 16 in
  let note _ cell =
    (match cell with _ :: _ :: slices -> Hashtbl.replace found slices () | _ -> ()); true in
  List.iter (fun { its; tree; _ } -> ignore (all_links note (root (axes its)) tree)) trees;
  List.of_seq (Hashtbl.to_seq_keys found)

let hints_of { claim; trees; _ } =
  let parameters = List.length (List.hd claim.of_patch).parts in
  let bound, tail = bound_and_tail claim (List.init parameters (fun _ -> -1.0, 1.0)) in
  let waves = at claim (List.init parameters (fun _ -> if claim.of_once = Upper_end then 1.0 else 0.0)) in
  let level y = let least, _, _ = eigen waves y in least in
  let y = minimum waves level in
  let _, _, n = eigen waves y in
  let size = Float.hypot (fst n) (snd n) in
  let both f (x, y) = billionths (1e9 *. f x), billionths (1e9 *. f y) in
  { bound; tail; place = both (fun y -> y /. pi) y, both (fun n -> n /. size) n;
    nearer = List.map (fun slices -> slices, bound_and_tail claim (List.map ends_of slices))
        (linked_slices trees) }

(* ---- the leaves, shared out *)

(* The chosen leaves of all parts, of which process k of n takes every n-th.  It writes a dot for each one that
   is excluded; the number of the first that is not ends its work.  every_leaf is proved to give what
   asking of all leaves gives; that it asks of each leaf once, in their order, until one is refused, is to
   be read in its five lines (all_leaves, Share.v). *)
let work file hints chosen k n output =
  let number = ref (-1) and turn = ref (-1) and decide = ref (fun _ -> false) and going = ref true in
  let excluded cell =
    incr number;
    if not (chosen !number) then true
    else begin
      incr turn;
      if !turn mod n <> k then true
      else begin
        let good = !decide cell in
        output_string output (if good then "." else string_of_int !number ^ "\n");
        flush output;
        good
      end
    end in
  List.iter (fun (claim, tree) ->
      decide := leaf_ok claim hints;
      if !going then going := every_leaf claim excluded tree)
    (all_parts file.claim (List.hd file.trees).tree file.further)

let signals = [Sys.sighup, 1; Sys.sigint, 2; Sys.sigterm, 15]
let ignore_signals () =
  List.iter (fun (signal, _) -> Sys.set_signal signal Sys.Signal_ignore) signals

(* Only the first one counts. *)
let interrupt number = ignore_signals (); raise (Interrupted number)

(* Signals wait while f works: none strikes between a process and the list of them. *)
let undisturbed f =
  let before = Unix.sigprocmask Unix.SIG_BLOCK (List.map fst signals) in
  match f () with
  | result -> ignore (Unix.sigprocmask Unix.SIG_SETMASK before); result
  | exception error -> ignore (Unix.sigprocmask Unix.SIG_SETMASK before); raise error

(* How many of the chosen leaves are excluded, if all of them are; else which is not. *)
let share file hints chosen jobs progress =
  let processes = ref [] in
  let start k =
    let input, output = Unix.pipe ~cloexec:true () in
    match Unix.fork () with
    | 0 ->
      List.iter (fun (signal, _) ->             (* those that were ignored still are *)
          if Sys.signal signal Sys.Signal_default = Sys.Signal_ignore then
            Sys.set_signal signal Sys.Signal_ignore) signals;
      Sys.set_signal Sys.sigpipe Sys.Signal_default;
      ignore (Unix.sigprocmask Unix.SIG_UNBLOCK (List.map fst signals));
      Unix.close input;
      let status = try work file hints chosen k jobs (Unix.out_channel_of_descr output); 0
        with _ -> 1 in
      Unix._exit status
    | pid -> Unix.close output; processes := (pid, input) :: !processes in
  let text = Bytes.create 65536 and refused = Buffer.create 16 and done_ = ref 0 in
  let rec listen inputs =
    if inputs <> [] && Buffer.length refused = 0 then begin
      let ready, _, _ = Unix.select inputs [] [] (-1.0) in
      let ended = List.filter (fun input ->
          let count = Unix.read input text 0 (Bytes.length text) in
          Bytes.iter (fun c -> if c = '.' then incr done_ else Buffer.add_char refused c)
            (Bytes.sub text 0 count);
          count = 0) ready in
      progress !done_;
      listen (List.filter (fun input -> not (List.mem input ended)) inputs)
    end in
  let finish () = undisturbed (fun () ->
      List.iter (fun (pid, _) -> Unix.kill pid Sys.sigkill) !processes;
      List.iter (fun (pid, _) -> ignore (Unix.waitpid [] pid)) !processes) in
  (match
     for k = 0 to jobs - 1 do undisturbed (fun () -> start k) done;
     listen (List.map snd !processes)
   with
   | () -> finish ()
   | exception error -> finish (); raise error);
  !done_, List.hd (String.split_on_char '\n' (Buffer.contents refused))

(* ---- what is said *)

let range_text name low high =
  let low, high = text_of low, text_of high in
  if low = high then name ^ " = " ^ low else Printf.sprintf "%s <= %s <= %s" low name high

(* The angles that v0 and v1 stand for, such as (v0 + v1, v0 - v1). *)
let frame_text frame =
  let term text x name =
    if x = 0 then text
    else
      let sign = if text <> "" then (if x < 0 then " - " else " + ") else if x < 0 then "-" else "" in
      text ^ sign ^ (if abs x = 1 then name else Printf.sprintf "%d %s" (abs x) name) in
  let sum x y = match term (term "" x "v0") y "v1" with "" -> "0" | text -> text in
  Printf.sprintf "(%s, %s)" (sum (List.nth frame 0) (List.nth frame 1))
    (sum (List.nth frame 2) (List.nth frame 3))

let small_of z = truncate (float_of (ratio z (z_of 1)))

(* Is it stated in the thesis's a, b and c?  They are the parameters, or move together and none of them
   downwards, or are fixed. *)
let is_boxed patch =
  List.map (fun w -> small_of w.of_k0, small_of w.of_k1) patch = [1, 0; 0, 1; 1, 1]
  && List.for_all (fun w -> vanishes w.of_phase) patch
  && match List.length (List.hd patch).parts with
  | 0 -> true
  | 1 -> List.for_all (fun w -> not (less (List.hd w.parts) (whole 0))) patch
  | 3 -> List.for_all Fun.id (List.concat (List.mapi (fun i w ->
      List.mapi (fun m g -> i = m || vanishes g) w.parts) patch))
  | _ -> false

(* What the file claims, in lines: in a, b and c as converse-check says it, or else in the parameters
   t1, t2, t3 from -1 to 1. *)
let claimed claim =
  let { m00; m01; m10; m11; centre0; half0; centre1; half1 } = claim.of_region in
  let patch = claim.of_patch in
  let boxed = is_boxed patch and parameters = List.length (List.hd patch).parts in
  let frame = List.map small_of [m00; m01; m10; m11] in
  let on_range name centre half = range_text name (qminus centre half) (qplus centre half) in
  let any = if boxed || parameters > 0 then " for any parameters with" else " for" in
  let last_of_graph =
    "(no invariant torus J = P + S'(y) over both angles, P constant, S periodic and C1)" in
  let potential =
    if boxed then
      ["V(y) = -a sin y0 - b sin y1 - c sin(y0 + y1),";
       "that is, J0' = J0 + a cos y0 + c cos(y0 + y1),"; "J1' = J1 + b cos y1 + c cos(y0 + y1),"]
    else ["V(y) = - the sum of A sin(k.y + phase) over the waves below,"] in
  let where =
    if claim.of_whole then [last_of_graph ^ any]
    else
      [last_of_graph;
       "whose orbit goes from y = x* to y' = " ^ frame_text frame ^ " in the region";
       on_range "v0 / pi" centre0 half0; on_range "v1 / pi" centre1 half1;
       "(no other y' was examined, and the region is not the full torus)" ^ any] in
  let sum = List.fold_left (fun x g -> qplus x (absolute g)) (whole 0) in
  let ranges =
    if boxed then
      List.map2 (fun name w -> on_range name w.middle (sum w.parts)) ["a"; "b"; "c"] patch
      @ (if parameters <> 1 then []
         else ["moving together, on the segment from all lower to all upper ends"])
    else
      let names = List.init parameters (fun m -> Printf.sprintf "t%d" (m + 1)) in
      (if names = [] then [] else ["-1 <= " ^ String.concat ", " names ^ " <= 1"])
      @ List.map (fun w ->
          let parts = List.concat (List.map2 (fun name g ->
              if vanishes g then []
              else [(if less g (whole 0) then "- " else "+ ") ^ text_of (absolute g) ^ " " ^ name])
              names w.parts) in
          Printf.sprintf "k = (%d, %d), phase = %s pi, A = %s" (small_of w.of_k0)
            (small_of w.of_k1) (text_of_ratio w.of_phase)
            (String.concat " " (text_of w.middle :: parts))) patch in
  let multiples what = ["and for any multiple s >= 1 of " ^ what ^ " (B > 10/3)"] in
  let larger = match claim.of_once with
    | No -> []
    | Upper_end -> multiples
                     (if boxed then "the upper ends of these ranges"
                      else "these amplitudes at t1 = 1")
    | Whole_patch -> multiples (if boxed then "such parameters" else "such amplitudes") in
  let present = List.filter (fun w -> not (List.for_all vanishes (w.middle :: w.parts))) patch in
  let flat_in k = present <> [] && List.for_all (fun w -> small_of (k w) = 0) present in
  let so k = Printf.sprintf "So the map of y%d alone has no rotational invariant circle." k in
  let alone =
    if not claim.of_whole then []
    else if flat_in (fun w -> w.of_k1) then [so 0]
    else if flat_in (fun w -> w.of_k0) then [so 1]
    else [] in
  ["THEOREM.  The map y' = y + J', J' = J - grad V(y) of two angles y (modulo 2 pi),"]
  @ potential @ ["has no invariant Lagrangian graph"] @ where @ ranges @ larger @ alone

(* The theorem, as far as it was verified; or the result of a spot check. *)
let report file hints checked sampled =
  let proved = total (fun tree -> tree.proved) file and linked = total (fun tree -> tree.linked) file
  and symmetric = total (fun tree -> tree.symmetric) file in
  (if sampled then
     [Printf.sprintf
        "Spot check of %d of %d proved leaves, NOT a verification: none of them fails."
        checked proved; "What is claimed and NOT verified :"]
   else if file.claim.of_whole then ["Verified :"]
   else ["Verified, for a part of the torus only :"])
  @ claimed file.claim
  @ [""; "Checker : " ^ program ^ " " ^ Version.number;
     "Method : Loewner criterion" ^ (if linked > 0 then ", links between starting points" else "")
     ^ ", proved in Coq; intervals of doubles"]
  @ List.map (fun { name; its; _ } ->
      let x, y = its.of_xstar in
      Printf.sprintf "x*%s : %s %s" (if name = "" then "" else " of " ^ name) (text_of x) (text_of y))
    file.trees
  @ ["B : " ^ text_of hints.bound]
  @ (match file.claim.of_alone with
      | Both -> []
      | First -> ["Alone : y0, since no wave depends on both angles"]
      | Second -> ["Alone : y1, since no wave depends on both angles"])
  @ [Printf.sprintf "Leaves : %d, of which %d proved%s and %d symmetric"
       (proved + symmetric + linked) proved
       (if linked > 0 then Printf.sprintf ", %d linked to other parts" linked else "") symmetric;
     Printf.sprintf "Proved leaves checked : %d" checked;
     "SHA-256 : " ^ file.sha256]

(* ---- the command *)

let help = {|usage: converse-verified [--jobs N] [--sample K] FILE

Verifies the theorem of a proof file by a checker that is proved in Coq (docs/explanation/trust.md).

  --jobs N     processes (default: one for each core)
  --sample K   only a spot check, of K leaves chosen by chance; not a verification
  --help, --version

exit status:
  0    verified
  1    rejected: the file is wrong (altered, unfinished, with undecided or missing parts)
  2    bad usage, or a file that cannot be read
  3    verified, but for successors in a part of the torus only
  4    a spot check in which nothing failed: NOT a verification
  5    not confirmed: the claim is false or its proof beyond the checker's limits
  130  interrupted (129, 143: by SIGHUP, SIGTERM)
  141  the reader of the output has closed the pipe, as head does
|}

let cores () =
  let processes = Unix.open_process_in "getconf _NPROCESSORS_ONLN" in
  let count = try int_of_string (input_line processes) with End_of_file | Failure _ -> 1 in
  ignore (Unix.close_process_in processes);
  max 1 count

type options = { path : string option; jobs : int option; sample : int option }

let rec parsed options = function
  | [] -> options
  | "--help" :: _ -> print_string help; exit 0
  | "--version" :: _ -> print_endline (program ^ " " ^ Version.number); exit 0
  | ("--jobs" | "--sample" as name) :: rest ->
    let count = match rest with
      | word :: _ when all_digits word && String.length word <= 9 -> int_of_string ("0u" ^ word)
      | _ -> 0 in
    if count = 0 then refuse "%s wants a whole number above 0; see %s --help" name program;
    let options = if name = "--jobs" then { options with jobs = Some count }
      else { options with sample = Some count } in
    parsed options (List.tl rest)
  | word :: _ when String.length word > 1 && word.[0] = '-' ->
    refuse "there is no such option; see %s --help" program
  | word :: rest when options.path = None -> parsed { options with path = Some word } rest
  | _ -> refuse "one file at a time; see %s --help" program

(* The tree that has a leaf P of this number, and its number there. *)
let rec located n = function
  | { proved; _ } :: (_ :: _ as later) when n >= proved -> located (n - proved) later
  | tree :: _ -> tree, n
  | [] -> invalid_arg "no leaf has this number"

(* Which leaves of so many, and how many they are. *)
let choice total = function
  | Some count when count < total ->
    Random.self_init ();
    let found = Hashtbl.create count in
    while Hashtbl.length found < count do
      Hashtbl.replace found (Random.full_int total) ()
    done;
    Hashtbl.mem found, count
  | _ -> (fun _ -> true), total

(* Where a linked leaf may lead out of the region that it is linked to; Coq has refused it.  It is named by
   its number among the leaves that are linked to the same part. *)
let rec blame_links hints = function
  | [] -> ()
  | { name; its; tree; _ } :: later ->
    let leads = linked_ok its hints (List.map (fun tree -> tree.its) later) and seen = ref [] in
    let visit f =
      seen := [];
      ignore (all_links (fun k cell -> seen := k :: !seen; f k cell) (root (axes its)) tree) in
    visit (fun _ _ -> true);
    let all = !seen and count k found = List.length (List.filter ((=) k) found) in
    visit (fun k cell ->
        leads k cell || beyond "%slinked leaf %d of %d is linked to %s, but may lead out of its region"
          (if name = "" then "" else name ^ ": ") (count k !seen) (count k all)
          (List.nth later (number_of k)).name);
    blame_links hints later

(* Is it so large that no double is?  For a sum Coq multiplies denominators, and reduces nothing. *)
let overflows x =
  let is_large = function
    | Zpos p -> snd (scaled p) > 1023
    | _ -> false in
  is_large (absolute x).qnum || is_large (Zpos x.qden)

(* Tells what is false from what is beyond the checker, where Coq has refused the header. *)
let blame hints { claim; trees; _ } =
  let patch = claim.of_patch in
  if not (alone_ok claim.of_alone patch) then reject "no coordinate is alone: a wave feels both";
  List.iter (fun { name; its; tree; _ } ->
      if not (mirrored (axes its) (orders_of (plain_problem its) (parameters patch)) tree) then
        reject "%sa skipped leaf has no mirror image that is proved"
          (if name = "" then "" else name ^ ": ")) trees;
  blame_links hints trees;
  let larger =
    if claim.of_once = No then "" else ", or that larger parameters are excluded at once" in
  let sum w = List.fold_left (fun x g -> qplus x (absolute g)) (absolute w.middle) w.parts in
  List.iteri (fun i w ->
      if List.mem w (felt claim.of_alone patch) && overflows (sum w) then
        beyond "the header's wave %d: the amplitude and its parts have too many digits: the fraction \
                that is their sum has a numerator or denominator above 1.8e308, the checker's limit"
          (i + 1)) patch;
  beyond "the bound B%s" larger

let verify options path =
  let file = read path in
  (* Almost all that a leaf makes is dead at once and never reaches the major heap, which is the tree's:
     to go through that again and again, each time a little has been added, is a tenth of the work. *)
  Gc.set { (Gc.get ()) with Gc.space_overhead = 300 };
  let hints = hints_of file in
  if not (header_ok file.claim hints (List.hd file.trees).tree file.further) then blame hints file;
  let chosen, total = choice (total (fun tree -> tree.proved) file) options.sample in
  let shown = ref 0 in
  let progress count =
    if Unix.isatty Unix.stderr && (100 * count / total > !shown || count = total) then begin
      shown := 100 * count / total;
      Printf.eprintf "\r%s\r%!" (if count = total then String.make 40 ' '
                                else Printf.sprintf "%d of %d leaves" count total)
    end in
  let jobs = min total (Option.value options.jobs ~default:(cores ())) in
  (match share file hints chosen jobs progress with
   | count, "" when count = total -> ()
   | _, "" -> refuse "a process ended before its share was done (out of memory?)"
   | _, number ->
     let { name; proved; _ }, n = located (int_of_string number) file.trees in
     beyond "%sproved leaf %d of %d is not excluded; the claim is false or its proof beyond the \
             limits of this checker" (if name = "" then "" else name ^ ": ") (1 + n) proved);
  let said = String.concat "\n" (report file hints total (options.sample <> None)) in
  ignore_signals ();                            (* the last word is to be the only one *)
  Sys.set_signal Sys.sigpipe Sys.Signal_default;        (* its reader may have enough, as head *)
  print_endline said;
  if options.sample <> None then spot_check
  else if file.claim.of_whole then verified else part

(* Every failure is one line. *)
let () =
  let options = ref { path = None; jobs = None; sample = None } in
  let complain text =
    let name = Option.fold ~none:"" ~some:(fun path -> String.escaped path ^ ": ") !options.path in
    prerr_endline (program ^ ": " ^ name ^ text) in
  let status =
    try
      List.iter (fun (signal, number) ->
          if Sys.signal signal (Sys.Signal_handle (fun _ -> interrupt number)) = Sys.Signal_ignore
          then Sys.set_signal signal Sys.Signal_ignore) signals;
      Sys.set_signal Sys.sigpipe Sys.Signal_ignore;
      options := parsed !options (List.tl (Array.to_list Sys.argv));
      match !options.path with
      | Some path -> verify !options path
      | None -> refuse "which file? see %s --help" program
    with
    | Failed (status, why) -> complain why; status
    | Interrupted number -> complain "interrupted; nothing was verified"; interrupted + number
    | Sys_error why -> complain ("the output cannot be written (" ^ why ^ ")"); unusable
    | Unix.Unix_error (error, _, _) ->
      complain ("the checker failed: " ^ Unix.error_message error); unusable
    | Stack_overflow | Out_of_memory -> complain "the checker failed: no more memory"; unusable in
  Stdlib.exit status
