"""Independent simulator of declared machines: functions of the machine file on plain numbers, with scipy's DOP853 and its events.

It uses no symbols and no Taylor series; friction forces while sticking follow from two evaluations of `motion`.
"""

from types import SimpleNamespace

import numpy as np
from scipy.integrate import solve_ivp

from orbits import DryFriction, Wall


class Numbers(tuple):
    """States as numbers, with access by index and by name."""

    def __new__(cls, names, values):
        made = super().__new__(cls, values)
        for name, value in zip(names, values):
            setattr(made, name, value)
        return made


class Independent:
    """Flights of a machine in given modes."""

    def __init__(self, machine, parameters, motion):
        self.machine, self.motion = machine, motion
        self.p = SimpleNamespace(**parameters)
        self.omega = parameters[machine.phase_rate] if machine.phase_rate else None

    def number(self, given, state, phase):
        if isinstance(given, str):
            return getattr(self.p, given)
        return given(state, phase, self.p) if callable(given) else given

    def rates(self, t, x, modes, forces=None):
        """Return the rates of the states; the force of a sticking friction is the one that keeps its velocity constant."""
        state = Numbers(self.machine.states, x)
        phase = None if self.omega is None else self.omega * t
        given, stuck = {}, []
        for contact, mode in zip(self.machine.contacts, modes):
            if isinstance(contact, Wall):
                continue
            if isinstance(contact, DryFriction):
                if mode == 0:
                    stuck.append(contact)
                    given[contact.name] = 0.0
                else:
                    sign = 0.0 if mode == 2 else mode
                    given[contact.name] = -sign * self.number(contact.limit, state, phase)
            else:
                given[contact.name] = mode
        if forces is not None:
            given.update(forces)

        def rate(extra):
            return np.array(self.motion(state, phase, self.p, SimpleNamespace(**{**given, **extra})), float)

        if not stuck or forces is not None:
            return rate({})
        assert len(stuck) == 1
        name = stuck[0].name
        zero, one = rate({name: 0.0}), rate({name: 1.0})
        free, effect = (self.along(stuck[0].velocity, t, x, r) for r in (zero, one))
        effect -= free
        self.force, self.mobility = -free / effect, effect
        return zero + self.force * (one - zero)

    def along(self, function, t, x, rates, step=1e-6):
        """Time derivative of a function of (state, phase, p), by a central difference along the flow."""

        def at(s):
            phase = None if self.omega is None else self.omega * (t + s)
            return function(Numbers(self.machine.states, x + s * rates), phase, self.p)

        return (at(step) - at(-step)) / (2 * step)

    def guards(self, modes):
        """Return (contact, function of (t, x)) for all events that are possible in a mode."""
        found = []
        for j, (contact, mode) in enumerate(zip(self.machine.contacts, modes)):
            if isinstance(contact, DryFriction) and mode == 0:

                def reserve(t, x, sign, contact=contact):
                    self.rates(t, x, modes)
                    state = Numbers(self.machine.states, x)
                    return (
                        self.number(contact.limit, state, None if self.omega is None else self.omega * t)
                        + sign * self.force
                    )

                found += [(j, lambda t, x, f=reserve: f(t, x, 1)), (j, lambda t, x, f=reserve: f(t, x, -1))]
                continue
            if isinstance(contact, DryFriction) and mode == 2:
                continue
            function = (
                contact.gap
                if isinstance(contact, Wall)
                else (contact.velocity if isinstance(contact, DryFriction) else contact.surface)
            )
            sign = 1 if isinstance(contact, Wall) else mode

            def guard(t, x, function=function, sign=sign):
                phase = None if self.omega is None else self.omega * t
                return sign * function(Numbers(self.machine.states, x), phase, self.p)

            found.append((j, guard))
        return found

    def impact(self, wall, t, x, modes):
        """Return the states after an impact, by the rate of the gap before it."""
        state = Numbers(self.machine.states, x)
        phase = None if self.omega is None else self.omega * t
        push = np.array([self.number(wall.push.get(n, 0.0), state, phase) for n in self.machine.states])
        e = self.number(wall.restitution, state, phase)

        def rate(y):
            return self.along(wall.gap, t, y, self.rates(t, y, modes))

        before = rate(x)
        effect = rate(x + push) - before
        return x - (1 + e) * before / effect * push


def crossed(function, run, t, touches=1e-8):
    """Whether a function that decreases to zero at t becomes negative; at a border it may only touch zero."""
    later = t + (run.t[-1] - t) * np.linspace(0.0, 1.0, 200)
    values = [function(s, run.sol(s)) for s in later]
    back = next((k for k, value in enumerate(values) if k and value > touches), len(values))
    return min(values[:back]) < -touches


def deviation(orbit, motion):
    """Largest difference between an orbit's nodes and DOP853 from each node to the next; infinite if a different event happens first."""
    machine = orbit.model
    own = Independent(machine, orbit.parameters, motion)
    word, nodes, n = orbit.word, orbit.nodes, len(orbit.word)
    omega = own.omega
    worst = 0.0
    for i in range(n):
        begin = nodes[i, 0] / omega if omega else 0.0
        if omega:
            last = nodes[(i + 1) % n, 0] + (2 * np.pi * orbit.periods if i + 1 == n else 0.0)
            span = last / omega - begin
        else:
            span = nodes[i, 0]
        modes, letter = word.modes[i], word.letter(i + 1)
        if span < 1e-6:
            continue
        guards = own.guards(modes)
        events = []
        for _, function in guards:

            def event(t, x, _, function=function):
                return function(t, x)

            event.direction = -1
            events.append(event)
        x = nodes[i, 1:]
        run = solve_ivp(
            own.rates, (begin, begin + span), x, "DOP853", args=(modes,), rtol=1e-12, atol=1e-14,
            max_step=span / 40, dense_output=True,
            events=events,
        )  # fmt: skip
        y = run.y[:, -1]
        for (j, function), times in zip(guards, run.t_events):
            for t in times:
                early = begin + 1e-6 * span < t < begin + span * (1 - 1e-6)
                if early and j != letter.contact and crossed(function, run, t):
                    return np.inf
        end = begin + span
        if letter.kind == 0:
            gap = machine.contacts[letter.contact].gap(
                Numbers(machine.states, y), omega and omega * end, own.p
            )
            worst = max(worst, abs(gap))
            y = own.impact(machine.contacts[letter.contact], end, y, modes)
        else:
            values = [abs(f(end, y)) for j, f in guards if j == letter.contact]
            worst = max(worst, min(values))
        worst = max(worst, float(np.abs(y - nodes[(i + 1) % n, 1:]).max()))
    return worst
