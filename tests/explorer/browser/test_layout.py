"""How the page fits its screen, and those who read it otherwise."""

import re

import pytest

#: fields of every law and form of friction that links need not have
OF_ALL = ["damping", "alpha"]


def test_a_slider_is_moved_by_keyboard(show):
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
    # (from each movement of a slider to its picture the browser's developer tools show the time)
    names = "performance.getEntriesByName('slider-to-drawn').length"
    assert shown.page.evaluate(names) == 2


def test_everything_is_reached_by_keyboard_and_has_a_name(show):
    shown = show()
    shown.page.wait_for_selector("#regimes li:not([hidden])")  # the atlas, which has a legend
    seen = []
    for _ in range(80):
        shown.page.keyboard.press("Tab")
        seen.append(
            shown.page.evaluate(
                """() => { const e = document.activeElement, s = getComputedStyle(e);
                const name = e.id || e.name || e.tagName;
                return [name, s.outlineStyle, parseFloat(s.outlineWidth)] }"""
            )
        )
        if seen[-1][0] == "volume":
            break
    names = [name for name, *_ in seen]
    wanted = "presets tasks-open link scenario python csv svg pdf png page".split()
    wanted += ["SPAN", "law", "friction_form"]  # (of the table of numbers, one that is explained)
    for symbol in ("a", "b", "Dc", "sigma", "M", "K", "V_lp"):
        wanted += [f"entry-{symbol}", f"slider-{symbol}"]
    wanted += [f"{control}-{symbol}" for symbol in OF_ALL for control in ("entry", "slider")]
    wanted += [f"{part}-{stepped}" for stepped in ("V_lp", "sigma") for part in ("factor", "step")]
    wanted += ["factor-kick", "kick", "hold-time", "hold", "slide-hold-slide"]
    played = ["play", "played", "playing-speed"]
    wanted += ["SUMMARY", "pin", "record-open", *played, "tab-map", "drag", "dot", "closer", "SPAN"]
    wanted += ["whole", "sound", "volume"]
    assert names == wanted
    assert all(style != "none" and width >= 1 for _, style, width in seen), seen
    # and has a name
    nameless = shown.page.evaluate(
        """() => [...document.querySelectorAll('button, input, select, [role=img]')]
        .filter(e => !(e.getAttribute('aria-label') || e.labels?.length || e.textContent.trim()))
        .map(e => e.id)"""
    )
    assert nameless == []
    names = "e => ['entry', 'slider'].map(k => document.getElementById(`${k}-${e}`).ariaLabel)"
    assert shown.page.evaluate(f"({names})('sigma')") == ["normal stress sigma"] * 2


def test_nothing_is_clipped_and_no_width_scrolls_sideways(show):
    shown = show()
    titles = shown.page.eval_on_selector_all("#presets option", "all => all.map(o => o.text)")
    clipped = """() => [...document.querySelectorAll('#numbers dd, #fields input[type=text]')]
        .filter(e => e.scrollWidth > e.clientWidth || (!e.value && e.clientHeight > 30))
        .map(e => e.value ?? e.textContent)"""
    fits = "w => document.documentElement.scrollWidth === w && innerWidth === w"
    for width, every in ((360, 1), (768, 4), (1280, 4)):  # the narrowest has least room
        shown.page.set_viewport_size({"width": width, "height": 740})
        for title in titles[1::every]:
            shown.choose("#presets", label=title)
            assert shown.page.evaluate(clipped) == [], (title, width)
            # (charts follow the window a moment later)
            shown.page.wait_for_function(fits, arg=width, timeout=5_000)
            for chart in ("#stress-chart", "#map-canvas"):
                box = shown.page.locator(chart).bounding_box()
                assert box["x"] >= 0, (title, width)
                assert box["x"] + box["width"] <= width, (title, width)


@pytest.mark.parametrize(("width", "height"), [(390, 844), (1024, 768), (1920, 1080)])
def test_the_layout_does_not_shift_while_a_slider_moves(show, width, height):
    """While a slider goes through the regimes, with their verdicts, notes and legends."""
    shown = show("V_from=90 um/s", viewport={"width": width, "height": height})
    shown.watch_shifts()
    moves = [("K", "1.1999 GPa/m"), ("K", "2 GPa/m"), ("K", "0.9 GPa/m"), ("M", "0"), ("M", "1e9")]
    for symbol, text in moves:
        shown.set(symbol, text)
    for chart in ("#machine", "#stress-chart", "#speed-chart", "#map-canvas", "#phase-canvas"):
        shown.page.hover(chart)
        shown.page.wait_for_timeout(50)
    shown.page.click("#play")
    for pace in ("0.25", "4"):
        shown.page.select_option("#playing-speed", pace)
        shown.page.wait_for_timeout(50)
    assert shown.shifts == []
    if width >= 1151:  # the page is as high as the window
        assert shown.page.evaluate("document.documentElement.scrollHeight") == height
        charts = shown.page.locator("#speed-chart").bounding_box()
        assert charts["height"] > 150
        assert charts["y"] + charts["height"] <= height


@pytest.mark.parametrize(("width", "height"), [(390, 844), (1024, 768), (1440, 900)])
def test_a_picture_is_on_the_first_screen_and_in_sight_of_a_slider(show, width, height):
    shown = show(viewport={"width": width, "height": height})
    page = shown.page

    def box(selector):
        found = page.locator(selector).bounding_box()
        return found["x"], found["y"], found["x"] + found["width"], found["y"] + found["height"]

    assert box("#machine")[3] + 100 <= height  # and so are 100 px of the traces below it
    assert box("#headline")[3] <= height
    page.locator("#slider-V_lp").scroll_into_view_if_needed()
    shown.type("Dc", "banana")
    page.wait_for_selector("#stale:visible")
    message = box("#stale")
    for chart in ("#stress-chart", "#speed-chart"):
        left, top, right, bottom = box(chart)
        assert top >= 0
        apart = message[2] <= left or right <= message[0] or message[1] >= bottom
        assert apart or message[3] <= top, chart
    assert box("#machine")[3] + 100 <= height


def test_a_finger_that_scrolls_over_a_slider_leaves_it(show):
    shown = show(viewport={"width": 390, "height": 844}, has_touch=True, is_mobile=True)
    shown.page.locator("#slider-K").evaluate("e => e.scrollIntoView({ block: 'center' })")
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
    shown.page.locator("#slider-K").evaluate("e => e.scrollIntoView({ block: 'center' })")
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
