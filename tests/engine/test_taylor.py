"""The Taylor method: coefficients, order, agreement with Rodas5P, choice."""

import functools
import math

import mpmath
import numpy as np
import pytest
import xarray as xr
from textbook import OF_LAW, drawn

import ratestate as rs
from ratestate.engine import rows as R
from ratestate.engine import taylor as T
from ratestate.engine.taylor import (
    ORDER,
    coefficients,
    has_recurrences,
    variational_coefficients,
)
from ratestate.friction.point import point_at
from ratestate.friction.tuples import pairwise_sum, product

WITH_RECURRENCES = [law for law in OF_LAW if law != "flash-heating"]
#: a state in the dimensionless system, with w_lp, its rate `ramp`, kappa and eta0
POINT = {"x": 0.3, "v": 0.2, "psi": -0.15, "w_lp": 1.1, "ramp": 0.07, "kappa": 0.8, "eta0": 0.6}


def longest(last, before, tolerance, momentum=0.0):
    return T.step_length(T.norm(last, momentum), T.norm(before, momentum), tolerance)


def rough_log2(x):
    return T.rough_log2(x)


def over_step(c, of_works, h):
    h_powers = T.powers(h)
    return tuple(pairwise_sum(product(one, h_powers)) for one in c), T.integrals(of_works, h_powers)


# ----------------------------------------------------------------------------------- coefficients


class Truncated:
    """A power series up to a degree, in many digits."""

    N = 2

    def __init__(self, c):
        c = [mpmath.mpf(one) for one in np.atleast_1d(c).tolist()]
        self.c = (c + [mpmath.mpf(0)] * self.N)[: self.N]

    @staticmethod
    def of(x):
        return x if isinstance(x, Truncated) else Truncated([x])

    def __add__(self, other):
        return Truncated([a + b for a, b in zip(self.c, Truncated.of(other).c, strict=True)])

    def __mul__(self, other):
        b = Truncated.of(other).c
        terms = (mpmath.fdot(self.c[: k + 1], b[k::-1]) for k in range(self.N))
        return Truncated(list(terms))

    def __neg__(self):
        return self * -1

    def __sub__(self, other):
        return self + -Truncated.of(other)

    def __rsub__(self, other):
        return -self + other

    __radd__, __rmul__ = __add__, __mul__

    def __pow__(self, n):
        return functools.reduce(Truncated.__mul__, [self] * n)

    def reciprocal(self):
        found = Truncated([1 / self.c[0]])
        for _ in range(6):
            found = found * (2 - self * found)
        return found

    def __truediv__(self, other):
        return self * Truncated.of(other).reciprocal()

    def __rtruediv__(self, other):
        return self.reciprocal() * other

    def exp(self):
        """e**c_0 times the exponential series of the rest."""
        rest, term, total = Truncated([0, *self.c[1:]]), Truncated([1]), Truncated([1])
        for k in range(1, self.N):
            term = term * rest * (mpmath.mpf(1) / k)
            total = total + term
        return total * mpmath.exp(self.c[0])

    def at(self, t):
        return mpmath.fsum(c * mpmath.mpf(t) ** k for k, c in enumerate(self.c))

    def integral(self, start):
        return Truncated([start, *(c / (k + 1) for k, c in enumerate(self.c[:-1]))])


def coefficients_of(law):
    """Return a law and its p, from the example of each of its parameters."""
    slider = rs.SpringSlider(a=0.003, b=0.006, Dc=1e-5, sigma=2e6, K=9e8, law=law, **OF_LAW[law])
    law = slider.friction_law
    columns = {k: np.array([v]) for k, v in slider.parameters.items() if not isinstance(v, str)}
    return law, tuple(float(one[0]) for one in law.coefficient_arrays(1e-6, columns))


def start_of(law, point):
    return [point["x"], point["v"], *[point["psi"]] * len(law.states)]


