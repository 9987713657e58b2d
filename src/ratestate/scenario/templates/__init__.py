"""Scenario files to start from, with the data files that they use.

`ratestate init` writes them.  A file begins with a comment: its first line says what the file is,
and lines that begin with ``ratestate`` are commands to try, each with what it shows.  A file leaves
its friction law to `template`: $law stands for it, $others for those that may take its place.
"""

import re
import string
from importlib import resources

from ...friction.laws import DEFAULT, LAWS

#: what there is, in the order of `ratestate init --list`
TEMPLATES = (
    *("lab", "brake", "fault", "record"),
    *("slide-hold-slide", "stiff-rig", "sinusoid", "recorded-loading", "brake-map"),
    "static-kinetic",
    *("fig2", "fig3", "fig4", "fig6", "million"),
)

#: template -> its friction law, where that is not the default one
LAW = dict.fromkeys(
    ("lab", "fault", "slide-hold-slide", "recorded-loading", "fig6", "static-kinetic"), "aging"
)

# Laws with the parameters of every slider alone.
_LAWS = [name for name, law in LAWS.items() if not law.parameters]


def template(name: str) -> str:
    """Return the text of a commented scenario file to start from.

    Parameters
    ----------
    name : str
        Name of the file, such as "lab", "brake" or "fault".  ``ratestate init --list`` lists the
        names.

    Returns
    -------
    str
        Text in TOML.

    Raises
    ------
    ParameterError
        If no template has this name.  The message lists the names, and suggests one.
    """
    if name not in TEMPLATES:
        from ..problems import choice  # which takes a second to import

        choice(name, TEMPLATES)
    chosen = LAW.get(name, DEFAULT)
    others = [law for law in _LAWS if law != chosen]
    named = {"law": chosen, "other": others[0], "others": " or ".join(f'"{law}"' for law in others)}
    return string.Template(_text(f"{name}.toml")).substitute(named)


def files_of(name: str) -> dict[str, str]:
    """Return file -> text: of a template, NAME.toml, and of its data, NAME.txt or NAME.csv.

    Raises ParameterError for an unknown template.
    """
    files = {file.name for file in resources.files(__package__).iterdir()}
    data = (f"{name}{ending}" for ending in (".txt", ".csv"))
    return {f"{name}.toml": template(name)} | {file: _text(file) for file in data if file in files}


def description(name: str) -> str:
    """Return what a template is, in one line; ParameterError for an unknown one."""
    return template(name).partition("\n")[0].removeprefix("# ").removesuffix(".")


def commands(name: str) -> list[str]:
    """Return commands to try with a template, each a line that ends with what it shows.

    Raises ParameterError for an unknown template.
    """
    comment = template(name).partition("\n[")[0]
    return re.findall(r"^#   (ratestate .*)$", comment, re.MULTILINE)


def _text(file: str) -> str:
    return (resources.files(__package__) / file).read_text("utf-8")
