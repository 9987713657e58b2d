"""Tables about one slider: a run, a cycle, its stability, a branch, a frequency response."""

import math
from typing import Any

import numpy as np
import xarray

from ..dynamics.results import (
    branch_parameter,
    law_of_result,
    normal_stress,
    parameter,
    slider_parameters,
    whole_contact,
)
from ..dynamics.stabilize import stabilize
from ..dynamics.verdict_sentences import on_edge
from ..engine.model import STEADY_SLIDING
from ..model.quantities import readable, readable_multiplier, readable_time
from ..model.slider import SpringSlider
from .many_cases import outside_lines
from .report import (
    ANY_SPEED,
    DIGITS,
    FEW_DIGITS,
    Blocks,
    Heading,
    Row,
    TextTable,
    Title,
    Units,
    left,
    of_quantities,
    value_text,
)

#: ratio to V_lp of the speed at which remedies make steady sliding stable
MARGIN = 1.1
#: what makes sliding stable -> the side of its bound
REMEDIES = {"K": ">=", "M": "<=", "damping": ">="}
#: variables in the table of special points
OF_POINTS = ("amplitude", "period", "V_max")
#: what oscillates -> the head of its gain
OUTPUTS = {"V": "V/V_lp", "tau": "tau/sigma", "mu": "mu"}
#: frequencies of a table, at most
MOST_FREQUENCIES = 16


def run(result: xarray.Dataset, units: Units) -> Blocks:
    """The end of a run, its extremes, and the last cycle that its tolerance resolves."""
    last = result.isel(time=-1)
    V = result.V.values
    times = (readable_time(float(result.time[i]), DIGITS) for i in (V.argmax(), V.argmin()))
    fastest, slowest = (f"at {time}" for time in times)
    rows = [
        Row("V", last.V, f"load point {readable('V_load', float(last.V_load), DIGITS)}"),
        Row("tau", last.tau, f"tau/sigma = {float(last.tau) / float(normal_stress(last)):.6g}"),
        *_of_contact(last, "force", "acceleration"),
        Row("mu", last.mu),
        Row("theta", last.theta),
        Row("V_max", result.V_max, fastest),
        Row("V_min", result.V_min, slowest),
        *_of_contact(result, "acceleration_max"),
        Row("cycles", result.cycles, "since the last jump of the loading"),
    ]
    if float(result.frequency) > 0.0:
        # (of a limit cycle, of ringing that decays, or due to the load point)
        sigma = parameter(result, "sigma")
        varies = "sigma" in result.data_vars
        reference = f", over sigma(0) = {value_text('sigma', sigma, units)}" if varies else ""
        rows.append(Row("amplitude", result.amplitude, f"of the last cycle{reference}"))
        rows.append(Row("stress_drop", result.amplitude * sigma, "of the last cycle"))
        rows += _of_contact(result, "force_amplitude", "displacement_amplitude")
        rows.append(Row("frequency", result.frequency, "of the last cycle"))
    rows.append(Row("energy_residual", abs(result.energy_residual)))
    end, law = readable_time(float(last.time), DIGITS), parameter(result, "law")
    title = f"At the end, {end}, after {int(result.steps):,} steps, {law} law"
    return [Title(title), of_quantities(rows, units)]


def _of_contact(result: xarray.Dataset, *symbols: str) -> list[Row]:
    """Rows about the contact as a whole, if its area is known; of M > 0 only if about inertia."""
    values = whole_contact(result)
    known = [symbol for symbol in symbols if symbol in values and values[symbol].notnull()]
    return [Row(symbol, values[symbol]) for symbol in known]


