"""Compiling beside other work changes nothing but the time it takes."""

import subprocess
import sys

import pytest

from orbits import ahead, compiled
from orbits.models import build


def kernels():
    return compiled.assemble(build({"name": "absorber"} | ahead.SMALL["absorber"]))


@pytest.fixture(autouse=True)
def no_helpers(monkeypatch):
    monkeypatch.setattr(compiled, "helpers", {})


@pytest.mark.parametrize("name", ["absorber", "coupled"])
def test_nothing_is_started_once_all_is_cached(name, monkeypatch):
    monkeypatch.setattr(ahead, "_cores", lambda: 2)
    ahead.compile_now(name)
    assert ahead.compile_ahead(name) is None


def test_one_core_compiles_one_thing_after_the_other(monkeypatch):
    monkeypatch.setattr(ahead, "_cores", lambda: 1)
    monkeypatch.setattr(ahead, "_missing", lambda name: True)
    assert ahead.compile_ahead("absorber") is None


def test_one_process_compiles_what_is_missing_wherever_it_is_started(monkeypatch, tmp_path):
    (tmp_path / "orbits.py").write_text(
        "raise SystemExit(3)"
    )  # another module of that name in the current folder
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(ahead, "_cores", lambda: 2)
    monkeypatch.setattr(ahead, "_missing", lambda name: True)
    process = ahead.compile_ahead("absorber", "contvines.events.scan:prepare")
    assert process is not None and ahead.compile_ahead("absorber") is process
    assert process.wait(timeout=120) == 0


def test_other_sources_are_not_compiled(monkeypatch):
    compiled_now = []
    monkeypatch.setattr(ahead, "compile_now", lambda *names: compiled_now.append(names))
    ahead.compile_as("another digest", "absorber")
    assert compiled_now == []
    ahead.compile_as(kernels().digest, "absorber", "a:b")
    assert compiled_now == [("absorber", "a:b")]


def test_waiting_ends_with_the_process_or_with_patience(monkeypatch):
    clock = [0.0]
    monkeypatch.setattr(compiled, "cached", lambda function: False)
    monkeypatch.setattr(compiled.time, "monotonic", lambda: clock[0])
    monkeypatch.setattr(compiled.time, "sleep", lambda seconds: clock.append(clock.pop() + seconds))
    endless = subprocess.Popen([sys.executable, "-c", "input()"], stdin=subprocess.PIPE)
    compiled.helpers["absorber"] = endless
    assert kernels().examine is kernels()._examine
    assert clock[0] > compiled.PATIENCE and endless.poll() is None and not compiled.helpers
    endless.communicate()
    compiled.helpers["absorber"] = endless  # has ended
    waited = clock[0]
    assert kernels().inspect is kernels()._inspect
    assert clock[0] == waited
