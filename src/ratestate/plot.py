"""Pictures of results: functions of (Dataset, ax), which the paper's figures are made of.

>>> import ratestate as rs
>>> from matplotlib.figure import Figure
>>> slider = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", M=3000, K="900 MPa/m")
>>> run = rs.simulate(slider, rs.Loading.steps("0.1 mm/s", (1.0, "3.2 mm/s")), t_end=1.2)
>>> black, red = trace(run, Figure().subplots())

Parameters that a picture needs (the normal stress, for tau/sigma) are read from the provenance
that every result carries.
"""

import json

import numpy as np
import xarray

from .errors import ParameterError
from .quantities import QUANTITIES

STRESS = r"$\tau/\sigma$"
AMPLITUDE = f"Amplitude of {STRESS} (max $-$ min)"
RED, BLUE, GRAY = "#d62728", "#1f4fd8", "0.55"

#: power of ten -> prefix
PREFIXES = {9: "G", 6: "M", 3: "k", 0: "", -3: "m", -6: "\N{GREEK SMALL LETTER MU}", -9: "n"}
#: SI unit -> how a label writes it, and the prefixes it takes
UNITS = {
    "1": ("", (0,)),
    "m": ("m", (0, -3, -6, -9)),
    "s": ("s", (0, -3, -6)),
    "m/s": ("m/s", (0, -3, -6, -9)),
    "Pa": ("Pa", (9, 6, 3, 0)),
    "Pa/m": ("Pa/m", (9, 6, 3, 0)),
    "kg/m^2": (r"kg/m$^2$", (0,)),
    "Hz": ("Hz", (3, 0)),
}
#: symbol -> how a label writes it, where it is more than one letter
LETTERS = {
    "Dc": "D_c",
    "V0": "V_0",
    "mu0": r"\mu_0",
    "sigma": r"\sigma",
    "V_lp": "V_{lp}",
    "K_c_qs": "K_{c,qs}",
    "eta": r"\eta",
}


def prefixed(unit, value):
    """Factor from SI, and the unit's text, that bring a value to 1 or more.

    >>> prefixed("m/s", 0.0032)
    (1000.0, 'mm/s')
    """
    text, powers = UNITS[unit]
    size = abs(value) * (1 + 1e-9)  # 1e-3 is 1 m, whatever its rounding
    power = next((p for p in powers if size >= 10.0**p), powers[-1] if size > 0 else 0)
    return 10.0**-power, PREFIXES[power] + text


def label(symbol):
    """A symbol as mathematics, for example ``$V_{lp}$``."""
    return f"${LETTERS.get(symbol, symbol)}$"


def value_text(symbol, value, unit_of=None):
    """A quantity as text: symbol, value and a unit that fits it, or fits `unit_of`."""
    factor, unit = prefixed(QUANTITIES[symbol].unit, value if unit_of is None else unit_of)
    return f"{label(symbol)} = {value * factor:.4g} {unit}".rstrip()


def parameter(data, symbol):
    """A slider's parameter from the provenance of a result: float, DataArray, or the law."""
    if "slider" not in data.attrs:
        raise ParameterError(
            f"{symbol} is unknown: the Dataset has lost its attribute 'slider' (arithmetic drops "
            f"attributes; copy data.attrs over)"
        )
    value = json.loads(data.attrs["slider"])[symbol]
    if isinstance(value, dict):
        return xarray.DataArray(value["values"], dims=value["dims"])
    return value


def trace(run, ax, *, x="time", tau=None, mu=None):
    """Draw tau/sigma in black and friction mu in red dashes against time.

    Parameters
    ----------
    run : xarray.Dataset
        One slider's, from `simulate`: dimension ``time`` only.
    ax : matplotlib.axes.Axes
    x : {"time", "delta_lp"}
        Abscissa: time [s] or load-point displacement [m].
    tau, mu : dict, optional
        Changes to the style of the two lines.

    Returns
    -------
    tuple of matplotlib.lines.Line2D
        The black and the red line.
    """
    abscissa = run[x]
    factor, unit = prefixed(QUANTITIES[x].unit, float(abs(abscissa).max()))
    stress = {"color": "k", "lw": 1.0, "label": f"{STRESS}, spring"} | (tau or {})
    friction = {"color": RED, "lw": 1.0, "ls": (0, (4, 2)), "label": r"$\mu$, friction"}
    (black,) = ax.plot(factor * abscissa, run.tau / parameter(run, "sigma"), **stress)
    (red,) = ax.plot(factor * abscissa, run.mu, **friction | (mu or {}))
    name = "Time" if x == "time" else "Load-point displacement"
    ax.set(xlabel=f"{name} [{unit}]", ylabel=rf"{STRESS} and $\mu$")
    return black, red


def phase(run, ax, *, unit_of=None, **style):
    """Draw slip velocity against tau/sigma, and a cross at steady sliding at the last V_load.

    Parameters
    ----------
    run : xarray.Dataset
        One slider's, from `simulate`: dimension ``time`` only.
    ax : matplotlib.axes.Axes
    unit_of : float, optional
        Speed [m/s] that sets the unit; by default the largest.
    **style
        Of the line.

    Returns
    -------
    matplotlib.lines.Line2D
    """
    V = float(run.V_load[-1])
    factor, unit = prefixed("m/s", unit_of or float(run.V.max()))
    (line,) = ax.plot(run.tau / parameter(run, "sigma"), factor * run.V, **{"lw": 0.5} | style)
    if V > 0:
        a, b, mu0, V0 = (parameter(run, symbol) for symbol in ("a", "b", "mu0", "V0"))
        ax.plot(mu0 + (a - b) * np.log(V / V0), factor * V, "kx", ms=5, mew=1.0, zorder=5)
    ax.set(xlabel=STRESS, ylabel=f"$V$ [{unit}]")
    return line


def amplitudes(cycles, ax, x="V_lp", **style):
    """Draw the amplitude of limit cycles against load-point velocity, or another variable.

    Parameters
    ----------
    cycles : xarray.Dataset
        From `limit_cycle`, along one dimension ``V_lp``.
    ax : matplotlib.axes.Axes
    x : str
        "V_lp" [m/s], "frequency" [Hz] or "period" [s], on a logarithmic axis.
    **style
        Of the line.

    Returns
    -------
    matplotlib.lines.Line2D
    """
    (line,) = ax.plot(cycles[x], cycles.amplitude, **{"color": "k", "lw": 1.3} | style)
    names = {"V_lp": "Loading velocity", "frequency": "Frequency", "period": "Period"}
    ax.set_xscale("log")
    ax.set(xlabel=f"{names[x]} [{QUANTITIES[x].unit}]", ylabel=AMPLITUDE)
    return line
