"""How often intervals of fits hold the truth: `python benchmarks/intervals.py [NUMBER]`.

Of 200 records drawn over a realistic range, which takes a minute: README has the numbers.  With
--two-states of as many records under laws with two states.
"""

import argparse
import sys
import warnings
from pathlib import Path

from report import CONSOLE, Table
from scipy.stats import binom

import ratestate as rs

sys.path.insert(0, str(Path(__file__).parents[1] / "tests/helpers"))
from synthetic_records import FREE, FREE_OF_TWO_STATES, coverage, drawn, drawn_of_two_states


def rows(found, free):
    """(what, part that 68 % intervals hold, part that 95 % intervals hold, number) of each kind."""
    kinds = {"all": found.holds, "white noise": found.holds[~found.is_red]}
    kinds["correlated noise"] = found.holds[found.is_red]
    kinds["with mass"] = found.holds[found.has_mass]
    kinds["without mass"] = found.holds[~found.has_mass]
    kinds |= {name: found.holds[:, [i]] for i, name in enumerate(free)}
    sizes = {what: holds[..., 0].size for what, holds in kinds.items()}
    return [(w, *holds.mean(axis=(0, 1)), sizes[w]) for w, holds in kinds.items() if sizes[w]]


def main():
    parser = argparse.ArgumentParser(description="Coverage of the intervals of fits.")
    parser.add_argument("number", nargs="?", type=int, default=200, help="records")
    parser.add_argument("--two-states", action="store_true", help="under laws with two states")
    options = parser.parse_args()
    draw, free = drawn_of_two_states, FREE_OF_TWO_STATES
    if not options.two_states:
        draw, free = drawn, FREE
    number = options.number
    warnings.simplefilter("ignore", rs.FitWarning)
    found = coverage(number, draw, free)
    table = Table("", "68 %", "95 %", "intervals", title=f"Truth in the intervals of {number} fits")
    for what, *parts, size in rows(found, free):
        table.add_row(what, *(f"{100 * part:.1f} %" for part in parts), str(size))
    CONSOLE.print(table)
    low, high = binom.interval(0.95, number, 0.95)
    every = int(found.holds[..., -1].all(axis=1).sum())
    CONSOLE.print(
        f"of {number} records a likelihood-ratio test at 95 % accepts the truth of all parameters "
        f"but K at once in {int(found.together.sum())}, and every single 95 % interval holds it in "
        f"{every}; of one interval or test {low:.0f} to {high:.0f} are expected, 95 times of 100"
    )


if __name__ == "__main__":
    main()
