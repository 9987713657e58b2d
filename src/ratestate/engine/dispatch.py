"""Run cases from Python: threads, progress, interruption, and the steps of a single slider."""

import threading
from concurrent.futures import ThreadPoolExecutor, wait

import numpy as np

from ..machine import cores
from . import backend, machine_code
from . import rows as R
from .control import IDLE, SETS, KernelRun, idle_lanes, run_lanes
from .march import MARCH, POINTS_PER_STEP, RIGID_MARCH
from .model import NUMBERS, STEP_LIMIT, empty_results
from .programs import Program, units_of
from .return_map import RETURN_MAP, empty_return_results
from .rows import WORK_SIZE
from .units import RigidUnits

# Sweeps over the lanes between two checks for a stop: some 20 ms in lanes, 4 ms alone.
BUDGET = 20_000
PATH_STEPS = 2000  # sweeps between two checks of a path
MAX_PATH_ROWS = 10_000_000  # 320 MB; a longer path ends with STEP_LIMIT


def run_march(taylor, law, cases, loads, save_times, order, progress=None):
    """Run all cases and return `Results`.

    The cases run on `backend.Backend.threads`, but not on more threads than sets of lanes can fill,
    or on the backend's device.  Cases with K = inf run on the CPU.  No case raises: its status says
    how it ended.  A case that is not in `order` has RUNNING and NaN.  Raises `backend.Stopped`,
    `CompilationError`, and on "cuda" the errors of `cuda.run`.  The arguments are not checked.

    taylor : a value of `METHODS`; law : of `friction.laws.LAWS`; cases, loads : Cases, Loads
    save_times : (rows, n_times) [s], increasing
    order : (m,) numbers of the cases to run, most costly first
    progress : callable, optional, receives the fraction done, 0 to 1, many times a second
    """
    cases, loads = _contiguous(cases), _contiguous(loads)
    results = empty_results(cases.y, save_times.shape[1])
    fields = {"cases": cases, "loads": loads, "results": results}
    fields["save_times"] = np.ascontiguousarray(save_times, float)
    is_rigid = np.isinf(cases.kappa[order])
    queues = {MARCH: order[~is_rigid], RIGID_MARCH: order[is_rigid]}
    _run(queues, law, taylor, progress, fields)
    return results


def _contiguous(arrays):
    """Return a named tuple of contiguous arrays: integers for indices, else doubles."""
    items = arrays._asdict().items()
    kinds = {"loading": np.int64, "times": np.int64}
    return type(arrays)(*(np.ascontiguousarray(x, kinds.get(name, float)) for name, x in items))


def run_returns(law, starts):
    """Run all cases from `Starts` to the next return to the section; `ReturnResults`.

    Threads, device, exceptions and `law` are as for `run_march`.
    """
    results = empty_return_results(starts.y)
    fields = {"cases": _contiguous(starts), "results": results}
    fields["waveform"] = int((starts.period > 0.0).any())
    _run({RETURN_MAP: np.arange(len(starts.y))}, law, True, None, fields)
    return results


def _run(queues, law, taylor, progress, fields):
    """Run queues of cases, each with its kernel, on the backend's device.

    queues : kernel -> (m,) numbers of its cases; the other arguments are as for `_Worker`
    """
    queues = {kernel: queue for kernel, queue in queues.items() if len(queue)}
    for kernel in queues.keys() - {RIGID_MARCH}:
        if backend.current().device == "cuda":
            from . import cuda

            cuda.run(kernel, law, taylor, queues.pop(kernel), progress, fields)
    n = sum(map(len, queues.values()))
    threads = max(1, min(backend.current().threads or cores(), n // R.LANES))
    # (without cases, no kernel is loaded or compiled)
    workers = [
        _Worker(kernel, queue[i::threads], law, taylor, **fields)
        for kernel, queue in queues.items()
        for i in range(min(threads, len(queue)))
    ]
    if threads == 1:
        for runner in workers:
            while not runner.run_sweeps():
                _report(workers, n, progress)
        return
    stop = threading.Event()

    def work(worker):
        while not stop.is_set() and not worker.run_sweeps():
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
    """Report the fraction of n cases that is done; raise `backend.Stopped` on a stop."""
    backend.check_stopped()
    if not progress:
        return
    done = 0.0
    for worker in workers:
        case, t, end = (worker.sets[:, row : row + R.LANES] for row in (R.CASE, R.T, R.T_END))
        with np.errstate(invalid="ignore", divide="ignore"):
            parts = t / end
        done += worker.position[1] + np.nan_to_num(parts[case != IDLE]).sum()
    progress(min(1.0, done / n))


def run_path(taylor, law, cases, loads, progress=None):
    """Run one case and return its path, with every step, and `Results`.

    The path is (m, 1 + len(y)): T and y = (x, v, psi), from t = 0 on.  It ends where the case ends,
    whatever the status; beyond `MAX_PATH_ROWS` the status is STEP_LIMIT.  The case runs on the CPU,
    whatever the backend's device.  Exceptions are as for `run_march`.
    """
    cases, loads = _contiguous(cases), _contiguous(loads)
    results = empty_results(cases.y, 0)
    # A step needs at most POINTS_PER_STEP rows, a jump one more, and the start one.
    buffer = np.empty((PATH_STEPS * (POINTS_PER_STEP + 1) + 1, 1 + cases.y.shape[1]))
    fields = {"cases": cases, "loads": loads, "results": results, "path": buffer}
    kernel = RIGID_MARCH if np.isinf(cases.kappa[0]) else MARCH
    worker = _Worker(kernel, np.zeros(1, np.int64), law, taylor, **fields)
    pieces: list[np.ndarray] = []
    done = False
    rows = 0
    while not done and rows < MAX_PATH_ROWS:
        done = worker.run_sweeps(PATH_STEPS)
        rows += worker.position[2]
        pieces.append(buffer[: worker.position[2]].copy())
        worker.position[2] = 0
        _report([worker], 1, progress)
    if not done:
        results.status[0] = STEP_LIMIT
        results.numbers[0, NUMBERS.index("t")] = pieces[-1][-1, 0] / cases.scale[0]
    return np.concatenate(pieces), results


class _Worker:
    """Sets of lanes, a queue of cases, and the kernel that runs them.

    kernel : `control.Kernel`; queue : (n,) numbers of cases
    taylor : whether steps may use the Taylor method, if the law allows
    fields : the other fields of `control.KernelRun`
    """

    def __init__(self, kernel, queue, law, taylor, **fields):
        rigid = kernel.units is RigidUnits
        shape = R.shape_of(law)._replace(rigid=int(rigid))
        taylor = taylor and not rigid and shape.terms > R.RODAS5P_TERMS
        s, self.position = idle_lanes(shape, SETS if taylor else 1), np.zeros(3, np.int64)
        self.sets = s.reshape(-1, shape.size)
        width = R.WIDTH if len(queue) > 1 else 1  # vectors would slow down a single slider
        units, queue = units_of(law, kernel.units, width), np.ascontiguousarray(queue)
        lanes = width, int(taylor), s, queue, self.position, np.zeros(WORK_SIZE)
        self._program = Program(run_lanes, KernelRun(kernel, shape, units, *lanes, **fields))
        machine_code.report_time(law.label)

    def run_sweeps(self, budget=BUDGET):
        """Run for `budget` sweeps over the lanes; return whether all cases are done."""
        return self._program(budget)
