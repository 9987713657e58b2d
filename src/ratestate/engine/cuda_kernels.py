"""The CUDA kernels: the engine's own functions of (lane buffer, lane), one slider a thread.

numba-cuda compiles the functions that numba compiled for the CPU, from the same source, so that
not one formula stands here: only what `march.march` and `return_map.march_to_section` do with a
lane, in their order.  Thread t works in lane t % LANES of row t // LANES of `buffers`.  A row of
the lane buffer is then 16 neighbouring doubles, and what a warp reads or writes of it, two whole
lines of 128 bytes.

A thread whose case is done takes the next of the queue, as a lane does on the CPU: cases differ
in cost by orders of magnitude, and a warp is as slow as its slowest thread.  A launch ends after
`budget` steps at the latest and what is under way stays in `buffers`; so the host can look up,
and no display driver loses patience.

Threads of a warp take steps of both methods, one kind after the other, and wait for those that see
to events.  That each does in its turn what most of its warp waits for was tried on an H100: it
costs more than it saves.

A kernel is made for one law, so that only that law's step is in it.  With both in it, and a
branch between them, it would have twice the code to keep in the instruction cache.
"""

import functools
from typing import Any

from numba import cuda as numba_cuda

from . import lanes as L
from . import return_events, return_lanes, return_map, return_taylor_lanes, taylor_lanes, waveform
from . import rows as R
from .events import handle_events
from .jit import inner
from .lane_case import IDLE
from .march import end_segment, finish, load
from .model import RUNNING
from .rows import OF_RODAS5P, rows_of
from .saving import save
from .step_control import control_step

cuda: Any = numba_cuda  # which of its two modules it is, is known at run time


@functools.cache
def vacating_kernel():
    """The kernel that leaves all lanes free."""

    @cuda.jit
    def vacate_on_gpu(buffers):
        s, l = place(buffers)
        s[R.CASE + l], s[R.HOME + l] = IDLE, l

    return vacate_on_gpu


@functools.cache
def march_kernel(law, taylor):
    """The kernel of `march.march` for this law.

    taylor : bool, whether steps may be of the Taylor method, if the law allows
    """

    @cuda.jit
    def march_on_gpu(
        buffers, queue, position, under_way, cases, loads, save_times, results, budget
    ):
        """March the cases of a queue.

        Parameters
        ----------
        buffers : (rows, size) the lanes; CASE = IDLE in those that are free
        queue : (n,) case numbers, in the order in which to start them
        position : (2,) int64: next in queue; cases done
        under_way : (1,) to which the fractions done of unfinished cases are added
        budget : int, steps a thread
        """
        s, l = place(buffers)
        for _ in range(budget):
            if s[R.CASE + l] == IDLE:
                n = cuda.atomic.add(position, 0, 1)
                if n >= queue.size:
                    return
                load(s, l, law, queue[n], cases, loads, save_times, results)
            try_step(rows_of(law).c[0], s, l, law, taylor)
            L.has_event(s, l, law)
            if s[R.CALL + l] > 0.0:
                handle_events(s, l, law)
                if L.saves(s, l):
                    save(s, l, law, cases, save_times, results.saved)
            L.commit_lane(s, l, law)
            if s[R.BREAK + l] > 0.0:
                end_segment(s, l, law, cases, loads, save_times, results.saved)
                if s[R.STATUS + l] != RUNNING:
                    finish(s, l, law, cases, results)
                    cuda.atomic.add(position, 1, 1)
            change_method(s, l)
        if s[R.CASE + l] != IDLE:
            cuda.atomic.add(under_way, 0, s[R.T + l] / s[R.T_END + l])

    return march_on_gpu


@functools.cache
def return_kernel(law):
    """The kernel of `return_map.march_to_section` for this law."""

    @cuda.jit
    def return_map_on_gpu(buffers, queue, position, under_way, starts, results, budget):
        """Take the cases of a queue to their next upward crossing of the section.

        Parameters as for `march_on_gpu`; how far an unfinished case has come is not known.
        """
        s, l = place(buffers)
        for _ in range(budget):
            if s[R.CASE + l] == IDLE:
                n = cuda.atomic.add(position, 0, 1)
                if n >= queue.size:
                    return
                return_map.load(s, l, law, queue[n], starts)
            try_step_of_return(rows_of(law).c[0], s, l, law)
            L.has_event(s, l, law)
            waveform.find_slow(s, l)
            if s[R.CALL + l] > 0.0:
                return_events.handle_events(s, l, law)
            L.commit_lane(s, l, law)
            return_lanes.commit_lane(s, l, law)
            if s[R.GUESS + l] > 0.0:
                add_to_waveform(s, l, law)
            if s[R.BREAK + l] > 0.0:
                return_map.finish(s, l, law, results)
                cuda.atomic.add(position, 1, 1)
            change_method(s, l)

    return return_map_on_gpu


@inner
def place(buffers):
    """The lane buffer and the lane of this thread.

    That the lane is no negative number is to be seen, or each index is tested for that.
    """
    t = cuda.grid(1)
    return buffers[t // R.LANES], t & (R.LANES - 1)


@inner
def try_step(rows, s, l, law, taylor):
    """Try one step of the lane, and see by which method the next one is.

    rows : of the coefficients of x; by their number the compiler leaves out the Taylor method where
        the law has no recurrences, but only if `OF_RODAS5P` is a name of this module
    """
    if len(rows) > OF_RODAS5P and s[R.TAYLOR + l] > 0.0:
        taylor_lanes.try_step(s, l, law)
    else:
        L.try_step(s, l, law)
        assess(rows, s, l, law, taylor)


@inner
def try_step_of_return(rows, s, l, law):
    """`try_step` of a return map."""
    if len(rows) > OF_RODAS5P and s[R.TAYLOR + l] > 0.0:
        return_taylor_lanes.try_step(s, l, law)
    else:
        return_lanes.try_step(s, l, law)
        assess(rows, s, l, law, True)


@inner
def assess(rows, s, l, law, taylor):
    """Accept a step of Rodas5P or not, and see whether the Taylor method takes the next one."""
    control_step(s, l)
    if len(rows) > OF_RODAS5P and taylor:
        taylor_lanes.find_calm(s, l, law)


@inner
def add_to_waveform(s, l, law):
    """`waveform.add_step`, of a step of either method."""
    rows = rows_of(law).c[0]
    if s[R.TAYLOR + l] > 0.0:
        waveform.add_step(s, l, rows)
    else:
        waveform.add_step(s, l, rows[:OF_RODAS5P])


@inner
def change_method(s, l):
    """Let the lane's next step be of the other method where it is to."""
    if s[R.CHANGES + l] > 0.0:
        s[R.TAYLOR + l] = 1.0 - s[R.TAYLOR + l]
        s[R.CHANGES + l] = 0.0
