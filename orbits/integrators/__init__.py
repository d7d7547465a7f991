"""Integration of the flights of declared machines, from symbolic formulas.

`expressions` treats formulas for both integrators; `engine` selects the integrator. An integrator offers:

- `Values`: functions compiled for many points at once;
- `Flight`: flights with derivatives by state and parameter, one at a time; `Flights`: `LANES` of them at once, if `LANES` is above 1;
- `Watch`: flights that report every rise of given functions through zero;
- `Run`: flights that end at the first fall of one of the functions through zero.

A function that begins at zero, or below it by roundoff, and rises from there does not count as falling.
"""
