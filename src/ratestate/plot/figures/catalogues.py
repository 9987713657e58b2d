"""The figure of one or several catalogues of stick-slip events, measured or simulated."""

from typing import NamedTuple

import numpy as np
import xarray

from ...errors import ParameterError
from ...model.conversion import in_si
from ...model.quantities import with_error
from ...records.stick_slip.catalogue import SEVERAL
from ..labels import BLUE, GRAY, RED, in_unit, prefixed
from ..layout import blank_figure, letters, plain_ticks, styled

#: looks of catalogues, in turn: colour, marker, and colour of its face
LOOKS = (("k", "o", "k"), (RED, "s", "none"), (BLUE, "^", "none"), (GRAY, "D", "none"))
#: height of a record's panel, and of those below [inches]
RECORD, BELOW = 1.5, 2.3
#: abscissa -> its name on an axis, and unit
ABSCISSAE = {"recurrence": ("Recurrence interval", "s"), "V_lp": ("$V_{lp}$", "m/s")}
#: factor by which V_lp varies if it is worth a panel; by which an abscissa does on a logarithmic
#: axis; points of a line
VARIES, LOGARITHMIC, POINTS = 1.05, 3.0, 50


class Named(NamedTuple):
    """A catalogue, what a legend calls it, and its look."""

    data: xarray.Dataset
    name: str
    color: str
    marker: str
    face: str


@styled
def events_figure(catalogues):
    """Draw the figure of a catalogue, or of a list or dict of them: records above, lines below."""
    named = _checked_catalogues(catalogues)
    loaded = any(bool(catalogue.data.recurrence.notnull().any()) for catalogue in named)
    heights = [RECORD * len(named) + 0.3, *([BELOW + 0.3] if loaded else [])]
    subject = named[0].name if len(named) == 1 else f"{len(named)} catalogues"
    fig = blank_figure(sum(heights) + 0.3, f"Stick-slip of {subject}")
    top, *below = fig.subfigures(len(heights), 1, height_ratios=heights, squeeze=False)[:, 0]
    records = top.subplots(len(named), 1, squeeze=False)[:, 0]
    for catalogue, ax in zip(named, records, strict=True):
        _record(catalogue, ax)
    letters(records, *(_heading(catalogue, len(named) > 1) for catalogue in named))
    for part in below:
        _lines(named, part)
    return fig


def _heading(catalogue, is_named):
    name = f"{catalogue.name}: " if is_named else ""
    marks = "\N{WHITE DOWN-POINTING TRIANGLE} peaks, \N{WHITE UP-POINTING TRIANGLE} troughs"
    if (catalogue.data.event_status == SEVERAL).any():
        marks += ", \N{MULTIPLICATION SIGN} several events in one fall"
    return f"{name}{catalogue.data.sizes['event']} events ({marks})"


def _lines(named, part):
    V_lp = np.concatenate([catalogue.data.V_lp.values for catalogue in named])
    varies = np.nanmax(V_lp) > VARIES * np.nanmin(V_lp)
    shown = ABSCISSAE if varies else ("recurrence",)
    axes = part.subplots(1, len(shown), sharey=True, squeeze=False)[0]
    drops = np.concatenate([catalogue.data.stress_drop.values for catalogue in named])
    largest = float(drops[np.isfinite(drops)].max(initial=0.0))
    factor, unit = prefixed("Pa", largest or 1.0)
    for abscissa, ax in zip(shown, axes, strict=True):
        _drops(named, ax, abscissa, factor, unit)
    axes[0].set_ylabel(in_unit("Stress drop", unit))
    texts = "stress drop against recurrence", "stress drop against load-point velocity"
    letters(axes, *texts, first=chr(ord("a") + len(named)))


