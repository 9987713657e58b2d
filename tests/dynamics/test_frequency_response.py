"""The response of steady sliding to small oscillations of speed and normal stress."""

import math

import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st
from textbook import Textbook, drawn

import ratestate as rs
from ratestate import files
from ratestate.dynamics.steady_sliding import TRANSFER
from ratestate.friction.laws import LAWS, one_length_laws

FIG2 = rs.SpringSlider(a=0.003, b=0.006, Dc=1e-5, sigma=2e6, M=3e3, K=9e8)
V = 1e-3


def stiff(law, rng):
    """Parameters of a slider that slides stably, with damping and alpha, and its speed."""
    parameters, V = drawn(law, rng)
    parameters |= {"alpha": rng.uniform(0.0, 0.5)}
    parameters["damping"] = rng.uniform(0.0, 1.0) * parameters["a"] * parameters["sigma"] / V
    slider = rs.SpringSlider(**parameters, law=law)
    size = parameters["b"] * parameters["sigma"] / parameters["Dc"]
    parameters["K"] = max(slider.K_c(V), 0.1 * size) * rng.uniform(1.3, 4.0)
    return parameters, V


def by_the_textbook(twin, V, frequency, given):
    """Amplitudes of (tau/sigma, ln V, mu), complex, of the textbook's equations, linearised.

    By central differences of what it says, so that no derivative of ours is used.
    """
    p, omega = twin.p, 2 * math.pi * frequency
    y = twin.steady(V)
    A, h = twin.jacobian(y, V), 1e-6
    force = np.zeros(len(y), complex)
    if given == "V_lp":
        force += (twin.rates(y, V * (1 + h)) - twin.rates(y, V * (1 - h))) / (2 * h * V)
    else:  # d ln s of an oscillation, and its rate
        for part, rate in ((1.0, 0.0), (0.0, omega)):
            ends = []
            for sign in (1, -1):
                s = 1 + sign * h * part, sign * h * rate
                p["s"] = lambda t, s=s: s
                ends.append(twin.rates(y, V))
            force += (1j if rate else 1.0) * (ends[0] - ends[1]) / (2 * h * p["sigma"])
        del p["s"]
    amplitudes = np.linalg.solve(1j * omega * np.eye(len(y)) - A, force)
    slopes = []
    for i in range(1, len(y)):
        up, down = y.copy(), y.copy()
        up[i] += h
        down[i] -= h
        of = [twin.mu(math.exp(z[1]), [math.exp(x) for x in z[2:]]) for z in (up, down)]
        slopes.append((of[0] - of[1]) / (2 * h))
    return amplitudes[0], amplitudes[1], np.dot(slopes, amplitudes[1:])


@pytest.mark.parametrize("law", LAWS)
def test_the_response_equals_the_textbooks(law):
    """In SI, in tau, V and theta, linearised by differences."""
    rng = np.random.default_rng(3)
    for _ in range(5):
        parameters, V = stiff(law, rng)
        slider, twin = rs.SpringSlider(**parameters, law=law), Textbook(law, parameters)
        near = V / parameters["Dc"] / (2 * math.pi)
        frequencies = near * 10 ** np.array([-1.5, -0.3, 0.0, 0.4, 1.5])
        found = rs.frequency_response(slider, V, frequencies)
        for k, f in enumerate(frequencies):
            for name in ("V_lp", "sigma"):
                tau, lnV, mu = by_the_textbook(twin, V, f, name)
                expected = {"tau": parameters["sigma"] * tau, "V": V * lnV, "mu": mu}
                size = {"tau": parameters["sigma"], "V": V / parameters["a"], "mu": 1.0}
                per = V / parameters["a"] if name == "V_lp" else parameters["sigma"]
                for out, value in expected.items():
                    ours = complex(found[f"{out}_by_{name}"][k])
                    near_0 = 1e-7 * size[out] / per
                    assert abs(ours - value) < 1e-5 * abs(value) + near_0, (out, name, f)


