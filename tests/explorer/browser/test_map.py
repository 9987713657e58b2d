"""The map of the page, and the slider on it."""

import math
import re

import pytest

DOT = """() => { const box = document.querySelector('#dot').getBoundingClientRect();
    return [box.x + box.width / 2, box.y + box.height / 2] }"""


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
    # friction that strengthens has no place on the map
    shown.set("b", "0.004")
    assert "b \u2264 a" in shown.text("#reasons")
    assert not shown.page.is_visible("#dot")


def test_a_finger_scrolls_past_the_map(show):
    shown = show(has_touch=True)
    shown.page.locator("#map-canvas").scroll_into_view_if_needed()
    box = shown.page.locator("#map-canvas").bounding_box()
    shown.page.touchscreen.tap(box["x"] + box["width"] - 40, box["y"] + 40)
    shown.page.wait_for_timeout(100)
    assert shown.entry("K") == "960 MPa/m"
