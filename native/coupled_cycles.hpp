// Elementary maps of the absorber on its oscillator between consecutive events, with exact derivatives, and margins. A node is
// (Psi, B+, v, v') at an impact and (Psi, w, v, v') at a turn, stick or slip; v = q1 + eps q2, w = q1 - q2, B = v' - w' = (1 + eps) q2'.
// The reference with all docstrings: orbits/machines/coupled/maps.py, margins.py and flow.py. Parameters in order: forcing G, frequency
// Omega, damping lambda, mass_ratio eps, restitution r, friction mu, gravity g, excitation chi.
#pragma once
#include "cycles.hpp"

namespace cycles {

struct CoupledCycles {
    struct Harmonic { double X, Y; };
    // Response of an oscillator to a moving base: force (sin Psi + excitation drag cos Psi) -> X sin Psi + Y cos Psi.
    static Harmonic harmonic(double force, double excitation, double drag, double stiffness) {
        double size = stiffness * stiffness + drag * drag;
        if (force == 0.0) return {0.0, 0.0};
        if (size == 0.0) return {HUGE_VAL, HUGE_VAL};
        double scale = force / size;
        return {scale * (stiffness + excitation * drag * drag), scale * drag * (excitation * stiffness - 1.0)};
    }
    struct Rates { double alpha, beta; };  // decay rate and angular frequency of mass z'' + drag z' + z = 0; NaN when overdamped
    static Rates rates(double mass, double drag) {
        double alpha = 0.5 * drag / mass, square = 1.0 / mass - alpha * alpha;
        return {alpha, square <= 0.0 ? NAN : sqrt(square)};
    }

    struct Response { double X, Y, alpha, beta, dX, dY, d_alpha, d_beta; };
    static Response response(const double* par, const double* slope, double mass, double d_mass) {
        double omega = par[1], lam = par[2], eps = par[3], chi = par[7], rate = eps * lam, d_rate = slope[3] * lam + eps * slope[2];
        double drag = rate * omega, d_drag = d_rate * omega + rate * slope[1], stiffness = 1.0 - mass * omega * omega;
        double d_stiffness = -(d_mass * omega + 2.0 * mass * slope[1]) * omega, force = eps * par[0], d_force = slope[3] * par[0] + eps * slope[0];
        auto [X, Y] = harmonic(force, chi, drag, stiffness);
        auto [alpha, beta] = rates(mass, rate);
        // (K + i c)(X + i Y) = f (1 + i chi c)
        double real = d_force - X * d_stiffness + Y * d_drag;
        double imag = d_force * chi * drag + force * (slope[7] * drag + chi * d_drag) - Y * d_stiffness - X * d_drag;
        double size = stiffness * stiffness + drag * drag, d_alpha = 0.5 * d_rate / mass - alpha * d_mass / mass;
        return {X, Y, alpha, beta, (real * stiffness + imag * drag) / size, (imag * stiffness - real * drag) / size, d_alpha,
                (-0.5 * d_mass / (mass * mass) - alpha * d_alpha) / beta};
    }

    // A quantity at the end of a flight: its value and its derivatives by Psi_0, y_0, v_0, v_0', Psi_1 and the parameter.
    // Duration below which a difference quotient loses more to rounding than its first two terms leave out: the root of the rounding.
    static constexpr double SHORT = 0x1p-26;

    struct Row {
        double value, psi0, y, v, vr, psi1, p;
        friend Row operator+(Row a, Row b) { return {a.value + b.value, a.psi0 + b.psi0, a.y + b.y, a.v + b.v, a.vr + b.vr, a.psi1 + b.psi1, a.p + b.p}; }
        friend Row operator-(Row a, Row b) { return {a.value - b.value, a.psi0 - b.psi0, a.y - b.y, a.v - b.v, a.vr - b.vr, a.psi1 - b.psi1, a.p - b.p}; }
        friend Row operator*(double f, Row a) { return {f * a.value, f * a.psi0, f * a.y, f * a.v, f * a.vr, f * a.psi1, f * a.p}; }
    };
    static void put(Workspace& work, whole i, int row, const Row& r, double target, double d_p) {  // F, A, D, Q of one equation
        double *A = work.A + 16 * i + 4 * row, *D = work.D + 16 * i + 4 * row;
        work.F[4 * i + row] = r.value - target;
        A[0] = r.psi0, A[1] = r.y, A[2] = r.v, A[3] = r.vr;
        D[0] = r.psi1, D[1] = 0.0, D[2] = 0.0, D[3] = 0.0;
        if (row > 0) D[row] = -1.0;
        work.Q[4 * i + row] = r.p + d_p;
    }

