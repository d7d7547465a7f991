"""`[continue] bounds`: branches end where a measure leaves its interval."""

import re

import numpy as np
import pytest

from contvines.store import load
from tests.contvines.studies import PAPER_MACHINE

STUDY = (
    PAPER_MACHINE
    + '[start]\nword = "LR"\namplitude = 0.55\n'
    + '[continue]\nparameter = "amplitude"\nwithin = [0.2, 1.2]\ndepth = 0\n'
)


def test_branches_end_where_a_measure_leaves_its_interval(run, tmp_path):
    (tmp_path / "free.toml").write_text(STUDY)
    (tmp_path / "s.toml").write_text(STUDY + "bounds = { B = [-inf, 1.1] }\n")
    for name in ("free", "s"):
        assert run("diagram", f"{name}.toml", "--quiet", "--no-look")[0] == 0
    free, graph = load("free.vines")["B1"], load("s.vines")["B1"]
    assert free.measure("B").max() > 1.2
    assert graph.measure("B").max() == pytest.approx(1.1, abs=1e-9)
    (stop,) = [s for s in load("s.vines").special.values() if s.kind == "user"]
    # where the branch without bounds passes the value
    order = np.argsort(free.measure("B"))
    assert stop.value == pytest.approx(np.interp(1.1, free.measure("B")[order], free.values[order]), abs=1e-3)
    assert load("s.vines").settings["bounds"] == {"B": [None, 1.1]}


@pytest.mark.parametrize(
    ("bounds", "said"),
    [
        ("{ foo = [0, 1] }", "there is no measure 'foo'"),
        ("{ B = [2.0, 1.0] }", r"B = \[2, 1\] is no interval"),
        ("{ B = [nan, 1.0] }", "is no interval"),
        ("{ B = 3 }", r"bounds\[B\] = 3 cannot be used; expected two numbers for each measure"),
        ("{ B = [7.0, 8.0] }", "at the start B = .* is outside of its bounds"),
    ],
)
def test_bounds_that_are_none_are_refused(run, bounds, said, tmp_path):
    (tmp_path / "s.toml").write_text(STUDY + f"bounds = {bounds}\n")
    status, _, err = run("diagram", "s.toml", "--no-look")
    assert status and re.search(said, " ".join(err.split()))