def solution(law, p, point, start=None, terms=ORDER + 3):
    """Return y and the powers of `work_rates` as `Truncated`, by Picard's iteration."""
    start = start_of(law, point) if start is None else start
    y = [Truncated([one]) for one in start]
    for Truncated.N in range(2, terms + 1):
        w_lp = Truncated([point["w_lp"], point["ramp"]])
        x, v, *psi = (Truncated(one.c) for one in y)
        w = v.exp()
        at = law.at_speed(v, tuple(psi), p)
        S, f = at.S, at.f
        rates = [point["kappa"] * (w_lp - w), (x - S) / (w * point["eta0"]), *f]
        y = [Truncated.of(rate).integral(one) for rate, one in zip(rates, start, strict=True)]
    return y, [x * w_lp, S * w]


def found_coefficients(law, p, point):
    y = (point["x"], point["v"], *[point["psi"]] * len(law.states))
    start = point_at(law, p, y, point["kappa"], point["eta0"])
    return coefficients(start, point["w_lp"], point["ramp"])


@pytest.mark.parametrize("name", WITH_RECURRENCES)
def test_coefficients(name):
    """Of the motion and of its powers, beside power series in 40 digits."""
    law, p = coefficients_of(name)
    with mpmath.workdps(40):
        y, works = solution(law, p, POINT)
    found, powers_found = found_coefficients(law, p, POINT)
    assert len(found) == 2 + len(law.states)
    for one, exact in zip((*found, *powers_found), (*y, *works), strict=True):
        exact = np.array(exact.c[: len(one)], float)
        np.testing.assert_allclose(one, exact, rtol=1e-12, atol=1e-13 * np.abs(exact).max())
    assert [len(one) for one in found] == [ORDER + 1] * len(found)
    assert [len(one) for one in powers_found] == [ORDER] * 2


@pytest.mark.parametrize("name", ["prz", "nagata", "two-state-aging"])
def test_coefficients_of_perturbations(name):
    """Beside difference quotients of power series in 60 digits, and the trace beside its own."""
    law, p = coefficients_of(name)
    point = POINT | {"w_lp": 1.0, "ramp": 0.0}
    y = start_of(law, point)
    rng, n = np.random.default_rng(7), len(y)
    z = tuple(tuple(rng.normal(size=n).tolist()) for _ in range(n - 1))
    start = point_at(law, p, tuple(y), point["kappa"], point["eta0"])
    of_y, of_z, trace = variational_coefficients(start, z)
    assert len(of_z) == n * (n - 1)
    with mpmath.workdps(60):
        tiny = mpmath.mpf(10) ** -25

        def moved(start, along, by, terms=ORDER + 3):
            begin = [a + by * tiny * b for a, b in zip(start, along, strict=True)]
            return solution(law, p, point, begin, terms)[0]

        exact_y = moved(y, y, 0)
        slopes = [
            (a - b) * (1 / (2 * tiny))
            for one in z
            for a, b in zip(moved(y, one, 1), moved(y, one, -1), strict=True)
        ]
        # the trace a little later, of slopes of the rates, which are second coefficients
        later = [one.at(0.02) for one in exact_y]
        units = [[mpmath.mpf(i == k) for i in range(n)] for k in range(n)]
        diagonal = [
            (moved(later, units[k], 1, 2)[k].c[1] - moved(later, units[k], -1, 2)[k].c[1])
            / (2 * tiny)
            for k in range(n)
        ]
    for found, exact in zip((*of_y, *of_z), (*exact_y, *slopes), strict=True):
        exact = np.array(exact.c[: ORDER + 1], float)
        np.testing.assert_allclose(found, exact, rtol=1e-11, atol=1e-12 * np.abs(exact).max())
    assert np.polynomial.Polynomial(trace)(0.02) == pytest.approx(float(sum(diagonal)), rel=1e-12)


@pytest.mark.parametrize("name", ["slip", "two-state-aging"])
def test_order(name):
    """Half the step has an error 2**(ORDER + 1) times smaller, of the motion and of its works."""
    law, p = coefficients_of(name)
    with mpmath.workdps(40):
        y, works = solution(law, p, POINT, terms=22)
        c, of_works = found_coefficients(law, p, POINT)
        errors = []
        for h in (0.2, 0.1):
            y_new, of_step = over_step(c, of_works, h)
            found = [*y_new, *(h * one for one in of_step)]
            exact = [one.at(h) for one in (*y, *(one.integral(0) for one in works))]
            errors.append(np.abs(np.array(found) - np.array(exact, float)))
    ratio = errors[0] / errors[1]
    assert (ratio > 2.0 ** (ORDER + 0.5)).all()
    assert (ratio < 2.0 ** (ORDER + 1.5)).all()


