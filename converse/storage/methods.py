"""Methods of results whose work is done in a room above: converse/results.py says where.

A value declares such a method with its docstring, and imports nothing for it."""

# By method, "Class.method", the function that does the work.
HOMES: "dict[str, str]" = {}


def provided(method):
    """The function that does the work of a method."""
    import importlib  # late, as all that delays the handlers of signals
    module, _, function = HOMES[method].rpartition(".")
    return getattr(importlib.import_module("converse." + module), function)


def absent(needs, extra, error):
    """__getattr__ of a package whose modules cannot be imported, for the reason `error`: whoever
    uses a name of it is told, in a line, what the package needs."""
    def look_up(name):
        from .files import ConverseError  # late, as above
        if name.startswith("__"):
            raise AttributeError(name)
        raise error if isinstance(error, ConverseError) else ConverseError(
            "%s (%s); pip install 'converse-kam[%s]'" % (needs, error, extra))
    return look_up
