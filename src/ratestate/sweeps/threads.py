"""Chunks of a sweep on threads of this process; compiled code lets them run in parallel."""

import itertools
import threading
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait

from ..machine import cores
from ..model.arrays import cut


def outcomes(tasks, call, numbers, report):
    """Solve the chunks with these numbers; yield each `Outcome` when it is ready."""
    workers = max(1, min(cores(), len(numbers))) if tasks.device == "cpu" else 1
    threads = -(-cores() // workers)
    stop, queue = threading.Event(), iter(numbers)

    def work(i):
        part = cut(call, tasks.chunks.slices(i))
        return tasks.do(i, part, lambda fraction: report.part(i, fraction), threads, stop)

    pool = ThreadPoolExecutor(workers)
    try:
        pending = {pool.submit(work, i) for i in itertools.islice(queue, workers)}
        while pending:
            finished, pending = wait(pending, timeout=0.1, return_when=FIRST_COMPLETED)
            pending |= {pool.submit(work, i) for i in itertools.islice(queue, len(finished))}
            report.refresh()
            for future in finished:
                yield future.result()
    finally:
        stop.set()
        pool.shutdown(cancel_futures=True)
