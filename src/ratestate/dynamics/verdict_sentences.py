"""Choose the sentences of a verdict from verdict_sentences.toml, and fill in the numbers."""

from pathlib import Path

import numpy as np

from ..friction.closed_forms import EDGE_WIDTH
from ..friction.quasi_static import runaway_step_lower_bound
from ..model.names import Sentences
from ..model.parameters import of_contact
from ..model.quantities import readable, readable_multiplier, readable_time
from .cycles.regimes import HARMONIC, STEADY, UNKNOWN
from .results import outside_domain

#: regimes besides those of `classify`, both without mass: V grows without bound; it grows
#: so after a large disturbance only
RUNAWAY, CONDITIONAL = "runaway", "conditionally stable"
# Inertia is negligible where eta is below the digits of K_c in the text, and below this part of the
# distance of K from K_c_qs.
NEGLIGIBLE_ETA, NEGLIGIBLE_PART = 1e-4, 0.01

_sentence = Sentences(Path(__file__).with_suffix(".toml"))


def sentence(name, v, **values):
    """Return a sentence with values of a `Verdict`, its stiffnesses by name, and others."""
    stiffnesses = {"K": v.slider.K, "K_c": v.K_c, "K_c_qs": v.K_c_qs}
    if v.K_fold is not None:
        stiffnesses["K_fold"] = v.K_fold
    shown = {symbol: of_contact("K", K, v.slider.area) for symbol, K in stiffnesses.items()}
    return _sentence(name, v=v, **shown, **values)


def sentences(v, reason):
    """Return the sentences of a `Verdict`, the motion first.

    reason : why the search for a cycle failed; "" if it succeeded, or did not converge
    """
    about_motion = _motion(v, reason), _doubling(v), _outside_domain(v)
    texts = *about_motion, *of_steady_sliding(v), _decay(v), _coexistence(v)
    return tuple(filter(None, texts))


def of_steady_sliding(v):
    """Return the one or two sentences of a `Verdict` on steady sliding."""
    return tuple(filter(None, (_stability(v), _inertia(v))))


def on_edge(K, K_c):
    """Return whether K = K_c > 0 to 8 digits: then only a nonlinear theory decides."""
    return bool(K_c > 0.0 and abs(K / K_c - 1.0) < EDGE_WIDTH)


def _motion(v, reason):
    """Describe the motion itself."""
    if v.regime == UNKNOWN:
        return _unknown(v, reason)
    name, values = v.regime, {}
    if v.regime == CONDITIONAL:
        values["safe_step"] = _safe_step(v)
    elif v.regime == RUNAWAY and v.on_edge:
        name = "runaway_on_edge"
    elif v.regime == HARMONIC:
        speeds = _range("V", v.V_min, v.V_max)
        values |= {"frequency": v.returns * v.frequency, "speeds": speeds}
    elif v.period is not None:
        values["period"] = readable_time(v.period, both=True)
    force = v.force_amplitude
    values["force"] = "" if force is None else sentence("motion.force", v, force=force)
    return sentence(f"motion.{name}", v, **values)


def _safe_step(v):
    """Describe steps that do not run away, under the slip law of eqs 1 and 3 only."""
    if v.slider.friction_law.name != "slip":
        return ""
    parameters = {name: v.slider.values[name] for name in ("a", "b", "Dc", "sigma", "K")}
    largest = np.floor(100 * runaway_step_lower_bound(**parameters)) / 100
    return sentence("motion.safe_step", v, largest=largest)


def _unknown(v, reason):
    """Say why the search from a tenth of the speed found no attractor."""
    ended = f": {reason.removesuffix('.')}" if reason else ""
    if v.stable and not v.on_edge:
        name = "stable"
    elif v.slider.M == 0.0 and not reason:
        name = "massless_on_edge" if v.on_edge else "massless"
    else:
        name = "failed" if reason else "no_cycle"
    return sentence(f"unknown.{name}", v, reason=ended)


def _doubling(v):
    """Say after how many maxima of the stress the cycle repeats, if more than one."""
    if v.returns is None or v.returns < 2:
        return ""
    return sentence("motion.doubled", v, period=readable_time(v.period, both=True))


