"""No message is kept that nothing says."""

import pytest

from ratestate.records import messages

PACKAGES = ("fitting", "healing", "kit", "load_point", "machine", "raw_record", "reading")


@pytest.mark.parametrize("package", [*PACKAGES, "stick_slip"])
def test_every_sentence_is_used(package):
    sentences = getattr(messages, package)
    source = "".join(path.read_text("utf-8") for path in sentences.path.parent.rglob("*.py"))
    for table, texts in sentences.tables.items():
        for name in texts:
            # by its name, or by one that is put together
            assert f'"{table}.{name}"' in source or f'f"{table}.{{' in source, (table, name)
