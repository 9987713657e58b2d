"""The slider and its loading, with their quantities and units.

=================================== ===========================================================
``slider``                          `SpringSlider`: its parameters, critical stiffness and speeds
``parameters``                      parameters given for the whole contact or as K/sigma; `logspace`
``loading``                         `Loading`: methods that make and extend a loading
``load_point``                      speed, displacement and normal stress of a loading at any time
``history``                         piecewise linear histories of speed and of normal stress
``segments``                        histories from the rows of a record, and of a sinusoid
``initial_state``                   the state at t = 0, and checks that the given values agree
``quantities``, ``quantities.toml`` unit, range and name of each quantity; values as text
``units.toml``                      name, example and prefixes of the values of each unit
``units``                           conversion of values to SI, and messages about wrong values
``conversion``                      conversion of results to other units, and back to SI
``arrays``                          batches of cases as flat arrays, and columns of a record
``user_laws``                       `register`: friction laws of users
``names``                           suggestions for mistyped names; sentences kept in TOML files
=================================== ===========================================================
"""
