"""Fig. 6: slow stick-slip at a stiffness just below the critical stiffness."""

from .. import Loading, limit_cycle, plot, simulate, stability
from ..plot.labels import with_unit
from ..plot.layout import figure, letters, styled
from .fig4 import steepest
from .parameters import FIG6, FIG6_SPEEDS, FIG6_STEP

T_STEP = FIG6_STEP / FIG6_SPEEDS[0]  # s
T_END = 310.0  # s: the slip law takes more than 100 s to settle
START = T_STEP + 8.0  # s, the end of the first part kept
CYCLES = 4.5  # kept at the end


def compute(law):
    """Compute the first seconds and the last cycles of the run, at the solver's steps."""
    slider = FIG6.replace(law=law)
    slow, fast = FIG6_SPEEDS
    run = simulate(slider, Loading.steps(slow, (T_STEP, fast)), T_END, rtol=1e-8)
    cycle = limit_cycle(slider, fast)
    theory = stability(slider, fast)
    last = T_END - CYCLES * float(cycle.period)
    rows = (run.time <= START) | (run.time >= last)
    data = run[["V", "V_load", "tau", "mu", "delta_lp", "amplitude", "frequency"]].isel(time=rows)
    data["settled"] = (data.time >= last).assign_attrs(units="1", long_name="in the limit cycle")
    measures = cycle[["amplitude", "period", "frequency", "inertia", "V_max", "V_min"]]
    data = data.assign({f"cycle_{name}": value for name, value in measures.items()})
    data = data.assign({name: theory[name] for name in ("K_c", "K_c_qs", "eta")})
    return data


def inertia(run):
    """Return the largest |tau/sigma - mu| of a run, divided by max - min of tau/sigma."""
    stress = run.tau / plot.parameter(run, "sigma")
    return float(abs(stress - run.mu).max() / (stress.max() - stress.min()))


@styled
def draw(data):
    """Draw tau/sigma and mu after the step, and once settled; a drop of each in the insets."""
    K = plot.parameter(data, "K")
    ratio_text = f" = {K / float(data.K_c_qs):.5g} {plot.label('K_c_qs')}"
    fig = figure(data, 4.4, "a b Dc sigma M K", ratio_text)
    left, right = fig.subplots(1, 2, width_ratios=[2.3, 1], sharey=True)
    first, settled = data.isel(time=~data.settled), data.isel(time=data.settled)
    slow, fast = (with_unit("V_lp", float(data.V_load[i])) for i in (0, -1))
    sigma = plot.parameter(data, "sigma")
    for ax, run in ((left, first), (right, settled)):
        plot.trace(run, ax, x="delta_lp")
        ax.axhspan(settled.tau.min() / sigma, settled.tau.max() / sigma, color="0.93", zorder=0)
    left.set(ylim=(0.505, 0.58), xlim=(0, 1e3 * first.delta_lp.max()))
    left.set_yticks([0.53, 0.54, 0.55, 0.56, 0.57])
    left.legend(loc="upper right", ncols=2)
    right.set_ylabel("")
    right.set_xlim(1e3 * settled.delta_lp.min(), 1e3 * settled.delta_lp.max())
    at_step = f"$K = {K / float(data.K_c):.4f}\\,K_c$, $\\eta = {float(data.eta):.3g}$"
    left.text(0.98, 0.5, "gray band: range of (b)", transform=left.transAxes, ha="right")
    end = f"limit cycle, at {float(data.time[-1]):.0f} s"
    letters([left, right], f"step from {slow} to {fast}, where {at_step}", end)
    _drop(left.inset_axes((0.3, 0.12, 0.3, 0.29)), first, 0.012, "first drop")
    _drop(right.inset_axes((0.28, 0.12, 0.66, 0.29)), settled, 0.1, "one of its drops")
    return fig


def _drop(ax, run, half, text):
    """Draw the steepest fall of the stress in a run, `half` seconds before and after."""
    plot.trace(steepest(run).sel(time=slice(-half, half)), ax)
    share = inertia(run)
    ax.set_ylabel("")
    gap = r"|$\tau/\sigma - \mu$| up to" + f" {100 * share:.2g} % of it"
    ax.set_title(f"{text}, with\n{gap}", fontsize=7.5, pad=3)
