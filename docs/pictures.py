"""Sketches of the concepts: `python docs/pictures.py [FOLDER]` draws them; the pages show the ones in docs/concepts/."""

import sys
from pathlib import Path

import numpy as np

from contvines.shared.figures import new_figure, styled

BLUE, RED, GREY, PALE = "#0b3c6f", "#d9484b", "#8a8a8a", "#dfe7ef"
STICK = "#b8761f"


def bare(axes):
    """Axes without frame, ticks and grid, on which lengths are equal in both directions."""
    axes.set_axis_off()
    axes.set_aspect("equal")


def arrow(axes, start, end, style="-|>", color="0.2", **more):
    """An arrow between two points."""
    look = {"arrowstyle": style, "color": color, "lw": 1.1, "shrinkA": 0, "shrinkB": 0, **more}
    axes.annotate("", xy=end, xytext=start, arrowprops=look)


def machine():
    """The cavity, the absorber in it, the half-width b and the directions."""
    figure = new_figure((7.2, 2.5))
    axes = figure.add_subplot()
    bare(axes)
    axes.fill([-3.3, -3, -3, 3, 3, 3.3, 3.3, -3.3], [1.5, 1.5, 0, 0, 1.5, 1.5, -0.3, -0.3], color=GREY, lw=0)
    axes.fill([0.55, 1.75, 1.75, 0.55], [0.02, 0.02, 0.8, 0.8], color=BLUE, lw=0)
    axes.plot([1.15, 1.15], [-0.02, 1.62], color=BLUE, lw=0.8, ls=":")
    axes.text(1.15, 0.41, "absorber", color="white", ha="center", va="center", fontsize=9)
    for x, name, side in ((-2.34, "w = +1", "left"), (2.34, "w = −1", "right")):
        axes.text(x, 1.72, name, ha=side, va="bottom", fontsize=9)
    axes.plot([0, 0], [-0.02, 2.25], color="0.3", lw=0.8, ls=(0, (4, 3)))
    for side in (-1, 1):
        arrow(axes, (0, 2.2), (side * 2.4, 2.2), "<|-|>")
        axes.plot([side * 2.4] * 2, [1.05, 2.3], color="0.3", lw=0.6, ls=":")
        axes.text(side * 1.2, 2.3, "b", ha="center", va="bottom", style="italic")
    axes.text(0.06, 1.12, "w = 0", ha="left", va="center", fontsize=9)
    axes.text(-2.96, 0.55, "left\nwall", ha="left", va="center", fontsize=9, color="0.25")
    axes.text(2.96, 0.55, "right\nwall", ha="right", va="center", fontsize=9, color="0.25")
    arrow(axes, (-0.9, -0.85), (0.9, -0.85), "<|-|>", RED)
    axes.text(1.05, -0.85, "the cavity is shaken: C sin(Ωτ)", color=RED, va="center")
    axes.text(-1.0, -0.85, "friction acts on the floor", color="0.25", va="center", ha="right")
    axes.set(xlim=(-3.9, 5.0), ylim=(-1.15, 2.75))
    return figure


def oscillator():
    """A mass on a spring beside a wall, shaken."""
    figure = new_figure((7.2, 1.7))
    axes = figure.add_subplot()
    bare(axes)
    axes.fill([-3.4, -3.2, -3.2, -3.4], [0, 0, 1.2, 1.2], color=GREY, lw=0)
    axes.fill([2.2, 2.5, 2.5, 2.2], [0, 0, 1.2, 1.2], color=GREY, lw=0)
    axes.plot([-3.4, 2.5], [0, 0], color="0.3", lw=1)
    turns = np.linspace(0, 1, 19)
    axes.plot(-3.2 + 2.6 * turns, 0.45 + 0.16 * np.sin(np.pi * 9 * turns), color="0.3", lw=1.2)
    axes.fill([-0.6, 0.6, 0.6, -0.6], [0.03, 0.03, 0.85, 0.85], color=BLUE, lw=0)
    axes.text(0, 0.43, "mass", color="white", ha="center", va="center", fontsize=9)
    axes.text(-1.9, 0.72, "spring", ha="center", va="bottom", fontsize=9)
    axes.text(2.62, 0.6, "wall", ha="left", va="center", fontsize=9)
    arrow(axes, (0.62, 0.45), (2.18, 0.45), "<|-|>")
    axes.text(1.4, 0.53, "gap", ha="center", va="bottom", fontsize=9)
    arrow(axes, (-0.55, 1.1), (0.55, 1.1), "<|-|>", RED)
    axes.text(-0.65, 1.1, "shaken at one frequency", color=RED, ha="right", va="center", fontsize=9)
    axes.set(xlim=(-3.6, 3.3), ylim=(-0.1, 1.3))
    return figure


