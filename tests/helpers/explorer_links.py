"""Links of the explorer's page: fragments of addresses, each of a kind of motion."""

STICK_SLIP = "a=0.005&b=0.008&Dc=10 um&sigma=4 MPa&M=100 kg/m^2&K=0.96 GPa/m&V_lp=10 um/s"
FIG2 = "a=0.003&b=0.006&Dc=10 um&sigma=2 MPa&M=3000 kg/m^2&K=900 MPa/m&V_lp=3.2 mm/s"
CASES = {
    "stick-slip": f"{STICK_SLIP}&mu0=0.6&V0=1 nm/s&law=slip",
    "stick-slip, aging law": f"{STICK_SLIP}&mu0=0.6&V0=1 nm/s&law=aging",
    "quasi-harmonic": f"{FIG2}&mu0=0.6&V0=1 nm/s&law=slip",
    "quasi-harmonic, aging law": f"{FIG2}&mu0=0.6&V0=1 nm/s&law=aging",
    "steady": f"{FIG2.replace('3.2 mm', '0.3 mm')}&mu0=0.6&V0=1 nm/s&law=slip",
    "without mass": f"{FIG2.replace('3000 kg', '0 kg')}&mu0=0.6&V0=1 nm/s&law=aging",
}
