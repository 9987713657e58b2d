"""Steady friction of each slide, with its drift.

Friction in a slide is a level, a drift, and a transient that fades from the peak on.  The slide's
own samples are joined with what the other slides say of it.  All slides are taken to follow one
line, with a level for each speed, from which they differ at random by as much as is seen.

Near steady sliding the equations of a slider without mass are linear.  The transient is then the
sum of two exponentials of slip, or an oscillation with an exponential envelope (Ruina 1983
doi:10.1029/JB088iB12p10359).  The lengths are properties of the slider, the same after every hold.
The amplitudes differ.  Farther from steady sliding the next terms of a series are products of the
two.
"""

from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq
from scipy.special import chdtri, logsumexp

from ..kit.polynomial_windows import basis, windows_that_pass
from .record import FEWEST, is_same

#: shorter length of the second exponential, as a fraction; or its wave number, times the length
FASTER, WAVES = (1.0, 0.5, 0.2, 0.05), (0.7, 1.5, 3.0, 6.0)
#: number of decay lengths; shortest and longest as a fraction of a slide
LENGTHS, SHORTEST, LONGEST = 18, 2e-3, 0.5
#: columns of a transient: linear, and with products
LINEAR, QUADRATIC = 2, 5
#: samples of a slide that are compared with each shape; independent deviations among them
COMPARED, INDEPENDENT = 150, 15
#: least weight of a shape, as a fraction of the best one's
LEAST = 1e-3
#: chi-square of six more coefficients that 1 window in 1000 exceeds by chance
SIGNIFICANT = 22.46
#: successive windows that must fail; orders of the polynomial that is tested
FAILED, TESTED = 2, 3
#: most samples of a slide; more are averaged in blocks
MOST = 2000
#: error of a level, as a multiple of that without a transient, beyond which noise is enlarged
POOR, MISFIT = 5.0, 3.0
#: largest error of a level, as a fraction of the fall since the peak, if the slide is to count
UNFINISHED = 0.1
#: largest standard deviation between slides, as a multiple of the difference of their levels
WIDEST = 10.0


class Shape(NamedTuple):
    """A transient's decay length [m], with a second, shorter one or a wave."""

    length: float
    faster: float  # second length as a fraction; 0 for a wave
    wave: float

    def columns(self, slip):
        """(n, QUADRATIC) a basis of transients at slip (n,) [m]; of order 1 at its start."""
        u = (slip - slip[0]) / self.length
        fade = np.exp(-u)
        if self.wave:
            one, two = fade * np.cos(self.wave * u), fade * np.sin(self.wave * u)
        elif self.faster == 1.0:
            one, two = fade, u * fade
        else:
            one, two = fade, (fade - np.exp(-u / self.faster)) / (1.0 - self.faster)
        return np.column_stack([one, two, one * one, one * two, two * two])


class Level(NamedTuple):
    """Steady friction of a slide: its level at the slide's end, and its slope unless that is 0."""

    start: float  # [s] of the first sample that was used; NaN if there is none
    end: float  # of what friction drifts along, at the slide's end
    coefficients: np.ndarray  # (1 or 2,)
    covariance: np.ndarray
    own_error: float  # standard error of the level from this slide alone; inf if it has none

    def at(self, along):
        """Steady friction there (a number or an array), and its standard error."""
        away = np.asarray(along) - self.end
        columns = np.array([np.ones_like(away), away])[: self.coefficients.size]
        variance = np.einsum("i...,ij,j...->...", columns, self.covariance, columns)
        return np.tensordot(self.coefficients, columns, 1)[()], np.sqrt(variance)[()]


