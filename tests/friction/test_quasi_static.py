"""Sliding without inertia: closed forms compared with simulations."""

import math

import numpy as np
import pytest
import xarray as xr
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.special import lambertw

import ratestate as rs
from ratestate.friction.quasi_static import (
    excursion,
    period,
    runaway_step,
    runaway_step_lower_bound,
    runaway_step_upper_bound,
)

LAWS = pytest.mark.parametrize("law", ["slip", "aging"])
V_LP, DC, SIGMA, A = 1e-12, 1e-5, 2e6, 0.004
UNIT = DC / V_LP
E_FOLDS = st.floats(-4, 4)


def friction(b_over_a):
    return {"a": A, "b": b_over_a * A, "Dc": DC, "sigma": SIGMA}


def stiffness(b_over_a, ratio):
    """Return K [Pa/m] from its ratio to K_c_qs."""
    return ratio * (b_over_a - 1) * A * SIGMA / DC


def march(law, b_over_a, ratio, v, psi, fractions, t_end, rtol=1e-10):
    """Simulate from ln(V/V_lp) = v and ln(theta V_lp/Dc) = psi, at K = ratio K_c_qs."""
    parameters = friction(b_over_a) | {"K": stiffness(b_over_a, ratio)}
    run = rs.simulate(
        rs.SpringSlider(**parameters, mu0=0.6, V0=1e-9, M=0.0, law=law),
        rs.Loading.constant(V_LP),
        t_end,
        initial={"V": V_LP * math.exp(v), "theta": UNIT * math.exp(psi)},
        times=np.asarray(fractions) * t_end,
        rtol=rtol,
    )
    E = excursion(run.V, run.theta, V_lp=V_LP, **parameters, law=law)
    return run, E.values


def start_state(law, c, first, second):
    """Return v, psi of any start (aging law), or of any periodic start (slip law)."""
    if law == "aging":
        return first - second, second  # ln(V theta/Dc) and psi
    h = math.exp(-first) - 1 + first
    x = -math.expm1(second) - c * h  # 1 - x - c h = exp(second) > 0
    return first, (x - first) / (1 + c)


def runs_away(b_over_a, ratio, steps, law="slip"):
    """Return whether steps from steady sliding at V_lp/steps run away."""
    parameters = friction(b_over_a) | {"K": stiffness(b_over_a, ratio)}
    slider = rs.SpringSlider(**parameters, mu0=0.6, V0=1e-9, M=0.0, law=law)
    V_start = xr.DataArray(V_LP / np.atleast_1d(steps), dims="step")
    # runaway takes about V_lp/V_start Dc/V_lp, the slip at the old speed
    t_end = UNIT * (20 * np.max(steps) + 20)
    run = rs.simulate(slider, rs.Loading.constant(V_LP), t_end, V_start=V_start, rtol=1e-10)
    names = run.status.attrs["flag_meanings"].split()
    codes = run.status.attrs["flag_values"].tolist()
    found = [names[codes.index(int(s))] for s in run.status]
    assert set(found) <= {"finished", "quasi_static_instability"}
    return np.array([name == "quasi_static_instability" for name in found])


# K = K_c_qs ---------------------------------------------------------------------------------------


@LAWS
@settings(max_examples=40, deadline=None)
@given(b_over_a=st.floats(1.2, 8), first=E_FOLDS, second=E_FOLDS)
def test_every_start_is_periodic(law, b_over_a, first, second):
    """One period later the state is back, and E has not changed (slip law: if E is finite)."""
    c = b_over_a - 1
    v, psi = start_state(law, c, first, second)
    parameters = friction(b_over_a) | {"K": stiffness(b_over_a, 1.0)}
    E = excursion(V_LP * math.exp(v), UNIT * math.exp(psi), V_lp=V_LP, **parameters, law=law)
    assert 0 <= E < np.inf
    assume(500 * c > E)  # V reaches V_lp exp(E/c), and 600 e-folds are what an exponential holds
    # near the separatrix of the slip law, E = inf, errors of the start grow
    spread = math.exp(E) if law == "slip" else 1 + E
    assume(spread < 1e4)
    T = period(E, V_lp=V_LP, a=A, b=b_over_a * A, Dc=DC)
    run, kept = march(law, b_over_a, 1.0, v, psi, [0.0, 0.21, 0.47, 0.83, 1.0], T)
    np.testing.assert_allclose(kept, E, rtol=0, atol=1e-8 * spread)
    back = [np.log(run.V[-1] / V_LP) - v, np.log(run.theta[-1] / UNIT) - psi]
    speed = (1 + c) * (1 + math.exp(v) + math.exp(-psi))  # of v and psi there, or more
    np.testing.assert_allclose(back, 0, atol=1e-8 * spread * max(speed, 1))


