"""``ratestate atlas``: the map of what any spring-slider does."""

from pathlib import Path
from typing import Annotated

import typer

from .folders import make_writable, reporting_files
from .options import Law
from .printing import print_line


def atlas(
    b_over_a: Annotated[float, typer.Option(help="b/a, above 1.")] = 2.0,
    law: Annotated[
        Law | None, typer.Option(help="Evolution law.", show_default="both, one after the other")
    ] = None,
    n: Annotated[int, typer.Option(help="Points along either axis.", min=2)] = 200,
    out: Annotated[Path, typer.Option(help="Folder for the files; made if missing.")] = Path(
        "figures"
    ),
    json: Annotated[
        bool, typer.Option("--json", help="Print one JSON document: the files.")
    ] = False,
) -> None:
    """Map the regimes of any spring-slider over its stiffness and speed.

    Writes, for each law, atlas_LAW.png and .pdf (the map) and .nc (its numbers).  A machine, rig or
    fault with this b/a is a point on the map, at K/K_c_qs and eta.

    Example: ratestate atlas --b-over-a 1.6 --law aging --out figures
    """
    make_writable(out)
    made = [
        path for each in ([law] if law else Law) for path in _chart(b_over_a, each.value, n, out)
    ]
    if json:
        from .document import strict_json

        print_line(strict_json({"files": [str(path) for path in made]}))


def _chart(b_over_a: float, law: str, n: int, out: Path) -> list[Path]:
    """Make the atlas of one law and list its files."""
    from ...paper.atlas import make

    with reporting_files(f"atlas, {law} law, b/a = {b_over_a:g}") as files:
        files += make(law, out, b_over_a=b_over_a, n=n)
    return files
