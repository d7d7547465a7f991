"""Plans of surveys: grids and lists of parameter values, and samples of uncertain parameters."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ..coexistence.settings import ATLAS
from ..shared.near_names import did_you_mean

SAMPLINGS = ("latin", "sobol", "random")
MOST = 1_000_000
KEYS = ("within", "count", "values", "normal", "uniform")


class PlanError(ValueError):
    """An invalid survey; the message names the field and its value, and suggests a remedy."""


class Law(Protocol):
    """A probability distribution; ``ppf`` is the inverse of the cumulative distribution function, as in scipy.stats."""

    def ppf(self, q: np.ndarray) -> np.ndarray: ...


@dataclass(frozen=True)
class Plan:
    """The systems of a survey: every combination of the values on the axes, each with every sample.

    Attributes
    ----------
    axes : dict
        Values of each parameter on a grid, in order.
    samples : dict
        Sampled values of each uncertain parameter, all of the same length; empty if no parameter is uncertain.
    """

    axes: dict[str, np.ndarray]
    samples: dict[str, np.ndarray]

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters that vary."""
        return (*self.axes, *self.samples)

    @property
    def dimensions(self) -> tuple[str, ...]:
        """Names of the results' dimensions: the axes, and ``sample`` where there are samples."""
        return (*self.axes, *(("sample",) if self.samples else ()))

    @property
    def shape(self) -> tuple[int, ...]:
        """Lengths of the dimensions."""
        sampled = [len(next(iter(self.samples.values())))] if self.samples else []
        return (*(len(values) for values in self.axes.values()), *sampled)

    def __len__(self) -> int:
        return int(np.prod(self.shape))

    def systems(self) -> list[dict[str, float]]:
        """Return the parameter values of each system, the last dimension varying fastest."""
        found = []
        count = self.shape[-1] if self.samples else 1
        for point in itertools.product(*self.axes.values()):
            for i in range(count):
                drawn = {name: float(values[i]) for name, values in self.samples.items()}
                found.append({**{name: float(x) for name, x in zip(self.axes, point)}, **drawn})
        return found

    def neighbours(self) -> list[int | None]:
        """Return for each system the index of an adjacent earlier one (one step back along the last axis that has moved); None for the first."""
        shape = self.shape
        found: list[int | None] = []
        for index in range(len(self)):
            place = [int(k) for k in np.unravel_index(index, shape)]
            axis = next((k for k in reversed(range(len(place))) if place[k] > 0), None)
            if axis is None:
                found.append(None)
                continue
            place[axis] = 0 if self.dimensions[axis] == "sample" else place[axis] - 1
            found.append(int(np.ravel_multi_index(tuple(place), shape)))
        return found


def planned(vary: Mapping[str, object], sampling: str = "latin", samples: int = 32, seed: int = 1) -> Plan:
    """Return the plan for a user's specification of each parameter.

    Parameters
    ----------
    vary : mapping
        Name -> specification:

        - a list of values;
        - ``{"within": [low, high], "count": n}``: a grid;
        - ``{"within": [low, high]}`` or ``{"uniform": [low, high]}``: uncertain, uniformly distributed;
        - ``{"normal": [mean, deviation]}``: uncertain, normally distributed; truncated to ``within`` if this is given, too.
    sampling : {"latin", "sobol", "random"}
        Method by which all uncertain parameters are sampled together.
    samples : int
        Number of samples.
    seed : int

    Raises
    ------
    PlanError
        If a specification is invalid; the message names the first error.
    """
    if not vary:
        raise PlanError(
            "[survey] vary is empty; name a parameter and its values, for example half_width = [10, 15]"
        )
    if sampling not in SAMPLINGS:
        raise PlanError(
            f"[survey] sampling = {sampling!r} is unknown; expected {', '.join(map(repr, SAMPLINGS))}"
        )
    if isinstance(samples, bool) or not isinstance(samples, int) or not 1 <= samples <= MOST:
        raise PlanError(f"[survey] samples = {samples!r}: expected a whole number from 1 to {MOST}")
    axes: dict[str, np.ndarray] = {}
    uncertain: dict[str, Law] = {}
    for name, given in vary.items():
        values = _axis(name, given)
        if values is not None:
            axes[name] = values
        elif isinstance(given, Mapping):
            uncertain[name] = _distribution(name, given)
    drawn = _drawn(uncertain, sampling, samples, seed) if uncertain else {}
    plan = Plan(axes, drawn)
    if len(plan) > MOST:
        raise PlanError(f"[survey] vary means {len(plan)} systems; at most {MOST} are allowed")
    return plan


