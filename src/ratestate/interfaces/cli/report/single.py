"""Tables about one slider: a run, a cycle, its stability, a branch."""

import math
from typing import TYPE_CHECKING, Any

from ....model.quantities import readable, readable_multiplier
from .rows import DIGITS, Row, row, table, when

if TYPE_CHECKING:
    import xarray

MULTIPLIERS = "Floquet multipliers; decay factors per period"


def run(result: "xarray.Dataset") -> list[Any]:
    """The end of a run, its extremes, and the last cycle that its tolerance resolves."""
    from ....dynamics.results import parameter

    last = result.isel(time=-1)
    end = float(last.time)
    V = result.V.values
    fastest, slowest = (f"at {when(float(result.time[i]))}" for i in (V.argmax(), V.argmin()))
    rows = [
        row("V", last.V, f"load point {readable('V_load', float(last.V_load), DIGITS)}"),
        row("tau", last.tau, f"tau/sigma = {float(last.tau) / parameter(result, 'sigma'):.6g}"),
        row("mu", last.mu),
        row("theta", last.theta),
        row("V_max", result.V_max, fastest),
        row("V_min", result.V_min, slowest),
        row("cycles", result.cycles, "since the last jump of the load point"),
    ]
    if float(result.cycles) >= 1.0:
        # (of a limit cycle, of ringing that decays, or due to the load point)
        amplitude, frequency = float(result.amplitude), float(result.frequency)
        rows.append(row("amplitude", amplitude, "of the last cycle"))
        rows.append(Row("frequency", readable("frequency", frequency, DIGITS), "of the last cycle"))
    rows.append(row("energy_residual", abs(result.energy_residual)))
    law = parameter(result, "law")
    title = f"At the end, {when(end)}, after {int(result.steps):,} steps, {law} law"
    return table(title, rows)


def stability(result: "xarray.Dataset") -> list[Any]:
    """Stiffness and speed beside their critical values; the least stable mode."""
    from ....dynamics.results import parameter
    from ....dynamics.wording import on_edge

    K, V = float(parameter(result, "K")), float(result.V_lp)
    growth, omega = float(result.growth_rate), float(result.omega)
    holds = "stable" if result.stable else "unstable"
    if on_edge(K, float(result.K_c)):
        holds = "on the edge of stability"
    M = float(parameter(result, "M"))
    massless = "M = 0" if M == 0.0 else "K = inf" if math.isinf(K) else ""
    rows = [
        row("K", K, f"{K / float(result.K_c):.4g} K_c" if math.isfinite(K) else "rigid"),
        row("K_c", result.K_c, "unstable where K < K_c"),
        row("K_c_qs", result.K_c_qs, "without inertia"),
        row("V_lp", V),
        row("V_c", result.V_c, _speed_remark(float(result.V_c), V)),
        row("eta", result.eta, "share by which inertia raises K_c"),
        row("f_n", result.f_n, massless),
        row("growth_rate", growth, _growth_time(growth)),
        row(
            "omega",
            omega,
            f"{readable('f_n', omega / (2 * math.pi), 4)}" if omega else "non-oscillatory",
        ),
    ]
    if not math.isnan(float(result.omega_c)):
        rows.append(row("omega_c", result.omega_c))
    return table(f"Steady sliding at {readable('V_lp', V)} is {holds}", rows)


def _speed_remark(critical: float, V: float) -> str:
    """The remark on V_c: how V_lp compares with it."""
    if critical == 0.0:
        return "unstable at any speed"
    if math.isinf(critical):
        return "stable at any speed"
    return f"V_lp is {V / critical:.4g} V_c"


def _growth_time(growth: float) -> str:
    """The e-folding time of a growth rate, as a remark."""
    if growth == 0.0 or math.isinf(growth):
        return ""
    what = "grows" if growth > 0.0 else "decays"
    return f"{what}; e-folding time {when(1.0 / abs(growth))}"


def cycle(result: "xarray.Dataset") -> list[Any]:
    """The numbers of a limit cycle, with their error."""
    from ....dynamics.results import parameter
    from ....engine.model import STEADY_SLIDING

    V = float(result.V_lp)
    at = f"at V_lp = {readable('V_lp', V)}, {parameter(result, 'law')} law"
    if int(result.status) == STEADY_SLIDING:
        return table(f"No cycle is reached {at}: steady sliding", [row("V_lp", V)])
    error = float(result.error)
    rows = [
        row("period", result.period, error=error),
        row("frequency", result.frequency, error=error),
        row("amplitude", result.amplitude, error=error),
        *(
            row(
                name,
                result[name],
                f"{float(result[name]) / V:.4g} V_lp",
                error=float(result[f"{name}_error"]),
            )
            for name in ("V_max", "V_min")
        ),
        row("inertia", result.inertia),
        row("slow_fraction", result.slow_fraction),
        row("fundamental", result.fundamental, "1 harmonic, 0.61 sawtooth"),
        Row(
            "multipliers",
            ", ".join(map(readable_multiplier, result.multipliers.values)),
            MULTIPLIERS,
        ),
        row("residual", result.residual),
    ]
    return table(f"The limit cycle {at}", rows)


def branch(result: "xarray.Dataset") -> list[Any]:
    """The bifurcation points of a branch, and the stability of cycles between them."""
    from rich import box
    from rich.table import Table
    from rich.text import Text

    from ....dynamics.attributes import branch_parameter

    symbol = branch_parameter(result)
    made = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False)
    for name in ("point", symbol, "amplitude", "period", "V_max", "multiplier", "cycles after it"):
        made.add_column(name, justify="left" if name in ("point", "cycles after it") else "right")
    stable = result.stable.values.astype(bool)
    special = [i for i, name in enumerate(result.special.values) if name]
    for i in special:
        one = result.isel(point=i)
        after = i + 1 < stable.size
        made.add_row(
            str(one.special.values).replace("_", " "),
            readable(symbol, float(one[symbol]), DIGITS),
            f"{float(one.amplitude):.{DIGITS}g}",
            when(float(one.period)),
            readable("V_max", float(one.V_max), DIGITS),
            readable_multiplier(complex(one.multipliers[0])),
            ("stable" if stable[i + 1] else "unstable") if after else "",
        )
    low, high = (readable(symbol, float(x)) for x in (result[symbol].min(), result[symbol].max()))
    worst = float(result.error.max())
    title = (
        f"A branch of {result.sizes['point']} limit cycles, {symbol} from {low} to {high}, "
        f"{int(stable.sum())} of them stable; relative error up to {worst:.1g}"
    )
    return [Text(title, style="bold"), made]
