"""The bifurcation diagram and parts of the map, as the explorer's server answers for them."""

import functools
import json

import numpy as np
import pytest

import ratestate as rs
from ratestate.engine.backend import Stopped
from ratestate.paper.parameters import FIG2, FIG4, FIG6
from ratestate_explorer import branch, entries, wire
from ratestate_explorer.branch import ParameterRange
from ratestate_explorer.deadline import Deadline
from ratestate_explorer.entries import PageState
from ratestate_explorer.menus import presets

AGING = FIG4.replace(law="aging")
V_LP = 1e-4


@functools.cache
def diagram(slider, along, V_lp=V_LP):
    return branch.branch(PageState(slider, V_lp), along, Deadline(120.0))


def pieces(header, arrays):
    """The pieces of a diagram's branches, each a dict of arrays."""
    cuts = np.cumsum(header["sizes"])[:-1]
    parts = {name: np.split(values, cuts) for name, values in arrays.items()}
    return [dict(zip(parts, values, strict=True)) for values in zip(*parts.values(), strict=True)]


class TestBranch:
    def test_the_diagram_agrees_with_continue_cycle(self):
        header, arrays = diagram(AGING, "K")
        (found,) = pieces(header, arrays)
        soft = 0.9 * float(AGING.K_c(V_LP))
        followed = rs.continue_cycle(AGING, "K", header["high"], soft, V_lp=V_LP)
        fold = followed.isel(point=int(np.argmax(followed.special.values == "fold")))
        (special,) = header["special"]
        assert header["hopf"] == pytest.approx((AGING.K_c(V_LP),), rel=1e-10)
        assert special["kind"] == "fold"
        assert special["parameter"] == pytest.approx(float(fold.K), rel=1e-8)
        assert special["amplitude"] == pytest.approx(float(fold.amplitude), rel=1e-3)
        assert special["V_max"] == pytest.approx(float(fold.V_max), rel=1e-3)
        # the cycle of the softest spring shown, by a search that follows nothing
        assert found["parameter"][-1] == header["low"]
        cycle = rs.limit_cycle(AGING.replace(K=header["low"]), V_LP)
        for name in ("amplitude", "V_max"):
            assert found[name][-1] == pytest.approx(float(cycle[name]), rel=1e-4)

    def test_cycles_are_unstable_from_the_hopf_point_to_the_fold(self):
        header, arrays = diagram(AGING, "K")
        assert not header["stable_at_low"]  # the softer springs are unstable
        stable = arrays["stable"].astype(bool)
        at = int(np.flatnonzero(arrays["parameter"] == header["special"][0]["parameter"])[0])
        assert not stable[:at].any()
        assert stable[at:-1].all()
        assert arrays["amplitude"][0] == 0.0
        assert arrays["V_max"][0] == pytest.approx(V_LP, rel=1e-12)
        _, of_slip = diagram(FIG4, "K")
        assert of_slip["stable"][:-1].all()  # supercritical

    @pytest.mark.parametrize(("along", "critical"), [("V_lp", 1e-4), ("M", 750.0)])
    def test_a_branch_that_is_steep_at_its_hopf_point_is_followed(self, along, critical):
        """The roughest accuracy gives up there: K is 1.0005 K_c_qs."""
        header, arrays = diagram(FIG6, along, 2e-4)
        assert header["note"] == ""
        assert header["hopf"] == pytest.approx((critical,), rel=1e-9)
        assert header["low"] == pytest.approx(0.1 * critical, rel=1e-9)
        assert header["high"] == pytest.approx(critical * 10**1.5, rel=1e-9)
        assert arrays["parameter"][-1] == header["high"]
        state = FIG6 if along == "V_lp" else FIG6.replace(M=header["high"])
        cycle = rs.limit_cycle(state, header["high"] if along == "V_lp" else 2e-4)
        assert arrays["amplitude"][-1] == pytest.approx(float(cycle.amplitude), rel=1e-4)

    def test_without_a_hopf_point_it_goes_from_end_to_end(self):
        header, arrays = diagram(FIG4, "V_lp")  # K < K_c_qs
        assert (header["hopf"], header["stable_at_low"]) == ((), False)
        assert (header["low"], header["high"]) == pytest.approx((10**-5.5, 10**-2.5))
        assert arrays["parameter"][[0, -1]].tolist() == [header["low"], header["high"]]

    def test_the_parameters_own_value_is_not_computed_with(self):
        first = diagram(FIG4, "K")
        again = branch.branch(PageState(FIG4.replace(K=1.1e9), V_LP), "K", Deadline(0.0))
        assert again[0] == first[0]
        assert again[0]["sizes"][0] > 50

    def test_the_range_reaches_a_slider_far_away(self):
        K_c = float(FIG4.K_c(V_LP))
        near, far = (branch.axis_of(FIG4.replace(K=x * K_c), V_LP, "K") for x in (0.04, 0.03))
        assert near.low == pytest.approx(K_c / 10**1.5, rel=1e-9)
        assert far.low == pytest.approx(10**6.5, rel=1e-9)  # 3/4 decade on, on a half decade
        assert near.high == far.high == pytest.approx(10.0 * K_c, rel=1e-9)

    @pytest.mark.parametrize(
        ("slider", "along", "note"),
        [
            (
                FIG2.replace(M=0.0),
                "K",
                "M = 0.0 kg/m^2 cannot be used: a branch ne",
            ),
            (FIG2.replace(K=np.inf), "V_lp", "Steady sliding is stable along the whole axis"),
            (FIG2.replace(b=0.002), "K", "Steady sliding is stable along the whole axis"),
        ],
    )
    def test_a_missing_branch_has_a_note(self, slider, along, note):
        header, arrays = diagram(slider, along)
        assert header["note"].startswith(note)
        assert header["sizes"] == []
        assert arrays["parameter"].size == 0
        assert 0.0 < header["low"] < header["high"] < np.inf

    def test_the_diagram_along_M_of_a_slider_without_mass_has_the_hopf_point(self):
        header, _ = diagram(FIG2.replace(M=0.0), "M")
        M_c = 0.5 * FIG2.a * FIG2.sigma * FIG2.Dc / V_LP**2  # K = 1.5 K_c_qs: eta = 0.5
        assert header["hopf"] == pytest.approx((M_c,), rel=1e-9)

    def test_what_was_found_of_a_branch_is_shown(self, monkeypatch):
        whole = rs.continue_cycle(FIG4, "K", 1.2e10, 4e8, V_lp=V_LP, rtol=1e-4)
        tried = []

        def ends_early(_, along, start, stop, **settings):
            tried.append((along, start < stop, settings["rtol"]))
            raise rs.NotConverged("it ends early\nfor a reason", whole[{"point": slice(40)}])

        monkeypatch.setattr(rs, "continue_cycle", ends_early)
        header, arrays = diagram(FIG4.replace(a=0.0051), "K")
        assert header["note"] == "it ends early"
        assert arrays["parameter"].size == 40
        # with more accuracy, then from the other end
        assert tried == [("K", False, 1e-4), ("K", False, 1e-6), ("K", True, 1e-4)]

    def test_the_time_for_a_branch_is_bounded(self):
        slider = FIG4.replace(a=0.0052)
        header, arrays = branch.branch(PageState(slider, V_LP), "K", Deadline(0.0))
        assert header["note"].startswith("The cycles take more than 0 s")
        assert arrays["parameter"].size == 0
        assert len(header["hopf"]) == 1
        cancelled = Deadline(60.0)
        cancelled.set()
        with pytest.raises(Stopped):
            branch.branch(PageState(slider, V_LP), "K", cancelled)

    @pytest.mark.parametrize(
        ("hopf", "stable", "courses"),
        [
            ((), True, []),
            ((), False, [(1.0, 256.0)]),
            ((16.0,), True, [(1.0, 256.0)]),
            ((16.0,), False, [(256.0, 1.0)]),
            ((4.0, 64.0), True, [(1.0, 16.0), (256.0, 16.0)]),
            ((4.0, 64.0), False, [(16.0, 1.0), (16.0, 256.0)]),
            ((4.0, 16.0, 64.0), True, [(1.0, 8.0), (32.0, 8.0), (32.0, 256.0)]),
        ],
    )
    def test_every_unstable_interval_is_followed_from_its_hopf_points(self, hopf, stable, courses):
        assert ParameterRange(1.0, 256.0, hopf, stable).courses() == courses


