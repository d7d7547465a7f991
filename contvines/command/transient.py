"""`contvines transient STUDY.toml`: a start-up, a free decay, or the response to a recorded base motion, with and without the absorber;
likewise for declared machines."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
import typer

from orbits.machines.physical.units import counted

from ..shared.numbers import figures
from .frame import present
from .measured import Measured, Rows, Scales, Series, loads_rows, measured, written
from .options import JsonOption, PlotOption, SizeOption, argument, option, refuse_alone
from .study_data import Sort, Study, refused

if TYPE_CHECKING:
    from orbits.design.record import Response
    from orbits.design.transients import StartUp


FARTHEST = 10.0  # metres: largest initial displacement of a free decay
HARDEST = 100_000.0  # m/s^2: largest recorded acceleration of the base
LONGEST = 100_000.0  # longest simulation after a record, in radians of the oscillator


def transient(
    context: typer.Context,
    study: Annotated[
        Path,
        argument("STUDY.toml", "A study of the coupled machine or a declared machine."),
    ],
    release: Annotated[
        str | None,
        option(
            "--release LENGTH",
            'Free decay from this displacement, "5 mm" (declared machine: "x = 5 mm, v = 0.1 m/s").',
        ),
    ] = None,
    record: Annotated[
        Path | None,
        option("--record FILE.csv", "Recorded base motion: one column for time, one for acceleration."),
    ] = None,
    start_up: Annotated[
        bool,
        option("--start-up", "Start from rest, with the excitation of the study."),
    ] = False,
    begin: Annotated[
        str | None,
        option(
            "--from FREQUENCY",
            "With --start-up and --over: first frequency of the run-up to that of the study.",
        ),
    ] = None,
    over: Annotated[
        str | None,
        option("--over TIME", 'Duration of the run-up, linear in time, "5 s".'),
    ] = None,
    time: Annotated[
        str | None,
        option(
            "--time TIME",
            "Free decay: print the share of the energy that impacts and friction take in this time; declared machine: length of the simulation.",
        ),
    ] = None,
    tail: Annotated[
        str | None,
        option("--tail TIME", 'Time to simulate after the record, with the base at rest, "2 s".'),
    ] = None,
    output: Annotated[
        Path | None,
        option("-o, --output FILE.csv", "Result file: the motion (or the energy of a decay) over time."),
    ] = None,
    plot: PlotOption = None,
    size: SizeOption = None,
    json_: JsonOption = False,
) -> None:
    """A start-up, a shock, a recorded base motion or a free decay, compared with the bare oscillator.

    The record is a CSV of time and acceleration; its column heads may name units (time [ms], acceleration [g]).
    """
    from ..export import check_target
    from .compose import machine
    from .study import read_study

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
    refuse_alone(context, tail="--record")
    if output is not None:
        check_target(output, "csv")
    read = read_study(study)
    machine(read)
    if read.sort is Sort.PAGE:
        if record is not None:
            raise ValueError(
                f"{study}: --record: the base is part of the equations of a declared machine; use --start-up or --release."
            )
        found = of_page(read, release, begin, over, time)
    elif release is not None:
        found = _released(read, release, time)
    elif record is not None:
        found = _recorded(read, record, tail)
    elif time is not None:
        raise ValueError(f"--time {time}: this goes with --release.")
    else:
        found = _started(read, begin, over)
    written(output, found.series, json_)
    present(found, json_, plot, size)


def _released(study: Study, text: str, within: str | None) -> Measured:
    from orbits.design.transients import free_decay, taken_share

    model, params = study.model, study.model.vector(study.loose)
    scales = Scales(model, params)
    displacement = scales.number("--release", text, "length")
    if scales.unit("length") and abs(displacement * scales.metre) > FARTHEST and not model.unusual:
        raise ValueError(
            f"--release {text} is implausible for an oscillator: expected at most {FARTHEST:g} m; if it is meant, say unusual = true in "
            "[model]."
        )
    with refused(f"{study.path}: --release {text}"):
        decay = free_decay(model, params, displacement)
    lost = decay.impacts + decay.friction + decay.damping
    rows: Rows = [
        ("pumping_time", decay.pumping_time, "time", "until nine tenths of the energy are gone"),
        ("bare_time", decay.bare_time, "time", "the same without absorber"),
        ("impact_share", decay.impacts / lost, "", "of what was dissipated: by impacts"),
        ("friction_share", decay.friction / lost, "", "by friction"),
        ("damping_share", decay.damping / lost, "", "by the oscillator's own damping"),
    ]
    if within is not None:
        lasts = scales.number("--time", within, "time")
        with refused(f"{study.path}: --time {within}"):
            share = taken_share(model, params, displacement, lasts)
        words = f"of the initial energy: taken by impacts and friction in {within}"
        rows.append(("taken_share", share, "", words))
    series: Series = [
        ("time", "time", decay.times),
        ("energy", "", decay.energy),
        ("bare_energy", "", decay.bare),
    ]
    return Measured(f"Free decay of {study.path.name} from {text}", scales.rows(rows), scales.columns(series))


def _started(study: Study, begin: str | None, over: str | None) -> Measured:
    from orbits.design.transients import start_up

    model, params = study.model, study.model.vector(study.loose)
    scales = Scales(model, params)
    run_up, rising = None, ""
    if run_up_given := _run_up(study, begin, over, scales.unit("time")):
        own = run_up_given[0] / model.amount("frequency", params) * float(model.phase_speed(params))
        run_up = own, run_up_given[1] / scales.factor("time")
        rising = f", its frequency running up from {begin} in {over}"
    with refused(f"{study.path}: --start-up"):
        motion = start_up(model, params, run_up=run_up)
    count, hardest = motion.impact_times.size, float(motion.impact_speeds.max(initial=0.0))
    eps, r = (float(model.column(params, name)) for name in ("mass_ratio", "restitution"))
    impulse = (1.0 + r) / (1.0 + eps) * hardest * scales.factor("impulse")
    relative = max(np.abs(motion.relative).max(), 1.0 if count else 0.0)
    figures: Rows = [
        *_peaks(motion, "largest displacement of the oscillator"),
        ("settled", motion.settled, "time", "time to settle to 5 % (no number: it does not)"),
        ("bare_settled", motion.bare_settled, "time", "the same without absorber"),
        ("impacts", count, "", "how many"),
        ("fastest_impact", hardest, "velocity", "largest impact speed"),
    ]
    rows = [
        *scales.rows(figures),
        *loads_rows(impulse, count, model.contact_time, model.units),
        *scales.rows([("worst_relative", relative, "length", "largest relative displacement")]),
        *([_share(motion)] if run_up is None else []),
    ]
    return _motion(f"Start-up of {study.path.name} from rest{rising}", scales, rows, motion)


def _recorded(study: Study, path: Path, tail: str | None) -> Measured:
    from orbits.design.record import recorded

    model, params = study.model, study.model.vector(study.loose)
    scales = Scales(model, params)
    second, seconds = scales.unit("time"), scales.factor("time")
    rate = "m/s^2" if scales.unit("length") else ""
    times, acceleration = measured(path, {"time": second, "acceleration": rate})
    after = 0.0 if tail is None else scales.number("--tail", tail, "time")
    if after < 0.0:
        raise ValueError(f"--tail {tail}: give a time of 0 or above.")
    if after > LONGEST:
        raise ValueError(
            f"--tail {tail}: give at most {LONGEST * seconds:.3g} {second}".rstrip()
            + ", some ten thousand periods."
        )
    hardest = np.abs(acceleration).max(initial=0.0)
    if rate and not model.unusual and hardest > HARDEST:
        raise ValueError(
            f"{path}: the largest acceleration is {hardest:.3g} m/s^2, which is implausible for a base: expected "
            f"at most {HARDEST:g} m/s^2; name the unit in the head of its column, or, if it is meant, say unusual = true in [model]."
        )
    with refused(str(path)):
        motion = recorded(model, params, times / seconds, acceleration / (scales.metre / seconds**2), after)
    rows: Rows = [
        *_peaks(motion, "largest displacement of the oscillator from the base"),
        ("impacts", motion.impact_times.size, "", "how many"),
        ("impact_energy", motion.impacts, "energy", "dissipated by impacts"),
        ("friction_energy", motion.friction, "energy", "by friction"),
        ("damping_energy", motion.damping, "energy", "by the oscillator's own damping"),
        _share(motion),
    ]
    title = f"{study.path.name} under the base motion of {path.name}, {times.size} instants"
    return _motion(title, scales, scales.rows(rows), motion)


def _peaks(motion: StartUp | Response, words: str) -> Rows:
    displacement = np.abs(motion.oscillator)
    return [
        ("peak", displacement.max(), "length", words),
        ("peak_at", motion.times[displacement.argmax()], "time", "when"),
        ("bare_peak", np.abs(motion.bare).max(), "length", "the same without absorber"),
    ]


def _share(motion: StartUp | Response) -> tuple[str, float, str, str]:
    words = "share of the dissipated energy that impacts and friction take"
    return "absorber_share", motion.absorber_share, "", words


def _motion(title: str, scales: Scales, rows: Rows, motion: StartUp | Response) -> Measured:
    """Convert a simulated motion with and without the absorber to the study's units."""
    series: Series = [
        ("time", "time", motion.times),
        ("oscillator", "length", motion.oscillator),
        ("relative", "length", motion.relative),
        ("bare_oscillator", "length", motion.bare),
    ]
    return Measured(title, rows, scales.columns(series), motion.impact_times * scales.factor("time"))


