"""The critical values that the page marks on its sliders."""

import numpy as np
import pytest

import ratestate as rs
from ratestate.dynamics.verdict import verdict
from ratestate.paper.parameters import FIG1, FIG2, FIG4
from ratestate_explorer.picture import marks

AGING = FIG2.replace(law="aging", K=601e6)


def test_they_are_the_verdicts():
    steady = rs.stability(AGING, 1e-4)
    found = marks(answer := verdict(AGING, 1e-4))
    assert found["K"] == [["K_c", float(steady.K_c)], ["K_fold", answer.K_fold]]
    assert found["V_lp"] == [["V_c", float(steady.V_c)]]
    assert answer.K_fold > float(steady.K_c)


@pytest.mark.parametrize("part", [0.999, 1.001])
def test_the_critical_mass_is_the_edge(part):
    ((name, M_c),) = marks(verdict(FIG2, 3.2e-3))["M"]
    assert name == "M_c"
    steady = rs.stability(FIG2.replace(M=part * M_c), 3.2e-3)
    assert bool(steady.stable) == (part < 1.0)


def test_both_critical_speeds_where_there_are_two():
    slider = FIG2.replace(friction_form="cut-off", V1=1e-2, V2=1e-2, K=400e6, M=0.0)
    names = [name for name, _ in marks(verdict(slider, 1e-3))["V_lp"]]
    steady = rs.stability(slider, 1e-3)
    expected = ["V_c", "V_c_upper"]
    assert names == [n for n in expected if np.isfinite(steady[n]) and steady[n] > 0.0]
    assert "V_c_upper" in names


@pytest.mark.parametrize(
    ("slider", "there"),
    [
        (FIG4, ["K"]),  # softer than K_c_qs: unstable at any speed and mass
        (FIG2.replace(a=0.01), []),  # strengthening
        (FIG2.replace(damping=1e3), ["K", "V_lp"]),  # eq. 6 does not hold
        (FIG1, ["K"]),  # a rigid spring has no critical speed or mass
    ],
)
def test_what_does_not_exist_is_not_marked(slider, there):
    found = marks(verdict(slider, 1e-4))
    assert [field for field, rows in found.items() if rows] == there
