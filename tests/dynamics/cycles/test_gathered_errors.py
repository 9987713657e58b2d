"""Errors of cycles where those of steps add up: extreme speeds, and stress where b/a is near 1."""

import numpy as np
import pytest
import xarray as xr

import ratestate as rs

NAMES = ("amplitude", "period", "V_max", "V_min")
ERRORS = ("error", "error", "V_max_error", "V_min_error")
SI = {"a": 0.005, "Dc": 1e-5, "sigma": 4e6}
V_LP = 1e-3
CUT_OFF = {"a": 0.015979, "b": 0.020508, "Dc": 7.8232e-5, "sigma": 130500.0, "M": 2.6335e7}
CUT_OFF |= {"K": 1247800.0, "mu0": 0.31187, "V0": 2.2406e-6, "V1": 1.5967e-5, "V2": 1.7066e-4}
# Law, rtol; b, K, M [SI]; amplitude, period [s], V_max and V_min [m/s].  By benchmarks/truth.py:
# Radau IIA collocation of 9 stages in 80-bit floating point; two tolerances agree to 2e-13.
CYCLES = {
    "large inertia": (
        ("aging", 1e-8, 0.06067538123503493, 77818055555899.9, 1545436507.9993088),
        (173.4043808730905, 0.02800413079251782, 1.999922867451156e-3, 7.302409538360132e-8),
    ),
    "large inertia, soft": (
        ("slip", 1e-6, 0.010366909949315587, 8874031401.467539, 182904765.09564522),
        (0.6511516940615861, 0.9054721123252169, 2.021757109739085e-3, 2.446310522531949e-12),
    ),
    "errors that cancel": (
        ("slip", 1e-10, 0.0775687188934421, 40020918240.75849, 14407222.337745946),
        (0.4945309587649809, 0.1316124042335927, 2.254484371536997e-3, 1.579982745725368e-23),
    ),
    "160 decades": (
        ("slip", 1e-8, 0.1672929349094968, 524533441931.9077, 556552159.8477865),
        (8.955774169628374, 0.2064543157936984, 2.045634340323947e-3, 5.392709997200693e-162),
    ),
    "b/a near 1": (
        ("slip", 1e-6, 0.005053068972813744, 18562135.505279742, 2.0492695003669756),
        (3.865300877082361e-3, 1.066280163904734, 0.6937040478383021, 8.755219030708431e-5),
    ),
    "b/a near 1, aging law": (
        ("aging", 1e-6, 0.005057492791681653, 6037159.067994741, 100.2146133112014),
        (7.703222409099773e-3, 5.296841735201627, 0.6086001068238093, 8.517842309736291e-6),
    ),
    "b/a near 1, as fine as rounding allows": (
        ("slip", 1e-10, 0.005060152979846565, 2392410980.645022, 55584477.069825985),
        (0.1130156965564848, 0.9601358069526656, 1.619244467794275e-3, 3.83680522573568e-4),
    ),
}


@pytest.mark.parametrize("name", CYCLES)
def test_errors_bound_true_errors_and_not_by_far(name):
    (law, rtol, b, K, M), exact = CYCLES[name]
    cycle = rs.limit_cycle(rs.SpringSlider(**SI, b=b, K=K, M=M, law=law), V_LP, rtol=rtol)
    for variable, error, value in zip(NAMES, ERRORS, exact, strict=True):
        assert abs(cycle[variable] / value - 1) <= cycle[error]
    off = abs(cycle.V_min / exact[-1] - 1)
    assert cycle.V_min_error < 3000 * off  # (the Taylor method leaves less than is estimated)
    assert cycle.error < rtol


def two_state_K_c(*, a, b, b2, Dc, Dc2, sigma, M, V):
    """K_c [Pa/m] under a law of two states, in 64 bits of mantissa: by its quadratic in omega^2."""
    a, b, b2, Dc, Dc2, sigma, M, V = map(np.longdouble, (a, b, b2, Dc, Dc2, sigma, M, V))
    r, s = np.array([b / a, b2 / a]), np.array([1.0, Dc / Dc2])
    half = 0.5 * ((1.0 - r) * s**2).sum()
    z = np.sqrt(half**2 - s.prod() ** 2 * (1.0 - r.sum())) - half
    kappa = z * (M * V**2 / (a * sigma * Dc) + (r * s / (z + s**2)).sum())
    return kappa * a * sigma / Dc


