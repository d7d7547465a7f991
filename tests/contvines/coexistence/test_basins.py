"""Shares with their intervals, boundaries, starts sorted by what they reach, values beyond stable stretches: by hand."""

from types import SimpleNamespace

import numpy as np
import pytest

import contvines as cv
from contvines.coexistence.basins import Basins
from contvines.coexistence.maps import MapPopulation
from contvines.graph.attractor import Attractor
from orbits import Absorber
from orbits.machines.physical import physical
from orbits.words import Word


def plane(index, mirrored, shares=()):
    attractors = [SimpleNamespace(share=share) for share in shares]
    x = np.arange(index.shape[1], dtype=float)
    return Basins(
        "p", 0.5, ("x", "y"), x, np.arange(index.shape[0], dtype=float), {}, index, mirrored, attractors
    )


@pytest.mark.parametrize("share", [0.0, 0.01, 0.37, 1.0])
def test_the_interval_of_a_share_is_wilson_s(share):
    """The shares q with (share - q)^2 = z^2 q (1 - q) / n."""
    n, z2 = 400, 1.96**2
    found = plane(np.zeros((20, 20), int), np.zeros((20, 20), bool), [share]).interval(0)
    roots = np.sort(np.roots([1.0 + z2 / n, -2.0 * share - z2 / n, share**2]).real)
    assert found == pytest.approx(roots, abs=1e-9)


def test_a_motion_and_the_mirror_image_of_another_have_a_boundary():
    """A straight one: the exponent is 1."""
    index = np.zeros((64, 64), int)
    index[:, 32:] = 1
    exponent, _ = plane(index, index == 0).uncertainty_exponent()
    assert exponent == pytest.approx(1.0, abs=0.15)
    with pytest.raises(ValueError, match="one motion alone"):
        plane(np.zeros((64, 64), int), np.zeros((64, 64), bool)).uncertainty_exponent()


def test_starts_reach_the_fixed_point_on_their_side():
    """x -> 1.5 x - x^3: fixed points +-sqrt(0.5), both with the multiplier 0; starts beyond sqrt(2.5) escape."""
    problem = cv.MapProblem(lambda x, p: p * x - x**3, [0.7], 1.5, scale=1.0)
    starts = np.array([[0.3], [-0.3], [0.9], [-1.0], [5.0], [1.1]])
    motions, index, _ = MapPopulation(problem, [(-2.0, 2.0)]).settle(starts, 1.5)
    assert [motions[k].kind for k in index] == ["periodic"] * 4 + ["escaped", "periodic"]
    ends = [float(motions[k].u[0]) for k in index if motions[k].kind == "periodic"]
    assert ends == pytest.approx(np.sqrt(0.5) * np.array([1.0, -1.0, 1.0, -1.0, 1.0]))


def test_basins_tell_their_shares_in_a_line_in_lines_and_in_a_table():
    index = np.zeros((20, 20), int)
    index[:, 15:] = 1
    found = plane(index, np.zeros((20, 20), bool))
    found.attractors = [
        Attractor(0.5, "LR", 1, "periodic", None, 0.75),
        Attractor(0.5, "", 0, "escaped", None, 0.25),
    ]
    assert repr(found) == "Basins(x x y, 20 x 20 starts at p = 0.5: LR 75.0%, escaped 25.0%)"
    lines = str(found).splitlines()
    low, high = found.interval(0)
    assert lines[0] == "400 starts in the plane x, y at p = 0.5"
    assert lines[2].split() == ["motion", "periods", "share", "95", "%", "interval"]
    assert lines[3].split()[:3] == ["LR", "k=1", "75.00%"] and f"{low:.2%} to {high:.2%}" in lines[3]
    assert lines[4].split()[:2] == ["escaped", "25.00%"] and len(lines) == 7
    assert found._repr_html_().count("<tr>") == 3 and "25.00%" in found._repr_html_()


