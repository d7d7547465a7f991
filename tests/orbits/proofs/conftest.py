"""What all proofs are tested with: comparisons of intervals that overlap are decided by nobody."""

import pytest
from mpmath.ctx_iv import ivmpf


@pytest.fixture(autouse=True)
def strict(monkeypatch):
    """Comparisons of overlapping intervals fail, as they do from mpmath 1.4 on; before, they were None."""
    original = ivmpf._compare

    def decided(one, other, comparison):
        found = original(one, other, comparison)
        if found is None:
            raise ValueError("these intervals overlap")
        return found

    monkeypatch.setattr(ivmpf, "_compare", decided)
