"""The alphabet of a vibro-impact motion: events, and the modes between them.

Between events the absorber slides towards the right wall (mode ``-``, w' < 0), slides towards the left wall (mode ``+``,
w' > 0) or sticks to the cavity floor (mode ``0``).

======  =====================================================  ==================
letter  event                                                  next mode
======  =====================================================  ==================
``L``   impact on the left wall, w = +1, reached in ``+``      ``-``
``R``   impact on the right wall, w = -1, reached in ``-``     ``+``
``t``   turn: w' = 0 while the shaking beats friction          the other sliding
``s``   stick: w' = 0 while friction holds                     ``0``
``u``   slip: friction gives way                               ``-`` or ``+``
======  =====================================================  ==================
"""

LETTERS = "LRtsu"
CODES = {letter: code for code, letter in enumerate(LETTERS)}
MIRRORED = {"L": "R", "R": "L", "t": "t", "s": "s", "u": "u"}
NAMES = {
    "L": "impact on the left wall",
    "R": "impact on the right wall",
    "t": "turn",
    "s": "stick",
    "u": "slip",
}
IMPACTS = frozenset("LR")


def is_impact(letter: str) -> bool:
    """Whether the event is an impact on a wall."""
    return letter in IMPACTS
