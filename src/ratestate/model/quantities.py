"""The table of quantities: symbol, SI unit, name, allowed range.

Symbols are the paper's.  A new quantity is one row; everything that reads values, labels
variables or writes messages looks here.
"""

import math
from typing import NamedTuple

#: unit -> what such a value is called in a message, and an example of one
KINDS = {
    "1": ("a pure number", "0.003"),
    "m": ("a length", "'10 um'"),
    "s": ("a time", "'10 s'"),
    "m/s": ("a speed", "'3.2 mm/s'"),
    "m/s^2": ("an acceleration", "'1 mm/s^2'"),
    "Pa": ("a stress", "'2 MPa'"),
    "Pa/m": ("a stiffness", "'900 MPa/m'"),
    "kg/m^2": ("a mass per area", "'3000 kg/m^2'"),
    "J/m^2": ("an energy per area", "'1 J/m^2'"),
    "Hz": ("a frequency", "'390 Hz'"),
    "1/s": ("a rate", "'1 1/s'"),
    "1/m": ("a rate per length", "'1 1/m'"),
    "rad/s": ("an angular frequency", "'1 rad/s'"),
}


#: power of ten -> prefix
PREFIXES = {9: "G", 6: "M", 3: "k", 0: "", -3: "m", -6: "u", -9: "n"}
#: unit -> the powers of ten with which values are shown, where there are any
POWERS = {
    "m": (0, -3, -6, -9),
    "s": (0, -3, -6),
    "m/s": (0, -3, -6, -9),
    "Pa": (9, 6, 3, 0),
    "Pa/m": (9, 6, 3, 0),
    "Hz": (3, 0, -3, -6),
}
#: name of a long time -> seconds
LONG_TIMES = {"years": 365.25 * 86400.0, "days": 86400.0, "hours": 3600.0}


class Quantity(NamedTuple):
    """A row of `QUANTITIES`: unit, name for plots, allowed range as `to_si` checks it."""

    unit: str
    long_name: str
    bound: str = ""  # "", "> 0" or ">= 0"
    example: str = ""  # where the one in KINDS would mislead
    may_be_inf: bool = False


