"""The function `sweep`: check that a store is of this sweep, and compute the chunks it lacks."""

import contextlib
import dataclasses
import functools
import os
import warnings
from pathlib import Path
from typing import Any

import numpy as np

from ..engine import backend as engine
from ..errors import ParameterError, RunWarning, StoreError
from ..machine import check_fits
from ..model.units import is_integer
from . import sentence
from .calls import call_of, check_cases, check_device, undisturbed
from .chunks import cases_per_chunk, chunks_of
from .cluster import Cluster
from .identity import arguments_of, differences, origin, origin_differences
from .progress import ProgressReport
from .slurm import slurm_cluster
from .solve import ANSWERED, bytes_per_case, form_of
from .status import store_status
from .store import METADATA, Store, as_lines, damage_message, device_attrs, open_result, reading
from .tasks import Tasks, Threads
from .writing import create, exclusive_lock


def sweep(
    function,
    slider,
    *,
    store=None,
    client=None,
    chunk=None,
    progress=True,
    device="cpu",
    slurm=None,
    **arguments,
):
    """Call a function for every case of its named arrays, in chunks that can be resumed.

    A case that fails does not affect the others.  The result of a case is the same to the last bit
    however the sweep is divided, and on any number of cores, threads or machines.  Processors of
    different kinds differ in their last digits.

    Parameters
    ----------
    function : callable or str
        The function, or its name: `limit_cycle`, `simulate`, `stability` or `frequency_response`.
    slider : SpringSlider
        Parameters may be named DataArrays.
    store : str or path, optional
        Folder of a Zarr store, such as "x.zarr".  It is created, or resumed if the same sweep began
        it.  Without a store the result is kept in memory.
    client : dask.distributed.Client, optional
        Cluster that computes the cases.  Its workers must reach the store under the same path.
        Without a client, all cores of this machine are used.
    chunk : int, optional
        Number of cases that are computed and stored together.  By default a chunk takes some
        seconds.
    progress : bool
        Whether to show progress on stderr: a bar on a terminal, else a line now and then.
    device : {"cpu", "cuda"}
        "cuda" computes on an NVIDIA GPU.  With a client, each worker needs one.
    slurm : str, optional
        Options of SLURM jobs that compute the cases instead of a client, such as
        "jobs=10,cores=16,memory=32GB,walltime=02:00:00".  :doc:`Run on SLURM </howto/slurm>`
        describes other options and lost jobs.
    **arguments
        The function's other arguments.

    Returns
    -------
    xarray.Dataset
        Result of the function for all cases.  With a store, numbers are read from disk when they
        are used.  If a case fails, no error is raised.  Instead:

        - ``status`` is neither 0 nor 1;
        - ``message`` is the reason; it is "" in all other cases;
        - numbers are NaN, flags and counts are 0, and ``outside_domain`` is -1;
        - ``steps`` is the number of steps until the failure.

        Failed cases that are stored are not repeated.

    Raises
    ------
    ParameterError
        If an argument cannot be used in some case, or if there is nothing to sweep over.
    StoreError
        If the store belongs to another sweep, has other chunks or another device, is in use, is not
        a store, or cannot be read or written.  Also if it is unfinished or damaged, and was begun
        by other programs or on another kind of processor.
    SolverError
        If the cluster is lost, no SLURM job is left, or none starts.
    KeyboardInterrupt
        If the sweep is interrupted.  The message says what is stored and how to resume.

    Warns
    -----
    RunWarning
        If runs start in unstable steady sliding and nothing disturbs them (see `simulate`).  There
        is one warning for all of them.
    RuntimeWarning
        If files of the store are missing or damaged.  Their chunks are computed again.

    Examples
    --------
    >>> import ratestate as rs
    >>> slider = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", K="900 MPa/m",
    ...                          M=rs.logspace("M", 100, 1e5, 12))
    >>> cycles = rs.sweep(rs.limit_cycle, slider, V_lp=rs.logspace("V_lp", 1e-3, 1e-1, 13))
    >>> dict(cycles.sizes)["M"], int((cycles.status == 0).sum())
    (12, 114)
    """
    name, call = call_of(function, slider, arguments)
    check_device(name, call, device)
    if client is not None and slurm is not None:
        raise ParameterError(sentence("call.both"))
    if client is not None and not hasattr(client, "nthreads"):
        raise ParameterError(sentence("call.client", client=client))
    if chunk is not None and not (is_integer(chunk) and chunk >= 1):
        raise ParameterError(sentence("call.chunk", chunk=chunk))
    if not isinstance(progress, bool):
        raise ParameterError(f"progress = {progress!r} must be True or False")
    if slurm is not None:
        context: Any = slurm_cluster(slurm, device)
    else:
        workers = Threads(device) if client is None else Cluster(client, device)
        context = contextlib.nullcontext(workers)
    with context as backend, engine.use(device=device):
        request = Request(name, call, chunk, device, backend, progress)
        if store is None:
            size = call.batch.n * bytes_per_case(request.form.swept)
            remedy = "Give a store (ratestate sweep FILE --store x.zarr)."
            check_fits(size, f"the results of {call.batch.n:,} cases", remedy)
        if text := undisturbed(name, call):
            warnings.warn(text, RunWarning, stacklevel=2)
        path = None if store is None else _folder(store, backend)
        try:
            return _in_memory(request) if path is None else _in_store(request, path)
        except KeyboardInterrupt:
            raise KeyboardInterrupt(message_of_interrupt(path)) from None


