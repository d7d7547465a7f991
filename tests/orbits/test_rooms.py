"""What `import orbits` alone has at hand."""

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