def last_two(c):
    return tuple(zip(*c, strict=True))[:-3:-1]


def test_last_terms_of_a_step_reach_the_tolerance():
    """A tenth of it, to 1 %, whichever of the last two is longer; and of any variable."""
    c = [[0.5**k for k in range(ORDER + 1)], [0.25**k for k in range(ORDER + 1)]]
    h = longest(*last_two(c), 1e-6)
    assert (0.5 * h) ** (ORDER - 1) == pytest.approx(1e-7, rel=0.12)
    assert (0.5 * h) ** ORDER < 1e-7
    c[1][ORDER - 1] = 0.0
    c[1][ORDER] = 1.0
    assert longest(*last_two(c), 1e-6) ** ORDER == pytest.approx(1e-7, rel=0.12)
    h = longest(*last_two(c), 1e-6, 100.0)  # by v, of which an error returns in x
    assert h**ORDER == pytest.approx(1e-9, rel=0.12)


@pytest.mark.parametrize("x", [1e-300, 3e-7, 0.75, 1.0, 1.5, 8.0, 1e300])
def test_rough_log2(x):
    assert math.log2(x) - 0.0861 < rough_log2(x) <= math.log2(x) + 1e-9


# ------------------------------------------------------------------------------ laws that have them


@pytest.mark.parametrize("name", OF_LAW)
def test_which_laws_have_recurrences(name):
    law, _ = coefficients_of(name)
    assert has_recurrences(law) == (name in WITH_RECURRENCES)
    assert (len(R.rows_of(law).c[0]) > R.RODAS5P_TERMS) == has_recurrences(law)


@pytest.mark.parametrize(
    ("own", "has"),
    [
        ({"damping": 1e5}, True),
        ({"friction": "cut-off", "V1": 1e-2, "V2": 1.0}, True),
        ({"friction": "regularized"}, False),
    ],
)
def test_which_forms_have_recurrences(own, has):
    slider = rs.SpringSlider(a=0.003, b=0.006, Dc=1e-5, sigma=2e6, M=3e3, K=9e8, **own)
    assert has_recurrences(slider.friction_law) == has


# ------------------------------------------------------------------------------------- the answers


def relative(run, exact):
    """Largest error in tau/(a sigma), ln V and ln theta."""
    a_sigma = exact.attrs["a sigma"]
    off = [abs(run.tau - exact.tau) / a_sigma, abs(np.log(run.V / exact.V))]
    return max(float(one.max()) for one in off)


@pytest.mark.parametrize("law", WITH_RECURRENCES)
def test_same_answers_as_rodas5p(law):
    """Of random sliders, quasi-harmonic and stick-slip, under a loading with steps and a ramp."""
    rng = np.random.default_rng(20)
    errors = []
    for _ in range(8):
        p, V = drawn(law, rng)
        slider = rs.SpringSlider(**p, law=law)
        t = 30.0 * p["Dc"] / V
        loading = rs.Loading.series(
            np.array([0.0, 0.3, 0.3, 0.6, 1.0]) * t, [V, V, 2 * V, 1.2 * V, 1.2 * V]
        )
        run = functools.partial(rs.simulate, slider, loading, t, times=np.linspace(0, t, 50))
        fine, other = run(rtol=1e-9), run(rtol=1e-9, method="rodas5p")
        exact = run(rtol=1e-13, method="rodas5p")
        exact.attrs["a sigma"] = p["a"] * p["sigma"]
        errors.append((relative(fine, exact), relative(other, exact)))
        assert abs(float(fine.energy_residual)) < 1e-8
        moves = float(exact.amplitude) > 1e-4  # else what is left of the first disturbance
        for name in ("amplitude", "frequency") * moves + ("V_max", "V_min", "inertial_force"):
            assert float(fine[name]) == pytest.approx(float(exact[name]), rel=1e-6, abs=1e-12), name
    found, others = np.array(errors).T
    assert np.median(found) < 2.0 * np.median(others)
    assert found.max() < 1e-5


