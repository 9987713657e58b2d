"""Ways in beside Python.

============ ======================================================
``cli``      the command line, ``ratestate``
``explorer`` the function `explore`, and the package that it needs
============ ======================================================
"""
