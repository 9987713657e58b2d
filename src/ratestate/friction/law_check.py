"""Whether a law that a user brings is one: its names, its derivatives, its steady sliding.

What is wrong is a sentence that names both values.  Derivatives are compared with differences of
the order before, by complex steps where its functions take complex numbers.
"""

import math
import types
from collections.abc import Callable
from typing import Any

import numpy as np

from ..errors import ParameterError
from .law import FrictionLaw

# Sizes of the step of a difference: an imaginary one, of which the square is nothing, and a real.
IMAGINARY, REAL = 1e-30, 1e-3
# Relative differences of derivatives that are rounding, by either step.
ROUNDING = {True: 1e-9, False: 1e-5}
# Rate in steady sliding, over the terms of which it is the sum.
STEADY = 1e-9
# Difference of the series of a law of one length from its rate.
SERIES = 1e-9
#: states and parameters at which a law is tried, in each of which they are drawn anew
TRIALS = 12


def _hessian(partials):
    """Second derivatives of friction, vv, v psi and psi psi, as one matrix along (v, psi)."""
    by_vv, by_vpsi, by_psipsi = partials
    return np.block(
        [
            [np.array(by_vv), np.array(by_vpsi)[None]],
            [np.array(by_vpsi)[:, None], np.array(by_psipsi)],
        ]
    )


def _third(partials):
    """Third derivatives of friction, likewise."""
    by_vvv, by_vvpsi, by_vpsipsi, by_psi_3 = partials
    by_v = _hessian((by_vvv, by_vvpsi, by_vpsipsi))
    by_psi = (_hessian(x) for x in zip(by_vvpsi, by_vpsipsi, by_psi_3, strict=True))
    return np.stack([by_v, *by_psi])


#: method of friction -> what makes an array, along the axes of (v, psi), of what it gives
ALONG_Y: dict[str, Callable[[Any], Any]] = {
    "resistance": np.array,
    "resistance_partials": lambda partials: np.array([partials[0], *partials[1]]),
    "resistance_partials_2": _hessian,
    "resistance_partials_3": _third,
}


def check(law, values):
    """How many orders of derivatives the law has, 1 to 3; ParameterError for what is wrong.

    values : symbol -> an example of each of its parameters [SI], a, b and Dc too
    """
    for method in ("rates", "rate_partials"):
        if not law.gives(method):
            raise ParameterError(f"it has no method {method}")
    if law.one_length:
        _check_one_length(law, values)
    rng = np.random.default_rng(0)
    orders = 3
    for _ in range(TRIALS):
        given = {symbol: x * math.exp(0.3 * rng.normal()) for symbol, x in values.items()}
        p = _coefficients(law, given)
        v, psi = rng.normal(), tuple(rng.normal(size=len(law.states)))
        trial = _Trial(law, v, psi, p)
        trial.check_rates()
        trial.check_friction()
        for order in (1, 2, 3):
            if order <= orders and not trial.has_order(order):
                orders = order - 1
        _check_steady(law, p)
    return orders


def _coefficients(law, values):
    """The law's coefficients, a tuple of floats."""
    arrays = {symbol: np.array(x) for symbol, x in values.items()}
    found = (law.coefficient_arrays(V, arrays) for V in (1e-6, 2e-6))
    p, faster = (tuple(float(x) for x in each) for each in found)
    rescaled = tuple(float(x) for x in law.rescaled(p, 2.0))
    if not np.allclose(rescaled, faster, rtol=1e-12, atol=0.0):
        raise ParameterError(
            f"rescaled gives {_shown(rescaled)} for twice the speed, coefficients {_shown(faster)}"
        )
    if not np.isfinite(p).all():
        raise ParameterError(f"coefficients gives {p} for {values}")
    return p


