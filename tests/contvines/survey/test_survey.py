"""Surveys: the same rows from one process, from two, and from a cluster that loses a worker; resumed, kept, read, drawn."""

import json
import os
import signal

import numpy as np
import pytest

from contvines.survey import PlanError, load_survey, survey
from tests.contvines.studies import table
from tests.contvines.survey.circles import Circles, size

pytestmark = pytest.mark.slow

VARY = {"radius": [0.5, 1.0, 1.5, 2.0, 4.0], "scale": [1.0, 4.0]}
ASKED = {"over": "p", "within": (-3.0, 3.0), "outcomes": (size, "peak", "covered")}


def run(folder="", deadly=-1.0, **options):
    return survey(Circles(str(folder), deadly), VARY, **{**ASKED, **options})


@pytest.fixture(scope="module")
def one():
    return run(workers=1, about={"what": "circles"}, units={"size": "mm", "radius": "m"})


def same(a, b):
    return all(np.array_equal(a[name], b[name], equal_nan=True) for name in a.columns) and np.array_equal(
        a.notes, b.notes
    )


def test_outcomes_are_those_of_circles(one):
    radius, scale = (np.array(VARY[name]) for name in VARY)
    wanted = radius[:4, None] * np.sqrt(scale)[None, :]
    np.testing.assert_allclose(one["size"][:4], wanted, rtol=1e-9)
    assert np.all(one["folds"][:4] == 2.0)


def test_a_system_that_fails_is_a_row_with_its_sentence(one):
    assert np.all(np.isnan(one["size"][4])) and one.failed == 2
    assert one.notes[4, 0] == "radius = 4 is more than 3; expected a smaller one"
    assert "2 of them failed" in str(one)


def test_two_processes_and_a_lost_worker(one, tmp_path):
    assert same(one, run(tmp_path, 1.5, workers=2))
    assert (tmp_path / "died").exists()


def test_a_cluster_that_loses_a_worker(one):
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        killed = []

        def kill(row):
            if not killed:
                pid = next(iter(cluster.workers.values())).pid
                killed.append(pid)
                os.kill(pid, signal.SIGKILL)

        found = run(cluster=cluster.scheduler_address, progress=kill)
    assert killed and same(one, found)


def test_a_killed_survey_goes_on(one, tmp_path):
    place, seen = tmp_path / "rows", []

    def stop(row):
        seen.append(row)
        if len(seen) == 4:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt) as stopped:
        run(workers=1, journal=place, progress=stop)
    left = stopped.value.graph
    assert (left.failed, left.waiting) == (0, 6) and "6 not done yet" in repr(left)
    with place.open("a") as file:
        file.write('{"index": 7, "colu')  # cut short
    again = []
    found = run(workers=1, journal=place, progress=again.append)
    assert len(again) == 6 and same(one, found)
    other = []
    survey(Circles(), {"radius": [1.0]}, **ASKED, workers=1, journal=place, progress=other.append)
    assert len(other) == 1  # the rows of another survey are not taken over


def test_files_hold_every_number(one, tmp_path):
    pytest.importorskip("xarray")
    one.save(tmp_path / "s.nc")
    back = load_survey(tmp_path / "s.nc")
    assert same(one, back) and back.units == one.units and back.about == one.about
    rows = table(tmp_path / "s.csv")
    assert len(rows) == 10 and float(rows[3]["size [mm]"]) == one["size"][1, 1]
    assert rows[9]["note"].startswith("radius = 4") and rows[9]["size [mm]"] == ""
    data = one.to_xarray()
    assert data["size"].attrs["units"] == "mm" and list(data["size"].dims) == ["radius", "scale"]
    assert json.loads(data.attrs["about"])["axes"]["radius"] == VARY["radius"]
    assert list(back.plan.axes) == list(one.plan.axes)
    (tmp_path / "no.nc").write_text("nothing")
    with pytest.raises(PlanError, match="not the NetCDF file of a survey"):
        load_survey(tmp_path / "no.nc")


def test_the_best_of_a_survey(one):
    assert one.best("size") == ({"radius": 0.5, "scale": 1.0}, pytest.approx(0.5, rel=1e-9))
    point, value = one.best("size", largest=True)
    assert point == {"radius": 2.0, "scale": 4.0} and value == pytest.approx(4.0, rel=1e-9)


def test_bands_and_maps_are_drawn(one):
    assert one.plot("size").axes[0].get_xlabel() == "radius [m]"
    drawn = survey(
        Circles(), {"radius": [1.0, 2.0], "scale": {"uniform": [1, 2]}}, over="p", within=(-3.0, 3.0),
        outcomes=(size,), workers=1,
    )  # fmt: skip
    assert drawn["size"].shape == (2, 32)
    labels = [text.get_text() for text in drawn.plot().axes[0].get_legend().get_texts()]
    assert labels == ["all samples", "95 %", "half of them", "median"]
    with pytest.raises(ValueError, match="no such outcome"):
        drawn.plot("weight")