@given(seed=st.integers(0, 10**6))
def test_without_mass_in_closed_form(seed):
    """That of Perfettini et al. (2001), and of a slider that its load point takes along."""
    rng = np.random.default_rng(seed)
    law = rng.choice(sorted(one_length_laws()))
    p, V = stiff(law, rng)
    p |= {"M": 0.0, "damping": 0.0}
    p["K"] = rng.uniform(1.2, 3.0) * (p["b"] - p["a"]) * p["sigma"] / p["Dc"]
    a, b, alpha, sigma = p["a"], p["b"], p["alpha"], p["sigma"]
    mu = p["mu0"] + (a - b) * math.log(V / p["V0"])
    frequency = V / p["Dc"] * 10 ** rng.uniform(-2, 1)
    S, k = 2j * math.pi * frequency * p["Dc"] / V, p["K"] * p["Dc"] / sigma
    whole = a * S**2 + (k + a - b) * S + k
    found = rs.frequency_response(rs.SpringSlider(**p, law=law), V, frequency)
    V_by_sigma = -V / sigma * S * (mu * (1 + S) - alpha * S) / whole
    assert complex(found.V_by_sigma) == pytest.approx(V_by_sigma, rel=1e-9)
    assert complex(found.V_by_V_lp) == pytest.approx(k * (1 + S) / whole, rel=1e-9)
    assert complex(found.tau_by_sigma) == pytest.approx(-k / S * V_by_sigma * sigma / V, rel=1e-9)
    rigid = rs.frequency_response(rs.SpringSlider(**p | {"K": math.inf}, law=law), V, frequency)
    assert complex(rigid.V_by_V_lp) == 1.0
    assert complex(rigid.V_by_sigma) == 0.0
    impedance = sigma * (a - b / (1 + S)) / V
    assert complex(rigid.tau_by_V_lp) == pytest.approx(
        impedance, rel=1e-9, abs=1e-9 * a * sigma / V
    )
    assert complex(rigid.tau_by_sigma) == pytest.approx(mu - alpha * S / (1 + S), rel=1e-9)


def test_a_slider_near_a_hopf_bifurcation_resonates():
    K_c, hopf = FIG2.K_c(V), rs.hopf(FIG2, V)
    for above, quality in ((1e-2, 1e2), (1e-4, 1e4)):
        slider = FIG2.replace(K=K_c * (1 + above))
        found = rs.frequency_response(
            slider, V, float(hopf.frequency) * np.linspace(0.9, 1.1, 2001)
        )
        assert float(found.resonance) == pytest.approx(float(hopf.frequency), rel=above)
        assert 0.3 * quality < float(found.quality) < 10 * quality
        peak = float(found.frequency[np.argmax(found.V_by_V_lp_gain.values)])
        assert peak == pytest.approx(float(found.resonance), rel=2e-4 + above**2)
        # half the power at half a bandwidth f/quality to either side
        width = float(found.resonance) / float(found.quality)
        if above == 1e-2:
            both = rs.frequency_response(
                slider, V, [peak, peak - width / 2, peak + width / 2]
            ).V_by_V_lp_gain
            np.testing.assert_allclose(both[1:] / both[0], math.sqrt(0.5), rtol=0.02)


def test_a_slider_that_does_not_oscillate_has_no_resonance():
    found = rs.frequency_response(FIG2.replace(K=1e12, M=0.0), V, 1.0)
    assert np.isnan(float(found.resonance))
    assert np.isnan(float(found.quality))
    slow = rs.frequency_response(FIG2, V, 1e-6)
    mu = 0.6 - 0.003 * math.log(1e3)
    assert complex(slow.tau_by_sigma) == pytest.approx(mu, rel=1e-5)
    assert complex(slow.V_by_V_lp) == pytest.approx(1.0, rel=1e-5)
    assert complex(slow.tau_by_V_lp) == pytest.approx(-0.003 * 2e6 / V, rel=1e-4)


@pytest.mark.parametrize("law", [{}, {"law": "nagata", "c": 0.0}])
def test_a_slider_whose_state_has_no_effect(law):
    """b = 0: a mass on a spring and a viscous stress a sigma/V, whatever the state does."""
    slider = FIG2.replace(b=0.0, **law)
    found = rs.frequency_response(slider, V, 40.0)
    omega = 80.0 * math.pi
    impedance = 1j * omega * 3e3 + 0.003 * 2e6 / V + 9e8 / (1j * omega)
    mu = 0.6 + 0.003 * math.log(1e3)
    assert complex(found.V_by_sigma) == pytest.approx(-mu / impedance, rel=1e-12)
    assert complex(found.V_by_V_lp) == pytest.approx(9e8 / (1j * omega) / impedance, rel=1e-12)