class _Own(NamedTuple):
    """Level (and slope) of a slide from its own samples: normal matrices for each shape.

    The last shape is no transient.
    """

    start: float  # [s]
    normal: np.ndarray  # (shapes, 1 + k, 1 + k) of friction, and of all columns
    scale: np.ndarray  # (shapes,) standard deviation of a transient's coefficients beforehand
    size: int  # level, or level and slope

    def solved(self, transient, prior=None):
        """Coefficients (shapes, k), their covariance, chi-square and ln of the likelihood.

        transient : number of its columns; prior : mean (size,) and its inverse covariance
        """
        k = self.size + transient
        normal, right = self.normal[:, 1 : k + 1, 1 : k + 1].copy(), self.normal[:, 1 : k + 1, 0]
        chi2 = self.normal[:, 0, 0]
        own, rest = slice(self.size), np.arange(self.size, k)
        normal[:, rest, rest] += self.scale[:, None] ** -2
        if prior is not None:
            mean, inverse = prior
            normal[:, own, own] += inverse
            right = right + np.pad(inverse @ mean, (0, transient))
            chi2 = chi2 + mean @ inverse @ mean
        covariance = np.linalg.inv(normal)
        coefficients = np.einsum("sij,sj->si", covariance, right)
        chi2 = chi2 - np.einsum("si,si->s", right, coefficients)
        log_normal = np.linalg.slogdet(normal)[1] + 2.0 * transient * np.log(self.scale)
        return coefficients, covariance, chi2, -0.5 * (chi2 + log_normal)

    def mean(self, weights, prior):
        """Level (and slope) and its covariance, averaged over shapes with these ln(weights)."""
        coefficients, covariance, _, likelihood = self.solved(QUADRATIC, prior)
        weights = weights + likelihood
        weights = np.exp(weights - logsumexp(weights))
        own = slice(self.size)
        mean = weights @ coefficients[:, own]
        away = coefficients[:, own] - mean
        inner = np.einsum("s,sij->ij", weights, covariance[:, own, own])
        return mean, inner + np.einsum("s,si,sj->ij", weights, away, away)

    def with_misfit(self, weights, prior):
        """Itself; with noise larger by `MISFIT` if its transient is what limits the level.

        Shapes describe a transient only approximately.
        """
        _, covariance = self.mean(weights, prior)
        if covariance[0, 0] * self.normal[0, 1, 1] < POOR**2:
            return self
        return self._replace(normal=self.normal / MISFIT**2)


def levels_of(record, noise):
    """Number of a slide's segment -> its `Level`; without slides whose level is unknown."""
    slides, friction, has_slope = [*record.slides.values()], record.friction, bool(record.trend)
    # (a slope does not exceed friction's own range)
    slope = (np.ptp(record.along) / np.ptp(friction)) ** 2.0
    bound = np.zeros(1 + has_slope), np.diag([0.0, slope][: 1 + has_slope])
    tails = [one.tail for one in slides if one.follows_hold and one.tail.size >= FEWEST]
    shapes, weights = shapes_of(friction, record.slip, tails, noise.level)
    own = [_own(record, slide.tail, noise, shapes) for slide in slides]
    seen = np.zeros((len(slides), weights.size))
    for i, (one, slide) in enumerate(zip(own, slides, strict=True)):
        if one is not None:
            own[i] = one.with_misfit(_with_none(weights, slide), bound)
            seen[i] = own[i].solved(QUADRATIC)[3][:-1] if slide.follows_hold else 0.0
    others = [
        _with_none(each, slide)
        for each, slide in zip(weights + seen.sum(0) - seen, slides, strict=True)
    ]
    alone = [one and one.mean(each, bound) for one, each in zip(own, others, strict=True)]
    errors = [np.inf if one is None else float(np.sqrt(one[1][0, 0])) for one in alone]
    for i, slide in enumerate(slides):
        fall = friction[slide.tail[0]] - friction[slide.rows[-FEWEST:]].mean()
        if slide.follows_hold and errors[i] > UNFINISHED * fall:
            own[i] = alone[i] = None
    ends = np.array([record.along[slide.rows[-1]] for slide in slides])
    levels = {}
    priors = _priors(slides, ends, alone, has_slope)
    for i, (number, prior) in enumerate(zip(record.slides, priors, strict=True)):
        if (one := own[i]) is not None:
            mean, covariance = one.mean(others[i], bound if prior is None else prior)
        elif prior is not None:
            mean, covariance = prior[0], np.linalg.inv(prior[1])
        else:
            continue
        start, mean = np.nan if one is None else one.start, mean + [friction[0], 0.0][: mean.size]
        levels[number] = Level(start, ends[i], mean, covariance, errors[i])
    return levels


def _with_none(weights, slide):
    """ln of the weights of shapes, and of no transient: half of all, but none after a hold."""
    if slide.follows_hold:
        return np.append(weights, -np.inf)
    return np.append(weights, logsumexp(weights) if weights.size else 0.0)


def shapes_of(friction, slip, tails, level):
    """List of `Shape`s, and ln of their weights, that may describe tails (list of rows).

    level : standard deviation of the noise

    They are compared with friction from each peak on.  None of them is exact there, so weights
    follow from the misfit relative to the least one.
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


def _own(record, rows, noise, shapes):
    """`_Own` of the largest window at a slide's end that a transient describes; None without."""
    if rows.size < FEWEST:
        return None
    columns, noise = _averaged(record, rows, noise)
    found = {}

    def passes(size, _):
        found[size] = _window(columns[:, -size:], noise, shapes)
        small, large = (found[size].solved(k)[2].min() for k in (LINEAR, QUADRATIC + TESTED))
        return small - large <= SIGNIFICANT

    passed = windows_that_pass(FEWEST, columns.shape[1], passes, FAILED)
    return found[passed[-1]] if passed else None


