"""Beginning: new studies, their schema, the help of each command, the self-test, and with what a file was made."""

import importlib
import inspect
import json
import platform
import tomllib

import numpy
import pytest

from contvines.command.begin import Kind, study_schema
from contvines.command.cli import COMMANDS
from contvines.command.compose import first_orbit
from contvines.command.study import StudyError, check_study, read_study
from contvines.store import Store
from tests.contvines.studies import EXAMPLES, SI, TWO, data

Validator = pytest.importorskip("jsonschema").Draft7Validator
SCHEMA = Validator(study_schema())


# ---------------------------------------------------------------- the schema agrees with the commands
@pytest.mark.parametrize("path", sorted(EXAMPLES.rglob("*.toml")), ids=lambda path: path.stem)
def test_every_example_is_valid(path):
    assert list(SCHEMA.iter_errors(tomllib.loads(path.read_text(encoding="utf-8")))) == []


def test_the_file_beside_the_documentation_is_what_the_command_writes(run, tmp_path):
    Validator.check_schema(SCHEMA.schema)
    assert "$ref" not in json.dumps(SCHEMA.schema)  # editors complete what stands there
    assert "#:schema a.json" in run.ok("schema -o a.json")
    assert (tmp_path / "a.json").read_text() == (EXAMPLES.parent / "docs/study.schema.json").read_text()


BAD = {
    "friction.toml": [
        "model.restitution = 1.5",
        'model.restitution = "0.7"',
        "model.fiction = 0.5",
        "start.amplitud = 0.5",
        "start.periods = 0",
        "continue.within = [0.1]",
        'continue.parameter = "colour"',
        "continue.depht = 2",
        "sweep.count = 1",
        'chart.parameter = "colour"',
    ],
    "design/absorber.toml": [
        'model.stifness = "3 N/m"',
        "model.half_width = 15",
        'continue.parameter = "colour"',
    ],
}


@pytest.mark.parametrize(("path", "change"), [(path, line) for path in BAD for line in BAD[path]])
def test_what_the_commands_refuse_the_schema_refuses(path, change):
    bad = data((EXAMPLES / path).read_text(), change)
    assert not SCHEMA.is_valid(bad)
    with pytest.raises(StudyError):
        check_study(bad)


def test_quantities_of_a_declared_machine_are_valid():
    assert SCHEMA.is_valid(data(TWO, "conditions.heat = 50")) and SCHEMA.is_valid(
        data(SI, "model.base_amplitude = 0")
    )


# ---------------------------------------------------------------- help
MEASURES = {
    "friction": "B",
    "frequency": "max_abs_q1",
    "bouncing_ball": "B",
    "machines/impact_oscillator": "approach_speed",
}


@pytest.mark.parametrize("study", MEASURES)
def test_the_default_of_y_is_the_machines(run, study):
    path = EXAMPLES / f"{study}.toml"
    assert run.ok("diagram", path, "--help").endswith(f"For {path} the default of -y is {MEASURES[study]}.\n")


@pytest.mark.parametrize("name", COMMANDS)
def test_the_list_of_commands_says_what_the_help_of_each_begins_with(name):
    module, sentence = COMMANDS[name]
    said = inspect.getdoc(getattr(importlib.import_module(f"contvines.command.{module}"), name))
    assert " ".join(said.split("\n\n")[0].split()) == sentence


# ---------------------------------------------------------------- new, doctor
@pytest.mark.parametrize("kind", Kind)
def test_a_new_study_begins(run, kind, tmp_path):
    if kind is Kind.machine:
        pytest.importorskip("heyoka")
    status, _, err = run("new", kind.value, "-o", "mine.toml")
    assert not status and "contvines diagram mine.toml" in err
    assert first_orbit(read_study("mine.toml")) is not None
    # every field is explained beside it, or in the line above
    lines = (tmp_path / "mine.toml").read_text().splitlines()
    fields = [line for line in lines if " = " in line and line[0] != "#"]
    assert 2 * sum("#" in line for line in fields) >= len(fields)


def test_the_self_test_and_files_name_what_computes(run, vines):
    said, made = run.json("doctor"), run.json("show g.vines")["made"]
    assert said["self_test"]["passed"]
    for told in (said, made):
        assert (told["numpy"], told["python"]) == (numpy.__version__, platform.python_version())
    assert said["extras"]["proofs"] in (True, False)
    with Store.open(vines) as store:
        assert set(store.made) == {"contvines", "numpy", "scipy", "python", "platform", "core", "date"}
