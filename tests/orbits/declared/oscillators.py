"""One body that is shaken, as many tests declare it, with walls on either side and friction below."""

from orbits import DryFriction, Machine, Wall

RIGHT = Wall("R", lambda s, phase, p: p.gap - s.x, {"v": -1.0}, "restitution")
LEFT = Wall("L", lambda s, phase, p: p.gap + s.x, {"v": 1.0}, "restitution")
FLOOR = DryFriction("floor", lambda s, phase, p: s.v, "friction")


def oscillator(force, *contacts, **options):
    """x'' = force(state, phase, p, contact)."""
    return Machine(
        name="oscillator",
        states=("x", "v"),
        phase_rate="frequency",
        motion=lambda s, phase, p, contact: (s.v, force(s, phase, p, contact)),
        contacts=[*contacts],
        **options,
    )
