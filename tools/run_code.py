"""Whether the code in pages of text works: python tools/run_code.py README.md docs/*.md

Runs the ```python blocks of each page one after another, in a folder of their own; a ```text block
right after one must be what it prints.  Loads each ```toml block as a scenario file; one without
[slider] takes that of the block before.  Notebooks are left to Sphinx.
"""

import contextlib
import io
import os
import re
import shutil
import sys
import tempfile
import textwrap
import time
import traceback
from pathlib import Path

BLOCK = re.compile(r"^( *)```(\w+)\n(.*?)^\1```$", re.MULTILINE | re.DOTALL)
OUTPUT = re.compile(r"\s*^ *```text\n(.*?)^ *```$", re.MULTILINE | re.DOTALL)
TEMPLATES = Path(__file__).resolve().parent.parent / "src/ratestate/scenario/templates"
SLIDER = re.compile(r"^\[slider\].*?(?=^\[|\Z)", re.MULTILINE | re.DOTALL)


def blocks(page, language):
    """The blocks of a page in one language: line number, text, and the output after it or None."""
    text = page.read_text(encoding="utf-8")
    for found in BLOCK.finditer(text):
        if found[2] == language:
            output = OUTPUT.match(text, found.end())
            line = text.count("\n", 0, found.start()) + 2
            yield line, textwrap.dedent(found[3]), output and textwrap.dedent(output[1])


def is_notebook(page):
    """Whether Sphinx runs the page's code."""
    return "{code-cell}" in page.read_text(encoding="utf-8")


def run_python(page):
    """Run a page's Python; an error names the page and the line."""
    names = {"__name__": page.stem}
    for line, text, output in blocks(page, "python"):
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile("\n" * (line - 1) + text, str(page), "exec"), names)
        if output not in (None, printed.getvalue()):
            raise AssertionError(
                f"{page}, line {line}: shown\n{output}\nbut printed\n{printed.getvalue()}"
            )


def load_toml(page):
    """Load a page's scenarios."""
    from ratestate import scenario

    slider = ""
    for line, text, _ in blocks(page, "toml"):
        own = SLIDER.search(text)
        slider = own[0] if own else slider
        file = Path(f"{page.stem}_line_{line}.toml")
        file.write_text(text if own else f"{slider}\n{text}", encoding="utf-8")
        scenario.load(file)


@contextlib.contextmanager
def elsewhere():
    """A folder with the records that pages name, gone afterwards, and no windows for pictures."""
    os.environ["MPLBACKEND"] = "agg"
    before = Path.cwd()
    with tempfile.TemporaryDirectory() as folder:
        shutil.copy(TEMPLATES / "record.txt", folder)
        shutil.copy(TEMPLATES / "recorded-loading.csv", Path(folder) / "record.csv")
        os.chdir(folder)
        try:
            yield
        finally:
            os.chdir(before)


def main():
    bad = 0
    for page in map(Path.resolve, map(Path, sys.argv[1:])):
        begin = time.monotonic()
        try:
            with elsewhere():
                load_toml(page)
                if not is_notebook(page):
                    run_python(page)
        except Exception:
            bad += 1
            traceback.print_exc()
        else:
            sys.stdout.write(f"{page.name}: {time.monotonic() - begin:.1f} s\n")
    sys.exit(bool(bad))


if __name__ == "__main__":
    main()