#: symbol -> `Quantity`.  b may be negative: published fits of some clays and gouges are.
QUANTITIES = {
    "a": Quantity("1", "direct effect", "> 0"),
    "b": Quantity("1", "evolution effect", "", "0.006"),
    "Dc": Quantity("m", "critical slip distance", "> 0"),
    "sigma": Quantity("Pa", "normal stress", "> 0"),
    "K": Quantity("Pa/m", "stiffness per area", "> 0", may_be_inf=True),
    "M": Quantity("kg/m^2", "mass per area", ">= 0"),
    "mu0": Quantity("1", "friction coefficient at V0", ">= 0", "0.6"),
    "V0": Quantity("m/s", "reference velocity", "> 0", "'1 um/s'"),
    "V": Quantity("m/s", "slip velocity", "> 0"),
    "V_lp": Quantity("m/s", "load-point velocity", "> 0"),
    "V_load": Quantity("m/s", "load-point velocity", ">= 0"),
    "V_start": Quantity("m/s", "slip velocity of the steady start", "> 0"),
    "V_c": Quantity("m/s", "critical velocity"),
    "V_max": Quantity("m/s", "largest slip velocity"),
    "V_min": Quantity("m/s", "smallest slip velocity"),
    "theta": Quantity("s", "state", "> 0"),
    "delta": Quantity("m", "slip"),
    "delta_lp": Quantity("m", "load-point displacement"),
    "slip": Quantity("m", "slip"),
    "tau": Quantity("Pa", "shear stress of the spring"),
    "mu": Quantity("1", "friction coefficient"),
    "eta": Quantity("1", "dynamic instability coefficient"),
    "K_c": Quantity("Pa/m", "critical stiffness"),
    "K_c_qs": Quantity("Pa/m", "quasi-static critical stiffness"),
    "f_n": Quantity("Hz", "natural frequency"),
    "eigenvalues": Quantity("1/s", "eigenvalues at steady sliding"),
    "growth_rate": Quantity("1/s", "growth rate of the least stable mode"),
    "omega": Quantity("rad/s", "angular frequency of the least stable mode"),
    "omega_c": Quantity("rad/s", "angular frequency at the Hopf bifurcation"),
    "stable": Quantity("1", "small perturbations decay"),
    "period": Quantity("s", "period of the limit cycle"),
    "frequency": Quantity("Hz", "frequency of the limit cycle"),
    "amplitude": Quantity("1", "peak-to-peak tau/sigma"),
    "inertia": Quantity("1", "largest |tau/sigma - mu| over amplitude"),
    "slow_fraction": Quantity("1", "part of the period slower than V_lp/10"),
    "fundamental": Quantity("1", "share of the fundamental in the variance of tau"),
    "multipliers": Quantity("1", "Floquet multipliers"),
    "residual": Quantity("1", "relative distance by which a cycle does not close"),
    "error": Quantity("1", "estimated relative error of amplitude and period"),
    "V_max_error": Quantity("1", "estimated relative error of V_max"),
    "V_min_error": Quantity("1", "estimated relative error of V_min"),
    "special": Quantity("1", "special point of a branch"),
    "step_up": Quantity("1", "smallest V_lp/V of a step up that leaves steady sliding"),
    "step_down": Quantity("1", "largest V_lp/V of a step down that leaves steady sliding"),
    "kick_up": Quantity("Pa", "smallest rise of tau that leaves steady sliding"),
    "kick_down": Quantity("Pa", "smallest fall of tau that leaves steady sliding"),
    "outcome": Quantity("1", "what the smallest such disturbance leads to"),
    "unstable_amplitude": Quantity("1", "amplitude of the unstable cycle"),
    "unstable_period": Quantity("s", "period of the unstable cycle"),
    "unstable_multiplier": Quantity("1", "larger Floquet multiplier of the unstable cycle"),
    "t": Quantity("s", "time", ">= 0"),
    "time": Quantity("s", "time", ">= 0"),
    "t_end": Quantity("s", "end of the run", "> 0"),
    "times": Quantity("s", "saved times", ">= 0"),
    "dt": Quantity("s", "time step", "> 0", "'0.1 ms'"),
    "rtol": Quantity("1", "relative tolerance", "> 0", "1e-6"),
    "status": Quantity("1", "how the case ended"),
    "message": Quantity("1", "why the case has no answer"),
    "steps": Quantity("1", "accepted steps"),
    "rejected": Quantity("1", "rejected steps"),
    "energy_residual": Quantity("1", "relative energy-balance error"),
    "cycles": Quantity("1", "cycles completed"),
    "returns": Quantity("1", "returns to V = V_lp that make the period"),
    "inertial_force": Quantity("1", "largest |tau/sigma - mu|"),
    "mu_min": Quantity("1", "smallest friction coefficient"),
    "reversal_margin": Quantity("1", "smallest tau/sigma + mu"),
    "outside_domain": Quantity("1", "where the friction law is outside of its domain"),
    "eigenvalue_3": Quantity("1/s", "third eigenvalue at the Hopf bifurcation"),
    "lyapunov_1": Quantity("1/s", "first Lyapunov coefficient"),
    "type": Quantity("1", "type of the Hopf bifurcation"),
    "amplitude_coefficient": Quantity("1", "growth of amplitude from the Hopf bifurcation"),
    "b_over_a": Quantity("1", "evolution effect over direct effect", "", "2"),
    "regime": Quantity("1", "regime by the measured cycle"),
    "regime_by_eta": Quantity("1", "regime by eta: stick-slip below 1, quasi-harmonic from 1 on"),
    "agree": Quantity("1", "whether both tell the same regime"),
    "amplitude_over_a": Quantity("1", "amplitude over a"),
    "slip_per_cycle": Quantity("1", "slip per cycle over Dc, V_lp period/Dc"),
    "frequency_over_f_n": Quantity("1", "frequency of the limit cycle over the natural frequency"),
    "V_max_over_V_lp": Quantity("1", "largest slip velocity over load-point velocity"),
    "K_over_K_c_qs": Quantity("1", "stiffness over the quasi-static critical one", "> 0"),
    "K_over_K_c": Quantity("1", "stiffness over the critical one", "> 0"),
    "K_c_over_K_c_qs": Quantity("1", "critical stiffness over the quasi-static one"),
    "K_fold_over_K_c_qs": Quantity("1", "stiffness up to which a cycle and stable sliding coexist"),
    "eta_bautin": Quantity("1", "eta at which the Hopf bifurcation changes its type"),
    "lag": Quantity("s", "delay of the load point behind its record"),
    "trend_slip": Quantity("1/m", "trend of friction with slip"),
    "trend_time": Quantity("1/s", "trend of friction with time"),
    "theta_start": Quantity("s", "state at the record's start"),
    "a_minus_b": Quantity("1", "rate dependence in steady sliding, a - b"),
    "standard_error": Quantity("1", "standard error, in the parameter's SI unit"),
    "interval": Quantity("1", "confidence interval, in the parameter's SI unit"),
    "correlation": Quantity("1", "correlation of the estimates"),
    "interval_kind": Quantity("1", "what the intervals are from"),
    "profile_value": Quantity("1", "value kept in a fit, in the parameter's SI unit"),
    "profile_deviance": Quantity("1", "chi-square of that fit over the least"),
    "posterior": Quantity("1", "samples of the posterior, in the parameter's SI unit"),
    "log_evidence": Quantity("1", "ln of the evidence"),
    "log_evidence_error": Quantity("1", "standard error of ln of the evidence"),
    "posterior_evaluations": Quantity("1", "likelihoods computed for the posterior"),
    "effective_samples": Quantity("1", "independent samples of the same worth"),
    "posterior_efficiency": Quantity("1", "samples per likelihood computed"),
    "aic_difference": Quantity("1", "Akaike information criterion over the least"),
    "bic_difference": Quantity("1", "Bayesian information criterion over the least"),
    "akaike_weight": Quantity("1", "Akaike weight of the law"),
    "log_bayes_factor": Quantity("1", "ln of the evidence over the largest"),
    "log_bayes_factor_error": Quantity("1", "standard error of that"),
    "friction": Quantity("1", "recorded friction"),
    "friction_fit": Quantity("1", "fitted friction"),
    "fit_error": Quantity("1", "standard error of the fitted friction"),
    "band": Quantity("1", "where 95 % of samples are predicted"),
    "rms": Quantity("1", "root mean square of the residuals"),
    "noise_white": Quantity("1", "standard deviation of the white noise"),
    "noise_red": Quantity("1", "standard deviation of the correlated noise"),
    "noise_time": Quantity("s", "correlation time of the noise"),
    "chi2_white": Quantity("1", "variance of the residuals over that of white noise"),
    "log_likelihood": Quantity("1", "ln of the likelihood at its maximum"),
    "aic": Quantity("1", "Akaike information criterion"),
    "bic": Quantity("1", "Bayesian information criterion"),
    "identifiability": Quantity("1", "what the record tells of each parameter"),
    "warnings": Quantity("1", "what must be known before the numbers are used, a line each"),
    "samples": Quantity("1", "samples fitted"),
    "evaluations": Quantity("1", "motions computed"),
    "noise": Quantity("1", "standard deviation of the noise in friction", "> 0", "3e-4"),
    "segment_t": Quantity("s", "start of a constant load-point velocity"),
    "segment_V": Quantity("m/s", "load-point velocity from there on"),
    "segment_t_error": Quantity("s", "standard error of the start"),
    "segment_V_error": Quantity("m/s", "standard error of the velocity"),
    "number": Quantity("1", "number"),  # an axis that is none of the above
}


