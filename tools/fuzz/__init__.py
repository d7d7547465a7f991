"""Search for wrong results: diagrams of random machines are checked by independent computations.

    python -m tools.fuzz absorber 150 SALT [--finer] [--first SEED]

Kinds of machines are those of :mod:`tools.fuzz.drawing`. Checks use the event-driven simulation, finite differences of its return
map, w as a function of the phase, and orbits next to special points. A finding (a result that seems wrong) names the seed; the same kind, salt
and seed draw the same machine again.
"""
