"""dask-jobqueue's cluster of a batch system, with `Jobs` that are replaced.

It is imported late, since dask-jobqueue can be imported by the main thread only: not by workers.
"""

import dask_jobqueue
from dask_jobqueue.core import Job as DaskJob
from dask_jobqueue.core import JobQueueCluster
from distributed.core import Status
from distributed.deploy.spec import SpecCluster

from .jobs import Jobs


class Job(DaskJob):
    """A job that knows why it was refused ("" if it was not); Dask would only log that."""

    refused = ""

    async def start(self):
        """Submit it; raises nothing if it is refused, which `refused` then says."""
        try:
            await super().start()
        except (RuntimeError, ValueError, OSError) as error:
            # dask-jobqueue quotes the whole call; the message of the command comes last
            self.refused = "; ".join(str(error).rpartition("stderr:")[-1].strip().splitlines())
            self.status = Status.running  # as Dask expects


class SweepCluster(JobQueueCluster):
    """Jobs with Dask workers; kept at their number by `Jobs`."""

    def __init__(self, system, jobs, replacements, wait, **settings):
        # Dask's log of workers that die is silenced: `Jobs` has better messages.
        super().__init__(**settings, silence_logs="critical")
        self.jobs = Jobs(system, self, jobs, replacements, wait)

    def _update_worker_status(self, op, msg):
        # `SpecCluster` would cancel a job whose only worker died and did not return within 15 s.
        super(SpecCluster, self)._update_worker_status(op, msg)


def sweep_cluster(system, **settings):
    """A `SweepCluster` of this `BatchSystem`, without jobs yet.

    settings : of `SweepCluster`, and those of dask-jobqueue, which raises for wrong ones
    """
    base = getattr(dask_jobqueue, system.dask_class)
    job = type("Job", (Job, base.job_cls), {})
    return type("SweepCluster", (SweepCluster, base), {"job_cls": job})(system, **settings)
