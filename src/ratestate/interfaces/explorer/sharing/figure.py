"""A figure of what the page shows, for a paper: stress, speed, phase plane, and the map."""

import contextlib
import io
import itertools
import threading
from importlib.metadata import version
from typing import Any
from urllib.parse import urlencode

import matplotlib as mpl
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.transforms import offset_copy

from ....dynamics.results import normal_stress
from ....errors import ParameterError
from ....plot.atlas import atlas
from ....plot.labels import BLUE, GRAY, LAWS, label, prefixed, value_text, with_unit
from ....plot.layout import ABOVE, dress, letters
from ....plot.motion import trace
from ....plot.pages.panels import NARROW, plane, speed
from ....plot.prose import mathematics, wrapped
from ....plot.runs import NamedRun, named_runs, since
from ..computation import charts
from ..computation.decimation import decimated
from ..computation.picture import run_of, study_of
from ..page_state.entries import SYMBOLS, entries_of
from ..page_state.protocol import text_of

#: width, height, and what a run kept adds to it [inches]; of text, and of letters in it [points]
WIDTH, HEIGHT, ROW, LINE, LETTER = 7.2, 5.2, 0.2, 505.0, 8.0
#: height below axes that their ticks and label take [points], and what a legend there looks like
FOOT, LEGEND = 25.0, {"fontsize": 7.5, "frameon": False}
#: what the map shows
MAP = rf"regimes, contours of {label('V_max')}/{label('V_lp')}"
#: twice the pixels that a page in a browser gives an inch
DPI = 2 * 96
#: colours of the runs kept for comparison, which are behind the run shown: those of the page
MUTED = ("#7a3fb5", "#0e7c66", "#a85b00")
#: settings that no call of matplotlib takes: text that stays text, and fonts that are inside
WRITING: Any = {"pdf.fonttype": 42, "svg.fonttype": "path", "svg.hashsalt": "ratestate"}
# One figure at a time: matplotlib's reader of mathematics and its settings are shared by threads.
_DRAWING = threading.Lock()


def figure_file(form, state, pinned, deadline):
    """A figure as bytes; form: "svg", "pdf" or "png"; it raises as `figure_of` does."""
    with _DRAWING:
        fig = figure_of(state, pinned, deadline)
        with _writing():
            return _written(fig, form, state)


def figure_of(state, pinned, deadline):
    """The Figure of a `PageState`, with the runs of others behind it.

    ParameterError where there is no run to draw; `TimeUp` past the deadline, backend.Stopped if it
    was cancelled.
    """
    study, run, notes = _motion(state, deadline)
    others = [_motion(other, deadline)[1] for other in pinned]
    chart = _chart(state.slider, deadline)
    size = WIDTH, HEIGHT + ROW * len(pinned)
    fig = Figure(figsize=size, layout=ConstrainedLayoutEngine(w_pad=0.06, h_pad=0.05))
    fig.suptitle(_caption(study, state, notes), x=0.01, ha="left", fontsize=LETTER)
    left, right = fig.subfigures(1, 2, squeeze=False, width_ratios=[1.4, 1])[0]
    stresses, speeds = left.subplots(2, 1, sharex=True)
    phase, *maps = right.subplots(1 if chart is None else 2, 1, squeeze=False)[:, 0]
    kept = _kept(run, others)
    _stress(stresses, run, kept)
    _speed(speeds, run, kept)
    _plane(phase, run, study, kept)
    for ax in maps:
        _map(ax, chart, state, study.verdict)
    letters([stresses, speeds, phase, *maps], "stress", "speed", "phase plane", MAP)
    if kept:
        names = ["the run shown", *(one.name for one in kept)]
        handles = [stresses.lines[0], *stresses.lines[-len(kept) :]]
        fig.legend(handles, names, loc="outside lower left", **LEGEND)
    dress(fig)
    return fig


def _motion(state, deadline):
    """The `Study` of a state, its run with time 0 at the step, and notes on what is not shown."""
    study = study_of(state, deadline)
    run, notes = run_of(study.plan, deadline)
    if run is None:
        raise ParameterError(" ".join(notes))
    stress = (run.tau / normal_stress(run)).values
    run = run.isel(time=decimated(stress, run.V.values))
    return study, since(run, study.plan.changes[0]), study.notes + notes


def _kept(run, others):
    """`NamedRun` of each run kept, named by what tells it apart, up to the end of the run shown."""
    _, *named = named_runs([run, *others])
    ends = [one.run.isel(time=one.run.time.values <= run.time.values[-1]) for one in named]
    looks = itertools.cycle(MUTED)
    return [
        NamedRun(end, one.name, {"color": color, "lw": 0.9, "zorder": 1.5})
        for end, one, color in zip(ends, named, looks, strict=False)
    ]


