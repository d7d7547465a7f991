"""A hardening oscillator in millimetres without contacts: two motions without events, each its own mirror image, are two motions like any other."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import contvines as cv
from contvines.plots.atlas import plot_atlas
from orbits.symbols import cos
from tests.orbits.declared.oscillators import oscillator

pytest.importorskip("pint")

MASS, DAMPING, STIFFNESS, CUBIC, FORCE = 0.5, 0.9, 500.0, 2e7, 0.7


HARDENING = oscillator(
    lambda s, phase, p, c: (FORCE * cos(phase) - DAMPING * s.v - STIFFNESS * s.x - CUBIC * s.x**3) / MASS,
    parameters={"frequency": 7.0}, mirror={}, units={"x": "mm", "v": "mm/s", "frequency": "Hz"}, response="max_abs_x",
)  # fmt: skip


def size(x, v, frequency):
    """Largest displacement [mm] of what a start settles on, by DOP853."""
    omega = 2.0 * np.pi * frequency

    def rates(t, y):
        return [
            y[1],
            (FORCE * np.cos(omega * t) - DAMPING * y[1] - STIFFNESS * y[0] - CUBIC * y[0] ** 3) / MASS,
        ]

    options = {"method": "DOP853", "rtol": 1e-9, "atol": 1e-12}
    settled = solve_ivp(rates, (0.0, 100.0 / frequency), [x * 1e-3, v * 1e-3], **options).y[:, -1]
    period = solve_ivp(rates, (0.0, 1.0 / frequency), settled, max_step=1e-3 / frequency, **options)
    return 1e3 * np.abs(period.y[0]).max()


def test_basins_tell_them_apart_and_know_no_mirror_images():
    basins = cv.basins(HARDENING, "frequency", 7.0, within={"x": (-6.0, 6.0), "v": (-150.0, 150.0)}, points=8)
    assert len(basins.attractors) == 2 and not any(about.mirror_share for about in basins.attractors)
    assert all(
        basins.told(k).startswith("no events through x = ") and " mm/s" in basins.told(k) for k in (0, 1)
    )
    large = {k: size(*(basins.states[k]), 7.0) > 4.0 for k in (0, 1)}
    assert sorted(large.values()) == [False, True]
    for i, k in ((0, 0), (3, 4), (7, 2)):  # rows are v
        assert large[int(basins.index[i, k])] == (size(basins.x[k], basins.y[i], 7.0) > 4.0)


@pytest.mark.slow
def test_an_atlas_has_both_on_branches_of_their_own():
    atlas = cv.atlas(
        HARDENING, over="frequency", within=(6.0, 7.5), values=[6.71875, 7.2], starts=32, scan=0, depth=0
    )
    assert {about.branch for about in atlas.attractors} == {"B1", "B2"}
    known = [size(-2.0, 0.0, 6.9), size(5.0, 100.0, 6.9)]
    found = []
    for branch in atlas:
        near = min(range(len(branch)), key=lambda i: abs(branch.values[i] - 6.9) + (not branch.stable[i]))
        found.append(branch.orbit(near).measure("max_abs_x"))
    assert sorted(found) == pytest.approx(known, rel=0.03)
    legend = plot_atlas(atlas).axes[1].get_legend()
    assert {text.get_text() for text in legend.get_texts()} == {"no events (B1)", "no events (B2)"}
    erosion = cv.robustness(atlas["B1"], 7.0)
    assert (erosion.word, erosion.reaches) == ("no events", "no events") and 1.0 < erosion.distance < 20.0
