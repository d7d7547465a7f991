"""Multipliers along the stable branches against C^2.

Paper: figure for r = 0.76, mu = 0.5, g = 0.211, with printed entries a, b, c, d of the linearised maps,
det A = r^4.

Confirms: the printed entries give the multipliers of the maps to rounding (B read as the mean speed); det
A = r^4; complex pairs have modulus r^2 = 0.5776, so no pair can leave the circle; both speeds, after and
before, give the same multipliers. Refines: the multiplier of the period touches +1 at C_max, but the half
map (half a period, then the mirror) has -1 there: that is what tells symmetry breaking from a fold.
"""

import numpy as np
import paper
import two_impacts

from orbits import Absorber


def printed_multipliers(b: float, R: float, h: float) -> np.ndarray:
    """Eigenvalues of the matrix A that the paper prints, at mean speed `b`; `h` is h~."""
    k = 2 / (1 + R) ** 2 * (np.pi / 2 - 1 / b) - (1 - R) * 2 / np.pi * h / ((1 + R) ** 2 * b)
    a = np.pi * k - (1 - R) / (1 + R)
    beta = k * (2 * h - (1 - R) * b) - (1 - R) / (1 + R) * 2 / np.pi * h
    c = -np.pi / ((1 + R) * b)
    d = (1 - R) / (1 + R) - 2 * h / ((1 + R) * b)
    return np.linalg.eigvals([[a**2 - beta * c, beta * (a - d)], [c * (d - a), d**2 - beta * c]])


def discriminant(orbit) -> float:
    """Positive where both multipliers are real, negative where they are a pair."""
    first, second = orbit.multipliers
    return float(np.real((first - second) ** 2))


def main():
    machine = Absorber(**paper.STRONG)
    fold, breaking = two_impacts.limits(machine)
    squares = fold + (breaking - fold) * np.linspace(0, 1, 200) ** 2 + 1e-12
    straight = two_impacts.symmetric(machine, squares)
    bent = two_impacts.asymmetric(machine, 1.0)
    border = two_impacts.at(bent, lambda o: o.margin).params[0] ** 2

    straight, bent = (two_impacts.refined(orbits, discriminant) for orbits in (straight, bent))
    figure, ((upper,), (lower,)) = paper.panels(7.4, 5.6, 2, 1, sharex=True)
    for orbits, name in ((straight, "symmetric"), (bent, "asymmetric")):
        c2 = np.array([o.params[0] ** 2 for o in orbits])
        values = np.array([np.sort_complex(o.multipliers) for o in orbits])
        for k in (0, 1):
            color, style = (paper.BLUE, "-") if name == "symmetric" else (paper.RED, paper.DASHED)
            inside = np.where((name == "symmetric") | (c2 <= border), 1.0, np.nan)
            for axes, part in ((upper, values[:, k].real), (lower, values[:, k].imag)):
                axes.plot(c2, part * inside, color=color, ls=style, label=name if k == 0 else None)
                if name == "asymmetric":
                    beyond = np.where(c2 > border, part, np.nan)
                    axes.plot(
                        c2,
                        beyond,
                        color=paper.GREY,
                        ls=paper.DOTTED,
                        label="only in the maps" if k == 0 else None,
                    )
    for axes in (upper, lower):
        axes.axvline(border, color=paper.GREY, lw=0.8, label="border")
    upper.axhline(1, color="k", lw=0.7)
    upper.axhline(-1, color="k", lw=0.7)
    upper.set(ylabel="real part", ylim=(-1.3, 1.3))
    lower.set(ylabel="imaginary part", xlabel="$C^2$", ylim=(-1.1, 0.65))
    paper.legend(lower, loc="lower left", ncols=2)

    R = float(two_impacts.restitution_ratio(machine.restitution))
    h = float(two_impacts.friction_number(machine.friction, machine.gravity, machine.mass_ratio))
    gap = 0.0
    for orbit in two_impacts.symmetric(machine, squares)[1:]:
        mean = float(orbit.nodes[0, 1]) - h
        ours = np.sort_complex(orbit.multipliers)
        gap = max(gap, float(np.max(np.abs(ours - np.sort_complex(printed_multipliers(mean, R, h))))))
    product = np.array([np.prod(o.multipliers).real for o in straight + bent])
    pairs = [abs(v) for o in straight + bent for v in o.multipliers if abs(v.imag) > 1e-6]
    return figure, {
        "largest difference between printed and computed multipliers": gap,
        "det A / r^4, least and largest": (
            round(product.min() / 0.76**4, 9),
            round(product.max() / 0.76**4, 9),
        ),
        "modulus of complex pairs, least and largest": (round(min(pairs), 6), round(max(pairs), 6)),
        "r^2": 0.76**2,
    }


if __name__ == "__main__":
    paper.run("multipliers", main)
