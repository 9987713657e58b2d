"""dask-jobqueue's SLURM cluster with `Jobs` that are replaced.

It stands alone, since dask-jobqueue can be imported by the main thread only: not by workers.
"""

from dask_jobqueue.slurm import SLURMCluster, SLURMJob
from distributed.core import Status
from distributed.deploy.spec import SpecCluster

from .slurm_jobs import Jobs


class Job(SLURMJob):
    """A job that knows why SLURM refused it; Dask would only log that."""

    refused = ""

    async def start(self):
        """Submit it."""
        try:
            await super().start()
        except (RuntimeError, ValueError, OSError) as error:
            # dask-jobqueue quotes the whole call; the message of sbatch comes last
            self.refused = "; ".join(str(error).rpartition("stderr:")[-1].strip().splitlines())
            self.status = Status.running  # as Dask expects


class SweepCluster(SLURMCluster):
    """SLURM jobs with Dask workers; kept at their number by `Jobs`."""

    job_cls = Job

    def __init__(self, jobs, replacements, wait, **settings):
        # Dask's log of workers that die is silenced: `Jobs` has better messages.
        super().__init__(**settings, silence_logs="critical")
        self.jobs = Jobs(self, jobs, replacements, wait)

    def _update_worker_status(self, op, msg):
        # `SpecCluster` would cancel a job whose only worker died and did not return within 15 s.
        super(SpecCluster, self)._update_worker_status(op, msg)
