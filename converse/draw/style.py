"""The colours and the style of all pictures, for matplotlib.  The user's settings do not matter."""

# The colours of Okabe and Ito, which the colour-blind can tell apart, and greys.
BLUE, ORANGE, VERMILLION = "#0072b2", "#e69f00", "#d55e00"
GREEN, PURPLE, DARK, GREY = "#009e73", "#cc79a7", "0.1", "0.6"

SALT = {"svg.hashsalt": "converse"}     # The same picture gives the same file.
STYLE = {                               # of all pictures except the prisms of a proof
    **SALT, "font.size": 8, "axes.titlesize": 9, "axes.labelsize": 9, "xtick.labelsize": 8,
    "ytick.labelsize": 8, "legend.fontsize": 8, "legend.title_fontsize": 8,
    "legend.framealpha": 0.85, "legend.edgecolor": "0.8", "lines.linewidth": 1,
    "axes.linewidth": 0.6, "axes.spines.top": False, "axes.spines.right": False,
}
