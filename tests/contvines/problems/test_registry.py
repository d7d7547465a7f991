"""Files are data: whatever a .vines file names, reading it imports and calls nothing."""

import subprocess
import sys

import numpy as np
import pytest

import contvines as cv
from contvines.problems.registry import UnknownFactory, factory, rebuild

EVIL = "open('marker', 'w').close()\ndef F(u, p):\n    return u - p\n"


def described(factory_name, **more):
    # Popen(description) would run its keys as a command line
    return {"touch": 0, "marker": 0, "factory": factory_name, **more}


CALLABLES = {"F": "evil:F", "jacobian": None, "derivative": None, "mirror": None}
NAMES = {
    "u0": [0.0],
    "p0": 0.0,
    "parameter": "p",
    "spectrum": "none",
    "name": "x",
    "cycle": 1,
    "dimension": 1,
}
ATTACKS = {
    "a process": described("orbits.ahead:subprocess.Popen"),
    "the system": described("os:system"),
    "an own module": described("evil:F"),
    "a submodule by attribute": described("contvines.problems.registry:import_module"),
    "builtins": described("builtins:exec"),
    "a builder that takes names": described("contvines.problems.registry:factory"),
    "no text": described(["os:system"]),
    "a long name": described("x" * 100_000),
    "functions of an equation": described(
        "contvines.problems.algebraic:from_description", callables=CALLABLES, **NAMES
    ),
    "functions of a map, as in version 0.1": described(
        "contvines.map_problem:from_description", callables=["evil:F", None, None], **NAMES
    ),
}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    (tmp_path / "evil.py").write_text(EVIL)
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    yield tmp_path
    sys.modules.pop("evil", None)


def graph_with(description):
    problem = cv.AlgebraicProblem(lambda u, p: np.array([u[0] ** 3 - p * u[0]]), [0.0], -0.5)
    graph = cv.diagram(problem, within=(-1.0, 1.0), depth=0)
    assert [p.kind for p in graph.special.values()].count("branch-point") == 1
    for branch in graph.branches.values():
        branch.description = dict(description)
    return graph


COMMANDS = [
    "show",
    "show --json",
    "orbit BP1",
    "orbit B1:1",
    "switch BP1",
    "plot",
    "plot --kind multipliers",
    "plot --kind network",
]
COMMANDS += [f"export --to {to}" for to in ("csv", "mat", "json", "graphml")]


@pytest.mark.slow
@pytest.mark.parametrize("attack", ATTACKS)
def test_no_reader_runs_what_a_file_names(folder, attack, run):
    graph_with(ATTACKS[attack]).save("x.vines")
    for command in COMMANDS:
        verb, *words = command.split()
        said = run(verb, "x.vines", *words)[2]
        assert "Traceback" not in said and "something went wrong" not in said and len(said) < 2000
        if verb in ("orbit", "switch"):
            assert "has no problem attached" in said or "cannot be understood" in said
    for read in (cv.load, cv.Graph.load):
        graph = read("x.vines")
        assert graph["B1"].problem is None
        with pytest.raises(ValueError, match="has no problem attached"):
            graph["B1"].orbit(0)
        with pytest.raises(ValueError, match="has no problem attached"):
            cv.switch(graph, "BP1")
    assert not (folder / "marker").exists() and "evil" not in sys.modules


@pytest.fixture
def named(folder):
    """A file whose graph is that of the function of another module."""
    graph = graph_with(ATTACKS["functions of an equation"])
    graph.save("x.vines")
    return folder


@pytest.mark.slow
@pytest.mark.parametrize("words", ["orbit x.vines B1:1 --json", "export x.vines --to csv"])
def test_with_trust_the_functions_are_imported(named, words):
    """A process that has not seen the function: refused or left out, unless the user says that the file may be trusted."""
    command = [sys.executable, "-m", "contvines.command", *words.split()]
    first = subprocess.run(command, capture_output=True, text=True)
    assert "--trust" in first.stderr and not (named / "marker").exists()
    second = subprocess.run([*command, "--trust"], capture_output=True, text=True)
    assert second.returncode == 0 and "--trust" not in second.stderr, second.stderr
    assert (named / "marker").exists()


def test_in_python_trust_and_known_functions(named):
    assert cv.load("x.vines").branches["B1"].problem is None
    trusted = cv.load("x.vines", trust=True).branches["B1"].problem
    assert trusted.equations(np.array([0.25]), 0.5)[0].tolist() == [-0.25]
    # the program has used the function now: its name in a file means nothing but that function
    assert cv.load("x.vines").branches["B1"].problem.functions.f is trusted.functions.f


def test_a_program_registers_its_own_factory():
    made = []
    with pytest.raises(UnknownFactory, match=r"contvines\.register"):
        factory("my house")
    cv.register("my house", lambda description, trust: made.append((description["size"], trust)) or "house")
    assert rebuild({"factory": "my house", "size": 3}) == "house" and made == [(3, False)]


@pytest.mark.parametrize(
    "name",
    ["orbits.problem:rebuild", "orbits.stuck_problem:rebuild", "contvines.algebraic:from_description",
     "contvines.map_problem:from_description"],
)  # fmt: skip
def test_factories_of_version_0_1_are_known(name):
    assert callable(factory(name))
