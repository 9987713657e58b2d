"""All events of a series with their quantities: detection, measurement, status and message."""

import itertools
import math
from typing import Any, NamedTuple

import numpy as np

from ..kit.sample_noise import sample_noise
from ..messages import stick_slip as sentences
from . import computed, recorded
from .detection import in_gaps, rough_events, without_rebounds
from .hidden import has_several, has_step_down
from .measures import (
    CHANGES,
    CUT_BY_END,
    CUT_BY_START,
    GAP,
    LOAD_CHANGES,
    SEVERAL,
    UNDERSAMPLED,
    WHOLE,
    kinds,
    measured_events,
)
from .noise import Noise, loading_noise
from .outliers import without_outliers
from .significance import is_stick_slip
from .stiffness import Stiffness, loading_stiffness
from .trends import Trend, speed_groups, trend

#: smallest event of a run, over the error that is allowed in a step
LEAST = 10.0
#: scatter of rough drops over their median beyond which events have windows of their own
ALIKE = 0.1
#: the same in standard deviations of the noise, which changes rough drops
BY_NOISE = 3.0
#: shortest loading beside an event, over the median one, of events that share windows
CLOSE = 0.5
#: noise of the loading over the white one from which events are detected anew
LARGER = 1.2
#: a drop over the threshold below which such drops may be lost
SAFE = 2.0
#: drop of an event with few samples, over the median one, that several events may make
LARGE = 1.5


class Columns(NamedTuple):
    """(m,) columns of events that are not quantities with errors."""

    kind: np.ndarray
    samples: np.ndarray
    status: np.ndarray
    message: np.ndarray


class Catalogue(NamedTuple):
    """The events of a series."""

    values: dict[str, Any]  # name -> (values (m,), standard errors (m,))
    columns: Columns
    trends: dict[str, Trend]  # by the name of the abscissa
    stiffness: Stiffness
    noise: Noise
    threshold: float  # smallest stress drop that is found [Pa]


def catalogue_of(series):
    """The `Catalogue` of a `Series`."""
    clean, rough, noise, threshold = detected(series)
    gaps = in_gaps(series.t, rough)
    rises, falls = _phases(series, rough)
    stiffness = Stiffness(series.K or math.nan, series.K_error, series.K_source)
    if series.K is None:
        stiffness = loading_stiffness(series, rises, falls, noise)
    found = _found(series, rough, gaps, noise)
    status = np.where(gaps, GAP, _status(clean, rough, found, noise))
    values = measured_events(series, found, stiffness, status == SEVERAL)
    unresolved = values["duration"][0] < _longest_steps(series, rough)
    values["duration"] = tuple(np.where(unresolved, math.nan, x) for x in values["duration"])
    values["recurrence"], why = _recurrence(series, values["event_time"], status)
    kind = kinds(values, stiffness.K, series.M)
    drop, V_lp = values["stress_drop"][0], values["V_lp"][0]
    usual = np.nanmedian(drop) if np.isfinite(drop).any() else math.inf
    bounded = found.sparse & np.isfinite(drop) & np.isin(status, (UNDERSAMPLED, SEVERAL))
    reports = {
        "sparse": bounded,
        "few": drop < SAFE * threshold,
        "lost": _lost(clean, rough, noise),
        "short": unresolved,
        "large": found.sparse & (drop > LARGE * usual) & (status != SEVERAL),
    }
    message = _messages(status, why, drop, stiffness, reports)
    # (of events that were loaded at one V_lp from the last one on)
    whole = np.isin(status, (WHOLE, UNDERSAMPLED)) & np.isfinite(values["recurrence"][0])
    drop = np.where(whole, drop, np.nan)
    abscissae = {"recurrence": "the recurrence interval", "V_lp": "V_lp"}
    trends = {name: trend(values[name][0], drop, V_lp, what) for name, what in abscissae.items()}
    columns = Columns(kind, found.samples, status, message)
    return Catalogue(values, columns, trends, stiffness, noise, threshold)


