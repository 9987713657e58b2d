"""The symbols of the glossary: name and unit from the package, what they mean from symbols.toml."""

import tomllib
from pathlib import Path

from ratestate.friction.laws import LAWS
from ratestate.model.quantities import QUANTITIES
from ratestate.plot.labels import LETTERS

TEXTS = Path(__file__).with_suffix(".toml")
#: the heading of the symbols that some friction laws alone have
OF_LAWS = "Under some friction laws"


def read(path=TEXTS):
    """Heading -> symbol -> text; AssertionError unless each quantity has one text, and no other."""
    groups = tomllib.loads(path.read_text("utf-8"))
    groups[OF_LAWS] = _of_laws({symbol for texts in groups.values() for symbol in texts})
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


def _of_laws(told):
    """Symbol -> text, of parameters and states of friction laws, but for those told of."""
    owners = {}
    for name, law in LAWS.items():
        owned = dict.fromkeys(law.parameters, "A parameter") | dict.fromkeys(law.states, "A state")
        owned |= {f"{state}_start": "Initial value of a state" for state in law.states}
        for symbol, kind in owned.items():
            owners.setdefault(symbol, (kind, []))[1].append(f"`{name}`")
    return {
        symbol: f"{kind} of {' and '.join(names)}."
        for symbol, (kind, names) in owners.items()
        if symbol not in told
    }


def _entry(symbol_and_text):
    symbol, text = symbol_and_text
    quantity = QUANTITIES[symbol]
    letter = f" ${LETTERS[symbol]}$" if symbol in LETTERS else ""
    unit = "" if quantity.unit == "1" else f" [{quantity.unit}]"
    return f"{symbol}\n  *{quantity.long_name}*{letter}{unit}. {text}".rstrip() + "\n"
