"""A record read by a page that asks back: what there is to choose from, whatever comes of it."""

from typing import Any, NamedTuple

from ...errors import ParameterError
from .columns import choose_columns
from .isolated import read_isolated
from .open_table import open_table
from .record import record_of


class Attempt(NamedTuple):
    """What a file has, and the record in it or why there is none."""

    columns: list[tuple[str, str]]  # title and unit of each, "" for none; [] if it has no table
    chosen: dict[str, int]  # symbol -> number of its column, from 1; {} if that is not clear
    record: Any  # the Dataset of `read_lab`, or None
    error: ParameterError | None  # why there is no record


def attempt(file, choices, seconds, stop):
    """The `Attempt` at a `MemoryFile`, in a process of its own, of which no file is written.

    choices : dict, keyword arguments of `read_lab`
    seconds, stop : as of `read_isolated`
    """
    try:
        return read_isolated(_attempt, file, "a record", choices, seconds=seconds, stop=stop)
    except ParameterError as error:
        return Attempt([], {}, None, error)


def _attempt(file, choices):
    """The same in this process."""
    try:
        table = open_table(file)
    except ParameterError as error:
        return Attempt([], {}, None, error)
    columns, chosen = [(column.title, column.unit) for column in table.columns], {}
    try:
        chosen = {s: i + 1 for s, i in choose_columns(table, choices.get("columns")).items()}
        record, _ = record_of([table], [file.name], **choices)
    except ParameterError as error:
        return Attempt(columns, chosen, None, error)
    return Attempt(columns, chosen, record, None)
