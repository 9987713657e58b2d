"""All events of a series with their quantities: detection, measurement, status and message."""

import itertools
import math
from typing import Any, NamedTuple

import numpy as np

from . import computed, recorded
from .detection import in_gaps, rough_events
from .measures import (
    CHANGES,
    CUT_BY_END,
    CUT_BY_START,
    GAP,
    LOAD_CHANGES,
    UNDERSAMPLED,
    WHOLE,
    kinds,
    measured_events,
)
from .noise import Noise, loading_noise, white_noise
from .outliers import without_outliers
from .refusals import sentence
from .significance import is_stick_slip
from .stiffness import Stiffness, loading_stiffness
from .trends import Trend, speed_groups, trend

#: smallest event of a run, over the error that is allowed in a step
LEAST = 10.0
#: scatter of rough drops over their median beyond which events have windows of their own
ALIKE = 0.1
#: noise of the loading over the white one from which events are detected anew
LARGER = 1.2


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


def catalogue_of(series):
    """The `Catalogue` of a `Series`."""
    rough, noise = detected(series)
    gaps = in_gaps(series.t, rough)
    rises, falls = _phases(series, rough)
    stiffness = Stiffness(series.K or math.nan, series.K_error, series.K_source)
    if series.K is None:
        stiffness = loading_stiffness(series, rises, falls, noise)
    found = _found(series, rough, gaps, noise)
    values = measured_events(series, found, stiffness)
    status = np.where(gaps, GAP, _status(series, rough, found))
    values["recurrence"], why = _recurrence(series, values["event_time"], status)
    kind = kinds(values, stiffness.K, series.M)
    message = _messages(status, why, values["stress_drop"][0], stiffness)
    # (of events that were loaded at one V_lp from the last one on)
    whole = np.isin(status, (WHOLE, UNDERSAMPLED)) & np.isfinite(values["recurrence"][0])
    drop, V_lp = np.where(whole, values["stress_drop"][0], np.nan), values["V_lp"][0]
    abscissae = {"recurrence": "the recurrence interval", "V_lp": "V_lp"}
    trends = {name: trend(values[name][0], drop, V_lp, what) for name, what in abscissae.items()}
    return Catalogue(
        values, Columns(kind, found.samples, status, message), trends, stiffness, noise
    )


def detected(series):
    """list of `Rough` events, and the `Noise`: of the loading, if that is larger than the white.

    None of a record whose stress merely wanders; outliers of one or two samples are no events.
    """
    if series.V is not None:
        return rough_events(series.tau, LEAST * series.resolution), Noise(0.0)
    white = white_noise(series.tau)
    series = series._replace(tau=without_outliers(series.tau, white))
    noise = Noise(white)
    rough = rough_events(series.tau, white)
    for _ in range(2):
        rises = _phases(series, rough)[0]
        noise = loading_noise(series.t, series.tau, rises, white)
        if noise.sd < LARGER * white:
            break
        rough = rough_events(series.tau, noise.sd, noise.inflation)
    return (rough if is_stick_slip(series, rough) else []), noise


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
        groups = _groups(series, rough, np.flatnonzero(whole))
    for rows in groups:
        some = [rough[k] for k in rows]
        if series.V is not None:
            part = computed.found_events(series, some)
        else:
            before = [max(rough[k - 1].trough, 0) if k else 0 for k in rows]
            after = [rough[k + 1].peak if k + 1 < len(rough) else series.t.size - 1 for k in rows]
            spans = np.array([before, after])
            part = recorded.found_events(series.t, series.tau, some, spans, noise)
        for column, of_part in zip(found, part, strict=True):
            column[rows] = of_part
    return found


def _groups(series, rough, whole):
    """Rows of events that are alike: at one V_lp, with much the same drop; else each by itself."""
    if not whole.size:
        return []
    peaks, troughs = (np.array([rough[k][i] for k in whole]) for i in (0, 1))
    drop = series.tau[peaks] - series.tau[troughs]
    speed = speed_groups(series.load.speed(0.5 * (series.t[peaks] + series.t[troughs]))[0])
    groups = []
    for number in range(speed.max() + 1):
        rows, own = whole[speed == number], drop[speed == number]
        near = np.abs(own - np.median(own)) <= ALIKE * np.median(own)
        groups += [rows[near]] if near.any() else []
        groups += [rows[[i]] for i in np.flatnonzero(~near)]
    return groups


def _status(series, rough, found):
    """(m,) status of all events."""
    status = np.where(found.sparse, UNDERSAMPLED, WHOLE)
    for k, one in enumerate(rough):
        if min(one) < 0:
            status[k] = CUT_BY_START if one.peak < 0 else CUT_BY_END
        elif series.load.varies(series.t[one.peak], series.t[one.trough], CHANGES):
            status[k] = LOAD_CHANGES
    return status


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


def _messages(status, why, drop, stiffness):
    """(m,) what must be known of each event."""
    names = {CUT_BY_START: "start", CUT_BY_END: "end", LOAD_CHANGES: "load", GAP: "gap"}
    messages = []
    for k, code in enumerate(status):
        texts = []
        if code in names:
            texts.append(sentence(f"message.{names[code]}"))
        elif not math.isfinite(drop[k]):
            texts.append(sentence("message.unmeasured"))
        elif code == UNDERSAMPLED:
            texts.append(sentence("message.sparse"))
        if why[k] and code not in (CUT_BY_START, CUT_BY_END):
            texts.append(sentence(f"message.{why[k]}"))
        if not math.isfinite(stiffness.K):
            texts.append(sentence("message.no_stiffness"))
        messages.append("; ".join(texts))
    return np.array(messages, dtype=object if not messages else str)
