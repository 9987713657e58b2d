"""Clusters to work on: a Dask scheduler that is there, or SLURM jobs of one's own."""

import re
import shutil
import subprocess
import tempfile

from ..errors import ParameterError

#: what `slurm_cluster` reads, and hands to dask-jobqueue by the same name
SLURM = "cores memory walltime queue account processes interface".split()
# Bytes of memory for each process: Python and the kernels alone take 0.3 GB.
LEAST = 5e8
EXAMPLE = "for example jobs=10,cores=16,memory=32GB,walltime=02:00:00,queue=short"


def slurm_cluster(text, start=True):
    """A Dask cluster of SLURM jobs, from options such as "jobs=10,cores=16,memory=32GB".

    What else jobs need, such as ``job-extra-directives`` and ``job-script-prologue``, is read from
    dask-jobqueue's own file, ~/.config/dask/jobqueue.yaml.

    Parameters
    ----------
    text : str
        ``jobs`` (default 1), and for each job ``cores`` and ``memory``, which are needed,
        ``walltime`` (default 30 min), ``queue``, ``account``, ``processes`` (default one a core)
        and ``interface``, the network's, such as ib0; key=value, separated by commas.
    start : bool
        Whether to submit the jobs; else ``job_script()`` of the cluster shows what would be.

    Raises
    ------
    ParameterError
        An option that is unknown, malformed or missing; SLURM refuses the job, or is not here;
        dask-jobqueue is not installed.
    """
    jobqueue = _needed("dask_jobqueue")
    options = _options(text)
    jobs = options.pop("jobs")
    # Another sweep may have the usual port.
    settings = options | {"scheduler_options": {"dashboard_address": ":0"}}
    try:
        cluster = jobqueue.SLURMCluster(**settings)
    except (ValueError, OSError, RuntimeError) as error:
        raise ParameterError(f"slurm: {text!r} makes no cluster ({error}); {EXAMPLE}") from error
    if start:
        try:
            _approve(cluster.job_script())
        except ParameterError:
            cluster.close()
            raise
        cluster.scale(jobs=jobs)
    return cluster


def _options(text):
    """The options in a text, name -> value, checked."""
    options: dict = {"jobs": 1}
    for item in re.split(r",(?=\s*\w+\s*=)", text):  # values may hold commas
        key, equals, value = (part.strip() for part in item.partition("="))
        if not equals or not value or key not in {"jobs", *SLURM}:
            known = ", ".join(["jobs", *SLURM])
            raise ParameterError(
                f"slurm: {item!r} is not key=value with a key of {known}; {EXAMPLE}"
            )
        options[key] = value
    for key in {"jobs", "cores", "processes"} & options.keys():
        if not (str(options[key]).isdecimal() and int(options[key]) > 0):
            raise ParameterError(f"slurm: {key} = {options[key]} must be an integer > 0; {EXAMPLE}")
        options[key] = int(options[key])
    if missing := [key for key in ("cores", "memory") if key not in options]:
        raise ParameterError(f"slurm: {' and '.join(missing)} of a job must be given; {EXAMPLE}")
    # One process a core: each has its own Python, and a case that kills it kills no others.
    options.setdefault("processes", options["cores"])
    if options["cores"] % options["processes"]:
        raise ParameterError(
            f"slurm: processes = {options['processes']} must divide cores = {options['cores']}"
        )
    share = _bytes(options["memory"]) / options["processes"]
    if share < LEAST:
        raise ParameterError(
            f"slurm: memory = {options['memory']} gives each of {options['processes']} processes "
            f"{share / 1e6:.0f} MB; each needs {LEAST / 1e6:.0f}: ask for more, or fewer processes"
        )
    if not re.fullmatch(r"(\d+-)?\d+(:\d+){0,2}", options.get("walltime", "1")):
        raise ParameterError(
            f"slurm: walltime = {options['walltime']} is not hours:minutes:seconds or "
            f"days-hours:minutes:seconds, such as 02:00:00"
        )
    return options


def _bytes(text):
    """A text such as 32GB as a number."""
    from dask.utils import parse_bytes

    try:
        return parse_bytes(text)
    except ValueError:
        raise ParameterError(f"slurm: memory = {text} is no size, such as 32GB") from None


def _approve(script):
    """Raise ParameterError unless SLURM would take this job."""
    if not shutil.which("sbatch"):
        raise ParameterError(
            "slurm: this machine has no sbatch; run the sweep where jobs are submitted from, or "
            "without --slurm"
        )
    with tempfile.NamedTemporaryFile("w", suffix=".sh") as file:
        file.write(script)
        file.flush()
        command = ["sbatch", "--test-only", file.name]
        answer = subprocess.run(command, capture_output=True, text=True, check=False)
    if answer.returncode:
        raise ParameterError(f"slurm: {answer.stderr.strip()}; SLURM refuses this job:\n{script}")


def client_of(address):
    """A client of the Dask scheduler at this address, such as "tcp://10.0.0.1:8786".

    Raises
    ------
    ParameterError
        dask.distributed is not installed; nothing answers there.
    """
    distributed = _needed("distributed")
    try:
        return distributed.Client(address, timeout="10s")
    except (OSError, ValueError) as error:
        raise ParameterError(
            f"scheduler = {address!r} does not answer ({error}); start one with 'dask scheduler', "
            f"and give the address that it prints"
        ) from error


def _needed(module):
    """A module of the extra `cluster`."""
    from importlib import import_module

    try:
        return import_module(module)
    except ImportError:
        raise ParameterError(
            f"{module} is not installed; pip install 'ratestate[cluster]' brings it"
        ) from None