def words():
    """Three motions over a period, with the letters of their events."""
    from orbits import Absorber

    absorber = Absorber(restitution=0.76, friction=0.5, gravity=0.211, mass_ratio=0.006)
    shown = [
        (absorber.symmetric_orbit(0.55), "LR: it hits both walls"),
        (absorber.orbit("LRLt", amplitude=1.05), "LRLt: three impacts, a turn"),
        (absorber.orbit("ss", amplitude=0.16), "ss: it slips and sticks"),
    ]
    figure = new_figure((7.2, 2.8))
    for i, (orbit, title) in enumerate(shown):
        axes = figure.add_subplot(1, len(shown), i + 1)
        scene = orbit.scene(400)
        time, w = np.array(scene["history"]["x"]), np.array(scene["portrait"]["x"])
        axes.axhspan(1, 1.25, color=GREY, lw=0)
        axes.axhspan(-1.25, -1, color=GREY, lw=0)
        axes.plot(time, w, color=BLUE)
        for event in scene["events"]:
            turn = (event["at"] - time[0]) % (time[-1] - time[0]) + time[0]  # shown once, at its first time
            wall = abs(event["x"]) > 0.999  # the letter of an impact stands in its wall
            up = (event["x"] <= 0) != wall
            side = {"s": -6, "u": 6}.get(event["event"], 0)
            axes.plot([turn], [event["x"]], "o", color=RED, ms=4.5, zorder=4)
            axes.annotate(event["event"], (turn, event["x"]), (side, (3 if wall else 6) * (1 if up else -1)), textcoords="offset points",
                          color="white" if wall else RED, weight="bold", ha="center", va="bottom" if up else "top")  # fmt: skip
        axes.set(
            xlim=(time[0] - 0.12, time[-1] + 0.05), ylim=(-1.25, 1.25), xlabel="forcing periods", title=title
        )
        axes.grid(False)
        axes.set_ylabel("w" if i == 0 else "", rotation=0)
        axes.set_yticks([-1, 0, 1])
        if i:
            axes.set_yticklabels([])
    return figure


def margins():
    """A flight whose velocity keeps its sign: by a margin, at the border, and not at all."""
    figure = new_figure((7.2, 2.4))
    s = np.linspace(0, 1, 300)
    for i, (low, title, note) in enumerate(
        ((0.35, "real", "margin > 0"), (0.0, "border", "margin = 0"), (-0.4, "virtual", "margin < 0"))
    ):
        axes = figure.add_subplot(1, 3, i + 1)
        v = low + 3.4 * (s - 0.5) ** 2
        axes.fill_between(s, -0.72, 0, color="#f6dcdc", lw=0)
        axes.axhline(0, color="0.25", lw=0.9)
        if low >= 0:
            axes.plot(s, v, color=BLUE)
        else:
            left = s < 0.5
            axes.plot(s[left & (v >= 0)], v[left & (v >= 0)], color=BLUE)
            axes.plot(s[(v < 0) | ~left], v[(v < 0) | ~left], color=BLUE, ls=(0, (1, 1.6)))
            first = s[left & (v >= 0)][-1]
            axes.plot([first, 1], [0.015, 0.015], color=STICK, lw=2.4)
            axes.text(
                0.5, 0.12, "what happens:\nit sticks", color=STICK, ha="center", va="bottom", fontsize=8
            )
        axes.plot([0.5], [low], "o", color=RED, ms=5)
        arrow(axes, (0.5, 0.0), (0.5, low), "<|-|>" if low else "-", RED, mutation_scale=8)
        x, y, side = {True: (0.53, low / 2, "left"), False: (0.5, 0.3, "center")}[low > 0]
        if low < 0:
            x, y, side = 0.56, low - 0.06, "left"
        axes.text(x, y, note, color=RED, fontsize=8, ha=side, va="center")
        axes.text(0.03, -0.6, "friction would reverse", color="#a04040", fontsize=8, va="center")
        axes.set(title=title, ylim=(-0.72, 1.3), xlim=(0, 1), xticks=[], yticks=[0], yticklabels=["0"])
        axes.set_xlabel("time within a flight")
        axes.set_ylabel("velocity" if i == 0 else "")
        axes.grid(False)
    return figure


