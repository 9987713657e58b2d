"""The report of a fit, in Markdown."""

import inspect
import json
import re
from pathlib import Path
from typing import Any, NamedTuple

import xarray

from ...model.names import Sentences
from ...model.quantities import readable, short, with_error
from ...model.slider import SpringSlider
from ...records.fitting.by_law import has_steps, results_by_law
from ...records.fitting.fit import fit
from ...report.estimates import estimate_rows, noise_text, short_name
from ...report.fit import (
    fixed_parameters,
    identifiability_by_law,
    labelled_warnings,
)
from ...report.steps import (
    HEADS,
    NOTATION,
    heading_of_steps,
    remarks_on_steps,
    table_of,
    warnings_by_text,
)
from ..scenario.as_python import registration
from .output import names_of

SENTENCES = Sentences(Path(__file__).with_suffix(".toml"))
#: how each report begins
HEADING = "# Fit of "

Laws = dict[str, xarray.Dataset]


class FitRequest(NamedTuple):
    """A fit requested on the command line, which the report also says how to repeat."""

    files: tuple[Path, ...]
    reading: dict[str, Any]  # arguments of `read_lab` beside the files
    values: dict[str, str]  # of the slider, as they were given
    laws: tuple[str, ...]
    fitting: dict[str, Any]  # arguments of `fit` beside record and slider

    @property
    def names(self) -> str:
        """The names of the files."""
        return names_of(self.files)

    @property
    def paths(self) -> Any:
        """The path of the file, or a list of those of several, as `read_lab` takes them."""
        paths = [file.as_posix() for file in self.files]
        return paths if len(paths) > 1 else paths[0]


def markdown(
    request: FitRequest, record: xarray.Dataset, slider: SpringSlider, result: xarray.Dataset
) -> str:
    """The whole report; `record` and `result` must have the attributes of `read_lab` and `fit`."""
    own = _of_steps(result) if has_steps(result) else _of_fit(record, result)
    text = SENTENCES(
        "report.steps" if has_steps(result) else "report.whole",
        names=request.names,
        what_was_read=_what_was_read(record),
        versions=", ".join(map(" ".join, json.loads(result.attrs["versions"]).items())),
        **_python(request, slider, result),
        **own,
    )
    # without the gaps that empty parts leave, and with signs as print has them
    return re.sub("\n{3,}", "\n\n", text).replace("+-", "\N{PLUS-MINUS SIGN}")


def _of_fit(record: xarray.Dataset, result: xarray.Dataset) -> dict[str, str]:
    """The parts of the report on one fit."""
    laws = results_by_law(result)
    warnings = [f"> - {text}" for text in labelled_warnings(laws)]
    determined = [f"**{law} law.** {text}" for law, text in identifiability_by_law(laws).items()]
    return {
        "warnings": _part("warnings", "\n".join(warnings)),
        "estimates": _estimates(laws),
        "kinds": _kinds(laws),
        "fixed": fixed_parameters(laws),
        "quality": _statistics(laws) if "aic" in result else _features(laws),
        "comparison": result.attrs.get("comparison", ""),
        "identifiability": _part("identifiability", "\n\n".join(determined)),
        "speed": readable("V_lp", float(record["segment_V"].max())),
    }


def _of_steps(result: xarray.Dataset) -> dict[str, str]:
    """The parts of the report on fits of steps."""
    tables, warnings = "", ""
    for law, part in results_by_law(result).items():
        heads, *rows = table_of(result, law)
        tables += SENTENCES("report.steps_under", law=law, table=_table(heads, rows, len(HEADS)))
        of_law = [f"- {steps}: {text}" for steps, text in warnings_by_text(part)]
        if of_law:
            warnings += SENTENCES("report.warnings_under", law=law, lines="\n".join(of_law))
    return {
        "heading": heading_of_steps(result),
        "tables": tables,
        "notation": NOTATION,
        "warnings": _part("warnings_of_steps", warnings),
        "remarks": "\n".join(f"- {remark}" for remark in remarks_on_steps(result)),
    }


def _what_was_read(record: xarray.Dataset) -> str:
    """The part on the record: its rows, what was found in it, its columns, and notes."""
    time = record["time"].values
    notes = [f"- {text}" for text in json.loads(record.attrs["notes"])]
    return SENTENCES(
        "report.record",
        record=record.attrs,
        rows=time.size,
        begin=time[0],
        end=time[-1],
        columns=_columns(record),
        notes=_part("notes", "\n".join(notes)),
    )


