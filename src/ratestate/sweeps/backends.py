"""Who computes a sweep: threads here, the Dask cluster of a client, or a new one made of jobs."""

import contextlib
import re
import shutil
import subprocess
import tempfile

from ..errors import ParameterError
from . import sentence
from .cluster import Cluster
from .slurm import SLURM
from .task import Threads

#: options of `job_cluster` for `Jobs`, and those passed to dask-jobqueue under the same name
JOBS = ["jobs", "replacements", "wait"]
OF_A_JOB = "cores memory walltime queue account processes interface".split()
#: least values of those that are integers; forms of those that are times
LEAST = {"jobs": 1, "replacements": 0, "cores": 1, "processes": 1}
TIMES = {"walltime": r"(\d+-)?\d+(:\d+){0,2}", "wait": r"(\d+-)?\d+:\d+:\d+"}
# Default replacements for each job; default time to wait for any worker.
REPLACEMENTS, WAIT = 10, "1-00:00:00"
# Bytes of memory for each process: Python and the kernels alone take 0.3 GB.
MIN_BYTES = 5e8
EXAMPLE = "for example jobs=10,cores=16,memory=32GB,walltime=02:00:00,queue=short"


@contextlib.contextmanager
def backend_of(device, client, jobs):
    """Context manager: a `Cluster` of a client or of new jobs, or else `Threads`, to run a sweep.

    ParameterError as by `job_cluster`, and on threads if this process has no such device.

    jobs : options of the jobs of a new `job_cluster`, which comes before the client, or None
    """
    if jobs is None:
        yield Threads(device) if client is None else Cluster(client, device)
        return
    with job_client(jobs) as own:
        yield Cluster(own, device)


@contextlib.contextmanager
def job_client(text, system=SLURM):
    """Context manager: a client of a new `job_cluster`; both are closed at the end."""
    distributed = _import_extra("distributed")
    with job_cluster(text, system=system) as cluster, distributed.Client(cluster) as client:
        yield client


def job_cluster(text, start=True, system=SLURM):
    """A Dask cluster of jobs in a `BatchSystem`.

    text : options such as "jobs=10,cores=16,memory=32GB"

    Options that are not given, and whatever else jobs need, are read from dask-jobqueue's own
    configuration.  Without `start` no job is submitted, and ``job_script()`` of the cluster shows
    what they would run.  ParameterError for options that are wrong or missing, where dask-jobqueue
    is not installed or makes no cluster of them, and where the batch system would refuse the job.
    """
    _import_extra("dask_jobqueue")  # this also loads its configuration
    import dask

    from .job_cluster import sweep_cluster

    site = f"jobqueue.{system.name}"
    options = _options(system, text, dask.config.get(site))
    # Another sweep may have the usual port.
    scheduler = {"dashboard_address": ":0"} | dask.config.get(f"{site}.scheduler-options")
    try:
        cluster = sweep_cluster(system, **options, scheduler_options=scheduler)
    except (ValueError, OSError, RuntimeError) as error:
        raise _refusal("no_cluster", system, text=text, error=error) from error
    if start:
        try:
            _check_script(system, cluster.job_script())
        except ParameterError:
            cluster.close()
            raise
        cluster.scale(jobs=cluster.jobs.number)
    return cluster


def _options(system, text, site):
    """The options in a string, name -> checked value; `site`: dask-jobqueue's configuration."""
    from dask.utils import parse_bytes

    site = {key: site[key] for key in ("cores", "memory", "processes") if site.get(key) is not None}
    options = {"jobs": 1, "wait": WAIT} | site | _split(system, text)
    for key in LEAST.keys() & options.keys():
        if not (str(options[key]).isdecimal() and int(options[key]) >= LEAST[key]):
            raise _refusal("integer", system, key=key, value=options[key], least=LEAST[key])
        options[key] = int(options[key])
    if missing := [key for key in ("cores", "memory") if key not in options]:
        raise _refusal("missing", system, keys=" and ".join(missing))
    # One process for each core: a case that kills its process then kills no others.
    default = {"replacements": REPLACEMENTS * options["jobs"], "processes": options["cores"]}
    options = default | options
    if options["cores"] % options["processes"]:
        raise _refusal("processes", system, **options)
    try:
        share = parse_bytes(options["memory"]) / options["processes"]
    except (ValueError, TypeError):
        raise _refusal("memory", system, **options) from None
    if share < MIN_BYTES:
        raise _refusal("share", system, share=share / 1e6, least=MIN_BYTES / 1e6, **options)
    for key, form in TIMES.items():
        if not re.fullmatch(form, options.get(key, "0:0:0")):
            raise _refusal("time", system, key=key, value=options[key])
    days, hours, minutes, seconds = map(int, re.findall(r"\d+", f"0-{options['wait']}")[-4:])
    return options | {"wait": 86400.0 * days + 3600.0 * hours + 60.0 * minutes + seconds}


def _split(system, text):
    """The options in a string, name -> string."""
    if not isinstance(text, str):
        raise _refusal("text", system, text=text)
    options = {}
    for item in re.split(r",(?=\s*\w+\s*=)", text):  # values may hold commas
        key, equals, value = (part.strip() for part in item.partition("="))
        if not equals or not value or key not in {*JOBS, *OF_A_JOB}:
            raise _refusal("key", system, item=item, keys=", ".join([*JOBS, *OF_A_JOB]))
        options[key] = value
    return options


def _check_script(system, script):
    """Raise ParameterError unless the batch system would take this job."""
    if not shutil.which(system.submit):
        raise _refusal("no_command", system, command=system.submit)
    with tempfile.NamedTemporaryFile("w", suffix=".sh") as file:
        file.write(script)
        file.flush()
        command = [system.submit, system.test, file.name]
        answer = subprocess.run(command, capture_output=True, text=True, check=False)
    if answer.returncode:
        raise _refusal("refused", system, error=answer.stderr.strip(), script=script)


def _refusal(why, system, **values):
    """The error about options of jobs, with this sentence."""
    names = {"system": system.name, "label": system.label}
    return ParameterError(sentence(f"batch.{why}", example=EXAMPLE, **names, **values))


def client_of(address):
    """A client of the Dask scheduler at this address, such as "tcp://10.0.0.1:8786".

    ParameterError if it does not answer in 10 s, or distributed is not installed.
    """
    distributed = _import_extra("distributed")
    try:
        return distributed.Client(address, timeout="10s")
    except (OSError, ValueError) as error:
        message = sentence("cluster.silent", address=address, error=error)
        raise ParameterError(message) from error


def _import_extra(module):
    """Import a module that the extra `cluster` installs."""
    from importlib import import_module

    try:
        return import_module(module)
    except ImportError:
        raise ParameterError(sentence("cluster.not_installed", module=module)) from None
