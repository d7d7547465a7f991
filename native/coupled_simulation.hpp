// Event-driven simulation of the absorber on its oscillator.
//
// In the direction s of the sliding let y = s w' > 0 and y' = s w''. With M >= |w'''| ahead, y stays positive for at least
//
//     h = 2 y / (sqrt(y'^2 + 2 M y) - y'),
//
// and w is monotone for as long as y is positive: inside such a step the wall ahead is met exactly when it has been passed at the end
// of it, and steps towards a turn approach it from one side like Newton's method. So no hit and no turn can be missed. The slip is
// found in the same way from a - |v'' - b| > 0, b being the acceleration down a slope.
//
// M comes from the energy of the third derivative u = q1''', which is itself an oscillator's response to a force of amplitude
// f = Omega^3 eps G sqrt(1 + (eps lambda Omega)^2): sqrt(u^2 + u'^2/kappa) grows by at most f/sqrt(kappa) per unit of time.
//
// Close to the start of a leg differences are taken from the Taylor series, and positions are kept with the digits below their
// roundoff, so that flights, turns and impacts keep their relative accuracy however small they are.
#pragma once
#include "coupled.hpp"
#include "stepping.hpp"

namespace simulation {

using coupled::certain;
using Oscillation = coupled::Oscillation<double>;
using Motion = coupled::Motion<double>;

struct Coupled : coupled::Law<double> {
    static constexpr int STATE = 8, ROW = 7;
    static constexpr double HORIZON = 2.5;  // M is renewed after this time

    double force;

    explicit Coupled(const double *p) : Law(p), force(strength()) {}

    static Motion motion(const double *x) { return {x[W], x[MODE] != 0.0 ? x[RATE] : 0.0, x[V], x[V_RATE]}; }
    Oscillation oscillation(const double *x) const { return Law::oscillation(x[PSI], motion(x), x[MODE]); }

    // Reduce the phase and set the mode of a start.
    void launch(double *state) const {
        carry(state[PSI], state[TURNS]);
        double sin_psi, cos_psi, w = state[W], rate = state[RATE];
        sine_cosine(state[PSI], sin_psi, cos_psi);
        double push = Law::push({w, rate, state[V], state[V_RATE]}, sin_psi, cos_psi) - b;  // against friction
        if (push == 0.0 && a == 0.0)  // the third derivative decides
            push = eps * G * omega * (cos_psi - chi * drag * omega * sin_psi) - state[V_RATE] / full - drag * lean;
        if (rate != 0.0) state[MODE] = rate > 0.0 ? 1.0 : -1.0;
        else if ((fabs(push) <= a && a > 0.0) || (fabs(w) == 1.0 && push * w >= 0.0)) state[MODE] = 0.0;
        else state[MODE] = push >= 0.0 ? 1.0 : -1.0;
    }

    // How a leg ends.
    enum Outcome { TIME_IS_OVER, HIT, HALT, SLIPS, NEVER };

    // While the absorber sticks: the time until friction no longer holds it, and in which direction it then goes.
    Outcome wait(const Oscillation& q, double w, double left, double& tau, Oscillation::Point& p, double& way) const {
        const double driven = full * q.driven(2), own = full * q.own(2, 0.0), tiny = 4e-16 * (driven + own + fabs(b));  // bounds of |v''|
        const double hold = w >= 1.0 ? a - b : w <= -1.0 ? a + b : a - fabs(b);  // what holds the absorber where it may slip
        p = q.begin();
        bool first = true;  // a zero right at the start is judged by its slope, and left behind
        double renew = -1.0, M = 0.0;
        tau = 0.0;
        while (tau < left) {
            if (tau >= renew) {
                if (driven + own * exponential(-q.alpha * tau) < hold || (driven + own == 0.0 && hold >= 0.0)) return NEVER;
                double u4 = q.fourth(p), u5 = q.fifth(p);
                M = full * (sqrt(u4 * u4 + u5 * u5 * q.by_kappa) + square * square * force * HORIZON);
                renew = tau + HORIZON;
            }
            double value = full * (p.h2 + p.z2), slope = full * (p.h3 + p.z3), step = renew - tau;
            for (double m = 1.0; m >= -1.0; m -= 2.0) {
                if (m * w >= 1.0) continue;
                double y = a - m * (value - b), y_rate = -m * slope;
                way = m;
                if (y <= tiny) {
                    if (!first || y_rate < 0.0 || y < -tiny) return SLIPS;
                    double ahead = M > 0.0 ? y_rate / M : step;
                    step = least(step, most(ahead, 1e-9));
                } else {
                    double ahead = M > 0.0 || y_rate < 0.0 ? certain(y, y_rate, M) : step;
                    step = least(step, ahead);
                    if (ahead < 2.3e-16 * (1.0 + tau)) return SLIPS;
                }
            }
            first = false;
            tau = least(step < renew - tau ? tau + step : renew, left);
            p = q.at(tau);
        }
        return TIME_IS_OVER;
    }

