"""Kinds of special points that a study names: ``kinds = "file.py:name"`` in [continue]."""

import hashlib
import sys
from collections.abc import Sequence
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Any


def load_kinds(study: Path, said: str) -> tuple[Sequence[Any], str]:
    """The built-in kinds with those of a file beside the study, and a digest of the file; the file is run.

    Parameters
    ----------
    study : Path
    said : str
        File and name; the name is that of a :class:`contvines.Kind`, or of a list of them.

    Raises
    ------
    ValueError
        If there is no such file beside the study, it does not run, or has no kinds of that name.
    """
    from contvines.bifurcation.kind import Kind
    from contvines.bifurcation.kinds import KINDS, checked

    file, _, name = said.rpartition(":")
    inside = file and not Path(file).is_absolute() and ".." not in Path(file).parts
    path = study.parent / file
    if not (inside and name and path.is_file()):
        raise ValueError(
            f'[continue] kinds = {said!r}: name a file beside the study and a kind in it, for example kinds = "saddles.py:neutral"'
        )
    digest = hashlib.sha256(path.read_bytes()).hexdigest()[:16]
    module_name = f"_kinds_{path.stem}_{digest}"
    module = sys.modules.get(module_name)
    if module is None:
        spec = spec_from_file_location(module_name, path)
        if spec is None or spec.loader is None:
            raise ValueError(f"[continue] kinds = {said!r}: {path} is no Python file")
        module = module_from_spec(spec)
        sys.modules[module_name] = module
        try:
            spec.loader.exec_module(module)
        except Exception as error:
            del sys.modules[module_name]
            raise ValueError(
                f"[continue] kinds = {said!r}: {path} does not run: {type(error).__name__}: {error}"
            ) from error
    found = getattr(module, name, None)
    own = [found] if isinstance(found, Kind) else list(found) if isinstance(found, list | tuple) else []
    if not own:
        known = [key for key, value in vars(module).items() if isinstance(value, Kind)]
        raise ValueError(
            f"[continue] kinds = {said!r}: {path} has no kind {name!r}; it has {', '.join(known) or 'none'}"
        )
    try:
        return checked([*(kind for kind in KINDS if kind not in own), *own]), digest
    except ValueError as error:
        raise ValueError(f"[continue] {error}") from None
