"""The flow of declared machines, with integrated flights."""

from __future__ import annotations

from typing import Any

import numpy as np

from contvines.shared.motions import BAND, SILENT
from orbits.arguments import SMALLEST
from orbits.contacts import Site
from orbits.contacts.wall import Wall
from orbits.flows.page import measures
from orbits.flows.page.cycle_equations import PageEquations
from orbits.flows.page.pieces import flown, loose_states, strobed
from orbits.flows.protocol import Census, Flow, Motion, Vanishing
from orbits.machines.page.compiled import moving
from orbits.machines.page.machine import Machine
from orbits.machines.page.si import OF_A_STATE
from orbits.settings import EVENTS, SIMULATING
from orbits.words import Word, place_of

LARGE = 5  # number of states from which fewer starts are simulated


class PageFlow(Flow[Machine]):
    """See `orbits.flows.protocol.Flow`.

    A node is the clock (the phase; of a self-excited machine the duration of the flight that follows) and the states after the event.
    """

    angles = ("phase",)
    seconds = "time"
    measure_names = staticmethod(measures.names)
    measures = staticmethod(measures.measure)
    closed_form = False
    resolution = SIMULATING.same

    def census(self, model: Machine) -> Census:
        """Return a small census: flights are integrated one by one; with many states words are long and a start takes seconds."""
        few = 6 if model.size < LARGE else 2
        return Census(across=60, brief=(3, few), price=20.0, longest=16, embedded=4)

    def coordinates(self, model: Machine) -> tuple[str, ...]:
        """Return the names of the states."""
        return model.states

    def position_entries(self, model: Machine) -> tuple[int, ...]:
        """Return the entries of the states that no wall changes by an impulse."""
        return tuple(1 + j for j in unmoved(model))

    def points(self, motion: Motion[Machine]) -> np.ndarray:
        """Return the states just after the events, shape (L, n)."""
        return motion.nodes[:, 1:]

    def equations(
        self,
        model: Machine,
        word: Word,
        periods: int,
        parameter: str,
        params: np.ndarray,
        symmetric: bool = False,
        units: tuple[float, float] | None = None,
    ) -> PageEquations:
        """Return the equations of the cycles with this word, flight by flight; `units` is not used."""
        return PageEquations(model, word, periods, parameter, params, symmetric)

    def loose(self, model: Machine, word: Word) -> tuple[int, ...]:
        """Return the entries of the states on which no rate and no event of the word depends."""
        return tuple(1 + j for j in loose_states(model, word))

    def strobed(self, motion: Motion[Machine]) -> np.ndarray:
        """Return the states of a motion without events, once per forcing period."""
        nodes = strobed(motion.model, motion.word, motion.periods, motion.nodes[0], motion.params)
        return nodes[:, 1:]

    def default_measure(self, model: Machine) -> str:
        """Return the machine file's response; otherwise the approach speed if there are walls, else the maximum of the first state."""
        if model.response is not None:
            return model.response
        return "approach_speed" if model.alphabet.walled else f"max_{model.states[0]}"

    def simulated_names(self, model: Machine) -> tuple[str, ...]:
        """Return the extremes of the first state, approach speed and impact rate; with forcing also the band of the response."""
        first = model.states[0]
        forced = (*BAND, SILENT) if model.forced else ()
        return (
            *(f"{kind}_{first}" for kind in OF_A_STATE[:3]),
            "approach_speed",
            "impacts_per_period",
            *forced,
        )

    def swept(self, model: Machine) -> tuple[str, ...]:
        """Return the machine file's response; otherwise nothing if there are walls (impacts are plotted), else extremes of the first state."""
        if model.response not in (None, "approach_speed"):
            return (model.response,)
        return () if model.alphabet.walled else self.simulated_names(model)[:2]

    def in_units(self, model: Machine, params: np.ndarray, values: dict[str, float]) -> dict[str, float]:
        """Return the values as they are: they have the machine's units."""
        return values

    def described(self, motion: Motion[Machine]) -> dict[str, Any]:
        """Return clock and states after the events."""
        clock = "phase" if motion.model.forced else "duration"
        nodes = [
            {"event": event, clock: float(row[0]), **dict(zip(motion.model.states, map(float, row[1:])))}
            for event, row in zip(motion.word.events or ("",), motion.nodes)
        ]
        return {"nodes": nodes, **({} if len(motion.word) else {"rest": "no events"})}

    def kind(self, motion: Motion[Machine]) -> str:
        """Return "periodic"; "stuck" for a motion without events in which no state changes."""
        if len(motion.word):
            return "periodic"
        table = self.sample(motion, 50)
        moves = any(np.ptp(table[name]) > EVENTS.at_rest for name in motion.model.states)
        return "periodic" if moves else "stuck"

    def restitution(self, motion: Motion[Machine], place: int) -> float:
        """Return the restitution of the wall that is hit, evaluated at the impact."""
        model, node = motion.model, motion.nodes[place]
        numbers = model.compiled.numbers(motion.params, motion.word.entries(place))
        rebound = model.compiled.rebound(motion.word.letter(place).contact)
        return float(rebound.one(node[1:], float(node[0]) if model.forced else 0.0, numbers)[1])

    def without_events(self, motion: Motion[Machine]) -> np.ndarray:
        """Return nodes at phase zero of each period; of a self-excited motion at the extreme of the first state that moves."""
        if not motion.model.forced:
            table = self.sample(motion, 4000)
            states = np.column_stack([table[name] for name in motion.model.states])
            e = motion.model.equations
            first = moving(e, e.pattern(e.pattern_key(motion.word.entries(-1))).rates)
            return np.array([[motion.durations.sum(), *states[int(np.argmax(states[:, first]))]]])
        phases = 2.0 * np.pi * np.arange(motion.periods)
        return np.column_stack([phases, self.at_phases(motion, phases)])

    # ------------------------------------------------------------------ between the events, and at borders
    def flown(self, motion: Motion[Machine], places: np.ndarray, ahead: np.ndarray) -> np.ndarray:
        """Return the states at clocks `ahead` after the events `places`, shape (m, n)."""
        clocks, states = motion.nodes[:, 0], motion.nodes[:, 1:]
        return flown(motion.model, motion.params, motion.word.contact_modes, states, clocks, places, ahead)

    def vanishing(self, motion: Motion[Machine], index: int, unit: int) -> Vanishing:
        """Return the event that vanishes with margin `index` of a border orbit, over its whole cycle."""
        place, watched = place_of(motion.word, index)
        spans = motion.durations
        site = Site(motion.word, place, spans, unit)
        if watched < 0:
            return Vanishing(site, watched)
        ahead, state, sign = self._closest(motion, place, watched)
        share = ahead / max(spans[place], SMALLEST)
        site = site._replace(sign=sign, at=self._end(motion, place, share), ahead=share < EVENTS.at_end)
        return Vanishing(site, watched, (ahead, state))

    def _end(self, motion: Motion[Machine], place: int, share: float) -> int:
        """Return the event at the end of the flight at which a guard vanishes; -1 if it vanishes inside."""
        if not len(motion.word) or EVENTS.at_end <= share <= 1.0 - EVENTS.at_end:
            return -1
        return (place if share < EVENTS.at_end else place + 1) % len(motion.word)

    def _closest(self, motion: Motion[Machine], place: int, contact: int) -> tuple[float, np.ndarray, int]:
        """Return the point in a flight at which the guards of a contact are closest to zero.

        Returns
        -------
        clock : float
            Since the start of the flight.
        state : float array (n,)
        sign : int
            Sign of the guard's event.
        """
        compiled, e = motion.model.compiled, motion.model.equations
        mode = motion.word.entries(place)
        key = e.pattern_key(mode)
        numbers = compiled.numbers(motion.params, mode)
        guards, values, watch = e.pattern(key).guards, compiled.guards(key), compiled.watch(key)
        begin = float(motion.nodes[place, 0]) if motion.model.forced else 0.0
        length = float(motion.durations[place])
        state = motion.nodes[place, 1:]
        candidates = [(begin, g, state) for g, guard in enumerate(guards) if guard.contact == contact]
        candidates += [
            c for c in watch(state, begin, begin + length, numbers) if guards[c[1]].contact == contact
        ]
        final = watch.final
        candidates += [
            (begin + length, g, final) for g, guard in enumerate(guards) if guard.contact == contact
        ]
        own_start = len(motion.word) and motion.word.letter(place).contact == contact
        own_end = len(motion.word) and motion.word.letter(place + 1).contact == contact
        best, found = np.inf, (0.0, state, 0)
        for clock, g, point in candidates:
            share = (clock - begin) / max(length, SMALLEST)
            if (own_start and share < EVENTS.at_end) or (own_end and share > 1.0 - EVENTS.at_end):
                continue
            value = abs(values(point[None], np.array([clock]), numbers[None])[0, g])
            if value < best:
                best, found = value, (clock - begin, np.array(point), guards[g].sign)
        return found


def unmoved(machine: Machine) -> list[int]:
    """Return the states that no wall changes by an impulse."""
    pushed = {name for contact in machine.contacts if isinstance(contact, Wall) for name in contact.push}
    return [j for j, name in enumerate(machine.states) if name not in pushed]
