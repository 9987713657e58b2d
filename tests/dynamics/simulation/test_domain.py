"""Where the friction law leaves its domain: extremes of friction, their flags, and what is told."""

import functools
import math

import numpy as np
import pytest
import xarray as xr

import ratestate as rs
from ratestate.dynamics.cycles.limit_cycle import orbit
from ratestate.dynamics.verdict import verdict
from ratestate.errors import RunWarning
from ratestate.formulas import friction
from ratestate.paper.parameters import FIG4, FIG4_K

LAWS = pytest.mark.parametrize("law", ["slip", "aging"])
SLIDER = FIG4.replace(K=FIG4_K[0])
# weakens so much that mu < 0 beyond 1e-9 exp(0.6/0.0333) = 0.067 m/s
WEAK = rs.SpringSlider(a=0.003, b=0.0363, Dc=1e-5, sigma=2e6, K=2e9, M=3000, mu0=0.6, V0=1e-9)


def names(found):
    """Flags of `outside_domain` in words."""
    flags = found.outside_domain
    words = flags.attrs["flag_meanings"].split()
    codes = flags.attrs["flag_values"].tolist()
    return [words[codes.index(x)] for x in np.ravel(flags.values).tolist()]


@functools.cache
def cycles(law):
    V_lp = xr.DataArray([1e-2, 10.0, 30.0, 100.0], dims="V_lp")
    return rs.limit_cycle(SLIDER.replace(law=law), V_lp)


def sampled(slider, run):
    """Smallest mu and tau/sigma + mu of what a run saved."""
    return float(run.mu.min()), float((run.tau / slider.sigma + run.mu).min())


def lowest_at(slider, run):
    """The steps of a run at which mu, and tau/sigma + mu, are smallest."""
    return int(run.mu.argmin("time")), int((run.tau / slider.sigma + run.mu).argmin("time"))


@LAWS
def test_extremes_of_friction_in_cycles(law):
    """At 10 m/s (the inset of Fig. 5) the spring pulls back, but less than friction can hold."""
    found = cycles(law)
    assert names(found) == ["inside", "inside", "spring_reverses", "spring_reverses"]
    assert 0 < found.reversal_margin.sel(V_lp=10.0) < 0.3
    slider = SLIDER.replace(law=law)
    for V_lp in (1e-2, 10.0, 30.0):
        turn, cycle = orbit(slider, V_lp), found.sel(V_lp=V_lp)
        start = {name: float(turn[name][0]) for name in ("V", "theta", "tau")}
        end, short = float(turn.time[-1]), {"rtol": 1e-8, "method": "rodas5p"}
        path = rs.simulate(slider, rs.Loading.constant(V_lp), end, initial=start, **short)
        for name, i in zip(("mu_min", "reversal_margin"), lowest_at(slider, path), strict=True):
            # (mu dips for so short a time that few doubles lie inside it)
            times = path.time.values[[max(i - 1, 0), min(i + 1, path.time.size - 1)]]
            times = np.unique(np.linspace(*times, 10001))
            near = rs.simulate(
                slider,
                rs.Loading.constant(V_lp),
                times[-1],
                initial=start,
                times=times,
                rtol=1e-11,
            )
            least = sampled(slider, near)[name == "reversal_margin"]
            assert -1e-8 < least - float(cycle[name]) < 1e-5, (V_lp, name)
            assert float(turn[name]) == pytest.approx(float(cycle[name]), abs=1e-8), (V_lp, name)


@LAWS
@pytest.mark.parametrize(
    ("name", "flag", "share"), [("mu_min", 1, 1.0), ("reversal_margin", 2, 0.5)]
)
def test_outside_domain_changes_at_zero_mu_min_or_reversal_margin(law, name, flag, share):
    """mu0 moves tau and mu alike, and the motion not at all."""
    cycle = cycles(law).sel(V_lp=10.0)
    for off in (-1e-9, 1e-9):
        mu0 = SLIDER.mu0 - share * float(cycle[name]) + off
        found = rs.limit_cycle(SLIDER.replace(law=law, mu0=mu0), 10.0)
        assert float(found[name]) == pytest.approx(off / share, rel=1e-3)
        assert bool(int(found.outside_domain) & flag) == (off < 0)
        assert float(found.amplitude) == float(cycle.amplitude)


def test_negative_friction_is_flagged():
    """Steady sliding so fast that mu < 0, and a little slower."""
    steady = WEAK.replace(K=1e13, M=0.0)
    mu = 0.6 - 0.0333 * math.log(1e9)
    assert mu == pytest.approx(-0.09, abs=1e-3)
    cycle = rs.limit_cycle(steady, 1.0)
    assert names(cycle) == ["both"]
    assert float(cycle.mu_min) == pytest.approx(mu, rel=1e-12)
    assert float(cycle.reversal_margin) == pytest.approx(2 * mu, rel=1e-12)
    assert "mu falls to -0.0901, so that friction would have to push" in verdict(steady, 1.0).text
    with pytest.warns(RunWarning):  # it stays on unstable sliding
        slow = rs.simulate(WEAK, rs.Loading.constant(0.06), 1e-6, V_start=0.06)
    assert names(slow) == ["inside"]
    assert float(slow.mu_min) == pytest.approx(0.6 - 0.0333 * math.log(6e7), rel=1e-4)


def test_failed_cases_are_unknown():
    K = xr.DataArray([3e8, 9e9], dims="K")
    slider = rs.SpringSlider(a=0.003, b=0.006, Dc=1e-5, sigma=2e6, K=K, M=0.0)
    run = rs.simulate(slider, rs.Loading.constant(1e-3), 1.0, V_start=5e-4)
    assert names(run) == ["unknown", "inside"]
    assert np.isnan(run.mu_min).values.tolist() == [True, False]
    assert names(rs.limit_cycle(slider, 1e-3)) == ["unknown", "inside"]


@LAWS
def test_mu_agrees_with_V_and_theta_or_is_nan(law):
    """The load point stops under fast sliding: V falls until double precision ends."""
    slider = SLIDER.replace(law=law)
    loading, t = rs.Loading.steps(50.0, (1e-3, 1e-3)), 3 / slider.f_n
    run = rs.simulate(slider, loading, t, times=np.linspace(0, t, 3001))
    p = {name: getattr(slider, name) for name in ("a", "b", "mu0", "V0", "Dc")}
    held = run.V > 1e-260 * slider.V0
    mu = friction(run.V, run.theta, **p)
    assert 0.05 < float(held.mean()) < 0.95
    np.testing.assert_allclose(run.mu[held], mu[held], rtol=0, atol=1e-12)
    assert (np.isnan(run.mu) == (slider.V0 * math.exp(-600) * (1 + 1e-9) >= run.V)).all()
    assert float(run.mu_min) < -1.7  # 0.003 times -600, and less
    assert "double precision" in run.mu.attrs["comment"]
