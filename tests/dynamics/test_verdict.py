"""What a slider does, in numbers and in words."""

import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ratestate as rs
from ratestate.dynamics.basin import escape
from ratestate.dynamics.steady_sliding import stability
from ratestate.dynamics.verdict import verdict
from ratestate.model.quantities import POWERS, QUANTITIES, readable
from ratestate.model.units import to_si
from ratestate.paper.parameters import FIG1, FIG2, FIG4, FIG6

REGIMES = [
    (FIG4, 1e-5, "stick-slip", "Stick-slip, a cycle every 29.98 s"),
    (FIG4, 0.2, "quasi-harmonic", "Quasi-harmonic vibration at 442.7 Hz"),
    (FIG2, 3.2e-3, "quasi-harmonic", "Quasi-harmonic vibration at 50.59 Hz"),
    (FIG2, 3e-4, "steady", "Steady sliding at 300 um/s"),
    (FIG6, 2e-4, "slow stick-slip", "Slow stick-slip, a cycle every 337.5 ms"),
    (FIG2.replace(M=0.0, K=5e8), 3e-4, "runaway", "Runaway: without mass (M = 0) the slip"),
    (FIG2.replace(M=0.0, K=6e8), 3e-4, "runaway", "Runaway: without mass (M = 0), after a st"),
    (FIG2.replace(M=0.0), 3e-4, "conditionally stable", "Steady sliding at 300 um/s is stable aga"),
    (FIG2.replace(M=0.0, K=6.006e8, law="aging"), 3e-4, "steady", "Steady sliding at 300 um/s"),
    (FIG2.replace(M=0.0, K=6.0000012e8, law="aging"), 3e-4, "unknown", "Steady sliding at 300"),
    (FIG2.replace(M=0.0, K=5.99994e8, law="aging"), 3e-4, "unknown", "No definite cycle is rea"),
]


@pytest.mark.parametrize(("slider", "V_lp", "regime", "start"), REGIMES)
def test_regimes(slider, V_lp, regime, start):
    found = verdict(slider, V_lp)
    assert found.regime == regime
    assert found.sentences[0].startswith(start)
    assert found.text.count("\n") == len(found.sentences) - 1


def test_only_under_the_slip_law_is_a_step_called_safe():
    """Under the PRZ law a smaller one than its bound runs away."""
    slider = FIG2.replace(M=0.0, K=6.12e8)
    safe = "A step up by a factor of less than 2.02 never runs away"
    assert safe in verdict(slider, 3e-4).sentences[0]
    found = verdict(slider.replace(law="prz"), 3e-4)
    assert found.regime == "conditionally stable"
    assert "does not" not in found.sentences[0]
    assert escape(slider.replace(law="prz"), 3e-4).step_up < 1.4


@pytest.mark.parametrize(
    ("slider", "V_lp", "said"),
    [
        (FIG1, 1e-4, "The spring is rigid (K = inf)"),
        (FIG4, 5.0, ", and the vibration has 0.999 times the natural frequency of 493.1 Hz."),
        (FIG4, 20.0, ", and the vibration has the natural frequency of 493.1 Hz."),
        (FIG2.replace(b=0.002), 1e-3, "does not weaken with velocity (b <= a)"),
        (FIG2.replace(M=0.0, law="aging"), 3e-4, "steady sliding is stable at every speed."),
        (FIG2.replace(K=5e8), 1e-3, "unstable at every speed, because K < K_c_qs."),
        (FIG2, 3.1e-3, "stable at every speed below V_c = 3.162 mm/s."),
        (FIG2, 3.2e-3, "0.79 % below K_c = 907.2 MPa/m"),
        (FIG2.replace(M=0.0), 3e-4, "a finite time. A step up by a factor of less than 2.5 never"),
        (FIG2.replace(K=6e8), 1e-6, "unstable at every speed, because K <= K_c_qs."),
        (FIG2.replace(K=6e8), 1e-6, "inertia raises K_c by 5e-06 % of K_c_qs"),
        (FIG2.replace(K=6e8), 1e-6, "(largest Floquet multiplier 1 - 6.95e-07)"),
        (
            FIG2.replace(M=0.0, K=6e8, law="aging"),
            3e-4,
            "an oscillation about steady sliding hardly grows",
        ),
        (FIG2, 3e-4, "ringing at 5.72 Hz"),
        (FIG2, 3.2e-3, "in 77.3 cycles, 1.527 s (largest Floquet multiplier 0.9706)"),
        (FIG4, 1e-5, "inertia leaves K_c at K_c_qs = 1.2 GPa/m"),
        (FIG4, 0.2, "inertia raises K_c to 21 times K_c_qs"),
        (FIG4.replace(sigma="50 MPa", Dc="10 cm", M=1e7), 1e-9, "years)"),
    ],
)
def test_the_verdict_at_limiting_values(slider, V_lp, said):
    assert said in verdict(slider, V_lp).text


