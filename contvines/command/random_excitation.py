"""`contvines random STUDY.toml`: response to a random excitation with a given spectral density, compared with the bare and the tuned machine."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from ..shared.numbers import figures
from .frame import present
from .measured import Measured, Rows, Scales, Series, written
from .options import JsonOption, PlotOption, SizeOption, argument, option
from .study_data import Sort, Study

WORDS = {
    "oscillator": "displacement of the oscillator from its base",
    "bare": "the same without absorber",
    "tuned": "the same with a tuned absorber of the same mass",
    "relative": "displacement of the oscillator against the absorber",
}
KINDS = {"rms": "standard deviation", "peak": "largest in a record, mean over the records", "mean": "mean"}
OWN = {
    "impact_rate": "impacts per unit of time",
    "absorber_power": "power that impacts and friction take",
    "absorber_share": "of what is dissipated: by impacts and friction",
}
KINDS_OF_OWN = {"impact_rate": "rate", "absorber_power": "power", "absorber_share": ""}
EXAMPLE = "[random] psd = [[2, 0.1], [20, 0.1]]"


def random(
    study: Annotated[
        Path,
        argument("STUDY.toml", "A study with a section [random], of the coupled or a declared machine."),
    ],
    seed: Annotated[
        int | None,
        option("--seed N", "Seed of the random draws, in place of the one in the study.", min=0),
    ] = None,
    output: Annotated[
        Path | None,
        option("-o, --output FILE.csv", "Result file: spectral densities of the responses."),
    ] = None,
    plot: PlotOption = None,
    size: SizeOption = None,
    json_: JsonOption = False,
) -> None:
    """Response to a random excitation of given spectral density: statistics with error bars.

    [random] psd = [[2, 0.1], [20, 0.1]] are frequencies [Hz] and densities of the base's acceleration [(m/s^2)^2/Hz], linear between; of a study without units
    frequencies in omega_0 and densities per omega_0. Of a declared machine name the parameter that is random, too. The same seed gives the same numbers.
    """
    from ..export import check_target
    from .compose import machine
    from .study import read_study

    if output is not None:
        check_target(output, "csv")
    read = read_study(study)
    machine(read)
    found = _computed(read, seed)
    written(output, found.series, json_)
    present(found, json_, plot, size)


def _computed(study: Study, seed: int | None) -> Measured:
    from orbits.design.random_excitation import Density, random_base, random_page

    section = study.random
    if section is None:
        raise ValueError(f"{study.path}: the section [random] is missing; for example {EXAMPLE}.")
    model, params = study.model, study.model.vector(study.loose)
    page = study.sort is Sort.PAGE
    if page != (section.parameter is not None):
        advice = (
            f"name the parameter that is random, one of {', '.join(model.parameter_names)}"
            if page
            else "leave it out: the base is what moves"
        )
        raise ValueError(f"{study.path}: [random] parameter: {advice}.")
    frequencies, values = np.array(section.psd, dtype=float).T
    options: dict[str, Any] = {
        "periods": section.periods,
        "records": section.records,
        "seed": section.seed if seed is None else seed,
    }
    units, scales = model.units, Scales(model, params)
    turn = 2.0 * math.pi if units else 1.0  # densities are per hertz if the study has units
    rate = 1.0 if page else 1.0 / scales.factor("time")
    try:
        if section.parameter is not None:
            psd = Density(frequencies * turn, values / turn)
            response = random_page(model, params, section.parameter, psd, start=study.state, **options)
        else:
            acceleration = scales.metre * rate**2
            psd = Density(frequencies * turn / rate, values * rate / turn / acceleration**2)
            response = random_base(model, params, psd, **options)
    except (ValueError, KeyError) as error:
        raise ValueError(f"{study.path}: [random] {str(error).rstrip('.')}.") from None

    def length(name: str) -> tuple[float, str]:
        """Return the factor from a dimensionless response to the study's unit, and the unit's name."""
        return (1.0, units.get(name, "")) if page else (scales.factor("length"), scales.unit("length"))

    rows: Rows = []
    errors: dict[str, float] = {}
    for name, (value, error) in response.numbers.items():
        sort, _, quantity = name.partition("_")
        if name in OWN:
            kind, words = "" if page else KINDS_OF_OWN[name], OWN[name]
            factor, unit = scales.factor(kind), scales.unit(kind) or ("Hz" if page and units else "")
        else:
            factor, unit = length(quantity)
            words = f"{KINDS[sort]} of {quantity}" if page else f"{KINDS[sort]}: {WORDS[quantity]}"
        rows.append((name, factor * value, unit, words))
        errors[name] = factor * error
    series: Series = [("frequency", "Hz" if units else "", response.omega * rate / turn)]
    for name, values in response.densities.items():
        factor, unit = length(name)
        series.append((name, f"{unit}^2/Hz" if unit else "", values * factor**2 * turn / rate))
    seconds = f"{figures(response.duration / rate)} {'s' if units else 'units of time'}"
    title = f"{study.path.name} under random excitation: {response.records} records of {seconds}"
    return Measured(title, rows, series, errors=errors)
