"""What is said of a store: what it holds, how a sweep ended, which cases failed."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

if TYPE_CHECKING:
    from ..sweeps.status import Held


def tell(store: Path, file: Path | None) -> None:
    """Say what a store holds, and whether it is the file's sweep."""
    from ..sweeps.status import held

    there = held(store)
    rows = {
        "store": str(there.path),
        "verb": there.verb,
        "axes": ", ".join(f"{dim} ({size})" for dim, size in there.dims.items()),
        "cases": str(there.cases),
        "done": f"{there.done} ({100 * there.done // there.cases} %)",
        "failed": str(there.failed),
        "steady": str(there.steady),
        "chunks": f"{there.chunks_done} of {there.chunks}",
        "versions": ", ".join(f"{name} {version}" for name, version in there.versions.items()),
        "size": _size(there.size),
    }
    lines = _differences(store, file) if file else []
    if file:
        rows["file"] = f"{file} asks for {'another sweep:' if lines else 'this very sweep'}"
    for label, text in rows.items():
        typer.echo(f"{label:<9} {text}")
    for line in lines:
        typer.echo(f"  {line}")


def _differences(store: Path, file: Path) -> list[str]:
    """In what a file's sweep differs from a store's, a line each."""
    from ..scenario import load
    from ..sweeps.calls import call_of
    from ..sweeps.inputs import differences, inputs_of
    from ..sweeps.store import read

    asked = load(file)
    _, stored = read(store)
    return differences(stored, inputs_of(*call_of(asked.verb, asked.slider, asked.settings)))


def summary(there: "Held") -> str:
    """What became of all cases, and where."""
    answers = "cycles" if there.verb == "limit_cycle" else "finished"
    counts = {answers: there.done - there.steady - there.failed}
    counts |= {"steady sliding": there.steady, "failed": there.failed}
    counts["not done"] = there.cases - there.done
    ways = ", ".join(f"{n} {how}" for how, n in counts.items() if n or how == "failed")
    return f"{there.cases} cases in {there.path}: {ways}"


def left(store: Path) -> str:
    """What an interrupted sweep leaves behind."""
    if not store.exists():
        return f"nothing is stored in {store} yet; the same command starts again"
    try:
        from ..sweeps.status import held

        there = held(store)
    except Exception:  # of any kind, if it was the import of a module that was interrupted
        return f"what was done is stored in {store}; the same command resumes"
    return f"{there.done} of {there.cases} cases are stored in {store}; the same command resumes"


def place(where: dict[str, Any]) -> str:
    """Which case: its values along the axes, with units."""
    from ..quantities import QUANTITIES

    units = {dim: QUANTITIES[dim].unit.removesuffix("1") for dim in where}
    return ", ".join(f"{dim} = {x:.6g} {units[dim]}".rstrip() for dim, x in where.items())


def _size(size: int) -> str:
    """Bytes as kB, MB or GB."""
    power = min(max(len(str(size)) - 1, 0) // 3, 3)
    return f"{size / 1000**power:.3g} {['B', 'kB', 'MB', 'GB'][power]}"
