"""The equations of motion under a law as recurrences of Taylor coefficients (series.py)."""

import functools

from .series import Graph, NotASeries, code

#: order of the Taylor method: degree of its polynomials in time
ORDER = 12


@functools.cache
def source(law):
    """The body of `coefficients` under a law; NotASeries where it has no recurrences."""
    graph = Graph()
    unknowns = [graph.unknown(f"y[{i}]") for i in range(2 + len(law.states))]
    try:
        derivatives, integrands = equations(law, graph, unknowns)
    except Exception as error:  # (where it gets no numbers, a law of a user may raise anything)
        raise NotASeries(f"the law {law.name}") from error
    lines, of_y, of_works = code(
        graph, dict(zip(unknowns, derivatives, strict=True)), integrands, ORDER
    )
    tuples = [", ".join(f"({', '.join(names)})" for names in group) for group in (of_y, of_works)]
    return [*lines, f"return ({tuples[0]}), ({tuples[1]})"]


def equations(law, graph, unknowns):
    """Derivatives in T of x, v and each psi, and the powers of `works`: `Series`."""
    x, v, psi = unknowns[0], unknowns[1], tuple(unknowns[2:])
    p = tuple(graph.name(f"p[{i}]") for i in range(law.n_coefficients))
    w, w_lp = graph.exp(v, "w"), graph.line("w_lp", "ramp")
    response = graph.exp(-v, "1.0 / (eta0 * w)")  # of dv/dT to the inertial force
    if law.reverses or law.history(p):
        raise NotASeries("slip that may reverse, or normal stress that varies")
    exponents = law.own_exponents(v, w, psi, (), p)
    e = tuple(graph.exp(graph.series(one), f"e[{i}]") for i, one in enumerate(exponents))
    stress = law.stress_in_v(v, w, psi, p)
    rates = law.rates_in_v(v, w, psi, e, p)
    derivatives = [graph.name("kappa") * (w_lp - w), (x - stress) * response, *rates]
    return list(map(graph.series, derivatives)), [x * w_lp, stress * w]


def has_recurrences(law):
    """Whether all that a law's equations hold has a rule."""
    try:
        source(law)
    except NotASeries:
        return False
    return True
