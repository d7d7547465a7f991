"""A TOML study, read and checked before any work starts.

Every value that cannot be used is refused with a sentence that names the field, the value and a way out;
all such sentences of one study are reported together.
"""

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

from contvines.command.conditions import check_varied, without_tables
from contvines.command.study_data import Study
from contvines.command.study_errors import StudyError as StudyError
from contvines.command.toml_text import TomlError, toml_data
from contvines.file_names import is_database
from contvines.shared.near_names import did_you_mean
from orbits.machines.names import PAGES, STRUCTURE

QUANTITY = re.compile(r"\s*[-+]?[\d.]+(e[-+]?\d+)?\s*[a-zA-Z%].*")  # "3.2 kg"


def read_study(path: str | Path) -> Study:
    """Read and check a TOML study.

    Raises
    ------
    StudyError
        If the file cannot be read, is not TOML, or holds a value that cannot be used.
    """
    path = Path(path)
    if path.suffix == ".py" and path.is_file():
        raise StudyError(
            f"{path}: this is a file of Python: run it with python, or name it in a study, [model] name = "
            f'"{path.name}:NAME"; contvines new flow writes one.'
        )
    try:
        return study_of(path.read_text(encoding="utf-8-sig"), path)
    except FileNotFoundError:
        near = did_you_mean(path.name, (other.name for other in path.parent.glob("*.toml")))
        why = f"there is no such file{near}; give the path of a TOML study."
    except IsADirectoryError:
        why = "this is a folder; give the path of a TOML study."
    except OSError as error:
        why = f"cannot be read ({error.strerror})."
    except UnicodeDecodeError:
        hint = (
            " It is a database: commands that take a study want the .toml file."
            if is_database(path)
            else " Save it as UTF-8."
        )
        why = f"this is not a TOML file (it is no text in UTF-8).{hint}"
    raise StudyError(f"{path}: {why}")


def study_of(text: str, path: Path) -> Study:
    """Check a study given as its text; `path` is its place, beside which files that it names are looked for.

    Raises
    ------
    StudyError
    """
    try:
        return replace(check_study(toml_data(text), path), text=text)
    except TomlError as error:
        raise StudyError(f"{path}: {error}.") from error
    except StudyError as error:
        raise StudyError(f"{path}: {error}") from error


def check_study(data: dict[str, Any], path: str | Path = "study") -> Study:
    """Check a study given as nested dicts; see `read_study`."""
    path, model = Path(path), data.get("model")
    about = model if isinstance(model, dict) else {}
    try:
        data, conditions, tables = without_tables(data)
        check_varied(data, tables)
        said = str(about.get("name", ""))
        if ".py" in said or said in (*PAGES, STRUCTURE):
            from contvines.command.own_study import read_own

            study = read_own(data, path)
        elif "units" in data or "units" in about:
            from contvines.command.physical_study import read_physical

            study = read_physical(data, path)
        else:
            from contvines.command.catalogue_study import read_catalogue

            for key, value in about.items():
                if isinstance(value, str) and QUANTITY.fullmatch(value):
                    raise StudyError(
                        f'[model] {key} = {value!r}: quantities want units = "si" on the first line of the study.'
                    )
            study = read_catalogue(data, path)
        study = replace(study, conditions=conditions, tables=tables)
        if study.kinds is not None:
            from contvines.command.own_code import load_kinds

            load_kinds(path, study.kinds)
    except StudyError:
        raise
    except (ValueError, OSError) as error:
        raise StudyError(str(error)) from error
    return study
