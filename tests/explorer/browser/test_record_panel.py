"""A laboratory record on the page: dropped, laid behind the curve, chosen from, taken away."""

import re

import numpy as np
import pytest
import synthetic_records
from conftest import PAINTED

T = np.arange(0.0, 240.0, 0.2)
STEP_AT = 100.0  # s, of synthetic_records.STEP
#: of synthetic_records.SLIDER what no record has
SLIDER = f"law={synthetic_records.SLIDER.law}&a=0.01&b=0.014&Dc=10 um&K=64 GPa/m&M=0&V0=1 um/s"
#: drop files, [[name, text or number of bytes], ...], on the page
DROP = """files => { const data = new DataTransfer();
    for (const [name, content] of files)
        data.items.add(new File([content.length ? content : new Uint8Array(content)], name));
    for (const kind of ['dragover', 'drop'])
        document.body.dispatchEvent(new DragEvent(kind, { dataTransfer: data, bubbles: true,
            cancelable: true })) }"""


@pytest.fixture(scope="module")
def data():
    return synthetic_records.record(
        synthetic_records.SLIDER, synthetic_records.STEP, T, noise=2e-4, seed=18
    )


@pytest.fixture(scope="module")
def text(data):
    columns = T + 5000.0, data.delta_lp.values * 1e6, data.friction.values, np.full_like(T, 20.0)
    return table(("Time(s)", "disp_um", "mu", "normal stress (MPa)"), columns)


def table(header, columns):
    rows = (",".join(f"{x:.7g}" for x in row) for row in zip(*columns, strict=True))
    return "\n".join([",".join(header), *rows])


def drop(shown, name, content):
    """Drop a file, and wait until it is read or refused."""
    shown.page.evaluate(DROP, [[name, content]])
    shown.page.wait_for_function(
        """() => document.querySelector('#record-progress').hidden
            && !document.querySelector('#record-said').textContent.startsWith('Reading')""",
        timeout=60_000,
    )


def zero(shown):
    return float(shown.page.input_value("#record-zero"))


def readout(shown, chart, fraction):
    """Time [s] and tau/sigma where the pointer is on a chart; what is seen there of the record."""
    box = shown.page.locator(f"{chart} .u-over").bounding_box()
    x = box["x"] + fraction * box["width"]
    shown.page.mouse.move(x, box["y"] + 20)
    shown.page.wait_for_function(
        "() => document.querySelector('#readout').textContent.includes('t = ')"
    )
    found = shown.text("#readout").replace("\N{MINUS SIGN}", "-")
    t, stress = (re.search(rf"{name} = (-?[\d.]+)", found) for name in ("t", "\u03c4/\u03c3"))
    record = shown.page.evaluate(
        """() => { const item = document.querySelector('#readout .record')?.parentElement;
        const low = box => box.getBoundingClientRect().bottom;
        return item && low(item) < low(document.querySelector('#readout')) + 2
            ? item.textContent : '' }"""
    )
    return float(t[1]), float(stress[1]), record


def test_a_record_lies_behind_the_curve(show, text, data):
    shown = show(SLIDER, viewport={"width": 1440, "height": 900})
    page = shown.page
    shown.watch_shifts("#record, #traces, #controls")
    assert shown.painted("#stress-chart canvas", "record").count == 0
    drop(shown, "p1234.csv", text)
    said = "p1234.csv: velocity step 1 \u2192 10 \u00b5m/s at 5100.0 s"
    assert shown.text("#record-said").startswith(said)
    assert zero(shown) == pytest.approx(5000.0 + STEP_AT, abs=0.05)
    assert "p1234.csv" in shown.text("#readout")
    wanted = f"chart => ({PAINTED})(chart).count > 200"
    page.wait_for_function(wanted, arg=["#stress-chart canvas", "record"])
    assert shown.painted("#speed-chart canvas", "record").count > 100
    # its conditions: the speeds, and the normal stress, of the step
    page.click("#record-conditions")
    page.wait_for_function("() => !document.querySelector('#experiment').hidden")
    shown.wait()
    assert (shown.entry("V_lp"), shown.entry("sigma")) == ("10 \u00b5m/s", "20 MPa")
    assert "1 \u00b5m/s" in shown.text("#stepped").replace("1.000", "1")
    # where the pointer is, the legend has its friction, which is the run's
    for fraction in (0.1, 0.3, 0.5, 0.9):
        t, stress, friction = readout(shown, "#stress-chart", fraction)
        expected = np.interp(t + zero(shown) - 5000.0, T, data.friction)
        assert float(friction) == pytest.approx(expected, abs=1e-4)
        assert float(friction) == pytest.approx(stress, abs=1e-3)
    # the whole of it
    first, *_ = readout(shown, "#stress-chart", 0.001)
    assert first > -50.0
    page.check("#record-whole")
    first, *_ = readout(shown, "#stress-chart", 0.001)
    assert first == pytest.approx(-STEP_AT, abs=1.0)
    page.uncheck("#record-whole")
    # and none of it
    page.click("#record-remove")
    assert shown.painted("#stress-chart canvas", "record").count == 0
    assert "p1234" not in shown.text("#readout")
    assert page.evaluate("document.activeElement.id") == "record-choose"
    page.keyboard.press("Escape")
    assert not page.is_visible("#record")
    assert page.evaluate("document.activeElement.id") == "record-open"
    assert shown.shifts == []


