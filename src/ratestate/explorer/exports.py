"""What the page shows, as files: scenario, Python lines, numbers."""

from .budget import bounded
from .picture import study_of

NAMES = {"scenario": "ratestate.toml", "python": "ratestate_run.py", "csv": "ratestate_run.csv"}


def export(ask, asked, deadline):
    """Name and text of the file that is asked for: "scenario", "python" or "csv"."""
    from .. import scenario
    from ..files import csv_text

    with bounded(deadline) as watch:
        plan = study_of(asked, watch).plan
        wanted = scenario.Scenario("simulate", plan.slider, plan.settings)
        if ask == "csv":
            watch.deadline.start()
            text = csv_text(plan.call().result(watch))
        else:
            text = scenario.toml(wanted) if ask == "scenario" else scenario.python(wanted)
    return {"name": NAMES[ask], "text": text}
