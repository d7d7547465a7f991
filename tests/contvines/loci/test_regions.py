"""The places at which a region is looked at: in the middle, and far from one another, but not near an edge."""

import numpy as np
import pytest

from contvines.loci.regions import divide


def test_the_places_of_a_strip():
    """Half a square, p in 0 to 1 of 2 and q in 0 to 1: the largest distance from its edges is a quarter of the raster's side.

    Of what is no nearer to an edge than 0.3 of that, places on the rim are farthest from those before.
    """
    cells = 200
    wall = np.array([[1.0, 0.0], [1.0, 1.0]])
    lower, upper = sorted(divide([wall], ((0.0, 2.0), (0.0, 1.0)), cells), key=lambda region: region.at[0])
    for region, low in ((lower, 0.0), (upper, 1.0)):
        assert region.share == pytest.approx(0.5, abs=0.01)
        places = np.array([region.at, *(place["at"] for place in region.elsewhere)])
        p, q = 0.5 * (places[:, 0] - low), places[:, 1]  # as parts of the raster
        gaps = np.min([p, 0.5 - p, q, 1.0 - q], axis=0)
        assert gaps[0] == pytest.approx(0.25, abs=2.0 / cells)
        assert gaps[1:] == pytest.approx(np.full(len(gaps) - 1, 0.3 * 0.25), abs=2.0 / cells)
        apart = np.hypot(np.subtract.outer(p, p), np.subtract.outer(q, q))
        assert len(places) == 5 and apart[~np.eye(5, dtype=bool)].min() > 0.2
