"""The variables of a limit cycle, in SI, from its dimensionless measures."""

import numpy as np

from ...engine.model import STEADY_SLIDING
from ...friction.rate_and_state import mu_ss
from ...friction.stability import K_c
from ..domain import domain_variables
from ..results import columns, status_variable
from ..simulation.cases import speed

#: their names, which a dimension or coordinate of the sweep cannot have
VARIABLES = (
    "period frequency amplitude V_max V_min inertia slow_fraction fundamental multipliers"
    " multiplier stable residual error V_max_error V_min_error returns mu_min reversal_margin"
    " outside_domain status"
).split()


def cycle_variables(batch, status, measures, stable):
    """The result's variables, name -> Variable [SI], from the measures of cycles; NaN without one.

    In steady sliding amplitude, inertia and errors are 0, V_max = V_min = V_lp and stable is
    K > K_c; `returns`, an int16, is 0 without a cycle.

    batch : holds the slider and V_lp
    measures : as of `measure`, name -> (n,) or (n, 2), NaN where there is no cycle; or empty
    stable : (n,) whether the cycles are
    """
    p, V, steady = columns(batch), batch.flat("V_lp"), status == STEADY_SLIDING
    nothing = np.full(batch.n, np.nan)

    def measured(name, if_steady=np.nan):
        return np.where(steady, if_steady, measures.get(name, nothing))

    period, amplitude = measured("period") * p.Dc / V, measured("amplitude", 0.0)
    critical = K_c(V, a=p.a, b=p.b, Dc=p.Dc, sigma=p.sigma, M=p.M)
    with np.errstate(divide="ignore", invalid="ignore"):
        values = {
            "period": period,
            "frequency": 1.0 / period,
            "amplitude": p.a * amplitude,
            "V_max": speed(measured("v_max", 0.0), V),
            "V_min": speed(measured("v_min", 0.0), V),
            "inertia": np.where(steady, 0.0, measured("g_max") / amplitude),
            "slow_fraction": measured("slow_fraction", 0.0),
            "fundamental": measured("fundamental"),
            "stable": np.where(steady, critical < p.K, stable),
            "residual": measured("residual", 0.0),
            "error": measured("error", 0.0),
            "V_max_error": measured("v_max_error", 0.0),
            "V_min_error": measured("v_min_error", 0.0),
            "returns": np.nan_to_num(measured("returns", 0.0)).astype(np.int16),
        }
    variables = {name: batch.variable(value, name) for name, value in values.items()}
    mu = mu_ss(V, a=p.a, b=p.b, mu0=p.mu0, V0=p.V0)
    lowest = mu + p.a * measured("f_min", 0.0), 2.0 * mu + p.a * measured("xf_min", 0.0)
    variables |= domain_variables(batch, *lowest)
    multipliers = measures.get("multipliers", np.full((batch.n, 2), np.nan, complex))
    variables["multipliers"] = batch.variable(multipliers, "multipliers", "multiplier")
    return variables | {"status": status_variable(batch, status)}
