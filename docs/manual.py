"""Writes manual pages and shell completions, from the commands' own parsers.

    python docs/manual.py [DIRECTORY]

DIRECTORY (build/share) is laid out as share/ of an installation.
"""

import re
import sys
from importlib import import_module
from pathlib import Path

import shtab
from argparse_manpage.manpage import Manpage

from converse.version import __version__

SHARE = Path(*sys.argv[1:2] or [Path(__file__).resolve().parent.parent / "build" / "share"])
SHELLS = {"bash": "bash-completion/completions/%s", "zsh": "zsh/site-functions/_%s",
          "fish": "fish/vendor_completions.d/%s.fish"}
SUMMARIES = {
    "commands.prove": "prove that a family of symplectic maps has no invariant tori",
    "check": "verify the theorem of a proof file, independently of its prover",
    "commands.map": "map where in parameter space there are no invariant tori, with proofs",
    "commands.orbits": "find periodic orbits of least action",
    "commands.portrait": "prove where in phase space a map has no invariant circles",
    "commands.tori": "prove that a symplectic map has an invariant torus",
}


def page(parser, summary):
    """The manual page's text, with what argparse-manpage leaves open."""
    text = str(Manpage(parser, {"project_name": "converse", "version": __version__,
                                "manual_title": "converse", "description": summary},
                       format="single-commands-section"))
    text = re.sub(r"\.SH COMMENTS\n(example:.*?)(?=\n\.SH|\Z)",       # as it is written
                  r".SH EXAMPLE AND EXIT STATUS\n.nf\n\1\n.fi", text, flags=re.DOTALL)
    text = text.replace(" - " + summary, " \\- " + summary)         # the form that whatis reads
    return re.sub("^'", r"\\&'", text, flags=re.MULTILINE)          # a quote would begin a request


def with_files(parser):
    """The same parser, whose files and directories can be completed."""
    for action in parser._actions:
        if action.dest == "directory":
            action.complete = shtab.DIRECTORY
        elif action.metavar in ("FILE", "POTENTIAL", "MAP") or not (
                action.metavar or action.option_strings):
            action.complete = shtab.FILE
    return parser


def write(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
    print(path)


for module, summary in SUMMARIES.items():
    parser = with_files(import_module("converse." + module).parser())
    write(SHARE / "man" / "man1" / (parser.prog + ".1"), page(parser, summary))
    for shell, name in SHELLS.items():
        write(SHARE / (name % parser.prog), shtab.complete(parser, shell))
