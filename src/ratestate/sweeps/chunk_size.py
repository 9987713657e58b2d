"""The cost of a case, measured on a sample of the sweep, and from it the size of chunks."""

import contextlib
import math
import threading
import time

import numpy as np

from ..engine import backend
from ..engine.rows import LANES
from ..errors import RateStateError
from ..model.arrays import isel
from .solve import bytes_per_case, solve

# Number of cases in the sample; seconds of computing after which a part of it is enough.
SAMPLE = 256
BUDGET = 0.02
# A chunk: how many seconds it takes, at least (below, overhead shows) and at most (what a power
# failure costs); how many chunks each worker gets in a long sweep; the largest size in bytes.
SECONDS = (1.0, 10.0)
CHUNKS_PER_WORKER = 16
MOST_BYTES = 1 << 27
# Towards the end of a chunk lanes idle: a tenth of the time if it has 8 times as many cases as
# there are lanes.  A chunk has so many, or fewer where they take longer than LONGEST [s], but
# never fewer cases than lanes.
CASES_TO_FILL_LANES = 8 * LANES
LONGEST = 600.0
# A GPU works on this many cases in parallel.
CASES_ON_GPU = 1 << 17


def seconds_per_case(sample, specs):
    """Seconds that a case takes on one core, measured on as much of a sample as `BUDGET` allows.

    Up to five times too much where costs differ, since the most costly cases come first.

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


def sample_indices(sizes, most):
    """Indices of about `most` cases, evenly spread over a sweep: dimension -> list of indices.

    At least one along each dimension.
    """
    left, indices = float(most), {}
    for number, dim in enumerate(sorted(sizes, key=sizes.__getitem__)):
        side = max(1, round(left ** (1.0 / (len(sizes) - number))))
        count = min(side, sizes[dim])
        indices[dim] = np.unique(np.linspace(0, sizes[dim] - 1, count).round().astype(int)).tolist()
        left /= count
    return indices


def cases_per_chunk(request):
    """How many cases a chunk should have, an int >= 1, where `sweep` was not given a number.

    In a long sweep each thread gets several chunks.  Where all can share one, this keeps their
    lanes full in a small sweep.
    """
    backend, workers = request.backend, request.backend.thread_count
    batch, specs = request.call.batch, request.form.specs
    n, fits = batch.n, max(1, MOST_BYTES // bytes_per_case(specs))
    if request.device == "cuda":
        return min(n, CASES_ON_GPU, fits)
    sample = isel(request.call, sample_indices(batch.sizes, min(SAMPLE, fits)))
    try:
        case_seconds = max(backend.run(seconds_per_case, sample, specs), 1e-9)
    except RateStateError:
        raise
    except Exception:  # a case of the sample killed its worker, so the cost is unknown
        case_seconds = LONGEST
    full = float(np.clip(LONGEST / case_seconds, LANES, CASES_TO_FILL_LANES))
    if backend.shared and n < 2 * workers * full:
        return min(n, fits, math.ceil(LONGEST * workers / case_seconds))
    seconds = float(np.clip(n * case_seconds / (CHUNKS_PER_WORKER * workers), *SECONDS))
    number = workers * math.ceil(n * case_seconds / (seconds * workers))
    return min(n, fits, math.ceil(max(n / number, full)))
