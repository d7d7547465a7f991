// What a chunk of points tells about special points between them, in one pass; the reference: contvines/bifurcation/scan.py.
#pragma once
#include "march.hpp"

namespace continuation {

constexpr double MARGIN = -1e-12;  // of contvines/continuation/layout.py

constexpr double FASTER = 2.0;     // times the rate that neighbouring segments tell
constexpr double PAST = 1e-10;  // multipliers of a conservative system lie on the circle up to roundoff

// Of one problem. Signed permutations T: u - T(u) of column j is u[j] - (signs[j] u[orders[j]] + constants[j]), modulo `shift`.
struct Scanner {
    whole unknowns, row, multipliers, kind, symmetries;
    Metric metric;
    const whole* orders;
    const double *signs, *constants, *shift;
    double* room;  // (2, symmetries, unknowns)
};
// Where a multiplier is: the logarithm of its size and its direction (of an eigenvalue real and imaginary part, NaN where nothing is known);
// how far the nearest one of the next point is, and of the one before, all in all and from the line, whether one of a pair is real there, and which it is.
struct Link {
    double gap, towards;
    whole born, at;
};
struct Place {
    double size, x, y;
    Link ahead, back;
};
// A chunk, and what is found: one array after the other from `lengths` on. Of the distances from 1 and from -1 (from 0) gaps, (4, count), are the
// nearest ones, then the products.
struct Scanned : Scanner {
    whole count;
    double flat;  // slopes up to this are rounding
    const double *points, *values, *tangents, *rows, *determinants;
    double *lengths, *smallest = lengths + count - 1, *gaps = smallest + count, *past = gaps + 4 * count, *reached = past + 3 * count,
           *low = reached + count - 1, *sizes = low + row - 2 * multipliers, *turns = sizes + symmetries * count;
    Place* places = (Place*)(turns + symmetries * (count - 1));  // (count, multipliers)
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

// How many of each sort (near 1, near -1, pairs) are past the circle, and how far all are from 1 and from -1.
inline void multipliers_of(const Scanned& s, const double* row, whole i) {
    double near[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, past[3] = {}, products[2] = {1.0, 1.0};
    Place* place = s.places + i * s.multipliers;
    for (whole k = 0; k < s.multipliers && s.kind != NONE; k++) {
        const double re = row[2 * k], im = row[2 * k + 1];
        const bool real = im == 0.0, map = s.kind == MAP;
        const int sort = s.kind == REAL ? 0 : !real ? 2 : map && !(re > 0.0) ? 1 : 0;
        const double by_size = 1.0 / (1.0 + (real ? fabs(re) : hypotenuse(re, im)));
        for (int side = 0; side < (map ? 2 : 1); side++) {
            const double along = map ? re - 1.0 + 2.0 * side : re, part = (real ? fabs(along) : hypotenuse(along, im)) * by_size;
            products[side] *= part > PAST ? part : 1.0;
        }
        place[k] = {NAN, NAN, NAN, {HUGE_VAL, 0.0, 0, k}, {HUGE_VAL, 0.0, 0, k}};
        if (s.kind != REAL && !real && !(im > 0.0)) continue;
        const double modulus = real ? fabs(re) : hypotenuse(re, im), size = map ? logarithm(modulus) : re;
        past[sort] += size > PAST;
        if (fabs(size) < near[sort]) near[sort] = fabs(size);
        const double x = map ? re / modulus : 0.0, y = map ? im / modulus : im;
        if (isfinite(size) && isfinite(x) && isfinite(y)) place[k].size = size, place[k].x = x, place[k].y = y;
    }
    for (int sort = 0; sort < 3; sort++) s.past[sort * s.count + i] = past[sort];
    for (int side = 0; side < 2; side++) {
        s.gaps[side * s.count + i] = near[side] > PAST && near[side] < HUGE_VAL ? near[side] : NAN;
        s.gaps[(2 + side) * s.count + i] = products[side];
    }
}

// The nearest multiplier at the next point of each one of point i - 1, and at the point before of each one of point i.
inline void join(const Scanned& s, whole i) {
    Place *before = s.places + (i - 1) * s.multipliers, *here = before + s.multipliers;
    for (whole j = 0; j < s.multipliers; j++)
        for (whole k = 0; k < s.multipliers; k++) {
            const double along = here[k].size - before[j].size, x = here[k].x - before[j].x, y = here[k].y - before[j].y;
            const double gap = sqrt(along * along + (x * x + y * y));
            const double* row = s.rows + i * s.row;
            const whole born = (row[2 * k + 1] > 0.0) != (row[2 * j + 1 - s.row] > 0.0);
            if (gap < before[j].ahead.gap) before[j].ahead = {gap, fabs(along), born, k};
            if (gap < here[k].back.gap) here[k].back = {gap, fabs(along), born, j};
        }
}
// Whether the parabola of the product of all distances from 1, or from -1, or of the nearest, through point i and the two beside it passes zero.
inline bool dips(const Scanned& s, whole i) {
    if (i == 0 || i + 1 == s.count) return false;
    const double h1 = s.lengths[i - 1], h2 = s.lengths[i];
    for (int side = 0; side < 4; side++) {
        const double *gap = s.gaps + side * s.count + i, *past = s.past + side % 2 * s.count + i;
        if (past[-1] != past[0] || past[1] != past[0]) continue;
        const double before = (gap[0] - gap[-1]) / h1, after = (gap[1] - gap[0]) / h2;
        const double bend = (after - before) / (h1 + h2), slope = (before * h2 + after * h1) / (h1 + h2);
        if (bend > 0.0 && -2.0 * bend * h1 < -slope && -slope < 2.0 * bend * h2 && 4.0 * bend * gap[0] < slope * slope) return true;
    }
    return false;
}
// Whether one of a pair at one end of segment i, or at the other, may have reached the circle between; see `reached` in the reference.
inline bool reaches(const Scanned& s, whole i) {
    const whole m = s.multipliers;
    const double length = s.lengths[i];
    for (whole j = 0; j < 2 * m; j++) {
        const bool last = j >= m;
        const whole from = last ? i + 1 : i, to = last ? i : i + 1;
        const Place& a = s.places[from * m + j % m];
        const Link own = last ? a.back : a.ahead;
        if (!(s.rows[from * s.row + 2 * (j % m) + 1] > 0.0 && own.gap < HUGE_VAL)) continue;
        const Place& b = s.places[to * m + own.at];
        const Place &left = last ? b : a, &right = last ? a : b;
        double anyway = 0.0, towards = 0.0;
        whole born = 0;
        const auto heed = [&](const Link& link, double over) {
            if (!(link.gap < HUGE_VAL)) return;
            anyway = larger(anyway, link.gap / over), towards = larger(towards, link.towards / over), born |= link.born;
        };
        heed(own, length);
        if (i > 0) heed(left.back, s.lengths[i - 1]);
        if (i + 2 < s.count) heed(right.ahead, s.lengths[i + 1]);
        const double way = larger(own.gap, FASTER * length * (born ? anyway : towards));
        if (smaller(fabs(a.size), fabs(b.size)) > PAST && way >= fabs(a.size) + fabs(b.size)) return true;
    }
    return false;
}

// Below the lowest of three points a parabola falls by a part of the changes between them: at most a quarter of the square of the longer
// length over the shorter one.
inline double fall(double one, double other) {
    const double uneven = larger(one / other, other / one);
    return 0.5 * uneven * uneven;
}
inline bool may_fall(const double* to, double part) {
    const double a = fabs(to[-2]), b = fabs(to[-1]), c = fabs(to[0]);
    return smaller(smaller(a, b), c) < part * larger(fabs(to[-1] - to[-2]), fabs(to[0] - to[-1]));
}

// Whether the slopes, signs and multipliers of the last two or three points up to i leave open that there is something between them.
inline bool open_at(const Scanned& s, whole i) {
    constexpr double STRAIGHT = 4.0;  // a straight line falls further than a parabola
    const whole n = s.unknowns;
    const double *slope = s.tangents + i * (n + 1) + n, here = slope[-n - 1], there = slope[0], length = s.lengths[i - 1];
    if (!(fabs(here) > s.flat && fabs(there) > s.flat && here * there > 0.0 && s.determinants[i] * s.determinants[i - 1] > 0.0)) return true;
    const double one = fabs(here), other = fabs(there), mean = (here > 0.0 ? s.values[i] - s.values[i - 1] : s.values[i - 1] - s.values[i]) / length;
    const double bend = 3.0 * (one + other - 2.0 * mean), middle = 2.0 * one + other - 3.0 * mean;
    if (bend > 0.0 && middle > 0.0 && middle < bend && one * bend < middle * middle) return true;  // the cubic turns twice
    for (int sort = 0; sort < 3; sort++)
        if (s.past[sort * s.count + i] != s.past[sort * s.count + i - 1]) return true;
    if (i < 2) return false;
    const double part = fall(s.lengths[i - 2], length), slopes[] = {slope[-2 * n - 2], here, there};
    return may_fall(slopes + 2, part) || may_fall(s.gaps + i, STRAIGHT * part);
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
        join(s, i);
        if (i == 1) continue;
        const double part = fall(s.lengths[i - 2], s.lengths[i - 1]), *b = c - s.row, *a = b - s.row;
        for (whole j = 0; j < width; j++) {
            const double least = smaller(smaller(smaller(HUGE_VAL, fabs(a[j])), fabs(b[j])), fabs(c[j])) + MARGIN;
            const double most = larger(larger(-1.0, fabs(b[j] - a[j])), fabs(c[j] - b[j]));  // passing over what is no number
            s.low[j] = (least < part * most) & (most < HUGE_VAL) ? 1.0 : s.low[j];
        }
    }
    for (whole i = 0; i + 1 < s.count; i++) {
        s.reached[i] = dips(s, i) || dips(s, i + 1) || ((s.kind == MAP || s.kind == FLOW) && reaches(s, i)) ? 1.0 : 0.0;
        quiet &= s.reached[i] == 0.0;
    }
    return quiet && sum(width, [&](whole j) { return s.low[j]; }) == 0.0;
}

}  // namespace continuation
