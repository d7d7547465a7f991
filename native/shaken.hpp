// Event-driven simulation of a shaken cavity, w'' = -C Omega^2 sin Psi - b - s a_s.
//
// Everything is written in the phase x = Omega d that has passed since the start of a leg and in the direction of the motion s,
// with theta = Psi (s = -1) or Psi - pi (s = +1), p = s w'/Omega, A = (a_s + s b)/Omega^2:
//
//     y''(x) = q(x) = C sin(theta_0 + x) - A,  y'(x) = p(x),  y(x) = s (w - w_0).
//
// q is positive for theta in (alpha, pi - alpha), alpha = arcsin(A/C), and negative on the rest of the circle (A < -C, on a steep
// slope: positive everywhere), so a leg that ends at the next theta = alpha is one rising and one falling piece of p. On the rising
// piece y is convex and Newton's iteration for the hit y = D, started from its right end, comes down to the root without crossing it;
// on the falling piece y is concave and Newton's iteration from the left climbs to the root without crossing it, or runs past the
// point where p = 0: then there is no hit before the turn. No hit and no turn can be missed.
#pragma once
#include "cavity_law.hpp"
#include "stepping.hpp"

namespace simulation {

// One direction of sliding: A, sin alpha, alpha, cos alpha, whether the shaking ever beats A and whether it always does, the wall ahead.
struct Direction {
    double pull, ratio, alpha, beta, reach, restitution;
    bool driven, always;

    Direction(double acceleration, const CavityLaw& law, double wall, double factor) : reach(wall), restitution(factor) {
        double C = law.amplitude;
        pull = acceleration / (law.omega * law.omega);
        driven = C - pull > 1e-12 * C;
        always = pull <= -C && driven;
        ratio = always ? -1.0 : driven ? pull / C : 1.0;
        alpha = arcsine(ratio);
        beta = sqrt((1.0 - ratio) * (1.0 + ratio));
    }

    bool rises_at(double theta) const { return alpha <= theta && theta < PI - alpha; }

    // theta: Psi for s = -1, Psi - pi for s = +1, within a turn from where q becomes positive.
    double angle_of(double psi, double s) const {
        double theta = s < 0.0 ? psi : psi >= PI ? psi - PI : psi + PI;
        return alpha < 0.0 && theta >= TWO_PI + alpha ? theta - TWO_PI : theta;
    }
};

// y'' = q0 + C (k0 sin x - m0 (1 - cos x)) from y = 0, y' = p.
struct Leg {
    double p, q0, C, k0, m0;
    struct Point { double y, rate, pull, jerk; };

    Point at(double x) const {
        Remainders r = remainders(x);
        return {p * x + 0.5 * q0 * x * x + C * (k0 * r.third - m0 * r.fourth), p + q0 * x + C * (k0 * r.versine - m0 * r.third),
                q0 + C * (k0 * r.sine - m0 * r.versine), C * (k0 * (1.0 - r.versine) - m0 * r.sine)};
    }

    // The zero of p on (lo, hi], where p falls from p(lo) >= 0 to p(hi) <= 0: Newton kept inside the bracket.
    double turn(double lo, double hi) const {
        double x = hi;
        for (int k = 0; k < 200; k++) {
            Point here = at(x);
            double rate = here.rate, pull = here.pull;
            if (rate > 0.0) lo = x;
            else if (rate < 0.0) hi = x;
            else return x;
            double next = pull < 0.0 ? x - rate / pull : hi, change = fabs(next - x);
            if (pull < 0.0 && (change <= 2.3e-16 * x || (change <= 1e-8 * x && C * change * change <= -1e-16 * pull * x)))
                return least(most(next, lo), hi);  // the remainder is of second order
            if (!(lo < next && next < hi)) {
                next = 0.5 * (lo + hi);
                if (hi - lo <= 2.3e-16 * hi) return next;
            }
            x = next;
        }
        return x;
    }
};

struct Shaken {
    static constexpr int STATE = 6, ROW = 5;
    CavityLaw law;
    Direction rightwards, leftwards;
    bool frictionless;

