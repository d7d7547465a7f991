"""Every example runs, and its numbers are those of the literature."""

import importlib.util
import runpy
from pathlib import Path

import numpy as np
import pytest

from tools.fuzz.many_digits import exact

pytestmark = pytest.mark.slow

EXAMPLES = Path(__file__).parents[1] / "examples"
SCRIPTS = {"pitchfork", "henon", "absorber", "neutral_saddle"}
STUDIES = {"friction", "friction_low", "frequency", "bouncing_ball"}


def example(name):
    spec = importlib.util.spec_from_file_location(f"example_{name}", EXAMPLES / f"{name}.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def values(graph, kind):
    return sorted(point.value for point in graph.of_kind(kind))


def test_no_example_is_forgotten():
    assert {p.stem for p in EXAMPLES.glob("*.py")} == SCRIPTS
    assert {p.stem for p in EXAMPLES.glob("*.toml")} == STUDIES


@pytest.mark.parametrize("name", sorted(SCRIPTS))
def test_scripts_run_as_a_user_runs_them(name, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(EXAMPLES / f"{name}.py"), run_name="__main__")
    assert "branches in" in capsys.readouterr().out


def test_pitchfork_and_its_perturbed_twin():
    module = example("pitchfork")
    perfect = module.perfect()
    broken = values(perfect, "symmetry-breaking") + values(perfect, "branch-point")
    assert broken == pytest.approx([0.0], abs=1e-10)
    assert len(perfect.branches) == 2  # the mirror image is recorded, not traced
    h = 0.02
    perturbed = module.perturbed(h)
    # x' = h + p x - x^3: the fold of the detached branch lies at p = 3 (h/2)^(2/3) (Strogatz, section 3.6)
    assert values(perturbed, "fold") == pytest.approx([3 * (h / 2) ** (2 / 3)], abs=1e-10)
    assert values(perturbed, "branch-point") == []


def test_henon_cascade():
    graph = example("henon").main()
    b = 0.3
    doublings = values(graph, "period-doubling")
    assert doublings[0] == pytest.approx(0.75 * (1 - b) ** 2, abs=1e-10)
    assert doublings[1] == pytest.approx((1 - b) ** 2 + (1 + b) ** 2 / 4, abs=1e-10)
    # later ones contract by Feigenbaum's ratio, 4.669 in the limit
    ratio = (doublings[1] - doublings[0]) / (doublings[2] - doublings[1])
    assert ratio == pytest.approx(4.669, rel=0.2)


def absorber_closed_forms(restitution, friction, gravity, mass_ratio):
    """C^2 of fold and symmetry breaking of the symmetric orbit LR at Omega = 1, from its closed form."""
    from math import pi

    R = (1 - restitution) / (1 + restitution)
    H = pi / 2 * (1 + mass_ratio) * friction * gravity

    def square(beta):
        return (1 - pi * beta / 2) ** 2 + (R * beta + H) ** 2

    top = 2 * pi - 4 * R * H
    return square(top / (pi**2 + 4 * R**2)), square(top / (pi**2 - 4))


def test_absorber(tmp_path):
    graph = example("absorber").main(tmp_path / "a.vines", tmp_path / "a.png")
    fold, breaking = absorber_closed_forms(0.76, 0.5, 0.211, 0.006)
    # printed to seven digits in the literature as well: 0.0637942 and 0.5282903
    assert (fold, breaking) == pytest.approx((0.0637942, 0.5282903), abs=5e-8)
    assert values(graph, "fold")[0] ** 2 == pytest.approx(fold, abs=1e-9)
    (point,) = graph.of_kind("symmetry-breaking")
    assert point.value**2 == pytest.approx(breaking, abs=1e-9)
    assert (tmp_path / "a.png").exists()


@pytest.mark.parametrize(("name", "machine"), [("friction", (0.5, 0.211)), ("friction_low", (0.1, 0.422))])
def test_studies(name, machine, tmp_path, monkeypatch):
    from contvines.command.cli import main
    from contvines.store import load

    monkeypatch.chdir(tmp_path)
    main_status = 0
    try:
        main(["diagram", str(EXAMPLES / f"{name}.toml"), "--quiet", "--plot", "a.png"])
    except SystemExit as end:
        main_status = end.code or 0
    assert main_status == 0
    graph = load(f"{name}.vines", problems=False)
    fold, breaking = absorber_closed_forms(0.76, *machine, 0.006)
    assert values(graph, "fold")[0] ** 2 == pytest.approx(fold, abs=1e-9)
    assert values(graph, "symmetry-breaking")[0] ** 2 == pytest.approx(breaking, abs=1e-9)
    assert all(branch.real for branch in graph.branches.values())
    asymmetric = [s.target for s in graph.switches if s.kind == "symmetry-breaking"]
    assert len(asymmetric) == 1
    assert graph.special[next(s.point for s in graph.switches if s.kind == "symmetry-breaking")].mirror


def test_a_ball_on_a_sinusoidal_table(tmp_path, monkeypatch, capsys):
    import csv
    import json
    from math import hypot, pi

    from contvines.command.cli import main

    monkeypatch.chdir(tmp_path)
    for command in (
        ["diagram", str(EXAMPLES / "bouncing_ball.toml"), "--quiet", "--plot", "a.png"],
        ["sweep", str(EXAMPLES / "bouncing_ball.toml"), "--quiet"],
        ["orbit", "bouncing_ball.vines", "PD1", "--json"],
    ):
        with pytest.raises(SystemExit) as end:
            main(command)
        assert not end.value.code
    shown = json.loads(capsys.readouterr().out)
    # table acceleration over gravity, one bounce a period: begins at pi (1 - r)/(1 + r), doubles where the ball's
    # linearised return has -1 (derived in tests/orbits/machines/test_cavity.py)
    r = 0.8
    fold = pi * (1 - r) / (1 + r)
    flip = hypot(fold, 2 * (1 + r * r) / (1 + r) ** 2)
    assert shown["parameters"]["amplitude"] == pytest.approx(flip, abs=1e-12)
    with open("bouncing_ball-sweep.csv") as file:
        rows = list(csv.DictReader(file))
    # from rest the ball lies on the table until the table falls faster than the ball
    assert all((row["attractor"] == "stuck") == (float(row["value"]) < 1.0) for row in rows)


def test_frequency_response_of_the_coupled_machine(tmp_path, monkeypatch):
    from contvines.command.cli import main
    from contvines.store import load

    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as end:
        main(["diagram", str(EXAMPLES / "frequency.toml"), "--quiet"])
    assert not end.value.code
    graph = load("frequency.vines")
    assert graph.finished
    assert all(branch.real for branch in graph.branches.values())
    words = {branch.description["word"] for branch in graph.branches.values()}
    assert {"LR", "tt"} <= words
    # event-driven simulation, which knows nothing of the continuation, follows a stable orbit of every stable branch
    for branch in graph.branches.values():
        inside = [i for i in range(1, len(branch) - 1) if branch.stable[i - 1 : i + 2].all()]
        if inside:
            assert branch.orbit(inside[len(inside) // 2]).replay() < 1e-6, branch
    # a pair passes the circle and comes back within 7e-6, in the step in which real multipliers meet; confirmed in many digits
    pairs = [
        point
        for point in graph.of_kind("neimark-sacker")
        if abs(point.value - 1.0015) < 2e-5 and graph[point.branch].description["word"] == "LRLttRLt"
    ]
    assert len(pairs) == 2
    for point in pairs:
        seen = exact(point.orbit).multipliers
        assert np.abs(np.abs(seen[np.abs(seen.imag) > 0.05]) - 1.0).max() < 1e-9
