"""Contrast of the explorer's colours, light and dark, by WCAG 2."""

import json
import re

import pytest

from ratestate.plot.figures.overview import MUTED
from ratestate_explorer.bundle import STATIC
from ratestate_explorer.wire import PINS

CSS = "".join(path.read_text() for path in sorted((STATIC / "css").glob("*.css")))
LIGHT, DARK = (
    dict(re.findall(r"--([\w-]+): (#[0-9a-f]{6});", block))
    for block in re.findall(r":root \{(.*?)\}", CSS, re.DOTALL)
)
REGIMES = ("steady", "slow", "stick", "harmonic", "unknown")


def test_each_pinned_run_has_its_colour_on_the_page_and_in_the_figure():
    names = [f"pinned-{k}" for k in range(1, PINS + 1)]
    for colors in (LIGHT, DARK):
        assert [name for name in colors if name.startswith("pinned-")] == names
    assert tuple(LIGHT[name] for name in names) == MUTED
    pins = (STATIC / "js/curves/pins.js").read_text()
    assert f"const ROLES = {json.dumps(names)};" in pins


def luminance(color):
    parts = [int(color[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    linear = [x / 12.92 if x <= 0.04045 else ((x + 0.055) / 1.055) ** 2.4 for x in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(first, second):
    low, high = sorted((luminance(first), luminance(second)))
    return (high + 0.05) / (low + 0.05)


def test_contrast_as_wcag_defines_it():
    assert contrast("#ffffff", "#000000") == pytest.approx(21.0)
    assert contrast("#777777", "#ffffff") == pytest.approx(4.48, abs=0.005)


@pytest.mark.parametrize("colors", [LIGHT, DARK], ids=["light", "dark"])
def test_text_is_readable_and_lines_are_seen(colors):
    texts = [(ink, paper) for ink in ("text", "muted", "problem") for paper in ("card", "page")]
    texts += [("accent", "card"), *(("on-map", regime) for regime in REGIMES)]
    inks = ("stress", "friction", "speed", "cycle", "run", "record", "fit", "edge", "accent")
    lines = [(ink, "card") for ink in (*inks, "pinned-1", "pinned-2", "pinned-3")]
    lines += [(ink, "inertia") for ink in ("stress", "friction")]
    lines += [(ink, regime) for ink in ("text", "jump") for regime in REGIMES[:4]]
    for pairs, least in ((texts, 4.5), (lines, 3.0)):
        for ink, paper in pairs:
            assert contrast(colors[ink], colors[paper]) >= least, (ink, paper)


def test_both_schemes_name_the_same_colors():
    assert set(LIGHT) == set(DARK)
    sizes = set(re.findall(r"--([\w-]+): [\d.]+rem", CSS))
    assert set(re.findall(r"var\(--([\w-]+)\)", CSS)) - sizes <= set(LIGHT)
