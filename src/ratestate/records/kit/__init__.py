"""Tools that the evaluations of records share."""
