"""What ``ratestate fit`` does: reads, fits, prints, and writes the report with its files."""

import json
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import typer

from ..errors import FitWarning, ParameterError, RecordWarning
from ..quantities import readable
from .shared import Law, reported, writable

if TYPE_CHECKING:
    import xarray

    from ..slider import SpringSlider

#: where a search begins, for want of better: the least squares scan the record's sizes themselves
STARTS = {"a": "0.01", "b": "0.01", "Dc": "10 um"}
#: K over sigma [1/m], likewise
STIFFNESS = 3e3
#: what a record tells of itself that goes into the result
REPORT, PICTURE, NUMBERS = "report.md", "fit.png", "fit.nc"
#: how each report begins
HEADING = "# Fit of "


class Asked(NamedTuple):
    """A fit as it was asked for."""

    file: Path
    named: dict[str, Any]  # of read_lab
    window: dict[str, Any]  # of read_lab
    values: dict[str, str | None]  # of the slider, as they were given
    free: tuple[str, ...]
    laws: tuple[str, ...]
    settings: dict[str, Any]  # of fit
    noise: str | None

    @property
    def reading(self) -> dict[str, Any]:
        """Arguments of `read_lab` beside the file."""
        return {k: v for k, v in (self.named | self.window).items() if v}

    @property
    def fitting(self) -> dict[str, Any]:
        """Arguments of `fit` beside record and slider."""
        law = self.laws[0] if len(self.laws) == 1 else self.laws
        return {"free": self.free, "law": law, **self.settings, "noise": _noise(self.noise)}


def tell_and_write(asked: Asked, out: Path | None, as_json: bool) -> bool:
    """Fit, print, write; whether the answer carries warnings."""
    from ..fitting.lines import named
    from .job import tell

    if out:
        writable(out)
        _not_foreign(out / REPORT)
    with reported(f"fit of {asked.file.name}, {named(asked.laws)}") as files:
        record, slider, result = _result(asked)
        if out:
            files += _written(asked, record, slider, result, out)
    tell(result, None, as_json)
    return _warned(result)


def _result(asked: Asked) -> "tuple[xarray.Dataset, SpringSlider, xarray.Dataset]":
    """The record, the slider that the search began with, and the result."""
    from ..fitting.verb import fit
    from ..lab import read_lab

    with warnings.catch_warnings():
        # both stand in what is printed
        warnings.simplefilter("ignore", FitWarning)
        warnings.simplefilter("ignore", RecordWarning)
        record = read_lab(asked.file, **asked.reading)
        slider = _slider(asked, record)
        result = fit(record, slider, **asked.fitting)
    return record, slider, result


def _slider(asked: Asked, record: "xarray.Dataset") -> "SpringSlider":
    """What is not free, and where the search for the rest begins; the record notes a default."""
    from ..fitting.unknowns import checked_free
    from ..slider import SpringSlider
    from ..units import to_si

    given: dict[str, Any] = {s: value for s, value in asked.values.items() if value is not None}
    if "sigma" not in given:
        if "sigma" not in record:
            raise ParameterError(
                "the record has no normal stress, and none is given; add --sigma '20 MPa', or say "
                "which column it is: --columns sigma=TITLE"
            )
        given["sigma"] = float(record["sigma"].median())
        taken = f"sigma = {readable('sigma', given['sigma'])} is the median of the record's"
        notes = [*json.loads(record.attrs["notes"]), f"{taken}, for none was given"]
        record.attrs["notes"] = json.dumps(notes)
    K = STIFFNESS * to_si("sigma", given["sigma"])
    slider = SpringSlider(**{**STARTS, "K": K, **given}, law=asked.laws[0])
    free = checked_free(asked.free, slider)
    for symbol in ("a", "b", "Dc", "K"):
        if symbol not in given and symbol not in free:
            raise ParameterError(
                f"{symbol} is neither free nor given; add --{symbol} VALUE, or name it in --free"
            )
    return slider


def _warned(result: "xarray.Dataset") -> bool:
    return bool((result["warnings"] != "").any())


def _written(
    asked: Asked,
    record: "xarray.Dataset",
    slider: "SpringSlider",
    result: "xarray.Dataset",
    out: Path,
) -> list[Path]:
    """Write numbers, picture and report, each whole or not at all; the files."""
    from .. import plot
    from ..files import replace, write
    from .report.written import markdown

    text = markdown(asked, record, slider, result)
    return [
        write(result, out / NUMBERS),
        plot.save(plot.fit(result), out / PICTURE),
        replace(out / REPORT, lambda partial: partial.write_text(text, "utf-8")),
    ]


def _not_foreign(path: Path) -> None:
    """Refuse to replace a file that is no report of a fit."""
    if path.is_file() and not path.read_text("utf-8", errors="replace").startswith(HEADING):
        raise ParameterError(
            f"{path} exists and is no report of ratestate fit; it is not replaced: give another "
            f"folder with --out"
        )


def laws(texts: list[str] | None, option: str) -> tuple[str, ...]:
    """The laws, each once, from as many texts, with commas between some or not."""
    found = [name.strip() for text in texts or ["slip"] for name in text.split(",")]
    for name in found:
        if name not in [*Law]:
            raise typer.BadParameter(
                f"{name!r} is no law; choose slip, aging or slip,aging", param_hint=option
            )
    return tuple(dict.fromkeys(found))


def pair(text: str | None, option: str) -> tuple[str | None, str | None] | None:
    """START,END as two values, of which either may be left out."""
    if text is None:
        return None
    ends = [end.strip() or None for end in text.split(",")]
    if len(ends) != 2 or ends == [None, None]:
        raise typer.BadParameter(
            f"{text!r} is not START,END, such as '11640 s,11720 s' or '11640 s,'",
            param_hint=option,
        )
    return ends[0], ends[1]


def pairs(texts: list[str] | None, option: str) -> dict[str, str]:
    """NAME=TEXT, each, as a dict."""
    found: dict[str, str] = {}
    for text in texts or []:
        name, sign, value = (part.strip() for part in text.partition("="))
        if not (name and sign and value):
            raise typer.BadParameter(f"{text!r} has no NAME=...", param_hint=option)
        found[name] = value
    return found


def numbered(columns: dict[str, str]) -> dict[str, Any]:
    """The same with columns that are numbers as such."""
    return {name: int(text) if text.isdigit() else text for name, text in columns.items()}


def _noise(text: str | None) -> Any:
    """The noise as `fit` takes it."""
    if text is None or "=" not in text:
        return text
    parts = (part.partition("=") for part in text.split(","))
    return {name.strip(): value.strip() for name, _, value in parts}
