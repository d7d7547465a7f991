"""Machine: a mechanical system with contacts, declared in a machine file."""

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
        Names and default values.
    motion : callable
        ``(state, phase, p, contact)`` -> rates of the states, in their order. `state` can be unpacked or used by names, `p` has the
        parameters, `contact` the friction forces and the signs of switches, as attributes. Functions come from `orbits.symbols`.
    contacts : sequence of Wall, DryFriction, Switch
    phase_rate : str, optional
        Name of the forcing frequency: the phase grows by it per unit of time, and the machine has the period
        2 pi in the phase. Without it the machine is self-excited, and its motions have periods of their own.
    mirror : mapping of str to str, optional
        Declares that the machine equals its mirror image half a forcing period later: all states change sign, and the named contacts change
        places (the others stay). ``{}``: no contact changes its place. It is checked at random states with the default parameters; at
        other values (a slope that is not zero) symmetric orbits and mirror images are used only if it holds there, too.
    starts : mapping of str to (low, high), optional
        Ranges of the states from which atlases and basins draw their starts; by default twice the reach of the motion from rest.
    units : mapping of str to str, optional
        Units of parameters and states by name, ``{"gap": "mm", "frequency": "Hz"}``, in which they are given (a text such as "1.2 mm" in any
        unit of the kind) and shown. The formulas of the file receive SI units; quantities without a unit here are passed unchanged.
    energy : callable, optional
        ``(state, phase, p)`` -> kinetic and potential energy of all bodies, in joules. With it impacts have masses, and orbits and transients the
        measures ``impulse``, ``impact_energy``, ``impact_loss``, ``friction_loss``, ``mean_force``, ``work_rate`` and, if a parameter is called
        ``contact_time`` (in seconds), ``peak_force``.
    response : str, optional
        The measure in diagrams, sweeps and surveys: ``max_``, ``min_`` or ``max_abs_`` with the name of the first state, or ``approach_speed``
        of the fastest impact, which is the default of a machine with walls.

    Raises
    ------
    PageError
        If the declaration is invalid; the message names the contact and the remedy.
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
        self.given_units = self._units.given
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
        """Other processes execute the machine file."""
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
        """Labels of axes by name of measure; states and parameters keep their names in the machine file."""
        found = {name: SYMBOLS[name] for name in ("phase", *self.load_names) if name in SYMBOLS}
        found |= {f"max_abs_{state}": f"largest |{state}|" for state in self.states}
        if "peak_force" in found:
            found["peak_force"] += f" (half sine over {CONTACT})"
        return found

    @property
    def units(self) -> dict[str, str]:
        """Units of parameters, states and measures by name; plain numbers have none."""
        units = self._units.shown(self.states)
        return (
            units | {name: OF_LOADS[name if name in OF_LOADS else "impulse"] for name in self.load_names}
            if units
            else {}
        )

    @property
    def load_names(self) -> tuple[str, ...]:
        """Names of the measures of forces and energies at its contacts."""
        return load_names(self.equations, self.parameters)

    @cached_property
    def compiled(self) -> Compiled:
        """Compiled functions of the machine."""
        return Compiled(self.equations)

    def vector(self, values: Mapping[str, float] | None = None) -> np.ndarray:
        """Return the parameter vector, shape (P,); `values` replace the machine's own.

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
        """Return the parameter vector, with each value checked by itself."""
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
        """Return the rate of the phase, radians per unit of time (self-excited: 1); shape of `params` (..., P) without the last axis."""
        if self.phase_rate is None:
            return 1.0
        speed = params[..., self.parameter_names.index(self.phase_rate)]
        return speed * self.equations.factors.get(self.phase_rate, 1.0)

    def sizes(self, params: np.ndarray) -> np.ndarray | None:
        """Return typical sizes of a node's entries, shape (n,), of a forced machine: in small units lengths and speeds are large numbers."""
        if not self.forced:
            return None
        named = self.named(params)
        found = self._units.sizes(self.states, named, float(self.phase_speed(params)))
        return None if np.all(found == 1.0) else np.append(1.0, found)

    def check_value(self, name: str, value: float) -> None:
        """Check a value that may be impossible whatever the other parameters are; see `orbits.machines.page.possible`.

        Raises
        ------
        ParameterError
            If the value is impossible; the message names parameter, value and remedy.
        """
        vector = self._numbers({name: value})
        if wrong := self._possible.wrong(vector, single=name):
            raise ParameterError(wrong)

    def has_mirror(self, params: np.ndarray, varying: str | None = None) -> bool:
        """Return whether mirror images of motions are motions at these parameters and at all values of `varying`."""
        place = None if varying is None else self.parameter_names.index(varying)
        return self._image is not None and self._image.holds(params, place)

    def absent(self, params: np.ndarray) -> frozenset[int]:
        """Return the frictions whose limit is zero at these parameters, at random states: they have no events."""
        frictions = tuple(self.equations.force)
        if not frictions:
            return frozenset()
        draws = checks.Draws(self.equations, params)
        numbers = np.hstack([draws.params, draws.signs])
        values = self.compiled.limits(frictions)(draws.states, draws.clock, numbers)
        return frozenset(j for j, column in zip(frictions, values.T) if np.all(column == 0.0))

    def settings(self, params: np.ndarray | None = None) -> dict[str, Any]:
        """Return the machine for a file, ready for JSON: path, text and digest of the machine file, and parameters."""
        values = self.parameters if params is None else self.named(params)
        return {"name": self.name, **self.page.describe(self), **values}

    # ------------------------------------------------------------------ motions
    def word(self, text: str | Word, params: np.ndarray | None = None) -> Word:
        """Read a word of this machine."""
        vector = self.vector() if params is None else params
        absent = frozenset() if isinstance(text, Word) else self.absent(vector)
        return Word.over(self.alphabet, text, absent)

    def word_of(self, events: Sequence[str], modes: Sequence[Sequence[int]], params: np.ndarray) -> Word:
        """Return the word with these events and modes."""
        return Word(tuple(events), tuple(tuple(mode) for mode in modes), self.alphabet)

    def rest_mode(self, params: np.ndarray, state: np.ndarray, clock: float) -> tuple[int, ...]:
        """Return the modes that follow from a state: free walls, signs of velocities and surfaces."""
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
        """Yield nothing: declared machines have no closed forms."""
        return iter(())

    def unshaken(self, params: np.ndarray) -> None:
        """Return None: the strength of the forcing of a declared machine is unknown."""

    def random_nodes(
        self, word: Word, periods: int, params: np.ndarray, generator: np.random.Generator
    ) -> np.ndarray:
        """Return random nodes, in which impacts leave their wall."""
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
        """Return random states within +-size, and a random phase."""
        start = {name: float(generator.uniform(-size, size)) for name in self.states}
        return start | ({"phase": float(generator.uniform(0.0, 2.0 * np.pi))} if self.forced else {})

    @hinting
    def smooth(self, state: Mapping[str, float] | None = None, **parameters: float):
        """Return the motions of a self-excited machine without events, in the mode of a state: its equilibria and cycles as a flow.

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
