"""How often intervals of fits hold the truth: `python benchmarks/intervals.py [NUMBER]`.

Of 200 records drawn over a realistic range, which takes a minute: README has the numbers.
"""

import sys
import warnings
from pathlib import Path

from report import CONSOLE, Table

import ratestate as rs

sys.path.insert(0, str(Path(__file__).parents[1] / "tests/helpers"))
from synthetic_records import FREE, coverage


def rows(found):
    """(what, part that 68 % intervals hold, part that 95 % intervals hold, number) of each kind."""
    kinds = {"all": found.holds, "white noise": found.holds[~found.is_red]}
    kinds["correlated noise"] = found.holds[found.is_red]
    kinds["with mass"] = found.holds[found.has_mass]
    kinds["without mass"] = found.holds[~found.has_mass]
    kinds |= {name: found.holds[:, [i]] for i, name in enumerate(FREE)}
    return [(what, *holds.mean(axis=(0, 1)), holds[..., 0].size) for what, holds in kinds.items()]


def main():
    number = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    warnings.simplefilter("ignore", rs.FitWarning)
    table = Table("", "68 %", "95 %", "intervals", title=f"Truth in the intervals of {number} fits")
    for what, *parts, size in rows(coverage(number)):
        table.add_row(what, *(f"{100 * part:.1f} %" for part in parts), str(size))
    CONSOLE.print(table)


if __name__ == "__main__":
    main()
