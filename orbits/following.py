"""How far the simulated motion leaves a claimed orbit: by events where they are distinct, by positions at a border.

At a border two events coincide or one has no strength, so the event list of the simulation is a matter of rounding there;
the motion itself is not.
"""

from __future__ import annotations

import numpy as np

from orbits.orbit import Orbit
from orbits.sampling import sample
from orbits.simulation.driver import simulate
from orbits.simulation.replay import replay
from orbits.simulation.return_map import state_of

AT_BORDER = 1e-4  # margins below this may make two events one


def replay_error(orbit: Orbit) -> float:
    """Largest deviation of the simulation over one period of the orbit.

    Nodes are compared, event by event. For orbits at a border whose events come otherwise, the relative position w is
    compared at many instants instead. Infinite if the simulation does something else.
    """
    error = float(replay(orbit).error)
    if np.isfinite(error) or abs(orbit.margin) > AT_BORDER:
        return error
    return position_error(orbit)


def position_error(orbit: Orbit, points: int = 400) -> float:
    """Largest difference of the relative positions over one period, the simulation started at the most definite event."""
    speeds = np.abs(orbit.events.rate_post)
    place = int(np.argmax(speeds)) if speeds.max() > 0.0 else _calmest(orbit)
    turned = orbit.rotate(place)
    from orbits.simulation.driver import machine

    engine = machine(orbit.model.name)
    start = state_of(
        engine, orbit.params, int(turned.word.codes[0]), int(turned.word.modes[0]), turned.nodes[0]
    )
    start[1] = np.clip(start[1], -1.0, 1.0)
    claimed = sample(turned, points)
    given = {name: value for name, value in orbit.parameters.items() if not hasattr(orbit.model, name)}
    model = orbit.model.changed(
        **{
            name: value
            for name, value in orbit.parameters.items()
            if name not in given and name != "excitation"
        }
    )
    run = simulate(model, start, periods=orbit.periods + 1e-6, **given)  # type: ignore[arg-type]
    first = run.start[0] + 2.0 * np.pi * run.start[4]
    seen = run.sample(first + (claimed["phase"] - claimed["phase"][0]))
    return float(np.abs(seen.w - claimed["w"]).max())


def _calmest(orbit: Orbit) -> int:
    """A slip if there is one (friction gives way at a known phase), else the first event."""
    return next((i for i, letter in enumerate(orbit.word.events) if letter == "u"), 0)
