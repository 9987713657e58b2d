"""A Dask cluster made of SLURM jobs, and the replacement of jobs that are lost.

dask-jobqueue submits the jobs.  Its ``adapt()`` (0.9, with distributed 2026.8) replaces no job of
several processes, nor one that ends before its worker starts.  So `Jobs` asks SLURM for the state
of jobs, and has dask-jobqueue submit others for those that have ended.
"""

import contextlib
import re
import subprocess
import time
from typing import Any

from ..errors import ParameterError, SolverError
from . import sentence
from .cluster import Cluster, import_extra
from .progress import to_stderr

#: options of `Jobs`, and those passed to dask-jobqueue under the same name
OF_JOBS = ["jobs", "replacements", "wait"]
OF_A_JOB = "cores memory walltime queue account processes interface".split()
#: least values of those that are integers
LEAST = {"jobs": 1, "replacements": 0, "cores": 1, "processes": 1}
# Default replacements for each job; default time to wait for any worker.
REPLACEMENTS, WAIT = 10, "1-00:00:00"
#: states of a job that has ended, as squeue(1) calls them; in all others it may still work
ENDED = """BOOT_FAIL CANCELLED COMPLETED DEADLINE FAILED NODE_FAIL OUT_OF_MEMORY PREEMPTED
    REVOKED TIMEOUT""".split()
# Seconds between two queries of SLURM; until squeue is assumed to hang.
POLL, HANGS = 15.0, 20.0


@contextlib.contextmanager
def slurm_cluster(text, device):
    """Give the `Cluster` of new SLURM jobs, which are cancelled in the end; see `job_cluster`."""
    distributed = import_extra("distributed")
    with job_cluster(text) as workers, distributed.Client(workers) as client:
        yield Cluster(client, device, Jobs(workers, _options(text)))


def job_cluster(text):
    """Return dask-jobqueue's cluster of SLURM jobs, of which none is submitted.

    Options that are not given, and whatever else jobs need, are read from dask-jobqueue's own
    configuration.  ``job_script()`` of the cluster shows what the jobs run.  ParameterError for
    options that are wrong or missing, or if dask-jobqueue is not installed or refuses them.

    text : options such as "jobs=10,cores=16,memory=32GB"
    """
    import_extra("dask_jobqueue")
    import dask
    from dask_jobqueue.slurm import SLURMCluster, SLURMJob
    from distributed.core import Status

    class Job(SLURMJob):
        """A job that says why sbatch refused it, and that is closed once it was cancelled.

        Dask closes no cluster with a job that could not start, or that is still "running".
        """

        refused = ""

        async def start(self):
            try:
                await super().start()
            except (RuntimeError, ValueError, OSError) as error:
                # dask-jobqueue quotes the whole call; the message of sbatch comes last
                self.refused = str(error).rpartition("stderr:")[-1].strip()
                self.status = Status.running  # as Dask expects

        async def close(self):
            await super().close()
            self.status = Status.closed

    options = {key: value for key, value in _options(text).items() if key not in OF_JOBS}
    # Another sweep may have the usual port.
    scheduler = dask.config.get("jobqueue.slurm.scheduler-options")
    options |= {"scheduler_options": {"dashboard_address": ":0"} | scheduler, "job_cls": Job}
    try:
        return SLURMCluster(**options)
    except (ValueError, OSError, RuntimeError) as error:
        raise _refusal("no_cluster", text=text, error=error) from error


