"""The paper's figures, and those beyond it: the list of them, and how they become files.

The list is all that names them: the command line, its help and the tests read it.  Nothing heavy
is imported before a figure is made.
"""

import importlib
from pathlib import Path
from typing import NamedTuple

SOURCE = "Im, Marone & Elsworth (2019), doi:10.1016/j.jmps.2018.08.026"


class Figure(NamedTuple):
    """A figure; its module, of this package, has ``compute(law)`` and ``draw(Dataset)``."""

    module: str
    name: str  # as the command line reports it
    title: str
    help: str = ""  # what the command line's help says of it, where it is not in the paper
    both_laws: bool = False

    def stem(self, law):
        """Name of its files: "fig2_slip"; without the law where it shows both."""
        return self.module if self.both_laws else f"{self.module}_{law}"

    def compute(self, law):
        """The Dataset of its numbers; the paper's supplement has the aging law."""
        from ..plot.labels import LAWS

        laws = "both evolution laws" if self.both_laws else LAWS[law].name
        attrs = {"title": f"{self.title}; {laws}", "references": SOURCE}
        return self._imported().compute(law).assign_attrs(attrs)

    def draw(self, data):
        """The matplotlib Figure of what `compute` gives."""
        return self._imported().draw(data)

    def _imported(self):
        return importlib.import_module(f".{self.module}", __package__)


FIGURES = {
    "1": Figure(
        "fig1", "Fig. 1", "Fig. 1. Friction after an e-fold step in velocity", both_laws=True
    ),
    "2": Figure("fig2", "Fig. 2", "Fig. 2. Velocity steps across the critical velocity"),
    "3": Figure("fig3", "Fig. 3", "Fig. 3. Oscillation 10 s after a velocity step"),
    "4": Figure("fig4", "Fig. 4", "Fig. 4. From stick-slip to quasi-harmonic oscillation"),
    "5": Figure("fig5", "Fig. 5", "Fig. 5. Amplitude and frequency of limit cycles"),
    "6": Figure("fig6", "Fig. 6", "Fig. 6. Slow stick-slip near the critical stiffness"),
    "scheme": Figure(
        "scheme",
        "the scheme's error",
        "Error of the paper's scheme (eqs 8, 9) against its time step",
        "the error of its method against the time step",
    ),
    "branches": Figure(
        "branches",
        "branches of limit cycles",
        "Limit cycles of the slider of Fig. 2, stable and unstable",
        "stable and unstable limit cycles",
    ),
    "basins": Figure(
        "basins",
        "basins of steady sliding",
        "How hard stable sliding may be pushed",
        "what stable sliding survives",
        both_laws=True,
    ),
}
#: those that are not in the paper
BEYOND = {key: figure for key, figure in FIGURES.items() if figure.help}


def make(key, law, out):
    """Compute and draw a figure of `FIGURES`, and `write` it."""
    figure = FIGURES[key]
    data = figure.compute(law)
    return write(data, figure.draw(data), out, figure.stem(law))


def write(data, fig, out, name):
    """Write a figure and its numbers as NAME.png, .pdf and .nc into a folder, made if missing.

    Files of these names are replaced, each at once; the list of their paths.
    """
    from .. import files, plot

    out = Path(out)
    out.mkdir(parents=True, exist_ok=True)
    pictures = [plot.save(fig, out / f"{name}{end}") for end in (".png", ".pdf")]
    return [*pictures, files.write(data, out / f"{name}.nc")]
