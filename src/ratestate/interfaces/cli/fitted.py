"""What ``ratestate fit`` does: reads, fits, prints, and writes the report with its files."""

import json
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...errors import FitWarning, ParameterError, RecordWarning
from ...model.quantities import readable
from .fit_request import FitRequest
from .shared import reported, writable

if TYPE_CHECKING:
    import xarray

    from ...model.slider import SpringSlider

#: where a search begins, for want of better: the least squares scan the record's sizes themselves
STARTS = {"a": "0.01", "b": "0.01", "Dc": "10 um"}
#: K over sigma [1/m], likewise
STIFFNESS = 3e3
#: what a record tells of itself that goes into the result
REPORT, PICTURE, NUMBERS = "report.md", "fit.png", "fit.nc"


def tell_and_write(request: FitRequest, out: Path | None, as_json: bool) -> bool:
    """Fit, print, write; whether the answer carries warnings."""
    from ...records.fitting.table import law_names
    from .job import tell

    if out:
        writable(out)
        _not_foreign(out / REPORT)
    with reported(f"fit of {request.file.name}, {law_names(request.laws)}") as files:
        record, slider, result = _result(request)
        if out:
            files += _written(request, record, slider, result, out)
    tell(result, None, as_json)
    return _warned(result)


def _result(request: FitRequest) -> "tuple[xarray.Dataset, SpringSlider, xarray.Dataset]":
    """The record, the slider that the search began with, and the result."""
    from ...records.fitting.fit import fit
    from ...records.reading import read_lab

    with warnings.catch_warnings():
        # both stand in what is printed
        warnings.simplefilter("ignore", FitWarning)
        warnings.simplefilter("ignore", RecordWarning)
        record = read_lab(request.file, **request.reading)
        slider = _slider(request, record)
        result = fit(record, slider, **request.fitting)
    return record, slider, result


def _slider(request: FitRequest, record: "xarray.Dataset") -> "SpringSlider":
    """What is not free, and where the search for the rest begins; the record notes a default."""
    from ...model.slider import SpringSlider
    from ...model.units import to_si
    from ...records.fitting.unknowns import checked_free

    given: dict[str, Any] = {s: value for s, value in request.values.items() if value is not None}
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
    slider = SpringSlider(**{**STARTS, "K": K, **given}, law=request.laws[0])
    free = checked_free(request.free, slider)
    for symbol in ("a", "b", "Dc", "K"):
        if symbol not in given and symbol not in free:
            raise ParameterError(
                f"{symbol} is neither free nor given; add --{symbol} VALUE, or name it in --free"
            )
    return slider


def _warned(result: "xarray.Dataset") -> bool:
    return bool((result["warnings"] != "").any())


def _written(
    request: FitRequest,
    record: "xarray.Dataset",
    slider: "SpringSlider",
    result: "xarray.Dataset",
    out: Path,
) -> list[Path]:
    """Write numbers, picture and report, each whole or not at all; the files."""
    from ... import plot
    from ...files import replace, write
    from .report.written import markdown

    text = markdown(request, record, slider, result, PICTURE)
    return [
        write(result, out / NUMBERS),
        plot.save(plot.fit(result), out / PICTURE),
        replace(out / REPORT, lambda partial: partial.write_text(text, "utf-8")),
    ]


def _not_foreign(path: Path) -> None:
    """Refuse to replace a file that is no report of a fit."""
    from .report.written import HEADING

    if path.is_file() and not path.read_text("utf-8", errors="replace").startswith(HEADING):
        raise ParameterError(
            f"{path} exists and is no report of ratestate fit; it is not replaced: give another "
            f"folder with --out"
        )
