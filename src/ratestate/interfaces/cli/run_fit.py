"""Run ``ratestate fit``: read, fit, print, and write the report with its files."""

import inspect
import json
import re
import warnings
from pathlib import Path
from typing import Any, NamedTuple

import xarray

from ...errors import FitWarning, ParameterError, RecordWarning
from ...files import laboratory_csv, write
from ...friction.laws import friction_law
from ...model.names import Sentences
from ...model.quantities import readable
from ...model.slider import SpringSlider
from ...records.fitting.by_law import clearly_worse, has_steps, law_names
from ...records.fitting.fit import fit
from ...records.fitting.settings import sliders_under
from ...records.fitting.unknowns import checked_free
from ...records.reading.sizes import constant_in_si
from ...report import summary
from ...report.report import TextTable, left
from ...report.steps import rows_of
from ...report.summary_csv import summary_csv
from ...scenario.as_python import registration
from .document import document
from .options import read_record
from .output import folder, names_of, print_json, reporting_files, write_text
from .run_scenario import print_report

#: initial guesses where none are given; the least squares also scan the scales of the record
STARTS = {"a": "0.01", "b": "0.01", "Dc": "10 um"}
#: K over sigma [1/m], likewise
STIFFNESS = 3e3
#: file names, which the report has too
REPORT, PLOT, NUMBERS = "report.md", "fit.png", "fit.nc"
TABLE, SUMMARY = "steps.csv", "steps_summary.csv"


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


def fit_and_report(request: FitRequest, out: Path | None, as_json: bool) -> bool:
    """Fit, print and write the files into the folder, if any; whether the answer carries warnings.

    Warnings on laws that fit clearly worse than another do not count.

    ParameterError as of `read_lab` and `fit`, and: a report.md there that is none of these; no
    normal stress; a, b, Dc, K or a parameter of the law neither given nor free.
    """
    report = out and out / REPORT
    written = (
        report.read_text("utf-8", errors="replace") if report and report.is_file() else HEADING
    )
    if not written.startswith(HEADING):
        raise ParameterError(
            f"{report} exists, is not a report of ratestate fit, and is not replaced",
            "Give another folder with --out.",
        )
    task = f"fit of {request.names}, {law_names(request.laws)}"
    with folder(out), reporting_files(task) as files:
        with warnings.catch_warnings():
            # both are printed with the result
            warnings.simplefilter("ignore", FitWarning)
            warnings.simplefilter("ignore", RecordWarning)
            read = read_record(request.paths, request.reading, request.values.get("sigma"))
            record, request = read[0], request._replace(reading=read[1])
            slider = _slider(request, record)
            result = fit(record, slider, **request.fitting)
        if out and report:
            from ... import plot

            text = markdown(request, record, slider, result)
            files += [
                write(result, out / NUMBERS),
                plot.save(plot.fit(result), out / PLOT),
                write_text(report, text),
            ]
            if has_steps(result):
                files += [
                    write_text(out / TABLE, laboratory_csv(rows_of(result), "step")),
                    write_text(out / SUMMARY, summary_csv(result)),
                ]
    if as_json:
        print_json(document(result, None))
    else:
        print_report(result)
    worse = clearly_worse(result)
    kept = result["warnings"] if not worse else result["warnings"].drop_sel(law=worse)
    return bool((kept != "").any())


def _slider(request: FitRequest, record: xarray.Dataset) -> SpringSlider:
    """Return the fixed parameters and initial guesses of the free ones; note a default sigma."""
    # what the format says of the machine holds where nothing else is given
    given: dict[str, Any] = json.loads(record.attrs.get("machine", "{}")) | request.values
    if "sigma" not in given:
        if "sigma" not in record:
            notes = json.loads(record.attrs["notes"])
            why = "".join(f" ({note})" for note in notes if note.startswith("sigma is left out"))
            raise ParameterError(
                f"the record has no normal stress{why}, and none is given",
                "Add --sigma '20 MPa', or say which column it is with --columns sigma=TITLE.",
            )
        given["sigma"] = float(record["sigma"].median())
        default = f"sigma = {readable('sigma', given['sigma'])} is the median of the record"
        notes = [*json.loads(record.attrs["notes"]), f"{default}, because none was given"]
        record.attrs["notes"] = json.dumps(notes)
    K = STIFFNESS * constant_in_si("sigma", given["sigma"])
    # of several laws the one that has the parameters of all, if any does
    law = max(map(friction_law, request.laws), key=lambda law: len(law.parameters))
    examples = {symbol: spec.example.strip("'") for symbol, spec in law.parameters.items()}
    guesses = {symbol: value for symbol, value in examples.items() if value}
    slider = SpringSlider(**{**STARTS, **guesses, "K": K, **given}, law=law.name)
    free = checked_free(request.fitting["free"], sliders_under(slider, request.laws))
    for symbol in ("a", "b", "Dc", *law.parameters, "K"):
        if symbol not in given and symbol not in free:
            option = f"--set {symbol}=" if symbol in law.parameters else f"--{symbol} "
            raise ParameterError(
                "is neither free nor given",
                f"Add {option}VALUE, or name it in --free.",
                symbol=symbol,
            )
    return slider


def markdown(
    request: FitRequest, record: xarray.Dataset, slider: SpringSlider, result: xarray.Dataset
) -> str:
    """Return the whole report; both Datasets must have the attributes of their functions."""
    time, columns = record["time"].values, json.loads(record.attrs["columns"]).items()
    rows = [[name, column["title"], column["unit"].removeprefix("1")] for name, column in columns]
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
        further=_python_lines(request, record, result),
        versions=", ".join(map(" ".join, json.loads(result.attrs["versions"]).items())),
        **_python(request, slider),
    )
    return re.sub("\n{3,}", "\n\n", text)  # without the gaps that empty parts leave


def _python_lines(request: FitRequest, record: xarray.Dataset, result: xarray.Dataset) -> str:
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
