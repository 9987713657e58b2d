"""Playing the run: block and spring, slips in slow motion, one instant on all charts."""

import numpy as np
import pytest
from explorer_links import CASES

from ratestate_explorer import entries, picture
from ratestate_explorer.deadline import Deadline
from ratestate_explorer.menus import presets

STEPS = 2000  # of the slider
#: frames are drawn when a test says so, at the times that it says
FRAMES = """() => { const queue = new Map(); let count = 0;
    window.requestAnimationFrame = (f) => { queue.set(++count, f); return count };
    window.cancelAnimationFrame = (id) => queue.delete(id);
    window.waiting = () => queue.size;
    let now = 0;
    window.draw = (frames, ms) => { for (let k = 0; k < frames; k += 1) {
        const due = [...queue.values()];
        queue.clear(); now += ms; due.forEach((f) => f(now)) } } }"""
SCRUB = """value => { const slider = document.querySelector('#played');
    slider.value = value; slider.dispatchEvent(new Event('input')) }"""
#: where the dots on the traces and the point on the phase plane are, in px of the window
MARKS = """() => Object.fromEntries([...document.querySelectorAll('.dot'),
    document.querySelector('#phase-point')].map((e) => { const box = e.getBoundingClientRect();
    return [e.id || e.className.slice(4),
            e.hidden ? null : [box.x + box.width / 2, box.y + box.height / 2]] }))"""
#: Of the arrays of a run: a Pace, its scale in a view of 600 px, and what is asked of them
OF_RUN = """async ({ arrays, window, shares, times }) => {
    const { Pace } = await import('/js/motion/pace.js');
    const { placesAt, scaleOf } = await import('/js/motion/places.js');
    for (const name in arrays) arrays[name] = Float64Array.from(arrays[name]);
    const pace = new Pace(arrays, window ?? [-Infinity, Infinity]);
    const scale = scaleOf(arrays, pace, 600);
    return { scale, duration: pace.duration, times: shares.map((s) => pace.timeAt(s)),
             factors: shares.map((s) => pace.factorAt(s)),
             back: shares.map((s) => pace.shareAt(pace.timeAt(s))),
             places: times.map((t) => placesAt(arrays, scale, t, 600)) } }"""


def arrays_of(number):
    """What the server sends for a preset."""
    texts = presets()[number]["entries"]
    return picture.picture(entries.state_of(texts), Deadline(60.0))[1]


def lengths_of(arrays):
    """Length of the curve of t, tau/sigma and log V, each over its range, up to each point."""
    columns = arrays["run_time"], arrays["run_stress"], np.log(arrays["run_V"])
    steps = sum((np.diff(column) / np.ptp(column)) ** 2 for column in columns)
    return np.concatenate([[0.0], np.cumsum(np.sqrt(steps))])


def evaluated(page, arrays, shares=(), times=(), window=None):
    sent = {name: a.tolist() for name, a in arrays.items() if name.startswith("run_")}
    return page.evaluate(
        OF_RUN, {"arrays": sent, "shares": [*shares], "times": [*times], "window": window}
    )


def test_slips_have_half_of_the_playing_time(modules):
    """Of the time of the run they have less than one part in 100."""
    arrays = arrays_of(0)
    lengths = lengths_of(arrays)
    shares = np.linspace(0.0, 1.0, 2001)
    found = evaluated(modules, arrays, shares)
    times = np.interp(shares * lengths[-1], lengths, arrays["run_time"])
    assert found["times"] == pytest.approx(times, rel=0.0, abs=1e-9 * arrays["run_time"][-1])
    assert found["back"] == pytest.approx(shares, rel=0.0, abs=1e-9)
    assert found["duration"] == pytest.approx(lengths[-1] / 2.0, rel=1e-9)
    slipping = np.interp(times, arrays["run_time"], arrays["run_V"]) > 1e-3
    assert 0.4 < slipping.mean() < 0.6
    evenly = np.linspace(*arrays["run_time"][[0, -1]], 20001)
    assert (np.interp(evenly, arrays["run_time"], arrays["run_V"]) > 1e-3).mean() < 0.01
    # and the pace is told as it is
    span = 0.1 / found["duration"]
    within = (shares > span) & (shares < 1.0 - span)
    ends = [
        np.interp((shares + way * span) * lengths[-1], lengths, arrays["run_time"])
        for way in (-1.0, 1.0)
    ]
    assert np.array(found["factors"])[within] == pytest.approx(
        ((ends[1] - ends[0]) / 0.2)[within], rel=1e-6
    )
    assert min(found["factors"]) < 1e-2 < 1.0 < max(found["factors"])


