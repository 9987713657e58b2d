"""What can be taken along from the page."""

import latency
import numpy as np

from ratestate.interfaces import scenario
from ratestate.paper.parameters import FIG4


def test_a_link_holds_everything(show):
    shown = show()
    shown.type("sigma", "5 MPa")
    shown.page.click("#step-V_lp")
    shown.page.select_option("#law", "aging")
    shown.wait()
    shown.page.click("#link")
    link = shown.page.evaluate("navigator.clipboard.readText()")
    other = show(link.partition("#")[2])
    assert other.entry("sigma") == "5 MPa"
    assert other.entry("V_lp") == "300 \u00b5m/s"
    assert other.page.input_value("#law") == "aging"
    assert other.text("#headline") == shown.text("#headline")
    assert other.text("#stepped") == shown.text("#stepped")
    other.page.reload()
    other.wait()
    assert other.text("#headline") == shown.text("#headline")


def test_downloads(show, tmp_path):
    shown = show(latency.CASES["stick-slip"])
    files = {}
    for name in ("scenario", "python", "csv", "png"):
        with shown.page.expect_download() as download:
            shown.page.click(f"#{name}")
        files[name] = tmp_path / download.value.suggested_filename
        download.value.save_as(files[name])
    loaded = scenario.load(files["scenario"])
    assert loaded.slider == FIG4
    run = scenario.run(loaded)
    lines: dict = {}
    exec(files["python"].read_text(), lines)
    assert any(hasattr(v, "tau") and np.array_equal(v.tau, run.tau) for v in lines.values())
    rows = np.genfromtxt(files["csv"], delimiter=",", skip_header=1)
    assert rows.shape[0] == run.sizes["time"]
    assert files["csv"].read_text().startswith("time [s],V [m/s],")
    png = files["png"].read_bytes()
    assert png.startswith(b"\x89PNG\r\n\x1a\n")
    width, height = (int.from_bytes(png[k : k + 4], "big") for k in (16, 20))
    assert (width, height) == (1382, 998)  # of 7.2 x 5.2 inches, each of twice 96 pixels
