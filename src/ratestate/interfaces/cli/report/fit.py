"""Tables about a fit."""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import xarray
    from rich.table import Table


def fit(result: "xarray.Dataset") -> list[Any]:
    """The estimates under each law with 95 % intervals, the noise, remarks and warnings."""
    from rich.text import Text

    from ....records.fitting.by_law import results_by_law
    from ....records.fitting.text import heading, labelled_warnings, remarks

    laws = results_by_law(result)
    first, *more = heading(result, laws)
    shown = [Text(first, style="bold"), *map(Text, more), _Widest(laws), Text("")]
    shown += map(Text, remarks(result, laws))
    return [*shown, *(Text(f"warning: {text}", style="bold") for text in labelled_warnings(laws))]


class _Widest:
    """The estimates in the fullest layout that the terminal is wide enough for."""

    def __init__(self, laws: "dict[str, xarray.Dataset]") -> None:
        self.laws = laws

    def __rich_console__(self, console: Any, options: Any) -> Any:
        alone = [{law: part} for law, part in self.laws.items()]
        endless = options.update(width=10_000)
        for together, meaning in ((True, True), (True, False), (False, True), (False, False)):
            parts = [self.laws] if together else alone
            tables = [_table(laws, meaning) for laws in parts]
            if (
                max(console.measure(one, options=endless).maximum for one in tables)
                <= options.max_width
            ):
                break
        yield from tables


def _table(laws: "dict[str, xarray.Dataset]", meaning: bool) -> "Table":
    """The estimates under these laws, with or without what each quantity is."""
    from rich import box
    from rich.table import Table
    from rich.text import Text

    from ....records.fitting.table import estimate_rows

    made = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False)
    made.add_column("", no_wrap=True)
    for law in laws:
        made.add_column(f"{law} law", justify="right", no_wrap=True)
        made.add_column("95 % interval", justify="right", no_wrap=True)
    if meaning:
        made.add_column("", no_wrap=True)
    for row in estimate_rows(laws):
        cells = [text for e in row.estimates for text in (e.value, (e.intervals or ("",))[-1])]
        made.add_row(*map(Text, (row.label, *cells, *([row.meaning] if meaning else []))))
    return made
