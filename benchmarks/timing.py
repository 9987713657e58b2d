"""Timing: CPU seconds of this process, medians of repetitions that take turns."""

import contextlib
import os
import statistics
import time


def cpu(job, least=0.0):
    """CPU seconds of one call of job, averaged over as many calls as fill `least` seconds."""
    calls, start = 0, time.process_time()
    while True:
        job()
        calls += 1
        spent = time.process_time() - start
        if spent >= least:
            return spent / calls


def interleaved(jobs, repetitions=7, least=0.02, most=3.0):
    """Median CPU seconds of each job, name -> seconds.

    The jobs take turns, so that a machine that slows down slows all of them alike.  One that has
    used more than `most` seconds takes no further turn.
    """
    found = {name: [] for name in jobs}
    for _ in range(repetitions):
        for name, job in jobs.items():
            if sum(found[name]) < most:
                found[name].append(cpu(job, least))
    return {name: statistics.median(values) for name, values in found.items()}


def wall(job):
    """Seconds on the clock of one call of job."""
    start = time.perf_counter()
    job()
    return time.perf_counter() - start


@contextlib.contextmanager
def one_core():
    """Keep this process on one core, where the system can: the engine then takes one thread."""
    if not hasattr(os, "sched_setaffinity"):
        yield  # CPU seconds then add up those of all threads
        return
    before = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {max(before)})
    try:
        yield
    finally:
        os.sched_setaffinity(0, before)
