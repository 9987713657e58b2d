"""``ratestate figures`` and ``atlas``: the paper's figures and claims, and the map of regimes."""

from pathlib import Path

import typer

from ...friction.laws import friction_law, own_parameters
from ...paper.figures import FIGURES, LAWS
from .options import laws_of, own_values
from .output import print_json, print_rich, reporting_files

FOLDER = Path("figures")


def figures(
    which: list[str] | None = None,
    *,
    law: str | None = None,
    law_file: Path | None = None,
    out: Path = FOLDER,
    no_titles: bool = False,
    json: bool = False,
) -> None:
    """Draw the figures of Im, Marone & Elsworth (2019) and check its claims.

    Figures are written as .png, .pdf and .nc (their numbers), and claims as .md and .json.

    Example: ratestate figures 2 4 --out figures
    """
    (law,) = laws_of([law] if law else [], law_file, LAWS[:1])
    if needed := friction_law(law).parameters:
        raise typer.BadParameter(
            f"{law!r} needs {', '.join(needed)}, which the paper does not give", param_hint="--law"
        )
    names = which or ["all"]
    if unknown := [name for name in names if name not in [*FIGURES, "all"]]:
        raise typer.BadParameter(
            f"{unknown[0]!r} is not a figure. Choose among {', '.join(FIGURES)} and all."
        )
    from ...files.place import make_writable

    make_writable(out)
    from ...paper import claims_table
    from ...paper.figures import make

    files, rows = list[Path](), None
    for key, figure in FIGURES.items():
        if "all" in names or key in names:
            with reporting_files(f"{figure.name}, {law} law") as written:
                written += make(key, law, out, title=not no_titles)
            files += written
    if "all" in names:
        with reporting_files(f"claims, {law} law") as written:
            rows = claims_table.claims(law)
            written += claims_table.write(rows, law, out)
        files += written
    if json:
        checked = {} if rows is None else claims_table.record(rows, law)
        print_json({"files": [str(path) for path in files], **checked})
    elif rows is not None:
        print_rich(claims_table.terminal(rows, law))


def atlas(
    *,
    b_over_a: float = 2.0,
    law: str | None = None,
    law_file: Path | None = None,
    of_law: list[str] | None = None,
    n: int = 200,
    out: Path = FOLDER,
    json: bool = False,
) -> None:
    """Map the regimes of any spring-slider against its stiffness and speed.

    For each law atlas_LAW.png and .pdf (the map) and .nc (its numbers) are written.  A machine, rig
    or fault with this b/a is a point on the map, at K/K_c_qs and eta.  If the law has a
    characteristic speed, the point is at K and V_lp.

    Example: ratestate atlas --b-over-a 1.6 --out figures
    """
    laws = laws_of([law] if law else [], law_file, LAWS)
    symbols = own_parameters(map(friction_law, laws))
    try:
        values = {symbol: float(x) for symbol, x in own_values(of_law, [*symbols, "M"]).items()}
    except ValueError as error:
        raise typer.BadParameter(f"{error}: give plain numbers", param_hint="--set") from None
    from ...files.place import make_writable

    make_writable(out)
    from ...paper.atlas_figure import make

    files = list[Path]()
    for name in laws:
        with reporting_files(f"atlas, {name} law, b/a = {b_over_a:g}") as written:
            written += make(name, out, b_over_a=b_over_a, n=n, **values)
        files += written
    if json:
        print_json({"files": [str(path) for path in files]})
