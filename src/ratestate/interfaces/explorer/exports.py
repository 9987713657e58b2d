"""Downloads of the run that the page shows: scenario, Python lines, numbers."""

from ...errors import ParameterError
from ...files import csv_text
from .. import scenario
from .picture import study_of

NAMES = {"scenario": "ratestate.toml", "python": "ratestate_run.py", "csv": "ratestate_run.csv"}
# Largest table to download: some 30 MB.
MOST_ROWS = 200_000


def export(kind, state, deadline):
    """dict, name and text of a file; kind: "scenario", "python" or "csv".

    ParameterError for more than `MOST_ROWS`, `TimeUp` past the deadline, backend.Stopped if
    cancelled.
    """
    plan = study_of(state, deadline).plan
    exported = scenario.Scenario("simulate", plan.slider, plan.settings)
    if kind == "csv":
        call = plan.call()
        with deadline.part():  # up to the run's end, or to where it fails
            motion = call.move(deadline)
            if motion.t.size > MOST_ROWS:
                raise ParameterError(
                    f"the run has {motion.t.size} rows, more than the {MOST_ROWS} of a download; "
                    f"the Python lines write it in full"
                )
            text = csv_text(call.dataset(call.variables(motion)))
    elif kind == "scenario":
        text = scenario.toml(exported)
    else:
        text = f"{scenario.python(exported)}print(result)\n"
    return {"name": NAMES[kind], "text": text}
