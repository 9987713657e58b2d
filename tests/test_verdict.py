"""What a slider does, in numbers and in words."""

import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ratestate as rs
from ratestate.cycles import limit_cycle
from ratestate.paper.parameters import FIG1, FIG2, FIG4, FIG6
from ratestate.quantities import POWERS, QUANTITIES, readable
from ratestate.steady import stability
from ratestate.units import to_si
from ratestate.verdict import verdict

REGIMES = [
    (FIG4, 1e-5, "stick-slip", "Stick-slip, a cycle every 29.98 s"),
    (FIG4, 0.2, "quasi-harmonic", "Quasi-harmonic vibration at 442.7 Hz"),
    (FIG2, 3.2e-3, "quasi-harmonic", "Quasi-harmonic vibration at 50.59 Hz"),
    (FIG2, 3e-4, "steady", "Steady sliding at 300 um/s"),
    (FIG6, 2e-4, "slow stick-slip", "Slow stick-slip, a cycle every 337.5 ms"),
    (FIG2.replace(M=0.0, K=5e8), 3e-4, "runaway", "Runaway: without mass (M = 0)"),
]


@pytest.mark.parametrize(("slider", "V_lp", "regime", "start"), REGIMES)
def test_regimes(slider, V_lp, regime, start):
    found = verdict(slider, V_lp)
    assert found.regime == regime
    assert found.sentences[0].startswith(start)
    assert found.text.count("\n") == len(found.sentences) - 1


def test_numbers_are_those_of_the_verbs():
    found = verdict(FIG2, "3.2 mm/s")
    steady, cycle = stability(FIG2, 3.2e-3), limit_cycle(FIG2, 3.2e-3)
    for name in ("K_c", "K_c_qs", "V_c", "eta", "f_n", "growth_rate", "omega"):
        assert getattr(found, name) == float(steady[name]), name
    for name in ("period", "frequency", "amplitude", "V_max", "V_min"):
        assert getattr(found, name) == float(cycle[name]), name
    assert found.multiplier == complex(cycle.multipliers[0])
    assert abs(found.multiplier) ** found.fade == pytest.approx(0.1, rel=1e-12)
    assert not found.stable


@pytest.mark.parametrize(
    ("slider", "V_lp", "said"),
    [
        (FIG1, 1e-4, "The spring is rigid (K = inf)"),
        (FIG2.replace(b=0.002), 1e-3, "does not weaken with velocity (b <= a)"),
        (FIG2.replace(M=0.0, law="aging"), 3e-4, "as it is at any speed without mass"),
        (FIG2.replace(K=5e8), 1e-3, "as it is at any speed where K < K_c_qs"),
        (FIG2, 3.1e-3, "as it is at any speed below V_c = 3.162 mm/s"),
        (FIG2, 3.2e-3, "0.79 % below K_c = 907.2 MPa/m"),
        (FIG2.replace(M=0.0), 3e-4, "from steady sliding at a tenth of the speed on"),
        (FIG2, 3e-4, "ringing at 5.72 Hz"),
        (FIG2, 3.2e-3, "in 77.3 cycles, 1.527 s (largest Floquet multiplier 0.9706)"),
        (FIG4, 1e-5, "inertia leaves K_c at K_c_qs = 1.2 GPa/m"),
        (FIG4, 0.2, "inertia raises K_c to 21 times K_c_qs"),
        (FIG4.replace(sigma="50 MPa", Dc="10 cm", M=1e7), 1e-9, "years)"),
    ],
)
def test_limits_have_words(slider, V_lp, said):
    assert said in verdict(slider, V_lp).text


def test_a_cycle_beside_stable_sliding():
    slider, V_lp = FIG2.replace(law="aging"), 5e-4
    K_c = slider.K_c(V_lp)
    K_fold = verdict(slider.replace(K=1.0001 * K_c), V_lp).K_fold
    assert 1.001 < K_fold / K_c < 1.02
    below = verdict(slider.replace(K=K_fold * (1 - 1e-4)), V_lp)
    beyond = verdict(slider.replace(K=K_fold * (1 + 1e-4)), V_lp)
    assert below.stable
    assert "well" in below.text
    assert beyond.regime == "steady"
    assert "well" not in beyond.text
    on_the_way = verdict(slider.replace(K=1.001 * K_c), V_lp)
    assert on_the_way.regime == "stick-slip"
    assert "the start decides" in on_the_way.text


def test_a_search_without_an_answer_is_told(monkeypatch):
    def fails(slider, V_lp):
        raise rs.NotConverged("limit_cycle stopped (no_convergence): chaos.\nSpringSlider(...)")

    monkeypatch.setattr("ratestate.verdict.limit_cycle", fails)
    found = verdict(FIG2, 3.2e-3)
    assert found.regime == "unknown"
    assert found.period is None
    assert found.sentences[0].endswith("limit_cycle stopped (no_convergence): chaos.")


def test_sweeps_are_refused():
    with pytest.raises(rs.ParameterError, match="one slider"):
        verdict(FIG2.replace(M=rs.logspace("M", 1.0, 2.0, 2)), 3e-4)


@settings(max_examples=30, deadline=None)
@given(
    a=st.floats(1e-4, 0.05),
    ratio=st.floats(0.5, 5.0),
    stiffness=st.floats(-2.0, 2.0),
    eta=st.floats(-12.0, 3.0),
    V_lp=st.floats(-12.0, 0.0),
    law=st.sampled_from(["slip", "aging"]),
)
def test_any_slider_gets_whole_sentences(a, ratio, stiffness, eta, V_lp, law):
    V = 10.0**V_lp
    scale = abs(ratio - 1.0) + 0.1
    K = 10.0**stiffness * a * scale * 1e6 / 1e-5
    M = 10.0**eta * a * 1e6 * 1e-5 / V**2
    slider = rs.SpringSlider(a=a, b=ratio * a, Dc=1e-5, sigma=1e6, K=K, M=M, law=law)
    found = verdict(slider, V)
    assert "nan" not in found.text
    assert all(re.match(r"[A-Zae].*\.$", sentence) for sentence in found.sentences)
    assert found.stable == (found.K_c < K)
    assert (found.period is None) == (found.multiplier is None)


@given(st.sampled_from(sorted(QUANTITIES)), st.floats(1e-12, 1e12))
def test_readable_text_is_read_again(symbol, value):
    unit = QUANTITIES[symbol].unit
    text = readable(symbol, value, 17)
    assert to_si(symbol, text, bound="") == pytest.approx(value, rel=1e-14)
    number = float(text.split(" ")[0])
    if unit in ("m", "s", "m/s", "Hz") and 10.0 ** POWERS[unit][-1] <= value < 1e3:
        assert 0.999 <= number < 1001.0


def test_readable_limits():
    assert readable("K", np.inf) == "inf Pa/m"
    assert readable("M", 0.0) == "0 kg/m^2"
    assert readable("V", 1e-3) == "1 mm/s"
    assert readable("a", 0.0031) == "0.0031"
