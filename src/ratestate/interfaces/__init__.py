"""Ways in beside Python.

============= =============================================================
``scenario``  scenario files: what may be in one, and what is wrong with it
``templates`` scenario files to start from, and their data
``cli``       the command line, ``ratestate``
``explorer``  the function `explore`, and the package that it needs
============= =============================================================
"""
