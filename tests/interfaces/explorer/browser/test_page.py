"""The explorer's page, in a real browser."""

import contextlib
import math
import re
import sys

import latency
import numpy as np
import pytest
from conftest import serving
from websockets.sync.client import connect

import ratestate as rs
from ratestate.interfaces import scenario
from ratestate.interfaces.explorer.app import MOST_PAGES
from ratestate.paper.parameters import FIG4

DRAWN = """() => { const { asked, drawn } = document.body.dataset;
    return asked && Number(drawn) >= Number(asked) }"""
NUMBERS = """() => Object.fromEntries([...document.querySelectorAll('#numbers div')].map(
    group => [group.firstChild.textContent, group.lastChild.textContent]))"""
#: fields of every law and form of friction that links need not have
OF_ALL = ["damping", "alpha"]
INNER = "all => all.map(e => e.innerHTML)"
DOT = """() => { const box = document.querySelector('#dot').getBoundingClientRect();
    return [box.x + box.width / 2, box.y + box.height / 2] }"""


class Shown:
    """A page of the explorer, and what went on in it."""

    def __init__(self, browser, address, fragment="", **look):
        self.context = browser.new_context(
            accept_downloads=True, **{"viewport": {"width": 1280, "height": 860}} | look
        )
        self.context.grant_permissions(["clipboard-read", "clipboard-write"])
        self.page = self.context.new_page()
        self.complaints, self.requests = [], []
        self.page.on("console", lambda m: self.complaints.append(m.text))
        self.page.on("pageerror", lambda e: self.complaints.append(str(e)))
        self.page.on("request", lambda r: self.requests.append(r.url))
        self.page.goto(f"{address}#{fragment}")
        self.wait()

    def wait(self):
        """Until everything asked for is drawn."""
        self.page.wait_for_function(DRAWN, timeout=120_000)

    def type(self, symbol, text):
        self.page.fill(f"#entry-{symbol}", text)
        self.page.press(f"#entry-{symbol}", "Enter")

    def entry(self, symbol):
        return self.page.input_value(f"#entry-{symbol}")

    def text(self, selector):
        return self.page.inner_text(selector).replace("\N{NO-BREAK SPACE}", " ")

    @property
    def numbers(self):
        return self.page.evaluate(NUMBERS)


@pytest.fixture
def show(browser, server):
    """Open pages; in the end, nothing was complained of, and no other host asked."""
    with contextlib.ExitStack() as stack:

        def opened(fragment="", **look):
            shown = Shown(browser, server.address, fragment, **look)
            stack.callback(finish, shown)
            return shown

        def finish(shown):
            shown.context.close()
            assert shown.complaints == []
            assert {url.split("/")[2] for url in shown.requests if url[:5] != "blob:"} == {
                server.address.split("/")[2]
            }

        yield opened


def test_it_opens_with_a_verdict(show):
    shown = show()
    cycle = rs.limit_cycle(FIG4, 1e-4)
    assert shown.text("#headline").startswith("Stick-slip, a cycle every 2.385 s")
    numbers = shown.numbers
    assert numbers["amplitude of \u03c4/\u03c3"] == f"{float(cycle.amplitude):.4g}"
    assert numbers["K/Kc"] == "0.8"
    assert shown.text("#banner") == ""
    for chart in ("#stress-chart canvas", "#speed-chart canvas", "#map-canvas", "#phase-canvas"):
        painted = shown.page.eval_on_selector(
            chart,
            "c => new Set(c.getContext('2d').getImageData(0, 0, c.width, c.height).data).size",
        )
        assert painted > 20, chart


def test_a_typed_value_and_a_law_are_taken(show):
    shown = show()
    shown.type("K", "1.3e3 N/m^2/um")
    shown.page.wait_for_function("() => document.querySelector('#headline').textContent[1] == 't'")
    shown.wait()
    assert shown.text("#headline") == "Steady sliding at 100 \u00b5m/s."
    assert shown.numbers["K/Kc"] == "1.083"
    # that is also what is heard, and nothing else
    shown.page.wait_for_function(
        "() => document.querySelector('#announcement').textContent.startsWith('Steady')"
    )
    assert shown.page.eval_on_selector_all("main [aria-live]", "all => all.length") == 0
    shown.page.select_option("#law", "aging")
    shown.type("K", "0.96 GPa/m")
    shown.wait()
    shown.page.wait_for_function(
        "() => document.querySelector('#headline').textContent.includes('2.777')"
    )