@pytest.mark.parametrize("width", [60, 80, 200])
def test_the_table_of_basins_fits_its_terminal(width, monkeypatch):
    found = plane(np.arange(400).reshape(20, 20) % 2, np.zeros((20, 20), bool))
    words = ("(LtRLttR)^64", "LRttLRttLRtt")
    found.attractors = [Attractor(0.5, w, 12, "periodic", None, 0.5, mirror_share=0.2) for w in words]
    for place in ("coexistence.table", "text_table"):
        monkeypatch.setattr(f"contvines.{place}.terminal_width", lambda: width)
    lines = str(found).splitlines()
    assert max(map(len, lines)) <= width
    for word in words:
        (row,) = [line for line in lines if word in line]
        assert width == 60 or (row.split()[:3] == [word, "k=12", "50.00%"] and row.endswith("20.00%"))
    if width == 60:  # a line for each cell
        assert sum("k=12" in line for line in lines) == sum("20.00%" in line for line in lines) == 2


def test_a_motion_has_the_same_word_in_basins_as_on_the_graph():
    absorber = Absorber(restitution=0.76, friction=0.5, gravity=0.211, mass_ratio=0.006)
    found = cv.basins(absorber, "amplitude", 1.1, points=8)
    words = [about.word for about in found.attractors if about.kind == "periodic"]
    assert words and words == [Word.parse(word).spelled() for word in words]


def test_a_machine_with_units_is_drawn_and_told_in_them():
    """A half-width is 14 mm, and as much in the time of one radian of the free oscillation is 14 mm times 2 pi 8 Hz."""
    case = {
        "oscillator_mass": "3.8 kg", "natural_frequency": "8 Hz", "damping_ratio": 0.007, "absorber_mass": "32 g", "half_width": "14 mm",
        "restitution": 0.6, "friction": 0.1, "base_amplitude": "0.3 mm", "frequency": "7.9 Hz",
    }  # fmt: skip
    found = cv.basins(physical("coupled", case), over="frequency", at=7.9, points=6, fixed={"v": 0.5})
    (axes,) = found.plot().axes
    assert axes.get_xlim() == pytest.approx((14.0, -14.0))
    assert "[mm]" in axes.get_xlabel() and "[mm/s]" in axes.get_ylabel()
    fast = 14.0 * 2.0 * np.pi * 8.0
    assert max(axes.get_ylim()) / fast == pytest.approx(found.y[-1] + 0.5 * (found.y[1] - found.y[0]))
    assert axes.get_title(loc="left") == "frequency = 7.9 Hz" and "frequency = 7.9 Hz" in str(found)
    told = found.to_dict()
    assert told["fixed"]["v"] == pytest.approx(7.0) and told["units"]["v"] == "mm"
    assert told["units"]["frequency"] == "Hz"


def test_a_long_word_is_short_for_people_and_whole_in_json():
    word = "".join("LR" + "t" * k for k in range(1, 20))  # 2 * 19 + 190 events, no power of a shorter word
    found = plane(np.zeros((20, 20), int), np.zeros((20, 20), bool))
    found.attractors.append(Attractor(0.5, word, 19, "periodic", None, 1.0))
    for text in (str(found), found._repr_html_(), repr(found)):
        assert word not in text and word[:12] in text and "228 events" in text
    assert found.to_dict()["attractors"][0]["word"] == word
    assert word == found.attractors[0].name


def test_a_value_outside_the_interval_is_refused_before_the_starts(tmp_path):
    from typer.testing import CliRunner

    from contvines.command.cli import app
    from tests.contvines.studies import PAPER_MACHINE

    study = tmp_path / "study.toml"
    start = '[start]\nword = "LR"\nperiods = 1\namplitude = 0.55\n'
    study.write_text(PAPER_MACHINE + start + '[continue]\nparameter = "amplitude"\nwithin = [0.2, 1.3]\n')
    refused = str(CliRunner().invoke(app, ["basins", str(study), "--at", "55"]).exception)
    assert "--at 55" in refused and "[continue] within = [0.2, 1.3]" in refused


def test_saddles_of_another_interval_are_refused():
    problem = cv.MapProblem(lambda u, p: np.array([p * u[0], 0.5 * u[1]]), [0.0, 0.0], 0.5)
    graph = cv.diagram(problem, within=(0.2, 0.8), depth=0)
    with pytest.raises(ValueError, match=r"at = 0\.9 lies outside the interval of saddles, 0\.2 to 0\.8"):
        cv.basins(problem, at=0.9, points=2, saddles=graph)
