"""Processes that tests start do not outlive them, and take Ctrl-C though the suite may ignore it."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(sys.platform != "linux", reason="what ends with its parent is a matter of Linux"),
]

SUITE = """
import subprocess, sys

def test_it():
    child = subprocess.Popen([sys.executable, "-c", "import time; print('up', flush=True); time.sleep(600)"], stdout=subprocess.PIPE)
    child.stdout.readline()
    print("child", child.pid, flush=True)
    {end}
"""


def suite(tmp_path, end, *words):
    """A suite of one test below a folder `tests` with our conftest, in a process of its own that ignores Ctrl-C."""
    folder = tmp_path / "tests"
    folder.mkdir()
    (folder / "children.py").symlink_to(Path(__file__).with_name("children.py"))
    (folder / "conftest.py").write_text(
        "from tests.children import adopt, no_child_survives_its_test\nadopt()\n"
    )
    (folder / "test_one.py").write_text(SUITE.format(end=end))
    (tmp_path / "pytest.ini").write_text(
        "[pytest]\npythonpath = .\naddopts = -p no:cacheprovider --import-mode=importlib\n"
    )
    ignoring = ["sh", "-c", "trap '' INT; exec \"$@\"", "sh"]
    return subprocess.Popen(
        [*ignoring, sys.executable, "-m", "pytest", "-q", "-s", *(words or ("-n", "0")), "tests"],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": ""},
    )


def gone(pid):
    for _ in range(500):
        try:
            if " Z " in Path(f"/proc/{pid}/stat").read_text():
                return True
        except FileNotFoundError:
            return True
        time.sleep(0.02)
    return False


@pytest.mark.parametrize(
    ("end", "blow", "status"),
    [
        ("pass", None, 0),
        ("raise AssertionError", None, 1),
        ("child.wait()", signal.SIGKILL, -signal.SIGKILL),
        # the child takes an interrupt, though the suite ignores it; the suite, too
        ("child.send_signal(2); assert child.wait(60) in (-2, 1, 130)", None, 0),
        ("import time; time.sleep(600)", signal.SIGINT, 2),
    ],
)
def test_a_child_ends_with_its_test_or_its_suite(tmp_path, end, blow, status):
    process = suite(tmp_path, end)
    begun = next(line for line in process.stdout if line.startswith("child"))
    if blow:
        process.send_signal(blow)
    assert gone(int(begun.split()[1]))
    process.communicate(timeout=60)
    assert process.returncode == status


def test_a_test_that_hangs_is_named_and_its_process_ends(tmp_path, pytestconfig):
    assert float(pytestconfig.getini("faulthandler_timeout")) > 0.0
    assert pytestconfig.getini("faulthandler_exit_on_timeout")
    limits = "-o", "faulthandler_timeout=3", "-o", "faulthandler_exit_on_timeout=true"
    said, _ = suite(tmp_path, "child.wait()", "-n", "1", *limits).communicate()
    assert "crashed while running 'tests/test_one.py::test_it'" in said