def test_a_slider_by_keyboard_and_how_long_it_takes(show, record_property):
    shown = show()
    shown.page.focus("#slider-V_lp")
    shown.page.keyboard.press("PageUp")
    shown.wait()
    first = float(shown.entry("V_lp").split(" ")[0])
    assert first > 100.0
    shown.page.keyboard.press("ArrowRight")
    shown.wait()
    second = float(shown.entry("V_lp").split(" ")[0])
    assert second / first == pytest.approx(10**0.005, rel=1e-3)
    times = latency.measured(shown.page, latency.CASES["stick-slip"], 20)
    record_property("slider_to_drawn", latency.summary(times))
    sys.stdout.write(f"slider to drawn: {latency.summary(times)}\n")
    assert len(times) == 20


def test_presets_are_the_papers_figures(show):
    shown = show()
    options = shown.page.eval_on_selector_all("#presets option", "all => all.map(o => o.text)")
    assert [text[:6] for text in options[1:]] == ["Fig. 4"] * 2 + ["Fig. 2"] * 3 + [
        "Fig. 6",
        "Fig. 1",
    ]
    shown.page.select_option("#presets", label=options[5])
    shown.wait()
    assert shown.text("#headline").startswith("Quasi-harmonic vibration at 50.59 Hz")
    assert "Stepped from 100 \u00b5m/s to 3.2 mm/s" in shown.text("#stepped")
    shown.page.select_option("#presets", label=options[7])
    shown.wait()
    assert "rigid" in shown.text("#reasons")
    assert shown.entry("K") == "inf Pa/m"


def test_a_wrong_entry_is_explained_and_the_picture_stays(show):
    shown = show()
    before = shown.numbers
    shown.type("Dc", "10 MPa")
    message = shown.page.wait_for_selector("#problem-Dc:visible")
    assert message.inner_text() == (
        "Dc = '10 MPa' is a stress [Pa]; expected a length [m] such as '10 um'"
    )
    assert shown.page.get_attribute("#entry-Dc", "aria-invalid") == "true"
    assert "problem-Dc" in shown.page.get_attribute("#entry-Dc", "aria-describedby")
    assert shown.numbers == before
    shown.type("Dc", "20 um")
    shown.wait()
    assert not shown.page.is_visible("#problem-Dc")
    assert shown.numbers["K/Kc"] == "1.6"


def test_one_wrong_entry_does_not_hold_up_the_others(show):
    shown = show()
    shown.type("M", "500 m")
    shown.page.wait_for_selector("#problem-M:visible")
    # what is right is taken, and said no more of
    shown.type("K", "1 GPa")
    shown.page.wait_for_selector("#problem-K:visible")
    shown.type("K", "1 GPa/m")
    shown.page.wait_for_selector("#problem-K", state="hidden")
    shown.wait()
    assert shown.page.is_visible("#problem-M")
    assert shown.entry("M") == "500 m"
    assert shown.text("#stale") == "Shown: the last valid values (M = 100 kg/m\u00b2); correct M."
    assert float(shown.page.eval_on_selector("#verdict", "e => getComputedStyle(e).opacity")) < 1
    assert shown.numbers["K/Kc"] == "0.8333"
    # steps and keys begin there
    shown.type("V_lp", "1 um/s")
    shown.page.click("#step-V_lp")
    shown.page.wait_for_selector("#stepped:visible")
    assert shown.entry("V_lp") == "3 \u00b5m/s"
    assert "Stepped from 1 \u00b5m/s to 3 \u00b5m/s" in shown.text("#stepped")
    shown.page.fill("#entry-K", "1.1 GPa/m")
    shown.page.focus("#dot")
    shown.page.keyboard.press("ArrowRight")
    shown.page.wait_for_function("() => document.querySelector('#entry-K').value[2] == '1'")
    shown.wait()
    assert shown.entry("K") == f"{1.1 * 10**0.02:.4g} GPa/m"
    # and nothing is taken along
    shown.page.click("#scenario")
    assert shown.text("#banner") == "Nothing was taken along: correct M first."
    shown.type("M", "500 kg/m^2")
    shown.wait()
    assert not shown.page.is_visible("#stale")
    assert shown.text("#banner") == ""


def test_units_are_shown_as_they_are_written_and_linked_in_ascii(show):
    shown = show()
    assert [shown.entry(symbol) for symbol in ("Dc", "M")] == ["10 \u00b5m", "100 kg/m\u00b2"]
    shown.type("Dc", "20 \u03bcm")  # the Greek letter, as some keyboards have it
    shown.wait()
    assert shown.numbers["K/Kc"] == "1.6"
    shown.page.wait_for_function("() => location.hash.includes('Dc=20+um')")
    assert "M=100+kg%2Fm%5E2" in shown.page.evaluate("location.href")
    assert shown.entry("Dc") == "20 \u00b5m"


