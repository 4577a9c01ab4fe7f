"""The checker's names, whichever of its modules they live in.

What a test puts in place of one of them is put into every module that uses it."""

import importlib
import pkgutil

from converse import check as package

MODULES = [package] + [importlib.import_module(package.__name__ + "." + name)
                       for _, name, _ in pkgutil.iter_modules(package.__path__)
                       if name not in ("__main__", "ship")]


class _Names:
    __slots__ = ()

    def __getattr__(self, name):
        for module in MODULES[1:]:
            if name in vars(module):
                return vars(module)[name]
        raise AttributeError("no module of the checker has the name %r" % name)

    def __setattr__(self, name, value):
        getattr(self, name)
        for module in MODULES:
            if name in vars(module):
                setattr(module, name, value)


check = _Names()


def start_of_workers(code):
    """What the checker's processes run, where they run this code first."""
    return check.START.replace("; work()", "; exec(%r); work()" % code)
