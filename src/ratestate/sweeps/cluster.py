"""Chunks of a sweep on a Dask cluster, on SLURM if need be."""

import itertools

from ..arrays import cut
from ..dataset import versions
from ..engine import drive
from ..errors import ParameterError, SolverError
from .chunks import halves
from .solve import joined, lost, solve
from .task import do_elsewhere

# Chunks sent ahead for each thread of the cluster, so that none waits for the next.
AHEAD = 2
# Halvings of a chunk that took its worker down before parts are tried again: each try of the bad
# one costs the lives of several workers.
HALVINGS = 4


def outcomes(client, tasks, call, numbers, report):
    """Do the chunks with these numbers, and yield their `Outcome`s as they come.

    Dask repeats what a lost worker did.  A chunk whose workers die again and again is set aside,
    and divided, when all else is done, until the case that does it is found.
    """
    from distributed import KilledWorker, as_completed

    queue, suspects, futures = iter(numbers), [], {}

    def submit(i):
        part = cut(call, tasks.chunks.places(i))
        future = client.submit(do_elsewhere, tasks, i, part, versions(), pure=False)
        futures[future] = i
        return future

    try:
        ready = as_completed()
        for i in itertools.islice(queue, AHEAD * max(1, sum(client.nthreads().values()))):
            ready.add(submit(i))
        for future in ready:
            i = futures.pop(future)
            for following in itertools.islice(queue, 1):
                ready.add(submit(following))
            if future.status == "cancelled":
                raise SolverError("the cluster gave up its tasks; what is done is stored")
            if isinstance(future.exception(), KilledWorker):
                suspects.append(i)
            else:
                yield future.result()
            report.show()
        for i in suspects:
            part = cut(call, tasks.chunks.places(i))
            yield tasks.outcome(i, _divided(client, part, tasks))
    finally:
        client.cancel(list(futures))


def _divided(client, part, tasks, level=0):
    """Variables of a part of which some cases take their worker down."""
    from distributed import KilledWorker

    if level % HALVINGS == 0 or part.batch.n == 1:
        try:
            return result(client, tasks.device, solve, part, tasks.kinds)
        except KilledWorker as error:
            if part.batch.n == 1:
                return lost(part, tasks.kinds, f"{type(error).__name__}: its workers died")
    dim, pieces = halves(part.batch.sizes)
    parts = [_divided(client, cut(part, piece), tasks, level + 1) for piece in pieces]
    return joined(parts, dim)


def result(client, device, function, *arguments):
    """What a function returns that a worker calls, with its kernels on one thread."""
    return client.submit(_placed, device, function, *arguments, pure=False).result()


def _placed(device, function, *arguments):
    with drive.place(threads=1, device=device):
        return function(*arguments)


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


#: what `slurm_cluster` reads -> how dask-jobqueue calls it
SLURM = {
    "cores": "cores",
    "memory": "memory",
    "walltime": "walltime",
    "queue": "queue",
    "account": "account",
    "processes": "processes",
}


def slurm_cluster(text, start=True):
    """A Dask cluster of SLURM jobs, from options such as "jobs=10,cores=16,memory=8GB".

    Parameters
    ----------
    text : str
        ``jobs`` (default 1), and for each job ``cores`` and ``memory``, which are needed,
        ``walltime``, ``queue``, ``account`` and ``processes``; key=value, separated by commas.
    start : bool
        Whether to submit the jobs; else ``job_script()`` of the cluster shows what would be.

    Raises
    ------
    ParameterError
        An option that is unknown, malformed or missing; dask-jobqueue is not installed.
    """
    jobqueue = _needed("dask_jobqueue")
    example = "for example jobs=10,cores=16,memory=8GB,walltime=02:00:00,queue=short"
    options: dict = {}
    for item in text.split(","):
        key, equals, value = (part.strip() for part in item.partition("="))
        if not equals or not value or key not in {"jobs", *SLURM}:
            known = ", ".join(["jobs", *SLURM])
            raise ParameterError(
                f"slurm: {item!r} is not key=value with a key of {known}; {example}"
            )
        options[key] = value
    for key in ("jobs", "cores", "processes"):
        if key in options and not (options[key].isdecimal() and int(options[key]) > 0):
            raise ParameterError(f"slurm: {key} = {options[key]} must be an integer > 0; {example}")
    if missing := [key for key in ("cores", "memory") if key not in options]:
        raise ParameterError(f"slurm: {' and '.join(missing)} of a job must be given; {example}")
    jobs, cores = int(options.pop("jobs", 1)), int(options["cores"])
    # One process a core: each has its own Python, and a case that kills it kills no others.
    settings = {SLURM[key]: value for key, value in options.items()}
    settings |= {"cores": cores, "processes": int(options.get("processes", cores))}
    settings["scheduler_options"] = {"dashboard_address": ":0"}  # another sweep may be running
    cluster = jobqueue.SLURMCluster(**settings)
    if start:
        cluster.scale(jobs=jobs)
    return cluster


def _needed(module):
    """A module of the extra `cluster`."""
    from importlib import import_module

    try:
        return import_module(module)
    except ImportError:
        raise ParameterError(
            f"{module} is not installed; pip install 'ratestate[cluster]' brings it"
        ) from None
