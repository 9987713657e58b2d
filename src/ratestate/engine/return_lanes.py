"""Loops over the lanes of a return map: the state's step by either method, with perturbations."""

import functools

from ..friction.functions import larger, smaller, where
from ..friction.tuples import (
    dot,
    dot_onto,
    grouped,
    largest,
    minus_dot,
    pairwise_sum,
    plus,
    product,
    select,
    size_of,
    times,
    total,
)
from . import lanes as L
from . import rows as R
from .equations import inertial_force
from .rows import load_each, read_rows, rows_of, store_each, write_rows
from .tangent import step as tangent_step
from .taylor import ORDER, integrals, longest, powers, size, variational_coefficients
from .taylor_lanes import last_sizes, momentum_of, record, step_lengths


def changes_of_speed(z, shares):
    """The change of omega (`kinematics`) by each of the perturbations z."""
    return tuple(dot_onto(one[1], shares, one[2:]) for one in z)


def step_of_lane(s, l, law, h):
    """What `tangent.step` gives for a step of size h from where the lane is."""
    rows = rows_of(law)
    y, e, z = read_rows(s, rows.y, l), read_rows(s, rows.e, l), load_each(s, rows.z, l)
    return tangent_step(y, s[R.W + l], e, z, 1.0, h, L.system_of(s, l, law))


def try_step(s, l, law):
    """Try one step of the lane by Rodas5P, perturbations included, and record its outcome."""
    h = s[R.H + l]
    new, z_new, error, dense, s[R.D_TRACE + l] = step_of_lane(s, l, law, h)
    store_each(s, rows_of(law).z_new, l, z_new)
    L.record(s, l, law, h, new, error, dense)


def try_taylor_step(s, l, law):
    """Take one step of the lane by the Taylor method, perturbations included."""
    rows, system = rows_of(law), L.system_of(s, l, law)
    y, e, w = read_rows(s, rows.y, l), read_rows(s, rows.e, l), s[R.W + l]
    z = load_each(s, rows.z, l)
    c, c_z, trace = variational_coefficients(law, y, w, e, z, *system[1:])
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
    record(s, l, law, h, h_powers, c, lengths, total(z_new) + mean_trace)


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

    ================  ===================================================
    f_x, f_v, f_psi   speed of the state, d/dT
    pace              the largest of these
    direction         the speeds over pace
    ================  ===================================================
    """
    ok = s[R.OK + l] > 0.0
    rows, system = rows_of(law), L.system_of(s, l, law)
    y, w, e = read_rows(s, rows.y, l), s[R.W + l], read_rows(s, rows.e, l)
    f_x = system[1] * (1.0 - w)
    f_psi = law.rates_in_v(y[1], w, y[2:], e, system[3])
    g, S_v, S_psi = inertial_force(y, w, e, law, system[3])
    rounding = L.ROUNDING_OF_FORCE * (abs(y[0]) + abs(S_v * y[1]) + size_of(S_psi, y[2:]))
    c = law.speed_slope(w, e)
    m = s[R.ETA0 + l] * c
    lost = (abs(g) <= rounding) | (m == 0.0)
    f_omega = where(lost, (f_x - dot(S_psi, f_psi)) / S_v, g / m)
    f_v = minus_dot(f_omega, law.shares(w, 1.0 / c, system[3]), f_psi)
    pace = larger(larger(abs(f_x), abs(f_v)), larger(largest(f_psi), 1e-300))
    direction = (f_x / pace, f_v / pace, *times(1.0 / pace, f_psi))
    share = 1.0 / dot(direction, direction)
    z, z_new = load_each(s, rows.z, l), load_each(s, rows.z_new, l)
    shifts = tuple(share * dot(one, direction) for one in z_new)
    for of_one, one, new, along in zip(rows.z, z, z_new, shifts, strict=True):
        write_rows(s, of_one, l, select(ok, plus(new, times(-along, direction)), one))
    early = read_rows(s, rows.early, l)
    write_rows(s, rows.early, l, select(ok, plus(early, times(1.0 / pace, shifts)), early))
    s[R.TRACE + l] += where(ok, s[R.D_TRACE + l], 0.0)
    s[R.SINCE + l] += s[R.OK + l]
