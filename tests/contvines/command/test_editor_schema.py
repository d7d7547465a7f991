"""The JSON Schema of studies agrees with what the commands accept and refuse."""

import json
import tomllib
from pathlib import Path

import pytest

from contvines.command.begin import study_schema
from contvines.command.study import StudyError, check_study

jsonschema = pytest.importorskip("jsonschema")
TOP = Path(__file__).parents[3]
STUDIES = sorted((TOP / "examples").rglob("*.toml"))
SCHEMA = study_schema()
VALIDATOR = jsonschema.Draft7Validator(SCHEMA)


def test_it_is_a_schema_of_its_dialect():
    jsonschema.Draft7Validator.check_schema(SCHEMA)
    assert "$ref" not in json.dumps(SCHEMA)  # editors complete what stands there


@pytest.mark.parametrize("path", STUDIES, ids=lambda path: path.stem)
def test_every_example_is_valid(path):
    assert list(VALIDATOR.iter_errors(tomllib.loads(path.read_text(encoding="utf-8")))) == []


def test_the_file_beside_the_documentation_is_what_the_command_writes(run, tmp_path):
    status, out, _ = run("schema", "-o", "a.json")
    assert not status and "#:schema a.json" in out
    assert (tmp_path / "a.json").read_text() == (TOP / "docs/study.schema.json").read_text()


def friction():
    return tomllib.loads((TOP / "examples/friction.toml").read_text(encoding="utf-8"))


def absorber():
    return tomllib.loads((TOP / "examples/design/absorber.toml").read_text(encoding="utf-8"))


BAD = [
    (friction, "model", "restitution", 1.5),
    (friction, "model", "restitution", "0.7"),
    (friction, "model", "fiction", 0.5),
    (friction, "start", "amplitud", 0.5),
    (friction, "start", "periods", 0),
    (friction, "continue", "within", [0.1]),
    (friction, "continue", "parameter", "colour"),
    (friction, "continue", "depht", 2),
    (friction, "sweep", "count", 1),
    (friction, "chart", "parameter", "colour"),
    (absorber, "model", "stifness", "3 N/m"),
    (absorber, "model", "half_width", 15),
    (absorber, "continue", "parameter", "colour"),
]


@pytest.mark.parametrize(("study", "section", "field", "value"), BAD)
def test_what_the_commands_refuse_the_schema_refuses(study, section, field, value):
    data = study()
    VALIDATOR.validate(data)
    data.setdefault(section, {})[field] = value
    assert not VALIDATOR.is_valid(data)
    with pytest.raises(StudyError):
        check_study(data)
