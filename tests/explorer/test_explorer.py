"""The explorer's server: what it answers, what it refuses, what it can bear."""

import contextlib
import http.client
import json
import threading
import time

import numpy as np
import pytest
from explorer_server import page, read, served
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from user_laws import MINE
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

import ratestate as rs
from ratestate import scenario
from ratestate.dynamics.cycles.limit_cycle import orbit
from ratestate.dynamics.simulation.simulate import SimulateCall
from ratestate.engine.backend import Stopped
from ratestate.friction.laws import LAWS
from ratestate.model.units import to_si
from ratestate.paper.parameters import FIG2, FIG4
from ratestate_explorer import (
    answers,
    charts,
    entries,
    exports,
    menus,
    picture,
    run_plan,
    server,
    session,
    wire,
)
from ratestate_explorer.app import MOST_PAGES, Guard
from ratestate_explorer.deadline import Deadline
from ratestate_explorer.entries import PageState, entries_of
from ratestate_explorer.menus import presets
from ratestate_explorer.queues import Kind, kind_of

STICK_SLIP = presets()[0]["entries"]
VIBRATION = entries_of(PageState(FIG2, 3.2e-3))
RUNAWAY = VIBRATION | {"M": "0 kg/m^2", "K": "500 MPa/m"}


def exported(kind, texts):
    return exports.export(wire.Question(1, kind, texts), Deadline(60.0))["content"].decode()


def painted(texts, seconds=10.0):
    return picture.picture(entries.state_of(texts), Deadline(seconds))


#: law -> texts of its own parameters, and the form of friction that it is for
OWN = {
    name: {s: menus.example(s) for s in law.parameters} | {"friction_form": law.form}
    for name, law in LAWS.items()
}


class TestEntries:
    @pytest.mark.parametrize(
        ("field", "text", "said"),
        [
            ("K", "900 MPa", "K = '900 MPa' is a stress. Give a stiffness such as"),
            ("M", "1" * 65, "M has no text of at most 64 characters"),
            ("sigma", 3, "sigma has no text"),
            ("law", "dry", "law = 'dry' is unknown. Choose slip or aging or flash-heating"),
            ("friction_form", "asinh", "'asinh' does not go with law = 'slip'. Choose log or"),
            ("friction_form", 3, "friction_form = '3' does not go"),
            ("friction_form", "x" * 900, f"friction_form = '{'x' * 64}' does not go"),
        ],
    )
    def test_a_problem_is_told_of_its_field(self, field, text, said):
        with pytest.raises(entries.BadEntries) as caught:
            entries.state_of(VIBRATION | {field: text})
        assert list(caught.value.problems) == [field]
        assert said in caught.value.problems[field]

    @pytest.mark.parametrize(
        ("text", "value"),
        [
            *(("500", 500.0), ("0", 0.0), (" 1.e-4 ", 1e-4), ("1_000", None), ("5 5", None)),
            *((text, None) for text in ("nan", "1e", "-5", "1e400", "1e-400", "1e21")),
        ],
    )
    def test_a_number_without_a_unit_is_in_SI(self, text, value):
        values = entries.values_of(VIBRATION | {"M": text})
        assert values is None if value is None else values["M"] == value

    def test_all_problems_at_once(self):
        with pytest.raises(entries.BadEntries) as caught:
            entries.state_of({})
        assert set(caught.value.problems) == {*entries.SYMBOLS, "law"}