def test_a_short_curve_is_played_for_six_seconds_and_a_jump_in_no_time(modules):
    arrays = arrays_of(6)  # a step of the speed under a rigid drive: V and mu jump
    lengths = lengths_of(arrays)
    jump = np.argmin(np.diff(arrays["run_time"]))
    assert lengths[jump + 1] - lengths[jump] > 1.0
    found = evaluated(modules, arrays, np.linspace(0.0, 1.0, 601))
    assert found["duration"] == 6.0
    assert min(found["factors"]) > 1e-3
    # a window is played alone
    last = arrays["run_time"][-1]
    found = evaluated(modules, arrays, [0.0, 0.5, 1.0], window=[0.5 * last, 0.75 * last])
    assert found["times"][::2] == pytest.approx([0.5 * last, 0.75 * last], rel=1e-12)
    assert 0.5 * last < found["times"][1] < 0.75 * last


@pytest.mark.parametrize(
    ("factor", "text"),
    [
        (1.0, "real time"),
        (1.04, "real time"),
        (0.96, "real time"),
        (1.06, "1.1 times faster"),
        (0.94, "slowed 1.1 times"),
        (12.0, "12 times faster"),
        (1 / 32e6, "slowed 3.2\u00b710\u2077 times"),
    ],
)
def test_the_pace_of_playback_is_described_in_words(modules, factor, text):
    words = "async (factor) => (await import('/js/motion/pace.js')).paceText(factor)"
    assert modules.evaluate(words, factor) == text


def test_block_and_load_point_are_where_the_run_has_them(modules):
    """Lengths of the spring from tau/K, which the page does not use."""
    arrays = arrays_of(0)
    time, stress = arrays["run_time"], arrays["run_stress"]
    picked = slice(None, None, 97)
    found = evaluated(modules, arrays, times=time[picked])
    block, ground = (
        np.array([place[name] for place in found["places"]]) for name in ("block", "ground")
    )
    load_point = 600.0 * (1.0 - 0.12)
    assert {place["loadPoint"] for place in found["places"]} == {load_point}
    change = 4e6 * (stress - stress.min()) / 0.96e9
    scale = 0.42 * 600.0 / change.max()
    spring = load_point - block
    assert spring == pytest.approx(0.16 * 600.0 + scale * change[picked], abs=1e-6)
    # marks pass as the load point moves, and the block stays with them while it sticks
    assert found["scale"]["ground"] == found["scale"]["spring"] == pytest.approx(scale)
    assert load_point - ground == pytest.approx(scale * 1e-4 * time[picked], abs=1e-6)
    assert np.diff(block - ground) == pytest.approx(
        scale * np.diff(arrays["run_slip"][picked]), abs=1e-6
    )
    assert 36.0 <= found["scale"]["apart"] * scale <= 90.0


def test_the_ground_passes_no_faster_than_the_eye_follows(modules):
    arrays = arrays_of(2)  # the block moves far, and the spring hardly changes
    shares = np.linspace(0.0, 1.0, 401)
    found = evaluated(modules, arrays, shares)
    scale = found["scale"]
    assert scale["spring"] / scale["ground"] > 3.0
    way = np.interp(found["times"], arrays["run_time"], arrays["run_load"])
    fastest = np.diff(way).max() * 400 / found["duration"]
    assert fastest * scale["ground"] == pytest.approx(22 * 36.0, rel=1e-6)
    # under a rigid drive there is only the ground that moves
    arrays = arrays_of(6)
    found = evaluated(modules, arrays, times=arrays["run_time"][::50])
    assert {place["block"] for place in found["places"]} == {600.0 * (1.0 - 0.12 - 0.16)}
    assert found["places"][0]["ground"] - found["places"][-1]["ground"] > 100.0


def time_told(shown):
    """Seconds in the readout."""
    return float(shown.text("#readout").split("t = ")[1].split(" ")[0])


