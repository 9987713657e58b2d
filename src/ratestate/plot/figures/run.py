"""The figures of runs and of a limit cycle: stress, speed against time, and the phase plane."""

from ...dynamics.cycles.limit_cycle import orbit
from ...dynamics.cycles.regimes import classify
from ...dynamics.results import contact_area, parameter, slider_parameters, whole_contact
from ...dynamics.steady_sliding import stability
from ...engine.model import RUNAWAY, STEADY_SLIDING
from ...errors import ParameterError
from ...model.slider import SpringSlider
from ..labels import (
    BLUE,
    GRAY,
    LAWS,
    STRESS,
    fitting_unit,
    in_unit,
    label_of_contact,
    prefixed,
    value_text,
    with_unit,
)
from ..layout import ABOVE, SLIDER, figure, letters, styled, text_width
from ..motion import force_axis, trace
from ..runs import THIN, NamedRun, common, named_runs, plane, speed
from .linear import stability_figure

# Cycles of a run from which lines run together, and how many are shown on their own.
MANY_CYCLES, SHOWN_CYCLES = 25, 5
#: width for a legend above the stress, of what is beside each name in it, and size of letters
#: [points]
ROOM, SPACE, LETTERS = 215.0, 30.0, 7.5
COMPACT = {"handlelength": 1.5, "handletextpad": 0.5, "columnspacing": 1.0}


@styled
def run_figure(run):
    end, law = with_unit("t", float(run.time[-1])), LAWS[parameter(run, "law")].name
    unstable = ", up to the quasi-static instability" if int(run.status) == RUNAWAY else ""
    return _motion(run, f"Run of {end}{unstable}, {law}", run)


@styled
def runs_figure(runs):
    """Draw the figure of several runs, as `named_runs` takes them; ParameterError as of it."""
    named = named_runs(runs)
    parts = [other.run for other in named]
    if any(run.attrs.get("title") != "ratestate simulate" for run in parts):
        raise ParameterError(
            "a figure of several runs shows results of simulate alone", "Give only such results."
        )
    if len(parts) == 1:
        return run_figure(parts[0])
    laws = {LAWS[parameter(run, "law")].name for run in parts}
    title = f"{len(parts)} runs, {' and '.join(sorted(laws))}"
    fig = figure(parts[0], 4.4, common(parts, SLIDER), title=title)
    axes = _panels(fig, runs, named)
    widest = SPACE + max(text_width(other.name, LETTERS) for other in named)
    axes["a"].legend(ncols=max(1, int(ROOM / widest)), **COMPACT, **ABOVE)
    axes["b"].legend(handles=axes["b"].lines[:1], **ABOVE)
    return fig


def _panels(fig, runs, named, last="", mu=None):
    """Draw stress, speed and phase plane of runs; return the axes, with an empty "d" for `last`.

    mu : as for `trace`
    """
    panels = [["a", "c"], ["b", "d"]] if last else [["a", "c"], ["b", "c"]]
    axes = fig.subplot_mosaic(panels, width_ratios=[1.5, 1])
    axes["a"].sharex(axes["b"])
    trace(runs, axes["a"], mu=mu)
    axes["a"].label_outer()
    speed(named, axes["b"])
    plane(named, axes["c"])
    letters([axes[name] for name in sorted(axes)], "stress", "speed", "phase plane", last)
    return axes


@styled
def cycle_figure(cycle):
    """Draw the figure of a slider's cycle; of its stability if it has no cycle.

    The cycle is computed again for a period.
    """
    symbols = slider_parameters(cycle)
    slider = SpringSlider(**{symbol: parameter(cycle, symbol) for symbol in symbols})
    V_lp = float(cycle.V_lp)
    if int(cycle.status) == STEADY_SLIDING:
        return stability_figure(stability(slider, V_lp))
    kind = str(classify(cycle).regime.values)
    title = (
        f"Limit cycle ({kind}) at {value_text('V_lp', V_lp)}, {LAWS[slider.law].name}: "
        f"{value_text('period', float(cycle.period))}, "
        f"peak-to-peak {STRESS} {float(cycle.amplitude):.4g}"
    )
    return _motion(orbit(slider, V_lp, rtol=parameter(cycle, "rtol")), title, cycle)


def _motion(run, title, result):
    """The three panels of a run, and its last cycles where there are many.

    result : the run, or the cycle that it shows; what it says of the contact goes with the title
    """
    fig = figure(run, 4.4, more=_of_contact(result), title=title)
    cycles = int(run.cycles)
    single = [NamedRun(run, "slider", {"color": BLUE})]
    if cycles > MANY_CYCLES:
        # (of lines that run together, dashes would make a pattern)
        axes = _panels(fig, run, single, f"the last {SHOWN_CYCLES} of {cycles} cycles", {"ls": "-"})
        last = run.time.values[-1] - SHOWN_CYCLES / float(run.frequency)
        trace(run.isel(time=run.time.values >= last), axes["d"])
    else:
        axes = _panels(fig, run, single)
    force_axis(run, axes["a"])
    if "sigma" in run.data_vars:
        _normal_stress(run, axes["a"])
    axes["a"].legend(ncols=2, **ABOVE)
    axes["b"].legend(ncols=2, **ABOVE)
    return fig


def _normal_stress(run, ax):
    area = contact_area(run)
    factor, unit = fitting_unit("sigma", run.sigma, area)
    in_time, _ = prefixed("s", float(run.time.max()))
    stress_ax = ax.twinx()
    stress_ax.plot(in_time * run.time, factor * run.sigma, color=GRAY, **THIN)
    stress_ax.set_ylabel(in_unit(label_of_contact("sigma", area), unit), color=GRAY)
    stress_ax.tick_params(axis="y", colors=GRAY)
    ax.set_zorder(stress_ax.get_zorder() + 1)
    ax.patch.set_visible(False)


def _of_contact(result):
    """A second line of parameters: the area, and what is known of the contact as a whole."""
    values = whole_contact(result)
    if not values:
        return ""
    names = ("force_amplitude", "displacement_amplitude", "acceleration_max")
    known = {"area": parameter(result, "area")} | {name: float(values[name]) for name in names}
    return "\n" + ", ".join(value_text(name, x) for name, x in known.items() if x > 0.0)
