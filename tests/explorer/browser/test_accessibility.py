"""The page as axe-core judges it, by the rules of WCAG 2.2, levels A and AA."""

from axe_playwright_python.sync_playwright import Axe

TAGS = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"]
RULES = {"runOnly": {"type": "tag", "values": TAGS}, "resultTypes": ["violations"]}
#: the rules that look at colours, the only ones that the other scheme may break
COLORS = RULES | {"runOnly": {"type": "rule", "values": ["color-contrast", "link-in-text-block"]}}


LOOKS = [("light", 1440, 900), ("dark", 1440, 900), ("light", 390, 844)]


def test_no_rule_of_axe_is_violated(show):
    shown = show()
    page = shown.page
    page.click("#pin")
    page.click("#tasks-open")
    page.click("#task-start")
    shown.wait()
    shown.type("Dc", "10 Mpa")  # a problem beside its field
    page.wait_for_selector("#problem-Dc:not([hidden])")
    page.click("#more summary")
    for scheme, width, height in LOOKS:
        page.emulate_media(color_scheme=scheme)
        page.set_viewport_size({"width": width, "height": height})
        page.evaluate("scrollTo(0, 0)")  # else what is half below the motion on a phone is small
        page.focus("#entry-a")
        page.keyboard.press("Tab")  # to a slider, which is explained
        page.wait_for_selector("#explanation:not([hidden])")
        found = Axe().run(page, options=COLORS if scheme == "dark" else RULES).response
        told = [
            (rule["id"], [node["target"] for node in rule["nodes"]]) for rule in found["violations"]
        ]
        assert told == [], (scheme, width)
    # it can find some: a control without a name
    page.evaluate("() => document.querySelector('#factor-V_lp').removeAttribute('aria-label')")
    page.evaluate("() => document.querySelector('label[for=factor-V_lp]').remove()")
    page.evaluate("scrollTo(0, 0)")
    found = Axe().run(page, "#controls", RULES).response["violations"]
    assert "label" in [rule["id"] for rule in found]
