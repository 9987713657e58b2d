"""Common parts of figures of fits: frame, likelihoods, and the table of estimates."""

import numpy as np
import scipy
from matplotlib.patches import Patch

from ...dynamics.recipe import attribute_text
from ...friction.laws import friction_law, own_parameters
from ...model.quantities import QUANTITIES, short
from ...records.fitting.by_law import law_names, results_by_law
from ...records.fitting.unknowns import DERIVED, TRENDS, parameter
from ...report.fits import STABLE_AT_ANY_K, estimated_symbols, estimates, name_of
from ..curves import law_with_band
from ..labels import GRAY, LAWS, in_unit, label, mathematics, scaled
from ..layout import ABOVE, figure, letters, text_width

#: letters of a legend for which a panel has room that has another beside it
ROOM = 45
#: laws that the title names; the legend names more
NAMED = 2
#: heights [inches]: of a likelihood, of axes' labels, of the title and the space under the table
LIKELIHOOD, LABELS, TITLE = 1.3, 1.0, 0.45
#: relative likelihood at the ends of the 95 % interval, exp(-3.84/2)
END_95 = 0.1465
BINS = 40
#: part of a posterior at each end of it that a histogram leaves out
TAIL = 0.002
#: d mu_ss/d ln V, where it is more than a - b
RATE_DEPENDENCE = r"$d\mu_{ss}/d\ln V$"
#: height of a row [inches], size of letters [points], width that the panels' margins take [inches]
ROW, SIZE, MARGIN = 0.17, 7.5, 0.25
#: least space between columns [points]; how much wider bold letters are
GAP, BOLD = 8.0, 1.12


def titled_figure(result, laws, height):
    """(Figure with its title, list of its empty parts: panels, likelihoods if any, estimates).

    height : of the panels [inches]
    """
    middle = [LIKELIHOOD] if non_gaussian(result) else []
    heights = [height + LABELS, *middle, ROW * (1 + len(laws))]
    extra = own_parameters(map(friction_law, laws))
    symbols = " ".join(s for s in (*"sigma M a b Dc K V0".split(), *extra) if s not in result)
    source = attribute_text(result, "source", "")
    law_text = f"the {law_names(laws)}" if len(laws) <= NAMED else f"{len(laws)} friction laws"
    title = (
        f"Fit of {source + ', ' if source else ''}{result.sizes['time']:,} samples of friction, "
        f"under {law_text}"
    )
    fig = figure(result, sum(heights) + TITLE, symbols, title=title)
    return fig, list(fig.subfigures(len(heights), 1, height_ratios=heights))


def finished(result, parts, first):
    """Fill the lower parts of a figure: likelihoods, if any, from letter `first` on; estimates."""
    if symbols := non_gaussian(result):
        panels = parts[0].subplots(1, len(symbols), sharey=True, squeeze=False)[0]
        for symbol, ax in zip(symbols, panels, strict=True):
            likelihood(result, symbol, ax)
        letters(panels, *(f"likelihood of {label(s)}" for s in symbols), first=first)
        panels[0].set_ylabel("relative likelihood")
    write_estimates(result, parts[-1].subplots())