    static double linearise(const Cycle& c, const double* u, Workspace& work) {
        const double *par = work.numbers, *slope = par + c.parameters;
        const whole length = c.length;
        const double G = par[0], omega = par[1], lam = par[2], eps = par[3], r = par[4], mu = par[5], g = par[6], chi = par[7];
        const double all = 1.0 + eps, part = 1.0 / all, rate = eps * lam, force = eps * G, friction = mu * g;  // acceleration of the absorber
        const double d_friction = mu * slope[6] + g * slope[5], d_omega = slope[1], d_eps = slope[3], d_r = slope[4];
        const double d_rate = d_eps * lam + eps * slope[2], d_force = d_eps * G + eps * slope[0];
        const double d_lever = slope[7] * rate * omega + chi * (d_rate * omega + rate * d_omega);  // of chi eps lambda Omega
        const double by_omega = 1.0 / omega;
        const Response slide = response(par, slope, 1.0, 0.0);
        Response stuck = slide;
        for (whole i = 0; i < length; i++)
            if (c.modes[i] == 0) {
                stuck = response(par, slope, all, d_eps);
                break;
            }
        double *sines = work.sines, *cosines = work.cosines;
        for (whole i = 0; i < length; i++) sine_cosine(u[4 * i], sines[i], cosines[i]);
        sines[length] = c.twist * sines[0], cosines[length] = c.twist * cosines[0];
        double largest = 0.0;
        for (whole i = 0; i < length; i++) {
            const whole event = c.events[i], arrival = arrival_of(c, i);
            const double mode = double(c.modes[i]), after = mode_after(c, i), *x = u + 4 * i;
            const double psi0 = x[0], y0 = x[1], v0 = x[2], v0_rate = x[3];
            const bool inner = i + 1 < length;
            const double psi1 = inner ? x[4] : u[0] + c.shift, y1 = inner ? x[5] : c.twist * u[1];
            const double v1 = inner ? x[6] : c.twist * u[2], v1_rate = inner ? x[7] : c.twist * u[3];
            const double s0 = sines[i], c0 = cosines[i], s1 = sines[i + 1], c1 = cosines[i + 1];
            const auto [X, Y, alpha, beta, dX, dY, d_alpha, d_beta] = mode != 0.0 ? slide : stuck;
            const double kappa = alpha * alpha + beta * beta, d = (psi1 - psi0) * by_omega;
            // the start: node -> (q1, q1', q2, q2') and its derivatives
            double w0 = y0, q2_rate = v0_rate * part, q1_rate = q2_rate, q1_y = eps * part, q2_y = -part, q1r_y = 0.0, q2r_y = 0.0;
            double q1r_vr = part, q2r_vr = part, dq1r = -d_eps * q1_rate * part;
            if (event < TURN) {
                w0 = 1.0 - 2.0 * double(event), q2_rate = y0 * part, q1_rate = v0_rate - eps * q2_rate;
                q1_y = 0.0, q2_y = 0.0, q1r_y = -eps * part, q2r_y = part, q1r_vr = 1.0, q2r_vr = 0.0;
                dq1r = -d_eps * (q2_rate - eps * q2_rate * part);
            }
            const double q1 = (v0 + eps * w0) * part, q2 = (v0 - w0) * part;
            const double dq1 = -d_eps * q2 * part, dq2 = dq1, dq2r = -d_eps * q2_rate * part;
            // the oscillator
            const double offset = -eps * mode * friction, d_offset = -mode * (d_eps * friction + eps * d_friction);
            const double z = q1 - X * s0 - Y * c0 - offset, zr = q1_rate - omega * (X * c0 - Y * s0);
            double sb, cb;
            sine_cosine(beta * d, sb, cb);
            const double decay = exponential(-alpha * d), Cn = decay * cb, S = decay * sb / beta;
            const double T11 = Cn + alpha * S, T12 = S, T21 = -kappa * S, T22 = Cn - alpha * S;
            const double Z = T11 * z + T12 * zr, Zr = T21 * z + T22 * zr, Zrr = -2.0 * alpha * Zr - kappa * Z;
            const double h1 = X * s1 + Y * c1, h1r = omega * (X * c1 - Y * s1);
            const double Q1r_ = Zr + h1r, Q1rr = Zrr - omega * omega * h1;
            const double q1_acceleration = -2.0 * alpha * zr - kappa * z - omega * omega * (X * s0 + Y * c0);
            // derivatives with respect to the parameter at fixed nodes
            const double dd = -d * by_omega * d_omega, dz = dq1 - dX * s0 - dY * c0 - d_offset;
            const double dzr = dq1r - omega * (dX * c0 - dY * s0) - d_omega * (X * c0 - Y * s0), lag = (d * Cn - S) / beta;
            const double dQ1 = T11 * dz + T12 * dzr + Zr * dd + dX * s1 + dY * c1 + d_offset + d_alpha * (z * S - d * Z) +
                               d_beta * ((zr + alpha * z) * lag - d * beta * z * S);
            const double dQ1r = T21 * dz + T22 * dzr + Zrr * dd + omega * (dX * c1 - dY * s1) + d_omega * (X * c1 - Y * s1) -
                                d_alpha * (d * Zr + (zr + 2.0 * alpha * z) * S) -
                                d_beta * (d * beta * zr * S + (alpha * zr + kappa * z) * lag + 2.0 * beta * z * S);
            const Row Q1 = {Z + h1 + offset, -(T11 * q1_rate + T12 * q1_acceleration) * by_omega, T11 * q1_y + T12 * q1r_y, T11 * part,
                            T12 * q1r_vr, Q1r_ * by_omega, dQ1};
            const Row Q1r = {Q1r_, -(T21 * q1_rate + T22 * q1_acceleration) * by_omega, T21 * q1_y + T22 * q1r_y, T21 * part,
                             T22 * q1r_vr, Q1rr * by_omega, dQ1r};
            // the absorber
            Row Q2 = Q1, Q2r = Q1r;
            if (mode != 0.0) {
                const double a = mode * friction, rate2 = q2_rate + a * d;
                Q2r = {rate2, -a * by_omega, q2r_y, 0.0, q2r_vr, a * by_omega, dq2r + a * dd + mode * d_friction * d};
                Q2 = {q2 + (q2_rate + 0.5 * a * d) * d, -rate2 * by_omega, q2_y + d * q2r_y, part, d * q2r_vr, rate2 * by_omega,
                      dq2 + dq2r * d + rate2 * dd + 0.5 * mode * d_friction * d * d};
            } else Q2.value -= w0, Q2.y -= 1.0;
            put(work, i, 2, Q1 + eps * Q2, v1, d_eps * Q2.value);
            put(work, i, 3, Q1r + eps * Q2r, v1_rate, d_eps * Q2r.value);
            // what ends the segment
            if (arrival < TURN) {
                put(work, i, 0, Q1 - Q2, 1.0 - 2.0 * double(arrival), 0.0);
                // v' + r w' = (1 + r) q1' + (eps - r) q2'
                put(work, i, 1, (1.0 + r) * Q1r + (eps - r) * Q2r, y1, d_eps * Q2r.value + d_r * (Q1r.value - Q2r.value));
            } else {
                put(work, i, 1, Q1 - Q2, y1, 0.0);
                if (arrival == SLIP) {  // friction gives way: v'' = -q1 - eps lambda q1' + e + eps lambda e' reaches m a
                    const double base = s1 + chi * rate * omega * c1;
                    Row push = -1.0 * Q1 - rate * Q1r;
                    push.value += force * base;
                    push.psi1 += force * (c1 - chi * rate * omega * s1);
                    put(work, i, 0, push, after * all * friction,
                        -d_rate * Q1r.value + d_force * base + force * d_lever * c1 - after * (d_eps * friction + all * d_friction));
                } else if (event < TURN || mode == 0.0) {
                    put(work, i, 0, Q1r - Q2r, 0.0, 0.0);
                } else if (fabs(d) < SHORT) {  // from rest to rest, hardly apart: the second derivative of w and half of the third times d
                    const double base = s0 + chi * rate * omega * c0, base_psi = c0 - chi * rate * omega * s0;
                    const double jerk = force * omega * base_psi - q1_rate - rate * q1_acceleration, half = 0.5 * jerk * by_omega;
                    const double dq1_acceleration = d_force * base + force * d_lever * c0 + d_offset - dq1 - d_rate * q1_rate - rate * dq1r;
                    put(work, i, 0,
                        {q1_acceleration - mode * friction + 0.5 * jerk * d, force * base_psi - half, -q1_y - rate * q1r_y, -part,
                         -rate * q1r_vr, half, dq1_acceleration - mode * d_friction + 0.5 * jerk * dd},
                        0.0, 0.0);
                } else {  // from rest to rest: the mean of w'' over the flight, w'/d, so that no flight of no duration solves it
                    double sm, cm;
                    sine_cosine(0.5 * (psi1 + psi0), sm, cm);
                    const double small = sine(0.5 * beta * d);
                    const double loss = exponential_less_one(-alpha * d) * cb - 2.0 * small * small - alpha * S;  // T22 - 1
                    const double swing = 2.0 * omega * sine(0.5 * (psi1 - psi0)) * (X * sm + Y * cm), by_d = 1.0 / d;
                    const double mean = (T21 * z + loss * zr - swing) * by_d - mode * friction;
                    Row speed = Q1r - Q2r;
                    speed.psi0 += mean * by_omega, speed.psi1 -= mean * by_omega, speed.p -= mean * dd;
                    speed = by_d * speed;
                    speed.value = mean, speed.vr = loss * part * by_d;
                    put(work, i, 0, speed, 0.0, 0.0);
                }
            }
            const double* F = work.F + 4 * i;
            double size = larger(larger(fabs(F[0]), fabs(F[1])), larger(fabs(F[2]), fabs(F[3])));
            if (!(size <= largest)) largest = size;
        }
        if (c.pinned && c.twist > 0.0) largest = larger(largest, pin(c, u, work));
        return largest;
    }