def stability(result: xarray.Dataset, units: Units) -> Blocks:
    """Stiffness and speed beside their critical values; the least stable mode."""
    K, M = float(parameter(result, "K")), float(parameter(result, "M"))
    V, K_c, V_c = float(result.V_lp), float(result.K_c), float(result.V_c)
    growth, omega = float(result.growth_rate), float(result.omega)
    holds = "stable" if result.stable else "unstable"
    if on_edge(K, K_c):
        holds = "on the edge of stability"
    upper = float(result.V_c_upper)
    speeds = ANY_SPEED.get(V_c) or f"V_lp is {V / V_c:.4g} V_c"
    speeds = speeds if upper == math.inf else "unstable from here on"
    one_length = law_of_result(result).one_length
    turns = (float(x) / (2 * math.pi) for x in (omega, result.omega_c))
    frequency, hopf = (readable("frequency", x, 4) for x in turns)
    ratio = f"{K / K_c:.4g} K_c" if K_c > 0.0 else ""
    e_folding = ""
    if growth != 0.0 and math.isfinite(growth):
        tendency = "grows" if growth > 0.0 else "decays"
        e_folding = f"{tendency}; e-folding time {readable_time(1.0 / abs(growth), DIGITS)}"
    rows = [
        Row("K", K, ratio if math.isfinite(K) else "rigid"),
        _critical("K_c", K_c, "unstable where K < K_c"),
        _critical("K_c_qs", float(result.K_c_qs), "without inertia"),
        Row("V_lp", V),
        Row("V_c", V_c, speeds),
        *([Row("V_c_upper", upper, "stable from here on")] if upper < math.inf else []),
        Row("eta", result.eta, "share by which inertia raises K_c" if one_length else ""),
        Row("f_n", result.f_n, "M = 0" if M == 0.0 else "K = inf" if math.isinf(K) else ""),
        Row("growth_rate", growth, e_folding),
        Row("omega", omega, frequency if omega else "non-oscillatory"),
    ]
    if not math.isnan(float(result.omega_c)):
        change = "lowered" if K_c < K else "raised"
        remark = f"{hopf}, if K were {change} to K_c at this speed"
        rows.append(Row("omega_c", result.omega_c, remark))
    title = f"Steady sliding at {value_text('V_lp', V, units, FEW_DIGITS)} is {holds}"
    blocks: Blocks = [Title(title), of_quantities(rows, units)]
    if holds == "unstable":
        heads = [left(), Heading("value"), *2 * [left()]]
        speed = f"{MARGIN:g} V_lp = {value_text('V_lp', MARGIN * V, units, FEW_DIGITS)}"
        blocks += ["", Title(f"Each alone makes it stable at {speed}")]
        blocks.append(TextTable(heads, remedies(result, units)))
    return blocks


def remedies(result: xarray.Dataset, units: Units) -> list[list[str]]:
    """Return what makes one slider stable at `MARGIN` V_lp, each alone, from its `stability`.

    A row consists of symbol, bound such as ">= 2.904 GPa/m", critical velocity, and remark.
    """
    known = {symbol: parameter(result, symbol) for symbol in slider_parameters(result)}
    found = stabilize(SpringSlider(**known), float(result.V_lp), MARGIN)
    rows = []
    for symbol, sign in REMEDIES.items():
        x, V_c = float(found[f"{symbol}_stable"]), float(found[f"V_c_with_{symbol}"])
        if math.isnan(x):
            rows.append([symbol, "none", "", "no mass is small enough"])
            continue
        bound = f"{sign} {value_text(symbol, x, units, FEW_DIGITS)}"
        speed = f"V_c = {value_text('V_c', V_c, units, FEW_DIGITS)}"
        if V_c in ANY_SPEED:
            speed = ANY_SPEED[V_c] if V_c else "but unstable at all lower speeds"
        ratio = float(found.damping_ratio_stable) if symbol == "damping" else math.nan
        remark = "" if math.isnan(ratio) else f"damping ratio {ratio:.3g}"
        rows.append([symbol, bound, speed, remark])
    return rows


def _critical(symbol: str, K: float, remark: str) -> Row:
    """The row of a critical stiffness, which is not > 0 where friction does not weaken."""
    return Row(symbol, K, remark) if K > 0.0 else Row(symbol, math.inf, "stable at any stiffness")


def cycle(result: xarray.Dataset, units: Units) -> Blocks:
    """The numbers of a limit cycle, with their error; of steady sliding, that there is none."""
    V = float(result.V_lp)
    speed = value_text("V_lp", V, units, FEW_DIGITS)
    at = f"at V_lp = {speed}, {parameter(result, 'law')} law"
    if int(result.status) == STEADY_SLIDING:
        title = Title(f"No cycle is reached {at}: steady sliding")
        return [title, of_quantities([Row("V_lp", V)], units)]
    numbers = {name: result[name] for name in ("period", "frequency", "amplitude")}
    numbers["stress_drop"] = result.amplitude * parameter(result, "sigma")
    rows = [Row(name, value, error=float(result.error)) for name, value in numbers.items()]
    names = ("force_amplitude", "displacement_amplitude", "acceleration_max")
    rows += _of_contact(result, *names)
    for name in ("V_max", "V_min"):
        multiple = f"{float(result[name]) / V:.4g} V_lp"
        rows.append(Row(name, result[name], multiple, error=float(result[f"{name}_error"])))
    multipliers = ", ".join(map(readable_multiplier, result.multipliers.values))
    rows += [
        Row("inertia", result.inertia),
        Row("slow_fraction", result.slow_fraction),
        Row("fundamental", result.fundamental, "1 harmonic, 0.61 sawtooth"),
        Row("multipliers", math.nan, "decay factors per period", text=multipliers),
        Row("residual", result.residual),
    ]
    return [Title(f"The limit cycle {at}"), of_quantities(rows, units)]


