"""What the likelihood says of each estimate: profiles, posterior, intervals.

The likelihood itself is computed in `least_squares`, where it is largest, and in `posterior`.
"""
