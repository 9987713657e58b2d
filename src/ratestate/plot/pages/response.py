"""The page of a frequency response: gains and phases, of speed and of normal stress."""

import numpy as np
from matplotlib.ticker import MultipleLocator

from ...dynamics.results import parameter
from ...errors import ParameterError
from ..labels import BLUE, GRAY, LAWS, RED, label, prefixed, value_text
from ..layout import figure, letters, styled

#: what answers -> color and dashes
LINES = {"tau": ("k", "-"), "mu": (RED, "--"), "V": (BLUE, "-")}
INPUTS = {"V_lp": "load-point velocity", "sigma": "normal stress"}


@styled
def response_page(result):
    """Page (Figure) of one slider's response to oscillations of many frequencies."""
    if result.sizes.get("frequency", 1) < 2:
        raise ParameterError(
            "a page of a frequency response shows several frequencies",
            "Give frequency a list, such as numpy.geomspace(1, 1000, 400).",
        )
    V_lp, law = float(result.V_lp), LAWS[parameter(result, "law")].name
    fig = figure(result, 4.4, title=f"Response of sliding at {value_text('V_lp', V_lp)}; {law}")
    axes = fig.subplots(3, 2, sharex=True, sharey="row")
    scale, unit = prefixed("Hz", float(np.median(result.frequency)))
    frequency = scale * result.frequency.values
    for column, name in zip(axes.T, INPUTS, strict=True):
        _draw(column, result, name, frequency)
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


def _draw(column, result, name, frequency):
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
