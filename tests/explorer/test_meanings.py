"""What the page says of its symbols."""

import re
import tomllib
from pathlib import Path

import pytest

from ratestate.model.quantities import QUANTITIES
from ratestate_explorer import app, entries, menus

TEXTS = Path(menus.__file__).with_name("meanings.toml")
FIELDS = menus.fields(entries.state_of(menus.presets()[0]["entries"]).values)
FOUND = menus.meanings(field["symbol"] for field in FIELDS)


def test_every_field_has_a_meaning():
    for field in FIELDS:
        meaning = FOUND[field["symbol"]]
        assert meaning["name"] == field["name"]
        assert meaning["unit"] == field["unit"]
    of_laws = {symbol for symbol, row in FOUND.items() if row["text"] == menus.OWN}
    assert of_laws == {"V_w", "mu_w", "V_cut", "c", "b2", "Dc2"}


def test_every_symbol_of_the_pages_sentences_has_one():
    words = (app.STATIC / "js/common/words.js").read_text()
    table = words.partition("const SYMBOLS = {")[2].partition("};")[0]
    symbols = re.findall(r'^  "?([\w/ -]+?)"?:', table, re.M)
    assert len(symbols) >= 21
    assert set(symbols) <= FOUND.keys()


def test_names_and_units_are_the_packages_where_it_has_them():
    rows = tomllib.loads(TEXTS.read_text())
    own = {symbol for symbol, row in rows.items() if isinstance(row, dict)}
    assert own & QUANTITIES.keys() == set()


@pytest.mark.parametrize("symbol", FOUND)
def test_a_meaning_has_one_or_two_plain_sentences(symbol):
    text = FOUND[symbol]["text"]
    assert 1 <= len(re.findall(r"[.](?= |$)", text)) <= 3
    assert 30 <= len(text) <= 200
    assert not set(text) & set("${}`\\")
