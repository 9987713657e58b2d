"""Loops over the lanes of a return map: the state's step by either method, with perturbations."""

import functools

from ..friction.functions import larger, smaller, where
from ..friction.tuples import (
    dot,
    grouped,
    largest,
    pairwise_sum,
    plus,
    product,
    select,
    times,
    total,
)
from . import lanes as L
from . import rows as R
from .rows import load_each, read_rows, rows_of, store_each, write_rows
from .tangent import step as tangent_step
from .taylor import ORDER, integrals, longest, powers, size, variational_coefficients
from .taylor_lanes import last_sizes, momentum_of, record, step_lengths


def step_of_lane(s, l, law, h):
    """What `tangent.step` gives for a step of size h from where the lane is."""
    return tangent_step(L.read_point(s, l, law), load_each(s, rows_of(law).z, l), h)


def try_step(s, l, law):
    """Try one step of the lane by Rodas5P, perturbations included, and record its outcome."""
    h = s[R.H + l]
    new, z_new, error, dense, s[R.D_TRACE + l] = step_of_lane(s, l, law, h)
    store_each(s, rows_of(law).z_new, l, z_new)
    L.record(s, l, h, new, error, dense)


def try_taylor_step(s, l, law):
    """Take one step of the lane by the Taylor method, perturbations included."""
    rows, start = rows_of(law), L.read_point(s, l, law)
    y, z = start.y, load_each(s, rows.z, l)
    c, c_z, trace = variational_coefficients(start, z)
    momentum = momentum_of(s, l)
    lengths = step_lengths(s, l, last_sizes(c, momentum))
    last, before = (grouped([one[k] for one in c_z], y) for k in (ORDER, ORDER - 1))
    of_last, of_before = sizes_of_each(z, last, before, momentum)
    by_z = longest(of_last, of_before, s[R.TOLERANCE + l])
    h = smaller(smaller(lengths[0], lengths[1]), by_z)
    landing = s[R.LANDING_STEP + l]
    h = where((landing > 0.0) & (landing < h), landing, h)
    h_powers = powers(h)
    dense = tuple(product(one, h_powers) for one in c_z)
    store_each(s, rows.c_z, l, dense)
    z_new = tuple(map(pairwise_sum, dense))
    store_each(s, rows.z_new, l, grouped(z_new, y))
    (mean_trace,) = integrals((trace,), h_powers)
    s[R.D_TRACE + l] = h * mean_trace
    record(s, l, start, h, h_powers, c, lengths, total(z_new) + mean_trace)


def sizes_of_each(z, last, before, momentum):
    """The largest `last_sizes` of a perturbation, over its own.

    last, before : of each perturbation the last coefficients
    """
    sizes = []
    for one, of_last, of_before in zip(z, last, before, strict=True):
        whole = size(one, momentum)
        sizes.append((size(of_last, momentum) / whole, size(of_before, momentum) / whole))
    return functools.reduce(lambda a, b: (larger(a[0], b[0]), larger(a[1], b[1])), sizes)


def commit_lane(s, l, law):
    """`lanes.commit_lane` for what a return map adds, once that is done.

    A perturbation along the orbit is a shift in time.  It grows and shrinks with the speed of the
    state, by twenty orders of magnitude in a stick-slip cycle, and would take all digits of the
    rest: it is taken out after each step.
    """
    rows, ok, at = rows_of(law), s[R.OK + l] > 0.0, L.read_point(s, l, law)
    by, unit = at.acceleration(1.0, at.is_balanced)
    speeds = at.in_v((at.of_x(1.0), by / unit, *at.f))
    pace = larger(largest(speeds), 1e-300)
    direction = times(1.0 / pace, speeds)
    share = 1.0 / dot(direction, direction)
    z, z_new = load_each(s, rows.z, l), load_each(s, rows.z_new, l)
    shifts = tuple(share * dot(one, direction) for one in z_new)
    for of_one, one, new, along in zip(rows.z, z, z_new, shifts, strict=True):
        write_rows(s, of_one, l, select(ok, plus(new, times(-along, direction)), one))
    early = read_rows(s, rows.early, l)
    write_rows(s, rows.early, l, select(ok, plus(early, times(1.0 / pace, shifts)), early))
    s[R.TRACE + l] += where(ok, s[R.D_TRACE + l], 0.0)
    s[R.SINCE + l] += s[R.OK + l]
