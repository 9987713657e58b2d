"""The result of a fit as a Dataset: estimates, intervals, correlation, curves, statistics."""

from typing import NamedTuple

import numpy as np
import xarray
from scipy.special import ndtri

from ...model.quantities import attrs
from .unknowns import LINEAR, START, slope, to_value

LEVELS = (0.68, 0.95)
SIDES = ("lower", "upper")
#: standard errors to which they reach, of a Gaussian
ROOTS = ndtri(0.5 + 0.5 * np.array(LEVELS))
#: half width of an interval of a logarithm beyond which it has no end
ENDLESS = np.log(1e6)
#: standard error of a coordinate that is none: the record does not see it
UNSEEN = 1e6


class Estimates(NamedTuple):
    """p estimates as they are reported [SI]: with errors, intervals, correlation."""

    names: tuple  # symbols
    values: np.ndarray  # (p,)
    errors: np.ndarray  # (p,) standard errors
    intervals: np.ndarray  # (p, levels, sides)
    correlation: np.ndarray  # (p, p), of the coordinates
    kinds: tuple  # what the intervals are from: "covariance", "profile" or "posterior"

    def only(self, names):
        """The same of these names."""
        i = [self.names.index(name) for name in names]
        kinds = tuple(self.kinds[k] for k in i)
        values, errors, intervals = self.values[i], self.errors[i], self.intervals[i]
        correlation = self.correlation[np.ix_(i, i)]
        return Estimates(tuple(names), values, errors, intervals, correlation, kinds)

    def with_intervals(self, intervals, kind):
        """The same with other intervals: name -> (levels, sides) [SI]."""
        ends = np.array(
            [intervals.get(name, old) for name, old in zip(self.names, self.intervals, strict=True)]
        )
        kinds = tuple(
            kind if name in intervals else old
            for name, old in zip(self.names, self.kinds, strict=True)
        )
        return self._replace(intervals=ends, kinds=kinds)


def estimates(names, coordinates, covariance, derived=()):
    """`Estimates` of what moves in coordinates (unknowns.py), from their covariance.

    Parameters
    ----------
    names : tuple of str, of the k coordinates
    coordinates : (k,)
    covariance : (k, k)
    derived : sequence of (symbol, value, (k,) gradient), linear functions of the coordinates
    """
    count = len(names)
    gradients = np.vstack([np.eye(count), *(gradient for _, _, gradient in derived)])
    spread = gradients @ covariance @ gradients.T
    errors = np.sqrt(np.diag(spread))
    where = np.concatenate([coordinates, [value for _, value, _ in derived]])
    reach = ROOTS[:, None] * np.array([-1.0, 1.0])
    ends = where[:, None, None] + errors[:, None, None] * reach
    values, scales = where.copy(), np.ones(where.size)
    for i, name in enumerate(names):
        values[i] = to_value(name, where[i])
        if name not in LINEAR:  # a logarithm so uncertain is unknown
            ends[i] = np.where(np.abs(ends[i] - where[i]) > ENDLESS, np.inf * reach, ends[i])
        scales[i] = slope(name, values[i])
        ends[i] = to_value(name, ends[i])
    names = (*names, *(symbol for symbol, _, _ in derived))
    correlation = spread / np.outer(errors, errors)
    scaled = np.where(errors < UNSEEN, scales * errors, np.inf)
    return Estimates(names, values, scaled, ends, correlation, ("covariance",) * len(names))


def estimate_variables(found):
    """The variables of `Estimates`: a scalar for each, and tables along ``parameter``."""
    variables: dict[str, tuple] = {
        name: ((), float(value), attrs(name))
        for name, value in zip(found.names, found.values, strict=True)
    }
    tables: dict[str, tuple] = {
        "standard_error": (("parameter",), found.errors),
        "interval": (("parameter", "level", "side"), found.intervals),
        "correlation": (("parameter", "other"), found.correlation),
        "interval_kind": (("parameter",), list(found.kinds)),
    }
    names = list(found.names)
    coords = {
        "parameter": names,
        "other": names,
        "level": list(LEVELS),
        "side": list(SIDES),
    }
    variables |= {name: (dims, values, attrs(name)) for name, (dims, values) in tables.items()}
    return xarray.Dataset(variables, coords)


