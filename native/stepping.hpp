// The contract of all steppers: state, event rows, status (orbits/machines/stepping.py says it in words).
#pragma once
#include "math.hpp"

namespace simulation {

enum Code : signed char { HIT_LEFT, HIT_RIGHT, TURN, STICK, SLIP, HOLD };
enum Status { EVENTS_FULL, TIME_REACHED, AT_REST, FAILED, PAUSED };
enum State { PSI, W, RATE, MODE, TURNS, LOW, V, V_RATE };

// A call returns after so many forcing periods at the latest, so that Python sees an interrupt.
constexpr double SLICE = 20000.0;

inline double least(double a, double b) { return b < a ? b : a; }
inline double most(double a, double b) { return b > a ? b : a; }

// Keep a phase within [0, 2 pi) and count its turns.
inline void carry(double& psi, double& turns) {
    double more;
    psi = wrap(psi, more);
    turns += more;
}

// Room for events, one row each, and how many there are.
struct Events {
    signed char *codes, *modes;
    double *rows;
    whole room, count = 0;

    bool full() const { return count == room; }

    // The next row; of the machine's columns beyond the fifth the caller writes itself.
    double *add(int width, Code code, double mode, double psi, double turns, double w, double before, double after) {
        double *row = rows + count * width;
        codes[count] = code;
        modes[count] = (signed char)mode;
        row[0] = psi;
        row[1] = turns;
        row[2] = w;
        row[3] = before;
        row[4] = after;
        count++;
        return row;
    }
};

}  // namespace simulation
