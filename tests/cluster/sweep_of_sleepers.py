"""A sweep whose points take 10 ms each and leave a trace: what the cluster's tests kill.

    python sweep_of_sleepers.py FOLDER ADDRESS

Every worker appends the numbers of its points to the file MEASURED of its environment.
"""

import os
import signal
import sys
import time
from pathlib import Path

from bcre_studies.sweeps.sweep import Sweep, run

POINTS = 300
MODULE = "bcre_studies.sweeps.points"


def sleep(case):
    """The square of a number, after a while; the poison kills the worker."""
    if case["poison"]:
        os.kill(os.getpid(), signal.SIGKILL)
    with Path(os.environ["MEASURED"]).open("a") as trace:
        trace.write(f"{case['number']}\n")
    time.sleep(0.01)
    return {"square": case["number"] ** 2}


def sweep_of(poison=None):
    """The sweep; the point ``poison`` kills the worker that measures it."""
    points = [{"number": number, "poison": number == poison} for number in range(POINTS)]
    columns = {"number": int, "poison": bool, "square": int}
    return Sweep("sleepers", sleep, points, columns, {"poison": poison}, MODULE)


if __name__ == "__main__":
    import sweep_of_sleepers  # under its own name, so that workers can import what it sends them

    folder, address = sys.argv[1:]
    run(sweep_of_sleepers.sweep_of(), Path(folder), address, print)