def test_a_record_is_fitted_where_it_lies(show, text):
    shown = show(SLIDER, viewport={"width": 1440, "height": 900})
    page = shown.page
    drop(shown, "p1234.csv", text)
    page.click("#record-earlier")
    before = zero(shown)
    page.click("#record-fit")
    page.wait_for_function(
        "() => document.querySelector('#record-notes').textContent.startsWith('Fit under the')",
        timeout=60_000,
    )
    said = shown.text("#record-notes").replace(" ", "")
    assert re.search(r"^Fitundertheslip.*law:a=0.01\d*\xb1.*,Dc=.*\xb5m,K=", said), said
    assert zero(shown) == before
    assert shown.text("#record-fit") == "Fit a, b, Dc and K"
    assert "fit" in shown.text("#readout")
    wanted = f"chart => ({PAINTED})(chart).count > 100"
    page.wait_for_function(wanted, arg=["#stress-chart canvas", "fit"])
    # a fit that is stopped leaves what was there
    page.click("#record-fit")
    assert shown.text("#record-fit") == "Stop the fit"
    page.click("#record-fit")
    assert shown.text("#record-fit") == "Fit a, b, Dc and K"
    assert shown.text("#record-notes").replace(" ", "") == said
    assert zero(shown) == before


def test_columns_are_chosen(show, data):
    columns = T, data.delta_lp.values * 1e3, data.friction.values
    shown = show()
    page = shown.page
    drop(shown, "r.csv", table(("clock", "channel A", "channel B"), columns))
    assert shown.text("#record-said").endswith(". Choose the column below.")
    assert page.is_visible("#record-form")
    assert page.is_disabled("#record-conditions")
    for symbol, title in (("time", "clock"), ("delta_lp", "channel A"), ("friction", "channel B")):
        page.select_option(f"#record-column-{symbol}", label=title)
    page.click("#record-form button")
    page.wait_for_function(
        """() => document.querySelector('#record-said').textContent
            .endsWith('has no unit. Choose its unit, or another column, below.')"""
    )
    page.fill("#record-unit-time", "s")
    page.fill("#record-unit-delta_lp", "mm")
    page.fill("#record-from", "50")
    page.click("#record-form button")
    page.wait_for_selector("#record-shown:enabled")
    assert "velocity step 1 \u2192 10 \u00b5m/s at 100.0 s" in shown.text("#record-said")
    page.check("#record-whole")
    first, *_ = readout(shown, "#stress-chart", 0.001)
    assert first == pytest.approx(50.0 - STEP_AT, abs=1.0)
    # another file is another table
    drop(shown, "other.csv", table(("t_s", "disp_mm", "mu"), columns))
    assert shown.text("#record-said").startswith("other.csv: velocity step")
    assert page.input_value("#record-column-time") == ""
    assert page.input_value("#record-from") == ""


