"""A pytest plugin for tools/mutants.py, set by the environment: WATCH_LOG, a file for lines of what
started and how it ended; WATCH_SECONDS of processor time after which no other test starts;
WATCH_PATIENCE, the processor time after which a test counts as hung and the process ends, as it
does after ten times as long on a clock.
"""

import faulthandler
import math
import os
import resource
import sys
import time
from pathlib import Path


def spent():
    """Processor time so far, that of child processes too [s]."""
    return sum(os.times()[:4])


def log(*words):
    with Path(os.environ["WATCH_LOG"]).open("a") as file:
        file.write("\t".join(words) + "\n")


def watch():
    patience = float(os.environ["WATCH_PATIENCE"])
    limit = math.ceil(time.process_time() + patience)
    resource.setrlimit(resource.RLIMIT_CPU, (limit, resource.RLIM_INFINITY))
    faulthandler.dump_traceback_later(10.0 * patience, exit=True, file=sys.__stderr__)


def pytest_configure():
    watch()


def pytest_runtest_protocol(item):
    if spent() > float(os.environ["WATCH_SECONDS"]):
        return True  # as if it had run
    log("started", item.nodeid)
    watch()
    return None


def pytest_runtest_logreport(report):
    log(report.outcome, report.nodeid)


def pytest_unconfigure():
    faulthandler.cancel_dump_traceback_later()
