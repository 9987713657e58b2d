"""Interfaces besides Python: the command line, and the function that opens the explorer."""