def test_a_run_is_played_frame_by_frame(show):
    shown = show()
    page = shown.page
    arrays = arrays_of(0)
    lengths = lengths_of(arrays)

    def share():
        return int(page.input_value("#played")) / STEPS

    page.evaluate(FRAMES)
    # nothing moves by itself
    assert (shown.text("#play"), share(), page.evaluate("waiting()")) == ("Play", 0.0, 0)
    assert "t =" not in shown.text("#readout")
    page.focus("#play")
    page.keyboard.press("Space")
    assert shown.text("#play") == "Pause"
    page.evaluate("draw(1, 20)")  # the first frame has no time before it
    assert time_told(shown) == 0.0
    page.evaluate("draw(50, 80)")
    assert share() == pytest.approx(4.0 / (lengths[-1] / 2.0), abs=1.0 / STEPS)
    t = np.interp(2.0 * 4.0, lengths, arrays["run_time"])
    assert time_told(shown) == pytest.approx(t, rel=1e-4)
    # a quarter as fast; and a browser that was away goes on where it was
    before = share()
    page.select_option("#playing-speed", "0.25")
    page.evaluate("draw(50, 80)")
    assert share() - before == pytest.approx(1.0 / (lengths[-1] / 2.0), abs=1.5 / STEPS)
    before = share()
    page.evaluate("draw(1, 60_000)")
    assert share() - before == pytest.approx(0.1 * 0.25 / (lengths[-1] / 2.0), abs=1.5 / STEPS)
    # other parameters while it plays: at the same share of the run, and on it goes
    before, told = share(), time_told(shown)
    page.fill("#entry-V_lp", "50 um/s")
    page.press("#entry-V_lp", "Enter")
    page.wait_for_function(
        """() => { draw(1, 0); const { asked, drawn } = document.body.dataset;
        return Number(drawn) >= Number(asked) }"""
    )
    assert share() == pytest.approx(before, abs=1.5 / STEPS)
    assert time_told(shown) > 1.5 * told
    page.evaluate("draw(50, 20)")
    assert share() > before
    assert page.evaluate("waiting()") == 1
    # paused, no frame is asked for
    page.focus("#play")
    page.keyboard.press("Space")
    assert (shown.text("#play"), page.evaluate("waiting()")) == ("Play", 0)
    told = time_told(shown)
    page.evaluate("draw(5, 20)")
    assert time_told(shown) == told


def test_playback_repeats_unless_reduced_motion_is_preferred(show):
    shown = show()
    page = shown.page
    for reduced, ends in (("no-preference", False), ("reduce", True)):
        page.emulate_media(reduced_motion=reduced)
        if ends:
            page.reload()
            shown.wait()
        page.wait_for_timeout(100)
        assert (shown.text("#play"), page.input_value("#played")) == ("Play", "0")
        page.evaluate(FRAMES)
        page.evaluate(SCRUB, STEPS - 2)
        page.focus("#played")
        page.keyboard.press("Space")
        page.evaluate("draw(20, 20)")
        assert (shown.text("#play") == "Play") == ends
        assert page.evaluate("waiting()") == (0 if ends else 1)
        assert (int(page.input_value("#played")) == STEPS) == ends
        page.evaluate("draw(20, 20)")
        page.click("#play")
        page.evaluate("draw(20, 20)")
        # played once more from the start; or paused, soon after it
        assert 10 < int(page.input_value("#played")) < 200


