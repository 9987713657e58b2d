"""What the page shows, as files: scenario, Python lines, numbers."""

from ...errors import ParameterError
from .budget import bounded
from .picture import study_of

NAMES = {"scenario": "ratestate.toml", "python": "ratestate_run.py", "csv": "ratestate_run.csv"}
# Rows of a table that a browser is still given: some 30 MB.
MOST_ROWS = 200_000


def export(ask, asked, deadline):
    """Name and text of the file that is asked for: "scenario", "python" or "csv"."""
    from .. import scenario

    with bounded(deadline) as watch:
        plan = study_of(asked, watch).plan
        if ask == "csv":
            text = _table(plan, watch)
        else:
            wanted = scenario.Scenario("simulate", plan.slider, plan.settings)
            text = scenario.toml(wanted) if ask == "scenario" else _lines(scenario.python(wanted))
    return {"name": NAMES[ask], "text": text}


def _lines(text):
    """Python lines as a program: it shows what it has computed."""
    return f"{text}print(result)\n"


def _table(plan, watch):
    """The run as CSV; where it ends early, as far as it comes."""
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