def detected(series):
    """Return a series without its outliers, its events, its noise, and the threshold [Pa].

    The events are a list of `Rough`, empty if stress merely wanders.  The `Noise` is that of the
    loading, if it is larger than white noise.
    """
    if series.V is not None:
        rough, threshold = rough_events(series.tau, LEAST * series.resolution)
        return series, rough, Noise(0.0), threshold
    white = max(sample_noise(series.tau), series.resolution)
    series = series._replace(tau=without_outliers(series.tau, white))
    noise = Noise(white)
    rough, threshold = _rough(series, noise)
    for _ in range(2):
        rises = _phases(series, rough)[0]
        noise = loading_noise(series.t, series.tau, rises, white)
        if noise.sd < LARGER * white:
            break
        rough, threshold = _rough(series, noise)
    return series, rough if is_stick_slip(series, rough) else [], noise, threshold


def _rough(series, noise):
    """list of `Rough` events in noise, each with its rebound, and the threshold [Pa]."""
    rough, threshold = rough_events(series.tau, noise.sd, noise.inflation)
    return without_rebounds(series.tau, series.load.moved(series.t[0], series.t), rough), threshold


def _phases(series, rough):
    """Loading phases between events at one V_lp, and whole events: [(first, last sample)]."""
    t, load = series.t, series.load
    falls = [one for one in rough if min(one) >= 0]
    pairs = [(a.trough, b.peak) for a, b in itertools.pairwise(rough) if min(a.trough, b.peak) >= 0]
    return [(i, j) for i, j in pairs if not load.varies(t[i], t[j], CHANGES)], falls


def _found(series, rough, gaps, noise):
    """`Found` for all events; NaN for those that the record cuts, but for the time they have.

    gaps : (m,) whether samples are missing during an event, of which nothing is found then
    """
    whole = np.array([min(one) >= 0 for one in rough], bool) & ~gaps
    found = recorded.nothing(len(rough))
    for k in np.flatnonzero(~whole & ~gaps):
        found.peak[k, 2] = series.t[rough[k].peak] if rough[k].peak >= 0 else math.nan
        found.trough[k, 2] = series.t[rough[k].trough] if rough[k].trough >= 0 else math.nan
    if series.V is not None:
        groups = [np.flatnonzero(whole)] if whole.any() else []
    else:
        groups = _groups(series, rough, np.flatnonzero(whole), noise)
    for rows in groups:
        some = [rough[k] for k in rows]
        if series.V is not None:
            part = computed.found_events(series, some)
        else:
            spans = np.array([_span(series, rough, k) for k in rows])[:, [0, 3]].T
            part = recorded.found_events(series.t, series.tau, some, spans, noise)
        for column, of_part in zip(found, part, strict=True):
            column[rows] = of_part
    for rows in (found.peak, found.trough) if series.V is None else ():
        rows[:, 1] = np.hypot(rows[:, 1], series.resolution)
        rows[:, 3] = np.hypot(rows[:, 3], series.t_resolution)
    found.middle[:, 1] = np.hypot(found.middle[:, 1], series.t_resolution)
    return found


def _groups(series, rough, whole, noise):
    """Rows of events that are alike: at one V_lp, with much the same drop; else each by itself."""
    if not whole.size:
        return []
    peaks, troughs = (np.array([rough[k][i] for k in whole]) for i in (0, 1))
    drop = series.tau[peaks] - series.tau[troughs]
    loading = np.array([_loading(series, rough, k) for k in whole])
    speed = speed_groups(series.load.speed(0.5 * (series.t[peaks] + series.t[troughs]))[0])
    groups = []
    for number in range(speed.max() + 1):
        rows, own = whole[speed == number], drop[speed == number]
        allowed = math.hypot(ALIKE * np.median(own), BY_NOISE * noise.sd)
        near = np.abs(own - np.median(own)) <= allowed
        own = loading[speed == number]
        near &= own > CLOSE * np.median(own)
        groups += [rows[near]] if near.any() else []
        groups += [rows[[i]] for i in np.flatnonzero(~near)]
    return groups


