"""Chunks of a sweep: blocks of cases that one task solves, and how many cases they have.

A chunk has one file for each variable in a store.  The number of cases follows from the cost of a
case, which is measured on a sample of the sweep.
"""

import contextlib
import dataclasses
import math
import threading
import time

import numpy as np

from ..engine import backend
from ..engine.rows import LANES
from ..model.arrays import isel
from .solve import bytes_per_case, solve

# Number of cases in the sample; seconds of computing after which a part of it is enough.
SAMPLE, BUDGET = 256, 0.02
# Shortest and longest time of a chunk [s]: below, overhead shows; a power failure costs the other.
SECONDS = (1.0, 10.0)
# Chunks for each worker in a long sweep; largest size of a chunk in bytes.
CHUNKS_PER_WORKER, MOST_BYTES = 16, 1 << 27
# Towards the end of a chunk lanes idle: a tenth of the time if it has 8 times as many cases as
# there are lanes.  A chunk has so many, or fewer if they take longer than LONGEST [s], but never
# fewer cases than lanes.
CASES_TO_FILL_LANES, LONGEST = 8 * LANES, 600.0
# A GPU works on this many cases in parallel.
CASES_ON_GPU = 1 << 17


@dataclasses.dataclass(frozen=True)
class Chunks:
    """Blocks that make up a sweep, of equal shape except for the last along each dimension."""

    sizes: dict  # dimension -> number of values
    shape: tuple  # number of values in a chunk along each dimension

    @property
    def counts(self):
        """Number of chunks along each dimension, a tuple."""
        return tuple(-(-n // k) for n, k in zip(self.sizes.values(), self.shape, strict=True))

    @property
    def number(self):
        return math.prod(self.counts)

    def index(self, i):
        """Return the index of chunk i along each dimension; ValueError without chunk i."""
        return tuple(map(int, np.unravel_index(i, self.counts)))

    def slices(self, i):
        """Return the cases of chunk i: dimension -> slice."""
        parts = zip(self.sizes.items(), self.shape, self.index(i), strict=True)
        return {dim: slice(k * m, min((k + 1) * m, n)) for (dim, n), m, k in parts}

    def cases(self, i):
        """Return the number of cases in chunk i."""
        return math.prod(part.stop - part.start for part in self.slices(i).values())

    def blocks(self, i, dims):
        """Return which blocks of variables chunk i writes: name -> index of the block.

        If a variable lacks some dimensions of the sweep, the first chunk along these writes its
        block.  If it lacks all of them, no chunk does.

        dims : name of a variable -> its dimensions
        """
        index = dict(zip(self.sizes, self.index(i), strict=True))
        blocks = {}
        for name, own_dims in dims.items():
            shared = index.keys() & {*own_dims}
            if shared and not any(index[dim] for dim in index.keys() - shared):
                blocks[name] = tuple(index.get(dim, 0) for dim in own_dims)
        return blocks


def chunks_of(sizes, most):
    """Return `Chunks` of at most `most` cases, contiguous in memory; `most` and sizes are >= 1.

    Trailing dimensions are whole, one is divided into about equal parts, and along leading ones a
    chunk has a single value.
    """
    shape: list = []
    for n in reversed(sizes.values()):
        fits = max(1, min(n, most // math.prod(shape)))
        shape.insert(0, -(-n // -(-n // fits)))
    return Chunks(dict(sizes), tuple(shape))


def seconds_per_case(sample, specs):
    """Return the time that a case takes on one core [s], measured until `BUDGET` is spent.

    The answer may be five times too large if costs differ, because the slowest cases come first.

    sample : call of a part of the sweep; specs : variable -> `VariableSpec`
    """
    stop, begin, done = threading.Event(), time.thread_time(), 1.0

    def watch(fraction):
        nonlocal done
        if fraction > 0.0 and time.thread_time() - begin > BUDGET:
            done = fraction
            stop.set()

    with backend.use(threads=1, stop=stop), contextlib.suppress(backend.Stopped):
        solve(sample, specs, progress=watch)
    return (time.thread_time() - begin) / (done * sample.batch.n)


def sample_of(call, most):
    """Return at most `most` cases of a call, but one along each dimension, evenly spread."""
    side = max(1, int(most ** (1.0 / len(call.batch.sizes))))
    steps = {dim: slice(None, None, -(-n // side)) for dim, n in call.batch.sizes.items()}
    return isel(call, steps)


def cases_per_chunk(request):
    """Return how many cases a chunk should have, if `sweep` was not given a number.

    In a long sweep each thread gets several chunks.  In a small sweep on threads of this process,
    which can share a chunk, the number keeps their lanes full.
    """
    workers = request.backend.thread_count
    batch, specs = request.call.batch, request.form.specs
    n, fits = batch.n, max(1, MOST_BYTES // bytes_per_case(specs))
    if request.device == "cuda":
        return min(n, CASES_ON_GPU, fits)
    sample = sample_of(request.call, min(SAMPLE, fits))
    case_seconds = max(request.backend.run(seconds_per_case, sample, specs), 1e-9)
    full_chunk = float(np.clip(LONGEST / case_seconds, LANES, CASES_TO_FILL_LANES))
    if request.backend.shared and n < 2 * workers * full_chunk:
        return min(n, fits, math.ceil(LONGEST * workers / case_seconds))
    seconds = float(np.clip(n * case_seconds / (CHUNKS_PER_WORKER * workers), *SECONDS))
    number = workers * math.ceil(n * case_seconds / (seconds * workers))
    return min(n, fits, math.ceil(max(n / number, full_chunk)))