@pytest.mark.parametrize("V_lp", [1e-5, 3e-4, 2e-3])
def test_in_the_time_named_a_disturbance_falls_to_a_tenth(V_lp):
    said = re.search(r"falls to a tenth in ([\d.]+ \w+)[.,]", verdict(FIG2, V_lp).text)[1]
    growth_rate = float(stability(FIG2, V_lp).growth_rate)
    assert np.exp(growth_rate * to_si("t", said)) == pytest.approx(0.1, rel=2e-3)


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
    assert "The start decides" in on_the_way.text


def test_the_verdict_on_a_search_without_an_answer(monkeypatch):
    def fails(slider, V_lp):
        raise rs.NotConverged("limit_cycle stopped (no_convergence): chaos.\nSpringSlider(...)")

    monkeypatch.setattr("ratestate.dynamics.verdict.limit_cycle", fails)
    found = verdict(FIG2, 3.2e-3)
    assert found.regime == "unknown"
    assert found.period is None
    assert re.fullmatch(r"The attractor is not known: no limit cycle .{,90}\.", found.sentences[0])


def test_the_verdict_on_a_search_that_was_stopped():
    error = rs.SolverError("the search was ended after 1 s\nSpringSlider(...)")
    assert verdict(FIG2, 3.2e-3, error).sentences[0] == (
        "The attractor is not known: the search was ended after 1 s."
    )
    assert (
        verdict(FIG2, 1e-3, error)
        .sentences[0]
        .endswith("is not known: the search was ended after 1 s.")
    )


def test_a_cycle_of_another_kind_is_refused():
    sweep = rs.limit_cycle(FIG2, rs.linspace("V_lp", 1e-3, 2e-3, 2))
    for cycle in (3, sweep, rs.orbit(FIG2, 1e-3)):
        with pytest.raises(rs.ParameterError, match="Leave cycle out"):
            verdict(FIG2, 1e-3, cycle)


def test_the_verdict_at_K_c_is_neither_stable_nor_unstable():
    V_c = 3.1622776601683795e-3
    found = verdict(FIG2, V_c)
    assert found.sentences[1].startswith("K = 900 MPa/m is K_c to 8 digits, the edge of stability")
    assert not re.search("stable|fall|well", found.text)
    beside = (verdict(FIG2, V_c * (1 + side * 1e-7)) for side in (-1, 1))
    assert ["is stable" in one.text for one in beside] == [True, False]


@settings(max_examples=15, deadline=None)
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


# ------------------------------------------------------------- what is said, and what is simulated


def far_from(slider, V_lp, V_start, t_end):
    """Largest |ln(V/V_lp)| of a run towards its end; inf if it runs away."""
    times = np.linspace(0.9, 1.0, 200) * t_end
    constant = rs.Loading.constant(V_lp)
    try:
        run = rs.simulate(slider, constant, t_end, V_start=V_start, times=times, rtol=1e-7)
    except rs.QuasiStaticInstability:
        return np.inf
    return float(np.abs(np.log(run.V / V_lp)).max())


def last_cycle(slider, V_lp, t_end):
    """Amplitude of tau/sigma and period of the last cycle from a tenth of the speed on."""
    run = rs.simulate(slider, rs.Loading.constant(V_lp), t_end, V_start=V_lp / 10, times=[t_end])
    return float(run.amplitude), 1.0 / float(run.frequency)


def check_motion(found):
    """Simulate what the first sentence of a `Verdict` claims."""
    slider, V, said = found.slider, found.V_lp, found.sentences[0]
    pace = abs(found.growth_rate)
    if match := re.match(r"(?:Slow s|S)tick-slip, a cycle every ([^:(]+)", said):
        period = to_si("t", match[1].strip())
    elif match := re.match(r"Quasi-harmonic vibration at ([^:]+):", said):
        period = 1.0 / to_si("frequency", match[1])
    elif re.fullmatch(r"Steady sliding at [^ ]+ [^ ]+\.", said):
        assert far_from(slider, V, V / 10, 25.0 / pace) < 0.05
        return
    elif match := re.search(r"is stable against.*by a factor of less than (\S+) never", said):
        assert far_from(slider, V, V / 10, 25.0 / pace) == np.inf
        assert far_from(slider, V, 0.999 * V, 5.0 / pace) < 2e-4
        assert far_from(slider, V, 1.001 * V / float(match[1]), 25.0 / pace) < 0.05
        return
    elif said.startswith("Runaway: without mass (M = 0) the slip velocity grows"):
        assert far_from(slider, V, 0.999 * V, 60.0 / pace) == np.inf
        return
    else:
        grows = re.match(r"No definite cycle", said)
        assert grows or "is stable. Whether the motion returns" in said
        far = far_from(slider, V, 0.999 * V, 5.0 / pace)
        assert (far > 4e-3) if grows else (far < 2e-4)
        return
    swing = float(re.search(r"peak-to-peak tau/sigma ([^,]+),", said)[1])
    amplitude, lasts = last_cycle(slider, V, period * (20 + 3 * found.fade))
    assert amplitude == pytest.approx(swing, rel=2e-2)
    assert lasts == pytest.approx(period, rel=1e-2)


