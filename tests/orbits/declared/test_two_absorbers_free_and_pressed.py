"""Two absorbers on one oscillator: one that slides freely may lie anywhere; both are pressed to their walls by a hard swing."""

import numpy as np
import pytest

from orbits import coupled_two
from orbits.attractors import find_attractor
from orbits.population import Population
from orbits.simulation import simulate

AT = {"frequency": 7.8, "clearance_1": 15.0, "clearance_2": 10.0}


def test_where_an_absorber_slides_freely_does_not_make_another_motion():
    """No force and no impact of the other one knows its position: shifted it is the same motion."""
    drawn = np.random.default_rng(3).uniform(-1, 1, 6) * [0.004, 0.01, 0.008, 0.2, 0.2, 0.2]
    orbit = find_attractor(coupled_two, np.concatenate([[0.0], drawn]), **AT).orbit
    hits = {text for text in orbit.word.events if text[0] in "LR"}
    assert orbit.periods == 1 and hits in ({"L1", "R1"}, {"L2", "R2"})
    free = 1 if hits == {"L2", "R2"} else 2
    population = Population(coupled_two, "frequency", {**AT, "frequency": 7.8})
    starts = np.array([np.concatenate([[0.0], drawn])] * 4)[:, -population.starts(1, 0, 7.8).shape[1] :]
    starts[:, -6 + free] += [0.0, 0.0005, -0.001, 0.0015]  # metres; it lies between its walls still
    motions, index, _ = population.settle(starts, 7.8)
    words = [motions[k].word for k in set(index.tolist()) if motions[k].kind == "periodic"]
    assert words and len(set(words)) == len(words)


@pytest.mark.parametrize("amplitude", [7e3, 7e4])
def test_both_pressed_to_their_walls_hop_no_more(amplitude):
    """A swing of a thousand clearances decays like that of the oscillator with both masses on it, within what the impacts take as well."""
    run = simulate(
        coupled_two, {"q": amplitude, "x1": amplitude + 15.0, "x2": amplitude + 10.0}, periods=60, **AT
    )
    assert run.lasted == pytest.approx(60.0) and len(run) < 200 * 2 * 60
    share = 3.8 / (3.8 + 0.032 + 0.016)  # of the mass that is the oscillator's
    rate = 2.0 * np.pi * 8.0 * np.sqrt(share)
    decay = np.exp(-0.007 * 2.0 * np.pi * 8.0 * share * 60 / 7.8)
    q, speed = run.last[0], 1000.0 * run.last[3]  # mm, mm/s
    assert np.hypot(q, speed / rate) == pytest.approx(decay * amplitude, rel=0.08)
