// Elementary maps of the absorber on its oscillator between consecutive events, with exact derivatives, and margins. A node is
// (Psi, B+, v, v') at an impact and (Psi, w, v, v') at a turn, stick or slip; v = q1 + eps q2, w = q1 - q2, B = v' - w' = (1 + eps) q2'.
// In words: orbits/machines/reference/maps.py, margins.py and law.py.
#pragma once
#include "coupled.hpp"
#include "cycles.hpp"

namespace cycles {

struct Coupled {
    // Where a flight begins.
    template <class T> static coupled::Motion<T> start(whole event, const T& y, const T& v, const T& v_rate) {
        if (event < TURN) return {1.0 - 2.0 * double(event), v_rate - y, v, v_rate};
        return {y, 0.0, v, v_rate};
    }

    // In one piece: numbers with derivatives are kept in registers.
    [[gnu::flatten]] static double linearise(const Cycle& c, const double* u, Workspace& work) {
        enum Variable { PSI0, Y, V, V_RATE, PSI1, PARAMETER, ALL };
        using Number = Dual<ALL>;
        constexpr int P = coupled::Law<Number>::PARAMETERS;
        Number par[P];
        for (int j = 0; j < P; j++) par[j] = work.numbers[j], par[j].partial[PARAMETER] = work.numbers[c.parameters + j];
        const coupled::Law<Number> law(par);
        for (whole i = 0; i < c.length; i++) sine_cosine(u[4 * i], work.sines[i], work.cosines[i]);
        double largest = 0.0;
        for (whole i = 0; i < c.length; i++) {
            const bool inner = i + 1 < c.length;
            const whole event = c.events[i], arrival = arrival_of(c, i);
            const double mode = double(c.modes[i]), twist = inner ? 1.0 : c.twist, *x = u + 4 * i, *next = inner ? x + 4 : u;
            const Number psi0 = Number::variable(x[0], PSI0), psi1 = Number::variable(inner ? next[0] : next[0] + c.shift, PSI1);
            const auto from = start(event, Number::variable(x[1], Y), Number::variable(x[2], V), Number::variable(x[3], V_RATE));
            const auto q = law.oscillation(psi0, from, mode);
            const Number t = (psi1 - psi0) * law.by_omega;
            const auto p = q.at(t);
            const auto to = law.after(q, p, from, mode, t);
            Number ends = to.rate, second = to.w;  // equations 0 and 1: what ends the segment, and what remains of the node
            if (arrival < TURN) ends = to.w - (1.0 - 2.0 * double(arrival)), second = to.v_rate + law.r * to.rate;
            else if (arrival == SLIP) ends = law.full * (p.h2 + p.z2) - (mode_after(c, i) * law.a + law.b);  // friction gives way: v'' = m a + b
            else if (event >= TURN && mode != 0.0) ends = p.mean - q.q2_pull;  // from rest to rest: w'/d, so that no flight of no duration solves it
            const Number rows[4] = {ends, second, to.v, to.v_rate};
            for (int row = 0; row < 4; row++) {
                double *A = work.A + 16 * i + 4 * row, *D = work.D + 16 * i + 4 * row, &F = work.F[4 * i + row];
                F = row > 0 ? rows[row].value - twist * next[row] : rows[row].value;
                for (int k = 0; k < 4; k++) A[k] = rows[row].partial[PSI0 + k], D[k] = 0.0;
                D[row] = -1.0, D[0] = rows[row].partial[PSI1];
                work.Q[4 * i + row] = rows[row].partial[PARAMETER];
                if (!(fabs(F) <= largest)) largest = fabs(F);
            }
        }
        if (c.pinned == 1) largest = larger(largest, pin(c, u, work, 0.0, 0.0));
        return largest;
    }

    // ---- margins ----------------------------------------------------------------------------------------------------------------
    using Oscillation = coupled::Oscillation<double>;

