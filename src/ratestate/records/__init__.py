"""Laboratory records: read, and fitted.

=========== =======================================================================
``reading`` a laboratory's file as a Dataset, with the load point's steps and holds
``fitting`` such a Dataset and a slider: parameters, their errors, warnings
=========== =======================================================================
"""
