"""A file that version 0.1 wrote opens, shows, draws, switches and is continued.

`version_0_1.vines` was made by version 0.1 from `examples/friction.toml` with amplitude within [0.7, 0.87] and depth 2.
"""

import shutil
from pathlib import Path

import numpy as np
import pytest

import contvines as cv
from contvines.graph.persistence import graph_entries
from contvines.store import Store, StoreError

FILE = Path(__file__).with_name("version_0_1.vines")
H = 0.5 * np.pi * (1 + 0.006) * 0.5 * 0.211
R = (1 - 0.76) / (1 + 0.76)
BETA = (2 * np.pi - 4 * R * H) / (np.pi**2 - 4)
BREAKING = (1 - 0.5 * np.pi * BETA) ** 2 + (R * BETA + H) ** 2  # of the symmetric orbit, amplitude squared


@pytest.fixture
def file(tmp_path):
    return Path(shutil.copy(FILE, tmp_path / "old.vines"))


def test_what_it_holds_is_right(file):
    graph = cv.load(file)
    assert [*graph.branches] == ["B1", "B2", "B3", "B4"]
    (breaking,) = graph.of_kind("symmetry-breaking")
    assert breaking.value**2 == pytest.approx(BREAKING, abs=1e-12)
    for branch in graph:
        for k in (0, len(branch) // 2, len(branch) - 1):
            orbit = branch.orbit(k)
            assert orbit.residual < 1e-12 and orbit.real and orbit.replay() < 1e-8
            if 0 < k < len(branch) - 1:
                assert branch.stable[k] == (np.abs(orbit.multipliers) < 1.0).all()


def test_borders_lead_on(file):
    graph = cv.load(file)
    (graze,) = graph.of_kind("velocity-graze")
    for value in (graph["B2"].values[-1], graph["B3"].values[0]):
        assert value == pytest.approx(graze.value, abs=1e-12)
    assert [switch.target for switch in graph.switches if switch.point == graze.label] == ["B3"]


@pytest.mark.parametrize(
    "words",
    ["show", "show --json", "orbit VG1", "plot -o old.png", "export --to csv -o old.csv", "switch SB1"],
)
def test_commands(file, run, words):
    verb, *more = words.split()
    status, _, err = run(verb, file, *more)
    assert status == 0, err


def test_equations_that_have_changed_since_are_named(file, run):
    """Unknowns of another number, as motions without events had, are those of an older version: its table still opens."""
    (_, _, content), *_ = [e for e in graph_entries(cv.load(file)) if e[:2] == ("branch", "B1")]
    fewer = {name: content[name][:, :-1] for name in ("points", "tangents")}
    with Store.open(file, write=True) as store, store.transaction():
        store.put("branch", "B1", {**content, **fewer})
    with pytest.raises(StoreError, match=r"an older version .* \(B1: its points have 1 .* 2 now\).*--fresh"):
        cv.load(file)
    assert "B1" in run("show", file)[1]
