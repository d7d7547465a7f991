"""An orbit in a notebook: one table, its motion in words, every parameter, its multipliers."""

import re

import pytest

from tests.machines import ABSORBER


@pytest.mark.parametrize("word", ["LR", ""])
def test_an_orbit_shows_itself_as_a_table(word):
    absorber = ABSORBER
    orbit = absorber.symmetric_orbit(0.55) if word else absorber.orbit("", amplitude=0.05)
    rows = dict(re.findall(r"<tr><th[^>]*>(.*?)</th><td[^>]*>(.*?)</td></tr>", orbit._repr_html_()))
    assert rows["motion"].startswith(word or "stuck") and "stable" in rows["motion"]
    assert {name: float(rows[name]) for name in orbit.parameters} == pytest.approx(orbit.parameters)
    first = rows["multipliers"].split(",")[0].replace(" ", "").replace("i", "j")
    assert first == "-" or abs(complex(first) - orbit.multipliers[0]) < 1e-4
    assert float(rows["least margin"].split()[0]) == pytest.approx(
        min(m.value for m in orbit.margins), rel=1e-3
    )
