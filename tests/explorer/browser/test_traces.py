"""The traces of the page: zoom, the instant that all charts mark, the gap that inertia makes."""

import numpy as np
import pytest

PLOT = "#stress-chart .u-over"


def drag(page, begin, end):
    """Drag over shares of the upper trace's width."""
    box = page.locator(PLOT).bounding_box()
    y = box["y"] + 0.4 * box["height"]
    page.mouse.move(box["x"] + begin * box["width"], y)
    page.mouse.down()
    page.mouse.move(box["x"] + end * box["width"], y, steps=4)
    page.mouse.up()


def time_at(page, share):
    """The time in the readout with the pointer at a share of the upper trace's width."""
    box = page.locator(PLOT).bounding_box()
    page.mouse.move(box["x"] + share * box["width"], box["y"] + 0.4 * box["height"])
    text = page.inner_text("#readout")
    assert " s" in text, text
    return float(text.split("t = ")[1].split()[0])


def test_a_zoom_stays_while_parameters_change(show):
    shown = show()
    page = shown.page
    whole = [time_at(page, share) for share in (0.002, 0.998)]
    assert page.is_disabled("#unzoom")
    drag(page, 0.25, 0.5)
    wanted = np.interp([0.25, 0.5], [0.002, 0.998], whole)
    zoomed = [time_at(page, share) for share in (0.002, 0.998)]
    np.testing.assert_allclose(zoomed, wanted, atol=0.01 * whole[1])
    shown.set("K", "950 MPa/m")
    np.testing.assert_allclose([time_at(page, share) for share in (0.002, 0.998)], zoomed, 1e-3)
    page.click("#unzoom")
    assert page.is_disabled("#unzoom")
    assert time_at(page, 0.998) == pytest.approx(whole[1], rel=0.03)
    # of a zoom that a much shorter run lies before nothing is left
    drag(page, 0.6, 0.9)
    shown.set("V_lp", "10 mm/s")
    assert page.is_disabled("#unzoom")


def test_all_charts_mark_the_instant(show):
    shown = show()
    page = shown.page
    assert page.is_hidden("#phase-point")
    assert "gap: inertia" in page.inner_text("#readout")
    time_at(page, 0.43)
    assert page.is_visible("#phase-point")
    page.hover("#headline")
    assert page.is_hidden("#phase-point")
    assert "t =" not in page.inner_text("#readout")
    # a gap has the name of what makes it
    for entries, name in (("M=0", None), ("M=0&damping=4 MPa s/m", "gap: damping")):
        shown.go(f"a=0.005&b=0.008&Dc=10 um&sigma=4 MPa&K=1.3 GPa/m&V_lp=10 um/s&{entries}")
        named = shown.page.query_selector("#readout .patch.inertia")
        assert (named is None) == (name is None)
        assert name is None or name in shown.page.inner_text("#readout")
