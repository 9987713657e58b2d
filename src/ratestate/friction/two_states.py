"""Friction with two states, each of which evolves over a distance of its own."""

from types import MappingProxyType

from .law import FrictionLaw, Parameter


class TwoStateLaw(FrictionLaw):
    """mu = mu0 + a ln(V/V0) + b ln(V0 theta/Dc) + b2 ln(V0 theta2/Dc2)."""

    source = (
        "Ruina (1983) doi:10.1029/JB088iB12p10359; Gu, Rice, Ruina & Tse (1984) "
        "doi:10.1016/0022-5096(84)90007-3"
    )
    states = MappingProxyType({"theta": ("b", "Dc"), "theta2": ("b2", "Dc2")})
    parameters = MappingProxyType(
        {
            "b2": Parameter("1", "evolution effect of the second state", example="0.002"),
            "Dc2": Parameter("m", "critical slip distance of the second state", "> 0", "'100 um'"),
        }
    )
