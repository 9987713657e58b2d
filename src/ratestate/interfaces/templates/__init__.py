"""Scenario files to start from, with the data that they need beside them.

`ratestate init` writes them.  A file begins with a comment: its first line says what the file is,
and lines that begin with ``ratestate`` are commands to try, each with what it shows.
"""

import re
from importlib import resources

#: what there is, in the order of `ratestate init --list`
TEMPLATES = (
    *("lab", "brake", "fault", "record"),
    *("slide-hold-slide", "stiff-rig", "sinusoid", "recorded-loading", "brake-map"),
    *("fig2", "fig3", "fig4", "fig6", "million"),
)


def template(name: str) -> str:
    """The text of a commented scenario file to start from.

    Parameters
    ----------
    name : str
        What the file describes, such as "lab", "brake" or "fault": one of those that
        ``ratestate init --list`` lists.

    Returns
    -------
    str
        TOML.

    Raises
    ------
    ParameterError
        Any other name; the message lists them, and the one that was perhaps meant.
    """
    if name not in TEMPLATES:
        from ..scenario.problems import choice  # which takes a second to import

        choice(name, TEMPLATES)
    return _text(f"{name}.toml")


def data_of(name: str) -> dict[str, str]:
    """The files that stand beside a template, as name -> text: those called NAME.txt or .csv.

    ParameterError for an unknown template.
    """
    template(name)
    names = {f"{name}.txt", f"{name}.csv"}
    found = (one.name for one in resources.files(__package__).iterdir())
    return {one: _text(one) for one in sorted(names.intersection(found))}


def description(name: str) -> str:
    """What a template is, in one line; ParameterError for an unknown one."""
    return template(name).partition("\n")[0].removeprefix("# ").removesuffix(".")


def commands(name: str) -> list[str]:
    """Commands to try with a template, each a line that ends with what it shows.

    ParameterError for an unknown template.
    """
    comment = template(name).partition("\n[")[0]
    return re.findall(r"^#   (ratestate .*)$", comment, re.MULTILINE)


def _text(file: str) -> str:
    return (resources.files(__package__) / file).read_text("utf-8")
