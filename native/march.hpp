// Continuation of a compiled problem: predict, correct, judge the step, many points a call; single points, and places where a number
// passes zero. The reference: contvines/continuation/loop.py, corrector.py, bracketing.py, layout.py; unknowns have scale 1 and one
// weight here: <a, b> = of_unknowns a_u.b_u + of_parameter a_p b_p.
#pragma once
#include "math.hpp"

namespace continuation {

struct Metric { double of_unknowns, of_parameter; };

// `SolutionSettings` in contvines/continuation/settings.py, in their order.
struct Solution { double rounding, small, predicted, stalled, solved, huge, left, jump, moved, cancels; };

// What all calls about one problem have in common. `Engine` in contvines/continuation/engine.py fills it.
struct Frame {
    const Table* table;
    void *data, *work;
    whole unknowns, row;
    Metric metric;
    double noise;
    double *u, *border, *step, *tangent, *guess, *bracket;  // room: (N,), four (N + 1,), Bracket
    const Solution* solution;
};

// ---- lengths ------------------------------------------------------------------------------------------------------------------
// Largest entry of a correction, relative to 1 + |unknown|; infinity where it is not finite.
inline double correction_size(const double* step, const double* u, double p, whole n) {
    double size = fabs(step[n]) / (1.0 + fabs(p)), total = size;
    for (whole i = 0; i < n; i++) {
        double entry = fabs(step[i]) / (1.0 + fabs(u[i]));
        size = entry > size ? entry : size, total += entry;  // maxima pass over what is not a number
    }
    return total < HUGE_VAL ? size : HUGE_VAL;
}
inline double rest_of(const double* border, const double* u, double p, double target, whole n) {
    double gap = target - border[n] * p;
    for (whole i = 0; i < n; i++) gap -= border[i] * u[i];
    return gap;
}
// The plane through (u, p) across a tangent; returns border.(u, p).
inline double plane(const double* tangent, const double* u, double p, Metric m, double* border, whole n) {
    double target = 0.0;
    for (whole j = 0; j < n; j++) border[j] = m.of_unknowns * tangent[j], target += border[j] * u[j];
    border[n] = m.of_parameter * tangent[n];
    return target + border[n] * p;
}
// Cubic Hermite extrapolation over a length h from point i - 1 (and i - 2); fills u, returns p. The arc between the two points is as long as
// their distance times 1 + angle^2/24 (exact to fourth order).
inline double extrapolate(const double* points, const double* values, const double* tangents, whole i, double h, Metric m, double* u, whole n) {
    const double *point = points + (i - 1) * n, *tangent = tangents + (i - 1) * (n + 1);
    if (i >= 2) {
        const double *old = point - n, *old_tangent = tangent - (n + 1);
        double change = values[i - 1] - values[i - 2], bend_p = tangent[n] - old_tangent[n], chord = 0.0, bend = 0.0;
        for (whole j = 0; j < n; j++) {
            double a = point[j] - old[j], b = tangent[j] - old_tangent[j];
            chord += a * a, bend += b * b;
        }
        double turn = m.of_parameter * bend_p * bend_p + m.of_unknowns * bend;
        double d = sqrt(m.of_parameter * change * change + m.of_unknowns * chord) * (1.0 + turn / 24.0);
        if (d > 0.0 && turn < 1.0 && h < 4.0 * d) {
            double share = h / d, by_d = 1.0 / d;
            auto ahead = [=](double a, double b, double mean) { return h * (a + share * (2.0 * a + b - 3.0 * mean + share * (a + b - 2.0 * mean))); };
            for (whole j = 0; j < n; j++) u[j] = point[j] + ahead(tangent[j], old_tangent[j], (point[j] - old[j]) * by_d);
            return values[i - 1] + ahead(tangent[n], old_tangent[n], change * by_d);
        }
    }
    for (whole j = 0; j < n; j++) u[j] = point[j] + h * tangent[j];
    return values[i - 1] + h * tangent[n];
}
// Cubic Hermite interpolation at s in [0, 1]; fills u and guess alike, returns p.
inline double hermite(const double* chord, double s, double* u, double* guess, whole n) {
    double a = (1.0 + 2.0 * s) * (1.0 - s) * (1.0 - s), b = s * (1.0 - s) * (1.0 - s), c = s * s * (3.0 - 2.0 * s), d = s * s * (s - 1.0);
    const double *c0 = chord, *c1 = c0 + n + 1, *c2 = c1 + n + 1, *c3 = c2 + n + 1;
    for (whole j = 0; j <= n; j++) guess[j] = a * c0[j] + b * c1[j] + c * c2[j] + d * c3[j];
    for (whole j = 0; j < n; j++) u[j] = guess[j];
    return guess[n];
}

// ---- corrector ------------------------------------------------------------------------------------------------------------------
constexpr double STRAY = 0.3, BEYOND = 1e300;

// Add a Newton correction to u and p, unless Newton's method diverges: 1 when converged, -1 when diverged, else 0.
inline int improve(const Frame& f, double* u, double& p, whole sweep, double residual, double& size, double tolerance) {
    const Solution& limits = *f.solution;
    const double* step = f.step;
    const double noise = f.noise;
    const whole n = f.unknowns;
    double before = size;
    size = correction_size(step, u, p, n);
    if (!(size < limits.huge)) return -1;
    if (sweep > 1 && size > 2.0 * before && size > larger(limits.stalled, 10.0 * noise)) return -1;
    for (whole i = 0; i < n; i++) u[i] += step[i];
    p += step[n];
    if (size <= larger(smaller(limits.small, tolerance), noise)) return 1;
    if (sweep > 0) {
        double ratio = size / before;
        // quadratic convergence: the next correction would be about ratio^2 size
        if (size <= tolerance && ratio * ratio * size <= larger(limits.predicted, noise)) return 1;
        if (size <= limits.stalled && ratio > 0.3 && residual < limits.solved) return 1;
        if (size <= 30.0 * noise && ratio > 0.1) return 1;  // corrections that are noise do not shrink, whatever the tolerance
    }
    return 0;
}

// ---- the march ------------------------------------------------------------------------------------------------------------------
// `judge` of a step rule (contvines/continuation/settings.py); ABORT ends the march.
using Judge = double (*)(double turn, double error, whole sweeps, double length, double angle, double roundoff);
inline double by_angle(double turn, double error, whole sweeps, double length, double angle, double roundoff) {
    if (!(turn <= 2.0 * angle && error <= angle * length + roundoff)) return -0.5;
    double factor = 2.0;
    if (turn > 0.5 * angle) factor = larger(0.5, angle / turn);
    return sweeps > 3 ? smaller(factor, 0.8) : factor;
}

struct Control { double angle, min_step, max_step, tolerance, lower, upper, stop_at_border, sweeps, row_margins, noise; };
enum Status { ABORTED = -1, RUNNING = 0, LEFT_INTERVAL = 1, STEP_TOO_SMALL = 2, NOT_EVALUABLE = 3, AT_BORDER = 4 };
constexpr double ABORT = -HUGE_VAL;

struct Chunk { double *points, *values, *tangents, *rows, *signs, *corrections; };

// Fill rows first, first + 1, .. below `stop` with points of the branch; row first - 1 holds the last known point, row first - 2 (if any) the one
// before it. The step to go on with is left in `h`, the number of filled rows in `filled`.
inline Status march(Frame& f, const Chunk& chunk, whole first, whole stop, double* h_, const Control& control, Judge judge, whole* filled) {
    const Table& table = *f.table;
    const whole n = f.unknowns;
    const double noise = f.noise;
    double &h = *h_, *u = f.u, *border = f.border, *step = f.step, *tangent = f.tangent;
    whole& i = *filled;
    int trouble = 0;
    for (i = first; i < stop;) {
        if (h < control.min_step) return trouble == -2 ? NOT_EVALUABLE : STEP_TOO_SMALL;
        const double start = chunk.values[i - 1];
        double p = extrapolate(chunk.points, chunk.values, chunk.tangents, i, h, f.metric, u, n), length = h, bound = 0.0, target;
        const bool fixed = p > control.upper || p < control.lower;
        if (fixed) {
            bound = p > control.upper ? control.upper : control.lower;
            if (start == bound) return LEFT_INTERVAL;
            for (int k = 0; k < 3; k++) {
                if (p != start) length *= smaller(larger((bound - start) / (p - start), 0.0), 1.5);
                p = extrapolate(chunk.points, chunk.values, chunk.tangents, i, length, f.metric, u, n);
            }
            p = bound;
            for (whole j = 0; j < n; j++) border[j] = 0.0;
            border[n] = 1.0, target = bound;
        } else target = plane(chunk.tangents + (i - 1) * (n + 1), u, p, f.metric, border, n);
        double* point = chunk.points + i * n;
        for (whole j = 0; j < n; j++) point[j] = u[j];
        const double guess = p;
        double size = 0.0, sign = 0.0;
        whole sweeps = -1;
        for (whole sweep = 0; sweep < whole(control.sweeps); sweep++) {
            double residual = table.linearise(f.data, u, p, f.work);
            if (!(residual < BEYOND)) {
                sweeps = -2;
                break;
            }
            sign = table.bordered(f.data, f.work, border, rest_of(border, u, p, target, n), step, tangent);
            int verdict = improve(f, u, p, sweep, residual, size, control.tolerance);
            if (verdict != 0) {
                sweeps = verdict > 0 ? sweep + 1 : -1;
                break;
            }
        }
        if (sweeps < 0) {
            trouble = int(sweeps), h *= 0.5;
            continue;
        }
        trouble = 0;
        const double* before = chunk.tangents + (i - 1) * (n + 1);
        double part_norm = 0.0, part_cosine = 0.0, part_error = 0.0;
        for (whole j = 0; j < n; j++) {
            double gap = u[j] - point[j];
            part_norm += tangent[j] * tangent[j], part_cosine += tangent[j] * before[j], part_error += gap * gap;
        }
        const Metric m = f.metric;
        double norm = sqrt(m.of_parameter * tangent[n] * tangent[n] + m.of_unknowns * part_norm);
        double cosine = (m.of_parameter * tangent[n] * before[n] + m.of_unknowns * part_cosine) / norm;
        double error = sqrt(m.of_parameter * (p - guess) * (p - guess) + m.of_unknowns * part_error);
        if (fixed) {
            p = bound;
            if (cosine < 0.0) cosine = -cosine, norm = -norm;
            if (tangent[n] * norm < 0.0) sign = -sign;
        }
        double turn = sqrt(larger(0.0, 2.0 - 2.0 * cosine)), factor = judge(turn, error, sweeps, length, control.angle, larger(f.solution->rounding, noise));
        if (factor == ABORT) return ABORTED;
        if (!(factor > 0.0)) {
            h = -factor * length;
            continue;
        }
        if (p > control.upper || p < control.lower) {
            bound = p > control.upper ? control.upper : control.lower;
            h = length * larger(0.5, (bound - start) / (p - start)) * 1.0000001;
            if (guess == p || start == bound) return LEFT_INTERVAL;
            if (h >= length) h = 0.9 * length;
            continue;
        }
        double *along = chunk.tangents + i * (n + 1), *row = chunk.rows + i * f.row, by_norm = 1.0 / norm;
        for (whole j = 0; j < n; j++) point[j] = u[j];
        for (whole j = 0; j <= n; j++) along[j] = tangent[j] * by_norm;
        chunk.values[i] = p, chunk.signs[i] = sign, chunk.corrections[i] = size;
        table.inspect(f.data, u, p, f.work, row);
        i++;
        if (fixed) return LEFT_INTERVAL;
        h = smaller(h * factor, control.max_step);
        if (control.stop_at_border > 0.0)
            for (whole j = whole(control.row_margins); j < f.row; j++)
                if (row[j] < -f.solution->rounding) return AT_BORDER;
    }
    return RUNNING;
}

// ---- aims: numbers of a solved point that pass zero at a special point --------------------------------------------------------------
enum Spectrum { NONE, MAP, FLOW, REAL };
enum What { NOTHING, MARGINS, SLOPE, SIGN, MULTIPLIER };
enum Sort { MINUS = -1, PAIR = 0, PLUS = 1 };
struct Aim { whole test, columns; const whole* column; whole count, kind, sort, rank, anyway; };

inline bool belongs(double im, whole kind, whole sort) { return sort == PAIR ? im > 0.0 : kind == REAL || im == 0.0; }
inline double size_among(double re, double im, whole kind, whole sort) {
    if (sort == PAIR) return kind == MAP ? hypotenuse(re, im) : re;
    return sort == MINUS && kind != REAL ? -re : re;
}
// The test function of one multiplier of a sort, the largest of them ranked first: positive past the circle (or the axis).
inline double multiplier_test(const double* row, whole count, whole kind, whole sort, whole rank) {
    constexpr double LIMIT = 1.0;
    whole members = 0;
    for (whole j = 0; j < count; j++) members += belongs(row[2 * j + 1], kind, sort);
    if (members < rank) {
        if (sort == PAIR || members == count) return -LIMIT;
        // a complex pair may meet on the real axis: continuous only where that happens at the critical place itself
        double place = kind != MAP ? 0.0 : sort == MINUS ? -1.0 : 1.0, nearest = LIMIT;
        for (whole j = 0; j < count; j++)
            if (row[2 * j + 1] != 0.0) nearest = smaller(nearest, hypotenuse(row[2 * j] - place, row[2 * j + 1]));
        return -nearest;
    }
    double value = HUGE_VAL;
    whole taken = -1;
    for (whole k = 0; k < rank; k++) {
        double largest = -HUGE_VAL;
        whole which = -1;
        for (whole j = 0; j < count; j++) {
            if (!belongs(row[2 * j + 1], kind, sort)) continue;
            double own = size_among(row[2 * j], row[2 * j + 1], kind, sort);
            bool follows = own < value || (own == value && j > taken);
            if (follows && (which < 0 || own > largest)) largest = own, which = j;
        }
        value = largest, taken = which;
    }
    if (kind == MAP) value = value > 0.0 ? (value < HUGE_VAL ? logarithm(value) : LIMIT) : -LIMIT;
    return smaller(larger(value, -LIMIT), LIMIT);
}
inline double probe(const Aim& aim, const double* row, double slope, double sign) {
    if (aim.test == MARGINS) {
        double value = 1.0;
        for (whole j = 0; j < aim.columns; j++)
            if (row[aim.column[j]] < value) value = row[aim.column[j]];  // NaN counts as not applicable
        return value;
    }
    if (aim.test == SLOPE) return slope;
    if (aim.test == SIGN) return sign;
    return multiplier_test(row, aim.count, aim.kind, aim.sort, aim.rank);
}

// ---- bracketing: Chandrupatla's method and secants (contvines/continuation/bracketing.py) --------------------------------------------
struct Bracket {
    double x1, f1, p1, x2, f2, p2, x3, f3, width, tolerance, jump, count, again, wait, aimed, beyond;
    struct Side { double points, xa, fa, xb, fb; } sides[2];
};
constexpr double BISECTIONS = 2.0, ENOUGH = 0.25, SHORT = 0.02, MOST = 100.0;

// Begin with a bracket; the next place to look at, NaN where one end is the root itself.
inline double begin(Bracket& k, double a, double b, double fa, double fb, double pa, double pb, double tolerance, double jump) {
    k = {b, fb, pb, a, fa, pa, b, fb, fabs(b - a), tolerance, jump, 0.0, 0.0, BISECTIONS, -1.0, 0.0, {}};
    if (fa == 0.0) k.x1 = a, k.f1 = fa, k.p1 = pa;
    else if (fb == 0.0) k.x2 = b, k.f2 = fb, k.p2 = pb;
    else return b + 0.5 * (a - b);
    return NAN;
}
inline double best(const Bracket& k) { return fabs(k.f1) < fabs(k.f2) ? k.x1 : k.x2; }

// Where to look next in the bracket, where inverse quadratic steps are not safe.
inline double secant(Bracket& k) {
    bool beyond = k.beyond > 0.0;
    k.beyond = 0.0;
    if (beyond) {  // a secant ended beyond the zero, hardly: a little before its end
        k.wait = 0.0;
        return k.x1 + SHORT * (k.x2 - k.x1);
    }
    double middle = 0.5 * (k.x1 + k.x2), nearest = HUGE_VAL, where = middle;
    if (k.wait > 0.0) {
        k.wait -= 1.0;
        return middle;
    }
    for (int side = 0; side < 2; side++) {
        const auto& s = k.sides[side];
        if (s.points < 2.0 || !(fabs(s.fb) < fabs(s.fa))) continue;
        double step = s.fb * (s.xb - s.xa) / (s.fa - s.fb);
        if (fabs(step) < nearest && smaller(k.x1, k.x2) < s.xb + step && s.xb + step < larger(k.x1, k.x2))
            nearest = fabs(step), where = s.xb + step, k.aimed = side;
    }
    return where;
}
// Take notice of f(x), and of what else is to be kept of x; the next place to look at, NaN where that is enough. `part`: of the first bracket,
// over which f jumps.
inline double follow(Bracket& k, double part, double x, double fx, double px) {
    if (!isfinite(fx)) {
        if (k.again > 0.0) return NAN;
        k.again = 1.0;
        return k.x1 + 0.37 * (k.x2 - k.x1);
    }
    k.again = 0.0, k.count += 1.0;
    int own = fx > 0.0;
    auto& s = k.sides[own];  // a secant that has ended beyond the zero, or has left too much, is not trusted again soon
    if (k.aimed >= 0.0 && k.aimed != own) k.beyond = 1.0;
    else if (k.aimed >= 0.0 && !(fabs(fx) < ENOUGH * fabs(s.fb))) k.wait = BISECTIONS;
    s = {s.points + 1.0, s.xb, s.fb, x, fx};
    k.aimed = -1.0;
    if ((fx > 0.0) == (k.f1 > 0.0)) k.x3 = k.x1, k.f3 = k.f1;
    else k.x3 = k.x2, k.f3 = k.f2, k.x2 = k.x1, k.f2 = k.f1, k.p2 = k.p1;
    k.x1 = x, k.f1 = fx, k.p1 = px;
    const double x1 = x, f1 = fx, x2 = k.x2, f2 = k.f2, x3 = k.x3, f3 = k.f3;
    if (f1 == 0.0) {
        k.x2 = x1, k.f2 = f1, k.p2 = px;
        return NAN;
    }
    double limit = 0.5 * k.tolerance * k.width / larger(fabs(x2 - x1), 1e-300);
    if (fabs(f1 - f2) > k.jump && fabs(x2 - x1) < part * k.width) return NAN;
    if (limit > 0.5 || fabs(x2 - x1) <= k.tolerance * k.width || k.count >= MOST) return NAN;
    double xi = (x1 - x2) / (x3 - x2), phi = f3 != f2 ? (f1 - f2) / (f3 - f2) : 2.0, t;
    if (phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi)
        t = (f1 / (f2 - f1)) * (f3 / (f2 - f3)) + ((x3 - x1) / (x2 - x1)) * (f1 / (f3 - f1)) * (f2 / (f3 - f2));
    else t = (secant(k) - x1) / (x2 - x1);
    return x1 + smaller(1.0 - limit, larger(limit, t)) * (x2 - x1);
}

// ---- single solutions, and everything about them (contvines/continuation/corrector.py: point, search) --------------------------------
enum Outcome { NOWHERE, PASSED, AT_END };
struct Found { double *u, *tangents, *rows, *numbers; };  // (k, N), (k, N + 1), (k, row), (k, 5)

inline Outcome points(Frame& f, const double* chord, double start, double length, const double* places, whole count,
                      const double* border, const double* along, whole max_sweeps, const Found& found, const Aim& aim) {
    const Table& table = *f.table;
    const whole n = f.unknowns;
    auto& bracket = *reinterpret_cast<Bracket*>(f.bracket);
    const bool searching = aim.test != NOTHING;
    Outcome outcome = NOWHERE;
    whole stage = 0, place = 0;
    double s = places[0], first_value = 0.0, first_p = 0.0;
    while (true) {
        double *u = found.u + place * n, *tangent = found.tangents + place * (n + 1), *row = found.rows + place * f.row;
        double p = hermite(chord, s, u, f.guess, n), residual = 0.0, sign = 0.0, size = 0.0;
        const whole limit = length > 0.0 && (s == 0.0 || s == 1.0) ? 0 : max_sweeps;
        whole sweeps = -1;
        bool settled = limit == 0;
        for (whole sweep = 0; sweep <= limit; sweep++) {
            residual = table.linearise(f.data, u, p, f.work);
            if (!(residual < BEYOND)) {
                sweeps = -2;
                break;
            }
            sign = table.bordered(f.data, f.work, border, rest_of(border, u, p, start + s * length, n), f.step, tangent);
            if (settled) {
                sweeps = sweep;
                break;
            }
            if (sweep == limit) break;
            int verdict = improve(f, u, p, sweep, residual, size, f.solution->rounding);
            if (verdict < 0) break;
            settled = verdict > 0;
        }
        if (sweeps >= 0) {
            table.inspect(f.data, u, p, f.work, row);
            double part_norm = 0.0, part_same = 0.0, across = border[n] * tangent[n], part_away = 0.0;
            for (whole j = 0; j < n; j++) {
                double away = u[j] - f.guess[j];
                part_norm += tangent[j] * tangent[j], part_same += tangent[j] * along[j], across += border[j] * tangent[j], part_away += away * away;
            }
            const Metric m = f.metric;
            double norm = sqrt(m.of_unknowns * part_norm + m.of_parameter * tangent[n] * tangent[n]);
            double same = m.of_unknowns * part_same + m.of_parameter * tangent[n] * along[n];
            if (norm < BEYOND) {
                if (same < 0.0) norm = -norm, across = -across;
                for (whole j = 0; j <= n; j++) tangent[j] /= norm;
                if (across < 0.0) sign = -sign;
                double change = p - f.guess[n];
                if (length > 0.0 && sqrt(m.of_unknowns * part_away + m.of_parameter * change * change) > STRAY * length) sweeps = -4;
            } else sweeps = -3;
        }
        double* numbers = found.numbers + 5 * place;
        numbers[0] = p, numbers[1] = double(sweeps), numbers[2] = residual, numbers[3] = sign, numbers[4] = size;
        if (!searching) {
            if (++place == count) return outcome;
            s = places[place];
            continue;
        }
        if (stage == 3) return outcome;  // the best place once more
        double value = sweeps >= 0 ? probe(aim, row, tangent[n], sign) : NAN, ahead;
        if (stage == 0) {
            stage = 1, first_value = value, first_p = p, s = 1.0;
            if (!isfinite(value)) return NOWHERE;
            continue;
        }
        if (stage == 1) {
            if (!isfinite(value)) return NOWHERE;
            if (first_value * value > 0.0) {
                double least = smaller(fabs(first_value), fabs(value)), most = larger(fabs(first_value), fabs(value));
                if (aim.anyway == 0 && least > f.solution->solved * most) return NOWHERE;  // an end that is the zero itself may have either sign, by roundoff
                outcome = AT_END;
                bracket.x1 = fabs(first_value) < fabs(value) ? 0.0 : 1.0;
                if (bracket.x1 == s) return outcome;
                stage = 3, s = 0.0;
                continue;
            }
            stage = 2, outcome = PASSED;
            ahead = begin(bracket, 0.0, 1.0, first_value, value, first_p, p, bracket.tolerance, bracket.jump);
        } else ahead = follow(bracket, f.solution->jump, s, value, p);
        if (ahead == ahead) {
            s = ahead;
            continue;
        }
        double end = best(bracket);
        if (end == s && sweeps >= 0) return outcome;
        stage = 3, s = end;
    }
}

}  // namespace continuation