def test_gain_and_phase_sweeps_and_files(tmp_path):
    slider = FIG2.replace(K=xr.DataArray([5e8, 7e8, 9e8], dims="K"), alpha=0.2)
    found = rs.frequency_response(slider, V, ["1 Hz", "10 Hz", 100.0, 500.0])
    assert dict(found.tau_by_sigma.sizes) == {"K": 3, "frequency": 4}
    assert found.stable.values.tolist() == [False, True, True]
    for name in TRANSFER:
        assert np.isnan(found[name][0]).all()
        one = found[name][1:]
        assert np.isfinite(one).all()
        gain, phase = found[f"{name}_gain"][1:], found[f"{name}_phase"][1:]
        np.testing.assert_allclose(gain * np.exp(1j * phase), one, rtol=1e-13)
        assert gain.units == one.units
        assert phase.units == "rad"
    alone = rs.frequency_response(slider.replace(K=9e8), "1 mm/s", "10 Hz")
    assert complex(alone.mu_by_sigma) == complex(found.mu_by_sigma[2, 1])
    again = files.read(files.write(found, tmp_path / "response.nc"))
    xr.testing.assert_identical(again.load(), found)


def test_usual_frequencies():
    """Decades around V/(2 pi Dc), 16 Hz, f_n, 87 Hz, and the resonance, between them."""
    found = rs.frequency_response(FIG2, V)
    assert found.frequency.values[[0, 60, -1]].tolist() == [1.0, 10.0, 1000.0]
    assert found.sizes == {"frequency": 181}
    rigid = FIG2.replace(K=math.inf, M=xr.DataArray([0.0, 3e3], dims="M"))
    alone = rs.frequency_response(rigid, V)  # no frequency but the first
    assert alone.frequency.values[[0, -1]].tolist() == [1.0, 1000.0]
    slow = rs.frequency_response(FIG2, xr.DataArray([V, 1e-9], dims="V_lp"))
    assert slow.frequency.values[[0, -1]].tolist() == [1e-6, 1000.0]


def test_alpha_changes_the_response_and_is_kept_in_copies():
    slider = FIG2.replace(alpha=0.2)
    assert (slider.alpha, slider.values["alpha"], FIG2.alpha) == (0.2, 0.2, 0.0)
    assert "alpha" not in FIG2.values
    assert rs.SpringSlider(**slider.parameters) == slider != FIG2
    fast = [complex(rs.frequency_response(s, V, 1e9).tau_by_sigma) for s in (slider, FIG2)]
    rigid = [one.replace(K=math.inf, M=0.0) for one in (slider, FIG2)]
    mu = 0.6 - 0.003 * math.log(1e3)
    sudden = [complex(rs.frequency_response(s, V, 1e9).tau_by_sigma).real for s in rigid]
    np.testing.assert_allclose(sudden, [mu - 0.2, mu], rtol=1e-6)
    assert abs(fast[0]) < 1e-3  # the mass does not follow
    with pytest.raises(rs.ParameterError, match=r"alpha = -0.1 must be >= 0"):
        FIG2.replace(alpha=-0.1)
    with pytest.raises(rs.ParameterError, match=r"alpha cannot be used with b = 0"):
        FIG2.replace(alpha=0.1, b=0.0)


def test_cases_without_a_response_are_refused():
    with pytest.raises(rs.ParameterError, match=r"steady sliding at V_lp = 3.3 mm/s is unstable"):
        rs.frequency_response(FIG2, "3.3 mm/s", 10.0)
    for frequency, text in (
        ([10.0, -1.0], r"frequency = -1 Hz must be > 0"),
        ("10 s", r"frequency = '10 s' is a time"),
        ([], r"frequency = \[\] is of type list"),
        (0.0, r"frequency = 0 Hz must be > 0"),
    ):
        with pytest.raises(rs.ParameterError, match=text):
            rs.frequency_response(FIG2, V, frequency)
    with pytest.raises(rs.ParameterError, match="is not a SpringSlider"):
        rs.frequency_response(None, V, 1.0)
    clash = xr.DataArray([1.0, 2.0], dims="resonance")
    with pytest.raises(rs.ParameterError, match="the dimension 'resonance' clashes"):
        rs.frequency_response(FIG2, V, clash)