def _part(name: str, lines: str) -> str:
    """A part of the report with these lines; empty without any."""
    return SENTENCES(f"report.{name}", lines=lines) if lines else ""


def _table(head: list[str], rows: list[list[str]], left: int) -> str:
    """A table, whose columns are aligned right but for the first `left` ones."""
    rule = ["---" if i < left else "---:" for i in range(len(head))]
    return "\n".join("| " + " | ".join(cells) + " |" for cells in (head, rule, *rows))


def _estimates(laws: Laws) -> str:
    """Values, standard errors and intervals under each law, side by side."""
    head = ["", "", *(t for law in laws for t in (f"**{law} law**", "68 %", "95 %"))]
    rows = []
    for row in estimate_rows(laws):
        cells = [t for value, *ends in row.estimates for t in (f"**{value}**", *ends)]
        rows.append([row.label, row.meaning, *cells])
    return _table(head, rows, 2)


def _kinds(laws: Laws) -> str:
    """Sentences on the intervals that are not from the covariance."""
    sentences = ""
    for law, part in laws.items():
        names = [short_name(symbol, {law: part}) for symbol in part["parameter"].values.tolist()]
        symbols: dict[str, list[str]] = {}
        for name, kind in zip(names, part["interval_kind"].values.tolist(), strict=True):
            symbols.setdefault(kind, []).append(name)
        symbols.pop("covariance", None)
        for kind, some in symbols.items():
            sentences += SENTENCES("report.kind", symbols=", ".join(some), law=law, kind=kind)
    return sentences


def _statistics(laws: Laws) -> str:
    """Residuals, noise and information criteria under each law."""
    rows = [
        [
            f"{law} law",
            f"{float(part['rms']):.3g}",
            noise_text(part),
            f"{float(part['chi2_white']):.3g}",
            short(float(part["aic"])),
            short(float(part["bic"])),
        ]
        for law, part in laws.items()
    ]
    head = ["", "r.m.s. residual", "noise in friction", "chi-square, if white", "AIC", "BIC"]
    return SENTENCES("report.statistics", table=_table(head, rows, 1))


def _features(laws: Laws) -> str:
    """Features of cycles, measured and fitted."""
    first = next(iter(laws.values()))
    rows = []
    for segment in range(first.sizes["segment"]):
        for feature in first["feature"].values.tolist():
            each = [one.isel(segment=segment).sel(feature=feature) for one in laws.values()]
            speed = readable("V_lp", float(each[0]["segment_V"]))
            measured = with_error(float(each[0]["measured"]), float(each[0]["measured_error"]))
            shown = measured if bool(each[0]["used"]) else "not resolved"
            fitted = [f"{float(one['fitted']):.5g}" for one in each]
            rows.append([speed, feature, shown, *fitted])
    head = ["load point", "feature", "measured", *(f"{law} law" for law in laws)]
    chi2 = ", ".join(f"{law} law {short(float(part['chi2']))}" for law, part in laws.items())
    return SENTENCES("report.features", table=_table(head, rows, 2), chi2=chi2)


def _columns(record: xarray.Dataset) -> str:
    """The columns that were read, with their units."""
    columns = json.loads(record.attrs["columns"]).items()
    rows = [[name, one["title"], one["unit"].removeprefix("1")] for name, one in columns]
    return _table(["", "column", "unit"], rows, 3)


def _python(request: FitRequest, slider: SpringSlider, result: xarray.Dataset) -> dict[str, str]:
    """Arguments of the Python lines that reproduce the result and go on with the best law."""
    defaults = inspect.signature(fit).parameters
    changed = {k: v for k, v in request.fitting.items() if v != defaults[k].default}
    best = ""
    if len(request.laws) > 1 and not has_steps(result):
        best = request.laws[int(result["aic_difference"].values.argmin())]
    registered = [line for law in request.laws for line in registration(law)]
    return {
        "registration": "".join(f"{line}\n" for line in registered),
        "reading": ", ".join([repr(request.paths), *_arguments(request.reading)]),
        "slider": repr(slider)
        .replace("(", "(\n    ")
        .replace(", ", ",\n    ")
        .replace(")", ",\n)"),
        "fitting": ", ".join(["record", "slider", *_arguments(changed)]),
        "law": f", law={best!r}" if best else "",
    }


def _arguments(named: dict[str, Any]) -> list[str]:
    return [f"{name}={value!r}" for name, value in named.items()]
