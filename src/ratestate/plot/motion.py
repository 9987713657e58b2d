"""Motions: stress against time, the phase plane, the amplitude of limit cycles along a sweep."""

from ..dynamics.results import normal_stress, parameter, whole_contact
from ..dynamics.steady_sliding import steady_stress
from ..errors import ParameterError
from ..model.conversion import in_si
from ..model.names import one_of
from ..model.parameters import force
from ..model.quantities import QUANTITIES
from .labels import ABSCISSAE, AMPLITUDE, DASHED, RED, STRESS, prefixed
from .layout import show_constant
from .runs import named_runs

#: along what a run is drawn -> the label of that axis
ALONG = ABSCISSAE | {"delta": "Slip"}


def trace(run, ax, *, x="time", tau=None, mu=None):
    """Draw tau/sigma in black and friction mu in red dashes against time; or compare runs.

    Without mass (M = 0) both are the same, and one line is drawn.  Several runs have one line each,
    tau/sigma, and a legend.  Lines of one law have one colour, or each run has its own.

    Parameters
    ----------
    run : xarray.Dataset, or list or dict of these
        Run of one slider, from `simulate`, or several runs.  The legend names several runs by the
        keys of a dict, by their values along the dimension other than ``time``, or by the
        parameters that differ between the runs of a list.
    ax : matplotlib.axes.Axes
        Axes to draw into.
    x : {"time", "delta_lp", "delta"}
        Abscissa: time, load-point displacement, or slip since the start of the run.  It is drawn in
        the unit that the axis label names, such as ms.  Lines that you add are in this unit too.
    tau, mu : dict, optional
        Changes to the style of the lines of tau/sigma and of mu, as for
        `matplotlib.axes.Axes.plot`.  Several runs, and runs without mass, have no line of mu.

    Returns
    -------
    tuple of matplotlib.lines.Line2D
        The black and the red line.  If M = 0 they are the same line.  For several runs, the line of
        each run.

    Raises
    ------
    ParameterError
        If it is not a run of `simulate`, if runs have more than one dimension other than ``time``,
        or if `x` is another abscissa.
    """
    if x not in ALONG:
        raise ParameterError("is unknown", one_of(ALONG, x), symbol="x", value=repr(x))
    runs = named_runs(run)

    def along(run):
        """The abscissa; delta itself begins at -tau/K."""
        return run[x] - (run[x][0] if x == "delta" else 0.0)

    factor, unit = prefixed(
        QUANTITIES[x].unit, max(float(abs(along(named.run)).max()) for named in runs)
    )

    def draw(run, values, style):
        return ax.plot(factor * along(run), values, **{"lw": 1.0} | style)[0]

    def stress(run, style):
        return draw(run, run.tau / normal_stress(run), style | (tau or {}))

    first_run = runs[0].run
    if len(runs) > 1:
        lines = tuple(stress(named.run, {"label": named.name} | named.line) for named in runs)
        ylabel = STRESS
        ax.legend()
    elif parameter(first_run, "M") == 0.0 and parameter(first_run, "damping") == 0.0:
        lines = 2 * (stress(first_run, {"color": "k", "label": rf"{STRESS} = $\mu$ ($M$ = 0)"}),)
        ylabel = rf"{STRESS} = $\mu$"
    else:
        red = {"color": RED, "ls": DASHED, "label": r"$\mu$, friction"}
        black = stress(first_run, {"color": "k", "label": f"{STRESS}, spring"})
        lines = black, draw(first_run, first_run.mu, red | (mu or {}))
        ylabel = rf"{STRESS} and $\mu$"
    ax.set(xlabel=f"{ALONG[x]} [{unit}]", ylabel=ylabel)
    show_constant(ax)
    return lines


def force_axis(run, ax):
    """Give axes of `trace` a second scale on the right, the spring's force, if it is known.

    It is not if the slider has no area, or if normal stress varies.
    """
    forces = whole_contact(run)
    if "force" not in forces or "sigma" in run.data_vars:
        return
    newtons = float(force(parameter(run, "sigma"), parameter(run, "area")))  # at tau/sigma = 1
    factor, unit = prefixed("N", float(abs(forces["force"]).max()))
    per_mu = factor * newtons
    scale = ax.secondary_yaxis("right", functions=(lambda y: y * per_mu, lambda f: f / per_mu))
    scale.set_ylabel(f"Force [{unit}]")


def phase(run, ax, *, unit_of=None, **style):
    """Draw slip velocity against tau/sigma, with a cross at steady sliding.

    The cross marks steady sliding at the last load-point speed; it is absent if this speed is 0.
    Both axes are linear.

    Parameters
    ----------
    run : xarray.Dataset
        Run of one slider, from `simulate` or `orbit`; anything else raises ParameterError.
    ax : matplotlib.axes.Axes
        Axes to draw into.
    unit_of : float, optional
        Speed [m/s] for which the unit is chosen, for example to give two runs the same unit.  By
        default it is the largest speed.
    **style
        Style of the line, as for matplotlib.

    Returns
    -------
    matplotlib.lines.Line2D
        The line of the motion.
    """
    run = named_runs([run])[0].run
    V = float(run.V_load[-1])
    factor, unit = prefixed("m/s", unit_of or float(run.V.max()))
    (line,) = ax.plot(run.tau / normal_stress(run), factor * run.V, **{"lw": 0.5} | style)
    if V > 0:
        ax.plot(steady_stress(run, V), factor * V, "kx", ms=5, mew=1.0, zorder=5)
    ax.set(xlabel=STRESS, ylabel=f"$V$ [{unit}]")
    show_constant(ax)
    return line


def amplitudes(cycles, ax, x="V_lp", **style):
    """Draw the amplitude of limit cycles against load-point velocity, frequency or period.

    Steady sliding has the amplitude 0, and neither frequency nor period.

    Parameters
    ----------
    cycles : xarray.Dataset
        From `limit_cycle`, along one dimension, such as ``V_lp``; else ParameterError.
    ax : matplotlib.axes.Axes
        Axes to draw into.
    x : {"V_lp", "frequency", "period"}
        Abscissa [m/s, Hz or s], on a logarithmic axis.
    **style
        Style of the line, as for matplotlib.

    Returns
    -------
    matplotlib.lines.Line2D
        The line of amplitudes.
    """
    names = {"V_lp": "Loading velocity", "frequency": "Frequency", "period": "Period"}
    if x not in names:
        raise ParameterError("is unknown", one_of(names, x), symbol="x", value=repr(x))
    cycles = in_si(cycles)
    variables = [getattr(cycles, "variables", {}).get(name) for name in ("amplitude", x)]
    if any(values is None or values.ndim != 1 for values in variables):
        raise ParameterError(
            f"amplitudes() draws limit cycles along one dimension that {x} depends on",
            "Pick one value of each other dimension with .isel.",
        )
    (line,) = ax.plot(cycles[x], cycles.amplitude, **{"color": "k", "lw": 1.3} | style)
    ax.set_xscale("log")
    ax.set(xlabel=f"{names[x]} [{QUANTITIES[x].unit}]", ylabel=AMPLITUDE)
    return line
