"""The pages of a run and of a limit cycle: stress, speed against time, and the phase plane."""

import numpy as np

from ...dynamics.attributes import loading_record, number
from ...dynamics.cycles.orbit import orbit
from ...dynamics.cycles.regimes import classify
from ...dynamics.results import parameter, slider_parameters
from ...dynamics.steady_sliding import stability
from ...dynamics.whole_contact import whole_contact
from ...engine.model import STEADY_SLIDING
from ...friction.rate_and_state import mu_ss
from ...model.slider import SpringSlider
from ..labels import BLUE, GRAY, LAWS, RED, STRESS, prefixed, value_text, with_unit
from ..layout import ABOVE, figure, is_wide, letters, styled
from ..motion import force_axis, trace
from .stability import stability_page

# Cycles of a run from which lines run together, and how many are shown on their own.
MANY, FEW = 25, 5


@styled
def run_page(run):
    """Page (Figure) of one slider's run."""
    end, law = with_unit("t", float(run.time[-1])), LAWS[parameter(run, "law")].name
    return _motion(run, f"Run of {end}, {law}", run)


@styled
def cycle_page(cycle):
    """Page of a slider's cycle, computed again for a period; that of `stability` if it has none."""
    symbols = slider_parameters(cycle)
    slider = SpringSlider(**{symbol: parameter(cycle, symbol) for symbol in symbols})
    V_lp = float(cycle.V_lp)
    if int(cycle.status) == STEADY_SLIDING:
        return stability_page(stability(slider, V_lp))
    kind = str(classify(cycle).regime.values)
    title = (
        f"Limit cycle ({kind}) at {value_text('V_lp', V_lp)}, {LAWS[slider.law].name}: "
        f"{value_text('period', float(cycle.period))}, "
        f"amplitude {float(cycle.amplitude):.4g}"
    )
    return _motion(orbit(slider, V_lp, rtol=number(cycle, "rtol")), title, cycle)


def _motion(run, title, result):
    """The three panels of a run, and its last cycles where there are many.

    result : the run, or the cycle that it shows; what it says of the contact goes with the title
    """
    fig = figure(run, 4.4, more=_of_contact(result), title=title)
    cycles = int(run.cycles)
    panels = [["a", "c"], ["b", "d"]] if cycles > MANY else [["a", "c"], ["b", "c"]]
    axes = fig.subplot_mosaic(panels, width_ratios=[1.5, 1])
    axes["a"].sharex(axes["b"])
    trace(run, axes["a"])
    axes["a"].label_outer()
    force_axis(run, axes["a"])
    axes["a"].legend(ncols=2, **ABOVE)
    _speed(run, axes["b"])
    _plane(run, axes["c"])
    texts = ["stress", "speed", "phase plane"]
    if cycles > MANY:
        last = run.time.values[-1] - FEW / float(run.frequency)
        trace(run.isel(time=run.time.values >= last), axes["d"])
        texts.append(f"the last {FEW} of {cycles} cycles")
    letters([axes[name] for name in sorted(axes)], *texts)
    return fig


def _of_contact(result):
    """A second line of parameters: the area, and what is known of the contact as a whole."""
    values = whole_contact(result)
    if not values:
        return ""
    names = ("force_amplitude", "displacement_amplitude", "acceleration_max")
    known = {"area": parameter(result, "area")} | {name: float(values[name]) for name in names}
    return "\n" + ", ".join(value_text(name, x) for name, x in known.items() if x > 0.0)


def _speed(run, ax):
    """Slip velocity and load-point velocity against time."""
    factor, unit = prefixed("s", float(run.time.max()))
    scale = _speed_axis(run, ax)
    t, load = _load(run)
    ax.plot(factor * t, scale * load, color=GRAY, lw=1.0, ls="--", label="load point")
    ax.plot(factor * run.time, scale * run.V, color=BLUE, lw=1.0, label="slider")
    ax.set(xlabel=f"Time [{unit}]")
    ax.legend(ncols=2, **ABOVE)


def _speed_axis(run, ax):
    """An axis for the speed, logarithmic if that pays; the factor from SI to its unit."""
    factor, unit = prefixed("m/s", float(run.V.max()))
    ax.set_ylabel(f"$V$ [{unit}]")
    if is_wide(run.V.values):
        ax.set_yscale("log")
    return factor


def _load(run):
    """Times and speeds of the load point, with its jumps where they are recorded; NaN at rest."""
    t, V = run.time.values, run.V_load.values
    record = loading_record(run)
    columns = [record.get(name) for name in ("t", "V", "rate")]
    if all(isinstance(column, list) for column in columns):  # of this run alone
        starts, speeds, rates = map(np.array, columns)
        ends = np.append(starts[1:], max(t[-1], starts[-1]))
        t = np.column_stack([starts, ends]).ravel()
        V = np.column_stack([speeds, speeds + rates * (ends - starts)]).ravel()
        last = np.searchsorted(t, run.time.values[-1], side="right")
        t, V = t[: last + 1].clip(None, run.time.values[-1]), V[: last + 1]
    return t, np.where(V > 0.0, V, np.nan)


def _plane(run, ax):
    """Speed against stress, with all steady states and the one at the last load-point velocity."""
    scale = _speed_axis(run, ax)
    laws = {symbol: parameter(run, symbol) for symbol in ("a", "b", "mu0", "V0")}
    ax.plot(run.tau / parameter(run, "sigma"), scale * run.V, color=BLUE, lw=0.8)
    low, high = ax.get_xlim()
    V = np.geomspace(float(run.V.min()), float(run.V.max()), 50)
    ax.plot(mu_ss(V, **laws), scale * V, color=GRAY, lw=0.9, ls="--", label="steady states")
    if (last := float(run.V_load[-1])) > 0.0:
        point = float(mu_ss(last, **laws))
        cross = {"color": RED, "ms": 6, "mew": 1.3, "zorder": 5}
        ax.plot(point, scale * last, "x", label="steady at the last $V_{lp}$", **cross)
        low, high = min(low, point), max(high, point)
    margin = 0.05 * (high - low)
    ax.set(xlim=(low - margin, high + margin), xlabel=STRESS)
    ax.legend(**ABOVE, ncols=1, handlelength=1.3, handletextpad=0.4, borderpad=0.1)