def _options(text):
    """Return the options in a string, of the site, and by default: name -> value."""
    import_extra("dask_jobqueue")  # this also loads its configuration
    from dask import config, utils

    site = config.get("jobqueue.slurm")
    options: dict[str, Any] = {"jobs": 1, "wait": WAIT}
    options |= {key: site[key] for key in ("cores", "memory", "processes") if site.get(key)}
    if not isinstance(text, str):
        raise _refusal("text", text=text)
    for item in re.split(r",(?=\s*\w+\s*=)", text):  # values may hold commas
        key, equals, value = (part.strip() for part in item.partition("="))
        if not equals or not value or key not in {*OF_JOBS, *OF_A_JOB}:
            raise _refusal("key", item=item, keys=", ".join([*OF_JOBS, *OF_A_JOB]))
        options[key] = value
    for key in LEAST.keys() & options.keys():
        if not (str(options[key]).isdecimal() and int(options[key]) >= LEAST[key]):
            raise _refusal("integer", key=key, value=options[key], least=LEAST[key])
        options[key] = int(options[key])
    if missing := [key for key in ("cores", "memory") if key not in options]:
        raise _refusal("missing", keys=" and ".join(missing))
    try:
        utils.parse_bytes(options["memory"])
    except (ValueError, TypeError):
        raise _refusal("memory", memory=options["memory"]) from None
    if not re.fullmatch(r"(\d+-)?\d+:\d+:\d+", options["wait"]):
        raise _refusal("wait", wait=options["wait"])
    days, hours, minutes, seconds = map(int, re.findall(r"\d+", f"0-{options['wait']}")[-4:])
    options["wait"] = 86400.0 * days + 3600.0 * hours + 60.0 * minutes + seconds
    default = {"replacements": REPLACEMENTS * options["jobs"], "processes": options["cores"]}
    options = default | options
    if options["cores"] % options["processes"]:
        raise _refusal("processes", **options)
    return options


def _refusal(why, **values):
    return ParameterError(sentence(f"slurm.{why}", **values))


class Jobs:
    """Keeps a cluster of `job_cluster` at its number of jobs, which it submits.

    Lost jobs are replaced once any worker has come: without, all jobs would fail in the same way.
    """

    def __init__(self, cluster, options):
        self.cluster, self.number, self.wait = cluster, options["jobs"], options["wait"]
        self.thread_count = options["jobs"] * options["cores"]
        self.replacements = self.replacements_left = options["replacements"]
        self.last_worker, self.last_query, self.had_worker = time.monotonic(), -POLL, False
        cluster.scale(jobs=self.number)

    def maintain(self):
        """Replace lost jobs; called every second while there is work.

        SolverError if no job is left and none will be submitted, or there was no worker for `wait`.
        """
        now = time.monotonic()
        if self.cluster.scheduler.workers:
            self.last_worker, self.had_worker = now, True
        if now - self.last_query < POLL:
            return
        self.last_query = now
        jobs = dict(self.cluster.workers)
        lost = {name: f"one refused ({job.refused})" for name, job in jobs.items() if job.refused}
        ids = {name: job.job_id for name, job in jobs.items() if job.job_id}
        states = squeue(ids.values())
        for name, job in {} if states is None else ids.items():
            state = states.get(job, "COMPLETED")  # SLURM forgets a job some minutes after its end
            if state.partition(",")[0] in ENDED:
                lost[name] = f"job {job} ({state})"
        if lost:
            self._replace(lost)
        if now - self.last_worker > self.wait:
            waiting = [f"job {job} ({(states or {}).get(job, 'unknown')})" for job in ids.values()]
            raise SolverError(sentence("slurm.no_worker", wait=self.wait, jobs=", ".join(waiting)))

    def _replace(self, lost):
        """Submit others for lost jobs, Dask's name -> why; SolverError if no job is left."""
        added = min(len(lost), self.replacements_left) if self.had_worker else 0
        self.replacements_left -= added
        self.cluster.sync(self.cluster.scale_down, list(lost))
        values = {"lost": ", ".join(lost.values()), "more": added, "left": self.replacements_left}
        to_stderr("ratestate: " + sentence("slurm.lost", **values))
        remaining = len(self.cluster.worker_spec) + added
        if not remaining:
            name = "used_up" if self.had_worker else "fruitless"
            values = {"lost": [*lost.values()][-1], "replacements": self.replacements}
            values["address"] = self.cluster.scheduler_address
            raise SolverError(sentence(f"slurm.{name}", **values))
        self.cluster.scale(jobs=remaining)


def squeue(ids):
    """Return state and reason of the jobs that SLURM knows, id -> text; None without an answer."""
    command = ["squeue", "--noheader", "--states=all", "--format=%i|%T|%r"]
    command.append("--jobs=" + ",".join(ids))
    try:
        answer = subprocess.run(command, capture_output=True, text=True, check=False, timeout=HANGS)
    except (OSError, subprocess.TimeoutExpired):
        return None
    if answer.returncode:  # also if it knows none of these jobs
        return {} if "Invalid job id" in answer.stderr else None
    rows = (line.strip().split("|") for line in answer.stdout.splitlines() if line.strip())
    return {
        job: state + (f", {why}" if why not in ("", "None") else "") for job, state, why in rows
    }
