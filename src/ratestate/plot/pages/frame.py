"""What pages of fits have in common: title and parts, legend, likelihoods, table of estimates."""

from matplotlib.patches import Patch

from ...dynamics import attributes
from ...friction.laws import friction_law, own_parameters
from ...records.fitting.by_law import law_names
from ..estimates import ROW, write_estimates
from ..labels import LAWS, label
from ..layout import ABOVE, figure, letters
from ..likelihood import likelihood, non_gaussian

#: letters of a legend for which a panel has room that has another beside it
ROOM = 45
#: laws that the title names; the legend names more
NAMED = 2
#: heights [inches]: of a likelihood, of axes' labels, of the title and the space under the table
LIKELIHOOD, LABELS, TITLE = 1.3, 1.0, 0.45


def framed(result, laws, height):
    """(Figure with its title, list of its empty parts: panels, likelihoods if any, estimates).

    height : of the panels [inches]
    """
    middle = [LIKELIHOOD] if non_gaussian(result) else []
    heights = [height + LABELS, *middle, ROW * (1 + len(laws))]
    own = own_parameters(map(friction_law, laws))
    symbols = " ".join(s for s in (*"sigma M a b Dc K V0".split(), *own) if s not in result)
    source = attributes.text(result, "source", "")
    which = f"the {law_names(laws)}" if len(laws) <= NAMED else f"{len(laws)} friction laws"
    title = (
        f"Fit of {source + ', ' if source else ''}{result.sizes['time']:,} samples of friction, "
        f"under {which}"
    )
    fig = figure(result, sum(heights) + TITLE, symbols, title=title)
    return fig, list(fig.subfigures(len(heights), 1, height_ratios=heights))


def finished(result, parts, first):
    """Fill the lower parts of a figure: likelihoods, if any, from letter `first` on; estimates."""
    if symbols := non_gaussian(result):
        panels = parts[0].subplots(1, len(symbols), sharey=True, squeeze=False)[0]
        for symbol, ax in zip(symbols, panels, strict=True):
            likelihood(result, symbol, ax)
        letters(panels, *(f"likelihood of {label(s)}" for s in symbols), first=first)
        panels[0].set_ylabel("relative likelihood")
    write_estimates(result, parts[-1].subplots())


def legend(ax, laws, *, band=True, narrow=False):
    """What the lines are, above the record; in two rows if a narrow panel has no room for one."""
    handles, names = ax.get_legend_handles_labels()
    if band:
        color = LAWS[next(iter(laws))].color if len(laws) == 1 else "0.5"
        handles.append(Patch(color=color, alpha=0.3, lw=0.0))
        names.append("95 % of samples")
    look = {"fontsize": 7, "handlelength": 1.2, "handletextpad": 0.4, "columnspacing": 0.7}
    rows = 2 if narrow and sum(map(len, names)) > ROOM else 1
    ax.legend(handles, names, ncols=-(-len(names) // rows), **(ABOVE | look))
