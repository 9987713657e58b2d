"""Where a sweep runs if not here: on the workers of a Dask cluster, of which any may die."""

import itertools
from collections import Counter

from ..errors import RateStateError, SolverError
from ..model.arrays import isel
from . import sentence
from .cluster_work import jobs_of, working
from .subprocesses import SubprocessTasks

# Chunks under way for each thread of the cluster, so that no thread waits for its next one.
AHEAD = 2
# Workers that may die with a chunk: the first, and those that then solve it in a subprocess.
MOST_DEATHS = 4


class Cluster:
    """The workers of a Dask cluster, as a backend of a sweep: see `task.Threads`."""

    shared = False

    def __init__(self, client, device):
        self.client, self.device = client, device

    @property
    def thread_count(self):
        """Number of threads that the cluster has or, with jobs, will have; at least 1."""
        jobs = jobs_of(self.client)
        return max(1, jobs.thread_count if jobs else sum(self.client.nthreads().values()))

    def run(self, function, *arguments):
        """Have a worker call a function, with kernels on one thread, and return its result.

        An error of ratestate's own in the function is raised here.  SolverError for any other,
        and where the cluster is lost; KilledWorker where the function kills several workers.
        """
        with working(self.client, self.device) as work:
            work.send(0, function, *arguments)
            while not (ended := work.finished()):
                work.thread_count()
            return _result_of(ended[0][1])

    def outcomes(self, tasks, call, numbers, report, processor):
        """Solve the chunks with these numbers; yield each `Outcome` when it is ready.

        All workers must have this kind of processor, if it is not None, else StoreError.  A chunk
        whose worker died is solved again by `SubprocessTasks`, where it cannot kill the worker; one
        whose worker ended with its job is simply solved again.  SolverError where workers die with
        one chunk more than `MOST_DEATHS` times, and where the cluster is lost.
        """
        from distributed import KilledWorker

        waiting, deaths = iter(numbers), Counter[int]()

        def send(i):
            how = SubprocessTasks(*tasks) if deaths[i] else tasks
            work.send(i, how.do, i, isel(call, tasks.chunks.slices(i)))

        def retry_in_subprocess(i):
            deaths[i] += 1
            if deaths[i] > MOST_DEATHS:
                raise SolverError(sentence("cluster.workers_die"))
            send(i)

        with working(self.client, self.device, processor) as work:
            while True:
                free = AHEAD * max(1, work.thread_count()) - len(work.under_way)
                for i in itertools.islice(waiting, max(0, free)):
                    send(i)
                if not work.unfinished:
                    return
                for i, job_ended in work.lost_tasks():
                    send(i) if job_ended else retry_in_subprocess(i)
                for i, answer in work.finished():
                    try:
                        outcome = _result_of(answer)
                    except KilledWorker:  # it killed several before their deaths were noted here
                        retry_in_subprocess(i)
                    else:
                        yield outcome
                report.refresh()


def _result_of(answer):
    """The result of a task that has ended; what it raised but should not becomes a SolverError."""
    from distributed import CancelledError, KilledWorker

    try:
        return answer.result()
    except (RateStateError, CancelledError, KilledWorker):
        raise
    except Exception as error:
        what = f"{type(error).__name__}: {error}"
        raise SolverError(sentence("cluster.worker", error=what)) from error