def _axis(name: str, given: object) -> np.ndarray | None:
    """Return the values of a parameter on an axis; None for an uncertain parameter."""
    place = f"[survey] vary.{name}"
    if isinstance(given, Mapping):
        unknown = [key for key in given if key not in KEYS]
        if unknown:
            hint = did_you_mean(str(unknown[0]), KEYS)
            raise PlanError(
                f"{place}.{unknown[0]}: there is no such field{hint}; {', '.join(KEYS)} are known"
            )
        if "values" in given:
            given = given["values"]
        elif "count" in given:
            low, high = _pair(f"{place}.within", given.get("within"))
            count = given["count"]
            if isinstance(count, bool) or not isinstance(count, int) or not 1 <= count <= MOST:
                raise PlanError(f"{place}.count = {count!r}: expected a whole number from 1 to {MOST}")
            if not low < high:
                raise PlanError(f"{place}.within = [{low:g}, {high:g}]: expected low < high")
            return np.linspace(low, high, count)
        else:
            return None
    if not isinstance(given, list | tuple | np.ndarray) or not len(given):
        raise PlanError(
            f"{place} = {given!r}: expected a list of values, or within and count; what is uncertain has uniform = [from, to] or normal = [mean, deviation]"
        )
    return np.array([_number(f"{place}[{i}]", value) for i, value in enumerate(given)])


def _distribution(name: str, given: Mapping[str, object]) -> Law:
    from scipy import stats

    place = f"[survey] vary.{name}"
    if "normal" in given:
        mean, deviation = _pair(f"{place}.normal", given["normal"])
        if not deviation > 0.0:
            raise PlanError(
                f"{place}.normal = [{mean:g}, {deviation:g}]: expected [mean, deviation], the second above 0"
            )
        if "within" not in given:
            return stats.norm(mean, deviation)
        low, high = _ends(place, "within", given)
        return stats.truncnorm((low - mean) / deviation, (high - mean) / deviation, mean, deviation)
    key = "uniform" if "uniform" in given else "within"
    low, high = _ends(place, key, given)
    return stats.uniform(low, high - low)


def _ends(place: str, key: str, given: Mapping[str, object]) -> tuple[float, float]:
    low, high = _pair(f"{place}.{key}", given.get(key))
    if not low < high:
        raise PlanError(f"{place}.{key} = [{low:g}, {high:g}]: expected low < high")
    return low, high


def _drawn(uncertain: dict[str, Law], sampling: str, samples: int, seed: int) -> dict[str, np.ndarray]:
    from scipy.stats import qmc

    count = len(uncertain)
    generator = np.random.default_rng(seed)
    if sampling == "random":
        places = generator.random((samples, count))
    elif sampling == "sobol":
        power = int(np.ceil(np.log2(samples)))
        places = qmc.Sobol(count, rng=generator).random_base2(power)[:samples]
    else:
        places = qmc.LatinHypercube(count, rng=generator).random(samples)
    places = np.clip(places, ATLAS.inside, 1.0 - ATLAS.inside)
    return {name: np.asarray(law.ppf(places[:, i])) for i, (name, law) in enumerate(uncertain.items())}


def _pair(place: str, value: object) -> tuple[float, float]:
    if not isinstance(value, list | tuple) or len(value) != 2:
        raise PlanError(f"{place} = {value!r}: expected two numbers")
    return _number(f"{place}[0]", value[0]), _number(f"{place}[1]", value[1])


def _number(place: str, value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float | np.number) or not np.isfinite(value):
        raise PlanError(f"{place} = {value!r} is no finite number")
    return float(value)
