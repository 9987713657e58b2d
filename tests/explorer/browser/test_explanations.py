"""What a symbol means, beside it: by pointer, keyboard and finger."""

TIP = "#explanation"
VISIBLE = "#explanation:not([hidden])"
INSIDE = """() => { const b = document.querySelector('#explanation').getBoundingClientRect();
    return b.left >= 0 && b.top >= 0 && b.right <= innerWidth && b.bottom <= innerHeight }"""
TEXT = "() => document.querySelector('#explanation').innerText"
LABEL, SPEED = (f"label[for=entry-{symbol}] [data-meaning]" for symbol in ("K", "V_lp"))
#: where the page names something -> how its explanation begins
NAMED = {
    "#reasons [data-meaning=K_c_qs]": "Kc,qs quasi-static critical stiffness [Pa/m]",
    "#numbers [data-meaning='Floquet multiplier']": "Floquet multiplier\n\nThe factor by which",
    "#readout [data-meaning='tau/sigma']": "\u03c4/\u03c3 stress of the spring divided by",
    "#stress-chart .u-axis >> nth=1": "\u03c4/\u03c3 stress of the spring divided by normal stress",
    "#speed-chart .u-axis >> nth=0": "t time [s]",
    "#map .axis-name.x": "K/Kc,qs stiffness divided by quasi-static critical stiffness\n",
    "#phase .axis-name.y": "V slip velocity [m/s]",
    "#cycle-key [data-meaning]": "limit cycle\n\nA motion that repeats",
    ".drag [data-meaning=M]": "M mass per area [kg/m\u00b2]",
}


def test_a_symbol_that_is_pointed_at_is_explained(show):
    shown = show()
    page = shown.page
    assert page.is_hidden(TIP)
    page.hover(LABEL)
    page.wait_for_selector(VISIBLE)
    assert shown.text(TIP).startswith("K stiffness per area [Pa/m]\n")
    assert "Below Kc it is too soft" in shown.text(TIP).replace("\n", " ")
    assert page.get_attribute(TIP, "role") == "tooltip"
    assert page.get_attribute(LABEL, "aria-describedby") == "explanation"
    assert page.evaluate(INSIDE)
    # it does not hide what it explains, and the pointer may go onto it
    tip, label = page.locator(TIP).bounding_box(), page.locator(LABEL).bounding_box()
    assert tip["y"] + tip["height"] <= label["y"]
    page.hover(TIP)
    page.wait_for_timeout(400)
    assert page.is_visible(TIP)
    page.mouse.move(700, 500)
    page.wait_for_selector(TIP, state="hidden")
    assert page.get_attribute(LABEL, "aria-describedby") is None
    # Escape sends it away, until the pointer has been elsewhere
    page.hover(f"{SPEED} i")
    page.wait_for_selector(VISIBLE)
    page.keyboard.press("Escape")
    assert page.is_hidden(TIP)
    page.hover(f"{SPEED} sub")
    page.wait_for_timeout(400)
    assert page.is_hidden(TIP)
    page.mouse.move(700, 500)
    page.hover(f"{SPEED} sub")
    page.wait_for_selector(VISIBLE)
    # and so is what is named elsewhere
    for where, begins in NAMED.items():
        page.locator(where).first.hover()
        page.wait_for_function(
            f"begins => ({TEXT})().startsWith(begins)", arg=begins, timeout=5_000
        )
        assert page.evaluate(INSIDE), where


def test_what_has_the_focus_is_explained_until_it_is_changed(show):
    shown = show()
    page = shown.page
    page.click("#entry-sigma")  # by pointer: it is for typing
    assert page.is_hidden(TIP)
    page.keyboard.press("Tab")
    page.wait_for_selector(VISIBLE)
    assert shown.text(TIP).startswith("\u03c3 normal stress [Pa]")
    assert page.get_attribute("#slider-sigma", "aria-describedby") == "explanation"
    page.keyboard.press("ArrowRight")
    assert page.is_hidden(TIP)
    page.keyboard.press("Tab")
    assert page.get_attribute("#entry-M", "aria-describedby") == "problem-M explanation"
    page.keyboard.press("Escape")
    assert page.is_hidden(TIP)
    assert page.get_attribute("#entry-M", "aria-describedby") == "problem-M"
    # one that was out of sight is scrolled to, and its explanation with it
    page.focus("#slider-damping")
    page.evaluate("document.querySelector('#controls').scrollTo(0, 0)")
    page.keyboard.press("Tab")
    page.wait_for_timeout(200)
    assert shown.text(TIP).startswith("\u03b1 response of state to normal stress")
    assert page.evaluate(INSIDE)
    tip, field = page.locator(TIP).bounding_box(), page.locator("#entry-alpha").bounding_box()
    assert 0 <= field["y"] - tip["y"] - tip["height"] < 15
    # the table of numbers is one stop of Tab, and arrow keys go on within it
    page.focus("#numbers [data-meaning='K/K_c']")
    heads = []
    for key in ("ArrowRight", "ArrowDown", "ArrowLeft", "ArrowLeft", "ArrowLeft"):
        page.keyboard.press(key)
        heads.append(shown.text(TIP).partition("\n")[0])
    assert heads == [
        "Kc critical stiffness [Pa/m]",
        "\u03b7 dynamic instability coefficient",
        "Kc critical stiffness [Pa/m]",
        "K/Kc stiffness divided by critical stiffness",
        "Floquet multiplier",
    ]
    page.keyboard.press("Tab")
    assert page.is_hidden(TIP)
    page.keyboard.press("Shift+Tab")
    assert shown.text(TIP).startswith("Floquet multiplier")


def test_a_finger_taps_a_symbol(show):
    shown = show(viewport={"width": 390, "height": 844}, has_touch=True, is_mobile=True)
    page = shown.page
    shown.watch_shifts()
    page.locator("#numbers [data-meaning=V_min]").tap()
    page.wait_for_selector(VISIBLE)
    assert shown.text(TIP).startswith("V")
    assert page.evaluate(INSIDE)
    page.locator("#headline").tap(position={"x": 2, "y": 2})
    assert page.is_hidden(TIP)
    label = page.locator("label[for=entry-alpha] [data-meaning]")
    label.scroll_into_view_if_needed()
    page.wait_for_timeout(100)  # (scrolling sends it away)
    label.tap()
    page.wait_for_selector(VISIBLE)
    assert page.evaluate(INSIDE)
    assert page.evaluate("document.activeElement.id") != "entry-alpha"  # and no keyboard opens
    label.tap()
    assert page.is_hidden(TIP)
    assert shown.shifts == []


def test_every_meaning_is_of_what_the_page_names(show):
    shown = show("law=two-state-slip&b2=0.002&Dc2=100 um")
    named = shown.page.evaluate(
        """async () => { const all = [...document.querySelectorAll('[data-meaning]')];
        return [...new Set(all.flatMap(e => e.dataset.meaning.split(',')))] }"""
    )
    assert {"b2", "K/K_c_qs", "mu", "t", "not known", "V_min"} <= set(named)
    silent = []
    for name in named:
        shown.page.evaluate(
            """name => { const probe = document.body.appendChild(document.createElement('button'));
            probe.dataset.meaning = name; probe.id = 'probe'; probe.focus() }""",
            name,
        )
        if shown.page.is_hidden(TIP):
            silent.append(name)
        shown.page.evaluate("document.querySelector('#probe').remove()")
    assert silent == []
