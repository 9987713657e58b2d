"""A law that is one formula, (1 - (V theta/Dc)^m)/m, has all that built-in laws have."""

from types import MappingProxyType

import numpy as np
import pytest
import xarray as xr
from user_laws import MINE

import ratestate as rs
from ratestate.dynamics.verdict import verdict

FIG2 = rs.SpringSlider(a=0.003, b=0.006, Dc=1e-5, sigma=2e6, M=3e3, K=9e8)
V = 4e-3


@pytest.fixture
def pair(law_file):
    """A slider under the formula with m = 2, and under the built-in law that it then is."""
    path = law_file(MINE)

    def made(slider=FIG2, **changes):
        own = slider.replace(law=rs.register(path), m=2.0, **changes)
        return own, slider.replace(law="prz", **changes)

    return made


def assert_same(found, wanted, rtol=1e-9):
    """All numbers of two results, beside those that tell only how they were found."""
    how = {"steps", "rejected", "error", "residual", "energy_residual", "returns", "iterations"}
    how |= {"inertial_force", "cycles"}  # (rounding, without mass)
    for name in wanted.data_vars.keys() - how:
        if wanted[name].dtype.kind in "fc" and "error" not in name:
            size = np.abs(wanted[name]).max() if wanted[name].size > 1 else 0.0
            np.testing.assert_allclose(
                found[name], wanted[name], rtol=rtol, atol=rtol * size, err_msg=name
            )
        elif wanted[name].dtype.kind in "ib" and "error" not in name:
            np.testing.assert_array_equal(found[name], wanted[name], err_msg=name)


@pytest.mark.parametrize(
    "part",
    [{"M": 0.0, "K": 4e9}, {"friction_form": "regularized"}, {"alpha": 0.3, "damping": 1e5}],
)
def test_runs_agree_with_the_built_in_law(pair, part):
    loading = rs.Loading.steps(V / 3, (0.02, V))
    if "alpha" in part:
        loading = loading.sigma_step(0.04, 2.1e6).sigma_sinusoid(5e4, period=0.03)
    times = [0.01, 0.03, 0.06, 0.1]
    runs = [rs.simulate(one, loading, 0.1, times=times, rtol=1e-11) for one in pair(**part)]
    assert_same(*runs)


def test_stability_and_the_hopf_point(pair):
    own, its = pair()
    assert_same(rs.stability(own, V), rs.stability(its, V))
    assert_same(rs.hopf(own, V), rs.hopf(its, V))
    assert_same(rs.hopf(own), rs.hopf(its))


def test_large_and_small_cycles_equal_the_built_in_law_s(pair):
    own, its = pair()
    K = float(its.K_c(V)) * xr.DataArray([0.3, 0.999], dims="K")
    cycles = [rs.limit_cycle(one.replace(K=K), V, rtol=1e-11) for one in (own, its)]
    names = "amplitude period V_max V_min mu_min multipliers".split()
    assert (cycles[1].status == 0).all()
    for name in names:
        np.testing.assert_allclose(
            cycles[0][name], cycles[1][name], rtol=1e-9, atol=1e-9, err_msg=name
        )


def test_friction_that_falls_with_speed_is_refused():
    """`register` sees it at the example of h alone."""

    class Bent(rs.FrictionLaw):
        name = "bent"
        parameters = MappingProxyType({"h": rs.laws.Parameter("1", "direct effect", "", "0.01")})

        def evolution(self, V, theta, p):
            return 1 - V * theta / p.Dc

        def friction(self, V, theta, p):
            log = rs.laws.log
            return p.mu0 + p.h * log(V / p.V0) + p.b * log(p.V0 * theta / p.Dc)

    slider = FIG2.replace(law=Bent, h=0.003, M=0.0, K=2e9)
    usual = FIG2.replace(law="aging", M=0.0, K=2e9)
    loading, how = rs.Loading.constant(V), {"V_start": V / 3, "times": [0.01]}
    found, wanted = (float(rs.simulate(x, loading, 0.01, **how).V[0]) for x in (slider, usual))
    assert found == pytest.approx(wanted, rel=1e-6)
    for h, part in ((0.0, "0"), (-0.003, "-1")):
        falling = slider.replace(h=h)
        for call in (
            lambda s: rs.simulate(s, loading, 0.01, **how),
            lambda s: rs.stability(s, V),
            lambda s: rs.limit_cycle(s.replace(M=3e3), V),
            lambda s: rs.hopf(s.replace(M=3e3)),
        ):
            with pytest.raises(rs.ParameterError) as error:
                call(falling)
            assert (error.value.symbol, error.value.value) == ("law", f"'{slider.law}'")
            assert error.value.problem.endswith(f"(d mu/d ln V)/a = {part}")


