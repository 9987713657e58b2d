"""The likelihood of a record as a function of its parameters, integrated over level and trend.

Friction is linear in level and trend, and their priors are flat without bounds, so that the
integral has a closed form.  The noise is held at its estimate.
"""

import math

import numpy as np

from ...model.conversion import in_si
from ...model.names import keywords_checked
from ..messages import fitting as sentences
from .problem import SamplesProblem
from .settings import checked_settings
from .solutions import solutions_of
from .unknowns import LINEAR, parameter, to_coordinate, unknowns_of

#: ln(likelihood) if a slider does not move through the whole record
NO_MOTION = -1e300


@keywords_checked
def log_likelihood(
    record, slider, free=("a", "b", "Dc", "K"), *, loading=None, trend="slip", noise=None
):
    """Return ln(likelihood) of a record as a function of the free parameters.

    The function is for your own sampler or optimiser.  The record must begin in steady sliding.
    Its level of friction and its trend are integrated out, with flat priors without bounds.  So the
    maximum is at the estimates of `fit`, but its value differs from ``log_likelihood`` of that
    result.

    Parameters
    ----------
    record : xarray.Dataset
        As for `fit`.
    slider : SpringSlider
        The law, the parameters that are not free, and an initial guess of the free ones.
    free : sequence of str
        The free parameters, in the order in which the function takes them.
    loading : Loading, optional
        As for `fit`.
    trend : {"slip", "time", None}
        As for `fit`.
    noise : float or dict, optional
        As for `fit`.  By default it is held at the estimate of a fit.

    Returns
    -------
    LogLikelihood
        A function of a point: values (k,) [SI], in the order of `free` without mu0.  It returns a
        float, or -inf if no slider with these values moves through the whole record.  Its attribute
        ``names`` holds the order.  The function can be pickled.

    Raises
    ------
    ParameterError
        As `fit` does.

    Examples
    --------
    >>> import numpy as np, ratestate as rs
    >>> slider = rs.SpringSlider(a=0.01, b=0.012, Dc="10 um", sigma="5 MPa", K="5 GPa/m")
    >>> step = rs.Loading.steps("1 um/s", (100.0, "10 um/s"))
    >>> run = rs.simulate(slider, step, 140.0, times=np.linspace(0, 140, 1401))
    >>> noise = 1e-4 * np.random.default_rng(1).normal(size=1401)
    >>> record = run[["delta_lp"]].assign(friction=run.tau / slider.sigma + noise)
    >>> function = rs.log_likelihood(record, slider, ("Dc", "a"))
    >>> function([10e-6, 0.01]) > function([20e-6, 0.01])
    True
    """
    free = (free,) if isinstance(free, str) else tuple(free)
    choices = {"against": "time", "start": "steady", "errors": "covariance"}
    settings = checked_settings(slider, free=free, law=None, noise=noise, trend=trend, **choices)
    (solution,) = solutions_of(in_si(record), settings, loading)
    names = [name for name in free if name != "mu0"]
    samples, slider = solution.problem.record, solution.problem.slider
    unknowns = unknowns_of(samples, slider, names, start=False)
    return LogLikelihood(SamplesProblem(samples, slider, unknowns), solution.noise)


class LogLikelihood:
    """ln(likelihood) as a function of all coordinates but level and trend."""

    def __init__(self, problem, noise):
        self.problem, self.noise = problem, noise
        names = problem.unknowns.names
        self.nonlinear = [i for i, name in enumerate(names) if name not in LINEAR]
        self.linear = [i for i, name in enumerate(names) if name in LINEAR]
        self.names = tuple(names[i] for i in self.nonlinear)
        self.evaluations = 0

    def __call__(self, values):
        """Return ln(likelihood) at values (k,) [SI] of `names`; -inf without a motion."""
        if np.shape(values) != (len(self.names),):
            raise sentences.refusal(
                "settings.point", names=", ".join(self.names), count=len(self.names), values=values
            )
        with np.errstate(divide="ignore", invalid="ignore"):
            pairs = list(zip(self.names, np.asarray(values, float), strict=True))
            coordinates = np.array([to_coordinate(name, value) for name, value in pairs])
        least = [parameter(name).least for name in self.names]
        if not np.isfinite(coordinates).all() or (coordinates < least).any():
            return -math.inf
        value, _ = self.at(coordinates)
        return value if value > NO_MOTION else -math.inf

    def at(self, coordinates):
        """Return ln(likelihood), mean and root of level and trend; `NO_MOTION` and 0."""
        self.evaluations += 1
        record, count = self.problem.record, len(self.linear)
        point = np.zeros((1, len(self.problem.unknowns.names)))
        point[0, self.nonlinear] = coordinates
        friction, regressors = self.problem.forward.friction_and_regressors(point)
        if not np.isfinite(friction).all():
            return NO_MOTION, np.zeros(count + count * count)
        lines = [regressor[0] for regressor in regressors.values()]
        columns = np.column_stack([record.friction - friction[0], *lines])
        white, log_determinant = self.noise.whiten(record.t, columns)
        products = white.T @ white
        # covariance of level and trend given the rest, as root @ root.T
        root = np.linalg.inv(np.linalg.cholesky(products[1:, 1:])).T
        gained = root.T @ products[1:, 0]
        chi2 = products[0, 0] - gained @ gained
        free = record.t.size - count
        value = -0.5 * (chi2 + log_determinant + free * math.log(2.0 * math.pi))
        blob = np.concatenate([root @ gained, root.ravel()])
        return float(value + np.log(np.diag(root)).sum()), blob

    def draw_linear(self, blobs, rng):
        """Return level and trend (n, ...) drawn given the other coordinates."""
        count = len(self.linear)
        mean, root = blobs[:, :count], blobs[:, count:].reshape(-1, count, count)
        return mean + np.einsum("nij,nj->ni", root, rng.standard_normal(mean.shape))
