"""The explorer's page, in a real browser."""

import pytest
from explorer_links import CASES

import ratestate as rs
from ratestate.paper.parameters import FIG4


def test_the_page_opens_with_a_verdict(show):
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
    # a page is four requests
    paths = sorted(url.split("/", 3)[3].partition("#")[0] for url in shown.requests)
    assert [path for path in paths if path != "icon.svg"] == ["", "page.css", "page.js"]


def test_typed_values_are_used(show):
    shown = show()
    assert shown.page.is_visible("#cycle-key")
    shown.type("K", "1.3e3 N/m^2/um")
    shown.page.wait_for_function("() => document.querySelector('#headline').textContent[1] == 't'")
    shown.wait()
    assert shown.text("#headline") == "Steady sliding at 100 \u00b5m/s."
    assert shown.numbers["K/Kc"] == "1.083"
    assert not shown.page.is_visible("#cycle-key")
    # that is also what is heard, and nothing else
    shown.page.wait_for_function(
        "() => document.querySelector('#announcement').textContent.startsWith('Steady')"
    )
    assert shown.page.eval_on_selector_all("main [aria-live]", "all => all.length") == 0
    shown.page.select_option("#law", "aging")
    shown.set("K", "0.96 GPa/m")
    shown.page.wait_for_function(
        "() => document.querySelector('#headline').textContent.includes('2.777')"
    )
    # units are shown as they are written, and linked in ASCII
    assert [shown.entry(symbol) for symbol in ("Dc", "M")] == ["10 \u00b5m", "100 kg/m\u00b2"]
    shown.type("Dc", "20 \u03bcm")  # the Greek letter, as some keyboards have it
    shown.wait()
    assert shown.numbers["K/Kc"] == "1.6"
    shown.page.wait_for_function("() => location.hash.includes('Dc=20+um')")
    assert "M=100+kg%2Fm%5E2" in shown.page.evaluate("location.href")
    assert shown.entry("Dc") == "20 \u00b5m"
    # a number in SI is given its unit
    in_SI = {"M": ("500", "kg/m\u00b2"), "V_lp": ("1e-4", "m/s"), "K": ("inf", "Pa/m")}
    for symbol, (text, _) in in_SI.items():
        shown.set(symbol, text)
    for symbol, (text, unit) in in_SI.items():
        assert shown.entry(symbol) == f"{text} {unit}"
    assert shown.text("#banner") == ""


def test_presets_are_the_papers_figures(show):
    shown = show()
    options = shown.page.eval_on_selector_all("#presets option", "all => all.map(o => o.text)")
    assert [text[:6] for text in options[1:]] == ["Fig. 4"] * 2 + ["Fig. 2"] * 3 + [
        "Fig. 6",
        "Fig. 1",
    ]
    shown.choose("#presets", label=options[5])
    assert shown.text("#headline").startswith("Quasi-harmonic vibration at 50.59 Hz")
    assert "Stepped from 100 \u00b5m/s to 3.2 mm/s" in shown.text("#stepped")
    shown.choose("#presets", label=options[7])
    assert "rigid" in shown.text("#reasons")
    assert shown.entry("K") == "inf Pa/m"


def test_a_wrong_entry_is_explained_and_the_picture_stays(show):
    shown = show()
    before = shown.numbers
    shown.type("Dc", "10 MPa")
    message = shown.page.wait_for_selector("#problem-Dc:visible")
    assert message.inner_text() == ("Dc = '10 MPa' is a stress. Give a length such as '10 um'.")
    assert shown.page.get_attribute("#entry-Dc", "aria-invalid") == "true"
    assert "problem-Dc" in shown.page.get_attribute("#entry-Dc", "aria-describedby")
    assert shown.numbers == before
    shown.type("Dc", "10 um")
    shown.page.wait_for_selector("#problem-Dc", state="hidden")
    # it does not hold up the others
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
    assert (
        shown.text("#stale")
        == "The page shows the last valid values (M = 100 kg/m\u00b2). Correct M."
    )
    opacity = "e => getComputedStyle(e).opacity"
    assert float(shown.page.eval_on_selector("#phase-canvas", opacity)) < 1
    muted = "rgb(89, 97, 107)"
    assert shown.page.eval_on_selector("#headline", "e => getComputedStyle(e).color") == muted
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
    assert shown.text("#banner") == "Nothing was saved. Correct M first."
    shown.set("M", "500 kg/m^2")
    assert not shown.page.is_visible("#stale")
    assert shown.text("#banner") == ""


