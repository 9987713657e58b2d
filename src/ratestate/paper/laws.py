"""The friction laws of the paper, by name."""

LAWS = ("slip", "aging")