def _averaged(record, rows, noise):
    """Times, change of friction, slip, and what friction drifts along, with their noise.

    Means of blocks, if there are more than `MOST` samples.  Without a trend the last is absent.
    """
    drift = [record.along] if record.trend else []
    change = record.friction - record.friction[0]
    columns = np.array([record.t, change, record.slip, *drift])[:, rows]
    each = -(-rows.size // MOST)
    if each == 1:
        return columns, noise
    columns = columns[:, rows.size % each :].reshape(len(columns), -1, each).mean(axis=2)
    # (the mean of a red part is less than each of its samples if it varies within a block)
    red = noise.red * min(1.0, np.sqrt(2.0 * noise.time / (columns[0, 1] - columns[0, 0])))
    return columns, noise._replace(white=noise.white / np.sqrt(each), red=red)


def _window(columns, noise, shapes):
    """`_Own` of the samples in these columns, as of `_averaged`."""
    t, friction, slip = columns[:3]
    drift = [along - along[-1] for along in columns[3:]]
    tested = basis(slip, slip[0], slip[-1], TESTED)[:, 1:]
    transients = [*(shape.columns(slip) for shape in shapes), np.zeros((t.size, QUADRATIC))]
    shared = np.column_stack([friction, np.ones(t.size), *drift, tested])
    white, _ = noise.whiten(t, np.column_stack([shared, *transients]))
    first, last = np.split(white[:, : shared.shape[1]], [-TESTED], axis=1)
    parts = np.split(white[:, shared.shape[1] :], len(transients), axis=1)
    each = [np.hstack([first, part, last]) for part in parts]
    normal = np.array([one.T @ one for one in each])
    lengths = np.array([*(shape.length for shape in shapes), 0.0])
    scale = (np.ptp(friction) + noise.level) * (1.0 + lengths / np.ptp(slip))
    return _Own(float(t[0]), normal, scale, 1 + len(drift))


def _priors(slides, ends, alone, has_slope):
    """What the other slides say of each one: mean and inverse covariance; None if nothing.

    They follow one line, with a level at each speed, but for a scatter.

    ends : (slides,) of what friction drifts along, at their ends
    alone : level (and slope) of each slide with its covariance; None if it has none
    """
    known = np.array([i for i, one in enumerate(alone) if one is not None], int)
    if not known.size or len(slides) < 2:
        return [None] * len(slides)
    speeds = [next(k for k, b in enumerate(slides) if is_same(a.V, b.V)) for a in slides]
    distance = np.median(np.diff(ends))
    designs = np.zeros((len(slides), 1 + has_slope, len(slides) + has_slope))
    designs[np.arange(len(slides)), 0, speeds] = 1.0
    if has_slope:
        designs[:, :, -1] = np.column_stack([(ends - ends.mean()) / distance, np.ones(ends.size)])
    unit = np.array([1.0, distance])[: 1 + has_slope]
    values = unit * np.array([alone[i][0] for i in known])
    covariances = np.outer(unit, unit) * np.array([alone[i][1] for i in known])
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
    """Coefficients (k,) of a line through slides, with a scatter about it; their covariance.

    designs : (slides, 1 or 2, k) factors of the coefficients in a level, and in a slope times a
        distance; values, covariances : of these levels and slopes
    """
    inverse = np.linalg.inv(covariances + scatter**2 * np.eye(values.shape[1]))
    weighted = np.einsum("aik,aij->akj", designs, inverse)
    normal = np.einsum("akj,ajl->kl", weighted, designs)
    # (friction is of the order of 1: this bounds levels at a speed of no other slide)
    covariance = np.linalg.inv(normal + WIDEST**-2.0 * np.eye(len(normal)))
    return covariance @ np.einsum("akj,aj->k", weighted, values), covariance


def scatter_about_line(designs, values, covariances, rank):
    """Standard deviation of slides about their line that errors do not explain; 0 if they do.

    Such that the median of their chi-squares is as expected: a few poor levels do not matter.

    rank : number of coefficients that the slides show; the others are those of `fitted_line`
    """
    freedom, size = 1.0 - rank / values.size, values.shape[1]

    def excess(scatter):
        line, _ = fitted_line(designs, values, covariances, scatter)
        rest = values - designs @ line
        inverse = np.linalg.inv(covariances + scatter**2 * np.eye(size))
        chi2 = np.einsum("ai,aij,aj->a", rest, inverse, rest)
        return float(np.median(chi2)) - freedom * chdtri(size, 0.5)

    if freedom <= 0.0 or excess(0.0) <= 0.0:
        return 0.0
    return brentq(excess, 0.0, WIDEST * float(np.ptp(values[:, 0]) + np.abs(values[:, 1:]).sum()))
