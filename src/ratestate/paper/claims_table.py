"""The claims table: where each claim of the paper stands, in writing and as JSON."""

import json
import math
from importlib.metadata import version

from ..files import replace
from ..friction.laws import law_name
from ..plot.labels import LAWS
from . import claims_cycles, claims_regimes, claims_steps
from .claim import CLOSED_FORM, SENTENCES, claim, statements

#: what measures the claims: functions of a law that give id -> what `claim` takes
MEASUREMENTS = [
    claims_steps.on_friction,
    claims_steps.on_steps,
    claims_steps.on_map,
    claims_cycles.on_cycles,
    claims_regimes.on_regimes,
    claims_regimes.on_slow_slip,
]
STYLES = {
    "agrees": "green",
    "agrees with the scheme only": "yellow",
    "differs": "red",
    "no value given": "dim",
}
SCHEME = {"slip": "im2017", "aging": "im2017(euler=True)"}
HEADINGS = ("Claim", "Paper", "Paper's scheme", "Converged", "Verdict")
#: what JSON has of each row
FIELDS = "id where claim paper covers unit scheme converged error error_from verdict note".split()


def claims(law="slip", measurements=MEASUREMENTS):
    """Check the claims of the paper, in its order: list of `Claim`, for all or some measurements.

    The paper's text, and all of its numbers, are about the slip law; what it says in words is put
    to the aging law too, with which its supplement repeats runs.  ParameterError for another law.
    """
    law = law_name(law)
    measured = {name: row for measure in measurements for name, row in measure(law).items()}
    order = list(statements())
    return [claim(name, law, measured[name]) for name in sorted(measured, key=order.index)]


def number(value):
    """A finite number as text: whole if it is and is below 1e6, else to 5 digits."""
    return f"{value:.0f}" if value == round(value) and abs(value) < 1e6 else f"{value:.5g}"


def quantity(values, unit):
    """Values and their unit as text."""
    return f"{', '.join(map(number, values))} {unit}".rstrip()


def _between(bounds):
    low, high = bounds
    if low == high:
        return number(low)
    if math.isinf(low) or math.isinf(high):
        return f"> {number(low)}" if math.isinf(high) else f"< {number(high)}"
    return f"{number(low)}..{number(high)}"


def cells(row):
    """Lines (list) of what the paper says, the scheme's values, the converged ones; ["-"]: none."""
    paper = [row.paper, f"taken as {', '.join(map(_between, row.covers))}"] if row.covers else ["-"]
    scheme = []
    for (omega_dt, *dt), values in row.scheme.items():
        times = ", ".join(f"{1e6 * x:.3g}" for x in dt)
        scheme.append(f"{quantity(values, row.unit)} at omega dt = {omega_dt:g}, dt = {times} us")
    error = f"+- {row.error:.0e}" if row.error else "+- 0"
    error = "closed form" if row.error_from == CLOSED_FORM else error
    return paper, scheme or ["-"], [f"{quantity(row.converged, row.unit)} ({error})"]


def tally(rows):
    """How many rows have each verdict that any has, as text."""
    counts = {verdict: sum(row.verdict == verdict for row in rows) for verdict in STYLES}
    return "; ".join(f"{count} {verdict}" for verdict, count in counts.items() if count)


def terminal(rows, law):
    """A rich Table of the rows: notes below each claim, and the values of each below each other."""
    from rich.table import Table
    from rich.text import Text

    first, *sources, last = HEADINGS
    table = Table(
        *(first, "Values", last),
        title=f"Claims, {LAWS[law].name}",
        caption=tally(rows),
        show_lines=True,
        expand=True,
    )
    for column, ratio in zip(table.columns, (5, 6, 2), strict=True):
        column.ratio = ratio
    for row in rows:
        about = Text(f"{row.claim} ").append(f"[{row.where}]", "dim")
        if row.note:
            about.append(f"\n{row.note}", "italic")
        values = Text()
        for source, lines in zip(sources, cells(row), strict=True):
            values.append(f"{source}: ", "bold").append("; ".join(lines) + "\n")
        values.right_crop()
        table.add_row(about, values, Text(row.verdict, STYLES[row.verdict]))
    return table


def markdown(rows, law):
    """The table as Markdown text: one table, then the notes and how errors were estimated."""
    lines = [
        f"# Claims, {LAWS[law].name}",
        "",
        SENTENCES("text.introduction", call=SCHEME[law]),
        f"{tally(rows)}.",
        "",
        "| | " + " | ".join(HEADINGS) + " |",
        "|-|-|-|-|-|-|",
    ]
    for i, row in enumerate(rows, start=1):
        middle = ["<br>".join(lines) for lines in cells(row)]
        line = (str(i), f"{row.claim} ({row.where})", *middle, f"**{row.verdict}**")
        lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |")
    lines += ["", "## Notes, and where the errors come from", ""]
    for i, row in enumerate(rows, start=1):
        lines.append(f"{i}. `{row.id}`: {row.note} Error: {row.error_from}.".replace(":  ", ": "))
    return "\n".join(lines) + "\n"


def record(rows, law):
    """The table as a dict that JSON can hold; an open end of a range is null."""
    return {
        "paper": "doi:10.1016/j.jmps.2018.08.026",
        "law": law,
        "scheme": SCHEME[law],
        "versions": {name: version(name) for name in ("ratestate", "llvmlite", "numpy")},
        "claims": [_plain(row) for row in rows],
    }


def _plain(row):
    """A row as a dict: null for what the paper does not give, and for an open end of a range."""
    values = {name: getattr(row, name) for name in FIELDS}
    return values | {
        "paper": row.paper or None,
        "covers": [[x if math.isfinite(x) else None for x in ends] for ends in row.covers] or None,
        "unit": row.unit or "1",
        "scheme": [
            {"omega_dt": omega_dt, "dt": dt, "values": by_scheme}
            for (omega_dt, *dt), by_scheme in row.scheme.items()
        ],
        "note": row.note or None,
    }


def write(rows, law, out):
    """Write the table as claims_<law>.md and .json into a folder that exists; list of the paths."""
    text = json.dumps(record(rows, law), indent=2, allow_nan=False) + "\n"
    return [
        replace(out / f"claims_{law}.md", lambda path: path.write_text(markdown(rows, law))),
        replace(out / f"claims_{law}.json", lambda path: path.write_text(text)),
    ]
