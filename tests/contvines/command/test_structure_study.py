"""Studies of structures: NLvib's grazes of two masses, and what is refused."""

from pathlib import Path

import numpy as np
import pytest

import contvines as cv
from contvines.command.study import StudyError, read_study

EXAMPLE = Path(__file__).parents[3] / "examples" / "structures" / "two_masses.toml"
GRAZES = (0.5818996390393119, 0.6534401404162605)  # |receptance x1 of a force on 2| times 0.1 is 1


@pytest.mark.slow
def test_the_grazes_of_two_masses_are_borders(run, tmp_path):
    path = tmp_path / "two.toml"
    path.write_text(EXAMPLE.read_text())
    done = run("diagram", path)
    assert done[0] == 0, done[2]
    graph = cv.load(path.with_suffix(".vines"))  # without running anything
    values = sorted(float(point.value) for point in graph.of_kind("switch-graze"))
    np.testing.assert_allclose(values, GRAZES, rtol=1e-12)
    assert all(branch.problem is not None for branch in graph.branches.values())


def test_studies_name_the_field(tmp_path):
    text = EXAMPLE.read_text()
    for before, after, says in (
        ("at = 2", "at = 3", r"\[model\] forces\[0\]: at = 3"),
        ("mass = [[1, 0], [0, 1]]\n", "", "mass is missing"),
        ("frequency = 0.75", "frequency = 0.75\nwall_gapp = 2.0", "wall_gap"),
    ):
        (tmp_path / "s.toml").write_text(text.replace(before, after))
        with pytest.raises(StudyError, match=says):
            read_study(tmp_path / "s.toml")


def test_a_survey_of_a_page_has_its_units(tmp_path):
    from contvines.command.survey_study import units_of

    (tmp_path / "two.toml").write_text(
        '[model]\nname = "coupled_two"\n[continue]\nparameter = "frequency"\nwithin = [7.6, 8.4]\n[survey]\nvary.friction_1 = [0.1]\n'
        'outcomes = ["largest:peak_force", "largest:max_q"]\n'
    )
    study = read_study(tmp_path / "two.toml")
    units = units_of(study, study.model)
    assert (
        units["largest_peak_force"] == "N"
        and units["largest_max_q"] == "mm"
        and units["largest_max_q_at"] == "Hz"
    )
