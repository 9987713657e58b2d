"""What is simulated, and the quantities and units of it.

=================================== ===========================================================
``slider``                          `SpringSlider`: which parameters a slider may have
``slider_names``, ``slider_text``   its parameters by name, and itself as text
``critical_numbers``                its critical stiffness and speeds
``loading``                         `Loading`: what the load point does
``initial_state``                   the state at t = 0, and which values for it agree
``quantities``, ``quantities.toml`` unit, range and name of each quantity; values as text
``units``                           reads values and says what is wrong with one
``other_units``, ``contact``        K as friction per length; mass, stiffness and force per area
``conversion``                      results in other units, and back to SI
``arrays``                          axes of a sweep, whether several agree, columns of a record
``names``                           mistyped names, and what was perhaps meant
``batch``                           from named values to a flat batch of cases, and back
``sentences``                       messages kept in TOML files, filled in
=================================== ===========================================================
"""
