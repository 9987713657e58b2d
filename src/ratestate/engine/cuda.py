"""Run cases on an NVIDIA GPU, one slider per thread: kernels, launches, progress.

This module contains no formula.  `kernel_of` joins three texts in LLVM's language: the units of a
law for vectors of one lane (code.py); the control, which the compiler of the CPU's control makes
from `march_lane`; and the entry, which gives each thread its number.  The control calls units by
name, so LLVM inlines the steps into the loop.  Arrays are in the GPU's global memory, LLVM's
address space 1.  `ptx` turns the text into PTX, which NVIDIA's driver assembles.

Thread t works in lane t % LANES of set t // LANES of the lane buffer.  A row of a set is 16
neighbouring doubles.  So a warp reads or writes a row as two whole lines of 128 bytes.

A thread whose case is done takes the next case of the queue, as a lane does on the CPU.  Cases
differ in cost by orders of magnitude, and a warp is as slow as its slowest thread.  A launch ends
after `budget` steps of each thread, and unfinished cases stay in the buffer.  So the host can
report progress or stop.

Threads of a warp take steps of both methods, one after the other, and wait for threads that handle
events.  Letting each warp do the step that most of its threads wait for costs more than it saves
(on an H100).
"""

import contextlib
import ctypes
import re
import time

import numpy as np

from ..errors import ParameterError, SolverError
from . import cuda_driver, machine_code
from . import rows as R
from .backend import check_stopped
from .code import unit_text
from .compiler import Array, kernel_text
from .control import IDLE, KernelRun, idle_lanes, next_case
from .machine_code import optimize, target
from .programs import LEVEL, Context
from .rows import WORK_SIZE, add, call_lanes
from .units import unit_names

# Threads of a block: one warp.  Threads share nothing, and small blocks spread a batch of a few
# thousand cases more evenly over the multiprocessors.
BLOCK = 32
# Warps on a multiprocessor.  A step keeps its stages or coefficients in registers, and takes up to
# the 255 that a thread can have: 65,536 // (256 x 32) = 8.  Further warps would take cases and wait
# for their turn, and these cases would finish last.  (Twice as many warps with half the registers
# gained nothing on an H100.)
WARPS = 8
# Seconds that a launch should take: short enough for a progress bar and Ctrl-C, and a hundred times
# the overhead of a launch.  MIN_BUDGET takes a few ms even on GPUs that are slow at doubles.
LAUNCH_SECONDS = 0.05
MIN_BUDGET = 64
MAX_GROWTH = 4
#: oldest GPUs that add doubles atomically; the driver assembles their PTX for newer GPUs too
OLDEST = "sm_60"
#: `run.work`, of which each thread has its own
THREAD_WORK = Array("%work", 1, np.dtype(np.float64))
ENTRY = """
define internal i32 @thread() {
  %block = call i32 @llvm.nvvm.read.ptx.sreg.ctaid.x()
  %size = call i32 @llvm.nvvm.read.ptx.sreg.ntid.x()
  %place = call i32 @llvm.nvvm.read.ptx.sreg.tid.x()
  %first = mul i32 %block, %size
  %thread = add i32 %first, %place
  ret i32 %thread
}

define ptx_kernel void @kernel(ptr addrspace(1) %words, i64 %budget) {
  %work = alloca [WORK_SIZE x double]
  %number = call i32 @thread()
  %thread = zext i32 %number to i64
  call { i1 } @march_lane(ptr addrspace(1) %words, ptr %work, i64 %thread, i64 %budget)
  ret void
}
"""


def check():
    """Raise ParameterError, with the remedy, if there is no GPU to run on."""
    try:
        cuda_driver.device()
    except (OSError, cuda_driver.CudaError) as error:
        raise ParameterError(
            f"needs an NVIDIA GPU with its driver, which was not found ({error})",
            "Leave device out to run on the CPU.",
            symbol="device",
            value="'cuda'",
        ) from error


def run(kernel, law, taylor, order, progress, fields):
    """Run a kernel on the cases of `order`; the arguments are as for `dispatch._run`.

    Raises ParameterError if there is no GPU, SolverError if the GPU fails, and `backend.Stopped`.
    """
    check()
    check_stopped()
    with contextlib.closing(_launches(kernel, law, taylor, order, fields)) as fractions:
        for fraction in fractions:
            if progress:
                progress(fraction)
            if fraction < 1.0:  # finished work is not discarded
                check_stopped()


