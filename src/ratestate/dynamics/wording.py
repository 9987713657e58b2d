"""The sentences of a verdict."""

import numpy as np

from ..friction.quasi_static import runaway_step_lower_bound
from ..model.quantities import long_time, readable, readable_multiplier
from .cycles.regimes import HARMONIC, SLOW, STEADY, STICK_SLIP, UNKNOWN

#: regimes besides those of `ratestate.regimes`, both without mass: V grows without bound; it grows
#: so after a large disturbance only
RUNAWAY, CONDITIONAL = "runaway", "conditionally stable"
# Inertia is negligible where eta is below the digits of K_c in the text, and below this part of the
# distance of K from K_c_qs.
NEGLIGIBLE_ETA, NEGLIGIBLE_PART = 1e-4, 0.01
# Relative distance from K_c below which a slider is called neither stable nor unstable.
EDGE = 1e-8


def sentences(verdict, reason):
    """The sentences of a `Verdict`, the motion first.

    reason : why the search for a cycle failed; empty if it did not, or did not converge
    """
    about_motion = motion(verdict, reason), doubling(verdict), outside_domain(verdict)
    about_steady = stability(verdict), inertia(verdict)
    return _not_empty(*about_motion, *about_steady, decay(verdict), coexistence(verdict))


def of_steady_sliding(verdict):
    """The sentences of a `Verdict` on steady sliding alone."""
    return _not_empty(stability(verdict), inertia(verdict))


def _not_empty(*texts):
    return [text for text in texts if text]


def on_edge(K, K_c):
    """Whether K = K_c to so many digits that only a nonlinear theory decides."""
    return bool(K_c > 0.0 and abs(K / K_c - 1.0) < EDGE)


def motion(verdict, reason):
    """The motion itself."""
    V = readable("V_lp", verdict.V_lp)
    if verdict.regime == STEADY:
        return f"Steady sliding at {V}."
    if verdict.regime == CONDITIONAL:
        return _conditional(verdict)
    if verdict.regime == RUNAWAY:
        start = ", from steady sliding at a tenth of the speed on," if verdict.on_edge else ""
        return (
            f"Runaway: without mass (M = 0){start} the slip velocity grows without bound within a "
            f"finite time, and no cycle is reached; give M > 0."
        )
    if verdict.regime == UNKNOWN:
        return _unknown(verdict, reason)
    swing = f"peak-to-peak tau/sigma {verdict.amplitude:.4g}"
    if verdict.regime == HARMONIC:
        between = f"V between {_range('V', verdict.V_min, verdict.V_max)}"
        return (
            f"Quasi-harmonic vibration at {readable('frequency', _vibration(verdict))}: {swing}, "
            f"{between}."
        )
    name = {SLOW: "Slow stick-slip", STICK_SLIP: "Stick-slip"}[verdict.regime]
    hardly = ", with hardly any inertia" if verdict.regime == SLOW else ""
    return (
        f"{name}, a cycle every {_time(verdict.period)}: {swing}, and the slider slips at up to "
        f"{readable('V', verdict.V_max, 3)}{hardly}."
    )


def doubling(verdict):
    """After how many maxima of the stress the cycle repeats, where more than one."""
    if verdict.returns is None or verdict.returns < 2:
        return ""
    return (
        f"It repeats after {verdict.returns} unequal maxima of the stress (period doubling), every "
        f"{_time(verdict.period)}."
    )


def _vibration(verdict):
    """How often the stress has a maximum [Hz]."""
    return verdict.returns * verdict.frequency


def outside_domain(verdict):
    """Where the motion leaves the domain of the friction law."""
    if verdict.mu_min is None or min(verdict.mu_min, verdict.reversal_margin) >= 0.0:
        return ""
    reasons = []
    if verdict.mu_min < 0.0:
        reasons.append(f"mu falls to {verdict.mu_min:.3g}, so that friction would have to push")
    if verdict.reversal_margin < 0.0:
        reasons.append(
            f"tau/sigma + mu falls to {verdict.reversal_margin:.3g}, so that the spring pulls back "
            f"harder than friction can hold"
        )
    return (
        f"This is outside the domain of the friction law, which knows forward slip only: "
        f"{', and '.join(reasons)}."
    )


def _conditional(verdict):
    """A stable slider without mass that a large disturbance makes run away."""
    p = verdict.slider.values
    safe = runaway_step_lower_bound(**{name: p[name] for name in ("a", "b", "Dc", "sigma", "K")})
    return (
        f"Steady sliding at {readable('V_lp', verdict.V_lp)} is stable against small disturbances; "
        f"without mass (M = 0) a large one, such as the start from a tenth of the speed, runs "
        f"away: V grows without bound within a finite time. A step up by a factor of less than "
        f"{np.floor(100 * safe) / 100:.4g} does not; give M > 0 to see what follows."
    )


def _unknown(verdict, reason):
    """A slider for which the search from a tenth of the speed found no attractor."""
    ended = f": {reason.removesuffix('.')}" if reason else ""
    if verdict.stable and not verdict.on_edge:
        return (
            f"Steady sliding at {readable('V_lp', verdict.V_lp)} is stable; whether a large "
            f"disturbance (the start from a tenth of the speed) returns to it is not "
            f"known{ended}."
        )
    if verdict.slider.M == 0.0 and not reason:
        grows = "hardly grows or fades" if verdict.on_edge else "grows from cycle to cycle"
        return (
            f"No cycle is singled out: without mass (M = 0) an oscillation about steady sliding "
            f"{grows}; give M > 0."
        )
    none = ": no limit cycle of 1, 2, 4, ... 32 returns was found to 1 %"
    return f"The attractor is not known{ended or none}."