@pytest.mark.parametrize("pasted", ["1" * 9000, "\u00b5" * 9000])
def test_a_long_text_is_refused_and_the_connection_stays(show, pasted):
    shown = show()
    sockets = []
    shown.page.on("websocket", lambda socket: sockets.append(socket.url))
    shown.type("K", pasted)
    shown.page.wait_for_selector("#problem-K:visible")
    assert "K is longer than 64 characters" in shown.text("#problem-K")
    shown.type("M", "500 kg/m^2")
    shown.wait()
    assert shown.numbers["K/Kc"] == "0.8"
    other = show(f"K={pasted}")  # and so of a link
    assert "longer than 64 characters" in other.text("#problem-K")
    assert sockets == []


def test_one_page_too_many_asks_ever_more_seldom(browser, server):
    address = server.address.replace("http", "ws").rstrip("/") + "/socket"
    with contextlib.ExitStack() as stack:
        for _ in range(MOST_PAGES):
            stack.enter_context(connect(address, origin=server.address.rstrip("/")))
        page = stack.enter_context(contextlib.closing(browser.new_context())).new_page()
        page.goto(server.address)
        for seconds in ("0.5", "1", "2"):
            page.wait_for_function(f"""() => document.querySelector('#banner').textContent
                .includes('too many pages are open; close one); trying again in {seconds} s')""")


def test_what_is_changed_without_a_connection_is_marked(browser):
    with contextlib.ExitStack() as stack:
        with serving() as first:
            shown = Shown(browser, first.address)
            stack.callback(shown.context.close)
        shown.page.wait_for_selector("#banner.lost:visible")
        opacity = "e => getComputedStyle(e).opacity"
        assert shown.page.eval_on_selector("#verdict", opacity) == "1"  # it is of what is shown
        shown.type("K", "2 GPa/m")
        assert float(shown.page.eval_on_selector("#verdict", opacity)) < 1


def test_a_number_in_SI_is_given_its_unit(show):
    shown = show()
    for symbol, text, unit in (
        ("M", "500", "kg/m\u00b2"),
        ("V_lp", "1e-4", "m/s"),
        ("K", "inf", "Pa/m"),
    ):
        shown.type(symbol, text)
        shown.wait()
        assert shown.entry(symbol) == f"{text} {unit}"
    assert shown.text("#banner") == ""


def test_the_dot_is_dragged(show):
    shown = show()
    ratio, eta = float(shown.numbers["K/Kc"]), 5e-6
    x, y = shown.page.evaluate(DOT)
    shown.page.mouse.move(x, y)
    shown.page.mouse.down()
    shown.page.mouse.move(x - 40, y - 30, steps=4)
    shown.page.mouse.up()
    shown.wait()
    found = shown.page.get_attribute("#dot", "aria-label")
    new_ratio, new_eta = found.split("= ")[1].split(",")[0], shown.numbers["\u03b7"]
    width = shown.page.eval_on_selector("#map-canvas", "c => c.clientWidth") - 76
    height = shown.page.eval_on_selector("#map-canvas", "c => c.clientHeight") - 48
    assert math.log10(float(new_ratio) / ratio) == pytest.approx(-40 * 5 / width, abs=0.01)
    moved = 10 ** (30 * 20 / height)
    mantissa, power = re.match(r"([\d.]+)(?:\u00b710(.*))?", new_eta).groups()
    digits = str.maketrans(
        "\u207b\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079", "-0123456789"
    )
    assert float(mantissa) * 10.0 ** int((power or "0").translate(digits)) == pytest.approx(
        eta * moved, rel=0.1
    )
    # K and V_lp are set, M is not
    assert shown.entry("M") == "100 kg/m\u00b2"
    assert shown.entry("V_lp") != "100 \u00b5m/s"
    shown.page.check("[name=drag][value=M]")
    speed = shown.entry("V_lp")
    shown.page.focus("#dot")
    shown.page.keyboard.press("Shift+ArrowUp")
    shown.wait()
    assert float(shown.entry("M").split(" ")[0]) == pytest.approx(100 * 10**0.4, rel=1e-3)
    assert shown.entry("V_lp") == speed


def test_quick_keys_move_the_dot_all_the_way(show):
    shown = show(latency.CASES["steady"])
    speed = float(shown.entry("V_lp").split(" ")[0])
    shown.page.focus("#dot")
    for _ in range(20):
        shown.page.keyboard.press("ArrowRight")
        shown.page.keyboard.press("ArrowDown")
    shown.wait()
    assert float(shown.entry("K").split(" ")[0]) == pytest.approx(0.9 * 10**0.4, rel=1e-3)
    assert float(shown.entry("V_lp").split(" ")[0]) == pytest.approx(
        1e3 * speed / 10**0.4, rel=1e-3
    )


