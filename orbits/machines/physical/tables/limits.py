"""Between which values the quantities of a machine usually lie, in SI units; beyond them `unusual` has to be said."""

CLEARANCE = (1e-5, 2.0)
AMPLITUDE = (1e-9, 10.0)
ACCELERATION = (1e-9, 100_000.0)
FREQUENCY = (0.001, 100_000.0)
NATURAL_FREQUENCY = (0.01, 100_000.0)
FRICTION = (1e-6, 2.0)
RESTITUTION = (0.01, 1.0)
GRAVITY = (1e-6, 500.0)
SHARE = (1e-6, 0.5)
"""Of the oscillator's mass, or of critical damping."""
OSCILLATOR_MASS = (1e-6, 1e9)
POSITIVE = (1e-9, 1e9)
"""Of an absorber's mass, a damping coefficient and a force."""
STIFFNESS = (1e-4, 1e13)
RATIO = (0.001, 1000.0)
"""Of one wall's number to the other's, or of its distance to the half-width."""
