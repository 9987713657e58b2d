"""The model in fits, compared with independent codes."""

import naive
import numpy as np
import pytest
from scipy.linalg import cholesky, solve_triangular
from synthetic_records import SLIDER, STEP, correlated, power_law, record

from ratestate.paper.figures import LAWS
from ratestate.records.fitting.forward import Forward
from ratestate.records.fitting.problem import samples_of
from ratestate.records.kit.noise import (
    Noise,
    RestrictedLikelihood,
    estimated_noise,
    families,
    modes,
)

T = np.concatenate([np.linspace(0.0, 99.0, 34), np.linspace(100.05, 104.0, 80)])
MASSES = {"none": 0.0, "inertial": 3e11}


def forward(names, *, law="slip", M=0.0, loading=STEP, kind="friction", trend="slip"):
    data = record(SLIDER, loading, T).rename(friction=kind)
    seen = samples_of(data, SLIDER, loading=loading, trend=trend, against="time")
    return Forward(seen, SLIDER.replace(M=M, law=law), names)


def by_scipy(t, *, V_start=1e-6, theta_start=None, level=0.6, trend=0.0, law="slip", **changes):
    """Return friction of the spring at times t by SciPy, for changed parameters."""
    case = {s: getattr(SLIDER, s) for s in ("a", "b", "Dc", "sigma", "K", "M", "mu0", "V0")}
    slider = naive.Naive(**(case | {"mu0": level} | changes), law=law)
    theta = slider.Dc / 1e-6 if theta_start is None else theta_start
    y = np.array([slider.mu(V_start, theta), np.log(V_start), np.log(theta)])
    settings = {"dense": True, "method": "DOP853"}  # none of these is stiff
    early = slider.solve(y[[0, 2]] if slider.M == 0 else y, 0.0, 100.0, 1e-6, **settings)
    late = slider.solve(early.y[:, -1], 100.0, t[-1] + 1e-9, 1e-5, **settings)
    found = np.where(t < 100.0, early.sol(np.minimum(t, 100.0))[0], late.sol(np.maximum(t, 100))[0])
    advance = np.where(t < 100.0, 1e-6 * t, 1e-4 + 1e-5 * (t - 100.0))
    slip = advance - (found - found[0]) * slider.sigma / slider.K
    return found + trend * slip


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("M", MASSES.values(), ids=MASSES)
def test_friction_and_its_sensitivities_agree_with_scipy(law, M):
    """Derivatives are differences of SciPy at 1e-12, with other steps."""
    start = ("V_start", "theta_start")
    names = ("a", "b", "Dc", "K", *(("M",) if M else ()), *start, "level", "trend")
    values = {"V_start": 0.3, "theta_start": -0.2, "b": 0.014, "level": 0.6, "trend": 2.0}
    values |= {"a": np.log(0.01), "Dc": np.log(1e-5), "K": np.log(6.4e10), "M": np.log(M or 1.0)}
    point = np.array([values[name] for name in names])

    def there(point):
        given = dict(zip(names, point, strict=True))
        changes = {n: np.exp(given[n]) for n in ("a", "Dc", "K", "M") if n in given}
        changes |= {n: given[n] for n in ("b", "level", "trend")}
        theta = changes["Dc"] / 1e-6 * np.exp(given["theta_start"])
        V = 1e-6 * np.exp(given["V_start"])
        return by_scipy(T, V_start=V, theta_start=theta, law=law, **changes)

    model = forward(names, law=law, M=M)
    friction, jacobian = model.jacobian(point)
    np.testing.assert_allclose(friction, there(point), rtol=0, atol=3e-9)
    for i, name in enumerate(names):
        step = 1e-5 if name == "b" else 1e-2 if name in ("level", "trend") else 7e-4
        ahead, back = point.copy(), point.copy()
        ahead[i] += step
        back[i] -= step
        expected = (there(ahead) - there(back)) / (2 * step)
        scale = np.abs(expected).max()
        assert scale > 0.0, name
        np.testing.assert_allclose(jacobian[:, i], expected, rtol=0, atol=2e-5 * scale)


def test_a_lag_is_the_same_motion_later():
    names = ("lag", "level", "trend")
    model = forward(names)
    now, later = model.friction(np.array([[0.0, 0.6, 0.0], [0.7, 0.6, 0.0]]))
    np.testing.assert_allclose(now, by_scipy(T), rtol=0, atol=3e-9)
    np.testing.assert_allclose(later, by_scipy(np.maximum(T - 0.7, 0.0)), rtol=0, atol=3e-9)
    # about the sample nearest to the step the friction has a kink
    _, jacobian = model.jacobian(np.array([0.35, 0.6, 0.0]))
    h = 1e-4
    differ = by_scipy(np.maximum(T - 0.35 - h, 0)) - by_scipy(np.maximum(T - 0.35 + h, 0))
    np.testing.assert_allclose(jacobian[:, 0], differ / (2 * h), rtol=0, atol=3e-5)


def test_a_slider_that_runs_away_gives_nan():
    """Below K_c no motion exists without inertia; neighbours in lanes are unaffected."""
    model = forward(("K", "V_start", "level"), trend=None)
    points = np.array([[np.log(6.4e10), 0.0, 0.6], [np.log(1e9), 1.0, 0.6]])[[0, 1, 0]]
    sound, lost, again = model.friction(points)
    assert np.isnan(lost).all()
    np.testing.assert_array_equal(sound, again)
    np.testing.assert_allclose(sound, by_scipy(T), rtol=0, atol=3e-9)


