"""The flow of declared machines: integrated."""

from __future__ import annotations

from typing import Any

import numpy as np

from contvines.shared.motions import BAND, SILENT
from orbits.contacts.wall import Wall
from orbits.flows.page import measures, sampling, vanishing
from orbits.flows.page.cycle_equations import PageEquations
from orbits.flows.page.pieces import loose_states
from orbits.flows.protocol import Census, Motion
from orbits.machines.page.compiled import moving
from orbits.machines.page.machine import Machine
from orbits.machines.page.si import OF_A_STATE
from orbits.settings import EVENTS, SIMULATING
from orbits.words import Word

LARGE = 5  # states


class PageFlow:
    """See `orbits.flows.protocol`; a node is the phase, or the duration of the flight that follows, and the states after the event."""

    angles = ("phase",)
    sample = staticmethod(sampling.sample)
    measure_names, default_measure = staticmethod(measures.names), staticmethod(measures.shown_first)
    measures = staticmethod(measures.measure)
    placed, vanishing = staticmethod(vanishing.placed), staticmethod(vanishing.vanishing)
    closed_form = False
    resolution = SIMULATING.same

    def census(self, model: Machine) -> Census:
        """Flights are integrated one by one; of a machine with many states words are long, and a start is followed for seconds."""
        few = 6 if model.size < LARGE else 2
        return Census(across=60, brief=(3, few), price=20.0, longest=16, embedded=4)

    def coordinates(self, model: Machine) -> tuple[str, ...]:
        """The states."""
        return model.states

    def position_entries(self, model: Machine) -> tuple[int, ...]:
        """States that no wall pushes."""
        return tuple(1 + j for j in unmoved(model))

    def points(self, motion: Motion[Machine]) -> np.ndarray:
        """The states."""
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
        """Flight by flight, in numpy; a page has no units of its own."""
        return PageEquations(model, word, periods, parameter, params, symmetric)

    def loose(self, model: Machine, word: Word) -> tuple[int, ...]:
        """States that no rate and no event of the word knows."""
        return tuple(1 + j for j in loose_states(model, word))

    def positions(self, motion: Motion[Machine], instants: int) -> np.ndarray:
        """States that no wall pushes; see `orbits.flows.page.sampling.states_at`."""
        phases = np.linspace(0.0, 2.0 * np.pi * motion.periods, instants * motion.periods, endpoint=False)
        return sampling.states_at(motion, phases)[:, unmoved(motion.model)]

    def image(self, motion: Motion[Machine]) -> np.ndarray:
        """All states with the other sign."""
        image = -motion.nodes
        image[:, 0] = motion.nodes[:, 0]
        return image

    def strobed(self, motion: Motion[Machine]) -> np.ndarray:
        """See `orbits.flows.page.sampling.strobed`."""
        return sampling.strobed(motion.model, motion.word, motion.periods, motion.nodes[0], motion.params)[
            :, 1:
        ]

    def simulated_names(self, model: Machine) -> tuple[str, ...]:
        """How far the first state goes, the fastest impact and how many there are; where it is forced a band, too."""
        first = model.states[0]
        forced = (*BAND, SILENT) if model.forced else ()
        return (
            *(f"{kind}_{first}" for kind in OF_A_STATE[:3]),
            "approach_speed",
            "impacts_per_period",
            *forced,
        )

    def swept(self, model: Machine) -> tuple[str, ...]:
        """What the page says; else impact speeds, which belong to the impacts, or how far the first state goes."""
        if model.response not in (None, "approach_speed"):
            return (model.response,)
        walls = any(isinstance(contact, Wall) for contact in model.contacts)
        return () if walls else self.simulated_names(model)[:2]

    def in_units(self, model: Machine, params: np.ndarray, values: dict[str, float]) -> dict[str, float]:
        """They are."""
        return values

    def described(self, motion: Motion[Machine]) -> dict[str, Any]:
        """Clock and states after the events."""
        clock = "phase" if motion.model.forced else "duration"
        nodes = [
            {"event": event, clock: float(row[0]), **dict(zip(motion.model.states, map(float, row[1:])))}
            for event, row in zip(motion.word.events or ("",), motion.nodes)
        ]
        return {"nodes": nodes, **({} if len(motion.word) else {"rest": "no events"})}

    def kind(self, motion: Motion[Machine]) -> str:
        """A motion without events is one, too, unless no state changes."""
        if len(motion.word):
            return "periodic"
        table = sampling.sample(motion, 50)
        moves = any(np.ptp(table[name]) > EVENTS.still for name in motion.model.states)
        return "periodic" if moves else "stuck"

    def restitution(self, motion: Motion[Machine], place: int) -> float:
        """Of the wall that is hit, as its formula has it there."""
        model, node = motion.model, motion.nodes[place]
        clock = node[:1] if model.forced else np.zeros(1)
        numbers = model.compiled.numbers(motion.params, motion.word.entries(place))
        rebound = model.compiled.rebound(motion.word.letter(place).contact)
        return float(rebound(node[None, 1:], clock, numbers[None])[0, 1])

    def without_events(self, motion: Motion[Machine]) -> np.ndarray:
        """The nodes at phase zero; of a self-excited motion at the extreme of the first state that moves."""
        if not motion.model.forced:
            table = sampling.sample(motion, 4000)
            states = np.column_stack([table[name] for name in motion.model.states])
            e = motion.model.equations
            first = moving(e, e.pattern(e.pattern_key(motion.word.entries(-1))).rates)
            return np.array([[motion.durations.sum(), *states[int(np.argmax(states[:, first]))]]])
        phases = 2.0 * np.pi * np.arange(motion.periods)
        return np.column_stack([phases, sampling.states_at(motion, phases)])


def unmoved(machine: Machine) -> list[int]:
    """States that no impulse of a wall moves."""
    pushed = {name for contact in machine.contacts if isinstance(contact, Wall) for name in contact.push}
    return [j for j, name in enumerate(machine.states) if name not in pushed]
