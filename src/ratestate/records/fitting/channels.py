"""What a record's Dataset holds: its times and friction, checked."""

import numpy as np

from ...errors import ParameterError

#: name of the variable -> kind of friction it is: the spring's or the interface's
KINDS = {"friction": "tau", "tau": "tau", "mu": "mu"}
#: friction that is possible, also as a change from its level; how far a load point moves [m]
LOW, HIGH, FARTHEST = -0.1, 3.0, 10.0


def column(data, name):
    """(m,) values of a variable along time [SI]; whatever is not finite is refused by row."""
    if name not in data.variables:
        raise ParameterError(f"the record has no variable {name!r}; it has {listed(data)}")
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


def listed(data):
    return ", ".join(map(str, data.variables)) or "no variable at all"


def of_usual_size(friction, data):
    """Refuse values that no laboratory has: of another unit, or sign."""
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


def increasing(time):
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
    found = [name for name in ("tau", "mu") if name in data.variables]
    if len(found) == 2:
        raise ParameterError(
            "the record has both tau and mu, of which only one can be fitted; drop the other, or "
            "assign friction, for example data.assign(friction=data.tau / sigma)"
        )
    if not found:
        raise ParameterError(f"the record has no friction; it has {listed(data)}")
    values = column(data, found[0])
    if found[0] == "tau":
        sigma = data["sigma"] if "sigma" in data.variables else slider.sigma
        values = values / np.asarray(sigma, float)
    return KINDS[found[0]], values
