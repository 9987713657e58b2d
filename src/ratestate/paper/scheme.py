"""Critical velocity and limit cycles that the paper's scheme gives at a time step.

Steps are given as omega dt, omega = sqrt(K/M): 0.1 is the largest that the script published by
the scheme's author accepts without a warning.
"""

import math

import numpy as np
import scipy
import xarray

from .. import Loading, SolverError, limit_cycle, plot
from ..dynamics.results import parameter
from ..plot.labels import PREFIXES
from ..plot.layout import figure, letters, styled
from .parameters import FIG2, FIG2_DURATION, FIG2_SPEEDS, FIG2_START
from .scheme_run import im2017, numbers_of, state_of, step

LARGEST, FINER = 0.1, 0.01  # omega dt
LAST = 0.1  # s at the end of a step of Fig. 2 that show how it oscillates: two cycles or more
#: law -> whether the author's script takes its state by backward Euler
EULER = {"slip": False, "aging": True}
# Steps of ln V, psi and u/A to difference the map: rounding then costs 1e-8 of a multiplier.
PERTURBATION = 1e-5
# Parts of V_c between which the scheme's critical velocity is searched for.
BRACKET = (0.2, 1.05)
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


def time_step(slider, omega_dt):
    """Return the time step dt [s] that is omega_dt in units of sqrt(M/K)."""
    return omega_dt * math.sqrt(slider.M / slider.K)


def multiplier(slider, V_lp, omega_dt, euler):
    """Return the spectral radius of one step, linearised about the scheme's own steady sliding.

    If it is above 1, steady sliding is unstable.  Raises SolverError if the scheme has no step.
    """
    numbers = A, B, h, one_c, sine = numbers_of(slider, time_step(slider, omega_dt))
    v, w = math.log(V_lp / slider.Dc), V_lp / slider.Dc
    # the spring's stress there is not the friction, but the one with which eq. 8 repeats itself
    steady = np.array([(A - B) * v + ((1.0 - one_c) * h - sine) * w / one_c, v, -v])

    def after(y):
        x, speed, psi = y.tolist()
        *new, found = step(state_of(slider, euler), x, speed, psi, w * h, numbers)
        if not found:
            raise SolverError(f"the scheme fails at omega dt = {omega_dt:g}. Reduce omega dt.")
        return np.array(new)

    moves = PERTURBATION * np.diag([A, 1.0, 1.0])
    columns = [(after(steady + move) - after(steady - move)) / (2.0 * move.sum()) for move in moves]
    return float(np.abs(np.linalg.eigvals(np.transpose(columns))).max())


def critical_velocity(slider, omega_dt, euler=None):
    """Return the V_lp [m/s], to 1e-7 V_c, at which the scheme's steady sliding turns unstable.

    Raises SolverError if it is not between 0.2 and 1.05 V_c of eq. 10, or the scheme has no step.
    V_c = 0 or inf is returned as it is.  euler : as in `EULER` by default
    """
    V_c, euler = float(slider.V_c), EULER[slider.law] if euler is None else euler
    if V_c in (0.0, math.inf):
        return V_c
    # the scheme is anti-damped: its V_c lies below the true one
    low, high = (part * V_c for part in BRACKET)
    for V_lp, stable in ((low, True), (high, False)):
        if (multiplier(slider, V_lp, omega_dt, euler) < 1.0) != stable:
            raise SolverError(
                f"the scheme's steady sliding is {'unstable' if stable else 'stable'} at "
                f"V_lp = {V_lp:.4g} m/s = {V_lp / V_c:.3g} V_c if omega dt = {omega_dt:g}. So its "
                f"critical velocity is not between {BRACKET[0]:g} and {BRACKET[1]:g} V_c. Reduce "
                f"omega dt."
            )
    while high - low > 1e-7 * V_c:
        middle = 0.5 * (low + high)
        if multiplier(slider, middle, omega_dt, euler) < 1.0:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


def step_response(slider, V_start, V_lp, duration, omega_dt, euler=None, last=LAST):
    """Run the scheme through a velocity step at t = 0; return its steps in the `last` [s].

    It ends at the first step not before `duration` [s].  euler : as in `EULER` by default
    """
    dt = time_step(slider, omega_dt)
    n = math.ceil(duration / dt)
    euler = EULER[slider.law] if euler is None else euler
    run = im2017(slider, Loading.constant(V_lp), n * dt, dt, V_start=V_start, euler=euler)
    return run.isel(time=slice(n - math.ceil(last / dt), None))


def last_cycle(run):
    """Return amplitude of tau/sigma [1] and frequency [Hz] of the last cycle in a run.

    Between two steps tau is a cubic with the slopes of tau at both ends.
    """
    t, tau = run.time.values, run.tau.values
    slope = parameter(run, "K") * (run.V_load - run.V).values
    rises = slope > 0.0

    def turn(i):
        """Return when tau turns between steps i and i + 1, and its value there."""
        pair = slice(i, i + 2)
        piece = scipy.interpolate.CubicHermiteSpline(t[pair], tau[pair], slope[pair])
        (at,) = piece.derivative().roots(extrapolate=False)
        return at, piece(at)

    first, last = np.flatnonzero(rises[:-1] & ~rises[1:])[-2:]
    between = np.flatnonzero(~rises[first:last] & rises[first + 1 : last + 1])[-1]
    (start, _), (_, lowest), (end, highest) = map(turn, (first, first + between, last))
    return float(highest - lowest) / parameter(run, "sigma"), 1.0 / float(end - start)


def compute(law):
    """Compute `PANELS` along ``scheme`` and ``omega_dt``, and their limits."""
    slider = FIG2.replace(law=law)
    cycle = limit_cycle(slider, V_LP, rtol=1e-10)
    found = np.array([[_measure(slider, od, kind) for od in OMEGA_DT] for kind in VARIANTS[law]])
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
    euler = variant == "euler"
    run = step_response(slider, FIG2_START, V_LP, FIG2_DURATION, omega_dt, euler)
    V_c = critical_velocity(slider, omega_dt, euler)
    return [V_c, float(run.V.min()), float(run.V.max()), last_cycle(run)[0]]


@styled
def draw(data):
    """Draw (a) critical velocity, (b) the limit cycle's velocities, (c) its amplitude."""
    dt = 1e6 * float(data.dt[0])
    step = rf"$\omega\,\Delta t$ = {OMEGA_DT[0]:g} is {dt:.0f} {PREFIXES[-6]}s"
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
