"""``ratestate fit``: a laboratory record, and the friction parameters in it."""

import enum
from pathlib import Path
from typing import Annotated, Any

import typer

from .exits import SOME_FAILED
from .options import Json


class Against(enum.StrEnum):
    """Where friction is compared."""

    time = "time"
    displacement = "displacement"
    cycles = "cycles"


class Trend(enum.StrEnum):
    """Along what friction drifts as well."""

    slip = "slip"
    time = "time"
    none = "none"


class Start(enum.StrEnum):
    """How the record begins."""

    auto = "auto"
    steady = "steady"
    free = "free"


class Errors(enum.StrEnum):
    """Where intervals come from."""

    auto = "auto"
    covariance = "covariance"
    profile = "profile"
    posterior = "posterior"


def _value(symbol: str, what: str, default: str) -> Any:
    """The option of a parameter of the slider."""
    return typer.Option(f"--{symbol}", metavar="VALUE", help=what, show_default=default)


FREE = "Where the search begins, or its value if it is not free."


def fit(
    file: Annotated[
        Path,
        typer.Argument(
            metavar="FILE",
            help="Record: text with columns, HDF5 or MAT.",
            show_default=False,
        ),
    ],
    law: Annotated[
        list[str] | None,
        typer.Option(
            metavar="LAWS",
            help="Evolution law: slip, aging, or slip,aging for both, side by side.",
            show_default="slip",
        ),
    ] = None,
    free: Annotated[
        str, typer.Option(metavar="SYMBOLS", help="What is found, of a, b, Dc, K, M and lag.")
    ] = "a,b,Dc,K",
    sigma: Annotated[
        str | None, _value("sigma", "Normal stress.", "the median of the record's")
    ] = None,
    a: Annotated[str | None, _value("a", FREE, "0.01")] = None,
    b: Annotated[str | None, _value("b", FREE, "0.01")] = None,
    Dc: Annotated[str | None, _value("Dc", FREE, "10 um")] = None,
    K: Annotated[str | None, _value("K", FREE, "sigma times 3000/m")] = None,
    M: Annotated[str | None, _value("M", "Mass per area; as the others.", "0")] = None,
    V0: Annotated[
        str | None, _value("V0", "Speed at which friction is mu0 if steady.", "1 um/s")
    ] = None,
    time: Annotated[
        str | None,
        typer.Option(
            metavar="START,END",
            help="Part of the record, such as '11640 s,11720 s'; either may be left out.",
            show_default="all",
        ),
    ] = None,
    displacement: Annotated[
        str | None,
        typer.Option(
            metavar="START,END", help="The same, such as '8600 um,8900 um'.", show_default="all"
        ),
    ] = None,
    columns: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=COLUMN",
            help="Title or number (from 1 on) of the column of time, delta_lp, V_load, friction, "
            "tau or sigma; repeat it for more.",
            show_default="by their titles",
        ),
    ] = None,
    units: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=UNIT",
            help="Unit of such a column, such as delta_lp=um; repeat it for more.",
            show_default="by their titles",
        ),
    ] = None,
    against: Annotated[
        Against, typer.Option(help="Where friction is compared; cycles: of stick-slip, vibration.")
    ] = Against.time,
    trend: Annotated[Trend, typer.Option(help="Along what friction drifts as well.")] = Trend.slip,
    start: Annotated[
        Start, typer.Option(help="Whether the record begins in steady sliding.")
    ] = Start.auto,
    noise: Annotated[
        str | None,
        typer.Option(
            metavar="VALUE",
            help="Standard deviation of the noise in friction; or, with correlated noise, such as "
            "'white=3e-4,red=2e-4,time=0.5 s'.",
            show_default="found from the residuals",
        ),
    ] = None,
    errors: Annotated[
        Errors,
        typer.Option(
            help="Where intervals come from; auto: from profiles of the likelihood where it is "
            "not Gaussian; posterior: from samples."
        ),
    ] = Errors.auto,
    out: Annotated[
        Path | None,
        typer.Option(
            help="Folder for report.md, fit.png and fit.nc (all numbers); made if missing.",
            show_default=False,
        ),
    ] = None,
    json: Json = False,
) -> None:
    """Fit friction parameters to a laboratory record of velocity steps, holds or stick-slip.

    It ends with code 3 where an answer carries warnings; they are printed with it.

    Example: ratestate fit examples/velocity_step.txt --out fitted
    """
    from .fit_request import FitRequest, laws, numbered, pair, pairs
    from .run_fit import fit_and_report

    request = FitRequest(
        file,
        {"columns": numbered(pairs(columns, "--columns")), "units": pairs(units, "--units")},
        {"time": pair(time, "--time"), "displacement": pair(displacement, "--displacement")},
        dict(zip("sigma a b Dc K M V0".split(), (sigma, a, b, Dc, K, M, V0), strict=True)),
        tuple(name.strip() for name in free.split(",") if name.strip()),
        laws(law, "--law"),
        {
            "against": against.value,
            "trend": None if trend is Trend.none else trend.value,
            "start": start.value,
            "errors": errors.value,
        },
        noise,
    )
    if fit_and_report(request, out, json):
        raise typer.Exit(SOME_FAILED)
