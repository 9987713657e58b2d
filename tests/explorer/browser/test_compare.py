"""Pinned runs, undo and redo."""

import re

from ratestate_explorer.menus import presets

CHARTS = ("#stress-chart canvas", "#speed-chart canvas", "#phase-canvas", "#map-canvas")
RESTED = "fragment => decodeURIComponent(location.hash).replaceAll('+', ' ').includes(fragment)"
SHOWS = "speed => document.getElementById('entry-V_lp').value === speed"


def test_a_pinned_run_stays_on_all_charts(show):
    shown = show()
    page = shown.page

    def pixels(role):
        return [shown.painted(chart, role).count for chart in CHARTS]

    assert pixels("pinned-1") == [0, 0, 0, 0]
    page.click("#pin")
    assert page.inner_text("#pins") == "the run shown\u00d7"
    page.select_option("#law", "aging")
    shown.set("K", "700 MPa/m")
    assert shown.text("#pins") == "K = 960 MPa/m, law = slip\u00d7"
    assert min(pixels("pinned-1")) > 20
    assert pixels("pinned-2") == [0, 0, 0, 0]
    page.click("#pin")
    page.click("#pin")
    assert page.is_disabled("#pin")  # three are all
    page.click("#pins button >> nth=0")
    assert pixels("pinned-1") == [0, 0, 0, 0]
    assert page.eval_on_selector_all("#pins li", "all => all.length") == 2
    assert page.evaluate("document.activeElement.id") == "pin"
    # it is in sight whatever is shown
    shown.type("K", "1.3 GPa/m")  # steady sliding, whose stress varies much less
    shown.wait()
    box = page.locator("#stress-chart .u-over").bounding_box()
    page.mouse.move(box["x"] + 0.999 * box["width"], box["y"] + 9)
    t_end = float(page.inner_text("#readout").split("t = ")[1].split()[0])
    assert t_end > 13.0  # of the pinned run: that shown has 10 s
    # and the focus stays on it
    page.focus("#pins button")
    page.evaluate(
        """() => { const K = document.querySelector('#slider-K');
        K.stepUp(20); K.dispatchEvent(new Event('input')) }"""
    )
    shown.wait()
    assert page.evaluate("document.activeElement.parentElement.parentElement.id") == "pins"
    described = "e => document.getElementById(e.getAttribute('aria-describedby')).innerText"
    assert "K = 700" in page.eval_on_selector("#pins button", described)
    page.keyboard.press("Enter")
    assert page.locator("#pins li").count() == 1


def test_changes_are_undone_and_done_again(show):
    shown = show()
    page = shown.page
    titles = [preset["title"] for preset in presets()]

    def preset():
        return page.eval_on_selector("#presets", "e => e.selectedOptions[0].text")

    assert (page.is_disabled("#undo"), page.is_disabled("#redo")) == (True, True)
    assert preset() == titles[0]
    shown.type("K", "700 MPa/m")
    page.wait_for_function(RESTED, arg="K=700 MPa/m")
    assert preset() == "your own values"
    page.focus("#slider-V_lp")
    for _ in range(3):  # one step, as they follow one another
        page.keyboard.press("ArrowRight")
    page.wait_for_function(RESTED, arg="V_lp=103.5 um/s")
    page.keyboard.press("Control+z")
    page.wait_for_function(RESTED, arg="V_lp=100 um/s")
    shown.wait()
    assert (shown.entry("V_lp"), shown.entry("K")) == ("100 \u00b5m/s", "700 MPa/m")
    assert (page.is_disabled("#undo"), page.is_disabled("#redo")) == (False, False)
    page.go_back()  # the browser's own button
    page.wait_for_function(RESTED, arg="K=960 MPa/m")
    assert shown.entry("K") == "960 MPa/m"
    assert preset() == titles[0]
    assert page.is_disabled("#undo")
    page.click("#redo")
    page.wait_for_function(RESTED, arg="K=700 MPa/m")
    page.keyboard.press("Control+Shift+z")
    page.wait_for_function(RESTED, arg="V_lp=103.5 um/s")
    # (the address changes before the entry does)
    page.wait_for_function(SHOWS, arg="103.5 \u00b5m/s")
    assert page.is_disabled("#redo")
    page.click("#undo")
    page.wait_for_function(RESTED, arg="V_lp=100 um/s")
    shown.type("K", "650 MPa/m")  # another future
    page.wait_for_function(RESTED, arg="K=650 MPa/m")
    assert page.is_disabled("#redo")