class TestLaws:
    @pytest.mark.parametrize("law", ["aging", "two-state-slip", "flash-heating"])
    def test_a_law_is_shown(self, law):
        """The page shows what the library finds, from a step between two motions."""
        texts = STICK_SLIP | OWN[law] | {"law": law, "K": "300 MPa/m", "V_from": "50 um/s"}
        state = entries.state_of(texts)
        assert {s: state.values[s] for s in OWN[law]} == {
            s: text if s == "friction_form" else to_si(s, text) for s, text in OWN[law].items()
        }
        # (also compiles what the picture, of which the time is limited, needs)
        cycle = rs.limit_cycle(state.slider, state.V_lp)
        largest = float(orbit(state.slider, state.V_from).tau.max() / state.slider.sigma)
        stiff = state.slider.replace(K=1e13)
        settled = rs.simulate(stiff, rs.Loading.constant(1e-4), 1e-3, V_start=1e-4)
        steady = rs.stability(state.slider, state.V_lp)
        header, arrays = painted(texts)
        assert header["numbers"]["regime"] == "stick-slip"
        assert header["numbers"]["period"] == pytest.approx(float(cycle.period), rel=1e-6)
        assert header["values"]["law"] == law
        assert header["numbers"]["K_c"] == float(steady.K_c)
        assert header["steady"] == pytest.approx(float(settled.mu[0]), rel=1e-12)
        # until the step, at the stress maximum, it is on the cycle at the speed before
        step = np.searchsorted(arrays["run_time"], 0.0)
        assert arrays["run_stress"][step] == pytest.approx(largest, rel=1e-6)
        text = exported("scenario", texts)
        assert scenario.loads(text).slider == state.slider

    def test_the_page_lists_laws_and_their_fields(self, law_file):
        name = rs.register(law_file(MINE))
        told = {row["name"]: row for row in menus.menu()}
        assert list(told) == [*LAWS]
        own = ["b2", "Dc2", "damping", "alpha"]
        cut_off = ["b2", "Dc2", "V1", "V2", "damping", "alpha"]
        forms = {"log": own, "cut-off": cut_off, "regularized": own}
        assert told["two-state-slip"]["forms"] == forms
        assert [*told["flash-heating"]["forms"]] == ["regularized"]
        assert told["two-state-slip"]["label"] == LAWS["two-state-slip"].label
        assert told[name]["names"] == (name, "mine")
        fields = {row["symbol"]: row for row in menus.fields(entries.state_of(VIBRATION).values)}
        assert list(fields)[: len(entries.SYMBOLS)] == [*entries.SYMBOLS]
        name = "critical slip distance of the second state"
        told = {"symbol": "Dc2", "name": name, "unit": "m", "usual": 1e-4, "text": "100 um"}
        assert fields["Dc2"] == told | {"marked": False}
        assert [s for s, row in fields.items() if row["marked"]] == ["M", "K", "V_lp"]
        assert fields["m"]["text"] == "1.5"

    def test_a_users_law_is_known_if_it_was_registered(self, law_file):
        path = law_file(MINE)
        texts = VIBRATION | {"law": "mine", "m": "1.5"}
        with pytest.raises(entries.BadEntries, match=r"law = 'mine' is unknown\. Choose slip or"):
            entries.state_of(texts)
        name = rs.register(path)
        slider = entries.state_of(texts).slider
        assert (slider.law, slider.m) == (name, 1.5)
        shown = entries_of(PageState(slider, 1e-3))
        header, arrays = painted(shown, seconds=120.0)  # it may be compiled
        assert header["sentences"][0].startswith("Steady sliding at 1 mm/s")
        assert arrays["run_time"].size > 10

    @pytest.mark.parametrize("more", [{"law": "mine@12345678"}, {"law_file": "mine.py"}])
    def test_entries_of_a_page_cannot_run_a_law_file(self, more, law_file, tmp_path, monkeypatch):
        law_file("raise SystemExit")
        monkeypatch.chdir(tmp_path)
        with pytest.raises(entries.BadEntries) as caught:
            entries.state_of(VIBRATION | more)
        (said,) = caught.value.problems.values()
        assert said.startswith(f"law = '{more.get('law', 'slip')}' is unknown. Choose slip or")
        assert said.endswith("with your own law: ratestate explore --law-file FILE.py.")


class TestFriction:
    """Forms of friction, damping, and what a step of normal stress does."""

    def test_a_solver_is_chosen_by_law_form_damping_and_stress(self):
        plain = kind_of(entries.state_of(VIBRATION))
        assert plain == ("slip", "log", (), False)
        changes = [{"friction_form": "regularized"}, {"damping": "1 kPa s/m"}, {"law": "aging"}]
        kinds = {kind_of(entries.state_of(VIBRATION | change)) for change in changes}
        assert len(kinds | {plain}) == 4
        for more in ({"kick": "3"}, {"protocol": "0 m/s for 1 s"}):
            assert kind_of(entries.state_of(VIBRATION | more)) == plain
        for more in ({"sigma_from": "3 MPa"}, {"protocol": "1 m/s at 3 MPa for 1 s"}):
            assert kind_of(entries.state_of(VIBRATION | more)) == plain._replace(sigma_varies=True)


