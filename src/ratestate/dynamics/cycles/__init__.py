"""Limit cycles: which one is reached, to full accuracy, and what it is like."""
