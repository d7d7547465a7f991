"""An orbit's motion, walls and events in the machine's units, as pictures show them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from orbits.orbit import Orbit

LINE = "#0b3c6f"  # colour of an orbit
LENGTHS, RATES = ("w", "cavity", "absorber"), ("w_rate",)


@dataclass(frozen=True)
class Shown:
    """One period of an orbit; lengths and velocities counted in `length` and `velocity`.

    Attributes
    ----------
    motion : dict
        Columns of `Orbit.sample`: ``w``, ``w_rate``, ``cavity``, ``absorber``, and ``phase``, ``segment``.
    left, right : float
        w at the walls.
    w, before, after, place : float arrays (L,)
        Of each event: relative position, relative velocities before and after, the absorber's position.
    length, velocity : str
        Units; empty for plain numbers, which are counted in half-widths of the cavity and the oscillator's own time.
    """

    motion: dict[str, np.ndarray]
    left: float
    right: float
    w: np.ndarray
    before: np.ndarray
    after: np.ndarray
    place: np.ndarray
    length: str
    velocity: str

    @property
    def half(self) -> float:
        """Half the distance between the walls."""
        return 0.5 * (self.left - self.right)

    @property
    def names(self) -> tuple[str, str]:
        """Labels of the phase portrait's axes, without symbols."""
        place = f" [{self.length}]" if self.length else ""
        rate = f" [{self.velocity}]" if self.velocity else ""
        return f"relative position w{place} (left wall at {self.left:+.6g})", f"relative velocity w'{rate}"

    @property
    def positions(self) -> str:
        """Label of an axis with positions."""
        return f"positions [{self.length}]" if self.length else "positions in units of b"


def shown(orbit: Orbit, points: int) -> Shown:
    """An orbit in the units of its machine.

    Parameters
    ----------
    orbit : Orbit
    points : int
        About how many samples.
    """
    model, params, table = orbit.model, orbit.params, orbit.events
    known = model.gauges(("w", "w_rate"), params)
    (long, length), (fast, velocity) = (known.get(name, (1.0, "")) for name in ("w", "w_rate"))
    sizes = dict.fromkeys(LENGTHS, long) | dict.fromkeys(RATES, fast)
    motion = {name: column * sizes.get(name, 1.0) for name, column in orbit.sample(points).items()}
    left, right = (long * float(wall) for wall in model.walls(params))
    _, place = model.bodies(table.w, table.v, params)
    events = table.w * long, table.rate_pre * fast, table.rate_post * fast, np.asarray(place) * long
    return Shown(motion, left, right, *events, length, velocity)


def quantities(orbit: Orbit, digits: int = 6) -> dict[str, str]:
    """Parameters of an orbit by name as text: quantities with their units, or the machine's plain numbers.

    Parameters
    ----------
    orbit : Orbit
    digits : int
    """
    about = orbit.model.described(orbit.params)
    units = about.get("units", {})
    return {
        name: f"{value:.{digits}g} {units.get(name, '')}".rstrip()
        for name, value in about["parameters"].items()
    }
