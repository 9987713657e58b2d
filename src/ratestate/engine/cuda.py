"""Running kernels on an NVIDIA GPU: copies of arrays, launches, progress, interruption."""

import contextlib
import ctypes
import time

import numpy as np

from ..errors import ParameterError, SolverError
from . import cache, cuda_driver
from . import cuda_kernels as kernels
from . import rows as R
from .backend import check_stopped
from .control import idle_lanes
from .programs import Context

# One warp a block: threads share nothing, and the finer a batch of a few thousand cases is cut, the
# more evenly it spreads over the multiprocessors.
BLOCK = 32
# Warps on a multiprocessor.  A step keeps its stages or coefficients in registers, and takes up to
# the 255 that a thread can have: 65,536 // (256 x 32) = 8.  Further warps would wait for their turn
# with cases in their hands, and these would finish last.  (Twice as many warps with half the
# registers gained nothing on an H100.)
RESIDENT = 8
# Seconds a launch should take: often enough for a progress bar and for Ctrl-C, and a hundred times
# what it takes to launch.  The least budget is a few ms even where doubles are slow.
SLICE = 0.05
LEAST_BUDGET = 64
GROWTH = 4


def check():
    """Raise ParameterError, with the remedy, if there is no GPU to run on."""
    try:
        cuda_driver.device()
    except (OSError, cuda_driver.CudaError) as error:
        raise ParameterError(
            f"device = 'cuda' needs an NVIDIA GPU with its driver, which was not found ({error})."
            " Leave device out to run on the CPU."
        ) from error


def run(kernel, law, taylor, order, progress, given):
    """Let a kernel do the cases of `order`; arguments as for `dispatch._run`.

    Raises ParameterError if there is no GPU, SolverError if it fails, and `backend.Stopped`.
    """
    check()
    check_stopped()
    with contextlib.closing(_launches(kernel, law, taylor, order, given)) as fractions:
        for fraction in fractions:
            if progress:
                progress(fraction)
            if fraction < 1.0:  # (finished work is kept)
                check_stopped()


def _launches(*given):
    """Launch until all cases are done; yield the fraction done after each launch."""
    memory = cuda_driver.Memory()
    try:
        cuda_driver.enter()
        yield from _unguarded_launches(memory, *given)
    except Exception as error:  # (cases raise nothing: they have status codes)
        raise SolverError(
            f"The GPU failed ({type(error).__name__}: {error}). If it lacks memory, give a smaller"
            " chunk. Leave device out to run on the CPU."
        ) from error
    finally:
        memory.free()


def _unguarded_launches(memory, kernel, law, taylor, order, given):
    """Do the work of `_launches`; exceptions are the driver's."""
    shape, n = R.shape_of(law), len(order)
    blocks = min(-(-n // BLOCK), RESIDENT * cuda_driver.attribute(cuda_driver.MULTIPROCESSORS))
    s, _ = idle_lanes(shape, -(-blocks * BLOCK // R.LANES))
    position, under_way = np.zeros(3, np.int64), np.zeros(1)
    run = kernel.record(
        kernel=kernel,
        shape=shape,
        units=kernels.units_by_name(law, kernel.units),
        taylor=int(taylor and shape.terms > R.OF_RODAS5P),
        s=s,
        queue=np.ascontiguousarray(order),
        position=position,
        work=kernels.OWN,
        **given,
    )
    context = Context(kernels.Threads(run, under_way), memory.place)
    function = cuda_driver.function(_image(law, kernel.units, context))
    words, budget = ctypes.c_uint64(memory.place(context.words)), ctypes.c_int64(LEAST_BUDGET)
    while position[1] < n:
        under_way[0] = 0.0
        memory.send(under_way)
        start = time.perf_counter()
        cuda_driver.launch(function, blocks, BLOCK, words, budget)
        memory.fetch(position)
        pace = SLICE / (time.perf_counter() - start)
        budget.value = max(LEAST_BUDGET, int(budget.value * min(pace, GROWTH)))
        memory.fetch(under_way)
        yield min(1.0, (position[1] + np.nan_to_num(under_way[0])) / n)
    for array in given["results"]:
        memory.fetch(array)


def _image(law, kind, context):
    """Return the PTX of a kernel, from disk if it is kept there."""
    kinds = cache.short_hash(tuple(context.kinds))
    name = f"{law.name}-{kind.__name__}-{kinds}-{kernels.OLDEST}"
    return cache.obtained(name, lambda: kernels.ptx(kernels.kernel(law, kind, context)))