    // Replace the displacement equation of the last flight by w_i + w_{i+1} = 0; returns by how much the mean position is off.
    static double pin(const Cycle& c, const double* u, Workspace& work) {
        whole last = last_flight(c);
        double *A = work.A + 16 * last + 4, *D = work.D + 16 * last + 4, &F = work.F[4 * last + 1];
        for (int k = 0; k < 4; k++) work.pin[k] = A[k], work.pin[4 + k] = D[k], A[k] = 0.0, D[k] = 0.0;
        work.pin[8] = F;
        A[1] = 1.0, D[1] = 1.0, work.Q[4 * last + 1] = 0.0;
        F = u[4 * last + 1] + (last + 1 < c.length ? u[4 * last + 5] : u[1]);
        return fabs(F);
    }
    static void unpin(const Cycle& c, Workspace& work) {
        if (!c.pinned || !(c.twist > 0.0)) return;
        whole last = last_flight(c);
        for (int k = 0; k < 4; k++) work.A[16 * last + 4 + k] = work.pin[k], work.D[16 * last + 4 + k] = work.pin[4 + k];
    }

    // ---- margins ----------------------------------------------------------------------------------------------------------------
    // A sum c + P sin Psi + Q cos Psi + exp(-alpha tau) (A cos beta tau + B sin beta tau), tau from the phase `phase` on.
    struct Wave {
        double constant, P, Q, A, B, omega, alpha, beta, phase;
        void at(double tau, double& value, double& slope) const {
            double s, c, sb, cb, decay = exponential(-alpha * tau);
            sine_cosine(phase + omega * tau, s, c), sine_cosine(beta * tau, sb, cb);
            double C = decay * cb, S = decay * sb;
            value = constant + P * s + Q * c + A * C + B * S;
            slope = omega * (P * c - Q * s) + (beta * B - alpha * A) * C - (beta * A + alpha * B) * S;
        }
        Wave derivative() const { return {0.0, -omega * Q, omega * P, beta * B - alpha * A, -beta * A - alpha * B, omega, alpha, beta, phase}; }
    };
    // Time for which y > 0 stays positive when |y''| <= bound: the zero of y + y' h - bound h^2/2.
    static double certain(double y, double y_rate, double bound) {
        double root = sqrt(y_rate * y_rate + 2.0 * bound * y);
        return y_rate > 0.0 ? (root + y_rate) / bound : 2.0 * y / (root - y_rate);
    }
    // First zero of a wave in start < tau < end; `end` when there is none. Steps as long as is certain never jump over one.
    static double first_zero(const Wave& w, double start, double end) {
        double bound = w.omega * w.omega * hypotenuse(w.P, w.Q) + (w.alpha * w.alpha + w.beta * w.beta) * exponential(-w.alpha * start) * hypotenuse(w.A, w.B);
        double tiny = 4e-16 * (fabs(w.constant) + fabs(w.P) + fabs(w.Q) + fabs(w.A) + fabs(w.B)), tau = start, value, slope;
        if (bound <= 1e-300) return end;
        w.at(tau, value, slope);
        if (fabs(value) <= tiny + 1e-15 * (1.0 + start + fabs(w.phase)) * fabs(slope)) {
            // leave the zero at the start: the slope decides the sign until 2 slope / bound
            tau += larger(fabs(slope) / bound, 1e-8);
            if (tau >= end) return end;
            w.at(tau, value, slope);
        }
        double sign = value > 0.0 ? 1.0 : -1.0;
        while (true) {
            double y = sign * value;
            if (y <= tiny) return tau;
            double step = certain(y, sign * slope, bound);
            if (step <= 2e-16 * (1.0 + tau)) return tau;
            tau += step;
            if (!(tau < end)) return end;
            w.at(tau, value, slope);
        }
    }
    // Smallest s w' at an interior minimum on start < tau < end of a slide, infinity if there is none.
    static double slowest(double s, double pull, double q2_rate, double h0, double h1, double z0, double z1, double omega, double alpha, double beta,
                          double force, double start, double end) {
        double square = omega * omega, kappa = alpha * alpha + beta * beta, smallest = HUGE_VAL, tau = start, bound = -1.0;
        while (true) {
            double sw, cw, sb, cb, decay = exponential(-alpha * tau);
            sine_cosine(omega * tau, sw, cw), sine_cosine(beta * tau, sb, cb);
            double H0 = h0 * cw + h1 / omega * sw, H1 = h1 * cw - omega * h0 * sw, C = decay * cb, S = decay * sb / beta;
            double Z1 = z1 * C - (alpha * z1 + kappa * z0) * S, Z2 = -2.0 * alpha * Z1 - kappa * (z0 * C + (z1 + alpha * z0) * S);
            double Z3 = -2.0 * alpha * Z2 - kappa * Z1, y = s * (Z2 - square * H0) - pull, slope = s * (Z3 - square * H1);
            if (bound < 0.0) {
                double fourth = square * square * H0 - 2.0 * alpha * Z3 - kappa * Z2;
                double fifth = square * square * H1 + 2.0 * alpha * (2.0 * alpha * Z3 + kappa * Z2) - kappa * Z3;
                double growth = square * square * force * (end - start) / sqrt(kappa);
                bound = sqrt(fourth * fourth + fifth * fifth / kappa) + growth;
                if (!(bound > 1e-300)) return smallest;
            }
            double sign = y > 0.0 ? 1.0 : -1.0, step = certain(fabs(y), sign * slope, bound);
            if (step < 1e-5) {
                double zero = sign * slope < 0.0 ? -y / slope : 0.0;
                if (tau + zero >= end) return smallest;
                if (slope > 0.0) {
                    double speed = s * (H1 + Z1 - q2_rate) - pull * tau;
                    smallest = smaller(smallest, speed + (y + 0.5 * slope * zero) * zero);
                }
                step = zero + larger(fabs(slope) / bound, 1e-5);
            }
            tau += step;
            if (!(tau < end)) return smallest;
        }
    }