def test_cycles_and_a_verdict_under_an_own_friction_with_a_kink():
    """Also where no slider of a batch has a cycle to be measured."""

    class Own(rs.FrictionLaw):
        name = "own"
        parameters = MappingProxyType({"V_k": rs.laws.Parameter("m/s", "kink", "> 0", "1 mm/s")})

        def friction(self, V, theta, p):
            beyond = rs.laws.where(p.V_k > V, 0.0, 0.3 * p.a * rs.laws.log(V / p.V_k))
            of_state = p.b * rs.laws.log(1.0 + p.V0 * theta / p.Dc)
            return p.mu0 + p.a * rs.laws.log(V / p.V0) + beyond + of_state

        def evolution(self, V, theta, p):
            return 1.0 - V * theta / p.Dc

    slider, speed = FIG2.replace(law=Own, V_k=2e-2, V0=0.1, K=3e8), 1e-4
    cycle = rs.limit_cycle(slider, speed)
    t_end = 12.0 * float(cycle.period)
    run = rs.simulate(slider, rs.Loading.constant(speed), t_end, V_start=2.0 * speed, times=[t_end])
    assert float(cycle.V_max) > 100.0 * speed
    assert float(run.frequency * cycle.period) == pytest.approx(1.0, rel=1e-4)
    stable = slider.replace(K=1e10)
    assert str(rs.limit_cycle(stable, speed).status.values) == "1"
    assert verdict(stable, speed).sentences[0].startswith("Steady sliding at")


def test_a_window_of_instability_may_end_at_a_kink():
    """Steady friction weakens up to V_x alone; the window lies between two speeds of a grid."""

    class Window(rs.FrictionLaw):
        name = "window"
        parameters = MappingProxyType({"V_x": rs.laws.Parameter("m/s", "end", "> 0", "1 mm/s")})

        def evolution(self, V, theta, p):
            beyond = p.Dc / p.V_x * (p.V_x / V) ** 0.2
            return 1.0 - theta / rs.laws.where(p.V_x > V, p.Dc / V, beyond)

    V_x, V_c = 1.15e-3, 1.15e-3 / np.array([1.001, 1.03, 1.06, 1.14])
    aging = rs.SpringSlider(a=0.004, b=0.008, Dc=1e-5, sigma=2e6, M=1e4, K=1e9, law="aging")
    K = aging.K_c(xr.DataArray(V_c, dims="K")).values
    slider = aging.replace(law=Window, V_x=V_x, K=xr.DataArray(K, dims="K"))
    np.testing.assert_allclose(slider.V_c, V_c, rtol=1e-9)
    np.testing.assert_allclose(slider.V_c_upper, V_x, rtol=1e-9)
    assert np.isinf(slider.replace(K=1.01 * K.max()).V_c)


def test_other_parameters_than_the_examples_may_have_no_steady_sliding():
    class Started(rs.FrictionLaw):
        name = "started"
        parameters = MappingProxyType({"r": rs.laws.Parameter("1", "steady V theta/Dc")})

        def evolution(self, V, theta, p):
            return p.r - V * theta / p.Dc

    slider = FIG2.replace(law=Started, r=0.5, K=2e9)
    run = rs.simulate(slider, rs.Loading.constant(V), 0.2, V_start=V / 2, times=[0.2])
    assert float(run.theta[0]) == pytest.approx(0.5 * 1e-5 / V, rel=1e-6)
    without = slider.replace(r=-1.0)
    said = f"^law = '{slider.law}'.* theta has no steady value. Give other parameters.$"
    for call in (
        lambda: rs.simulate(without, rs.Loading.constant(V), 0.02, V_start=V / 2),
        lambda: rs.stability(without, V),
        lambda: rs.hopf(without),
    ):
        with pytest.raises(rs.ParameterError, match=said):
            call()
