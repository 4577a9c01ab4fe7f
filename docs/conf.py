"""The site of docs/, by Sphinx: make docs."""

from converse.version import __version__

project = "converse"
release = version = __version__
extensions = ["myst_nb", "sphinx.ext.autodoc", "numpydoc"]
html_theme = "alabaster"
html_theme_options = {"description": "Proofs about invariant tori of symplectic maps",
                      "page_width": "70em", "sidebar_width": "17em"}
html_copy_source = False

# Pages are written for GitHub, too: $...$ is mathematics, and sections are linked to by its names.
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4

nb_execution_timeout = 300              # seconds, of a notebook on a busy machine
nb_execution_raise_on_error = True

autodoc_default_options = {"members": True, "show-inheritance": True}
autodoc_member_order = "bysource"
autodoc_typehints = "none"              # numpydoc's sections say what arguments are
numpydoc_show_class_members = False


def readable(app, what, name, obj, options, lines):
    """Shows a docstring as it stands, unless it has numpydoc's sections, whose bars are bars."""
    if any(line.strip().startswith("---") for line in lines):
        lines[:] = [line.replace("|", "\\|") for line in lines]
    elif lines:
        lines[:] = ["::", "", *("    " + line for line in lines), ""]


def setup(app):
    app.connect("autodoc-process-docstring", readable, priority=400)    # before numpydoc's own
