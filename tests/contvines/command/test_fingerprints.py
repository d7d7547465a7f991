"""What a study's digest depends on, and guesses with the wrong count of numbers."""

import pytest

from contvines.command.study import StudyError, check_study

STUDY = {
    "model": {"name": "absorber", "restitution": 0.76, "friction": 0.5, "gravity": 0.211},
    "start": {"word": "LR", "periods": 1, "amplitude": 0.55},
    "continue": {"parameter": "amplitude", "within": [0.2, 1.2], "depth": 1},
}


def study(**sections):
    return check_study(
        {name: {**STUDY.get(name, {}), **sections.get(name, {})} for name in {**STUDY, **sections}}
    )


def test_each_command_has_its_own_and_an_atlas_counts_its_section():
    plain, wider = study(), study(atlas={"values": 5})
    commands = ("diagram", "trace", "atlas")
    assert len({plain.fingerprint(command) for command in commands}) == 3
    assert plain.fingerprint("diagram") == wider.fingerprint("diagram")
    assert plain.fingerprint("atlas") != wider.fingerprint("atlas")


@pytest.mark.parametrize("count", [1, 3, 4])
def test_a_node_has_as_many_numbers_as_the_machine_says(count):
    with pytest.raises(StudyError, match=r"guess\[1\]"):
        study(start={"guess": [[0.1, 0.2], [0.3] * count]})
    assert study(start={"guess": [[0.1, 0.2], [0.3, 0.4]]}).guess == [[0.1, 0.2], [0.3, 0.4]]


@pytest.mark.parametrize(("first", "fine"), [(0.2, True), (1.2, True), (0.19, False), (1.3, False)])
def test_the_start_lies_inside_the_interval(first, fine):
    if fine:
        assert study(start={"amplitude": first}).parameters["amplitude"] == first
        return
    with pytest.raises(StudyError, match="lies outside"):
        study(start={"amplitude": first})
