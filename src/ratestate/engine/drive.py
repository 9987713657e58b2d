"""Driving the march from Python: threads, progress, interruption, the solver's own steps."""

import os
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from . import CACHE
from . import rows as R
from .march import IDLE, march
from .model import NUMBERS, RUNNING, STEP_LIMIT, Results

# Sweeps over the lanes between two looks at the clock: some 20 ms in lanes, 4 ms alone.
BUDGET = 20_000
PATH_ROWS = 8192
MAX_ROWS = 10_000_000  # of a path: 320 MB


def run(method, law, cases, loads, save_times, order, alone, progress=None):
    """March all cases, on as many threads as there are cores and full sets of lanes.

    Parameters
    ----------
    method, law : int, codes
    cases, loads : Cases, Loads (model.py)
    save_times : (rows, n_times) [s]
    order : (n,) case numbers, most costly first
    alone : bool, whether this is the only case of the call (which may take the scalar path)
    progress : callable, optional, given the fraction done about ten times a second

    Returns
    -------
    Results
    """
    n = len(order)
    results = _results(len(cases.beta), save_times.shape[1])
    if n == 0:  # nothing for which to load, or even compile, the kernels
        return results
    threads = max(1, min(_cores(), n // R.LANES))
    _announce()
    stop = threading.Event()
    workers = [
        _Worker(method, law, np.ascontiguousarray(order[i::threads]), cases, loads, alone)
        for i in range(threads)
    ]
    no_path = np.empty((0, 4))

    def work(worker):
        while not stop.is_set() and not worker.go(save_times, results, no_path):
            pass

    if threads == 1:
        for _ in _until(lambda: workers[0].go(save_times, results, no_path)):
            if progress:
                progress(_fraction(workers, n))
        return results
    with ThreadPoolExecutor(threads) as pool:
        futures = [pool.submit(work, worker) for worker in workers]
        try:
            while not all(future.done() for future in futures):
                time.sleep(0.001 if n < 1000 else 0.05)
                if progress:
                    progress(_fraction(workers, n))
        finally:
            stop.set()
        for future in futures:
            future.result()
    return results


def run_path(method, law, cases, loads, progress=None):
    """March the one case and keep every step: (m, 4) T, x, v, psi from t = 0 on, and Results."""
    results = _results(1, 0)
    _announce()
    worker = _Worker(method, law, np.zeros(1, np.int64), cases, loads, True)
    save_times = np.empty((1, 0))
    buffer = np.empty((PATH_ROWS, 4))
    pieces = [np.array([[0.0, *cases.y[0]]])]
    done = False
    rows = 0
    while not done and rows < MAX_ROWS:
        done = worker.go(save_times, results, buffer)
        rows += worker.position[2]
        pieces.append(buffer[: worker.position[2]].copy())
        worker.position[2] = 0
        if progress:
            progress(_fraction([worker], 1))
    if not done:
        results.status[0] = STEP_LIMIT
        results.numbers[0, NUMBERS.index("t")] = pieces[-1][-1, 0] / cases.scale[0]
    return np.concatenate(pieces), results


class _Worker:
    """One set of lanes and its queue."""

    def __init__(self, method, law, queue, cases, loads, alone):
        self.s = np.zeros(R.SIZE)
        self.s[R.CASE : R.CASE + R.LANES] = IDLE
        self.position = np.zeros(3, np.int64)
        self.fixed = (method, law, alone, self.s, queue, self.position, cases, loads)

    def go(self, save_times, results, path):
        return march(*self.fixed, save_times, results, path, BUDGET)


def _results(n, n_times):
    return Results(
        np.full((n, 3), np.nan),
        np.full((n, n_times, 3), np.nan),
        np.full((n, len(NUMBERS)), np.nan),
        np.full(n, RUNNING, np.int8),
    )


def _until(step):
    while not step():
        yield


def _fraction(workers, n):
    """Cases done, and the parts of those under way, over all."""
    done = 0.0
    for worker in workers:
        s, lanes = worker.s, slice(0, R.LANES)
        busy = s[R.CASE :][lanes] != IDLE
        with np.errstate(invalid="ignore"):
            parts = s[R.T :][lanes] / s[R.T_END :][lanes]
        done += worker.position[1] + np.nan_to_num(parts[busy]).sum()
    return min(1.0, done / n)


def _cores():
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _announce():
    """Say that kernels are about to be compiled, if there are none in the cache."""
    compiled = getattr(march, "signatures", True)  # a plain function where the compiler is off
    if not compiled and not any(CACHE.rglob("*.nbi")):
        sys.stderr.write("ratestate: compiling kernels for this machine, some 15 s, once ...\n")
        sys.stderr.flush()