def test_sliders_of_what_has_no_logarithm_begin_near_what_is_usual(show):
    link = latency.CASES["stick-slip"].replace("0.96 GPa", "inf Pa").replace("100 kg", "0 kg")
    shown = show(link)
    assert shown.page.is_visible("text=the slider is beyond the map")
    assert "beyond the map" in shown.page.get_attribute("#dot", "aria-label")
    shown.page.press("#slider-K", "ArrowLeft")
    shown.page.press("#slider-M", "ArrowRight")
    shown.wait()
    K = shown.entry("K").split(" ")
    assert (10 < float(K[0]) < 1000, K[1]) == (True, "GPa/m")
    assert 0.1 < float(shown.entry("M").split(" ")[0]) < 100
    assert shown.page.get_attribute("#slider-K", "aria-valuetext") == shown.entry("K")
    shown.type("K", "2 GPa/m")
    shown.wait()
    assert shown.page.get_attribute("#slider-K", "aria-valuetext") == "2 GPa/m"
    assert not shown.page.is_visible("text=the slider is beyond the map")


def test_the_atlas_comes_for_any_ratio(show):
    shown = show(latency.CASES["stick-slip"].replace("a=0.005&b=0.008", "a=0.008&b=0.009"))
    shown.page.wait_for_selector("#regimes:not(.waiting) >> text=coarse", timeout=60_000)
    assert shown.text("#banner") == ""
    assert not shown.page.is_visible("#map-note")


def test_a_link_with_a_bad_entry_shows_something(show):
    shown = show(latency.CASES["stick-slip"].replace("0.96 GPa/m", "3 MPa"))
    shown.page.wait_for_selector("#numbers dd")
    assert shown.text("#stale") == "Shown: the last valid values (K = 960 MPa/m); correct K."
    assert "is a stress" in shown.text("#problem-K")
    shown.type("K", "0.96 GPa/m")
    shown.wait()
    assert not shown.page.is_visible("#stale")
    shown.page.wait_for_selector("#regimes:not(.waiting) >> text=coarse", timeout=60_000)


def test_a_finger_scrolls_past_the_map(show):
    shown = show(has_touch=True)
    shown.page.locator("#map-canvas").scroll_into_view_if_needed()
    box = shown.page.locator("#map-canvas").bounding_box()
    shown.page.touchscreen.tap(box["x"] + box["width"] - 40, box["y"] + 40)
    shown.page.wait_for_timeout(100)
    assert shown.entry("K") == "960 MPa/m"


def test_friction_that_strengthens_has_no_place_on_the_map(show):
    shown = show()
    shown.type("b", "0.004")
    shown.wait()
    assert "b \u2264 a" in shown.text("#reasons")
    assert not shown.page.is_visible("#dot")


def test_a_velocity_step_and_back(show):
    shown = show()
    shown.page.fill("#factor-V_lp", "nonsense")
    shown.page.click("#step-V_lp")
    assert "expected a number > 0" in shown.text("#problem-V_from")
    for wrong in ("1/0", "1/2/3", "/2", "2/2"):
        shown.page.fill("#factor-V_lp", wrong)
        shown.page.click("#step-V_lp")
        assert f"factor = '{wrong}' is no use" in shown.text("#problem-V_from")
    shown.page.fill("#factor-V_lp", "1/2")
    # takes it in; the button steps, by a double click too
    shown.page.press("#factor-V_lp", "Enter")
    shown.page.dblclick("#step-V_lp")
    shown.wait()
    assert shown.entry("V_lp") == "50 \u00b5m/s"
    assert "Stepped from 100 \u00b5m/s to 50 \u00b5m/s" in shown.text("#stepped")
    assert not shown.page.is_visible("#problem-V_from")
    shown.page.click("#unstep")
    shown.wait()
    assert shown.entry("V_lp") == "100 \u00b5m/s"
    assert not shown.page.is_visible("#stepped")


def test_a_step_of_normal_stress_and_back(show):
    shown = show(latency.CASES["steady"])
    shown.type("alpha", "0.2")
    shown.wait()
    shown.page.fill("#factor-sigma", "0")
    shown.page.click("#step-sigma")
    assert "factor = '0' is no use" in shown.text("#problem-sigma_from")
    shown.page.fill("#factor-sigma", "1.05")
    shown.page.click("#step-sigma")
    shown.wait()
    assert shown.entry("sigma") == "2.1 MPa"
    assert shown.text("#stepped").startswith("Stepped from 2 MPa to 2.1 MPa at time 0.")
    assert not shown.page.is_visible("#problem-sigma_from")
    # a step of the speed starts from there, and has its own undoing
    shown.page.click("#step-V_lp")
    shown.wait()
    assert shown.entry("sigma") == "2.1 MPa"
    assert shown.text("#stepped").startswith("Stepped from 300 \u00b5m/s to 900 \u00b5m/s at")
    shown.page.click("#unstep")
    shown.wait()
    assert [shown.entry(symbol) for symbol in ("V_lp", "sigma")] == ["300 \u00b5m/s", "2.1 MPa"]
    # a link may have both at once, and both are undone together
    both = f"{latency.CASES['steady']}&V_from=0.1 mm/s&sigma_from=1.9 MPa"
    other = show(both)
    assert other.text("#stepped").startswith(
        "Stepped from 100 \u00b5m/s to 300 \u00b5m/s, and from 1.9 MPa to 2 MPa at time 0."
    )
    with other.page.expect_download() as saving:
        other.page.click("#scenario")
    saved = scenario.loads(saving.value.path().read_text())
    assert saved.slider.sigma == 1.9e6
    at_end = saved.settings["loading"].sigma(saved.settings["t_end"], saved.slider.sigma)
    assert float(at_end) == 2e6
    other.page.click("#unstep")
    other.wait()
    assert [other.entry(symbol) for symbol in ("V_lp", "sigma")] == ["0.1 mm/s", "1.9 MPa"]
    assert not other.page.is_visible("#stepped")


