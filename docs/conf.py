"""The site of docs/, by Sphinx: make docs."""

import inspect

from converse.version import __version__

project = "converse"
release = version = __version__
myst_fence_as_directive = ["math"]
extensions = ["myst_nb", "sphinx.ext.autodoc", "numpydoc"]
html_theme = "alabaster"
html_theme_options = {"description": "Proofs about invariant tori of symplectic maps",
                      "page_width": "70em", "sidebar_width": "17em"}
html_copy_source = False
smartquotes = False                     # V'' has two primes, not a quotation mark

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
    """Shows a docstring as it stands, unless it has numpydoc's sections, where bars are bars."""
    text = inspect.cleandoc(obj.__doc__ or "")
    if "\n---" in text:
        lines[:] = [line.replace("|", "\\|") for line in lines]
    elif text:
        lines[:] = ["::", "", *("    " + line for line in text.splitlines()), ""]


def skips(app, what, name, obj, skip, options):
    """Leaves out the fields of named tuples, which the docstrings of their classes list."""
    return skip or (getattr(obj, "__doc__", None) or "").startswith("Alias for field number")


def setup(app):
    app.connect("autodoc-skip-member", skips)
    app.connect("autodoc-process-docstring", readable, priority=600)    # after numpydoc
