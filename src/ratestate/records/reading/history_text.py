"""The steps and holds of a record as a line of text."""

import numpy as np

from ...model.quantities import PREFIXES, power_of, readable


def describe_history(segments, t, displacement=None):
    """Steps and holds, such as "velocity step 3.00 -> 10.0 um/s at 11676.4 s (8710 um)".

    t, displacement : of the record's rows [s], [m] (optional)
    """
    if segments.V.size == 1:
        V = segments.V[0]
        return f"no step: {'a hold' if V == 0.0 else f'steady at {_speed(V)}'} throughout"
    ends = np.append(segments.t[1:], t[-1])
    texts = []
    for i, (start, V) in enumerate(zip(segments.t, segments.V, strict=True)):
        at = f"{start:.1f} s" if abs(start) >= 100.0 else f"{start:.4g} s"
        moved = "" if displacement is None else _displacement(np.interp(start, t, displacement))
        before = segments.V[i - 1] if i else None
        if V == 0.0:
            since = f"{at}{moved if i else ''}"
            texts.append(f"hold of {readable('t', ends[i] - start, 4)} from {since}")
        elif before == 0.0:
            texts.append(f"slide at {_speed(V)} from {at}")
        elif before is not None:
            texts.append(f"velocity step {_speeds(before, V)} at {at}{moved}")
    return "; ".join(texts)


def _speed(V):
    return readable("V_lp", V, 3)


def _speeds(before, V):
    """Two speeds, in one unit if they are not too far apart."""
    if max(before, V) >= 100.0 * min(before, V):
        return f"{_speed(before)} -> {_speed(V)}"
    power = power_of("m/s", max(before, V))
    one, other = (f"{x / 10.0**power:#.3g}".rstrip(".") for x in (before, V))
    return f"{one} -> {other} {PREFIXES[power]}m/s"


def _displacement(x):
    """A displacement in brackets."""
    return f" ({x * 1e6:.0f} um)" if abs(x) < 0.1 else f" ({x * 1e3:.3f} mm)"
