"""The stepper of declared machines: moves a state from event to event, without words and without equations of orbits."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from orbits.contacts import HIT, HOLD, RELEASE, SLIP, STICK, SWITCH, TURN
from orbits.contacts.dry_friction import ABSENT, STUCK
from orbits.contacts.wall import FREE, HELD
from orbits.flows.protocol import SimulationError
from orbits.machines.page.machine import Machine
from orbits.machines.page.possible import singular_at
from orbits.settings import EVENTS

if TYPE_CHECKING:
    from orbits.integrators.expressions import Values
    from orbits.integrators.protocol import Run, Watch
    from orbits.machines.page.patterns import Guard

TWO_PI = 2.0 * np.pi
HALVINGS = 6  # bisections of the way to the top of a hop
CORRECTIONS = 6  # corrections of the gap rates of walls that hold


class Tools(NamedTuple):
    """Compiled functions of one mode: flights to the first vanishing guard, flights past guards, and guards with their rates."""

    run: Run
    watch: Watch
    values: Values
    guards: list[Guard]


class Stepper:
    """Moves a state of a declared machine from event to event.

    Attributes
    ----------
    state : float array (n,)
    modes : tuple of int
        Mode of each contact.
    clock : float
        The phase in [0, 2 pi) of a forced machine; else the time since the last event.
    base : float
        Whole turns times 2 pi (or time) before `clock`.
    """

    def __init__(self, machine: Machine, params: np.ndarray) -> None:
        self.machine, self.params = machine, np.asarray(params, dtype=float)
        self.compiled, self.equations = machine.compiled, machine.equations
        self.absent = machine.absent(self.params)
        self.clock_rate = float(machine.phase_speed(self.params))
        self.state = np.zeros(machine.size)
        self.clock, self.base = 0.0, 0.0
        self.modes: tuple[int, ...] = ()
        self.count = 0  # events so far
        self._last = -1  # contact of the last event, if another event may follow at the same instant
        self._compiled: dict[tuple[int, ...], Tools] = {}
        self._numbers: dict[tuple[int, ...], np.ndarray] = {}
        self._pushes: dict[tuple[int, tuple[int, ...]], Values] = {}
        places = {j: machine.size + 1 + k for k, j in enumerate(self.equations.signed)}
        self._touched = {  # per wall: frictions and switches whose sign an impact may change, with their places in the impact's map
            w: [(j, places[j]) for (wall, j) in machine.alphabet.flips if wall == w and j not in self.absent]
            for w in self.equations.gap
        }
        self._frictions = [*self.equations.velocity]
        self._tied = {  # per wall: frictions whose velocity is the rate of the wall's gap
            w: [
                j
                for (wall, j), sign in machine.alphabet.flips.items()
                if wall == w and sign is not None and j in self._frictions
            ]
            for w in self._touched
        }
        self._values = self.compiled.contact_values()
        self._impacts = {w: self.compiled.impact_map(w) for w in self._touched}
        self._fresh = False  # a guard starts at zero: leave its surface before searching for events
        self._hop = 0.0  # time to the top of a short hop from a wall
        self._due: list[int] = []  # walls that are hit at the same instant because of an impact elsewhere

    # ------------------------------------------------------------------ beginning
    def renew(self, params: np.ndarray) -> None:
        """Continue with other parameters; friction that sticks may begin to slide, a wall that holds may let go.

        Gaps, switch surfaces and velocities of contacts must not depend on the parameters that changed.
        """
        self.params = params
        self._numbers.clear()
        if any(self.modes[j] == STUCK for j in self._frictions):
            self.start(self.state, self.base + self.clock)
        elif self._holds:
            self._last = len(self.modes)  # no contact: any guard may be violated

    def start(self, state: np.ndarray, clock: float, modes: tuple[int, ...] | None = None) -> None:
        """Begin at a state; the modes follow from it if they are not given.

        Raises
        ------
        SimulationError
            If a gap is negative.
        """
        self.state = np.array(state, dtype=float)
        self.base = 0.0
        if self.machine.forced:
            turns = math.floor(clock / TWO_PI)
            self.base, self.clock = TWO_PI * turns, clock - TWO_PI * turns
        else:
            self.clock = 0.0
        self._last, self._due = -1, []
        if modes is not None:
            self.modes = tuple(modes)
            self._fresh = True
            self._settle_touches()
            return
        self.modes = tuple(self.machine.rest_mode(self.params, self.state, self.clock))
        values = self.contact_values()
        for j in self._touched:
            if values[j] < -EVENTS.zero * (1.0 + np.abs(self.state).max()):
                raise SimulationError(
                    f"the gap of wall {self.machine.contacts[j].letter!r} is {values[j]:.6g} at the start: bodies overlap; "
                    "give a start with all gaps at 0 or above"
                )
        for j in self._frictions * len(self._frictions):  # the slip of one may overcome the next one
            if self.modes[j] == STUCK:
                self.modes = self._changed_mode(j, self._at_rest(j))
        self._agree()
        self._fresh = True
        for j in self._touched:
            if abs(values[j]) <= EVENTS.zero and self._gap_rate(j) < 0.0:
                self._struck(j)

    def _agree(self) -> None:
        """Repeat the decisions of frictions at rest until each slides in the direction in which the others push it."""
        for _ in self._frictions:
            before = self.modes
            for guard in self._vanishing():
                self._happened(guard)
            if self.modes == before:
                return

    def contact_values(self) -> np.ndarray:
        """Return the gap, velocity or surface function of each contact at the present state."""
        if not self.machine.contacts:
            return np.zeros(0)
        return self._evaluated(self._values)

    # ------------------------------------------------------------------ laws
    @property
    def _tools(self) -> Tools:
        """Compiled functions of the present mode."""
        found = self._compiled.get(self.modes)
        if found is None:
            key, compiled = self.equations.pattern_key(self.modes), self.compiled
            guards = self.equations.pattern(key).guards
            found = Tools(compiled.run(key), compiled.watch(key), compiled.guards(key), guards)
            self._compiled[self.modes] = found
        return found

    @property
    def numbers(self) -> np.ndarray:
        """Runtime numbers of the present mode."""
        found = self._numbers.get(self.modes)
        if found is None:
            found = self._numbers[self.modes] = self.compiled.numbers(self.params, self.modes)
        return found

    def _evaluated(self, values: Values) -> np.ndarray:
        """Evaluate functions at the present state and mode."""
        return values.one(self.state, self.clock, self.numbers)

    def _guards(self, modes: tuple[int, ...] | None = None) -> list[tuple[float, float, Guard]]:
        """Return value, rate and guard of every guard at the present state, in a mode (by default the present one)."""
        modes_before = self.modes
        self.modes = modes_before if modes is None else modes
        tools = self._tools
        row, count = self._evaluated(tools.values).tolist(), len(tools.guards)
        self.modes = modes_before
        return list(zip(row[:count], row[count:], tools.guards))

    def _move(self, until: float) -> None:
        """Move on to a clock without looking for events."""
        self._tools.watch.move(self.state, self.clock, until, self.numbers)
        self.clock = until

    @property
    def _holds(self) -> bool:
        """Whether a wall holds a body."""
        return any(self.modes[w] == HELD for w in self._touched)

    def _changed_mode(self, contact: int, mode: int) -> tuple[int, ...]:
        changed = list(self.modes)
        changed[contact] = mode
        return tuple(changed)

    def _at_rest(self, friction: int) -> int:
        """Return the mode of a friction at zero velocity: stuck, or the sign of the motion that begins."""
        for value, _, guard in self._guards(self._changed_mode(friction, STUCK)):
            if guard.contact == friction and value < 0.0:
                return guard.sign
        return STUCK

    def _gap_rate(self, wall: int) -> float:
        return float(self._evaluated(self._impacts[wall])[len(self.state)])

    def _impact(self, wall: int) -> int:
        """Apply Newton's law; return HOLD if impacts have accumulated or leave no speed, else HIT."""
        row, n = self._evaluated(self._impacts[wall]), len(self.state)
        before = float(row[n])
        self.state[:] = row[:n]
        for j, place in self._touched[wall]:
            sign = 1 if row[place] > 0.0 else -1
            if sign != self.modes[j] and row[place] != 0.0 and self.modes[j] != ABSENT:
                self.modes = self._changed_mode(j, sign)
        after = self._gap_rate(wall)
        size = 1.0 + np.abs(self.state).max()
        push = self._push_back(wall) if after * after < EVENTS.slow * size * size else 0.0
        if push < 0.0:
            if before * before < EVENTS.simultaneous * abs(push) * size:
                return self._hold(wall)
            rise = -after / push
            self._hop = rise if rise * self.clock_rate < EVENTS.hop else 0.0
        return HIT

    def _struck(self, wall: int) -> int:
        """Apply an impact and its consequences at other walls that are touched; return HIT or HOLD.

        A wall that holds releases its body unless the hop would be part of accumulated impacts; a wall that is approached is hit at the same
        instant.
        """
        kind = self._impact(wall)
        near = EVENTS.zero * (1.0 + np.abs(self.state).max())
        gaps = self.contact_values()
        self._due = []
        resting = []
        for other in self._touched:
            if other == wall or (self.modes[other] != HELD and abs(gaps[other]) > near):
                continue
            rate = self._gap_rate(other)
            if abs(rate) <= near:
                continue
            if self.modes[other] == HELD:
                if self._piled_up(other, rate):
                    resting.append(other)
                    continue
                self._let_go(other, opening=rate > 0.0)
            if rate < 0.0:
                self._due.append(other)
        if resting:
            self._remove_gap_rates(resting if self.modes[wall] != HELD else [*resting, wall], near)
        return kind

    def _piled_up(self, wall: int, rate: float) -> bool:
        """Return whether a hop from a wall that holds, at this rate of the gap, belongs to accumulated impacts."""
        modes, fresh = self.modes, self._fresh
        self._let_go(wall, opening=rate > 0.0)
        push = self._push_back(wall)
        self.modes, self._fresh = modes, fresh
        return push < 0.0 and rate * rate < EVENTS.simultaneous * abs(push) * (1.0 + np.abs(self.state).max())

    def _remove_gap_rates(self, walls: list[int], near: float) -> None:
        """Remove the gap rates of walls that hold; each correction changes the other rates, so it is repeated."""
        for _ in range(CORRECTIONS):
            moving = [wall for wall in walls if abs(self._gap_rate(wall)) > near]
            if not moving:
                return
            for wall in moving:
                self.state[:] = self._evaluated(self.compiled.settled(wall))

    def _let_go(self, wall: int, opening: bool = True) -> None:
        """End the hold of a wall; frictions tied to it slide as its gap opens or closes."""
        modes = list(self._changed_mode(wall, FREE))
        for (contact, k), sign in self.machine.alphabet.flips.items():
            if contact == wall and sign is not None and k not in self.absent:
                modes[k] = sign if opening else -sign
        self.modes = tuple(modes)
        self._fresh = True

    def _opened(self, wall: int) -> None:
        """Open the gap of a body that sticks at a wall by roundoff; otherwise roundoff would trigger impacts again and again."""
        slopes, gap = self._evaluated(self.compiled.gap_slopes(wall)), float(self.contact_values()[wall])
        self.state += (EVENTS.zero * (1.0 + np.abs(self.state).max()) - gap) * slopes / float(slopes @ slopes)

    def _push_back(self, wall: int) -> float:
        """Return the acceleration of a free wall's gap."""
        values = self._pushes.get((wall, self.modes))
        if values is None:
            key = self.equations.pattern_key(self.modes)
            values = self._pushes[wall, self.modes] = self.compiled.gap_acceleration(wall, key)
        return float(self._evaluated(values)[0])

    def _hold(self, wall: int) -> int:
        """Begin to rest on a wall: remove the remaining rate of the gap."""
        self.state[:] = self._evaluated(self.compiled.settled(wall))
        modes = list(self._changed_mode(wall, HELD))
        values = self.contact_values()
        for j, _ in self._touched[wall]:  # the last impact may have changed the sign of a velocity
            if modes[j] != ABSENT:
                modes[j] = 1 if values[j] > 0.0 else -1 if values[j] < 0.0 else modes[j]
        for j in self._tied[wall]:  # the hold keeps the velocity at zero, so friction is absent
            modes[j] = ABSENT
        self.modes = tuple(modes)
        return HOLD

    # ------------------------------------------------------------------ going on
    def advance(self, until: float) -> tuple[int, int, int] | None:
        """Move to the next event, or to `until` (base + clock).

        Returns
        -------
        (contact, kind, sign) or None
            The event; None if `until` was reached.

        Raises
        ------
        SimulationError
            If the motion diverges, or would slide along a switch surface.
        """
        end = until - self.base
        if self._due:
            wall = self._due.pop()
            self.count += 1
            return wall, self._struck(wall), 0
        if self._last >= 0:
            event = self._simultaneous()
            if event is not None:
                self.count += 1
                return event
        while True:
            tools, before, began = self._tools, self.state.copy(), self.clock
            if self._fresh:
                self._fresh = False
                self._leave_surface(min(self.clock + EVENTS.leave, end))
            elif self._hop:
                self._to_top_of_hop(end)
            self._hop = 0.0
            if not end > self.clock:
                self._rebase()
                return None
            self.clock, place = tools.run(self.state, self.clock, end, self.numbers)
            if place is None:
                self._rebase()
                return None
            if place < 0:
                raise SimulationError(self._reason_of_divergence(before, began))
            guard = self._first(tools.guards[place])
            event = self._happened(guard)
            if event is not None:
                self.count += 1
                self._last = event[0] if self._frictions or self._holds else -1
                self._rebase()
                return event

    def _simultaneous(self) -> tuple[int, int, int] | None:
        """Return an event at the same instant as the last one, or None.

        Equal bodies begin to slip, or come to rest, at the same instant, and an event may add a force that another friction cannot hold, or
        that pulls a body from a wall that holds it. Such events are found here because a guard that begins at zero or below has no zero crossing.
        """
        guard = next((guard for guard in self._vanishing() if guard.contact != self._last), None)
        self._last = -1 if guard is None else guard.contact
        return None if guard is None else self._happened(guard)

    def _first(self, guard: Guard) -> Guard:
        """Return, of simultaneous turns and slips of several bodies, the first one in the machine's order.

        Otherwise roundoff would decide. The result is the same: each event changes only its own mode, and one that the others undo happens
        again at once.
        """
        if len(self._frictions) < 2 or guard.kind not in (SLIP, TURN):
            return guard
        return min([guard, *self._vanishing()], key=lambda one: one.contact)

    def _vanishing(self) -> list[Guard]:
        """Return the guards of turns and slips that happen now, and of walls that would have to pull."""
        touch, same_instant = EVENTS.touch, EVENTS.simultaneous
        return [
            guard
            for value, rate, guard in self._guards()
            if (rate < -touch and guard.kind in (SLIP, TURN) and abs(value) < same_instant * (1.0 - rate))
            or (value < -touch and guard.kind in (SLIP, RELEASE))
        ]

    def _reason_of_divergence(self, state: np.ndarray, clock: float) -> str:
        """Return the reason why a flight from a state gave no finite number."""
        name = repr(self.machine.name)
        for x, c in ((state, clock), (self.state, self.clock)):
            found = singular_at(self.equations, self.params, self.modes, x, c)
            if found:
                return f"the motion of {name} cannot go on: {found}; start elsewhere, or write the formula so that it is a number there"
        return f"the motion of {name} left the range of numbers: give parameters and a start of moderate size"

    def _leave_surface(self, end: float) -> None:
        """Leave a surface on which a guard starts without a rate, unless another event happens first."""
        if not end > self.clock:
            return
        before, begin = self.state.copy(), self.clock
        self._move(end)
        for value, rate, guard in self._guards():
            if value <= 0.0 and rate < 0.0 and guard.kind == HIT:  # the opening gap is negative by roundoff
                self.state, self.clock = before, begin
                if self.contact_values()[guard.contact] <= EVENTS.zero * (1.0 + np.abs(self.state).max()):
                    self._opened(guard.contact)
                return

    def _to_top_of_hop(self, end: float) -> None:
        """Move to the top of a short hop.

        The end of the hop is searched from there, because a zero at the beginning of a flight can hide a second one close to it.
        """
        before, begin = self.state.copy(), self.clock
        for _ in range(HALVINGS):
            top = begin + self._hop * self.clock_rate
            if begin < top < end:
                self._move(top)
                if all(value > 0.0 for value, _, _ in self._guards()):
                    return
                self.state[:], self.clock = before, begin
            self._hop *= 0.5

    def _settle_touches(self) -> None:
        """After a start on a switch surface that is only touched, choose the side to which the flow leads."""
        near = EVENTS.touch * (1.0 + np.abs(self.state).max())
        for value, rate, guard in self._guards():
            if guard.kind == SWITCH and abs(value) < near and abs(rate) < near:
                before = self.state.copy(), self.clock
                self._move(self.clock + EVENTS.leave)
                crossed = next(value for value, _, g in self._guards() if g is guard) < 0.0
                self.state, self.clock = before
                if crossed:
                    self.modes = self._changed_mode(guard.contact, -self.modes[guard.contact])

    def _rebase(self) -> None:
        if self.machine.forced:
            turns = math.floor(self.clock / TWO_PI)
            if turns:
                self.clock -= TWO_PI * turns
                self.base += TWO_PI * turns
        else:
            self.base += self.clock
            self.clock = 0.0

    def _touches(self, switch: int) -> bool:
        """Return whether a switch surface is only touched; if so, the state has moved past it."""
        place, rate = next((k, r) for k, (_, r, g) in enumerate(self._guards()) if g.contact == switch)
        if abs(rate) > EVENTS.touch * (1.0 + np.abs(self.state).max()):
            return False
        before = self.state.copy(), self.clock
        self._move(self.clock + EVENTS.leave)
        if self._guards()[place][0] > 0.0:
            return True
        self.state, self.clock = before
        return False

    def _driven(self, friction: int) -> int | None:
        """Return a moving wall that holds the friction's body, so that the friction cannot stop it; None if there is none."""
        wall = next(
            (w for w in self._touched if self.modes[w] == HELD and friction in dict(self._touched[w])), None
        )
        if wall is None:
            return None
        # the reserves of both directions add up to twice the limit times the acceleration per unit of force
        freedom = sum(
            v for v, _, g in self._guards(self._changed_mode(friction, STUCK)) if g.contact == friction
        )
        return None if freedom > 0.0 else wall

    def _turned_by(self, wall: int, friction: int) -> tuple[int, int, int]:
        """Return the event when a friction's velocity changes sign while a moving wall holds the body: a turn, or a release.

        The wall releases the body if it would have to pull after the turn; the fate of the velocity is then the next event.
        """
        turned = self._changed_mode(friction, -self.modes[friction])
        if any(v < 0.0 for v, _, g in self._guards(turned) if g.contact == wall and g.kind == RELEASE):
            self._let_go(wall)
            return wall, RELEASE, 0
        self.modes = turned
        return friction, TURN, turned[friction]

    def _happened(self, guard: Guard) -> tuple[int, int, int] | None:
        j, kind = guard.contact, guard.kind
        if kind == HIT:
            if any(self.modes[f] == STUCK for f in self._tied[j]):
                self._opened(j)
                return None
            return j, self._struck(j), 0
        if kind == TURN:
            wall = self._driven(j)
            if wall is not None:
                return self._turned_by(wall, j)
            before = self.modes[j]
            after = self._at_rest(j)
            if after == before:
                return None  # the velocity only touches zero
            self.modes = self._changed_mode(j, after)
            return j, STICK if after == STUCK else TURN, after
        if kind == SLIP:
            self.modes = self._changed_mode(j, guard.sign)
            self._fresh = True
            return j, SLIP, guard.sign
        if kind == RELEASE:
            self._let_go(j)
            return j, RELEASE, 0
        if self._touches(j):
            return None
        after = -self.modes[j]
        self.modes = self._changed_mode(j, after)
        rate = next(r for _, r, g in self._guards() if g.contact == j and g.kind == SWITCH)
        if rate < 0.0:
            raise SimulationError(
                f"switch {self.machine.contacts[j].name!r}: both flows lead to its surface, so the motion would slide along it; "
                "declare a law that crosses (a spring and damper that do not pull), or a DryFriction"
            )
        return j, SWITCH, after
