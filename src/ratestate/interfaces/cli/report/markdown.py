"""The report of a fit, in Markdown."""

import inspect
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ....model.quantities import readable, short, with_error
from ....records.fitting.by_law import results_by_law, warnings_of
from ....records.fitting.table import NAMES, estimate_rows, noise_text
from ....records.fitting.text import fixed_parameters, identifiability_by_law

if TYPE_CHECKING:
    import xarray

    from ....model.slider import SpringSlider
    from ..fit_request import FitRequest

#: how each report begins
HEADING = "# Fit of "
PYTHON = """import ratestate as rs
from ratestate import fitting, plot

record = rs.read_lab({file})
slider = rs.{slider}
result = rs.fit({fit})
plot.save(plot.fit(result), "fit.png")
print(fitting.summary(result))

fitted = fitting.slider_of(result{law})  # to go on with
print(rs.stability(fitted, {V}).stable.item())
"""


def markdown(
    request: "FitRequest",
    record: "xarray.Dataset",
    slider: "SpringSlider",
    result: "xarray.Dataset",
    picture: str,
) -> str:
    """The whole report; `picture` is the name of the image file beside it that shows the fit."""
    laws = results_by_law(result)
    parts = [
        f"{HEADING}{request.file.name}",
        f"![Record, fitted curves, residuals and estimates]({picture})",
        _warnings(laws),
        "## Estimates",
        _estimates(laws),
        fixed_parameters(laws),
        "## How well they fit",
        _statistics(laws) if "aic" in result else _features(laws),
        result.attrs.get("comparison", ""),
        *_identifiability(laws),
        "## What was read",
        _record(record),
        "## To do it again",
        "In the folder in which the command was run:",
        f"```python\n{_python(request, record, slider, result)}```",
        f"All numbers are in fit.nc.  Made with {_versions(result)}.",
    ]
    text = "\n\n".join(part for part in parts if part) + "\n"
    return text.replace("+-", "\N{PLUS-MINUS SIGN}")


def _table(head: list[str], rows: list[list[str]], right: range) -> str:
    """A table; columns in `right` are aligned there."""
    rule = ["---:" if i in right else "---" for i in range(len(head))]
    return "\n".join("| " + " | ".join(cells) + " |" for cells in (head, rule, *rows))


def _estimates(laws: "dict[str, xarray.Dataset]") -> str:
    """Values, standard errors and intervals under each law, side by side."""
    head = ["", "", *(t for law in laws for t in (f"**{law} law**", "68 %", "95 %"))]
    rows = []
    for row in estimate_rows(laws):
        cells = [t for e in row.estimates for t in (f"**{e.value}**", *(e.intervals or "  "))]
        rows.append([row.label, row.meaning, *cells])
    return _table(head, rows, range(2, len(head))) + (
        "\n\nAfter +- stands the standard error, or half the 68 % interval where that is not from "
        "the covariance; the next columns are the intervals that hold the true value with these "
        f"probabilities, if law and loading are right.{_kinds(laws)}"
    )


def _kinds(laws: "dict[str, xarray.Dataset]") -> str:
    """Sentences on the intervals that are not from the covariance."""
    sentences = []
    for law, part in laws.items():
        kinds = part["interval_kind"].values.tolist()
        for kind in dict.fromkeys(kinds):
            symbols = [
                NAMES.get(symbol, symbol)
                for symbol, one in zip(part["parameter"].values.tolist(), kinds, strict=True)
                if one == kind
            ]
            if kind != "covariance":
                sentences.append(
                    f"  Those of {', '.join(symbols)} ({law} law) are from the {kind}."
                )
    return "".join(sentences)


def _statistics(laws: "dict[str, xarray.Dataset]") -> str:
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
    return _table(head, rows, range(1, 6)) + (
        "\n\nChi-square is the variance of the residuals over that of noise from sample to sample: "
        "where it is well above 1, noise is correlated or the law does not fit.  The errors "
        "above allow for the correlation."
    )


def _features(laws: "dict[str, xarray.Dataset]") -> str:
    """Features of cycles, measured and fitted."""
    first = next(iter(laws.values()))
    rows = []
    for segment in range(first.sizes["segment"]):
        one = first.isel(segment=segment)
        for feature in first["feature"].values.tolist():
            value = one.sel(feature=feature)
            measured = with_error(float(value["measured"]), float(value["measured_error"]))
            fitted = [
                f"{float(part['fitted'].isel(segment=segment).sel(feature=feature)):.5g}"
                for part in laws.values()
            ]
            speed = readable("V_lp", float(one["segment_V"]))
            shown = measured if bool(value["used"]) else "not resolved"
            rows.append([speed, feature, shown, *fitted])
    head = ["load point", "feature", "measured", *(f"{law} law" for law in laws)]
    chi2 = ", ".join(f"{law} law {short(float(part['chi2']))}" for law, part in laws.items())
    table = _table(head, rows, range(2, len(head)))
    return f"{table}\n\nTimes are in s.  Chi-square of the features: {chi2}."


def _identifiability(laws: "dict[str, xarray.Dataset]") -> list[str]:
    """How well the record constrains each parameter."""
    notes = [f"**{law} law.** {text}" for law, text in identifiability_by_law(laws).items()]
    return ["## What the record tells", *notes] if notes else []


def _warnings(laws: "dict[str, xarray.Dataset]") -> str:
    """All warnings, where they cannot be overlooked."""
    lines = [f"> - {law} law: {text}" for law, part in laws.items() for text in warnings_of(part)]
    return "\n".join(["> **Read this before you use the numbers.**", ">", *lines]) if lines else ""


def _record(record: "xarray.Dataset") -> str:
    """File, rows, columns, detected segments, notes."""
    columns: dict[str, Any] = json.loads(record.attrs["columns"])
    rows = [[name, one["title"], one["unit"].removeprefix("1")] for name, one in columns.items()]
    time = record["time"].values
    summary = (
        f"{record.attrs['source']}: {time.size:,} rows, from {time[0]:.7g} to {time[-1]:.7g} s.  "
        f"Found: {record.attrs['found']}."
    )
    notes = [f"- {text}" for text in json.loads(record.attrs["notes"])]
    table = _table(["", "column", "unit"], rows, range(0))
    return "\n\n".join([summary, table, *(["Notes:\n\n" + "\n".join(notes)] if notes else [])])


def _python(
    request: "FitRequest",
    record: "xarray.Dataset",
    slider: "SpringSlider",
    result: "xarray.Dataset",
) -> str:
    """Python lines that reproduce the result and continue with the slider of the best law."""
    from ....records.fitting.fit import fit

    defaults = inspect.signature(fit).parameters
    changed = {k: v for k, v in request.fitting.items() if v != defaults[k].default}
    reading = [repr(Path(request.file).as_posix()), *_arguments(request.reading)]
    arguments = ", ".join(["record", "slider", *_arguments(changed)])
    made = repr(slider).replace("(", "(\n    ").replace(", ", ",\n    ").replace(")", ",\n)")
    law = ""
    if len(request.laws) > 1:
        law = f", law={request.laws[int(result['aic_difference'].values.argmin())]!r}"
    V = repr(readable("V_lp", float(record["segment_V"].max())))
    return PYTHON.format(file=", ".join(reading), slider=made, fit=arguments, law=law, V=V)


def _arguments(named: dict[str, Any]) -> list[str]:
    return [f"{name}={value!r}" for name, value in named.items()]


def _versions(result: "xarray.Dataset") -> str:
    versions = json.loads(result.attrs["versions"])
    return ", ".join(f"{name} {version}" for name, version in versions.items())