def legend(ax, laws, *, narrow=False):
    """What the lines are, above the record; in two rows if a narrow panel has no room for one."""
    handles, names = ax.get_legend_handles_labels()
    if law := law_with_band(laws):
        handles.append(Patch(color=LAWS[law].color, alpha=0.3, lw=0.0))
        names.append("95 % of samples")
    look = {"fontsize": 7, "handlelength": 1.2, "handletextpad": 0.4, "columnspacing": 0.7}
    rows = 2 if narrow and sum(map(len, names)) > ROOM else 1
    ax.legend(handles, names, ncols=-(-len(names) // rows), **(ABOVE | look))


def non_gaussian(result):
    """Return the free parameters with a finite standard error and a likelihood to draw.

    Empty if there is no profile or posterior of any, under any law.
    """
    laws = results_by_law(result)
    free = {s: _laws_with(laws, s).values() for s in estimated_symbols(laws) if s not in DERIVED}
    drawn = (_profile(p, s) or _samples(p, s) is not None for s, fits in free.items() for p in fits)
    if not any(drawn):
        return []
    return [
        s for s, fits in free.items() if all(np.isfinite(_standard_error(part, s)) for part in fits)
    ]


def _laws_with(laws, symbol):
    return {law: part for law, part in laws.items() if symbol in part["parameter"].values}


def _standard_error(part, symbol):
    return float(part["standard_error"].sel(parameter=symbol))


def likelihood(result, symbol, ax):
    """Draw a parameter's likelihood as a line (profile, or else Gaussian), a posterior filled."""
    laws = _laws_with(results_by_law(result), symbol)
    largest = max(abs(float(part[symbol])) for part in laws.values())
    factor, unit = scaled(symbol, largest)
    for law, part in laws.items():
        color = LAWS[law].color
        if (samples := _samples(part, symbol)) is not None:
            ends = np.quantile(samples, (TAIL, 1.0 - TAIL))
            counts, edges = np.histogram(samples, BINS, tuple(ends))
            ax.stairs(counts / counts.max(), factor * edges, fill=True, color=color, alpha=0.25)
        values, deviance = _profile(part, symbol) or _gaussian(part, symbol)
        ax.plot(factor * values, np.exp(-0.5 * deviance), lw=1.1, **LAWS[law].line)
        ax.axvline(factor * float(part[symbol]), color=color, lw=0.7, ls=":")
    ax.axhline(END_95, color=GRAY, lw=0.7)
    ax.set(ylim=(0.0, 1.08), xlabel=in_unit(label(symbol), unit))


def _profile(part, symbol):
    """Values and deviances of a profile, finely; None where there is none."""
    if "profile_value" not in part:
        return None
    values, deviance = (
        part[name].sel(parameter=symbol).values for name in ("profile_value", "profile_deviance")
    )
    known = np.isfinite(values) & np.isfinite(deviance)
    values, deviance = values[known], deviance[known]
    if values.size < 3:
        return None
    fine = np.linspace(values[0], values[-1], 200)
    # between its points the root of the deviance is smooth, and nearly straight
    side = np.where(values < values[np.argmin(deviance)], -1.0, 1.0)
    return fine, scipy.interpolate.PchipInterpolator(values, side * np.sqrt(deviance))(fine) ** 2


def _gaussian(part, symbol):
    """The same as `_profile`, of a Gaussian in the logarithm, or in what moves as itself."""
    value, z = float(part[symbol]), np.linspace(-3.0, 3.0, 200)
    error = _standard_error(part, symbol)
    is_log = parameter(symbol).is_log
    return (value * np.exp(error / value * z) if is_log else value + error * z), z**2


def _samples(part, symbol):
    if "posterior" not in part:
        return None
    samples = part["posterior"].sel(parameter=symbol).values
    return samples if np.isfinite(samples).all() and np.ptp(samples) > 0.0 else None


def write_estimates(result, ax):
    """Write the estimates with their errors into axes: a column for each, a row for each law.

    Beside them K/K_c_qs, unless K = inf, and a measure of the misfit.  `result` is not checked.
    """
    laws = results_by_law(result)
    shown = [row for row in estimates(laws, scaled) if row.symbol not in (*TRENDS, "K/sigma")]
    columns = [(in_unit(_heading(row.symbol, laws), row.unit), _cells(row)) for row in shown]
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
    widths = [text_width(f"{max(laws, key=len)} law", SIZE) * BOLD]
    widths += [
        GAP + max(text_width(cell, SIZE) for cell in (heading, *cells))
        for heading, cells in columns
    ]
    right, room = np.cumsum(widths), (ax.get_figure(root=True).get_figwidth() - MARGIN) * 72.0
    at = {"va": "center", "fontsize": SIZE * min(room / right[-1], 1.0)}
    right += max(room - right[-1], 0.0) / len(columns) * np.arange(len(widths))
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
    texts = ("stable" if text == STABLE_AT_ANY_K else text for text, *_ in estimate.texts)
    texts = (text.replace("+-", "\N{PLUS-MINUS SIGN}") for text in texts)
    return [text.replace("-", "\N{MINUS SIGN}") for text in texts]
