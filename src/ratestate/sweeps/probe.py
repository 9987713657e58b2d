"""What a case of a sweep costs, and so how many of them make a chunk."""

import contextlib
import math
import threading
import time

import numpy as np

from ..engine import backend
from ..engine.rows import LANES
from ..errors import RateStateError
from ..model.arrays import cut
from .solve import bytes_of_a_case, solve

# Cases to try, spread over the sweep; seconds after which to be content with a part of them.
SAMPLE = 256
BUDGET = 0.02
# A chunk: seconds that it takes, at least (below, overhead shows) and at most (what a pulled plug
# costs); how many each worker gets of a long sweep; its bytes.
SECONDS = (1.0, 10.0)
SHARE = 16
MOST_BYTES = 1 << 27
# Lanes run empty towards the end of a chunk: in one of 8 times as many cases, by a tenth.  Where
# that takes longer than this [s], fewer must do, but no fewer than there are lanes.
FULL = 8 * LANES
LONGEST = 600.0
# A GPU works on this many at once.
CASES_ON_GPU = 1 << 17


def seconds_of_a_case(sample, kinds):
    """What a case costs on one core, by a sample, or what can be done of it.

    Up to five times too much where costs differ, since the most costly cases come first.
    """
    stop, begin, done = threading.Event(), time.thread_time(), 1.0

    def look(fraction):
        nonlocal done
        if fraction > 0.0 and time.thread_time() - begin > BUDGET:
            done = fraction
            stop.set()

    with backend.use(threads=1, stop=stop), contextlib.suppress(backend.Stopped):
        solve(sample, kinds, progress=look)
    return (time.thread_time() - begin) / (done * sample.batch.n)


def spread(sizes, most):
    """Places of about so many cases all over a sweep: dimension -> list of indices."""
    left, places = float(most), {}
    for number, dim in enumerate(sorted(sizes, key=sizes.__getitem__)):
        side = max(1, round(left ** (1.0 / (len(sizes) - number))))
        count = min(side, sizes[dim])
        places[dim] = np.unique(np.linspace(0, sizes[dim] - 1, count).round().astype(int)).tolist()
        left /= count
    return places


def cases_of_a_chunk(call, kinds, workers, together, device, run):
    """How many cases make a chunk.

    Of a long sweep each worker gets several.

    kinds : of the variables
    workers : how many there are, each with one core
    together : whether all of them can do one chunk, which keeps their lanes full in a small sweep
    run : callable of a function and its arguments, which says where
    """
    n = call.batch.n
    fits = max(1, MOST_BYTES // bytes_of_a_case(kinds))
    if device == "cuda":
        return min(n, CASES_ON_GPU, fits)
    sample = cut(call, spread(call.batch.sizes, min(SAMPLE, fits)))
    try:
        a_case = run(seconds_of_a_case, sample, kinds)
    except RateStateError:
        raise
    except Exception:  # a case of the sample took its worker down; what it costs is not known
        a_case = LONGEST
    a_case = max(a_case, 1e-9)
    full = float(np.clip(LONGEST / a_case, LANES, FULL))
    total = n * a_case
    if together and n < 2 * workers * full:
        return min(n, fits, math.ceil(LONGEST * workers / a_case))
    seconds = float(np.clip(total / (SHARE * workers), *SECONDS))
    number = workers * math.ceil(total / (seconds * workers))
    return min(n, fits, math.ceil(max(n / number, full)))
