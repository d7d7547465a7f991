"""The parameters of a machine that can vary, their units, and how the parameter vector depends on them.

A machine given by dimensionless numbers varies one of them at a time; a machine given by physical quantities
(`orbits.machines.physical.machine`) may change several numbers with one quantity.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from contvines.shared.near_names import did_you_mean
from orbits.machines.measures import SYMBOLS, WORDS
from orbits.machines.parameters import Parameter, ParameterError, products, single

if TYPE_CHECKING:
    from collections.abc import Iterator

    from orbits.arguments import Reals
    from orbits.words import Word


class Varying:
    """Common base of built-in and declared machines: parameters and units, and the methods that find motions."""

    table: ClassVar[tuple[Parameter, ...]] = ()
    younger: ClassVar[tuple[str, ...]] = ()
    """Parameters that older files lack; machines from these files have the defaults."""

    in_cavity: ClassVar[bool] = False
    """Whether the machine is an absorber between two walls of a cavity, with friction on its floor."""

    contact_time: float | None = None
    """Duration of an impact, in 1/omega_0 (with units: in seconds), for the peak force; None: no peak force."""

    if TYPE_CHECKING:
        name: str
        default_parameter: str
        parameter_names: tuple[str, ...]
        flow: str
        forced: bool
        node: int
        node_names: tuple[str, ...]
        patience: int

        # implemented by both kinds of machines, in `orbits.machines.base` and `orbits.machines.page.machine`
        def has_mirror(self, params: np.ndarray, varying: str | None = None) -> bool: ...
        def phase_speed(self, params: np.ndarray) -> Reals: ...
        def check_value(self, name: str, value: float) -> None: ...
        def settings(self, params: np.ndarray | None = None) -> dict[str, Any]: ...
        def word(self, text: str | Word, params: np.ndarray) -> Word: ...
        def word_of(self, events: Sequence[str], modes: Sequence[Any], params: np.ndarray) -> Word | None: ...
        def unshaken(self, params: np.ndarray) -> tuple[str, str] | None: ...
        def start_nodes(self, word: Word, periods: int, params: np.ndarray) -> Iterator[np.ndarray]: ...
        def random_nodes(
            self, word: Word, periods: int, params: np.ndarray, generator: np.random.Generator
        ) -> np.ndarray | None: ...
        def random_start(
            self, params: np.ndarray, generator: np.random.Generator, size: float = 1.0
        ) -> dict[str, float]: ...

        def vector(self, values: Mapping[str, Any] | None = None) -> np.ndarray: ...

    def completed(self, params: np.ndarray) -> np.ndarray:
        """Return a parameter vector from an older file, completed with parameters added since.

        Raises
        ------
        ValueError
            If its length is that of no version of the machine.
        """
        names = self.parameter_names
        if params.size == len(names) - len(self.younger):
            given = iter(params)
            return np.array([getattr(self, name) if name in self.younger else next(given) for name in names])
        if params.size != len(names):
            raise ValueError(f"{params.size} parameters are described, the machine has {len(names)}")
        return params

    def named(self, params: np.ndarray) -> dict[str, float]:
        """Return the entries of a parameter vector by name."""
        return dict(zip(self.parameter_names, params.tolist(), strict=True))

    @property
    def amount_names(self) -> tuple[str, ...]:
        """Names of all parameters that can vary, in the order of `amounts`; here the numbers themselves."""
        return self.parameter_names

    def amounts(self, params: np.ndarray) -> np.ndarray:
        """Return the values of all parameters that can vary, shape (Q,)."""
        return params

    def amount(self, name: str, params: np.ndarray) -> float:
        """Return the value of one parameter."""
        return float(self.amounts(params)[self.place_of(name)])

    def path(self, name: str, params: np.ndarray) -> np.ndarray:
        """Return how the numbers depend on one parameter while the others stay as in `params`, shape (2, P); see `orbits.machines.parameters`."""
        place, law = self.place_of(name), self.law
        if not len(law):
            return single(params.size, place)
        powers, others = law[1 + place], self.amounts(params).copy()
        others[place] = 1.0
        return np.array([np.where(powers != 0.0, products(law, others), 0.0), powers])

    @property
    def law(self) -> np.ndarray:
        """The numbers as products of powers of the amounts, shape (Q + 1, P); no rows if amounts and numbers are the same."""
        return np.zeros((0, len(self.parameter_names)))

    def vector_at(self, name: str, value: float, values: Mapping[str, Any] | None = None) -> np.ndarray:
        """Return `vector` with the parameter `name` at `value`.

        Raises
        ------
        ParameterError
            As `vector` does.
        """
        return self.vector({**(values or {}), name: value})

    @property
    def units(self) -> dict[str, str]:
        """Units of parameters and measures by name; none for dimensionless machines."""
        return {}

    @property
    def notation(self) -> dict[str, str]:
        """Labels of axes by name of parameter or measure: in symbols, or in words for quantities with a unit."""
        found = {**SYMBOLS, **{name: WORDS[name] for name in self.units if name in WORDS}}
        if self.contact_time is not None:
            shape = f"half sine of {self.contact_time:g} {self.units.get('contact_time', '')}".rstrip()
            found["peak_force"] += f" ({shape})"
        return found

    def described(self, params: np.ndarray) -> dict[str, Any]:
        """Return the parameters by name and the units, ready for JSON."""
        return {"parameters": self.named(params), **({"units": self.units} if self.units else {})}

    def gauge(self, kind: str, params: np.ndarray) -> np.ndarray | float:
        """Return one dimensionless unit of a kind of measure ("length", "velocity", "energy", "area") in the shown unit."""
        return 1.0

    def gauges(self, names: Sequence[str], params: np.ndarray) -> dict[str, tuple[float, str]]:
        """Return, for coordinates that have a unit, the size of one in the shown unit, and this unit."""
        return {name: (1.0, self.units[name]) for name in names if self.units.get(name)}

    def middle(self, params: np.ndarray) -> Reals:
        """Return the position about which mirror images are taken."""
        return 0.0

    def image(self, word: Word, nodes: np.ndarray, params: np.ndarray) -> np.ndarray:
        """Return the mirror images of nodes (..., L, n) of the first events of a word, with phases or durations unchanged."""
        image = -nodes
        image[..., 0] = nodes[..., 0]
        return image

    def natural_units(self, params: np.ndarray) -> tuple[float, float]:
        """Return a length and a rate of the machine's own size; orbits are solved in these units, so that results do not depend on the user's.

        They scale exactly with the machine, so that comparisons with fixed tolerances give the same result in every unit, apart from roundoff.
        1 if the machine's equations offer no choice of units.
        """
        return 1.0, 1.0

    def sizes(self, params: np.ndarray) -> np.ndarray | None:
        """Return typical sizes of a node's entries, shape (n,), if they are not of order 1 in the units of solving; else None."""
        return None

    def factors(self, units: tuple[float, float]) -> np.ndarray:
        """Return one unit of each dimensionless parameter, (P,), when length and rate are counted in `units`."""
        length, rate = units
        sizes = {"b": length, "omega_0": rate, "b omega_0^2": length * rate * rate}
        return np.array([sizes.get(parameter.unit, 1.0) for parameter in self.table])

    def place_of(self, name: str) -> int:
        """Return the index of a parameter in `amount_names`.

        Raises
        ------
        ParameterError
            If the name is unknown.
        """
        if name not in self.amount_names:
            raise ParameterError(
                f"parameter = {name!r} is unknown to the model {self.name!r}{did_you_mean(name, self.amount_names)}; choose one of "
                + ", ".join(self.amount_names)
            )
        return self.amount_names.index(name)

    # ------------------------------------------------------------------ motions
    def simulate(
        self,
        start: Mapping[str, float] | np.ndarray | None = None,
        *,
        periods: float | None = None,
        time: float | None = None,
        events: int | None = None,
        **parameters: float,
    ):
        """Simulate from event to event, independently of the equations that continuation solves.

        Parameters
        ----------
        start : mapping or ndarray, optional
            States by name, in the machine's units: `phase` (radians), `w`, `w_rate` and, for an oscillating cavity, `v`, `v_rate` (or
            `q1`, `q2`, `q1_rate`, `q2_rate`); of a declared machine its own states, and `phase` if it is forced. Missing entries are 0.
        periods, time : float, optional
            Length of the run, in forcing periods or in the machine's time.
        events : int, optional
            Largest number of events; by default a million.
        **parameters
            Parameters that are no fields of the machine (`amplitude`), or that replace its fields.

        Returns
        -------
        Trajectory
            Phases of the events in `clocks`, their letters in `letters`; `reason` is the reason for the end of the run.

        Raises
        ------
        SimulationError
            If the start is impossible, no length is given, or the laws of motion do not continue the motion.
        """
        from orbits.simulation.runs import simulate

        return simulate(self, start, periods=periods, time=time, events=events, **parameters)

    def attractor(
        self,
        start: Mapping[str, float] | np.ndarray | None = None,
        *,
        transient: float | None = None,
        max_period: int = 16,
        tolerance: float | None = None,
        patience: int | None = None,
        observed: bool = True,
        **parameters: float,
    ):
        """Find the attractor to which a start leads: simulate until the motion recurs, then solve for it.

        Parameters
        ----------
        start : mapping or ndarray, optional
            As for `simulate`; by default rest.
        transient : float, optional
            Length left out first: 300 forcing periods (self-excited: 100 events).
        max_period : int
            Longest recurrence to search for, in forcing periods (self-excited: 25 times as many events).
        tolerance : float, optional
            Largest distance of two points, relative to 1 + their size, that counts as a return; 1e-6, for a declared machine 1e-5.
        patience : int, optional
            How often the transient is prolonged if nothing recurs.
        observed : bool
            Whether a motion that does not recur is followed until its statistics settle.
        **parameters
            Parameters that are no fields of the machine (`amplitude`), or that replace its fields.

        Returns
        -------
        Attractor
            `kind` is its kind, `orbit` the solved orbit (None if no word describes the motion); `contvines.diagram` can begin with it.

        Raises
        ------
        SimulationError
            If the start or the lengths are impossible.
        """
        from orbits.attractors.search import find_attractor

        return find_attractor(
            self,
            start,
            transient=transient,
            max_period=max_period,
            tolerance=tolerance,
            patience=patience,
            observed=observed,
            **parameters,
        )

    def attractors(self, count: int, seed: int = 0, size: float = 1.0, **options: float | None):
        """Find the different attractors of random starts, in the order in which they are found; mirror images count once.

        Parameters
        ----------
        count : int
            Number of starts.
        seed : int
            Seed of the random generator.
        size : float
            Of a declared machine: states are drawn within +-`size`.
        **options
            As for `attractor`, including parameters of the machine.

        Returns
        -------
        list of Attractor

        Raises
        ------
        SimulationError
            If no start can be simulated.
        """
        from orbits.attractors.search import different_attractors

        return different_attractors(self, count, seed, size, **options)

    def population(self, over: str | None = None, **parameters: float):
        """Return many starts of the machine, for `contvines.atlas`, `basins` and `robustness`.

        Parameters
        ----------
        over : str, optional
            The varying parameter; by default `default_parameter`.
        **parameters
            Parameters that are no fields of the machine, or that replace its fields.

        Returns
        -------
        orbits.population.Population

        Raises
        ------
        SimulationError
            If the machine has no parameter called `over`.
        """
        from orbits.population import Population

        return Population(self, over or self.default_parameter, parameters)

    def orbit(
        self,
        word: str | Word,
        periods: int = 1,
        guess: Sequence[Sequence[float]] | np.ndarray | None = None,
        **parameters: Any,
    ):
        """Solve for the orbit with this word.

        Parameters
        ----------
        word : str or Word
            Events of one period, such as ``"LR"``; ``""`` is the motion without events.
        periods : int
            Forcing periods after which the orbit closes, 1 or more; of a self-excited machine 1.
        guess : array_like, shape (L, n), optional
            Nodes for Newton's method, one row per event (slips included): the phase, then the entries of `node_names`. Without a guess closed
            forms are tried, then simulation from many starts, then random nodes.
        **parameters
            Parameters that are no fields of the machine (`amplitude`), or that replace its fields.

        Returns
        -------
        Orbit

        Raises
        ------
        orbits.starts.find.StartError
            If no orbit with this word is found; the message lists the attempts and the motion that the simulator finds.
        ParameterError, WordError
            If a parameter or the word is impossible.
        """
        from orbits.starts.find import find

        return find(self, word, periods, guess, parameters)
