"""What a part of the benchmark found, as a table on the screen, in Markdown and in JSON."""

import dataclasses
import json
import os
import platform
import sys
from importlib import metadata
from pathlib import Path

from rich.console import Console
from rich.table import Table

CONSOLE = Console(width=None if sys.stdout.isatty() else 120)


@dataclasses.dataclass
class Goal:
    """What was asked, what was found, and whether that will do."""

    asked: str
    found: str
    met: bool

    @property
    def verdict(self):
        return "met" if self.met else "NOT MET"


@dataclasses.dataclass
class Part:
    """One part: a table of strings, remarks, goals."""

    title: str
    columns: list[str]
    rows: list[list[str]] = dataclasses.field(default_factory=list)
    notes: list[str] = dataclasses.field(default_factory=list)
    goals: list[Goal] = dataclasses.field(default_factory=list)
    text: int = 1  # leading columns that are words, not numbers

    def add(self, *cells):
        self.rows.append([str(cell) for cell in cells])

    def goal(self, asked, found, met):
        self.goals.append(Goal(asked, found, bool(met)))

    def show(self):
        """Print it."""
        table = Table(title=self.title, title_justify="left", title_style="bold")
        for i, column in enumerate(self.columns):
            table.add_column(column, justify="left" if i < self.text else "right")
        for row in self.rows:
            table.add_row(*row)
        CONSOLE.print(table)
        for note in self.notes:
            CONSOLE.print(f"  {note}", highlight=False)
        for goal in self.goals:
            style = "green" if goal.met else "bold red"
            CONSOLE.print(f"  goal: {goal.asked}: {goal.found}  [{style}]{goal.verdict}[/]")
        CONSOLE.print()

    def markdown(self):
        lines = [f"## {self.title}", "", _row(self.columns)]
        lines.append(_row(["---" if i < self.text else "---:" for i in range(len(self.columns))]))
        lines += [_row(row) for row in self.rows]
        lines += ["", *(f"- {note}" for note in self.notes)]
        if self.goals:
            lines += ["", _row(["goal", "found", ""]), _row(["---"] * 3)]
            lines += [_row([g.asked, g.found, g.verdict]) for g in self.goals]
        return "\n".join([*lines, ""])


def _row(cells):
    return "| " + " | ".join(cells) + " |"


def environment():
    """The machine and the versions, name -> words."""
    found = {"processor": _processor(), "cores": str(os.cpu_count())}
    if hasattr(os, "getloadavg"):
        found["load at the end"] = f"{os.getloadavg()[0]:.1f} (1 min; idle but for this run: 1)"
    found["Python"] = platform.python_version()
    for name in ("ratestate", "numba", "numpy", "scipy", "lmfit", "numbalsoda", "heyoka"):
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            found[name] = "not installed"
    return found


def _processor():
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        return next(line.split(":")[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()


def write(parts, folder):
    """Write results.md and results.json."""
    folder.mkdir(parents=True, exist_ok=True)
    about = environment()
    text = ["# Benchmark", "", ", ".join(f"{k} {v}" for k, v in about.items()), ""]
    text += [part.markdown() for part in parts]
    (folder / "results.md").write_text("\n".join(text))
    record = {"environment": about, "parts": [dataclasses.asdict(part) for part in parts]}
    (folder / "results.json").write_text(json.dumps(record, indent=1) + "\n")


def power(tol):
    """A tolerance in short: 1e-06 -> 1e-6."""
    return f"{tol:.1e}".replace(".0e", "e").replace("e-0", "e-")
