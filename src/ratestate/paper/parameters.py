"""The paper's parameter sets in SI, without the friction law, which each figure chooses."""

from ..model.slider import SpringSlider

#: Fig. 1: an e-fold step from V0, imposed on the slider itself (the paper's K/sigma is 1e5 1/m).
FIG1 = SpringSlider(a=0.003, b=0.004, Dc=10e-6, sigma=1e6, K=float("inf"), mu0=0.6, V0=30e-6)

#: Fig. 2, and with another M, V_lp or K Figs. 3 and 6: K = 1.5 K_c_qs.
FIG2 = SpringSlider(a=0.003, b=0.006, Dc=10e-6, sigma=2e6, K=900e6, M=3000.0, mu0=0.6, V0=1e-9)
FIG2_START = 0.1e-3  # m/s
FIG2_SPEEDS = [0.3e-3, 3.1e-3, 3.2e-3]  # m/s
FIG2_DURATION = 10.0  # s after the step

FIG3_M = (1e2, 1e5, 12)  # kg/m^2: first, last, number
FIG3_V_LP = (10**-3.8, 1e-1, 13)  # m/s

#: Figs. 4 and 5.  The text gives no mu0 or V0; they shift friction and leave cycles as they are.
FIG4 = SpringSlider(a=0.005, b=0.008, Dc=10e-6, sigma=4e6, K=0.96e9, M=100.0, mu0=0.6, V0=1e-9)
FIG4_K = [0.96e9, 0.60e9]  # Pa/m
FIG4_V_LP = (1e-5, 1.0)  # m/s: five orders of magnitude
FIG4_EXAMPLES = {"stick_slip": 1e-4, "harmonic": 0.2}  # m/s, of its panels (b) and (c)
FIG5_V_LP = (1e-5, 10.0)  # m/s, with the larger rates of its inset

#: Fig. 6: barely stiff enough for quasi-static sliding, not enough at the second speed.
FIG6 = FIG2.replace(K=1.0005 * FIG2.K_c_qs)
FIG6_SPEEDS = (10e-6, 200e-6)  # m/s
FIG6_STEP = 0.1e-3  # m of load-point displacement