def times(n, rng):
    """Return times as of a data logger: two rates and a gap."""
    dt = np.where(np.arange(n - 1) < n // 3, 1.0, 0.1) * rng.uniform(0.8, 1.2, n - 1)
    dt[n // 2] = 20.0
    return np.concatenate([[0.0], np.cumsum(dt)])


@pytest.mark.parametrize(
    "noise",
    [
        *(Noise(white=0.3, red=2.0, time=time) for time in (0.01, 0.5, 300.0)),
        *(Noise(white=0.1, red=2.0, time=30.0, exponent=exponent) for exponent in (0.6, 1.0, 1.9)),
    ],
)
def test_whitening_agrees_with_the_dense_covariance(noise):
    rng = np.random.default_rng(1)
    t = times(200, rng)
    columns = rng.normal(size=(200, 3))
    variances, relaxations = noise.relaxations(float(np.median(np.diff(t))))
    assert variances.sum() == pytest.approx(4.0)
    if noise.exponent:  # about one relaxation a decade, with weights of time^(exponent - 1)
        assert relaxations.size == 3
        weights = (relaxations / 30.0) ** (noise.exponent - 1.0)
        np.testing.assert_allclose(variances / variances[0], weights)
    covariance = noise.white**2 * np.eye(200)
    for variance, time in zip(variances, relaxations, strict=True):
        covariance += variance * np.exp(-np.abs(t[:, None] - t) / time)
    lower = cholesky(covariance, lower=True)
    white, log_determinant = noise.whiten(t, columns)
    np.testing.assert_allclose(white, solve_triangular(lower, columns, lower=True), atol=1e-9)
    assert log_determinant == pytest.approx(2 * np.log(np.diag(lower)).sum(), abs=1e-8)


@pytest.mark.parametrize(("exponent", "within"), [(0.7, 0.12), (1.0, 0.15), (1.5, 0.3)])
def test_the_exponent_of_noise_is_found(exponent, within):
    """A filter in frequency makes the noise, up to half the sampling rate."""
    rng, t = np.random.default_rng(6), np.arange(2000.0)
    residual = power_law(2000, exponent, rng)
    found, _ = estimated_noise(RestrictedLikelihood(t, residual, np.ones((2000, 1))))
    assert abs(found.exponent - exponent) < within


def restricted_likelihood(t, y, X, share, time):
    """Return ln of it at the best variance, from the dense covariance."""
    correlation = (1 - share) * np.eye(t.size) + share * np.exp(-np.abs(t[:, None] - t) / time)
    white = np.linalg.solve(np.linalg.cholesky(correlation), np.column_stack([y, X]))
    y, X = white[:, 0], white[:, 1:]
    left = y - X @ np.linalg.lstsq(X, y, rcond=None)[0]
    freedom = t.size - X.shape[1]
    determinants = np.linalg.slogdet(correlation)[1] + np.linalg.slogdet(X.T @ X)[1]
    return -0.5 * (freedom * np.log(left @ left / freedom) + determinants)


@pytest.mark.parametrize("time", [0.3, 2.0])
def test_the_estimated_noise_is_the_likeliest(time):
    """Neither the true noise of 5 records nor noise near the estimate is likelier."""
    rng = np.random.default_rng(7)
    t = times(300, rng)
    X = np.stack([np.cos(k * np.pi * t / t[-1]) for k in range(6)], axis=1)
    for _ in range(5):
        y = 1e-4 * rng.normal(size=t.size) + 3e-4 * correlated(t, time, rng)
        likelihood = RestrictedLikelihood(t, y, X)
        family = families(likelihood)[0]
        highest, point = max(modes(family), key=lambda one: one[0])
        chosen = likelihood.at(estimated_noise(likelihood)[0]).log_likelihood
        assert chosen >= highest - 1e-6  # by a power law perhaps
        found = family.at(point).noise
        share = found.red**2 / found.level**2
        best = restricted_likelihood(t, y, X, share, found.time)
        others = [(0.9, time), (share, 0.8 * found.time), (share, 1.25 * found.time)]
        others += [(share**1.2, found.time), (share**0.8, found.time)]
        for other in others:
            assert restricted_likelihood(t, y, X, *other) < best + 0.01, other


@pytest.mark.parametrize(("seed", "counts"), [(1, False), (2, True)])
def test_correlated_noise_needs_a_rise_of_the_likelihood(seed, counts):
    """ln(likelihood) must rise by 3; here it rises by 1.6 and by 5.8."""
    rng, t = np.random.default_rng(seed), np.arange(300.0)
    slow = np.linalg.cholesky(np.exp(-np.abs(t[:, None] - t) / 5.0))
    y, X = rng.normal(size=300) + 0.45 * slow @ rng.normal(size=300), np.ones((300, 1))
    found = estimated_noise(RestrictedLikelihood(t, y, X))[0]
    assert (found.red > 0.0) == counts
    plain = restricted_likelihood(t, y, X, 0.0, 1.0)
    shapes = [
        (share, time) for share in (0.03, 0.1, 0.3, 0.5) for time in (1.0, 3.0, 10.0, 30.0, 100.0)
    ]
    rise = max(restricted_likelihood(t, y, X, *shape) for shape in shapes) - plain
    assert (4.0 < rise < 6.0) if counts else (1.5 < rise < 2.9)


def test_white_noise_is_called_white():
    rng = np.random.default_rng(3)
    t = times(500, rng)
    fitted = np.stack([np.ones_like(t), t], axis=1)
    found = [
        estimated_noise(RestrictedLikelihood(t, 2e-4 * rng.normal(size=t.size), fitted))[0]
        for _ in range(40)
    ]
    assert sum(noise.red > 0.0 for noise in found) <= 2
    assert np.mean([noise.level for noise in found]) == pytest.approx(2e-4, rel=0.02)
