// Many motions at once, and what is known of a cycle from its nodes: states, positions.
#pragma once
#include "stepping.hpp"

namespace simulation {

constexpr int BUFFER = 1024;  // events kept between two looks

// Room for the events of one call on the stack; nobody reads them but `settle`, which counts impacts.
template <class Machine> struct Scratch {
    signed char codes[BUFFER], modes[BUFFER];
    double rows[BUFFER * Machine::ROW];
    Events events() { return {codes, modes, rows, BUFFER}; }
};

enum Fate { WANDERING, SETTLED, RESTS, LOST };

// What became of a motion: its fate, forcing periods, impacts and piled-up impacts of one recurrence, least distance of a return.
struct Motions { whole *periods, *impacts, *holds; double *gaps; whole *fate; };

// Follow a state up to a time, counting impacts, piled-up impacts and events.
template <class Machine>
Status follow(const Machine& machine, double *state, double until, Scratch<Machine>& room, whole& impacts, whole& holds, double& work) {
    for (;;) {
        Events events = room.events();
        Status status = machine.advance(state, until, events);
        for (whole j = 0; j < events.count; j++) {
            impacts += room.codes[j] < 2;
            holds += room.codes[j] == HOLD;
        }
        work += double(events.count);
        if (status != EVENTS_FULL && status != PAUSED) return status;
    }
}

// Run motion i until it recurs, rests or is lost; returns how many events and forcing periods that took.
template <class Machine>
double settle_one(const Machine& machine, whole i, double *state, double transient, whole longest, double tolerance,
                  const Motions& found, Scratch<Machine>& room) {
    double work = transient;
    if (state[TURNS] < 0.5) machine.launch(state);
    const double until = floor(state[TURNS] + state[PSI] / TWO_PI + 0.5) + transient;
    whole hits = 0, held = 0;
    Status status = follow(machine, state, until, room, hits, held, work);
    double first[Machine::STATE];
    for (int c = 0; c < Machine::STATE; c++) first[c] = state[c];
    hits = held = 0;
    if (status == TIME_REACHED) found.gaps[i] = HUGE_VAL;
    for (whole k = 1; status == TIME_REACHED && k <= longest; k++) {
        status = follow(machine, state, until + double(k), room, hits, held, work);
        work += 1.0;
        if (status != TIME_REACHED) break;
        double gap = 0.0;
        for (int c = W; c < Machine::STATE; c++)
            if (c != TURNS && c != LOW) gap = most(gap, fabs(state[c] - first[c]));
        found.gaps[i] = least(found.gaps[i], gap);
        if (gap < tolerance) {
            found.periods[i] = k;
            found.impacts[i] = hits;
            found.holds[i] = held;
            found.fate[i] = SETTLED;
            break;
        }
    }
    if (status == AT_REST) found.fate[i] = RESTS;
    if (status == FAILED) found.fate[i] = LOST;
    return work;
}

// Run every motion from number `begin` on that still wanders, until `budget` events and periods are spent; returns the next number.
template <class Machine>
whole settle(const Machine& machine, whole begin, whole count, double *states, double transient, whole longest, double tolerance,
             const Motions& found, double budget) {
    Scratch<Machine> room;
    for (whole i = begin; i < count; i++) {
        if (found.fate[i] != WANDERING) continue;
        if (budget < 0.0) return i;
        budget -= settle_one(machine, i, states + i * Machine::STATE, transient, longest, tolerance, found, room);
    }
    return count;
}

// Follow a motion and a neighbour between the walls, which is drawn back to it once a forcing period; factors of the growth in
// periods `begin` to `end`. Before the first one the neighbour is put `distance` away.
template <class Machine>
void growth(const Machine& machine, double *state, double *other, double left, double right, whole begin, whole end, double distance,
            double *ratios) {
    Scratch<Machine> room;
    whole hits = 0, held = 0;
    double work = 0.0;
    auto apart = [&](int c) { return other[c] - state[c]; };
    auto sign = [](double x) { return double(x > 0.0) - double(x < 0.0); };
    if (begin == 0) {
        for (int c = 0; c < Machine::STATE; c++) other[c] = state[c];
        other[W] -= distance * sign(other[W]);
        other[RATE] += 0.5 * distance;
        machine.launch(other);
    }
    for (whole k = begin; k < end; k++) {
        const double until = floor(state[TURNS] + state[PSI] / TWO_PI + 0.5) + 1.0;
        follow(machine, state, until, room, hits, held, work);
        follow(machine, other, until, room, hits, held, work);
        double sum = apart(W) * apart(W) + apart(RATE) * apart(RATE);
        for (int c = V; c < Machine::STATE; c++) sum += apart(c) * apart(c);
        double size = sqrt(sum);
        if (size == 0.0) {  // a stick has lost the difference: give it one again
            ratios[k] = 1e-3;
            other[RATE] = state[RATE] + distance;
        } else {
            ratios[k] = size / distance;
            const double ratio = distance / size;
            for (int c = W; c < Machine::STATE; c++)
                if (c != MODE && c != TURNS && c != LOW) other[c] = state[c] + ratio * apart(c);
        }
        other[PSI] = state[PSI];
        other[TURNS] = state[TURNS];
        other[LOW] = state[LOW];
        other[W] = least(most(other[W], right), left);
        machine.launch(other);
    }
}

// The state just after an event, from its node (Psi, B+ or w(, v, v')).
template <class Machine>
void state_of(const Machine& machine, signed char code, signed char mode, const double *node, double left, double right, double *state) {
    state[PSI] = wrap(node[0], state[TURNS]);
    state[MODE] = double(mode);
    state[W] = node[1];
    state[RATE] = state[LOW] = 0.0;
    for (int c = V; c < Machine::STATE; c++) state[c] = node[c - 4];
    if (code < 2) {
        state[W] = code == HIT_LEFT ? left : right;
        state[RATE] = machine.cavity_speed(state) - node[1];
    }
}

// w of a cycle of `length` radians at equal phases, from phase zero on.
template <class Machine>
void positions(const Machine& machine, whole events, const signed char *codes, const signed char *modes, const double *nodes,
               double left, double right, double length, whole count, double *w) {
    constexpr int NODE = Machine::STATE - 4;
    const double first = nodes[0];
    double state[Machine::STATE] = {}, out[4], before = -1.0, begins = 0.0;
    whole segment = 0, loaded = -1;
    for (whole i = 0; i < count; i++) {
        double wanted = double(i) * (length / double(count)) - first;
        wanted -= floor(wanted / length) * length;
        if (wanted < before) {
            segment = 0;
            begins = 0.0;
        }
        before = wanted;
        while (segment + 1 < events && most(begins, nodes[(segment + 1) * NODE] - first) <= wanted) {
            segment++;
            begins = most(begins, nodes[segment * NODE] - first);
        }
        if (segment != loaded) state_of(machine, codes[segment], modes[segment], nodes + segment * NODE, left, right, state);
        loaded = segment;
        machine.sample(state, wanted - begins, out);
        w[i] = out[0];
    }
}

}  // namespace simulation
