"""Sentences kept in TOML files."""

import pytest

from ratestate.model.names import Sentences


@pytest.fixture
def sentences(tmp_path):
    path = tmp_path / "motion.toml"
    path.write_text(
        'steady = {plain = "At {V:as V}.", rounded = "At {case.V:as V_lp 2}, {x:.1f}, {name}."}\n',
        "utf-8",
    )
    return Sentences(path)


def test_values_are_shown_as_quantities(sentences):
    assert sentences("steady.plain", V=0.0032) == "At 3.2 mm/s."


def test_attributes_digits_and_formats_of_python(sentences):
    case = type("Case", (), {"V": 1.2345e-6})
    text = sentences("steady.rounded", case=case, x=2.25, name="sigma")
    assert text == "At 1.2 um/s, 2.2, sigma."


@pytest.mark.parametrize(("name", "missing"), [("steady.fast", "fast"), ("steady.plain", "V")])
def test_missing_names_and_values_raise_key_errors(sentences, name, missing):
    with pytest.raises(KeyError, match=missing):
        sentences(name)
