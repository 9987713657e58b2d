"""The bifurcation diagram on the page, and the map that zooms, refines and shows coexistence."""

import json
import math

import pytest
from explorer_links import CASES

import ratestate as rs
from ratestate.paper.parameters import FIG4, FIG6
from ratestate_explorer import branch

FIG4_LINK, V_LP = CASES["stick-slip"], 1e-5  # m/s
#: Fig. 6 under the aging law: K_c is 601.2 and K_fold 602.81 MPa/m
COEXISTENCE = (
    "a=0.003&b=0.006&Dc=10 um&sigma=2 MPa&M=3000 kg/m^2&V_lp=200 um/s&mu0=0.6&V0=1 nm/s"
    "&law=aging&K={} MPa/m"
)
LEFT, RIGHT, TOP, BOTTOM = 64, 12, 8, 40  # margins of a plane
READY = """along => (document.querySelector('#branch-canvas').ariaLabel ?? '')
    .includes(`against ${along}.`) && !document.querySelector('#branch-dot').hidden"""
FINE = """() => [...document.querySelectorAll('#regimes li')].some(
    e => !e.hidden && e.textContent === '16 \u00d7 16 sliders')"""


def dot(shown, name="dot"):
    """Where a dot is on its canvas."""
    return shown.page.evaluate(
        """name => ['left', 'top'].map(side =>
        parseFloat(document.getElementById(name).style[side]))""",
        name,
    )


def plane(shown, canvas):
    """Width and height between the axes of a canvas."""
    width, height = shown.page.eval_on_selector(canvas, "c => [c.clientWidth, c.clientHeight]")
    return width - LEFT - RIGHT, height - TOP - BOTTOM


def diagram(shown, along="K"):
    """Wait for the diagram along a parameter."""
    shown.page.click("#tab-branch")
    shown.page.select_option("#along", along)
    shown.page.wait_for_function(READY, arg=along, timeout=60_000)


def test_the_diagram_has_the_slider_on_it_and_is_clicked(show):
    shown = show(FIG4_LINK)
    asked = []

    def listen(socket):
        socket.on("framesent", lambda sent: asked.append(json.loads(sent)))

    def branches():
        return [question["along"] for question in asked if question["ask"] == "branch"]

    shown.page.on("websocket", listen)
    shown.page.reload()
    shown.wait()
    diagram(shown)
    axis = branch.axis_of(FIG4, V_LP, "K")
    width, height = plane(shown, "#branch-canvas")
    decades = math.log10(axis.high / axis.low)
    x, y = dot(shown, "branch-dot")
    assert x == pytest.approx(LEFT + width * math.log10(9.6e8 / axis.low) / decades, abs=0.5)
    # the amplitude axis begins 6 % of the largest amplitude below 0, and ends as much above it
    largest = float(rs.limit_cycle(FIG4.replace(K=axis.low), V_LP).amplitude)
    share = 0.06 + float(rs.limit_cycle(FIG4, V_LP).amplitude) / largest
    assert y == pytest.approx(TOP + height * (1.0 - share / 1.12), abs=0.5)
    assert f"Hopf at K = {FIG4.K_c(V_LP) / 1e9:.4g} GPa/m" in shown.page.get_attribute(
        "#branch-canvas", "aria-label"
    )
    shown.page.click("#branch-canvas", position={"x": LEFT + 0.25 * width, "y": TOP + 20})
    shown.wait()
    clicked = axis.low * 10 ** (0.25 * decades)
    assert float(shown.entry("K").split(" ")[0]) == pytest.approx(clicked / 1e6, rel=5e-3)
    assert dot(shown, "branch-dot")[0] == pytest.approx(LEFT + 0.25 * width, abs=1.0)
    before = float(shown.entry("K").split(" ")[0])
    shown.page.keyboard.press("ArrowRight")
    shown.page.keyboard.press("Shift+ArrowLeft")
    shown.wait()
    after = float(shown.entry("K").split(" ")[0])
    assert after / before == pytest.approx(10 ** (0.02 - 0.2), rel=1e-3)
    # beyond K_c it slides steadily: amplitude 0
    shown.set("K", "2 GPa/m")
    assert dot(shown, "branch-dot")[1] == pytest.approx(TOP + height * (1 - 0.06 / 1.12), abs=0.5)
    # the diagram is the same for all values of K
    shown.page.wait_for_timeout(400)  # longer than a key must rest
    assert branches() == ["K"]
    # along another parameter, and with speeds: it is asked for again
    diagram(shown, "V_lp")
    assert branches() == ["K", "V_lp"]
    shown.page.select_option("#measure", "V_max")
    assert "V_max of limit cycles against V_lp" in shown.page.get_attribute(
        "#branch-canvas", "aria-label"
    )
    assert "V_lp = 10 \u00b5m/s, V_max 10 \u00b5m/s" in shown.page.get_attribute(
        "#branch-dot", "aria-label"
    )


