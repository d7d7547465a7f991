"""The pages for users of other packages: their printed values, ours, and a solve of each in 40 digits by mpmath.

The witness has the equations of the demos once more, in mpmath, and solves bordered systems by Newton's method with derivatives of its
own: F = 0 with J q = 0 at folds and branch points, F = 0 with J (a + i b) = i omega (a + i b) at Hopf points.
"""

import re
from contextlib import chdir
from pathlib import Path

import mpmath as mp
import numpy as np
import pytest

pytestmark = pytest.mark.slow

DOCS = Path(__file__).parents[1] / "docs"
PAGES = "".join(
    (DOCS / f"{name}.md").read_text(encoding="utf-8") for name in ("coming_from", "coming_from_others")
)


def reactor(u, p):
    reaction = p * (1 - u[0]) * mp.exp(u[1])
    return [-u[0] + reaction, -3 * u[1] + 14 * reaction]


def oscillator(u, q2):
    x, y, s = u
    z = 1 - x - y - s
    tenth = mp.mpf(1) / 10
    return [
        5 * z * z - 2 * x * x - 10 * x * y,
        q2 * z - tenth * y - 10 * x * y,
        mp.mpf("0.0675") * (z - 4 * tenth * s),
    ]


def mass(u, drive):
    e, x, v = u
    alpha = mp.mpf("1.5")
    total = mp.mpf("3.07") * v * x * e + drive
    return [
        (-e + alpha * mp.log(1 + mp.exp(total / alpha))) / mp.mpf("0.013"),
        (1 - x) / mp.mpf("0.2") - v * x * e,
        (mp.mpf("0.3") - v) / mp.mpf("1.5") + mp.mpf("0.3") * (1 - v) * e,
    ]


def times(f, u, p, direction):
    """The Jacobian of f at u times a direction."""
    total = [mp.mpf(0)] * len(u)
    for j, d in enumerate(direction):
        column = [mp.diff(lambda t: f([*u[:j], t, *u[j + 1 :]], p)[i], u[j]) for i in range(len(u))]  # noqa: B023
        total = [a + d * b for a, b in zip(total, column)]
    return total


def jacobian(f, u, p):
    columns = [times(f, u, p, [mp.mpf(i == j) for i in range(len(u))]) for j in range(len(u))]
    return np.array([[float(c[i]) for c in columns] for i in range(len(u))])


def fold(f, u, p):
    n = len(u)
    q0 = np.linalg.svd(jacobian(f, u, p))[2][-1]

    def system(*z):
        x, value, q = list(z[:n]), z[n], list(z[n + 1 :])
        return [*f(x, value), *times(f, x, value, q), sum(a * b for a, b in zip(q, q0)) - 1]

    return mp.findroot(system, [*u, p, *map(mp.mpf, q0)], tol=mp.mpf(10) ** -60)[n]


def hopf(f, u, p):
    n = len(u)
    values, vectors = np.linalg.eig(jacobian(f, u, p))
    k = int(np.argmin(np.abs(values.real) + 1e3 * (values.imag <= 0)))
    q0, omega = vectors[:, k], values[k].imag

    def system(*z):
        x, value, w = list(z[:n]), z[n], z[n + 1]
        a, b = list(z[n + 2 : 2 * n + 2]), list(z[2 * n + 2 :])
        ja, jb = times(f, x, value, a), times(f, x, value, b)
        real = sum(c.real * s + c.imag * t for c, s, t in zip(q0, a, b)) - 1
        imaginary = sum(c.real * t - c.imag * s for c, s, t in zip(q0, a, b))
        turned = [s + w * t for s, t in zip(ja, b)] + [s - w * t for s, t in zip(jb, a)]
        return [*f(x, value), *turned, real, imaginary]

    start = [*u, p, mp.mpf(omega), *map(mp.mpf, map(float, q0.real)), *map(mp.mpf, map(float, q0.imag))]
    return mp.findroot(system, start, tol=mp.mpf(10) ** -60)[n]


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    """The names of the pages after all its cells have run, in a folder of their own."""
    cells = re.findall(r"```\{code-cell\} ipython3\n(.*?)```", PAGES, re.DOTALL)
    names: dict = {}
    with chdir(tmp_path_factory.mktemp("page")):
        exec(compile("\n".join(cells), "coming_from.md", "exec"), names)
    return names


def pairs(page, name):
    for kind, values in page[f"{name}_printed"].items():
        for text in values:
            point = min(page[f"{name}_graph"].of_kind(kind), key=lambda point: abs(point.value - float(text)))
            yield kind, text, point


@pytest.mark.parametrize(("name", "f"), [("ab", reactor), ("catalytic", oscillator), ("neural", mass)])
def test_printed_values_ours_and_a_solve_in_many_digits_agree(page, name, f):
    found = list(pairs(page, name))
    assert len({point.label for _, _, point in found}) == len(found)
    special = [p for p in page[f"{name}_graph"].special.values() if p.kind != "end"]
    assert len(special) == len(found)  # nothing beside what is printed
    for kind, text, point in found:
        with mp.workdps(40):
            start = [mp.mpf(float(v)) for v in point.u], mp.mpf(point.value)
            exact = (fold if kind == "fold" else hopf)(f, *start)
        assert abs(point.value - float(exact)) <= max(1e-13 * abs(float(exact)), point.location_error)
        digits = len(re.sub(r"[eE].*", "", text).split(".")[1])
        scale = 10.0 ** float(re.search(r"[eE](.+)", text)[1]) if re.search(r"[eE]", text) else 1.0
        # BifurcationKit prints brackets as wide as 8 units of the last digit
        assert abs(float(text) - float(exact)) <= 9 * 10.0**-digits * scale


def test_the_eigenvalue_of_the_discrete_line(page):
    exact = 1600 * np.sin(np.pi / 40) ** 2
    (point,) = page["eigen_graph"].of_kind("branch-point")
    assert f"{exact:.4f}" == "9.8493"
    assert point.value == pytest.approx(exact, rel=1e-13)


def test_the_fold_of_the_discrete_bratu_problem(page):
    """Against a shooting through the recurrence of the differences: u_0 = 0, u_1 free, u_10 is the middle."""
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
