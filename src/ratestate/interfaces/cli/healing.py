"""``ratestate healing``: healing and relaxation in the holds of a laboratory record."""

from pathlib import Path
from typing import Any, Literal

import typer

from .exits import SOME_FAILED
from .reading import Reading, noise_of

Trend = Literal["slip", "time", "none"]
#: the files' name
NAME = "healing"


def healing(
    files: list[Path],
    *,
    slider: Path | None = None,
    reading: Reading,
    trend: Trend = "slip",
    noise: str | None = None,
    out: Path | None = None,
    json: bool = False,
) -> None:
    """Evaluate slide-hold-slide tests: healing and relaxation of each hold, and their rates.

    It ends with code 3 where a hold cannot be evaluated; the reasons are printed.

    Example: ratestate healing holds.txt --out healed
    """
    from ...files import read
    from ...records.healing.healing import healing as evaluate
    from ...report import summary
    from .document import document
    from .evaluate_record import reported, write_all
    from .output import print_json, print_rich

    settings: dict[str, Any] = {
        "trend": None if trend == "none" else trend,
        "noise": noise_of(noise),
    }
    fitted = read(slider) if slider else None
    with reported(NAME, files, reading, out) as (record, made):
        result = evaluate(record, fitted, **settings)
        made += write_all(result, out, NAME, "hold")
    if json:
        print_json(document(result, None))
    else:
        print_rich(*summary(result))
    if bool((result["hold_status"] != 0).any()):
        raise typer.Exit(SOME_FAILED)
