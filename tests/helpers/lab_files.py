"""The record of a laboratory as a file of text: a step from 1 to 10 um/s at 15 s."""

import numpy as np

N = 120
#: time [s], displacement [um], friction and normal stress [MPa] of 120 rows
T = np.arange(N) * 0.25
X = np.where(T < 15, T, 10 * T - 135)
MU = 0.6 + 0.003 * np.sin(T) + 0.0001 * T
SIGMA = np.full(N, 20.0)
HEADER = "Time(s)", "Displ(microns)", "Friction", "Normal_stress(MPa)"


def cells(columns, number=repr):
    """Rows of texts."""
    return [[number(float(x)) for x in row] for row in zip(*columns, strict=True)]


def write_rows(path, rows, header=HEADER, delimiter="\t", above=(), end="\n", encoding="utf-8"):
    """Write rows of texts below a header, and lines above it; return the path."""
    lines = [*above, *([delimiter.join(header)] if header else []), *map(delimiter.join, rows)]
    path.write_bytes((end.join(lines) + end).encode(encoding))
    return path


def write(path, columns, header=HEADER, number=repr, **how):
    """Write columns, as `write_rows` does; a dict has their titles."""
    if isinstance(columns, dict):
        header, columns = [*columns], columns.values()
    return write_rows(path, cells(columns, number), header, **how)


def check(data, rows=slice(None), friction=MU):
    """These rows of the record came through, in SI and to rounding."""
    np.testing.assert_array_equal(data.time, T[rows])
    np.testing.assert_allclose(data.delta_lp, 1e-6 * X[rows], rtol=3e-16)
    np.testing.assert_array_equal(data.friction, friction[rows])


def record_columns(data, **more):
    """Title -> values, as laboratories have them, of a record in SI; `more` has other columns."""
    columns = {"Time(s)": data.time, "Displ(microns)": 1e6 * data.delta_lp}
    columns |= {"Friction": data.friction} if "friction" in data else {}
    return {title: np.asarray(values) for title, values in (columns | more).items()}
