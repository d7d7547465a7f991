"""Entries of files in which the border at which an event vanishes was called chatter and labelled CH."""

from contvines.graph.persistence import renamed


def test_kinds_and_labels_of_a_graph():
    entries = {
        "branch": {
            "B1": {"label": "B1", "seed": "CH1", "marks": [[3, "CH1"]], "endings": [{"point": "CH1", "kind": "chatter"}]}
        },
        "special": {
            "CH1": {"label": "CH1", "kind": "chatter", "branch": "B1"},
            "LP1": {"label": "LP1", "kind": "fold", "branch": "B1"},
        },
        "switch": {"0": {"point": "CH1", "source": "B1", "target": "B2", "kind": "chatter"}},
        "proof": {"CH1": {"existence": True}},
        "attractor": {"0": {"kind": "chatter", "word": ""}},
    }  # fmt: skip
    assert renamed(entries) == {
        "branch": {
            "B1": {"label": "B1", "seed": "VE1", "marks": [[3, "VE1"]], "endings": [{"point": "VE1", "kind": "vanishing-event"}]}
        },
        "special": {
            "VE1": {"label": "VE1", "kind": "vanishing-event", "branch": "B1"},
            "LP1": {"label": "LP1", "kind": "fold", "branch": "B1"},
        },
        "switch": {"0": {"point": "VE1", "source": "B1", "target": "B2", "kind": "vanishing-event"}},
        "proof": {"VE1": {"existence": True}},
        "attractor": {"0": {"kind": "chatter", "word": ""}},
    }  # fmt: skip
