"""Transients of declared machines, and the frequency from which one runs up."""

from __future__ import annotations

from contvines.command.measured import Rows
from contvines.command.sentences import refused
from contvines.command.study_data import Sort, Study
from contvines.command.transient_table import Told, loads_rows
from contvines.shared.number_text import figures
from orbits.machines.physical.units import counted


def frequency_on_line(study: Study, text: str) -> float:
    """`--from`, counted as the study counts its frequency."""
    name = study.model.default_parameter if study.sort is not Sort.PAGE else study.model.phase_rate
    if name is None:
        raise ValueError(
            f"{study.path}: --from {text}: the machine is self-excited, it has no frequency that could run up."
        )
    value = counted("--from", text, study.model.units.get(name, ""))
    if value < 0.0:
        raise ValueError(f"--from {text}: give a frequency of 0 or above.")
    return value


def time_on_line(text: str, second: str) -> float:
    """`--over`, in the study's unit of time."""
    time = counted("--over", text, second)
    if not time > 0.0:
        raise ValueError(f"--over {text}: give a time above 0.")
    return time


def of_page(
    study: Study, release: str | None, begin: str | None, over: str | None, within: str | None
) -> Told:
    """A transient of a declared machine: its states, its impacts and what these and friction take."""
    from orbits.design.page_transients import page_transient
    from orbits.machines.page.si import CONTACT

    machine = study.model
    params, shown = machine.vector(study.loose), machine.units
    second = shown.get("time", "")
    start = dict(study.named_state or {}) if release is None else _states(study, release)
    rising = {} if begin is None or over is None else {
        "run_up_from": frequency_on_line(study, begin), "run_up_time": time_on_line(over, second)
    }  # fmt: skip
    with refused(str(study.path)):
        lasts = None if within is None else counted("--time", within, second)
        seen = page_transient(machine, params, start, time=lasts, **rising)
    rows: Rows = []
    for name in seen.states:
        unit = shown.get(name, "")
        rows.append((f"largest_{name}", seen.largest[name], unit, f"largest size of {name}"))
        if release is None:
            words = "time to settle to 5 % (no number: it does not)"
            rows.append((f"settled_{name}", seen.settled[name], second, words))
    count = seen.impact_times.size
    speed = shown.get("approach_speed", "")
    rows += [("impacts", float(count), "", "how many")] if machine.equations.gap else []
    if count:
        rows.append(("fastest_impact", float(seen.impact_speeds.max()), speed, "largest impact speed"))
    if seen.energy is not None:
        held = study.parameters.get(CONTACT)
        if held is not None:
            held *= machine.equations.factors.get(CONTACT, 1.0)
        loads = {**shown, "contact_time": second} if shown else {}
        rows += loads_rows(float(seen.impulses.max(initial=0.0)), count, held, loads)
        joule = shown.get("impact_loss", "")
        rows.append(("impact_energy", float(seen.impacts[-1]), joule, "taken by impacts"))
        rows.append(("friction_energy", float(seen.friction[-1]), joule, "by friction"))
        if release is not None:
            end = float(seen.times[-1])
            words = f"of the initial energy: taken by both in {figures(end)} {second}".rstrip()
            rows.append(("taken_share", seen.share(end), "", words))
    series = [
        ("time", second, seen.times),
        *((name, shown.get(name, ""), values) for name, values in seen.states.items()),
    ]
    series += [] if seen.energy is None else [("energy", shown.get("impact_loss", ""), seen.energy)]
    what = f"from {release}" if release else "from its start" if start else "from rest"
    return Told(f"Transient of {study.path.name} {what}", rows, series, seen.impact_times, drawn=2)


def _states(study: Study, text: str) -> dict[str, float]:
    """`--release` of a declared machine: states by name."""
    from contvines.shared.near_names import did_you_mean

    machine, found = study.model, {}
    example = f"{machine.states[0]} = 1 {machine.units.get(machine.states[0], '')}".rstrip()
    for part in text.split(","):
        name, _, value = (side.strip() for side in part.partition("="))
        if name not in machine.states or not value:
            known = ", ".join(machine.states)
            raise ValueError(
                f"--release {text!r}: {name!r} is no state with a value{did_you_mean(name, machine.states)}; of a declared machine it is a list such as "
                f'"{example}", and the states are {known}.'
            )
        with refused(f"--release {text!r}"):
            found[name] = counted(name, value, machine.units.get(name, ""))
    return found
