"""Commands on a record: ``fit``, ``events``, ``healing``, ``stiffness``, ``lab describe``."""

import json as json_texts
import warnings
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import typer

from ...errors import RecordWarning
from ...friction.laws import DEFAULT, friction_law, own_parameters
from .exits import SOME_FAILED
from .options import FileReading, Reading, laws_of, noise_of, own_values, read_record
from .output import folder, names_of, print_line, reporting_files, write_text

if TYPE_CHECKING:
    import xarray

Against = Literal["time", "displacement", "cycles"]
Trend = Literal["slip", "time", "none"]
Start = Literal["auto", "steady", "free"]
Errors = Literal["auto", "covariance", "profile", "posterior"]


def fit(
    files: list[Path],
    *,
    law: list[str] | None = None,
    law_file: Path | None = None,
    free: str = "a,b,Dc,K",
    sigma: str | None = None,
    a: str | None = None,
    b: str | None = None,
    Dc: str | None = None,
    K: str | None = None,
    M: str | None = None,
    V0: str | None = None,
    of_law: list[str] | None = None,
    reading: Reading,
    per_step: bool = False,
    against: Against = "time",
    trend: Trend = "slip",
    start: Start = "auto",
    noise: str | None = None,
    errors: Errors = "auto",
    out: Path | None = None,
    json: bool = False,
) -> None:
    """Fit friction parameters to a laboratory record of velocity steps, holds or stick-slip.

    Warnings are printed with the result, and the exit code is then 3.

    Example: ratestate fit record.txt --per-step --out fitted
    """
    values = {"sigma": sigma, "a": a, "b": b, "Dc": Dc, "K": K, "M": M, "V0": V0}
    named = (name.strip() for text in law or () for name in text.split(","))
    laws = laws_of(named, law_file, [DEFAULT])
    fitting = {
        "free": tuple(name.strip() for name in free.split(",") if name.strip()),
        "law": laws if len(laws) > 1 else laws[0],
        "per_step": per_step,
        "against": against,
        "trend": None if trend == "none" else trend,
        "start": start,
        "errors": errors,
        "noise": noise_of(noise),
    }
    from .run_fit import FitRequest, fit_and_report

    values |= own_values(of_law, own_parameters(map(friction_law, laws)))
    given = {symbol: value for symbol, value in values.items() if value is not None}
    request = FitRequest(tuple(files), reading.keywords(), given, laws, fitting)
    if fit_and_report(request, out, json):
        raise typer.Exit(SOME_FAILED)


def events(
    files: list[Path],
    *,
    K: str | None = None,
    M: str | None = None,
    sigma: str | None = None,
    reading: Reading,
    out: Path | None = None,
    json: bool = False,
) -> None:
    """Find the stick-slip events of a laboratory record: stress drops, recurrence, slip, errors.

    Example: ratestate events record.txt --out catalogue
    """
    from ...records.stick_slip import events as find_events

    given = {"K": K, "M": M, "sigma": sigma}
    given = {name: value for name, value in given.items() if value is not None}

    def evaluate(record: "xarray.Dataset") -> "xarray.Dataset":
        # what the format says of the machine holds where nothing else is given
        return find_events(record, **json_texts.loads(record.attrs.get("machine", "{}")) | given)

    _evaluate("events", evaluate, "event", files, reading, sigma, out, json)


def healing(
    files: list[Path],
    *,
    slider: Path | None = None,
    sigma: str | None = None,
    reading: Reading,
    trend: Trend = "slip",
    noise: str | None = None,
    out: Path | None = None,
    json: bool = False,
) -> None:
    """Evaluate slide-hold-slide tests: healing and relaxation of each hold, and their rates.

    If a hold cannot be evaluated, the reason is printed, and the exit code is 3.

    Example: ratestate healing holds.txt --out healed
    """
    from ...files import read
    from ...records.healing.healing import healing as find_healing

    settings = {"trend": None if trend == "none" else trend, "noise": noise_of(noise)}
    fitted = read(slider) if slider else None

    evaluate = partial(find_healing, slider=fitted, **settings)
    result = _evaluate("healing", evaluate, "hold", files, reading, sigma, out, json)
    if bool((result["hold_status"] != 0).any()):
        raise typer.Exit(SOME_FAILED)


def stiffness(
    files: list[Path],
    *,
    sigma: str | None = None,
    reading: Reading,
    out: Path | None = None,
    json: bool = False,
) -> None:
    """Find stiffness, mass and damping of a machine from loading slopes and ring-downs in a record.

    Example: ratestate stiffness holds.txt --sigma '10 MPa'
    """
    from ...records.machine.machine_stiffness import machine_stiffness

    evaluate = partial(machine_stiffness, sigma=sigma)
    _evaluate("stiffness", evaluate, "slope", files, reading, sigma, out, json)


def describe(
    file: Path,
    *,
    sigma: str | None = None,
    K: str | None = None,
    M: str | None = None,
    reading: FileReading,
) -> None:
    """Print a description of a laboratory's files, for --lab-format of other commands.

    Example: ratestate lab describe record.txt
    """
    from ...records.reading.lab_format import describe_lab

    print_line(describe_lab(file, sigma=sigma, K=K, M=M, **reading.keywords()).rstrip("\n"))


def _evaluate(
    name: str,
    evaluate: "Callable[[xarray.Dataset], xarray.Dataset]",
    dim: str,
    files: list[Path],
    reading: Reading,
    sigma: str | None,
    out: Path | None,
    json: bool,
) -> "xarray.Dataset":
    """Read a record, evaluate it, write the files into the folder, if any, and print the result."""
    from ...report import summary
    from .document import document
    from .output import print_json, print_rich

    keywords = reading.keywords()
    with folder(out), reporting_files(f"{name} of {names_of(files)}") as written:
        with warnings.catch_warnings():
            warnings.simplefilter("always", RecordWarning)
            record, _ = read_record(files if len(files) > 1 else files[0], keywords, sigma)
        result = evaluate(record)
        written += _write_all(result, out, name, dim)
    if json:
        print_json(document(result, None))
    else:
        print_rich(*summary(result))
    return result


def _write_all(result: "xarray.Dataset", out: Path | None, name: str, dim: str) -> list[Path]:
    """Write a result as NAME.nc and NAME.png, and its tables; return the paths.

    NAME.csv has a row for each value along a dimension, NAME_summary.csv one for each quantity of
    the whole record.
    """
    if not out:
        return []
    from ... import plot
    from ...files import laboratory_csv, write
    from ...report.summary_csv import summary_csv

    table = laboratory_csv(_by_law(result, dim), dim)
    return [
        write(result, out / f"{name}.nc"),
        plot.save(plot.figure(result), out / f"{name}.png"),
        write_text(out / f"{name}.csv", table),
        write_text(out / f"{name}_summary.csv", summary_csv(result)),
    ]


def _by_law(result: "xarray.Dataset", dim: str) -> "xarray.Dataset":
    """Return a result whose variables of several laws are split into one for each law."""
    table = result.copy()
    for name, variable in result.data_vars.items():
        if set(variable.dims) == {"law", dim}:
            for law in result["law"].values.tolist():
                table[f"{name}_{law}"] = variable.sel(law=law, drop=True)
    return table
