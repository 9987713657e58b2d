"""Downloads of the run that the page shows: scenario, Python lines, numbers."""

from ...errors import ParameterError
from .budget import bounded
from .picture import study_of

NAMES = {"scenario": "ratestate.toml", "python": "ratestate_run.py", "csv": "ratestate_run.csv"}
# Largest table to download: some 30 MB.
MOST_ROWS = 200_000


def export(kind, state, deadline):
    """Name and text of a file; kind: "scenario", "python" or "csv"."""
    from .. import scenario

    with bounded(deadline) as watch:
        plan = study_of(state, watch).plan
        if kind == "csv":
            text = _table(plan, watch)
        else:
            exported = scenario.Scenario("simulate", plan.slider, plan.settings)
            text = (
                scenario.toml(exported)
                if kind == "scenario"
                else _program(scenario.python(exported))
            )
    return {"name": NAMES[kind], "text": text}


def _program(text):
    """Python lines as a program that prints its result."""
    return f"{text}print(result)\n"


def _table(plan, watch):
    """The run as CSV, up to its end or to where it fails."""
    from ...files import csv_text

    call = plan.call()
    watch.deadline.start()
    motion = call.move(watch)
    if motion.t.size > MOST_ROWS:
        raise ParameterError(
            f"the run has {motion.t.size} rows, more than the {MOST_ROWS} of a download; the "
            f"Python lines write it in full"
        )
    return csv_text(call.dataset(call.variables(motion)))