class TestWire:
    def test_an_answer_has_a_header_and_arrays(self):
        arrays = {"x": np.arange(3), "y": np.array([True])}
        header, found = read(
            wire.answer(7, "picture", arrays, big=np.inf, n=np.int64(3), text="\u00b5")
        )
        assert header == {
            "id": 7,
            "kind": "picture",
            "big": "Infinity",
            "n": 3,
            "text": "\u00b5",
        }
        assert found["x"].tolist() == [0.0, 1.0, 2.0]
        assert found["y"].tolist() == [1.0]

    @pytest.mark.parametrize(
        "text",
        [
            *("", "{", "[]", "null", "[" * 4000, '{"id": NaN, "ask": "csv"}', "9" * 4090),
            *(
                '{"id": true, "ask": "csv"}',
                '{"id": -1, "ask": "csv"}',
                '{"id": 1e3, "ask": "csv"}',
            ),
            *('{"id": 1, "ask": "rm"}', '{"id": 1, "ask": ["csv"]}', " " * (wire.LONGEST + 1)),
        ],
    )
    def test_malformed_questions_are_refused(self, text):
        with pytest.raises(wire.BadQuestion):
            wire.checked(wire.Question, text)


class TestPicture:
    def test_a_picture_has_the_run_and_the_limit_cycle(self):
        header, arrays = painted(STICK_SLIP)
        cycle = rs.limit_cycle(FIG4, 1e-4)
        assert header["numbers"]["period"] == pytest.approx(float(cycle.period), rel=1e-7)
        assert arrays["cycle_time"][-1] == pytest.approx(float(cycle.period), rel=1e-7)
        for name in ("run", "cycle"):
            late = arrays[f"{name}_stress"][len(arrays[f"{name}_stress"]) // 2 :]
            assert np.ptp(late) == pytest.approx(float(cycle.amplitude), rel=2e-3)
        # it begins in steady sliding at a tenth of the speed
        assert arrays["run_V"][0] == pytest.approx(1e-5, rel=1e-12)
        assert arrays["run_stress"][0] == pytest.approx(0.6 - 0.003 * np.log(1e4), rel=1e-12)
        assert header["steady"] == pytest.approx(0.6 - 0.003 * np.log(1e5), rel=1e-12)

    @pytest.mark.parametrize("V_from", ["50 um/s", "1 nm/s", "1e-15 m/s"])
    def test_a_fifth_of_the_time_shown_is_before_a_step(self, V_from):
        """However slow the motion before: there it rests at its stress maximum."""
        _, arrays = painted(STICK_SLIP | {"V_from": V_from})
        time, tau = arrays["run_time"], arrays["run_stress"]
        assert -time[0] / np.ptp(time) == pytest.approx(0.2, rel=1e-4)
        before = orbit(FIG4, to_si("V_lp", V_from))
        at = np.searchsorted(time, 0.0)
        assert time[at] == 0.0
        assert tau[at] == pytest.approx(float(before.tau[0] / FIG4.sigma), rel=1e-6)
        assert arrays["run_V"][at] == pytest.approx(to_si("V_lp", V_from), rel=1e-3)
        # what comes after the step is seen: slips of the cycle
        assert arrays["run_V"][time > 0.0].max() > 1e-2

    def test_three_cycles_at_most_are_shown_before_a_step(self):
        _, arrays = painted(STICK_SLIP | {"V_from": "1 mm/s", "V_lp": "50 um/s"})
        period = float(rs.limit_cycle(FIG4, 1e-3).period)
        assert -arrays["run_time"][0] == pytest.approx(3.0 * period, rel=1e-5)

    def test_after_a_large_step_of_normal_stress_the_spring_is_seen_to_reload(self):
        """It takes mu (sigma - sigma_from)/(K V_lp), here 17 s, to slip at all."""
        header, arrays = painted(STICK_SLIP | {"sigma_from": "1.3 MPa"}, seconds=120.0)
        period = header["numbers"]["period"]
        reloading = 0.6 * (4e6 - 1.3e6) / (0.96e9 * 1e-4)
        assert 5.0 < (arrays["run_time"][-1] - reloading) / period < 7.0
        late = arrays["run_time"] > reloading + 2.0 * period
        assert np.ptp(arrays["run_stress"][late]) == pytest.approx(
            header["numbers"]["amplitude"], rel=0.01
        )

    def test_a_runaway_is_shown_as_far_as_it_comes(self):
        header, arrays = painted(RUNAWAY)
        assert header["numbers"]["regime"] == "runaway"
        assert "quasi_static_instability" in header["notes"][0]
        assert "SpringSlider" not in header["notes"][0]
        assert arrays["run_V"][-1] > 1e3
        assert "cycle_V" not in arrays

    def test_a_run_that_has_not_settled_is_reported(self):
        cycles, arrays = painted(VIBRATION | {"V_lp": "3.16228 mm/s"})  # V_c is 3.162278 mm/s
        said = "The run shown is 40 cycles long. Its transient has not decayed by then."
        assert said in cycles["notes"]
        period = cycles["numbers"]["period"]
        assert arrays["run_time"][-1] == pytest.approx(40.0 * period, rel=1e-5)
        assert painted(STICK_SLIP)[0]["notes"] == []
        damped, _ = painted(VIBRATION | {"V_lp": "3.16 mm/s"})
        assert "oscillations long. Its transient has not decayed" in damped["notes"][0]

    def test_an_unknown_motion_before_time_0_is_noted(self, monkeypatch):
        attractor = picture._attractor

        def fails_before(slider, V, watch):
            return (rs.SolverError("none"), None) if V == 1e-4 else attractor(slider, V, watch)

        monkeypatch.setattr(picture, "_attractor", fails_before)
        header, _ = painted(STICK_SLIP | {"V_from": "100 um/s", "V_lp": "50 um/s"})
        assert "No limit cycle was found at the speed and normal stress" in header["notes"][0]

    def test_a_run_that_got_nowhere_is_not_tried_again(self, monkeypatch):
        tried = []

        def stopped(call, watch):
            tried.append(call.t_end)
            watch(0.0)
            raise Stopped

        monkeypatch.setattr(picture, "_attractor", lambda *_: (rs.SolverError("none"), None))
        monkeypatch.setattr(SimulateCall, "move", stopped)
        header, _ = painted(VIBRATION)
        assert len(tried) == 1
        assert header["notes"][0].startswith("No run of ")

    def test_a_search_that_takes_too_long_is_reported(self):
        header, arrays = painted(STICK_SLIP, seconds=0.0)
        assert "the search was ended after 0 s" in header["sentences"][0]
        assert header["numbers"]["regime"] == "unknown"
        assert header["notes"][0].startswith("No run of ")
        assert arrays["run_time"].size == 0

    def test_a_cancelled_run_gives_nothing(self, monkeypatch):
        deadline = Deadline(60.0)

        def attractor(*_):
            deadline.set()
            return rs.SolverError("none"), None

        monkeypatch.setattr(run_plan, "SLIP", 1e9)
        monkeypatch.setattr(picture, "_attractor", attractor)
        with pytest.raises(Stopped):
            picture.picture(entries.state_of(VIBRATION), deadline)

    def test_a_failure_of_the_program_is_an_answer_too(self, caplog):
        def fails(question, deadline):
            raise ZeroDivisionError("a bug")

        reply, failed = answers.run_job(fails, wire.Question(3, "csv", {}), Deadline(1.0))
        header, _ = read(reply)
        assert failed
        assert (header["id"], header["kind"]) == (3, "problem")
        assert "internal error" in header["problems"][""]
        assert "a bug" in caplog.text
        caplog.clear()
        ended = Deadline(1.0)
        ended.set()
        with pytest.raises(Stopped):
            answers.run_job(fails, wire.Question(3, "csv", {}), ended)
        assert caplog.text == ""

    @pytest.mark.parametrize(("worked", "ended"), [(0.9, False), (1.1, True)])
    def test_on_a_busy_machine_a_deadline_counts_work(self, worked, ended, monkeypatch):
        """Time of the processor, but for a tenth of all time at least; never more than all."""
        now = {"monotonic": 5.0, "process_time": 3.0}
        for name in now:
            monkeypatch.setattr(time, name, lambda name=name: now[name])
        deadline = Deadline(1.0)
        deadline.start()
        now["monotonic"] += 4.0
        now["process_time"] += worked
        assert deadline.is_set() == ended
        now["monotonic"] += 7.0  # 11 s in all
        assert deadline.is_set()
        deadline.start()
        now["process_time"] += 100.0  # by other questions
        now["monotonic"] += 0.9
        assert not deadline.is_set()

    def test_a_deadline_that_is_restarted_ends_at_its_total_time(self):
        deadline = Deadline(60.0, total=0.05)
        begin = time.monotonic()
        while not deadline.is_set() and time.monotonic() < begin + 5.0:
            deadline.start()
            time.sleep(0.01)
        assert 0.04 < time.monotonic() - begin < 5.0


class TestExports:
    def test_a_run_that_ends_early_is_written_as_far_as_it_comes(self):
        text = exported("csv", RUNAWAY)
        numbers = np.genfromtxt(text.splitlines(), delimiter=",", names=True)
        _, arrays = painted(RUNAWAY)
        assert numbers["time_s"][-1] == arrays["run_time"][-1]
        assert numbers["V_ms"][-1] > 1e3

    def test_long_tables_are_refused_in_words(self, monkeypatch):
        monkeypatch.setattr(exports, "MOST_ROWS", 100)
        with pytest.raises(rs.ParameterError, match="rows, more than the 100 of a download"):
            exported("csv", VIBRATION)


class TestCharts:
    def test_a_chart_is_the_atlas_and_is_kept(self):
        slider = entries.state_of(STICK_SLIP).slider
        header, arrays = charts.chart(slider, 4, Deadline(60.0))
        assert header["key"] == ("slip", 1.6)
        assert arrays["regime"].size == 16
        begin = time.perf_counter()
        again = charts.chart(slider.replace(a=0.0050001), 4, Deadline(0.0))
        assert again[1].keys() == arrays.keys()
        assert all(np.array_equal(again[1][name], arrays[name], equal_nan=True) for name in arrays)
        assert time.perf_counter() - begin < 1.0

    def test_the_curve_is_eq_6(self):
        line = charts.line(FIG4, 1e-4, FIG4.K_c_qs)
        assert np.allclose(line["line_ratio"], 1.0 + line["line_eta"], rtol=1e-14)
        assert charts.SPAN["eta"] == (line["line_eta"][0], line["line_eta"][-1])
        assert charts.line(FIG4.replace(b=0.001), 1e-4, -1.0)["line_eta"].size == 0

    @pytest.mark.parametrize(
        ("changes", "said"),
        [
            ({"b": 0.001}, "b <= a: friction never weakens"),
            (
                {"law": "nagata", "c": 2.0},
                "law = 'nagata' with friction_form = 'log' .* has no map",
            ),
            (
                {"friction_form": "regularized", "damping": 1e3},
                "and damping = 1000 Pa s/m has no map",
            ),
        ],
    )
    def test_a_slider_without_a_map_of_regimes_gets_a_message(self, changes, said):
        with pytest.raises(rs.ParameterError, match=said):
            charts.chart(FIG2.replace(**changes), 4, Deadline(60.0))

    def test_a_window_is_a_part_of_the_atlas(self):
        limits = (0.995, 1.01, 1e-3, 3e-3)
        header, arrays = charts.chart(FIG2.replace(law="aging"), 5, Deadline(120.0), limits)
        part = {"K_over_K_c_qs": limits[:2], "eta": limits[2:]}
        found = rs.atlas(2.0, "aging", n=5, rtol=charts.RTOL, transition=False, **part)
        assert (header["key"], header["size"], header["window"]) == (("aging", 2.0), 5, limits)
        assert header["eta_bautin"] == rs.bautin("aging", 2.0)
        assert np.isfinite(arrays["K_fold_over_K_c_qs"]).any()
        for name, values in arrays.items():
            assert np.array_equal(values, found[name].values.ravel(), equal_nan=True), name

    def test_the_time_for_a_chart_is_bounded(self):
        slider = entries.state_of(VIBRATION).slider
        with pytest.raises(rs.ParameterError, match="60 x 60 points of the map take more than 0 s"):
            charts.chart(slider, 60, Deadline(0.0))
        cancelled = Deadline(60.0)
        cancelled.set()
        with pytest.raises(Stopped):
            charts.chart(slider, 60, cancelled)

    @pytest.mark.parametrize(
        ("a", "b", "ratio"),
        [
            (0.008, 0.009, 1.125),
            (0.008, 0.013, 1.625),
            (0.008, 0.00801, 1.00125),
            (0.001, 0.1, 100.0),
            (0.008, 0.008, None),
            (0.008, -0.001, None),
        ],
    )
    def test_a_picture_names_its_chart(self, a, b, ratio):
        key = charts.key_of(FIG4.replace(a=a, b=b))
        assert (key and key[1]) == (pytest.approx(ratio, rel=1e-12) if ratio else None)


@pytest.fixture(scope="module")
def port():
    with served() as found:
        yield found


def others():
    """Threads that are none of the explorer's pools."""
    return {t.name for t in threading.enumerate() if not t.name.startswith("explorer")}


def drained(socket):
    """Read until the connection ends."""
    while True:
        socket.recv(20)


def answered(socket, number, kinds=("picture", "problem", "file")):
    """The answer to the question of this id."""
    while True:
        header, arrays = read(socket.recv(60))
        if header["id"] == number and header["kind"] in kinds:
            return header, arrays


def ask(socket, number, what="picture", texts=VIBRATION):
    socket.send(json.dumps({"id": number, "ask": what, "entries": texts}))


class TestServer:
    def test_the_newest_question_wins(self, port):
        with page(port) as socket:
            for number in range(1, 41):
                ask(socket, number)
            seen = []
            while 40 not in seen:
                header, _ = read(socket.recv(60))
                seen += [header["id"]] if header["kind"] == "picture" else []
            assert seen == sorted(seen)
            assert len(seen) < 40

    def test_too_many_downloads_are_said(self, port):
        with page(port) as socket:
            for number in range(1, 61):
                ask(socket, number, "csv")
            kinds = {}
            while 60 not in kinds or len(kinds) < 60:
                header, _ = read(socket.recv(60))
                if header["kind"] not in (
                    "preparing",
                    "ready",
                ):  # come to a page that is opened early
                    kinds[header["id"]] = header["kind"]
            assert set(kinds.values()) == {"file", "problem"}
            assert kinds[60] == "file"

    def test_downloads_hold_no_picture_up(self, port, monkeypatch):
        free, begun = threading.Event(), threading.Event()

        def export(*_):
            begun.set()
            assert free.wait(60)
            return {"name": "a", "type": "text/plain", "content": b"b"}

        monkeypatch.setattr(exports, "export", export)
        with page(port) as first, page(port) as second, page(port) as third:
            for socket in (first, second):
                ask(socket, 1, "csv")
            assert begun.wait(30)
            ask(third, 1)
            assert answered(third, 1)[0]["kind"] == "picture"
            free.set()
            assert answered(second, 1)[0]["kind"] == "file"

    def test_repeated_nonsense_closes_the_connection(self, port):
        with page(port) as socket:
            for _ in range(session.NONSENSE - 1):
                socket.send("nonsense")
            ask(socket, 1)
            assert answered(socket, 1)[0]["kind"] == "picture"
            for _ in range(session.NONSENSE):
                socket.send("nonsense")
            with pytest.raises(ConnectionClosed, match="these are not questions"):
                drained(socket)

    def test_a_chart_is_sent_coarse_and_then_fine(self, port, monkeypatch):
        monkeypatch.setattr(charts, "SIZES", (2, 3))
        with page(port) as socket:
            ask(socket, 1, "chart")
            sizes = [answered(socket, 1, ("chart",))[0]["size"] for _ in range(2)]
            assert sizes == [2, 3]

    @pytest.mark.parametrize(
        "origin", [None, "http://evil.example", "https://127.0.0.1", "null", "http://127.0.0.1:1"]
    )
    def test_other_origins_are_refused(self, port, origin):
        with pytest.raises(InvalidStatus) as caught, page(port, origin=origin):
            pass
        assert caught.value.response.status_code == 403

    @pytest.mark.parametrize("host", ["evil.example", "127.0.0.1", "127.0.0.1:1", ""])
    def test_other_hosts_are_refused(self, port, host):
        connection = http.client.HTTPConnection("127.0.0.1", port, timeout=20)
        connection.request("GET", "/", headers={"Host": host})
        response = connection.getresponse()
        assert (response.status, response.read()) == (403, b"not this host's page")
        connection.close()

    def test_the_page_asks_nobody_else(self, port):
        connection = http.client.HTTPConnection("127.0.0.1", port, timeout=20)
        connection.request("GET", "/")
        response = connection.getresponse()
        policy = response.headers["Content-Security-Policy"]
        assert response.status == 200
        assert policy.startswith("default-src 'none'; script-src 'self'")
        assert b"http://" not in response.read()
        above = ("/..", "/%2e%2e", "/..%2f", "/js/../..", "/")
        away = [f"{path}/service/app.py" for path in above]
        for path in ("/vendor/uPlot.LICENSE", "/docs", *away):
            status = 200 if path.startswith("/vendor") else 404
            connection.request("GET", path)
            response = connection.getresponse()
            response.read()
            assert response.status == status, path
        connection.close()

    def test_over_long_messages_close_the_page_alone(self, port):
        with page(port) as other, page(port) as socket:
            socket.send("x" * 100_000)
            with pytest.raises(ConnectionClosed):
                drained(socket)
            ask(other, 1)
            assert answered(other, 1)[0]["kind"] == "picture"

    def test_too_many_pages_are_refused(self, port):
        with contextlib.ExitStack() as stack:
            for _ in range(MOST_PAGES):
                stack.enter_context(page(port))
            uri, origin = f"ws://127.0.0.1:{port}/socket", f"http://127.0.0.1:{port}"
            with connect(uri, origin=origin) as socket:
                with pytest.raises(ConnectionClosed) as caught:
                    socket.recv(20)
                assert caught.value.rcvd.code == 1013
                assert "too many pages" in caught.value.rcvd.reason

    def test_closed_pages_leave_no_threads_or_queues(self, port):
        with page(port) as socket:
            ask(socket, 1)
            answered(socket, 1)
        time.sleep(0.2)
        before = others()
        for _ in range(10):
            with page(port) as socket:
                ask(socket, 1, "csv")
                ask(socket, 2)
        deadline = time.monotonic() + 20.0
        while others() - before and time.monotonic() < deadline:
            time.sleep(0.05)
        assert others() <= before
        ours = [t for t in threading.enumerate() if t.name.startswith("explorer")]
        assert len(ours) <= 4  # those of the pools stay

    def test_no_message_stops_the_server(self, port, monkeypatch):
        monkeypatch.setattr(session, "NONSENSE", 10**6)
        values = st.recursive(
            st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=20),
            lambda inner: (
                st.lists(inner, max_size=4) | st.dictionaries(st.text(), inner, max_size=4)
            ),
            max_leaves=12,
        )
        numbers = ["1e308", "1e-320", "nan", "inf", "-0", "1e999 m", "1 mm/s", "2"]
        texts = st.sampled_from([*numbers, "0 for 1", "1e9 at 1e9 for 1e9; 1e-9 for 1e-9"])
        field = st.sampled_from([*entries.SYMBOLS, "law", *entries.EXPERIMENT, "id", "ask"])
        questions = st.builds(
            lambda ask, changed: json.dumps(
                {"id": 5, "ask": ask, "entries": {**VIBRATION, **changed}}
            ),
            st.sampled_from(wire.ASKS),
            st.dictionaries(field, texts | values, max_size=3),
        )
        messages = st.one_of(
            st.binary(max_size=200),
            st.text(max_size=200),
            values.map(lambda value: json.dumps(value)),
            questions,
        )
        with page(port) as socket:

            @settings(max_examples=30, deadline=None, suppress_health_check=[HealthCheck.too_slow])
            @given(messages)
            def send(message):
                socket.send(message)

            send()
            ask(socket, 77)
            told = []
            while (header := read(socket.recv(60))[0])["id"] != 77:
                told += header.get("problems", {}).values()
            assert header["kind"] == "picture"
            assert [text for text in told if "internal error" in text] == []


class TestServe:
    def test_what_is_prepared_ends_with_the_server(self, monkeypatch, caplog):
        monkeypatch.setattr(session, "answer_chart", lambda *_, **__: 1 / 0)
        shared = session.SharedWork()
        shared.close()
        begin = time.monotonic()
        with pytest.raises(Stopped):
            session.warm_up(Kind("slip", "log", (), False), shared.kernels.deadline)
        assert time.monotonic() - begin < 10.0
        assert caplog.text == ""

    def test_browsers_leave_port_80_out(self):
        assert {"127.0.0.1", "localhost:80"} <= Guard(None, 80).hosts
        assert "http://localhost" in Guard(None, 80).origins
        assert "127.0.0.1" not in Guard(None, 8080).hosts

    def test_a_port_in_use_is_said(self, port):
        with pytest.raises(rs.ParameterError, match=f"port = {port} is in use. Give another"):
            server.listen(port)
        for bad in (-1, 70000, "80", True):
            with pytest.raises(rs.ParameterError, match="whole number from 0 to 65535"):
                server.listen(bad)
