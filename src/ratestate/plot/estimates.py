"""Estimates as a table within a figure."""

import numpy as np

from ..model.quantities import short
from ..records.fitting.by_law import results_by_law
from ..records.fitting.unknowns import TRENDS
from ..report.estimates import (
    STABLE_AT_ANY_K,
    estimate_texts,
    estimated_symbols,
    largest,
    short_name,
    stiffness_ratio_text,
)
from .labels import LAWS, in_unit, label, scaled
from .layout import text_width

#: d mu_ss/d ln V, where it is more than a - b
RATE_DEPENDENCE = r"$d\mu_{ss}/d\ln V$"
#: height of a row [inches], size of letters [points], width that the panels' margins take [inches]
ROW, SIZE, MARGIN = 0.17, 7.5, 0.25
#: least space between columns [points]; how much wider bold letters are
GAP, BOLD = 8.0, 1.12


def estimates(result, ax):
    """Write the estimates with their errors into axes: a column for each, a row for each law.

    Beside them K/K_c_qs, unless K = inf, and a measure of the misfit.  `result` is not checked.
    """
    laws = results_by_law(result)
    symbols = [symbol for symbol in estimated_symbols(laws) if symbol not in TRENDS]
    columns = [_column(laws, symbol) for symbol in symbols]
    if any(ratios := [stiffness_ratio_text(part) for part in laws.values()]):
        cells = ["stable" if text == STABLE_AT_ANY_K else _printed(text or "-") for text in ratios]
        columns.append((f"$K$/{label('K_c_qs')}", cells))
    if "aic" not in result:
        columns.append((r"$\chi^2$", [short(float(part["chi2"])) for part in laws.values()]))
    elif len(laws) == 1:
        rms = [f"{1e3 * float(part['rms']):.3g}" for part in laws.values()]
        columns.append((r"r.m.s. [$10^{-3}$]", rms))
    else:
        aic = np.array([float(part["aic"]) for part in laws.values()])
        columns.append((r"$\Delta$AIC", [short(value) for value in aic - aic.min()]))
    write(ax, [*laws], columns)


def write(ax, laws, columns):
    """Write a table with rules; columns : (heading, a cell for each law).  It shrinks to fit."""
    ax.set_axis_off()
    ax.set(xlim=(0.0, 1.0), ylim=(len(laws) + 1.0, 0.0))
    wide = [text_width(f"{max(laws, key=len)} law", SIZE) * BOLD]
    wide += [
        GAP + max(text_width(cell, SIZE) for cell in (heading, *cells))
        for heading, cells in columns
    ]
    right, room = np.cumsum(wide), (ax.get_figure(root=True).get_figwidth() - MARGIN) * 72.0
    at = {"va": "center", "fontsize": SIZE * min(room / right[-1], 1.0)}
    right += max(room - right[-1], 0.0) / len(columns) * np.arange(len(wide))
    right /= right[-1]
    for y in (0.0, 1.0, len(laws) + 1.0):
        ax.plot([0.0, 1.0], [y, y], color="k", lw=0.5 if y == 1.0 else 0.8, clip_on=False)
    for i, law in enumerate(laws):
        ax.text(0.0, i + 1.5, f"{law} law", color=LAWS[law].color, fontweight="bold", **at)
    for x, (heading, cells) in zip(right[1:], columns, strict=True):
        for i, text in enumerate((heading, *cells)):
            ax.text(x, i + 0.5, text, ha="right", **at)


def _column(laws, symbol):
    """Heading with the unit, and value with error under each law."""
    factor, unit = scaled(symbol, largest(laws, symbol))
    cells = [_printed(value) for value, *_ in estimate_texts(laws, symbol, factor)]
    heading = label(symbol)
    if symbol == "a_minus_b" and short_name(symbol, laws) != "a - b":
        heading = RATE_DEPENDENCE
    return in_unit(heading, unit), cells


def _printed(text):
    """Signs as print has them."""
    return text.replace("+-", "\N{PLUS-MINUS SIGN}").replace("-", "\N{MINUS SIGN}")
