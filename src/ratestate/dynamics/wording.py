"""The sentences of a verdict."""

import numpy as np

from ..friction.quasi_static import runaway_step_lower_bound
from ..model.quantities import long_time, readable, readable_multiplier
from .cycles.regimes import HARMONIC, SLOW, STEADY, STICK_SLIP, UNKNOWN

#: regimes besides those of `ratestate.regimes`, both without mass: V grows without bound; it does
#: after a large disturbance only
RUNAWAY, CONDITIONAL = "runaway", "conditionally stable"
# eta below which inertia changes K_c by no more than its digits in the text, where besides it is
# this small a part of the distance of K from K_c_qs.
UNFELT, SMALL = 1e-4, 0.01
# Relative distance from K_c at which a slider is neither called stable nor unstable.
EDGE = 1e-8


def sentences(found, why):
    """A `Verdict` in words, the motion first.

    why : of one without an answer, what stopped the search; empty if it found nothing to settle on
    """
    said = (motion(found, why), doubling(found), outside_domain(found), *_steady(found))
    return _told(*said, fading(found), beside(found))


def of_steady_sliding(found):
    """Only what a `Verdict` says of steady sliding, whatever the motion."""
    return _told(*_steady(found))


def _steady(found):
    return stability(found), inertia(found)


def _told(*texts):
    return [text for text in texts if text]


def on_edge(K, K_c):
    """Whether K = K_c to so many digits that only a nonlinear theory decides."""
    return bool(K_c > 0.0 and abs(K / K_c - 1.0) < EDGE)


def motion(found, why):
    """What is seen."""
    V = readable("V_lp", found.V_lp)
    if found.regime == STEADY:
        return f"Steady sliding at {V}."
    if found.regime == CONDITIONAL:
        return _conditional(found)
    if found.regime == RUNAWAY:
        start = ", from steady sliding at a tenth of the speed on," if found.on_edge else ""
        return (
            f"Runaway: without mass (M = 0){start} the slip velocity grows without bound within a "
            f"finite time, and no cycle is reached; give M > 0."
        )
    if found.regime == UNKNOWN:
        return _unsettled(found, why)
    swing = f"tau/sigma swings by {found.amplitude:.4g}"
    if found.regime == HARMONIC:
        between = f"V between {_range('V', found.V_min, found.V_max)}"
        return (
            f"Quasi-harmonic vibration at {readable('frequency', _vibration(found))}: {swing}, "
            f"{between}."
        )
    name = {SLOW: "Slow stick-slip", STICK_SLIP: "Stick-slip"}[found.regime]
    hardly = ", with hardly any inertia" if found.regime == SLOW else ""
    return (
        f"{name}, a cycle every {_time(found.period)}: {swing}, and the slider slips at up to "
        f"{readable('V', found.V_max, 3)}{hardly}."
    )


def doubling(found):
    """After how many maxima of the stress the cycle repeats, where it is not one."""
    if found.returns is None or found.returns < 2:
        return ""
    return (
        f"It repeats after {found.returns} unequal maxima of the stress (period doubling), every "
        f"{_time(found.period)}."
    )


def _vibration(found):
    """How often the stress has a maximum [Hz]."""
    return found.returns * found.frequency


def outside_domain(found):
    """Where the motion leaves the domain of the friction law."""
    if found.mu_min is None or min(found.mu_min, found.reversal_margin) >= 0.0:
        return ""
    reasons = []
    if found.mu_min < 0.0:
        reasons.append(f"mu falls to {found.mu_min:.3g}, so that friction would have to push")
    if found.reversal_margin < 0.0:
        reasons.append(
            f"tau/sigma + mu falls to {found.reversal_margin:.3g}, so that the spring pulls back "
            f"harder than friction can hold"
        )
    return (
        f"This is outside the domain of the friction law, which knows forward slip only: "
        f"{', and '.join(reasons)}."
    )


def _conditional(found):
    """A stable slider without mass that a large disturbance makes run away."""
    p = found.slider.values
    safe = runaway_step_lower_bound(**{name: p[name] for name in ("a", "b", "Dc", "sigma", "K")})
    return (
        f"Steady sliding at {readable('V_lp', found.V_lp)} is stable against small disturbances; "
        f"without mass (M = 0) a large one, such as the start from a tenth of the speed, runs "
        f"away: V grows without bound within a finite time. A step up by a factor of less than "
        f"{np.floor(100 * safe) / 100:.4g} does not; give M > 0 to see what follows."
    )


