// Block-cyclic bordered systems in O(l): Householder reflections eliminate the inner nodes (Wright's structured orthogonal
// factorisation, SIAM J. Sci. Stat. Comput. 13 (1992) 742), so that no product of matrices is formed and long, strongly unstable
// cycles lose nothing. Row i ties nodes i and i + 1 by A_i and D_i, and the parameter by Q_i; node L is node 0 with all but its
// first unknown times `twist`.
#pragma once
#include "math.hpp"

namespace algebra {

constexpr double TINY = 1e-300;

struct System {
    whole length, node;
    const double *F, *A, *D, *Q;
    double twist;
    double *stored, *panel, *small, *solution, *lanes;  // room; `solution` (2, L n + 1) holds a particular and a null solution
};

// n equations in x_0 and p (`small`, n by n + 2) by complete pivoting: a particular and a null solution, and a sign.
template <int N> double close(double* small, double* x, double* y, whole size, int nodes) {
    const int n = N ? N : nodes, width = n + 2;
    int order[33];
    double sign = 1.0;
    for (int j = 0; j <= n; j++) order[j] = j;
    for (int j = 0; j < n; j++) {
        double best = -1.0;
        int row = j, column = j;
        for (int i = j; i < n; i++)
            for (int c = j; c <= n; c++)
                if (fabs(small[i * width + c]) > best) best = fabs(small[i * width + c]), row = i, column = c;
        if (row != j) {
            sign = -sign;
            for (int c = 0; c < width; c++) swap(small[j * width + c], small[row * width + c]);
        }
        if (column != j) {
            sign = -sign;
            swap(order[j], order[column]);
            for (int i = 0; i < n; i++) swap(small[i * width + j], small[i * width + column]);
        }
        double& pivot = small[j * width + j];
        if (fabs(pivot) < TINY) pivot = TINY;
        if (pivot < 0.0) sign = -sign;
        for (int i = j + 1; i < n; i++) {
            double ratio = small[i * width + j] / pivot;
            for (int c = j + 1; c < width; c++) small[i * width + c] -= ratio * small[j * width + c];
        }
    }
    auto place = [&](int j) { return order[j] < n ? whole(order[j]) : size; };
    x[place(n)] = 0.0, y[place(n)] = 1.0;
    for (int j = n - 1; j >= 0; j--) {
        double particular = small[j * width + n + 1], null = -small[j * width + n];
        for (int c = j + 1; c < n; c++) {
            particular -= small[j * width + c] * x[place(c)];
            null -= small[j * width + c] * y[place(c)];
        }
        x[place(j)] = particular / small[j * width + j];
        y[place(j)] = null / small[j * width + j];
    }
    return sign;
}

// Householder reflections that clear the first n columns of the 2n rows x_i | x_0 | x_{i+1} | p | right-hand side; a sign.
template <int N> double triangularise(double* panel, int nodes) {
    const int n = N ? N : nodes, width = 3 * n + 2;
    double sign = 1.0;
    for (int j = 0; j < n; j++) {
        double square = 0.0;
        for (int i = j + 1; i < 2 * n; i++) square += panel[i * width + j] * panel[i * width + j];
        double head = panel[j * width + j];
        if (square > 0.0) {
            double norm = -copysign(sqrt(square + head * head), head), first = head - norm, factor = 1.0 / (norm * first);
            for (int c = j + 1; c < width; c++) {
                double dot = first * panel[j * width + c];
                for (int i = j + 1; i < 2 * n; i++) dot += panel[i * width + j] * panel[i * width + c];
                dot *= factor;
                panel[j * width + c] += dot * first;
                for (int i = j + 1; i < 2 * n; i++) panel[i * width + c] += dot * panel[i * width + j];
            }
            panel[j * width + j] = norm;
            sign = -sign;
        }
        if (panel[j * width + j] < 0.0) sign = -sign;
    }
    return sign;
}

// Particular and null solution of J x + F_p p = -F, one node after the other; a sign.
template <int N> double eliminate(const System& s) {
    const int n = N ? N : int(s.node), width = 3 * n + 2, first = n, next = 2 * n, at_p = 3 * n, side = 3 * n + 1;
    const whole length = s.length, size = length * n;
    double *panel = s.panel, sign = 1.0;
    for (int i = 0; i < n; i++) {  // panel[:n]:  V x_i + U x_0 + w p = r
        for (int c = 0; c < n; c++) panel[i * width + c] = s.D[i * n + c], panel[i * width + first + c] = s.A[i * n + c];
        panel[i * width + at_p] = s.Q[i], panel[i * width + side] = -s.F[i];
    }
    for (whole b = 1; b < length; b++) {
        const double *A = s.A + b * n * n, *D = s.D + b * n * n;
        for (int i = 0; i < n; i++) {
            double *upper = panel + i * width, *lower = panel + (n + i) * width;
            for (int c = 0; c < n; c++) lower[c] = A[i * n + c], lower[first + c] = 0.0, lower[next + c] = D[i * n + c], upper[next + c] = 0.0;
            lower[at_p] = s.Q[b * n + i], lower[side] = -s.F[b * n + i];
        }
        sign *= triangularise<N>(panel, n);
        double* stored_panel = s.stored + b * n * width;
        for (int i = 0; i < n * width; i++) stored_panel[i] = panel[i];
        for (int i = 0; i < n; i++) {
            double *upper = panel + i * width, *lower = panel + (n + i) * width;
            for (int c = 0; c < n; c++) upper[c] = lower[next + c], upper[first + c] = lower[first + c];
            upper[at_p] = lower[at_p], upper[side] = lower[side];
        }
    }
    for (int i = 0; i < n; i++) {
        double *row = s.small + i * (n + 2), *upper = panel + i * width;
        for (int c = 0; c < n; c++) row[c] = upper[first + c] + (c == 0 ? upper[c] : s.twist * upper[c]);
        row[n] = upper[at_p], row[n + 1] = upper[side];
    }
    double *x = s.solution, *y = s.solution + size + 1;
    sign *= close<N>(s.small, x, y, size, n);
    for (whole b = length - 1; b > 0; b--)
        for (int i = n - 1; i >= 0; i--) {
            const double* row = s.stored + (b * n + i) * width;
            double pivot = fabs(row[i]) < TINY ? TINY : row[i];
            double particular = row[side] - row[at_p] * x[size], null = -row[at_p] * y[size];
            whole ahead = b + 1 < length ? (b + 1) * n : 0;
            for (int c = 0; c < n; c++) {
                double after = row[next + c] * (ahead == 0 && c > 0 ? s.twist : 1.0);
                particular -= row[first + c] * x[c], particular -= after * x[ahead + c];
                null -= row[first + c] * y[c], null -= after * y[ahead + c];
            }
            for (int c = i + 1; c < n; c++) particular -= row[c] * x[b * n + c], null -= row[c] * y[b * n + c];
            x[b * n + i] = particular / pivot, y[b * n + i] = null / pivot;
        }
    return sign;
}

// ---- two unknowns per node: the same in registers, several segments of the cycle side by side -------------------------------------
// One reflection step needs the one before it and mostly waits for a square root and a division; segments are independent.

using Four [[gnu::vector_size(32)]] = double;
using FourWholes [[gnu::vector_size(32)]] = whole;
inline Four root(Four x) { return Four{sqrt(x[0]), sqrt(x[1]), sqrt(x[2]), sqrt(x[3])}; }
inline double root(double x) { return sqrt(x); }
inline double minus_with_sign(double size, double of) { return -copysign(size, of); }
inline Four minus_with_sign(Four size, Four of) {  // size >= 0
    constexpr whole SIGN = whole(1) << 63;
    FourWholes flipped = ~__builtin_bit_cast(FourWholes, of) & SIGN;
    return __builtin_bit_cast(Four, __builtin_bit_cast(FourWholes, size) | flipped);
}

// V x_b + U x_0 + w p = r for the two rows of a condensed segment.
template <class T> struct Condensed { T a00, a01, u00, u01, w0, r0, a10, a11, u10, u11, w1, r1; };
// The rows that give a node from the first node of its segment (u), the one after it (e) and p (w): R is (1/d0, a01; 1/d1).
template <class T> struct Reflected { T d0, a01, u00, u01, e00, e01, w0, r0, d1, u10, u11, e10, e11, w1, r1; };
template <class T> struct Block { T b00, b01, b10, b11, d00, d01, d10, d11, q0, q1, f0, f1; };

// Two Householder reflections that clear the first two columns of the lower rows of
//     a00 a01  u00 u01   0   0   w0 r0
//     a10 a11  u10 u11   0   0   w1 r1
//     b00 b01   0   0   d00 d01  q0 f0
//     b10 b11   0   0   d10 d11  q1 f1
template <class T> inline Reflected<T> reflect(Condensed<T>& s, Block<T> m, T u00, T u01, T u10, T u11, T never_zero) {
    T a00 = s.a00, a01 = s.a01, w0 = s.w0, r0 = s.r0, a10 = s.a10, a11 = s.a11, w1 = s.w1, r1 = s.r1;
    T square = m.b00 * m.b00 + m.b10 * m.b10 + never_zero + a00 * a00 + a10 * a10;
    T n = minus_with_sign(root(square), a00), v = a00 - n, t = 1.0 / (n * a00 - square);  // 1 / (n v), a sum of two negative numbers
    T k = (m.b00 * m.b01 + m.b10 * m.b11 + a10 * a11 + v * a01) * t;
    a01 += k * v, a11 += k * a10, m.b01 += k * m.b00, m.b11 += k * m.b10;
    k = (a10 * u10 + v * u00) * t;
    u00 += k * v, u10 += k * a10;
    T g00 = k * m.b00, g10 = k * m.b10;
    k = (a10 * u11 + v * u01) * t;
    u01 += k * v, u11 += k * a10;
    T g01 = k * m.b00, g11 = k * m.b10;
    k = (m.b00 * m.d00 + m.b10 * m.d10) * t;
    T e00 = k * v, e10 = k * a10;
    m.d00 += k * m.b00, m.d10 += k * m.b10;
    k = (m.b00 * m.d01 + m.b10 * m.d11) * t;
    T e01 = k * v, e11 = k * a10;
    m.d01 += k * m.b00, m.d11 += k * m.b10;
    k = (m.b00 * m.q0 + m.b10 * m.q1 + a10 * w1 + v * w0) * t;
    w0 += k * v, w1 += k * a10, m.q0 += k * m.b00, m.q1 += k * m.b10;
    k = (m.b00 * m.f0 + m.b10 * m.f1 + a10 * r1 + v * r0) * t;
    r0 += k * v, r1 += k * a10, m.f0 += k * m.b00, m.f1 += k * m.b10;
    T square2 = a11 * a11 + m.b01 * m.b01 + m.b11 * m.b11 + never_zero;
    T n2 = minus_with_sign(root(square2), a11);
    v = a11 - n2, t = 1.0 / (n2 * a11 - square2);
    k = (m.b01 * g00 + m.b11 * g10 + v * u10) * t;
    u10 += k * v, g00 += k * m.b01, g10 += k * m.b11;
    k = (m.b01 * g01 + m.b11 * g11 + v * u11) * t;
    u11 += k * v, g01 += k * m.b01, g11 += k * m.b11;
    k = (m.b01 * m.d00 + m.b11 * m.d10 + v * e10) * t;
    e10 += k * v, m.d00 += k * m.b01, m.d10 += k * m.b11;
    k = (m.b01 * m.d01 + m.b11 * m.d11 + v * e11) * t;
    e11 += k * v, m.d01 += k * m.b01, m.d11 += k * m.b11;
    k = (m.b01 * m.q0 + m.b11 * m.q1 + v * w1) * t;
    w1 += k * v, m.q0 += k * m.b01, m.q1 += k * m.b11;
    k = (m.b01 * m.f0 + m.b11 * m.f1 + v * r1) * t;
    r1 += k * v, m.f0 += k * m.b01, m.f1 += k * m.b11;
    s = {m.d00, m.d01, g00, g01, m.q0, m.f0, m.d10, m.d11, g10, g11, m.q1, m.f1};
    return {1.0 / n, a01, u00, u01, e00, e01, w0, r0, 1.0 / n2, u10, u11, e10, e11, w1, r1};
}
template <class T> inline Reflected<T> reflect(Condensed<T>& s, const Block<T>& m, T never_zero) {
    return reflect(s, m, s.u00, s.u01, s.u10, s.u11, never_zero);
}

constexpr double NEVER_ZERO = 1e-290;

// A node from the first node x of its segment and the node n after it, for the particular solution (side 1) or the null one (0).
template <class T> inline void back(const Reflected<T>& k, T side, T p, T x0, T x1, T n0, T n1, T& first, T& second) {
    T low = (k.r1 * side - k.w1 * p - k.u10 * x0 - k.u11 * x1 - k.e11 * n1 - k.e10 * n0) * k.d1;
    first = (k.r0 * side - k.w0 * p - k.u00 * x0 - k.u01 * x1 - k.e01 * n1 - k.e00 * n0 - k.a01 * low) * k.d0;
    second = low;
}

inline Condensed<double> condensed(const System& s, whole i) {
    const double *A = s.A + 4 * i, *D = s.D + 4 * i, *Q = s.Q + 2 * i, *F = s.F + 2 * i;
    return {D[0], D[1], A[0], A[1], Q[0], -F[0], D[2], D[3], A[2], A[3], Q[1], -F[1]};
}
inline Block<double> block_of(const System& s, whole i) {
    const double *A = s.A + 4 * i, *D = s.D + 4 * i, *Q = s.Q + 2 * i, *F = s.F + 2 * i;
    return {A[0], A[1], A[2], A[3], D[0], D[1], D[2], D[3], Q[0], Q[1], -F[0], -F[1]};
}

// Two halves side by side; the middle node comes last.
inline double eliminate_halves(const System& s) {
    auto* reflected = reinterpret_cast<Reflected<double>*>(s.stored);  // row i: node i from the first node of its half and the one after it
    const whole length = s.length, middle = length / 2, size = 2 * length;
    double sign = 1.0;
    Condensed<double> state = condensed(s, 0);
    auto further = [&](Condensed<double>& c, whole i) {
        reflected[i] = reflect(c, block_of(s, i), NEVER_ZERO);
        sign *= copysign(1.0, reflected[i].d0 * reflected[i].d1);
    };
    if (length > 1) {
        Condensed<double> other = condensed(s, middle);
        for (whole i = 1; i < middle; i++) further(state, i), further(other, middle + i);
        if (length % 2) further(other, length - 1);
        Block<double> last = {other.u00, other.u01, other.u10, other.u11, other.a00, other.a01, other.a10, other.a11, other.w0, other.w1, other.r0, other.r1};
        reflected[middle] = reflect(state, last, NEVER_ZERO);
        sign *= copysign(1.0, reflected[middle].d0 * reflected[middle].d1);
    }
    double* small = s.small;
    small[0] = state.u00 + state.a00, small[1] = state.u01 + s.twist * state.a01, small[2] = state.w0, small[3] = state.r0;
    small[4] = state.u10 + state.a10, small[5] = state.u11 + s.twist * state.a11, small[6] = state.w1, small[7] = state.r1;
    double *x = s.solution, *y = s.solution + size + 1;
    sign *= close<2>(small, x, y, size, 2);
    if (length == 1) return sign;
    double p = x[size], null = y[size], x0 = x[0], x1 = x[1], y0 = y[0], y1 = y[1];
    double e0 = x0, e1 = s.twist * x1, z0 = y0, z1 = s.twist * y1;
    double a0, a1, b0, b1;
    back(reflected[middle], 1.0, p, x0, x1, e0, e1, a0, a1);
    back(reflected[middle], 0.0, null, y0, y1, z0, z1, b0, b1);
    const double m0 = a0, m1 = a1, n0 = b0, n1 = b1;
    x[2 * middle] = m0, x[2 * middle + 1] = m1, y[2 * middle] = n0, y[2 * middle + 1] = n1;
    auto second = [&](whole j) {
        back(reflected[j], 1.0, p, m0, m1, e0, e1, e0, e1);
        back(reflected[j], 0.0, null, n0, n1, z0, z1, z0, z1);
        x[2 * j] = e0, x[2 * j + 1] = e1, y[2 * j] = z0, y[2 * j + 1] = z1;
    };
    if (length % 2) second(length - 1);
    for (whole i = middle - 1; i > 0; i--) {
        back(reflected[i], 1.0, p, x0, x1, a0, a1, a0, a1);
        back(reflected[i], 0.0, null, y0, y1, b0, b1, b0, b1);
        x[2 * i] = a0, x[2 * i + 1] = a1, y[2 * i] = b0, y[2 * i + 1] = b1;
        second(middle + i);
    }
    return sign;
}

constexpr whole LANES = 8, SHORTEST = 32;  // segments side by side; cycles shorter than this are cut in two halves

// Eight segments side by side, as two vectors of four; what is left of each is one block of a short cycle.
inline double eliminate_lanes(const System& s) {
    const whole length = s.length, m = length / LANES, rest = length % LANES, nodes = LANES + rest, size = 2 * length;
    double* aligned = reinterpret_cast<double*>((reinterpret_cast<whole>(s.lanes) + 31) & ~whole(31));
    auto* reflected = reinterpret_cast<Reflected<Four>*>(aligned);
    double* room = aligned + m * 2 * whole(sizeof(Reflected<Four>) / 8);
    double *F = room, *A = F + 2 * nodes, *D = A + 4 * nodes, *Q = D + 4 * nodes, *found = Q + 2 * nodes;
    const Four never_zero = {NEVER_ZERO, NEVER_ZERO, NEVER_ZERO, NEVER_ZERO};
    double sign = 1.0;
    auto entry = [&](const double* array, whole stride, whole offset, whole i) {  // of block i of four segments
        return Four{array[stride * i + offset], array[stride * (i + m) + offset], array[stride * (i + 2 * m) + offset], array[stride * (i + 3 * m) + offset]};
    };
    auto block = [&](whole i) {
        return Block<Four>{entry(s.A, 4, 0, i), entry(s.A, 4, 1, i), entry(s.A, 4, 2, i), entry(s.A, 4, 3, i),
                           entry(s.D, 4, 0, i), entry(s.D, 4, 1, i), entry(s.D, 4, 2, i), entry(s.D, 4, 3, i),
                           entry(s.Q, 2, 0, i), entry(s.Q, 2, 1, i), -entry(s.F, 2, 0, i), -entry(s.F, 2, 1, i)};
    };
    Condensed<Four> state[2];
    Four product[2];
    for (int half = 0; half < 2; half++) {
        Block<Four> b = block(4 * half * m);
        state[half] = {b.d00, b.d01, b.b00, b.b01, b.q0, b.f0, b.d10, b.d11, b.b10, b.b11, b.q1, b.f1};
        product[half] = Four{1.0, 1.0, 1.0, 1.0};
    }
    for (whole b = 1; b < m; b++)
        for (int half = 0; half < 2; half++) {
            Reflected<Four> k = reflect(state[half], block(4 * half * m + b), never_zero);
            reflected[2 * b + half] = k;
            Four both = k.d0 * k.d1;
            for (int j = 0; j < 4; j++) product[half][j] *= copysign(1.0, both[j]);
        }
    for (whole i = 0; i < LANES; i++) {
        const Condensed<Four>& c = state[i / 4];
        whole j = i % 4;
        D[4 * i] = c.a00[j], D[4 * i + 1] = c.a01[j], D[4 * i + 2] = c.a10[j], D[4 * i + 3] = c.a11[j];
        A[4 * i] = c.u00[j], A[4 * i + 1] = c.u01[j], A[4 * i + 2] = c.u10[j], A[4 * i + 3] = c.u11[j];
        Q[2 * i] = c.w0[j], Q[2 * i + 1] = c.w1[j], F[2 * i] = -c.r0[j], F[2 * i + 1] = -c.r1[j];
        sign *= product[i / 4][j];
    }
    for (whole i = 0; i < rest; i++) {
        whole from = LANES * m + i, to = LANES + i;
        for (int c = 0; c < 4; c++) A[4 * to + c] = s.A[4 * from + c], D[4 * to + c] = s.D[4 * from + c];
        for (int c = 0; c < 2; c++) Q[2 * to + c] = s.Q[2 * from + c], F[2 * to + c] = s.F[2 * from + c];
    }
    sign *= eliminate_halves({nodes, 2, F, A, D, Q, s.twist, s.stored, s.panel, s.small, found, nullptr});
    const double *x = found, *y = found + 2 * nodes + 1;
    double *X = s.solution, *Y = s.solution + size + 1;
    const double p = x[2 * nodes], null = y[2 * nodes];
    const Four one = {1.0, 1.0, 1.0, 1.0}, none = {0.0, 0.0, 0.0, 0.0}, ps = one * p, nulls = one * null;
    struct Ends { Four x0, x1, y0, y1, n0, n1, z0, z1; } ends[2];
    for (whole i = 0; i < LANES; i++) {
        Ends& e = ends[i / 4];
        whole j = i % 4, a = i + 1 < nodes ? i + 1 : 0;
        double back_by = i + 1 < nodes ? 1.0 : s.twist;
        e.x0[j] = x[2 * i], e.x1[j] = x[2 * i + 1], e.y0[j] = y[2 * i], e.y1[j] = y[2 * i + 1];
        e.n0[j] = x[2 * a], e.n1[j] = back_by * x[2 * a + 1], e.z0[j] = y[2 * a], e.z1[j] = back_by * y[2 * a + 1];
        X[2 * i * m] = x[2 * i], X[2 * i * m + 1] = x[2 * i + 1], Y[2 * i * m] = y[2 * i], Y[2 * i * m + 1] = y[2 * i + 1];
    }
    for (whole b = m - 1; b > 0; b--)
        for (int half = 0; half < 2; half++) {
            Ends& e = ends[half];
            const Reflected<Four>& k = reflected[2 * b + half];
            back(k, one, ps, e.x0, e.x1, e.n0, e.n1, e.n0, e.n1);
            back(k, none, nulls, e.y0, e.y1, e.z0, e.z1, e.z0, e.z1);
            for (int j = 0; j < 4; j++) {
                whole at = 2 * ((4 * half + j) * m + b);
                X[at] = e.n0[j], X[at + 1] = e.n1[j], Y[at] = e.z0[j], Y[at + 1] = e.z1[j];
            }
        }
    for (whole i = 0; i <= 2 * rest; i++) X[2 * LANES * m + i] = x[2 * LANES + i], Y[2 * LANES * m + i] = y[2 * LANES + i];
    return sign;
}

inline double eliminated(const System& s) {
    if (s.node == 2) return s.length < SHORTEST ? eliminate_halves(s) : eliminate_lanes(s);
    return s.node == 4 ? eliminate<4>(s) : eliminate<0>(s);
}

// Solve [[J, F_p], [border]] z = (-F, target) into `step` and = (0, 1) into `tangent`; the determinant's sign, up to a constant.
inline double solve_bordered(const System& s, const double* border, double target, double* step, double* tangent) {
    const whole size = s.length * s.node;
    double sign = eliminated(s);
    const double *x = s.solution, *y = x + size + 1;
    double along = 0.0, across = 0.0;
    for (whole i = 0; i <= size; i++) across += border[i] * x[i], along += border[i] * y[i];
    if (along == 0.0) along = TINY, sign = 0.0;
    else if (along < 0.0) sign = -sign;
    double by = 1.0 / along, share = (target - across) * by;
    for (whole i = 0; i <= size; i++) step[i] = x[i] + share * y[i], tangent[i] = y[i] * by;
    return sign;
}

}  // namespace algebra
