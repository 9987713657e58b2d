"""What can be taken along from the page."""

from explorer_links import CASES

from ratestate import scenario
from ratestate.paper.parameters import FIG4


def test_downloads(show, tmp_path):
    shown = show(CASES["stick-slip"])
    files = {name: shown.saved(name, tmp_path) for name in ("scenario", "python", "csv", "png")}
    assert scenario.load(files["scenario"]).slider == FIG4
    assert files["python"].read_text().endswith("print(result)\n")
    assert files["csv"].read_text().startswith("time [s],V [m/s],")
    png = files["png"].read_bytes()
    assert png.startswith(b"\x89PNG\r\n\x1a\n")
    width, height = (int.from_bytes(png[k : k + 4], "big") for k in (16, 20))
    assert (width, height) == (1382, 998)  # of 7.2 x 5.2 inches, each of twice 96 pixels