class TestWire:
    @staticmethod
    def question(**more):
        return wire.checked(wire.Question, json.dumps({"id": 1, "entries": {}, **more}))

    def test_a_branch_has_its_parameter(self):
        assert self.question(ask="branch", along="V_lp").along == "V_lp"
        for along in (None, "Dc", 3, ["K"]):
            with pytest.raises(wire.BadQuestion, match="along"):
                self.question(ask="branch", along=along)

    def test_a_window_has_limits_inside_the_map(self):
        assert self.question(ask="window", window=[0.01, 1000, 1e-16, 1e4]).window == (
            0.01,
            1000.0,
            1e-16,
            1e4,
        )
        kinds = (None, 5, [1, 2, 3], [1, 2, 1, True], [1, 2, 1, "2"])
        sizes = ([0.0099, 1, 1, 2], [1, 1000.1, 1, 2], [1, 2, 9e-17, 1], [1, 2, 1, 10001])
        empty = ([1, 1, 1, 2], [2, 1, 1, 2], [1, 2, 2, 2], [1, 10**400, 1, 2])
        for window in (*kinds, *sizes, *empty):
            with pytest.raises(wire.BadQuestion, match="window"):
                self.question(ask="window", window=window)

    def test_the_page_opens_with_what_can_be_asked(self):
        state = entries.state_of(presets()[0]["entries"])
        header, arrays = branch.branch(state, "K", Deadline(120.0))
        sent = wire.answer(1, "branch", arrays, **header)
        assert len(sent) < 20_000
