"""The pieces of the absorber's motion: triangle wave, square wave, and the ripple that friction adds.

Paper: figure with Pi(z), M(z) and (Pi^2 - pi^2/4) M; its slow flow takes the ripple's first harmonic as
(pi^4 - 16)/pi^4 h.

Refines: by quadrature the first cosine harmonic of the ripple (h/pi)(pi^2/4 - Pi^2) M is 8/pi^2 =
0.810569 of h; the paper's 0.835744 is what comes out when Pi and M are each replaced by their own first
harmonic before they are multiplied, and is 3.1 % too large.
"""

import numpy as np
import paper
from scipy.integrate import quad


def main():
    def triangle(z):
        return np.arcsin(np.sin(z))

    def square(z):
        return np.sign(np.cos(z))

    def ripple(z):
        return (0.25 * np.pi**2 - triangle(z) ** 2) * square(z) / np.pi

    def rough(z):
        return (0.25 * np.pi**2 - (4 / np.pi * np.sin(z)) ** 2) * (4 / np.pi * np.cos(z)) / np.pi

    cuts = (0.5 * np.pi, 1.5 * np.pi)
    exact = quad(lambda z: ripple(z) * np.cos(z), 0, 2 * np.pi, points=cuts)[0] / np.pi
    printed = quad(lambda z: rough(z) * np.cos(z), 0, 2 * np.pi)[0] / np.pi

    z = np.linspace(-np.pi, 3 * np.pi, 1601)
    figure, ((left,), (right,)) = paper.panels(7.2, 6.0, 2, 1, sharex=True)
    left.plot(z, triangle(z), color=paper.BLUE, label=r"$\Pi(z)=\arcsin(\sin z)$")
    left.plot(z, square(z), color=paper.RED, ls=paper.DASHED, label=r"$M(z)=\Pi'(z)$")
    left.plot(z, -ripple(z) * np.pi, color=paper.GREY, ls=paper.DOTTED, label=r"$(\Pi^2-\pi^2/4)\,M$")
    paper.legend(left, loc="upper right", ncols=3)
    left.set(ylim=(-3, 4))
    right.plot(z, ripple(z), color=paper.BLUE, label="ripple, in units of $h$")
    right.plot(
        z,
        exact * np.cos(z),
        color=paper.GREEN,
        ls=paper.DASHED,
        label=rf"first harmonic $8/\pi^2$ = {exact:.4f}",
    )
    right.plot(z, printed * np.cos(z), color=paper.RED, ls=paper.DOTTED, label=f"as printed, {printed:.4f}")
    paper.legend(right, loc="upper right", ncols=3)
    right.set(xlabel="$z$", ylim=(-0.9, 1.2))
    return figure, {
        "kappa by quadrature": exact,
        "8/pi^2": 8 / np.pi**2,
        "kappa of the paper, by multiplying first harmonics": printed,
        "excess of the paper": printed / exact - 1,
    }


if __name__ == "__main__":
    paper.run("sawtooth", main)
