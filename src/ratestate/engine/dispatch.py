"""Running kernels from Python: threads, progress, interruption, the solver's own steps."""

import threading
from concurrent.futures import ThreadPoolExecutor, wait

import numpy as np

from ..machine import cores
from . import backend
from . import rows as R
from .compilation import announce, call
from .lane_case import IDLE
from .lane_sets import SETS
from .march import march, march_im2017
from .model import NUMBERS, RODAS5P, STEP_LIMIT, empty_results
from .return_map import empty_return_results, march_to_section

# Sweeps over the lanes between two looks at the clock: some 20 ms in lanes, 4 ms alone.
BUDGET = 20_000
PATH_ROWS = 8192
MAX_ROWS = 10_000_000  # of a path, 320 MB; then STEP_LIMIT


def run_march(method, law, cases, loads, save_times, order, progress=None):
    """`Results` of all cases, on one thread a core, but no more than full sets of lanes.

    At most `backend.Backend.threads`, or on its device.  No case raises: its status says how it
    ended, RUNNING and NaN that it is not in `order`.  `backend.Stopped` where the backend stops it;
    `CompilationError`, and on "cuda" what `cuda.run_march` raises.  The arguments are not checked.

    cases, loads : Cases, Loads (model.py); method : of `METHODS`; law : of `friction.laws.LAWS`
    save_times : (rows, n_times) [s], increasing
    order : (m,) numbers of the cases to run, most costly first
    progress : callable, optional, given the fraction done, 0 to 1, many times a second
    """
    if backend.current().device == "cuda":
        from . import cuda

        return cuda.run_march(law, method.taylor, cases, loads, save_times, order, progress)
    results = empty_results(cases.y, save_times.shape[1])
    fixed = (cases, loads, save_times, results, np.empty((0, 1 + cases.y.shape[1])))

    _share(order, lambda queue: _marcher(method, law, queue, fixed), progress)
    return results


def _marcher(method, law, queue, fixed):
    """The `_Worker` of a queue of cases that are marched by this method."""
    kernel = march if method.code is RODAS5P else march_im2017
    return _Worker(kernel, (method.code,), law, method.taylor, queue, fixed)


def run_returns(law, starts):
    """`ReturnResults` of all cases, from `Starts` to the next upward crossing of the section.

    Threads, device, exceptions, `law` as for `run_march`.
    """
    if backend.current().device == "cuda":
        from . import cuda

        return cuda.run_returns(law, starts)
    results = empty_return_results(starts.y)

    def worker(queue):
        return _Worker(march_to_section, (), law, True, queue, (starts, results))

    _share(np.arange(len(starts.y)), worker)
    return results


def _share(order, worker, progress=None):
    """Let workers (callable, queue -> `_Worker`) take all cases: one a core, with full lanes."""
    n = len(order)
    if n == 0:  # nothing for which to load, or even compile, the kernels
        return
    threads = max(1, min(backend.current().threads or cores(), n // R.LANES))
    workers = [worker(np.ascontiguousarray(order[i::threads])) for i in range(threads)]
    if threads == 1:
        while not workers[0].go():
            _report(workers, n, progress)
        return
    stop = threading.Event()

    def work(worker):
        while not stop.is_set() and not worker.go():
            pass

    with ThreadPoolExecutor(threads) as pool:
        futures = [pool.submit(work, worker) for worker in workers]
        try:
            while wait(futures, timeout=0.05).not_done:
                _report(workers, n, progress)
        finally:
            stop.set()
        for future in futures:
            future.result()


def _report(workers, n, progress):
    """Give progress what is done of n cases; `backend.Stopped` where the backend stops them."""
    backend.check_stopped()
    if progress:
        progress(_fraction(workers, n))


def run_path(method, law, cases, loads, progress=None):
    """March the one case and keep every step: its path and `Results`.

    The path is (m, 1 + len(y)), T and y = (x, v, psi), from t = 0 on.

    However it ends, the path is as far as it came; beyond `MAX_ROWS` the status is STEP_LIMIT.
    On the CPU, whatever the backend's device; exceptions as for `run_march`.
    """
    results = empty_results(cases.y, 0)
    buffer = np.empty((PATH_ROWS, 1 + cases.y.shape[1]))
    fixed = (cases, loads, np.empty((1, 0)), results, buffer)
    worker = _marcher(method, law, np.zeros(1, np.int64), fixed)
    pieces = [np.array([[0.0, *cases.y[0]]])]
    done = False
    rows = 0
    while not done and rows < MAX_ROWS:
        done = worker.go()
        rows += worker.position[2]
        pieces.append(buffer[: worker.position[2]].copy())
        worker.position[2] = 0
        _report([worker], 1, progress)
    if not done:
        results.status[0] = STEP_LIMIT
        results.numbers[0, NUMBERS.index("t")] = pieces[-1][-1, 0] / cases.scale[0]
    return np.concatenate(pieces), results


class _Worker:
    """Sets of lanes, their queue, and the kernel that works it off.

    codes : what the kernel is given before the law
    taylor : whether steps may be of the Taylor method, if the law allows
    """

    def __init__(self, kernel, codes, law, taylor, queue, fixed):
        announce(kernel, law)
        rows = R.rows_of(law)
        taylor = taylor and len(rows.c[0]) > R.OF_RODAS5P
        sets = SETS if taylor else 1
        self.s = np.zeros(sets * rows.size)
        self.columns = np.add.outer(rows.size * np.arange(sets), np.arange(R.LANES))
        self.s[R.CASE + self.columns] = IDLE
        self.s[R.HOME + self.columns] = self.columns
        self.position = np.zeros(3, np.int64)
        self.kernel = kernel
        self.arguments = (*codes, law, taylor, self.s, queue, self.position, *fixed)

    def go(self):
        """Work for a while; whether all is done."""
        return call(self.kernel, *self.arguments, BUDGET)


def _fraction(workers, n):
    """Cases done, and the parts of those under way, over all."""
    done = 0.0
    for worker in workers:
        s, columns = worker.s, worker.columns
        busy = s[R.CASE + columns] != IDLE
        with np.errstate(invalid="ignore", divide="ignore"):
            parts = s[R.T + columns] / s[R.T_END + columns]
        done += worker.position[1] + np.nan_to_num(parts[busy]).sum()
    return min(1.0, done / n)
