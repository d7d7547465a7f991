"""What a chart prints: zeros as zeros, beside the size of each interval, and lines that fit."""

from types import SimpleNamespace

import numpy as np

from contvines.loci.regions import Region
from contvines.loci.table import table


class Locus(SimpleNamespace):
    def __len__(self):
        return len(self.values)


def chart():
    locus = Locus(
        label="LP1", kind="fold", branch=SimpleNamespace(description={"word": "LR"}), closed=False, ended=("", ""),
        values=np.array([[7.5e-15, 2e-18], [0.5, 1e-3]]), real=np.array([True, True]),
    )  # fmt: skip
    point = SimpleNamespace(
        label="CP1",
        kind="cusp",
        value=(-7.5e-15, 1e-4),
        on=["LP1"],
        coefficients={"c": 3e-15},
        real=True,
        note="",
    )
    found, other = ({"word": word, "periods": 1, "kind": "periodic"} for word in ("LR", "LRt"))
    elsewhere = [{"at": [0.5, 2e-4], "attractors": [found]}, {"at": [-0.5, 2e-4], "attractors": [other]}]
    region = Region((3e-15, 5e-4), 1.0, [found], elsewhere=elsewhere)
    return SimpleNamespace(
        parameters=("p", "q"), units={"q": "mm"}, within=((-1.0, 1.0), (-1e-3, 1e-3)), loci={"LP1": locus}, points={"CP1": point},
        regions=[region], message="",
    )  # fmt: skip


def test_what_is_only_rounding_is_zero():
    text = table(chart())
    assert "e-15" not in text and "e-18" not in text
    assert "0..0.5" in text and "0..0.001" in text and "c = 0" in text
    assert "0.0001" in text


def test_units_stand_in_the_title_and_the_heads():
    lines = table(chart()).splitlines()
    assert lines[0] == "chart of p within [-1, 1] and q within [-0.001, 0.001] mm"
    assert lines[2].split()[3:6] == ["q", "[mm]", "p"]


def test_every_line_fits():
    for width in (40, 60, 80):
        assert all(len(line) <= width for line in table(chart(), width).split("\n"))


def test_places_that_disagree_are_told():
    """Of three places of the region one has another motion: it, and it alone, is named with its place."""
    text = table(chart())
    assert "LR; not all over it: LRt at 0.0002, -0.5" in text and "0.0002, 0.5" not in text
    (region,) = chart().regions
    told = region.to_dict(("p", "q"))
    assert not told["agrees"] and [place["words"] for place in told["elsewhere"]] == [["LR"], ["LRt"]]
