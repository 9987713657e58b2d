"""What is said of a store: what it holds, how a sweep ended, which cases failed."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...errors import StoreError
from .document import strict
from .say import say

if TYPE_CHECKING:
    import xarray

    from ...sweeps.status import Held


def ended(store: Path, result: "xarray.Dataset", json: bool) -> int:
    """Say how a sweep into a store ended; the number of failed cases."""
    from ...sweeps.status import failures, held
    from .report.sweep import failed_lines

    there = held(store)
    if json:
        found, _ = failures(result, most=there.failed)
        names = ("at", "status", "message")
        say(strict(_known(there) | {"failures": [dict(zip(names, x, strict=True)) for x in found]}))
    else:
        say(summary(there))
        for line in failed_lines(result) if there.failed else []:
            say(line)
    return there.failed


def _known(there: "Held") -> dict[str, Any]:
    """What a store holds, for JSON."""
    return there._asdict() | {"path": str(there.path)}


def tell(store: Path, file: Path | None, json: bool, verify: bool = False) -> None:
    """Say what a store holds, whether it is whole, and whether it is the file's sweep.

    Raises
    ------
    StoreError
        It is damaged, where that was to be verified.
    """
    from ...sweeps.manifest import told
    from ...sweeps.status import held

    there = held(store, verify)
    lines = _differences(store, file) if file else []
    if json:
        say(strict(_known(there) | ({"differences": lines} if file else {})))
    else:
        _tell(there, file, lines)
    if there.flaws:
        raise StoreError(told(store, there.flaws))


def _tell(there: "Held", file: Path | None, lines: list[str]) -> None:
    """Print what a store holds, a row each."""
    rows = {
        "store": str(there.path),
        "verb": there.verb,
        "axes": ", ".join(f"{dim} ({size})" for dim, size in there.dims.items()),
        "cases": str(there.cases),
        "done": f"{there.done} ({100 * there.done // there.cases} %)",
        "failed": str(there.failed),
        "steady": str(there.steady),
        "chunks": f"{there.chunks_done} of {there.chunks}",
        "versions": _versions(there.versions),
        "size": _size(there.size),
    }
    if there.origins:
        rows["processor"] = _makers(there)
    if there.flaws is not None:
        rows["verified"] = (
            f"damaged or missing files: {len(there.flaws)}"
            if there.flaws
            else "all files are as they were written"
        )
    if file:
        rows["file"] = f"{file} asks for {'another sweep:' if lines else 'this very sweep'}"
    for label, text in rows.items():
        say(f"{label:<9} {text}")
    for line in lines:
        say(f"  {line}")


def _versions(versions: dict[str, str]) -> str:
    return ", ".join(f"{name} {version}" for name, version in versions.items())


def _makers(there: "Held") -> str:
    """On what kinds of processor, and if that is of several kinds, by which versions."""
    from ...sweeps.origin import named

    kinds = [named(one["processor"]) for one in there.origins]
    if len(kinds) == 1:
        return kinds[0]
    return "; ".join(
        f"{kind}: {one['chunks']} chunks ({_versions(one['versions'])})"
        for one, kind in zip(there.origins, kinds, strict=True)
    )


def _differences(store: Path, file: Path) -> list[str]:
    """In what a file's sweep differs from a store's, a line each."""
    from ...sweeps.calls import call_of
    from ...sweeps.inputs import differences, inputs_of
    from ...sweeps.store import read
    from .job import scenario_of

    asked = scenario_of(file)
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
        from ...sweeps.status import held

        there = held(store)
    except Exception:  # of any kind, if it was the import of a module that was interrupted
        return f"what was done is stored in {store}; the same command resumes"
    return f"{there.done} of {there.cases} cases are stored in {store}; the same command resumes"


def _size(size: int) -> str:
    """Bytes as kB, MB or GB."""
    power = min(max(len(str(size)) - 1, 0) // 3, 3)
    return f"{size / 1000**power:.3g} {['B', 'kB', 'MB', 'GB'][power]}"