def check_stability(found):
    """Simulate a small disturbance of steady sliding, of which the second sentence tells."""
    far = far_from(found.slider, found.V_lp, 0.999 * found.V_lp, 5.0 / abs(found.growth_rate))
    claim = re.search(r"steady sliding is (stable|unstable)", found.sentences[1])[1]
    assert (far < 2e-4) if claim == "stable" else (far > 4e-3), claim


def sliders(number, seed=5):
    """Sliders on either side of K_c, law, b/a, K/K_c - 1 and eta; some of particular interest."""
    draw = np.random.default_rng(seed)
    for i in range(number):
        off = draw.choice([-0.9, 1.0]) * 10 ** draw.uniform(-2.0, 0.0)
        eta = 0.0 if i % 4 == 0 else 10 ** draw.uniform(-4.0, 2.0)
        yield ["slip", "aging"][i // 4 % 2], draw.uniform(1.1, 4.0), off, eta
    yield "aging", 2.0, 1e-3, 0.0125  # stable, and stick-slip from a tenth of the speed
    yield "slip", 2.0, 5e-3, 0.0  # stable, and a runaway from there
    yield "aging", 2.0, 1e-3, 0.0  # stable, and not settled
    yield "aging", 2.0, -1e-4, 0.0  # unstable, and not settled


def test_the_first_sentences_agree_with_simulations():
    a, Dc, sigma, V_lp = 0.004, 1e-5, 2e6, 1e-3
    seen = set()
    for law, ratio, off, eta in sliders(32):
        M = eta * a * sigma * Dc / V_lp**2
        K = (1.0 + off) * (ratio - 1.0) * a * sigma / Dc * (1.0 + eta)
        slider = rs.SpringSlider(a=a, b=ratio * a, Dc=Dc, sigma=sigma, K=K, M=M, law=law)
        found = verdict(slider, V_lp)
        check_motion(found)
        check_stability(found)
        seen.add((found.regime, found.stable))
    assert {"steady", "stick-slip", "slow stick-slip", "quasi-harmonic"} < {
        name for name, _ in seen
    }
    assert seen > {("runaway", False), ("conditionally stable", True), ("stick-slip", True)}
    assert seen > {("unknown", False)}


@given(st.sampled_from(sorted(QUANTITIES)), st.floats(1e-12, 1e12))
def test_readable_text_is_read_again(symbol, value):
    unit = QUANTITIES[symbol].unit
    text = readable(symbol, value, 17)
    assert to_si(symbol, text, bound="") == pytest.approx(value, rel=1e-14)
    number = float(text.split(" ")[0])
    if unit in ("m", "s", "m/s", "Hz") and 10.0 ** POWERS[unit][-1] <= value < 1e3:
        assert 0.999 <= number < 1001.0


@pytest.mark.parametrize(
    ("symbol", "value", "text"),
    [
        ("frequency", 2500.0, "2.5 kHz"),
        ("frequency", 2.5e-3, "2.5 mHz"),
        ("frequency", 2.5e-6, "2.5 uHz"),
        ("frequency", 2.5e-9, "0.0025 uHz"),
        ("frequency", 2.5e-10, "2.5e-10 Hz"),
        ("Dc", 2.5e-9, "2.5 nm"),
        ("V", 2.5e-9, "2.5 nm/s"),
        ("t", 2.5e-6, "2.5 us"),
        ("t", 2.5e-9, "0.0025 us"),
        ("sigma", 2.5e6, "2.5 MPa"),
        ("sigma", 2.5e3, "2.5 kPa"),
        ("K", 2.5e9, "2.5 GPa/m"),
        ("K", 2.5e12, "2500 GPa/m"),
    ],
)
def test_readable_text_has_the_prefix_that_fits(symbol, value, text):
    """Down to a thousandth of the smallest; below it none helps."""
    assert readable(symbol, value) == text


def test_readable_limits():
    assert readable("K", np.inf) == "inf Pa/m"
    assert readable("M", 0.0) == "0 kg/m^2"
    assert readable("V", 1e-3) == "1 mm/s"
    assert readable("a", 0.0031) == "0.0031"
