"""Steady friction of each slide, with its drift.

Friction in a slide is the sum of a level, a drift, and a transient that decays from the peak on.
The fit of a slide has a prior from the other slides: all slides follow one line, with a level for
each speed.  The scatter of slides about this line is estimated.

Near steady sliding the equations of a slider without mass are linear.  The transient is then the
sum of two exponentials of slip, or an oscillation with an exponential envelope (Ruina 1983
doi:10.1029/JB088iB12p10359).  The decay lengths are properties of the slider, equal after every
hold.  The amplitudes differ.  Farther from steady sliding, the next terms of a series are products
of the two functions.
"""

from typing import NamedTuple

import numpy as np
import scipy

from .holds import FEWEST, is_same_speed
from .polynomials import basis, windows_that_pass

#: second decay length as a fraction of the first; or wave number times the decay length
FASTER, WAVES = (1.0, 0.5, 0.2, 0.05), (0.7, 1.5, 3.0, 6.0)
#: number of decay lengths that are tried; shortest and longest, as fractions of a slide
LENGTHS, SHORTEST, LONGEST = 18, 2e-3, 0.5
#: number of columns of a transient: linear terms only, and with products
LINEAR, QUADRATIC = 2, 5
#: samples of a slide that are compared with each shape; number of independent residuals among them
COMPARED, INDEPENDENT = 150, 15
#: least weight of a shape, as a fraction of the best one's
LEAST = 1e-3
#: fall of chi-square by six more coefficients that 1 of 1000 windows exceeds by chance
SIGNIFICANT = 22.46
#: order of the polynomial that is tested
TESTED = 3
#: most samples of a slide; more are averaged in blocks
MAX_SAMPLES = 2000
#: error of a level, as a multiple of the error without a transient, above which the noise is
#: enlarged; the factor
POOR_FIT, MISFIT = 5.0, 3.0
#: largest error of a level, as a fraction of the fall since the peak, of a slide that is used
UNFINISHED = 0.1
#: largest standard deviation between slides, as a multiple of the difference of their levels
WIDEST = 10.0


class Shape(NamedTuple):
    """Shape of a transient: a decay length, with a second, shorter one or a wave."""

    length: float  # [m]
    faster: float  # second length as a fraction of the first; 0 for a wave
    wave: float  # wave number times the length; 0 for two exponentials

    def columns(self, slip):
        """Return a basis of transients (n, QUADRATIC) at slip (n,) [m], about 1 at the start."""
        # (noise of slip may be many times the length, and exp(-u) would overflow)
        u = np.maximum((slip - slip[0]) / self.length, -1.0)
        fade = np.exp(-u)
        if self.wave:
            first, second = fade * np.cos(self.wave * u), fade * np.sin(self.wave * u)
        elif self.faster == 1.0:
            first, second = fade, u * fade
        else:
            first, second = fade, (fade - np.exp(-u / self.faster)) / (1.0 - self.faster)
        return np.column_stack([first, second, first * first, first * second, second * second])


class Level(NamedTuple):
    """Steady friction of a slide: its level at the slide's end, and its slope with a trend."""

    start: float  # time [s] of the first sample that was used; NaN if none was
    end: float  # drift coordinate at the slide's end
    coefficients: np.ndarray  # (1 or 2,) level, and slope if there is a trend
    covariance: np.ndarray
    error_alone: float  # standard error of the level from this slide alone; inf if unknown

    def at(self, drift_coordinate):
        """Return steady friction and its standard error at a drift coordinate or several."""
        distance = np.asarray(drift_coordinate) - self.end
        columns = np.array([np.ones_like(distance), distance])[: self.coefficients.size]
        variance = np.einsum("i...,ij,j...->...", columns, self.covariance, columns)
        return np.tensordot(self.coefficients, columns, 1)[()], np.sqrt(variance)[()]


class _Solution(NamedTuple):
    """The least-squares solution of a slide for each shape."""

    coefficients: np.ndarray  # (shapes, k)
    covariance: np.ndarray  # (shapes, k, k)
    chi2: np.ndarray  # (shapes,)
    log_likelihood: np.ndarray  # (shapes,)


