"""The figure of a system of prisms, as in the thesis, written as a PostScript program.

The program carries the tree itself, a byte for each node, and draws it by walking it.
"""

import math
import os

from . import files, picture, tree

SIDE = 400                              # of the square, in points
LEFT, BELOW, RIGHT, ABOVE = 44, 56, 10, 42
WIDTH, HEIGHT = LEFT + SIDE + RIGHT, BELOW + SIDE + ABOVE

PROLOG = """\
/box {                  % x y w h outline fill: a rectangle with its outline inside
  setgray /edge exch def 4 copy rectfill
  /h exch def /w exch def /y exch def /x exch def
  /r w h lt { w } { h } ifelse def
  r 1 gt {
    /e r 0.05 mul dup 0.25 gt { pop 0.25 } if def
    edge setgray e setlinewidth
    x e 2 div add y e 2 div add w e sub h e sub rectstroke
  } if
} bind def
/kinds 12 dict def       % what to do with the prism x y w h on the stack
kinds begin
  (0) 0 get { /h exch def /w exch def /y exch def /x exch def
    x w 2 div add y w 2 div h   x y w 2 div h } bind def
  (1) 0 get { /h exch def /w exch def /y exch def /x exch def
    x y h 2 div add w h 2 div   x y w h 2 div } bind def
  (234) { { 4 copy } bind def } forall          % a cut of a parameter shows both halves
  (P) 0 get { 0 0.35 box } bind def
  (S) 0 get { 0.65 0.85 box } bind def
  (U) 0 get { 0.65 1 box } bind def
  (?) 0 get { 0.65 1 box } bind def
end
/walk {                 % the tree follows in the file, up to a full stop
  { currentfile read not { exit } if
    dup (.) 0 get eq { pop exit } if
    kinds exch 2 copy known { get exec } { pop pop } ifelse
  } loop
} bind def
/widen { dup 3 lt { dup 3 sub 2 div 3 -1 roll add exch pop 3 } if } bind def
/mark {                 % x y w h: an undecided prism, large enough to be seen
  1 0 0 setrgbcolor 0.4 setlinewidth
  /h exch def /w exch def /y exch def /x exch def
  x w widen /w exch def /x exch def   y h widen /h exch def /y exch def
  x y w h rectstroke
  x y moveto w h rlineto x y h add moveto w h neg rlineto stroke
} bind def
/star {                 % x y: the starting point
  gsave translate newpath 0 0 3 0 360 arc gsave 1 setgray fill grestore
  0 setgray 1 setlinewidth stroke 0 0 0.8 0 360 arc fill grestore
} bind def
/text /Helvetica findfont 10 scalefont def
/small /Helvetica findfont 7 scalefont def
/greek /Symbol findfont 10 scalefont def
/width { text setfont stringwidth pop greek setfont exch stringwidth pop add } bind def
/angle {                % (pi) (number) x y shift: a multiple of pi; shift -1 left of x, -0.5 centred
  /shift exch def moveto 2 copy width shift mul 0 rmoveto
  text setfont show greek setfont show
} bind def
/axis { moveto text setfont (v) show small setfont 0 -2 rmoveto show } bind def
/centred { moveto dup stringwidth pop -2 div 0 rmoveto show } bind def
"""


def figure(proof, path):
    """Writes the figure of a proof, finished or not: SVG, PNG or PDF by the file's name, else
    PostScript."""
    if os.fspath(path).endswith(picture.FORMATS):
        picture.picture(proof, path)
    else:
        files.write(path, postscript(proof).encode("ascii"))