class _Trial:
    """A law at one state (v, psi), with coefficients p."""

    def __init__(self, law, v, psi, p):
        self.law, self.at, self.p = law, (v, *psi), p
        self.smooth = _of_complex_numbers(law)

    def _call(self, law, method, y):
        """A method's value at y = (v, psi); of friction an array along the axes of y."""
        v, psi = y[0], tuple(y[1:])
        w = np.exp(v)
        if method.startswith("rate"):
            e = tuple(np.exp(x) for x in law.exponents(v, w, psi, self.p))
            return getattr(law, method)(v, w, psi, e, self.p)
        return ALONG_Y[method](getattr(law, method)(v, w, psi, self.p))

    def slopes(self, method):
        """Derivatives of a method's value by v and by each psi, and whether by complex steps."""
        try:
            found = [np.imag(np.array(self._call(self.smooth, method, y))) for y in self._moved(1j)]
            return [x / IMAGINARY for x in found], True
        except (TypeError, AttributeError, ValueError):
            pass
        stencil = {-2: 1.0, -1: -8.0, 1: 8.0, 2: -1.0}
        total: list[Any] = [0.0] * len(self.at)
        for k, weight in stencil.items():
            for i, y in enumerate(self._moved(k)):
                total[i] = total[i] + weight * np.array(self._call(self.law, method, y))
        return [x / (12.0 * REAL) for x in total], False

    def _moved(self, by):
        """The state moved along each variable, by an imaginary step or so many real ones."""
        step = IMAGINARY * 1j if by == 1j else REAL * by
        for i in range(len(self.at)):
            yield tuple(x + step if j == i else x for j, x in enumerate(self.at))

    def check_rates(self):
        """Raise ParameterError unless there is a finite rate for each state."""
        rates, n = self._call(self.law, "rates", self.at), len(self.at) - 1
        if not (isinstance(rates, tuple) and len(rates) == n and np.isfinite(rates).all()):
            raise ParameterError(
                f"rates must give a tuple of {n}, finite numbers, not {rates} {self}"
            )

    def check_friction(self):
        """Raise ParameterError where the direct effect is not > 0."""
        by_v = float(self._call(self.law, "resistance_partials", self.at)[0])
        if not by_v > 0.0:
            raise ParameterError(f"friction must rise with the speed: dR/dv = {by_v:.6g} {self}")

    def has_order(self, order):
        """Whether derivatives of this order are there; ParameterError where they are wrong."""
        suffix = "" if order == 1 else f"_{order}"
        below = "" if order == 2 else f"_{order - 1}"
        of_rates = ("rates" if order == 1 else f"rate_partials{below}", f"rate_partials{suffix}")
        friction = "resistance" if order == 1 else f"resistance_partials{below}"
        if not self.law.gives(of_rates[1]):
            return False
        self._compare_rates(order, *of_rates)
        return self._friction_is_right(order, friction, f"resistance_partials{suffix}")

    def _compare_rates(self, order, lower, upper):
        """Compare derivatives of the rates with differences of the order before."""
        found = [np.atleast_1d(np.array(x)) for x in self._call(self.law, upper, self.at)]
        n = len(self.at) - 1
        if len(found) != order + 1 or any(x.shape != (n,) for x in found):
            raise ParameterError(
                f"{upper} must give {order + 1} tuples of {n}, a number a state, not {found}"
            )
        slopes, exact = self.slopes(lower)
        slopes = [np.reshape(x, (-1, n)) for x in slopes]
        expected = [*slopes[0], np.array([slopes[1 + k][-1][k] for k in range(n)])]
        for k, (mine, its) in enumerate(zip(found, expected, strict=True)):
            self._compare(f"{upper}, tuple {k + 1} of {order + 1}", mine, its, exact)
        for j in range(n):
            for k in range(n):
                if j != k and np.abs(slopes[1 + j][:, k]).max() > 1e-12:
                    raise ParameterError(f"the rate of state {k + 1} depends on state {j + 1}")

    def _friction_is_right(self, order, lower, upper):
        """Whether derivatives of friction are there; ParameterError where they are wrong."""
        slopes, exact = self.slopes(lower)
        found, expected = self._call(self.law, upper, self.at), np.array(slopes)
        if self.law.gives(upper) or order == 1:
            self._compare(upper, found, expected, exact)
            return True
        return bool(np.allclose(found, expected, rtol=0, atol=ROUNDING[exact]))

    def _compare(self, what, found, expected, exact):
        """Raise ParameterError unless both are the same, to rounding."""
        size = max(1.0, float(np.abs(expected).max()))
        if not (np.abs(found - expected) <= ROUNDING[exact] * size).all():
            raise ParameterError(
                f"{what}: {_shown(found)}, by differences {_shown(expected)} {self}"
            )

    def __str__(self):
        psi = ", ".join(f"{x:.4g}" for x in self.at[1:])
        return f"(at v = {self.at[0]:.4g}, psi = ({psi}), p = {_shown(self.p)})"


def _check_steady(law, p):
    """Raise ParameterError unless steady sliding at V_ref is found, and steady."""
    columns = tuple(np.array([x]) for x in p)
    psi = law.steady_variables(columns)
    e = law.exponentials(0.0, 1.0, psi, columns)
    rates = np.array([float(np.ravel(x)[0]) for x in law.rates(0.0, 1.0, psi, e, columns)])
    if not (np.abs(rates) <= STEADY).all():
        raise ParameterError(
            f"in steady sliding at V_ref the rates are {_shown(rates)}, not 0, where "
            f"steady_variables gives {_shown([float(x[0]) for x in psi])} (p = {_shown(p)})"
        )


def _check_one_length(law, values):
    """Raise ParameterError unless a law that says so has one length, and the series of its rate."""
    if law.gives("resistance") or dict(law.states) != {"theta": "Dc"}:
        raise ParameterError(
            "one_length = True is for one state, theta, and the friction of eq. 1; leave it out"
        )
    p = _coefficients(law, values)
    for z in (-0.4, 0.4):
        (rate,) = law.rates(0.0, 1.0, (z,), law.exponentials(0.0, 1.0, (z,), p), p)
        series = -z + sum(c * z**k for k, c in enumerate(law.series, 2))
        if not abs(rate - series) <= SERIES:
            raise ParameterError(
                f"one_length = True needs series = (c2, c3, ...): at v = 0 and psi = z = {z} rates "
                f"is {float(rate):.6g}, -z + c2 z^2 + c3 z^3 + ... {series:.6g}; mend it, or leave "
                f"one_length out"
            )


def _of_complex_numbers(law):
    """The law with NumPy's functions, which take complex numbers, in place of those of `math`."""
    kind = type(law)
    methods = {}
    for base in reversed(kind.__mro__[:-1]):
        for name, method in vars(base).items():
            if isinstance(method, types.FunctionType):
                names = {k: np if x is math else x for k, x in method.__globals__.items()}
                methods[name] = types.FunctionType(
                    method.__code__, names, name, method.__defaults__, method.__closure__
                )
    return type(kind.__name__, (FrictionLaw,), dict(vars(kind)) | methods)()


def _shown(values):
    return "(" + ", ".join(f"{float(x):.6g}" for x in np.ravel(values)) + ")"
