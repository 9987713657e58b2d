"""Linear theory: the figure of stability, and the figure of a frequency response."""

import numpy as np
from matplotlib.ticker import FixedLocator, FormatStrFormatter, MultipleLocator, NullLocator

from ...dynamics.results import contact_area, law_of_result, parameter
from ...errors import ParameterError
from ...friction.linear_stability import K_c, eigenvalues
from ...report.report import shown_units
from ...report.single import MARGIN, remedies
from ..labels import BLUE, GRAY, LAWS, RED, fitting_unit, label, mathematics, prefixed, value_text
from ..layout import figure, letters, styled

DECADES = 1.5  # of speed shown on either side, at least
#: what answers -> color and dashes
LINES = {"tau": ("k", "-"), "mu": (RED, "--"), "V": (BLUE, "-")}
INPUTS = {"V_lp": "load-point velocity", "sigma": "normal stress"}


@styled
def stability_figure(result):
    """Draw the figure of one slider's steady sliding."""
    law = law_of_result(result)
    values = {s: float(parameter(result, s)) for s in (*law.symbols, "sigma", "M")}
    K, V_lp, V_c = float(parameter(result, "K")), float(result.V_lp), float(result.V_c)
    upper = float(result.V_c_upper) if "V_c_upper" in result else np.inf
    stable = "stable" if result.stable else "unstable"
    name = LAWS[parameter(result, "law")].name
    title = f"Steady sliding at {value_text('V_lp', V_lp)} is {stable}; {name}"
    fig = figure(result, 3.4, more="" if result.stable else _remedies(result), title=title)
    speeds = [V_lp, *(x for x in (V_c, upper) if 1e-6 * V_lp < x < 1e6 * V_lp)]
    V = np.geomspace(min(speeds) / 10**DECADES, max(speeds) * 10**DECADES, 401)
    factor, speed = prefixed("m/s", V_lp)
    axes = fig.subplot_mosaic([["a", "b"], ["a", "c"]])
    for ax in axes.values():
        limits = factor * V[[0, -1]]
        ax.set(xscale="log", xlim=limits, xlabel=f"{label('V_lp')} [{speed}]")
    axes["b"].set_xlabel("")
    axes["b"].tick_params(labelbottom=False)
    columns = {symbol: np.full(V.shape, value) for symbol, value in values.items()}
    critical = K_c(law, V, **columns)
    of_K = fitting_unit("K", K if np.isfinite(K) else critical[0], contact_area(result))
    _map(axes["a"], V, factor, of_K, K, V_lp, critical, {"V_c": V_c, "V_c_upper": upper})
    first = eigenvalues(law, V, K=np.full(V.shape, K), **columns)[:, 0]
    _mode(axes["b"], axes["c"], V, factor, V_lp, first)
    texts = "growth rate of the least stable mode", "its frequency"
    letters(axes.values(), "stiffness and critical stiffness", *texts)
    return fig


def _remedies(result):
    """Return a line of the caption: what makes the slider stable, each alone."""
    found = remedies(result, shown_units(result))
    bounds = [f"{symbol} {bound}" for symbol, bound, *_ in found if bound != "none"]
    text = f"Stable at {MARGIN:g} V_lp with {', '.join(bounds[:-1])} or {bounds[-1]}"
    return "\n" + mathematics(text.replace(">=", r"$\geq$"))


def _map(ax, V, factor, of_K, K, V_lp, critical, speeds):
    scale, unit = of_K
    critical = np.where(critical > 0.0, critical, np.nan)
    ends = np.nan_to_num(critical[[0, -1]])
    shown = [x for x in (K, *ends) if 0.0 < x < np.inf] or [1.0]
    low, high = min(shown) / 10.0, min(max(shown) * 30.0, 1e4 * min(shown))
    ax.set(yscale="log", ylim=(scale * low, scale * high), ylabel=f"$K$ [{unit}]")
    if not np.isnan(critical).all():
        ax.plot(factor * V, scale * critical, color="k", lw=1.4, label=label("K_c"))
        region = {"color": "0.9", "lw": 0, "zorder": 0, "label": "unstable"}
        ax.fill_between(factor * V, scale * low, scale * critical, **region)
    else:
        ax.text(0.97, 0.05, "stable at any stiffness", transform=ax.transAxes, ha="right")
    for (name, speed), dashes in zip(speeds.items(), (":", "-."), strict=True):
        if V[0] < speed < V[-1]:
            ax.axvline(factor * speed, color=GRAY, lw=0.8, ls=dashes, label=value_text(name, speed))
    if np.isfinite(K):
        ax.axhline(scale * K, color=BLUE, lw=0.8, ls="--")
        ax.plot(factor * V_lp, scale * K, "o", color=RED, ms=5, zorder=5, label="this slider")
    else:
        ax.text(0.97, 0.05, "rigid: stable at any speed", transform=ax.transAxes, ha="right")
    if ax.get_legend_handles_labels()[0]:
        ax.legend(loc="upper left")


