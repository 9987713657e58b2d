"""Notes on a fit: warnings, identifiability of the parameters, comparison of the laws."""
