"""A search for false results: machines drawn at random, their diagrams, and checks whose truth comes from elsewhere.

    python -m tools.fuzz absorber 150 SALT [--finer] [--first SEED]

Kinds of machines are those of :mod:`tools.fuzz.drawing`. The witnesses are the event-driven simulation, differences of its return
map, w as a function of the phase, and the neighbours of a special point. A finding names the seed: the same kind, salt and seed draw the
same machine again.
"""
