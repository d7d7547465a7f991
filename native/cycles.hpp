// What all cycles share: their data and workspace, how parameters move a machine's numbers, other readings of the linearisation,
// multipliers with margins, Newton's method. `Machine` (cavity.hpp, coupled_cycles.hpp) has `linearise`, `margins`.
#pragma once
#include "elimination.hpp"
#include "multipliers.hpp"

namespace cycles {
using namespace algebra;

// The equations of cycles with one word against one parameter; see CycleData in orbits/arguments.py.
struct Cycle {
    whole length, parameters, quantities, powers, pinned, active;
    double twist, shift;
    whole *events, *modes;
    double *params, *path, *amounts, *law;
};
// Arrays for one system of L nodes; see Workspace there.
struct Workspace {
    whole length, node;
    double *F, *A, *D, *Q, *numbers, *pin, *sines, *cosines, *stored, *panel, *small, *solution, *lanes, *scratch, *re, *im;
};

enum Letter { LEFT, RIGHT, TURN, STICK, SLIP };

// The event at the end of segment i; half a cycle is closed by its mirror image.
inline whole arrival_of(const Cycle& c, whole i) {
    if (i + 1 < c.length) return c.events[i + 1];
    return c.twist > 0.0 || c.events[0] > RIGHT ? c.events[0] : 1 - c.events[0];
}
// The mode after the event at the end of segment i, and before event i.
inline double mode_after(const Cycle& c, whole i) { return i + 1 < c.length ? double(c.modes[i + 1]) : c.twist * double(c.modes[0]); }
inline double mode_before(const Cycle& c, whole i) { return i > 0 ? double(c.modes[i - 1]) : c.twist * double(c.modes[c.length - 1]); }
// The last event that is followed by a flight: its displacement equation is what the pin replaces (orbits/machines/reference/maps.py).
inline whole last_flight(const Cycle& c) { return c.modes[c.length - 1] != 0 ? c.length - 1 : c.length - 2; }

// Replace the displacement equation of the last flight of an impact-free motion by w_i + w_{i+1} = middle, the sum of the walls' places;
// returns by how much the mean position is off.
inline double pin(const Cycle& c, const double* u, Workspace& work, double middle, double d_middle) {
    const whole n = work.node, last = last_flight(c), row = last * n + 1;
    double *A = work.A + row * n, *D = work.D + row * n;
    for (whole k = 0; k < n; k++) work.pin[k] = A[k], work.pin[n + k] = D[k], A[k] = D[k] = 0.0;
    A[1] = D[1] = 1.0, work.Q[row] = -d_middle;
    work.F[row] = u[row] + (last + 1 < c.length ? u[row + n] : c.twist * u[1]) - middle;
    return fabs(work.F[row]);
}
inline void unpin(const Cycle& c, Workspace& work) {
    if (c.pinned != 1) return;
    const whole n = work.node, row = last_flight(c) * n + 1;
    for (whole k = 0; k < n; k++) work.A[row * n + k] = work.pin[k], work.D[row * n + k] = work.pin[n + k];
}

// The numbers at p, then their derivatives with respect to p, into `out` (2 P,); see orbits/machines/parameters.py.
inline void place(const Cycle& c, double p, double* out) {
    const whole count = c.parameters;
    for (whole j = 0; j < count; j++) {
        double factor = c.path[j], exponent = c.path[count + j];
        if (exponent == 0.0) out[j] = c.params[j], out[count + j] = 0.0;
        else if (exponent == 1.0) out[j] = factor * p, out[count + j] = factor;
        else out[j] = factor * power(p, exponent), out[count + j] = exponent * factor * power(p, exponent - 1.0);
    }
}

inline double cycle_bordered(void* data, void* work, const double* border, double target, double* step, double* tangent) {
    auto& w = *static_cast<Workspace*>(work);
    System system = {w.length, w.node, w.F, w.A, w.D, w.Q, static_cast<Cycle*>(data)->twist, w.stored, w.panel, w.small, w.solution, w.lanes};
    return solve_bordered(system, border, target, step, tangent);
}

// Give the parameter that varies in `other` a value in `data`.
inline void cycle_assign(void* data, void* other, double value) {
    auto& c = *static_cast<Cycle*>(data);
    whole index = static_cast<Cycle*>(other)->active;
    c.amounts[index] = value;
    if (c.powers == 0) {
        c.params[index] = value;
        return;
    }
    for (whole j = 0; j < c.parameters; j++) {
        double product = c.law[j], rest = c.law[j];
        for (whole k = 0; k < c.quantities; k++) {
            double exponent = c.law[(k + 1) * c.parameters + j];
            if (exponent == 0.0) continue;
            double factor = exponent == 1.0 ? c.amounts[k] : power(c.amounts[k], exponent);
            product *= factor;
            if (k != c.active) rest *= factor;
        }
        c.params[j] = product, c.path[j] = rest;
    }
}

// Write the transposed system into another workspace, with `column` (L n,) as its last column.
inline void cycle_transpose(void* data, void* work, const double* column, void* other) {
    auto &w = *static_cast<Workspace*>(work), &o = *static_cast<Workspace*>(other);
    const double twist = static_cast<Cycle*>(data)->twist;
    const whole n = w.node;
    for (whole k = 0; k < w.length; k++) {
        whole following = k + 1 < w.length ? k + 1 : 0;
        for (whole i = 0; i < n; i++) {
            double scale = following == 0 && i > 0 ? twist : 1.0;
            o.Q[k * n + i] = column[following * n + i];
            for (whole c = 0; c < n; c++) {
                o.A[(k * n + i) * n + c] = scale * w.D[(k * n + c) * n + i];
                o.D[(k * n + i) * n + c] = w.A[(following * n + c) * n + i] * (following == 0 && c > 0 ? twist : 1.0);
            }
        }
    }
}

template <class Machine> struct CycleKernels {
    static double linearise(void* data, const double* u, double p, void* work) {
        auto &c = *static_cast<Cycle*>(data);
        auto &w = *static_cast<Workspace*>(work);
        place(c, p, w.numbers);
        double largest = Machine::linearise(c, u, w);
        return isfinite(largest) ? largest : HUGE_VAL;
    }
    // Turn the closure x_L = T x_0 into x_L = -T x_0 (sign = -1), and back; the pin of an impact-free motion is taken out.
    static void flip(void* data, void* work, double) {
        auto& w = *static_cast<Workspace*>(work);
        unpin(*static_cast<Cycle*>(data), w);
        double* last = w.D + (w.length - 1) * w.node * w.node;
        for (whole i = 0; i < w.node * w.node; i++) last[i] = -last[i];
    }
    // Multipliers of the closure map as (re, im) pairs, then four margins per node.
    static void inspect(void* data, const double* u, double, void* work, double* row) {
        auto& c = *static_cast<Cycle*>(data);
        auto& w = *static_cast<Workspace*>(work);
        const int n = int(w.node);
        unpin(c, w);
        // Nothing later depends on when a stick begins or ends: w' = 0 there and v'' is the same before and after, at a slip w'' = 0, too.
        // Those phases move with 1/w'' and one over the rate at which friction gives way, which grow without bound where the stick
        // vanishes, so they are held instead.
        for (whole i = 0; i < c.length; i++) {
            whole arrival = c.events[i + 1 < c.length ? i + 1 : 0];
            if (arrival != STICK && arrival != SLIP) continue;
            double *A = w.A + i * n * n, *D = w.D + i * n * n;
            for (int k = 0; k < n; k++) A[k] = 0.0, D[k] = 0.0;
            D[0] = 1.0;
        }
        double *re = w.re, *im = w.im;
        multipliers(w.A, w.D, c.length, n, c.twist, re, im, w.scratch);
        int count = n;
        if (c.pinned) {  // an impact-free motion may be moved as a whole: drop that multiplier, nearest to the twist
            count = n - 1;
            int trivial = 0;
            for (int j = 1; j < n; j++)
                if (hypotenuse(re[j] - c.twist, im[j]) < hypotenuse(re[trivial] - c.twist, im[trivial])) trivial = j;
            for (int j = trivial; j < count; j++) re[j] = re[j + 1], im[j] = im[j + 1];
        }
        for (int j = 0; j < count; j++) row[2 * j] = re[j], row[2 * j + 1] = im[j];
        Machine::margins(c, u, w, row + 2 * count);
    }
    static constexpr Table table = {linearise, cycle_bordered, inspect, cycle_assign, flip, cycle_transpose};
};

// Newton's method on the hyperplane of `border` (fixed p: its last unit vector), halving steps that do not help; the residual, infinity
// where it does not converge. `room` holds `size` trial unknowns.
inline double newton(const Table& table, void* data, void* work, whole size, double* u, double* p, double* room, const double* border,
                     double* step, double* tangent, double tolerance, whole limit, whole* iterations) {
    double residual = table.linearise(data, u, *p, work);
    for (whole iteration = 0; iteration < limit; iteration++) {
        *iterations = iteration;
        double sign = table.bordered(data, work, border, 0.0, step, tangent);
        if (sign == 0.0 || !isfinite(step[0])) return HUGE_VAL;
        double length = 0.0, share = 1.0, best = HUGE_VAL;
        for (whole j = 0; j < size; j++) length = larger(length, fabs(step[j]));
        while (share > 0.01) {
            for (whole j = 0; j < size; j++) room[j] = u[j] + share * step[j];
            best = table.linearise(data, room, *p + share * step[size], work);
            if (best < residual || length < 1e-7) break;
            share *= 0.5;
        }
        for (whole j = 0; j < size; j++) u[j] = room[j];
        *p += share * step[size], residual = best, *iterations = iteration + 1;
        if (length * share < tolerance || (residual < 1e-14 && length < 1e-9)) return residual;
    }
    *iterations = limit;
    return HUGE_VAL;
}

}  // namespace cycles