    explicit Shaken(const CavityLaw& numbers)
        : law(numbers), rightwards(-law.pull[1], law, -law.wall[1], law.restitution[1]),
          leftwards(law.pull[0], law, law.wall[0], law.restitution[0]), frictionless(law.pull[0] == law.pull[1]) {}

    // Reduce the phase and set the mode of a start.
    void launch(double *state) const {
        carry(state[PSI], state[TURNS]);
        double square = law.omega * law.omega, push = -law.amplitude * sine(state[PSI]), w = state[W];
        bool to_left = push > law.pull[0] / square, to_right = push < law.pull[1] / square;
        if (state[RATE] != 0.0) state[MODE] = state[RATE] > 0.0 ? 1.0 : -1.0;
        else if (!(to_left || to_right) || (w == law.wall[0] && to_left) || (w == law.wall[1] && to_right)) state[MODE] = 0.0;
        else state[MODE] = to_left ? 1.0 : -1.0;
    }

    // Whether the push in a direction passes zero at psi, rising.
    bool begins_at_root(double psi, double s) const {
        const Direction& ahead = s > 0.0 ? leftwards : rightwards;
        const double C = law.amplitude;
        double sin_psi, cos_psi;
        sine_cosine(psi, sin_psi, cos_psi);
        return ahead.driven && -s * cos_psi > 0.0 && fabs(-s * C * sin_psi - ahead.pull) < 1e-13 * C;
    }

