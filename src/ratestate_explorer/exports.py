"""Files to take along: scenario, Python lines, numbers, a figure; and the page itself."""

import ratestate as rs

from .entries import BadEntries, state_of
from .picture import study_of
from .wire import FILES

FIGURES = ("svg", "pdf", "png")
# Largest table to download: some 30 MB.
MOST_ROWS = 200_000


def export(question, deadline):
    """Return name, type and content (bytes) of a file, a dict; the question names one of `FILES`.

    ParameterError for more than `MOST_ROWS`, and where a figure has no run; `TimeUp` past the
    deadline, `Stopped` if cancelled.
    """
    kind, state = question.ask, state_of(question.entries)
    try:
        pinned = [state_of(entries) for entries in question.pinned]
    except BadEntries as error:
        raise rs.ParameterError(f"a run kept for comparison: {error}") from None
    if kind == "page":
        from .standalone import standalone

        content = standalone(question.entries, question.pinned, deadline).encode()
    elif kind in FIGURES:
        from .figure import figure_file  # which is slow to import

        content = figure_file(kind, state, pinned, deadline)
    else:
        content = _text(kind, state, deadline).encode()
    name, of_type = FILES[kind]
    return {"name": name, "type": of_type, "content": content}


def _text(kind, state, deadline):
    plan = study_of(state, deadline).plan
    exported = rs.scenario.Scenario("simulate", plan.slider, plan.settings)
    if kind == "scenario":
        return rs.scenario.toml(exported)
    if kind == "python":
        return f"{rs.scenario.python(exported)}print(result)\n"
    try:
        with deadline.part():
            run = plan.run()
    except rs.SolverError as error:
        run = error.best  # up to where it fails
    if run.sizes["time"] > MOST_ROWS:
        raise rs.ParameterError(
            f"the run has {run.sizes['time']} rows, more than the {MOST_ROWS} of a download. The "
            f"Python lines write it in full."
        )
    return rs.files.csv_text(run)