class _SlideFit(NamedTuple):
    """Least-squares fit of a slide's level (and slope), for each shape.

    The last shape stands for a slide without a transient.
    """

    start: float  # [s]
    root: np.ndarray  # (shapes, rows, 1 + k) friction and all columns, triangular
    scale: np.ndarray  # (shapes,) prior standard deviation of a transient's coefficients
    size: int  # 1: level; 2: level and slope

    def solved(self, transient, prior=None):
        """Return the `_Solution`.

        transient : number of columns of the transient
        prior : mean (size,) and inverse covariance of level (and slope), or None
        """
        k = self.size + transient
        rows = [np.roll(self.root[:, :, : k + 1], -1, axis=2)]  # friction is the last column
        of_scale = np.eye(transient, k + 1, self.size)
        rows.append(of_scale / self.scale[:, None, None])
        if prior is not None:
            mean, inverse = prior
            values, vectors = np.linalg.eigh(inverse)
            level = np.sqrt(np.maximum(values, 0.0))[:, None] * vectors.T
            of_prior = np.column_stack([level, np.zeros((self.size, transient)), level @ mean])
            rows.append(np.broadcast_to(of_prior, (len(self.scale), *of_prior.shape)))
        root = _triangular(np.concatenate(rows, axis=1))
        inverse = np.linalg.inv(root[:, :k, :k])
        coefficients = (inverse @ root[:, :k, k:])[..., 0]
        covariance = inverse @ inverse.swapaxes(1, 2)
        chi2 = root[:, k, k] ** 2
        log_determinant = np.log(np.abs(np.diagonal(root[:, :k, :k], axis1=1, axis2=2))).sum(axis=1)
        log_normal = log_determinant + transient * np.log(self.scale)
        return _Solution(coefficients, covariance, chi2, -0.5 * chi2 - log_normal)

    def mean(self, weights, prior):
        """Return level (and slope) and covariance, averaged over shapes with these ln(weights)."""
        coefficients, covariance, _, log_likelihood = self.solved(QUADRATIC, prior)
        weights = weights + log_likelihood
        weights = np.exp(weights - scipy.special.logsumexp(weights))
        level = slice(self.size)
        mean = weights @ coefficients[:, level]
        deviation = coefficients[:, level] - mean
        within = np.einsum("s,sij->ij", weights, covariance[:, level, level])
        return mean, within + np.einsum("s,si,sj->ij", weights, deviation, deviation)

    def with_misfit(self, weights, prior):
        """Enlarge the noise by `MISFIT` if the level's error is mainly due to the transient.

        The reason is that shapes describe a transient only approximately.
        """
        _, covariance = self.mean(weights, prior)
        if covariance[0, 0] * (self.root[0, :, 1] ** 2).sum() < POOR_FIT**2:
            return self
        return self._replace(root=self.root / MISFIT)


def _triangular(matrices):
    return np.asarray(np.linalg.qr(matrices, mode="r"))


def levels_of(record, noise):
    """Return index of a slide's segment -> `Level`, for slides whose level is known."""
    slides, friction, has_slope = [*record.slides.values()], record.friction, bool(record.trend)
    # (over the record, the drift does not exceed the range of friction)
    slope = (np.ptp(record.drift_coordinate) / np.ptp(friction)) ** 2.0
    bound = np.zeros(1 + has_slope), np.diag([0.0, slope][: 1 + has_slope])
    tails = [slide.tail for slide in slides if slide.follows_hold and slide.tail.size >= FEWEST]
    shapes, weights = shapes_of(friction, record.slip, tails, noise.level)
    fits = [_slide_fit(record, slide.tail, noise, shapes) for slide in slides]
    evidence = np.zeros((len(slides), weights.size))
    for i, (fit, slide) in enumerate(zip(fits, slides, strict=True)):
        if fit is not None:
            fits[i] = fit.with_misfit(_with_no_transient(weights, slide), bound)
            if slide.follows_hold:
                evidence[i] = fits[i].solved(QUADRATIC).log_likelihood[:-1]
    of_shapes = [
        _with_no_transient(weight, slide)
        for weight, slide in zip(weights + evidence.sum(0) - evidence, slides, strict=True)
    ]
    means = [fit and fit.mean(weight, bound) for fit, weight in zip(fits, of_shapes, strict=True)]
    errors = [np.inf if level is None else float(np.sqrt(level[1][0, 0])) for level in means]
    for i, slide in enumerate(slides):
        fall = friction[slide.tail[0]] - friction[slide.rows[-FEWEST:]].mean()
        if slide.follows_hold and errors[i] > UNFINISHED * fall:
            fits[i] = means[i] = None
    ends = np.array([record.drift_coordinate[slide.rows[-1]] for slide in slides])
    levels = {}
    priors = _priors(slides, ends, means, has_slope)
    for i, (number, prior) in enumerate(zip(record.slides, priors, strict=True)):
        if (fit := fits[i]) is not None:
            mean, covariance = fit.mean(of_shapes[i], bound if prior is None else prior)
        elif prior is not None:
            mean, covariance = prior[0], np.linalg.inv(prior[1])
        else:
            continue
        start, mean = np.nan if fit is None else fit.start, mean + [friction[0], 0.0][: mean.size]
        levels[number] = Level(start, ends[i], mean, covariance, errors[i])
    return levels


