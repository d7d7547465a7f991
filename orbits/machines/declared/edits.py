"""How a word over any contacts changes where a margin vanishes: local edits of the event list at a border orbit.

At the border the old and the new description are the same motion, so the nodes of the new word are known there. What vanishes with
the old word grows with the new one:

- a flight that touches a wall gains an impact of vanishing speed, and an impact of vanishing speed disappears (or, where a friction
  feels the same velocity, becomes a turn);
- a flight in which a sliding velocity touches zero gains a stick of vanishing duration with a slip that goes on; a stick that just
  holds gains a slip and a stick; a turn that no longer beats friction becomes a stick, and the other way round;
- a flight that touches the surface of a switch gains two crossings, and two crossings that meet disappear;
- two events of different contacts that meet change their order (a corner).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from orbits.contacts.dry_friction import STUCK, DryFriction
from orbits.contacts.wall import Wall
from orbits.machines.declared.margins import per_node
from orbits.machines.declared.sampling import lengths
from orbits.machines.declared.words import HIT, SLIP, STICK, SWITCH, TURN

SHORT = 1e-4  # clock of a stick, or between events, that is about to vanish
FIRST = 2e-3  # size of what grows from nothing

Mode = tuple[int, ...]


@dataclass(frozen=True)
class Edit:
    """Events `start` .. `stop - 1` give way to others.

    Attributes
    ----------
    start, stop : int
    events : tuple of str
    modes : tuple of modes
    nodes : float array (m, n + 1)
    grows : str
        The ``gap`` of the clock between the first two new events (`beside`: between the event before and the first), the ``speed``
        of the impact that is the first new event, or a ``margin`` of the new word where nothing was inserted.
    note : str
    """

    start: int
    stop: int
    events: tuple[str, ...]
    modes: tuple[Mode, ...]
    nodes: np.ndarray
    grows: str
    note: str


def with_mode(mode: Mode, contact: int, value: int) -> Mode:
    """The mode with another entry for one contact."""
    changed = list(mode)
    changed[contact] = value
    return tuple(changed)


def edits_at(orbit: Any, index: int) -> list[Edit]:
    """The edits that margin `index` may ask for at a border orbit, the likeliest first.

    The orbit must be read so that the margin's event is not the last one (see `crossing.turned`).
    """
    contacts = orbit.machine.contacts
    place, column = divmod(index, per_node(len(contacts)))
    if column < len(contacts):
        return _at_guard(orbit, place, column)
    if not len(orbit.word):
        return []
    if column == len(contacts):
        return _at_event(orbit, place)
    return _at_meeting(orbit, place)


# ---------------------------------------------------------------------- guards
def closest(orbit: Any, place: int, contact: int) -> tuple[float, np.ndarray, int]:
    """Where the guards of a contact come closest to zero in a flight: clock from its start, state, sign of the guard's event."""
    machine = orbit.machine
    compiled, e = machine.compiled, machine.equations
    mode = orbit.word.modes[place % len(orbit.word.modes)]
    key = e.pattern_key(mode)
    numbers = compiled.numbers(orbit.params, mode)
    guards, values, watch = e.pattern(key).guards, compiled.guards(key), compiled.watch(key)
    begin = float(orbit.nodes[place, 0]) if machine.forced else 0.0
    length = float(lengths(orbit)[place])
    state = orbit.nodes[place, 1:]
    candidates = [(begin, g, state) for g, guard in enumerate(guards) if guard.contact == contact]
    candidates += [c for c in watch(state, begin, begin + length, numbers) if guards[c[1]].contact == contact]
    final = watch.final
    candidates += [(begin + length, g, final) for g, guard in enumerate(guards) if guard.contact == contact]
    own_start = len(orbit.word) and orbit.word.letter(place).contact == contact
    own_end = len(orbit.word) and orbit.word.letter(place + 1).contact == contact
    best, found = np.inf, (0.0, state, 0)
    for clock, g, there in candidates:
        share = (clock - begin) / max(length, 1e-300)
        if (own_start and share < 1e-9) or (own_end and share > 1.0 - 1e-9):
            continue
        value = abs(values(there[None], np.array([clock]), numbers[None])[0, g])
        if value < best:
            best, found = value, (clock - begin, np.array(there), guards[g].sign)
    return found


def _node(orbit: Any, place: int, ahead: float, state: np.ndarray) -> np.ndarray:
    begin = float(orbit.nodes[place, 0]) if orbit.machine.forced else 0.0
    return np.concatenate([[begin + ahead], state])


