"""What `diagram`, `trace` and `switch` ask of the continuation."""

import pytest

import contvines
from contvines.command import compose
from contvines.command.cli import main
from contvines.store import load, save
from tests.contvines import fakes
from tests.contvines.studies import PAPER_MACHINE

STUDY = (
    PAPER_MACHINE
    + '[start]\nword = "LR"\namplitude = 0.55\n'
    + '[continue]\nparameter = "amplitude"\nwithin = [0.2, 1.2]\ndepth = 3\nvirtual = true\nmax_branches = 7\nangle = 0.05\n'
)


@pytest.fixture
def asked(monkeypatch, tmp_path):
    """The options with which `contvines.diagram` was called."""
    found = {}

    def diagram(seed, **options):
        found.update(options)
        return fakes.pitchfork_graph()

    monkeypatch.setattr(contvines, "diagram", diagram)
    monkeypatch.setattr(compose, "first_orbit", lambda study: "an orbit")
    (tmp_path / "s.toml").write_text(STUDY)
    monkeypatch.chdir(tmp_path)
    return found


def call(*words):
    with pytest.raises(SystemExit) as end:
        main(list(words))
    assert not end.value.code


def test_a_diagram_is_what_the_study_says(asked):
    call("diagram", "s.toml", "--quiet", "--no-look")
    assert asked["over"] == "amplitude" and tuple(asked["within"]) == (0.2, 1.2)
    assert asked["depth"] == 3 and asked["virtual"] is True
    assert asked["settings"] == {"max_branches": 7, "angle": 0.05}


def test_a_trace_is_one_branch_without_switching(asked):
    call("trace", "s.toml", "--quiet")
    assert asked["depth"] == 0
    assert asked["settings"] == {"max_branches": 1, "angle": 0.05}
    assert asked["over"] == "amplitude" and tuple(asked["within"]) == (0.2, 1.2)


def test_switch_goes_on_as_the_file_was_made_but_may_make_more_branches(monkeypatch, tmp_path):
    graph = fakes.pitchfork_graph()
    graph.settings.update(max_branches=1, angle=0.05, depth=0)
    path = tmp_path / "s.vines"
    save(graph, path)
    found = {}

    def switch(graph, label, **options):
        found.update(options, label=label)
        return []

    monkeypatch.setattr("contvines.graph.automatic.switch", switch)
    call("switch", str(path), "BP1", "--quiet")
    assert found["label"] == "BP1" and found["settings"] == {"angle": 0.05}
    assert load(path).settings["max_branches"] == 1
