"""The figure of the prisms of a proof, as in the thesis: in PostScript, or by matplotlib.

The PostScript program contains the tree, a byte for each node, and walks it once for each kind of
prism: where parameters were cut several prisms share a place, and what is not proved must lie on
top.
"""

import os

from ..model.exact import short_text
from ..prover import tree
from ..prover.report import verdict
from ..storage import files
from . import captions, notebook, plot

SIDE = 400                              # of the square, in points
LEFT_MARGIN, RIGHT_MARGIN = 44, 24      # beside it
PAGE_WIDTH = LEFT_MARGIN + SIDE + RIGHT_MARGIN
LEADING, SMALL_LEADING = 13, 10         # from one line of text to the next
STRING_LENGTH = 60000                   # nodes of the tree in a string; PostScript allows 65535

ALL_FORMATS = *plot.FORMATS, "ps", "eps"         # as the name of a file says

MARKS = {"P": "dark", "S": "light", captions.LINKED: "ringed", "?": "white", "U": "crossed"}

PROLOG = """\
/outline {              % x y w h gray: inside the rectangle, if there is room
  setgray /h exch def /w exch def /y exch def /x exch def
  /r w h lt { w } { h } ifelse def
  r 1 gt {
    /e r 0.05 mul dup 0.25 gt { pop 0.25 } if def
    e setlinewidth
    x e 2 div add y e 2 div add w e sub h e sub rectstroke
  } if
} bind def
/box {                  % x y w h outline fill
  setgray 5 1 roll 4 copy rectfill 5 -1 roll outline
} bind def
/widen { dup least lt { dup least sub 2 div 3 -1 roll add exch pop least } if } bind def
/seen {                 % x y w h: the rectangle, made large enough to be seen
  /h exch def /w exch def /y exch def /x exch def
  x w widen /w exch def /x exch def   y h widen /h exch def /y exch def
  x y w h
} bind def
/cross {                % x y w h
  4 copy 1 setgray rectfill
  1 0 0 setrgbcolor 0.4 setlinewidth
  /h exch def /w exch def /y exch def /x exch def
  x y w h rectstroke
  x y moveto w h rlineto x y h add moveto w h neg rlineto stroke
} bind def
/ring {                 % x y w h
  4 copy 1 setgray rectfill
  0 0.45 0.7 setrgbcolor 0.8 setlinewidth rectstroke
} bind def
/drop { pop pop pop pop } bind def
/nodes 12 dict def      % what to do with the prism x y w h on the stack
nodes begin
  (0) 0 get { /h exch def /w exch def /y exch def /x exch def
    x w 2 div add y w 2 div h   x y w 2 div h } bind def
  (1) 0 get { /h exch def /w exch def /y exch def /x exch def
    x y h 2 div add w h 2 div   x y w h 2 div } bind def
  (234) { { 4 copy } bind def } forall          % a cut of a parameter: two in one place
  (PSU?a) { { drop } bind def } forall
end
/each {                 % (kind) procedure: for each prism x y w h of that kind
  nodes begin 1 index 0 get exch def end
  0 0 side side tree {
    { nodes exch 2 copy known { get exec } { pop pop } ifelse } forall
  } forall
  0 get nodes exch { drop } put
} bind def
/star {                 % x y: the starting point
  gsave translate newpath 0 0 3 0 360 arc gsave 1 setgray fill grestore
  0 setgray 1 setlinewidth stroke 0 0 0.8 0 360 arc fill grestore
} bind def
/text /Helvetica findfont 10 scalefont def
/small /Helvetica findfont 7 scalefont def
/greek /Symbol findfont 10 scalefont def
/fit { 2 copy gt { exch div dup scale } { pop pop } ifelse } bind def   % width room
/width { text setfont stringwidth pop greek setfont exch stringwidth pop add } bind def
/angle {                % (pi) (number) x y room shift: a multiple of pi, from shift times its width
  /shift exch def /room exch def
  gsave translate
  2 copy width dup room fit shift mul 0 moveto
  text setfont show greek setfont show grestore
} bind def
/axis { moveto text setfont (v) show small setfont 0 -2 rmoveto show } bind def
/line {                 % (words) x y room: centred
  /room exch def
  gsave translate
  dup stringwidth pop dup room fit -2 div 0 moveto show grestore
} bind def
"""


def figure(proof, target, format=None, caption=True):
    """Draws a proof, finished or not, in a file.  The target is a path or a binary file; the format
    svg, png, pdf or ps, by default as the file's name ends, else PostScript.  caption: whether the
    lines above say what is proved and by what."""
    kind = format_of(target) if format is None else format
    if kind != "ps" and kind not in plot.FORMATS:
        raise ValueError("the format is one of %s, ps, not %r" % (", ".join(plot.FORMATS), kind))
    data = postscript(proof, caption).encode("ascii", "replace") if kind == "ps" \
        else plot.figure_bytes(proof, kind, caption)
    if hasattr(target, "write"):
        target.write(data)
    else:
        files.write(target, data)
    return None