@dataclasses.dataclass(frozen=True)
class Request:
    """What a sweep is to compute, and where; checked by `sweep`."""

    name: str  # of the function
    call: Any
    chunk: int | None  # cases of a chunk; None: chosen by `cases_per_chunk`
    device: str
    backend: Any  # `Threads` or `Cluster`
    progress: bool

    @functools.cached_property
    def form(self):
        """`Form` of the result."""
        return form_of(self.call)

    @functools.cached_property
    def origin(self):
        """`origin` of this process or, with a cluster, of a worker."""
        return self.backend.run(origin, self.device)

    def record(self, chunks):
        """Return the record of a store for these chunks."""
        specs = self.form.specs.items()
        return {
            "function": self.name,
            "arguments": arguments_of(self.name, self.call),
            "sizes": chunks.sizes,
            "chunk": list(chunks.shape),
            "device": self.device,
            "variables": {k: f"{spec.dtype} over ({', '.join(spec.dims)})" for k, spec in specs},
            **self.origin,
        }

    def divide(self):
        """Return the `Chunks`; ParameterError if the arguments of a case contradict each other."""
        chunks = chunks_of(self.call.batch.sizes, self.chunk or cases_per_chunk(self))
        check_cases(self.call, chunks)
        return chunks

    def outcomes(self, chunks, done, store=None, failed=0):
        """Solve all chunks that are not done; yield each `Outcome` when it is ready.

        failed : number of failed cases among those done
        """
        closed_store = store and dataclasses.replace(store)  # without the arrays that it has opened
        tasks = Tasks(chunks, self.form.specs, closed_store, self.device)
        numbers = np.flatnonzero(~done).tolist()
        label = f"sweep of {self.name}"
        with ProgressReport(label, chunks, done, failed, quiet=not self.progress) as report:
            outcomes = self.backend.outcomes(tasks, self.call, numbers, report, self.origin)
            with contextlib.closing(outcomes):
                for outcome in outcomes:
                    report.finished(outcome)
                    yield outcome


def _in_memory(request):
    form, chunks = request.form, request.divide()
    variables = {name: spec.empty(chunks.sizes) for name, spec in form.specs.items()} | form.static
    for outcome in request.outcomes(chunks, np.zeros(chunks.number, bool)):
        slices = chunks.slices(outcome.chunk)
        for name in form.swept:
            part = outcome.variables[name]
            variables[name][{dim: slices[dim] for dim in part.dims if dim in slices}] = part
    return request.call.dataset(variables).assign_attrs(device_attrs(request.device))


def _in_store(request, path):
    with reading(path):
        exists = path.exists()
    if not exists:
        create(path, request, request.divide())
    store = _matching_store(request, path)
    if not store.done().all() or store.flaws():
        with exclusive_lock(path / METADATA, path):
            store = _matching_store(request, path)  # another sweep may have held the lock before
            done, failed = _prepare(store, request)
            for _ in request.outcomes(store.chunks, done, store, failed):
                pass
    return open_result(path)


def _matching_store(request, path):
    """Return the `Store` at a path; StoreError, with the differences, if it is of another sweep."""
    with reading(path):
        store = Store.open(path)
        lines = differences(store.arguments, arguments_of(request.name, request.call))
        lines += differences({"device": store.record["device"]}, {"device": request.device})
        sizes, shape = store.chunks.sizes, store.chunks.shape
    if request.chunk is not None and chunks_of(sizes, request.chunk).shape != shape:
        lines.append(f"chunk: blocks of {shape} cases in the store, chunk={request.chunk} now")
    if lines:
        raise StoreError(sentence("store.other_sweep", path=path, lines=as_lines(lines)))
    return store


def _prepare(store, request):
    """Return which chunks of a store are kept, (chunks,) bool, and how many of their cases failed.

    StoreError if what computes would give other last digits or variables than the store has, or if
    files made with the store are damaged.
    """
    current = request.record(store.chunks)
    with reading(store.path):
        lines = origin_differences(store.record, current)
        lines += differences(store.record["variables"], current["variables"], "variable ")
        if lines:
            raise StoreError(sentence("origin.refused", path=store.path, lines=as_lines(lines)))
        done, flaws = store.done(), store.flaws()
        if any(flaw.chunk is None for flaw in flaws):
            raise StoreError(damage_message(store.path, flaws))
        done[[flaw.chunk for flaw in flaws]] = False
        counts = store.statuses(done)
    for partial in store.path.rglob("*.partial"):  # of writers that were killed
        partial.unlink(missing_ok=True)
    if flaws:
        text = sentence("damage.repaired", path=store.path, lines=as_lines(flaws))
        warnings.warn(text, RuntimeWarning, stacklevel=5)
    return done, sum(n for code, n in counts.items() if code not in ANSWERED)


def message_of_interrupt(path):
    """Return what an interrupted sweep has stored, and how to go on, as text."""
    if path is None:
        return sentence("interrupted.memory")
    if not path.exists():
        return sentence("interrupted.nothing", path=path)
    try:
        status = store_status(path)
    except Exception as error:  # any: the interrupt may have hit the import of a module
        return f"interrupted. {error}"
    return sentence("interrupted.some", path=path, done=status.done, cases=status.cases)


def _folder(store, backend):
    """Return the path of a store; ParameterError if it cannot be one."""
    if not isinstance(store, str | os.PathLike) or "://" in os.fspath(store):
        raise ParameterError(sentence("call.path", store=store))
    path = Path(store).expanduser()
    return path if backend.shared else path.absolute()  # workers may run in another folder