    // While it slides: the time until it hits the wall ahead or comes to a halt; y = s w' and its rate there, the way slid.
    Outcome slip(const Oscillation& q, double s, double Y0, double Y1, double target, double left, double& tau, Oscillation::Point& p,
                 double& y, double& y_rate, double& gain) const {
        const double third = square * omega * force * HORIZON * sqrt(q.by_kappa), tiny = 1e-300, brake = s * q.q2_pull;
        double renew = -1.0, M = 0.0;
        tau = gain = 0.0;
        y = Y0;
        y_rate = Y1;
        if (target <= 0.0) return HIT;
        auto look = [&] {
            p = q.at(tau);
            gain = s * (p.way - q.travel(tau));
            y = Y0 + s * p.speed - brake * tau;
            y_rate = s * (p.h2 + p.z2) - brake;
        };
        for (;;) {
            if (tau >= renew) {
                double u3 = p.h3 + p.z3, u4 = q.fourth(p);
                M = sqrt(u3 * u3 + u4 * u4 * q.by_kappa) + third;
                renew = tau + HORIZON;
            }
            double step;
            if (y <= tiny) {
                if (tau > 0.0) return HALT;
                // from rest: y' or, after a slip, y'' opens the flight
                double jerk = s * (p.h3 + p.z3), u4 = q.fourth(p), u5 = q.fifth(p);
                double M4 = sqrt(u4 * u4 + u5 * u5 * q.by_kappa) + omega * third;
                step = most(M > 0.0 ? y_rate / M : 0.0, M4 > 0.0 ? 1.5 * jerk / M4 : 0.0);
                if (M == 0.0 && M4 == 0.0 && !(y_rate > 0.0)) return NEVER;  // neither friction, slope nor forcing: nothing moves
                if (!(step > 1e-13)) step = 1e-13;  // hardly any acceleration in this direction
            } else {
                step = M > 0.0 || y_rate < 0.0 ? certain(y, y_rate, M) : HUGE_VAL;
                if (step < 2.3e-16 * tau) return HALT;
                if (step > 2.0 * target / y + 0.5) step = 2.0 * target / y + 0.5;  // far beyond the wall
            }
            double before = tau;
            tau = least(step < renew - tau ? tau + step : renew, left);
            look();
            if (gain >= target) {
                double lo = before, hi = tau;
                for (int k = 0; k < 60; k++) {
                    double miss = gain - target, bottom = 2.0 * y * y - miss * y_rate;
                    if (miss >= 0.0) hi = tau; else lo = tau;
                    step = bottom > 0.0 ? 2.0 * miss * y / bottom : HUGE_VAL;
                    double next = tau - step;
                    if (!(lo < next && next < hi)) {
                        if (fabs(step) <= 4.5e-16 * tau) break;
                        next = 0.5 * (lo + hi);
                    }
                    double change = fabs(next - tau);
                    tau = next;
                    look();
                    if ((change <= 1e-6 * tau && change * change * fabs(y_rate) <= 1e-16 * y * tau) || hi - lo <= 2.3e-16 * hi) {
                        step = y > 0.0 ? (gain - target) / y : 0.0;  // one Newton step more, from values at hand
                        if (fabs(step) < change) {
                            tau -= step;
                            p.way -= step * (p.speed + q.h1 + q.z1);
                            p.speed -= step * (p.h2 + p.z2);
                            y -= step * y_rate;
                        }
                        break;
                    }
                }
                return HIT;
            }
            if (tau >= left) return TIME_IS_OVER;
        }
    }

