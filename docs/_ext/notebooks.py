"""Tutorials as Jupyter notebooks, to be downloaded: what myst-nb has executed, in plain Markdown.

A tutorial's notebook lies beside its page, as ``PAGE.ipynb``; ``_templates/notebook.html`` links
to it.
"""

import json
import re
from pathlib import Path

#: (pattern, replacement): what Jupyter cannot show, as Markdown that it can
PLAIN = [
    (r"^(:{3,}.*|:[\w-]+:.*)\n", ""),  # fences and options of directives
    (r"\{\w+\}`~(?:\w+\.)*(\w+)`", r"`\1`"),  # {exc}`~ratestate.NotConverged`
    (r"\{\w+\}`([^`<]+) <[^`]*>`", r"`\1`"),  # {meth}`Loading.series <ratestate.Loading.series>`
    (r"\{\w+\}`([^`]+)`", r"`\1`"),  # {func}`ratestate.fit`
    (r"\[([^\]]+)\]\((?!https?:)[^)]+\)", r"\1"),  # links to other pages
]


def plain(text):
    """MyST without roles, fences of directives and links to other pages, which Jupyter lacks."""
    for pattern, replacement in PLAIN:
        text = re.sub(pattern, replacement, text, flags=re.MULTILINE)
    return text


def add_notebook(app, page, template, context, doctree):
    """Write a tutorial's notebook into the site, and give the template its name."""
    executed = Path(app.outdir).parent / "jupyter_execute" / f"{page}.ipynb"
    if not page.startswith("tutorials/") or not executed.is_file():
        return
    notebook = json.loads(executed.read_text("utf-8"))
    notebook["metadata"].pop("file_format", None)
    for cell in notebook["cells"]:
        cell["metadata"] = {}
        if cell["cell_type"] == "markdown":
            cell["source"] = plain("".join(cell["source"]))
    target = Path(app.outdir) / f"{page}.ipynb"
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_text(json.dumps(notebook, indent=1), "utf-8")
    context["notebook"] = target.name


def setup(app):
    app.connect("html-page-context", add_notebook)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
