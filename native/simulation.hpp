// The simulator's functions as Python calls them; the first argument is the machine's number.
#pragma once
#include "machines.hpp"
#include "many_starts.hpp"

namespace simulation {

template <class F> auto with_machine(whole number, const double *params, F f) {
    return ::with_machine(number, [&](auto machine) { return f(typename decltype(machine)::Simulation(params)); });
}

}  // namespace simulation

EXPORT void simulation_launch(whole machine, double *state, const double *params) {
    simulation::with_machine(machine, params, [&](const auto& m) { m.launch(state); });
}

// Returns eight times the number of events, plus the status.
EXPORT whole simulation_advance(whole machine, double *state, const double *params, double until, signed char *codes, signed char *modes,
                                double *rows, whole room) {
    return simulation::with_machine(machine, params, [&](const auto& m) -> whole {
        simulation::Events events{codes, modes, rows, room};
        const simulation::Status status = m.advance(state, until, events);
        return 8 * events.count + status;
    });
}

EXPORT void simulation_sample(whole machine, whole count, const double *states, const double *params, const double *ahead, double *out) {
    simulation::with_machine(machine, params, [&](const auto& m) {
        for (whole i = 0; i < count; i++) m.sample(states + i * m.STATE, ahead[i], out + 4 * i);
    });
}

EXPORT void simulation_works(whole machine, whole count, const double *states, const double *params, const double *ahead, double *out) {
    simulation::with_machine(machine, params, [&](const auto& m) {
        for (whole i = 0; i < count; i++) m.works(states + i * m.STATE, ahead[i], out + 3 * i);
    });
}

EXPORT void simulation_energies(whole machine, whole count, const double *states, const double *params, double *out) {
    simulation::with_machine(machine, params, [&](const auto& m) {
        for (whole i = 0; i < count; i++) out[i] = m.energy(states + i * m.STATE);
    });
}

EXPORT void simulation_states(whole machine, const double *params, whole count, const signed char *codes, const signed char *modes,
                              const double *nodes, double left, double right, double *states) {
    simulation::with_machine(machine, params, [&](const auto& m) {
        for (whole i = 0; i < count; i++)
            simulation::state_of(m, codes[i], modes[i], nodes + i * (m.STATE - 4), left, right, states + i * m.STATE);
    });
}

EXPORT void simulation_positions(whole machine, const double *params, whole events, const signed char *codes, const signed char *modes,
                                 const double *nodes, double left, double right, double length, whole count, double *w) {
    simulation::with_machine(machine, params, [&](const auto& m) {
        simulation::positions(m, events, codes, modes, nodes, left, right, length, count, w);
    });
}

EXPORT whole simulation_settle(whole machine, whole begin, whole count, double *states, const double *params, double transient,
                               whole longest, double tolerance, whole *periods, whole *impacts, whole *holds, double *gaps, whole *fate,
                               double budget) {
    const simulation::Motions found{periods, impacts, holds, gaps, fate};
    return simulation::with_machine(machine, params, [&](const auto& m) {
        return simulation::settle(m, begin, count, states, transient, longest, tolerance, found, budget);
    });
}

EXPORT void simulation_growth(whole machine, double *state, double *other, const double *params, double left, double right, whole begin,
                              whole end, double distance, double *ratios) {
    simulation::with_machine(machine, params, [&](const auto& m) {
        simulation::growth(m, state, other, left, right, begin, end, distance, ratios);
    });
}

// Of the segments of a machine that rides on an oscillator: see `Coupled::shape`.
EXPORT void simulation_shapes(whole machine, whole count, const double *states, const double *params, const double *lengths, double *out) {
    simulation::with_machine(machine, params, [&](const auto& m) {
        if constexpr (requires { m.shape(states, 0.0, out); })
            for (whole i = 0; i < count; i++) m.shape(states + i * m.STATE, lengths[i], out + 4 * i);
    });
}
