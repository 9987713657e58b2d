"""Times and friction in the Dataset of a record, checked."""

import numpy as np

from ...errors import ParameterError

#: name of the variable -> kind of friction: of the spring (tau) or the interface (mu)
KINDS = {"friction": "tau", "tau": "tau", "mu": "mu"}
#: bounds of friction, which may be a change from some level; farthest that a load point moves [m]
LOW, HIGH, FARTHEST = -0.1, 3.0, 10.0


def column(data, name):
    """(m,) values of a variable along time [SI]; refuses values that are not finite, by row."""
    if name not in data.variables:
        raise ParameterError(f"the record has no variable {name!r}; it has {variable_names(data)}")
    variable = data[name]
    if variable.dims != ("time",):
        raise ParameterError(
            f"{name} has the dimensions {variable.dims}; a record has its values along time alone: "
            f"pick one case with .isel(...)"
        )
    values = np.ascontiguousarray(variable.values, float)
    if not np.isfinite(values).all():
        row = int(np.argmin(np.isfinite(values)))
        raise ParameterError(
            f"{name} is {values[row]} in row {row} (counted from 0 on); drop such rows, for "
            f"example data.dropna('time')"
        )
    return values


def variable_names(data):
    """The names of all variables, as a message lists them."""
    return ", ".join(map(str, data.variables)) or "no variable at all"


def check_sizes(friction, data):
    """Refuse values that no laboratory has: they are in another unit, or of another sign."""
    typical = float(np.median(friction))
    if not LOW < typical < HIGH:
        what = "turn its sign" if -HIGH < typical < 0.0 else "is it a stress, or in per cent?"
        raise ParameterError(
            f"friction is {typical:.4g} (its median); expected shear over normal stress, {HIGH:g} "
            f"at most: {what}"
        )
    if "delta_lp" in data.variables:
        far = float(np.ptp(column(data, "delta_lp")))
        if far > FARTHEST:
            raise ParameterError(
                f"delta_lp ranges over {far:.4g} m; expected metres, {FARTHEST:g} at most: if it "
                f"is in um, divide it by 1e6"
            )


def check_increasing(time):
    """Refuse times that do not increase, by row."""
    if not (np.diff(time) > 0.0).all():
        row = int(np.argmin(np.diff(time) > 0.0)) + 1
        raise ParameterError(
            f"time goes from {time[row - 1]!r} to {time[row]!r} s in row {row} (counted from 0 "
            f"on); times must increase: sort the record and drop repeated ones"
        )


def friction_of(data, slider):
    """Kind and values of the friction that was recorded."""
    if "friction" in data.variables:
        return "tau", column(data, "friction")
    names = [name for name in ("tau", "mu") if name in data.variables]
    if len(names) == 2:
        raise ParameterError(
            "the record has both tau and mu, of which only one can be fitted; drop the other, or "
            "assign friction, for example data.assign(friction=data.tau / sigma)"
        )
    if not names:
        raise ParameterError(f"the record has no friction; it has {variable_names(data)}")
    values = column(data, names[0])
    if names[0] == "tau":
        sigma = data["sigma"] if "sigma" in data.variables else slider.sigma
        values = values / np.asarray(sigma, float)
    return KINDS[names[0]], values
