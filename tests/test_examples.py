"""Every example and every teaching study runs, and its special points are those of closed forms and of the literature."""

import runpy
from math import hypot, pi, sqrt
from pathlib import Path

import numpy as np
import pytest

from contvines.store import load
from tests.contvines.studies import table
from tools.fuzz.many_digits import exact

pytestmark = pytest.mark.slow

EXAMPLES = Path(__file__).parents[1] / "examples"


@pytest.fixture
def script(tmp_path, monkeypatch, capsys):
    """The names of an example that has run as a user runs it."""
    monkeypatch.chdir(tmp_path)

    def names(name):
        found = runpy.run_path(str(EXAMPLES / f"{name}.py"), run_name="__main__")
        assert "branches in" in capsys.readouterr().out
        return found

    return names


def values(graph, kind):
    return sorted(point.value for point in graph.of_kind(kind))


def absorber(place, friction=0.5, gravity=0.211):
    """Amplitude of the fold (LP1) or the symmetry breaking (SB1) of the symmetric motion LR of the absorber: C^2 from its closed form.

    C^2 = (1 - pi beta/2)^2 + (R beta + H)^2: d/d beta = 0 at the fold.
    """
    R, H = (1 - 0.76) / (1 + 0.76), pi / 2 * 1.006 * friction * gravity
    beta = (2 * pi - 4 * R * H) / (pi**2 + (4 * R**2 if place == "LP1" else -4))
    return hypot(1 - pi * beta / 2, R * beta + H)


def test_the_closed_forms_are_those_that_are_printed():
    assert (absorber("LP1") ** 2, absorber("SB1") ** 2) == pytest.approx((0.0637942, 0.5282903), abs=5e-8)


def test_pitchfork_and_its_perturbed_twin(script):
    names = script("pitchfork")
    perfect = names["perfect"]()
    broken = values(perfect, "symmetry-breaking") + values(perfect, "branch-point")
    assert broken == pytest.approx([0.0], abs=1e-10)
    assert len(perfect.branches) == 2  # the mirror image is recorded, not traced
    h = 0.02
    perturbed = names["perturbed"](h)
    # x' = h + p x - x^3: the fold of the detached branch lies at p = 3 (h/2)^(2/3) (Strogatz, section 3.6)
    assert values(perturbed, "fold") == pytest.approx([3 * (h / 2) ** (2 / 3)], abs=1e-10)
    assert values(perturbed, "branch-point") == []


def test_henon_cascade(script):
    b = 0.3
    first, second, third = values(script("henon")["graph"], "period-doubling")[:3]
    assert first == pytest.approx(0.75 * (1 - b) ** 2, abs=1e-10)
    assert second == pytest.approx((1 - b) ** 2 + (1 + b) ** 2 / 4, abs=1e-10)
    # later ones contract by Feigenbaum's ratio, 4.669 in the limit
    assert (second - first) / (third - second) == pytest.approx(4.669, rel=0.2)


def test_scripts(script, tmp_path):
    assert {p.stem for p in EXAMPLES.glob("*.py")} == {"pitchfork", "henon", "absorber", "neutral_saddle"}
    script("neutral_saddle")
    script("absorber")
    graph = load(tmp_path / "absorber.vines", problems=False)
    for label in ("LP1", "SB1"):
        assert graph[label].value == pytest.approx(absorber(label), rel=1e-9)
    assert (tmp_path / "absorber.png").exists()


R = 0.8
FOLD = pi * (1 - R) / (1 + R)
SLIP = 1.006 * 0.5 * 0.211
PAPER = {label: absorber(label) for label in ("LP1", "SB1")}
# the ball lands when the table gives back what a bounce loses; multiplier -1 of the linearised return
BALL = {"LP1": FOLD, "PD1": hypot(FOLD, 2 * (1 + R * R) / (1 + R) ** 2)}
STUDIES = {
    "friction": PAPER,
    "friction_low": {label: absorber(label, 0.1, 0.422) for label in PAPER},
    "frequency": {},
    "bouncing_ball": {"PD1": BALL["PD1"]},
    "teaching/absorber": PAPER,
    "teaching/bouncing_ball": BALL,
    # the linear response reaches the wall
    "teaching/impact_oscillator": {"WG1": hypot(1 - 0.8**2, 2 * 0.05 * 0.8)},
    # the floor's acceleration reaches friction; sliding without rest (Den Hartog 1931, without a spring)
    "teaching/stick_slip": {"ST1": SLIP, "ST2": SLIP * sqrt(1 + pi**2 / 4)},
    "teaching/own": {"HB1": 2.0},
}


@pytest.fixture
def study(tmp_path, monkeypatch):
    """Runs a verb on a study of the examples."""
    from contvines.command.cli import main

    monkeypatch.chdir(tmp_path)

    def run(verb, name, *options):
        with pytest.raises(SystemExit) as end:
            main([verb, str(EXAMPLES / f"{name}.toml"), "--quiet", *options])
        assert not end.value.code

    return run


@pytest.mark.parametrize("name", STUDIES)
def test_special_points_of_studies_are_the_closed_forms(name, study):
    if name == "teaching/impact_oscillator":
        pytest.importorskip("heyoka")
    study("diagram", name, "--no-look", "--plot", "a.png")
    graph = load(f"{Path(name).stem}.vines", trust=True)
    found = {label: graph.special[label].value for label in STUDIES[name]}
    assert found == pytest.approx(STUDIES[name], rel=1e-9)
    assert graph.finished and all(branch.real for branch in graph.branches.values())
    if "SB1" in found:
        assert [s.point for s in graph.switches if s.kind == "symmetry-breaking"] == ["SB1"]
        assert graph.special["SB1"].mirror
    if name == "teaching/own":  # the period of the first cycles, 2 pi / a
        assert graph["B2"].measure("period")[0] == pytest.approx(2 * pi, rel=1e-3)
    if name == "frequency":
        check_frequency_response(graph)


def check_frequency_response(graph):
    assert {"LR", "tt"} <= {branch.description["word"] for branch in graph}
    # event-driven simulation, which knows nothing of the continuation, follows a stable orbit of every stable branch
    for branch in graph:
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


def test_every_study_is_checked_and_every_teaching_study_told():
    page = (EXAMPLES.parent / "docs" / "teaching.md").read_text(encoding="utf-8")
    paths = [*EXAMPLES.glob("*.toml"), *EXAMPLES.glob("teaching/*.toml")]
    names = {path.relative_to(EXAMPLES).with_suffix("").as_posix() for path in paths}
    assert names == set(STUDIES)
    assert all(f"examples/{name}.toml" in page for name in names if "teaching/" in name)


def test_a_ball_on_a_table_begins_to_bounce_where_the_table_falls_faster_than_it(study):
    study("sweep", "bouncing_ball")
    rows = table("bouncing_ball-sweep.csv")
    assert rows and all((row["attractor"] == "stuck") == (float(row["value"]) < 1.0) for row in rows)
