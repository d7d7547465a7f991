// Cycles of flows by Gauss collocation: equations and derivatives from values at the Gauss points, and their elimination in O(N).
// contvines/flows/cycles.py and elimination.py, the reference, say what is computed. Unknowns inside an interval, then those of one
// mesh point after the other, are eliminated by Householder reflections (Wright, SIAM J. Sci. Stat. Comput. 13 (1992) 742).
#pragma once
#include "math.hpp"

namespace collocation {

constexpr double TINY = 1e-300, LEAST = 1e-18;

// One cycle: N intervals of m Gauss points with d states; `free` where the period is an unknown (autonomous flows).
struct Cycle {
    whole count, degree, node, free;
    const double *values, *slopes, *weights, *scale;  // of the rule, (m, m + 1) twice and (m); (d)
    double clock, unit;                               // what counts as large in the period and in the parameter
    double *points, *rates;                           // x and x' at the Gauss points, (N, m, d)
    double *residual, *derivative;                    // F and F_p, (N m d + free + N)
    double *blocks, *by_period, *phase;               // (N, m d, (m + 1) d), (N, m d), (N, m d), in units of the scales
    double *columns, *rows, *foot, *left, *right, *states, *shared, *room;  // of `System`, where k = free + 1 and s = 2
};

// x and x' at the Gauss points of every interval.
inline void at_gauss_points(const Cycle& y, const double* x) {
    const whole m = y.degree, d = y.node;
    for (whole i = 0; i < y.count; i++) {
        const double *own = x + i * m * d, *after = i + 1 < y.count ? own + m * d : x;
        for (whole c = 0; c < m; c++) {
            const double *values = y.values + c * (m + 1), *slopes = y.slopes + c * (m + 1);
            double *at = y.points + (i * m + c) * d, *rate = y.rates + (i * m + c) * d;
            for (whole a = 0; a < d; a++) at[a] = values[m] * after[a], rate[a] = slopes[m] * after[a];
            for (whole j = 0; j < m; j++)
                for (whole a = 0; a < d; a++) at[a] += values[j] * own[j * d + a], rate[a] += slopes[j] * own[j * d + a];
        }
    }
}

// Residual and derivatives from f, df/dx and df/dp (null of forced flows) at the Gauss points; the phase condition is of unit length. Returns what
// its length was: 0 where nothing moves, NaN where one of the numbers is not finite.
inline double assemble(const Cycle& y, const double* widths, double period, const double* f, const double* jacobian, const double* slope) {
    const whole m = y.degree, d = y.node, width = (m + 1) * d, states = y.count * m * d;
    for (whole i = 0; i < states + y.free + y.count; i++) y.residual[i] = y.derivative[i] = 0.0;
    if (y.free)
        for (whole i = 0; i < states; i++) y.phase[i] = 0.0;
    double given = 0.0;
    for (whole i = 0; i < y.count; i++) {
        const double step = period * widths[i];
        double *own = y.phase + i * m * d, *after = i + 1 < y.count ? own + m * d : y.phase;
        for (whole c = 0; c < m; c++) {
            const double *values = y.values + c * (m + 1), *slopes = y.slopes + c * (m + 1), weight = widths[i] * y.weights[c];
            for (whole a = 0; a < d; a++) {
                const whole at = (i * m + c) * d + a;
                const double *J = jacobian + at * d, by = -step / y.scale[a];
                double* row = y.blocks + at * width;
                for (whole j = 0; j <= m; j++) {
                    double v = by * values[j];
                    for (whole b = 0; b < d; b++) row[j * d + b] = v * J[b] * y.scale[b];
                    row[j * d + a] += slopes[j];
                }
                for (whole b = 0; b < d; b++) given += J[b];
                given += f[at] + (slope ? slope[at] : 0.0);
                y.residual[at] = y.rates[at] - step * f[at];
                if (slope) y.derivative[at] = -step * slope[at];
                if (!y.free) continue;
                const double direction = f[at] / y.scale[a];
                y.by_period[at] = -widths[i] * direction * y.clock;
                for (whole j = 0; j < m; j++) own[j * d + a] += values[j] * weight * direction;
                after[a] += values[m] * weight * direction;
            }
        }
    }
    double square = 0.0;
    if (y.free)
        for (whole i = 0; i < states; i++) square += y.phase[i] * y.phase[i];
    const double length = sqrt(square);
    if (length > 0.0)
        for (whole i = 0; i < states; i++) y.phase[i] /= length;
    return isfinite(given) ? length : NAN;
}

// A right-hand side in compiled code, f, df/dx and df/dp of an autonomous flow, with its parameters and room for what they give at the Gauss points.
struct Rates {
    using Function = void (*)(whole n, const double* x, const double* t, const double* p, double* out);
    Function f, by_state, by_parameters;
    whole parameters, varying;                               // q, and which of them varies
    double *p, *values, *jacobian, *slopes, *slope;  // (q), (N m, d), (N m, d, d), (N m, d, q), (N m, d)
};
inline double evaluate(const Cycle& y, const Rates& rates, const double* x, const double* widths, double period) {
    const whole n = y.count * y.degree, size = n * y.node;
    at_gauss_points(y, x);
    rates.f(n, y.points, nullptr, rates.p, rates.values);
    rates.by_state(n, y.points, nullptr, rates.p, rates.jacobian);
    rates.by_parameters(n, y.points, nullptr, rates.p, rates.slopes);
    for (whole i = 0; i < size; i++) rates.slope[i] = rates.slopes[i * rates.parameters + rates.varying];
    return assemble(y, widths, period, rates.values, rates.jacobian, rates.slope);
}

using Four [[gnu::vector_size(32), gnu::aligned(8), gnu::may_alias]] = double;
inline whole padded(whole width) { return (width + 3) & ~whole(3); }  // rows of panels are multiples of four numbers
inline void add(double* __restrict to, double by, const double* __restrict from, whole first, whole width) {
    for (whole c = first; c < width; c += 4) *reinterpret_cast<Four*>(to + c) += by * *reinterpret_cast<const Four*>(from + c);
}

// Reflections that clear the first columns of an array below its diagonal; the sign of the determinant of what is eliminated. Loops begin at a multiple
// of four: what stands left of the diagonal is of no use to anybody; on it the inverse is left. `v` has room for a column.
inline double triangularise(double* a, whole rows, whole columns, whole width, double* v) {
    double sign = 1.0;
    for (whole j = 0; j < columns; j++) {
        double square = 0.0, head = a[j * width + j];
        for (whole i = j + 1; i < rows; i++) v[i] = a[i * width + j], square += v[i] * v[i];
        if (square > 0.0) {
            const double norm = -copysign(sqrt(square + head * head), head), first = head - norm, by = 1.0 / (norm * first);
            for (whole c = (j + 1) & ~whole(3); c < width; c += 4) {
                double* column = a + c;
                Four dot = first * *reinterpret_cast<Four*>(column + j * width);
                for (whole i = j + 1; i < rows; i++) dot += v[i] * *reinterpret_cast<Four*>(column + i * width);
                dot *= by;
                *reinterpret_cast<Four*>(column + j * width) += first * dot;
                for (whole i = j + 1; i < rows; i++) *reinterpret_cast<Four*>(column + i * width) += v[i] * dot;
            }
            a[j * width + j] = norm, sign = -sign;
        }
        if (a[j * width + j] < 0.0) sign = -sign;
        a[j * width + j] = 1.0 / a[j * width + j];
    }
    return sign;
}

// Take the unknowns of the first columns out of some border rows (as wide as the panel), with the triangle that gives them.
inline void take_out(const double* panel, whole columns, whole width, double* border, whole rows) {
    for (whole j = 0; j < columns; j++)
        for (whole r = 0; r < rows; r++) add(border + r * width, -border[r * width + j] * panel[j * width + j], panel + j * width, (j + 1) & ~whole(3), width);
}

// n equations by complete pivoting, rows scaled: sides (n, s) become the solutions. The determinant's sign, 0 of a singular matrix, whose
// solutions are large along a null vector.
inline double solve_small(double* matrix, double* sides, whole n, whole s, whole* order) {
    double sign = 1.0, largest = 0.0;
    for (whole i = 0; i < n; i++) {
        double size = 0.0;
        for (whole c = 0; c < n; c++) size = larger(size, fabs(matrix[i * n + c]));
        if (!(size < HUGE_VAL)) return 0.0;
        if (size == 0.0) size = 1.0;
        for (whole c = 0; c < n; c++) matrix[i * n + c] /= size;
        for (whole c = 0; c < s; c++) sides[i * s + c] /= size;
        order[i] = i;
    }
    for (whole j = 0; j < n; j++) {
        whole row = j, column = j;
        double best = -1.0;
        for (whole i = j; i < n; i++)
            for (whole c = j; c < n; c++)
                if (fabs(matrix[i * n + c]) > best) best = fabs(matrix[i * n + c]), row = i, column = c;
        if (row != j) {
            sign = -sign;
            for (whole c = 0; c < n; c++) swap(matrix[j * n + c], matrix[row * n + c]);
            for (whole c = 0; c < s; c++) swap(sides[j * s + c], sides[row * s + c]);
        }
        if (column != j) {
            sign = -sign;
            swap(order[j], order[column]);
            for (whole i = 0; i < n; i++) swap(matrix[i * n + j], matrix[i * n + column]);
        }
        double& pivot = matrix[j * n + j];
        largest = larger(largest, fabs(pivot));
        if (pivot == 0.0) sign = 0.0;
        if (fabs(pivot) < LEAST * largest || pivot == 0.0) pivot = copysign(larger(LEAST * largest, TINY), pivot);
        if (pivot < 0.0) sign = -sign;
        for (whole i = j + 1; i < n; i++) {
            double ratio = matrix[i * n + j] / pivot;
            if (ratio == 0.0) continue;
            for (whole c = j + 1; c < n; c++) matrix[i * n + c] -= ratio * matrix[j * n + c];
            for (whole c = 0; c < s; c++) sides[i * s + c] -= ratio * sides[j * s + c];
        }
    }
    for (whole j = n - 1; j >= 0; j--)
        for (whole c = 0; c < s; c++) {
            double value = sides[j * s + c];
            for (whole l = j + 1; l < n; l++) value -= matrix[j * n + l] * sides[l * s + c];
            sides[j * s + c] = value / matrix[j * n + j];
        }
    for (whole j = 0; j < n; j++)  // back to the order of the columns
        while (order[j] != j) {
            whole k = order[j];
            for (whole c = 0; c < s; c++) swap(sides[j * s + c], sides[k * s + c]);
            swap(order[j], order[k]);
        }
    return sign;
}

struct System {
    whole count, inner, node, shared, sides;  // N, (m - 1) d, d, k, s
    double closure;
    const double *blocks, *columns, *rows, *foot;  // (N, m d, (m + 1) d), (N, m d, k + s), (N, k, m d), (k, k + s)
    double *left, *right;                          // of the equations between mesh points, (N, d, d); filled
    double *found, *at_shared;                     // (N, m d, s), (k, s); filled
    double *room;
};

inline whole room_for(whole count, whole inner, whole d, whole k, whole s) {
    const whole all = inner + d, width = padded(inner + 2 * d + k + s), wide = padded(3 * d + k + s);
    return count * (inner * width + d * wide) + all * width + 2 * d * wide + (2 * k + s) * (width + wide) + 2 * (d + k) * (d + k + s + 1) + 2 * d * s + all + d;
}

// The unknowns of one eliminated group, for s sides: z (s, stride) has what multiplies the columns right of the triangle, and 0 everywhere else.
inline void back(const double* panel, whole n, whole width, whole side, whole s, double* z, whole stride) {
    for (whole r = n - 1; r >= 0; r--) {
        const double* row = panel + r * width;
        for (whole c = 0; c < s; c++) {
            double* own = z + c * stride;
            Four sum = {};
            for (whole j = r & ~whole(3); j < width; j += 4) sum += *reinterpret_cast<const Four*>(row + j) * *reinterpret_cast<const Four*>(own + j);
            own[r] = (row[side + c] - ((sum[0] + sum[1]) + (sum[2] + sum[3]))) * row[r];
        }
    }
}

inline double solve(const System& y) {
    const whole N = y.count, n = y.inner, d = y.node, k = y.shared, s = y.sides, K = k + s, all = n + d, width = padded(n + 2 * d + K), wide = padded(3 * d + K);
    const whole widest = width > wide ? width : wide;
    double *panels = y.room, *chain = panels + N * n * width, *panel = chain + N * d * wide, *two = panel + all * width;
    double *border = two + 2 * d * wide, *next = border + k * width, *z = next + k * wide, *column = z + s * widest, *small = column + all + d;
    double *sides = small + (d + k) * (d + k), *ends = sides + (d + k) * s, *foot = ends + d * s;
    double *at_first = foot + k * K, *at_node = at_first + k * d;
    auto* order = reinterpret_cast<whole*>(at_node + k * d);
    double sign = 1.0;
    for (whole i = 0; i < k * K; i++) foot[i] = y.foot[i];
    for (whole i = 0; i < k * d; i++) at_node[i] = 0.0;
    for (whole i = 0; i < 2 * d * wide; i++) two[i] = 0.0;
    for (whole b = 0; b < N; b++) {
        const double *A = y.blocks + b * all * (n + 2 * d), *C = y.columns + b * all * K;
        for (whole i = 0; i < all; i++) {
            double* row = panel + i * width;
            const double* a = A + i * (n + 2 * d);
            for (whole c = 0; c < n; c++) row[c] = a[d + c];
            for (whole c = 0; c < d; c++) row[n + c] = a[c], row[n + d + c] = a[d + n + c];
            for (whole c = 0; c < K; c++) row[n + 2 * d + c] = C[i * K + c];
            for (whole c = n + 2 * d + K; c < width; c++) row[c] = 0.0;
        }
        sign *= triangularise(panel, all, n, width, column);
        for (whole i = 0; i < n * width; i++) panels[b * n * width + i] = panel[i];
        const double* rest = panel + n * width;
        for (whole i = 0; i < d; i++)
            for (whole c = 0; c < d; c++) y.left[(b * d + i) * d + c] = rest[i * width + n + c], y.right[(b * d + i) * d + c] = rest[i * width + n + d + c];
        for (whole r = 0; r < k; r++) {
            double* row = border + r * width;
            const double* own = y.rows + (b * k + r) * all;
            for (whole c = 0; c < n; c++) row[c] = own[d + c];
            for (whole c = 0; c < d; c++) row[n + c] = own[c] + at_node[r * d + c], row[n + d + c] = 0.0;
            for (whole c = 0; c < K; c++) row[n + 2 * d + c] = foot[r * K + c];
            for (whole c = n + 2 * d + K; c < width; c++) row[c] = 0.0;
        }
        take_out(panel, n, width, border, k);
        if (b == 0) {  // two: x_i | x_0 | x_(i + 1) | shared
            for (whole i = 0; i < d; i++) {
                double *row = two + i * wide, *from = panel + (n + i) * width + n;
                for (whole c = 0; c < d; c++) row[d + c] = from[c], row[c] = from[d + c];
                for (whole c = 0; c < K; c++) row[3 * d + c] = from[2 * d + c];
            }
            for (whole r = 0; r < k; r++) {
                double* row = border + r * width + n;
                for (whole c = 0; c < d; c++) at_first[r * d + c] = row[c], at_node[r * d + c] = row[d + c];
                for (whole c = 0; c < K; c++) foot[r * K + c] = row[2 * d + c];
            }
            continue;
        }
        for (whole i = 0; i < d; i++) {
            double *upper = two + i * wide, *lower = two + (d + i) * wide, *from = panel + (n + i) * width + n;
            for (whole c = 0; c < d; c++) upper[2 * d + c] = 0.0, lower[c] = from[c], lower[d + c] = 0.0, lower[2 * d + c] = from[d + c];
            for (whole c = 0; c < K; c++) lower[3 * d + c] = from[2 * d + c];
        }
        sign *= triangularise(two, 2 * d, d, wide, column);
        for (whole i = 0; i < d * wide; i++) chain[b * d * wide + i] = two[i];
        for (whole r = 0; r < k; r++) {
            const double* from = border + r * width + n;
            double* row = next + r * wide;
            for (whole c = 0; c < d; c++) row[c] = from[c], row[d + c] = at_first[r * d + c], row[2 * d + c] = from[d + c];
            for (whole c = 0; c < K; c++) row[3 * d + c] = from[2 * d + c];
            for (whole c = 3 * d + K; c < wide; c++) row[c] = 0.0;
        }
        take_out(two, d, wide, next, k);
        for (whole r = 0; r < k; r++) {
            const double* row = next + r * wide;
            for (whole c = 0; c < d; c++) at_first[r * d + c] = row[d + c], at_node[r * d + c] = row[2 * d + c];
            for (whole c = 0; c < K; c++) foot[r * K + c] = row[3 * d + c];
        }
        for (whole i = 0; i < d; i++) {
            double *upper = two + i * wide, *lower = two + (d + i) * wide;
            for (whole c = 0; c < d; c++) upper[c] = lower[2 * d + c], upper[d + c] = lower[d + c];
            for (whole c = 0; c < K; c++) upper[3 * d + c] = lower[3 * d + c];
        }
    }
    const whole size = d + k;
    for (whole i = 0; i < size; i++) {
        double *row = small + i * size, *side = sides + i * s;
        const double *a = i < d ? two + i * wide + d : at_first + (i - d) * d, *b = i < d ? two + i * wide : at_node + (i - d) * d;
        const double* e = i < d ? two + i * wide + 3 * d : foot + (i - d) * K;
        for (whole c = 0; c < d; c++) row[c] = a[c] + y.closure * b[c];
        for (whole c = 0; c < k; c++) row[d + c] = e[c];
        for (whole c = 0; c < s; c++) side[c] = e[k + c];
    }
    sign *= solve_small(small, sides, size, s, order);
    const double* shared = sides + d * s;
    for (whole i = 0; i < k * s; i++) y.at_shared[i] = shared[i];
    for (whole i = 0; i < d * s; i++) y.found[i] = sides[i], ends[i] = y.closure * sides[i];
    auto put = [z, s, widest](whole at, const double* from, whole size) {
        for (whole c = 0; c < s; c++)
            for (whole j = 0; j < size; j++) z[c * widest + at + j] = from[j * s + c];
    };
    auto take = [z, s, widest](double* to, whole size) {
        for (whole c = 0; c < s; c++)
            for (whole j = 0; j < size; j++) to[j * s + c] = z[c * widest + j];
    };
    for (whole b = N - 1; b >= 0; b--) {
        double* own = y.found + b * all * s;
        if (b > 0) {
            for (whole i = 0; i < s * widest; i++) z[i] = 0.0;
            put(d, sides, d), put(2 * d, ends, d), put(3 * d, shared, k);
            back(chain + b * d * wide, d, wide, 3 * d + k, s, z, widest);
            take(own, d);
        }
        for (whole i = 0; i < s * widest; i++) z[i] = 0.0;
        put(n, own, d), put(n + d, ends, d), put(n + 2 * d, shared, k);
        back(panels + b * n * width, n, width, n + 2 * d + k, s, z, widest);
        take(own + d * s, n);
        for (whole i = 0; i < d * s; i++) ends[i] = own[i];
    }
    return sign;
}

// [[F_u, F_p], [border]] x = (-F, n) and (0, 1), all in the user's units; the mesh keeps its widths. Returns the determinant's sign.
inline double bordered(const Cycle& y, double closure, double corner, const double* border, double n, double* step, double* tangent) {
    const whole N = y.count, m = y.degree, d = y.node, all = m * d, states = N * all, tail = states + y.free, size = tail + N, k = y.free + 1, K = k + 2;
    double widths_n = 0.0, widths_p = 0.0;
    for (whole i = tail; i < size; i++) widths_p -= border[i] * y.derivative[i] * y.unit, widths_n -= border[i] * -y.residual[i];
    for (whole i = 0; i < N; i++)
        for (whole r = 0, a = 0; r < all; r++, a = a + 1 < d ? a + 1 : 0) {
            const whole at = i * all + r;
            double *column = y.columns + at * K, own = y.scale[a];
            if (y.free) column[0] = y.by_period[at], y.rows[(i * k) * all + r] = y.phase[at];
            column[k - 1] = y.derivative[at] / own * y.unit, column[k] = -y.residual[at] / own, column[k + 1] = 0.0;
            y.rows[(i * k + k - 1) * all + r] = border[at] * own;
        }
    double* last = y.foot + (k - 1) * K;
    if (y.free) {
        y.foot[0] = corner, y.foot[1] = y.derivative[states] * y.unit, y.foot[2] = -y.residual[states], y.foot[3] = 0.0;
        last[0] = border[states] * y.clock;
    }
    last[k - 1] = border[size] * y.unit + widths_p, last[k] = n + widths_n, last[k + 1] = 1.0;
    double sign = solve({N, all - d, d, k, 2, closure, y.blocks, y.columns, y.rows, y.foot, y.left, y.right, y.states, y.shared, y.room});
    for (whole i = 0, a = 0; i < states; i++, a = a + 1 < d ? a + 1 : 0) step[i] = y.states[2 * i] * y.scale[a], tangent[i] = y.states[2 * i + 1] * y.scale[a];
    if (y.free) step[states] = y.shared[0] * y.clock, tangent[states] = y.shared[1] * y.clock;
    step[size] = y.shared[2 * k - 2] * y.unit, tangent[size] = y.shared[2 * k - 1] * y.unit;
    for (whole i = tail; i < size; i++) step[i] = -y.residual[i] - y.derivative[i] * step[size], tangent[i] = -y.derivative[i] * tangent[size];
    return sign;
}

// x of a x = b by Gauss's elimination with partial pivoting, both destroyed, for s right sides; false where a pivot vanishes.
inline bool solve_plain(double* a, double* b, whole n, whole s) {
    for (whole j = 0; j < n; j++) {
        whole pivot = j;
        for (whole i = j + 1; i < n; i++)
            if (fabs(a[i * n + j]) > fabs(a[pivot * n + j])) pivot = i;
        if (!(fabs(a[pivot * n + j]) > 0.0)) return false;
        if (pivot != j) {
            for (whole c = j; c < n; c++) swap(a[j * n + c], a[pivot * n + c]);
            for (whole c = 0; c < s; c++) swap(b[j * s + c], b[pivot * s + c]);
        }
        for (whole i = j + 1; i < n; i++) {
            double ratio = a[i * n + j] / a[j * n + j];
            if (ratio == 0.0) continue;
            for (whole c = j + 1; c < n; c++) a[i * n + c] -= ratio * a[j * n + c];
            for (whole c = 0; c < s; c++) b[i * s + c] -= ratio * b[j * s + c];
        }
    }
    for (whole j = n - 1; j >= 0; j--)
        for (whole c = 0; c < s; c++) {
            for (whole l = j + 1; l < n; l++) b[j * s + c] -= a[j * n + l] * b[l * s + c];
            b[j * s + c] /= a[j * n + j];
        }
    return true;
}

// Shortest Newton step to an equilibrium from the Gauss points, in units of the scale, from f and df/dx there; -1 where a Jacobian is singular.
inline double distance_to_rest(const Cycle& y, const double* f, const double* jacobian) {
    const whole d = y.node;
    double least = HUGE_VAL, *a = y.room, *b = a + d * d;
    for (whole i = 0; i < y.count * y.degree; i++) {
        double size = 0.0, speed = 0.0;
        for (whole r = 0; r < d; r++) {
            const double unit = 1.0 / y.scale[r];
            for (whole c = 0; c < d; c++) a[r * d + c] = jacobian[(i * d + r) * d + c] * unit * y.scale[c], size += a[r * d + c] * a[r * d + c];
            b[r] = f[i * d + r] * unit, speed += b[r] * b[r];
        }
        if (speed > least * size) continue;  // |x| >= |a x| / |a|
        if (!solve_plain(a, b, d, 1)) return -1.0;
        double square = 0.0;
        for (whole r = 0; r < d; r++) square += b[r] * b[r];
        least = square < least ? square : least;
    }
    return sqrt(least);
}

// The maps from each mesh point to the next one between the planes across the motion (speeds (N, d)): (N, d - 1, d - 1), from `left` and `right`. Returns the product
// of the factors by which the motion's own direction grows, 1 but for errors; -1 where the cycle stands still or a factor is singular.
inline double across(const Cycle& y, const double* speeds, double* maps) {
    const whole count = y.count, d = y.node, e = d - 1;
    double product = 1.0, *a = y.room, *b = a + d * d, *v = b + d * d, *w = v + d;
    auto mirror = [&](const double* speed, double* to) {  // the reflection that takes the direction of motion to the first axis
        double square = 0.0;
        for (whole r = 0; r < d; r++) square += speed[r] * speed[r];
        double size = sqrt(square), head = speed[0] + copysign(size, speed[0]), norm = square - speed[0] * speed[0] + head * head;
        for (whole r = 0; r < d; r++) to[r] = (r ? speed[r] : head) * sqrt(2.0 / norm);
        return copysign(size, -speed[0]);
    };
    for (whole i = 0; i < count; i++) {
        for (whole r = 0; r < d * d; r++) a[r] = y.right[i * d * d + r], b[r] = -y.left[i * d * d + r];
        const double own_size = mirror(speeds + i * d, v), next_size = mirror(speeds + (i + 1 < count ? i + 1 : 0) * d, w);
        if (!(fabs(own_size) > 0.0) || !solve_plain(a, b, d, d)) return -1.0;
        for (whole r = 0; r < d; r++) {  // b (1 - v v')
            double dot = 0.0;
            for (whole c = 0; c < d; c++) dot += b[r * d + c] * v[c];
            for (whole c = 0; c < d; c++) b[r * d + c] -= dot * v[c];
        }
        for (whole c = 0; c < d; c++) {  // (1 - w w') b
            double dot = 0.0;
            for (whole r = 0; r < d; r++) dot += w[r] * b[r * d + c];
            for (whole r = 0; r < d; r++) b[r * d + c] -= dot * w[r];
        }
        product *= b[0] * own_size / next_size;
        for (whole r = 0; r < e; r++)
            for (whole c = 0; c < e; c++) maps[(i * e + r) * e + c] = b[(r + 1) * d + c + 1];
    }
    return product;
}

}  // namespace collocation
