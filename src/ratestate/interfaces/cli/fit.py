"""``ratestate fit``: a laboratory record, and the friction parameters in it."""

from pathlib import Path
from typing import Annotated, Any, Literal, get_args

import typer

from .exits import SOME_FAILED
from .options import Json, Law, option

Against = Literal["time", "displacement", "cycles"]
Trend = Literal["slip", "time", "none"]
Start = Literal["auto", "steady", "free"]
Errors = Literal["auto", "covariance", "profile", "posterior"]
FREE = "Where the search begins, or its value if it is not free."
V0_MEANS = "Speed at which friction is mu0 if steady."


def fit(
    file: Annotated[
        Path, typer.Argument(metavar="FILE", help="Record: text with columns, HDF5 or MAT.")
    ],
    law: Annotated[
        list[str] | None,
        option("LAWS", "Evolution law: slip, aging, or slip,aging for both, side by side.", "slip"),
    ] = None,
    free: Annotated[
        str, option("SYMBOLS", "What is found, of a, b, Dc, K, M and lag.")
    ] = "a,b,Dc,K",
    sigma: Annotated[
        str | None, option("VALUE", "Normal stress.", "the median of the record's")
    ] = None,
    a: Annotated[str | None, option("VALUE", FREE, "0.01")] = None,
    b: Annotated[str | None, option("VALUE", FREE, "0.01")] = None,
    Dc: Annotated[str | None, option("VALUE", FREE, "10 um", "--Dc")] = None,
    K: Annotated[str | None, option("VALUE", FREE, "sigma times 3000/m", "--K")] = None,
    M: Annotated[str | None, option("VALUE", "Mass per area; as the others.", "0", "--M")] = None,
    V0: Annotated[str | None, option("VALUE", V0_MEANS, "1 um/s", "--V0")] = None,
    time: Annotated[
        str | None,
        option(
            "START,END",
            "Part of the record, such as '11640 s,11720 s'; either may be left out.",
            "all",
        ),
    ] = None,
    displacement: Annotated[
        str | None, option("START,END", "The same, such as '8600 um,8900 um'.", "all")
    ] = None,
    columns: Annotated[
        list[str] | None,
        option(
            "NAME=COLUMN",
            "Title or number (from 1 on) of the column of time, delta_lp, V_load, friction, "
            "tau or sigma; repeat it for more.",
            "by their titles",
        ),
    ] = None,
    units: Annotated[
        list[str] | None,
        option(
            "NAME=UNIT",
            "Unit of such a column, such as delta_lp=um; repeat it for more.",
            "by their titles",
        ),
    ] = None,
    against: Annotated[
        Against, typer.Option(help="Where friction is compared; cycles: of stick-slip, vibration.")
    ] = "time",
    trend: Annotated[Trend, typer.Option(help="Along what friction drifts as well.")] = "slip",
    start: Annotated[
        Start, typer.Option(help="Whether the record begins in steady sliding.")
    ] = "auto",
    noise: Annotated[
        str | None,
        option(
            "VALUE",
            "Standard deviation of the noise in friction; or, with correlated noise, such as "
            "'white=3e-4,red=2e-4,time=0.5 s'.",
            "found from the residuals",
        ),
    ] = None,
    errors: Annotated[
        Errors,
        typer.Option(
            help="Where intervals come from; auto: from profiles of the likelihood where it is "
            "not Gaussian; posterior: from samples."
        ),
    ] = "auto",
    out: Annotated[
        Path | None,
        typer.Option(
            help="Folder for report.md, fit.png and fit.nc (all numbers); made if missing."
        ),
    ] = None,
    json: Json = False,
) -> None:
    """Fit friction parameters to a laboratory record of velocity steps, holds or stick-slip.

    It ends with code 3 where an answer carries warnings; they are printed with it.

    Example: ratestate fit examples/velocity_step.txt --out fitted
    """
    from .report.markdown import FitRequest
    from .run_fit import fit_and_report

    numbered = {k: int(v) if v.isdigit() else v for k, v in _pairs(columns, "--columns").items()}
    reading = {
        "columns": numbered,
        "units": _pairs(units, "--units"),
        "time": _window(time, "--time"),
        "displacement": _window(displacement, "--displacement"),
    }
    values = {"sigma": sigma, "a": a, "b": b, "Dc": Dc, "K": K, "M": M, "V0": V0}
    laws = _laws(law)
    fitting = {
        "free": tuple(name.strip() for name in free.split(",") if name.strip()),
        "law": laws if len(laws) > 1 else laws[0],
        "against": against,
        "trend": None if trend == "none" else trend,
        "start": start,
        "errors": errors,
        "noise": _noise(noise),
    }
    given = {symbol: value for symbol, value in values.items() if value is not None}
    request = FitRequest(file, {k: v for k, v in reading.items() if v}, given, laws, fitting)
    if fit_and_report(request, out, json):
        raise typer.Exit(SOME_FAILED)


def _laws(texts: list[str] | None) -> tuple[str, ...]:
    """The laws, each once, from strings with one or several laws separated by commas."""
    names = [name.strip() for text in texts or ["slip"] for name in text.split(",")]
    for name in names:
        if name not in get_args(Law):
            raise typer.BadParameter(
                f"{name!r} is no law; choose slip, aging or slip,aging", param_hint="--law"
            )
    return tuple(dict.fromkeys(names))


def _window(text: str | None, option: str) -> tuple[str | None, str | None] | None:
    """START,END as two values, either of which may be omitted."""
    if text is None:
        return None
    ends = [end.strip() or None for end in text.split(",")]
    if len(ends) != 2 or ends == [None, None]:
        raise typer.BadParameter(
            f"{text!r} is not START,END, such as '11640 s,11720 s' or '11640 s,'",
            param_hint=option,
        )
    return ends[0], ends[1]


def _pairs(texts: list[str] | None, option: str) -> dict[str, str]:
    """Strings of the form NAME=TEXT as a dict."""
    named: dict[str, str] = {}
    for text in texts or []:
        name, sign, value = (part.strip() for part in text.partition("="))
        if not (name and sign and value):
            raise typer.BadParameter(f"{text!r} has no NAME=...", param_hint=option)
        named[name] = value
    return named


def _noise(text: str | None) -> Any:
    """The noise as `ratestate.fit` takes it."""
    if text is None or "=" not in text:
        return text
    parts = (part.partition("=") for part in text.split(","))
    return {name.strip(): value.strip() for name, _, value in parts}