def attrs(symbol):
    """Attributes ``units`` and ``long_name`` that a variable with this symbol carries."""
    return {"units": QUANTITIES[symbol].unit, "long_name": QUANTITIES[symbol].long_name}


def expected(symbol, unit=True):
    """The end of an error message: what a value of this quantity looks like, and its SI unit."""
    quantity = QUANTITIES[symbol]
    kind, example = KINDS[quantity.unit]
    si = f" [{quantity.unit}]" if unit and quantity.unit != "1" else ""
    return f"expected {kind}{si} such as {quantity.example or example}"


def power_of(unit, value):
    """The power of ten of the prefix that brings a value [SI] to 1 or more, or nearest to it.

    It is 0 for values so small that no prefix makes them readable.

    >>> power_of("m/s", 0.0032)
    -3
    """
    powers = POWERS.get(unit, (0,))
    size = abs(value) * (1 + 1e-9)  # 1e-3 is 1 m, whatever its rounding
    lowest = powers[-1] if size >= 10.0 ** (powers[-1] - 3) else 0
    return next((p for p in powers if size >= 10.0**p), lowest)


def long_time(seconds):
    """Name and length [s] of the unit, beyond seconds, in which a time is best told, or None."""
    return next((unit for unit in LONG_TIMES.items() if seconds >= 2.0 * unit[1]), None)


def readable(symbol, value, digits=4):
    """A value [SI] of a quantity as text that `to_si` reads, with a unit that fits it.

    >>> readable("V_lp", 0.0032)
    '3.2 mm/s'
    """
    unit = QUANTITIES[symbol].unit
    if unit == "1" or not abs(value) < float("inf"):
        return f"{value:.{digits}g}" + ("" if unit == "1" else f" {unit}")
    power = power_of(unit, value)
    return f"{value / 10.0**power:.{digits}g} {PREFIXES[power]}{unit}"


def with_error(value, error):
    """A value and its standard error as text, with the digits that the error leaves.

    >>> with_error(9.4871, 0.1234), with_error(9.4871, 0.0456), with_error(0.6, 0.0)
    ('9.49 +- 0.12', '9.49 +- 0.05', '0.6')
    """
    if not 0.0 < error < float("inf"):
        return f"{value:.4g}"
    return f"{rounded(value, error)} +- {rounded(error, error)}"


def rounded(value, error):
    """A value as text, to the last digit of its error: the first one, if it is 3.55 or more, or
    else the second.

    >>> rounded(9.4871, 0.1234), rounded(9.4871, 0.0456), rounded(152345.6, 1234.5)
    ('9.49', '9.49', '152346')
    """
    if not 1e-12 < error < 1e5:
        return f"{value:.4g}"
    return f"{value:.{max(-math.floor(math.log10(error / 3.55)), 0)}f}"


def short(value):
    """A plain number in three digits, or all of its whole ones.

    >>> short(7.3298), short(11712.4)
    ('7.33', '11712')
    """
    return f"{value:.0f}" if abs(value) >= 99.5 else f"{value:.3g}"


def readable_multiplier(value):
    """A Floquet multiplier as text; a real one near 1 by what it lacks.

    >>> readable_multiplier(0.5 + 0.25j), readable_multiplier(1 - 7e-7)
    ('0.5+0.25i', '1 - 7e-07')
    """
    x, y = value.real, value.imag
    if abs(y) > 1e-12 * abs(value):
        return f"{x:.4g}{y:+.4g}i"
    return f"1 - {1 - x:.3g}" if 0.0 < 1.0 - x < 5e-5 else f"{x:.4g}"
