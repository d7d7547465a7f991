"""Entries of files in which the border at which an event vanishes was called chatter and labelled CH."""

import json

from contvines.graph.persistence import renamed


def test_kinds_and_labels_of_a_graph():
    entries = {
        "branch": {
            "B1": {"label": "B1", "seed": "CH1", "marks": [[3, "CH1"]], "endings": [{"point": "CH1", "kind": "chatter"}]}
        },
        "special": {"CH1": {"label": "CH1", "kind": "chatter", "branch": "B1"}, "LP1": {"label": "LP1", "kind": "fold"}},
        "switch": {"0": {"point": "CH1", "source": "B1", "target": "B2", "kind": "chatter"}},
        "proof": {"CH1": {"existence": True}},
    }  # fmt: skip
    text = json.dumps(entries).replace("CH1", "VE1").replace("chatter", "vanishing-event")
    motions = {"attractor": {"0": {"kind": "chatter", "word": ""}}}  # a motion that chatters does so still
    assert renamed(entries | motions) == json.loads(text) | motions
