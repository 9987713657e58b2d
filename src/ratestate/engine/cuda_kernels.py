"""The GPU's kernels: the units of a law and the control, with one slider a thread, as PTX.

No formula stands here.  `kernel` joins three texts in LLVM's language: the units of a law for
vectors of one lane (unit_code.py); the control, which the compiler of the CPU's control makes from
`march_lane`; and the entry, which gives each thread its number.  The
control calls units by name, so LLVM puts the steps into the loop.  Arrays are in the GPU's global
memory, LLVM's address space 1.  `ptx` turns the text into PTX, which NVIDIA's driver assembles.

Thread t works in lane t % LANES of set t // LANES of the lane buffer.  A row of a set is 16
neighbouring doubles.  So a warp reads or writes a row as two whole lines of 128 bytes.

A thread whose case is done takes the next case of the queue, as a lane does on the CPU.  Cases
differ in cost by orders of magnitude, and a warp is as slow as its slowest thread.  A launch ends
after `budget` steps of each thread, and unfinished cases stay in the buffer.  So the host can
report progress or stop.

Threads of a warp take steps of both methods, one kind after the other, and wait for threads that
handle events.  Letting each warp do what most of its threads wait for costs more than it saves (on
an H100).
"""

import re
from typing import NamedTuple

import numpy as np

from . import rows as R
from .calls import WORK, add, call_lanes
from .compiler import kernel_text
from .control import IDLE, next_case
from .instructions import Array
from .machine_code import optimized, target
from .march import Run
from .programs import LEVEL
from .return_map import ReturnRun
from .unit_code import unit_text
from .units import unit_names

#: the oldest GPUs that add doubles atomically; the driver assembles their PTX for newer GPUs too
OLDEST = "sm_60"
#: `run.work`: each thread has its own
OWN = Array("%work", 1, np.dtype(np.float64))
ENTRY = """
declare i32 @llvm.nvvm.read.ptx.sreg.ctaid.x()
declare i32 @llvm.nvvm.read.ptx.sreg.ntid.x()
declare i32 @llvm.nvvm.read.ptx.sreg.tid.x()

define internal i32 @thread() {
  %block = call i32 @llvm.nvvm.read.ptx.sreg.ctaid.x()
  %size = call i32 @llvm.nvvm.read.ptx.sreg.ntid.x()
  %place = call i32 @llvm.nvvm.read.ptx.sreg.tid.x()
  %first = mul i32 %block, %size
  %thread = add i32 %first, %place
  ret i32 %thread
}

define ptx_kernel void @kernel(ptr addrspace(1) %words, i64 %budget) {
  %work = alloca [WORK x double]
  %number = call i32 @thread()
  %thread = zext i32 %number to i64
  call i1 @march_lane(ptr addrspace(1) %words, ptr %work, i64 %thread, i64 %budget)
  ret void
}
"""


class Threads(NamedTuple):
    """All that the threads work on."""

    run: Run | ReturnRun
    under_way: np.ndarray  # (1,) sum of the fractions done of unfinished cases


def units_by_name(law, kind):
    """The LLVM names of a law's units; kind : `MarchUnits` or `ReturnUnits`."""
    names = unit_names(law, kind)
    # LLVM deletes code that would call "null", a unit that the law does not have.
    return kind(*(f"@{name}" if name in names else "null" for name in kind._fields))


def kernel(law, kind, context):
    """LLVM text of ``void kernel(words, budget)``.

    kind : of the law's units; context : `Context` of its `Threads`
    """
    units = unit_text(law, kind, 1)
    units = units.replace("i64 %n)", "i64 %n) alwaysinline")
    text = kernel_text(march_lane, context.layout, "ptr addrspace(1)", ", ptr %work")
    entry = ENTRY.replace("WORK", str(WORK))
    functions = re.sub("define (void|i1)", r"define internal \1", f"{units}\n{text}")
    lines = f"{functions}\n{entry}".splitlines()
    # LLVM refuses to declare a function twice.
    first = dict.fromkeys(line for line in lines if line.startswith("declare"))
    return "\n".join([*first, *(line for line in lines if line not in first)])


def ptx(text):
    """PTX, bytes, of LLVM text."""
    machine = target(OLDEST, "", "nvptx64-nvidia-cuda")
    return machine.emit_assembly(optimized(text, machine, LEVEL)).encode()


def column_of(run, thread):
    """The column of a thread's lane."""
    return thread // R.LANES * run.shape.size + thread % R.LANES


def march_lane(threads, thread, budget):
    """Do the work of `control.run_lanes` in one lane; whether no case is left."""
    run = threads.run
    s, kernel, l = run.s, run.kernel, column_of(run, thread)
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
        # (what is read anew is not known: LLVM would write all code after the step twice)
        kernel.commit(run, l, 1, run.taylor > 0 and s[R.TAYLOR + l] > 0.0)
        if s[R.BREAK + l] > 0.0:
            kernel.end(run, l)
        if run.taylor > 0 and s[R.CHANGES + l] > 0.0:
            s[R.TAYLOR + l] = 1.0 - s[R.TAYLOR + l]
    if s[R.CASE + l] != IDLE:
        add(threads.under_way, 0, s[R.T + l] / s[R.T_END + l])
    return False
