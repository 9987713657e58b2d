"""The slider that the scenario files of tests begin with."""

SLIDER = """
[slider]
a = 0.003
b = 0.006
Dc = "10 um"
sigma = "2 MPa"
K = "900 MPa/m"
"""
