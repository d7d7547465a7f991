"""Compiling beside other work changes nothing but the time it takes."""

import subprocess
import sys

import pytest

from orbits import precompile
from orbits.cycles import kernels as kernel_module
from orbits.machines.catalogue import usual


def kernels():
    return kernel_module.assemble(usual("absorber")[0])


@pytest.fixture(autouse=True)
def no_helpers(monkeypatch):
    monkeypatch.setattr(kernel_module, "helpers", {})


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
    assert process.wait(timeout=120) == 0


def test_other_sources_are_not_compiled(monkeypatch):
    compiled_now = []
    monkeypatch.setattr(precompile, "compile_now", lambda *names: compiled_now.append(names))
    precompile.compile_as("another digest", "absorber")
    assert compiled_now == []
    precompile.compile_as(kernels().digest, "absorber", "a:b")
    assert compiled_now == [("absorber", "a:b")]


def test_waiting_ends_with_the_process_or_with_patience(monkeypatch):
    clock = [0.0]
    monkeypatch.setattr(kernel_module, "cached", lambda function: False)
    monkeypatch.setattr(kernel_module.time, "monotonic", lambda: clock[0])
    monkeypatch.setattr(kernel_module.time, "sleep", lambda seconds: clock.append(clock.pop() + seconds))
    endless = subprocess.Popen([sys.executable, "-c", "input()"], stdin=subprocess.PIPE)
    kernel_module.helpers["absorber"] = endless
    assert kernels().examine is kernels()._examine
    assert clock[0] > kernel_module.PATIENCE and endless.poll() is None and not kernel_module.helpers
    endless.communicate()
    kernel_module.helpers["absorber"] = endless  # has ended
    waited = clock[0]
    assert kernels().inspect is kernels()._inspect
    assert clock[0] == waited