def _run_up(study: Study, begin: str | None, over: str | None, second: str) -> tuple[float, float] | None:
    """Return the first frequency (`--from`) and the duration (`--over`) of a run-up, in the study's units; None without a run-up."""
    if begin is None or over is None:
        return None
    name = study.model.default_parameter if study.sort is not Sort.PAGE else study.model.phase_rate
    if name is None:
        raise ValueError(
            f"{study.path}: --from {begin}: the machine is self-excited, it has no frequency that could run up."
        )
    frequency = counted("--from", begin, study.model.units.get(name, ""))
    if frequency < 0.0:
        raise ValueError(f"--from {begin}: give a frequency of 0 or above.")
    time = counted("--over", over, second)
    if not time > 0.0:
        raise ValueError(f"--over {over}: give a time above 0.")
    return frequency, time


def of_page(
    study: Study, release: str | None, begin: str | None, over: str | None, within: str | None
) -> Measured:
    """Compute a transient of a declared machine: its states, its impacts, and the energy that impacts and friction dissipate."""
    from orbits.design.page_transients import page_transient
    from orbits.machines.page.si import CONTACT

    machine = study.model
    params, units = machine.vector(study.loose), machine.units
    second = units.get("time", "")
    start = dict(study.state or {}) if release is None else _states(study, release)
    run_up = _run_up(study, begin, over, second)
    rising = dict(zip(("run_up_from", "run_up_time"), run_up or ()))
    with refused(str(study.path)):
        lasts = None if within is None else counted("--time", within, second)
        motion = page_transient(machine, params, start, time=lasts, **rising)
    rows: Rows = []
    for name in motion.states:
        unit = units.get(name, "")
        rows.append((f"largest_{name}", motion.largest[name], unit, f"largest size of {name}"))
        if release is None:
            words = "time to settle to 5 % (no number: it does not)"
            rows.append((f"settled_{name}", motion.settled[name], second, words))
    count = motion.impact_times.size
    speed = units.get("approach_speed", "")
    rows += [("impacts", float(count), "", "how many")] if machine.equations.gap else []
    if count:
        rows.append(("fastest_impact", float(motion.impact_speeds.max()), speed, "largest impact speed"))
    if motion.energy is not None:
        contact_time = study.parameters.get(CONTACT)
        if contact_time is not None:
            contact_time *= machine.equations.factors.get(CONTACT, 1.0)
        loads = {**units, "contact_time": second} if units else {}
        rows += loads_rows(float(motion.impulses.max(initial=0.0)), count, contact_time, loads)
        joule = units.get("impact_loss", "")
        rows.append(("impact_energy", float(motion.impacts[-1]), joule, "taken by impacts"))
        rows.append(("friction_energy", float(motion.friction[-1]), joule, "by friction"))
        if release is not None:
            end = float(motion.times[-1])
            words = f"of the initial energy: taken by both in {figures(end)} {second}".rstrip()
            rows.append(("taken_share", motion.share(end), "", words))
    series = [("time", second, motion.times)]
    series += [(name, units.get(name, ""), values) for name, values in motion.states.items()]
    series += [] if motion.energy is None else [("energy", units.get("impact_loss", ""), motion.energy)]
    origin = f"from {release}" if release else "from its start" if start else "from rest"
    return Measured(f"Transient of {study.path.name} {origin}", rows, series, motion.impact_times, drawn=2)


def _states(study: Study, text: str) -> dict[str, float]:
    """Parse `--release` of a declared machine to states by name."""
    from ..shared.near_names import did_you_mean

    machine, found = study.model, {}
    example = f"{machine.states[0]} = 1 {machine.units.get(machine.states[0], '')}".rstrip()
    for part in text.split(","):
        name, _, value = (side.strip() for side in part.partition("="))
        if name not in machine.states or not value:
            names = ", ".join(machine.states)
            raise ValueError(
                f"--release {text!r}: {name!r} is no state with a value{did_you_mean(name, machine.states)}; of a declared machine it is a list such as "
                f'"{example}", and the states are {names}.'
            )
        with refused(f"--release {text!r}"):
            found[name] = counted(name, value, machine.units.get(name, ""))
    return found