def _unsettled(found, why):
    """A slider of which it is not known where the start from a tenth of the speed leads."""
    ended = f": {why.removesuffix('.')}" if why else ""
    if found.stable and not found.on_edge:
        return (
            f"Steady sliding at {readable('V_lp', found.V_lp)} is stable; whether a large "
            f"disturbance (the start from a tenth of the speed) returns to it was not "
            f"settled{ended}."
        )
    if found.slider.M == 0.0 and not why:
        grows = "hardly grows or fades" if found.on_edge else "grows from turn to turn"
        return (
            f"No cycle is singled out: without mass (M = 0) a swing about steady sliding {grows}; "
            f"give M > 0."
        )
    none = ": the motion settles into none of 1, 2, 4, ... 32 returns that is known to 1 %"
    return f"No cycle is known here{ended or none}."


def stability(found):
    """Whether steady sliding holds, and up to which speed."""
    slider = found.slider
    if np.isinf(slider.K):
        return "The spring is rigid (K = inf): the slider moves with its load point, at any speed."
    if found.K_c_qs <= 0.0:
        return (
            "Friction does not weaken with velocity (b <= a): steady sliding is stable at any "
            "stiffness and any speed."
        )
    K, K_c = readable("K", slider.K), readable("K_c", found.K_c)
    if found.on_edge:
        return (
            f"K = {K} is K_c to 8 digits, the edge of stability: small disturbances of steady "
            f"sliding hardly grow or fade."
        )
    held = f"K = {K} is {_compared(slider.K / found.K_c)} K_c = {K_c}: steady sliding is "
    held += "stable" if found.stable else "unstable"
    if found.V_c == 0.0:
        side = "<" if found.K_c_qs > slider.K else "<="
        return f"{held}, as it is at any speed where K {side} K_c_qs."
    if np.isinf(found.V_c):
        return f"{held}, as it is at any speed without mass."
    side = "below" if found.stable else "above"
    return f"{held}, as it is at any speed {side} V_c = {readable('V_c', found.V_c)}."


def inertia(found):
    """What inertia does to stability, and to the frequency."""
    if found.K_c_qs <= 0.0 or np.isinf(found.slider.K) or found.slider.M == 0.0:
        return ""
    K_c_qs = f"K_c_qs = {readable('K_c_qs', found.K_c_qs)}"
    away = abs(found.slider.K / found.K_c_qs - 1.0)
    if found.eta < min(UNFELT, SMALL * away):
        raised = f"eta = {found.eta:.3g}: inertia leaves K_c at {K_c_qs}"
    elif found.eta < 1.0:
        raised = f"eta = {found.eta:.3g}: inertia raises K_c by {100 * found.eta:.2g} % of {K_c_qs}"
    else:
        raised = f"eta = {found.eta:.3g}: inertia raises K_c to {1 + found.eta:.3g} times {K_c_qs}"
    if found.regime == HARMONIC:
        share = _vibration(found) / found.f_n
        raised += f"; the vibration has {share:.3g} times the natural frequency"
        raised += f" of {readable('f_n', found.f_n)}"
    return f"{raised}."


def fading(found):
    """How a small disturbance dies."""
    if found.on_edge and found.regime == STEADY:
        return ""
    if found.regime == STEADY and found.growth_rate < 0.0:
        time = _time(-np.log(10.0) / found.growth_rate)
        rings = f", ringing at {readable('frequency', found.omega / (2 * np.pi), 3)}"
        return (
            f"A small disturbance falls to a tenth in {time}{rings if found.omega > 0.0 else ''}."
        )
    if found.fade is None:
        return ""
    largest = f"largest Floquet multiplier {_multiplier(found.multiplier)}"
    if found.fade <= 1.0:
        return f"A small disturbance is down to a tenth within a cycle ({largest})."
    time = _time(found.fade * found.period)
    return f"A small disturbance falls to a tenth in {found.fade:.3g} cycles, {time} ({largest})."


def beside(found):
    """What else is stable."""
    if found.stable and found.multiplier is not None and not found.on_edge:
        return (
            "Steady sliding is stable as well; this cycle is reached from a tenth of the speed, "
            "and the start decides."
        )
    if found.K_fold is not None and found.K_fold > found.slider.K:
        return (
            f"Up to K = {readable('K', found.K_fold, 5)} a limit cycle is stable as well: a large "
            f"enough push starts it."
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
    """Two values as text, in the unit that fits the larger where they are of similar size."""
    if low < 0.01 * high:
        return f"{readable(symbol, low, 3)} and {readable(symbol, high, 3)}"
    number, unit = readable(symbol, high, 3).split(" ")
    return f"{low * float(number) / high:.3g} and {number} {unit}"
