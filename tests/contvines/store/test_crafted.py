"""Files made by hand with right digests: what contvines never writes is refused in a sentence, and nothing on a terminal obeys a file."""

import json
from contextlib import suppress

import numpy as np
import pytest

from contvines.graph.persistence import graph_entries
from contvines.store import Store, StoreError, load, save
from contvines.store.on_disk import digest_of
from tests.contvines import fakes

ENTRIES = {(kind, key): content for kind, key, content in graph_entries(fakes.pitchfork_graph())}


def setting(name, value):
    return lambda content: content.update({name: value})


def without(name):
    return lambda content: content.pop(name)


NESTED = [[]]
for _ in range(300):
    NESTED = [NESTED]

CRAFTED = {
    "no interval": ("graph", "graph", setting("within", None)),
    "an interval of text": ("graph", "graph", setting("within", ["a", "b"])),
    "no model": ("graph", "graph", setting("model", None)),
    "a model nested three hundred deep": ("graph", "graph", setting("model", {"name": NESTED})),
    "a message that is none": ("graph", "graph", setting("message", 7)),
    "a number beyond all floats": ("graph", "graph", setting("settings", {"depth": 10**400})),
    "values of text in settings": ("graph", "graph", setting("settings", {"scanned": 1, "scan": "", "quiet": 1})),
    "a field that is not one": ("graph", "graph", setting("colour", "red")),
    "a branch without points": ("branch", "B1", without("points")),
    "points in a row": ("branch", "B1", setting("points", np.zeros(41))),
    "points that are true or false": ("branch", "B1", setting("points", np.zeros((41, 1), bool))),
    "points and values of unlike lengths": ("branch", "B1", setting("values", np.zeros(40))),
    "an empty branch": ("branch", "B1", lambda c: c.update({n: c[n][:0] for n in ("points", "values", "tangents", "multipliers", "margin", "stable")})),
    "numbers in the place of stable": ("branch", "B1", setting("stable", np.zeros(41))),
    "another label": ("branch", "B1", setting("label", "B7")),
    "a mark beyond its points": ("branch", "B1", setting("marks", [[41, "BP1"]])),
    "an ending without a reason": ("branch", "B1", setting("endings", [{"value": 1.0}, {"value": 1.0}])),
    "one ending": ("branch", "B1", setting("endings", [{"reason": "closed"}])),
    "a description that is none": ("branch", "B1", setting("description", "pitchfork")),
    "a point of a branch that is missing": ("special", "BP1", setting("branch", "B9")),
    "a point without a value": ("special", "BP1", setting("value", None)),
    "a coefficient of text": ("special", "BP1", setting("coefficient", "1")),
    "a switch to nowhere": ("switch", "0", setting("target", "B9")),
    "a switch without a point": ("switch", "0", without("point")),
}  # fmt: skip


@pytest.mark.parametrize("what", CRAFTED)
def test_entries_that_are_not_ours_are_refused_in_a_sentence(kept, what):
    kind, key, change = CRAFTED[what]
    content = dict(ENTRIES[kind, key])
    change(content)
    with Store.open(kept, write=True) as store, store.transaction():
        store.put(kind, key, content)
    with pytest.raises(
        StoreError, match=r"x\.vines: this file does not hold a graph as contvines writes it \("
    ):
        load(kept)


def test_an_entry_under_another_label_is_refused(kept, rewritten):
    rewritten(lambda db: db.execute("DELETE FROM entry WHERE kind = 'branch' AND key = 'B3'"))
    with Store.open(kept, write=True) as store, store.transaction():
        store.put("branch", "B8", ENTRIES["branch", "B3"])
    with pytest.raises(StoreError, match="its label is 'B3'"):
        load(kept)


ARRAYS = {
    "dtype": ["V99999999999", "S-1", "O"],
    "shape": ["[-1, 1]", '["41", 1]', "[41.0, 1]", "[true, 41]", "[99999999999, 99999999999]", "null", "[" * 100_000],
    "data": ["text", 7],
}  # fmt: skip
TEXTS = ["[" * 100_000, '{"x": ' + "9" * 5001 + "}", "[]", "7", "{"]


@pytest.mark.parametrize(
    ("key", "change", "value"),
    [
        *(
            ("B1", f"array SET {column} = ? WHERE name = 'points' AND entry", value)
            for column in ARRAYS
            for value in ARRAYS[column]
        ),
        *(("0", "entry SET scalars = ? WHERE id", text) for text in TEXTS),
    ],
)
def test_what_is_not_ours_is_refused_in_a_sentence(kept, rewritten, key, change, value):
    def tampered(db):
        (entry,) = db.execute("SELECT id FROM entry WHERE key = ?", (key,)).fetchone()
        db.execute(f"UPDATE {change} = ?", (value, entry))
        about = db.execute("SELECT kind, key, scalars FROM entry WHERE id = ?", (entry,)).fetchone()
        arrays = "SELECT name, dtype, shape, data FROM array WHERE entry = ? ORDER BY name"
        with suppress(AttributeError):  # of a number in the place of data
            digest = digest_of(*about, db.execute(arrays, (entry,)).fetchall())
            db.execute("UPDATE entry SET digest = ? WHERE id = ?", (digest, entry))

    rewritten(tampered)
    with pytest.raises(StoreError, match=r"x\.vines: this file " + (r"is damaged \(" if key == "B1" else "")):
        load(kept)


OBEYED = "\x1b]0;mine\x07\x1b[2J\u009b31m\u202ered\r"


def test_no_text_of_a_file_is_obeyed_by_a_terminal(path, run):
    graph = fakes.pitchfork_graph()
    graph.complete, graph.message, graph.start = False, OBEYED, f"begun elsewhere {OBEYED}"
    graph.special["VG1"].remarks = (OBEYED,)
    graph.switches[0] = type(graph.switches[0])("BP1", "B1", "B2", "branch-point", OBEYED)
    graph.branches["B1"].description = {"name": "pitchfork", "factory": None, "word": OBEYED, "periods": 1}
    save(graph, path)
    for verb, *words in (["show"], ["show", "--json"], ["switch", "VG1"], ["plot", "--kind", "none"]):
        _, out, err = run(verb, path, *words)
        assert not {c for c in out + err if c < " " and c != "\n"} & set(OBEYED)
        assert not set("\u009b\u202e") & set(out + err)
    assert r"\x1b]0;mine\x07" in str(load(path))
    assert json.loads(run("show", path, "--json")[1])["start"].startswith("begun elsewhere")
