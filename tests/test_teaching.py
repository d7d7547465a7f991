"""Each teaching study gives what its text promises: special points at their closed forms, and stability beside them."""

from math import hypot, pi, sqrt
from pathlib import Path

import pytest

from contvines.command.cli import main
from contvines.store import load

pytestmark = pytest.mark.slow

FOLDER = Path(__file__).parents[1] / "examples" / "teaching"


def absorber(square_root_term):
    """Amplitude at which the symmetric motion LR of the absorber has d/d beta of C^2 = 0 (fold) or breaks its symmetry."""
    loss, friction = (1 - 0.76) / (1 + 0.76), pi / 2 * 1.006 * 0.5 * 0.211
    beta = (2 * pi - 4 * loss * friction) / (pi**2 + square_root_term(loss))
    return hypot(1 - pi * beta / 2, loss * beta + friction)


R = 0.8
FOLD = pi * (1 - R) / (1 + R)
SLIP = 1.006 * 0.5 * 0.211
EXPECTED = {
    # the ball lands when the table gives back what a bounce loses; multiplier -1 of the linearised return
    "bouncing_ball": {"LP1": FOLD, "PD1": hypot(FOLD, 2 * (1 + R * R) / (1 + R) ** 2)},
    # the linear response reaches the wall
    "impact_oscillator": {"WG1": hypot(1 - 0.8**2, 2 * 0.05 * 0.8)},
    # the floor's acceleration reaches friction; sliding without rest (Den Hartog 1931, without a spring)
    "stick_slip": {"ST1": SLIP, "ST2": SLIP * sqrt(1 + pi**2 / 4)},
    "absorber": {"LP1": absorber(lambda loss: 4 * loss**2), "SB1": absorber(lambda loss: -4)},
    "own": {"HB1": 2.0},
}


def test_no_study_is_forgotten():
    assert {path.stem for path in FOLDER.glob("*.toml")} == set(EXPECTED)


@pytest.mark.parametrize("name", sorted(EXPECTED))
def test_special_points_are_the_closed_forms(name, tmp_path, monkeypatch):
    if name == "impact_oscillator":
        pytest.importorskip("heyoka")
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as end:
        main(["diagram", str(FOLDER / f"{name}.toml"), "--quiet", "--no-look", "--plot", "a.png"])
    assert not end.value.code
    graph = load(f"{name}.vines", problems=False)
    assert {label: graph.special[label].value for label in EXPECTED[name]} == pytest.approx(
        EXPECTED[name], rel=1e-9
    )
    page = (FOLDER.parents[1] / "docs" / "teaching.md").read_text(encoding="utf-8")
    assert f"examples/teaching/{name}.toml" in page
    if name == "own":  # the period of the first cycles, 2 pi / a
        cycles = load("own.vines", trust=True)["B2"]
        assert cycles.measure("period")[0] == pytest.approx(2 * pi, rel=1e-3)
