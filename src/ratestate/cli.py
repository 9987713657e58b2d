"""The command line: ``ratestate figures``, ``ratestate atlas`` and ``ratestate --version``.

Nothing heavy is imported before a command needs it, so help and version come at once.
"""

import contextlib
import enum
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import typer

from .errors import RateStateError

FAILED, INTERRUPTED = 2, 130
#: What ``figures`` can draw: the paper's six, and others -> what they show.
OTHERS = {
    "scheme": "the scheme's error",
    "branches": "branches of limit cycles",
    "basins": "basins of steady sliding",
}
FIGURES = ["1", "2", "3", "4", "5", "6", *OTHERS]
WIDTH = 140  # of the claims table where no terminal says how wide it is

main = typer.Typer(
    name="ratestate",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,  # a traceback that can be copied into a report
    context_settings={"help_option_names": ["-h", "--help"]},
)


class Law(enum.StrEnum):
    """Evolution law."""

    slip = "slip"
    aging = "aging"


def _version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        typer.echo(version("ratestate"))
        raise typer.Exit


@main.callback()
def _ratestate(
    version: Annotated[
        bool,
        typer.Option("--version", callback=_version, is_eager=True, help="Print the version."),
    ] = False,
) -> None:
    """Dynamics of a slider on a spring under rate-and-state friction.

    Example: ratestate figures 2 3 --law slip --out figures
    """


@contextlib.contextmanager
def _ending_well() -> Iterator[None]:
    """End what can be foreseen with one message on stderr and an exit code."""
    try:
        yield
    except RateStateError as error:
        typer.echo(f"error: {error}", err=True)
        raise typer.Exit(FAILED) from error
    except OSError as error:
        typer.echo(f"error: cannot write: {error}", err=True)
        raise typer.Exit(FAILED) from error
    except KeyboardInterrupt as interrupt:
        typer.echo("interrupted; files already listed are whole", err=True)
        raise typer.Exit(INTERRUPTED) from interrupt


def _writable(out: Path) -> None:
    """Make the folder, and see whether it takes files: rather now than after minutes of work."""
    out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryFile(dir=out):
        pass


def _wanted(names: list[str]) -> list[str]:
    """The figures asked for, in the order of the paper."""
    if unknown := [name for name in names if name not in [*FIGURES, "all"]]:
        raise typer.BadParameter(
            f"{unknown[0]!r} is no figure; choose among {', '.join(FIGURES)} and all"
        )
    return [name for name in FIGURES if "all" in names or name in names]


@main.command()
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
    with _ending_well():
        _writable(out)
        for name in wanted:
            _draw(name, law.value, out)
        if "all" in names:
            _check_claims(law.value, out)


@main.command()
def atlas(
    b_over_a: Annotated[float, typer.Option(help="b/a, above 1.")] = 2.0,
    law: Annotated[
        Law | None, typer.Option(help="Evolution law.", show_default="both, one after the other")
    ] = None,
    n: Annotated[int, typer.Option(help="Points along either axis.", min=2)] = 200,
    out: Annotated[Path, typer.Option(help="Folder for the files; made if missing.")] = Path(
        "figures"
    ),
) -> None:
    """Map what any spring-slider does, over its stiffness and its speed.

    For each law, atlas_LAW.png and .pdf (the map) and .nc (its numbers).  A machine, rig or fault
    with this b/a is a point on it, at K/K_c_qs and eta.

    Example: ratestate atlas --b-over-a 1.6 --law aging --out figures
    """
    with _ending_well():
        _writable(out)
        for each in [law] if law else Law:
            _chart(b_over_a, each.value, n, out)


def _chart(b_over_a: float, law: str, n: int, out: Path) -> None:
    """Make the atlas of one law and list its files."""
    from .paper.atlas import make

    with _reported(f"atlas, {law} law, b/a = {b_over_a:g}") as files:
        files += make(law, out, b_over_a=b_over_a, n=n)


def _draw(name: str, law: str, out: Path) -> None:
    """Make one figure and list its files."""
    from .paper.figures import make

    with _reported(f"{OTHERS.get(name, f'Fig. {name}')}, {law} law") as files:
        files += make(name if name in OTHERS else int(name), law, out)


def _check_claims(law: str, out: Path) -> None:
    """Check the claims, write them, and print the table on stdout."""
    from rich.console import Console

    from .paper import claims_table
    from .paper.claims import claims

    with _reported(f"claims, {law} law") as files:
        rows = claims(law)
        files += claims_table.write(rows, law, out)
    console = Console()
    if not console.is_terminal:
        console = Console(width=WIDTH)
    console.print(claims_table.terminal(rows, law))


@contextlib.contextmanager
def _reported(what: str) -> Iterator[list[Path]]:
    """Say on stderr what is being made; afterwards how long it took and which files it left."""
    from rich.console import Console

    console = Console(stderr=True, highlight=False)
    console.print(f"[bold]{what}[/bold] ...")
    begin, files = time.monotonic(), list[Path]()
    yield files
    console.print(f"  {time.monotonic() - begin:.1f} s", style="dim")
    for path in files:
        typer.echo(f"  {path}", err=True)