def test_friction_has_forms_with_fields_of_their_own(show):
    shown = show()
    enabled = "#friction option:not([disabled])"
    assert shown.page.eval_on_selector_all(enabled, INNER) == ["log", "cut-off", "regularized"]
    assert not shown.page.is_visible("#entry-V2")
    shown.page.select_option("#friction", "cut-off")
    shown.wait()
    assert shown.page.inner_html(".field:has(#entry-V2) .symbol") == "<i>V</i><sub>2</sub>"
    shown.type("V1", "1 m/s")
    shown.type("V2", "2 um/s")
    shown.wait()
    cycle = rs.limit_cycle(FIG4.replace(friction="cut-off", V1=1.0, V2=2e-6), 1e-4)
    assert shown.numbers["amplitude of \u03c4/\u03c3"] == f"{float(cycle.amplitude):.4g}"
    # a law that it does not go with has its own; what was typed waits for its form
    shown.page.select_option("#law", "nagata")
    shown.wait()
    assert shown.page.input_value("#friction") == "log"
    assert shown.page.eval_on_selector_all(enabled, INNER) == ["log"]
    assert not shown.page.is_visible("#entry-V2")
    shown.page.select_option("#law", "slip")
    shown.page.select_option("#friction", "cut-off")
    shown.wait()
    assert shown.entry("V2") == "2 \u00b5m/s"


def test_a_link_whose_friction_does_not_go_with_its_law(show):
    shown = show("law=flash-heating&friction=log")
    assert "does not go with law = 'flash-heating'" in shown.text("#problem-friction")
    assert shown.text("#stale") == "Shown: the last valid values; correct friction."
    assert shown.page.is_visible("#entry-V_w")
    shown.page.select_option("#friction", "regularized")
    shown.wait()
    assert not shown.page.is_visible("#problem-friction")
    other = show("law=flash-heating")  # nor need it have any
    assert other.page.input_value("#friction") == "regularized"
    assert other.text("#headline") == shown.text("#headline")


def test_the_legend_has_a_limit_cycle_where_there_is_one(show):
    shown = show(latency.CASES["steady"])
    assert not shown.page.is_visible("#cycle-key")
    shown.type("V_lp", "4 mm/s")
    shown.wait()
    assert shown.page.is_visible("#cycle-key")


def test_slip_that_reverses_is_drawn_on_a_linear_axis(show):
    swings = "law=aging&a=0.01&b=0.015&Dc=10 um&sigma=1 MPa&M=1000 kg/m^2&K=100 MPa/m"
    shown = show(f"{swings}&mu0=0.05&V0=1 um/s&V_lp=0.1 m/s&friction=regularized")
    assert shown.numbers["slowest"].startswith("-")
    # a real multiplier has the sign that the verdict gives it
    multiplier = shown.numbers["Floquet multiplier"]
    assert multiplier.startswith("-")
    assert f"Floquet multiplier {multiplier})" in shown.text("#reasons")
    # from the lowest to the highest point of the axes that V is drawn at, most of their height
    rows = """canvas => { const c = document.querySelector(canvas);
        const [r, g, b] = getComputedStyle(document.body).getPropertyValue('--speed').trim()
            .match(/[0-9a-f]{2}/g).map(h => parseInt(h, 16));
        const copy = new OffscreenCanvas(c.width, c.height).getContext('2d');
        copy.drawImage(c, 0, 0);
        const { data } = copy.getImageData(0, 0, c.width, c.height);
        const drawn = [];
        for (let i = 0; i < data.length; i += 4)
            if (data[i] === r && data[i + 1] === g && data[i + 2] === b)
                drawn.push(Math.floor(i / 4 / c.width));
        return [Math.min(...drawn) / c.height, Math.max(...drawn) / c.height, drawn.length] }"""
    for chart in ("#speed-chart canvas", "#phase-canvas"):
        top, bottom, count = shown.page.evaluate(f"({rows})('{chart}')")
        assert top < 0.2, chart
        assert 0.6 < bottom < 0.95, chart
        assert count > 100, chart
    # and back on a logarithmic one
    shown.page.select_option("#friction", "log")
    shown.wait()
    assert not shown.numbers["slowest"].startswith("-")
    assert "outside the domain" in shown.text("#reasons")


