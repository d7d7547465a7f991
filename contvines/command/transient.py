"""`contvines transient STUDY.toml`: a free decay, or the answer to a recorded motion of the base, with the absorber and without."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from contvines.command.frame import JsonOption, PlotOption, SizeOption, check_plot, draw, say, tell
from contvines.command.page_transient import frequency_on_line, of_page, time_on_line
from contvines.command.study_data import Sort, Study
from contvines.command.transient_table import Told, loads_rows

if TYPE_CHECKING:
    from orbits.design.record import Response
    from orbits.design.start_up import StartUp

FARTHEST = 10.0  # metres that an oscillator is pulled aside
HARDEST = 100_000.0  # m/s^2 that a base is accelerated by
LONGEST = 100_000.0  # that a motion is followed after a record, in radians of the oscillator


def transient(
    study: Annotated[
        Path,
        typer.Argument(metavar="STUDY.toml", help="A study of the coupled machine or a declared machine."),
    ],
    release: Annotated[
        str | None,
        typer.Option(
            "--release",
            metavar="LENGTH",
            help='Free decay from this displacement, "5 mm" (declared machine: "x = 5 mm, v = 0.1 m/s").',
        ),
    ] = None,
    record: Annotated[
        Path | None,
        typer.Option(
            "--record",
            metavar="FILE.csv",
            help="Recorded base motion: one column for time, one for acceleration.",
        ),
    ] = None,
    start_up: Annotated[
        bool,
        typer.Option("--start-up", help="Start from rest, with the excitation of the study."),
    ] = False,
    begin: Annotated[
        str | None,
        typer.Option(
            "--from",
            metavar="FREQUENCY",
            help="With --start-up and --over: first frequency of the run-up to that of the study.",
        ),
    ] = None,
    over: Annotated[
        str | None,
        typer.Option("--over", metavar="TIME", help='Duration of the run-up, linear in time, "5 s".'),
    ] = None,
    time: Annotated[
        str | None,
        typer.Option(
            "--time",
            metavar="TIME",
            help="Free decay: print the share of the energy that impacts and friction take in this time; declared machine: length of the simulation.",
        ),
    ] = None,
    tail: Annotated[
        str | None,
        typer.Option(
            "--tail", metavar="TIME", help='Time to simulate after the record, with the base at rest, "2 s".'
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            metavar="FILE.csv",
            help="Result file: the motion (or the energy of a decay) over time.",
        ),
    ] = None,
    plot: PlotOption = None,
    size: SizeOption = None,
    json_: JsonOption = False,
) -> None:
    """A start-up, a shock, a recorded base motion or a free decay, compared with the bare oscillator.

    The record is a CSV of time and acceleration; its column heads may name units (time [ms], acceleration [g]).
    """
    from contvines.command.compose import machine
    from contvines.command.study import read_study
    from contvines.export import check_target

    if [release is not None, record is not None, start_up].count(True) != 1:
        given = "none is" if release is None and record is None and not start_up else "more than one is"
        raise ValueError(
            f'--release, --record and --start-up: {given} given; give one of them: --release "5 mm" for a free decay, '
            "--record shock.csv for a measured motion of the base, --start-up for the study's own excitation."
        )
    if (begin is None) != (over is None) or (begin is not None and not start_up):
        raise ValueError(
            "--from and --over go together, and with --start-up: the frequency runs up from the one in the other."
        )
    if tail is not None and record is None:
        raise ValueError(f"--tail {tail}: this goes with --record.")
    if output is not None:
        check_target(output, "csv")
    check_plot(plot, size)
    read = read_study(study)
    machine(read)
    if read.sort is Sort.PAGE:
        if record is not None:
            raise ValueError(
                f"{study}: --record: the base is part of the equations of a declared machine; use --start-up or --release."
            )
        found = of_page(read, release, begin, over, time)
    elif start_up:
        if time is not None:
            raise ValueError(f"--time {time}: this goes with --release.")
        found = _started(read, begin, over)
    else:
        found = _released(read, release, time) if release is not None else _recorded(read, record, tail)  # type: ignore[arg-type]
    tell(found, found.as_json() if json_ else None)
    if output is not None:
        found.write(output)
        say(f"kept in {output}", json_)
    draw(plot, lambda: found.draw(size), json_)


def _released(study: Study, text: str, within: str | None) -> Told:
    from contvines.command.measured import length_on_line, scales
    from orbits.design.transients import free_decay, taken_share
    from orbits.machines.physical import units

    model, params = study.model, study.model.vector(study.loose)
    length, unit, seconds, second = scales(model, params)
    displacement = length_on_line(text, "--release", unit)
    metres = displacement * (units.size(unit, "m") or 1.0) if unit else 0.0
    if abs(metres) > FARTHEST and not model.unusual:
        raise ValueError(
            f"--release {text} is implausible for an oscillator: expected at most {FARTHEST:g} m; if it is meant, say unusual = true in "
            "[model]."
        )
    try:
        decay = free_decay(model, params, displacement / length)
    except ValueError as error:
        raise ValueError(f"{study.path}: --release {text}: {error}.") from None
    more = []
    if within is not None:
        told = length_on_line(within, "--time", second)
        try:
            share = taken_share(model, params, displacement / length, told / seconds)
        except ValueError as error:
            raise ValueError(f"{study.path}: --time {within}: {error}.") from None
        more = [
            ("taken_share", share, "", f"of the initial energy: taken by impacts and friction in {within}")
        ]
    lost = decay.impacts + decay.friction + decay.damping
    rows = [
        ("pumping_time", decay.pumping_time * seconds, second, "until nine tenths of the energy are gone"),
        ("bare_time", decay.bare_time * seconds, second, "the same without absorber"),
        ("impact_share", decay.impacts / lost, "", "of what was dissipated: by impacts"),
        ("friction_share", decay.friction / lost, "", "by friction"),
        ("damping_share", decay.damping / lost, "", "by the oscillator's own damping"),
        *more,
    ]
    series = [
        ("time", second, decay.times * seconds),
        ("energy", "", decay.energy),
        ("bare_energy", "", decay.bare),
    ]
    return Told(f"Free decay of {study.path.name} from {text}", rows, series)


def _started(study: Study, begin: str | None, over: str | None) -> Told:
    import numpy as np

    from contvines.command.measured import scales
    from orbits.design.start_up import start_up
    from orbits.machines.physical import units

    model, params = study.model, study.model.vector(study.loose)
    length, unit, seconds, second = scales(model, params)
    run_up = None
    if begin is not None and over is not None:
        rising = (
            frequency_on_line(study, begin)
            / model.amount("frequency", params)
            * float(model.phase_speed(params))
        )
        run_up = (rising, time_on_line(over, second) / seconds)
    try:
        seen = start_up(model, params, run_up=run_up)
    except ValueError as error:
        raise ValueError(f"{study.path}: --start-up: {error}.") from None
    gauges = model.tables.GAUGES if unit else {}
    speed = units.unit_of(gauges["velocity"]) if unit else ""
    moved, bare = np.abs(seen.oscillator), np.abs(seen.bare)
    hardest = float(seen.impact_speeds.max(initial=0.0))
    fastest = hardest * float(model.gauge("velocity", params))
    eps, r = (float(model.column(params, name)) for name in ("mass_ratio", "restitution"))
    impulse = (1.0 + r) / (1.0 + eps) * hardest * float(model.gauge("impulse", params))
    rows = [
        ("peak", float(moved.max()) * length, unit, "largest displacement of the oscillator"),
        ("peak_at", float(seen.times[int(moved.argmax())]) * seconds, second, "when"),
        ("bare_peak", float(bare.max()) * length, unit, "the same without absorber"),
        ("settled", seen.settled * seconds, second, "time to settle to 5 % (no number: it does not)"),
        ("bare_settled", seen.bare_settled * seconds, second, "the same without absorber"),
        ("impacts", float(seen.impact_times.size), "", "how many"),
        ("fastest_impact", fastest, speed, "largest impact speed"),
        *loads_rows(impulse, seen.impact_times.size, model.contact_time, model.units),
        (
            "worst_relative",
            max(float(np.abs(seen.relative).max()), 1.0 if seen.impact_times.size else 0.0) * length,
            unit,
            "largest relative displacement",
        ),
    ]
    if run_up is None:
        words = "share of the dissipated energy that impacts and friction take"
        rows.append(("absorber_share", seen.absorber_share, "", words))
    rising = "" if begin is None else f", its frequency running up from {begin} in {over}"
    return _motion(
        f"Start-up of {study.path.name} from rest{rising}", rows, seen, (length, unit, seconds, second)
    )


def _recorded(study: Study, path: Path, tail: str | None) -> Told:
    import numpy as np

    from contvines.command.measured import Column, length_on_line, measured, scales
    from orbits.design.transients import recorded

    model, params = study.model, study.model.vector(study.loose)
    length, unit, seconds, second = scales(model, params)
    rate = "m/s^2" if unit else ""
    times, acceleration = measured(path, (Column("time", second), Column("acceleration", rate)))
    from orbits.machines.physical import units

    metre = units.size(unit, "m") if unit else 1.0
    one = (metre or 1.0) * length / seconds**2  # of acceleration
    after = 0.0 if tail is None else length_on_line(tail, "--tail", second) / seconds
    if after < 0.0:
        raise ValueError(f"--tail {tail}: give a time of 0 or above.")
    if after > LONGEST:
        raise ValueError(
            f"--tail {tail}: give at most {LONGEST * seconds:.3g} {second}".rstrip()
            + ", some ten thousand periods."
        )
    if unit and not model.unusual and np.abs(acceleration).max(initial=0.0) > HARDEST:
        raise ValueError(
            f"{path}: the largest acceleration is {np.abs(acceleration).max():.3g} m/s^2, which is implausible for a base: expected "
            f"at most {HARDEST:g} m/s^2; name the unit in the head of its column, or, if it is meant, say unusual = true in [model]."
        )
    try:
        seen = recorded(model, params, times / seconds, acceleration / one, after)
    except ValueError as error:
        raise ValueError(f"{path}: {error}.") from None
    energy = float(model.gauge("energy", params)) / float(model.column(params, "mass_ratio"))
    joule = units.unit_of(model.tables.GAUGES["energy"]) if unit else ""
    over = np.abs(seen.oscillator)
    rows = [
        ("peak", seen.peak * length, unit, "largest displacement of the oscillator from the base"),
        ("peak_at", float(seen.times[int(over.argmax())]) * seconds, second, "when"),
        ("bare_peak", seen.bare_peak * length, unit, "the same without absorber"),
        ("impacts", float(seen.impact_times.size), "", "how many"),
        ("impact_energy", seen.impacts * energy, joule, "dissipated by impacts"),
        ("friction_energy", seen.friction * energy, joule, "by friction"),
        ("damping_energy", seen.damping * energy, joule, "by the oscillator's own damping"),
        (
            "absorber_share",
            seen.absorber_share,
            "",
            "share of the dissipated energy that impacts and friction take",
        ),
    ]
    title = f"{study.path.name} under the base motion of {path.name}, {times.size} instants"
    return _motion(title, rows, seen, (length, unit, seconds, second))


def _motion(
    title: str,
    rows: list[tuple[str, float, str, str]],
    seen: StartUp | Response,
    scales: tuple[float, str, float, str],
) -> Told:
    """A simulated motion with the absorber and without, in the study's units of length and time."""
    length, unit, seconds, second = scales
    series = [
        ("time", second, seen.times * seconds),
        ("oscillator", unit, seen.oscillator * length),
        ("relative", unit, seen.relative * length),
        ("bare_oscillator", unit, seen.bare * length),
    ]
    return Told(title, rows, series, seen.impact_times * seconds)
