"""Values of parameters as they are typed."""

import pytest

from contvines.command.amounts import amount, inside, interval

UNITS = {"base_amplitude": "mm", "frequency": "Hz"}


def test_numbers_are_counted_in_the_files_units_and_quantities_in_their_own():
    assert amount("--at", "7.9", "frequency", UNITS) == 7.9
    assert amount("--at", "0.0079 kHz", "frequency", UNITS) == pytest.approx(7.9, rel=1e-15)
    assert amount("--at", "480 rpm", "frequency", UNITS) == pytest.approx(8.0, rel=1e-15)
    assert amount("--at", "-1e-3", "friction", UNITS) == -1e-3
    assert interval("--within", ("350 um", "0.06 cm"), "base_amplitude", UNITS) == pytest.approx((0.35, 0.6))


@pytest.mark.parametrize(
    "text, name, sentence",
    [
        ("7.9 mm", "frequency", "frequency is shown in Hz"),
        ("fast", "frequency", "is not a number with a unit"),
        ("0.3 mm", "friction", "friction is a plain number here"),
        ("nan", "friction", "must be finite"),
    ],
)
def test_what_is_no_value_is_refused(text, name, sentence):
    with pytest.raises(ValueError, match=sentence):
        amount("--at", text, name, UNITS)


def test_an_interval_must_have_an_inside():
    with pytest.raises(ValueError, match=r"^--within '0.6 mm' '100 um': give the lower value first"):
        interval("--within", ("0.6 mm", "100 um"), "base_amplitude", UNITS)


@pytest.mark.parametrize("text", ["7.7", "0.0077 kHz", "8.2 Hz", "492.1 rpm"])
def test_a_value_outside_the_interval_is_refused(text):
    """An interval from 7.8 to 8.2 Hz: 468 to 492 rpm; its ends belong to it."""
    if text == "8.2 Hz":
        assert inside("--at", text, "frequency", (7.8, 8.2), UNITS, "[continue] within") == 8.2
        return
    with pytest.raises(
        ValueError, match=rf"--at {text}: .* outside \[continue\] within = \[7.8, 8.2\] Hz; give"
    ):
        inside("--at", text, "frequency", (7.8, 8.2), UNITS, "[continue] within")
