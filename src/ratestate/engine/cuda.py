"""Running kernels on an NVIDIA GPU: arrays there and back, launches, progress, interruption.

Nothing here imports CUDA until it is asked to run.
"""

import importlib.util
import time
import warnings
from typing import Any

import numpy as np
from numba import config as numba_config

from ..errors import ParameterError, SolverError
from . import rows as R
from .backend import check_stopped
from .model import empty_results
from .return_map import empty_return_results
from .rows import rows_of

config: Any = numba_config  # numba sets its attributes at run time

# One warp a block: threads share nothing, and the finer a batch of a few thousand cases is cut, the
# more evenly it spreads over the multiprocessors.
BLOCK = 32
# Of warps on a multiprocessor.  A step keeps its stages or coefficients in registers, and so takes
# all 255 that a thread can have: 65,536 // (255 -> 256 x 32) = 8.  More would wait for their turn
# with cases in their hands, and these are the last to finish.  (Twice as many, with half the
# registers, gained nothing on an H100.)
RESIDENT = 8
# Seconds a launch should take: often enough for a progress bar and for Ctrl-C, and a hundred times
# what it takes to launch.  The least budget is a few ms even where doubles are slow.
SLICE = 0.05
LEAST_BUDGET = 64
GROWTH = 4


def check():
    """Raise ParameterError, with the remedy, where there is no GPU to run on."""
    if reason := _missing():
        raise ParameterError(
            "device = 'cuda' needs an NVIDIA GPU with its driver, and numba-cuda: pip install"
            f" 'ratestate[gpu]'; not found here: {reason}; leave device out to run on the CPU"
        )


def _missing():
    """What there is none of, or nothing."""
    if not config.ENABLE_CUDASIM and importlib.util.find_spec("numba_cuda") is None:
        return "numba-cuda"
    cuda = _numba_cuda()
    if cuda.is_available():
        return ""
    # no driver, or no device; without words: no compiler
    error = str(cuda.cuda_error() or "the CUDA toolkit (NVVM)")
    return "; ".join(line.strip().rstrip(".:") for line in error.splitlines() if line.strip(" :"))


def _numba_cuda() -> Any:
    """The module `numba.cuda`: that of numba-cuda, or the simulator's."""
    from numba import cuda

    return cuda


def run_march(law, taylor, cases, loads, save_times, order, progress=None):
    """March all cases; parameters and `Results` as for `dispatch.run_march`.

    ParameterError where there is no GPU, SolverError where it fails, `backend.Stopped`.

    taylor : bool, whether steps may be of the Taylor method, if the law allows
    """
    check()
    from . import cuda_kernels

    n_times = save_times.shape[1]
    if n_times == 0:  # for arrays without elements numba would compile anew: a time never reached
        save_times = np.full((len(save_times), 1), np.inf)
    results = empty_results(cases.y, save_times.shape[1])
    kernel = cuda_kernels.march_kernel(law, taylor)
    _work(kernel, rows_of(law).size, order, (cases, loads, save_times), results, progress)
    return results._replace(saved=results.saved[:, :n_times])


def run_returns(law, starts):
    """`ReturnResults` of all cases; parameters as for `dispatch.run_returns`.

    Exceptions as for `run_march`.
    """
    check()
    from . import cuda_kernels

    results = empty_return_results(starts.y)
    kernel = cuda_kernels.return_kernel(law)
    order = np.arange(len(starts.y))
    _work(kernel, rows_of(law).size, order, (starts,), results, None)
    return results


def _work(kernel, size, order, given, results, progress):
    """Launch the kernel until all cases are done; its results are copied into `results`."""
    if len(order) == 0:
        return
    check_stopped()
    for fraction in _launches(kernel, size, order, given, results):
        if progress:
            progress(fraction)
        if fraction < 1.0:  # (what is done is kept)
            check_stopped()


def _launches(kernel, size, order, given, results):
    """Do `_work`: yields the fraction done after each launch.  SolverError where CUDA fails."""
    try:
        yield from _unguarded_launches(kernel, size, order, given, results)
    except Exception as error:  # none of a case's: compiled code has but status codes
        raise SolverError(
            f"the GPU failed ({type(error).__name__}: {error}); if its memory is what lacks, give a"
            f" smaller chunk; without device='cuda' the CPU does the work"
        ) from error


def _unguarded_launches(kernel, size, order, given, results):
    """`_launches`, with the exceptions of CUDA and numba."""
    from . import cuda_kernels

    n = len(order)
    cuda = _numba_cuda()
    capacity = RESIDENT * cuda.current_context().device.MULTIPROCESSOR_COUNT
    blocks = min(-(-n // BLOCK), capacity)
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Grid size")  # a small batch makes a small grid
        launch, vacate = kernel[blocks, BLOCK], cuda_kernels.vacating_kernel()[blocks, BLOCK]
    buffers = cuda.device_array((-(-blocks * BLOCK // R.LANES), size))
    vacate(buffers)
    position, there = np.zeros(2, np.int64), _to_device(results)
    queue, counts = _to_device(order), cuda.to_device(position)
    rest = (*map(_to_device, given), there)
    budget = LEAST_BUDGET
    while position[1] < n:
        under_way = cuda.to_device(np.zeros(1))
        start = time.perf_counter()
        launch(buffers, queue, counts, under_way, *rest, budget)
        counts.copy_to_host(position)  # waits
        pace = SLICE / (time.perf_counter() - start)
        budget = max(LEAST_BUDGET, int(budget * min(pace, GROWTH)))
        part = np.nan_to_num(under_way.copy_to_host()[0])
        yield min(1.0, (position[1] + part) / n)
    for here, array in zip(results, there, strict=True):
        array.copy_to_host(here)


def _to_device(arrays):
    """The array, or the named tuple of arrays, in the GPU's memory."""
    if isinstance(arrays, tuple):
        return type(arrays)(*map(_to_device, arrays))
    return _numba_cuda().to_device(np.ascontiguousarray(arrays))
