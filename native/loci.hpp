// Special points of a compiled problem as solutions of a larger one, against a second parameter: minimally augmented systems. The
// reference, which says how and why: contvines/loci/kernels.py.
#pragma once
#include "march.hpp"

namespace loci {

enum Condition { FOLD, FLIP, MARGIN, PAIR, BRANCH };
enum SolutionRow { ALONG, NULL_VECTOR, TESTED, LEFT, SPARE };
enum BorderRow { B, C, FLIP_B, FLIP_C };
enum StateEntry { VALID, SIGN, ANGLE, AGE };
constexpr double STEP = 1e-7, STILL = 1e-7, LONGEST = 4.0, TURNED = 1.02;

// See LocusData and Work in contvines/loci/problem.py.
struct Data {
    const Table* table;
    void *first, *second;  // data of the problem against either parameter
    whole kind, which, multipliers, flow;
    double unit;
};
struct Work {
    whole n, last, masks;  // unknowns of the problem; of the locus; masked margins
    void *base, *trial;    // workspaces of the problem, and places in them
    double *residual, *base_F, *base_Q, *trial_F, *trial_Q, *point, *columns, *solutions, *directions, *borders, *row, *shifted, *scales, *values,
        *slopes, *lines, *reference, *small;
    whole* masked;
    double *rows, *frozen, *steep, *state, *frame, *last_residual;
    whole row_size;
    double* solution(whole k) const { return solutions + k * (n + 1); }
    double* direction(whole k) const { return directions + k * (last + 1); }
    double* border(whole k) const { return borders + k * (n + 1); }
    double* line(whole k) const { return lines + k * (n + 1); }
};

// Solve M (v, g) = (0, 1) with the linearisation at hand, into `tangent`; returns g.
inline double null_test(const Data& d, const Work& w, const double* b, const double* c, double* step, double* tangent) {
    double* line = w.line(0);
    for (whole i = 0; i < w.n; i++) w.trial_F[i] = 0.0, w.trial_Q[i] = b[i], line[i] = c[i];
    line[w.n] = 0.0;
    d.table->bordered(d.first, w.trial, line, 0.0, step, tangent);
    return tangent[w.n];
}

// (test, position) of the pair nearest to the stability boundary and to the reference, into `found`.
inline void pair_of(const double* row, whole multipliers, bool flow, double reference, double* found) {
    double best = HUGE_VAL;
    found[0] = found[1] = NAN;
    for (whole i = 0; i < multipliers; i++)
        for (whole j = i + 1; j < multipliers; j++) {
            double a = row[2 * i], b = row[2 * i + 1], c = row[2 * j], e = row[2 * j + 1];
            if (fabs(b + e) > 1e-9 * (1.0 + fabs(b)) || (b != 0.0 && fabs(a - c) > 1e-9 * (1.0 + fabs(a)))) continue;
            double total = a + c, product = a * c - b * e, test = flow ? total : product - 1.0, place = flow ? product : 0.5 * total;
            double distance = fabs(test) + 0.1 * fabs(place - reference) / (flow ? 1.0 + fabs(reference) : 1.0);
            if (distance < best) best = distance, found[0] = test, found[1] = place;
        }
}

// The tests g at any (u, p, q), into `values`; the linearisation in `trial` is used up. Returns the residual.
inline double tests(const Data& d, const Work& w, const double* u, double p, double q, double* values) {
    const Table& t = *d.table;
    t.assign(d.first, d.second, q);
    double residual = t.linearise(d.first, u, p, w.trial);
    if (!(residual < continuation::BEYOND)) return residual;
    double *tested = w.solution(TESTED), *line = w.line(0), *step = w.line(1);
    if (d.kind == FOLD) values[0] = null_test(d, w, w.border(B), w.border(C), step, tested);
    else if (d.kind == FLIP) {
        t.flip(d.first, w.trial, -1.0);
        values[0] = null_test(d, w, w.border(FLIP_B), w.border(FLIP_C), step, tested);
        t.flip(d.first, w.trial, 1.0);
    } else if (d.kind == BRANCH) {
        for (whole i = 0; i < w.n; i++) w.trial_F[i] = d.unit * w.trial_Q[i], w.trial_Q[i] = w.border(B)[i], line[i] = w.border(C)[i];
        line[w.n] = 0.0;
        t.bordered(d.first, w.trial, line, 0.0, step, tested);
        values[0] = tested[w.n], values[1] = step[w.n];
    } else {
        t.inspect(d.first, u, p, w.trial, w.row);
        if (d.kind == MARGIN) values[0] = w.row[2 * d.multipliers + d.which];
        else {
            pair_of(w.row, d.multipliers, d.flow, w.reference[0], w.reference + 1);
            values[0] = w.reference[1];
        }
    }
    return residual;
}

// Derivatives of the tests along a direction in (U, q), by differences.
inline void slopes_along(const Data& d, const Work& w, const double* direction, double* slopes) {
    const whole n = w.n, last = w.last, count = last - n;
    double length = fabs(direction[last]) / larger(w.scales[last], fabs(w.point[last]));
    for (whole i = 0; i <= n; i++) length = larger(length, fabs(direction[i]) / larger(w.scales[i], fabs(w.point[i])));
    if (!(length > 1e-14)) {
        for (whole k = 0; k < count; k++) slopes[k] = 0.0;
        return;
    }
    double h = STEP / length;
    for (whole i = 0; i <= n; i++) w.shifted[i] = w.point[i] + h * direction[i];
    tests(d, w, w.shifted, d.unit * w.shifted[n], w.point[last] + h * direction[last], slopes);
    for (whole k = 0; k < count; k++) slopes[k] = (slopes[k] - w.values[k]) / h;
}

// Whether directions and slopes are those of the last call, because the point has hardly moved; keeps the point if not.
inline bool frozen(const Work& w, const double* U, double q) {
    const whole last = w.last;
    bool still = w.state[VALID] > 0.0 && fabs(q - w.frozen[last]) < STILL * larger(w.scales[last], fabs(q));
    for (whole i = 0; i < last; i++)
        if (still && !(fabs(U[i] - w.frozen[i]) < STILL * larger(w.scales[i], fabs(U[i])))) still = false;
    if (still) return true;
    for (whole i = 0; i < last; i++) w.frozen[i] = U[i];
    w.frozen[last] = q;
    return false;
}

// ---- directions in (U, q) along which F = 0 holds to first order ----------------------------------------------------------------------
inline void rotate(const Work& w, double angle) {
    double s, c, *one = w.columns, *two = w.columns + w.n;
    sine_cosine(angle, s, c);
    for (whole i = 0; i < w.n; i++) {
        double a = one[i], b = two[i];
        one[i] = c * a + s * b, two[i] = c * b - s * a;
    }
}
// Angle and row from the two directions found last; returns by how much the angle changes.
inline double turn(const Work& w) {
    const double *along = w.solution(ALONG), *null = w.solution(NULL_VECTOR);
    const whole n = w.n;
    double angle = -arctangent(along[n]), size = null[n] * null[n];
    for (whole i = 0; i < n; i++) size += (null[i] / w.scales[i]) * (null[i] / w.scales[i]);
    if (!(0.0 < size && size < HUGE_VAL && -2.0 < angle && angle < 2.0)) return 0.0;
    for (whole i = 0; i < n; i++) w.frame[i] = null[i] / w.scales[i] / w.scales[i] / size;
    w.frame[n] = cosine(angle) * null[n] / size;
    w.state[ANGLE] += angle;
    return angle;
}
// Direction k: unknowns of a solution, and what its part along C1 means for the parameters.
inline void parted(const Work& w, whole k, const double* solution) {
    double *direction = w.direction(k), s, c;
    sine_cosine(w.state[ANGLE], s, c);
    for (whole i = 0; i < w.n; i++) direction[i] = solution[i];
    direction[w.n] = solution[w.n] * c * w.scales[w.n];
    direction[w.last] = solution[w.n] * s * w.scales[w.last];
}
inline void plain_row(const Work& w) {
    double* row = w.line(0);
    for (whole i = 0; i < w.n; i++) row[i] = w.border(C)[i];
    row[w.n] = 0.0;
}
// [[F_u, column], [row]] x = (-side, 0) into `step`, (0, 1) into `tangent`; returns the determinant's sign.
inline double solve(const Data& d, const Work& w, const double* side, const double* column, const double* row, double* step, double* tangent) {
    for (whole i = 0; i < w.n; i++) w.base_F[i] = side[i], w.base_Q[i] = column[i];
    return d.table->bordered(d.first, w.base, row, 0.0, step, tangent);
}
// The directions but the particular one; F_p and F_q, in the units of U and q, are in `columns` and are used up.
inline void span(const Data& d, const Work& w) {
    const whole n = w.n, last = w.last;
    double *along = w.solution(ALONG), *null = w.solution(NULL_VECTOR), *one = w.columns, *two = w.columns + n;
    if (d.kind == BRANCH) {
        plain_row(w);
        for (whole k = 0; k < 2; k++) {
            solve(d, w, w.columns + k * n, w.border(B), w.line(0), along, null);
            double* direction = w.direction(1 + k);
            for (whole i = 0; i < n; i++) direction[i] = along[i];
            direction[n] = 1.0 - double(k), direction[n + 1] = along[n], direction[last] = double(k);
        }
        double* direction = w.direction(3);
        for (whole i = 0; i < n; i++) direction[i] = null[i];
        direction[n] = 0.0, direction[n + 1] = null[n], direction[last] = 0.0;
    } else {
        for (whole i = 0; i < n; i++) one[i] *= w.scales[n], two[i] *= w.scales[last];
        if (w.state[VALID] >= 0.0) {
            turn(w);
            rotate(w, w.state[ANGLE]);
        } else {  // any row, then the one that belongs to this place
            for (whole i = 0; i < n; i++) w.frame[i] /= w.scales[i];
            rotate(w, w.state[ANGLE]);
            solve(d, w, two, one, w.frame, along, null);
            rotate(w, turn(w));
        }
        solve(d, w, two, one, w.frame, along, null);
        parted(w, 1, null), parted(w, 2, along);
        double s, c;
        sine_cosine(w.state[ANGLE], s, c);
        w.direction(2)[n] -= s * w.scales[n], w.direction(2)[last] += c * w.scales[last];
    }
    w.state[VALID] = 0.0;
}
// Direction 0: what makes up for the residuals of F; returns the sign of the elimination.
inline double particular(const Data& d, const Work& w) {
    double *found = w.solution(SPARE), *spare = w.solution(SPARE + 1), *direction = w.direction(0), sign;
    if (d.kind == BRANCH) {
        plain_row(w);
        sign = solve(d, w, w.residual, w.border(B), w.line(0), found, spare);
        for (whole i = 0; i < w.n; i++) direction[i] = found[i];
        direction[w.n] = 0.0, direction[w.n + 1] = found[w.n], direction[w.last] = 0.0;
    } else {
        sign = solve(d, w, w.residual, w.columns, w.frame, found, spare);
        parted(w, 0, found);
    }
    return sign;
}

// ---- the table of a locus ---------------------------------------------------------------------------------------------------------
// F, F_u, F_p, F_q and the tests at (U, q).
inline double linearise(void* data, const double* U, double q, void* work) {
    const Data& d = *static_cast<Data*>(data);
    const Work& w = *static_cast<Work*>(work);
    const Table& t = *d.table;
    const whole n = w.n, size = w.last;
    const double p = d.unit * U[n];
    const bool still = frozen(w, U, q);
    if (!still) {
        w.state[VALID] = smaller(w.state[VALID], 0.0);
        t.assign(d.second, d.first, p);
        if (!(t.linearise(d.second, U, q, w.base) < continuation::BEYOND)) return HUGE_VAL;
        for (whole i = 0; i < n; i++) w.columns[n + i] = w.base_Q[i];
    }
    t.assign(d.first, d.second, q);
    double largest = t.linearise(d.first, U, p, w.base);
    if (!(largest < continuation::BEYOND)) return HUGE_VAL;
    for (whole i = 0; i < n; i++) w.residual[i] = w.base_F[i] + (d.kind == BRANCH ? U[n + 1] * w.border(B)[i] : 0.0);
    if (!still) {
        for (whole i = 0; i < n; i++) w.columns[i] = d.unit * w.base_Q[i];
        span(d, w);
    }
    w.state[SIGN] = particular(d, w);
    for (whole i = 0; i < size; i++) w.point[i] = U[i] + w.direction(0)[i];
    w.point[size] = q + w.direction(0)[size];
    tests(d, w, w.point, d.unit * w.point[n], w.point[size], w.values);
    for (whole k = 0; k < size - n; k++) {
        w.residual[n + k] = w.values[k];
        if (!(fabs(w.values[k]) < HUGE_VAL)) return HUGE_VAL;
        largest = larger(largest, fabs(w.values[k]));
    }
    for (whole i = 0; i < size; i++) w.last_residual[i] = w.residual[i];
    return largest;
}

// Gauss elimination with row exchange of `size` equations with two right-hand sides; returns the determinant's sign.
inline double close(double* small, whole size) {
    auto at = [&](whole i, whole j) -> double& { return small[5 * i + j]; };
    double sign = 1.0;
    for (whole j = 0; j < size; j++) {
        whole best = j;
        for (whole i = j + 1; i < size; i++)
            if (fabs(at(i, j)) > fabs(at(best, j))) best = i;
        if (best != j) {
            sign = -sign;
            for (whole c = 0; c < 5; c++) swap(at(j, c), at(best, c));
        }
        if (at(j, j) == 0.0) at(j, j) = 1e-300;
        if (at(j, j) < 0.0) sign = -sign;
        for (whole i = j + 1; i < size; i++) {
            double ratio = at(i, j) / at(j, j);
            for (whole c = j; c < 5; c++) at(i, c) -= ratio * at(j, c);
        }
    }
    for (whole j = size - 1; j >= 0; j--)
        for (whole side = 3; side < 5; side++) {
            for (whole c = j + 1; c < size; c++) at(j, side) -= at(j, c) * at(c, side);
            at(j, side) /= at(j, j);
        }
    return sign;
}

inline double bordered(void* data, void* work, const double* border, double target, double* step, double* tangent) {
    const Data& d = *static_cast<Data*>(data);
    const Work& w = *static_cast<Work*>(work);
    const whole n = w.n, last = w.last, count = last - n, total = count + 1;  // tests; directions besides the particular one
    bool own = true;  // the residuals are those of the point, for which the particular direction stands
    for (whole i = 0; i < last; i++)
        if (w.residual[i] != w.last_residual[i]) own = false;
    for (whole k = 0; k < count; k++) w.slopes[k] = 0.0;
    if (!own) {
        w.state[SIGN] = particular(d, w);
        slopes_along(d, w, w.direction(0), w.slopes);
        for (whole i = 0; i < last; i++) w.last_residual[i] = NAN;
    }
    double across = 0.0, *small = w.small;
    for (whole i = 0; i <= last; i++) across += border[i] * w.direction(0)[i];
    for (whole k = 0; k < count; k++) small[5 * k + 3] = -w.residual[n + k] - w.slopes[k], small[5 * k + 4] = 0.0;
    small[5 * count + 3] = target - across, small[5 * count + 4] = 1.0;
    const whole width = count > 2 ? count : 2;  // of `steep`
    for (whole column = 0; column < total; column++) {
        double *steep = w.steep + column * width, along = 0.0;
        if (w.state[VALID] < 1.0) slopes_along(d, w, w.direction(1 + column), steep);
        for (whole k = 0; k < count; k++) small[5 * k + column] = steep[k];
        for (whole i = 0; i <= last; i++) along += border[i] * w.direction(1 + column)[i];
        small[5 * count + column] = along;
    }
    w.state[VALID] = 1.0;
    for (whole i = 0; i < total; i++)
        for (whole column = total; column < 3; column++) small[5 * i + column] = 0.0;
    double sign = w.state[SIGN] * close(small, total);
    for (whole i = 0; i <= last; i++) {
        step[i] = w.direction(0)[i], tangent[i] = 0.0;
        for (whole column = 0; column < total; column++) {
            step[i] += small[5 * column + 3] * w.direction(1 + column)[i];
            tangent[i] += small[5 * column + 4] * w.direction(1 + column)[i];
        }
    }
    return sign;
}

// Borders from the null vectors: c along `null`, b along the left one, in units of the scales; the linearisation is in `base`.
inline void renew(const Data& d, const Work& w, double* b, double* c, const double* null) {
    const whole n = w.n;
    double *line = w.line(0), *left = w.solution(LEFT), size = 0.0;
    for (whole i = 0; i < n; i++) size += (null[i] / w.scales[i]) * (null[i] / w.scales[i]);
    if (!(0.0 < size && size < HUGE_VAL)) return;
    size = sqrt(size);
    for (whole i = 0; i < n; i++) c[i] = null[i] / w.scales[i] / w.scales[i] / size, line[i] = b[i];
    line[n] = 0.0;
    d.table->transpose(d.first, w.base, c, w.trial);
    for (whole i = 0; i < n; i++) w.trial_F[i] = 0.0;
    d.table->bordered(d.first, w.trial, line, 0.0, w.line(1), left);
    size = 0.0;
    for (whole i = 0; i < n; i++) size += (left[i] * w.rows[i]) * (left[i] * w.rows[i]);
    if (!(0.0 < size && size < HUGE_VAL)) return;
    size = sqrt(size);
    for (whole i = 0; i < n; i++) b[i] = left[i] * w.rows[i] * w.rows[i] / size;
}
// Whether borders are due: the null vector has turned away from c, or they have served a few points.
inline bool worn(const Work& w, const double* null) {
    double size = 0.0;
    for (whole i = 0; i < w.n; i++) size += (null[i] / w.scales[i]) * (null[i] / w.scales[i]);
    w.state[AGE] += 1.0;
    if (w.state[AGE] < LONGEST && size < TURNED * TURNED) return false;
    w.state[AGE] = 0.0;
    return true;
}
// Multipliers and margins of the problem, then of the locus: p within its bounds, and the pair still a pair.
inline void inspect(void* data, const double* U, double q, void* work, double* row) {
    const Data& d = *static_cast<Data*>(data);
    const Work& w = *static_cast<Work*>(work);
    const Table& t = *d.table;
    if ((d.kind == FOLD || d.kind == BRANCH || d.kind == FLIP) && worn(w, w.solution(TESTED))) {
        w.state[VALID] = smaller(w.state[VALID], 0.0);  // slopes belong to the borders
        if (d.kind != FLIP) renew(d, w, w.border(B), w.border(C), w.solution(TESTED));
        else {
            t.flip(d.first, w.base, -1.0);
            renew(d, w, w.border(FLIP_B), w.border(FLIP_C), w.solution(TESTED));
            t.flip(d.first, w.base, 1.0);
        }
    }
    double* own = row + w.row_size;
    t.assign(d.first, d.second, q);  // the tests have asked nearby
    t.inspect(d.first, U, d.unit * U[w.n], w.base, row);
    own[0] = U[w.n] - w.reference[3], own[1] = w.reference[4] - U[w.n], own[2] = HUGE_VAL;
    for (whole j = 0; j < w.masks; j++) row[2 * d.multipliers + w.masked[j]] = HUGE_VAL;
    if (d.kind == PAIR) {
        pair_of(row, d.multipliers, d.flow, w.reference[0], w.reference + 1);
        w.reference[0] = w.reference[2];
        own[2] = d.flow ? w.reference[2] : 1.0 - w.reference[2] * w.reference[2];
    }
}

inline constexpr Table table = {linearise, bordered, inspect, nullptr, nullptr, nullptr};

}  // namespace loci
