"""Entries as rows: what comes back, and digests that tell where one part ends and the next begins."""

import numpy as np
import pytest

from contvines.store.packing import digest_of, packed, unpacked


def test_digests_tell_parts_apart():
    rows = [("x", "<f8", "[1]", b"12345678")]
    moved = [("x<", "f8", "[1]", b"12345678")]
    found = [
        digest_of("journal", "B1", "{}", rows),
        digest_of("journalB", "1", "{}", rows),
        digest_of("journal", "B1{", "}", rows),
        digest_of("journal", "B1", "{}", moved),
        digest_of("journal", "B1", "{}", []),
        digest_of("journal", "B1", "{}", rows * 2),
    ]
    assert len(set(found)) == len(found)
    assert digest_of("journal", "B1", "{}", list(rows)) == found[0]


@pytest.mark.parametrize(
    "array",
    [np.array([[1.5, np.nan]]), np.array([1 - 2j]), np.array([True, False]), np.arange(3), np.zeros((0, 4))],
)
def test_arrays_come_back(array):
    again = unpacked(*packed(array))
    assert (
        again.shape == array.shape
        and again.dtype.kind == array.dtype.kind
        and again.tobytes() == array.tobytes()
    )
    again[...] = 0  # and may be written to
