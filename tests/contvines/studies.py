"""Studies that many tests begin with, and how a test changes one."""

import csv
import tomllib
from functools import reduce
from pathlib import Path

EXAMPLES = Path(__file__).parents[2] / "examples"

# the reduced absorber of the literature
PAPER_MACHINE = """[model]
name = "absorber"
restitution = 0.76
friction = 0.5
gravity = 0.211
mass_ratio = 0.006
"""
PAPER = (
    PAPER_MACHINE
    + """[start]
word = "LR"
periods = 1
amplitude = 0.55
[continue]
parameter = "amplitude"
within = [0.2, 1.2]
depth = 0
"""
)
# the same machine, whose walls give way where it is warm
WARM = PAPER + "[conditions]\ntemperature = 40\n[survey]\nvary.temperature = [20, 70]\n"
WARM = WARM.replace("0.76", "{ temperature = [[20, 0.8], [60, 0.7], [80, 0.6]] }")
# the absorber on an oscillator
COUPLED = PAPER_MACHINE.replace("absorber", "coupled") + (
    '[start]\nword = "LR"\nforcing = 3.3\nfrequency = 0.98\n[continue]\nparameter = "frequency"\nwithin = [0.95, 1.05]'
)
# a machine in kilograms, millimetres and hertz
SI = """
units = "si"
[model]
name = "coupled"
oscillator_mass = "3.8 kg"
natural_frequency = "8 Hz"
absorber_mass = "32 g"
half_width = "15 mm"
damping_ratio = 0.007
restitution = 0.6
friction = 0.1
base_amplitude = "0.3 mm"
[start]
word = "LR"
frequency = "7.9 Hz"
[continue]
parameter = "frequency"
within = ["7.5 Hz", "8200 mHz"]
"""
# a machine of two absorbers that comes with the package, integrated
TWO = """
units = "si"
[model]
name = "coupled_two"
[start]
frequency = "8 Hz"
[continue]
parameter = "frequency"
within = ["7.6 Hz", "8.4 Hz"]
"""
# a machine in a file, and a study of it
STOP_FILE = """
from orbits import Machine, Wall
from orbits.symbols import cos

machine = Machine(
    name="stop",
    states=("x", "v"),
    parameters={"forcing": 1.0, "frequency": 2.3, "damping": 0.05, "gap": 0.1, "restitution": 0.8},
    phase_rate="frequency",
    motion=lambda s, phase, p, contact: (s.v, p.forcing * cos(phase) - 2 * p.damping * s.v - s.x),
    contacts=[Wall("R", gap=lambda s, phase, p: p.gap - s.x, push={"v": -1.0}, restitution="restitution")],
)
"""
STOP = """
[model]
name = "stop.py:machine"
gap = 0.05
[start]
frequency = 2.3
[continue]
parameter = "frequency"
within = [2.2, 2.5]
depth = 0
[sweep]
count = 4
transient = 30
"""


def data(text, changes=""):
    """A study as dicts, after changes: lines of TOML, laid over it, or `no SECTION.FIELD`, which takes it away."""
    study = tomllib.loads(text)
    for line in changes.splitlines():
        if line.startswith("no "):
            *sections, field = line[3:].split(".")
            del reduce(dict.__getitem__, sections, study)[field]
        else:
            lay(study, tomllib.loads(line))
    return study


def lay(study, change):
    for name, value in change.items():
        if isinstance(value, dict) and isinstance(study.get(name), dict):
            lay(study[name], value)
        else:
            study[name] = value


def table(path):
    """The rows of a file that a study has written."""
    with open(path, newline="") as file:
        return list(csv.DictReader(file))
