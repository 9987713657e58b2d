"""The verb `sweep`: another verb over as many cases as there are, and through any interruption."""

import contextlib
import dataclasses
import functools
import os
from pathlib import Path
from typing import Any

import numpy as np

from ..engine import backend
from ..errors import ParameterError
from ..machine import check_fits, cores
from . import cluster, here
from .bar import Report
from .calls import call_of, check, check_device
from .chunks import chunks_of
from .connect import slurm_client
from .create import create, tidy
from .lock import alone
from .older import INSIDE
from .origin import origin
from .probe import cases_of_a_chunk
from .resume import resumed
from .solve import bytes_of_a_case, form_of
from .status import crashed_in, failed_in
from .store import damage_told, examined, is_complete, noted, result_of, undone
from .task import Tasks


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
    """Another verb over all named DataArrays among its arguments, in chunks.

    Cases have the same bits however they are divided, on however many cores, threads or machines
    (of one kind: processors differ in their last digits).  A case that fails costs itself only.
    What a store has lost, or holds damaged, is computed again, with a RuntimeWarning.

    Parameters
    ----------
    verb : callable or str
        `limit_cycle`, `simulate` or `stability`, or the name.
    slider : SpringSlider
        With DataArrays for parameters, or none.
    store : str or path, optional
        Folder of a Zarr store, such as "x.zarr".  Made if there is none.  One that the same sweep
        began is gone on with: what is done is not done again.  Without it the result is in memory.
    client : dask.distributed.Client, optional
        Cluster that does the work; its workers must see the store under the same path.  Without
        it all cores here do.
    chunk : int, optional
        Cases that are solved, and stored, at a time.  By default of some seconds, as a first probe
        says.
    progress : bool
        Whether to show on stderr how far it is: a bar on a terminal, else a line now and then.
    device : {"cpu", "cuda"}
        "cuda": an NVIDIA GPU (of each worker, with a client).
    retry_crashed : bool
        Whether to do cases again that the store has with the status ``crashed``, as when what they
        failed of has been mended.
    slurm : str, optional
        SLURM jobs that do the work, instead of a client's workers, such as
        "jobs=10,cores=16,memory=32GB,walltime=02:00:00".  For the other options, lost jobs and
        dask-jobqueue's configuration see :doc:`Run on SLURM </howto/slurm>`.
    mixed : bool
        Whether cases may differ in their last digits by what computed them: whether to go on with
        a store that other versions or another kind of processor began, and to take workers of
        several kinds.  The store keeps what made which chunk.
    **arguments
        The verb's other arguments.

    Returns
    -------
    xarray.Dataset
        As the verb's, with the variable ``message``, which says of each failed case why, and
        ``status`` for `stability` too.  With a store, the opened store: numbers are read where they
        are used, but for the messages of up to ten million cases.

    Raises
    ------
    ParameterError
        An argument that cannot be used, for any case; nothing to sweep over.
    StoreError
        The store belongs to another sweep, or was begun by other versions or on another kind of
        processor (differences are listed), is in use, or cannot be read or written; nothing that
        it holds is lost.
    SolverError
        The cluster was lost, or no SLURM job is left, or none starts.

    Examples
    --------
    >>> import ratestate as rs
    >>> slider = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", K="900 MPa/m",
    ...                          M=rs.logspace("M", 100, 1e5, 12))
    >>> found = rs.sweep(rs.limit_cycle, slider, V_lp=rs.logspace("V_lp", 1e-3, 1e-1, 13))
    >>> dict(found.sizes)["M"], int((found.status == 0).sum())
    (12, 114)
    """
    name, call = call_of(verb, slider, arguments)
    check_device(name, call, device, client is None and slurm is None)
    if client is not None and slurm is not None:
        raise ParameterError("client and slurm both say who does the work; give one of them")
    if client is not None and not hasattr(client, "nthreads"):
        raise ParameterError(
            f"client = {client!r} is no dask.distributed.Client; for the address of a scheduler "
            f"give client=Client(address)"
        )
    integer = isinstance(chunk, int | np.integer) and not isinstance(chunk, bool)
    if chunk is not None and not (integer and chunk >= 1):
        raise ParameterError(f"chunk = {chunk!r} must be a number of cases >= 1, such as 10000")
    for option, value in (("retry_crashed", retry_crashed), ("mixed", mixed)):
        if not isinstance(value, bool):
            raise ParameterError(f"{option} = {value!r} must be True or False")
    if retry_crashed and store is None:
        raise ParameterError("retry_crashed = True: only a store has cases to try again; give one")
    with contextlib.ExitStack() as until_done:
        if slurm is not None:
            client = until_done.enter_context(slurm_client(slurm))
        until_done.enter_context(backend.use(device=device))
        plan = Plan(name, call, chunk, client, device, progress, mixed)
        if store is None:
            return _in_memory(plan)
        return _in_store(plan, _folder(store, client), retry_crashed)


