"""The pages for users of other packages: their printed values and ours beside solves in many digits.

`tools/demos/table.json` has these: of the same equations, written anew in mpmath (`tools/demos/witness.py`).
"""

import json
import re
from contextlib import chdir
from decimal import Decimal
from pathlib import Path

import mpmath as mp
import numpy as np
import pytest

from tools.demos.make_table import TABLE

pytestmark = pytest.mark.slow

DOCS = Path(__file__).parents[1] / "docs"
PAGES = "".join((DOCS / f"{name}.md").read_text() for name in ("coming_from", "coming_from_others"))


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    """The names of the pages after all its cells have run, in a folder of their own."""
    cells = re.findall(r"```\{code-cell\} ipython3\n(.*?)```", PAGES, re.DOTALL)
    names: dict = {}
    with chdir(tmp_path_factory.mktemp("page")):
        exec(compile("\n".join(cells), "coming_from.md", "exec"), names)
    return names


@pytest.mark.parametrize(
    ("name", "demo"), [("ab", "ab"), ("catalytic", "oxidation of CO"), ("neural", "neural mass")]
)
def test_printed_values_ours_and_a_solve_in_many_digits_agree(page, name, demo):
    points = [p for p in page[f"{name}_graph"].special.values() if p.kind != "end"]
    points = sorted(points, key=lambda p: (p.kind, p.value))
    printed = sorted((kind, Decimal(t)) for kind, texts in page[f"{name}_printed"].items() for t in texts)
    exact = sorted((row["kind"], row["value"]) for row in json.loads(TABLE.read_text())[demo])
    assert [p.kind for p in points] == [kind for kind, _ in printed] == [kind for kind, _ in exact]
    for point, (_, text), (_, value) in zip(points, printed, exact):
        assert abs(point.value - value) <= max(1e-13 * abs(value), point.location_error)
        # BifurcationKit prints brackets as wide as 8 units of the last digit
        assert abs(float(text) - value) <= 9 * 10.0 ** text.as_tuple().exponent


def test_the_eigenvalue_and_the_fold_of_the_discrete_bratu_problem(page):
    """The fold against a shooting through the recurrence of the differences: u_0 = 0, u_1 free, u_10 is the middle."""
    exact = 1600 * np.sin(np.pi / 40) ** 2
    (point,) = page["eigen_graph"].of_kind("branch-point")
    assert f"{exact:.4f}" == "9.8493"
    assert point.value == pytest.approx(exact, rel=1e-13)
    (point,) = page["bratu_graph"].of_kind("fold")
    with mp.workdps(40):

        def ends(first, mu):
            before, now = mp.mpf(0), first
            for _ in range(19):
                before, now = now, 2 * now - before - mu * mp.exp(now) / 400
            return now

        start = (mp.mpf(float(point.u[0])), mp.mpf(point.value))
        _, mu = mp.findroot(lambda a, m: [ends(a, m), mp.diff(lambda t: ends(t, m), a)], start)
    assert point.value == pytest.approx(float(mu), rel=1e-13)