def test_a_law_has_its_own_fields(show):
    shown = show()
    own = ["b2", "Dc2"]
    assert not any(shown.page.is_visible(f"#entry-{symbol}") for symbol in own)
    shown.page.select_option("#law", label="two-state slip law")
    shown.wait()
    assert [shown.entry(symbol) for symbol in own] == ["0.002", "100 \u00b5m"]
    labels = shown.page.eval_on_selector_all("#own .field:not([hidden]) .symbol", INNER)
    assert labels[:2] == ["<i>b</i><sub>2</sub>", "<i>D</i><sub>c</sub><sub>2</sub>"]
    assert labels[2:] == ["damping", "<i>\u03b1</i>"]
    shown.type("b2", "-0.001")
    shown.wait()
    slider = FIG4.replace(law="two-state-slip", b2=-0.001, Dc2=1e-4)
    K_c = float(rs.stability(slider, 1e-4).K_c)
    assert shown.numbers["Kc"] == f"{K_c / 1e9:.4g} GPa/m"
    shown.page.focus("#slider-b2")
    shown.page.keyboard.press("PageUp")  # larger, of the same sign
    shown.wait()
    assert float(shown.entry("b2")) < -0.001
    shown.page.wait_for_selector("#map-note:not([hidden])")
    assert "the map of regimes is for laws of one state" in shown.text("#map-note")
    shown.type("Dc2", "2 MPa")
    shown.page.wait_for_selector("#problem-Dc2:not([hidden])")
    shown.type("Dc2", "0.2 mm")
    shown.page.wait_for_timeout(300)
    link = shown.page.evaluate("location.href")
    assert "Dc2=0.2+mm" in link
    # another law has none of them, nor has the link; and they come back as they were
    shown.page.select_option("#law", "aging")
    shown.wait()
    shown.page.wait_for_timeout(300)
    assert not any(shown.page.is_visible(f"#entry-{symbol}") for symbol in own)
    assert "Dc2" not in shown.page.evaluate("location.href")
    shown.page.select_option("#law", "two-state-slip")
    shown.wait()
    assert shown.entry("Dc2") == "0.2 mm"
    other = show(link.partition("#")[2])
    assert other.page.input_value("#law") == "two-state-slip"
    assert other.entry("Dc2") == "0.2 mm"


def test_damping_is_given_and_taken_away(show):
    shown = show()
    assert shown.entry("damping") == "0 Pa s/m"
    shown.type("damping", "3 MPa s/m")
    shown.wait()
    slider = FIG4.replace(damping=3e6)
    assert shown.numbers["Kc"] == f"{slider.K_c(1e-4) / 1e9:.4g} GPa/m"
    assert "damping=3+MPa+s%2Fm" in shown.page.evaluate("location.href")
    shown.page.select_option("#presets", index=2)
    shown.wait()
    assert shown.entry("damping") == "0 Pa s/m"


def test_a_law_file_is_in_the_menu(show):
    shown = show()
    name = shown.page.eval_on_selector("#law option[value^=mine]", "option => option.value")
    shown.page.select_option("#law", name)
    shown.wait()
    assert shown.entry("m") == "1.5"
    assert "limit_cycle needs derivatives" in shown.text("#headline")


def test_a_link_holds_everything(show):
    shown = show()
    shown.type("sigma", "5 MPa")
    shown.page.click("#step-V_lp")
    shown.page.select_option("#law", "aging")
    shown.wait()
    shown.page.click("#link")
    link = shown.page.evaluate("navigator.clipboard.readText()")
    other = show(link.partition("#")[2])
    assert other.entry("sigma") == "5 MPa"
    assert other.entry("V_lp") == "300 \u00b5m/s"
    assert other.page.input_value("#law") == "aging"
    assert other.text("#headline") == shown.text("#headline")
    assert other.text("#stepped") == shown.text("#stepped")
    other.page.wait_for_timeout(300)
    other.page.reload()
    other.wait()
    assert other.text("#headline") == shown.text("#headline")


