"""Friction laws, and the stability of steady sliding.

==================== ============================================================================
``law_formula``      the base class of laws: names, parameters, a formula
``law``              equations, coefficients and steady sliding that follow from the formula
``built_in_laws``    the built-in laws of friction
``laws``             laws by name
``forms``            forms of friction other than eq. 1
``user_law``         laws from a user's file or class: named with a hash, and checked
``formulas``         friction and state in SI (eqs 1 to 3), for users
``equations``        rates and friction as expressions, from running a formula once
``expressions``      graphs of expressions
``rewriting``        derivatives, coefficients and Python functions from expressions
``taylor``           Taylor coefficients of expressions
``functions``        exp, log and others for numbers of any kind; their derivatives
``tuples``           arithmetic on tuples of these numbers
``motion``           the equations of motion and their derivatives, as expressions
``point``            the values of these equations at one point, and the speed there
``composition``      combine a law with a form of friction, damping and varying normal stress
``steady_state``     steady sliding by root finding
``linear_stability`` stability of steady sliding under any law, and its response
``critical_speeds``  speeds at which stability changes
``stability``        stability in closed form, for laws of one length (eqs 5 to 7, 10)
``normal_form``      type of the Hopf bifurcation
``quasi_static``     sliding without inertia: excursions and the edge of runaway
``roots``            roots of increasing functions and of polynomials, in arrays
==================== ============================================================================
"""
