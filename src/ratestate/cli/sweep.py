"""``ratestate sweep``: a scenario file's sweep into a store, and what a store holds."""

import contextlib
import enum
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any

import typer

from .shared import SOME_FAILED, ending_well
from .stored import left, place, summary, tell

LISTED = 20  # failed cases, at most


class Device(enum.StrEnum):
    """What computes."""

    cpu = "cpu"
    cuda = "cuda"


def sweep(
    store: Annotated[
        Path, typer.Option(help="Zarr store: made if missing, else taken up where it was left.")
    ],
    file: Annotated[
        Path | None,
        typer.Argument(
            metavar="FILE.toml",
            help="Scenario file: the slider, and what is swept.  --status can do without.",
            show_default=False,
        ),
    ] = None,
    chunk: Annotated[
        int | None,
        typer.Option(help="Cases in a chunk.", show_default="by a probe of the cost", min=1),
    ] = None,
    status: Annotated[
        bool, typer.Option("--status", help="Only tell what the store holds.")
    ] = False,
    scheduler: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS",
            help="Run on the Dask cluster of this scheduler, such as tcp://node1:8786.",
        ),
    ] = None,
    slurm: Annotated[
        str | None,
        typer.Option(
            metavar="OPTIONS",
            help="Run in SLURM jobs, such as jobs=10,cores=16,memory=32GB; also walltime=02:00:00, "
            "queue=NAME, account=NAME, processes=N, interface=ib0.",
        ),
    ] = None,
    job_script: Annotated[
        bool, typer.Option("--job-script", help="Only print the job script that --slurm submits.")
    ] = False,
    device: Annotated[Device, typer.Option(help="What computes.")] = Device.cpu,
) -> None:
    """Run the sweep of a scenario file, or go on with it.

    Results are stored as they come: after Ctrl-C or a crash the same command resumes.

    Exit codes: 0 all cases have an answer, 2 error, 3 some cases failed, 130 interrupted.

    Example: ratestate sweep examples/fig3.toml --store fig3.zarr
    """
    if scheduler and slurm:
        raise typer.BadParameter("it cannot go with --scheduler", param_hint="--slurm")
    if job_script and not slurm:
        raise typer.BadParameter("it needs --slurm OPTIONS", param_hint="--job-script")
    with ending_well(lambda: left(store)):
        if slurm and job_script:
            _print_job_script(slurm)
        elif status:
            tell(store, file)
        elif file is None:
            raise typer.BadParameter(
                "missing; only --status can do without", param_hint="FILE.toml"
            )
        elif _run(file, store, scheduler, slurm, chunk=chunk, device=device.value):
            raise typer.Exit(SOME_FAILED)


def _run(
    file: Path, store: Path, scheduler: str | None, slurm: str | None, **how: int | str | None
) -> int:
    """Run what the file asks for and say how it went; the number of failed cases."""
    from ..scenario import load
    from ..sweeps.status import failures, held
    from ..sweeps.verb import sweep as run

    asked = load(file)
    with _client(scheduler, slurm) as client:
        how |= {"client": client, "progress": True}
        result = run(asked.verb, asked.slider, store=store, **how, **asked.settings)
    there = held(store)
    typer.echo(summary(there))
    if there.failed:
        first, number = failures(result, most=LISTED)
        for where, name, message in first:
            typer.echo(f"  {place(where)}: {name}: {message}")
        if number > len(first):
            typer.echo(f"  and {number - len(first)} more")
    return there.failed


@contextlib.contextmanager
def _client(scheduler: str | None, slurm: str | None) -> Iterator[Any]:
    """The Dask client asked for, closed in the end; None for threads of this process."""
    with contextlib.ExitStack() as until_done:
        if slurm:
            from ..sweeps.connect import slurm_cluster

            scheduler = until_done.enter_context(slurm_cluster(slurm)).scheduler_address
        if not scheduler:
            yield None
            return
        from ..sweeps.connect import client_of

        yield until_done.enter_context(client_of(scheduler))


def _print_job_script(slurm: str) -> None:
    """Print what --slurm submits, without submitting it."""
    from ..sweeps.connect import slurm_cluster

    with slurm_cluster(slurm, start=False) as cluster:
        typer.echo(cluster.job_script())
