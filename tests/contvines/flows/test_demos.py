"""Demos of other packages with cycles: all special points of the table, no others, each against a solve of its own.

The values of the table are the witness's (`tools/flow_demos/witness.py`): shooting by Taylor series and Newton's method on an extended system.
"""

import json

import numpy as np
import pytest

from tools.flow_demos.listed import DEMOS, PRINTED

pytest.importorskip("heyoka")  # integrates for the witness
from tools.flow_demos.make_table import TABLE, points_of, shooting_of, solved

pytestmark = pytest.mark.slow

EXPECTED = json.loads(TABLE.read_text(encoding="utf-8"))
BY_NAME = {demo.name: demo for demo in DEMOS}
LONG = {
    "pen",
    "neural mass",
    "wav",
    "oxidation of CO",
    "lor",
    "brc",
}  # `python -m tools.flow_demos.make_table` solves these, too
AWAY = {"homoclinic": 3e-6}  # parts of the interval; else of the location of an equilibrium or a cycle
CLOSE = 2e-8
ROUNDED = 1e-11  # of long cycles, beside the error of the mesh


def disagreements(demo, found):
    """What a diagram has otherwise than the table: kinds, values, and values that differ by more than the stated error."""
    expected, width = EXPECTED[demo.name], demo.within[1] - demo.within[0]
    kinds = [point.kind for point in found], [row["kind"] for row in expected]
    if kinds[0] != kinds[1]:
        return [kinds]
    pairs = [(point, row["value"]) for point, row in zip(found, expected) if row["value"] is not None]
    return [
        (point.label, point.value, value)
        for point, value in pairs
        if abs(point.value - value)
        > min(AWAY.get(point.kind, CLOSE) * width, point.location_error + ROUNDED * width)
    ]


def test_every_demo_is_in_the_table():
    assert set(EXPECTED) == set(BY_NAME)


@pytest.mark.parametrize("name", sorted(BY_NAME.keys() - LONG))
def test_demo(name):
    demo = BY_NAME[name]
    assert disagreements(demo, points_of(demo.graph())) == []


@pytest.mark.parametrize("name", ["adaptx"])
def test_the_table_is_what_the_witness_finds(name):
    demo = BY_NAME[name]
    found = points_of(demo.graph())
    for point, row in zip(found, EXPECTED[name]):
        assert solved(demo, point) == pytest.approx(row["value"], rel=1e-10)
    start = shooting_of(demo, found[-1])
    assert np.abs(start.cycle(start.start)[0]).max() < 1e-6  # our cycle solves the witness's equations


@pytest.mark.parametrize("name", sorted(set(PRINTED) & set(BY_NAME)))
def test_what_others_print(name):
    """To a part in 10^4: AUTO's demos have coarse meshes (chu's Hopf point, exactly 6.80434, is printed as 6.80443)."""
    for kind, texts in PRINTED[name].items():
        rows = [row for row in EXPECTED[name] if row["kind"] == kind]
        values = [row["ours"] if row["value"] is None else row["value"] for row in rows]
        for text in texts:
            nearest = min(values, key=lambda value: abs(value - float(text)))
            assert nearest == pytest.approx(float(text), rel=2e-4, abs=1e-9), (kind, text)
