"""`contvines sweep`: its rows lead to starts."""

import json

import numpy as np
import pytest

from contvines.command.sweep import StoredRow, _drawn_impact
from orbits.words import Word
from tests.contvines.studies import PAPER_MACHINE, table

STUDY = """{machine}
[start]
word = "{word}"
periods = {periods}
guess = {nodes}
{parameter} = {value}
[continue]
parameter = "{parameter}"
within = {within}
[sweep]
within = {within}
count = {count}
transient = {transient}
"""
ABSORBER = {
    "machine": PAPER_MACHINE, "parameter": "amplitude", "within": "[0.12, 1.3]", "count": 20, "transient": 100,
}  # fmt: skip
COUPLED = {
    "machine": PAPER_MACHINE.replace("absorber", "coupled") + "damping = 1.0\nforcing = 2.47\n",
    "parameter": "frequency", "within": "[0.93, 1.07]", "count": 12, "transient": 150,
}  # fmt: skip


@pytest.mark.parametrize(
    ("numbers", "words"),
    [(ABSORBER, {"LR", "ss", "tt", "LRs", "LRLt"}), (COUPLED, {"LR", "ss", "tt", "LRtRtt"})],
)
def test_a_row_is_a_start_of_the_same_orbit(run, tmp_path, numbers, words):
    """Word, periods and nodes pasted into [start] give the simulator's orbit."""
    anywhere = STUDY.format(**numbers, word="LR", periods=1, value=1.0, nodes="")
    (tmp_path / "a.toml").write_text(anywhere.replace("guess = \n", ""))
    run.ok("sweep a.toml -q -o a.csv")
    rows = table(tmp_path / "a.csv")
    assert list(rows[0])[:6] == ["value", "direction", "attractor", "word", "periods", "impacts"]
    assert list(rows[0])[-2:] == ["symmetric", "nodes"]
    tried = set()
    for row in rows:
        if row["attractor"] in ("stuck", "chaotic", "chatter"):
            assert row["nodes"] == ("[]" if row["attractor"] == "stuck" else "")
            continue
        (tmp_path / "b.toml").write_text(STUDY.format(**{**row, **numbers}))
        status, out, err = run("orbit b.toml --json")
        assert (status, err) == (0, "")
        orbit = json.loads(out)
        found = [
            [n["phase"], n["B_post"] if n["event"] in "LR" else n["w"], n.get("v", 0.0), n.get("v_rate", 0.0)]
            for n in orbit["nodes"]
        ]
        nodes = np.array(json.loads(row["nodes"]))
        gap = np.array(found)[:, : nodes.shape[1]] - nodes
        gap[:, 0] -= 2 * np.pi * np.round(gap[0, 0] / (2 * np.pi))
        assert np.abs(gap).max() < 1e-7
        assert max(abs(complex(*m)) for m in orbit["multipliers"]) < 1.0  # an attractor
        assert row["symmetric"] == str(int(orbit["symmetric"]))
        tried.add(row["word"])
    assert words <= tried


def test_the_impact_on_the_line_of_a_branch_is_told():
    """The branch begins at the other wall: its B is that of the second impact."""
    row = StoredRow(["0.5", "", "", "LRtt"], "", True, [1.2, 1.4], [])
    assert _drawn_impact(row, [(Word.parse("RLtt"), np.arange(2), np.full(2, 1.4))]) == 1
