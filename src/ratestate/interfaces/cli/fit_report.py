"""report.md: the report of a fit in Markdown, what was read, and the lines that repeat the fit."""

import inspect
import json
import re
from pathlib import Path
from typing import Any, NamedTuple

import xarray

from ...model.names import Sentences
from ...model.quantities import readable
from ...model.slider import SpringSlider
from ...records.fitting.by_law import has_steps
from ...records.fitting.fit import fit
from ...report import summary
from ...report.report import TextTable, left
from ...scenario.as_python import registration
from .output import names_of

SENTENCES = Sentences(Path(__file__).with_suffix(".toml"))
#: how each report begins
HEADING = "# Fit of "


class FitRequest(NamedTuple):
    """A fit requested on the command line, which the report also says how to repeat."""

    files: tuple[Path, ...]
    reading: dict[str, Any]  # arguments of `read_lab` beside the files
    values: dict[str, str]  # of the slider, as they were given
    laws: tuple[str, ...]
    fitting: dict[str, Any]  # arguments of `fit` beside record and slider

    @property
    def names(self) -> str:
        return names_of(self.files)

    @property
    def paths(self) -> Any:
        """The path of the file, or a list of the paths of several, as `read_lab` takes them."""
        paths = [file.as_posix() for file in self.files]
        return paths if len(paths) > 1 else paths[0]


def markdown(
    request: FitRequest, record: xarray.Dataset, slider: SpringSlider, result: xarray.Dataset
) -> str:
    """Return the whole report; both Datasets must have the attributes of their functions."""
    time, columns = record["time"].values, json.loads(record.attrs["columns"]).items()
    rows = [[name, one["title"], one["unit"].removeprefix("1")] for name, one in columns]
    heads = [left(head) for head in ("", "column", "unit")]
    kind = "steps" if has_steps(result) else "whole"
    text = SENTENCES(
        "report.text",
        heading=HEADING + request.names,
        report=summary(result).markdown(),
        record=record.attrs,
        rows=time.size,
        begin=time[0],
        end=time[-1],
        columns=TextTable(heads, rows).markdown(),
        picture=SENTENCES(f"{kind}.picture"),
        files=SENTENCES(f"{kind}.files"),
        further=_further(request, record, result),
        versions=", ".join(map(" ".join, json.loads(result.attrs["versions"]).items())),
        **_python(request, slider),
    )
    return re.sub("\n{3,}", "\n\n", text)  # without the gaps that empty parts leave


def _further(request: FitRequest, record: xarray.Dataset, result: xarray.Dataset) -> str:
    """Return the Python lines that go on with the best law; "" after fits of steps."""
    if has_steps(result):
        return ""
    best = ""
    if len(request.laws) > 1:
        best = f", law={request.laws[int(result['aic_difference'].values.argmin())]!r}"
    speed = readable("V_lp", float(record["segment_V"].max()))
    return SENTENCES("whole.further", law=best, speed=speed)


def _python(request: FitRequest, slider: SpringSlider) -> dict[str, str]:
    """Return arguments of the Python lines that reproduce the result."""
    defaults = inspect.signature(fit).parameters
    changed = {k: v for k, v in request.fitting.items() if v != defaults[k].default}
    registered = [line for law in request.laws for line in registration(law)]
    return {
        "registration": "".join(f"{line}\n" for line in registered),
        "reading": ", ".join([repr(request.paths), *_arguments(request.reading)]),
        "slider": repr(slider)
        .replace("(", "(\n    ")
        .replace(", ", ",\n    ")
        .replace(")", ",\n)"),
        "fitting": ", ".join(["record", "slider", *_arguments(changed)]),
    }


def _arguments(named: dict[str, Any]) -> list[str]:
    return [f"{name}={value!r}" for name, value in named.items()]
