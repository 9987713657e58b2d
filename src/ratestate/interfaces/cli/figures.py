"""``ratestate figures``: the paper's figures and claims."""

from pathlib import Path
from typing import Annotated, Any

import typer

from .folders import make_writable, reporting_files
from .options import Law
from .printing import print_line, print_rich

#: What ``figures`` can draw: the paper's six, and others -> what they show.
OTHERS = {
    "scheme": "the scheme's error",
    "branches": "branches of limit cycles",
    "basins": "basins of steady sliding",
}
FIGURES = ["1", "2", "3", "4", "5", "6", *OTHERS]


def figures(
    which: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="1..6|scheme|branches|basins|all",
            help="Figures of the paper; scheme: the error of its method against the time step; "
            "branches: stable and unstable limit cycles; basins: what stable sliding survives; "
            "all (the default): all of these and the claims table.",
            show_default=False,
        ),
    ] = None,
    law: Annotated[Law, typer.Option(help="Evolution law.")] = Law.slip,
    out: Annotated[Path, typer.Option(help="Folder for the files; made if missing.")] = Path(
        "figures"
    ),
    json: Annotated[
        bool, typer.Option("--json", help="Print one JSON document: the files and the claims.")
    ] = False,
) -> None:
    """Draw the figures of Im, Marone & Elsworth (2019) and check its claims.

    Each figure is written as .png, .pdf and .nc (its numbers), the claims as .md and .json.

    Example: ratestate figures 2 4 --law aging --out figures
    """
    names = which or ["all"]
    wanted = _wanted(names)
    make_writable(out)
    files = [path for name in wanted for path in _draw(name, law.value, out)]
    rows = None
    if "all" in names:
        with reporting_files(f"claims, {law.value} law") as more:
            rows, paths = _checked_claims(law.value, out)
            more += paths
        files += more
    if json:
        _say_json(files, rows, law.value)
    elif rows is not None:
        from ...paper import claims_table

        print_rich(claims_table.terminal(rows, law.value))


def _wanted(names: list[str]) -> list[str]:
    """The requested figures, in the order of the paper."""
    if unknown := [name for name in names if name not in [*FIGURES, "all"]]:
        raise typer.BadParameter(
            f"{unknown[0]!r} is no figure; choose among {', '.join(FIGURES)} and all"
        )
    return [name for name in FIGURES if "all" in names or name in names]


def _draw(name: str, law: str, out: Path) -> list[Path]:
    """Make one figure and list its files."""
    from ...paper.figures import make

    with reporting_files(f"{OTHERS.get(name, f'Fig. {name}')}, {law} law") as files:
        files += make(name if name in OTHERS else int(name), law, out)
    return files


def _checked_claims(law: str, out: Path) -> tuple[list[Any], list[Path]]:
    """Check the claims and write them; the rows, and the files."""
    from ...paper import claims_table
    from ...paper.claims import claims

    rows = claims(law)
    return rows, claims_table.write(rows, law, out)


def _say_json(files: list[Path], rows: list[Any] | None, law: str) -> None:
    """Print which files were written, and the claims where they were checked."""
    from ...paper import claims_table
    from .document import strict_json

    claims = {} if rows is None else claims_table.record(rows, law)
    print_line(strict_json({"files": [str(path) for path in files], **claims}))
