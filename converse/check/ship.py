"""Puts the checker's modules together: a zip file that Python runs, one file to read and mail, and
a shorter one for a referee.

    python -m converse.check.ship DIRECTORY

writes converse-check.pyz, converse_check.py and referee.py there.  Each needs nothing but Python,
and is the same to the byte whenever it is made of the same sources.  The first two take numpy for
speed where there is one, and do what converse-check does; referee.py checks a proof file in
integers alone, and has no more of the modules than that needs.
"""

import ast
import os
import re
import sys
import zipfile

FOLDER = os.path.dirname(os.path.abspath(__file__))
# In the order in which they are read; each needs only those before it.
SHARED = ("version", "limits", "failures", "claim", "tree", "proof_file", "arith", "cover", "torus",
          "exact", "criterion", "links", "words")
ORDER = (*SHARED, "lockstep", "maps", "signals", "state", "progress", "processes", "workers",
         "torus_file", "field", "series", "tori", "run", "command")
REFEREE = (*SHARED, "referee")
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
        self.lines, self.tree = lines, tree

    def without(self, unused):
        """The rest of its text, without the functions, classes and names of the module, and methods
        of its classes, that are unused."""
        lines = list(self.lines)
        methods = [x for node in self.tree.body if isinstance(node, ast.ClassDef)
                   for x in node.body if isinstance(x, ast.FunctionDef)]
        for node in self.tree.body + methods:
            if set(own_names(node)) & unused:
                first = min([node.lineno] + [x.lineno for x in getattr(node, "decorator_list", ())])
                lines[first - 1:node.end_lineno] = [None] * (node.end_lineno - first + 1)
        text = "\n".join(line for line in lines if line is not None).strip("\n")
        return re.sub("\n{3,}", "\n\n", text) if unused else text


def own_names(node):
    """What a statement defines: a function, a class, or the names that it assigns."""
    if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
        return [node.name]
    if isinstance(node, ast.Assign):
        return [x.id for target in node.targets for x in ast.walk(target)
                if isinstance(x, ast.Name)]
    return []


def unused_names(modules, main):
    """The functions, constants and methods of the modules that nothing mentions on the way from
    main, by whatever name."""
    bodies = {}
    for module in modules:
        for node in module.tree.body:
            parts = [node]
            if isinstance(node, ast.ClassDef):
                parts += [x for x in node.body if isinstance(x, ast.FunctionDef)]
            for part in parts:
                inner = [x for x in ast.iter_child_nodes(part)
                         if not (isinstance(part, ast.ClassDef) and x in parts)]
                for name in own_names(part):
                    bodies.setdefault(name, []).extend(inner)
    used, todo = set(), [main]
    todo += [name for name in bodies if name.startswith("__")]
    while todo:
        name = todo.pop()
        if name in bodies and name not in used:
            used.add(name)
            todo += [x.id if isinstance(x, ast.Name) else x.attr
                     for body in bodies[name] for x in ast.walk(body)
                     if isinstance(x, (ast.Name, ast.Attribute))]
    return set(bodies) - used


def one_file(order=ORDER, main="main"):
    """The text of these modules as one, which runs main; of the referee's, what main needs."""
    modules = [Module(name) for name in order]
    for at, module in enumerate(modules):
        if not set(module.needs) <= set(order[:at]):
            raise SystemExit("%s needs a module that comes after it" % module.name)
    names = [name for module in modules for name in module.defines]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise SystemExit("two modules have names of their own: " + ", ".join(twice))
    unused = unused_names(modules, main) if order == REFEREE else set()
    imports = sorted({line for module in modules for line in module.imports},
                     key=lambda line: (line.startswith("from"), line))
    parts = ['#!/usr/bin/env python3\n"""%s\n\nThis one file was put together from the modules of '
             'converse/check; each begins with its name.\n"""\n\n%s\n' % (
                 ast.get_docstring(ast.parse(source("__init__" if order == ORDER else order[-1]))),
                 "\n".join(imports))]
    for module in modules:
        summary = "\n".join(("# " + line).rstrip() for line in module.summary.splitlines())
        parts.append("# ---- %s\n%s\n\n%s\n" % (module.name, summary, module.without(unused)))
    parts.append('if __name__ == "__main__":\n    sys.exit(%s())\n' % main)
    return ("\n" if order == REFEREE else "\n\n").join(parts)


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
    app = os.path.join(directory, "converse-check.pyz")
    zip_app(app)
    for name, text in (("converse_check.py", one_file()),
                       ("referee.py", one_file(REFEREE, "referee_main"))):
        path = os.path.join(directory, name)
        with open(path, "w", encoding="utf-8", newline="\n") as file:
            file.write(text)
        os.chmod(path, 0o755)
    print("%s runs, and beside it converse_check.py can be read and mailed: each is the checker, "
          "alone; referee.py is its exact part." % app)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: python -m converse.check.ship DIRECTORY")
    main(sys.argv[1])
