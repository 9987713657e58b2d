"""Published values of a, b and Dc, from materials.toml, as tables and a list of their sources."""

import tomllib
from pathlib import Path

from ratestate.model.quantities import readable
from ratestate.model.units import to_si
from ratestate.plot import label

FILE = Path(__file__).with_suffix(".toml")
#: where an entry was read -> its mark in the table
CHECKED = {"text": "", "abstract": "", "code": "", "not": "\\*"}
PARAMETERS = ("a", "b", "Dc")


def read(path=FILE):
    """Entries, a and b as numbers and Dc in metres or pairs of them, and sources by their keys.

    ParameterError for a value out of range or of a wrong unit; AssertionError for an entry without
    one of the other keys, or a source that is missing or not used.
    """
    data = tomllib.loads(path.read_text("utf-8"))
    for entry in data["entry"]:
        wanted = {"material", "conditions", "found", "source", "checked"}
        assert entry.keys() - set(PARAMETERS) == wanted, entry
        assert entry["checked"] in CHECKED, entry
        for symbol in entry.keys() & set(PARAMETERS):
            values = entry[symbol] if isinstance(entry[symbol], list) else [entry[symbol]]
            entry[symbol] = [to_si(symbol, value) for value in values]
            assert len(values) <= 2, entry
            assert entry[symbol] == sorted(entry[symbol]), entry
    used = {entry["source"] for entry in data["entry"]}
    assert used == data["source"].keys(), used ^ data["source"].keys()
    return data["entry"], data["source"]


def values():
    """The entries with a value as a table; a star marks a source that was not checked."""
    return _table(PARAMETERS, lambda entry: entry.keys() & set(PARAMETERS))


def findings():
    """The entries without values as a table."""
    return _table((), lambda entry: not entry.keys() & set(PARAMETERS))


def _table(symbols, belongs):
    entries, sources = read()
    head = ["", *(label(s) for s in symbols), "what was found", "source"]
    rows = [
        [
            f"**{entry['material']}**: {entry['conditions']}",
            *(_values(entry, symbol) for symbol in symbols),
            entry["found"],
            _link(sources[entry["source"]]) + CHECKED[entry["checked"]],
        ]
        for entry in filter(belongs, entries)
    ]
    return "\n".join(f"| {' | '.join(row)} |" for row in [head, ["---"] * len(head), *rows])


def sources():
    """The sources as a list, in the order of the alphabet, with links."""
    _, found = read()
    lines = [f"- {s['text']}, [doi:{s['doi']}]({_address(s)})." for s in found.values()]
    return "\n".join(sorted(lines))


def _values(entry, symbol):
    texts = (readable(symbol, x).replace("um", "µm") for x in entry.get(symbol, []))
    return " to ".join(text.replace(" ", "\N{NO-BREAK SPACE}") for text in texts)


def _link(source):
    """Authors and year, where the text begins with them, as a link to the DOI."""
    return f"[{source['text'].partition(')')[0]})]({_address(source)})"


def _address(source):
    return f"https://doi.org/{source['doi']}".replace("(", "%28").replace(")", "%29")