def _mode(growth, frequency, V, factor, V_lp, first):
    """The growth rate against speed, over decades of either sign, and the frequency."""
    largest = np.abs(first.real).max()
    decade = 10.0 ** np.floor(np.log10(largest))
    growth.set_yscale("asinh", linear_width=0.01 * largest)
    growth.yaxis.set_major_locator(FixedLocator(decade * np.array([-1.0, -0.1, 0.0, 0.1, 1.0])))
    growth.yaxis.set_major_formatter(FormatStrFormatter("%g"))
    growth.yaxis.set_minor_locator(NullLocator())
    growth.axhline(0.0, color=GRAY, lw=0.7)
    growth.plot(factor * V, first.real, color="k", lw=1.4)
    growth.set(ylabel="Growth rate [1/s]")
    turns = np.abs(first.imag) / (2.0 * np.pi)
    scale, unit = prefixed("Hz", turns.max())
    frequency.set(ylabel=f"Frequency [{unit}]")
    if turns.any():
        frequency.set_yscale("log")
        frequency.plot(factor * V, np.where(turns, scale * turns, np.nan), color=BLUE, lw=1.4)
    else:
        frequency.set_yticks([])
        frequency.text(0.97, 0.1, "no oscillation", transform=frequency.transAxes, ha="right")
    for ax in (growth, frequency):
        ax.axvline(factor * V_lp, color=RED, lw=0.8, label="this slider")
    growth.legend(loc="best")


@styled
def response_figure(result):
    """Draw the figure of one slider's response to oscillations of many frequencies."""
    if result.sizes.get("frequency", 1) < 2:
        raise ParameterError(
            "a figure of a frequency response shows several frequencies",
            "Give frequency a list, such as numpy.geomspace(1, 1000, 400).",
        )
    V_lp, law = float(result.V_lp), LAWS[parameter(result, "law")].name
    fig = figure(result, 4.4, title=f"Response of sliding at {value_text('V_lp', V_lp)}; {law}")
    axes = fig.subplots(3, 2, sharex=True, sharey="row")
    scale, unit = prefixed("Hz", float(np.median(result.frequency)))
    frequency = scale * result.frequency.values
    for column, name in zip(axes.T, INPUTS, strict=True):
        _draw_gains(column, result, name, frequency)
        column[-1].set_xlabel(f"Frequency [{unit}]")
        if np.isfinite(resonance := float(result.resonance)):
            for ax in column:
                ax.axvline(scale * resonance, color=GRAY, lw=0.8, ls=":")
    axes[0, 0].set_ylabel(r"$|\Delta \ln V|$")
    axes[1, 0].set_ylabel(r"$|\Delta\tau|/\sigma$,  $|\Delta\mu|$")
    axes[2, 0].set_ylabel("Phase [degrees]")
    axes[2, 0].yaxis.set_major_locator(MultipleLocator(90.0))
    for ax in axes[1:, 0]:
        ax.legend(loc="best")
    fig.align_ylabels(axes[:, 0])
    texts = [f"per relative change of {text} {label(name)}" for name, text in INPUTS.items()]
    letters(axes[0], *texts)
    return fig


def _draw_gains(column, result, name, frequency):
    """Gains of V, of tau and mu, and the phases, in three axes."""
    V_lp, sigma = float(result.V_lp), float(parameter(result, "sigma"))
    size = {"V_lp": V_lp, "sigma": sigma}[name]
    units = {"V": V_lp, "tau": sigma, "mu": 1.0}
    for out, (color, dashes) in LINES.items():
        look = {"color": color, "ls": dashes, "lw": 1.4, "label": label(out)}
        gain = result[f"{out}_by_{name}_gain"].values * size / units[out]
        column[0 if out == "V" else 1].plot(frequency, gain, **look)
        phase = np.degrees(np.unwrap(result[f"{out}_by_{name}_phase"].values))
        column[2].plot(frequency, phase, **look)
    for ax in column[:2]:
        ax.set(xscale="log", yscale="log", xlim=frequency[[0, -1]])