def stability(verdict):
    """Whether steady sliding is stable, and at which speeds."""
    slider = verdict.slider
    if np.isinf(slider.K):
        return "The spring is rigid (K = inf): the slider moves with its load point, at any speed."
    if verdict.K_c_qs <= 0.0:
        return (
            "Friction does not weaken with velocity (b <= a): steady sliding is stable at any "
            "stiffness and any speed."
        )
    K, K_c = readable("K", slider.K), readable("K_c", verdict.K_c)
    if verdict.on_edge:
        return (
            f"K = {K} is K_c to 8 digits, the edge of stability: small disturbances of steady "
            f"sliding hardly grow or fade."
        )
    comparison = f"K = {K} is {_compared(slider.K / verdict.K_c)} K_c = {K_c}: steady sliding is "
    comparison += "stable" if verdict.stable else "unstable"
    if verdict.V_c == 0.0:
        side = "<" if verdict.K_c_qs > slider.K else "<="
        return f"{comparison}, as it is at any speed where K {side} K_c_qs."
    if np.isinf(verdict.V_c):
        return f"{comparison}, as it is at any speed without mass."
    side = "below" if verdict.stable else "above"
    return f"{comparison}, as it is at any speed {side} V_c = {readable('V_c', verdict.V_c)}."


def inertia(verdict):
    """The effect of inertia on stability, and on the frequency."""
    if verdict.K_c_qs <= 0.0 or np.isinf(verdict.slider.K) or verdict.slider.M == 0.0:
        return ""
    K_c_qs = f"K_c_qs = {readable('K_c_qs', verdict.K_c_qs)}"
    away = abs(verdict.slider.K / verdict.K_c_qs - 1.0)
    eta = verdict.eta
    if eta < min(NEGLIGIBLE_ETA, NEGLIGIBLE_PART * away):
        effect = f"eta = {eta:.3g}: inertia leaves K_c at {K_c_qs}"
    elif eta < 1.0:
        effect = f"eta = {eta:.3g}: inertia raises K_c by {100 * eta:.2g} % of {K_c_qs}"
    else:
        effect = f"eta = {eta:.3g}: inertia raises K_c to {1 + eta:.3g} times {K_c_qs}"
    if verdict.regime == HARMONIC:
        share = _vibration(verdict) / verdict.f_n
        effect += f"; the vibration has {share:.3g} times the natural frequency"
        effect += f" of {readable('f_n', verdict.f_n)}"
    return f"{effect}."


def decay(verdict):
    """How fast a small disturbance decays."""
    if verdict.on_edge and verdict.regime == STEADY:
        return ""
    if verdict.regime == STEADY and verdict.growth_rate < 0.0:
        time = _time(-np.log(10.0) / verdict.growth_rate)
        rings = f", ringing at {readable('frequency', verdict.omega / (2 * np.pi), 3)}"
        return (
            f"A small disturbance falls to a tenth in {time}{rings if verdict.omega > 0.0 else ''}."
        )
    if verdict.fade is None:
        return ""
    largest = f"largest Floquet multiplier {_multiplier(verdict.multiplier)}"
    if verdict.fade <= 1.0:
        return f"A small disturbance is down to a tenth within a cycle ({largest})."
    time = _time(verdict.fade * verdict.period)
    return f"A small disturbance falls to a tenth in {verdict.fade:.3g} cycles, {time} ({largest})."


def coexistence(verdict):
    """Another motion that is stable as well."""
    if verdict.stable and verdict.multiplier is not None and not verdict.on_edge:
        return (
            "Steady sliding is stable as well; this cycle is reached from a tenth of the speed, "
            "and the start decides."
        )
    if verdict.K_fold is not None and verdict.K_fold > verdict.slider.K:
        return (
            f"Up to K = {readable('K', verdict.K_fold, 5)} a limit cycle is stable as well: a "
            f"large enough push starts it."
        )
    return ""


def _multiplier(value):
    """A multiplier as text, with the size of a complex one."""
    text = readable_multiplier(value)
    return f"{text}, of size {abs(value):.3g}" if text.endswith("i") else text


def _compared(ratio):
    """A ratio as text: near 1 the difference."""
    if abs(ratio - 1.0) >= 0.1:
        return f"{ratio:.4g} times"
    return f"{100 * abs(ratio - 1.0):.2g} % {'above' if ratio > 1.0 else 'below'}"


def _time(seconds):
    """A time as text; a long one also in years, days or hours."""
    text = readable("t", seconds)
    if long := long_time(seconds):
        return f"{text} ({seconds / long[1]:.3g} {long[0]})"
    return text


def _range(symbol, low, high):
    """Two values as text, in the larger one's unit where they are of similar size."""
    if low < 0.01 * high:
        return f"{readable(symbol, low, 3)} and {readable(symbol, high, 3)}"
    number, unit = readable(symbol, high, 3).split(" ")
    return f"{low * float(number) / high:.3g} and {number} {unit}"
