"""What a report shows of a survey, as data for its page: every machine with its parameters, outcomes and note."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ..plots.survey import label_of
from .numbers import plain_label, shortened

if TYPE_CHECKING:
    from ..survey.results import Survey


def survey_contents(survey: Survey, source: str) -> dict[str, Any]:
    """The data of a survey's page.

    Parameters
    ----------
    survey : Survey
    source : str
        Name of the file.

    Returns
    -------
    dict
        Plain numbers, text and lists; machines in the order of the plan.
    """
    from .. import __version__

    systems = list(survey.plan.systems())
    return {
        "version": __version__,
        "source": source,
        "axes": {name: shortened(values, 12) for name, values in survey.plan.axes.items()},
        "samples": list(survey.plan.samples),
        "parameters": {
            name: shortened([system[name] for system in systems], 12) for name in survey.plan.names
        },
        "columns": {name: shortened(np.ravel(values), 12) for name, values in survey.columns.items()},
        "failed": survey.failed,
        "notes": [str(note) for note in survey.notes.ravel()],
        "units": dict(survey.units),
        "names": {
            name: plain_label(label_of(survey, name)) for name in (*survey.plan.names, *survey.columns)
        },
        "about": {str(k): _as_text(v) for k, v in survey.about.items()},
    }


def _as_text(value: object) -> str:
    if isinstance(value, dict):
        return ", ".join(f"{k}: {_as_text(v)}" for k, v in value.items())
    if isinstance(value, list | tuple):
        return ", ".join(_as_text(v) for v in value)
    return str(value)
