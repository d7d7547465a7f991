"""Kill -9 in the middle of a diagram, then the same command again: the same graph as an undisturbed run."""

import random
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from contvines.graph.persistence import same_graph
from contvines.store import Store, load

pytestmark = pytest.mark.slow

HERE = Path(__file__).parents[1]
STUDY = HERE.parents[1] / "examples" / "friction.toml"
COMMAND = [sys.executable, "-m", "contvines.command", "diagram", str(STUDY), "--quiet", "-o"]


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    path = tmp_path_factory.mktemp("undisturbed") / "u.vines"
    subprocess.run([*COMMAND, str(path)], check=True)
    return load(path, problems=False)


@pytest.mark.parametrize("where", ["before", "inside", "after"])
def test_killed_at_chosen_writes(tmp_path, undisturbed, where):
    path, log = tmp_path / "k.vines", tmp_path / "log.txt"
    chance = random.Random(where)
    kills = 0
    for attempt in range(2):
        writes = chance.randint(2, 3 + 4 * attempt)
        words = [str(writes), where, str(log), "diagram", str(STUDY), "--quiet", "-o", str(path)]
        done = subprocess.run([sys.executable, str(HERE / "killer.py"), *words])
        if done.returncode == 0:
            break
        assert done.returncode == -signal.SIGKILL
        kills += 1
        with Store.open(path) as store:  # whole
            if store.finished:  # killed right after its last write
                assert where == "after"
                break
            kept = [key for key, _ in store.entries("journal")]
        assert set(log.read_text().split()) <= set(kept)  # nothing lost but what was in flight
    assert kills
    subprocess.run([*COMMAND, str(path)], check=True)
    assert same_graph(load(path, problems=False), undisturbed)


@pytest.mark.parametrize("blow", [signal.SIGKILL, signal.SIGINT])
def test_stopped_while_it_looks_for_what_the_diagram_does_not_have(tmp_path, undisturbed, blow):
    path = tmp_path / "l.vines"
    code = (
        "import os, sys\nfrom contvines.coexistence import census\nfrom contvines.command.cli import main\n"
        f"census.census = lambda *a: os.kill(os.getpid(), {int(blow)})\nmain(sys.argv[1:])"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, *COMMAND[3:], str(path)], capture_output=True, text=True
    )
    if blow == signal.SIGINT:
        assert done.returncode == 130
        assert f"the diagram is kept in {path}; the same command looks again" in done.stderr
        assert "Traceback" not in done.stderr
    stopped = load(path, problems=False)
    assert stopped.finished and not stopped.looked and not stopped.missing
    subprocess.run([*COMMAND, str(path)], check=True)
    assert same_graph(load(path, problems=False), undisturbed)
    assert undisturbed.looked and undisturbed.missing


def test_interrupted_by_ctrl_c_says_how_to_go_on(tmp_path, undisturbed):
    path = tmp_path / "c.vines"
    code = (
        "import sys\nfrom contvines.store import Store\nfrom contvines.command.cli import main\n"
        "record = Store.record\n"
        "def once(self, *a):\n    record(self, *a)\n    raise KeyboardInterrupt\n"
        "Store.record = once\nmain(sys.argv[1:])"
    )
    words = ["diagram", str(STUDY), "-o", str(path)]
    done = subprocess.run([sys.executable, "-c", code, *words], capture_output=True, text=True)
    assert done.returncode == 130
    assert f"all finished points are kept in {path}; the same command goes on from there" in done.stderr
    assert "Traceback" not in done.stderr
    again = subprocess.run([*COMMAND[:-2], "-o", str(path)], capture_output=True, text=True)
    assert again.returncode == 0
    assert "is unfinished: going on after" in again.stderr
    assert same_graph(load(path, problems=False), undisturbed)
    before = path.read_bytes()
    third = subprocess.run([*COMMAND[:-2], "-o", str(path)], capture_output=True, text=True)
    assert third.returncode == 0
    assert "holds the finished result of this study; nothing to compute" in third.stderr
    assert third.stdout == again.stdout
    assert path.read_bytes() == before
