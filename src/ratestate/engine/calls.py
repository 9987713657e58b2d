"""Calls of a law's units (units.py) from the control, which is the same for all laws.

In compiled code a unit is an address (compiler.py); in Python it is a function of these arguments.
"""

from .rows import WIDTH

#: places in `work`: what a unit of one lane is given comes first, what it finds begins here
FOUND = 128
#: numbers of `work`
WORK = 160


def call_lanes(unit, s, first, n):
    """Call a unit of lanes for n vectors of them, from the column `first` on."""
    for l in range(first, first + WIDTH * n):
        unit(s, l)


def call_point(unit, s, l, work):
    """Call a unit of the lane l; what it is given stands in `work`, and what it finds after it."""
    unit(s, l, work)


def add(array, k, x):
    """Add x to item k of an array that threads share; return the item before."""
    before = array[k]
    array[k] += x
    return before
