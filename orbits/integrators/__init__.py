"""Flights of declared machines: symbols in, integrators out. `expressions` is what both integrators share; `engine` says which one is used.

An integrator offers functions compiled for many points at once (`Values`), flights with their sensitivities, one by one (`Flight`) or, where `LANES` is
above 1, so many at once (`Flights`), flights that report every rise of given functions through zero (`Watch`), and flights that end at the first fall (`Run`).
A function that begins at zero, or below it by roundoff, and rises from there has not fallen.
"""