def test_downloads(show, tmp_path):
    shown = show(latency.CASES["stick-slip"])
    files = {}
    for name in ("scenario", "python", "csv", "png"):
        with shown.page.expect_download() as download:
            shown.page.click(f"#{name}")
        files[name] = tmp_path / download.value.suggested_filename
        download.value.save_as(files[name])
    loaded = scenario.load(files["scenario"])
    assert loaded.slider == FIG4
    run = scenario.run(loaded)
    lines: dict = {}
    exec(files["python"].read_text(), lines)
    assert any(hasattr(v, "tau") and np.array_equal(v.tau, run.tau) for v in lines.values())
    rows = np.genfromtxt(files["csv"], delimiter=",", skip_header=1)
    assert rows.shape[0] == run.sizes["time"]
    assert files["csv"].read_text().startswith("time [s],V [m/s],")
    png = files["png"].read_bytes()
    assert png.startswith(b"\x89PNG\r\n\x1a\n")
    width, height = (int.from_bytes(png[k : k + 4], "big") for k in (16, 20))
    assert width > 800
    assert height > 400


def test_a_lost_connection_says_so_and_comes_back(browser):
    with contextlib.ExitStack() as stack:
        with serving() as first:
            shown = Shown(browser, first.address)
            stack.callback(shown.context.close)
            before = shown.numbers
        assert first.process.returncode == 130
        # after a line for each kernel that had to be compiled
        assert first.process.errors.endswith("interrupted; the explorer has ended\n")
        banner = shown.page.wait_for_selector("#banner.lost:visible")
        assert "is lost" in banner.inner_text()
        shown.type("K", "2 GPa/m")
        assert shown.numbers == before
        port = int(first.address.split(":")[2].strip("/"))
        with serving(port):
            shown.page.wait_for_selector("#banner", state="hidden", timeout=60_000)
            shown.wait()
            assert shown.numbers["K/Kc"] == "1.667"


def test_everything_is_reached_by_keyboard(show):
    shown = show()
    seen = []
    for _ in range(40):
        shown.page.keyboard.press("Tab")
        seen.append(
            shown.page.evaluate(
                """() => { const e = document.activeElement, s = getComputedStyle(e);
                const name = e.id || e.name || e.tagName;
                return [name, s.outlineStyle, parseFloat(s.outlineWidth)] }"""
            )
        )
        if seen[-1][0] == "whole":
            break
    names = [name for name, *_ in seen]
    wanted = ["presets", "link", "scenario", "python", "csv", "png", "law", "friction"]
    for symbol in ("a", "b", "Dc", "sigma", "M", "K", "V_lp"):
        wanted += [f"entry-{symbol}", f"slider-{symbol}"]
    wanted += [f"{control}-{symbol}" for symbol in OF_ALL for control in ("entry", "slider")]
    wanted += [f"{part}-{stepped}" for stepped in ("V_lp", "sigma") for part in ("factor", "step")]
    assert names == [*wanted, "SUMMARY", "drag", "dot", "whole"]
    assert all(style != "none" and width >= 1 for _, style, width in seen), seen


def test_nothing_is_clipped_and_no_width_scrolls_sideways(show):
    shown = show()
    titles = shown.page.eval_on_selector_all("#presets option", "all => all.map(o => o.text)")
    clipped = """() => [...document.querySelectorAll('#numbers dd, #fields input[type=text]')]
        .filter(e => e.scrollWidth > e.clientWidth || (!e.value && e.clientHeight > 30))
        .map(e => e.value ?? e.textContent)"""
    fits = "w => document.documentElement.scrollWidth === w && innerWidth === w"
    for title in titles[1:]:
        shown.page.select_option("#presets", label=title)
        shown.wait()
        for width in (360, 768, 1280):
            shown.page.set_viewport_size({"width": width, "height": 740})
            shown.wait()
            assert shown.page.evaluate(clipped) == [], (title, width)
            # (charts follow the window a moment later)
            shown.page.wait_for_function(fits, arg=width, timeout=5_000)
            for chart in ("#stress-chart", "#map-canvas"):
                box = shown.page.locator(chart).bounding_box()
                assert box["x"] >= 0, (title, width)
                assert box["x"] + box["width"] <= width, (title, width)


@pytest.mark.parametrize(
    ("width", "height"), [(390, 844), (844, 390), (1024, 768), (1440, 900), (2560, 1440)]
)
def test_nothing_moves_but_what_is_moved(show, width, height):
    """While a slider goes through the regimes, with their verdicts, notes and legends."""
    shown = show("V_from=90 um/s", viewport={"width": width, "height": height})
    shown.page.evaluate(
        """() => { window.shifts = [];
        new PerformanceObserver(list => shifts.push(...list.getEntries().flatMap(
            e => e.sources.map(s => s.node && (s.node.id || s.node.nodeName)))))
            .observe({ type: 'layout-shift' }) }"""
    )
    moves = [("K", "1.1999 GPa/m"), ("K", "2 GPa/m"), ("K", "0.9 GPa/m"), ("M", "0"), ("M", "1e9")]
    for symbol, text in moves:
        shown.type(symbol, text)
        shown.wait()
    for chart in ("#stress-chart", "#speed-chart", "#map-canvas", "#phase-canvas"):
        shown.page.hover(chart)
        shown.page.wait_for_timeout(50)
    # (what is typed, which has no node for scripts, is given its unit)
    assert [what for what in shown.page.evaluate("shifts") if what] == []
    if width >= 1151:  # the page is as high as the window
        assert shown.page.evaluate("document.documentElement.scrollHeight") == height
        charts = shown.page.locator("#speed-chart").bounding_box()
        assert charts["height"] > 150
        assert charts["y"] + charts["height"] <= height


