"""Dask clusters: an existing scheduler, or a new cluster of SLURM jobs."""

import contextlib
import datetime
import re
import shutil
import subprocess
import tempfile

from ..errors import ParameterError

#: options of `slurm_cluster` for `Jobs`, and those passed to dask-jobqueue under the same name
JOBS = ["jobs", "replacements", "wait"]
SLURM = "cores memory walltime queue account processes interface".split()
#: least values of those that are integers; the form of the time that is read here
LEAST = {"jobs": 1, "replacements": 0, "cores": 1, "processes": 1}
WAIT_FORM = r"((?P<days>\d+)-)?(?P<hours>\d+):(?P<minutes>\d+):(?P<seconds>\d+)"
# Default replacements for each job; default time to wait for any worker.
REPLACEMENTS, WAIT = 10, "1-00:00:00"
# Bytes of memory for each process: Python and the kernels alone take 0.3 GB.
MIN_BYTES = 5e8
EXAMPLE = "for example jobs=10,cores=16,memory=32GB,walltime=02:00:00,queue=short"


@contextlib.contextmanager
def slurm_client(text):
    """A client of a new `slurm_cluster`; both are closed at the end."""
    distributed = _import_extra("distributed")
    with slurm_cluster(text) as cluster, distributed.Client(cluster) as client:
        yield client


def slurm_cluster(text, start=True):
    """A Dask cluster of SLURM jobs, from options such as "jobs=10,cores=16,memory=32GB".

    Options that are not given, and whatever else jobs need, are read from dask-jobqueue's own
    configuration.  Without `start` no job is submitted, and ``job_script()`` of the cluster shows
    what they would run.
    """
    _import_extra("dask_jobqueue")  # this also loads its configuration
    import dask

    from .slurm import SweepCluster

    options = _options(text, dask.config.get("jobqueue.slurm"))
    # Another sweep may have the usual port.
    scheduler = {"dashboard_address": ":0"} | dask.config.get("jobqueue.slurm.scheduler-options")
    try:
        cluster = SweepCluster(**options, scheduler_options=scheduler)
    except (ValueError, OSError, RuntimeError) as error:
        raise ParameterError(f"slurm: {text!r} makes no cluster ({error}); {EXAMPLE}") from error
    if start:
        try:
            _check_with_slurm(cluster.job_script())
        except ParameterError:
            cluster.close()
            raise
        cluster.jobs.submit()
    return cluster


def _options(text, site):
    """The options in a string, name -> checked value; `site`: dask-jobqueue's configuration."""
    site = {key: site[key] for key in ("cores", "memory", "processes") if site.get(key) is not None}
    options = {"jobs": 1, "wait": WAIT} | site | _split(text)
    for key in LEAST.keys() & options.keys():
        if not (str(options[key]).isdecimal() and int(options[key]) >= LEAST[key]):
            raise ParameterError(
                f"slurm: {key} = {options[key]} must be an integer >= {LEAST[key]}; {EXAMPLE}"
            )
        options[key] = int(options[key])
    if missing := [key for key in ("cores", "memory") if key not in options]:
        raise ParameterError(f"slurm: {' and '.join(missing)} of a job must be given; {EXAMPLE}")
    # One process for each core: a case that kills its process then kills no others.
    default = {"replacements": REPLACEMENTS * options["jobs"], "processes": options["cores"]}
    options = default | options
    processes = options["processes"]
    if options["cores"] % processes:
        raise ParameterError(
            f"slurm: processes = {processes} must divide cores = {options['cores']}"
        )
    share = _bytes(options["memory"]) / processes
    if share < MIN_BYTES:
        raise ParameterError(
            f"slurm: memory = {options['memory']} gives each of {processes} processes "
            f"{share / 1e6:.0f} MB; each needs {MIN_BYTES / 1e6:.0f}: ask for more, or fewer "
            f"processes"
        )
    if not re.fullmatch(r"(\d+-)?\d+(:\d+){0,2}", options.get("walltime", "0")):
        raise _malformed_time("walltime", options)
    wait = re.fullmatch(WAIT_FORM, options["wait"])
    if not wait:
        raise _malformed_time("wait", options)
    seconds = datetime.timedelta(**{unit: int(n) for unit, n in wait.groupdict("0").items()})
    return options | {"wait": seconds.total_seconds()}


def _malformed_time(key, options):
    return ParameterError(
        f"slurm: {key} = {options[key]} is not hours:minutes:seconds or "
        f"days-hours:minutes:seconds, such as 02:00:00"
    )


def _split(text):
    """The options in a string, name -> string."""
    if not isinstance(text, str):
        raise ParameterError(f"slurm = {text!r} is not a text; {EXAMPLE}")
    options = {}
    for item in re.split(r",(?=\s*\w+\s*=)", text):  # values may hold commas
        key, equals, value = (part.strip() for part in item.partition("="))
        if not equals or not value or key not in {*JOBS, *SLURM}:
            keys = ", ".join([*JOBS, *SLURM])
            raise ParameterError(
                f"slurm: {item!r} is not key=value with a key of {keys}; {EXAMPLE}"
            )
        options[key] = value
    return options


def _bytes(text):
    """A text such as 32GB as a number."""
    from dask.utils import parse_bytes

    try:
        return parse_bytes(text)
    except (ValueError, TypeError):
        raise ParameterError(f"slurm: memory = {text} is no size, such as 32GB") from None


def _check_with_slurm(script):
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
    """A client of the Dask scheduler at this address, such as "tcp://10.0.0.1:8786"."""
    distributed = _import_extra("distributed")
    try:
        return distributed.Client(address, timeout="10s")
    except (OSError, ValueError) as error:
        raise ParameterError(
            f"scheduler = {address!r} does not answer ({error}); start one with 'dask scheduler', "
            f"and give the address that it prints"
        ) from error


def _import_extra(module):
    """Import a module that the extra `cluster` installs."""
    from importlib import import_module

    try:
        return import_module(module)
    except ImportError:
        raise ParameterError(
            f"{module} is not installed; pip install 'ratestate[cluster]' brings it"
        ) from None
