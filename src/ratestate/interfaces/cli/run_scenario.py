"""Run a scenario: check outputs, compute, print the result and write the files."""

import math
from pathlib import Path

import typer
import xarray

from ... import scenario as scenarios
from ...dynamics.progress import on_terminal
from ...dynamics.results import whole_contact
from ...dynamics.verdict import verdict
from ...errors import NotConverged, ParameterError, QuasiStaticInstability, SolverError
from ...files import NUMBERS, checked_path, write
from ...files.place import PICTURES
from ...model.conversion import find_variable, in_units
from ...model.names import one_of
from ...model.quantities import QUANTITIES
from ...model.units import is_array, to_si
from ...scenario import Output, Scenario
from ...scenario.files import LARGEST
from .document import document, failed
from .exits import FAILED, SOME_FAILED
from .options import Outputs, pairs_of
from .output import print_json, print_line, print_rich
from .verdict_text import VerdictText, verdict_text


def load_scenario(file: Path, function: str | None, law_file: Path | None) -> Scenario:
    """Return the scenario of a file, or of standard input for "-"."""
    if file != Path("-"):
        return scenarios.load(file, function, law_file=law_file)
    text = typer.get_binary_stream("stdin").read(LARGEST + 1)
    return scenarios.loads(text, function, name="standard input", law_file=law_file)


def run_and_report(scenario: Scenario, outputs: Outputs, units: dict[str, str]) -> None:
    """Run a scenario, print the result, and write the requested files.

    Raises `typer.Exit` with code 3 after a part of a branch, or if cases failed; with code 2 after
    a run that no quasi-static motion continues.

    units : symbol -> the unit in which it is printed and written, as by `wanted_units`
    """
    output = output_paths(scenario, outputs.out, outputs.plot)
    problem = None
    try:
        result = compute(scenario)
    except SolverError as error:
        if error.best is None:
            raise
        problem, result = error, error.best  # a part of a branch or run is useful
    numbers = in_numbers(result, units)
    verdict = None if swept_dims(scenario) else verdict_text(scenario, result)
    write_numbers(numbers, output)
    if outputs.json:
        print_json(document(numbers, verdict))
    else:
        print_report(result, verdict, units)
    draw_plot(result, output)
    if problem:
        print_line(f"error: {problem}", err=True)
    if isinstance(problem, QuasiStaticInstability):
        raise typer.Exit(FAILED)
    if problem or failed(result):
        raise typer.Exit(SOME_FAILED)


def output_paths(scenario: Scenario, out: Path | None, plot: Path | None) -> Output:
    """Return checked paths for the result: of the options, or else of the scenario.

    Raises ParameterError for another ending, no such folder, or a plot of more than two axes.
    """
    file, picture = out or scenario.output.file, plot or scenario.output.plot
    if picture and len(dims := swept_dims(scenario)) > 2:
        raise ParameterError(
            f"a picture shows a sweep over one or two axes, and this one has {len(dims)} "
            f"({', '.join(dims)})",
            "Leave the plot out.",
        )
    return Output(file and checked_path(file, NUMBERS), picture and checked_path(picture, PICTURES))


def note_sweep(scenario: Scenario) -> None:
    """Say on stderr that the command computes all cases of a file's [sweep], if it has any."""
    sizes = swept_dims(scenario)
    if sizes and scenario.function != "continue_cycle":
        cases = math.prod(sizes.values())
        print_line(
            f"computing the [sweep] of the file, {cases:,} case{'s' if cases > 1 else ''}. For a "
            f"single case remove [sweep]. To keep the cases in a store use ratestate sweep.",
            err=True,
        )


def swept_dims(scenario: Scenario) -> dict[str, int]:
    """Return the dimensions of a scenario's sweep -> their sizes; {} for a single slider."""
    slider, settings = scenario.slider, scenario.settings
    speeds = getattr(settings.get("loading"), "V", 0.0)
    values = filter(is_array, [*slider.values.values(), *settings.values(), speeds])
    sizes = {str(dim): size for value in values for dim, size in value.sizes.items()}
    return {dim: size for dim, size in sizes.items() if dim not in ("segment", "time", "frequency")}


def compute(scenario: Scenario) -> xarray.Dataset:
    """Return the result of a scenario; a sweep uses all cores, and a failed case spoils no other.

    Raises ParameterError for branches over an axis and results that exceed the memory; SolverError,
    with the verdict on a limit cycle, if a single case has no answer.
    """
    dims = swept_dims(scenario)
    if dims and scenario.function == "continue_cycle":
        raise ParameterError(
            "a branch follows the cycles of one slider, but there are many values of "
            f"{' and '.join(dims)}",
            "Give one value of each.",
        )
    if not dims:
        try:
            return scenarios.run(scenario)
        except (NotConverged, QuasiStaticInstability) as error:
            if scenario.function != "limit_cycle":
                raise
            found = verdict(scenario.slider, scenario.settings["V_lp"], error)
            message = f"no cycle is found.\n{found.text}\n{scenario.slider!r}"
            raise SolverError(message) from error
    from ...sweeps.sweep import sweep

    return sweep(scenario.function, scenario.slider, progress=on_terminal(), **scenario.settings)


def wanted_units(texts: list[str] | None) -> dict[str, str]:
    """Return the units of the option --units, symbol -> unit; ParameterError for a wrong one."""
    units = pairs_of(texts, "--units", separator=",")
    for symbol, unit in units.items():
        if symbol not in QUANTITIES:
            raise ParameterError(f"--units: {symbol} is not a quantity", one_of(QUANTITIES, symbol))
        to_si(symbol, f"1 {unit}", label=f"--units {symbol}", bound="")
    return units


def in_numbers(result: xarray.Dataset, units: dict[str, str]) -> xarray.Dataset:
    """Return a result as it is written and printed: with the whole contact, in these units.

    Name units without a variable of the result on stderr; they have no effect.
    """
    numbers = result.assign(whole_contact(result).data_vars)
    found = {k: unit for k, unit in units.items() if find_variable(numbers, k) is not None}
    if absent := [name for name in units if name not in found]:
        print_line(f"--units: this result has no {', '.join(absent)}", err=True)
    return in_units(numbers, **found)


def write_numbers(numbers: xarray.Dataset, output: Output) -> None:
    """Write numbers to the output file, if there is one, and name it on stderr."""
    if output.file:
        write(numbers, output.file)
        print_line(f"wrote {output.file}", err=True)


def print_report(
    result: xarray.Dataset,
    verdict: VerdictText | None = None,
    units: dict[str, str] | None = None,
) -> None:
    """Print the result and the verdict as tables."""
    from rich.text import Text

    from ...report import summary

    blocks = [*summary(result, units)]
    if verdict and result.attrs["title"] == "ratestate simulate":
        blocks += [Text(), Text(f"{verdict.about}:", style="bold"), Text(verdict.text)]
    elif verdict:
        blocks = [Text(verdict.text), Text(), *blocks]
    print_rich(*blocks)


def draw_plot(result: xarray.Dataset, output: Output) -> None:
    """Draw the output plot, if there is one, and name it on stderr."""
    if output.plot:
        from ... import plot

        plot.save(plot.figure(result), output.plot)
        print_line(f"wrote {output.plot}", err=True)
