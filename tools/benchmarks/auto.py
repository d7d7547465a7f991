"""Time of AUTO-07p per point on the same equations, if it is installed (AUTO_DIR, and a Fortran compiler).

The executable runs without AUTO's Python interface, with the analytic Jacobian and minimal output. AUTO computes
no multipliers of an algebraic problem; its test functions for folds and branch points are switched on.
"""

import os
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

CONSTANTS = """\
NDIM = {n}, IPS = 0, IRS = 0, ILP = 1
ICP = [1]
NTST = 1, NCOL = 4, IAD = 0, ISP = 1, ISW = 1, IPLT = 0, NBC = 0, NINT = 0
NMX = {points}, NPR = 0, MXBF = 0, IID = 0, ITMX = 8, ITNW = 7, NWTN = 7, JAC = 1
EPSL = 1e-10, EPSU = 1e-10, EPSS = 1e-8
DS = {step}, DSMIN = {step}, DSMAX = {step}, IADS = 0
NPAR = 1, THL = {{}}, THU = {{}}
RL0 = 0.2, RL1 = 0.7
"""


class Auto:
    """AUTO with the compiled equations in a separate directory."""

    def __init__(self, directory=None):
        home = os.environ.get("AUTO_DIR", "")
        self.available = bool(home) and (Path(home) / "lib").is_dir() and shutil.which("gfortran") is not None
        if not self.available:
            return
        self.directory = Path(directory or tempfile.mkdtemp(prefix="contvines-auto-"))
        source = Path(__file__).with_name("absorber_auto.f90")
        objects = sorted(str(path) for path in (Path(home) / "lib").glob("*.o"))
        command = ["gfortran", "-O3", "-march=native", "-w", f"-I{home}/include", str(source), *objects]
        subprocess.run(
            [*command, "-fopenmp", "-o", "absorber"], cwd=self.directory, check=True, capture_output=True
        )

    def run(self, l, points, step=2e-3):
        """Continue with a fixed step; return seconds of wall time and the points."""
        text = CONSTANTS.format(n=2 * l, points=points, step=step)
        (self.directory / "fort.2").write_text(text)
        for name in ("fort.7", "fort.8", "fort.9"):
            (self.directory / name).unlink(missing_ok=True)
        begin = time.perf_counter()
        subprocess.run(["./absorber"], cwd=self.directory, check=True, capture_output=True)
        seconds = time.perf_counter() - begin
        rows = [line.split() for line in (self.directory / "fort.7").read_text().splitlines()]
        rows = [row for row in rows if row and row[0] == "1"]
        return seconds, rows
