"""A survey's NetCDF: what is damaged is refused with a sentence, whatever is damaged; files without a digest are still read."""

import numpy as np
import pytest

from contvines.survey import Plan, PlanError, Survey, load_survey

pytest.importorskip("xarray")
PLAN = Plan({"width": np.array([1.0, 2.0, 3.0])}, {"friction": np.array([0.1, 0.2])})
ABOUT = {"axes": {"width": [1.0, 2.0, 3.0]}, "samples": {"friction": [0.1, 0.2]}}


def made():
    notes = np.full((3, 2), "", dtype=object)
    notes[1, 0] = "no stable motion is known in 2 % of the interval"
    return Survey(PLAN, {"peak": np.arange(6.0).reshape(3, 2) + 0.25}, notes, {"peak": "mm"}, ABOUT)


@pytest.fixture
def kept(tmp_path):
    made().save(tmp_path / "s.nc")
    return tmp_path / "s.nc"


def flipped(whole, place, bit):
    return whole[:place] + bytes([whole[place] ^ 1 << bit]) + whole[place + 1 :]


def test_a_flipped_bit_and_a_file_cut_short_or_made_longer_are_refused(kept):
    whole = kept.read_bytes()
    bits = (flipped(whole, place, place % 8) for place in range(0, len(whole), 7))
    for other in (*bits, *(whole[:length] for length in range(0, len(whole), 37)), whole + b"\0"):
        kept.write_bytes(other)
        with pytest.raises(PlanError, match=r"s\.nc: "):
            load_survey(kept)


def test_a_file_without_a_digest_is_read_and_a_damaged_one_gets_a_sentence(kept):
    made().to_xarray().to_netcdf(kept, engine="scipy", format="NETCDF3_64BIT")
    assert np.array_equal(load_survey(kept)["peak"], made()["peak"])
    whole, draw = kept.read_bytes(), np.random.default_rng(3)
    for place in draw.integers(0, len(whole), 150):
        kept.write_bytes(flipped(whole, place, int(draw.integers(8))))
        try:
            load_survey(kept)
        except PlanError as error:
            assert str(error).startswith(str(kept))