def _at_guard(orbit: Any, place: int, j: int) -> list[Edit]:
    word, contact, alphabet = orbit.word, orbit.machine.contacts[j], orbit.word.alphabet
    mode = word.modes[place % len(word.modes)]
    ahead, state, sign = closest(orbit, place, j)
    length = float(lengths(orbit)[place])
    at_start, at_end = ahead < 1e-9 * length, ahead > (1.0 - 1e-9) * length
    node = _node(orbit, place, ahead, state)
    insert = place + 1 if len(word) else 0
    if isinstance(contact, Wall):
        if (at_start or at_end) and len(word):
            at = place if at_start else place + 1
            return _turn_at_wall(orbit, at % len(word), j)
        text = alphabet.text_of(j, HIT)
        return [Edit(insert, insert, (text,), (mode,), node[None], "speed", "a flight touches a wall")]
    early, late = node.copy(), node.copy()
    early[0] -= FIRST
    pair = np.array([early, late])
    if isinstance(contact, DryFriction):
        stick, slip = alphabet.text_of(j, STICK), alphabet.text_of(j, SLIP)
        if mode[j] != STUCK:
            modes = (with_mode(mode, j, STUCK), mode)
            return [
                Edit(insert, insert, (stick, slip), modes, pair, "gap", "a stick appears inside a flight")
            ]
        modes = (with_mode(mode, j, sign), mode)
        return [Edit(insert, insert, (slip, stick), modes, pair, "gap", "friction gives way for a moment")]
    if len(word) and length < SHORT * 100:
        return _pair(orbit, place)
    away, back = alphabet.text_of(j, SWITCH, -mode[j]), alphabet.text_of(j, SWITCH, mode[j])
    modes = (with_mode(mode, j, -mode[j]), mode)
    early[0], late[0] = node[0] - 0.5 * FIRST, node[0] + 0.5 * FIRST
    return [
        Edit(insert, insert, (away, back), modes, np.array([early, late]), "gap", "a flight touches a switch")
    ]


def _turn_at_wall(orbit: Any, place: int, wall: int) -> list[Edit]:
    """A turn or stick that reaches a wall: an impact of vanishing speed takes its place."""
    word = orbit.word
    letter = word.letter(place)
    sign = word.alphabet.flips.get((wall, letter.contact))
    if sign is None or letter.kind not in (TURN, STICK) or word.modes[place - 1][letter.contact] != -sign:
        return []
    node, text = orbit.nodes[place], word.alphabet.text_of(wall, HIT)
    after = with_mode(word.modes[place - 1], letter.contact, sign)
    if letter.kind == TURN:
        return [Edit(place, place + 1, (text,), (after,), node[None], "speed", "a turn hits a wall")]
    late = node.copy()
    if orbit.machine.forced:
        late[0] += FIRST
    modes = (after, word.modes[place])
    return [
        Edit(
            place,
            place + 1,
            (text, letter.text),
            modes,
            np.array([node, late]),
            "speed",
            "a stick hits a wall",
        )
    ]


# ---------------------------------------------------------------------- events
def _at_event(orbit: Any, place: int) -> list[Edit]:
    word = orbit.word
    letter, mode, before = word.letter(place), word.modes[place], word.modes[place - 1]
    node, n = orbit.nodes[place], len(word)
    none = orbit.nodes[:0]
    if letter.kind == HIT:
        turned = [j for j in range(len(mode)) if mode[j] != before[j]]
        if not turned:
            return [Edit(place, place + 1, (), (), none, "margin", "an impact vanishes")]
        if len(turned) > 1:
            return []
        j = turned[0]
        found = []
        follower = word.letter(place + 1)
        if place + 1 < n and follower.contact == j and follower.kind == STICK:
            merged = node.copy()
            merged[0] = orbit.nodes[place + 1, 0]
            found.append(
                Edit(
                    place,
                    place + 2,
                    (follower.text,),
                    (word.modes[place + 1],),
                    merged[None],
                    "margin",
                    "an impact before a stick vanishes",
                )
            )
        turn = word.alphabet.text_of(j, TURN)
        found.append(
            Edit(place, place + 1, (turn,), (mode,), node[None], "margin", "an impact becomes a turn")
        )
        return found
    if letter.kind == TURN:
        return _turn(orbit, place)
    if letter.kind == STICK and place + 1 < n:
        return _stick(orbit, place)
    if letter.kind == SLIP and place > 0 and word.letter(place - 1).contact == letter.contact:
        return _stick(orbit, place - 1)
    if letter.kind == SWITCH:
        return _pair(orbit, place)
    return []