def branch(result: xarray.Dataset, units: Units) -> Blocks:
    """The bifurcation points of a branch, and the stability of cycles between them."""
    symbol = branch_parameter(result)
    stable = result.stable.values.astype(bool)
    cycles = result.isel(point=result.amplitude.values > 0.0)  # without Hopf points
    number = int(cycles.stable.sum())
    ends = (result[symbol].min(), result[symbol].max())
    low, high = (value_text(symbol, float(x), units, FEW_DIGITS) for x in ends)
    worst = float(result.error.max())
    title = (
        f"A branch of {cycles.sizes['point']} limit cycles, {symbol} from {low} to {high}, "
        f"{'all' if number == cycles.sizes['point'] else number} of them stable; "
        f"relative error up to {worst:.1g}"
    )
    outside = outside_lines(cycles, "cycles", units, [symbol])
    return [Title(title), *outside, _special_points(result, symbol, stable, units)]


def _special_points(result: xarray.Dataset, symbol: str, stable: Any, units: Units) -> TextTable:
    """The points of a branch that have a name, and the stability of cycles after each."""
    rows = []
    after = [*("stable" if holds else "unstable" for holds in stable[1:]), ""]
    for i in np.flatnonzero(result.special.values != ""):
        point = result.isel(point=i)
        numbers = (value_text(name, float(point[name]), units) for name in (symbol, *OF_POINTS))
        multiplier = readable_multiplier(complex(point.multipliers[0]))
        name = str(point.special.item()).replace("_", " ")
        rows.append([name, *numbers, multiplier, after[i]])
    heads = [symbol, *OF_POINTS, "multiplier"]
    columns = [*map(Heading, heads), left("cycles\nafter it")]
    return TextTable([left("point"), *columns], rows, splits=True)


def response(result: xarray.Dataset, units: Units) -> Blocks:
    """The resonance, and gains and phases at some of the frequencies."""
    V, sigma = float(result.V_lp), float(parameter(result, "sigma"))
    law = parameter(result, "law")
    title = f"The response of steady sliding at {readable('V_lp', V)}, {law} law"
    known = np.isfinite(float(result.resonance))
    rows = [
        Row("resonance", result.resonance, "" if known else "the slider does not oscillate"),
        Row("quality", result.quality),
    ]
    curve = result if "frequency" in result.dims else result.expand_dims("frequency")
    n = curve.sizes["frequency"]
    drawn = curve.isel(
        frequency=np.unique(np.linspace(0, n - 1, min(n, MOST_FREQUENCIES)).round().astype(int))
    )
    low, high = (readable("frequency", float(x)) for x in (curve.frequency[0], curve.frequency[-1]))
    note = f"{n} frequencies from {low} to {high}" if n > 1 else f"One frequency, {low}"
    note += f", {drawn.sizes['frequency']} of them shown" if n > MOST_FREQUENCIES else ""
    of_size = {"V": V, "tau": sigma, "mu": 1.0}
    tables: Blocks = []
    for given, size in (("V_lp", V), ("sigma", sigma)):
        tables += ["", Title(f"Per relative change of {given} (phases in degrees)")]
        tables.append(_gains(drawn, given, {out: size / x for out, x in of_size.items()}, units))
    return [Title(title), of_quantities(rows, units), "", note, *tables]


def _gains(
    result: xarray.Dataset, given: str, factors: dict[str, float], units: Units
) -> TextTable:
    """Gains, times these factors, and phases in degrees."""
    heads = ["frequency", *(head for name in OUTPUTS.values() for head in (name, "phase"))]
    rows = []
    for i, frequency in enumerate(result.frequency.values):
        response = result.isel(frequency=i)
        cells = [value_text("frequency", float(frequency), units, FEW_DIGITS)]
        for out, factor in factors.items():
            gain, phase = (float(response[f"{out}_by_{given}_{x}"]) for x in ("gain", "phase"))
            cells += [f"{gain * factor:.{FEW_DIGITS}g}", f"{np.degrees(phase):.1f}"]
        rows.append(cells)
    return TextTable([*map(Heading, heads)], rows)


#: function -> the table of its result for a single slider
TABLES = {
    "simulate": run,
    "limit_cycle": cycle,
    "stability": stability,
    "frequency_response": response,
    "continue_cycle": branch,
}
