"""``ratestate figures``: the paper's figures and claims."""

from pathlib import Path
from typing import Annotated

import typer

from .shared import Law, ending_well, reported, writable

#: What ``figures`` can draw: the paper's six, and others -> what they show.
OTHERS = {
    "scheme": "the scheme's error",
    "branches": "branches of limit cycles",
    "basins": "basins of steady sliding",
}
FIGURES = ["1", "2", "3", "4", "5", "6", *OTHERS]
WIDTH = 140  # of the claims table where no terminal says how wide it is


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
) -> None:
    """Draw the figures of Im, Marone & Elsworth (2019) and check its claims.

    Each figure is written as .png, .pdf and .nc (its numbers), the claims as .md and .json.

    Example: ratestate figures all --law aging --out figures
    """
    names = which or ["all"]
    wanted = _wanted(names)
    with ending_well():
        writable(out)
        for name in wanted:
            _draw(name, law.value, out)
        if "all" in names:
            _check_claims(law.value, out)


def _wanted(names: list[str]) -> list[str]:
    """The figures asked for, in the order of the paper."""
    if unknown := [name for name in names if name not in [*FIGURES, "all"]]:
        raise typer.BadParameter(
            f"{unknown[0]!r} is no figure; choose among {', '.join(FIGURES)} and all"
        )
    return [name for name in FIGURES if "all" in names or name in names]


def _draw(name: str, law: str, out: Path) -> None:
    """Make one figure and list its files."""
    from ..paper.figures import make

    with reported(f"{OTHERS.get(name, f'Fig. {name}')}, {law} law") as files:
        files += make(name if name in OTHERS else int(name), law, out)


def _check_claims(law: str, out: Path) -> None:
    """Check the claims, write them, and print the table on stdout."""
    from rich.console import Console

    from ..paper import claims_table
    from ..paper.claims import claims

    with reported(f"claims, {law} law") as files:
        rows = claims(law)
        files += claims_table.write(rows, law, out)
    console = Console()
    if not console.is_terminal:
        console = Console(width=WIDTH)
    console.print(claims_table.terminal(rows, law))
