"""The function `sweep`: another function for any number of cases, resumed after interruptions."""

import os
import warnings
from pathlib import Path

import numpy as np

from ..engine import backend as engine
from ..errors import ParameterError, RunWarning, StoreError
from ..machine import check_fits
from ..model.units import is_integer
from . import sentence
from .backends import backend_of
from .calls import call_of, check_device, undisturbed
from .create import create, remove_abandoned
from .legacy import SWEEP_GROUP
from .lock import exclusive_lock
from .request import SweepRequest
from .resume import resume_store
from .solve import bytes_per_case
from .status import crashed_chunks_in, failed_cases_in, store_status
from .store import as_store_error, device_attrs, matching_record, open_result
from .writing import mark_undone


def sweep(
    verb,
    slider,
    *,
    store=None,
    client=None,
    chunk=None,
    progress=True,
    device="cpu",
    retry_crashed=False,
    slurm=None,
    mixed=False,
    **arguments,
):
    """Call another function for all named DataArrays among its arguments, in chunks.

    Each case gives the same result, bit for bit, however the sweep is divided, and on any number
    of cores, threads or machines of one kind (processors of different kinds differ in their last
    digits).  A case that fails spoils no other.  Files of a store that are missing or damaged are
    computed again, with a RuntimeWarning.

    Parameters
    ----------
    verb : callable or str
        The function, or its name: `limit_cycle`, `simulate`, `stability` or `frequency_response`.
    slider : SpringSlider
        With DataArrays for parameters, or none.
    store : str or path, optional
        Folder of a Zarr store, such as "x.zarr", made if there is none.  A store that the same
        sweep began is resumed: what is done is not done again.  Without a store the result is kept
        in memory.
    client : dask.distributed.Client, optional
        Cluster that does the work; its workers must see the store under the same path.  Without
        a client all cores of this machine do it.
    chunk : int, optional
        Cases that are solved, and stored, at a time.  By default as many as take some seconds,
        measured on a sample.
    progress : bool
        Whether to show progress on stderr: a bar on a terminal, else a line now and then.
    device : {"cpu", "cuda"}
        "cuda": an NVIDIA GPU (of each worker, with a client).
    retry_crashed : bool
        Whether to compute again the cases with the status ``crashed`` in the store, for example
        after their cause has been removed.
    slurm : str, optional
        SLURM jobs that do the work, instead of a client's workers, such as
        "jobs=10,cores=16,memory=32GB,walltime=02:00:00".  For the other options, lost jobs and
        dask-jobqueue's configuration see :doc:`Run on SLURM </howto/slurm>`.
    mixed : bool
        Whether the last digits of cases may depend on what computed them: whether to resume a
        store that other versions or another kind of processor began, and to use workers of several
        kinds.  The store records the versions and the processor of each chunk.
    **arguments
        The function's other arguments.

    Returns
    -------
    xarray.Dataset
        As the function returns it, with ``status`` for `stability` too.  A case that failed
        raises nothing: its ``status`` is neither 0 nor 1, and the variable ``message``, "" for all
        others, says why.  Its numbers are NaN, its flags and counts 0; but ``outside_domain`` is
        -1, and ``steps`` are those taken unless it crashed.  With a store this is the
        opened store, which reads numbers when they are used; messages are read at once, up to ten
        million.

    Raises
    ------
    ParameterError
        An argument that cannot be used, for any case; nothing to sweep over.
    StoreError
        The store belongs to another sweep, or was begun by other versions or on another kind of
        processor (differences are listed), is in use, or cannot be read or written; nothing in it
        is lost.
    SolverError
        The cluster is lost, no SLURM job is left, or none starts.
    KeyboardInterrupt
        The sweep was interrupted; with a store the message says how many cases it holds.

    Warns
    -----
    RunWarning
        Once, with their number: runs start on steady sliding that is unstable, and nothing disturbs
        them (see `simulate`).

    Examples
    --------
    >>> import ratestate as rs
    >>> slider = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", K="900 MPa/m",
    ...                          M=rs.logspace("M", 100, 1e5, 12))
    >>> cycles = rs.sweep(rs.limit_cycle, slider, V_lp=rs.logspace("V_lp", 1e-3, 1e-1, 13))
    >>> dict(cycles.sizes)["M"], int((cycles.status == 0).sum())
    (12, 114)
    """
    name, call = call_of(verb, slider, arguments)
    check_device(name, call, device)
    if client is not None and slurm is not None:
        raise ParameterError("client and slurm both say who does the work; give one of them")
    if client is not None and not hasattr(client, "nthreads"):
        raise ParameterError(sentence("call.client", client=client))
    if chunk is not None and not (is_integer(chunk) and chunk >= 1):
        raise ParameterError(sentence("call.chunk", chunk=chunk))
    switches = {"progress": progress, "retry_crashed": retry_crashed, "mixed": mixed}
    for option, value in switches.items():
        if not isinstance(value, bool):
            raise ParameterError(f"{option} = {value!r} must be True or False")
    if retry_crashed and store is None:
        raise ParameterError(sentence("call.retry"))
    with backend_of(device, client, slurm) as backend, engine.use(device=device):
        request = SweepRequest(name, call, chunk, device, mixed, backend, progress)
        if store is None:
            _check_fits(request)
        if text := undisturbed(name, call):
            warnings.warn(text, RunWarning, stacklevel=2)
        if store is None:
            return _in_memory(request)
        path = _folder(store, backend)
        try:
            return _in_store(request, path, retry_crashed)
        except KeyboardInterrupt:
            raise KeyboardInterrupt(_interrupted(path)) from None


