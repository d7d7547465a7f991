"""Numbers and names as a page has them: few digits, no infinities, no markup."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import PurePath
from typing import TYPE_CHECKING, Any

import numpy as np

from ..problems.abilities import Animated

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ..graph.graph import Graph
    from ..loci.chart import Chart


def shortened(values: ArrayLike, digits: int = 9) -> list[float | None]:
    """Numbers with so many digits; None for what is no finite number."""
    return [float(f"{v:.{digits}g}") if np.isfinite(v) else None for v in np.asarray(values, dtype=float)]


def rounded(value: object) -> object:
    """Arrays and numbers within dicts and lists with five digits."""
    if isinstance(value, np.ndarray):
        return shortened(value, 5)
    if isinstance(value, dict):
        return {k: rounded(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [rounded(v) for v in value]
    return float(f"{value:.5g}") if isinstance(value, float) else value


def readable_model(model: dict[str, Any]) -> dict[str, Any]:
    """What a page says of a machine: its plain entries; of files only their names, not where they lay."""
    plain = {str(k): v for k, v in model.items() if not isinstance(v, dict | list)}
    return {k: PurePath(v).name if k == "page" else v for k, v in plain.items()}


def heading(result: Graph | Chart, source: str, names: Iterable[str]) -> dict[str, Any]:
    """What every page of a graph or chart says: versions, model, settings, state, and these names as labels of axes."""
    from .. import __version__
    from ..plots.style import axis_label

    return {
        "version": __version__,
        "source": source,
        "model": readable_model(result.model),
        "settings": {str(k): v for k, v in result.settings.items()},
        "finished": result.finished,
        "message": result.message,
        "names": {
            name: plain_label(axis_label(name, unit=result.units.get(name), notation=result.notation))
            for name in names
        },
    }


def scene(orbit: object, samples: int) -> dict[str, Any] | None:
    """Curves of a motion for the page; None of a solution that has none."""
    if not isinstance(orbit, Animated):
        return None
    return {name: rounded(part) for name, part in orbit.scene(samples).items()}


def plain_label(label: str) -> str:
    """A matplotlib label as plain text: no dollars and commands."""
    for old, new in (
        ("$^{-1}$", "⁻¹"), ("$", ""), (r"\Omega", "Ω"), (r"\mu", "μ"), (r"\tilde g", "g"), (r"\varepsilon", "ε"), (r"\lambda", "λ"),
        ("^{2}", "²"), ("^{-2}", "⁻²"), ("^{3}", "³"), ("^+", "⁺"), ("^-", "⁻"), ("^2", "²"), ("_1", "₁"), ("_-", "₋"), (r"\,", " "),
    ):  # fmt: skip
        label = label.replace(old, new)
    return label