    static void margins(const Cycle& c, const double* u, Workspace& work, double* out) {
        const double* par = work.numbers;
        const whole length = c.length;
        const double G = par[0], omega = par[1], lam = par[2], eps = par[3], r = par[4], friction = par[5] * par[6], chi = par[7];
        const double all = 1.0 + eps, rate = eps * lam, force = eps * G, a = all * friction, square = omega * omega;
        const Harmonic slide = harmonic(force, chi, rate * omega, 1.0 - square), stuck = harmonic(force, chi, rate * omega, 1.0 - all * square);
        const Rates slide_rates = rates(1.0, rate), stuck_rates = rates(all, rate);
        const double strength = force * sqrt(1.0 + chi * chi * rate * rate * square);
        for (whole i = 0; i < length; i++) {
            const whole event = c.events[i], arrival = arrival_of(c, i);
            const double mode = double(c.modes[i]), *x = u + 4 * i, psi0 = x[0], y0 = x[1], v0 = x[2], v0_rate = x[3];
            const bool inner = i + 1 < length;
            const double psi1 = inner ? x[4] : u[0] + c.shift, y1 = inner ? x[5] : c.twist * u[1], v1_rate = inner ? x[7] : c.twist * u[3];
            const double s0 = work.sines[i], c0 = work.cosines[i], d = (psi1 - psi0) / omega;
            double w0 = y0, q2_rate = v0_rate / all, q1_rate = q2_rate;
            if (event < TURN) w0 = 1.0 - 2.0 * double(event), q2_rate = y0 / all, q1_rate = v0_rate - eps * q2_rate;
            const double q1 = (v0 + eps * w0) / all, push = -q1 - rate * q1_rate + force * (s0 + chi * rate * omega * c0);  // v''
            const auto [X, Y] = mode != 0.0 ? slide : stuck;
            const auto [alpha, beta] = mode != 0.0 ? slide_rates : stuck_rates;
            const double offset = -eps * mode * friction, h0 = X * s0 + Y * c0, h1 = omega * (X * c0 - Y * s0), z0 = q1 - h0 - offset, z1 = q1_rate - h1;
            const Wave position = {offset, X, Y, z0, (z1 + alpha * z0) / beta, omega, alpha, beta, psi0};
            Wave speed = position.derivative();
            const Wave acceleration = speed.derivative(), jerk = acceleration.derivative();
            double flight = HUGE_VAL, tau = 0.0, value, slope;
            if (!(d > 0.0)) {
            } else if (mode == 0.0) {
                while ((tau = first_zero(jerk, tau, d)) < d) {
                    acceleration.at(tau, value, slope);
                    flight = smaller(flight, a - all * fabs(value));
                }
            } else if (a > 0.0) {
                if (event == SLIP) {  // w' = w'' = 0 at the start of a slip: go as far as m w''' keeps its sign
                    double bound = square * hypotenuse(acceleration.P, acceleration.Q) + (alpha * alpha + beta * beta) * hypotenuse(acceleration.A, acceleration.B);
                    if (bound > 0.0) tau = smaller(fabs(jerk.P * s0 + jerk.Q * c0 + jerk.A) / bound, 0.5 * d);
                }
                if (event != TURN || mode * push > a)  // else the turn's own margin says it
                    flight = slowest(mode, friction, q2_rate, h0, h1, z0, z1, omega, alpha, beta, strength, tau, d);
            } else {
                speed.constant = -q2_rate;
                while ((tau = first_zero(speed, tau, d)) < d) {
                    position.at(tau, value, slope);
                    flight = smaller(flight, 1.0 - fabs(w0 - q1 + value - q2_rate * tau));
                }
            }
            double* margin = out + 4 * i;
            margin[0] = flight;
            margin[2] = event >= TURN ? 1.0 - fabs(y0) : HUGE_VAL;
            if (event == TURN) margin[1] = -mode_before(c, i) * push - a;
            else if (event == STICK) margin[1] = a - fabs(push);
            else if (event == SLIP) margin[1] = mode * (jerk.P * s0 + jerk.Q * c0 + jerk.A);  // w''' of the slide that begins
            margin[3] = d;
            // the wall's reaction: w'+ = -r w'-, and B+ = v' - w'+
            if (arrival < TURN) out[4 * (inner ? i + 1 : 0) + 1] = (1.0 - 2.0 * double(arrival)) * (y1 - v1_rate) / r;
        }
    }
};

}  // namespace cycles
