"""Compiling the simulator beside other work changes nothing but the time it takes."""

import os

import pytest

from orbits import ahead


@pytest.mark.parametrize("name", ["absorber", "coupled"])
def test_nothing_is_started_once_the_stepper_is_cached(name, monkeypatch):
    monkeypatch.setattr(os, "cpu_count", lambda: 2)
    ahead.compile_now(name)
    assert ahead.compile_ahead(name) is None


def test_one_core_compiles_one_thing_after_the_other(monkeypatch):
    monkeypatch.setattr(os, "cpu_count", lambda: 1)
    monkeypatch.setattr(ahead, "_missing", lambda name: True)
    assert ahead.compile_ahead("absorber") is None


def test_a_process_compiles_what_is_missing(monkeypatch):
    monkeypatch.setattr(os, "cpu_count", lambda: 2)
    monkeypatch.setattr(ahead, "_missing", lambda name: True)
    process = ahead.compile_ahead("absorber")
    assert process is not None
    assert process.wait(timeout=120) == 0