    Status advance(double *state, double until, Events& events) const {
        double psi = state[PSI], w = state[W], rate = state[RATE], s = state[MODE], turns = state[TURNS], low = state[LOW];
        double v = state[V], v_rate = state[V_RATE];
        double check = psi + w + rate + v + v_rate + slide.X + slide.Y + stuck.X + stuck.Y + slide.beta + stuck.beta + a + b;
        if (!isfinite(check)) return FAILED;
        // by forcing periods and by periods of the oscillator, whichever are longer
        const double goal = least(until, turns + least(SLICE, SLICE * omega));
        bool fresh = false;  // the leg starts with a slip: w' = w'' = 0
        int idle = 0;  // legs in a row without progress
        Status status = EVENTS_FULL;
        auto add = [&](Code code, double before, double after) {
            double *row = events.add(ROW, code, s, psi, turns, w, before, after);
            row[5] = v;
            row[6] = v_rate;
        };
        while (!events.full()) {
            const double left = ((goal - turns) * TWO_PI - psi) / omega, rest_of_time = ((until - turns) * TWO_PI - psi) / omega;
            if (!(left > 0.0)) { status = TIME_REACHED; break; }
            double tau;
            Oscillation::Point p;
            if (s == 0.0) {  // at rest on the floor, or against a wall
                const Oscillation q = Law::oscillation(psi, {w, 0.0, v, v_rate}, 0.0);
                double way = 0.0;
                Outcome outcome = wait(q, w, left, tau, p, way);
                if (outcome == NEVER) p = q.at(tau = rest_of_time);
                if (tau > 0.0) {
                    v += full * p.way;
                    v_rate += full * p.speed;
                    psi += omega * tau;
                    carry(psi, turns);
                }
                rate = 0.0;
                if (outcome != SLIPS) { status = outcome == NEVER ? AT_REST : TIME_REACHED; break; }
                s = way;
                fresh = true;
                if (a > 0.0 || fabs(w) == 1.0) add(SLIP, 0.0, 0.0);
                continue;
            }
            const Oscillation q = Law::oscillation(psi, {w, rate, v, v_rate}, s);
            p = q.begin();
            double Y0 = s * rate, Y1 = fresh ? 0.0 : s * (p.h2 + p.z2) - s * q.q2_pull;
            if (Y0 < 1e-6 && s * w == -1.0 && low == 0.0 && Y1 + 2.0 * a < 0.0) {
                // leaving a wall that is pushed after the absorber: is this the tail of a chatter?
                double shove = -Y1 - a, factor = r * sqrt((shove - a) / (shove + a));  // shove: |v'' - b|
                double rest = Y0 * (1.0 / (shove + a) + 1.0 / sqrt((shove - a) * (shove + a)));
                if (factor < 1.0) rest /= 1.0 - factor;
                if ((factor < 1.0 && rest < 1e-7 && rest * fabs(p.h3 + p.z3) < 0.01 * (shove - a)) || Y0 < 1e-13) {
                    rest = least(rest, 1e-7);
                    v += rest * v_rate;
                    v_rate += rest * (b - s * shove);
                    psi += omega * rest;
                    carry(psi, turns);
                    rate = s = 0.0;
                    add(HOLD, 0.0, 0.0);
                    continue;
                }
            }
            double y, y_rate, gain;
            Outcome outcome = slip(q, s, Y0, Y1, (1.0 - s * w) - s * low, left, tau, p, y, y_rate, gain);
            if (outcome == NEVER) tau = rest_of_time;
            fresh = false;
            idle = tau < 1e-11 ? idle + 1 : 0;
            if (idle > 10000) { status = FAILED; break; }
            v += p.way + eps * q.travel(tau);
            v_rate += p.speed + eps * q.q2_pull * tau;
            psi += omega * tau;
            carry(psi, turns);
            if (outcome == HIT) {
                if (!(y > 1e-30)) y = 1e-30;
                w = s;
                low = 0.0;
                rate = -s * r * y;
                s = -s;
                add(s < 0.0 ? HIT_LEFT : HIT_RIGHT, -s * y, rate);
                continue;
            }
            shift(w, low, s * gain);
            if (fabs(w) > 1.0 || (fabs(w) == 1.0 && w * low > 0.0)) { w = copysign(1.0, w); low = 0.0; }
            if (outcome != HALT) {
                rate = y > 0.0 ? s * y : 0.0;
                status = outcome == NEVER ? AT_REST : TIME_REACHED;
                break;
            }
            rate = 0.0;
            if (a == 0.0) { s = -s; continue; }  // nothing happens where w' passes zero
            bool turns_back = y_rate < -2.0 * a;
            s = turns_back ? -s : 0.0;
            add(turns_back ? TURN : STICK, 0.0, 0.0);
        }
        if (!(isfinite(psi) && isfinite(w) && isfinite(rate) && isfinite(v))) status = FAILED;
        const double now[STATE] = {psi, w, rate, s, turns, low, v, v_rate};
        for (int i = 0; i < STATE; i++) state[i] = now[i];
        return status == TIME_REACHED && goal < until ? PAUSED : status;
    }

    double cavity_speed(const double *state) const { return state[V_RATE]; }

    // w, w', v, v' at a phase after a state.
    void sample(const double *state, double ahead, double *out) const {
        const Oscillation q = oscillation(state);
        const double t = ahead / omega;
        const Motion x = after(q, q.at(t), motion(state), state[MODE], t, state[LOW]);
        out[0] = x.w, out[1] = x.rate, out[2] = x.v, out[3] = x.v_rate;
    }

