"""Experiments on the page: what is read, and that the runs are those that it says."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import ratestate as rs
from ratestate import orbit, scenario
from ratestate.paper.parameters import FIG1, FIG2, FIG4
from ratestate_explorer import entries, exports, picture, state, wire
from ratestate_explorer.deadline import Deadline
from ratestate_explorer.entries import entries_of, state_of
from ratestate_explorer.state import PageState, Segment

STEADY = entries_of(PageState(FIG2, 1e-4))
STICK_SLIP = entries_of(PageState(FIG4, 1e-4))
AGING = FIG2.replace(law="aging")


def painted(texts, seconds=60.0):
    return picture.picture(state_of(texts), Deadline(seconds))


def problem(texts):
    with pytest.raises(entries.BadEntries) as caught:
        painted(texts)
    return caught.value.problems


class TestEntries:
    def test_a_protocol_is_its_segments(self):
        text = " 0 m/s  for 100 s;1e-5 at 4.4 MPa for 20;2 mm/s for 0.5 ms "
        found = [Segment(0.0, None, 100.0), (1e-5, 4.4e6, 20.0), (2e-3, None, 5e-4)]
        assert list(state.segments_of(text)) == found
        assert state.text_of(state.segments_of(text)) == (
            "0 m/s for 100 s; 10 um/s at 4.4 MPa for 20 s; 2 mm/s for 500 us"
        )

    @pytest.mark.parametrize(
        ("text", "said"),
        [
            ("-3 m/s for 1 s", "V of segment 1 = '-3 m/s' must be >= 0. Give a speed"),
            ("1 m/s for 1 s; 3 MPa for 1 s", "V of segment 2 = '3 MPa' is a stress. Give"),
            ("1 m/s at for 1 s", "sigma of segment 1 = '' is not a number with a unit. Give"),
            ("1 m/s for 2 s;", "segment 2 = '' is not a segment. Give 'V for T' or 'V at"),
            ("1e21 for 1 s", "V of segment 1 = '1e21 m/s' is out of range"),
            (" ", "protocol is empty. Give 'V for T' or 'V at SIGMA for T'"),
            ("; ".join(["1 m/s for 1 s"] * 21), "has 21 segments in 313 characters, and a page"),
            ("1 m/s for 1 s" + " " * 988, "has 1 segments in 1001 characters, and a page may have"),
            ("9" * 900, f"segment 1 = '{'9' * 64}' is not a segment"),
        ],
    )
    def test_what_is_wrong_is_said_of_its_segment(self, text, said):
        problems = problem(STEADY | {"protocol": text})
        assert list(problems) == ["protocol"]
        assert said in problems["protocol"]

    def test_all_problems_of_a_protocol_are_reported(self):
        said = problem(STEADY | {"protocol": "-1 m/s for 1 s; 1 m/s for 1 s; x for 2 s"})[
            "protocol"
        ]
        assert "segment 1" in said
        assert "segment 2" not in said
        assert "segment 3" in said

    def test_a_protocol_of_the_largest_length_is_read(self):
        twenty = "; ".join(["1 m/s for 1 s"] * 20)
        assert len(state.segments_of(twenty + " " * (1000 - len(twenty)))) == 20

    @given(st.text("0129.-e; mMPaufortatgs\u00b5", max_size=60))
    def test_any_text_is_read_or_refused(self, text):
        try:
            segments = state.segments_of(text)
        except rs.ParameterError:
            return
        assert all(V >= 0.0 and duration > 0.0 for V, _, duration in segments)

    @pytest.mark.parametrize("text", ["1", "0", "-2", "x", "1e21", "inf", "nan", "", 3, "1" * 65])
    def test_a_kick_is_a_factor(self, text):
        problems = problem(STEADY | {"kick": text})
        assert list(problems) == ["kick"]
        assert "Give a number > 0 that is not 1, such as 10" in problems["kick"]

    def test_protocols_are_read_as_they_are_written(self):
        segments = (Segment(0.0, None, 12.5), Segment(1e-6, 2.2e6, 1e3))
        state = PageState(FIG2, 1e-4, 2e-4, 1.9e6, segments, 0.5)
        assert state_of(entries_of(state, 15)) == state
        assert state_of(STEADY | {"protocol": None, "kick": None}) == PageState(FIG2, 1e-4)

    def test_a_rigid_drive_neither_rests_nor_is_kicked(self):
        texts = entries_of(PageState(FIG1, 1e-4)) | {"protocol": "1 um/s for 1 s; 0 m/s for 1 s"}
        problems = problem(texts | {"kick": "3"})
        assert problems["protocol"].startswith("V of segment 2 = 0 m/s with K = inf: eq. 1 gives")
        assert problems["kick"].startswith("kick: with K = inf the slider moves at the load")

    def test_a_segment_that_rounding_would_swallow_is_refused(self):
        texts = STEADY | {"protocol": "1 mm/s for 8.5 ns; 0 m/s for 3 s"}
        said = problem(texts)["protocol"]
        assert said.startswith("duration of segment 1 = 0.0085 us is less than 1e-09 of the 8.9")
        assert painted(texts | {"protocol": "1 mm/s for 9.5 ns; 0 m/s for 3 s"})


class TestProtocols:
    def test_the_run_is_that_of_a_loading_written_by_hand(self):
        texts = STEADY | {"V_from": "20 um/s", "sigma_from": "1.9 MPa"}
        texts["protocol"] = (
            "0 m/s for 30 s; 10 um/s at 2.2 MPa for 20 s; 50 um/s at 1.9 MPa for 5 s"
        )
        header, arrays = painted(texts)
        t = -arrays["run_time"][0]
        loading = (
            rs.Loading.constant("20 um/s")
            .step(t, 0.0)
            .step(t + 30.0, "10 um/s")
            .step(t + 50.0, "50 um/s")
            .step(t + 55.0, "100 um/s")
            .sigma_step(t + 30.0, "2.2 MPa")
            .sigma_step(t + 50.0, "1.9 MPa")
            .sigma_step(t + 55.0, "2 MPa")
        )
        t_end = t + 55.0 + header["settling"]
        run = rs.simulate(FIG2.replace(sigma=1.9e6), loading, float(f"{t_end:.15g}"))
        assert np.array_equal(arrays["run_V"], run.V)
        assert np.array_equal(arrays["run_stress"], run.tau / run.sigma)
        assert np.array_equal(arrays["run_time"], run.time - t)
        assert header["changes"] == pytest.approx([0.0, 30.0, 50.0, 55.0], abs=1e-12)
        assert t == pytest.approx(0.2 * t_end, rel=1e-4)
        assert header["values"]["protocol"][1] == (1e-5, 2.2e6, 20.0)

    def test_before_time_0_it_is_the_motion_shown_unless_another_is_named(self):
        hold = {"protocol": "0 m/s for 1 s"}
        before = {"V_from": "100 um/s", "sigma_from": "4 MPa"}
        one, other = (painted(STICK_SLIP | hold | more)[1] for more in ({}, before))
        assert all(np.array_equal(one[name], other[name]) for name in one)
        at = np.searchsorted(one["run_time"], 0.0)
        top = orbit(FIG4, 1e-4).tau[0] / FIG4.sigma
        assert one["run_stress"][at] == pytest.approx(float(top), rel=1e-6)

    def test_after_a_hold_the_spring_is_seen_to_reload(self):
        """Where a slip of 100 Dc would end before the stress has its peak."""
        slider = AGING.replace(a=0.0059)
        slider = slider.replace(K=3.0 * slider.K_c(1e-4))
        texts = entries_of(PageState(slider, 1e-4)) | {"protocol": "0 m/s for 1e5 s"}
        header, arrays = painted(texts)
        after = arrays["run_time"] > 1e5
        peak = arrays["run_time"][after][arrays["run_stress"][after].argmax()] - 1e5
        assert 100 * slider.Dc / 1e-4 < peak < 0.9 * header["settling"]
        assert arrays["run_stress"][-1] == pytest.approx(header["steady"], rel=1e-3)

    def test_a_run_that_ends_in_the_protocol_is_shown_as_far_as_it_comes(self):
        texts = STEADY | {"M": "0 kg/m^2", "K": "500 MPa/m", "protocol": "1 mm/s for 5 s"}
        header, arrays = painted(texts)
        assert "quasi_static_instability" in header["notes"][-1]
        assert arrays["run_time"][-1] < 5.0

    def test_a_long_protocol_is_cut_and_that_is_said(self):
        texts = entries_of(PageState(FIG2, 3.2e-3))
        painted(texts | {"protocol": "4 mm/s for 1 s"})  # so that all is compiled
        header, arrays = painted(texts | {"protocol": "4 mm/s for 1e7 s"}, seconds=0.4)
        assert header["notes"][-1].startswith("The run is cut at")
        assert header["notes"][-1].endswith(
            "after 0.4 s of computing. The Python lines have no such limit."
        )
        assert 0.0 < arrays["run_time"][-1] < 1e7
        assert 100 < arrays["run_time"].size <= picture.MOST_SENT


class TestKicks:
    @pytest.mark.parametrize(("factor", "escapes"), [(10.0, False), (30.0, True)])
    def test_a_kick_leads_from_stable_sliding_to_the_cycle_beside_it(self, factor, escapes):
        slider = AGING.replace(K=1.001 * AGING.K_c(5e-4))
        header, arrays = painted(entries_of(PageState(slider, 5e-4, kick=factor), 15))
        amplitude = header["numbers"]["amplitude"]
        assert header["numbers"]["stable"]
        said = "are both stable. The kick starts from steady sliding"
        assert any(said in note for note in header["notes"])
        assert amplitude == pytest.approx(float(rs.limit_cycle(slider, 5e-4).amplitude), rel=1e-6)
        assert arrays["run_time"][0] == 0.0
        assert arrays["run_V"][0] == pytest.approx(factor * 5e-4, rel=1e-12)
        assert arrays["run_stress"][0] == pytest.approx(header["steady"], rel=1e-12)
        late = arrays["run_stress"][arrays["run_time"] > 0.9 * arrays["run_time"][-1]]
        if escapes:
            assert np.ptp(late) == pytest.approx(amplitude, rel=2e-3)
        else:
            assert np.ptp(late) < 0.2 * amplitude

    def test_a_cycle_is_kicked_at_its_stress_maximum(self):
        header, arrays = painted(STICK_SLIP | {"kick": "0.1", "protocol": "0 m/s for 1 s"})
        top = orbit(FIG4, 1e-4).isel(time=0)
        initial = {symbol: float(top[symbol]) for symbol in ("V", "theta", "tau")}
        initial["V"] *= 0.1
        loading = rs.Loading.constant(0.0).step(1.0, "100 um/s")
        run = rs.simulate(FIG4, loading, arrays["run_time"][-1], V_start=1e-4, initial=initial)
        assert np.array_equal(arrays["run_V"], run.V)
        assert header["changes"] == [0.0, 1.0]

    def test_the_normal_stress_steps_before_the_kick(self):
        """Under Linker and Dieterich's law: tau and V stay at the step, theta falls."""
        slider = FIG2.replace(alpha=0.2)
        state = PageState(slider, 1e-4, sigma_from=0.9 * slider.sigma, kick=3.0)
        header, arrays = painted(entries_of(state, 15))
        assert arrays["run_stress"][0] == pytest.approx(0.9 * header["steady"], rel=1e-9)
        assert arrays["run_V"][0] == pytest.approx(3e-4, rel=1e-9)
        change = slider.a * np.log(3.0) - slider.alpha * np.log(1.0 / 0.9)
        assert arrays["run_mu"][0] == pytest.approx(header["steady"] + change, rel=1e-9)


