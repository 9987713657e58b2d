"""Cycles of several returns: which attractor is reached, and what is said of it."""

import numpy as np
import pytest
import xarray as xr
from dimensionless import make_system, measured_by_scipy

import ratestate as rs
from ratestate.dynamics.cycles.attractor import find_attractors, steady_start
from ratestate.dynamics.cycles.measure import refine
from ratestate.dynamics.cycles.system import state
from ratestate.dynamics.verdict import verdict

# A stable cycle of one return lies beside one of two, to which the start at V_lp/10 leads.
BESIDE = rs.SpringSlider(
    a=0.003, b=0.0363, Dc=1e-5, mu0=0.6, V0=1e-9, sigma=2e6, M=3000, K=1.06 * 0.0333 * 2e6 / 1e-5
)
V_LP = 8.78e-3


def cycles_by_search(system):
    attractors = find_attractors(system, steady_start(system), 1e-9, None)
    return attractors, refine(system, attractors, 1e-9)


def test_the_attractor_and_not_the_cycle_beside_it():
    found = rs.limit_cycle(BESIDE, V_LP)
    assert found.status == 0
    assert found.returns == 2
    assert found.returns.dtype == np.int16
    period, n = float(found.period), 300
    settings = {"V_start": V_LP / 10, "rtol": 1e-9, "method": "rodas5p"}  # (its steps are short)
    run = rs.simulate(BESIDE, rs.Loading.constant(V_LP), n * period, **settings)
    late = run.isel(time=run.time > (n - 3) * period)
    stress = late.tau.values / 2e6
    assert float(found.amplitude) == pytest.approx(stress.max() - stress.min(), rel=1e-5)
    assert 0.0818 < float(found.amplitude) < 0.0820
    assert float(found.V_max) == pytest.approx(float(late.V.max()), rel=1e-3)
    assert float(found.V_min) == pytest.approx(float(late.V.min()), rel=1e-2)
    # and simulate says the same of its last whole period
    assert int(run.returns) == 2
    assert float(run.amplitude) == pytest.approx(float(found.amplitude), rel=1e-7)
    assert float(run.frequency) == pytest.approx(float(found.frequency), rel=1e-7)
    # the drops of either half are those that were seen
    tops = np.flatnonzero((stress[1:-1] > stress[:-2]) & (stress[1:-1] >= stress[2:])) + 1
    drops = {round(float(stress[i] - stress[i : i + 300].min()), 4) for i in tops[:-1]}
    assert {0.0819, 0.0319} <= drops
    # the cycle of one return exists and is stable, and its branch can be followed
    branch = rs.continue_cycle(BESIDE, "V_lp", 1e-2, V_LP, rtol=1e-7)
    assert float(branch.amplitude[-1]) == pytest.approx(0.0538, abs=1e-4)
    assert -1 < float(branch.multipliers[-1, 0].real) < -0.99
    assert (branch.returns == 1).all()


# K Dc/(a sigma), b/a, eta, returns: beside tangencies and among windows of chaos, where a search
# may go round for ever, or take a cycle that the orbit only passes.  Where two numbers of returns
# are given, cycles of both attract, and a start reaches the one or the other by its last bit.
HARD = [
    (36.31132196056443, 38.43134462741554, 7.435331354704798, (2, 4)),
    (21.630378570214766, 22.93433105283279, 0.21538580854401101, (1,)),
    (21.469571501238462, 22.53634547870793, 0.23623783597880565, (2,)),
    (34.959747466280774, 35.57941622524835, 0.12512627049105998, (2,)),
    (11.37, 12.971660394273613, 1.047916942260419, (8,)),
    (11.4, 12.971660394273613, 1.047916942260419, (16,)),
    (11.406, 12.971660394273613, 1.047916942260419, (32,)),
]
V = 1e-3


def slip_slider(kappa, beta, eta):
    a, Dc, sigma = 0.003, 1e-5, 2e6
    return rs.SpringSlider(
        a=a, b=a * beta, Dc=Dc, sigma=sigma, K=kappa * a * sigma / Dc, M=eta * a * sigma * Dc / V**2
    )


@pytest.mark.parametrize(("kappa", "beta", "eta", "returns"), HARD)
def test_cycles_that_are_hard_to_reach(kappa, beta, eta, returns):
    """By a long run, which knows nothing of the search."""
    slider = slip_slider(kappa, beta, eta)
    found = rs.limit_cycle(slider, V)
    assert int(found.returns) in returns
    t_end = max(100 * float(found.period), 10.0)
    run = rs.simulate(slider, rs.Loading.constant(V), t_end, V_start=V / 10, rtol=1e-9)
    assert int(run.returns) in returns
    if int(run.returns) == int(found.returns):  # as always where one number is given
        assert float(run.amplitude) == pytest.approx(float(found.amplitude), rel=1e-4)
        assert float(run.frequency) == pytest.approx(float(found.frequency), rel=1e-4)


