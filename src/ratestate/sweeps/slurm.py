"""SLURM, as a `BatchSystem`."""

import subprocess

from .jobs import BatchSystem, State

#: states of a job that has ended, as squeue(1) calls them; in all others it may still work
ENDED = """BOOT_FAIL CANCELLED COMPLETED DEADLINE FAILED NODE_FAIL OUT_OF_MEMORY PREEMPTED
    REVOKED TIMEOUT""".split()
# Seconds until squeue is assumed to hang.
HANGS = 20.0


def squeue(ids):
    """Job id -> `State`, for the jobs that SLURM knows; None if it does not answer."""
    command = ["squeue", "--noheader", "--states=all", "--format=%i|%T|%r"]
    command.append("--jobs=" + ",".join(ids))
    try:
        answer = subprocess.run(command, capture_output=True, text=True, check=False, timeout=HANGS)
    except (OSError, subprocess.TimeoutExpired):
        return None
    if answer.returncode:  # also if it knows none of these jobs
        return {} if "Invalid job id" in answer.stderr else None
    rows = (line.strip().split("|") for line in answer.stdout.splitlines() if line.strip())
    return {job: State(*rest) for job, *rest in rows}


SLURM = BatchSystem(
    name="slurm",
    label="SLURM",
    dask_class="SLURMCluster",
    submit="sbatch",
    test="--test-only",
    query="squeue",
    log="slurm-ID.out",
    ended=ENDED,
    states=squeue,
)
