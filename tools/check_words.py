"""Ends with an error where a word stands in the code that the field has a better one for.

Names of the code are looked at, and their parts between underscores; CONTRIBUTING.md says why.
"""

import io
import sys
import tokenize
from pathlib import Path

SOURCES = Path(__file__).resolve().parents[1] / "src/ratestate"
#: word -> what to say instead
BETTER = {
    "asked": "request, settings",
    "attend": "handle_events",
    "birth": "Hopf point",
    "crumb": "remainder",
    "doubts": "diagnostics, warnings",
    "judge": "step control",
    "noun": "class",
    "said": "message, report",
    "spoken": "message, report",
    "told": "message, report",
}


def misnomers(path):
    """(line, name, word) of each name in a file that has one of the words."""
    for token in tokenize.generate_tokens(io.StringIO(path.read_text("utf-8")).readline):
        if token.type == tokenize.NAME:
            for word in BETTER.keys() & set(token.string.lower().split("_")):
                yield token.start[0], token.string, word


def main():
    lines = [
        f"{path.relative_to(SOURCES)}:{line}: {name}: instead of {word!r}: {BETTER[word]}"
        for path in sorted(SOURCES.rglob("*.py"))
        for line, name, word in misnomers(path)
    ]
    if lines:
        sys.exit("\n".join([*lines, f"error: {len(lines)} names have words of our own"]))


if __name__ == "__main__":
    main()
