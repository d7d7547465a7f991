"""Pictures of basins of a machine in units say them."""

import contvines as cv
from orbits import coupled_two


def test_axes_of_basins_have_units():
    basins = cv.basins(coupled_two, "frequency", at=7.8, points=3)
    axes = basins.plot().axes[0]
    assert axes.get_xlabel().endswith("[mm]") and axes.get_ylabel().endswith("[mm]")
    assert basins.to_dict()["units"] | {"q": "mm", "x1": "mm"} == basins.to_dict()["units"]
