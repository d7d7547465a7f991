"""The flow of the built-in machines, in closed form."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from contvines.core.library import NOTHING, NUMBER, POINTER, WHOLE, address, function
from contvines.shared.motions import BAND, SILENT
from orbits.contacts import HIT, SLIP, Change, Site
from orbits.contacts.dry_friction import STUCK
from orbits.flows.equations import Equations
from orbits.flows.native import measures
from orbits.flows.native.cycle_equations import NativeEquations
from orbits.flows.native.measures import events_of, gauged
from orbits.flows.protocol import Census, Flow, Motion, Vanishing
from orbits.machines.base import Model
from orbits.machines.native_stepper import bytes_of, floats, number, stepper
from orbits.settings import EVENTS, GROWING, SIMULATING
from orbits.words import Word, place_of
from orbits.words.alphabet import FLOOR, LEFT, RIGHT, Watch

FLIGHT = 0  # column of the margin that belongs to a flight
GRID = np.arange(41.0)  # grid points of the bracket that encloses the smallest speed in a flight


class NativeFlow(Flow[Model]):
    """See `orbits.flows.protocol.Flow`; a node is (Psi, B+) at an impact and (Psi, w) elsewhere, then v and v' if the cavity is an oscillator."""

    angles = measures.ANGLES
    closed_form = True
    resolution = SIMULATING.one  # two borders whose values agree to 1e-12 may be 5e-6 apart
    seconds = "tau"
    measures = staticmethod(measures.measure)

    def census(self, model: Model) -> Census:
        """Return a large census: starts are simulated together in closed form."""
        return Census(across=200, brief=(5, 48), price=1.0, longest=24, embedded=6)

    def coordinates(self, model: Model) -> tuple[str, ...]:
        """Return the names of position and velocity in the cavity, and of those of the centre of mass if the cavity is an oscillator."""
        return stepper(model.name).coordinates

    def position_entries(self, model: Model) -> tuple[int, ...]:
        """Return the entry of w."""
        return (1,)

    def points(self, motion: Motion[Model]) -> np.ndarray:
        """Return w, w' (and v, v') just after the events, shape (L, d)."""
        return self._states(motion)[:, list(stepper(motion.model.name).places)]

    def equations(
        self,
        model: Model,
        word: Word,
        periods: int,
        parameter: str,
        params: np.ndarray,
        symmetric: bool = False,
        units: tuple[float, float] | None = None,
    ) -> Equations:
        """Return the equations of the cycles with this word; the empty word (the absorber at rest) has linear ones."""
        if len(word):
            return NativeEquations(model, word, periods, parameter, params, symmetric, units)
        from orbits.flows.native.rest_equations import RestEquations

        return RestEquations(model, parameter, params)

    def loose(self, model: Model, word: Word) -> tuple[int, ...]:
        """Return the entry of w for a motion that hits no wall."""
        return (1,) if word.impact_free and len(word) else ()

    def strobed(self, motion: Motion[Model]) -> np.ndarray:
        """Return an empty table: the absorber at rest has no coordinates."""
        return np.zeros((motion.periods + 1, 0))

    def measure_names(self, model: Model) -> tuple[str, ...]:
        """Return the names of the machine's measures."""
        return model.measure_names

    def default_measure(self, model: Model) -> str:
        """Return the machine's default measure."""
        return model.default_measure

    def simulated_names(self, model: Model) -> tuple[str, ...]:
        """Return the simulated measures; the reduced model has the squared amplitude of the cavity in place of the oscillator's displacement."""
        speeds = ("max_abs_w", "impact_speed", "impacts_per_period")
        return ("max_abs_q1", *speeds, *BAND, SILENT) if model.moving_cavity else ("C2", *speeds)

    def swept(self, model: Model) -> tuple[str, ...]:
        """Return the machine's default measure."""
        return (model.default_measure,)

    def in_units(self, model: Model, params: np.ndarray, values: dict[str, float]) -> dict[str, float]:
        """Convert dimensionless measures to the machine's units."""
        return gauged(model, params, values)

    def described(self, motion: Motion[Model]) -> dict[str, Any]:
        """Return velocities and positions at the events, in the units that are shown."""
        model, table = motion.model, events_of(motion)
        long, fast = (float(model.gauge(kind, motion.params)) for kind in ("length", "velocity"))
        nodes = []
        for i, letter in enumerate(motion.word.events):
            entry = {
                "event": letter,
                "phase": float(table.phase[i]),
                "B_pre": float(table.B_pre[i]) * fast,
                "B_post": float(table.B_post[i]) * fast,
                "w": float(table.w[i]) * long,
                "w_rate": float(table.rate_post[i]) * fast,
            }
            for name in model.node_names[2:]:
                entry[name] = float(getattr(table, name)[i]) * (fast if name.endswith("rate") else long)
            nodes.append(entry)
        return {"events": "".join(motion.word.events), "nodes": nodes}

    def kind(self, motion: Motion[Model]) -> str:
        """Return "periodic" with impacts, "sliding" with other events only, "stuck" without events."""
        return "periodic" if motion.word.impacts else "sliding" if len(motion.word) else "stuck"

    def restitution(self, motion: Motion[Model], place: int) -> float:
        """Return Newton's coefficient of the wall that is hit."""
        return float(motion.model.restitutions(motion.params)[motion.word.letter(place).contact])

    def without_events(self, motion: Motion[Model]) -> None:
        """Return None: that motion is the absorber at rest, whose border has its own rules."""

    # ------------------------------------------------------------------ between the events
    def _states(self, motion: Motion[Model]) -> np.ndarray:
        """Return the stepper's states just after the events, shape (L, S)."""
        word, engine = motion.word, stepper(motion.model.name)
        return engine.states_of(motion.params, word.codes, word.mode_codes, motion.nodes)

    def flown(self, motion: Motion[Model], places: np.ndarray, ahead: np.ndarray) -> np.ndarray:
        """Return w, w', v, v' at clocks `ahead` after the events `places`, shape (m, 4)."""
        out = np.empty((len(ahead), 4))
        stepper(motion.model.name).sample(self._states(motion)[places], motion.params, ahead, out)
        return out

    def columns(self, motion: Motion[Model], table: np.ndarray) -> dict[str, np.ndarray]:
        """Return the coordinates and the absolute positions ``cavity`` (q1) and ``absorber`` (q2), in units of b."""
        w, w_rate, v, v_rate = table.T
        cavity, absorber = motion.model.bodies(w, v, motion.params)
        return {
            "w": w,
            "w_rate": w_rate,
            "v": v,
            "v_rate": v_rate,
            "cavity": cavity,
            "absorber": absorber,
        }

    def sample(self, motion: Motion[Model], points: int = 400) -> dict[str, np.ndarray]:
        """Sample one period; the absorber at rest, which moves with its cavity, at equal phases."""
        if len(motion.word):
            return super().sample(motion, points)
        phase = np.linspace(0.0, 2.0 * np.pi, points)
        rest = motion.model.rest
        v, v_rate = rest.cavity_motion(motion.params, rest.solved(motion.params), phase)
        nothing = np.zeros_like(phase)
        return {
            self.seconds: phase / motion.model.phase_speed(motion.params),
            "phase": phase,
            **self.columns(motion, np.array([nothing, nothing, v, v_rate]).T),
            "segment": np.zeros(points, int),
        }

    def positions(self, motion: Motion[Model], instants: int) -> np.ndarray:
        """Return w at equal phases, shape (periods * instants, 1), computed in the native core if there is one."""
        machine, count = number(motion.model.name), instants * motion.periods
        if not len(motion.nodes):
            return np.zeros((count, 1))
        if machine is None:
            return super().positions(motion, instants)
        left, right = motion.model.walls(motion.params)
        codes, modes = bytes_of(motion.word.codes), bytes_of(motion.word.mode_codes)
        nodes, params, w = floats(motion.nodes), floats(motion.params), np.empty((count, 1))
        work = function(
            "simulation_positions", NOTHING, WHOLE, POINTER, WHOLE, POINTER, POINTER, POINTER, NUMBER, NUMBER, NUMBER, WHOLE, POINTER
        )  # fmt: skip
        events, length = (address(codes), address(modes), address(nodes)), 2.0 * np.pi * motion.periods
        work(machine, address(params), len(codes), *events, left, right, length, count, address(w))
        return w

    def _flight(self, motion: Motion[Model], place: int, ahead: np.ndarray) -> np.ndarray:
        """Return w, w', v, v' at clocks `ahead` after event `place`, shape (m, 4)."""
        return self.flown(motion, np.full(len(ahead), place), ahead)

    # ------------------------------------------------------------------ at borders
    def vanishing(self, motion: Motion[Model], index: int, unit: int) -> Vanishing | None:
        """Return the event that vanishes with margin `index` of a border orbit, over its whole cycle; None if no word follows."""
        word = motion.word
        place, watched = place_of(word, index)
        in_flight = index % len(word.alphabet.columns) == FLIGHT
        site = Site(word, place, motion.durations, unit)
        if word.frictionless and in_flight:
            soft = self._soft(motion, place)
            if soft is not None:
                return Vanishing(site._replace(place=soft), Watch.STRENGTH)
            ahead = np.linspace(0.0, float(motion.durations[place]), 20002)[1:-1]
            return self._touching(motion, site, ahead)
        if watched in (Watch.STRENGTH, Watch.DURATION):
            return None if word.frictionless and watched == Watch.DURATION else Vanishing(site, watched)
        if not in_flight:
            if word.frictionless:
                return None
            at = place - 1 if word.letter(place).kind == SLIP else place
            return Vanishing(site._replace(place=at, at=at), self._nearest_wall(motion, motion.nodes[at, 1]))
        if (
            word.modes[place] == STUCK
        ):  # the reserve of friction vanishes inside the stick, so the time of the slip jumps
            return Vanishing(site, Watch.STRENGTH)
        return Vanishing(site, FLOOR, self._slowest(motion, place))

    def _soft(self, motion: Motion[Model], place: int) -> int | None:
        """Return the event at either end of a flight that is an impact of vanishing speed, or None."""
        places = (place, (place + 1) % len(motion.word))
        speed = EVENTS.touch * math.prod(motion.model.natural_units(motion.params))
        rates = events_of(motion).rate_post
        return next((k for k in places if abs(rates[k]) < speed), None)

    def _touching(self, motion: Motion[Model], site: Site, ahead: np.ndarray) -> Vanishing | None:
        """Return the touch at the reversal of a frictionless flight that comes closest to a wall; None if the flight does not reverse."""
        path = self._flight(motion, site.place, ahead)
        inner = np.flatnonzero(np.diff(np.sign(path[:, 1])) != 0)
        if not inner.size:
            return None
        left, right = motion.model.walls(motion.params)
        touch = inner[np.argmin(np.minimum(left - path[inner, 0], path[inner, 0] - right))]
        wall = self._nearest_wall(motion, path[touch, 0])
        return Vanishing(site, wall, self._node_inside(motion, float(ahead[touch]), path[touch]))

    def _slowest(self, motion: Motion[Model], place: int) -> tuple[float, np.ndarray]:
        """Return clock and node entries of the point in a flight at which the speed of sliding (mode times w') is smallest."""
        mode = float(motion.word.mode_codes[place])
        ahead = np.linspace(0.0, float(motion.durations[place]), 402)[1:-1]
        speed = mode * self._flight(motion, place, ahead)[:, 1]
        inner = np.flatnonzero((speed[1:-1] <= speed[:-2]) & (speed[1:-1] <= speed[2:])) + 1
        k = int(inner[speed[inner].argmin()] if inner.size else speed.argmin())
        low, high = float(ahead[max(k - 1, 0)]), float(ahead[min(k + 1, ahead.size - 1)])
        for _ in range(6):  # finer grids round the minimum: 1/20 of the bracket each time
            ahead = low + (high - low) / 40.0 * GRID
            k = int((mode * self._flight(motion, place, ahead)[:, 1]).argmin())
            low, high = float(ahead[max(k - 1, 0)]), float(ahead[min(k + 1, 40)])
        clock = 0.5 * (low + high)
        return self._node_inside(motion, clock, self._flight(motion, place, np.array([clock]))[0])

    def _node_inside(self, motion: Motion[Model], ahead: float, row: np.ndarray) -> tuple[float, np.ndarray]:
        """Return clock and node entries, w (, v, v'), of a point in a flight, like a node away from the walls."""
        return ahead, row[[0, 2, 3]][: motion.nodes.shape[1] - 1]

    def _nearest_wall(self, motion: Motion[Model], w: float) -> int:
        """Return the wall nearer to w."""
        left, right = motion.model.walls(motion.params)
        return LEFT if left - w < w - right else RIGHT

    def placed(self, motion: Motion[Model], found: Vanishing, place: int, change: Change) -> np.ndarray:
        """Return the nodes of the new events; their second entry is B+ for impacts and w for others."""
        model, word, letters = motion.model, motion.word, motion.word.alphabet.letters
        rows = super().placed(motion, found, place, change)
        length, rate = model.natural_units(motion.params)
        hit_before = 0  # side of the new impact just before: 1 left, -1 right, 0 none
        for row, text, spot in zip(rows, change.events, change.spots):
            hit = letters[text].kind == HIT
            side = (1 if letters[text].contact == LEFT else -1) if hit else 0
            replaced = None if spot.node is None else word.letter(spot.node)
            replaces_hit = replaced is not None and replaced.kind == HIT
            if hit and not replaces_hit:
                node = row if spot.node is None else motion.nodes[spot.node]
                row[1] = model.cavity_speed(node, motion.params)[0]  # B+ = v' - w'+
                row[1] += side * GROWING.first * length * rate
            elif replaced is not None and replaces_hit and not hit:
                row[1] = model.walls(motion.params)[0 if replaced.contact == LEFT else 1]
            elif hit_before and not hit:
                row[1] -= hit_before * 0.1 * GROWING.first**2 * length  # a little off the wall
            hit_before = side
        return rows
