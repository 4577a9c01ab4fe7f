"""Moments that the tests choose themselves, however fast or slow the machine is."""

import time

PATIENCE = 300                      # seconds: a process that takes longer hangs

# The command, that decides so many prisms, makes a file and waits until that is gone, or it is to
# stop.
HELD = """
import sys, time
from pathlib import Path
from converse.commands.prove import main
from converse.prover import native
sign, left, work = Path(sys.argv.pop(1)), int(sys.argv.pop(1)), native.Search.work
def work_or_wait(self, threads, look, *limits):
    if threads == 0 or limits:                  # not the proof itself
        return work(self, threads, look, *limits)
    if not work(self, threads, look, left) or self.view().finished:
        return work(self, threads, look)
    sign.touch()
    try:
        while sign.exists():
            if look():
                return False
            time.sleep(0.005)
    except BaseException:
        time.sleep(0.05)                        # what is to strike now has time for it
        raise
    return work(self, threads, look)
native.Search.work = work_or_wait
sys.exit(main())
"""

# The command, that makes a file when it begins to set up the search.  If it was not stopped in the
# middle of that it says so in the file, and waits to be.
BEGUN = """
import sys, time
from pathlib import Path
from converse.commands.prove import main
from converse.prover import native
sign, work = Path(sys.argv.pop(1)), native.Search.work
def begin_and_wait(self, threads, look):
    sign.touch()
    done = work(self, threads, look)
    if done:
        sign.write_text("whole")
        while not look():
            time.sleep(0.005)
    return done
native.Search.work = begin_and_wait
sys.exit(main())
"""


def wait_until(there, process):
    """Until there() is true, which it must be before the process ends."""
    end = time.monotonic() + PATIENCE
    while not there():
        assert process.poll() is None and time.monotonic() < end
        time.sleep(0.005)
