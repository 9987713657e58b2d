"""Limit cycles: which one is reached, to full accuracy, and what it is like.

Whether it closes after 1, 2, 4 or more returns `search_step` finds, and `attractor` confirms.
"""
