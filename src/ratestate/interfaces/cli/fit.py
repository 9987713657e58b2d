"""``ratestate fit``: a laboratory record, and the friction parameters in it."""

from pathlib import Path
from typing import Literal

import typer

from ...friction.laws import DEFAULT, friction_law, own_parameters
from .command import laws_of, own_values
from .exits import SOME_FAILED
from .reading import Reading, noise_of

Each = Literal["step"]
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
    each: Each | None = None,
    against: Against = "time",
    trend: Trend = "slip",
    start: Start = "auto",
    noise: str | None = None,
    errors: Errors = "auto",
    out: Path | None = None,
    json: bool = False,
) -> None:
    """Fit friction parameters to a laboratory record of velocity steps, holds or stick-slip.

    It ends with code 3 where an answer carries warnings; they are printed with it.

    Example: ratestate fit record.txt --each step --out fitted
    """
    values = {"sigma": sigma, "a": a, "b": b, "Dc": Dc, "K": K, "M": M, "V0": V0}
    named = (name.strip() for text in law or () for name in text.split(","))
    laws = laws_of(named, law_file, [DEFAULT])
    fitting = {
        "free": tuple(name.strip() for name in free.split(",") if name.strip()),
        "law": laws if len(laws) > 1 else laws[0],
        "each": each,
        "against": against,
        "trend": None if trend == "none" else trend,
        "start": start,
        "errors": errors,
        "noise": noise_of(noise),
    }
    from .fit_report import FitRequest
    from .run_fit import fit_and_report

    values |= own_values(of_law, own_parameters(map(friction_law, laws)))
    given = {symbol: value for symbol, value in values.items() if value is not None}
    request = FitRequest(tuple(files), reading.keywords(), given, laws, fitting)
    if fit_and_report(request, out, json):
        raise typer.Exit(SOME_FAILED)
