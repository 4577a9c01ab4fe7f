"""Puts the checker's modules together: a zip file that Python runs, and one file to read and mail.

    python -m converse.check.ship DIRECTORY

writes converse-check.pyz and converse_check.py there.  Either needs nothing but Python (and takes
numpy for speed where there is one), does what converse-check does, and is the same to the byte
whenever it is made of the same sources.
"""

import ast
import os
import sys
import zipfile

FOLDER = os.path.dirname(os.path.abspath(__file__))
# In the order in which they are read; each needs only those before it.
ORDER = ("version", "limits", "failures", "claim", "tree", "proof_file", "arith", "torus", "exact",
         "criterion", "lockstep", "maps", "words", "state", "progress", "signals", "workers", "run",
         "command")
MAIN = '''import sys

from converse_check import main

if __name__ == "__main__":
    sys.exit(main())
'''


def source(name):
    with open(os.path.join(FOLDER, name + ".py"), encoding="utf-8") as file:
        return file.read()


def module_names():
    return sorted(name[:-3] for name in os.listdir(FOLDER) if name.endswith(".py"))


class Module:
    """A module taken apart: its docstring, what it imports, its own names, and the rest of it."""

    def __init__(self, name):
        self.name, text = name, source(name)
        lines, tree = text.splitlines(), ast.parse(text)
        self.summary, self.imports, self.needs, self.defines = ast.get_docstring(tree), [], [], []
        for node in tree.body:
            if isinstance(node, (ast.Import, ast.ImportFrom)):
                if getattr(node, "level", 0):
                    if node.level != 1 or any(alias.asname for alias in node.names):
                        raise SystemExit("%s, line %d: only 'from .module import name' can be put "
                                         "together" % (name, node.lineno))
                    self.needs.append(node.module)
                else:
                    self.imports.append(ast.get_source_segment(text, node))
            elif isinstance(node, (ast.FunctionDef, ast.ClassDef)):
                self.defines.append(node.name)
            elif isinstance(node, ast.Assign):
                self.defines += [x.id for target in node.targets for x in ast.walk(target)
                                 if isinstance(x, ast.Name)]
            elif not (node is tree.body[0] and self.summary):
                raise SystemExit("%s, line %d: a module only imports and defines"
                                 % (name, node.lineno))
            if isinstance(node, (ast.Import, ast.ImportFrom)) or node is tree.body[0]:
                lines[node.lineno - 1:node.end_lineno] = [None] * (
                    node.end_lineno - node.lineno + 1)
        self.rest = "\n".join(line for line in lines if line is not None).strip("\n")


def one_file():
    """The text of all modules as one."""
    modules = [Module(name) for name in ORDER]
    for at, module in enumerate(modules):
        if not set(module.needs) <= set(ORDER[:at]):
            raise SystemExit("%s needs a module that comes after it" % module.name)
    names = [name for module in modules for name in module.defines]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise SystemExit("two modules have names of their own: " + ", ".join(twice))
    imports = sorted({line for module in modules for line in module.imports},
                     key=lambda line: (line.startswith("from"), line))
    parts = ['#!/usr/bin/env python3\n"""%s\n\nThis one file was put together from the modules of '
             'converse/check; each begins with its name.\n"""\n\n%s\n' % (
                 ast.get_docstring(ast.parse(source("__init__"))), "\n".join(imports))]
    for module in modules:
        summary = "\n".join(("# " + line).rstrip() for line in module.summary.splitlines())
        parts.append("# ---- %s\n%s\n\n%s\n" % (module.name, summary, module.rest))
    parts.append('if __name__ == "__main__":\n    sys.exit(main())\n')
    return "\n\n".join(parts)


def zip_app(path):
    """A zip file with the package, under a name of its own, that Python can run."""
    with open(path, "wb") as file:
        file.write(b"#!/usr/bin/env python3\n")
        with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
            for name, text in [("__main__.py", MAIN)] + [
                    ("converse_check/%s.py" % name, source(name)) for name in module_names()]:
                archive.writestr(zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0)), text,
                                 zipfile.ZIP_DEFLATED)
    os.chmod(path, 0o755)


def main(directory):
    os.makedirs(directory, exist_ok=True)
    app, one = (os.path.join(directory, name) for name in ("converse-check.pyz",
                                                           "converse_check.py"))
    zip_app(app)
    with open(one, "w", encoding="utf-8", newline="\n") as file:
        file.write(one_file())
    os.chmod(one, 0o755)
    print("%s runs, and %s can be read and mailed: each is the checker, alone." % (app, one))


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: python -m converse.check.ship DIRECTORY")
    main(sys.argv[1])
