"""The text of `contvines orbit`, from what its --json prints."""

from contvines.command.orbit import _describe


class Found:
    def __init__(self, **about):
        self.about = about

    def to_dict(self):
        return self.about


def test_the_smallest_margin_is_named_with_its_place():
    margins = [
        {"kind": "approach", "segment": 0, "value": 0.5},
        {"kind": "turn", "segment": 3, "value": 0.0625},
        {"kind": "wall", "segment": 4, "value": 2.0},
    ]
    text = _describe(Found(word="LR", periods=1, real=True, margins=margins))
    assert "smallest margin: 0.0625 (turn, segment 3) of 3" in text
