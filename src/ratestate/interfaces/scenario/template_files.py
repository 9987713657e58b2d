"""Commented scenario files to start from."""

from importlib import resources

from .problems import choice

TEMPLATES = ("brake", "lab", "fault")


def template(name: str) -> str:
    """The text of a commented scenario file to start from.

    Parameters
    ----------
    name : {"brake", "lab", "fault"}

    Raises
    ------
    ParameterError
        Any other name.
    """
    file = resources.files(__package__) / "templates" / f"{choice(name, TEMPLATES)}.toml"
    return file.read_text("utf-8")