def test_a_record_is_shifted_and_stays_until_there_is_another(show, text):
    shown = show("V_from=1 um/s")
    page = shown.page
    page.click("#record-open")
    assert page.evaluate("document.activeElement.id") == "record-choose"
    page.set_input_files(
        "#record-file", {"name": "good.csv", "mimeType": "text/csv", "buffer": text.encode()}
    )
    page.wait_for_selector("#record-shown:enabled")
    begin = zero(shown)
    page.focus("#record-zero")
    page.keyboard.press("ArrowUp")
    step = zero(shown) - begin
    box = [readout(shown, "#stress-chart", fraction)[0] for fraction in (0.002, 0.998)]
    assert 0.005 < step / (box[1] - box[0]) < 0.025
    page.click("#record-later")
    page.click("#record-later")
    assert zero(shown) == pytest.approx(begin - step, rel=1e-7)
    page.click("#record-earlier")
    assert zero(shown) == pytest.approx(begin, rel=1e-7)
    for typed, invalid in (("5050", "false"), ("50x", "true"), ("", "true"), ("5060.5", "false")):
        page.fill("#record-zero", typed)
        page.press("#record-zero", "Enter")
        assert page.get_attribute("#record-zero", "aria-invalid") == invalid
    page.keyboard.press("ArrowDown")
    assert zero(shown) == pytest.approx(5060.5 - step, rel=1e-6)
    # what is no record changes nothing
    for name, content, said in (
        ("r.png", "\x89PNG\0\0", "r.png is neither text nor HDF5 nor MAT"),
        ("empty.txt", 0, "empty.txt is empty. A record has rows such as"),
        ("large.txt", 50_000_001, "the file is larger than the 50 MB that the page takes"),
    ):
        drop(shown, name, content)
        assert shown.text("#record-said").startswith(said)
        assert page.is_visible("#record-said.problem")
    assert not [url for url in shown.requests if "large.txt" in url]
    # the record that there was stays
    assert "good.csv" in shown.text("#readout")
    shown.set("K", "2 GPa/m")
    assert shown.text("#headline").startswith("Steady sliding")
    # of two the newer is read
    page.evaluate(DROP, [["first.csv", text]])
    assert page.is_visible("#record-progress")
    drop(shown, "second.csv", text)
    assert shown.text("#record-said").startswith("second.csv: ")
    assert shown.page.evaluate("document.body.classList.contains('dropping')") is False
    # from a drag files are taken, and nothing else
    over = """kind => { const data = new DataTransfer();
        if (kind === 'file') data.items.add(new File(['1'], 'r'));
        else data.items.add('1', 'text/plain');
        const event = new DragEvent('dragover', { dataTransfer: data, bubbles: true,
            cancelable: true });
        document.body.dispatchEvent(event);
        return [event.defaultPrevented, document.body.classList.contains('dropping')] }"""
    for kind in ("text", "file"):
        assert page.evaluate(over, kind) == [kind == "file"] * 2


#: the lines that a record draws, its range, and its friction at two times
LAYER = """async isLog => { const { LabRecord } = await import('/js/record/record.js');
    const record = new LabRecord(() => {});
    record.set({ name: 'r', begin: 10, arrays: { time: Float64Array.of(0, 10, 20, 30),
        friction: Float64Array.of(0.5, 0.6, 0.7, 0.1), segment_t: Float64Array.of(0, 10, 20),
        segment_V: Float64Array.of(2, 0, 3) } });
    const lines = [];
    const ctx = { beginPath() {}, stroke() {}, moveTo: (x, y) => lines.push(['move', x, y]),
        lineTo: (x, y) => lines.push(['line', x, y]) };
    record.draw({ ctx, scales: { y: { distr: isLog ? 3 : 1 } } }, 'speed', x => x, y => y);
    return { lines, stress: record.range('stress', -6, 6), speed: record.range('speed', -6, 6),
        at: [-10, 5, 20, 21].map(t => record.frictionAt(t)), times: record.times() } }"""


@pytest.mark.parametrize("is_log", [True, False])
def test_a_load_point_that_rests_has_no_place_on_a_logarithmic_axis(modules, is_log):
    found = modules.evaluate(LAYER, is_log)
    first = [["move", -10, 2], ["line", 0, 2]]
    hold, last = [["line", 0, 0], ["line", 10, 0]], [[10, 3], [20, 3]]
    starts = ("move", "line") if is_log else ("line", "line")
    expected = first + ([] if is_log else hold)
    assert found["lines"] == expected + [[s, *p] for s, p in zip(starts, last, strict=True)]
    assert found["stress"] == pytest.approx([0.5, 0.7])  # of what is shown, and one point beyond
    assert found["speed"] == [2, 2]  # of what slides
    assert found["at"] == [0.5, pytest.approx(0.65), pytest.approx(0.1), None]
    assert found["times"] == []
