"""The names by which studies call machines, and where each of them is."""

PLACES = {
    "absorber": ("orbits.machines.absorber", "Absorber"),
    "cavity": ("orbits.machines.cavity", "Cavity"),
    "coupled": ("orbits.machines.coupled", "Coupled"),
}
"""Module and class of each machine."""
NAMES = tuple(PLACES)
NATIVE = ("absorber", "cavity", "coupled")
"""Machines of the native core, in the order of native/machines.hpp; others compute with their reference."""
STRUCTURE = "structure"
"""What studies call a machine of matrices (`orbits.machines.structure`)."""
PAGES = {"coupled_two": "orbits.machines.coupled_two"}
"""Machines that come with the package, whose flow is integrated; the module holds the machine by its name."""
