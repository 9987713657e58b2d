"""The Taylor method: coefficients, agreement with Rodas5P, choice."""

import functools
import math

import exact_functions  # noqa: F401  by which laws take mpmath's numbers
import mpmath as mp
import numpy as np
import pytest
from textbook import OF_LAW, drawn

import ratestate as rs
from ratestate.engine import rows as R
from ratestate.engine import taylor as T
from ratestate.engine.rows import ORDER
from ratestate.friction.point import point_at

WITH_RECURRENCES = [law for law in OF_LAW if law != "flash-heating"]
#: kappa and eta0; w_lp and its rate
SLIDER, LOADING = (mp.mpf(0.8), mp.mpf(0.6)), (mp.mpf(1.1), mp.mpf(0.07))


def longest(last, before, tolerance, momentum=0.0):
    return T.step_length(T.norm(last, momentum), T.norm(before, momentum), tolerance)


# ----------------------------------------------------------------------------------- coefficients


def coefficients_of(law):
    """Return a law and its p, from the example of each of its parameters."""
    slider = rs.SpringSlider(a=0.003, b=0.006, Dc=1e-5, sigma=2e6, K=9e8, law=law, **OF_LAW[law])
    law = slider.friction_law
    columns = {k: np.array([v]) for k, v in slider.parameters.items() if not isinstance(v, str)}
    return law, tuple(mp.mpf(float(one[0])) for one in law.coefficient_arrays(1e-6, columns))


def start_of(name):
    """Return a slider under a law, a `Point` in mpmath's numbers."""
    law, p = coefficients_of(name)
    y = (0.3, 0.2, *[-0.15, -0.1][: len(law.states)])
    return point_at(law, p, tuple(map(mp.mpf, y)), *SLIDER)


def rates(start, y, w_lp):
    """Return dy/dT, and the powers of the load point and of friction."""
    at, (kappa, eta0) = start.at(tuple(y)), SLIDER
    S = at.x - at.g
    return [kappa * (w_lp - at.w), at.g / (at.w * eta0), *at.f], [at.x * w_lp, S * at.w]


def value(series, T):
    return [mp.fsum(c * T**k for k, c in enumerate(one)) for one in series]


def compare(found, function):
    """Compare the coefficients of series with those of a function of T with as many values."""
    at = functools.cache(lambda T, precision: function(T))  # (which `taylor` raises)
    for i, one in enumerate(found):
        exact = np.array(mp.taylor(lambda T, i=i: at(T, mp.mp.prec)[i], 0, len(one) - 1), float)
        one = np.array(one, float)
        np.testing.assert_allclose(one, exact, rtol=1e-12, atol=1e-13 * np.abs(exact).max())


def slope(series):
    return [[k * c for k, c in enumerate(one)][1:] for one in series]


@pytest.mark.parametrize("name", WITH_RECURRENCES)
def test_coefficients(name):
    """The series satisfy the equations of motion, and are those of both powers, in each order."""
    start = start_of(name)
    found, powers = T.coefficients(start, *LOADING)

    def exact(T):
        dy, works = rates(start, value(found, T), value([LOADING], T)[0])
        return *dy, *works

    compare([*slope(found), *powers], exact)
    assert [len(one) for one in found] == [ORDER + 1] * (2 + len(start.psi))
    assert [len(one) for one in powers] == [ORDER] * 2


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
    assert math.log2(x) - 0.0861 < T.rough_log2(x) <= math.log2(x) + 1e-9


# ------------------------------------------------------------------------------ laws that have them


@pytest.mark.parametrize(
    ("has", "own"),
    [
        *((law in WITH_RECURRENCES, {"law": law} | own) for law, own in OF_LAW.items()),
        (True, {"damping": 1e5}),
        (True, {"friction_form": "cut-off", "V1": 1e-2, "V2": 1.0}),
        (False, {"friction_form": "regularized"}),
    ],
)
def test_which_laws_and_forms_have_recurrences(has, own):
    law = rs.SpringSlider(a=0.003, b=0.006, Dc=1e-5, sigma=2e6, K=9e8, **own).friction_law
    assert law.has_recurrences == has
    assert (len(R.rows_of(law).c[0]) > R.RODAS5P_TERMS) == has


# ------------------------------------------------------------------------------------- the answers


def relative(run, exact):
    """Largest error in tau/(a sigma), ln V and ln theta."""
    a_sigma = exact.attrs["a sigma"]
    off = [abs(run.tau - exact.tau) / a_sigma, abs(np.log(run.V / exact.V))]
    return max(float(one.max()) for one in off)


@pytest.mark.parametrize("law", WITH_RECURRENCES)
def test_taylor_steps_agree_with_rodas5p(law):
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
    constant = rs.Loading.constant
    stiff = [
        (1.02, slider, constant(1e-5), 40.0, 9e-6),
        (1.05, slider.replace(K=2e9), constant(0.1), 5.0, 0.09),
        (1.05, slider.replace(damping=1e7), constant(0.1), 5.0, 0.09),
        # of which the state relaxes a hundred times faster than it vibrates
        (1.1, slider.replace(M=1e7), constant(0.1), 5.0, 0.09),
        (1.02, slider, rs.Loading.steps(1e-3, (0.05, 0.0)), 1e5, 1e-3),
    ]
    harmonic = {1e-4: 0.7, 1e-8: 0.25, 1e-12: 0.07}[rtol], slider, constant(1e-2), 1.0, 9e-3
    for most, *arguments, V_start in [harmonic, *stiff]:
        run = functools.partial(rs.simulate, *arguments, V_start=V_start, rtol=rtol, times=[0.0])
        by_both, by_rodas5p = (int(run(method=one).steps) for one in ("auto", "rodas5p"))
        assert by_both < most * by_rodas5p, arguments


@pytest.mark.parametrize("seed", range(3))
def test_every_crossing_of_V_lp_within_a_step_is_found(seed):
    """V may rise above V_lp and fall below it again within a step, as it does in transients."""
    rng = np.random.default_rng(seed)
    a, b, Dc, sigma, V = 0.005, 0.0005, 1e-5, 1e6, 1e-5
    K, M = 25.0 * a * sigma / Dc, 0.02 * a * sigma * Dc / V**2
    slider = rs.SpringSlider(a=a, b=b, Dc=Dc, sigma=sigma, K=K, M=M, law="prz")
    loading = rs.Loading.constant(V)
    for k in range(12):
        loading = loading.ramp(1.0 + 2.2 * k, V * rng.uniform(0.2, 3.0), 2.0)
    run = functools.partial(rs.simulate, slider, loading, 30.0, V_start=0.9 * V)
    exact = run(times=np.linspace(0.0, 30.0, 60_001), rtol=1e-11)
    above = (exact.V_load <= exact.V).values
    returns = int((~above[:-1] & above[1:]).sum()) - 1
    assert returns > 8
    for method in ("auto", "rodas5p"):
        assert int(run(times=[30.0], rtol=1e-9, method=method).cycles) == returns
