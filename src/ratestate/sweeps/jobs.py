"""The jobs of a sweep in a batch system: lost ones are replaced, until that is of no use.

dask-jobqueue has ``adapt()`` for this.  But (0.9, with distributed 2026.8) it replaces no job of
several processes, nor one that ends before its worker starts; it goes on submitting jobs that fail
at once; and it cancels some that still wait.  So the state of jobs is taken from the batch system.
"""

import time
from collections.abc import Callable
from typing import NamedTuple

from ..errors import SolverError
from . import sentence
from .progress import to_stderr

# Seconds between two queries of the batch system; the same where a chunk waits for the answer; how
# long it waits at most.
POLL, SOON, LONGEST = 15.0, 1.0, 60.0
# After so many jobs in a row that end before a worker starts no more are submitted.
FRUITLESS = 3


class State(NamedTuple):
    """State of a job according to its batch system."""

    name: str
    reason: str

    def __str__(self):
        return self.name if self.reason in ("", "None") else f"{self.name}, {self.reason}"


class BatchSystem(NamedTuple):
    """What is particular to a batch system."""

    name: str  # of the option, and of dask-jobqueue's configuration
    label: str  # in messages
    dask_class: str  # of dask-jobqueue
    submit: str  # the command
    test: str  # its option that only tests whether a job would be taken
    query: str  # the command that lists jobs
    log: str  # the file in which a job logs
    ended: list  # states of a job that has ended
    states: Callable  # ids -> {id: `State`}, or None if it does not answer


class Jobs:
    """Keeps a `SweepCluster` at its number of jobs.

    system : `BatchSystem`
    replacements : how many jobs may be submitted in all to replace lost ones
    wait : seconds without any worker after which to give up
    """

    def __init__(self, system, cluster, number, replacements, wait):
        self.system, self.cluster, self.number, self.wait = system, cluster, number, wait
        self.replacements = self.replacements_left = replacements
        self.job_of: dict[str, str] = {}  # address of a worker -> id of its job
        self.states: dict[str, State] = {}  # id of a job -> its last known state
        self.fruitless_jobs, self.last_loss = 0, ""
        self.last_query, self.last_answer, self.urgent = -POLL, -POLL, False
        self.last_worker = time.monotonic()  # last time that there was a worker

    @property
    def thread_count(self):
        """Number of threads of all jobs together."""
        return self.number * self.cluster.new_spec["options"]["cores"]

    def has_ended(self, address, died):
        """Whether the job of a worker that died at this time has ended; None: not yet known.

        False also if the worker's job is not known, or no answer came for a minute.

        address : of the worker; died : by `time.monotonic`
        """
        job = self.job_of.get(address)
        if job is None or time.monotonic() - died > LONGEST:
            return False
        if self.states.get(job, State("", "")).name in self.system.ended:
            return True
        if self.last_answer > died:
            return False
        self.urgent = True
        return None

    def maintain(self):
        """Replace lost jobs; called every second while there is work.

        SolverError if no job is left and none will be submitted, or there was no worker for `wait`.
        """
        now = time.monotonic()
        self._note_workers(now)
        if now - self.last_query < (SOON if self.urgent else POLL):
            return
        self.last_query, self.urgent = now, False
        if lost := self._lost(now):
            self.cluster.sync(self.cluster.scale_down, list(lost))
        self._replace(list(lost.values()))
        if not self.cluster.worker_spec:
            values = {"last_loss": self.last_loss, "replacements": self.replacements}
            values |= {"jobs": self.fruitless_jobs, "address": self.cluster.scheduler_address}
            values |= {"system": self.system.label, "log": self.system.log}
            name = "used_up" if self.fruitless_jobs < FRUITLESS else "fruitless"
            raise SolverError(sentence(f"jobs.{name}", **values))
        if now - self.last_worker > self.wait:
            raise SolverError(sentence("jobs.no_worker", wait=self.wait, jobs=self._waiting()))

    def _note_workers(self, now):
        """Note the job of each worker."""
        ids = {name: job.job_id for name, job in list(self.cluster.workers.items())}
        known = set(self.job_of.values())
        for address, worker in list(self.cluster.scheduler.workers.items()):
            # if a job has several workers, their names end in a number
            job = ids.get(worker.name) or ids.get(str(worker.name).rpartition("-")[0])
            if job:
                self.job_of[address] = job
            self.last_worker = now
        if set(self.job_of.values()) - known:
            self.fruitless_jobs = 0

    def _lost(self, now):
        """Dask's name -> (id, reason), for the jobs that are lost."""
        jobs = list(self.cluster.workers.items())
        lost = {name: ("", job.refused) for name, job in jobs if job.refused}
        ids = {name: job.job_id for name, job in jobs if job.job_id}
        states = self.system.states(ids.values()) if ids else {}
        if states is None:
            return lost
        self.last_answer = now
        # A batch system forgets a job some minutes after its end.
        ended = self.system.ended
        gone = {job: State("COMPLETED", "forgotten") for job in self.states.keys() - states.keys()}
        self.states = gone | states
        known = {name: (job, self.states[job]) for name, job in ids.items() if job in self.states}
        return lost | {
            name: (job, str(state)) for name, (job, state) in known.items() if state.name in ended
        }

    def _replace(self, lost):
        """Submit replacements for jobs lost now or before, while that makes sense."""
        with_worker = set(self.job_of.values())
        self.fruitless_jobs += sum(job not in with_worker for job, _ in lost)
        self.replacements_left += sum(not job for job, _ in lost)  # refused jobs do not count
        missing = self.number - len(self.cluster.worker_spec)
        more = 0 if self.fruitless_jobs >= FRUITLESS else min(missing, self.replacements_left)
        if not (lost or more):
            return
        self.replacements_left -= more
        self.cluster.scale(jobs=len(self.cluster.worker_spec) + more)
        losses = [f"job {job} ({why})" if job else f"one refused ({why})" for job, why in lost]
        self.last_loss = losses[-1] if losses else self.last_loss
        what = {"losses": ", ".join(losses), "more": more, "left": self.replacements_left}
        what["system"] = self.system.label
        to_stderr("ratestate: " + sentence("jobs.lost" if lost else "jobs.hope", **what))

    def _waiting(self):
        """The submitted jobs and their states, for a message."""
        ids = [job.job_id for job in list(self.cluster.workers.values())]
        unknown = f"unknown to {self.system.query}"
        jobs = [f"job {job} ({self.states.get(job, unknown)})" for job in ids if job]
        return ", ".join(jobs) or "no job is submitted yet"
