"""Lanes of a return map under a law with recurrences: steps of the Taylor method, of both kinds."""

import functools

from ..friction.functions import larger, smaller, where
from ..friction.tuples import grouped, pairwise_sum, product, total
from . import lanes as L
from . import rows as R
from .rows import load_each, read_rows, rows_of, store_each
from .taylor import ORDER, integrals, longest, powers, size, variational_coefficients
from .taylor_lanes import last_sizes, momentum_of, record, step_lengths


def try_step(s, l, law):
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
