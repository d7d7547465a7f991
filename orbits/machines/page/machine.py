"""Machine: a hybrid system in a machine file."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from contvines.shared.near_names import hinting, no_parameter
from orbits.arguments import Reals
from orbits.contacts import HIT
from orbits.contacts.dry_friction import ABSENT, STUCK
from orbits.contacts.switch import Switch
from orbits.contacts.wall import FREE, Wall
from orbits.machines.measures import SYMBOLS
from orbits.machines.page import checks
from orbits.machines.page.compiled import Compiled
from orbits.machines.page.mirror import MirrorImage
from orbits.machines.page.page import Page, PageError, again, object_name, page_of
from orbits.machines.page.patterns import Contact, Equations
from orbits.machines.page.possible import Possible
from orbits.machines.page.si import CONTACT, OF_LOADS, Units, load_names
from orbits.machines.parameters import ParameterError
from orbits.machines.varying import Varying
from orbits.words import Word
from orbits.words.alphabet import Alphabet


class Machine(Varying):
    """A machine declared by its equations of motion and its contacts.

    Parameters
    ----------
    name : str
    states : sequence of str
    parameters : mapping of str to float
        Names and the values they have where none are given.
    motion : callable
        ``(state, phase, p, contact)`` -> rates of the states, in their order. `state` unpacks and knows its names, `p` has the
        parameters, `contact` the friction forces and the signs of switches. Functions come from `orbits.symbols`.
    contacts : sequence of Wall, DryFriction, Switch
    phase_rate : str, optional
        The parameter that is the forcing's frequency: the phase grows by it per unit of time, and the machine has the period
        2 pi in the phase. Left out: a self-excited machine, whose motions have periods of their own.
    mirror : mapping of str to str, optional
        The machine equals its mirror image: all states change sign, these contacts change places (those not named stay), half a
        forcing period on. ``{}``: no contact changes its place. Checked at random states with the parameters' own values; with
        other values (a slope that is not zero) symmetric orbits and mirror images are looked for only if it holds there, too.
    starts : mapping of str to (low, high), optional
        Ranges of the states among which atlases and basins draw their starts; by default twice what the motion from rest reaches.
    units : mapping of str to str, optional
        Units of parameters and states by name, ``{"gap": "mm", "frequency": "Hz"}``: in them they are given (a text such as "1.2 mm" in any of
        its kind) and shown. The formulas of the file see SI units; what has no unit here they see as it is.
    energy : callable, optional
        ``(state, phase, p)`` -> kinetic and potential energy of all bodies, in joules: with it impacts have masses, and orbits and transients the
        measures ``impulse``, ``impact_energy``, ``impact_loss``, ``friction_loss``, ``mean_force``, ``work_rate`` and, where a parameter is called
        ``contact_time`` (in seconds), ``peak_force``.
    response : str, optional
        The measure that diagrams, sweeps and surveys show: ``max_``, ``min_`` or ``max_abs_`` with the name of the first state, or ``approach_speed`` of the
        fastest impact, which is the default of a machine with walls.

    Raises
    ------
    PageError
        If this declares no machine; the sentence names the contact and the way out.
    """

    flow = "page"

    patience = 2

    @hinting
    def __init__(
        self,
        *,
        name: str,
        states: Sequence[str],
        parameters: Mapping[str, float],
        motion: Callable,
        contacts: Sequence[Contact] = (),
        phase_rate: str | None = None,
        mirror: Mapping[str, str] | None = None,
        starts: Mapping[str, tuple[float, float]] | None = None,
        units: Mapping[str, str] | None = None,
        energy: Callable | None = None,
        response: str | None = None,
    ) -> None:
        self.energy, self.response = energy, response
        if not isinstance(parameters, Mapping):
            raise PageError(
                f"parameters = {parameters!r} must have a value for each name, for example {{'gap': 1.0}}"
            )
        self._units = Units(units, states, tuple(parameters), phase_rate)
        self.given_units = self._units.said
        parameters = {key: self._units.number(key, value) for key, value in parameters.items()}
        checks.check_names(name, states, parameters, phase_rate, contacts)
        self.name = name
        self.states = tuple(states)
        self.parameters = {key: float(value) for key, value in parameters.items()}
        self.parameter_names = tuple(self.parameters)
        self.starts = checks.check_starts(starts, self.states)
        self.phase_rate = phase_rate
        self.contacts: tuple[Any, ...] = tuple(contacts)
        self.forced = phase_rate is not None
        self.default_parameter = phase_rate or self.parameter_names[0]
        self.node_names = ("phase" if self.forced else "duration", *self.states)
        self.page: Page = page_of(motion)
        self.equations = Equations(
            self.states, self.parameter_names, phase_rate, motion, self.contacts, self._units.factors, energy
        )
        params = self._numbers({})
        flips = self.equations.flips = checks.check_contacts(self.equations, params)
        image = None if mirror is None else MirrorImage(self.equations, params, mirror)
        images, turned = (None, frozenset()) if image is None else (image.images, image.turned)
        self._image = image
        checks.check_response(response, self.states, self.contacts)
        rides = checks.riding(self.equations, params)
        for j in self.equations.push if energy is not None else ():
            checks.check_energy(self.equations, params, j)
        self.alphabet = Alphabet(self.contacts, images, turned, flips, rides)
        self._units.check(self.equations)
        self._possible = Possible(self.equations, self.units)
        if wrong := self._possible.wrong(params):
            raise PageError(wrong)

    def __repr__(self) -> str:
        kind = "self-excited" if self.phase_rate is None else f"forced at {self.phase_rate}"
        return f"<Machine {self.name}: {', '.join(self.states)}; {kind}; letters {' '.join(self.alphabet.letters)}>"

    def __reduce__(self) -> tuple[Any, ...]:
        """Other processes run its page."""
        name = object_name(self)
        if not name:
            raise ParameterError(
                f"the machine {self.name!r} cannot go to another process: declare it under a name at the top of a file, or work with workers = 1"
            )
        return again, (self.page.path, name)

    # ------------------------------------------------------------------ facts
    @property
    def size(self) -> int:
        """Number of states."""
        return len(self.states)

    @property
    def notation(self) -> dict[str, str]:
        """Labels of axes by name of measure; states and parameters (never "phase") are shown by the names in the machine file."""
        found = {name: SYMBOLS[name] for name in ("phase", *self.load_names) if name in SYMBOLS}
        found |= {f"max_abs_{state}": f"largest |{state}|" for state in self.states}
        if "peak_force" in found:
            found["peak_force"] += f" (half sine over {CONTACT})"
        return found

    @property
    def units(self) -> dict[str, str]:
        """Units of parameters, states and measures by name; plain numbers have none."""
        shown = self._units.shown(self.states)
        return (
            shown | {name: OF_LOADS[name if name in OF_LOADS else "impulse"] for name in self.load_names}
            if shown
            else {}
        )

    @property
    def load_names(self) -> tuple[str, ...]:
        """Measures of its contacts' forces and energies."""
        return load_names(self.equations, self.parameters)

    @cached_property
    def compiled(self) -> Compiled:
        """Its compiled functions."""
        return Compiled(self.equations)

    def vector(self, values: Mapping[str, float] | None = None) -> np.ndarray:
        """The parameter vector, shape (P,), with `values` in place of the machine's own.

        Raises
        ------
        ParameterError
            If a name is unknown, or a value is not finite or out of range, by itself or together with others.
        """
        params = self._numbers(values or {})
        if wrong := self._possible.wrong(params):
            raise ParameterError(wrong)
        return params

    def _numbers(self, values: Mapping[str, float]) -> np.ndarray:
        """The parameter vector, each value checked by itself."""
        merged = dict(self.parameters)
        for key, value in values.items():
            if key not in merged:
                raise ParameterError(no_parameter(key, f"the machine {self.name!r}", self.parameter_names))
            given = self._units.number(key, value)
            try:
                merged[key] = float(given)
            except (TypeError, ValueError):
                raise ParameterError(f"{key} = {given!r} is not a number") from None
            if not np.isfinite(merged[key]):
                raise ParameterError(f"{key} = {merged[key]} is not finite; give a number")
        if self.phase_rate is not None and not (speed := merged[self.phase_rate]) > 0.0:
            raise ParameterError(f"{self.phase_rate} = {speed:g}: a forcing frequency is above 0")
        return np.array([merged[key] for key in self.parameter_names])

    def phase_speed(self, params: np.ndarray) -> Reals:
        """How fast the phase grows, in radians per unit of time; of a self-excited machine 1: shapes follow `params` (..., P)."""
        if self.phase_rate is None:
            return 1.0
        speed = params[..., self.parameter_names.index(self.phase_rate)]
        return speed * self.equations.factors.get(self.phase_rate, 1.0)

    def sizes(self, params: np.ndarray) -> np.ndarray | None:
        """Typical sizes of a node's entries, shape (n,), of a forced machine: in small units lengths, and speeds even more, are large numbers."""
        if not self.forced:
            return None
        named = self.named(params)
        found = self._units.sizes(self.states, named, float(self.phase_speed(params)))
        return None if np.all(found == 1.0) else np.append(1.0, found)

    def check_value(self, name: str, value: float) -> None:
        """Refuse a value that a parameter cannot have whatever the others are; see `orbits.machines.page.possible`.

        Raises
        ------
        ParameterError
            Naming the parameter, the value and a way out.
        """
        vector = self._numbers({name: value})
        if wrong := self._possible.wrong(vector, alone=name):
            raise ParameterError(wrong)

    def has_mirror(self, params: np.ndarray, varying: str | None = None) -> bool:
        """Whether the mirror image of every motion is one at these parameters, whatever the value of the one that varies."""
        place = None if varying is None else self.parameter_names.index(varying)
        return self._image is not None and self._image.holds(params, place)

    def absent(self, params: np.ndarray) -> frozenset[int]:
        """Frictions whose limit is zero at these parameters, at random states: they have no events."""
        frictions = tuple(self.equations.force)
        if not frictions:
            return frozenset()
        draws = checks.Draws(self.equations, params)
        numbers = np.hstack([draws.params, draws.signs])
        values = self.compiled.limits(frictions)(draws.states, draws.clock, numbers)
        return frozenset(j for j, column in zip(frictions, values.T) if np.all(column == 0.0))

    def settings(self, params: np.ndarray | None = None) -> dict[str, Any]:
        """What a file keeps of the machine, ready for JSON: where its machine file is, that file's text and digest, and parameters."""
        values = self.parameters if params is None else self.named(params)
        return {"name": self.name, **self.page.describe(self), **values}

    # ------------------------------------------------------------------ motions
    def word(self, text: str | Word, params: np.ndarray | None = None) -> Word:
        """Read a word of this machine."""
        vector = self.vector() if params is None else params
        absent = frozenset() if isinstance(text, Word) else self.absent(vector)
        return Word.over(self.alphabet, text, absent)

    def word_of(self, events: Sequence[str], modes: Sequence[Sequence[int]], params: np.ndarray) -> Word:
        """The word with these events and modes."""
        return Word(tuple(events), tuple(tuple(mode) for mode in modes), self.alphabet)

    def rest_mode(self, params: np.ndarray, state: np.ndarray, clock: float) -> tuple[int, ...]:
        """Modes that a state suggests: free walls, signs of velocities and surfaces."""
        absent = self.absent(params)
        numbers = np.concatenate([params, np.zeros(len(self.equations.signed))])
        values = self.compiled.contact_values().one(state, clock, numbers) if self.contacts else []
        modes = []
        for j, (contact, value) in enumerate(zip(self.contacts, values)):
            if isinstance(contact, Wall):
                modes.append(FREE)
            elif isinstance(contact, Switch):
                modes.append(1 if value >= 0.0 else -1)
            elif j in absent:
                modes.append(ABSENT)
            else:
                modes.append(STUCK if value == 0.0 else (1 if value > 0.0 else -1))
        return tuple(modes)

    def start_nodes(self, word: Word, periods: int, params: np.ndarray) -> Iterator[np.ndarray]:
        """Nothing is known in closed form."""
        return iter(())

    def unshaken(self, params: np.ndarray) -> None:
        """None: what shakes a declared machine is not known."""

    def random_nodes(
        self, word: Word, periods: int, params: np.ndarray, generator: np.random.Generator
    ) -> np.ndarray:
        """Nodes at random, impacts such that they leave their wall."""
        n = max(1, len(word))
        nodes = generator.uniform(-1.0, 1.0, (n, self.size + 1))
        if self.forced:
            nodes[:, 0] = np.sort(generator.uniform(0.0, 2.0 * np.pi * periods, n))
        else:
            nodes[:, 0] = generator.uniform(0.1, 6.0, n)
        nodes[:, 1:] *= 10.0 ** generator.uniform(-1.0, 1.0)
        if not len(word):
            nodes[0, 0] = 0.0
        for i in range(len(word)):
            letter = word.letter(i)
            if letter.kind != HIT:
                continue
            clock = float(nodes[i, 0]) if self.forced else 0.0
            numbers = self.compiled.numbers(params, word.entries(i))
            row = self.compiled.approach(letter.contact).one(nodes[i, 1:], clock, numbers)
            rate, slope, push = row[0], row[1 : self.size + 1], row[self.size + 1 :]
            if rate < 0.0:
                nodes[i, 1:] -= 2.0 * rate / float(slope @ push) * push
        return nodes

    def random_start(
        self, params: np.ndarray, generator: np.random.Generator, size: float = 1.0
    ) -> dict[str, float]:
        """States within +-size and a phase."""
        start = {name: float(generator.uniform(-size, size)) for name in self.states}
        return start | ({"phase": float(generator.uniform(0.0, 2.0 * np.pi))} if self.forced else {})

    @hinting
    def smooth(self, state: Mapping[str, float] | None = None, **parameters: float):
        """The motions of a self-excited machine without events, in the mode of a state: its equilibria and cycles as a flow.

        ``contvines.diagram(machine.smooth({"x": 0.1}), over=...)`` begins at the equilibrium near the state; see `orbits.flows.page.smooth`.

        Raises
        ------
        ValueError
            If the machine is forced, or something is held or sticks in that state.
        """
        from orbits.flows.page.smooth import beside

        if self.forced:
            raise PageError(
                f"{self.name!r} is forced: its motions without events are orbits with the word ''; use machine.orbit('')"
            )
        return beside(self, state, **parameters)


__all__ = ["Machine", "PageError"]
