"""`contvines rerun`: a result again from the study that its file keeps; a study that has changed is told with what differs."""

import json
import math
import sqlite3
from contextlib import closing

import pytest

from contvines.store import load
from tests.contvines.studies import PAPER
from tests.machines import ABSORBER

STUDY = PAPER.replace("[0.2, 1.2]", "[0.2, 0.6]")


@pytest.fixture
def file(run, tmp_path):
    """The result of a study."""
    (tmp_path / "s.toml").write_text(STUDY)
    run.ok("diagram s.toml -q")
    return tmp_path / "s.vines"


def edited(file, old, new):
    """The study that a file keeps, changed as if somebody else had written it."""
    with closing(sqlite3.connect(file)) as db, db:
        (text,) = db.execute("SELECT value FROM meta WHERE key = 'study'").fetchone()
        study = json.loads(text)
        study["source"]["text"] = study["source"]["text"].replace(old, new)
        db.execute("UPDATE meta SET value = ? WHERE key = 'study'", (json.dumps(study),))


def test_a_result_is_the_same_again_though_its_study_has_gone(run, file):
    file.with_suffix(".toml").unlink()
    assert "no differences" in run.ok("rerun s.vines -q")
    first, second = load("s.vines"), load("s-rerun.vines")
    assert [p.value for p in first.special.values()] == [p.value for p in second.special.values()]
    said = run.json("rerun s.vines -q")
    assert said["same_study"] and said["differences"] == []
    assert said["before"]["numpy"] == said["after"]["numpy"]


def test_what_differs_is_listed(run, file):
    """With r = 0.75 the fold is where its closed form says: another place than that of r = 0.76."""
    edited(file, "0.76", "0.75")
    status, out, _ = run("rerun s.vines --json -q")
    said = json.loads(out)
    assert status == 1 and not said["same_study"]
    moved = next(text for text in said["differences"] if text.startswith("LP1 moved from "))
    ratio, height = 0.25 / 1.75, 0.5 * math.pi * 1.006 * 0.5 * 0.211
    beta = (2 * math.pi - 4 * ratio * height) / (math.pi**2 + 4 * ratio**2)
    expected = math.hypot(1 - math.pi * beta / 2, ratio * beta + height)
    assert float(moved.split()[-1]) == pytest.approx(expected, abs=1e-9)


def test_studies_with_code_are_not_run(run, file):
    edited(file, '"absorber"', '"evil.py:machine"')
    file.with_name("evil.py").write_text("raise SystemExit(99)")
    status, _, err = run("rerun s.vines")
    assert status == 1 and "--trust" in err


FAST = """import contvines as cv


def too_fast(point):
    return point.measure("impact_speed") - 0.9


fast = cv.Kind("fast", "FA", test=too_fast, locus=too_fast)
"""


def test_a_point_of_a_kind_of_the_study_is_followed_in_a_second_parameter(run, tmp_path):
    (tmp_path / "fast.py").write_text(FAST)
    (tmp_path / "s.toml").write_text(STUDY + 'kinds = "fast.py:fast"\n')
    run.ok("diagram s.toml -q --no-look")
    line = "locus s.vines FA1 --over friction --within 0.4 0.55 -q"
    status, _, err = run(line)
    assert status and "--trust allows it" in err
    run.ok(line + " --trust")
    speeds = [
        ABSORBER.changed(friction=q).symmetric_orbit(amplitude=p).measure("impact_speed")
        for p, q in load("s-FA1.vines").loci["FA1"].values
    ]
    assert len(speeds) > 2 and speeds == pytest.approx([0.9] * len(speeds), abs=1e-9)
