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

from ..kit.polynomial_windows import basis, window_sizes
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

    def mean(self, weights, prior=None):
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
    """First row of a slide -> its `Level`; without slides of whose level nothing is known."""
    slides, bound = record.slides, _bound(record)
    tails = [one.tail for one in slides if one.follows_hold and one.tail.size >= FEWEST]
    shapes, weights = shapes_of(record.friction, record.slip, tails, noise.level)
    own, seen = [], np.zeros((len(slides), weights.size))
    for i, slide in enumerate(slides):
        one = _own(record, slide.tail, noise, shapes)
        own.append(one and one.with_misfit(_with_steady(weights, slide), bound))
        if one is not None and slide.follows_hold:
            seen[i] = own[i].solved(QUADRATIC)[3][:-1]
    others = [
        _with_steady(weights + seen.sum(0) - each, slide)
        for each, slide in zip(seen, slides, strict=True)
    ]
    alone = [one and one.mean(each, bound) for one, each in zip(own, others, strict=True)]
    errors = [np.inf if one is None else float(np.sqrt(one[1][0, 0])) for one in alone]
    for i, slide in enumerate(slides):
        if errors[i] > UNFINISHED * _fall(record, slide):
            own[i] = alone[i] = None
    ends = np.array([record.along[one.rows[-1]] for one in slides])
    priors = _priors(slides, ends, alone, record.trend is not None)
    levels = {}
    for i, slide in enumerate(slides):
        start, prior = np.nan, priors[i]
        if (one := own[i]) is not None:
            start = one.start
            mean, covariance = one.mean(others[i], bound if prior is None else prior)
        elif prior is not None:
            mean, covariance = prior[0], np.linalg.inv(prior[1])
        else:
            continue
        mean[0] += record.friction[0]
        levels[int(slide.rows[0])] = Level(start, ends[i], mean, covariance, errors[i])
    return levels


def _with_steady(weights, slide):
    """ln of the weights of shapes, and of no transient: half of all, but none after a hold."""
    if slide.follows_hold:
        return np.append(weights, -np.inf)
    return np.append(weights, logsumexp(weights) if weights.size else 0.0)


def _fall(record, slide):
    """Fall of friction from the peak to the end of a slide; inf unless it follows a hold."""
    if not slide.follows_hold:
        return np.inf
    return float(record.friction[slide.tail[0]] - record.friction[slide.rows[-FEWEST:]].mean())


def _bound(record):
    """What is known of any level (and slope): a slope does not exceed friction's own range."""
    slope = (np.ptp(record.along) / np.ptp(record.friction)) ** 2.0
    known = np.array([0.0, slope])[: 1 + (record.trend is not None)]
    return np.zeros(known.size), np.diag(known)


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
    misfit = np.mean([np.log(_misfits(friction, slip, rows, shapes, level)) for rows in tails], 0)
    weights = -INDEPENDENT * (misfit - misfit.min())
    kept = np.flatnonzero(weights > np.log(LEAST))
    return [shapes[i] for i in kept], weights[kept]