def test_a_pinned_run_says_what_was_before_and_what_it_lacks(show):
    shown = show()
    page = shown.page
    page.select_option("#presets", label="Fig. 2: Step to just above V_c")
    page.wait_for_function("() => location.hash.includes('V_from')")
    shown.wait()
    page.click("#pin")
    there = page.evaluate("location.hash")
    without = re.sub("&V_from=[^&]*", "", there)
    for hash_, said in ((without, "before = "), (there, "the run shown")):
        page.evaluate("hash => { location.hash = hash }", hash_)
        page.wait_for_function(
            "said => document.querySelector('#pins li').innerText.includes(said)", arg=said
        )
        if hash_ == without:
            page.click("#pin")
    first, second = page.locator("#pins li").all_inner_texts()
    assert first.startswith("the run shown")
    assert re.sub(r"\s", "", second).startswith("noVlpbefore")


def test_quick_undo_loses_no_change_and_stays_on_the_page(show):
    shown = show()
    page = shown.page
    for K in ("700", "710"):
        shown.type("K", f"{K} MPa/m")
        page.wait_for_function(RESTED, arg=f"K={K} MPa/m")
    page.focus("#entry-K")
    page.keyboard.press("Control+z")  # in a text field it is of typing
    page.wait_for_timeout(100)
    assert page.evaluate(RESTED, "K=710 MPa/m")
    page.evaluate("document.activeElement.blur()")
    shown.type("K", "720 MPa/m")
    page.click("#undo")  # at once: what is undone is the last change
    page.wait_for_function(RESTED, arg="K=710 MPa/m")
    page.click("#redo")
    page.wait_for_function(RESTED, arg="K=720 MPa/m")
    page.eval_on_selector("#undo", "e => { for (let i = 0; i < 5; i += 1) e.click() }")
    page.wait_for_function(RESTED, arg="K=710 MPa/m")
    for K in ("700", "960"):
        page.click("#undo")
        page.wait_for_function(RESTED, arg=f"K={K} MPa/m")
    assert page.is_disabled("#undo")
    page.keyboard.press("Control+z")
    page.wait_for_timeout(100)
    assert page.evaluate(RESTED, "K=960 MPa/m")


def test_what_was_undone_can_be_done_again_after_a_reload(show):
    shown = show()
    page = shown.page
    # a drag is one step, however long it rests on the way
    box = page.locator("#slider-K").bounding_box()
    y = box["y"] + 0.5 * box["height"]
    page.mouse.move(box["x"] + 0.5 * box["width"], y)
    page.mouse.down()
    for part in (0.6, 0.7):
        page.mouse.move(box["x"] + part * box["width"], y)
        page.wait_for_timeout(600)
    page.mouse.up()
    page.wait_for_function("() => !document.getElementById('undo').disabled")
    assert shown.entry("K") != "960 MPa/m"
    page.click("#undo")
    page.wait_for_function(RESTED, arg="K=960 MPa/m")
    assert page.is_disabled("#undo")
    shown.type("K", "700 MPa/m")
    page.wait_for_function(RESTED, arg="K=700 MPa/m")
    page.click("#undo")
    page.wait_for_function(RESTED, arg="K=960 MPa/m")
    page.reload()
    shown.wait()
    assert (page.is_disabled("#undo"), page.is_disabled("#redo")) == (True, False)
    page.click("#redo")
    page.wait_for_function(RESTED, arg="K=700 MPa/m")
    page.reload()
    shown.wait()
    assert (page.is_disabled("#undo"), page.is_disabled("#redo")) == (False, True)
    page.click("#undo")
    page.wait_for_function(RESTED, arg="K=960 MPa/m")
    page.goto("about:blank")  # what could be done again is gone
    page.go_back()
    shown.wait()
    assert (page.is_disabled("#undo"), page.is_disabled("#redo")) == (True, True)