def _loading(series, rough, k):
    """Shorter time of loading beside a whole event [s]; one that the record cuts does not count."""
    last, peak, trough, following = _span(series, rough, k)
    before, after = series.t[peak] - series.t[last], series.t[following] - series.t[trough]
    if k == 0 or k + 1 == len(rough):
        return max(before, after)
    return min(before, after)


def _status(series, rough, found, noise):
    """(m,) status of all events."""
    status = np.where(found.sparse, UNDERSAMPLED, WHOLE)
    for k, one in enumerate(rough):
        if min(one) < 0:
            status[k] = CUT_BY_START if one.peak < 0 else CUT_BY_END
        elif series.load.varies(series.t[one.peak], series.t[one.trough], CHANGES):
            status[k] = LOAD_CHANGES
        elif series.V is None and has_several(series.tau, _span(series, rough, k), noise):
            status[k] = SEVERAL
    return status


def _span(series, rough, k):
    """Samples of the last trough, of an event's peak and trough, and of the next peak."""
    last = max(rough[k - 1].trough, 0) if k else 0
    following = rough[k + 1].peak if k + 1 < len(rough) else series.t.size - 1
    return last, *rough[k], following


def _longest_steps(series, rough):
    """(m,) longest step between samples in the fall of each event [s]."""
    steps = np.diff(series.t, prepend=series.t[0])
    whole = [max(one.peak, 0) for one in rough], [max(*one, 0) for one in rough]
    return np.array([steps[i : j + 1].max() for i, j in zip(*whole, strict=True)])


def _lost(series, rough, noise):
    """(m,) whether the loading before each event has a smaller fall that noise does not make."""
    lost = np.zeros(len(rough), bool)
    for k, (last, one) in enumerate(itertools.pairwise(rough), 1):
        if series.V is None and min(last.trough, *one) >= 0:
            rise, drop = slice(last.trough, one.peak), series.tau[one.peak] - series.tau[one.trough]
            lost[k] = has_step_down(series.t[rise], series.tau[rise], drop, noise)
    return lost


def _recurrence(series, event_time, status):
    """(values, errors) (m,) of times since the last event, and why one is NaN (list of names)."""
    time, error = event_time
    values, errors = np.full(time.size, math.nan), np.full(time.size, math.nan)
    why = ["first"] * min(time.size, 1)
    for k in range(1, time.size):
        if not np.isfinite(time[k - 1]) or status[k - 1] == LOAD_CHANGES:
            why.append("after_cut")
        elif not np.isfinite(time[k]):
            why.append("")
        elif series.load.varies(time[k - 1], time[k], CHANGES):
            why.append("changed")
        else:
            values[k], errors[k] = time[k] - time[k - 1], math.hypot(error[k], error[k - 1])
            why.append("")
    return (values, errors), why


def _messages(status, why, drop, stiffness, reports):
    """(m,) what must be known of each event.

    reports : name of a message -> (m,) whether it holds
    """
    names = {CUT_BY_START: "start", CUT_BY_END: "end", LOAD_CHANGES: "load", GAP: "gap"}
    names[SEVERAL] = "several"
    messages = []
    for k, code in enumerate(status):
        texts = []
        if code in names:
            texts.append(sentences(f"message.{names[code]}"))
        elif not math.isfinite(drop[k]):
            texts.append(sentences("message.unmeasured"))
        texts += [sentences(f"message.{name}") for name, holds in reports.items() if holds[k]]
        if why[k] and code not in (CUT_BY_START, CUT_BY_END):
            texts.append(sentences(f"message.{why[k]}"))
        if not math.isfinite(stiffness.K):
            texts.append(sentences("message.no_stiffness"))
        messages.append("; ".join(texts))
    return np.array(messages, dtype=object if not messages else str)
