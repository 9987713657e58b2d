"""How the friction laws look in pictures: their names, and the lines of their fits."""

from .labels import BLUE, RED

#: law -> its name
LAWS = {"slip": "slip (Ruina) law", "aging": "aging (Dieterich) law"}
#: law -> colour and dashes of its fitted curve; the record is gray
COLORS = {"slip": RED, "aging": BLUE}
DASHES = {"slip": "-", "aging": (0, (5, 1.6))}
