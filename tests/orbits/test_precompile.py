"""Compiling beside other work changes nothing but the time it takes."""

import subprocess
import sys
from types import SimpleNamespace

import pytest

from orbits import precompile
from orbits.compiling import waiting
from orbits.cycles import kernels as kernel_module
from orbits.machines.catalogue import usual


def kernels():
    return kernel_module.assemble(usual("absorber")[0])


@pytest.fixture(autouse=True)
def no_processes():
    waiting.processes.clear()
    yield
    waiting.processes.clear()


@pytest.mark.parametrize("name", ["absorber", "coupled"])
def test_nothing_is_started_once_all_is_cached(name, monkeypatch):
    monkeypatch.setattr(precompile, "_cores", lambda: 2)
    precompile.compile_now(name)
    assert precompile.compile_ahead(name) is None


def test_one_core_compiles_one_thing_after_the_other(monkeypatch):
    monkeypatch.setattr(precompile, "_cores", lambda: 1)
    monkeypatch.setattr(precompile, "_missing", lambda name: True)
    assert precompile.compile_ahead("absorber") is None


def test_one_process_compiles_what_is_missing_wherever_it_is_started(monkeypatch, tmp_path):
    (tmp_path / "orbits.py").write_text(
        "raise SystemExit(3)"
    )  # another module of that name in the current folder
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(precompile, "_cores", lambda: 2)
    monkeypatch.setattr(precompile, "_missing", lambda name: True)
    process = precompile.compile_ahead("absorber", "contvines.events.scan:prepare")
    assert process is not None and precompile.compile_ahead("absorber") is process
    assert process.wait(timeout=600) == 0


def test_other_sources_are_not_compiled(monkeypatch):
    compiled_now = []
    monkeypatch.setattr(precompile, "compile_now", lambda *names: compiled_now.append(names))
    precompile.compile_as("another digest", "absorber")
    assert compiled_now == []
    precompile.compile_as(kernels().digest, "absorber", "a:b")
    assert compiled_now == [("absorber", "a:b")]


def test_waiting_ends_with_the_process_or_with_patience(monkeypatch):
    clock = [0.0]
    monkeypatch.setattr(waiting, "cached", lambda function: False)
    monkeypatch.setattr(waiting.time, "monotonic", lambda: clock[0])
    monkeypatch.setattr(waiting.time, "sleep", lambda seconds: clock.append(clock.pop() + seconds))
    endless = subprocess.Popen([sys.executable, "-c", "input()"], stdin=subprocess.PIPE)
    missing = SimpleNamespace(overloads={})
    waiting.processes["absorber"] = endless
    waiting.wait_for("absorber", SimpleNamespace(overloads={1: 2}))  # compiled here: no need of anybody
    assert clock[0] == 0.0 and waiting.processes
    waiting.wait_for("absorber", missing)
    assert clock[0] > waiting.PATIENCE and endless.poll() is None and not waiting.processes
    endless.communicate()
    waiting.processes["absorber"] = endless  # has ended
    waited = clock[0]
    waiting.wait_for("absorber", missing)
    assert clock[0] == waited and not waiting.processes


def test_waiting_ends_as_soon_as_the_function_is_kept(monkeypatch):
    found = iter([False, False, True])
    monkeypatch.setattr(waiting, "cached", lambda function: next(found))
    monkeypatch.setattr(waiting.time, "sleep", lambda seconds: None)
    waiting.processes["absorber"] = SimpleNamespace(poll=lambda: None)
    waiting.wait_for("absorber", SimpleNamespace(overloads={}))
    assert next(found, "none is left") == "none is left" and waiting.processes
