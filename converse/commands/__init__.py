"""The commands converse, converse-map, converse-orbits, converse-portrait and converse-tori;
converse-check is converse.check."""

import signal


def _command(name):
    """The entry point of a command.  Until the command sets its handlers, Ctrl-C ends the process
    without a traceback: so little is imported before."""
    def start():
        if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
            signal.signal(signal.SIGINT, signal.SIG_DFL)
        from importlib import import_module
        return import_module("." + name, __name__).main()
    return start


start_prove, start_map, start_orbits, start_portrait, start_tori = map(
    _command, ("prove", "map", "orbits", "portrait", "tori"))