def _stress(ax, run, kept):
    trace(run, ax)
    ax.set_xlabel("")  # it is that of the speeds, below
    ax.legend(ncols=2, **ABOVE)
    factor, _ = prefixed("s", float(abs(run.time).max()))
    for one, _, line in kept:
        ax.plot(factor * one.time, one.tau / normal_stress(one), **line)


def _speed(ax, run, kept):
    runs = [NamedRun(run, "slip", {"color": BLUE}), *(one._replace(name="_") for one in kept)]
    speed(runs, ax)
    ax.legend(ncols=2, **ABOVE)


def _plane(ax, run, study, kept):
    runs = [one._replace(name="_") for one in kept]
    runs.append(NamedRun(run, "run", {"color": GRAY, "lw": 0.6}))
    if study.verdict.period:
        runs.append(NamedRun(study.orbit, "limit cycle", {"color": BLUE, "lw": 1.4}))
    plane(runs, ax, named=True)
    ax.legend(**_below(ax))


def _chart(slider, deadline):
    """The atlas behind the map; None where there is none in time."""
    size = charts.size_in_time(slider, deadline)
    return size and charts.survey(*charts.key_of(slider), size)


def _map(ax, chart, state, verdict):
    """The regimes with the slider as a point, hollow at the edge where it is beyond the map."""
    handles = atlas(chart, ax)
    ends = ax.get_xlim(), ax.get_ylim()
    at = state.slider.K / verdict.K_c_qs, verdict.eta
    inside = [min(max(x, low), high) for x, (low, high) in zip(at, ends, strict=True)]
    beyond = tuple(inside) != at
    name = "this slider, beyond the map" if beyond else "this slider"
    look = {"mfc": "w" if beyond else "k", "mec": "k", "ms": 5, "ls": "", "zorder": 6}
    handles += ax.plot(*inside, "o", label=name, clip_on=False, **look)
    names = [str(one.get_label()).replace(" (", "\n(").replace(", ", ",\n") for one in handles]
    ax.legend(handles, names, **_below(ax))


def _below(ax):
    """Where a legend goes that is below its axes and their label."""
    foot = offset_copy(ax.transAxes, ax.get_figure(root=True), y=-FOOT, units="points")
    at = {"loc": "upper center", "bbox_to_anchor": (0.5, 0.0), "bbox_transform": foot, "ncols": 2}
    return LEGEND | NARROW | at | {"columnspacing": 1.2}


def _caption(study, state, notes):
    """The verdict; what the slider is; and what is not shown."""
    headline = mathematics(study.verdict.sentences[0]).split(" ")
    values, before = state.values, state.before
    parts, own = [LAWS[state.slider.law].name], state.slider.friction_law.parameters
    when = "in the end" if state.protocol else "since time 0"
    for symbol in dict.fromkeys((*SYMBOLS, *own)):
        text = value_text(symbol, values[symbol])
        if before and before.values[symbol] != values[symbol]:
            text = f"{text} {when} ({with_unit(symbol, before.values[symbol])} before)"
        parts.append(text)
    if state.kick:
        parts.append(rf"$V$ times {state.kick:.4g} at time 0")
    if state.protocol:
        first, *others = mathematics(text_of(state.protocol)).split("; ")
        parts += [f"from time 0: {first}", *others]
    lines = [wrapped(headline, LINE, LETTER), wrapped(parts, LINE, LETTER, ", ")]
    lines += [wrapped(mathematics(note).split(" "), LINE, LETTER) for note in notes]
    return "\n".join(lines)


@contextlib.contextmanager
def _writing():
    """The settings of `WRITING`, and none of the others, which a user may change meanwhile."""
    before: Any = {name: mpl.rcParams[name] for name in WRITING}
    mpl.rcParams.update(WRITING)
    try:
        yield
    finally:
        mpl.rcParams.update(before)


def _written(fig, form, state):
    """A figure as bytes, with what it is of; the same ones each time."""
    what = urlencode(entries_of(state))
    made = f"ratestate {version('ratestate')}"
    metadata = {
        "svg": {"Title": "ratestate", "Description": what, "Creator": made, "Date": None},
        "pdf": {"Title": "ratestate", "Subject": what, "Creator": made, "CreationDate": None},
        "png": {"Title": "ratestate", "Description": what, "Software": made},
    }
    into = io.BytesIO()
    fig.savefig(into, format=form, dpi=DPI, metadata=metadata[form])
    return into.getvalue()
