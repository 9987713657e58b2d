"""What the symbols and terms of the page mean: name, unit, and a sentence or two each."""

import tomllib
from pathlib import Path

from ....model.quantities import QUANTITIES

# Of a friction law's own parameters, of which the names say what is to be said.
OWN = "A parameter of this friction law alone."


def meanings(others):
    """Symbol or term -> its name, unit and text; of those of meanings.toml and these others."""
    rows = tomllib.loads(Path(__file__).with_suffix(".toml").read_text("utf-8"))
    return {symbol: _meaning(symbol, rows.get(symbol, OWN)) for symbol in (*rows, *others)}


def _meaning(symbol, row):
    if isinstance(row, dict):
        return row
    quantity = QUANTITIES[symbol]
    return {"name": quantity.long_name, "unit": quantity.unit, "text": row}