def test_states_of_infinite_excursion_run_away():
    """A kick in stress from steady sliding, up or down, at K = K_c_qs (slip law).

    V jumps by exp(x), x = kick/(a sigma), and theta does not: (b/a) x + c exp(-x) >= b/a runs
    away, that is, x outside 1 + W(-c a/(b e)) with the two branches of Lambert's function.
    """
    c, beta = 1.0, 2.0
    for branch, sign in ((0, 1), (-1, -1)):  # x - 1 = -(c/beta) exp(-x)
        kick = 1 + float(lambertw(-c / beta / math.e, branch).real)
        assert kick * sign > 0
        for factor, unstable in ((1 - 1e-5, False), (1 + 1e-5, True)):
            V = V_LP * math.exp(kick * factor)
            state = {"V_lp": V_LP, **friction(beta), "K": stiffness(beta, 1.0), "law": "slip"}
            assert np.isinf(excursion(V, UNIT, **state)) == unstable
            if unstable:
                with pytest.raises(rs.QuasiStaticInstability):
                    march("slip", beta, 1.0, math.log(V / V_LP), 0.0, [1.0], 60 * UNIT)
            else:
                march("slip", beta, 1.0, math.log(V / V_LP), 0.0, [1.0], 60 * UNIT)


# Other stiffnesses --------------------------------------------------------------------------------


@LAWS
@pytest.mark.parametrize("ratio", [0.8, 1.001, 1.5])
def test_rate_of_the_excursion(law, ratio):
    """dE/dT of the module, integrated along a simulation; it has one sign."""
    b_over_a, fractions = 2.0, np.linspace(0, 1, 4001)
    v, psi = start_state(law, 1.0, 0.3, -0.9)
    run, E = march(law, b_over_a, ratio, v, psi, fractions, 3 * UNIT, rtol=1e-12)
    assert (np.diff(E) * (1 - ratio) > 0).all()
    v, psi = np.log(run.V.values / V_LP), np.log(run.theta.values / UNIT)
    kappa, c = ratio, 1.0
    if law == "aging":
        rate = -(kappa - c) * np.expm1(v + psi) ** 2 * np.exp(-psi)
    else:
        one_less_z = 1 - (v + 2 * psi) - kappa * (np.exp(-v) - 1 + v)
        rate = kappa * (kappa - c) * v * np.expm1(-v) / one_less_z * np.exp(v)
    step = 3 / 4000
    integral = (rate[:-2:2] + 4 * rate[1:-1:2] + rate[2::2]).sum() * step / 3
    assert E[-1] - E[0] == pytest.approx(integral, rel=1e-6)


def test_bounds_at_the_paper_s_stiffness():
    """b/a = 2, K = 1.5 K_c_qs as in Fig. 2: 2.5 < 3.469 < 4.718."""
    parameters = friction(2.0) | {"K": stiffness(2.0, 1.5)}
    assert runaway_step_lower_bound(**parameters) == pytest.approx(2.5, rel=1e-12)
    assert runaway_step_upper_bound(**parameters) == pytest.approx(2 + math.e, rel=1e-12)
    assert runs_away(2.0, 1.5, [3.468, 3.470]).tolist() == [False, True]
    assert not runs_away(2.0, 1.5, [3.470, 100.0], law="aging").any()


# Limits and shapes --------------------------------------------------------------------------------


def test_runaway_bounds_and_period_without_instability():
    for b in (A, 0.5 * A, 0.0, -A):  # never unstable
        parameters = {"a": A, "b": b, "Dc": DC, "sigma": SIGMA, "K": 1e9}
        assert runaway_step(a=A, b=b) == np.inf
        assert runaway_step_lower_bound(**parameters) == np.inf
        assert runaway_step_upper_bound(**parameters) == np.inf
        assert np.isnan(period(1.0, V_lp=V_LP, a=A, b=b, Dc=DC))
    for bound in (runaway_step_lower_bound, runaway_step_upper_bound):
        soft, critical = (friction(2.0) | {"K": stiffness(2.0, r)} for r in (0.99, 1 + 1e-12))
        assert bound(**soft) == 1
        assert bound(**critical) == pytest.approx(2, rel=1e-5)
    assert period(np.inf, V_lp=V_LP, a=A, b=2 * A, Dc=DC) == np.inf
    with pytest.raises(rs.ParameterError, match="law = 'cut-off'"):
        excursion(1.0, 1.0, V_lp=1.0, **friction(2.0), K=1e9, law="cut-off")
