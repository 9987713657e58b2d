"""The symbols of the glossary: name and unit from the package, what they mean from symbols.toml."""

import tomllib
from pathlib import Path

from ratestate.model.quantities import QUANTITIES
from ratestate.plot.labels import LETTERS

TEXTS = Path(__file__).with_suffix(".toml")


def read(path=TEXTS):
    """Heading -> symbol -> text; AssertionError unless each quantity has one text, and no other."""
    groups = tomllib.loads(path.read_text("utf-8"))
    symbols = [symbol for texts in groups.values() for symbol in texts]
    wrong = sorted(QUANTITIES.keys() ^ set(symbols)) + [s for s in symbols if symbols.count(s) > 1]
    assert not wrong, f"{path.name}: missing, unknown or twice: {', '.join(wrong)}"
    return groups


def symbols():
    """A glossary of them for each heading."""
    return "\n\n".join(
        "\n".join([f"### {heading}", "", "```{glossary}", *map(_entry, texts.items()), "```"])
        for heading, texts in read().items()
    )


def _entry(symbol_and_text):
    symbol, text = symbol_and_text
    quantity = QUANTITIES[symbol]
    letter = f" ${LETTERS[symbol]}$" if symbol in LETTERS else ""
    unit = "" if quantity.unit == "1" else f" [{quantity.unit}]"
    return f"{symbol}\n  *{quantity.long_name}*{letter}{unit}. {text}\n"
