"""A pytest plugin for tools/mutants.py: which functions each test calls, or which tests to run.

Its settings are in the environment.  WATCH_LOG: a file for lines of what started, passed and
failed.  WATCH_CALLS: a file for lines of a test, a tab and a function that the test, or a child
process of it, calls.  WATCH_LIMITS: a file of the only tests to run, in their order, each with a
limit of time [s] after which the process ends.  WATCH_SOURCES: the folder of the functions.

PYTEST_DONT_REWRITE: Python itself imports this first, by the sitecustomize.py of mutants.py.
"""

import faulthandler
import json
import os
import sys
import threading
from pathlib import Path

LOG, CALLS, LIMITS = (os.environ.get(f"WATCH_{name}") for name in ("LOG", "CALLS", "LIMITS"))
SOURCES = os.environ.get("WATCH_SOURCES", "src") + os.sep
limits = json.loads(Path(LIMITS).read_text()) if LIMITS else {}
seen = set()


def trace():
    """From now on record each function of the sources that is called, once a test."""
    calls = os.open(CALLS, os.O_WRONLY | os.O_APPEND | os.O_CREAT)

    def on_call(frame, event, arg):
        code = frame.f_code
        if id(code) not in seen:
            seen.add(id(code))
            if code.co_filename.startswith(SOURCES):
                test = os.environ.get("PYTEST_CURRENT_TEST", "").rsplit(" (", 1)[0]
                file = code.co_filename.removeprefix(SOURCES)
                os.write(calls, f"{test}\t{file}:{code.co_qualname}\n".encode())

    threading.settrace(on_call)
    sys.settrace(on_call)


def log(*words):
    with Path(LOG).open("a") as file:
        file.write("\t".join(words) + "\n")


def pytest_configure(config):
    if limits:
        config.option.maxfail = 1
        faulthandler.dump_traceback_later(max(limits.values()), exit=True, file=sys.__stderr__)


def pytest_collection_modifyitems(items):
    if limits:
        chosen = {item.nodeid: item for item in items if item.nodeid in limits}
        items[:] = [chosen[test] for test in limits if test in chosen]


def pytest_runtest_logstart(nodeid):
    seen.clear()
    log("started", nodeid)
    if limits:
        faulthandler.dump_traceback_later(limits[nodeid], exit=True, file=sys.__stderr__)


def pytest_runtest_logreport(report):
    log(f"{report.when} {report.outcome}", report.nodeid, str(report.duration))


def pytest_sessionfinish():
    faulthandler.cancel_dump_traceback_later()
