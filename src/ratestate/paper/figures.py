"""Make the figures of the paper and beyond, which figures.toml lists, and write them to files.

The command line, its help and the tests read this list.  Nothing heavy is imported before a figure
is made.
"""

import importlib
import tomllib
from pathlib import Path
from typing import NamedTuple

#: friction laws of the paper
LAWS = ("slip", "aging")


class Figure(NamedTuple):
    """A figure; its module, of this package, has ``compute(law)`` and ``draw(Dataset)``."""

    module: str
    title: str
    name: str
    help: str = ""
    both_laws: bool = False

    def stem(self, law):
        """Return the name of its files: "fig2_slip"; without the law if it shows both."""
        return self.module if self.both_laws else f"{self.module}_{law}"

    def compute(self, law):
        """Return the Dataset of its numbers; the law has no effect if it shows both."""
        from ..plot.labels import LAWS as STYLES

        laws = "both evolution laws" if self.both_laws else STYLES[law].name
        source = "Im, Marone & Elsworth (2019), doi:10.1016/j.jmps.2018.08.026"
        data = self._imported().compute(law)
        return data.assign_attrs(title=f"{self.title}; {laws}", references=source)

    def draw(self, data):
        """Draw the matplotlib Figure of these numbers."""
        return self._imported().draw(data)

    def _imported(self):
        return importlib.import_module(f".{self.module}", __package__)


def _figures():
    """Yield the rows of figures.toml; figures of the paper have a number."""
    rows = tomllib.loads(Path(__file__).with_suffix(".toml").read_text("utf-8"))
    for key, row in rows.items():
        base = {"module": f"fig{key}", "name": f"Fig. {key}"} if key.isdigit() else {"module": key}
        yield key, Figure(**base | row)


FIGURES = dict(_figures())
#: those that are not in the paper
EXTRAS = {key: figure for key, figure in FIGURES.items() if figure.help}


def make(key, law, out, *, title=True):
    """Compute, draw and `write` a figure of `FIGURES`, with its title or without; return the paths.

    The file of its numbers has the title in any case.
    """
    from ..plot.layout import untitled

    figure = FIGURES[key]
    data = figure.compute(law)
    fig = figure.draw(data)
    return write(data, fig if title else untitled(fig), out, figure.stem(law))


def write(data, fig, out, name):
    """Write a figure and its numbers as NAME.png, .pdf and .nc into a folder; return the paths.

    The folder is made if missing; each file replaces an old one at once.
    """
    from .. import files, plot

    out = Path(out)
    out.mkdir(parents=True, exist_ok=True)
    pictures = [plot.save(fig, out / f"{name}{end}") for end in (".png", ".pdf")]
    return [*pictures, files.write(data, out / f"{name}.nc")]
