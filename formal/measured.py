"""Runs coqc, or another command on a file, and says what time and memory it took:
python measured.py OUTPUT COMMAND ... FILE.  OUTPUT has what the command says, too."""

import resource
import subprocess
import sys

output, *command = sys.argv[1:]
with open(output, "wb") as file:
    status = subprocess.call(command, stdout=file)
used = resource.getrusage(resource.RUSAGE_CHILDREN)
with open(output, "a") as file:
    print("%s: %.1f s, %d MB\n" % (command[-1], used.ru_utime + used.ru_stime,
                                   used.ru_maxrss / 1024), file=file)
sys.exit(status if status >= 0 else 1)
