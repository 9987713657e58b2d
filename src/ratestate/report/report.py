"""`Report`, and `summary`, which makes it of any result."""

import io
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import xarray
from rich.console import Console, Group

from ..dynamics.recipe import attribute_text
from ..errors import ParameterError

#: width of a report as plain text [characters]
WIDTH = 110


class Report:
    """Tables and sentences on a result.

    ``print`` writes it as plain text, a notebook shows it, and rich prints it in the width and with
    the colours of a terminal.

    Parameters
    ----------
    blocks : iterable
        rich's ``Text`` and ``Table``, or others that rich prints.
    """

    def __init__(self, blocks: Iterable[Any]) -> None:
        self.blocks = list(blocks)

    def __rich__(self) -> Group:
        return Group(*self.blocks)

    def __str__(self) -> str:
        return "\n".join(line.rstrip() for line in self._printed().export_text().splitlines())

    def _repr_html_(self) -> str:
        return self._printed().export_html(code_format="<pre>{code}</pre>", inline_styles=True)

    def _printed(self) -> Console:
        console = Console(
            file=io.StringIO(), record=True, width=WIDTH, highlight=False, emoji=False
        )
        console.print(self)
        return console

    def __iter__(self) -> Iterator[Any]:
        return iter(self.blocks)


def summary(result: xarray.Dataset, units: Mapping[str, str] | None = None) -> Report:
    """Describe the result of any function of ratestate, to print.

    Parameters
    ----------
    result : xarray.Dataset
        Result of `simulate`, `stability`, `limit_cycle`, `continue_cycle`, `frequency_response`,
        `sweep`, `fit`, `events`, `healing` or `machine_stiffness`, with its attributes.
    units : dict, optional
        Symbol -> unit of its values in tables, such as ``{"V_lp": "mm/s"}``, for results of the
        first six.  By default each value has a unit that fits.

    Returns
    -------
    Report
        Its `str` is plain text.

    Raises
    ------
    ParameterError
        If it is not such a result, or lacks its attributes.

    Examples
    --------
    >>> import ratestate as rs
    >>> slider = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", K="1 GPa/m")
    >>> print(str(rs.summary(rs.stability(slider, "1 um/s"))).splitlines()[0])
    Steady sliding at 1 um/s is stable
    """
    if not isinstance(result, xarray.Dataset):
        raise ParameterError(
            f"a {type(result).__name__} is not a result", "Give a Dataset from ratestate."
        )
    name = attribute_text(result, "title").removeprefix("ratestate ")
    return Report(_blocks(name, result, units or {}))


def _blocks(name: str, result: xarray.Dataset, units: Mapping[str, str]) -> list[Any]:
    """Return the blocks of the report on a result of the function with this name."""
    if name == "fit":
        from .fit import fit

        return fit(result)
    from . import evaluations, single, sweep

    if name in evaluations.TABLES:
        return evaluations.TABLES[name](result)
    if name not in single.TABLES:
        raise ParameterError(
            f"the title of the Dataset, {name!r}, is not that of a result",
            "Give a Dataset as ratestate returns it.",
        )
    tables = sweep.cases if "message" in result else single.TABLES[name]
    return tables(result, units)