@pytest.mark.parametrize(
    ("law", "rtol"),
    [("slip", 1e-4), ("slip", 1e-8), ("slip", 1e-12), ("aging", 1e-4), ("aging", 1e-8)],
)
def test_taylor_steps_are_taken_only_if_not_stiff(law, rtol):
    """Fewer steps where nothing is stiff, and not more where it is, through holds and events."""
    slider = rs.SpringSlider(a=0.003, b=0.006, Dc=1e-5, sigma=2e6, M=3e3, K=9e8, law=law)
    run = functools.partial(rs.simulate, rtol=rtol, times=[0.0])

    def steps(slider, *arguments, **more):
        found = [run(slider, *arguments, method=method, **more) for method in ("auto", "rodas5p")]
        return [int(one.steps) for one in found]

    harmonic, by_rodas5p = steps(slider, rs.Loading.constant(1e-2), 1.0, V_start=9e-3)
    assert harmonic < {1e-4: 0.7, 1e-8: 0.25, 1e-12: 0.07}[rtol] * by_rodas5p
    stick_slip, by_rodas5p = steps(slider, rs.Loading.constant(1e-5), 40.0, V_start=9e-6)
    assert stick_slip < 1.02 * by_rodas5p
    stable, by_rodas5p = steps(slider.replace(K=2e9), rs.Loading.constant(0.1), 5.0, V_start=0.09)
    assert stable < 1.05 * by_rodas5p
    damped, by_rodas5p = steps(
        slider.replace(damping=1e7), rs.Loading.constant(0.1), 5.0, V_start=0.09
    )
    assert damped < 1.05 * by_rodas5p
    heavy, by_rodas5p = steps(
        slider.replace(M=1e7), rs.Loading.constant(0.1), 5.0, V_start=0.09
    )  # of which the state relaxes a hundred times faster than it vibrates
    assert heavy < 1.1 * by_rodas5p
    hold, by_rodas5p = steps(slider, rs.Loading.steps(1e-3, (0.05, 0.0)), 1e5, V_start=1e-3)
    assert hold < 1.02 * by_rodas5p


def test_sliders_that_change_their_method_in_one_batch():
    """Their returns and extremes move with them: 40 that differ, in a batch and each alone."""
    n = 40
    M = xr.DataArray(np.geomspace(1e2, 1e6, n), dims="case")
    slider = rs.SpringSlider(a=0.003, b=0.006, Dc=1e-5, sigma=2e6, M=M, K=9e8, law="aging")
    run = functools.partial(rs.simulate, rtol=1e-8)
    many = run(slider, rs.Loading.constant(3e-2), 1.0, V_start=2.5e-2)
    names = ["amplitude", "frequency", "V_max", "V_min", "cycles", "inertial_force", "steps"]
    for i in range(0, n, 3):
        one = run(slider.replace(M=float(M[i])), rs.Loading.constant(3e-2), 1.0, V_start=2.5e-2)
        for name in names:
            expected = float(one[name])
            assert float(many[name][i]) == pytest.approx(expected, rel=2e-6, abs=1e-9), name


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("method", ["auto", "rodas5p"])
def test_no_return_is_missed(method, seed):
    """V may rise above V_lp and fall below it again within a step, as it does in transients."""
    rng = np.random.default_rng(seed)
    a, b, Dc, sigma, V = 0.005, 0.0005, 1e-5, 1e6, 1e-5
    K, M = 25.0 * a * sigma / Dc, 0.02 * a * sigma * Dc / V**2
    slider = rs.SpringSlider(a=a, b=b, Dc=Dc, sigma=sigma, K=K, M=M, law="prz")
    loading = rs.Loading.constant(V)
    for k in range(12):
        loading = loading.ramp(1.0 + 2.2 * k, V * rng.uniform(0.2, 3.0), 2.0)
    times = np.linspace(0.0, 30.0, 60_001)
    exact = rs.simulate(slider, loading, 30.0, V_start=0.9 * V, times=times, rtol=1e-11)
    above = (exact.V_load <= exact.V).values
    returns = int((~above[:-1] & above[1:]).sum()) - 1
    run = rs.simulate(
        slider, loading, 30.0, V_start=0.9 * V, times=[30.0], rtol=1e-9, method=method
    )
    assert returns > 8
    assert int(run.cycles) == returns
