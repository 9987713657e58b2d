"""Estimates as a table within a figure."""

import numpy as np

from ..model.quantities import QUANTITIES, short
from ..records.fitting.by_law import results_by_law
from ..records.fitting.unknowns import TRENDS
from ..report.fits import STABLE_AT_ANY_K, estimates, name_of
from .labels import LAWS, in_unit, label, scaled
from .layout import text_width
from .prose import mathematics

#: d mu_ss/d ln V, where it is more than a - b
RATE_DEPENDENCE = r"$d\mu_{ss}/d\ln V$"
#: height of a row [inches], size of letters [points], width that the panels' margins take [inches]
ROW, SIZE, MARGIN = 0.17, 7.5, 0.25
#: least space between columns [points]; how much wider bold letters are
GAP, BOLD = 8.0, 1.12


def write_estimates(result, ax):
    """Write the estimates with their errors into axes: a column for each, a row for each law.

    Beside them K/K_c_qs, unless K = inf, and a measure of the misfit.  `result` is not checked.
    """
    laws = results_by_law(result)
    shown = [one for one in estimates(laws, scaled) if one.symbol not in (*TRENDS, "K/sigma")]
    columns = [(in_unit(_heading(one.symbol, laws), one.unit), _cells(one)) for one in shown]
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


def _heading(symbol, laws):
    if symbol == "a_minus_b" and name_of(symbol, laws) != "a - b":
        return RATE_DEPENDENCE
    return label(symbol) if symbol in QUANTITIES else mathematics(symbol)


def _cells(estimate):
    """Return value and error under each law, with the signs of print."""
    values = [value for value, *_ in estimate.texts]
    return ["stable" if text == STABLE_AT_ANY_K else _printed(text) for text in values]


def _printed(text):
    """Signs as print has them."""
    return text.replace("+-", "\N{PLUS-MINUS SIGN}").replace("-", "\N{MINUS SIGN}")
