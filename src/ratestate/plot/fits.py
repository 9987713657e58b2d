"""`plot.fit`: a fit as a picture."""

from ..records.fitting.by_law import checked_by_law
from .curves import axis_of, curves, marks
from .layout import styled
from .pages.fit import fit_page


@styled
def fit(result, ax=None, *, x=None):
    """Draw a fit: the record, the fitted curves with their 95 % bands, what they leave of it.

    Without axes a whole figure, with the residuals, close-ups of the first steps, and a table of
    the estimates; into axes only the record and the curves.

    Parameters
    ----------
    result : xarray.Dataset
        From `fit`, under one law or several.
    ax : matplotlib.axes.Axes, optional
    x : {"delta_lp", "time"}, optional
        Abscissa: load-point displacement [m] or time [s] from the record's first sample on; by
        default displacement, but time where the load point rests.

    Returns
    -------
    matplotlib.figure.Figure
        A new one, or that of the axes.

    Raises
    ------
    ParameterError
        Another result than that of `fit`, or one that has lost its attributes.
    """
    checked_by_law(result, "plot.fit")
    if ax is None:
        return fit_page(result, x)
    axis = axis_of(result, x)
    curves(result, ax, axis)
    marks(result, ax, axis)
    ax.legend()
    return ax.figure