def _outside_domain(v):
    """Say if and why the motion leaves the domain of the friction law."""
    if v.mu_min is None or outside_domain(v.slider.friction_law, v.mu_min, v.reversal_margin) <= 0:
        return ""
    negative = [name for name in ("mu_min", "reversal_margin") if getattr(v, name) < 0.0]
    reasons = ", and ".join(sentence(f"outside_domain.{name}", v) for name in negative)
    return reasons and sentence("outside_domain.whole", v, reasons=reasons)


def _stability(v):
    """Say whether steady sliding is stable, and at which speeds."""
    K = v.slider.K
    if np.isinf(K):
        return sentence("stability.rigid", v)
    if v.K_c <= 0.0:
        name = "strengthening" if v.slider.friction_law.one_length else "at_any_stiffness"
        return sentence(f"stability.{name}", v)
    if v.on_edge:
        return sentence("stability.on_edge", v)
    if v.V_c == 0.0 or np.isinf(v.V_c):
        name = "never" if v.V_c == 0.0 else "always"
    else:
        name = "below" if v.stable else "above"
    speeds = sentence(f"stability.{name}", v, side="<" if v.K_c_qs > K else "<=")
    stable = "stable" if v.stable else "unstable"
    values = {"compared": _compared(K / v.K_c), "stable": stable, "speeds": speeds}
    if v.V_c_upper < np.inf:
        beyond = v.V_lp > v.V_c_upper and not v.stable
        values["again"] = ", and again at this speed" if beyond else ""
        values["speeds"] = sentence(f"stability.{'between' if v.V_c else 'below_upper'}", v)
    return sentence("stability.whole" if v.V_c_upper == np.inf else "stability.only", v, **values)


def _inertia(v):
    """Describe the effect of inertia on stability, and on the frequency."""
    if v.K_c_qs <= 0.0 or np.isinf(v.slider.K) or v.slider.M == 0.0:
        return ""
    vibration = ""
    if v.regime == HARMONIC:
        share = v.returns * v.frequency / v.f_n
        name = "natural" if f"{share:.3g}" == "1" else "vibration"
        vibration = sentence(f"inertia.{name}", v, share=share)
    distance = abs(v.slider.K / v.K_c_qs - 1.0)
    rise = v.eta if v.slider.friction_law.one_length else v.K_c / v.K_c_qs - 1.0
    if rise < min(NEGLIGIBLE_ETA, NEGLIGIBLE_PART * distance):
        name = "negligible"
    else:
        name = "small" if rise < 1.0 else "large"
    values = {"percent": 100 * rise, "factor": 1 + rise, "vibration": vibration}
    return sentence(f"inertia.{name}", v, **values)


def _decay(v):
    """Say how fast a small disturbance decays."""
    if v.regime == STEADY and v.on_edge:
        return ""
    if v.regime == STEADY and v.growth_rate < 0.0:
        name = "ringing" if v.omega > 0.0 else "monotonic"
        time = readable_time(-np.log(10.0) / v.growth_rate, both=True)
        return sentence(f"decay.{name}", v, time=time, frequency=v.omega / (2 * np.pi))
    if v.fade is None:
        return ""
    name = "within_a_cycle" if v.fade <= 1.0 else "in_cycles"
    time, multiplier = (
        readable_time(v.fade * v.period, both=True),
        readable_multiplier(v.multiplier),
    )
    if multiplier.endswith("i"):  # it is complex
        multiplier += f", of size {abs(v.multiplier):.3g}"
    return sentence(f"decay.{name}", v, time=time, multiplier=multiplier)


def _coexistence(v):
    """Name another motion that is stable as well."""
    if v.stable and v.multiplier is not None and not v.on_edge:
        return sentence("coexistence.steady_sliding", v)
    if v.K_fold is not None and v.K_fold > v.slider.K:
        return sentence("coexistence.cycle", v)
    return ""


def _compared(ratio):
    """Return a ratio as text; near 1 the difference."""
    if abs(ratio - 1.0) >= 0.1:
        return f"{ratio:.4g} times"
    return f"{100 * abs(ratio - 1.0):.2g} % {'above' if ratio > 1.0 else 'below'}"


def _range(symbol, low, high):
    """Return two values as text, with the unit once if they are of similar size."""
    if low < 0.01 * high:
        return f"{readable(symbol, low, 3)} and {readable(symbol, high, 3)}"
    number, unit = readable(symbol, high, 3).split(" ")
    return f"{low * float(number) / high:.3g} and {number} {unit}"