def format_of(target):
    """The format that the name of a file asks for."""
    name = getattr(target, "name", "") if hasattr(target, "write") else os.fspath(target)
    ending = os.path.splitext(name)[1][1:].lower() if isinstance(name, str) else ""
    return ending if ending in plot.FORMATS else "ps"


def svg(proof):
    """The figure as the text of an SVG file; None without matplotlib."""
    try:
        return plot.figure_bytes(proof, "svg").decode("utf-8")
    except files.ConverseError:
        return None


def html(proof):
    """The verdict and, where there is matplotlib, the figure."""
    return notebook.html(verdict(proof), lambda: plot.figure_bytes(proof, "svg"), "svg",
                         "the prisms")


def postscript(proof, caption=True):
    counts = captions.counts(proof)
    nodes = captions.nodes(proof)
    nodes += tree.UNTRIED * (counts.get("?", 0) - nodes.count(tree.UNTRIED))
    key = ["%s: %s (%d)" % (MARKS[kind], captions.KIND_NAMES[kind], count)
           for kind, count in counts.items()]
    star = captions.star(proof)
    if star:
        key.append("circle: " + captions.STAR)
    head, foot = (captions.head(proof), captions.foot(proof)) if caption else ([], [])
    below = 40 + SMALL_LEADING * len(foot)
    top = SIDE + 16 + SMALL_LEADING + LEADING * len(head)

    lines = [
        "%!PS-Adobe-3.0 EPSF-3.0",
        "%%%%BoundingBox: 0 0 %d %d" % (PAGE_WIDTH, below + top),
        "%%Title: Prisms of a converse KAM proof",
        "%%Creator: converse " + _escape(proof.version),
        "%%LanguageLevel: 2",
        "%%DocumentNeededResources: font Helvetica Symbol",
        "%%Pages: 1",
        "%%EndComments",
        "%%BeginProlog",
        "/side %d def" % SIDE,
        "/least %g def" % (SIDE * captions.LEAST),
        PROLOG + "%%EndProlog",
        "%%Page: 1 1",
        "/tree [                 % line ends in it say nothing",
    ]
    for start in range(0, len(nodes), STRING_LENGTH):
        part = nodes[start:start + STRING_LENGTH]
        lines += ["("] + [part[i:i + 78] for i in range(0, len(part), 78)] + [")"]
    lines += ["] def", "gsave %d %d translate" % (LEFT_MARGIN, below)]
    lines += ["(%s) { %s } each" % (kind, paint) for kind, paint in (
        ("S", "0.65 0.85 box"), ("P", "0.35 setgray rectfill"), ("P", "0 outline"),
        (captions.LINKED, "seen ring"), ("?", "seen 0.65 1 box"),
        ("U", "seen cross")) if kind in counts]
    lines += ["0 setgray 0.6 setlinewidth 0 0 side side rectstroke"]
    if star:
        lines += ["%g %g star" % tuple(SIDE * part for part in star)]
    lines += ["0 setgray 0.6 setlinewidth"]
    for axis in range(2):
        for place in range(3) if proof.problem.half[axis - 2] else (1,):
            lines += _tick(proof.problem, axis, place)
    lines += ["(0) %d -28 axis" % (SIDE // 2 - 4),
              "(1) %d %d axis" % (4 - LEFT_MARGIN, SIDE // 2 + 16)]
    lines += _text("small", SIDE + 10, SMALL_LEADING, ["   ".join(key)])
    lines += _text("text", SIDE + 10 + SMALL_LEADING + 4, LEADING, head)
    lines += _text("small", 4 - below, SMALL_LEADING, foot)
    lines += ["grestore", "showpage", "%%Trailer", "%%EOF"]
    return "\n".join(lines) + "\n"


def _tick(problem, axis, place):
    """The tick at the lower end (place 0), in the middle (1) or at the upper end (2)."""
    at = place * SIDE // 2
    half = problem.half[axis - 2]
    value = problem.centre[axis - 2] + (place - 1) * half
    words = {0: "0", 1: "", -1: "-"}.get(value) if value in (0, 1, -1) \
        else short_text(value, half / 100)
    text = "(%s) (%s)" % ("p" if value else "", words)
    if axis == 0:
        x, shift = at, -0.5
        if len(words) > 7:              # from one end of the page to the other
            x, shift = ((4 - LEFT_MARGIN, 0), (at, -0.5), (SIDE + RIGHT_MARGIN - 4, -1))[place]
        return ["%d 0 moveto 0 -5 rlineto stroke" % at,
                "%s %d -16 %d %g angle" % (text, x, PAGE_WIDTH // 3 - 8, shift)]
    return ["0 %d moveto -5 0 rlineto stroke" % at,
            "%s -8 %d %d -1 angle" % (text, at - 3, LEFT_MARGIN - 12)]


def _text(font, y, step, words):
    """Lines of text in the middle of the page, the lowest at y."""
    return [font + " setfont"] + [
        "(%s) %g %g %d line" % (_escape(line), PAGE_WIDTH / 2 - LEFT_MARGIN, y - step * k,
                                PAGE_WIDTH - 10)
        for k, line in enumerate(words, 1 - len(words))]


def _escape(text):
    """For a string of PostScript."""
    return "".join("\\" + char if char in "()\\" else char for char in text)
