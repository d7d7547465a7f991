"""Files for AUTO-07p and XPPAUT: columns and counts as their manuals say, values against closed forms; a cycle is read back and followed."""

import numpy as np
import pytest

import contvines as cv
from tests.contvines.flows.shooting import landau

HOPF = cv.FlowProblem(landau, [0.0, 0.0], {"mu": -0.5})


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("auto")
    graph = cv.diagram(HOPF, over="mu", within=(-0.5, 1.0))
    assert graph.export(path / "hopf.auto", "auto") == path / "b.hopf"
    graph.export(path / "hopf.dat", "xpp")
    return path


def test_branches(folder):
    """Columns of 19 letters; stable points have negative numbers; the cycle has AUTO's type of a Hopf point where it begins."""
    lines, width = (folder / "b.hopf").read_text().splitlines(), 19

    def cells(line):
        return [line[k : k + width].strip() for k in range(width, len(line), width)]

    names = cells([line for line in lines if " PT " in line][1])
    rows = [line for line in lines if int(line[:4]) > 0]
    assert not any(len(line) % width for line in rows)
    cycles = [line for line in rows if int(line[:4]) == 2]
    values = np.array([cells(line) for line in cycles], dtype=float)
    mu, period = values[:, names.index("mu")], values[:, names.index("period")]
    np.testing.assert_allclose(period, 2 * np.pi, atol=1e-8)
    np.testing.assert_allclose(values[:, names.index("max x0")][mu > 0.1], np.sqrt(mu[mu > 0.1]), rtol=1e-6)
    assert all(int(line[4:10]) < 0 for line, value in zip(cycles, mu, strict=True) if value > 0.1)
    kinds = [int(line[10:14]) for line in rows if int(line[:4]) == 1 and int(line[14:19])]
    assert kinds == [9, 3, 9]


def test_solutions_are_read_and_followed(folder):
    found = cv.flows.read_auto(folder / "s.hopf")
    end = next(one for one in found if len(one.times) > 1 and abs(one.parameters[0] - 1.0) < 1e-9)
    assert end.kind == 9 and end.period == pytest.approx(2 * np.pi, abs=1e-9)
    np.testing.assert_allclose(np.linalg.norm(end.states, axis=1), 1.0, atol=1e-6)
    assert end.times[0] == 0.0 and end.times[-1] == 1.0
    orbit = HOPF.cycle(end.times * end.period, end.states, mu=1.0)
    assert orbit.period == pytest.approx(2 * np.pi, abs=1e-8)


def test_numbers_as_fortran_writes_them(tmp_path):
    """An equilibrium of a file with exponents D and without a letter."""
    head = " 1 1 9 1 1 1 1 3 2 0 0 1 0 2 1 0\n"
    (tmp_path / "s.x").write_text(head + "  0.0 1.5D+00 -2.0-101\n   0.25E+000\n")
    (one,) = cv.flows.read_auto(tmp_path / "s.x")
    assert one.states.tolist() == [[1.5, -2e-101]] and one.parameters.tolist() == [0.25]
    with pytest.raises(ValueError, match="PAR"):
        _ = one.period
    (tmp_path / "s.y").write_text("nothing of the kind\n")
    with pytest.raises(ValueError, match="AUTO-07p"):
        cv.flows.read_auto(tmp_path / "s.y")


def test_points_of_xppaut(folder):
    """Types 1 and 2: stable and unstable equilibria, 3: stable cycles."""
    rows = np.loadtxt(folder / "hopf.dat")
    mu, high, low, kind, branch = rows.T
    assert set(kind[(branch == 1) & (mu < -1e-9)]) == {1.0}
    assert set(kind[(branch == 1) & (mu > 1e-9)]) == {2.0}
    big = (branch == 2) & (mu > 0.1)
    assert set(kind[big]) == {3.0}
    np.testing.assert_allclose(high[big], np.sqrt(mu[big]), rtol=1e-6)
    np.testing.assert_allclose(low[big], -high[big], rtol=1e-6)
