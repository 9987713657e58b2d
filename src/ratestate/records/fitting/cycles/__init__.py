"""Fits of limit cycles, stick-slip or vibration, by features of the cycles."""