def _circle(axes, path, label):
    """The unit circle, and the way of a multiplier through it."""
    angle = np.linspace(0, 2 * np.pi, 200)
    axes.fill(np.cos(angle), np.sin(angle), color=PALE, lw=0)
    axes.plot(np.cos(angle), np.sin(angle), color="0.3", lw=1)
    axes.axhline(0, color="0.7", lw=0.6, zorder=0)
    axes.axvline(0, color="0.7", lw=0.6, zorder=0)
    arrow(axes, path[0], path[1], color=RED, mutation_scale=12, lw=1.8)
    axes.text(*label[:2], label[2], color=RED, ha="center")
    axes.text(0, -1.38, "multipliers: unit circle", ha="center", va="top", fontsize=8, color="0.3")
    bare(axes)
    axes.set(xlim=(-1.75, 1.75), ylim=(-1.75, 1.45))


def _pair(draw, circle):
    figure = new_figure((7.2, 2.5))
    left, right = figure.subplots(1, 2, width_ratios=(1.7, 1))
    draw(left)
    left.set(xticks=[], yticks=[], xlabel="parameter", ylabel="motion")
    left.grid(False)
    _circle(right, *circle)
    return figure


def _marked(axes, x, y, label, offset=(8, 8)):
    axes.plot([x], [y], "o", color="black", ms=6, zorder=5)
    axes.annotate(label, (x, y), offset, textcoords="offset points", weight="bold")


def fold():
    """A stable and an unstable motion meet and vanish."""

    def draw(axes):
        y = np.linspace(0, 1, 100)
        axes.plot(0.15 + y**2, 0.5 + 0.45 * y, color=BLUE)
        axes.plot(0.15 + y**2, 0.5 - 0.45 * y, color=BLUE, ls=(0, (5, 2.2)))
        _marked(axes, 0.15, 0.5, "LP", (-22, -4))
        axes.text(0.75, 0.9, "stable", color=BLUE, ha="right", va="bottom")
        axes.text(0.75, 0.1, "unstable", color=BLUE, ha="right", va="top")
        axes.text(0.07, 0.12, "no such\nmotion", color=GREY, ha="center", va="center")
        axes.set(xlim=(-0.05, 1.15), ylim=(-0.02, 1.05))

    return _pair(draw, (((0.45, 0.0), (1.5, 0.0)), (1.25, 0.18, "+1")))


