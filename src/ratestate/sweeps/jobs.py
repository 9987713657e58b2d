"""The SLURM jobs of a sweep: lost ones are replaced, and an error says when no more will come.

dask-jobqueue has ``adapt()`` for this, which (0.9, with distributed 2026.8) replaces no job of
several processes, nor one that ends before its worker comes; submits jobs that fail at once
without end; and cancels some that still wait.  So SLURM itself is asked what became of them.
"""

import subprocess
import sys
import time
from typing import NamedTuple

from ..errors import SolverError

#: states of a job that has ended, as squeue(1) calls them; in all others it may still work
ENDED = (
    *("BOOT_FAIL", "CANCELLED", "COMPLETED", "DEADLINE", "FAILED", "NODE_FAIL", "OUT_OF_MEMORY"),
    *("PREEMPTED", "REVOKED", "TIMEOUT"),
)
# Seconds between two questions to SLURM; the same where a chunk waits for the answer, which is
# not waited for longer than this; until squeue is thought to hang.
POLL, SOON, LONGEST, HANGS = 15.0, 1.0, 60.0, 20.0
# Jobs in a row that end before a worker comes, until no more are submitted.
FRUITLESS = 3
RESUME = "what is stored is whole: run the same sweep again to go on"


class State(NamedTuple):
    """What SLURM says of a job."""

    name: str
    reason: str

    def __str__(self):
        return self.name if self.reason in ("", "None") else f"{self.name}, {self.reason}"


def squeue(ids):
    """Job id -> `State`, as far as SLURM knows these jobs; None if it does not answer."""
    command = ["squeue", "--noheader", "--states=all", "--format=%i|%T|%r"]
    command.append("--jobs=" + ",".join(ids))
    try:
        answer = subprocess.run(command, capture_output=True, text=True, check=False, timeout=HANGS)
    except (OSError, subprocess.TimeoutExpired):
        return None
    if answer.returncode:  # it does so, too, if it knows none of them
        return {} if "Invalid job id" in answer.stderr else None
    rows = (line.strip().split("|") for line in answer.stdout.splitlines() if line.strip())
    return {job: State(*rest) for job, *rest in rows}


class Jobs:
    """Keeps a `ratestate.sweeps.slurm.SweepCluster` at its number of jobs.

    Parameters
    ----------
    cluster : SweepCluster
    number : int
        Of jobs at a time.
    replacements : int
        Jobs that may be submitted, in all, for such as are lost.
    wait : float
        Seconds without any worker after which to give up.
    """

    def __init__(self, cluster, number, replacements, wait):
        self.cluster, self.number, self.wait = cluster, number, wait
        self.replacements = self.left = replacements
        self.job_of: dict[str, str] = {}  # address of a worker -> id of its job
        self.states: dict[str, State] = {}  # id of a job -> what SLURM last said of it
        self.fruitless, self.last = 0, ""
        self.asked, self.answered, self.hurry = -POLL, -POLL, False
        self.served = time.monotonic()  # when there was a worker

    @property
    def threads(self):
        """How many threads all jobs have together."""
        return self.number * self.cluster.new_spec["options"]["cores"]

    def submit(self):
        """Submit the jobs."""
        self.cluster.scale(jobs=self.number)

    def has_ended(self, address, died):
        """Whether the job of a worker that died at this time has ended; None: not known yet."""
        job = self.job_of.get(address)
        if job is None or time.monotonic() - died > LONGEST:
            return False
        if self.states.get(job, State("", "")).name in ENDED:
            return True
        if self.answered > died:
            return False
        self.hurry = True
        return None

    def keep(self):
        """Replace those that are lost; called every second while there is work.

        Raises
        ------
        SolverError
            There is no worker, and none will come.
        """
        now = time.monotonic()
        self._meet_workers(now)
        if now - self.asked < (SOON if self.hurry else POLL):
            return
        self.asked, self.hurry = now, False
        if lost := self._lost(now):
            self.cluster.sync(self.cluster.scale_down, list(lost))
        self._replace(list(lost.values()))
        if not self.cluster.worker_spec:
            raise SolverError(self._none_left())
        if now - self.served > self.wait:
            raise SolverError(
                f"no worker for {self.wait:.0f} s: {self._waiting()}; ask for less in a job, or "
                f"another queue, or wait longer (wait=1-00:00:00 is a day); {RESUME}"
            )

    def _meet_workers(self, now):
        """Take note of the workers there are."""
        ids = {name: job.job_id for name, job in list(self.cluster.workers.items())}
        known = set(self.job_of.values())
        for address, worker in list(self.cluster.scheduler.workers.items()):
            # of several in a job each has a number
            job = ids.get(worker.name) or ids.get(str(worker.name).rpartition("-")[0])
            if job:
                self.job_of[address] = job
            self.served = now
        if set(self.job_of.values()) - known:
            self.fruitless = 0

    def _lost(self, now):
        """Dask's name -> (id, why) of the jobs that are lost."""
        jobs = list(self.cluster.workers.items())
        lost = {name: ("", job.refused) for name, job in jobs if job.refused}
        ids = {name: job.job_id for name, job in jobs if job.job_id}
        found = squeue(ids.values()) if ids else {}
        if found is None:
            return lost
        self.answered = now
        # SLURM forgets a job some minutes after its end.
        gone = {job: State("COMPLETED", "forgotten") for job in self.states.keys() - found.keys()}
        self.states = gone | found
        for name, job in ids.items():
            state = self.states.get(job)
            if state and state.name in ENDED:
                lost[name] = job, str(state)
        return lost

    def _replace(self, lost):
        """Submit others for jobs that were lost, now or before, as far as that makes sense."""
        served = set(self.job_of.values())
        self.fruitless += sum(job not in served for job, _ in lost)
        self.left += sum(not job for job, _ in lost)  # such as were refused have cost nothing
        missing = self.number - len(self.cluster.worker_spec)
        more = 0 if self.fruitless >= FRUITLESS else min(missing, self.left)
        if not (lost or more):
            return
        self.left -= more
        self.cluster.scale(jobs=len(self.cluster.worker_spec) + more)
        words = [f"job {job} ({why})" if job else f"one refused ({why})" for job, why in lost]
        self.last = words[-1] if words else self.last
        why = f"SLURM jobs lost: {', '.join(words)}" if lost else "SLURM jobs bring workers again"
        say(f"{why}; {more} submitted instead; at most {self.left} more will be")

    def _none_left(self):
        """Why there are no jobs, and what to do."""
        if self.fruitless >= FRUITLESS:
            address = self.cluster.scheduler_address
            return (
                f"{self.fruitless} SLURM jobs in a row were lost before a worker came, at last "
                f"{self.last}; its log (slurm-ID.out, or in jobqueue.yaml's log-directory) may say "
                f"why: nodes need the same programs under the same paths, and must reach {address} "
                f"(interface=ib0 chooses another network); {RESUME}"
            )
        return (
            f"no SLURM job is left, the last was {self.last}, and all {self.replacements} "
            f"replacements are used up; {RESUME}, with a longer walltime or more replacements=N"
        )

    def _waiting(self):
        """The jobs that there are, and their states."""
        ids = [job.job_id for job in list(self.cluster.workers.values())]
        words = [f"job {job} ({self.states.get(job, 'unknown to squeue')})" for job in ids if job]
        return ", ".join(words) or "no job is submitted yet"


def say(text):
    """Write a line to stderr, if there is one."""
    if sys.stderr:
        sys.stderr.write(f"ratestate: {text}\n")
        sys.stderr.flush()
