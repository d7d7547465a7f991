"""Event-driven stepper of the reduced absorber: that of a cavity with this machine's numbers (compiled)."""

from __future__ import annotations

from orbits.machines.absorber import law as _numbers
from orbits.machines.absorber.law import law
from orbits.machines.cavity.stepper import ROW as ROW
from orbits.machines.cavity.stepper import STATE as STATE
from orbits.machines.cavity.stepper import stepper_with

launch, advance, sample, works, energies = stepper_with(law, _numbers)