def test_sliders_of_what_has_no_logarithm_begin_near_what_is_usual(show):
    link = CASES["stick-slip"].replace("0.96 GPa", "inf Pa").replace("100 kg", "0 kg")
    shown = show(link)
    assert shown.page.is_visible("text=the slider is beyond the map")
    assert "beyond the map" in shown.page.get_attribute("#dot", "aria-label")
    shown.page.press("#slider-K", "ArrowLeft")
    shown.page.press("#slider-M", "ArrowRight")
    shown.wait()
    K = shown.entry("K").split(" ")
    assert (10 < float(K[0]) < 1000, K[1]) == (True, "GPa/m")
    assert 0.1 < float(shown.entry("M").split(" ")[0]) < 100
    assert shown.page.get_attribute("#slider-K", "aria-valuetext").startswith(shown.entry("K"))
    shown.set("K", "2 GPa/m")
    assert shown.page.get_attribute("#slider-K", "aria-valuetext") == "2 GPa/m, above K_c"
    assert not shown.page.is_visible("text=the slider is beyond the map")


def test_slip_that_reverses_is_drawn_on_a_linear_axis(show):
    swings = "law=aging&a=0.01&b=0.015&Dc=10 um&sigma=1 MPa&M=1000 kg/m^2&K=100 MPa/m"
    shown = show(f"{swings}&mu0=0.05&V0=1 um/s&V_lp=0.1 m/s&friction_form=regularized")
    assert shown.numbers["slowest"].startswith("-")
    # a real multiplier has the sign that the verdict gives it
    multiplier = shown.numbers["Floquet multiplier"]
    assert multiplier.startswith("-")
    assert f"Floquet multiplier {multiplier})" in shown.text("#reasons")
    # from the lowest to the highest point of the axes that V is drawn at, most of their height
    for chart in ("#speed-chart canvas", "#phase-canvas"):
        drawn = shown.painted(chart, "speed")
        assert drawn.top < 0.2, chart
        assert 0.6 < drawn.bottom < 0.95, chart
        assert drawn.count > 100, chart
    # and back on a logarithmic one
    shown.choose("#friction_form", "log")
    assert not shown.numbers["slowest"].startswith("-")
    assert "outside the domain" in shown.text("#reasons")


def test_a_symbol_that_is_not_known_is_its_letters(modules):
    shown = """async (name) => {
        const { symbol } = await import('/js/common/words.js');
        return symbol(name).map((part) => part.textContent) }"""
    assert modules.evaluate(shown, "K_c") == ["K", "c"]
    for name in ("D_RS", "toString"):
        assert modules.evaluate(shown, name) == [name]


def test_ticks_of_late_digits_count_from_a_value(modules):
    ticks, label = modules.evaluate(
        """async () => (await import('/js/common/ticks.js')).counted(0.55506402, 0.55506409, 4)"""
    )
    base, power = label.strip(" \N{MINUS SIGN}]").split("  [")
    assert (base, power) == ("0.55506406", "10\u207b\u2078")
    told = [float(text.replace("\N{MINUS SIGN}", "-")) for _, text in ticks]
    assert len(set(told)) == len(told) >= 3
    assert [value for value, _ in ticks] == pytest.approx(
        [float(base) + 1e-8 * count for count in told], abs=1e-14
    )
