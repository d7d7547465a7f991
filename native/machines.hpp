// The built-in machines by their numbers: their places in `NATIVE` of orbits/machines/names.py.
#pragma once
#include "cavity.hpp"
#include "coupled_cycles.hpp"
#include "coupled_simulation.hpp"
#include "shaken.hpp"

// A machine whose cavity moves as prescribed, by its law (cavity_law.hpp).
template <class Law> struct ShakenMachine {
    using Cycles = cycles::Cavity<Law>;
    struct Simulation : simulation::Shaken {
        explicit Simulation(const double* params) : Shaken(Law::law(params)) {}
    };
};
struct CoupledMachine {
    using Cycles = cycles::Coupled;
    using Simulation = simulation::Coupled;
};

template <class F> auto with_machine(whole number, F f) {
    switch (number) {
        case 0: return f(ShakenMachine<AbsorberLaw>());
        case 1: return f(ShakenMachine<GeneralLaw>());
        default: return f(CoupledMachine());
    }
}
