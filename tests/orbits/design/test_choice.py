"""The best choice: against closed forms, with kinks, over tolerances, and what cannot be chosen."""

import pytest

from orbits.design import best
from orbits.machines.base import ParameterError


def kinked(values):
    """The larger of two lines that cross at 1.3."""
    x = values["x"]
    return {"peak": max(3.0 - x, 0.5 * x + 1.05), "cost": x}


def test_one_parameter_with_a_kink():
    choice = best(kinked, "peak", {"x": (0.0, 4.0)})
    assert choice.values["x"] == pytest.approx(1.3, abs=8e-3)
    assert choice.others == {"cost": choice.values["x"]} and len(choice.tried) >= 9


def test_two_parameters_and_the_largest():
    def hill(values):
        if values["x"] > 3.0:
            raise ValueError("no machine")
        return {"height": 5.0 - (values["x"] - 1.2) ** 2 - 2.0 * (values["y"] + 0.4) ** 2}

    choice = best(hill, "height", {"x": (0.0, 4.0), "y": (-2.0, 2.0)}, largest=True)
    assert choice.values == pytest.approx({"x": 1.2, "y": -0.4}, abs=0.02)
    assert choice.outcome == pytest.approx(5.0, abs=1e-3)


def test_the_worst_of_the_tolerances_and_a_quantile():
    def outcome(values):
        return {"peak": (values["x"] - values["r"]) ** 2}

    drawn = [{"r": r} for r in (0.0, 0.1, 0.2, 2.0)]
    worst = best(outcome, "peak", {"x": (-1.0, 3.0)}, tolerances=drawn)
    assert worst.values["x"] == pytest.approx(1.0, abs=5e-3)  # half-way between the extremes
    most = best(outcome, "peak", {"x": (-1.0, 3.0)}, tolerances=drawn, quantile=0.5)
    assert most.values["x"] < 0.6


def test_what_cannot_be_chosen():
    for over in ({}, {"x": (1.0, 0.0)}, {"x": (0, 1), "y": (0, 1), "z": (0, 1)}):
        with pytest.raises(ParameterError):
            best(kinked, "peak", over)
    with pytest.raises(ParameterError, match="outcome = 'weight' is unknown"):
        best(kinked, "weight", {"x": (0.0, 1.0)})
    with pytest.raises(ParameterError, match="no machine|has a number"):
        best(lambda values: {"peak": float("nan")}, "peak", {"x": (0.0, 1.0)})
