"""``ratestate sweep``: a scenario file's sweep into a store, and the status of a store."""

import contextlib
from pathlib import Path
from typing import Any, Literal

import typer

from ...errors import ParameterError
from .exits import SOME_FAILED, on_interrupt
from .options import Outputs
from .output import print_line
from .store_report import interrupted_message, print_outcome, print_status

Device = Literal["cpu", "cuda"]


def sweep(
    file: Path | None = None,
    *,
    store: Path,
    chunk: int | None = None,
    status: bool = False,
    verify: bool = False,
    scheduler: str | None = None,
    slurm: str | None = None,
    job_script: bool = False,
    device: Device = "cpu",
    outputs: Outputs,
) -> None:
    """Run the sweep of a scenario file, or resume it.

    Results are stored as they are computed: after Ctrl-C or a crash the same command resumes.

    Example: ratestate sweep fig3.toml --store fig3.zarr
    """
    if scheduler and slurm:
        raise typer.BadParameter("it cannot go with --scheduler", param_hint="--slurm")
    if job_script and not slurm:
        raise typer.BadParameter("it needs --slurm OPTIONS", param_hint="--job-script")
    if verify and not status:
        raise typer.BadParameter("it needs --status", param_hint="--verify")
    with on_interrupt(lambda: interrupted_message(store)):
        if slurm and job_script:
            from ...sweeps.slurm import job_cluster

            with job_cluster(slurm) as cluster:
                print_line(cluster.job_script())
        elif status:
            print_status(store, file, outputs.law_file, outputs.json, verify)
        elif file is None:
            raise typer.BadParameter(
                "missing. Only --status works without it.", param_hint="FILE.toml"
            )
        else:
            from ...sweeps.sweep import sweep as run
            from .run_scenario import (
                draw_plot,
                in_numbers,
                load_scenario,
                output_paths,
                wanted_units,
                write_numbers,
            )

            own_units = wanted_units(outputs.units)
            scenario = load_scenario(file, None, outputs.law_file)
            output = output_paths(scenario, outputs.out, outputs.plot)
            with _client(scheduler) as client:
                how: dict[str, Any] = {"client": client, "slurm": slurm, "chunk": chunk}
                how |= {"device": device, **scenario.settings}
                result = run(scenario.function, scenario.slider, store=store, progress=True, **how)
                number = print_outcome(store, result, outputs.json)
                write_numbers(in_numbers(result, own_units), output)
                draw_plot(result, output)
            if number:
                raise typer.Exit(SOME_FAILED)


def _client(scheduler: str | None) -> Any:
    """Return a context with the client of a Dask scheduler, or with None."""
    if not scheduler:
        return contextlib.nullcontext()
    from ...sweeps.cluster import import_extra

    try:
        return import_extra("distributed").Client(scheduler, timeout="10s")
    except (OSError, ValueError) as error:
        raise ParameterError(
            f"scheduler = {scheduler!r} does not answer ({error}). Start one with "
            f"'dask scheduler', and give the address that it prints."
        ) from error