def _launches(kernel, law, taylor, order, fields):
    """Launch until all cases are done; yield the fraction done after each launch."""
    memory = cuda_driver.Memory()
    try:
        cuda_driver.enter()
        shape, n = R.shape_of(law), len(order)
        blocks = min(-(-n // BLOCK), WARPS * cuda_driver.attribute(cuda_driver.MULTIPROCESSORS))
        s = idle_lanes(shape, -(-blocks * BLOCK // R.LANES))
        position, partly_done = np.zeros(3, np.int64), np.zeros(1)
        names, kind = unit_names(law, kernel.units), kernel.units
        # "null" stands for a unit that the law does not have; LLVM deletes code that would call it.
        units = kind(*(f"@{name}" if name in names else "null" for name in kind._fields))
        uses_taylor = taylor and shape.terms > R.RODAS5P_TERMS
        lanes = 1, int(uses_taylor), s, np.ascontiguousarray(order), position, THREAD_WORK
        run = KernelRun(kernel, shape, units, *lanes, **fields, partly_done=partly_done)
        context = Context(run, memory.address)
        version = machine_code.short_hash(context.kinds)
        name = f"{law.name}-{kind.__name__}-{version}-{OLDEST}"
        image = machine_code.cached_code(name, lambda: ptx(kernel_of(law, kernel.units, context)))
        function = cuda_driver.function(image)
        words, budget = ctypes.c_uint64(memory.address(context.words)), ctypes.c_int64(MIN_BUDGET)
        while position[1] < n:
            partly_done[0] = 0.0
            memory.send(partly_done)
            start = time.perf_counter()
            cuda_driver.launch(function, blocks, BLOCK, words, budget)
            memory.fetch(position)
            pace = LAUNCH_SECONDS / (time.perf_counter() - start)
            budget.value = max(MIN_BUDGET, int(budget.value * min(pace, MAX_GROWTH)))
            memory.fetch(partly_done)
            yield min(1.0, (position[1] + np.nan_to_num(partly_done[0])) / n)
        for array in fields["results"]:
            memory.fetch(array)
    except Exception as error:  # not due to a case: cases have status codes and raise nothing
        raise SolverError(
            f"The GPU failed ({type(error).__name__}: {error}). If it lacks memory, give a smaller"
            " chunk. Leave device out to run on the CPU."
        ) from error
    finally:
        memory.free()


# The kernel of a law, as LLVM text and as PTX


def kernel_of(law, kind, context):
    """Return the LLVM text of ``void kernel(words, budget)``.

    kind : class of the law's units; context : `Context` of its `KernelRun`
    """
    units = unit_text(law, kind, 1)
    units = units.replace("i64 %n)", "i64 %n) alwaysinline")
    text = kernel_text(march_lane, context.layout(), "ptr addrspace(1)", ", ptr %work")
    entry = ENTRY.replace("WORK_SIZE", str(WORK_SIZE))
    functions = re.sub(r"define (void|\{)", r"define internal \1", f"{units}\n{text}")
    return f"{functions}\n{entry}"


def ptx(text):
    """Return LLVM text as PTX, bytes."""
    machine = target(OLDEST, "", "nvptx64-nvidia-cuda")
    return machine.emit_assembly(optimize(text, machine, LEVEL)).encode()


def march_lane(run, thread, budget):
    """Do the work of `control.run_lanes` in one lane; return whether no case is left."""
    s, kernel, l = run.s, run.kernel, thread // R.LANES * run.shape.size + thread % R.LANES
    for _ in range(budget):
        if s[R.CASE + l] == IDLE:
            i = next_case(run)
            if i < 0:
                return True
            kernel.load(run, l, i)
        if run.taylor > 0 and s[R.TAYLOR + l] > 0.0:
            call_lanes(run.units.taylor, s, l, 1)
        else:
            call_lanes(run.units.step, s, l, 1)
        if s[R.CALL + l] > 0.0:
            kernel.handle(run, l)
        # Read the method again: else LLVM would duplicate all code that follows the step.
        kernel.commit(run, l, 1, run.taylor > 0 and s[R.TAYLOR + l] > 0.0)
        if s[R.BREAK + l] > 0.0:
            kernel.end(run, l)
        if run.taylor > 0 and s[R.CHANGES + l] > 0.0:
            s[R.TAYLOR + l] = 1.0 - s[R.TAYLOR + l]
    if s[R.CASE + l] != IDLE:
        add(run.partly_done, 0, s[R.T + l] / s[R.T_END + l])
    return False
