"""The error of the paper's scheme against its time step: critical velocity and limit cycle."""

import numpy as np
import xarray

from .. import plot
from ..dynamics.cycles.limit_cycle import limit_cycle
from ..plot.layout import figure, letter, styled
from .layout import titled
from .parameters import FIG2, FIG2_SPEEDS, FIG2_START
from .scheme_map import critical_velocity, step_response, time_step

V_LP = FIG2_SPEEDS[-1]
OMEGA_DT = [0.1, 0.07, 0.05, 0.035, 0.025, 0.02, 1 / 60, 0.0125, 0.01, 1 / 160, 1 / 320]
SETTLED = 10.0  # s after the step
LAST = 0.1  # s at the end in which V is looked at: two cycles or more
METHODS = {"slip": ["im2017"], "aging": ["im2017", "im2017_euler"]}
NAMES = {"im2017": "state advanced exactly", "im2017_euler": "state by backward Euler"}
STYLES = {"im2017": ("k", "o"), "im2017_euler": (plot.BLUE, "s")}
# Read off the paper's text (sec. 3.1), for the slip law.
PAPER_RANGE = (2.6e-3, 4.0e-3)  # m/s


def compute(law):
    """The scheme's V_c and its limit cycle at 3.2 mm/s: dimensions ``scheme``, ``omega_dt``.

    ``V_c_scheme``, ``V_min``, ``V_max`` [m/s] and ``amplitude`` (of tau/sigma) are the scheme's;
    ``V_c`` (eq. 10), ``cycle_V_min``, ``cycle_V_max`` and ``cycle_amplitude`` what they tend to.
    """
    slider = FIG2.replace(law=law)
    cycle = limit_cycle(slider, V_LP, rtol=1e-10)
    names = ["V_c_scheme", "V_min", "V_max", "amplitude"]
    found = np.array([[_measure(slider, od, m) for od in OMEGA_DT] for m in METHODS[law]])
    units = ["m/s", "m/s", "m/s", "1"]
    long_names = [
        "critical velocity of the scheme",
        "smallest slip velocity in the scheme's cycle",
        "largest slip velocity in the scheme's cycle",
        "peak-to-peak tau/sigma in the scheme's cycle",
    ]
    data = xarray.Dataset(
        {
            name: (("scheme", "omega_dt"), found[..., i], {"units": unit, "long_name": text})
            for i, (name, unit, text) in enumerate(zip(names, units, long_names, strict=True))
        },
        {
            "scheme": ("scheme", METHODS[law], {"units": "1", "long_name": "the scheme's variant"}),
            "omega_dt": ("omega_dt", OMEGA_DT, {"units": "1", "long_name": "sqrt(K/M) dt"}),
        },
        cycle.attrs,
    )
    dt = [time_step(slider, od) for od in OMEGA_DT]
    data.coords["dt"] = ("omega_dt", dt, {"units": "s", "long_name": "time step"})
    data["V_c"] = ((), slider.V_c, {"units": "m/s", "long_name": "critical velocity (eq. 10)"})
    for name in ("V_min", "V_max", "amplitude"):
        data[f"cycle_{name}"] = cycle[name].drop_vars("V_lp")
    return titled(data, "Error of the paper's scheme (eqs 8, 9) against its time step", law)


def _measure(slider, omega_dt, method):
    """V_c, V_min, V_max and amplitude of the scheme."""
    run = step_response(slider, FIG2_START, V_LP, SETTLED, omega_dt, method, LAST)
    V_c = critical_velocity(slider, omega_dt, method)
    return [V_c, float(run.V.min()), float(run.V.max()), float(run.amplitude)]


@styled
def draw(data):
    """(a) critical velocity, (b) the limit cycle's velocities, (c) its amplitude."""
    dt = 1e6 * float(data.dt[0])
    step = rf"$\omega\,\Delta t$ = {OMEGA_DT[0]:g} is {dt:.0f} {plot.PREFIXES[-6]}s"
    fig = figure(data, 3.6, "a b Dc sigma M K", f"; {step}")
    axes = fig.subplots(1, 3)
    for method in data.scheme.values:
        color, marker = STYLES[method]
        run = data.sel(scheme=method)
        style = {"color": color, "marker": marker, "ms": 3, "lw": 1.0}
        axes[0].plot(data.omega_dt, 1e3 * run.V_c_scheme, label=NAMES[method], **style)
        axes[1].plot(data.omega_dt, 1e3 * run.V_min, **style)
        axes[1].plot(data.omega_dt, 1e3 * run.V_max, **style)
        axes[2].plot(data.omega_dt, 1e3 * run.amplitude, **style)
    true = {"color": plot.RED, "ls": "--", "lw": 1.0}
    axes[0].axhline(1e3 * data.V_c, label="true: eq. 10, converged", **true)
    axes[1].axhline(1e3 * data.cycle_V_min, **true)
    axes[1].axhline(1e3 * data.cycle_V_max, **true)
    axes[2].axhline(1e3 * data.cycle_amplitude, **true)
    axes[0].axhline(1e3 * FIG2_SPEEDS[1], color=plot.GRAY, lw=0.8, ls=":")
    note = {"ha": "right", "va": "bottom", "color": "0.4", "fontsize": 7}
    axes[0].text(0.1, 1e3 * FIG2_SPEEDS[1], "3.1 mm/s", **note)
    # The curve of panel (c) leaves room for the legend of all three.
    axes[2].legend(*axes[0].get_legend_handles_labels(), loc="lower right")
    if "im2017_euler" not in data.scheme:
        for V in PAPER_RANGE:
            axes[1].axhline(1e3 * V, color=plot.GRAY, lw=0.8, ls=":")
            axes[1].text(0.1, 1e3 * V, f"paper: about {1e3 * V:g}", **note)
    _titles(axes)
    return fig


def _titles(axes):
    """Letters, axes and labels."""
    labels = [
        ("Critical velocity", "$V_c$ [mm/s]"),
        (f"Limit cycle at {1e3 * V_LP:g} mm/s", "Smallest and largest $V$ [mm/s]"),
        ("Its amplitude", rf"{plot.STRESS}, max - min [$10^{{-3}}$]"),
    ]
    for ax, text, (title, ylabel) in zip(axes, "abc", labels, strict=True):
        ax.set(xlim=(0, 0.103), xlabel=r"Time step $\omega\,\Delta t$", ylabel=ylabel)
        letter(ax, text, title)
    axes[2].set_ylim(bottom=0)
