"""Commands on the slider of a file: ``run``, ``stability``, ``response``, ``cycle``, ``branch``."""

import dataclasses
from pathlib import Path
from typing import Any

import typer

from .options import Outputs, register_file


def run(file: Path | None = None, *, source: Path | None = None, outputs: Outputs) -> None:
    """Simulate the loading of a scenario file, or compute its sweep in memory.

    Without --out and --plot, the files named in the table [output] are written.

    Example: ratestate run lab.toml --plot lab.png
    """
    from .run_scenario import load_scenario, note_sweep, run_and_report, wanted_units

    units = wanted_units(outputs.units)
    if source is not None and file is None:
        from ...files import read
        from ...scenario import from_result

        register_file(outputs.law_file)
        scenario = from_result(read(source))
    elif file is not None and source is None:
        scenario = load_scenario(file, None, outputs.law_file)
        note_sweep(scenario)
    else:
        raise typer.BadParameter("give either a file or --from RESULT", param_hint="FILE.toml")
    run_and_report(scenario, outputs, units)


def stability(file: Path, *, outputs: Outputs) -> None:
    """Find whether steady sliding is stable at the speed at the end of the loading.

    Example: ratestate stability lab.toml
    """
    _call(file, "stability", outputs)


def response(file: Path, *, frequency: list[str] | None = None, outputs: Outputs) -> None:
    """Find how steady sliding responds to small oscillations of speed and normal stress.

    The mean speed is the speed at the end of the loading, at which sliding must be stable.

    Example: ratestate response record.toml --plot response.png
    """
    texts = [text.strip() for option in frequency or [] for text in option.split(",")]
    given: dict[str, Any] = {"frequency": texts} if texts else {}
    _call(file, "frequency_response", outputs, **given)


def cycle(file: Path, *, outputs: Outputs) -> None:
    """Find the limit cycle that the slider reaches at the speed at the end of the loading.

    Example: ratestate cycle brake.toml --plot cycle.png
    """
    _call(file, "limit_cycle", outputs)


def branch(
    file: Path,
    *,
    parameter: str | None = None,
    start: str | None = None,
    stop: str | None = None,
    outputs: Outputs,
) -> None:
    """Follow limit cycles, stable and unstable, while a parameter changes.

    Example: ratestate branch brake.toml --start "50 mm/s" --stop "3 cm/s"
    """
    if parameter is start is stop is None:
        _call(file, "continue_cycle", outputs)
    elif start is None or stop is None:
        raise typer.BadParameter("both are needed", param_hint="--start and --stop")
    else:
        changes = {"parameter": parameter or "V_lp", "start": start, "stop": stop}
        _call(file, "limit_cycle", outputs, **changes)


def _call(file: Path, function: str, outputs: Outputs, **changes: Any) -> None:
    """Call a function with a file's scenario, whose own function and [output] are ignored."""
    from ...scenario import Output
    from .run_scenario import load_scenario, note_sweep, run_and_report, wanted_units

    units = wanted_units(outputs.units)
    scenario = load_scenario(file, function, outputs.law_file)
    settings = scenario.settings | changes
    if "parameter" in changes:  # from a limit cycle to a branch
        function = "continue_cycle"
        if changes["parameter"] == "V_lp":
            settings.pop("V_lp")
    scenario = dataclasses.replace(scenario, function=function, settings=settings, output=Output())
    note_sweep(scenario)
    run_and_report(scenario, outputs, units)
