"""Sines and cosines of many phases at once, written so that the compiler makes vector instructions of them.

The phase is reduced by a multiple of pi kept in three pieces (Cody and Waite), halved, and evaluated with the
polynomials of the standard libraries on [-pi/4, pi/4]; the doubled angle gives both. Absolute errors stay below
4e-16 for phases up to 5e7, which is less than what rounding a phase of a few radians does.
"""

from __future__ import annotations

import numpy as np

from contvines_ground.parts import part
from orbits.compiling.decorators import OPTIONS

PI_A, PI_B, PI_C = 3.141592651605606, 1.9841871479187034e-09, 1.1442377452219664e-17
OVER_PI = 1.0 / np.pi
# Taylor-like minimax coefficients of sin and cos on [-pi/4, pi/4]
S1, S2, S3 = -1.66666666666666324348e-01, 8.33333333332248946124e-03, -1.98412698298579493134e-04
S4, S5, S6 = 2.75573137070700676789e-06, -2.50507602534068634195e-08, 1.58969099521155010221e-10
C1, C2, C3 = 4.16666666666666019037e-02, -1.38888888888741095749e-03, 2.48015872894767294178e-05
C4, C5, C6 = -2.75573143513906633035e-07, 2.08757232129817482790e-09, -1.13596475577881948265e-11


@part(forceinline=True, fastmath={"contract", "nsz"}, **OPTIONS)
def sines_cosines(phases, stride, count, sines, cosines):
    """Fill `sines` and `cosines` with those of phases[0], phases[stride], .. (`count` of them)."""
    for i in range(count):
        cosines[i] = phases[stride * i]
    for i in range(count):
        x = cosines[i]
        n = np.floor(x * OVER_PI + 0.5)
        parity = 0.5 * n
        sign = 1.0 - 4.0 * (parity - np.floor(parity))
        y = 0.5 * (((x - n * PI_A) - n * PI_B) - n * PI_C)
        z = y * y
        sine = y + y * z * (S1 + z * (S2 + z * (S3 + z * (S4 + z * (S5 + z * S6)))))
        cosine = 1.0 - 0.5 * z + z * z * (C1 + z * (C2 + z * (C3 + z * (C4 + z * (C5 + z * C6)))))
        sines[i] = sign * (2.0 * sine * cosine)
        cosines[i] = sign * (1.0 - 2.0 * sine * sine)
