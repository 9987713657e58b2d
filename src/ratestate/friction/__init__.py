"""Friction laws, and the stability of steady sliding.

==================== ============================================================================
``law``              what a friction law is: a formula
``law_properties``   what follows from the formula: kind of law, steady sliding
``laws``             the built-in laws, a file each
``forms``            forms of friction beside that of eq. 1
``two_states``       states and parameters of laws with two states
``user_law``         laws from a user's file or class, named with a hash of their formula
``law_check``        check a user's law: finite, uncoupled, one steady state
``formulas``         friction and state in SI (eqs 1 to 3), for users
``equations``        a formula run once: rates and friction as expressions
``expressions``      graphs of expressions
``rewriting``        derivatives, coefficients and Python functions from expressions
``taylor``           Taylor coefficients of expressions
``functions``        what exp, log and others mean to numbers of any kind; their derivatives
``tuples``           arithmetic on tuples of these numbers
``kinematics``       slip rate as a function of the solver's variables
``motion``           the equations of motion and their derivatives, as expressions
``composition``      combine a law with a form of friction, damping and varying normal stress
``steady_state``     steady sliding by root finding
``linear_stability`` stability of steady sliding under any law
``linear_response``  response to small oscillations under any law
``critical_speeds``  speeds at which stability changes
``stability``        stability in closed form, laws of one length (eqs 5 to 7, 10)
``eigenvalues``      the three modes of steady sliding with one state
``hopf_of_law``      type of the Hopf bifurcation under any law
``normal_form``      the same in closed form, laws of one length
``quasi_static``     excursions and runaway for M = 0, in closed form
``convex``           the function in which these are written
``separatrix``       threshold of runaway for M = 0 under the slip law
``polynomials``      products and roots of polynomials in arrays
``roots``            roots of increasing functions of arrays
``elementwise``      let functions of arrays take floats and DataArrays
==================== ============================================================================
"""
