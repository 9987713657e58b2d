"""The state at t = 0: steady sliding, unless `initial` gives other values."""

import numpy as np

from ..friction.expressions import LIMIT
from ..friction.roots import root
from .names import refusal
from .slider_parameters import PARAMETERS
from .units import to_si

# largest difference x - S that is due to rounding
TOLERANCE = 1e-9
# largest initial speed [m/s]: the engine's exponentials saturate not far above it
MAX_V = 1e250


def initial_values(initial, law):
    """Return the values for t = 0 in SI, as {"V_initial": 0.001, ...}; {} for None.

    Raises ParameterError for a wrong key, type, unit or range.  `initial_state` checks agreement.
    """
    if initial is None:
        return {}
    symbols = ("V", *law.states, "tau")
    if not isinstance(initial, dict) or not set(initial) <= set(symbols):
        raise refusal("initial.no_dict", initial=initial, names=", ".join(symbols[:-1]))
    bound = {"V": ""} if law.reverses else {}  # V may then be 0 or negative
    return {
        f"{name}_initial": to_si(name, value, label=f"initial {name}", bound=bound.get(name))
        for name, value in initial.items()
    }


def initial_state(law, batch, V_load):
    """Return x = (tau/sigma - mu_ref)/a, v and the law's variables at t = 0, (n, m).

    `initial` replaces values of steady sliding at V_start, with two exceptions.
    If M = 0, the balance x = S fixes one of V, the states and tau by the others.  If K = inf, V
    equals V_load, and x = S fixes tau, or a state if tau is given.  If two states are not given,
    tau fixes the first of them.

    Raises ParameterError in these cases:
    - All of V, the states and tau are given with M = 0, or all states and tau with K = inf, and
      x - S differs from 0 by more than 1e-9.
    - V differs from V_load, and K = inf.
    - tau would have to fix a state on which friction does not depend.
    - x = S would fix a speed above 1e250 m/s.
    - V or V_start is not between 1e-260 and 1e260 times V0.

    batch : the slider's parameters, V_start, and the result of `initial_values`
    V_load : (n,) speed of the load point at t = 0 [m/s], the slider's speed if K = inf
    """
    a, _, _, sigma, K, M, _, V0 = map(batch.flat, PARAMETERS)
    mu_ref, p = batch.at_reference(law)
    names = [s for s in ("V", *law.states, "tau") if f"{s}_initial" in batch.values]
    given = {s: batch.flat(f"{s}_initial") for s in names}
    for label, V in ("V_start", batch.flat("V_start")), ("initial V", given.get("V", V0)):
        check_speed_ratio(law, label, V, "V0", V0)
    v, states = steady_state(law, batch, batch.flat("V_start"), p)
    x = stress(law, v, states, p)
    states = tuple(
        np.log(V0 * given[name] / batch.flat(distance)) if name in given else state
        for name, distance, state in zip(law.states, law.lengths, states, strict=True)
    )
    if "tau" in given:
        x = (given["tau"] / sigma - mu_ref) / a
    rigid = np.isinf(K)
    w_given = given.get("V", batch.flat("V_start")) / V0
    w = np.where(rigid, np.maximum(V_load, 5e-324) / V0, w_given)
    v = law.v_at(w, states, p)
    in_balance = (M == 0) | rigid  # then x = S fixes one value by the others
    missing = [k for k, name in enumerate(law.states) if name not in given]
    if "V" in given and (np.abs(v - law.v_at(w_given, states, p)) > TOLERANCE).any():
        others = f", and {' or '.join(law.states)} or tau" if "tau" in given and not missing else ""
        raise refusal("initial.rigid_speed", others=others)
    if "tau" in given and not missing:
        # (at rest friction fixes nothing)
        fixed = in_balance if "V" in given else rigid & (V_load > 0.0)
        differs = fixed & (np.abs(x - stress(law, v, states, p)) > TOLERANCE)
        if differs.any():
            _raise_disagreement(law, batch, int(np.argmax(differs)), v, states, p, given)
    from_stress = in_balance & (("V" in given) | rigid)
    if "tau" in given and missing and from_stress.any():
        states = _state_from_stress(law, x, w, states, p, missing[0], from_stress)
        v = law.v_at(w, states, p)
    elif "V" in given:
        x = np.where(in_balance, stress(law, v, states, p), x)
    if rigid.any():
        x = np.where(rigid, stress(law, v, states, p), x)
    if (free_speed := in_balance & ~rigid).any():
        v = np.where(free_speed, root(lambda v: stress(law, v, states, p) - x, v, free_speed), v)
    _check_start_speed((law.log_jump_rate(v, states, p) + np.log(V0))[free_speed], names)
    return np.stack([x, v, *law.variables(v, states, p)], axis=1)


