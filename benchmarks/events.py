"""How true catalogues of stick-slip events are: `python benchmarks/events.py [NUMBER]`.

200 random sliders on their limit cycles, whose stress drop and period `limit_cycle` gives to 1e-8,
make runs without noise at the solver's own steps and at fewer and fewer samples, and records with
white and with correlated noise of up to 3 % of the drop.  Records of straight loading and short
falls, 9 of each kind, have noise of up to 20 % of the drop, and two events close to each other.
"""

import argparse
import sys
from pathlib import Path

import numpy as np
from report import CONSOLE, Table
from scipy.stats import norm

import ratestate as rs

sys.path.insert(0, str(Path(__file__).parents[1] / "tests/helpers"))
from synthetic_stick_slip import cycles, sawtooth

#: periods of a run; of a record; samples a period of runs
RUN, RECORD, SAMPLES = 4.2, 8.2, (None, 3000, 1000, 300, 100)
#: noise of records of straight loading, over the drop; times from one event to a second [samples]
NOISE, CLOSE = (0.003, 0.03, 0.1, 0.2), (None, 0.5, 1.5, 3.0, 8.0, 20.0)
#: records of each kind; parts of messages that an event may be several, or others be lost
EACH, TOLD = 9, ("several events", "may be lost", "may span")
#: quantities whose truth is that of the run at the solver's own steps
OWN_TRUTH = ("tau_max", "tau_min", "event_start", "event_end", "duration", "slip")


def without_noise(found):
    """Print the relative errors of drops and recurrence intervals without noise."""
    table = Table(
        "samples a period", "median", "90 %", "largest", "recurrence, largest", "not sparse"
    )
    for samples in SAMPLES:
        drop, recurrence, whole = [], [], []
        for cycle in found:
            events = rs.events(cycle.run(RUN, samples))
            good = events.event_status.values == 0
            sparse = events.event_status.values == 4
            whole.append(good.sum() / max((good | sparse).sum(), 1))
            if not good.any():
                continue
            drop.append(np.abs(events.stress_drop.values[good] / cycle.drop - 1.0).max())
            times = np.abs(events.recurrence.values[good] / cycle.period - 1.0)
            recurrence.append(np.nanmax(times, initial=0.0))
        numbers = (*np.quantile(drop, (0.5, 0.9, 1.0)), max(recurrence))
        name = "the solver's own" if samples is None else str(samples)
        table.add_row(name, *(f"{x:.1e}" for x in numbers), f"{np.mean(whole):.2f}")
    CONSOLE.print(table)


def with_noise(found, correlation=0.0):
    """Print how far drops, intervals and slip rates are off, over their errors."""
    exact = ("stress_drop", "recurrence", "peak_slip_rate")
    off: dict = {name: [] for name in (*exact, *OWN_TRUTH)}
    missed = extra = 0
    for seed, cycle in enumerate(found):
        rng = np.random.default_rng(seed)
        samples, noise = 10 ** rng.uniform((2.3, -2.7), (3.2, -1.5))
        record = cycle.record(RECORD, samples, noise, rng, correlation)
        events = rs.events(record, K=cycle.slider.K, M=cycle.slider.M)
        status = events.event_status.values
        good = (status == 0) | (status == 4)
        own = rs.events(cycle.run(RECORD))
        expected = own.event_status.values == 0
        missed += max(int(expected.sum() - good.sum()), 0)
        extra += max(int(good.sum() - expected.sum()), 0)
        truth = dict(zip(exact, (cycle.drop, cycle.period, cycle.V_max), strict=True))
        gaps = np.abs(events.event_time.values[:, None] - own.event_time.values[expected])
        same = np.flatnonzero(expected)[gaps.argmin(axis=1)]
        truth |= {name: own[name].values[same] for name in OWN_TRUTH}
        for name, true in truth.items():
            z = ((events[name] - true) / events[f"{name}_error"]).values[good]
            off[name].append(z[np.isfinite(z)])
    table = Table("", "events", "mean error", "its error", "68 %", "95 %")
    for name, parts in off.items():
        z = np.concatenate(parts)
        held = [(np.abs(z) <= norm.ppf(0.5 + 0.5 * p)).mean() for p in (0.6827, 0.95)]
        numbers = f"{z.mean():.3f}", f"{1 / np.sqrt(max(z.size, 1)):.3f}"
        table.add_row(name, str(z.size), *numbers, *(f"{100 * x:.1f} %" for x in held))
    CONSOLE.print(table)
    CONSOLE.print(f"{missed} events missed, {extra} too many")
    return off


def straight_loading():
    """Print how many events are within 4 errors, or reported as doubtful, and the bias of drops."""
    table = Table("second event", "noise", "events", "found", "reported", "4 errors", "drop off by")
    for gap in CLOSE:
        for noise in NOISE:
            rows = [_straight(gap, noise, seed) for seed in range(EACH)]
            (true, found), parts = np.sum([row[0] for row in rows], axis=0), [r[1] for r in rows]
            off, relative, told = np.concatenate(parts).T
            good = ((off < 4.0) | (told > 0.0)).mean()
            numbers = str(true), str(found), str(int(told.sum())), f"{100 * good:.1f} %"
            bias = f"{100 * np.median(relative):.1f} %"
            table.add_row("none" if gap is None else f"{gap} s", str(noise), *numbers, bias)
    CONSOLE.print(table)


def _straight(gap, noise, seed):
    """Numbers of true and found events; of each whole one its error, in those told, and more.

    The largest of the errors of drop and time; the relative error of the drop; whether a message
    reports it.
    """
    rng = np.random.default_rng(seed)
    starts = np.cumsum(100.0 * np.exp(0.1 * rng.normal(size=9)))
    starts = np.sort([*starts, *([] if gap is None else [starts[4] + gap])])
    truth = sawtooth(
        starts, 1e5 * np.exp(0.1 * rng.normal(size=starts.size)), 1.0, rng, noise * 1e5
    )
    events = rs.events(truth.record, K=truth.K)
    rows = []
    for i in np.flatnonzero(events.stress_drop.notnull().values):
        one = events.isel(event=i)
        near = int(np.abs(truth.times - float(one.event_time)).argmin())
        drop, late = one.stress_drop - truth.drops[near], one.event_time - truth.times[near]
        off = max(abs(float(drop / one.stress_drop_error)), abs(float(late / one.event_time_error)))
        told = any(text in str(one.event_message.item()) for text in TOLD)
        rows.append((off, float(drop) / truth.drops[near], told))
    return (starts.size, events.sizes["event"]), np.array(rows, float).reshape(-1, 3)


def main():
    parser = argparse.ArgumentParser(description="Truth of catalogues of stick-slip events.")
    parser.add_argument("number", nargs="?", type=int, default=200, help="sliders")
    options = parser.parse_args()
    found = cycles(options.number)
    without_noise(found)
    CONSOLE.print("white noise of 0.2 to 3 % of the drop, 200 to 1600 samples a period")
    with_noise(found)
    CONSOLE.print("noise with a correlation of 0.6 between neighbouring samples")
    with_noise(found, 0.6)
    CONSOLE.print("straight loading, one sample a second, an event of 1 s in about 100 s")
    straight_loading()


if __name__ == "__main__":
    main()
