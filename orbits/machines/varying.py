"""Which of a machine's numbers may vary, how the others follow, and in which units they are given.

A machine whose numbers are all its own varies one of them at a time; a machine of physical quantities
(`orbits.machines.physical.machine`) varies a direction in them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from contvines.shared.near_names import did_you_mean
from orbits.machines.notation import SYMBOLS, WORDS
from orbits.machines.parameters import Parameter, ParameterError
from orbits.machines.path import single

if TYPE_CHECKING:
    from collections.abc import Iterator

    from orbits.numbers import Reals
    from orbits.words import Word


class Varying:
    """The part of a machine (`orbits.machines.base.Model`) that knows what may vary."""

    table: ClassVar[tuple[Parameter, ...]] = ()
    younger: ClassVar[tuple[str, ...]] = ()
    """Parameters that older files do not have: their machines have the defaults."""

    in_cavity: ClassVar[bool] = False
    """Whether it is an absorber that moves between two walls of a cavity, with friction on its floor."""

    contact_time: float | None = None
    """Duration of an impact, in 1/omega_0, in seconds where there are units; None where no peak force is asked for."""

    if TYPE_CHECKING:
        name: str
        default_parameter: str
        parameter_names: tuple[str, ...]
        flow: str
        forced: bool
        node: int
        node_names: tuple[str, ...]
        patience: int

        # what both kinds of machines answer: `orbits.machines.mechanics`, `orbits.machines.page.machine`
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
        """A parameter vector of an older file with what was added since.

        Raises
        ------
        ValueError
            If it has not as many numbers as any version of the machine.
        """
        names = self.parameter_names
        if params.size == len(names) - len(self.younger):
            given = iter(params)
            return np.array([getattr(self, name) if name in self.younger else next(given) for name in names])
        if params.size != len(names):
            raise ValueError(f"{params.size} parameters are described, the machine has {len(names)}")
        return params

    @property
    def amount_names(self) -> tuple[str, ...]:
        """Names of all parameters that may vary, in the order of `amounts`; here the numbers themselves."""
        return self.parameter_names

    def amounts(self, params: np.ndarray) -> np.ndarray:
        """Values of all parameters that may vary, shape (Q,)."""
        return params

    def amount(self, name: str, params: np.ndarray) -> float:
        """The value of one of them."""
        return float(self.amounts(params)[self.place_of(name)])

    def path(self, name: str, params: np.ndarray) -> np.ndarray:
        """How the numbers follow one of them while the others stay as in `params`, shape (2, P); see `orbits.machines.path`."""
        return single(params.size, self.place_of(name))

    @property
    def law(self) -> np.ndarray:
        """The numbers as products of powers of the amounts, shape (Q + 1, P); no rows where they are the numbers themselves."""
        return np.zeros((0, len(self.parameter_names)))

    def vector_at(self, name: str, value: float, values: Mapping[str, Any] | None = None) -> np.ndarray:
        """`vector` with the parameter that may vary called `name` at `value`.

        Raises
        ------
        ParameterError
            As `vector` does.
        """
        return self.vector({**(values or {}), name: value})

    @property
    def units(self) -> dict[str, str]:
        """Units of parameters and measures by name; none here, where all are numbers."""
        return {}

    @property
    def notation(self) -> dict[str, str]:
        """Labels of axes by name of parameter or measure: in symbols, in words for numbers that have a unit."""
        found = {**SYMBOLS, **{name: WORDS[name] for name in self.units if name in WORDS}}
        if self.contact_time is not None:
            shape = f"half sine of {self.contact_time:g} {self.units.get('contact_time', '')}".rstrip()
            found["peak_force"] += f" ({shape})"
        return found

    def described(self, params: np.ndarray) -> dict[str, Any]:
        """A parameter vector by name, ready for JSON."""
        return {"parameters": dict(zip(self.parameter_names, (float(v) for v in params), strict=True))}

    def gauge(self, kind: str, params: np.ndarray) -> np.ndarray | float:
        """What one dimensionless unit of a kind of measure ("length", "velocity", "energy", "area") is in `units`."""
        return 1.0

    def gauges(self, names: Sequence[str], params: np.ndarray) -> dict[str, tuple[float, str]]:
        """What one of these coordinates is in the unit that is shown, and that unit; of those that have one."""
        return {name: (1.0, self.units[name]) for name in names if self.units.get(name)}

    def middle(self, params: np.ndarray) -> Reals:
        """The position about which mirror images are taken."""
        return 0.0

    def natural_units(self, params: np.ndarray) -> tuple[float, float]:
        """A length and a rate of the machine's own size; orbits are solved for in these, so that no unit makes a difference.

        They are exactly as large as the machine: whatever is compared with a number is then the same in every unit, but for
        rounding. 1 where the machine's equations have no unit to choose.
        """
        return 1.0, 1.0

    def factors(self, units: tuple[float, float]) -> np.ndarray:
        """What one dimensionless number of each of the machine's own parameters is, (P,), in units of a length and a rate."""
        length, rate = units
        sizes = {"b": length, "omega_0": rate, "b omega_0^2": length * rate * rate}
        return np.array([sizes.get(parameter.unit, 1.0) for parameter in self.table])

    def place_of(self, name: str) -> int:
        """Place of a parameter among `amount_names`.

        Raises
        ------
        ParameterError
            If there is none of this name.
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
        """Simulate from event to event; see `orbits.simulation.simulate`."""
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
        """The attractor that a start leads to; see `orbits.attractors.find_attractor`."""
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
        """The different attractors that `count` random starts lead to; see `orbits.attractors.different_attractors`."""
        from orbits.attractors.search import different_attractors

        return different_attractors(self, count, seed, size, **options)

    def population(self, over: str | None = None, **parameters: float):
        """Many starts and what they settle on; see `orbits.population.Population`."""
        from orbits.population.population import Population

        return Population(self, over or self.default_parameter, parameters)

    def orbit(
        self,
        word: str | Word,
        periods: int = 1,
        guess: Sequence[Sequence[float]] | np.ndarray | None = None,
        **parameters: Any,
    ):
        """Solve for the orbit with this word; see `orbits.starts.find.find`."""
        from orbits.starts.find import find

        return find(self, word, periods, guess, parameters)
