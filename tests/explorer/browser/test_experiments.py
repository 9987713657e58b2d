"""Experiments on the page: their buttons, and the list of what they have made."""

from urllib.parse import parse_qsl

import numpy as np
import pytest
from explorer_links import CASES

from ratestate import scenario
from ratestate_explorer import state

#: stable sliding
STEADY = CASES["steady"]
ROWS = """() => [...document.querySelectorAll('#protocol tbody tr')].map(row =>
    [...row.children].map(cell => { const input = cell.querySelector('input');
        return input ? input.value || `(${input.placeholder})` : cell.textContent }))"""


def rows(shown):
    """The list as it is read, what is empty with its placeholder in parentheses."""
    return shown.page.evaluate(ROWS)


def linked(shown, name):
    """An entry of the link."""
    return dict(parse_qsl(shown.copied_link())).get(name)


def press(shown, *buttons):
    for button in buttons:
        shown.page.click(f"#{button}")
        shown.wait()


def edit(shown, label, text):
    shown.page.fill(f"[aria-label='{label}']", text)
    shown.page.press(f"[aria-label='{label}']", "Enter")


def test_a_velocity_step_and_back(show):
    shown = show()
    shown.page.fill("#factor-V_lp", "nonsense")
    shown.page.click("#step-V_lp")
    assert "Give a number > 0" in shown.text("#problem-factor-V_lp")
    for wrong in ("1/0", "1/2/3", "/2", "2/2"):
        shown.page.fill("#factor-V_lp", wrong)
        shown.page.click("#step-V_lp")
        assert f"factor = '{wrong}' cannot be used" in shown.text("#problem-factor-V_lp")
    shown.page.fill("#factor-V_lp", "1/2")
    # takes it in; the button steps, by a double click too
    shown.page.press("#factor-V_lp", "Enter")
    shown.page.dblclick("#step-V_lp")
    shown.wait()
    assert shown.entry("V_lp") == "50 \u00b5m/s"
    assert "Stepped from 100 \u00b5m/s to 50 \u00b5m/s" in shown.text("#stepped")
    assert not shown.page.is_visible("#problem-factor-V_lp")
    shown.page.click("#unstep")
    shown.wait()
    assert shown.entry("V_lp") == "100 \u00b5m/s"
    assert not shown.page.is_visible("#stepped")
    # a link may have both at once, and both are undone together
    shown.go(f"{STEADY}&V_from=0.1 mm/s&sigma_from=1.9 MPa")
    assert shown.text("#stepped").startswith(
        "Stepped from 0.1 mm/s to 0.3 mm/s, and from 1.9 MPa to 2 MPa at time 0."
    )
    saved = scenario.loads(shown.saved("scenario").read_text())
    assert saved.slider.sigma == 1.9e6
    at_end = saved.settings["loading"].sigma(saved.settings["t_end"], saved.slider.sigma)
    assert float(at_end) == 2e6
    shown.page.click("#unstep")
    shown.wait()
    assert [shown.entry(symbol) for symbol in ("V_lp", "sigma")] == ["0.1 mm/s", "1.9 MPa"]
    assert not shown.page.is_visible("#stepped")


def test_a_step_follows_another(show):
    shown = show(STEADY)
    charts = """() => ['verdict', 'traces', 'map', 'phase'].map(id =>
        JSON.stringify(document.getElementById(id).getBoundingClientRect()))"""
    before = shown.page.evaluate(charts)
    press(shown, "step-V_lp", "step-sigma")
    assert rows(shown)[0] == ["before", "300 \u00b5m/s", "2 MPa", "settled"]
    first = rows(shown)[1]
    assert first[:3] == ["1", "900 \u00b5m/s", "(2 MPa)"]
    # it lasts as long as its motion was shown
    lasting = first[3]
    assert rows(shown)[2:] == [["then", "900 \u00b5m/s", "2.2 MPa", "on"]]
    assert not shown.page.is_visible("#stepped")
    press(shown, "step-V_lp")
    assert shown.page.evaluate(charts) == before
    assert rows(shown)[2][:3] == ["2", "900 \u00b5m/s", "2.2 MPa"]
    assert shown.entry("V_lp") == "2.7 mm/s"
    text = linked(shown, "protocol")
    assert text.startswith(f"900 um/s for {lasting}; 900 um/s at 2.2 MPa for ")
    loading = scenario.loads(shown.saved("scenario").read_text()).settings["loading"]
    assert loading.V.tolist() == [3e-4, 9e-4, 2.7e-3]
    durations = [segment.duration for segment in state.segments_of(text)]
    stress = loading.normal_stress
    assert stress.t[1] - loading.t[1] == pytest.approx(durations[0], rel=1e-12)
    assert loading.t[2] - stress.t[1] == pytest.approx(durations[1], rel=1e-12)


def test_holds_and_kicks_and_none_of_them(show):
    shown = show(STEADY)
    press(shown, "hold")
    assert linked(shown, "protocol") == "0 m/s for 100 s"
    assert rows(shown) == [
        ["before", "(0.3 mm/s)", "settled"],
        ["1", "0 m/s", "100 s", "\u00d7"],
        ["then", "0.3 mm/s", "on"],
    ]
    shown.page.fill("#factor-kick", "1")
    shown.page.click("#kick")
    assert "Give a number > 0 that is not 1" in shown.text("#problem-factor-kick")
    shown.page.fill("#factor-kick", "1/2")
    press(shown, "kick")
    assert not shown.page.is_visible("#problem-factor-kick")
    assert rows(shown)[1] == ["kick", "0.5", "\u00d7 V", "\u00d7"]
    press(shown, "clear")
    assert not shown.page.is_visible("#experiment")
    assert [linked(shown, name) for name in ("protocol", "kick")] == [None, None]
    # in place of a mere step a kick follows the motion as it is now
    press(shown, "step-V_lp", "kick")
    assert rows(shown)[0] == ["before", "(900 \u00b5m/s)", "settled"]
    assert linked(shown, "V_from") is None
    # which then goes on, and another hold after it
    shown.page.fill("#hold-time", "2 min")
    press(shown, "hold")
    assert [row[0] for row in rows(shown)] == ["before", "kick", "1", "2", "then"]
    assert rows(shown)[3][1:3] == ["0 m/s", "2 min"]
    other = show(shown.copied_link())
    assert rows(other) == rows(shown)
    assert other.text("#headline") == shown.text("#headline")