def _misfits(friction, slip, rows, shapes, level):
    """Standard deviation of friction in these rows about a level, a drift and each of shapes."""
    rows = rows[:: max(rows.size // COMPARED, 1)]
    y, x = friction[rows], slip[rows]
    straight = np.column_stack([np.ones(rows.size), (x - x[0]) / np.ptp(x)])
    misfits = []
    for shape in shapes:
        columns = np.column_stack([straight, shape.columns(x)])
        rest = y - columns @ np.linalg.lstsq(columns, y, rcond=1e-6)[0]
        misfits.append(np.hypot(np.sqrt(np.mean(rest**2)), level))
    return np.array(misfits)


def _own(record, rows, noise, shapes):
    """`_Own` of the largest window at a slide's end that a transient describes; None without."""
    if rows.size < FEWEST:
        return None
    columns, noise = _averaged(record, rows, noise)
    best, failed = None, 0
    for size in window_sizes(FEWEST, columns.shape[1]):
        one = _window(columns[:, -size:], noise, shapes)
        small, large = (one.solved(k)[2].min() for k in (LINEAR, QUADRATIC + TESTED))
        failed = failed + 1 if small - large > SIGNIFICANT else 0
        best = best if failed else one
        if failed == FAILED:
            break
    return best


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
    columns = columns[:, rows.size % each :]
    columns = columns.reshape(len(columns), -1, each).mean(axis=2)
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
    transients = white[:, shared.shape[1] :].reshape(t.size, -1, QUADRATIC)
    each = [np.hstack([first, transients[:, i], last]) for i in range(len(shapes) + 1)]
    normal = np.array([one.T @ one for one in each])
    lengths = np.array([*(shape.length for shape in shapes), 0.0])
    scale = (np.ptp(friction) + noise.level) * (1.0 + lengths / np.ptp(slip))
    return _Own(float(t[0]), normal, scale, 1 + len(drift))


def _priors(slides, ends, alone, has_slope):
    """What the other slides say of each one: mean and inverse covariance; None if nothing.

    ends : (slides,) of what friction drifts along, at their ends
    alone : level (and slope) of each slide with its covariance; None if it has none
    """
    known = [i for i, one in enumerate(alone) if one is not None]
    if not known or len(slides) < 2:
        return [None] * len(slides)
    speeds = [next(k for k, b in enumerate(slides) if is_same(a.V, b.V)) for a in slides]
    distance = np.median(np.diff(ends))
    designs = np.zeros((len(slides), 1 + has_slope, len(slides) + has_slope))
    designs[np.arange(len(slides)), 0, speeds] = 1.0
    if has_slope:
        designs[:, :, -1] = np.column_stack([(ends - ends.mean()) / distance, np.ones(ends.size)])
    unit = np.array([1.0, distance])[: 1 + has_slope]
    line = _Line(
        designs[known],
        unit * np.array([alone[i][0] for i in known]),
        np.outer(unit, unit) * np.array([alone[i][1] for i in known]),
        len({speeds[i] for i in known}) + has_slope,
    )
    scatter = line.scatter()
    priors: list = []
    for i, design in enumerate(designs):
        if known == [i]:
            priors.append(None)
            continue
        mean, covariance = line.fitted(scatter, np.array(known) != i)
        covariance = design @ covariance @ design.T + scatter**2 * np.eye(unit.size)
        inverse = np.outer(unit, unit) * np.linalg.inv(covariance)
        priors.append((design @ mean / unit, inverse))
    return priors


class _Line(NamedTuple):
    """Levels, and slopes times a distance, of slides that follow one line but for a scatter."""

    designs: np.ndarray  # (slides, 1 or 2, k) factors of the line's coefficients
    values: np.ndarray  # (slides, 1 or 2)
    covariances: np.ndarray
    rank: int  # number of coefficients that the slides show

    def fitted(self, scatter, used):
        """Coefficients of the line through these slides (mask), and their covariance."""
        inverse = self._inverse(scatter)[used]
        weighted = np.einsum("aik,aij->akj", self.designs[used], inverse)
        normal = np.einsum("akj,ajl->kl", weighted, self.designs[used])
        # (friction is of the order of 1: this bounds levels at a speed of no other slide)
        covariance = np.linalg.inv(normal + WIDEST**-2.0 * np.eye(len(normal)))
        return covariance @ np.einsum("akj,aj->k", weighted, self.values[used]), covariance

    def scatter(self):
        """Standard deviation of slides about the line that errors do not explain; 0 if they do.

        Such that the median of their chi-squares is as expected: a few poor levels do not matter.
        """
        freedom = 1.0 - self.rank / self.values.size

        def excess(scatter):
            line, _ = self.fitted(scatter, np.ones(len(self.values), bool))
            rest = self.values - self.designs @ line
            chi2 = np.einsum("ai,aij,aj->a", rest, self._inverse(scatter), rest)
            return float(np.median(chi2)) - freedom * chdtri(self.values.shape[1], 0.5)

        if freedom <= 0.0 or excess(0.0) <= 0.0:
            return 0.0
        widest = WIDEST * float(np.ptp(self.values[:, 0]) + np.abs(self.values[:, 1:]).sum())
        return brentq(excess, 0.0, widest)

    def _inverse(self, scatter):
        return np.linalg.inv(self.covariances + scatter**2 * np.eye(self.values.shape[1]))
