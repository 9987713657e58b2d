"""One state or two: `python benchmarks/states.py RECORD [--out FIGURE.png] [--sigma "30 MPa"]`.

Fits a laboratory record of velocity steps under the slip and aging laws and under those with two
states, compares them by AIC, prints the estimates, and draws record, fits and residuals.
"""

import argparse
import warnings
from pathlib import Path

from report import CONSOLE

import ratestate as rs
from ratestate import plot

LAWS = ("slip", "two-state-slip", "aging", "two-state-aging")
FREE = ("a", "b", "Dc", "b2", "Dc2", "K")


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("record", type=Path)
    parser.add_argument("--out", type=Path, default=Path("build/bench/states.png"))
    parser.add_argument("--sigma", help="the median of the record's by default")
    options = parser.parse_args()
    record = rs.read_lab(options.record)
    sigma = options.sigma or float(record.sigma.median())
    start = {"a": 0.01, "b": 0.01, "Dc": "10 um", "b2": 0.002, "Dc2": "100 um"}
    slider = rs.SpringSlider(**start, sigma=sigma, K="1e-3/um", law=LAWS[1])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rs.FitWarning)  # the summary lists them
        result = rs.fit(record, slider, FREE, law=LAWS)
    CONSOLE.print(rs.summary(result), highlight=False, markup=False, soft_wrap=True)
    for law, difference in zip(LAWS, result.aic_difference.values, strict=True):
        CONSOLE.print(f"{law}: AIC above the least by {difference:.1f}", highlight=False)
    options.out.parent.mkdir(parents=True, exist_ok=True)
    plot.save(plot.fit(result), options.out)
    CONSOLE.print(f"written to {options.out}", highlight=False)


if __name__ == "__main__":
    main()
