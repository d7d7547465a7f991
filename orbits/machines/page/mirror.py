"""The mirror image of a declared machine's motions: all states change sign, contacts change places, half a forcing period on.

A machine may have it at some values of its parameters only: a slope of zero, walls that are equally far.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property, lru_cache
from typing import Any

import numpy as np

from orbits.contacts.dry_friction import DryFriction
from orbits.contacts.wall import Wall
from orbits.integrators.expressions import Values
from orbits.machines.page.checks import DRAWS, Draws
from orbits.machines.page.page import PageError
from orbits.machines.page.patterns import Equations
from orbits.settings import FORMULAS

VARIED = 0.5  # parts of its own value (of 1, where it is 0) by which a parameter is varied


class MirrorImage:
    """What a page says of the mirror image, checked at the page's own parameters.

    Parameters
    ----------
    equations : Equations
    params : float array (P,)
    pairs : mapping of str to str
        Contacts that change places.

    Attributes
    ----------
    images : dict of int to int
        Contact -> its mirror image.
    turned : frozenset of int
        Switches whose sign turns.

    Raises
    ------
    PageError
        If the image is no motion of the machine; the sentence says where and by how much.
    """

    def __init__(self, equations: Equations, params: np.ndarray, pairs: Mapping[str, str]) -> None:
        self.equations = equations
        self.images = _images(equations, pairs)
        self.turned = self._turned(Draws(equations, params))
        self._holds = lru_cache(maxsize=256)(self._checked)
        draws = Draws(equations, params)
        here, there = self._both(draws)
        for k, (name, _, _, _) in enumerate(self._rows):
            wrong = self._wrong(here[:, k], there[:, k])
            if wrong is not None:
                state = ", ".join(f"{n} = {v:.4g}" for n, v in zip(equations.states, draws.states[wrong]))
                when = f", phase = {draws.clock[wrong]:.4g}" if equations.phase_rate is not None else ""
                raise PageError(
                    f"mirror: {name} is not the mirror image: at {state}{when} it is {float(here[wrong, k]):.6g}, its image "
                    f"gives {float(there[wrong, k]):.6g}; set mirror=None, or correct the formula"
                )

    def holds(self, params: np.ndarray, varying: int | None = None) -> bool:
        """Whether the machine has the mirror image at these parameters, whatever the value of the one that varies."""
        return self._holds(params.tobytes(), varying)

    def _checked(self, values: bytes, varying: int | None) -> bool:
        params = np.frombuffer(values)
        draws = Draws(self.equations, params)
        if varying is not None:
            size = abs(float(params[varying])) or 1.0
            draws.params[:, varying] += VARIED * size * np.linspace(-1.0, 1.0, DRAWS)
        here, there = self._both(draws)
        return all(self._wrong(a, b) is None for a, b in zip(here.T, there.T))

    @cached_property
    def _rows(self) -> list[tuple[str, Any, Any, float]]:
        """Name, formula, formula whose mirror image equals it, and that image's sign."""
        e, rows = self.equations, []
        for j, contact in enumerate(e.contacts):
            what, k = contact.described, self.images[j]
            if isinstance(contact, Wall):
                rows.append((f"the gap of {what}", e.gap[j], e.gap[k], 1.0))
                rows.append((f"the restitution of {what}", e.restitution[j], e.restitution[k], 1.0))
            elif isinstance(contact, DryFriction):
                rows.append((f"the velocity of {what}", e.velocity[j], e.velocity[k], -1.0))
                rows.append((f"the limit of {what}", e.limit[j], e.limit[k], 1.0))
            else:
                sign = -1.0 if j in self.turned else 1.0
                rows.append((f"the surface of {what}", e.surface[j], e.surface[k], sign))
        rates = e.pattern(e.pattern_key([1 if j in e.signed else 0 for j in range(len(e.contacts))])).rates
        rows += [(f"motion's rate of {name}", rate, rate, -1.0) for name, rate in zip(e.states, rates)]
        return rows

    @cached_property
    def _values(self) -> tuple[Values, Values]:
        layout = self.equations.layout
        return (
            Values(layout, [row[1] for row in self._rows]),
            Values(layout, [row[2] for row in self._rows]),
        )

    def _both(self, draws: Draws) -> tuple[np.ndarray, np.ndarray]:
        """Values of all formulas at random states, and those of their images there, both of shape (DRAWS, count)."""
        signs = np.empty_like(draws.signs)
        for place, j in enumerate(self.equations.signed):
            turns = isinstance(self.equations.contacts[j], DryFriction) or j in self.turned
            signs[:, self.equations.signed.index(self.images[j])] = draws.signs[:, place] * (
                -1.0 if turns else 1.0
            )
        own, image = self._values
        with np.errstate(all="ignore"):
            here = own(draws.states, draws.clock, np.hstack([draws.params, draws.signs]))
            there = image(-draws.states, draws.clock + np.pi, np.hstack([draws.params, signs]))
        return here, there * np.array([row[3] for row in self._rows])

    def _turned(self, draws: Draws) -> frozenset[int]:
        """Switches whose surface is nearer to minus its image."""
        e, found = self.equations, set()
        for j, k in self.images.items():
            if not isinstance(e.contacts[j], (Wall, DryFriction)):
                here = draws.of([e.surface[j]])
                there = draws.of([e.surface[k]], states=-draws.states, clock=draws.clock + np.pi)
                if np.abs(here + there).max() < np.abs(here - there).max():
                    found.add(j)
        return frozenset(found)

    @staticmethod
    def _wrong(here: np.ndarray, there: np.ndarray) -> int | None:
        """The state at which a formula and its image differ most; None where they agree."""
        gap = np.abs(here - there)
        agree = np.nanmax(gap) <= FORMULAS.same * (1.0 + np.nanmax(np.abs(here)))
        return None if agree else int(np.nanargmax(gap))


def _images(equations: Equations, pairs: Mapping[str, str]) -> dict[int, int]:
    """Contact -> its mirror image, as the page says it."""
    if not isinstance(pairs, Mapping):
        raise PageError(
            f"mirror = {pairs!r} must say which contacts change places, for example {{'L': 'R'}}; {{}} where none does"
        )
    contacts = equations.contacts
    by_letter = {letter: j for j, c in enumerate(contacts) for letter in (c.name, *c.letters)}
    images = {j: j for j in range(len(contacts))}
    for one, other in pairs.items():
        for letter in (one, other):
            if letter not in by_letter:
                raise PageError(
                    f"mirror = {dict(pairs)!r}: {letter!r} is no contact; there are {', '.join(by_letter)}"
                )
        a, b = by_letter[one], by_letter[other]
        if type(contacts[a]) is not type(contacts[b]):
            raise PageError(f"mirror: {one!r} and {other!r} are contacts of different kinds")
        images[a], images[b] = b, a
    return images
