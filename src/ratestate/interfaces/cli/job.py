"""From a scenario to what is printed and written: outputs checked first, then the work."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from ...errors import NotConverged, ParameterError, QuasiStaticInstability, SolverError
from .ends import SOME_FAILED
from .say import say, show
from .spoken import instead, spoken

if TYPE_CHECKING:
    import xarray

    from ..scenario import Output, Scenario
    from .spoken import Spoken


#: what a sweep in memory may take: of limit cycles, or of stability, some 2e7 cases
MOST_BYTES = 3 * 10**9


def scenario_of(file: Path, verb: str | None = None) -> "Scenario":
    """The scenario of a file, or of what standard input holds if that is what is named."""
    from ..scenario import LARGEST, load, loads

    if file != Path("-"):
        return load(file, verb)
    text = typer.get_binary_stream("stdin").read(LARGEST + 1)
    return loads(text, verb, name="standard input")


def do(asked: "Scenario", out: Path | None, plot: Path | None, json: bool) -> None:
    """Do what a scenario asks for, print the result, and write the files asked for."""
    output = places(asked, out, plot)
    problem = None
    try:
        result = perform(asked)
    except NotConverged as error:
        if error.best is None or asked.verb != "continue_cycle":
            raise
        problem, result = error, error.best  # a part of a branch is worth having
    keep(result, output)
    tell(result, None if axes(asked) else spoken(asked, result), json)
    draw(result, output)
    if problem:
        typer.echo(f"error: {problem}", err=True)
    from .document import failed

    if problem or failed(result):
        raise typer.Exit(SOME_FAILED)


def places(asked: "Scenario", out: Path | None, plot: Path | None) -> "Output":
    """Where the result goes: the options, or else what the scenario says; checked."""
    from ...files import NUMBERS, PICTURES, checked
    from ..scenario import Output

    file, picture = out or asked.output.file, plot or asked.output.plot
    if picture and len(dims := axes(asked)) > 2:
        raise ParameterError(
            f"a picture shows a sweep over one or two axes, and this one has {len(dims)} "
            f"({', '.join(dims)}); leave the plot out"
        )
    return Output(file and checked(file, NUMBERS), picture and checked(picture, PICTURES))


def axes(asked: "Scenario") -> list[str]:
    """Dimensions of a scenario's sweep; none for a single case."""
    from ...model.units import is_array

    loading = asked.settings.get("loading")
    values = [*asked.slider.values.values(), *asked.settings.values(), getattr(loading, "V", 0.0)]
    found = dict.fromkeys(str(dim) for value in values if is_array(value) for dim in value.dims)
    return [dim for dim in found if dim not in ("segment", "time")]


def perform(asked: "Scenario") -> "xarray.Dataset":
    """Do it; a sweep over all cores, and such that a case that fails costs itself only."""
    from ..scenario import run

    if not axes(asked):
        try:
            return run(asked)
        except (NotConverged, QuasiStaticInstability) as error:
            if asked.verb != "limit_cycle":
                raise
            raise SolverError(instead(asked, error)) from error
    from ...sweeps.calls import call_of
    from ...sweeps.solve import bytes_of_a_case, form_of
    from ...sweeps.verb import sweep

    _, call = call_of(asked.verb, asked.slider, asked.settings)
    cases, each = call.batch.n, bytes_of_a_case(form_of(call).kinds)
    if cases * each > MOST_BYTES:
        raise ParameterError(
            f"the results of {cases:,} cases take {cases * each / 1e9:.3g} GB, and no more than "
            f"{MOST_BYTES / 1e9:.3g} GB are kept in memory; use ratestate sweep FILE --store "
            f"x.zarr, or fewer cases"
        )
    progress = sys.stderr is not None and sys.stderr.isatty()
    return sweep(asked.verb, asked.slider, progress=progress, **asked.settings)


def keep(result: "xarray.Dataset", output: "Output") -> None:
    """Write the numbers where they are wanted, and say on stderr where they are."""
    from ...files import write

    if output.file:
        write(result, output.file)
        typer.echo(f"wrote {output.file}", err=True)


def tell(result: "xarray.Dataset", said: "Spoken | None", json: bool) -> None:
    """Print the result, and what is said of it in words."""
    if json:
        from .document import document

        say(document(result, said))
    else:
        from .report import report

        show(*report(result, said))


def draw(result: "xarray.Dataset", output: "Output") -> None:
    """Draw the picture where it is wanted, and say on stderr where it is."""
    if output.plot:
        from ... import plot

        plot.save(plot.page(result), output.plot)
        typer.echo(f"wrote {output.plot}", err=True)
