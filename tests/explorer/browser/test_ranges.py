"""The sliders: what they reach over, and what is marked on them."""

import math

import pytest
from explorer_links import CASES

import ratestate as rs
from ratestate.dynamics.verdict import verdict
from ratestate.paper.parameters import FIG2

AGING = CASES["steady"].replace("law=slip", "law=aging").replace("900 MPa", "601 MPa")
#: middles of the marks and of the thumb's way on a field's slider, and the labels
MARKS = """field => { const range = document.querySelector(`#slider-${field}`);
    const { left, width } = range.getBoundingClientRect();
    const thumb = 16;
    const marks = range.parentElement.querySelector('.marks');
    const middle = e => { const b = e.getBoundingClientRect(); return b.x + b.width / 2 };
    return { way: [left + thumb / 2, width - thumb],
        ticks: [...marks.querySelectorAll('.tick')].map(middle),
        labels: [...marks.querySelectorAll('.label')].map(e => [e.textContent, middle(e),
            e.getBoundingClientRect().left - left, left + width - e.getBoundingClientRect().right])
    } }"""


def ends(shown, symbol):
    texts = shown.page.eval_on_selector_all(
        f".range:has(#slider-{symbol}) .ends span", "all => all.map(e => e.textContent)"
    )
    return [text.replace("\N{NO-BREAK SPACE}", " ") for text in texts]


def place(way, value, low, high):
    """Where a value [SI] is on a slider, in pixels."""
    left, width = way
    return left + width * math.log(value / low) / math.log(high / low)


def test_critical_values_are_marked_where_they_are(show):
    shown = show(AGING)
    slider = FIG2.replace(law="aging", K=601e6)
    steady, answer = rs.stability(slider, 3e-4), verdict(slider, 3e-4)
    found = shown.page.evaluate(MARKS, "V_lp")
    assert found["ticks"] == [
        pytest.approx(place(found["way"], float(steady.V_c), 1e-6, 1e-2), abs=0.6)
    ]
    assert [text for text, *_ in found["labels"]] == ["Vc"]
    found = shown.page.evaluate(MARKS, "K")
    marked = [float(steady.K_c)] if answer.K_fold is None else [float(steady.K_c), answer.K_fold]
    wanted = [place(found["way"], value, 1e7, 1e11) for value in marked]
    assert found["ticks"] == pytest.approx(wanted, abs=0.6)
    # the mark of the critical mass follows the stiffness, and the thumb stands on it there
    shown.type("V_lp", "3.2 mm/s")
    shown.set("K", "900 MPa/m")
    M_c = 9e8 / 6e8 - 1  # eta at which K = K_c
    M_c *= 2e6 * 0.003 * 1e-5 / 3.2e-3**2
    found = shown.page.evaluate(MARKS, "M")
    assert found["ticks"] == [pytest.approx(place(found["way"], M_c, 10, 1e5), abs=0.6)]
    assert [text for text, *_ in found["labels"]] == ["Mc"]


def test_marks_that_are_close_have_one_label_and_it_stays_inside(show):
    shown = show(AGING.replace("0.3 mm/s", "100 um/s").replace("601 MPa", "600.6 MPa"))
    found = shown.page.evaluate(MARKS, "K")
    slider = FIG2.replace(law="aging", K=600.6e6)
    wanted = [float(rs.stability(slider, 1e-4).K_c), verdict(slider, 1e-4).K_fold]
    assert found["ticks"] == pytest.approx(
        [place(found["way"], value, 1e7, 1e11) for value in wanted], abs=0.6
    )
    assert [text for text, *_ in found["labels"]] == ["Kc Kfold"]
    assert shown.page.get_attribute("#slider-K", "aria-valuetext") == (
        "600.6 MPa/m, above K_c and below K_fold"
    )
    # K_c near either end of the slider, and right at it
    for sigma, side in (("40 kPa", 0), ("34 kPa", 0), ("300 MPa", 1), ("333 MPa", 1)):
        shown.set("sigma", sigma)
        ((text, _, *room),) = shown.page.evaluate(MARKS, "K")["labels"]
        assert text == "Kc"
        assert room[side] < 30, sigma
        assert min(room) > -1, sigma


def test_a_range_stays_but_for_values_from_elsewhere(show):
    shown = show()
    assert ends(shown, "K") == ["10 MPa/m", "100 GPa/m"]
    assert ends(shown, "V_lp") == ["1 \u00b5m/s", "10 mm/s"]
    assert ends(shown, "a") == ["0.001", "0.1"]
    assert ends(shown, "M") == ["1 kg/m\u00b2", "10000 kg/m\u00b2"]
    # not by hand, to the very end
    shown.page.press("#slider-V_lp", "End")
    shown.wait()
    assert shown.entry("V_lp") == "10 mm/s"
    assert ends(shown, "V_lp") == ["1 \u00b5m/s", "10 mm/s"]
    # nor for a typed value inside, but for one outside
    shown.set("V_lp", "9.9 mm/s")
    assert ends(shown, "V_lp") == ["1 \u00b5m/s", "10 mm/s"]
    shown.set("V_lp", "10.1 mm/s")
    assert ends(shown, "V_lp") == ["100 \u00b5m/s", "1 m/s"]
    at = float(shown.page.input_value("#slider-V_lp"))
    assert at == pytest.approx(math.log10(0.0101), abs=0.003)
    # a preset begins anew
    shown.choose("#presets", index=1)
    assert ends(shown, "V_lp") == ["1 \u00b5m/s", "10 mm/s"]
    # an address does not where its value is within, such as that of a change undone
    shown.page.evaluate("location.hash = 'V_lp=9 mm/s'")
    shown.page.wait_for_function("() => document.querySelector('#entry-V_lp').value[0] === '9'")
    shown.wait()
    assert ends(shown, "V_lp") == ["1 \u00b5m/s", "10 mm/s"]
    # and with a page that is opened by a link it reaches about what that holds
    assert ends(show("V_lp=9 mm/s"), "V_lp") == ["100 \u00b5m/s", "1 m/s"]
    # a negative value has negative ends
    assert ends(show("b=-0.001"), "b") == ["-0.0001", "-0.01"]
