"""``ratestate sweep``: a scenario file's sweep into a store, and the status of a store."""

import contextlib
from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from .exits import SOME_FAILED, on_interrupt
from .options import Json, Out, Plot, option
from .output import print_line
from .store_report import interrupted_message, print_outcome, print_status

Device = Literal["cpu", "cuda"]


def sweep(
    store: Annotated[
        Path, typer.Option(help="Zarr store: made if missing, else resumed where it was left.")
    ],
    file: Annotated[
        Path | None,
        typer.Argument(
            metavar="FILE.toml",
            help="Scenario file: the slider, and what is swept.  --status can do without.",
        ),
    ] = None,
    chunk: Annotated[
        int | None,
        typer.Option(help="Cases in a chunk.", show_default="measured on a sample", min=1),
    ] = None,
    status: Annotated[
        bool, typer.Option("--status", help="Only print the status of the store.")
    ] = False,
    verify: Annotated[
        bool,
        typer.Option(
            "--verify", help="With --status: read all files, and exit with 2 if any is damaged."
        ),
    ] = False,
    mixed: Annotated[
        bool,
        typer.Option(
            "--mixed",
            help="Go on with what other versions or another kind of processor began, and take "
            "workers of several kinds; last digits may differ.",
        ),
    ] = False,
    scheduler: Annotated[
        str | None,
        option("ADDRESS", "Run on the Dask cluster of this scheduler, such as tcp://node1:8786."),
    ] = None,
    slurm: Annotated[
        str | None,
        option(
            "OPTIONS",
            "Run in SLURM jobs, such as jobs=10,cores=16,memory=32GB; also walltime=02:00:00, "
            "queue=NAME, account=NAME, processes=N, interface=ib0; and for those that are lost, "
            "replacements=N, wait=24:00:00.",
        ),
    ] = None,
    job_script: Annotated[
        bool, typer.Option("--job-script", help="Only print the job script that --slurm submits.")
    ] = False,
    retry_crashed: Annotated[
        bool, typer.Option("--retry-crashed", help="Compute crashed cases of the store again.")
    ] = False,
    device: Annotated[Device, typer.Option(help="What computes.")] = "cpu",
    out: Out = None,
    plot: Plot = None,
    json: Json = False,
) -> None:
    """Run the sweep of a scenario file, or resume it.

    Results are stored as they are computed: after Ctrl-C or a crash the same command resumes.

    Example: ratestate sweep examples/fig3.toml --store fig3.zarr
    """
    if scheduler and slurm:
        raise typer.BadParameter("it cannot go with --scheduler", param_hint="--slurm")
    if job_script and not slurm:
        raise typer.BadParameter("it needs --slurm OPTIONS", param_hint="--job-script")
    if verify and not status:
        raise typer.BadParameter("it needs --status", param_hint="--verify")
    with on_interrupt(lambda: interrupted_message(store)):
        if slurm and job_script:
            _print_job_script(slurm)
        elif status:
            print_status(store, file, json, verify)
        elif file is None:
            raise typer.BadParameter(
                "missing; only --status can do without", param_hint="FILE.toml"
            )
        else:
            from ...sweeps.sweep import sweep as run
            from .run_scenario import draw_plot, load_scenario, output_paths, write_result

            scenario = load_scenario(file)
            output = output_paths(scenario, out, plot)
            with _client(scheduler, slurm) as client:
                how: dict[str, Any] = {"client": client, "chunk": chunk, "device": device}
                how |= {"mixed": mixed, "retry_crashed": retry_crashed, **scenario.settings}
                result = run(scenario.verb, scenario.slider, store=store, progress=True, **how)
                number = print_outcome(store, result, json)
                write_result(result, output)
                draw_plot(result, output)
            if number:
                raise typer.Exit(SOME_FAILED)


def _client(scheduler: str | None, slurm: str | None) -> Any:
    """A context with the requested Dask client; with None for threads of this process."""
    if not (slurm or scheduler):
        return contextlib.nullcontext()
    from ...sweeps.connect import client_of, slurm_client

    return slurm_client(slurm) if slurm else client_of(scheduler)


def _print_job_script(slurm: str) -> None:
    """Print what --slurm submits, without submitting it."""
    from ...sweeps.connect import slurm_cluster

    with slurm_cluster(slurm, start=False) as cluster:
        print_line(cluster.job_script())