    Status advance(double *state, double until, Events& events) const {
        const double C = law.amplitude, omega = law.omega, size = C + fabs(law.slope) / (omega * omega);
        double psi = state[PSI], w = state[W], p = fabs(state[RATE]) / omega, s = state[MODE], turns = state[TURNS], low = state[LOW];
        if (!(isfinite(psi) && isfinite(w) && isfinite(p) && isfinite(size) && isfinite(leftwards.pull))) return FAILED;
        const double goal = least(until, turns + SLICE);
        bool at_root = s != 0.0 && p == 0.0 && begins_at_root(psi, s);  // the leg starts exactly where q = 0, q rising: a slip
        Status status = EVENTS_FULL;
        while (!events.full()) {
            const double left = (goal - turns) * TWO_PI - psi;
            if (!(left > 0.0)) { status = TIME_REACHED; break; }
            if (s == 0.0) {  // at rest on the floor, or against a wall
                double wait = HUGE_VAL;
                for (double way = -1.0; way <= 1.0; way += 2.0) {
                    const Direction& ahead = way > 0.0 ? leftwards : rightwards;
                    if (way * w >= ahead.reach || !ahead.driven) continue;
                    double theta = ahead.angle_of(psi, way), delay = 0.0, turn;
                    if (!ahead.always && !(ahead.alpha <= theta && theta < PI - ahead.alpha - 1e-12))
                        delay = wrap(ahead.alpha - theta, turn);
                    if (delay < wait) { wait = delay; s = way; at_root = delay > 0.0; }
                }
                if (wait >= left) {
                    status = wait == HUGE_VAL ? AT_REST : TIME_REACHED;
                    psi += status == AT_REST ? (until - turns) * TWO_PI - psi : left;
                    carry(psi, turns);
                    s = 0.0;
                    break;
                }
                psi += wait;
                carry(psi, turns);
                p = 0.0;
                if (!(frictionless && law.wall[1] < w && w < law.wall[0])) events.add(ROW, SLIP, s, psi, turns, w, 0.0, 0.0);
                continue;
            }
            const Direction &ahead = s > 0.0 ? leftwards : rightwards, &behind = s > 0.0 ? rightwards : leftwards;
            const double A = ahead.pull;
            Leg leg{p, 0.0, C, ahead.beta, ahead.ratio};
            double theta = ahead.alpha;
            if (!at_root) {
                double sin_psi, cos_psi;
                sine_cosine(psi, sin_psi, cos_psi);
                leg.m0 = -s * sin_psi;
                leg.k0 = -s * cos_psi;
                leg.q0 = C * leg.m0 - A;
                theta = ahead.angle_of(psi, s);
            }
            at_root = false;
            const double away = -leg.m0 * C;  // v'' against the motion
            if (p < 1e-6 * size && -s * w == behind.reach && away > behind.pull && away + A > 0.0 && !ahead.rises_at(theta)) {
                // leaving a wall that is pushed after the absorber: is this the tail of a chatter?
                double back = away - behind.pull, brake = away + A, factor = behind.restitution * sqrt(back / brake);
                double rest = p * (1.0 / brake + 1.0 / sqrt(back * brake));
                if (factor < 1.0) rest /= 1.0 - factor;
                if ((rest * rest * C < 1e-16 * back && factor < 1.0) || p < 1e-13 * size) {
                    if (p < 1e-13 * size) rest = least(rest, 1e-13);
                    psi += rest;
                    carry(psi, turns);
                    events.add(ROW, HOLD, 0.0, psi, turns, w, 0.0, 0.0);
                    p = s = 0.0;
                    continue;
                }
            }
            const double target = (ahead.reach - s * w) - s * low;
            double top = 0.0, end;
            if (ahead.driven) {
                double alpha = ahead.alpha;
                end = theta < alpha ? alpha - theta : TWO_PI + alpha - theta;
                top = ahead.always ? end : ahead.rises_at(theta) ? PI - alpha - theta : 0.0;
            } else {
                end = A > 0.0 ? (p + 2.0 * C) / A : HUGE_VAL;
                if (A == 0.0 && C == 0.0) {
                    if (p == 0.0) { psi += (until - turns) * TWO_PI - psi; carry(psi, turns); status = AT_REST; break; }
                    end = 2.0 * target / p + 1.0;
                }
            }
            const double full = end;
            const bool cut = end > left;
            if (cut) end = left;
            enum { LEG_ENDS, HIT, HALT } outcome = LEG_ENDS;
            double x = 0.0, y = 0.0, rate = p;
            if (top > 0.0) {
                x = least(top, end);
                Leg::Point here = leg.at(x);
                y = here.y;
                rate = here.rate;
                if (target <= 0.0) { outcome = HIT; x = 0.0; rate = p; }
                else if (y >= target) {
                    outcome = HIT;
                    for (int k = 0; k < 100; k++) {  // convex: from the right
                        double step = rate > 0.0 ? (y - target) / rate : x;
                        if (step >= x) step = 0.5 * x;
                        if (!(step > 2.3e-16 * x)) break;
                        x -= step;
                        here = leg.at(x);
                        y = here.y;
                        rate = here.rate;
                        step = (y - target) / rate;
                        if (step <= 1e-5 * x && fabs(here.pull) * step <= 1e-5 * rate && C * step * step <= 1e-9 * rate) {
                            step *= 1.0 + 0.5 * step * here.pull / rate;  // the last step from values at hand
                            x -= step;
                            rate -= step * (here.pull - 0.5 * step * here.jerk);
                            break;
                        }
                    }
                }
            }
            if (outcome == LEG_ENDS && x < end) {
                double before = x;
                int k = 0;
                for (; k < 200; k++) {  // concave: from the left
                    if (rate <= 0.0) { outcome = HALT; break; }
                    double step = (target - y) / rate;
                    if (!(step > 2.3e-16 * x)) {
                        if (target - y <= 0.0 || step > 0.0) outcome = HIT;
                        break;
                    }
                    if (x == end) break;
                    before = x;
                    x += step;
                    if (x > end) x = end;
                    Leg::Point here = leg.at(x);
                    y = here.y;
                    rate = here.rate;
                    step = (target - y) / rate;
                    bool small = fabs(here.pull) * step <= 1e-5 * rate && C * step * step <= 1e-9 * rate;
                    if (small && 0.0 < step && step <= 1e-5 * x && x + step < end) {
                        step *= 1.0 - 0.5 * step * here.pull / rate;  // the last step from values at hand
                        x += step;
                        rate += step * (here.pull + 0.5 * step * here.jerk);
                        outcome = HIT;
                        break;
                    }
                }
                if (k == 200) outcome = HIT;
                if (outcome == HALT) {
                    if (before < x) { x = leg.turn(before, x); y = leg.at(x).y; }
                    else y = 0.0;
                }
            }
            if (outcome == LEG_ENDS && !cut) {
                at_root = ahead.driven && !ahead.always;  // theta = alpha: go on with fresh digits
                if (ahead.driven) x = full;
            }
            psi += x;
            carry(psi, turns);
            if (outcome == HIT) {
                if (!(rate > 1e-30)) rate = 1e-30;
                w = s * ahead.reach;
                low = 0.0;
                p = ahead.restitution * rate;
                s = -s;
                events.add(ROW, s < 0.0 ? HIT_LEFT : HIT_RIGHT, s, psi, turns, w, -s * omega * rate, s * omega * p);
                continue;
            }
            shift(w, low, s * y);
            if (w > law.wall[0] || (w == law.wall[0] && low > 0.0)) { w = law.wall[0]; low = 0.0; }
            else if (w < law.wall[1] || (w == law.wall[1] && low < 0.0)) { w = law.wall[1]; low = 0.0; }
            if (outcome == LEG_ENDS) {
                p = rate > 0.0 ? rate : 0.0;
                if (cut) { status = TIME_REACHED; break; }
                continue;
            }
            p = 0.0;
            if (frictionless) {  // nothing happens where w' passes zero
                s = -s;
                at_root = x == 0.0 && begins_at_root(psi, s);  // else both directions may halt there by rounding, for ever
                continue;
            }
            bool turns_back = behind.driven && C * (s * sine(psi)) > behind.pull;
            s = turns_back ? -s : 0.0;
            events.add(ROW, turns_back ? TURN : STICK, s, psi, turns, w, 0.0, 0.0);
        }
        if (!(isfinite(psi) && isfinite(w) && isfinite(p))) status = FAILED;
        state[PSI] = psi;
        state[W] = w;
        state[RATE] = s * omega * p;
        state[MODE] = s;
        state[TURNS] = turns;
        state[LOW] = low;
        return status == TIME_REACHED && goal < until ? PAUSED : status;
    }

