"""The list of demos with cycles from other packages, with start, interval and printed results of each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

import contvines as cv

from ..demos import equilibria as eq
from ..demos import more_equilibria as more
from ..demos.demo import NUMBERS
from . import fields


@dataclass(frozen=True)
class CycleDemo:
    """A demo with cycles.

    Attributes
    ----------
    name, source, parameter : str
    equations : callable
        (u, p, m) -> rates, for forced flows (u, p, t, m); also for arrays.
    u, p : start
        State and parameter.
    within : (float, float)
        Interval of the parameter.
    settles : bool
        Whether the first solution is the cycle on which a motion from ``u`` settles; else it is an equilibrium.
    period : callable, optional
        Period of the forcing as a function of the parameter.
    exact : tuple of (kind, value)
        Values from closed forms.
    guess : callable, optional
        () -> times and states near the first cycle, if no motion settles on it.
    """

    name: str
    source: str
    equations: Callable[..., list[Any]]
    u: list[float]
    p: float
    within: tuple[float, float]
    parameter: str = "p"
    settles: bool = False
    period: Callable[[float], float] | None = None
    mirror: Any = None
    depth: int = 2
    exact: tuple[tuple[str, float], ...] = ()
    settings: dict[str, Any] = field(default_factory=dict)
    guess: Callable[[], tuple[np.ndarray, np.ndarray]] | None = None

    def rates(self, x: Any, p: Any, *t: Any) -> list[Any]:
        """Return the right-hand side."""
        return self.equations(x, p, *t, NUMBERS)

    def flow(self) -> cv.FlowProblem:
        """Return the flow at the start."""
        period = None if self.period is None else (lambda p, of=self.period: of(p))
        return cv.FlowProblem(
            self.rates, self.u, self.p, parameter=self.parameter, period=period, mirror=self.mirror
        )

    def graph(self) -> cv.Graph:
        """Compute the diagram."""
        flow = self.flow()
        seed: Any = flow
        if self.guess is not None:
            times, states = self.guess()
            seed = flow.cycle(times, states)
        elif self.settles or self.period:
            seed = flow.attractor()
        return cv.diagram(
            seed, over=self.parameter, within=self.within, depth=self.depth, settings=self.settings
        )


PRINTED = {
    "lor": {"period-doubling": ["229.407", "218.210", "215.966"]},
    "lrz": {"hopf": ["24.7368"], "homoclinic": ["13.9266"]},
    "abc": {
        "hopf": ["0.204185", "0.229836", "0.259957", "0.346208"],
        "fold": ["0.213697", "0.211903", "0.224962"],
    },
    "plp": {"hopf": ["3.49995", "4.65046"], "fold": ["2.75969", "5.00784"]},
    "plp, isola": {"fold": ["2.98629", "4.72213"]},
    "pp2": {"hopf": ["0.671594"], "homoclinic": ["0.707941"]},
    "pp3": {
        "hopf": ["0.459600", "0.106415", "0.503835", "0.229357"],
        "branch-point": ["0.301234"],
    },
    "tor": {
        "hopf": ["-0.589337"],
        "fold": ["-0.584335", "-0.832514"],
        "symmetry-breaking": ["-0.587029", "-0.832438"],
    },
    "tor, unlike": {"neimark-sacker": ["-0.591650"], "period-doubling": ["-0.614955"]},
    "pen": {"period-doubling": ["0.179163"], "symmetry-breaking": ["0.331445", "0.175511"]},
    "brc": {
        "hopf": ["0.513070", "1.02515", "1.59033", "1.97999"],
        "symmetry-breaking": ["1.27121"],
        "neimark-sacker": ["1.70606", "1.87693", "1.30281", "1.92790"],
    },
    "chu": {"hopf": ["6.80443"], "period-doubling": ["8.19600"]},
    "wav": {"hopf": ["635.591"]},
    "kpr": {"homoclinic": ["-1.85119"]},
    "san": {"homoclinic": ["0"]},
    "mtn": {"homoclinic": ["0.0672976"]},
    "ops": {"hopf": ["0.937557"], "fold": ["0.921972", "0.928528"]},
    "torBPC": {
        "fold": ["-0.584492842"],
        "neimark-sacker": ["-0.595750404"],
        "period-doubling": ["-0.614681654"],
    },
    "adaptx": {"hopf": ["1.000002"], "period-doubling": ["0.630302"]},
    "oxidation of CO": {"hopf": ["1.04100305"]},
    "neural mass": {"hopf": ["-1.85012460", "-1.15105934"]},
    "lorenz 84": {"hopf": ["1.61966", "2.46722", "2.85987"]},
}
"""Name -> kind -> values that the source prints (for AUTO-07p: its run of the demo)."""

TURN = np.diag([-1.0, -1.0, 1.0])
ODD = -np.eye(3)
OTHER_WAY = np.kron(np.eye(2), np.eye(6)[::-1])
OTHER_PENDULUM = np.diag([1.0, 1.0, -1.0, 1.0, 1.0])[[0, 1, 2, 4, 3]]


def still() -> tuple[np.ndarray, np.ndarray]:
    """Return times and states of the equilibrium of frc over a forcing period at beta = 100, as a guess of the forced cycle."""
    return np.linspace(0.0, 2 * np.pi / 100, 41), np.tile([0.5, 0.0], (41, 1))


DEMOS = [
    CycleDemo(
        "lor",
        "AUTO lor",
        eq.lorenz,
        [20.0, 40.0, 280.0],
        280.0,
        (200.0, 330.0),
        "rho",
        settles=True,
        mirror=TURN,
        depth=4,
    ),
    CycleDemo("lrz", "AUTO lrz", eq.lorenz, [0.0, 0.0, 0.0], 0.5, (0.0, 30.0), "rho", mirror=TURN, depth=3),
    CycleDemo("abc", "AUTO abc", eq.abc, [0.0, 0.0, 0.0], 0.0, (0.0, 0.4), "D", depth=3),
    CycleDemo(
        "frc",
        "AUTO frc",
        fields.frc,
        [0.5, 0.0],
        100.0,
        (24.6, 100.0),
        "beta",
        period=lambda b: 2 * np.pi / b,
        guess=still,
    ),
    CycleDemo("plp", "AUTO plp", eq.plp, [45.56, 177.8], 2.021628, (2.0, 6.0), "rho"),
    CycleDemo("plp, isola", "AUTO plp", fields.plp_isola, [40.0, 95.0], 4.0, (2.5, 6.0), "rho", settles=True),
    CycleDemo("pp2", "AUTO pp2", eq.pp2, [0.0, 0.0], 0.0, (0.0, 1.0), "p1", depth=3),
    CycleDemo("pp3", "AUTO pp3", eq.pp3, [1.0, 0.0, 0.0], 0.0, (0.0, 1.0), "p1", depth=4),
    CycleDemo(
        "chu", "AUTO chu", eq.chu, [1.4994, 0.0, -1.4994], 6.0, (6.0, 8.5), "alpha", mirror=ODD, depth=3
    ),
    CycleDemo("wav", "AUTO wav", fields.wave, [62.77, 88.8, 0.0, 0.0], 500.0, (500.0, 700.0), "a0"),
    CycleDemo("kpr", "AUTO kpr", fields.koper, [-1.5, -1.5, -1.5], -2.5, (-2.5, 0.0), "lambda"),
    CycleDemo(
        "san",
        "AUTO san",
        fields.sandstede,
        [0.7, 0.0, 0.0],
        0.5,
        (-0.5, 0.5),
        "mu",
        exact=(("homoclinic", 0.0),),
    ),
    CycleDemo("mtn", "AUTO mtn", fields.plankton, [2.0, 2.0], 0.06, (0.03, 0.1), "GF", settles=True),
    CycleDemo("ops", "AUTO ops", eq.ops, [0.9, 1.314, 0.9], 0.9, (0.9, 0.95), "p3"),
    CycleDemo(
        "torBPC",
        "MatCont torBPC",
        fields.tor_matcont,
        [0.0, 0.0, 0.0],
        -0.62,
        (-0.62, -0.55),
        "nu",
    ),
    CycleDemo(
        "oxidation of CO",
        "MatCont, BifurcationKit",
        eq.oxidation,
        [0.0014673, 0.826167, 0.123119],
        1.92373,
        (0.5, 1.95),
        "q2",
    ),
    CycleDemo(
        "adaptx",
        "MatCont adaptx, BifurcationKit Lur'e",
        eq.adaptx,
        [0.0, 0.0, 0.0],
        1.5,
        (0.5, 1.8),
        "alpha",
        depth=3,
    ),
    CycleDemo("morris-lecar", "MatCont", eq.morris_lecar, [-60.0, 0.01], 0.0, (0.0, 300.0), "Iapp"),
    CycleDemo(
        "neural mass",
        "BifurcationKit TMvf",
        more.neural_mass,
        [0.238616, 0.982747, 0.367876],
        -2.0,
        (-4.0, -0.9),
        "E0",
    ),
    CycleDemo(
        "steinmetz",
        "BifurcationKit, MatCont",
        fields.steinmetz,
        [6.0, 20.0, 0.02, 0.9],
        0.75,
        (0.6, 1.0),
        "k8",
        settles=True,
    ),
    CycleDemo(
        "lorenz 84",
        "BifurcationKit, MatCont",
        eq.lorenz84,
        [2.9787, -0.0387, 0.0582, -0.0211],
        3.0,
        (1.0, 3.0),
        "F",
    ),
    CycleDemo(
        "langford",
        "COCO langford",
        fields.langford,
        [0.3, 0.4, 0.0],
        1.5,
        (0.2, 2.0),
        "rho",
        settles=True,
        exact=(("neimark-sacker", 0.51 / (1.3 - 0.343 / 3 - 0.51 * 0.7)),),
    ),
    CycleDemo(
        "bistable",
        "COCO bistable",
        fields.bistable,
        [0.0, 1.0],
        2 * np.pi,
        (2 * np.pi / 1.3, 2 * np.pi / 0.7),
        "T",
        period=lambda p: p,
    ),
    CycleDemo(
        "hopf",
        "COCO hopf",
        fields.hopf,
        [0.0, 0.0],
        -1.0,
        (-1.0, 1.0),
        "p1",
        exact=(("fold", -0.25), ("hopf", 0.0)),
    ),
    CycleDemo("marsden", "COCO marsden", fields.marsden, [0.0, 0.0, 0.0], -1.0, (-1.0, 1.0), "p1"),
    CycleDemo(
        "tor, COCO", "COCO tor", fields.tor_coco, [0.0, 0.0, 0.0], -0.65, (-0.65, -0.55), "nu", mirror=ODD
    ),
    CycleDemo(
        "pneta",
        "COCO pneta",
        fields.pneta,
        [1.0, 0.0],
        0.1,
        (0.1, 20.0),
        "eps",
        settles=True,
        mirror=-np.eye(2),
    ),
    CycleDemo("canard", "COCO canard", fields.canard, [0.0, 0.0], -1.1, (-1.1, 1.1), "a"),
    CycleDemo(
        "brc",
        "AUTO brc",
        fields.brc,
        [2.0] * 6 + [2.725] * 6,
        0.4,
        (0.4, 2.0),
        "L",
        mirror=OTHER_WAY,
        depth=2,
    ),
    CycleDemo("tor", "AUTO tor", eq.tor, [0.0, 0.0, 0.0], -0.6, (-0.84, -0.57), "nu", mirror=ODD, depth=1),
    CycleDemo(
        "tor, unlike", "AUTO tor", eq.tor, [0.0, 0.0, 0.0], -0.6, (-0.65, -0.57), "nu", mirror=ODD, depth=3
    ),
    CycleDemo(
        "pen",
        "AUTO pen",
        fields.pen,
        [1.0, 0.0, 0.0, 4.0, 4.0],
        0.4,
        (0.13, 0.4),
        "I",
        settles=True,
        mirror=OTHER_PENDULUM,
        depth=1,
    ),
    CycleDemo(
        "predator and prey, forced",
        "BifurcationKit, MatCont",
        fields.predator_prey,
        [0.3, 0.3],
        0.5,
        (0.2, 0.5),
        "b0",
        period=lambda b: 1.0,
    ),
]