def steady_sliding_state(law, batch, V):
    """Return x, v and the law's variables in steady sliding at V (n,): array (n, m)."""
    _, p = batch.at_reference(law)
    v, states = steady_state(law, batch, V, p)
    return np.stack([stress(law, v, states, p), v, *law.variables(v, states, p)], axis=1)


def steady_state(law, batch, V, p):
    """Return v and a tuple of ln(V0 theta/D) of each state in steady sliding at V.

    p : the law's coefficients at V0
    """
    V0 = batch.flat("V0")
    at_V = law.coefficient_arrays(V, batch.columns)
    steady = law.log_states(0.0, law.steady(at_V).psi, at_V)
    states = tuple(state - np.log(V / V0) for state in steady)
    return law.v_at(V / V0, states, p), states


def stress(law, v, log_states, p):
    """Return the resistance S to sliding, in the units of x, from ln(V0 theta/D)."""
    psi = law.variables(v, log_states, p)
    return law.at(v, psi, p).S


def _state_from_stress(law, x, w, states, p, k, where):
    """Return the states, with state k such that S at w equals x if `where` is true."""

    def with_state(state):
        return (*states[:k], state, *states[k + 1 :])

    def stress_error(state):
        changed = with_state(state)
        return stress(law, law.v_at(w, changed, p), changed, p) - x

    solution = root(stress_error, states[k], where)
    if not np.isfinite(solution[where]).all():
        raise refusal("initial.not_fixed", name=list(law.states)[k])
    return with_state(np.where(where, solution, states[k]))


def check_speed_ratio(law, label, V, reference, V_ref):
    """Raise ParameterError if V/V_ref is beyond the range of the engine.

    label, reference : the symbols of V and V_ref
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        beyond = np.abs(np.log(np.abs(V) / V_ref)) > LIMIT
    if not law.reverses and beyond.any():
        first = {"V": V[beyond][0], "V_ref": V_ref[beyond][0]}
        raise refusal("initial.range", symbol=label, reference=reference, **first)


def _check_start_speed(log_V, names):
    given = " and ".join(names) or "state"
    if np.isnan(log_V).any():
        raise refusal("initial.no_speed", names=given)
    if (log_V > np.log(MAX_V)).any():
        raise refusal("initial.fast", names=given, exponent=log_V.max() / np.log(10.0))


def _raise_disagreement(law, batch, i, v, states, p, given):
    a, sigma, K = (batch.flat(symbol)[i] for symbol in ("a", "sigma", "K"))
    tau = sigma * (batch.at_reference(law)[0][i] + a * stress(law, v, states, p)[i])
    names = " and ".join(law.states)
    balance = "sigma mu + damping V" if "damping" in law.parameters else "sigma mu"
    values = {"tau": tau, "balance": balance}
    where, remedy = "without inertia (M = 0)", "Leave one of them out, or give M > 0."
    if np.isinf(K):
        where, remedy = "if K = inf,", f"Leave {names.replace('and', 'or')} or tau out."
    quantities = f"V, {names} and tau" if "V" in given else f"{names} and tau"
    raise refusal("initial.disagree", which=quantities, where=where, remedy=remedy, **values)