def postscript(proof):
    problem = proof.problem
    cuts, proved, symmetric, undecided = (
        sum(map(proof.tree.count, kinds)) for kinds in (tree.CUTS, "P", "S", "U"))
    untried = 1 + cuts - proved - symmetric - undecided
    nodes = proof.tree + tree.UNTRIED * (untried - proof.tree.count(tree.UNTRIED)) + "."
    lines = [
        "%!PS-Adobe-3.0 EPSF-3.0",
        "%%%%BoundingBox: 0 0 %d %d" % (WIDTH, HEIGHT),
        "%%Title: Prisms of a converse KAM proof",
        "%%Creator: converse " + proof.version,
        "%%LanguageLevel: 2",
        "%%DocumentNeededResources: font Helvetica Symbol",
        "%%Pages: 1",
        "%%EndComments",
        "%%BeginProlog",
        PROLOG + "%%EndProlog",
        "%%Page: 1 1",
        "gsave %d %d translate" % (LEFT, BELOW),
        "0 0 %d %d walk" % (SIDE, SIDE),
    ]
    lines += [nodes[i:i + 78] for i in range(0, len(nodes), 78)]
    lines += ["%g %g %g %g mark" % _rectangle(cell)
              for kind, cell in tree.Walk().feed(proof.tree) if kind == "U"]
    lines += ["0 setgray 0.6 setlinewidth 0 0 %d %d rectstroke" % (SIDE, SIDE)]
    lines += _star(proof)
    lines += ["0 setgray 0.6 setlinewidth"]
    for axis in range(2):
        for place in range(3):
            lines += _tick(problem, axis, place)
    lines += [
        "(0) %d -30 axis" % (SIDE // 2 - 4),
        "(1) -40 %d axis" % (SIDE // 2 + 16),
        "text setfont",
        "(%s) %d %d centred" % (_title(proof), SIDE // 2, SIDE + 30),
        "small setfont",
        "(%s) %d %d centred" % (
            "dark: proved (%d)   light: skipped by symmetry (%d)   white: untried (%d)   "
            "crossed: undecided (%d)" % (proved, symmetric, untried, undecided),
            SIDE // 2, SIDE + 14),
        "(%s) %d -50 centred" % (_subtitle(proof), SIDE // 2),
        "grestore",
        "showpage",
        "%%Trailer",
        "%%EOF",
    ]
    return "\n".join(lines) + "\n"


def _rectangle(cell):
    (i, j, *_), (k, l, *_) = cell
    w, h = SIDE / 2 ** k, SIDE / 2 ** l
    return i * w, j * h, w, h


def _tick(problem, axis, place):
    """The tick at the lower end (place 0), in the middle (1) or at the upper end (2)."""
    at = place * SIDE // 2
    value = problem.centre[3 + axis] + (place - 1) * problem.half[3 + axis]
    number = {0: "0", 1: "", -1: "-"}.get(value, "%.6g" % value)
    text = "(%s) (%s)" % ("p" if value else "", number)
    if axis == 0:
        return ["%d 0 moveto 0 -5 rlineto stroke" % at, "%s %d -16 -0.5 angle" % (text, at)]
    return ["0 %d moveto -5 0 rlineto stroke" % at, "%s -8 %d -1 angle" % (text, at - 3)]


def _star(proof):
    """The starting point, where the region shows it."""
    places = []
    for axis, text in enumerate(proof.xstar):
        centre, half = (float(x[3 + axis]) for x in (proof.problem.centre, proof.problem.half))
        offset = math.remainder(float(text) / math.pi - centre, 2)
        if half == 0 or abs(offset) > half:
            return []
        places.append((offset / half + 1) * SIDE / 2)
    return ["%g %g star" % tuple(places)]


def _title(proof):
    return ",   ".join(
        "%.9g < %s < %.9g" % (centre - half, name, centre + half) if half else
        "%s = %.9g" % (name, centre) for name, centre, half in zip(
            "abc", proof.problem.centre, proof.problem.half))


def _subtitle(proof):
    words = "converse %s, %s" % (proof.version, proof.arithmetic)
    if proof.as_printed:
        words += "; as printed in the thesis: a historical reconstruction, not a proof"
    return words