def test_a_finger_that_scrolls_over_a_slider_leaves_it(show):
    shown = show(viewport={"width": 390, "height": 844}, has_touch=True, is_mobile=True)
    shown.page.locator("#slider-K").scroll_into_view_if_needed()
    box = shown.page.locator("#slider-K").bounding_box()
    client = shown.context.new_cdp_session(shown.page)

    def swipe(dx, dy):
        x, y = box["x"] + 0.3 * box["width"], box["y"] + box["height"] / 2
        points = [(x + k * dx, y + k * dy) for k in range(12)]
        for i, (px, py) in enumerate(points):
            kind = "touchMove" if i else "touchStart"
            touches = [{"x": px, "y": py}]
            client.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": touches})
        client.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
        shown.page.wait_for_timeout(200)
        shown.wait()

    at = shown.page.evaluate("scrollY")
    swipe(1, -12)
    assert shown.page.evaluate("scrollY") > at + 50
    assert shown.entry("K") == "960 MPa/m"
    assert shown.numbers["K/Kc"] == "0.8"
    shown.page.locator("#slider-K").scroll_into_view_if_needed()
    box = shown.page.locator("#slider-K").bounding_box()
    swipe(12, 1)
    assert shown.entry("K") != "960 MPa/m"


def test_dark_is_dark_and_nothing_moves_for_those_who_mind(show):
    shown = show(color_scheme="dark", reduced_motion="reduce")
    page, transition = shown.page.evaluate(
        """() => [getComputedStyle(document.body).backgroundColor,
        getComputedStyle(document.querySelector('#step-V_lp')).transitionDuration]"""
    )
    assert max(map(int, re.findall(r"\d+", page))) < 40
    assert transition == "0s"
    # of a copy: a canvas that is read often is slowed down, which the console warns of
    corner = """canvas => { const copy = new OffscreenCanvas(1, 1).getContext('2d');
        copy.drawImage(document.querySelector(canvas), 2, 2, 1, 1, 0, 0, 1, 1);
        return copy.getImageData(0, 0, 1, 1).data.slice(0, 3) }"""
    shown.page.wait_for_function(f"() => Math.max(...({corner})('#map-canvas')) < 60")
    shown.page.emulate_media(color_scheme="light")
    shown.page.wait_for_function(f"() => Math.min(...({corner})('#phase-canvas')) > 230")


def test_every_named_control_has_a_name(show):
    shown = show()
    nameless = shown.page.evaluate(
        """() => [...document.querySelectorAll('button, input, select, [role=img]')]
        .filter(e => !(e.getAttribute('aria-label') || e.labels?.length || e.textContent.trim()))
        .map(e => e.id)"""
    )
    assert nameless == []
    names = "e => ['entry', 'slider'].map(k => document.getElementById(`${k}-${e}`).ariaLabel)"
    assert shown.page.evaluate(f"({names})('sigma')") == ["normal stress sigma"] * 2


def test_a_symbol_that_is_not_known_is_its_letters(server, browser):
    page = browser.new_page()
    page.goto(f"{server.address}js/words.js")
    shown = "async (name) => (await import('/js/words.js')).symbol(name).map((x) => x.textContent)"
    assert page.evaluate(shown, "K_c") == ["K", "c"]
    for name in ("D_RS", "toString"):
        assert page.evaluate(shown, name) == [name]
    page.close()


def test_ticks_of_late_digits_count_from_a_value(server, browser):
    page = browser.new_page()
    page.goto(f"{server.address}js/ticks.js")
    ticks, label = page.evaluate(
        """async () => (await import('/js/ticks.js')).counted(0.55506402, 0.55506409, 4)"""
    )
    page.close()
    base, power = label.strip(" \N{MINUS SIGN}]").split("  [")
    assert (base, power) == ("0.55506406", "10\u207b\u2078")
    told = [float(text.replace("\N{MINUS SIGN}", "-")) for _, text in ticks]
    assert len(set(told)) == len(told) >= 3
    assert [value for value, _ in ticks] == pytest.approx(
        [float(base) + 1e-8 * count for count in told], abs=1e-14
    )
