"""The sentences of a verdict."""

import numpy as np

from .quantities import readable
from .regimes import HARMONIC, SLOW, STEADY, STICK_SLIP, UNKNOWN

#: regime, besides those of `ratestate.regimes`: V grows without bound (M = 0)
RUNAWAY = "runaway"
# eta below which inertia changes K_c by no more than its digits in the text.
UNFELT = 1e-4
YEAR = 365.25 * 86400.0  # s


def sentences(found, why):
    """A `Verdict` in words, the motion first.

    why : of one without an answer, what stopped the search
    """
    told = (motion(found, why), stability(found), inertia(found), fading(found), beside(found))
    return [sentence for sentence in told if sentence]


def motion(found, why):
    """What is seen."""
    if found.regime == STEADY:
        return f"Steady sliding at {readable('V_lp', found.V_lp)}."
    if found.regime == RUNAWAY:
        start = ", from steady sliding at a tenth of the speed on," if found.stable else ""
        return (
            f"Runaway: without mass (M = 0){start} the slip velocity grows without bound within a "
            f"finite time, and no cycle is reached; give M > 0."
        )
    if found.regime == UNKNOWN:
        return f"No cycle is known here: {why}"
    swing = f"tau/sigma swings by {found.amplitude:.4g}"
    if found.regime == HARMONIC:
        between = f"V between {_range('V', found.V_min, found.V_max)}"
        return (
            f"Quasi-harmonic vibration at {readable('frequency', found.frequency)}: {swing}, "
            f"{between}."
        )
    name = {SLOW: "Slow stick-slip", STICK_SLIP: "Stick-slip"}[found.regime]
    hardly = ", with hardly any inertia" if found.regime == SLOW else ""
    return (
        f"{name}, a cycle every {_time(found.period)}: {swing}, and the slider slips at up to "
        f"{readable('V', found.V_max, 3)}{hardly}."
    )


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
    held = f"K = {K} is {_compared(slider.K / found.K_c)} K_c = {K_c}: steady sliding is "
    held += "stable" if found.stable else "unstable"
    if found.V_c == 0.0:
        return f"{held}, as it is at any speed where K < K_c_qs."
    if np.isinf(found.V_c):
        return f"{held}, as it is at any speed without mass."
    side = "below" if found.stable else "above"
    return f"{held}, as it is at any speed {side} V_c = {readable('V_c', found.V_c)}."


def inertia(found):
    """What inertia does to stability, and to the frequency."""
    if found.K_c_qs <= 0.0 or np.isinf(found.slider.K) or found.slider.M == 0.0:
        return ""
    K_c_qs = f"K_c_qs = {readable('K_c_qs', found.K_c_qs)}"
    if found.eta < UNFELT:
        raised = f"eta = {found.eta:.3g}: inertia leaves K_c at {K_c_qs}"
    elif found.eta < 1.0:
        raised = f"eta = {found.eta:.3g}: inertia raises K_c by {100 * found.eta:.2g} % of {K_c_qs}"
    else:
        raised = f"eta = {found.eta:.3g}: inertia raises K_c to {1 + found.eta:.3g} times {K_c_qs}"
    if found.regime == HARMONIC:
        share = found.frequency / found.f_n
        raised += f"; the vibration has {share:.3g} times the natural frequency"
        raised += f" of {readable('f_n', found.f_n)}"
    return f"{raised}."


def fading(found):
    """How a small disturbance dies."""
    if found.regime == STEADY and found.growth_rate < 0.0:
        time = _time(-np.log(10.0) / found.growth_rate)
        rings = f", ringing at {readable('frequency', found.omega / (2 * np.pi), 3)}"
        return (
            f"A small disturbance falls to a tenth in {time}{rings if found.omega > 0.0 else ''}."
        )
    if found.fade is None:
        return ""
    largest = f"largest Floquet multiplier {_complex(found.multiplier)}"
    if found.fade <= 1.0:
        return f"A small disturbance is down to a tenth within a cycle ({largest})."
    time = _time(found.fade * found.period)
    return f"A small disturbance falls to a tenth in {found.fade:.3g} cycles, {time} ({largest})."


def beside(found):
    """What else is stable."""
    if found.stable and found.multiplier is not None:
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


def _complex(value):
    """A multiplier as text."""
    if abs(value.imag) > 1e-12 * abs(value):
        return f"{value.real:.3g} +- {abs(value.imag):.3g}i, of size {abs(value):.3g}"
    return f"{value.real:.4g}"


def _compared(ratio):
    """A ratio as text: near 1 the difference."""
    if abs(ratio - 1.0) >= 0.1:
        return f"{ratio:.4g} times"
    if abs(ratio - 1.0) < 1e-8:
        return "at"
    return f"{100 * abs(ratio - 1.0):.2g} % {'above' if ratio > 1.0 else 'below'}"


def _time(seconds):
    """A time as text; a long one also in years or days."""
    text = readable("t", seconds)
    for name, size in (("years", YEAR), ("days", 86400.0), ("hours", 3600.0)):
        if seconds >= 2.0 * size:
            return f"{text} ({seconds / size:.3g} {name})"
    return text


def _range(symbol, low, high):
    """Two values as text, in the unit that fits the larger where they are of similar size."""
    if low < 0.01 * high:
        return f"{readable(symbol, low, 3)} and {readable(symbol, high, 3)}"
    number, unit = readable(symbol, high, 3).split(" ")
    return f"{low * float(number) / high:.3g} and {number} {unit}"
