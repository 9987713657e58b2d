"""Laws, forms of friction and damping on the page."""

import ratestate as rs
from ratestate.paper.parameters import FIG4

INNER = "all => all.map(e => e.innerHTML)"


def test_friction_has_forms_with_fields_of_their_own(show):
    shown = show()
    enabled = "#friction_form option:not([disabled])"
    assert shown.page.eval_on_selector_all(enabled, INNER) == ["log", "cut-off", "regularized"]
    assert not shown.page.is_visible("#entry-V2")
    shown.choose("#friction_form", "cut-off")
    assert (
        shown.page.inner_html(".field:has(#entry-V2) .symbol [data-meaning]")
        == "<i>V</i><sub>2</sub>"
    )
    shown.type("V1", "1 m/s")
    shown.set("V2", "2 um/s")
    cycle = rs.limit_cycle(FIG4.replace(friction_form="cut-off", V1=1.0, V2=2e-6), 1e-4)
    assert shown.numbers["amplitude of \u03c4/\u03c3"] == f"{float(cycle.amplitude):.4g}"
    # a law that it does not go with has its own; what was typed waits for its form
    shown.choose("#law", "nagata")
    assert shown.page.input_value("#friction_form") == "log"
    assert shown.page.eval_on_selector_all(enabled, INNER) == ["log"]
    assert not shown.page.is_visible("#entry-V2")
    shown.page.select_option("#law", "slip")
    shown.choose("#friction_form", "cut-off")
    assert shown.entry("V2") == "2 \u00b5m/s"


def test_a_link_whose_friction_does_not_go_with_its_law(show):
    shown = show("law=flash-heating")  # which needs to have none
    texts = "inputs => inputs.map(input => input.value)"
    fields = shown.page.eval_on_selector_all(".field input", texts)
    assert shown.page.input_value("#friction_form") == "regularized"
    shown.go("law=flash-heating&friction_form=log")
    assert "does not go with law = 'flash-heating'" in shown.text("#problem-friction_form")
    assert shown.text("#stale") == "The page shows the last valid values. Correct friction_form."
    assert shown.page.is_visible("#entry-V_w")
    shown.choose("#friction_form", "regularized")
    assert not shown.page.is_visible("#problem-friction_form")
    assert shown.page.eval_on_selector_all(".field input", texts) == fields
    assert len(fields) >= 20


def test_a_law_has_its_own_fields(show):
    shown = show()
    own = ["b2", "Dc2"]
    assert not any(shown.page.is_visible(f"#entry-{symbol}") for symbol in own)
    shown.choose("#law", label="two-state slip law")
    assert [shown.entry(symbol) for symbol in own] == ["0.002", "100 \u00b5m"]
    labels = shown.page.eval_on_selector_all(
        "#own .field:not([hidden]) .symbol [data-meaning]", INNER
    )
    assert labels[:2] == ["<i>b</i><sub>2</sub>", "<i>D</i><sub>c</sub><sub>2</sub>"]
    assert labels[2:] == ["damping", "<i>\u03b1</i>"]
    shown.set("b2", "-0.001")
    slider = FIG4.replace(law="two-state-slip", b2=-0.001, Dc2=1e-4)
    K_c = float(rs.stability(slider, 1e-4).K_c)
    assert shown.numbers["Kc"] == f"{K_c / 1e9:.4g} GPa/m"
    shown.page.focus("#slider-b2")
    shown.page.keyboard.press("PageUp")  # larger, of the same sign
    shown.wait()
    assert float(shown.entry("b2")) < -0.001
    shown.page.wait_for_selector("#map-note:not([hidden])")
    assert "has no map of regimes" in shown.text("#map-note")
    shown.type("Dc2", "2 MPa")
    shown.page.wait_for_selector("#problem-Dc2:not([hidden])")
    shown.type("Dc2", "0.2 mm")
    shown.page.wait_for_function("() => location.href.includes('Dc2=0.2+mm')")
    link = shown.page.evaluate("location.href")
    # another law has none of them, nor has the link; and they come back as they were
    shown.choose("#law", "aging")
    shown.page.wait_for_function("() => !location.href.includes('Dc2')")
    assert not any(shown.page.is_visible(f"#entry-{symbol}") for symbol in own)
    shown.choose("#law", "two-state-slip")
    assert shown.entry("Dc2") == "0.2 mm"
    other = show(link.partition("#")[2])
    assert other.page.input_value("#law") == "two-state-slip"
    assert other.entry("Dc2") == "0.2 mm"


def test_a_law_file_is_in_the_menu(show):
    shown = show()
    shown.choose("#presets", index=1)
    name = shown.page.eval_on_selector("#law option[value^=mine]", "option => option.value")
    shown.choose("#law", name)
    assert shown.entry("m") == "1.5"
    assert "peak-to-peak" in shown.text("#headline")
