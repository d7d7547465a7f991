// What a chunk of points tells about special points between them, in one pass; the reference: contvines/bifurcation/scan.py.
#pragma once
#include "march.hpp"

namespace continuation {

constexpr double MARGIN = -1e-12;  // of contvines/continuation/layout.py

constexpr double PAST = 1e-10;  // multipliers of a conservative system lie on the circle up to roundoff

// Of one problem. Signed permutations T: u - T(u) of column j is u[j] - (signs[j] u[orders[j]] + constants[j]), modulo `shift`.
struct Scanner {
    whole unknowns, row, multipliers, kind, symmetries;
    Metric metric;
    const whole* orders;
    const double *signs, *constants, *shift;
    double* room;  // (2, symmetries, unknowns)
};
// A chunk, and what is found: one array after the other from `lengths` on.
struct Scanned : Scanner {
    whole count;
    double flat;  // slopes up to this are rounding
    const double *points, *values, *tangents, *rows, *determinants;
    double *lengths, *smallest = lengths + count - 1, *near = smallest + count, *past = near + 3 * count, *pairs = past + 3 * count,
           *low = pairs + count, *sizes = low + row - 2 * multipliers, *turns = sizes + symmetries * count;
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

// Below the lowest of three points a parabola falls by a part of the changes between them: at most a quarter of the square of the longer
// length over the shorter one. Of a pair (`unlike`) see contvines/bifurcation/evidence.py.
inline double fall(double one, double other) {
    const double uneven = larger(one / other, other / one);
    return 0.5 * uneven * uneven;
}
inline bool may_fall(const double* to, double part, double unlike = 0.0) {
    const double a = fabs(to[-2]), b = fabs(to[-1]), c = fabs(to[0]);
    return smaller(smaller(a, b), c) - unlike * larger(larger(a, b), c) < part * larger(fabs(to[-1] - to[-2]), fabs(to[0] - to[-1]));
}

// Whether the slopes, signs and multipliers of the last two or three points up to i leave open that there is something between them.
inline bool open_at(const Scanned& s, whole i) {
    constexpr double UNLIKE = 0.2, STRAIGHT = 4.0;  // a straight line falls further than a parabola
    const whole n = s.unknowns;
    const double *slope = s.tangents + i * (n + 1) + n, here = slope[-n - 1], there = slope[0], length = s.lengths[i - 1];
    if (!(fabs(here) > s.flat && fabs(there) > s.flat && here * there > 0.0 && s.determinants[i] * s.determinants[i - 1] > 0.0)) return true;
    const double one = fabs(here), other = fabs(there), mean = (here > 0.0 ? s.values[i] - s.values[i - 1] : s.values[i - 1] - s.values[i]) / length;
    const double bend = 3.0 * (one + other - 2.0 * mean), middle = 2.0 * one + other - 3.0 * mean;
    if (bend > 0.0 && middle > 0.0 && middle < bend && one * bend < middle * middle) return true;  // the cubic turns twice
    if (s.pairs[i] != s.pairs[i - 1]) return true;
    for (int sort = 0; sort < 3; sort++)
        if (s.past[sort * s.count + i] != s.past[sort * s.count + i - 1]) return true;
    if (i < 2) return false;
    const double part = fall(s.lengths[i - 2], length), slopes[] = {slope[-2 * n - 2], here, there};
    return may_fall(slopes + 2, part) || may_fall(s.near + i, STRAIGHT * part) || may_fall(s.near + s.count + i, part) ||
           may_fall(s.near + 2 * s.count + i, part, UNLIKE);
}

// Returns whether nothing is open.
inline bool scan(const Scanned& s) {
    const whole n = s.unknowns, width = s.row - 2 * s.multipliers;
    const double period = sum(n, [&](whole j) { return s.shift[j] * s.shift[j]; });
    bool quiet = s.kind != REAL;  // where pairs tell, too
    for (whole j = 0; j < width; j++) s.low[j] = 0.0;
    for (whole i = 0; i < s.count; i++) {
        const double *point = s.points + i * n, *row = s.rows + i * s.row, *c = row + 2 * s.multipliers;
        multipliers_of(s, row, i);
        s.smallest[i] = joined(width, HUGE_VAL, smaller, [&](whole j) { return c[j]; });
        quiet &= s.smallest[i] >= MARGIN;
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
        quiet = quiet && !open_at(s, i);
        if (i == 1) continue;
        const double part = fall(s.lengths[i - 2], s.lengths[i - 1]), *b = c - s.row, *a = b - s.row;
        for (whole j = 0; j < width; j++) {
            const double least = smaller(smaller(fabs(a[j]), fabs(b[j])), fabs(c[j])) + MARGIN, most = larger(fabs(b[j] - a[j]), fabs(c[j] - b[j]));
            s.low[j] = (least < part * most) & (most < HUGE_VAL) ? 1.0 : s.low[j];
        }
    }
    return quiet && sum(width, [&](whole j) { return s.low[j]; }) == 0.0;
}

}  // namespace continuation