def _turn(orbit: Any, place: int) -> list[Edit]:
    word = orbit.word
    letter, mode, node = word.letter(place), word.modes[place], orbit.nodes[place]
    j, alphabet, found = letter.contact, word.alphabet, []
    if place + 1 < len(word):
        follower = word.letter(place + 1)
        if follower.contact == j and follower.kind == STICK:
            held = orbit.nodes[place + 1][None]
            modes = (word.modes[place + 1],)
            note = "a turn before a stick disappears"
            found.append(Edit(place, place + 2, (follower.text,), modes, held, "margin", note))
    late = node.copy()
    late[0] += FIRST
    events = (alphabet.text_of(j, STICK), alphabet.text_of(j, SLIP))
    modes = (with_mode(mode, j, STUCK), mode)
    found.append(
        Edit(place, place + 1, events, modes, np.array([node, late]), "gap", "a turn becomes a stick")
    )
    return found


def _stick(orbit: Any, place: int) -> list[Edit]:
    """A stick that vanishes, or that is about to be preceded by a turn."""
    word, node = orbit.word, orbit.nodes[place]
    letter, follower = word.letter(place), word.letter(place + 1)
    j, alphabet = letter.contact, word.alphabet
    before, out = word.modes[place - 1], word.modes[place + 1]
    late = node.copy()
    late[0] += FIRST
    turn = alphabet.text_of(j, TURN)
    modes = (with_mode(before, j, -before[j]), word.modes[place])
    turned = Edit(
        place, place + 1, (turn, letter.text), modes, np.array([node, late]), "gap", "a turn appears before a stick"
    )  # fmt: skip
    gap = float(lengths(orbit)[place - 1])
    if (
        place > 0
        and word.letter(place - 1).contact == j
        and word.letter(place - 1).kind == TURN
        and gap < SHORT
    ):
        modes = (word.modes[place],)
        note = "a turn before a stick disappears"
        return [Edit(place - 1, place + 1, (letter.text,), modes, node[None], "margin", note)]
    if (
        place > 0
        and word.letter(place - 1).contact == j
        and word.letter(place - 1).kind == SLIP
        and gap < SHORT * 100
    ):
        note = "a slip vanishes"
        turned = Edit(place - 1, place + 1, (), (), orbit.nodes[:0], "margin", note)
    if follower.contact != j or follower.kind != SLIP:
        return [turned]
    if out[j] == before[j]:
        gone = Edit(place, place + 2, (), (), orbit.nodes[:0], "margin", "a stick disappears inside a flight")
        return [gone, turned]
    middle = node.copy()
    if orbit.machine.forced:
        middle[0] = 0.5 * (node[0] + orbit.nodes[place + 1, 0])
    else:
        middle[0] = node[0] + orbit.nodes[place + 1, 0]
    return [Edit(place, place + 2, (turn,), (out,), middle[None], "margin", "a stick becomes a turn"), turned]


def _pair(orbit: Any, place: int) -> list[Edit]:
    """Two crossings of a switch that meet disappear."""
    word = orbit.word
    found = []
    for first in (place, place - 1):
        if first < 0 or first + 1 >= len(word):
            continue
        if (
            word.letter(first).contact == word.letter(first + 1).contact
            and lengths(orbit)[first] < SHORT * 100
        ):
            found.append(
                Edit(first, first + 2, (), (), orbit.nodes[:0], "margin", "two crossings of a switch vanish")
            )
    return found


def _at_meeting(orbit: Any, place: int) -> list[Edit]:
    """Two consecutive events that fall together."""
    word = orbit.word
    if place + 1 >= len(word):
        return []
    here, there = word.letter(place), word.letter(place + 1)
    if here.contact == there.contact:
        if here.kind == SWITCH:
            return _pair(orbit, place)
        if here.kind == STICK:
            return _stick(orbit, place)
        if here.kind == TURN and there.kind == STICK:
            return _turn(orbit, place)
        if {here.kind, there.kind} in ({TURN}, {SLIP, STICK}):
            note = "two turns vanish" if here.kind == TURN else "a slip vanishes"
            return [Edit(place, place + 2, (), (), orbit.nodes[:0], "margin", note)]
        return []
    if there.kind == STICK and here.kind == HIT and (here.contact, there.contact) in word.alphabet.flips:
        return _at_event(orbit, place)
    before, after = word.modes[place - 1], word.modes[place + 1]
    changes = [j for j in range(len(before)) if word.modes[place + 1][j] != word.modes[place][j]]
    between = before
    for j in changes:
        between = with_mode(between, j, after[j])
    nodes = np.array([orbit.nodes[place], orbit.nodes[place + 1]])
    return [
        Edit(
            place,
            place + 2,
            (there.text, here.text),
            (between, after),
            nodes,
            "margin",
            "two events change their order",
        )
    ]
