"""Steps of speed and normal stress on the page."""

import latency

from ratestate.interfaces import scenario


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
