"""Cycles of a piecewise linear map next to its border, solved for one by one, beside what their determinants say of them."""

import numpy as np
import pytest

from orbits.cycles.rounds import Rounds

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


def touching_cycle(plain, b, border, kick, rounds):
    """Distances of the points of the cycle of x -> A x + b mu, which adds g s where s^2 is the distance beyond the border, in its first
    round only, for small mu: of mu's sign, whichever lets it touch; and its derivative's largest multiplier."""
    n = len(b)
    power = np.linalg.matrix_power
    lead = np.linalg.inv(np.eye(n) - power(plain, rounds))
    still = lead @ sum(power(plain, k) for k in range(rounds)) @ b
    moved = lead @ power(plain, rounds - 1) @ kick
    # s^2 + (border.moved) s + mu (border.still) = 0 has the small root s for this mu
    s = 1e-6
    mu = -(s * s + s * (border @ moved)) / (border @ still)
    x, distances = mu * still + s * moved, []
    for k in range(rounds):
        distances.append(border @ x)
        x = plain @ x + mu * b + (s * kick if k == 0 else 0.0)
    M = power(plain, rounds - 1) @ (plain - np.outer(kick, border) / (2.0 * s))
    return np.array(distances), np.abs(np.linalg.eigvals(M)).max()


@pytest.mark.parametrize("size", [1, 2])
def test_no_cycle_that_touches_once_is_given_up_and_most_that_are_torn_are(size):
    generator = np.random.default_rng(size)
    told = missed = wanted = 0
    for _ in range(200):
        plain = 0.6 * generator.standard_normal((size, size))
        border, b, kick = generator.standard_normal((3, size))
        near, further = (np.array([plain, plain - np.outer(kick, border) / (2.0 * s)]) for s in (2e-5, 2e-4))
        hopeless = Rounds(near, 1e-13, False, further).hopeless(ROUNDS)
        for rounds in range(2, ROUNDS + 1):
            distances, radius = touching_cycle(plain, b, border, kick, rounds)
            real = (distances[1:] > 0.0).all()  # the first one's distance is -s^2
            assert distances[0] < 0.0
            if real and (radius < 1.0 or rounds == 2):
                wanted += 1
                assert (rounds, 1) not in hopeless
            elif not real and (rounds == 2 or radius < 1.0):
                told += (rounds, 1) in hopeless
                missed += (rounds, 1) not in hopeless
    assert wanted > 40
    assert told > 9 * missed