def symmetry_breaking():
    """Two mirror twins leave a symmetric motion."""

    def draw(axes):
        x = np.linspace(0, 1, 100)
        axes.plot([0, 0.4], [0.5, 0.5], color=BLUE)
        axes.plot([0.4, 1.1], [0.5, 0.5], color=BLUE, ls=(0, (5, 2.2)))
        axes.plot(0.4 + 0.7 * x, 0.5 + 0.4 * np.sqrt(x), color=RED)
        axes.plot(0.4 + 0.7 * x, 0.5 - 0.4 * np.sqrt(x), color=RED)
        _marked(axes, 0.4, 0.5, "SB", (-20, 8))
        axes.text(0.04, 0.44, "symmetric", color=BLUE, va="top")
        axes.text(1.08, 0.74, "hits the left wall harder", color=RED, ha="right", va="top", fontsize=9)
        axes.text(1.08, 0.27, "its mirror image", color=RED, ha="right", va="bottom", fontsize=9)
        axes.set(xlim=(0, 1.12), ylim=(0, 1))

    return _pair(draw, (((0.45, 0.0), (1.5, 0.0)), (1.25, 0.18, "+1")))


def period_doubling():
    """A motion that repeats after two periods takes over."""

    def draw(axes):
        x = np.linspace(0, 1, 100)
        axes.plot([0, 0.4], [0.35, 0.47], color=BLUE)
        axes.plot([0.4, 1.1], [0.47, 0.68], color=BLUE, ls=(0, (5, 2.2)))
        line = 0.47 + 0.3 * 0.7 * x
        axes.plot(0.4 + 0.7 * x, line + 0.22 * np.sqrt(x), color=RED)
        axes.plot(0.4 + 0.7 * x, line - 0.22 * np.sqrt(x), color=RED)
        _marked(axes, 0.4, 0.47, "PD", (-14, 10))
        axes.text(0.04, 0.3, "every period alike", color=BLUE, va="top", fontsize=9)
        axes.text(0.7, 0.93, "one period, and the next", color=RED, ha="center", fontsize=9)
        axes.set(xlim=(0, 1.12), ylim=(0.1, 1.02))

    return _pair(draw, (((-0.45, 0.0), (-1.5, 0.0)), (-1.25, 0.18, "−1")))


def grazing():
    """What a border does: the branch goes on with another word, or turns back."""
    figure = new_figure((7.2, 2.5))
    titles = ("persistence: the branch goes on", "nonsmooth fold: two motions meet")
    for i, title in enumerate(titles):
        axes = figure.add_subplot(1, 2, i + 1)
        axes.axvline(0.5, color="0.6", lw=0.8, ls=(0, (4, 3)))
        axes.plot([0.05, 0.5], [0.3, 0.5], color=BLUE)
        axes.plot([0.5, 0.95], [0.5, 0.7], color=BLUE, ls=(0, (1, 1.8)))
        other = ([0.5, 0.95], [0.5, 0.92]) if i == 0 else ([0.5, 0.05], [0.5, 0.9])
        axes.plot(*other, color=STICK, ls="-" if i == 0 else (0, (5, 2.2)))
        axes.plot([0.5], [0.5], marker="v", color="black", ms=8, zorder=5)
        axes.annotate("VG", (0.5, 0.5), (4, -15), textcoords="offset points", weight="bold")
        axes.text(0.05, 0.22, "LR", color=BLUE, va="top")
        axes.text(0.95, 0.54, "LR, virtual", color=BLUE, ha="right", va="top", fontsize=9)
        axes.text(
            other[0][1], 0.95, "LRs: with a stick", color=STICK, ha="right" if i == 0 else "left", va="bottom"
        )
        axes.set(xlim=(0, 1), ylim=(0.05, 1.1), xticks=[], yticks=[], title=title, xlabel="parameter")
        axes.set_ylabel("motion" if i == 0 else "")
        axes.grid(False)
    return figure


PICTURES = (machine, oscillator, words, margins, fold, symmetry_breaking, period_doubling, grazing)


def draw_all(folder):
    """Draw every sketch into a folder; their paths."""
    places = []
    for picture in PICTURES:
        with styled():
            figure = picture()
            places.append(Path(folder) / f"{picture.__name__}.png")
            figure.savefig(places[-1], dpi=110)
    return places


if __name__ == "__main__":
    target = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).with_name("concepts"))
    target.mkdir(exist_ok=True)
    print(*draw_all(target), sep="\n")