@pytest.mark.parametrize(
    ("V", "values"),
    [
        (3.302e-7, (0.002992, 0.01365, 0.0006556, 2.69e-5, 3.295e-5, 14510000.0, 4.07e12)),
        (0.05313, (0.003927, 0.0103, -0.001168, 3.993e-7, 9.578e-6, 430500.0, 0.2229)),
    ],
)
def test_errors_beside_the_hopf_point_of_two_states(V, values):
    """Within 1e-8 of it rounding of V/V_lp limits amplitudes, which the normal form gives."""
    given = dict(zip(("a", "b", "b2", "Dc", "Dc2", "sigma", "M"), values, strict=True))
    K_c = two_state_K_c(**given, V=V)
    below = np.geomspace(3e-10, 3e-8, 8)
    K = xr.DataArray((K_c * (1.0 - below)).astype(float), dims="K")
    slider = rs.SpringSlider(law="two-state-aging", **given, K=K)
    cycles = rs.limit_cycle(slider, V)
    found = (cycles.status == 0).values
    assert found[below > 1e-8].all()
    coefficient = float(rs.hopf(slider.replace(K=float(K_c)), V).amplitude_coefficient)
    true = coefficient * np.sqrt((1.0 - K.values / K_c).astype(float))
    off, error = np.abs(cycles.amplitude.values / true - 1.0)[found], cycles.error.values[found]
    assert (off <= error).all()
    assert np.median(error / off) < 500.0


# Regularized friction: law, V [m/s]; a, b, mu0, V0 [m/s], Dc [m], sigma [Pa], M [kg/m^2].
REGULARIZED = [
    ("slip", 2.02206e-6, (0.018353, 0.076643, 0.41753, 4.1173e-8, 5.7225e-7, 101145.0, 968189.0)),
    ("aging", 7.9509e-7, (0.0052647, 0.046097, 0.65844, 3.6457e-8, 4.2286e-6, 520574.0, 2.1744e10)),
]


def regularized_K_c(*, a, b, mu0, V0, Dc, sigma, M, V):
    """K_c [Pa/m] under regularized friction, in 64 bits of mantissa."""
    a, b, mu0, V0, Dc, sigma, M, V = map(np.longdouble, (a, b, mu0, V0, Dc, sigma, M, V))
    friction = np.arcsinh(0.5 * V / V0 * np.exp((mu0 + b * np.log(V0 / V)) / a))
    return (b - a) * sigma / Dc * (np.tanh(friction) + M * V**2 / (a * sigma * Dc))


@pytest.mark.parametrize(("law", "V", "values"), REGULARIZED)
def test_errors_beside_the_hopf_point_of_regularized_friction(law, V, values):
    """Each step rounds mu/a, 10 and 125 here, and the weak attraction of the cycle amplifies that.

    The normal form gives amplitudes; the last cycle, far from K_c, gives the next term of it.
    """
    given = dict(zip(("a", "b", "mu0", "V0", "Dc", "sigma", "M"), values, strict=True))
    K_c = regularized_K_c(**given, V=V)
    below = np.append(np.geomspace(5e-8, 1e-6, 12), 1e-4)
    K = xr.DataArray((K_c * (1.0 - below)).astype(float), dims="K")
    slider = rs.SpringSlider(law=law, friction_form="regularized", **given, K=K)
    cycles = rs.limit_cycle(slider, V)
    coefficient = float(rs.hopf(slider.replace(K=float(K_c)), V).amplitude_coefficient)
    distance = (1.0 - K.values / K_c).astype(float)
    ratio = cycles.amplitude.values / (coefficient * np.sqrt(distance))
    off = np.abs(ratio - 1.0 - (ratio[-1] - 1.0) * distance / distance[-1])[:-1]
    found, error = (cycles.status.values == 0)[:-1], cycles.error.values[:-1]
    assert found.sum() >= 7
    assert (off <= error)[found].all()
    assert np.median((error / off)[found]) < 50.0


def test_multipliers_are_as_accurate_as_stated():
    """With cut-offs the orbit is known far better than its derivative."""
    slider = rs.SpringSlider(law="aging", friction_form="cut-off", **CUT_OFF)
    cycle, exact = (rs.limit_cycle(slider, 6.0797e-7, rtol=rtol) for rtol in (1e-6, 1e-12))
    off = np.abs(cycle.multipliers - exact.multipliers)
    assert (off <= cycle.multipliers_error + exact.multipliers_error).all()
    assert cycle.multipliers_error.max() < 1e-5
    assert exact.multipliers_error.max() < 1e-10


@pytest.mark.parametrize("below", [1e-9, 1e-7, 1e-5, 1e-4])
def test_multipliers_of_small_cycles(below):
    """Against that of the return map, which resolves it where the cycle is not the smallest."""
    slider = rs.SpringSlider(a=0.005, b=0.0135, Dc=1e-5, sigma=4e6, M=1.36e4, K=1.0)
    slider = slider.replace(K=slider.K_c(V_LP) * (1.0 - below))
    cycle = rs.limit_cycle(slider, V_LP)
    growth = float(rs.stability(slider, V_LP).growth_rate)
    leading = -2.0 * growth * float(cycle.period)
    left = float(cycle.multipliers[0].real) - 1.0
    assert left == pytest.approx(leading, rel=1e3 * below + 1e-4)
    assert cycle.multipliers_error[0] < min(1e-8, 1e-2 * abs(left))