class TestExports:
    @pytest.mark.parametrize(
        "more",
        [
            {"protocol": "0 m/s for 2 s; 20 um/s for 3.3 s; 100 um/s for 0.7 s", "kick": "2"},
            {"protocol": "0 m/s at 4.1 MPa for 2 s; 0 m/s for 1 s", "sigma_from": "3.9 MPa"},
            {"sigma_from": "3.9 MPa", "kick": "0.5"},
            {"V_from": "50 um/s"},
        ],
    )
    def test_the_same_run_in_all_forms(self, more, tmp_path):
        texts = STICK_SLIP | more
        _, arrays = painted(texts)
        forms = {
            k: exports.export(wire.Question(1, k, texts), Deadline(20.0))["content"].decode()
            for k in ("scenario", "python", "csv")
        }
        file = tmp_path / "ratestate.toml"
        file.write_text(forms["scenario"])
        loaded = scenario.run(scenario.load(file))
        lines: dict = {}
        exec(forms["python"], lines)
        written = next(v for v in lines.values() if hasattr(v, "data_vars"))
        numbers = np.genfromtxt(forms["csv"].splitlines(), delimiter=",", skip_header=1)
        header = forms["csv"].split("\n")[0].split(",")
        assert np.array_equal(loaded.V, arrays["run_V"])
        assert np.array_equal(written.V, loaded.V)
        assert np.array_equal(written.tau, loaded.tau)
        assert np.array_equal(numbers[:, header.index("V [m/s]")], loaded.V)
        assert numbers[:, 0].tolist() == loaded.time.values.tolist()
