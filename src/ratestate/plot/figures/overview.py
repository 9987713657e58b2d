"""The function `overview`: a run with its limit cycle, other runs, and its place on the atlas."""

import itertools

from matplotlib.transforms import offset_copy

from ...dynamics.results import normal_stress
from ..labels import BLUE, GRAY, label, mathematics, prefixed
from ..layout import ABOVE, apply_style, blank_figure, letters, wrapped
from ..maps import atlas
from ..motion import trace
from ..runs import NARROW, NamedRun, named_runs, plane, speed

#: height, and height for each further run [inches]; width of text, size of letters [points]
HEIGHT, ROW, LINE, LETTER = 5.2, 0.2, 505.0, 8.0
#: height of ticks and label below axes [points], and the look of a legend there
FOOT, LEGEND = 25.0, {"fontsize": 7.5, "frameon": False}
#: title of the map
MAP = rf"regimes, contours of {label('V_max')}/{label('V_lp')}"
#: colours of other runs, which are behind the run
MUTED = ("#7a3fb5", "#0e7c66", "#a85b00")


def overview(run, verdict, *, orbit=None, others=(), chart=None, caption=()):
    """Draw a run, its limit cycle and its place on the map of regimes.

    The function changes no settings of matplotlib, so that other threads may draw meanwhile.

    Parameters
    ----------
    run : xarray.Dataset
        Run of one slider, from `simulate`; anything else raises ParameterError.
    verdict : ratestate.Verdict
        Verdict on the slider at its last load-point velocity.
    orbit : xarray.Dataset, optional
        From `ratestate.orbit`, for the phase plane.
    others : list of xarray.Dataset
        Up to 3 runs of `simulate` (more share colours), drawn behind the run up to its end.
    chart : xarray.Dataset, optional
        From `ratestate.atlas`, for b/a of the slider.
    caption : list of list of str
        Paragraphs above the panels.  Each is a list of texts, between which a line may end.
        Symbols and powers of ten in them are written as mathematics.

    Returns
    -------
    matplotlib.figure.Figure
        Stress, speed, phase plane and, with a chart, the map.
    """
    lines = [wrapped([mathematics(text) for text in texts], LINE, LETTER) for texts in caption]
    fig = blank_figure(HEIGHT + ROW * len(others), "\n".join(lines))
    left, right = fig.subfigures(1, 2, squeeze=False, width_ratios=[1.4, 1])[0]
    stresses, speeds = left.subplots(2, 1, sharex=True)
    phase, *maps = right.subplots(1 if chart is None else 2, 1, squeeze=False)[:, 0]
    other_runs = _other_runs(run, others)
    unnamed = [other._replace(name="_") for other in other_runs]
    _stress(stresses, run, other_runs)
    speed([NamedRun(run, "slip", {"color": BLUE}), *unnamed], speeds)
    speeds.legend(ncols=2, **ABOVE)
    cycle = [] if orbit is None else [NamedRun(orbit, "limit cycle", {"color": BLUE, "lw": 1.4})]
    runs = [*unnamed, NamedRun(run, "run", {"color": GRAY, "lw": 0.6}), *cycle]
    plane(runs, phase, named=True)
    phase.legend(**_settings_below(phase))
    for ax in maps:
        _map(ax, chart, verdict)
    letters([stresses, speeds, phase, *maps], "stress", "speed", "phase plane", MAP)
    if other_runs:
        names = ["the run shown", *(other.name for other in other_runs)]
        handles = [stresses.lines[0], *stresses.lines[-len(other_runs) :]]
        fig.legend(handles, names, loc="outside lower left", **LEGEND)
    apply_style(fig)
    return fig


def _other_runs(run, others):
    """`NamedRun` of each other run, named by what differs, up to the end of the run."""
    _, *named = named_runs([run, *others])
    ends = [other.run.isel(time=other.run.time.values <= run.time.values[-1]) for other in named]
    looks = itertools.cycle(MUTED)
    return [
        NamedRun(end, other.name, {"color": color, "lw": 0.9, "zorder": 1.5})
        for end, other, color in zip(ends, named, looks, strict=False)
    ]


def _stress(ax, run, other_runs):
    trace(run, ax)
    ax.set_xlabel("")  # the axis of the speeds, below, has it
    ax.legend(ncols=2, **ABOVE)
    factor, _ = prefixed("s", float(abs(run.time).max()))
    for other, _, line in other_runs:
        ax.plot(factor * other.time, other.tau / normal_stress(other), **line)


def _map(ax, chart, verdict):
    """Draw the regimes with the slider as a point, hollow at the edge if it is beyond the map."""
    handles_ = atlas(chart, ax)
    ends = ax.get_xlim(), ax.get_ylim()
    at = verdict.slider.K / verdict.K_c_qs, verdict.eta
    inside = [min(max(x, low), high) for x, (low, high) in zip(at, ends, strict=True)]
    beyond = tuple(inside) != at
    name = "this slider, beyond the map" if beyond else "this slider"
    look = {"mfc": "w" if beyond else "k", "mec": "k", "ms": 5, "ls": "", "zorder": 6}
    handles_ += ax.plot(*inside, "o", label=name, clip_on=False, **look)
    names = [str(line.get_label()).replace(" (", "\n(").replace(", ", ",\n") for line in handles_]
    ax.legend(handles_, names, **_settings_below(ax))


def _settings_below(ax):
    """Return settings of a legend below axes and their label."""
    foot = offset_copy(ax.transAxes, ax.get_figure(root=True), y=-FOOT, units="points")
    at = {"loc": "upper center", "bbox_to_anchor": (0.5, 0.0), "bbox_transform": foot, "ncols": 2}
    return LEGEND | NARROW | at | {"columnspacing": 1.2}
