// Cycles of flows by Gauss collocation: equations and derivatives from values at the Gauss points, and their elimination in O(N).
// contvines/flows/assembly.py and elimination.py, the reference, say what is computed. Unknowns inside an interval, then those of one
// mesh point after the other, are eliminated by Householder reflections (Wright, SIAM J. Sci. Stat. Comput. 13 (1992) 742).
#pragma once
#include "math.hpp"

namespace collocation {

constexpr double TINY = 1e-300, LEAST = 1e-18;

// x and x' at the Gauss points of every interval; values and slopes are (m, m + 1), x and the results (N, m, d).
inline void at_gauss_points(const double* values, const double* slopes, const double* x, whole count, whole m, whole d, double* points, double* rates) {
    for (whole i = 0; i < count; i++) {
        const double *own = x + i * m * d, *after = i + 1 < count ? own + m * d : x;
        for (whole c = 0; c < m; c++) {
            double *y = points + (i * m + c) * d, *z = rates + (i * m + c) * d;
            for (whole a = 0; a < d; a++) y[a] = values[c * (m + 1) + m] * after[a], z[a] = slopes[c * (m + 1) + m] * after[a];
            for (whole j = 0; j < m; j++) {
                double v = values[c * (m + 1) + j], s = slopes[c * (m + 1) + j];
                for (whole a = 0; a < d; a++) y[a] += v * own[j * d + a], z[a] += s * own[j * d + a];
            }
        }
    }
}

// Derivatives of the equations of each interval by the values at its nodes, (N, m d, (m + 1) d), in units of the scales.
inline void blocks_of(const double* values, const double* slopes, const double* steps, const double* jacobian, const double* scale,
                      whole count, whole m, whole d, double* blocks) {
    const whole width = (m + 1) * d;
    for (whole i = 0; i < count; i++)
        for (whole c = 0; c < m; c++)
            for (whole a = 0; a < d; a++) {
                const double* J = jacobian + ((i * m + c) * d + a) * d;
                double *row = blocks + ((i * m + c) * d + a) * width, by = -steps[i] / scale[a];
                for (whole j = 0; j <= m; j++) {
                    double v = by * values[c * (m + 1) + j];
                    for (whole b = 0; b < d; b++) row[j * d + b] = v * J[b] * scale[b];
                    row[j * d + a] += slopes[c * (m + 1) + j];
                }
            }
}

// Reflections that clear the first columns of an array below its diagonal; the sign of the determinant of what is eliminated.
inline double triangularise(double* a, whole rows, whole columns, whole width, double* dots) {
    double sign = 1.0;
    for (whole j = 0; j < columns; j++) {
        double square = 0.0, head = a[j * width + j];
        for (whole i = j + 1; i < rows; i++) square += a[i * width + j] * a[i * width + j];
        if (square > 0.0) {
            double norm = -copysign(sqrt(square + head * head), head), first = head - norm, by = 1.0 / (norm * first);
            double* top = a + j * width;
            for (whole c = j + 1; c < width; c++) dots[c] = first * top[c];
            for (whole i = j + 1; i < rows; i++) {
                double v = a[i * width + j];
                if (v == 0.0) continue;
                for (whole c = j + 1; c < width; c++) dots[c] += v * a[i * width + c];
            }
            for (whole c = j + 1; c < width; c++) dots[c] *= by, top[c] += first * dots[c];
            for (whole i = j + 1; i < rows; i++) {
                double v = a[i * width + j];
                if (v == 0.0) continue;
                for (whole c = j + 1; c < width; c++) a[i * width + c] += v * dots[c];
            }
            top[j] = norm, sign = -sign;
        }
        if (a[j * width + j] < 0.0) sign = -sign;
    }
    return sign;
}

// Take the unknowns of the first columns out of a border row (as wide as the panel), with the triangle that gives them.
inline void take_out(const double* panel, whole columns, whole width, double* row) {
    for (whole j = 0; j < columns; j++) {
        double y = row[j] / panel[j * width + j];
        if (y == 0.0) continue;
        for (whole c = j + 1; c < width; c++) row[c] -= y * panel[j * width + c];
    }
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
    const whole all = inner + d, width = inner + 2 * d + k + s, wide = 3 * d + k + s;
    return count * (inner * width + d * wide) + all * width + 2 * d * wide + (k + 2) * (width + wide) + 2 * (d + k) * (d + k + s + 1) + 2 * d * s;
}

// The unknowns of one eliminated group: triangle R and R^-1 applied to what the panel holds right of it.
inline void back(const double* panel, whole n, whole width, const double* first, whole nf, const double* second, whole ns, const double* shared, whole k,
                 whole s, double* x, whole stride) {
    for (whole r = n - 1; r >= 0; r--) {
        const double *row = panel + r * width, *p = row + n;
        double* own = x + r * stride;
        for (whole c = 0; c < s; c++) own[c] = p[nf + ns + k + c];
        for (whole j = r + 1; j < n; j++)
            for (whole c = 0; c < s; c++) own[c] -= row[j] * x[j * stride + c];
        for (whole j = 0; j < nf; j++)
            for (whole c = 0; c < s; c++) own[c] -= p[j] * first[j * s + c];
        for (whole j = 0; j < ns; j++)
            for (whole c = 0; c < s; c++) own[c] -= p[nf + j] * second[j * s + c];
        for (whole j = 0; j < k; j++)
            for (whole c = 0; c < s; c++) own[c] -= p[nf + ns + j] * shared[j * s + c];
        for (whole c = 0; c < s; c++) own[c] /= row[r];
    }
}

inline double solve(const System& y) {
    const whole N = y.count, n = y.inner, d = y.node, k = y.shared, s = y.sides, K = k + s, all = n + d, width = n + 2 * d + K, wide = 3 * d + K;
    const whole widest = width > wide ? width : wide;
    double *kept = y.room, *chain = kept + N * n * width, *panel = chain + N * d * wide, *two = panel + all * width;
    double *border = two + 2 * d * wide, *dots = border + k * widest, *small = dots + widest;
    double *sides = small + (d + k) * (d + k), *ends = sides + (d + k) * s, *foot = ends + 2 * d * s;
    double *at_first = foot + k * K, *here = at_first + k * d;
    auto* order = reinterpret_cast<whole*>(here + k * d);
    double sign = 1.0;
    for (whole i = 0; i < k * K; i++) foot[i] = y.foot[i];
    for (whole i = 0; i < k * d; i++) here[i] = 0.0;
    for (whole b = 0; b < N; b++) {
        const double *A = y.blocks + b * all * (n + 2 * d), *C = y.columns + b * all * K;
        for (whole i = 0; i < all; i++) {
            double* row = panel + i * width;
            const double* a = A + i * (n + 2 * d);
            for (whole c = 0; c < n; c++) row[c] = a[d + c];
            for (whole c = 0; c < d; c++) row[n + c] = a[c], row[n + d + c] = a[d + n + c];
            for (whole c = 0; c < K; c++) row[n + 2 * d + c] = C[i * K + c];
        }
        sign *= triangularise(panel, all, n, width, dots);
        for (whole i = 0; i < n * width; i++) kept[b * n * width + i] = panel[i];
        const double* rest = panel + n * width;
        for (whole i = 0; i < d; i++)
            for (whole c = 0; c < d; c++) y.left[(b * d + i) * d + c] = rest[i * width + n + c], y.right[(b * d + i) * d + c] = rest[i * width + n + d + c];
        for (whole r = 0; r < k; r++) {
            double* row = border + r * width;
            const double* own = y.rows + (b * k + r) * all;
            for (whole c = 0; c < n; c++) row[c] = own[d + c];
            for (whole c = 0; c < d; c++) row[n + c] = own[c] + here[r * d + c], row[n + d + c] = 0.0;
            for (whole c = 0; c < K; c++) row[n + 2 * d + c] = foot[r * K + c];
            take_out(panel, n, width, row);
        }
        if (b == 0) {  // two: x_i | x_0 | x_(i + 1) | shared
            for (whole i = 0; i < d; i++) {
                double *row = two + i * wide, *from = panel + (n + i) * width + n;
                for (whole c = 0; c < d; c++) row[d + c] = from[c], row[c] = from[d + c];
                for (whole c = 0; c < K; c++) row[3 * d + c] = from[2 * d + c];
            }
            for (whole r = 0; r < k; r++) {
                double* row = border + r * width + n;
                for (whole c = 0; c < d; c++) at_first[r * d + c] = row[c], here[r * d + c] = row[d + c];
                for (whole c = 0; c < K; c++) foot[r * K + c] = row[2 * d + c];
            }
            continue;
        }
        for (whole i = 0; i < d; i++) {
            double *upper = two + i * wide, *lower = two + (d + i) * wide, *from = panel + (n + i) * width + n;
            for (whole c = 0; c < d; c++) upper[2 * d + c] = 0.0, lower[c] = from[c], lower[d + c] = 0.0, lower[2 * d + c] = from[d + c];
            for (whole c = 0; c < K; c++) lower[3 * d + c] = from[2 * d + c];
        }
        sign *= triangularise(two, 2 * d, d, wide, dots);
        for (whole i = 0; i < d * wide; i++) chain[b * d * wide + i] = two[i];
        for (whole r = 0; r < k; r++) {
            const double* from = border + r * width + n;
            double* row = dots;
            for (whole c = 0; c < d; c++) row[c] = from[c], row[d + c] = at_first[r * d + c], row[2 * d + c] = from[d + c];
            for (whole c = 0; c < K; c++) row[3 * d + c] = from[2 * d + c];
            take_out(two, d, wide, row);
            for (whole c = 0; c < d; c++) at_first[r * d + c] = row[d + c], here[r * d + c] = row[2 * d + c];
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
        const double *a = i < d ? two + i * wide + d : at_first + (i - d) * d, *b = i < d ? two + i * wide : here + (i - d) * d;
        const double* e = i < d ? two + i * wide + 3 * d : foot + (i - d) * K;
        for (whole c = 0; c < d; c++) row[c] = a[c] + y.closure * b[c];
        for (whole c = 0; c < k; c++) row[d + c] = e[c];
        for (whole c = 0; c < s; c++) side[c] = e[k + c];
    }
    sign *= solve_small(small, sides, size, s, order);
    const double* shared = sides + d * s;
    for (whole i = 0; i < k * s; i++) y.at_shared[i] = shared[i];
    for (whole i = 0; i < d * s; i++) y.found[i] = sides[i], ends[i] = y.closure * sides[i];
    for (whole b = N - 1; b >= 0; b--) {
        double* own = y.found + b * all * s;
        if (b > 0) back(chain + b * d * wide, d, wide, sides, d, ends, d, shared, k, s, own, s);
        back(kept + b * n * width, n, width, own, d, ends, d, shared, k, s, own + d * s, s);
        for (whole i = 0; i < d * s; i++) ends[i] = own[i];
    }
    return sign;
}

}  // namespace collocation
