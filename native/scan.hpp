// In which segments of a branch may there be something to locate? One pass over a chunk of points; the reference with all
// docstrings is contvines/bifurcation/scan.py.
#pragma once
#include "elimination.hpp"
#include "march.hpp"

namespace continuation {

enum Flag { FOLD = 1, SINGULAR = 2, PAST_CIRCLE = 4, BORDER = 8, MEETING = 16, SHALLOW = 32, DAMPED = 64, HUMP = 128, LANDING = 8192 };
constexpr double APART = 1e-6, NEXT = 0.1, WITHIN = 1e-4;

// Signed permutations T: u - T(u) of column j is u[j] - (images[j] u[orders[j]] + constants[j]), modulo `shift`; `gaps` is room.
struct Symmetries { whole count, columns; const whole* orders; const double *images, *constants, *shift; double* gaps; };
struct Scanned { whole count, unknowns, row; const double *points, *values, *slopes, *rows, *signs; };

using algebra::Four;
using algebra::FourWholes;
inline Four load(const double* from) {
    Four x;
    __builtin_memcpy(&x, from, sizeof x);
    return x;
}

// Whether the parabola through three neighbouring positive values dips below zero between them.
inline bool dips(double left, double middle, double right, double h1, double h2) {
    if (!(left > 0.0 && middle > 0.0 && right > 0.0 && h1 > 0.0 && h2 > 0.0)) return false;
    if (!(left < HUGE_VAL && middle < HUGE_VAL && right < HUGE_VAL)) return false;
    double before = (middle - left) / h1, after = (right - middle) / h2, bend = (after - before) / (h1 + h2);
    if (!(bend > 0.0)) return false;
    double slope = (before * h2 + after * h1) / (h1 + h2), vertex = -0.5 * slope / bend;
    return -h1 < vertex && vertex < h2 && middle - 0.25 * slope * slope / bend < 0.0;
}
// Whether the cubic with these positive slopes at its ends, and this mean slope, falls in between: two folds.
inline bool turns_twice(double here, double there, double mean) {
    double bend = 3.0 * (here + there - 2.0 * mean), middle = 2.0 * here + there - 3.0 * mean;
    return bend > 0.0 && 0.0 < middle && middle < bend && here * bend < middle * middle;
}
// Whether one of the margins dips before the last of three points. Below the lowest of them a parabola falls by at most `share` of the changes.
inline bool one_dips(const double* a, const double* b, const double* c, whole width, double h1, double h2, double share) {
    whole suspects = 0;
    for (whole j = 0; j < width; j++) {
        double least = b[j] < a[j] ? b[j] : a[j];
        least = c[j] < least ? c[j] : least;
        suspects += least - MARGIN < share * (fabs(b[j] - a[j]) + fabs(c[j] - b[j]));
    }
    if (suspects == 0) return false;
    for (whole j = 0; j < width; j++)
        if (dips(a[j] - MARGIN, b[j] - MARGIN, c[j] - MARGIN, h1, h2)) return true;
    return false;
}

// Fill `flags` (n - 1,), bits per segment, and `smallest` (n,), the smallest margin (infinity without margins).
inline void mark_segments(const Scanned& chunk, whole first_margin, whole kind, bool real, double flat, double past, Metric metric,
                          const Symmetries& sym, whole* flags, double* smallest) {
    const whole columns = sym.columns, width = chunk.row - first_margin;
    double period = 0.0;
    for (whole j = 0; j < columns; j++) period += sym.shift[j] * sym.shift[j];
    whole plus = 0, minus = 0, pairs = 0;
    double outermost = 0.0, before = 0.0, before_that = 0.0, short_ = 0.0;
    for (whole i = 0; i < chunk.count; i++) {
        const double *row = chunk.rows + i * chunk.row, *margins = row + first_margin, *point = chunk.points + i * chunk.unknowns;
        Four least = {HUGE_VAL, HUGE_VAL, HUGE_VAL, HUGE_VAL};  // comparisons pass over NaN
        whole j = 0;
        for (; j + 3 < width; j += 4) {
            Four x = load(margins + j);
            least = x < least ? x : least;
        }
        for (; j < width; j++) least[0] = margins[j] < least[0] ? margins[j] : least[0];
        smallest[i] = smaller(smaller(least[0], least[1]), smaller(least[2], least[3]));
        const whole old_plus = plus, old_minus = minus, old_pairs = pairs;  // multipliers past the circle
        before_that = before, before = outermost;
        plus = minus = pairs = 0, outermost = -HUGE_VAL;
        for (j = 0; j < first_margin; j += 2) {
            double re = row[j], im = row[j + 1];
            if (kind == MAP) {
                double modulus = im == 0.0 ? fabs(re) : sqrt(re * re + im * im);
                outermost = larger(outermost, modulus);
                if (im == 0.0) plus += re > 1.0 + past, minus += re < -1.0 - past;
                else pairs += im > 0.0 && modulus > 1.0 + past;
            } else if (kind == FLOW) {
                outermost = larger(outermost, re);
                if (im == 0.0) plus += re > past;
                else pairs += im > 0.0 && re > past;
            } else if (kind == REAL) plus += re > past;
        }
        const whole now = i % 2;  // the part that a symmetry changes, modulo shifts by a period
        for (whole s = 0; s < sym.count; s++) {
            double dot = 0.0, *gaps = sym.gaps + (now * sym.count + s) * columns;
            for (j = 0; j < columns; j++) {
                whole at = s * columns + j;
                gaps[j] = point[j] - (sym.images[at] * point[sym.orders[at]] + sym.constants[at]);
                dot += gaps[j] * sym.shift[j];
            }
            if (dot != 0.0) {
                double turns = rint(dot / period);
                for (j = 0; j < columns; j++) gaps[j] -= turns * sym.shift[j];
            }
        }
        if (i == 0) continue;
        const double here_slope = chunk.slopes[i - 1], there_slope = chunk.slopes[i];
        whole found = 0;
        if ((here_slope >= 0.0) != (there_slope >= 0.0) && (fabs(here_slope) > flat || fabs(there_slope) > flat)) found |= FOLD;
        if ((chunk.signs[i - 1] >= 0.0) != (chunk.signs[i] >= 0.0)) found |= SINGULAR;
        if (plus != old_plus || minus != old_minus || pairs != old_pairs) found |= PAST_CIRCLE;
        if ((smallest[i - 1] < MARGIN) != (smallest[i] < MARGIN) && (smallest[i] < MARGIN) == real) found |= BORDER;
        for (whole s = 0; s < sym.count; s++) {
            double here = 0.0, there = 0.0, dot = 0.0;
            const double *own = sym.gaps + (now * sym.count + s) * columns, *other = sym.gaps + ((1 - now) * sym.count + s) * columns;
            for (j = 0; j < columns; j++) here = larger(here, fabs(own[j])), there = larger(there, fabs(other[j])), dot += own[j] * other[j];
            if (dot < 0.0 && here > APART && there > APART) found |= MEETING;
            if (here < WITHIN && there > APART && here < NEXT * there) found |= LANDING;
        }
        flags[i - 1] = found;
        const double* old = point - chunk.unknowns;
        Four squares = {0.0, 0.0, 0.0, 0.0};
        for (j = 0; j + 3 < chunk.unknowns; j += 4) {
            Four change = load(point + j) - load(old + j);
            squares += change * change;
        }
        for (; j < chunk.unknowns; j++) squares[0] += (point[j] - old[j]) * (point[j] - old[j]);
        double change = chunk.values[i] - chunk.values[i - 1];
        double length = sqrt(metric.of_unknowns * ((squares[0] + squares[1]) + (squares[2] + squares[3])) + metric.of_parameter * change * change);
        if (here_slope * there_slope > 0.0 && fabs(here_slope) > flat && fabs(there_slope) > flat && length > 0.0) {
            double side = here_slope > 0.0 ? 1.0 : -1.0;
            if (turns_twice(side * here_slope, side * there_slope, side * change / length)) flags[i - 1] |= HUMP;
            if (i > 1 && dips(side * chunk.slopes[i - 2], side * here_slope, side * there_slope, short_, length)) flags[i - 2] |= HUMP, flags[i - 1] |= HUMP;
        }
        if (i > 1 && short_ > 0.0 && length > 0.0) {
            // a parabola through three values falls below the lowest of them by at most this part of the changes between them
            double uneven = larger(short_ / length, length / short_), share = 0.25 * uneven * uneven;
            double a = smallest[i - 2], b = smallest[i - 1], c = smallest[i];
            bool bounded = larger(larger(a, b), c) < HUGE_VAL;  // infinite without margins
            if (real && ((bounded && smaller(smaller(a, b), c) < share * (fabs(b - a) + fabs(c - b)) && dips(a, b, c, short_, length)) ||
                         one_dips(margins - 2 * chunk.row, margins - chunk.row, margins, width, short_, length, share)))
                flags[i - 2] |= SHALLOW, flags[i - 1] |= SHALLOW;
            if ((kind == MAP || kind == FLOW) && first_margin > 0) {
                a = before_that, b = before, c = outermost;
                double most = larger(larger(a, b), c), lowest = smaller(smaller(a, b), c), changes = fabs(b - a) + fabs(c - b);
                bool lost;
                if (kind == FLOW) lost = dips(-a, -b, -c, short_, length);
                else  // -log x is at least 1 - x, and steepest at the least x; logarithms take longer than all else here
                    lost = lowest > 0.0 && most < 1.0 && (1.0 - most) * lowest < share * changes &&
                           dips(-logarithm(a), -logarithm(b), -logarithm(c), short_, length);
                if (lost) flags[i - 2] |= DAMPED, flags[i - 1] |= DAMPED;
            }
        }
        short_ = length;
    }
}

}  // namespace continuation