def test_the_slider_scrubs_all_charts(show):
    shown = show()
    thumb = "input => getComputedStyle(input).getPropertyValue('--thumb')"
    for slider in ("#played", "#volume", "#slider-K"):  # without it there is none to be seen
        assert shown.page.eval_on_selector(slider, thumb) == "1rem"
    page = shown.page
    arrays = arrays_of(0)
    lengths = lengths_of(arrays)
    still = page.evaluate("document.querySelector('#machine').toDataURL()")
    page.evaluate(SCRUB, 1000)
    t = float(np.interp(0.5 * lengths[-1], lengths, arrays["run_time"]))
    assert time_told(shown) == pytest.approx(t, rel=1e-4)
    V = np.exp(np.interp(t, arrays["run_time"], np.log(arrays["run_V"])))
    assert page.evaluate("document.querySelector('#machine').toDataURL()") != still
    marks = page.evaluate(MARKS)
    assert marks["stress"][0] == marks["friction"][0] == pytest.approx(marks["speed"][0], abs=0.01)
    box = page.locator("#speed-chart .u-over").bounding_box()
    across = (t - arrays["run_time"][0]) / np.ptp(arrays["run_time"])
    assert marks["speed"][0] == pytest.approx(box["x"] + across * box["width"], abs=0.1)
    # (the axis has 6 % of room at both ends)
    logs = np.log(arrays["run_V"])
    up = (0.06 + (np.log(V) - logs.min()) / np.ptp(logs)) / 1.12
    assert marks["speed"][1] == pytest.approx(box["y"] + (1 - up) * box["height"], abs=0.1)
    # by keys
    page.focus("#played")
    page.keyboard.press("ArrowRight")
    t = float(np.interp(1001 / STEPS * lengths[-1], lengths, arrays["run_time"]))
    assert time_told(shown) == pytest.approx(t, rel=1e-4)
    assert page.get_attribute("#played", "aria-valuetext") == f"t = {t:.5g} s"
    # zoomed, what is shown is played; the instant stays if it is shown, else that begins
    last = arrays["run_time"][-1]
    assert 0.25 * last < t < 0.5 * last
    for window, at in (((0.25, 0.5), t), ((0.5, 0.8), 0.5 * last)):
        page.mouse.move(box["x"] + window[0] * box["width"], box["y"] + 40)
        page.mouse.down()
        page.mouse.move(box["x"] + window[1] * box["width"], box["y"] + 40, steps=3)
        page.mouse.up()
        page.mouse.move(1, 1)
        assert time_told(shown) == pytest.approx(at, rel=1e-4 if at == t else 0.01)
        for value, share in ((0, window[0]), (STEPS, window[1])):
            page.evaluate(SCRUB, value)
            assert time_told(shown) == pytest.approx(share * last, rel=0.01)
        told = time_told(shown)
        page.click("#unzoom")
        assert time_told(shown) == pytest.approx(told, rel=1e-4)
    assert 0.7 * STEPS < int(page.input_value("#played")) < 0.9 * STEPS


def test_what_is_pointed_at_is_shown_on_all_charts(show):
    shown = show(viewport={"width": 1600, "height": 1200})  # a phase plane of some size
    page = shown.page
    arrays = arrays_of(0)
    page.evaluate(SCRUB, 1850)  # in the last cycle but one or later
    played, at_rest = time_told(shown), page.evaluate(MARKS)
    drawn = page.evaluate("document.querySelector('#machine').toDataURL()")
    # at a trace: the point of the phase plane goes there, and the block moves
    box = page.locator("#stress-chart .u-over").bounding_box()
    page.mouse.move(box["x"] + box["width"] / 3, box["y"] + 20)
    pointed = time_told(shown)
    assert pointed == pytest.approx(arrays["run_time"][-1] / 3, rel=5e-3)
    marks = page.evaluate(MARKS)
    assert page.evaluate("document.querySelector('#machine').toDataURL()") != drawn
    stress = np.interp(pointed, arrays["run_time"], arrays["run_stress"])
    ends = arrays["cycle_stress"].min(), arrays["cycle_stress"].max()
    plane = page.locator("#phase-canvas").bounding_box()
    across = (0.07 + (stress - ends[0]) / (ends[1] - ends[0])) / 1.14
    assert marks["phase-point"][0] == pytest.approx(
        plane["x"] + 64 + across * (plane["width"] - 76), abs=1.0
    )
    # gone, it is where it was played
    page.mouse.move(1, 1)
    assert (time_told(shown), page.evaluate(MARKS)) == (played, at_rest)
    # at the phase plane: the line of the traces goes there, of the last passage
    page.evaluate(SCRUB, 300)
    page.mouse.move(*at_rest["phase-point"])
    assert time_told(shown) > arrays["run_time"][-1] - 2.4  # a period is 2.385 s
    found = page.evaluate(MARKS)
    for chart in ("phase-point", "stress", "speed"):
        assert found[chart][1] == pytest.approx(at_rest[chart][1], abs=3.0), chart
    # up to 24 px from the curve, here its left side, inward
    left = int(np.argmin(arrays["cycle_stress"]))
    logs = np.log(arrays["cycle_V"])
    up = (0.07 + (logs[left] - logs.min()) / np.ptp(logs)) / 1.14
    x = plane["x"] + 64 + 0.07 / 1.14 * (plane["width"] - 76)
    y = plane["y"] + 8 + (1 - up) * (plane["height"] - 48)
    page.mouse.move(1, 1)
    scrubbed = time_told(shown)
    for far, near in ((21, True), (28, False)):
        page.mouse.move(x + far, y)
        assert (time_told(shown) != scrubbed) == near, far
    page.mouse.move(plane["x"] + 20, y)  # beside the axes there is nothing to point at
    assert time_told(shown) == scrubbed


