"""Lanes of a return map under a law with recurrences: steps of the Taylor method, of both kinds."""

from . import lanes as L
from . import return_lanes
from . import rows as R
from .jit import inlined, inner, lanewise, recursive
from .recurrences import ORDER
from .rows import OF_RODAS5P, rows_of
from .taylor import integrals, longest, powers, size, variational_coefficients
from .taylor_lanes import find_calms, last_sizes, momentum_of, record, step_lengths
from .tuples import (
    grouped,
    load_each,
    of_each,
    pairwise_sums,
    product_each,
    read_rows,
    store_each,
    total,
)


@inlined
def try_step(s, l, law):
    """Take one step of the lane by the Taylor method, perturbations included."""
    rows, system = rows_of(law), L.system_of(s, l, law)
    y, e, w = read_rows(s, rows.y, l), read_rows(s, rows.e, l), s[R.W + l]
    z = load_each(s, rows.z, l)
    c, c_z, trace = variational_coefficients(law, y, w, e, z, *system[1:])
    momentum = momentum_of(s, l)
    lengths = step_lengths(s, l, last_sizes(c, momentum))
    last, before = grouped(of_each(c_z, ORDER), y), grouped(of_each(c_z, ORDER - 1), y)
    by_z = longest(*sizes_of_each(z, last, before, momentum), s[R.TOLERANCE + l])
    h = min(min(lengths[0], lengths[1]), by_z)
    landing = s[R.LANDING_STEP + l]
    h = landing if (landing > 0.0) & (landing < h) else h
    h_powers = powers(h)
    dense = product_each(c_z, h_powers)
    store_each(s, rows.c_z, l, dense)
    z_new = pairwise_sums(dense)
    store_each(s, rows.z_new, l, grouped(z_new, y))
    (mean_trace,) = integrals((trace,), h_powers)
    s[R.D_TRACE + l] = h * mean_trace
    record(s, l, law, h, h_powers, c, lengths, total(z_new) + mean_trace)


@recursive
def sizes_of_each(z, last, before, momentum):
    """The largest `last_sizes` of a perturbation, over its own.

    last, before : of each perturbation the last coefficients
    """
    whole = size(z[0], momentum)
    here = size(last[0], momentum) / whole, size(before[0], momentum) / whole
    if len(z) == 1:
        return here
    others = sizes_of_each(z[1:], last[1:], before[1:], momentum)
    return max(here[0], others[0]), max(here[1], others[1])


@lanewise
def advance_by_taylor(s, law, n):
    """Take a step by the Taylor method in the first n vectors of lanes."""
    for l in range(R.WIDTH * n):
        try_step(s, l, law)
    L.find_events(s, law, n)


@inner
def advance(rows, s, law, n, taylor):
    """As `taylor_lanes.advance`."""
    if len(rows) == OF_RODAS5P:
        return_lanes.advance(s, law, n)
    elif taylor:
        advance_by_taylor(s, law, n)
    else:
        return_lanes.advance(s, law, n)
        find_calms(s, law, n)
