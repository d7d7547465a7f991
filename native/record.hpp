// The answer of an oscillator with its absorber to a recorded motion of the base (orbits/design/record.py says the equations).
#pragma once
#include "math.hpp"

namespace recorded {

constexpr double SLOWEST = 1e-7;  // speed of an impact below which the absorber stays on a wall that it is pressed to
constexpr int MOST_EVENTS = 20000;  // in a hundredth of the natural period

// Displacement and speed after t of mass x'' + rate x' + x = force + slope t.
inline void drift(double& x, double& v, double mass, double rate, double force, double slope, double t) {
    const double alpha = 0.5 * rate / mass, beta = sqrt(1.0 / mass - alpha * alpha), offset = force - rate * slope;
    const double z = x - offset, zr = v - slope, decay = exponential(-alpha * t);
    double s, c;
    sine_cosine(beta * t, s, c);
    s /= beta;
    x = decay * (z * c + (zr + alpha * z) * s) + offset + slope * t;
    v = decay * (zr * c - (alpha * zr + z / mass) * s) + slope;
}

// Displacements and speeds of oscillator and absorber, relative to the base.
struct Bodies { double x1, v1, x2, v2; };

struct Machine {
    double rate, eps, pull, r;

    // After t in a mode: -1, +1 slide, 0 stick; the base's acceleration is a0 + a1 t.
    Bodies at(Bodies s, whole mode, double a0, double a1, double t) const {
        if (mode == 0) {
            double y = s.x1, yr = s.v1;
            drift(y, yr, 1.0 + eps, rate, -(1.0 + eps) * a0, -(1.0 + eps) * a1, t);
            return {y, yr, s.x2 + y - s.x1, yr};
        }
        drift(s.x1, s.v1, 1.0, rate, -a0 - eps * pull * double(mode), -a1, t);
        const double push = pull * double(mode) - a0;
        return {s.x1, s.v1, s.x2 + (s.v2 + (0.5 * push - a1 * t / 6.0) * t) * t, s.v2 + (push - 0.5 * a1 * t) * t};
    }

    // Relative to inertia the force that keeps the absorber where it is: x2'' + e'' while it sticks.
    double need(const Bodies& s) const { return -(rate * s.v1 + s.x1) / (1.0 + eps); }

    // What vanishes at an event: 0, 1 the walls, 2 the relative speed, 3, 4 the reserve of friction while it sticks.
    double watch(const Bodies& s, whole mode, int event) const {
        if (event == 0) return 1.0 - (s.x1 - s.x2);
        if (event == 1) return 1.0 + (s.x1 - s.x2);
        if (event == 2) return double(mode) * (s.v1 - s.v2);
        return event == 3 ? pull - need(s) : pull + need(s);
    }
};

}  // namespace recorded

// Where the march stands between two calls, all members of eight bytes.
struct RecordState {
    recorded::Bodies bodies;
    double bare, bare_rate;
    whole mode, wall;  // while the mode is 0: +1, -1 where the absorber lies against the left or right wall, which only pushes
    whole row, hits, place, step;  // rows written, impacts seen, the interval of the record and the step in it that come next
    double lost[3];  // by impacts, friction and damping
};

// March on through the record, at most `most` rows: (time, x1, w, x1 of the bare oscillator) and times of impacts.
// Returns 0 at the end, 1 if there is more, -1 where events have no end.
EXPORT whole record_march(RecordState *state, whole intervals, const double *times, const double *acceleration, const whole *steps,
                          double rate, double eps, double pull, double r, double *out, double *hits, whole room, whole most) {
    using namespace recorded;
    const Machine machine{rate, eps, pull, r};
    RecordState now = *state;
    const whole last_row = now.row + most;
    for (; now.place < intervals; now.place++, now.step = 0) {
        const whole k = now.place;
        const double span = times[k + 1] - times[k], a1 = (acceleration[k + 1] - acceleration[k]) / span, h = span / double(steps[k]);
        for (; now.step < steps[k]; now.step++) {
            if (now.row >= last_row) {
                *state = now;
                return 1;
            }
            const whole j = now.step;
            double a0 = acceleration[k] + a1 * h * double(j), time = times[k] + h * double(j), left = h;
            drift(now.bare, now.bare_rate, 1.0, rate, -a0, -a1, h);
            for (int tries = 0; left > 0.0; tries++) {
                if (tries >= MOST_EVENTS) return -1;
                double first = left;
                int which = -1;
                const int last = now.mode == 0 ? 5 : pull > 0.0 ? 3 : 2;
                for (int event = now.mode == 0 ? 3 : 0; event < last; event++) {
                    if (now.mode == 0 && ((event == 3 && now.wall == 1) || (event == 4 && now.wall == -1))) continue;  // the wall holds
                    auto value = [&](double t) { return machine.watch(machine.at(now.bodies, now.mode, a0, a1, t), now.mode, event); };
                    if (value(first) >= 0.0) continue;
                    double low = 0.0, high = first;
                    while (high - low > 1e-15 * (1.0 + first)) {
                        double middle = 0.5 * (low + high);
                        if (middle <= low || middle >= high) break;
                        (value(middle) >= 0.0 ? low : high) = middle;
                    }
                    first = high;
                    which = event;
                }
                const Bodies before = now.bodies;
                Bodies s = machine.at(before, now.mode, a0, a1, first);
                now.lost[2] += rate * 0.5 * (before.v1 * before.v1 + s.v1 * s.v1) * first;
                if (now.mode != 0) now.lost[1] += eps * pull * fabs((s.x1 - s.x2) - (before.x1 - before.x2));
                a0 += a1 * first;
                left -= first;
                time += first;
                if (which == 0 || which == 1) {
                    const double w_rate = s.v1 - s.v2, v_rate = s.v1 + eps * s.v2, after = -r * w_rate;
                    const whole side = which == 0 ? 1 : -1;
                    now.lost[0] += 0.5 * eps / (1.0 + eps) * (1.0 - r * r) * w_rate * w_rate;
                    if (now.hits < room) hits[now.hits++] = time;
                    s.v2 = (v_rate - after) / (1.0 + eps);
                    s.v1 = s.v2 + after;
                    s.x2 = s.x1 - double(side);
                    now.mode = after > 0.0 ? 1 : -1;
                    if (fabs(after) < SLOWEST && double(side) * machine.need(s) > -pull) {
                        s.v1 = s.v2 = v_rate / (1.0 + eps);
                        now.mode = 0;
                        now.wall = side;
                    }
                } else if (which == 2) {
                    const double need = machine.need(s);
                    s.v2 = s.v1;
                    now.mode = fabs(need) <= pull ? 0 : need > 0.0 ? 1 : -1;
                    now.wall = 0;
                } else if (which >= 3) {
                    now.mode = which == 3 ? 1 : -1;
                    now.wall = 0;
                }
                now.bodies = s;
            }
            double *row = out + 4 * now.row++;
            row[0] = times[k] + h * double(j + 1);
            row[1] = now.bodies.x1;
            row[2] = now.bodies.x1 - now.bodies.x2;
            row[3] = now.bare;
        }
    }
    *state = now;
    return 0;
}
