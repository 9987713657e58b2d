"""Published values of a, b and Dc, from materials.toml, as tables and a list of their sources."""

import tomllib
from pathlib import Path

from ratestate.model.quantities import readable
from ratestate.model.units import to_si
from ratestate.plot import label

FILE = Path(__file__).with_suffix(".toml")
PARAMETERS = ("a", "b", "Dc")
REQUIRED = {"material", "conditions", "found", "source", "read"}


def read(path=FILE):
    """Entries, a and b as numbers and Dc in metres or pairs of them, and sources by their keys.

    ParameterError for a value out of range or of a wrong unit; AssertionError for an entry without
    one of the other keys, or a source that is missing or not used.
    """
    data = tomllib.loads(path.read_text("utf-8"))
    for entry in data["entry"]:
        assert entry.keys() - {*PARAMETERS, "law", "model"} == REQUIRED, entry
        for symbol in entry.keys() & set(PARAMETERS):
            values = entry[symbol] if isinstance(entry[symbol], list) else [entry[symbol]]
            entry[symbol] = [to_si(symbol, value) for value in values]
            assert len(values) <= 2, entry
            assert entry[symbol] == sorted(entry[symbol]), entry
    used = {entry["source"] for entry in data["entry"]}
    assert used == data["source"].keys(), used ^ data["source"].keys()
    return data["entry"], data["source"]


def kind(entry):
    """Whether an entry has measured values, values of a model, or none."""
    if not entry.keys() & set(PARAMETERS):
        return "finding"
    return "model" if entry.get("model") else "measured"


def values():
    """The measured values as a table."""
    return _table("measured", PARAMETERS, "law")


def models():
    """The values that were chosen for computations as a table."""
    return _table("model", PARAMETERS)


def findings():
    """The entries without values as a table."""
    return _table("finding")


def _table(wanted, symbols=(), *more):
    entries, sources = read()
    head = ["", *more, *(label(s) for s in symbols), "what was found", "source"]
    rows = [
        [
            ": ".join(filter(None, (f"**{entry['material']}**", entry["conditions"]))),
            *(entry.get(key, "") for key in more),
            *(_values(entry, symbol) for symbol in symbols),
            entry["found"],
            f"{_link(sources[entry['source']])}, {entry['read']}",
        ]
        for entry in entries
        if kind(entry) == wanted
    ]
    return "\n".join(f"| {' | '.join(row)} |" for row in [head, ["---"] * len(head), *rows])


def sources():
    """The sources as a list, in the order of the alphabet, with links."""
    _, found = read()
    lines = [f"- {s['text']}, [{_shown(s)}]({_address(s)})." for s in found.values()]
    return "\n".join(sorted(lines, key=str.lower))


def _values(entry, symbol):
    texts = (readable(symbol, x).replace("um", "µm") for x in entry.get(symbol, []))
    return " to ".join(text.replace(" ", "\N{NO-BREAK SPACE}") for text in texts)


def _link(source):
    """Authors and year, or the name of a code, with which the text begins, as a link."""
    name = source["text"].partition(")")[0] + ")"
    return f"[{name if 'doi' in source else name.partition(' (')[0]}]({_address(source)})"


def _shown(source):
    return f"doi:{source['doi']}" if "doi" in source else source["url"].removeprefix("https://")


def _address(source):
    address = f"https://doi.org/{source['doi']}" if "doi" in source else source["url"]
    return address.replace("(", "%28").replace(")", "%29")
