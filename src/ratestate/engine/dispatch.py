"""Running kernels from Python: threads, progress, interruption, the solver's own steps."""

import threading
from concurrent.futures import ThreadPoolExecutor, wait

import numpy as np

from ..machine import cores
from . import backend, machine_code
from . import rows as R
from .control import IDLE, SETS, Run, idle_lanes, run_lanes
from .march import MARCH, POINTS, RIGID_MARCH
from .model import NUMBERS, STEP_LIMIT, empty_results
from .programs import Program, units_of
from .return_map import RETURN_MAP, empty_return_results
from .rows import WORK
from .units import RigidUnits

# Sweeps over the lanes between two looks at the clock: some 20 ms in lanes, 4 ms alone.
BUDGET = 20_000
PATH_STEPS = 2000
MAX_ROWS = 10_000_000  # of a path, 320 MB; then STEP_LIMIT


def run_march(taylor, law, cases, loads, save_times, order, progress=None):
    """`Results` of all cases, on one thread a core, but no more than full sets of lanes.

    At most `backend.Backend.threads`, or on its device; those of K = inf on the CPU.  No case
    raises: its status says how it ended, RUNNING and NaN that it is not in `order`.
    `backend.Stopped` where the backend stops it; `CompilationError`, and on "cuda" what
    `cuda.run` raises.  The arguments are not checked.

    taylor : of `METHODS`; law : of `friction.laws.LAWS`; cases, loads : Cases, Loads (model.py)
    save_times : (rows, n_times) [s], increasing
    order : (m,) numbers of the cases to run, most costly first
    progress : callable, optional, given the fraction done, 0 to 1, many times a second
    """
    cases, loads = _uniform(cases), _uniform(loads)
    results = empty_results(cases.y, save_times.shape[1])
    given = {"cases": cases, "loads": loads, "results": results}
    given["save_times"] = np.ascontiguousarray(save_times, float)
    is_rigid = np.isinf(cases.kappa[order])
    queues = {MARCH: order[~is_rigid], RIGID_MARCH: order[is_rigid]}
    _run(queues, law, taylor, progress, given)
    return results


def _uniform(arrays):
    """A named tuple with contiguous arrays of doubles, and of integers for indices."""
    each = arrays._asdict().items()
    kinds = {"loading": np.int64, "times": np.int64}
    return type(arrays)(*(np.ascontiguousarray(x, kinds.get(name, float)) for name, x in each))


def run_returns(law, starts):
    """`ReturnResults` of all cases, from `Starts` to the next upward crossing of the section.

    Threads, device, exceptions, `law` as for `run_march`.
    """
    results = empty_return_results(starts.y)
    given = {"cases": _uniform(starts), "results": results}
    given["waveform"] = int((starts.period > 0.0).any())
    _run({RETURN_MAP: np.arange(len(starts.y))}, law, True, None, given)
    return results


def _run(queues, law, taylor, progress, given):
    """Let kernels do cases, the first of them on the backend's device.

    queues : kernel -> (m,) numbers of its cases; others are as for `_Worker`
    """
    queues = {kernel: queue for kernel, queue in queues.items() if len(queue)}
    for kernel in queues.keys() - {RIGID_MARCH}:
        if backend.current().device == "cuda":
            from . import cuda

            cuda.run(kernel, law, taylor, queues.pop(kernel), progress, given)
    n = sum(map(len, queues.values()))
    threads = max(1, min(backend.current().threads or cores(), n // R.LANES))
    # (of no cases, kernels are neither loaded nor even compiled)
    workers = [
        _Worker(kernel, queue[i::threads], law, taylor, **given)
        for kernel, queue in queues.items()
        for i in range(min(threads, len(queue)))
    ]
    if threads == 1:
        for one in workers:
            while not one.go():
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
    """Give progress the part of n cases that is done; `backend.Stopped` where they are stopped."""
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
    """March the one case and keep every step: its path and `Results`.

    The path is (m, 1 + len(y)), T and y = (x, v, psi), from t = 0 on.

    However it ends, the path is as far as it came; beyond `MAX_ROWS` the status is STEP_LIMIT.
    On the CPU, whatever the backend's device; exceptions as for `run_march`.
    """
    cases, loads = _uniform(cases), _uniform(loads)
    results = empty_results(cases.y, 0)
    # A step needs so many rows at most, a jump one more, and the start one.
    buffer = np.empty((PATH_STEPS * (POINTS + 1) + 1, 1 + cases.y.shape[1]))
    given = {"cases": cases, "loads": loads, "results": results, "path": buffer}
    kernel = RIGID_MARCH if np.isinf(cases.kappa[0]) else MARCH
    worker = _Worker(kernel, np.zeros(1, np.int64), law, taylor, **given)
    pieces: list[np.ndarray] = []
    done = False
    rows = 0
    while not done and rows < MAX_ROWS:
        done = worker.go(PATH_STEPS)
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

    kernel : `control.Kernel`; queue : (n,) numbers of cases
    taylor : whether steps may be of the Taylor method, if the law allows
    given : what else the kernel's record has
    """

    def __init__(self, kernel, queue, law, taylor, **given):
        rigid = kernel.units is RigidUnits
        shape = R.shape_of(law)._replace(rigid=int(rigid))
        taylor = taylor and not rigid and shape.terms > R.OF_RODAS5P
        s, self.position = idle_lanes(shape, SETS if taylor else 1), np.zeros(3, np.int64)
        self.sets = s.reshape(-1, shape.size)
        width = R.WIDTH if len(queue) > 1 else 1  # (alone, vectors only cost time)
        units, queue = units_of(law, kernel.units, width), np.ascontiguousarray(queue)
        lanes = width, int(taylor), s, queue, self.position, np.zeros(WORK)
        self._program = Program(run_lanes, Run(kernel, shape, units, *lanes, **given))
        machine_code.report_time()

    def go(self, budget=BUDGET):
        """Work for a while; whether all is done."""
        return self._program(budget)
