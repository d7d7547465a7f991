"""Cycles of a piecewise linear map next to its border, solved for one by one, beside what their determinants say of them."""

import numpy as np
import pytest

from orbits.borders.rounds import Rounds

ROUNDS = 8


def cycle(maps, b, border, word):
    """Distances from the border of a cycle's points, in the order of the word, and its largest multiplier."""
    M, v = np.eye(len(b)), np.zeros(len(b))
    for k in word:
        M, v = maps[k] @ M, maps[k] @ v + b
    x, distances = np.linalg.solve(np.eye(len(b)) - M, v), []
    for k in word:
        distances.append(border @ x)
        x = maps[k] @ x + b
    return np.array(distances), np.abs(np.linalg.eigvals(M)).max()


@pytest.mark.parametrize("size", [1, 2, 4])
def test_no_cycle_that_is_real_and_stable_is_given_up(size):
    generator = np.random.default_rng(size)
    told, wanted = 0, 0
    for _ in range(60):
        plain = 0.6 * generator.standard_normal((size, size))
        border, b = generator.standard_normal((2, size))
        maps = np.array([plain, plain + np.outer(generator.standard_normal(size), border)])
        hopeless = Rounds(maps, 1e-14, linear=True).hopeless(ROUNDS)
        for rounds in range(2, ROUNDS + 1):
            for changed in {1, rounds - 1}:
                word = [1] * changed + [0] * (rounds - changed)
                distances, radius = cycle(maps, b, border, word)
                side = distances * np.where(np.array(word) == 1, 1.0, -1.0)
                real = (side > 0.0).all() or (side < 0.0).all()
                if real and (radius < 1.0 or rounds == 2):
                    wanted += 1
                    assert (rounds, changed) not in hopeless
                elif (rounds, changed) in hopeless:
                    told += 1
    assert wanted > 4
    assert told > 400  # most of the others are told from their determinants
