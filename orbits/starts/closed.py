"""The orbits of a machine that are known in closed form."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from orbits.machines.base import Model
from orbits.starts.find import polish
from orbits.words import Word

if TYPE_CHECKING:
    from orbits.orbit import Orbit


def closed_orbits(model: Model, params: np.ndarray, made: type[Orbit]) -> Iterator[Orbit]:
    """The real ones among rest and the orbits of `Model.closed_words`, stable or not.

    Parameters
    ----------
    model : Model
    params : float array (P,)
    made : type
        Of what is yielded: a kind of `orbits.orbit.Orbit`.
    """
    rest = made.at_rest(model, params)
    if rest.real:
        yield rest
    for text in model.closed_words:
        word = Word.parse(text, frictionless=model.frictionless(params))
        for nodes in model.start_nodes(word, 1, params):
            orbit = polish(made(model, word, 1, nodes, params))
            if orbit is not None and orbit.real:
                yield orbit
