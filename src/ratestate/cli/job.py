"""From a scenario to what is printed and written: outputs checked first, then the work."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from ..errors import NotConverged, ParameterError
from .ends import SOME_FAILED
from .say import say, show

if TYPE_CHECKING:
    import xarray

    from ..scenario import Output, Scenario


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
    tell(result, spoken(asked, result), json)
    draw(result, output)
    if problem:
        typer.echo(f"error: {problem}", err=True)
    if problem or failed(result):
        raise typer.Exit(SOME_FAILED)


def places(asked: "Scenario", out: Path | None, plot: Path | None) -> "Output":
    """Where the result goes: the options, or else what the scenario says; checked."""
    from ..files import NUMBERS, PICTURES, checked
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
    from ..units import is_array

    loading = asked.settings.get("loading")
    values = [*asked.slider.values.values(), *asked.settings.values(), getattr(loading, "V", 0.0)]
    found = dict.fromkeys(str(dim) for value in values if is_array(value) for dim in value.dims)
    return [dim for dim in found if dim not in ("segment", "time")]


def perform(asked: "Scenario") -> "xarray.Dataset":
    """Do it; a sweep over all cores, and such that a case that fails costs itself only."""
    from ..scenario import run

    if not axes(asked):
        return run(asked)
    from ..sweeps.verb import sweep

    progress = sys.stderr is not None and sys.stderr.isatty()
    return sweep(asked.verb, asked.slider, progress=progress, **asked.settings)


def spoken(asked: "Scenario", result: "xarray.Dataset") -> Any:
    """The `Verdict` on a single slider, or None."""
    from ..verdict import judge, verdict

    if axes(asked) or asked.verb == "continue_cycle":
        return None
    if asked.verb == "limit_cycle":
        return judge(asked.slider, asked.settings["V_lp"], result)
    if asked.verb == "stability":
        return verdict(asked.slider, asked.settings["V_lp"])
    loading = asked.settings["loading"]
    if loading.sine is not None:
        return verdict(asked.slider, loading.sine.V_lp)
    V, rate = float(loading.V[-1]), float(loading.rate[-1])
    return verdict(asked.slider, V) if V > 0.0 and rate == 0.0 else None


def keep(result: "xarray.Dataset", output: "Output") -> None:
    """Write the numbers where they are wanted, and say on stderr where they are."""
    from ..files import write

    if output.file:
        write(result, output.file)
        typer.echo(f"wrote {output.file}", err=True)


def tell(result: "xarray.Dataset", judged: Any, json: bool) -> None:
    """Print the result, and the verdict if there is one."""
    if json:
        from .document import document

        say(document(result, judged))
    else:
        from .report import report

        show(*report(result, judged))


def draw(result: "xarray.Dataset", output: "Output") -> None:
    """Draw the picture where it is wanted, and say on stderr where it is."""
    if output.plot:
        from .. import plot

        plot.save(plot.page(result), output.plot)
        typer.echo(f"wrote {output.plot}", err=True)


def failed(result: "xarray.Dataset") -> int:
    """Number of cases without an answer."""
    from ..sweeps.solve import failed

    return failed(result.variables) if "message" in result else 0
