"""Quantities are read whatever another installation has left behind."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pint

TOP = Path(__file__).resolve().parents[4]
READS = "from orbits.machines.physical.units import registry; print(registry()('15 mm').to('m').magnitude)"


def test_what_an_installation_of_pint_has_kept_is_not_needed_by_another(tmp_path):
    """A virtual environment is deleted, and the next one goes on."""
    other = tmp_path / "other"
    shutil.copytree(Path(pint.__file__).parent, other / "pint")
    said = []
    for paths in ((other, TOP), (TOP,)):
        known = {"PYTHONPATH": os.pathsep.join(map(str, paths)), "XDG_CACHE_HOME": str(tmp_path / "cache")}
        done = subprocess.run([sys.executable, "-c", READS], env=os.environ | known, capture_output=True, text=True)  # fmt: skip
        said.append(done.stdout.strip() or done.stderr)
        shutil.rmtree(other, ignore_errors=True)
    assert said == ["0.015", "0.015"]
