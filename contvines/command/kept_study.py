"""The study that a result file keeps, and the kinds of special points that it names."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from contvines.command.own_code import load_kinds
from contvines.command.study import study_of
from contvines.command.study_data import Study
from contvines.command.toml_text import toml_data


def kept_study(file: Path, source: object, trust: bool) -> tuple[Study, dict[str, Any]]:
    """The study that a file keeps, read as if it stood where it stood.

    Raises
    ------
    ValueError
        If the file keeps none, or one that names Python files while it is not trusted.
    """
    if not isinstance(source, dict) or not source.get("text"):
        raise ValueError(
            f"{file}: this file keeps no study to run again: it was saved by a version that kept none, or from something else than a study; "
            f"contvines diagram STUDY.toml -o {file.stem}-again.vines computes the study anew."
        )
    data, place = toml_data(source["text"]), (file.absolute().parent / str(source["study"])).resolve()
    named = [str(data.get(part, {}).get(key, "")) for part, key in (("model", "name"), ("continue", "kinds"))]
    if not trust and any(".py" in name for name in named):
        code = next(name for name in named if ".py" in name)
        raise ValueError(
            f"{file}: its study runs the code of {code!r} beside {place}; --trust allows it, for a file whose maker you trust."
        )
    return study_of(source["text"], place), source


def kept_kinds(file: Path, trust: bool) -> Sequence[Any] | None:
    """The kinds that the study of a file looks for; None if it keeps no study that names kinds of its own.

    Raises
    ------
    ValueError
        As `kept_study` does.
    """
    from contvines.store import Store

    with Store.open(file) as store:
        source = (store.study or {}).get("source")
    if not source:
        return None
    study, _ = kept_study(file, source, trust)
    return load_kinds(study.path, study.kinds)[0] if study.kinds else None
