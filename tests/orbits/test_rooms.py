"""What `import orbits` alone has at hand, and what a diagram of a machine does without."""

import json
import math
import subprocess
import sys

import pytest

CODE = """
import json, sys
import orbits
assert not any(name.startswith("orbits.design") for name in sys.modules)
print(json.dumps(orbits.design.Design(cavity=0.01, natural_frequency=5.0, restitution=0.5, friction=0.0, mass_ratio=0.0).activation_threshold))
"""


def test_the_design_is_at_hand_without_an_import_of_its_own():
    """Least amplitude of impacts without friction: 2 b R/sqrt(pi^2 + 4 R^2), of an oscillator that outweighs the absorber."""
    done = subprocess.run([sys.executable, "-c", CODE], capture_output=True, text=True, check=True)
    R = 0.5 / 1.5
    expected = 2.0 * 0.01 * R / math.sqrt(math.pi**2 + 4.0 * R**2)
    assert json.loads(done.stdout) == pytest.approx(expected, rel=1e-12)


WITHOUT = """
import sys
import contvines as cv
from orbits import Absorber
seed = Absorber(restitution=0.76, friction=0.5, gravity=0.211, mass_ratio=0.006).orbit("LR", amplitude=0.55)
cv.diagram(seed, over="amplitude", within=(0.5, 0.6), depth=0)
print([name for name in ("contvines.flows", "scipy", "matplotlib", "heyoka") if name in sys.modules])
"""


def test_a_diagram_of_a_machine_does_without_flows():
    done = subprocess.run([sys.executable, "-c", WITHOUT], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