def test_measures_of_two_returns_by_scipy():
    """Period, extremes and the waveform of the whole period, by Radau and an FFT."""
    parameters = (1.06 * 11.1, 12.1, 3000 * V_LP**2 / (0.003 * 2e6 * 1e-5))
    system = make_system("slip", *parameters)
    attractors, found = cycles_by_search(system)
    assert attractors.n_returns.tolist() == [2]
    found = {name: value[0] for name, value in found.items()}
    y, period = state(system, attractors.u)[0], found["period"]
    exact, half = measured_by_scipy("slip", parameters, y, period, returns=2)
    assert np.abs(half - y).max() > 0.5  # not one return twice
    tolerances = {"v_min": {"abs": 1e-5}, "fundamental": {"rel": 1e-4}}
    for name, value in exact.items():
        tolerance = tolerances.get(name, {"rel": 1e-5, "abs": 1e-6})
        assert found[name] == pytest.approx(value, **tolerance), name


def test_verdict_tells_of_the_doubling():
    said = verdict(BESIDE, V_LP)
    assert said.returns == 2
    cycle = rs.limit_cycle(BESIDE, V_LP)
    sentence = next(text for text in said.sentences if "period doubling" in text)
    assert sentence.startswith("It repeats after 2 unequal maxima of the stress")
    assert f"every {1e3 * float(cycle.period):.4g} ms" in sentence
    other = verdict(BESIDE.replace(b=0.006, K=9e8), 3.2e-3)
    assert other.returns == 1
    assert not any("doubling" in text for text in other.sentences)


# Two states without mass, beta1 = 1, beta2 = 0.84, rho = 0.048 (Gu et al., 1984), just below K_c.
TWO = {"a": 0.01, "b": 0.01, "b2": 0.0084, "Dc": 4.8e-6, "Dc2": 1e-4, "sigma": 5e6, "K": 1e9}
TWO_V = 1e-6


def two_states(ratio):
    slider = rs.SpringSlider(**TWO, law="two-state-slip")
    return slider.replace(K=ratio * slider.K_c(TWO_V))


def test_critical_stiffness_of_gu_and_others():
    """K_c Dc/(a sigma) as in the literature on these parameters, 0.08028."""
    K_c = two_states(1.0).K
    assert K_c * TWO["Dc"] / (TWO["a"] * TWO["sigma"]) == pytest.approx(0.08028, abs=5e-6)


def test_doublings_come_closer_by_feigenbaums_number():
    """Both sides of each: a multiplier of -1 above it, and a smaller cycle of twice the returns."""
    edges, off = np.array([0.866259, 0.857039, 0.855393, 0.855050]), 2e-5
    ratios = xr.DataArray(np.ravel([edges + off, edges - off], order="F"), dims="K")
    found = rs.limit_cycle(two_states(ratios), TWO_V, V_start=0.77 * TWO_V)
    assert found.returns.values.tolist() == [1, 2, 2, 4, 4, 8, 8, 16]
    first = found.multipliers[:, 0].values.real
    assert ((first[::2] > -1.0) & (first[::2] < -0.85)).all()
    assert (first[1::2] < 1.0).all()
    gaps = -np.diff(edges)
    np.testing.assert_allclose(gaps[:-1] / gaps[1:], [5.60, 4.79], atol=0.05)


def test_the_start_decides_between_a_cycle_and_runaway():
    """From V_lp/10, the usual start, the same slider runs away."""
    slider = two_states(0.862)
    with pytest.raises(rs.QuasiStaticInstability):
        rs.limit_cycle(slider, TWO_V)
    starts = xr.DataArray([TWO_V / 10.0, TWO_V / 1.3, 1.01 * TWO_V], dims="V_start")
    found = rs.limit_cycle(slider, TWO_V, V_start=starts)
    assert found.returns.values.tolist() == [0, 2, 2]
    assert float(found.amplitude[1]) == pytest.approx(float(found.amplitude[2]), rel=1e-9)
    usual = rs.SpringSlider(a=0.003, b=0.006, Dc=1e-5, sigma=2e6, K=9e8, M=3e3)
    xr.testing.assert_equal(
        rs.limit_cycle(usual, 3.2e-3).drop_attrs(),
        rs.limit_cycle(usual, 3.2e-3, V_start=3.2e-4).drop_attrs(),
    )
