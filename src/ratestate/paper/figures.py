"""The paper's figures, and ours beyond it, as files: a picture, its print version, its numbers."""

from pathlib import Path

from .. import files, plot
from . import basins, branches, fig1, fig2, fig3, fig4, fig5, fig6, scheme

#: number or name -> module, with ``compute(law) -> Dataset`` and ``draw(Dataset) -> Figure``
PAPER = dict(enumerate((fig1, fig2, fig3, fig4, fig5, fig6), start=1))
FIGURES = PAPER | {"scheme": scheme, "branches": branches, "basins": basins}
#: those that show both laws
BOTH_LAWS = (1, "basins")


def stem(number, law):
    """Name of a figure's files: "fig2_slip"; without the law where it shows both."""
    name = f"fig{number}" if isinstance(number, int) else number
    return name if number in BOTH_LAWS else f"{name}_{law}"


def make(number, law, out):
    """Compute and draw a figure of `FIGURES`, and `write` it; the supplement has the aging law."""
    module = FIGURES[number]
    data = module.compute(law)
    return write(data, module.draw(data), out, stem(number, law))


def write(data, fig, out, name):
    """Write a figure and its numbers as NAME.png, .pdf and .nc into a folder, made if missing.

    Files of these names are replaced, each at once; the list of their paths.
    """
    out = Path(out)
    out.mkdir(parents=True, exist_ok=True)
    pictures = [plot.save(fig, out / f"{name}{end}") for end in (".png", ".pdf")]
    return [*pictures, files.write(data, out / f"{name}.nc")]
