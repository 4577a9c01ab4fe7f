"""Moments that the tests choose themselves, however fast or slow the machine is."""

import time

PATIENCE = 300                      # seconds: a process that takes longer hangs

# The command, that decides so many prisms, makes a file and waits until that is gone, or it is to
# stop.  Its worker waits, as if it were long at work; there is to be but one.
HELD = """
import sys, time
from pathlib import Path
from converse.commands.prove import main
from converse.prover import native
sign, left, grow = Path(sys.argv.pop(1)), int(sys.argv.pop(1)), native.grow
def grow_or_wait(task, cells, seconds, leaves, want_steps, stop):
    global left
    if left == 0:
        sign.touch()
        while sign.exists() and not stop.is_set():
            time.sleep(0.005)
        if stop.is_set():
            time.sleep(0.05)                    # what is to strike now has time for it
        left = leaves
    grown = grow(task, cells, seconds, min(left, leaves), want_steps, stop)
    if grown is not None:
        left -= sum(map(grown.text.count, "PSU"))
    return grown
native.grow = grow_or_wait
sys.exit(main())
"""

# The command, that makes a file when it begins to set up the search.  If it was not stopped in the
# middle of that it says so in the file, and waits to be.
BEGUN = """
import sys, time
from pathlib import Path
from converse.commands.prove import main
from converse.prover import native
sign, begin = Path(sys.argv.pop(1)), native.begin
def begin_and_wait(task, tree, stop):
    sign.touch()
    begun = begin(task, tree, stop)
    if begun is not None:
        sign.write_text("whole")
        while not stop.is_set():
            time.sleep(0.005)
    return begun
native.begin = begin_and_wait
sys.exit(main())
"""


def wait_until(there, process):
    """Until there() is true, which it must be before the process ends."""
    end = time.monotonic() + PATIENCE
    while not there():
        assert process.poll() is None and time.monotonic() < end
        time.sleep(0.005)
