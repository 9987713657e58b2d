"""A pytest plugin for tools/mutants.py, set by the environment: WATCH_LOG, a file for lines of what
started and how it ended; WATCH_SECONDS of processor time after which no other test starts;
WATCH_PATIENCE, the time after which a test counts as hung and the process ends.
"""

import faulthandler
import os
import sys
from pathlib import Path


def spent():
    """Processor time so far, that of child processes too [s]."""
    return sum(os.times()[:4])


def log(*words):
    with Path(os.environ["WATCH_LOG"]).open("a") as file:
        file.write("\t".join(words) + "\n")


def watch():
    patience = float(os.environ["WATCH_PATIENCE"])
    faulthandler.dump_traceback_later(patience, exit=True, file=sys.__stderr__)


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
