"""What a case of a sweep costs, and so how many of them make a chunk."""

import contextlib
import math
import threading
import time
from typing import NamedTuple

import numpy as np

from ..arrays import cut
from ..engine import drive
from ..errors import RateStateError
from .solve import bytes_of_a_case, kinds_of, solve

# Cases to try, spread over the sweep.
SAMPLE = 256
# Cases to try until one ends without an error.
TRIALS = 8
# Seconds after which to be content with a part of them.
BUDGET = 0.05
# A chunk: seconds that it takes, at least (below, overhead shows) and at most (what a pulled plug
# costs); how many each worker gets of a long sweep; its cases; its bytes.
SECONDS = (1.0, 10.0)
SHARE = 16
MOST_CASES = 1 << 15
MOST_BYTES = 1 << 26
# A GPU works on this many at once.
CASES_ON_GPU = 1 << 17


class Form(NamedTuple):
    """What the result of a sweep is like."""

    kinds: dict  # variable -> `Kind`
    static: dict  # those variables that are common to all cases


def form_of(call, run):
    """`Form` of a call's result, by one of its cases; compiles the kernels where needed.

    run : callable of a function and its arguments, which says where
    """
    dims, sizes = call.batch.dims, call.batch.sizes
    for trial in range(TRIALS):
        # the first case, and if that raises, others up to the last
        at = {dim: trial * (n - 1) // (TRIALS - 1) for dim, n in sizes.items()}
        try:
            found = run(solve, cut(call, {dim: slice(i, i + 1) for dim, i in at.items()}))
        except (drive.Stopped, RateStateError):
            raise
        except Exception:
            if trial == TRIALS - 1:
                raise
        else:
            break
    static = {name: v for name, v in found.items() if not set(v.dims) & set(dims)}
    return Form(kinds_of(found, dims), static)


def seconds_of_a_case(sample, kinds):
    """What a case costs on one core, by a sample, or what can be done of it.

    An upper bound where costs differ, since the most costly cases come first.
    """
    stop, begin, done = threading.Event(), time.perf_counter(), 1.0

    def look(fraction):
        nonlocal done
        if fraction > 0.0 and time.perf_counter() - begin > BUDGET:
            done = fraction
            stop.set()

    with drive.place(threads=1, stop=stop), contextlib.suppress(drive.Stopped):
        solve(sample, kinds, progress=look)
    return (time.perf_counter() - begin) / (done * sample.batch.n)


def spread(sizes):
    """Places of about `SAMPLE` cases all over a sweep: dimension -> list of indices."""
    left, places = float(SAMPLE), {}
    for number, dim in enumerate(sorted(sizes, key=sizes.__getitem__)):
        side = max(1, round(left ** (1.0 / (len(sizes) - number))))
        count = min(side, sizes[dim])
        places[dim] = np.unique(np.linspace(0, sizes[dim] - 1, count).round().astype(int)).tolist()
        left /= count
    return places


def cases_of_a_chunk(call, form, workers, least, device, run):
    """How many cases make a chunk.

    Of a long sweep each worker gets several.

    workers : how many there are, each with one core
    least : number of chunks of a sweep of a few seconds
    run : as for `form_of`
    """
    n = call.batch.n
    fits = MOST_BYTES // max(1, bytes_of_a_case(form.kinds))
    if device == "cuda":
        return max(1, min(n, CASES_ON_GPU, fits))
    number = SHARE * workers
    sample = cut(call, spread(call.batch.sizes))
    try:
        total = run(seconds_of_a_case, sample, form.kinds) * n
    except RateStateError:
        raise
    except Exception:  # a case of the sample took its worker down; what it costs is not known
        total = math.inf
    if total < 2.0 * workers * SECONDS[0]:
        number = least
    elif total < math.inf:
        seconds = float(np.clip(total / (SHARE * workers), *SECONDS))
        number = workers * math.ceil(total / (seconds * workers))
    return max(1, min(math.ceil(n / number), MOST_CASES, fits))
