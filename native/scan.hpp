// What a chunk of points tells about special points between them, in one pass; the reference: contvines/bifurcation/scan.py.
#pragma once
#include "march.hpp"

namespace continuation {

constexpr double PAST = 1e-10;  // multipliers of a conservative system lie on the circle up to roundoff

// Signed permutations T: u - T(u) of column j is u[j] - (signs[j] u[orders[j]] + constants[j]), modulo `shift`.
struct Scanned {
    whole count, unknowns, row, multipliers, kind, symmetries;
    Metric metric;
    const double *points, *values, *rows;
    const whole* orders;
    const double *signs, *constants, *shift;
    double *room;  // (2, symmetries, unknowns)
    double *lengths, *smallest, *near, *past, *pairs, *least, *change, *sizes, *turns;
};

// Terms joined in four parts, so that the order is that of vector instructions whether there are any or not.
template <class Join, class Term> inline double joined(whole n, double none, Join join, Term term) {
    double part[4] = {none, none, none, none};
    whole j = 0;
    for (; j + 3 < n; j += 4)
        for (int k = 0; k < 4; k++) part[k] = join(part[k], term(j + k));
    for (; j < n; j++) part[0] = join(part[0], term(j));
    return join(join(part[0], part[1]), join(part[2], part[3]));
}
template <class Term> inline double sum(whole n, Term term) {
    return joined(n, 0.0, [](double a, double b) { return a + b; }, term);
}

// Of each sort (near 1, near -1, pairs) the distance of the nearest from the circle, negative where an odd number is past it.
inline void multipliers_of(const Scanned& s, const double* row, whole i) {
    double near[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, past[3] = {}, paired = 0.0;
    for (whole k = 0; k < s.multipliers && s.kind != NONE; k++) {
        const double re = row[2 * k], im = row[2 * k + 1];
        const bool real = im == 0.0, map = s.kind == MAP;
        const int sort = s.kind == REAL ? 0 : !real ? 2 : map && !(re > 0.0) ? 1 : 0;
        if (s.kind != REAL && !real && !(im > 0.0)) continue;
        const double size = map ? logarithm(real ? fabs(re) : hypotenuse(re, im)) : re;
        past[sort] += size > PAST, near[sort] = fabs(size) < near[sort] ? fabs(size) : near[sort];
        if (sort == 2 && isfinite(size)) paired = 1.0;
    }
    for (int sort = 0; sort < 3; sort++) {
        const bool told = near[sort] > PAST && near[sort] < HUGE_VAL;
        s.near[sort * s.count + i] = told ? (whole(past[sort]) % 2 ? -near[sort] : near[sort]) : NAN;
        s.past[sort * s.count + i] = past[sort];
    }
    s.pairs[i] = paired;
}

inline void scan(const Scanned& s) {
    const whole n = s.unknowns, width = s.row - 2 * s.multipliers;
    const double period = sum(n, [&](whole j) { return s.shift[j] * s.shift[j]; });
    for (whole j = 0; j < width; j++) s.least[j] = HUGE_VAL, s.change[j] = 0.0;
    for (whole i = 0; i < s.count; i++) {
        const double *point = s.points + i * n, *row = s.rows + i * s.row, *margins = row + 2 * s.multipliers;
        multipliers_of(s, row, i);
        const double* old = i > 0 ? margins - s.row : margins;
        for (whole j = 0; j < width; j++) {
            const double size = fabs(margins[j] - MARGIN), change = fabs(margins[j] - old[j]);
            s.least[j] = size < s.least[j] ? size : s.least[j];
            s.change[j] = change > s.change[j] ? change : s.change[j];
        }
        s.smallest[i] = joined(width, HUGE_VAL, smaller, [&](whole j) { return margins[j]; });
        for (whole k = 0; k < s.symmetries; k++) {
            double *gap = s.room + (i % 2 * s.symmetries + k) * n, *before = s.room + ((i + 1) % 2 * s.symmetries + k) * n;
            const whole* order = s.orders + k * n;
            const double *signs = s.signs + k * n, *constants = s.constants + k * n;
            for (whole j = 0; j < n; j++) gap[j] = point[j] - (signs[j] * point[order[j]] + constants[j]);
            const double turns = period > 0.0 ? rint(sum(n, [&](whole j) { return gap[j] * s.shift[j]; }) / period) : 0.0;
            if (turns != 0.0)
                for (whole j = 0; j < n; j++) gap[j] -= turns * s.shift[j];
            s.sizes[k * s.count + i] = joined(n, 0.0, larger, [&](whole j) { return fabs(gap[j]); });
            if (i > 0) s.turns[k * (s.count - 1) + i - 1] = sum(n, [&](whole j) { return gap[j] * before[j]; });
        }
        if (i == 0) continue;
        const double* last = point - n;
        const double change = s.values[i] - s.values[i - 1], squares = sum(n, [&](whole j) { return (point[j] - last[j]) * (point[j] - last[j]); });
        s.lengths[i - 1] = sqrt(s.metric.of_unknowns * squares + s.metric.of_parameter * change * change);
    }
}

}  // namespace continuation