def profile_variables(profiles, numbers):
    """Points of the profiles: ``profile_value`` [SI] and ``profile_deviance``; NaN where none."""
    if not profiles:
        return xarray.Dataset()
    size = max(one.values.size for one in profiles.values())
    table = np.full((2, len(numbers), size), np.nan)
    for i, number in enumerate(numbers):
        if number.name in profiles:
            one = profiles[number.name]
            table[:, i, : one.values.size] = number.si(one.values), one.deviance
    dims = ("parameter", "profile_point")
    names = ("profile_value", "profile_deviance")
    variables = {n: (dims, part, attrs(n)) for n, part in zip(names, table, strict=True)}
    coords = {"parameter": [number.name for number in numbers], "profile_point": np.arange(size)}
    return xarray.Dataset(variables, coords)


def posterior_variables(sampled, numbers):
    """Samples of equal weight, and the sampler's diagnostics."""
    if sampled is None:
        return xarray.Dataset()
    samples = np.stack([number.si(sampled.of(number)) for number in numbers], axis=1)
    values = {
        "log_evidence": sampled.log_evidence,
        "log_evidence_error": sampled.log_evidence_error,
        "posterior_evaluations": sampled.evaluations,
        "effective_samples": sampled.effective,
        "posterior_efficiency": sampled.efficiency,
    }
    variables: dict[str, tuple] = {n: ((), value, attrs(n)) for n, value in values.items()}
    variables["posterior"] = (("sample", "parameter"), samples, attrs("posterior"))
    return xarray.Dataset(variables, {"parameter": [number.name for number in numbers]})


def curves(solution):
    """The variables along time: what was recorded, what was fitted, how far they may differ."""
    record = solution.problem.record
    error = np.sqrt(
        np.maximum(
            np.einsum("mi,ij,mj->m", solution.jacobian, solution.covariance, solution.jacobian), 0.0
        )
    )
    reach = ROOTS[-1] * np.hypot(error, solution.noise.level)
    values = {
        "friction": record.friction,
        "friction_fit": solution.fitted,
        "fit_error": error,
    }
    variables: dict[str, tuple] = {n: ("time", value, attrs(n)) for n, value in values.items()}
    named = {"units": "1", "long_name": "recorded less fitted friction"}
    variables["residual"] = ("time", record.friction - solution.fitted, named)
    band = solution.fitted[:, None] + reach[:, None] * np.array([-1.0, 1.0])
    variables["band"] = (("time", "side"), band, attrs("band"))
    variables["delta_lp"] = ("time", record.loading.delta_lp(record.t), attrs("delta_lp"))
    coords = {"time": ("time", record.time, attrs("time")), "side": list(SIDES)}
    return xarray.Dataset(variables, coords)


def statistics(solution):
    """How well the curve fits, and what noise it leaves."""
    residual = solution.problem.record.friction - solution.fitted
    noise = solution.noise
    k = len(solution.point) + (3 if noise.red else 1)
    successive = np.var(np.diff(residual)) / 2.0
    values = {
        "rms": np.sqrt(np.mean(residual**2)),
        "noise_white": noise.white,
        "noise_red": noise.red,
        "noise_time": noise.time if noise.red else 0.0,
        "chi2_white": np.mean(residual**2) / successive,
        "log_likelihood": solution.log_likelihood,
        "aic": 2.0 * k - 2.0 * solution.log_likelihood,
        "bic": k * np.log(residual.size) - 2.0 * solution.log_likelihood,
        "samples": residual.size,
        "evaluations": solution.evaluations,
    }
    if START[0] in solution.unknowns.names:
        forward = solution.problem.forward
        at = {name: float(value[0]) for name, value in forward.values(solution.point[None]).items()}
        v, psi = (at[name] for name in START)
        values["V_start"] = forward.V0 * np.exp(v)
        values["theta_start"] = at["Dc"] / forward.V0 * np.exp(psi)
    return xarray.Dataset({name: ((), value, attrs(name)) for name, value in values.items()})


def text_variables(identifiability, warnings):
    """The words on a fit: what is determined; and what must be known, a line each."""
    texts = {"identifiability": identifiability, "warnings": "\n".join(warnings)}
    return {name: ((), text, attrs(name)) for name, text in texts.items()}
