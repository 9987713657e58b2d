"""Forces and motions of the whole contact, of a slider whose area is known."""

import numpy as np
import xarray

from ..model.quantities import attrs
from ..model.units import is_array
from .results import parameter, slider_parameters


def force(stress, area):
    """Return the force [N] of a stress [Pa] on an area [m^2]."""
    return stress * area


def whole_contact(result):
    """Return forces and motions of the whole contact; none if the slider's area is not known.

    Parameters
    ----------
    result : xarray.Dataset
        From `simulate`, `limit_cycle` or `continue_cycle`, of one slider or many.

    Returns
    -------
    xarray.Dataset
        For a run, along ``time``: ``force`` [N] of the spring, and ``acceleration`` [m/s^2], eq. 4.
        Per case: ``force_amplitude`` [N] and ``displacement_amplitude`` [m], relative to the load
        point, both peak-to-peak in the last cycle; ``acceleration_max`` [m/s^2], the largest one of
        either sign.  Accelerations are NaN if M = 0.

    Raises
    ------
    ParameterError
        The result has lost its attributes.
    """
    if "area" not in slider_parameters(result):
        return xarray.Dataset()
    sigma, K, M, area = (parameter(result, symbol) for symbol in ("sigma", "K", "M", "area"))
    M = M.where(M > 0.0) if is_array(M) else M or np.nan
    found = {}
    if "tau" in result:
        found["force"] = force(result["tau"], area)
        held = sigma * result["mu"] + parameter(result, "damping") * result["V"]
        found["acceleration"] = (result["tau"] - held) / M
    if "amplitude" in result:
        stress = result["amplitude"] * sigma
        found["force_amplitude"] = force(stress, area)
        found["displacement_amplitude"] = stress / K
        of_run = "inertial_force" in result
        largest = result["inertial_force"] if of_run else result["inertia"] * result["amplitude"]
        found["acceleration_max"] = largest * sigma / M
    data = xarray.Dataset({symbol: value.drop_attrs(deep=False) for symbol, value in found.items()})
    for symbol in found:
        data[symbol].attrs = attrs(symbol)
    return data