def test_slide_hold_slide_slips_enough_between_longer_and_longer_holds(show):
    shown = show(STEADY)
    shown.page.fill("#hold-time", "5 MPa")
    shown.page.click("#slide-hold-slide")
    shown.page.wait_for_selector("#problem-hold-time:visible")
    assert "hold = '5 MPa' is a stress. Give a time" in shown.text("#problem-hold-time")
    shown.page.fill("#hold-time", "30")
    shown.page.click("#slide-hold-slide")
    shown.page.wait_for_selector("[aria-label='Remove segment 5']")
    shown.wait()
    segments = state.segments_of(linked(shown, "protocol"))
    assert [s.duration for s in segments[::2]] == [3.0, 30.0, 300.0]
    assert [s.V for s in segments] == pytest.approx([0.0, 3e-4] * 2 + [0.0])
    table = np.genfromtxt(shown.saved("csv"), delimiter=",", names=True)
    time = table["time_s"] - table["time_s"][0]
    saved = table["delta_m"]
    begin = 0.2 * time[-1]  # the time before time 0
    ends = begin + np.cumsum([s.duration for s in segments])
    for i in (1, 3):
        slipped = np.diff(np.interp([ends[i - 1], ends[i]], time, saved))[0]
        assert 20.0 < slipped / 10e-6 < 40.0


def test_the_list_of_segments_can_be_edited(show):
    shown = show(f"{STEADY}&protocol=0 m/s for 10 s; 1 um/s for 20 s")
    edit(shown, "speed of segment 2", "2e-6")
    shown.wait()
    assert linked(shown, "protocol") == "0 m/s for 10 s; 2e-6 m/s for 20 s"
    edit(shown, "duration of segment 2", "-3 s")
    shown.page.wait_for_selector("#problem-protocol:visible")
    assert "duration of segment 2 = '-3 s' must be > 0" in shown.text("#problem-protocol")
    invalid = "all => all.map(e => e.ariaLabel)"
    wrong = "#protocol [aria-invalid=true]"
    assert shown.page.eval_on_selector_all(wrong, invalid) == ["duration of segment 2"]
    shown.page.wait_for_selector("#stale:visible")
    assert shown.text("#stale").endswith("Correct protocol.")
    shown.page.click("#hold")
    assert shown.text("#problem-hold-time") == "correct protocol first"
    edit(shown, "duration of segment 2", "3 ms")
    shown.page.wait_for_selector("#problem-protocol", state="hidden")
    shown.wait()
    assert shown.page.eval_on_selector_all(wrong, invalid) == []
    press(shown, "add-segment")
    active = "document.activeElement.ariaLabel"
    assert shown.page.evaluate(active) == "speed of segment 3"
    assert rows(shown)[3][1] == "300 \u00b5m/s"
    edit(shown, "speed before time 0", "0.2 mm/s")
    shown.wait()
    assert linked(shown, "V_from") == "0.2 mm/s"
    edit(shown, "speed before time 0", "0 m/s")
    shown.page.wait_for_selector("#problem-V_from:visible")
    assert "V_from = '0 m/s' must be > 0" in shown.text("#problem-V_from")
    edit(shown, "speed before time 0", "")
    shown.wait()
    assert rows(shown)[0] == ["before", "(0.3 mm/s)", "settled"]
    shown.page.click("[aria-label='Remove segment 2']")
    shown.wait()
    assert shown.page.evaluate(active) == "speed of segment 2"
    for number in (2, 1):
        shown.page.click(f"[aria-label='Remove segment {number}']")
    shown.wait()
    assert not shown.page.is_visible("#experiment")
    # what follows the fields is seen to do so
    shown.page.click("#hold")
    shown.type("V_lp", "0.25 mm/s")
    assert rows(shown)[0][1] == "(0.25 mm/s)"
    assert rows(shown)[-1][1] == "0.25 mm/s"


def test_what_the_load_point_does_is_drawn(modules):
    """Of a hold nothing is drawn on a logarithmic axis; a line is at each change."""
    speeds = """() => import('/js/common/changes.js').then(({ changes, speedOf }) => {
        const values = { V_from: null, V_lp: 3, protocol: [[0, null, 2], [1, null, 1]] };
        const picture = { changes: [0, 2, 3], values, arrays: { run_time: [-1, 4] } };
        const at = [];
        const get = (_, name) => name === 'moveTo' ? x => at.push(x) : () => {};
        const ctx = new Proxy({}, { get, set: () => true });
        changes.draw({ ctx, bbox: { top: 0, height: 1 } }, 'speed', x => 10 * x, null, picture);
        picture.arrays.run_time = [0, 4];
        changes.draw({ ctx, bbox: { top: 0, height: 1 } }, 'speed', x => 100 * x, null, picture);
        return [[-1, 0, 1.9, 2, 3, 4].map(speedOf(picture)), at] })"""
    assert modules.evaluate(speeds) == [[3, 0, 0, 1, 3, 3], [0, 20, 30, 200, 300]]