def _checked_catalogues(catalogues):
    """list of `Named`; ParameterError for anything else, none, or more than have looks."""
    if isinstance(catalogues, xarray.Dataset):
        catalogues = [catalogues]
    names = list(catalogues) if isinstance(catalogues, dict) else None
    parts = list(catalogues.values()) if isinstance(catalogues, dict) else list(catalogues)
    if any(part.attrs.get("title") != "ratestate events" for part in parts):
        raise ParameterError(
            "a figure of events shows results of events alone", "Give only such results."
        )
    if len(parts) > len(LOOKS):
        raise ParameterError(
            f"a figure shows {len(LOOKS)} catalogues at most, not {len(parts)}", "Give fewer."
        )
    names = names or [_name(part) for part in parts]
    return [Named(in_si(d), n, *look) for d, n, look in zip(parts, names, LOOKS, strict=False)]


def _name(data):
    is_simulated = {"scenario", "slider"} & data.attrs.keys()
    return str(data.attrs.get("source") or ("simulated" if is_simulated else "measured"))


def _record(catalogue, ax):
    data = catalogue.data
    factor, unit = prefixed("Pa", float(np.abs(data.tau).max()))
    in_time, time_unit = prefixed("s", float(np.abs(data.time).max()))
    ax.plot(in_time * data.time, factor * data.tau, color="0.45", lw=0.6, zorder=1)
    for edge, level, mark in (("start", "tau_max", "v"), ("end", "tau_min", "^")):
        x, y = in_time * data[f"event_{edge}"], factor * data[level]
        look = {"color": catalogue.color, "ms": 3.5, "mew": 0.7, "mfc": "none", "ls": ""}
        ax.plot(x, y, mark, **look, zorder=3)
    merged = data.isel(event=data.event_status.values == SEVERAL)
    middle = 0.5 * factor * (merged.tau_max + merged.tau_min)
    ax.plot(in_time * merged.event_time, middle, "x", color=catalogue.color, ms=5, zorder=3)
    ax.margins(x=0.01)
    ax.set(xlabel=in_unit("Time", time_unit), ylabel=in_unit(r"$\tau$", unit))


def _drops(named, ax, abscissa, factor, stress):
    """Stress drops with their errors against an abscissa, and the lines through them."""
    x_name, si = ABSCISSAE[abscissa]
    values = np.concatenate([catalogue.data[abscissa].values for catalogue in named])
    values = values[np.isfinite(values) & (values > 0.0)]
    in_x, unit = prefixed(si, float(values.max(initial=0.0)) or 1.0)
    for events, title, color, marker, face in named:
        loaded = np.isin(events.event_status, (0, 4)) & events.recurrence.notnull().values
        data, line = events.isel(event=loaded), events.sel(abscissa=abscissa)
        x, y = in_x * data[abscissa].values, factor * data.stress_drop.values
        error = factor * data.stress_drop_error.values
        name = title if len(named) > 1 else ""
        if np.isfinite(line.trend_B):
            ends = np.geomspace(np.nanmin(x), np.nanmax(x), POINTS)
            fitted = float(line.trend_A) + float(line.trend_B) * np.log10(ends / in_x)
            ax.plot(ends, factor * fitted, color=color, lw=1.0)
            name += ": " if name else ""
            slope = with_error(factor * float(line.trend_B), factor * float(line.trend_B_error))
            slope = slope.replace("+-", r"$\pm$").replace("-", "\N{MINUS SIGN}", slope[0] == "-")
            name += f"{slope} {stress} a decade"
        x_error = in_x * data[f"{abscissa}_error"].values
        style = {"color": color, "marker": marker, "mfc": face, "ms": 4, "mew": 0.9, "ls": ""}
        ax.errorbar(x, y, error, x_error, **style, elinewidth=0.7, label=name or None)
    if values.size and values.max() > LOGARITHMIC * values.min():
        ax.set_xscale("log")
        plain_ticks(ax.xaxis, in_x * values)
    ax.set(xlabel=in_unit(x_name, unit))
    ax.margins(y=0.25)
    if ax.get_legend_handles_labels()[1]:
        ax.legend(loc="upper left" if abscissa == "recurrence" else "upper right", fontsize=6.5)
