"""Stiffness and inertia of a machine: the slopes and the ring-downs with their fits."""

import numpy as np

from ...dynamics.recipe import attribute_text
from ...model.quantities import power_of
from ...records.machine.means import estimate, value_with_unit
from ..labels import BLUE, GRAY, RED, prefixed
from ..layout import figure, letters, styled

#: slopes and ring-downs that are drawn at most; parts of its length that are shown beside each
MOST, LEFT, BESIDE = 4, 0.2, 0.5
#: rows from one to the next of one fitted curve, at most
GAP = 2
#: dimension -> what is drawn along it, and the variable whose error decides how much each weighs
DRAWN = {"slope": ("slopes", "slope_K"), "ring_down": ("ring-downs", "ring_down_omega")}


@styled
def machine_page(result):
    """Page (Figure) of a result of `machine_stiffness`."""
    source = attribute_text(result, "source", "")
    title = f"Machine{f' of {source}' if source else ''}: " + ", ".join(
        estimate(result, symbol) for symbol in ("K", "M", "damping")
    )
    chosen = {name: _heaviest(result, name) for name in DRAWN if result.sizes[name]}
    more = _how_many(result, chosen)
    fig = figure(result, 0.6 + 2.3 * len(chosen), symbols="", more=more, title=_typeset(title))
    panels, texts = [], []
    parts = np.ravel(fig.subfigures(len(chosen), 1))
    for part, (name, rows) in zip(parts, chosen.items(), strict=True):
        axes = part.subplots(1, rows.size, squeeze=False)[0]
        for i, ax in zip(rows, axes, strict=True):
            _one(result, name, i, ax)
            panels.append(ax)
            texts.append(_typeset(_what(result, name, i)))
        axes[0].set_ylabel(r"Friction $\tau/\sigma$")
    letters(panels, *texts)
    return fig


def _heaviest(result, name):
    """Numbers of the slopes or ring-downs that weigh most, those that are used first."""
    _, variable = DRAWN[name]
    errors = result[f"{variable}_error"].values / result[variable].values
    is_out = ~result["slope_used"].values if name == "slope" else np.zeros(errors.size, bool)
    return np.sort(np.lexsort((errors, is_out))[:MOST])


def _how_many(result, chosen):
    """What is drawn of more slopes or ring-downs, in words."""
    parts = [
        f"{rows.size} of {result.sizes[name]} {DRAWN[name][0]}"
        for name, rows in chosen.items()
        if rows.size < result.sizes[name]
    ]
    return f"Drawn are {' and '.join(parts)}, those that weigh most" if parts else ""


def _what(result, name, i):
    """What stands above a panel; stiffnesses are in the unit that fits K."""
    if name == "slope":
        kind = str(result["slope_kind"].values[i]).replace("_", " ")
        value, error = (float(result[f"slope_K{end}"].values[i]) for end in ("", "_error"))
        K = float(result["K"])
        power = power_of("Pa/m", value if K != K else K)
        used = "" if result["slope_used"].values[i] else " (not used)"
        return f"{kind}{used}\n{value_with_unit(value, error, 'Pa/m', power)}"
    hertz, error = (
        float(result[f"ring_down_omega{end}"].values[i]) / (2.0 * np.pi) for end in ("", "_error")
    )
    return f"ring-down\n{value_with_unit(hertz, error, 'Hz')}"


def _typeset(text):
    """Text with a sign for +-, and raised powers."""
    return text.replace("+-", "\N{PLUS-MINUS SIGN}").replace("^2", "$^2$")


def _one(result, name, i, ax):
    """Draw the samples about one slope or ring-down, and its curve."""
    t, fitted = result["time"].values, result[f"{name}_friction"].values
    start = float(result[f"{name}_start"].values[i])
    known = np.flatnonzero(np.isfinite(fitted) & (t >= start))
    # (the next one's level before may follow)
    known = known[: np.append(np.flatnonzero(np.diff(known) > GAP) + 1, known.size)[0]]
    lasts = float(t[known[-1]] - start)
    shown = (t > start - LEFT * lasts) & (t < start + (1.0 + BESIDE) * lasts)
    drawn = shown & np.isfinite(fitted) & (t <= t[known[-1]])
    factor, unit = prefixed("s", lasts)
    look = {"ls": "", "marker": ".", "ms": 2.0, "mew": 0.0, "color": "0.55", "rasterized": True}
    ax.plot(factor * (t[shown] - start), result["friction"].values[shown], **look)
    color = RED if name == "slope" else BLUE
    ax.plot(factor * (t[drawn] - start), fitted[drawn], color=color, lw=1.2)
    ax.axvline(0.0, color=GRAY, lw=0.7, ls=":")
    ax.set_xlabel(f"Time [{unit}]")