@dataclasses.dataclass(frozen=True)
class Plan:
    """What is to be done, by whom."""

    name: str  # of the verb
    call: Any
    chunk: int | None
    client: Any
    device: str
    progress: bool
    mixed: bool

    def run(self, function, *arguments):
        """What a function returns, where the work is to be done."""
        if self.client is None:
            return function(*arguments)
        return cluster.result(self.client, self.device, function, *arguments)

    @functools.cached_property
    def form(self):
        """`Form` of the result."""
        return form_of(self.call)

    @functools.cached_property
    def origin(self):
        """Versions and kind of processor of what does the work: of a worker, with a cluster."""
        return self.run(origin, self.device)

    def begin(self):
        """Check all arguments, case by case, and try what a case costs; `Chunks`."""
        call, together = self.call, self.client is None
        workers = cores() if together else cluster.threads(self.client)
        cases = self.chunk or cases_of_a_chunk(
            call, self.form.kinds, workers, together, self.device, self.run
        )
        chunks = chunks_of(call.batch.sizes, cases)
        check(call, chunks)
        return chunks

    def outcomes(self, chunks, done, store=None, failed=0):
        """Do all chunks that are not done, and yield their `Outcome`s as they come.

        store : open `Store`, or None
        failed : number of cases that failed in those that are
        """
        kind = None if self.mixed else self.origin["processor"]
        tasks = Tasks(chunks, self.form.kinds, store, self.device, kind)
        numbers = np.flatnonzero(~done).tolist()
        label = f"sweep of {self.name}"
        with Report(label, chunks, done, failed, quiet=not self.progress) as report:
            if self.client is None:
                outcomes = here.outcomes(tasks, self.call, numbers, report)
            else:
                outcomes = cluster.outcomes(self.client, tasks, self.call, numbers, report)
            with contextlib.closing(outcomes):
                for outcome in outcomes:
                    report.finished(outcome)
                    yield outcome


def _in_memory(plan):
    """The result, put together from its chunks."""
    form, cases = plan.form, plan.call.batch.n
    own = {name: kind for name, kind in form.kinds.items() if name not in form.static}
    check_fits(cases * bytes_of_a_case(own), f"the results of {cases:,} cases", "give a store")
    chunks = plan.begin()
    variables = {name: kind.empty(chunks.sizes) for name, kind in form.kinds.items()}
    for outcome in plan.outcomes(chunks, np.zeros(chunks.number, bool)):
        places = chunks.places(outcome.chunk)
        for name in variables.keys() - form.static.keys():
            found = outcome.variables[name]
            where = tuple(places.get(dim, slice(None)) for dim in found.dims)
            variables[name].values[where] = found.values
    return plan.call.dataset(variables | form.static).assign_attrs(noted(plan.device))


def _in_store(plan, path, retry_crashed):
    """The store, made or gone on with, when all is done."""
    tidy(path)
    with damage_told(path):
        there = path.exists()
    if not there:
        create(path, plan.name, plan.call, plan.begin(), plan.form, plan.device)
    asked = plan.name, plan.call, plan.chunk, plan.device
    if retry_crashed or not is_complete(path, examined(path, *asked)):
        with alone(path / INSIDE / "zarr.json", path):
            # as the last to hold it left it
            store = resumed(path, plan.form, asked, plan.origin, plan.mixed)
            if retry_crashed:
                store = undone(store, crashed_in(store))
            for _ in plan.outcomes(store.chunks, store.done, store, failed_in(store)):
                pass
    return result_of(path)


def _folder(store, client):
    """The path of a store; ParameterError if it is none."""
    if not isinstance(store, str | os.PathLike) or "://" in os.fspath(store):
        raise ParameterError(f"store = {store!r} must be the path of a folder, such as 'x.zarr'")
    path = Path(store).expanduser()
    return path if client is None else path.absolute()  # workers may be somewhere else