def _with_no_transient(weights, slide):
    """Append ln of the weight without a transient: half of the total, or 0 after a hold."""
    if slide.follows_hold:
        return np.append(weights, -np.inf)
    return np.append(weights, scipy.special.logsumexp(weights) if weights.size else 0.0)


def shapes_of(friction, slip, tails, level):
    """Return the `Shape`s that may describe the tails (lists of rows), and ln of their weights.

    Shapes are compared with friction from each peak on.  None of them is exact there, so weights
    follow from the misfit relative to the least one.

    level : standard deviation of the noise
    """
    if not tails:
        return [], np.zeros(0)
    distance = float(np.median([np.ptp(slip[rows]) for rows in tails]))
    lengths = distance * np.geomspace(SHORTEST, LONGEST, LENGTHS)
    forms = [(faster, 0.0) for faster in FASTER] + [(0.0, wave) for wave in WAVES]
    shapes = [Shape(length, *form) for length in lengths for form in forms]
    misfit = np.zeros(len(shapes))
    for tail in tails:
        rows = tail[:: max(tail.size // COMPARED, 1)]
        y, x = friction[rows], slip[rows]
        straight = basis(x, x[0], x[-1], 1)
        for i, shape in enumerate(shapes):
            columns = np.column_stack([straight, shape.columns(x)])
            rest = y - columns @ np.linalg.lstsq(columns, y, rcond=1e-6)[0]
            misfit[i] += np.log(np.hypot(np.sqrt(np.mean(rest**2)), level)) / len(tails)
    weights = -INDEPENDENT * (misfit - misfit.min())
    kept = np.flatnonzero(weights > np.log(LEAST))
    return [shapes[i] for i in kept], weights[kept]


def _slide_fit(record, rows, noise, shapes):
    """Fit the largest window at a slide's end that a transient describes; None without one."""
    if rows.size < FEWEST:
        return None
    columns, noise = _averaged(record, rows, noise)
    fits = {}

    def passes(size):
        fits[size] = _fit_in_window(columns[:, -size:], noise, shapes)
        small, large = (fits[size].solved(k).chi2.min() for k in (LINEAR, QUADRATIC + TESTED))
        return small - large <= SIGNIFICANT

    passed = windows_that_pass(FEWEST, columns.shape[1], passes)
    return fits[passed[-1]] if passed else None


def _averaged(record, rows, noise):
    """Return times, change of friction, slip and drift coordinate as rows, and their noise.

    More than `MAX_SAMPLES` samples are averaged in blocks.  Without a trend the last row is absent.
    """
    drift = [record.drift_coordinate] if record.trend else []
    change = record.friction - record.friction[0]
    columns = np.array([record.t, change, record.slip, *drift])[:, rows]
    block = -(-rows.size // MAX_SAMPLES)
    if block == 1:
        return columns, noise
    columns = columns[:, rows.size % block :].reshape(len(columns), -1, block).mean(axis=2)
    # (averaging reduces the red part if it varies within a block)
    red = noise.red * min(1.0, np.sqrt(2.0 * noise.time / (columns[0, 1] - columns[0, 0])))
    return columns, noise._replace(white=noise.white / np.sqrt(block), red=red)


def _fit_in_window(columns, noise, shapes):
    """Return the `_SlideFit` of samples from `_averaged`."""
    t, friction, slip = columns[:3]
    drift = [coordinate - coordinate[-1] for coordinate in columns[3:]]
    tested = basis(slip, slip[0], slip[-1], TESTED)[:, 1:]
    transients = [*(shape.columns(slip) for shape in shapes), np.zeros((t.size, QUADRATIC))]
    shared = np.column_stack([friction, np.ones(t.size), *drift, tested])
    white, _ = noise.whiten(t, np.column_stack([shared, *transients]))
    first, last = np.split(white[:, : shared.shape[1]], [-TESTED], axis=1)
    parts = np.split(white[:, shared.shape[1] :], len(transients), axis=1)
    designs = [np.hstack([first, part, last]) for part in parts]
    root = _triangular(np.array(designs))
    lengths = np.array([*(shape.length for shape in shapes), 0.0])
    scale = (np.ptp(friction) + noise.level) * (1.0 + lengths / np.ptp(slip))
    return _SlideFit(float(t[0]), root, scale, 1 + len(drift))


def _priors(slides, ends, means, has_slope):
    """Return the prior of each slide from all others: mean and inverse covariance, or None.

    Slides scatter about one line with a level at each speed.

    ends : (slides,) drift coordinates at the slides' ends
    means : level (and slope) of each slide with its covariance, or None
    """
    known = np.array([i for i, level in enumerate(means) if level is not None], int)
    if not known.size or len(slides) < 2:
        return [None] * len(slides)
    speeds = [next(k for k, b in enumerate(slides) if is_same_speed(a.V, b.V)) for a in slides]
    distance = np.median(np.diff(ends))
    designs = np.zeros((len(slides), 1 + has_slope, len(slides) + has_slope))
    designs[np.arange(len(slides)), 0, speeds] = 1.0
    if has_slope:
        designs[:, :, -1] = np.column_stack([(ends - ends.mean()) / distance, np.ones(ends.size)])
    unit = np.array([1.0, distance])[: 1 + has_slope]
    values = unit * np.array([means[i][0] for i in known])
    covariances = np.outer(unit, unit) * np.array([means[i][1] for i in known])
    rank = len({speeds[i] for i in known}) + has_slope
    scatter = scatter_about_line(designs[known], values, covariances, rank)
    priors: list = []
    for i, design in enumerate(designs):
        use = known != i
        if not use.any():
            priors.append(None)
            continue
        mean, covariance = fitted_line(designs[known[use]], values[use], covariances[use], scatter)
        covariance = design @ covariance @ design.T + scatter**2 * np.eye(unit.size)
        inverse = np.outer(unit, unit) * np.linalg.inv(covariance)
        priors.append((design @ mean / unit, inverse))
    return priors


def fitted_line(designs, values, covariances, scatter):
    """Return coefficients (k,) of a line through slides that scatter about it; their covariance.

    designs : (slides, 1 or 2, k) factors of the coefficients in each level, and in each slope times
        a distance
    values, covariances : levels and slopes, and their covariances
    """
    inverse = np.linalg.inv(covariances + scatter**2 * np.eye(values.shape[1]))
    weighted = np.einsum("aik,aij->akj", designs, inverse)
    normal = np.einsum("akj,ajl->kl", weighted, designs)
    # (friction is of the order of 1: this bounds the level at a speed without another slide)
    covariance = np.linalg.inv(normal + WIDEST**-2.0 * np.eye(len(normal)))
    return covariance @ np.einsum("akj,aj->k", weighted, values), covariance


def scatter_about_line(designs, values, covariances, rank):
    """Return the standard deviation of slides about their line beyond their errors.

    It makes the median of their chi-squares as expected, so that a few outliers do not matter.  It
    is 0 if the errors explain the scatter.

    rank : number of coefficients that the slides determine
    """
    freedom, size = 1.0 - rank / values.size, values.shape[1]

    def excess(scatter):
        line, _ = fitted_line(designs, values, covariances, scatter)
        rest = values - designs @ line
        inverse = np.linalg.inv(covariances + scatter**2 * np.eye(size))
        chi2 = np.einsum("ai,aij,aj->a", rest, inverse, rest)
        return float(np.median(chi2)) - freedom * scipy.special.chdtri(size, 0.5)

    if freedom <= 0.0 or excess(0.0) <= 0.0:
        return 0.0
    return scipy.optimize.brentq(
        excess, 0.0, WIDEST * float(np.ptp(values[:, 0]) + np.abs(values[:, 1:]).sum())
    )