def test_a_load_point_that_is_held_has_no_arrow(show):
    shown = show(f"{CASES['steady']}&protocol=0 m/s for 1 s")
    page = shown.page
    box = page.locator("#stress-chart .u-over").bounding_box()
    beside = """() => { const c = document.querySelector('#machine');
        const copy = new OffscreenCanvas(c.width, c.height).getContext('2d');
        copy.drawImage(c, 0, 0);
        const x = Math.ceil(c.width * (1 - 0.12) + 4), y = c.height - 24;
        const { data } = copy.getImageData(x, 0, c.width - x, y - 2);
        return data.filter((value, i) => i % 4 === 0 && value < 128).length }"""
    inked = {}
    for step in range(1, 12):
        page.mouse.move(box["x"] + step / 12 * box["width"], box["y"] + 20)
        t, unit = shown.text("#readout").split("t = ")[1].split(" ")
        held = 0.0 < float(t) < {"s": 1.0, "ms": 1000.0}[unit]
        inked.setdefault(held, []).append(page.evaluate(beside))
    assert set(inked[True]) == {0}
    assert min(inked[False]) > 40


def test_the_nearest_place_is_that_of_the_last_passage(modules):
    find = """async ([xs, ys, x, y, slack]) =>
        (await import('/js/curves/nearest.js')).nearest(xs, ys, x, y, slack)"""
    there_and_back = [[0.0, 10.0, 20.0, 10.0, 0.0], [0.0, 0.0, 0.0, 1.0, 1.0]]
    for slack, at in ((0.0, 0.4), (0.9, 0.4), (1.1, 3.6)):
        found = modules.evaluate(find, [*there_and_back, 4.0, -2.0, slack])
        assert found["at"] == pytest.approx(at)
        assert found["distance"] == pytest.approx(2.0 if at < 1 else 3.0)
    assert modules.evaluate(find, [[], [], 1.0, 1.0, 0.0])["distance"] == np.inf


def test_without_a_run_there_is_nothing_to_play(modules):
    played = """async () => {
        const { Playback } = await import('/js/motion/playback.js');
        const { Instant } = await import('/js/motion/instant.js');
        const make = (tag) => document.createElement(tag);
        const elements = { button: make('button'), slider: make('input'), speed: { value: '1',
            addEventListener() {} }, readout: make('span') };
        const instant = new Instant();
        const none = { run_time: [], run_stress: [], run_V: [] };
        const some = { run_time: [0, 1], run_stress: [0, 1], run_V: [1, 2] };
        const typed = (arrays) => ({ arrays: Object.fromEntries(
            Object.entries(arrays).map(([name, values]) => [name, Float64Array.from(values)])) });
        let times = [0, 1];
        const playback = new Playback(elements, instant, () => times);
        const states = [];
        const show = (arrays) => { playback.show(typed(arrays));
            states.push([elements.button.disabled, playback.isPlaying, instant.time,
                         elements.readout.textContent]) };
        show(none);
        show(some);
        playback.play();
        show(some);
        show(none);
        times = [5, 9];  // only something else is shown then
        show(some);
        return states }"""
    states = modules.evaluate(played)
    assert states[0] == [True, False, None, ""]
    assert states[1] == [False, False, None, "slowed 6 times"]
    assert states[2] == [False, True, 0, "slowed 6 times"]
    assert states[3] == [True, False, None, ""]
    assert states[4] == [True, False, None, ""]