    double cavity_speed(const double *state) const { return law.amplitude * law.omega * cosine(state[PSI]); }

    // w, w', v, v' at a phase x after a state.
    void sample(const double *state, double x, double *out) const {
        const double C = law.amplitude, omega = law.omega, s = state[MODE];
        double sin_psi, cos_psi;
        if (s == 0.0) {
            out[0] = state[W];
            out[1] = 0.0;
        } else {
            Leg::Point there = leg(state).at(x);
            out[0] = state[W] + s * there.y;
            out[1] = s * omega * there.rate;
        }
        sine_cosine(state[PSI] + x, sin_psi, cos_psi);
        out[2] = C * sin_psi;
        out[3] = C * omega * cos_psi;
    }

    // In the frame of the cavity, per mass of the absorber: the integral of -v'' w', no damper, and friction times the way slid.
    void works(const double *state, double x, double *out) const {
        const double C = law.amplitude, square = law.omega * law.omega, s = state[MODE];
        out[0] = out[1] = out[2] = 0.0;
        if (s == 0.0) return;
        Leg from = leg(state);
        double sin_psi, cos_psi;
        sine_cosine(state[PSI] + x, sin_psi, cos_psi);
        double m1 = -s * sin_psi, k1 = -s * cos_psi, A = C * from.m0 - from.q0;
        out[0] = C * square * ((from.p + C * from.k0) * (from.k0 - k1) - 0.5 * C * (m1 * m1 - from.m0 * from.m0) - A * (m1 - from.m0 - x * k1));
        out[2] = (s > 0.0 ? law.pull[0] - law.slope : law.slope - law.pull[1]) * fabs(from.at(x).y);
    }

    // Energy of the relative motion per mass of the absorber.
    double energy(const double *state) const { return 0.5 * state[RATE] * state[RATE] + law.slope * state[W]; }

private:
    Leg leg(const double *state) const {
        const double C = law.amplitude, omega = law.omega, s = state[MODE];
        double sin_psi, cos_psi;
        sine_cosine(state[PSI], sin_psi, cos_psi);
        double A = (s > 0.0 ? law.pull[0] : -law.pull[1]) / (omega * omega), m0 = -s * sin_psi;
        return {s * state[RATE] / omega, C * m0 - A, C, -s * cos_psi, m0};
    }
};

}  // namespace simulation