    // Positive half of the Gauss-Legendre rule with 16 nodes.
    static constexpr int HALF = 8;
    static constexpr double NODES[HALF] = {0.09501250983763744, 0.2816035507792589, 0.45801677765722737, 0.6178762444026438,
                                           0.755404408355003,   0.8656312023878318, 0.9445750230732326,  0.9894009349916499};
    static constexpr double WEIGHTS[HALF] = {0.1894506104550685,  0.18260341504492358, 0.16915651939500254,  0.14959598881657674,
                                             0.12462897125553388, 0.09515851168249279, 0.062253523938647894, 0.027152459411754096};

    // Sum f(tau, weight) over a span of time, in pieces of at most a turn: of a product of two waves, cos 2 x there, the rule misses less
    // than 1e-19. Returns half the length of a piece, by which sums are to be multiplied.
    template <class F> static double quadrature(double turn, double span, F f) {
        const whole pieces = whole(most(turn, span) / TWO_PI) + 1;
        const double half = 0.5 * span / double(pieces);
        for (whole piece = 0; piece < pieces; piece++) {
            for (int j = 0; j < HALF; j++) {
                f((double(2 * piece + 1) - NODES[j]) * half, WEIGHTS[j]);
                f((double(2 * piece + 1) + NODES[j]) * half, WEIGHTS[j]);
            }
        }
        return half;
    }

    // Per M b^2 omega_0^2: the integrals of (e + eps lambda e') q1' and of eps lambda q1'^2, and eps mu g times the way slid.
    void works(const double *state, double ahead, double *out) const {
        const Oscillation q = oscillation(state);
        const double span = ahead / omega, start = q.h1 + q.z1;
        double given = 0.0, lost = 0.0;
        const double half = quadrature(ahead, span, [&](double tau, double weight) {
            double rate = start + q.at(tau).speed, sin_psi, cos_psi;
            sine_cosine(state[PSI] + omega * tau, sin_psi, cos_psi);
            given += weight * rate * (sin_psi + chi * drag * omega * cos_psi);
            lost += weight * rate * rate;
        });
        out[0] = eps * G * half * given;
        out[1] = drag * half * lost;
        out[2] = state[MODE] != 0.0 ? eps * pull * fabs(q.at(span).way - q.travel(span)) : 0.0;
    }

    // Kinetic and potential energy per M b^2 omega_0^2.
    double energy(const double *state) const {
        double q1 = (state[V] + eps * state[W]) / full, q1_rate = (state[V_RATE] + eps * state[RATE]) / full;
        double q2_rate = (state[V_RATE] - state[RATE]) / full;
        return 0.5 * (q1_rate * q1_rate + q1 * q1 + eps * q2_rate * q2_rate) + eps * lean * state[W];
    }

    // Of a segment: largest |q1|, and the integrals of v sin Psi, v cos Psi and q1 sin Psi over the phase.
    void shape(const double *state, double length, double *out) const {
        const Oscillation q = oscillation(state);
        const bool moving = state[MODE] != 0.0;
        const double q1 = (state[V] + eps * state[W]) / full, span = length / omega;
        double largest = most(fabs(q1), fabs(q1 + q.at(span).way)), tau = 0.0;
        while (span > 0.0) {  // the extrema of q1
            const double bound = q.driven(3) + q.own(3, tau), tiny = 4e-16 * (2.0 * q.driven(1) + 2.0 * q.own(1, 0.0));
            tau = coupled::first_zero(tau, span, bound, tiny, 0.0, [&](double at, double& value, double& slope) {
                const Oscillation::Point p = q.at(at);
                value = q.h1 + q.z1 + p.speed, slope = p.h2 + p.z2;
            });
            if (tau >= span) break;
            largest = most(largest, fabs(q1 + q.at(tau).way));
        }
        out[0] = largest;
        double sine_part = 0.0, cosine_part = 0.0, own = 0.0;
        const double half = quadrature(length, span, [&](double t, double weight) {
            double way = q.at(t).way, sin_psi, cos_psi, v = state[V] + (moving ? way + eps * q.travel(t) : full * way);
            sine_cosine(state[PSI] + omega * t, sin_psi, cos_psi);
            sine_part += weight * v * sin_psi;
            cosine_part += weight * v * cos_psi;
            own += weight * (q1 + way) * sin_psi;
        });
        out[1] = sine_part * half * omega;
        out[2] = cosine_part * half * omega;
        out[3] = own * half * omega;
    }
};

}  // namespace simulation