    // First zero between two times of w' (order 1), or of q1''' (order 3).
    static double first_zero(const Oscillation& q, int order, double psi, double start, double end) {
        const double tiny = 4e-16 * ((order == 1 ? fabs(q.q2_rate) + fabs(q.q2_pull) * end : 0.0) + 2.0 * q.driven(order) + 2.0 * q.own(order, 0.0));
        return coupled::first_zero(start, end, q.driven(order + 2) + q.own(order + 2, start), tiny, psi, [&](double tau, double& value, double& slope) {
            const Oscillation::Point p = q.at(tau);
            if (order == 1) value = q.h1 + q.z1 + p.speed - (q.q2_rate + q.q2_pull * tau), slope = p.h2 + p.z2 - q.q2_pull;
            else value = p.h3 + p.z3, slope = q.fourth(p);
        });
    }
    // Smallest s w' at an interior minimum on start < tau < end of a slide, infinity if there is none. A zero of w'' needs to be known to
    // 1e-5 only: the minimum is then taken from the Taylor series.
    static double slowest(const Oscillation& q, double s, double force, double start, double end) {
        const double brake = s * q.q2_pull;
        double smallest = HUGE_VAL, tau = start, bound = -1.0;
        while (true) {
            const Oscillation::Point p = q.at(tau);
            const double y = s * (p.h2 + p.z2) - brake, slope = s * (p.h3 + p.z3);
            if (bound < 0.0) {
                const double fourth = q.fourth(p), fifth = q.fifth(p);
                bound = sqrt(fourth * fourth + fifth * fifth * q.by_kappa) + q.square * q.square * force * (end - start) / sqrt(q.kappa);
                if (!(bound > 1e-300)) return smallest;
            }
            double sign = y > 0.0 ? 1.0 : -1.0, step = coupled::certain(fabs(y), sign * slope, bound);
            if (step < 1e-5) {
                double zero = sign * slope < 0.0 ? -y / slope : 0.0;
                if (tau + zero >= end) return smallest;
                if (slope > 0.0) {
                    double speed = s * (q.h1 + q.z1 + p.speed - q.q2_rate) - brake * tau;
                    smallest = smaller(smallest, speed + (y + 0.5 * slope * zero) * zero);
                }
                step = zero + larger(fabs(slope) / bound, 1e-5);
            }
            tau += step;
            if (!(tau < end)) return smallest;
        }
    }

    static void margins(const Cycle& c, const double* u, Workspace& work, double* out) {
        const coupled::Law<double> law(work.numbers);
        const double a = law.a, b = law.b, strength = law.strength();
        for (whole i = 0; i < c.length; i++) {
            const whole event = c.events[i], arrival = arrival_of(c, i);
            const bool inner = i + 1 < c.length;
            const double mode = double(c.modes[i]), *x = u + 4 * i, psi0 = x[0], psi1 = inner ? x[4] : u[0] + c.shift, d = (psi1 - psi0) / law.omega;
            const auto from = start(event, x[1], x[2], x[3]);
            const double push = law.push(from, work.sines[i], work.cosines[i]) - b;  // what friction withstands: v'' - b
            const Oscillation q = law.oscillation(psi0, from, mode);
            const Oscillation::Point begin = q.begin();
            const double jerk = begin.h3 + begin.z3;
            double flight = HUGE_VAL, tau = 0.0;
            if (!(d > 0.0)) {
            } else if (mode == 0.0) {
                while ((tau = first_zero(q, 3, psi0, tau, d)) < d) {
                    const Oscillation::Point p = q.at(tau);
                    flight = smaller(flight, a - fabs(law.full * (p.h2 + p.z2) - b));
                }
            } else if (a > 0.0) {
                if (event == SLIP) {  // w' = w'' = 0 at the start of a slip: go as far as m w''' keeps its sign
                    const double bound = q.driven(4) + q.own(4, 0.0);
                    if (bound > 0.0) tau = smaller(fabs(jerk) / bound, 0.5 * d);
                }
                if (event != TURN || mode * push > a)  // else the turn's own margin says it
                    flight = slowest(q, mode, strength, tau, d);
            } else {
                while ((tau = first_zero(q, 1, psi0, tau, d)) < d)
                    flight = smaller(flight, 1.0 - fabs(law.after(q, q.at(tau), from, mode, tau).w));
            }
            double* margin = out + 4 * i;
            margin[0] = flight;
            margin[2] = event >= TURN ? 1.0 - fabs(x[1]) : HUGE_VAL;
            if (event == TURN) margin[1] = -mode_before(c, i) * push - a;
            else if (event == STICK) margin[1] = a - fabs(push);
            else if (event == SLIP) margin[1] = mode * jerk;  // w''' of the slide that begins
            margin[3] = d;
            // the wall's reaction: w'+ = -r w'-, and B+ = v' - w'+
            const double* next = inner ? x + 4 : u;
            const double rate = (inner ? 1.0 : c.twist) * (next[1] - next[3]);
            if (arrival < TURN) out[4 * (inner ? i + 1 : 0) + 1] = (1.0 - 2.0 * double(arrival)) * rate / law.r;
        }
    }
};

}  // namespace cycles
