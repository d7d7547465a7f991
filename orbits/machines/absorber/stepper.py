"""Event-driven stepper of the reduced absorber in plain Python: that of a cavity with this machine's numbers."""

from __future__ import annotations

from orbits.machines.absorber.law import law
from orbits.machines.cavity.stepper import ROW as ROW
from orbits.machines.cavity.stepper import STATE as STATE
from orbits.machines.cavity.stepper import ShakenStepper

stepper = ShakenStepper(law)
launch, advance, sample = stepper.launch, stepper.advance, stepper.sample
works, energies = stepper.works, stepper.energies
