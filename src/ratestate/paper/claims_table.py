"""The table of the paper's claims with verdicts, as Markdown and as JSON."""

import json
import math
from importlib.metadata import version

from ..files import replace
from ..friction.laws import law_name
from ..plot.labels import LAWS
from . import claims_cycles, claims_steps
from .claim import CLOSED_FORM, SENTENCES, claim, statements

#: what measures the claims: functions of a law that give id -> what `claim` takes
MEASUREMENTS = [
    claims_steps.on_friction,
    claims_steps.on_steps,
    claims_steps.on_map,
    claims_cycles.on_cycles,
    claims_cycles.on_regimes,
    claims_cycles.on_slow_slip,
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
    """Check the claims of the paper, in its order, by all or some measurements; list of `Claim`.

    The paper's numbers are for the slip law.  Its phrases are also tested under the aging law,
    which its supplement uses.
    """
    law = law_name(law)
    measured = {name: row for measure in measurements for name, row in measure(law).items()}
    order = list(statements())
    return [claim(name, law, measured[name]) for name in sorted(measured, key=order.index)]


def number(value):
    """Return a finite number as text: an integer below 1e6 in full, others to 5 digits."""
    return f"{value:.0f}" if value == round(value) and abs(value) < 1e6 else f"{value:.5g}"


def quantity(values, unit):
    """Return values and their unit as text."""
    return f"{', '.join(map(number, values))} {unit}".rstrip()


def _bounds_text(bounds):
    low, high = bounds
    if low == high:
        return number(low)
    if math.isinf(low) or math.isinf(high):
        return f"> {number(low)}" if math.isinf(high) else f"< {number(high)}"
    return f"{number(low)}..{number(high)}"


def cells(row):
    """Return lines on the paper, the scheme and converged values, three lists; ["-"] if none."""
    paper = (
        [row.paper, f"taken as {', '.join(map(_bounds_text, row.covers))}"] if row.covers else ["-"]
    )
    scheme = []
    for (omega_dt, *dt), values in row.scheme.items():
        times = ", ".join(f"{1e6 * x:.3g}" for x in dt)
        scheme.append(f"{quantity(values, row.unit)} at omega dt = {omega_dt:g}, dt = {times} us")
    error = f"+- {row.error:.0e}" if row.error else "+- 0"
    error = "closed form" if row.error_from == CLOSED_FORM else error
    return paper, scheme or ["-"], [f"{quantity(row.converged, row.unit)} ({error})"]


def tally(rows):
    """Return as text how many rows have each verdict."""
    counts = {verdict: sum(row.verdict == verdict for row in rows) for verdict in STYLES}
    return "; ".join(f"{count} {verdict}" for verdict, count in counts.items() if count)


def terminal(rows, law):
    """Return a rich Table of the rows, with the values of each claim below each other."""
    from rich.table import Table
    from rich.text import Text

    first, *sources, last = HEADINGS
    look = {"caption": tally(rows), "show_lines": True, "expand": True}
    table = Table(title=f"Claims, {LAWS[law].name}", **look)
    for heading, ratio in ((first, 5), ("Values", 6), (last, 2)):
        table.add_column(heading, ratio=ratio)
    for row in rows:
        claim = Text(f"{row.claim} [{row.where}]\n").append(row.note, "italic")
        values = zip(sources, cells(row), strict=True)
        text = "\n".join(f"{source}: {'; '.join(lines)}" for source, lines in values)
        table.add_row(claim, Text(text), Text(row.verdict, STYLES[row.verdict]))
    return table


def markdown(rows, law):
    """Return the table as Markdown, then the notes and how errors were estimated."""
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
    """Return the table as a dict that JSON can hold; an open end of a range is null."""
    return {
        "paper": "doi:10.1016/j.jmps.2018.08.026",
        "law": law,
        "scheme": SCHEME[law],
        "versions": {name: version(name) for name in ("ratestate", "llvmlite", "numpy")},
        "claims": [_plain(row) for row in rows],
    }


def _plain(row):
    """Return a row as a dict: null for what the paper does not give."""
    scheme = [
        {"omega_dt": omega_dt, "dt": dt, "values": by_scheme}
        for (omega_dt, *dt), by_scheme in row.scheme.items()
    ]
    covers = [[x if math.isfinite(x) else None for x in ends] for ends in row.covers]
    values = {name: getattr(row, name) for name in FIELDS} | {"scheme": scheme}
    or_null = {"paper": row.paper or None, "covers": covers or None, "note": row.note or None}
    return values | or_null | {"unit": row.unit or "1"}


def write(rows, law, out):
    """Write the table as claims_<law>.md and .json into an existing folder; return the paths."""
    text = json.dumps(record(rows, law), indent=2, allow_nan=False) + "\n"
    return [
        replace(out / f"claims_{law}.md", lambda path: path.write_text(markdown(rows, law))),
        replace(out / f"claims_{law}.json", lambda path: path.write_text(text)),
    ]