def test_the_tabs_are_accessible_and_switch_panels(show):
    shown = show()
    state = """() => ['map', 'branch'].map(name => {
        const [tab, panel] = [`tab-${name}`, name].map(id => document.getElementById(id));
        return [tab.ariaSelected, tab.tabIndex, panel.role, panel.checkVisibility()] })"""
    assert shown.page.evaluate(state) == [
        ["true", 0, "tabpanel", True],
        ["false", -1, "tabpanel", False],
    ]
    shown.page.focus("#tab-map")
    for key, chosen in (("ArrowRight", 1), ("ArrowRight", 0), ("End", 1), ("Home", 0)):
        shown.page.keyboard.press(key)
        assert [of[0] for of in shown.page.evaluate(state)].index("true") == chosen, key
        assert shown.page.evaluate("document.activeElement.id") == ("tab-map", "tab-branch")[chosen]
    # side by side where the page is wide
    shown.page.set_viewport_size({"width": 1900, "height": 1000})
    shown.page.wait_for_function("() => document.querySelector('#branch').checkVisibility()")
    assert [of[2:] for of in shown.page.evaluate(state)] == [[None, True], [None, True]]
    left, right = (shown.page.locator(f"#{name}").bounding_box() for name in ("map", "branch"))
    assert left["x"] + left["width"] <= right["x"]
    assert left["y"] == right["y"]
    assert not shown.page.is_visible("#tab-map")


def test_the_map_has_the_headlines_colour_about_the_dot(show):
    """Slow stick-slip at K = 0.9985 K_c lies within a cell of the map."""
    values = {s: f"{value:.15g}" for s, value in FIG6.values.items()}
    fragment = "&".join(
        f"{s}={values[s]}" for s in ("a", "b", "Dc", "sigma", "M", "K", "mu0", "V0")
    )
    shown, role = show(f"{fragment}&law=slip&V_lp=200 um/s"), "slow"
    x, y = dot(shown)
    beside = [[x + dx - 1, y - 1, 2, 2] for dx in (-9, 9)]
    for box in beside:
        assert shown.painted("#map-canvas", role, box).share == 1.0
    for other in {"steady", "slow", "stick", "harmonic"} - {role}:
        assert shown.painted("#map-canvas", other, beside[0]).count == 0


def test_a_slider_beside_a_cycle_lies_in_the_hatched_strip(show):
    shown = show(COEXISTENCE.format(602))
    shown.page.wait_for_selector("#regimes:not(.waiting) >> text=coarse", timeout=60_000)
    assert shown.page.is_visible("text=lost with a jump")
    assert not shown.page.is_visible("text=coexistence")  # thinner than a pixel
    for _ in range(10):
        shown.page.click("#closer")
    shown.page.wait_for_function(FINE, timeout=60_000)
    assert shown.page.is_visible("text=coexistence")
    hatched = {}
    for K in (600.6, 601.6, 602, 602.4, 603.2):  # K_c is 601.2, K_fold 602.81
        shown.set("K", f"{K} MPa/m")
        x, y = dot(shown)
        above = [x - 4, y - 35, 8, 20]  # outside the halo
        hatched[K] = shown.painted("#map-canvas", "jump", above).share
    assert [share > 0.05 for share in hatched.values()] == [False, True, True, True, False], hatched
    assert hatched[600.6] == hatched[603.2] == 0.0


def test_the_map_zooms_by_keys_wheel_and_buttons(show):
    shown = show(FIG4_LINK)
    assert shown.page.is_disabled("#whole-map")
    x, y = dot(shown)
    shown.page.focus("#dot")
    for _ in range(5):
        shown.page.keyboard.press("+")
    assert dot(shown) == pytest.approx([x, y], abs=0.1)  # it is zoomed about the slider
    width, _ = plane(shown, "#map-canvas")
    box = shown.page.locator("#map-canvas").bounding_box()
    shown.page.mouse.move(box["x"] + x, box["y"] + y)
    shown.page.mouse.down()
    shown.page.mouse.move(box["x"] + x - 40, box["y"] + y, steps=2)
    shown.page.mouse.up()
    shown.wait()
    moved = float(shown.entry("K").split(" ")[0]) / 960
    assert math.log10(moved) == pytest.approx(-40 * 5 / 32 / width, rel=0.03)
    # what is set tells neighbouring pixels apart, and an arrow key goes as far on the screen
    before = dot(shown)[0]
    shown.page.focus("#dot")
    shown.page.keyboard.press("ArrowRight")
    shown.wait()
    assert dot(shown)[0] - before == pytest.approx(0.02 * width / 5, abs=0.3)
    # a slider that leaves what is shown is followed
    shown.set("K", "2 GPa/m")
    assert dot(shown)[0] == pytest.approx(LEFT + width / 2, abs=0.5)
    shown.page.keyboard.down("Control")
    shown.page.mouse.move(box["x"] + LEFT + width / 2, box["y"] + y)
    for _ in range(5):
        shown.page.mouse.wheel(0, 100)
    shown.page.keyboard.up("Control")
    shown.page.wait_for_function("() => document.querySelector('#whole-map').disabled")
    whole = dot(shown)[0]
    assert whole == pytest.approx(LEFT + width * (2 + math.log10(2e9 / 1.2e9)) / 5, abs=0.5)
    shown.page.click("#closer")
    shown.page.click("#whole-map")
    assert dot(shown)[0] == whole
