"""The state at t = 0: steady sliding, with any part of it overridden."""

import numpy as np

from ..errors import ParameterError
from .slider import PARAMETERS
from .units import to_si

SYMBOLS = ("V", "theta", "tau")


def initial_values(initial):
    """The values given for t = 0 in SI, under the names "V_initial" and so on; {} for None.

    ParameterError for another key, type, unit or range; `initial_state` sees whether they agree.
    """
    if initial is None:
        return {}
    if not isinstance(initial, dict) or not set(initial) <= set(SYMBOLS):
        raise ParameterError(
            f"initial = {initial!r} must be a dict with any of the keys V, theta and tau, "
            f"for example {{'theta': '10 s'}}"
        )
    return {
        f"{symbol}_initial": to_si(symbol, value, label=f"initial {symbol}")
        for symbol, value in initial.items()
    }


def initial_state(batch, V_load):
    """(n, 3) x = (tau/sigma - mu0)/a, v = ln(V/V0) and psi = ln(V0 theta/Dc) at t = 0.

    Steady sliding at V_start, but for what `initial` gives.  Where M = 0 friction fixes what is
    left out.  Where K = inf V is V_load, and friction fixes theta or tau by the other.

    ParameterError where values disagree, by more than 1e-9 in x - v - beta psi: V, theta and tau
    where M = 0, theta and tau where K = inf; for V other than V_load where K = inf; and for b = 0
    where tau would have to fix theta.  Ranges are checked by `initial_values`.

    batch : with the slider's parameters, V_start, and what `initial_values` found
    V_load : (n,) speed of the load point at t = 0 [m/s], imposed on the slider where K = inf
    """
    a, b, Dc, sigma, K, M, mu0, V0 = map(batch.flat, PARAMETERS)
    given = {s: batch.flat(f"{s}_initial") for s in SYMBOLS if f"{s}_initial" in batch.values}
    beta, v = b / a, np.log(batch.flat("V_start") / V0)
    x, psi = (1 - beta) * v, -v
    if "V" in given:
        v = np.log(given["V"] / V0)
    if "theta" in given:
        psi = np.log(V0 * given["theta"] / Dc)
    if "tau" in given:
        x = (given["tau"] / sigma - mu0) / a
    rigid = np.isinf(K)
    v = np.where(rigid, np.log(np.maximum(V_load, 5e-324) / V0), v)
    bound = (M == 0) | rigid  # there tau/sigma = mu, and two of the three fix the third
    if "V" in given and (np.abs(v - np.log(given["V"] / V0)) > 1e-9).any():
        raise ParameterError(
            "initial V: where K = inf the slider moves at the load point's speed from t = 0 on; "
            "leave V out" + (", and theta or tau" if len(given) == 3 else "")
        )
    fixed = bound if "V" in given else rigid & (V_load > 0.0)  # at rest friction fixes nothing
    clash = fixed & (np.abs(x - v - beta * psi) > 1e-9)
    if {"theta", "tau"} <= set(given) and clash.any():
        i = int(np.argmax(clash))
        mu = mu0[i] + a[i] * (v[i] + beta[i] * psi[i])
        which = "V, theta and tau" if "V" in given else "theta and tau"
        where, remedy = "without inertia (M = 0)", "leave one of them out, or give M > 0"
        if rigid[i]:
            where, remedy = "where K = inf", "leave theta or tau out"
        raise ParameterError(
            f"initial {which} do not agree: {where} tau must be sigma mu "
            f"= {sigma[i] * mu:.6g} Pa; {remedy}"
        )
    by_stress = bound & (("V" in given) | rigid)
    if "tau" in given and "theta" not in given and by_stress.any():
        with np.errstate(divide="ignore", invalid="ignore"):
            psi = np.where(by_stress, (x - v) / beta, psi)
        if not np.isfinite(psi).all():
            raise ParameterError("b = 0: initial V and tau do not fix theta; give theta and tau")
    elif "V" in given:
        x = np.where(bound, v + beta * psi, x)
    x = np.where(rigid, v + beta * psi, x)
    v = np.where(bound & ~rigid, x - beta * psi, v)
    return np.stack([x, v, psi], axis=1)
