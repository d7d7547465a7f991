"""Graphs, charts and atlases that were checked from outside and frozen: every later state gives the same."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from contvines.store.differences import differences

from .studies import file_of, studies

STUDIES = studies()
ROOT = Path(__file__).parents[2]


@pytest.mark.filterwarnings("error::RuntimeWarning")
@pytest.mark.parametrize("name", STUDIES)
def test_golden(name):
    golden = json.loads(file_of(name).read_text())
    assert not differences(golden, json.loads(json.dumps(STUDIES[name]())))


REFERENCE = """
import json, sys
from contvines.core.library import variant
from tests.golden.studies import studies
print(json.dumps([variant(), studies()[sys.argv[1]]()]))
"""
ALWAYS = ("cavity 9", "demo henon")
LONGER = ("friction", "stick-slip", "coupled 11", "page bouncing_ball", "chart henon", "demo lorenz 84")


# all others: `CONTVINES_CORE=reference pytest tests/golden`; at WG2 of absorber 11 the last bit says whether a far solution is found
@pytest.mark.parametrize("name", [*ALWAYS, *(pytest.param(name, marks=pytest.mark.slow) for name in LONGER)])
def test_the_reference_core_gives_the_same(name):
    """In a process of its own, as the core is chosen once; every flight is computed in Python: some seconds."""
    found = subprocess.run(
        [sys.executable, "-c", REFERENCE, name],
        cwd=ROOT,
        env=os.environ | {"CONTVINES_CORE": "reference"},
        capture_output=True,
        text=True,
        check=True,
        timeout=900,
    )
    core, graph = json.loads(found.stdout)
    assert core == "reference"
    assert not differences(json.loads(file_of(name).read_text()), graph)


def test_there_is_one_file_for_each_study():
    assert {file_of(name) for name in STUDIES} == set(file_of("friction").parent.glob("*.json"))


CHANGES = {
    "a value moved by 1e-9": lambda g: g["points"]["SB1"].update(value=g["points"]["SB1"]["value"] + 1e-9),
    "a kind": lambda g: g["points"]["SB1"].update(kind="fold"),
    "a point that is virtual": lambda g: g["points"]["SB1"].update(real=False),
    "multipliers": lambda g: g["points"]["SB1"].update(multipliers=[0.5, 1.1]),
    "a point left out": lambda g: g["points"].pop("PD5"),
    "a branch left out": lambda g: g["branches"].pop("B13"),
    "a word": lambda g: g["branches"]["B2"].update(word="ss"),
    "an interval": lambda g: g["branches"]["B1"].update(stable=[]),
    "a link left out": lambda g: g["links"].pop(),
}


@pytest.mark.parametrize("change", CHANGES)
def test_the_comparison_notices_every_change(change):
    golden, other = (json.loads(file_of("friction").read_text()) for _ in range(2))
    assert not differences(golden, other)
    CHANGES[change](other)
    assert differences(golden, other)
