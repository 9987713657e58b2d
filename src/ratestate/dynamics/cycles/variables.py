"""The variables of a limit cycle, in SI, from its dimensionless measures."""

import numpy as np

from ...engine.model import STEADY_SLIDING
from ...friction.linear_stability import is_stable
from ..domain import domain_variables
from ..results import columns, status_variable

#: their names, which a dimension or coordinate of the sweep cannot have
VARIABLES = (
    "period frequency amplitude V_max V_min inertia slow_fraction fundamental multipliers"
    " multipliers_error multiplier stable residual error V_max_error V_min_error returns mu_min"
    " reversal_margin outside_domain status"
).split()


def cycle_variables(law, batch, status, measures, stable):
    """The result's variables, name -> Variable [SI], from the measures of cycles; NaN without one.

    In steady sliding amplitude, inertia and errors are 0, V_max = V_min = V_lp and stable is
    whether that is; `returns`, an int16, is 0 without a cycle.

    law, batch : the friction law; holds the slider and V_lp
    measures : as of `measure`, name -> (n,) or (n, k), NaN where there is no cycle; or empty
    stable : (n,) whether the cycles are
    """
    p, V, steady = columns(batch), batch.flat("V_lp"), status == STEADY_SLIDING
    nothing = np.full(batch.n, np.nan)

    def measured(name, if_steady=np.nan):
        return np.where(steady, if_steady, measures.get(name, nothing))

    period, amplitude = measured("period") * p.Dc / V, measured("amplitude", 0.0)
    at_V, psi = law.coefficient_arrays(V, batch.columns), law.reference_state
    steady_v = law.v_at(1.0, psi, at_V)
    of_law = {symbol: batch.flat(symbol) for symbol in law.symbols}
    steadily = is_stable(law, V, sigma=p.sigma, K=p.K, M=p.M, **of_law)
    with np.errstate(divide="ignore", invalid="ignore"):
        values = {
            "period": period,
            "frequency": 1.0 / period,
            "amplitude": p.a * amplitude,
            "V_max": V * law.speed(measured("v_max", steady_v), psi, at_V),
            "V_min": V * law.speed(measured("v_min", steady_v), psi, at_V),
            "inertia": np.where(steady, 0.0, measured("g_max") / amplitude),
            "slow_fraction": measured("slow_fraction", 0.0),
            "fundamental": measured("fundamental"),
            "stable": np.where(steady, steadily, stable),
            "residual": measured("residual", 0.0),
            "error": measured("error", 0.0),
            "V_max_error": measured("v_max_error", 0.0),
            "V_min_error": measured("v_min_error", 0.0),
            "returns": np.nan_to_num(measured("returns", 0.0)).astype(np.int16),
        }
    variables = {name: batch.variable(value, name) for name, value in values.items()}
    mu = law.reference_friction(V, batch.columns)
    at = law.steady(at_V)
    lowest = mu + p.a * measured("f_min", at.R), 2.0 * mu + p.a * measured("xf_min", at.R + at.S)
    variables |= domain_variables(law, batch, *lowest)
    without = np.full((batch.n, 1 + len(law.states)), np.nan)
    for name, dtype in (("multipliers", complex), ("multipliers_error", float)):
        value = measures.get(name, without.astype(dtype))
        variables[name] = batch.variable(value, name, "multiplier")
    return variables | {"status": status_variable(batch, status)}