def _check_fits(request):
    """Raise ParameterError if the result takes more memory than there is."""
    cases, own = request.call.batch.n, _own(request)
    check_fits(cases * bytes_per_case(own), f"the results of {cases:,} cases", "Give a store.")


def _own(request):
    """Name -> specification of the variables that each case has."""
    specs, static = request.form
    return {name: spec for name, spec in specs.items() if name not in static}


def _in_memory(request):
    """The result, assembled from its chunks."""
    (specs, static), own = request.form, _own(request)
    chunks = request.divide()
    variables = {name: spec.empty(chunks.sizes) for name, spec in specs.items()} | static
    for outcome in request.outcomes(chunks, np.zeros(chunks.number, bool)):
        slices = chunks.slices(outcome.chunk)
        for name in own:
            part = outcome.variables[name]
            where = tuple(slices.get(dim, slice(None)) for dim in part.dims)
            variables[name].values[where] = part.values
    return request.call.dataset(variables).assign_attrs(device_attrs(request.device))


def _in_store(request, path, retry_crashed):
    """The result in a store, which is made or resumed."""
    remove_abandoned(path)
    with as_store_error(path):
        exists = path.exists()
    if not exists:
        create(path, request, request.divide())
    record = matching_record(path, request)
    with as_store_error(path):
        incomplete = retry_crashed or record.metadata_flaws or not record.done.all()
        resumes = incomplete or record.flaws  # last, since these take reading the whole store
    if resumes:
        with exclusive_lock(path / SWEEP_GROUP / "zarr.json", path):
            # read again, since another sweep may have held the lock before
            store = resume_store(path, request)
            if retry_crashed:
                store = mark_undone(store, crashed_chunks_in(store))
            for _ in request.outcomes(store.chunks, store.done, store, failed_cases_in(store)):
                pass
    return open_result(path)


def _interrupted(path):
    """What an interrupted sweep has stored, and how to go on, as text."""
    if not path.exists():
        return sentence("interrupted.nothing", path=path)
    try:
        status = store_status(path)
    except StoreError as error:
        return str(error)
    return sentence("interrupted.some", path=path, done=status.done, cases=status.cases)


def _folder(store, backend):
    """The path of a store; ParameterError if it cannot be one."""
    if not isinstance(store, str | os.PathLike) or "://" in os.fspath(store):
        raise ParameterError(sentence("call.path", store=store))
    path = Path(store).expanduser()
    return path if backend.shared else path.absolute()  # workers may run in another folder
