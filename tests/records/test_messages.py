"""No message is kept that nothing says."""

import pytest

from ratestate.records import messages


@pytest.mark.parametrize(
    "package", ["healing", "kit", "load_point", "machine", "raw_record", "reading", "stick_slip"]
)
def test_every_sentence_is_used(package):
    sentences = getattr(messages, package)
    folder = sentences.path.parent
    source = "".join(path.read_text("utf-8") for path in folder.glob("*.py"))
    for table, texts in sentences.tables.items():
        for name in texts:
            assert f'{table}.{name}"' in source or f'"{name}"' in source, (table, name)
