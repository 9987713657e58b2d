"""Friction laws, and the stability of steady sliding.

==================== ============================================================================
``law_formula``      what a friction law states: names, parameters, a formula
``law``              what follows from the formula: kind of law, steady sliding
``built_in_laws``    the built-in laws of friction
``laws``             laws by their names
``forms``            forms of friction beside that of eq. 1
``user_law``         laws from a user's file or class: named with a hash, and checked
``formulas``         friction and state in SI (eqs 1 to 3), for users
``equations``        a formula run once: rates and friction as expressions
``expressions``      graphs of expressions
``rewriting``        derivatives, coefficients and Python functions from expressions
``taylor``           Taylor coefficients of expressions
``functions``        what exp, log and others mean to numbers of any kind; their derivatives
``tuples``           arithmetic on tuples of these numbers
``motion``           the equations of motion and their derivatives, as expressions
``point``            their values at a point, and how fast a slider slips there
``composition``      combine a law with a form of friction, damping and varying normal stress
``steady_state``     steady sliding by root finding
``linear_stability`` stability of steady sliding under any law, and its response
``critical_speeds``  speeds at which stability changes
``stability``        stability in closed form, laws of one length (eqs 5 to 7, 10)
``normal_form``      type of the Hopf bifurcation
``quasi_static``     sliding without inertia: excursions and the edge of runaway
``roots``            roots of increasing functions and of polynomials, in arrays
==================== ============================================================================
"""
