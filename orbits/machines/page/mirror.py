"""The mirror image of a declared machine's motions: all states change sign, contacts change places, half a forcing period later.

A machine may have this symmetry only at some values of its parameters: a slope of zero, walls at equal distances.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

import numpy as np

from orbits.contacts.dry_friction import DryFriction
from orbits.contacts.wall import Wall
from orbits.integrators.expressions import Values
from orbits.machines.page.checks import DRAWS, Draws
from orbits.machines.page.page import PageError
from orbits.machines.page.patterns import Equations
from orbits.settings import FORMULAS
from orbits.symbols import Symbol

VARIED = 0.5  # largest relative change of the varying parameter (absolute, if it is 0)


class MirrorImage:
    """The mirror image as the machine file declares it, checked at the file's own parameters.

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
        Switches whose sign changes.

    Raises
    ------
    PageError
        If the image is no motion of the machine; the message says at which state, and by how much.
    """

    def __init__(self, equations: Equations, params: np.ndarray, pairs: Mapping[str, str]) -> None:
        e = self.equations = equations
        self.images = _images(e, pairs)
        draws = Draws(e, params)
        self.turned = self._turned_switches(draws)
        # name, formula, formula whose mirror image equals it, and that image's sign
        rows: list[tuple[str, Symbol, Symbol, float]] = []
        for name, kind, j, table in e.formulas():
            turns = kind == "velocity" or (kind == "surface" and j in self.turned)
            rows.append((name, table[j], table[self.images[j]], -1.0 if turns else 1.0))
        rates = e.pattern(e.pattern_key([1 if j in e.signed else 0 for j in range(len(e.contacts))])).rates
        rows += [(f"motion's rate of {name}", rate, rate, -1.0) for name, rate in zip(e.states, rates)]
        names, own, images, signs = zip(*rows)
        self._own, self._image, self._signs = Values(e.layout, own), Values(e.layout, images), np.array(signs)
        self._holds = lru_cache(maxsize=256)(self._checked)
        for name, values, image_values in zip(names, *(table.T for table in self._values_of_both(draws))):
            wrong = self._worst_state(values, image_values)
            if wrong is not None:
                state = ", ".join(f"{n} = {v:.4g}" for n, v in zip(e.states, draws.states[wrong]))
                phase_text = f", phase = {draws.clock[wrong]:.4g}" if e.phase_rate is not None else ""
                raise PageError(
                    f"mirror: {name} is not the mirror image: at {state}{phase_text} it is {float(values[wrong]):.6g}, its image "
                    f"gives {float(image_values[wrong]):.6g}; set mirror=None, or correct the formula"
                )

    def holds(self, params: np.ndarray, varying: int | None = None) -> bool:
        """Return whether the machine has the mirror image at these parameters and at all values of the varying one."""
        return self._holds(params.tobytes(), varying)

    def _checked(self, values: bytes, varying: int | None) -> bool:
        params = np.frombuffer(values)
        draws = Draws(self.equations, params)
        if varying is not None:
            size = abs(float(params[varying])) or 1.0
            draws.params[:, varying] += VARIED * size * np.linspace(-1.0, 1.0, DRAWS)
        own, image = self._values_of_both(draws)
        return all(self._worst_state(a, b) is None for a, b in zip(own.T, image.T))

    def _values_of_both(self, draws: Draws) -> tuple[np.ndarray, np.ndarray]:
        """Return values of all formulas at random states, and values of their images, both of shape (DRAWS, count)."""
        e, signs = self.equations, np.empty_like(draws.signs)
        for place, j in enumerate(e.signed):
            turns = isinstance(e.contacts[j], DryFriction) or j in self.turned
            signs[:, e.signed.index(self.images[j])] = (
                -draws.signs[:, place] if turns else draws.signs[:, place]
            )
        with np.errstate(all="ignore"):
            own = self._own(draws.states, draws.clock, np.hstack([draws.params, draws.signs]))
            image = self._image(-draws.states, draws.clock + np.pi, np.hstack([draws.params, signs]))
        return own, image * self._signs

    def _turned_switches(self, draws: Draws) -> frozenset[int]:
        """Return the switches whose surface is closer to minus its image."""
        e, found = self.equations, set()
        for j, k in self.images.items():
            if not isinstance(e.contacts[j], (Wall, DryFriction)):
                own = draws.of([e.surface[j]])
                image = draws.of([e.surface[k]], states=-draws.states, clock=draws.clock + np.pi)
                if np.abs(own + image).max() < np.abs(own - image).max():
                    found.add(j)
        return frozenset(found)

    @staticmethod
    def _worst_state(own: np.ndarray, image: np.ndarray) -> int | None:
        """Return the state at which a formula and its image differ most; None if they agree."""
        gap = np.abs(own - image)
        agree = np.nanmax(gap) <= FORMULAS.same * (1.0 + np.nanmax(np.abs(own)))
        return None if agree else int(np.nanargmax(gap))


def _images(equations: Equations, pairs: Mapping[str, str]) -> dict[int, int]:
    """Return contact -> its mirror image, as declared."""
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
