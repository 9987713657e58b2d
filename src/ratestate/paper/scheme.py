"""The error of the paper's scheme against its time step: critical velocity and limit cycle."""

import numpy as np
import xarray

from .. import limit_cycle, plot
from ..plot.layout import figure, letters, styled
from .parameters import FIG2, FIG2_DURATION, FIG2_SPEEDS, FIG2_START
from .scheme_map import critical_velocity, last_cycle, step_response, time_step

V_LP = FIG2_SPEEDS[-1]
OMEGA_DT = [0.1, 0.07, 0.05, 0.035, 0.025, 0.02, 1 / 60, 0.0125, 0.01, 1 / 160, 1 / 320]
VARIANTS = {"slip": ["exact"], "aging": ["exact", "euler"]}
STYLES = {
    "exact": {"label": "state advanced exactly", "color": "k", "marker": "o"},
    "euler": {"label": "state by backward Euler", "color": plot.BLUE, "marker": "s"},
}
#: title and axis of each panel -> what is measured of the scheme: unit, meaning
PANELS = {
    ("Critical velocity", "$V_c$ [mm/s]"): {
        "V_c_scheme": ("m/s", "critical velocity of the scheme"),
    },
    (f"Limit cycle at {1e3 * V_LP:g} mm/s", "Smallest and largest $V$ [mm/s]"): {
        "V_min": ("m/s", "smallest slip velocity in the scheme's cycle"),
        "V_max": ("m/s", "largest slip velocity in the scheme's cycle"),
    },
    ("Its amplitude", rf"{plot.STRESS}, max - min [$10^{{-3}}$]"): {
        "amplitude": ("1", "peak-to-peak tau/sigma in the scheme's cycle"),
    },
}
# Read off the paper's text (sec. 3.1), for the slip law.
PAPER_RANGE = (2.6e-3, 4.0e-3)  # m/s


def compute(law):
    """`PANELS` along ``scheme`` and ``omega_dt``, and what they tend to: ``V_c``, ``cycle_...``."""
    slider = FIG2.replace(law=law)
    cycle = limit_cycle(slider, V_LP, rtol=1e-10)
    found = np.array([[_measure(slider, od, one) for od in OMEGA_DT] for one in VARIANTS[law]])
    dims = ("scheme", "omega_dt")
    measured = (row for panel in PANELS.values() for row in panel.items())
    data = xarray.Dataset(
        {
            name: (dims, found[..., i], {"units": unit, "long_name": text})
            for i, (name, (unit, text)) in enumerate(measured)
        },
        {
            "scheme": ("scheme", VARIANTS[law], {"units": "1", "long_name": "how state advances"}),
            "omega_dt": ("omega_dt", OMEGA_DT, {"units": "1", "long_name": "sqrt(K/M) dt"}),
        },
        cycle.attrs,
    )
    dt = [time_step(slider, od) for od in OMEGA_DT]
    data.coords["dt"] = ("omega_dt", dt, {"units": "s", "long_name": "time step"})
    data["V_c"] = ((), slider.V_c, {"units": "m/s", "long_name": "critical velocity (eq. 10)"})
    for name in ("V_min", "V_max", "amplitude"):
        data[f"cycle_{name}"] = cycle[name].drop_vars("V_lp")
    return data


def _measure(slider, omega_dt, variant):
    """V_c, V_min, V_max and amplitude of the scheme."""
    euler = variant == "euler"
    run = step_response(slider, FIG2_START, V_LP, FIG2_DURATION, omega_dt, euler)
    V_c = critical_velocity(slider, omega_dt, euler)
    return [V_c, float(run.V.min()), float(run.V.max()), last_cycle(run)[0]]


@styled
def draw(data):
    """(a) critical velocity, (b) the limit cycle's velocities, (c) its amplitude."""
    dt = 1e6 * float(data.dt[0])
    step = rf"$\omega\,\Delta t$ = {OMEGA_DT[0]:g} is {dt:.0f} {plot.PREFIXES[-6]}s"
    fig = figure(data, 3.6, "a b Dc sigma M K", f"; {step}")
    axes = fig.subplots(1, 3)
    for ax, ((_, ylabel), names) in zip(axes, PANELS.items(), strict=True):
        for variant in data.scheme.values:
            for name in names:
                y = 1e3 * data[name].sel(scheme=variant)
                ax.plot(data.omega_dt, y, ms=3, lw=1.0, **STYLES[variant])
        for name in names:
            true = data.V_c if name == "V_c_scheme" else data[f"cycle_{name}"]
            style = {"color": plot.RED, "ls": "--", "lw": 1.0, "label": "true: eq. 10, converged"}
            ax.axhline(1e3 * true, **style)
        ax.set(xlim=(0, 0.103), xlabel=r"Time step $\omega\,\Delta t$", ylabel=ylabel)
    letters(axes, *(title for title, *_ in PANELS))
    axes[2].set_ylim(bottom=0)
    # The curve of panel (c) leaves room for the legend of all three.
    axes[2].legend(*axes[0].get_legend_handles_labels(), loc="lower right")
    lines = [(axes[0], FIG2_SPEEDS[1], "3.1 mm/s")]
    if "euler" not in data.scheme:
        lines += [(axes[1], V, f"paper: about {1e3 * V:g}") for V in PAPER_RANGE]
    for ax, V, text in lines:
        ax.axhline(1e3 * V, color=plot.GRAY, lw=0.8, ls=":")
        ax.text(0.1, 1e3 * V, text, ha="right", va="bottom", color="0.4", fontsize=7)
    return fig
