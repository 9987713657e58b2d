"""``ratestate sweep``: a scenario file's sweep into a store, and the status of a store."""

import contextlib
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import typer

from ...errors import ParameterError, StoreError
from .exits import SOME_FAILED
from .options import Outputs
from .output import print_json, print_line

if TYPE_CHECKING:
    import xarray

    from ...sweeps.status import StoreStatus

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
    """Compute the sweep of a scenario file into a store, or resume it.

    Results are stored as they are computed.  After Ctrl-C or a crash, run the same command again.

    Example: ratestate sweep fig3.toml --store fig3.zarr
    """
    if scheduler and slurm:
        raise typer.BadParameter("it cannot go with --scheduler", param_hint="--slurm")
    if job_script and not slurm:
        raise typer.BadParameter("it needs --slurm OPTIONS", param_hint="--job-script")
    if verify and not status:
        raise typer.BadParameter("it needs --status", param_hint="--verify")
    if slurm and job_script:
        from ...sweeps.slurm import job_cluster

        with job_cluster(slurm) as cluster:
            print_line(cluster.job_script())
    elif status:
        print_status(store, file, outputs.law_file, outputs.json, verify)
    elif file is None:
        raise typer.BadParameter("missing. Only --status works without it.", param_hint="FILE.toml")
    else:
        from ...sweeps.sweep import message_of_interrupt
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
            settings: dict[str, Any] = {"client": client, "slurm": slurm, "chunk": chunk}
            settings |= {"device": device, "progress": True, **scenario.settings}
            try:
                result = run(scenario.function, scenario.slider, store=store, **settings)
                number = print_outcome(store, result, outputs.json)
                write_numbers(in_numbers(result, own_units), output)
                draw_plot(result, output)
            except KeyboardInterrupt as interrupt:  # perhaps before or after `run` computes
                raise KeyboardInterrupt(str(interrupt) or message_of_interrupt(store)) from None
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


def print_outcome(store: Path, result: "xarray.Dataset", json: bool) -> int:
    """Print how a sweep into a store ended; return the number of failed cases."""
    from ...report.many_cases import failed_lines, outcomes, outside_lines
    from ...report.report import shown_units
    from ...sweeps.status import failures, store_status

    status = store_status(store)
    if json:
        failed, _ = failures(result, most=status.failed)
        names = ("at", "status", "message")
        _print_json(status, failures=[dict(zip(names, values, strict=True)) for values in failed])
    else:
        units = shown_units(result)
        outside = outside_lines(result, "cases", units)
        ends = outcomes(result["status"].values, status.function)
        failed_text = "" if status.failed else ", 0 failed"
        lines = [f"{status.cases:,} cases in {store}: {ends}{failed_text}", *outside]
        print_line("\n".join([*lines, *(failed_lines(result, units) if status.failed else [])]))
    return status.failed


def print_status(
    store: Path, file: Path | None, law_file: Path | None, json: bool, verify: bool = False
) -> None:
    """Print the status of a store, and whether a file has its sweep.

    verify : read all files; if any is damaged, a StoreError follows what is printed
    """
    from ...sweeps.status import store_status
    from ...sweeps.store import damage_message

    status = store_status(store, verify)
    differences = _differences(store, file, law_file) if file else []
    if json:
        _print_json(status, **({"differences": differences} if file else {}))
    else:
        rows = _rows(status)
        if file:
            request = "another sweep:" if differences else "this very sweep"
            rows["file"] = f"{file} asks for {request}"
        lines = [f"{label:<9} {text}" for label, text in rows.items()]
        print_line("\n".join([*lines, *(f"  {line}" for line in differences)]))
    if status.flaws:
        raise StoreError(damage_message(store, status.flaws))


def _print_json(status: "StoreStatus", **more: Any) -> None:
    """Print the status of a store, and more, as JSON."""
    flaws = None if status.flaws is None else list(map(str, status.flaws))
    print_json(status._asdict() | {"path": str(status.path), "flaws": flaws} | more)


def _rows(status: "StoreStatus") -> dict[str, str]:
    """The status of a store: label -> text."""
    from rich.filesize import decimal

    rows = {
        "store": str(status.path),
        "function": status.function,
        "axes": ", ".join(f"{dim} ({size})" for dim, size in status.dims.items()),
        "cases": str(status.cases),
        "done": f"{status.done} ({100 * status.done // status.cases} %)",
        "failed": str(status.failed),
        "steady": str(status.steady),
        "chunks": f"{status.chunks_done} of {status.chunks}",
        "versions": ", ".join(f"{name} {version}" for name, version in status.versions.items()),
        "size": decimal(status.size),
    }
    if status.processor:
        rows["processor"] = status.processor
    if status.flaws:
        rows["verified"] = f"damaged or missing files: {len(status.flaws)}"
    elif status.flaws is not None:
        rows["verified"] = "all files are intact"
    return rows


def _differences(store: Path, file: Path, law_file: Path | None) -> list[str]:
    """Differences of a file's sweep from a store's, as lines."""
    from ...sweeps.calls import call_of
    from ...sweeps.identity import arguments_of, differences
    from ...sweeps.store import Store
    from .run_scenario import load_scenario

    scenario = load_scenario(file, None, law_file)
    call = call_of(scenario.function, scenario.slider, scenario.settings)
    return differences(Store.open(store).arguments, arguments_of(*call))
