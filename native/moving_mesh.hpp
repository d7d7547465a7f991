// The direction along which the mesh of a cycle moves with the curve; contvines/flows/moving_mesh.py, the reference, says what is computed.
#pragma once
#include "math.hpp"

namespace moving_mesh {

struct Ring {
    whole count, degree, node, free, copies;  // N, m, d; whether the period is an unknown
    const double *rates, *nodes, *scale;      // (m, m + 1), (m + 1), (d)
    double stiffness, least;                  // size of a cycle, in units of the scale, below which its mesh stands still
    double* room;                             // N m d + 9 N + 3 d numbers
};

// The value and the change of an outermost node, on parabolas through it and its neighbours: nodes pass an extreme, these do not jump there.
struct Extreme { double value, change; };
inline Extreme at_extreme(const Ring& y, const double* u, const double* widths, const double* tangent, whole k) {
    const whole m = y.degree, d = y.node, states = y.count * m * d, node = k / d;
    const whole before = k >= d ? k - d : k - d + states, after = k + d < states ? k + d : k + d - states;
    const whole from = before / d;
    const double back = (y.nodes[from % m + 1] - y.nodes[from % m]) * widths[from / m], on = (y.nodes[node % m + 1] - y.nodes[node % m]) * widths[node / m];
    const double rises = (u[after] - u[k]) / on, bend = (rises - (u[k] - u[before]) / back) / (back + on), slope = rises - bend * on;
    const double away = (tangent[after] - tangent[k]) / on, turn = (away - (tangent[k] - tangent[before]) / back) / (back + on);
    const double place = bend != 0.0 ? smaller(larger(-0.5 * slope / bend, -back), on) : 0.0;
    return {u[k] + place * (slope + place * bend), tangent[k] + place * (away - turn * on + place * turn)};
}

inline void steer(const Ring& y, const double* u, const double* row, double* tangent) {
    const whole N = y.count, m = y.degree, d = y.node, n = N / y.copies, states = N * m * d;
    const double* widths = u + states + y.free;
    double *slopes = y.room, *low = slopes + states, *moved = low + d, *stretch = moved + d, *square = stretch + d, *cross = square + n, *wanted = cross + n;
    double *right = wanted + n, *there = right + n, *diagonal = there + n, *one = diagonal + n, *other = one + n, *shift = other + n;
    double size = 0.0;
    const whole part = states / y.copies;
    for (whole a = 0; a < d; a++) {
        double smallest = HUGE_VAL, largest = -HUGE_VAL, range = 0.0, grows = 0.0;
        low[a] = moved[a] = 0.0;
        for (whole from = a; from < states; from += part) {  // means over the parts of the mesh: which one has the outermost node may change
            whole lowest = from, highest = from;
            for (whole k = from; k < from - a + part; k += d) {
                if (u[k] < u[lowest]) lowest = k;
                if (u[k] > u[highest]) highest = k;
            }
            const Extreme least = at_extreme(y, u, widths, tangent, lowest), most = at_extreme(y, u, widths, tangent, highest);
            low[a] += least.value / y.copies, moved[a] += least.change / y.copies;
            range += most.value - least.value, grows += most.change - least.change;
            smallest = smaller(smallest, u[lowest]), largest = larger(largest, u[highest]);
        }
        stretch[a] = range > 0.0 ? grows / range : 0.0;
        size = larger(size, (largest - smallest) / y.scale[a]);
    }
    if (!(size > y.least)) return;
    for (whole i = 0; i < 5 * n; i++) square[i] = 0.0;
    const double stiff = y.stiffness * size * size * double(N * m * d);
    for (whole i = 0; i < N; i++) {
        const whole at = i % n;
        const double *own = u + i * m * d, *after = i + 1 < N ? own + m * d : u;
        for (whole j = 0; j < m; j++) {
            const double s = y.nodes[j], *rates = y.rates + j * (m + 1);
            double squares = 0.0, products = 0.0;
            for (whole a = 0; a < d; a++) {
                double slope = rates[m] * after[a];
                for (whole k = 0; k < m; k++) slope += rates[k] * own[k * d + a];
                const whole k = (i * m + j) * d + a;
                slope /= widths[i] * y.scale[a], slopes[k] = slope;
                squares += slope * slope;
                products += slope * (tangent[k] - moved[a] - stretch[a] * (u[k] - low[a])) / y.scale[a];
            }
            square[at] += (1.0 - s) * (1.0 - s) * squares, cross[at] += s * (1.0 - s) * squares, right[at] += s * s * squares;
            wanted[at] -= (1.0 - s) * products, there[at] -= s * products;
        }
        square[at] += stiff / widths[i], right[at] += stiff / widths[i], cross[at] -= stiff / widths[i];
    }
    for (whole i = 0; i < n; i++) {
        const whole before = i ? i - 1 : n - 1;
        diagonal[i] = square[i] + right[before], one[i] = wanted[i] + there[before], other[i] = 0.0;
    }
    // the others in terms of the first mesh point, which closes the ring
    other[1] -= cross[0], other[n - 1] -= cross[n - 1];
    for (whole i = 2; i < n; i++) {
        const double by = cross[i - 1] / diagonal[i - 1];
        diagonal[i] -= by * cross[i - 1], one[i] -= by * one[i - 1], other[i] -= by * other[i - 1];
    }
    for (whole i = n - 1; i > 0; i--) {
        const double next = i + 1 < n ? cross[i] : 0.0, ahead = i + 1 < n ? one[i + 1] : 0.0, beyond = i + 1 < n ? other[i + 1] : 0.0;
        one[i] = (one[i] - next * ahead) / diagonal[i], other[i] = (other[i] - next * beyond) / diagonal[i];
    }
    double first = 0.0;
    if (y.free) first = (one[0] - cross[0] * one[1] - cross[n - 1] * one[n - 1]) / (diagonal[0] + cross[0] * other[1] + cross[n - 1] * other[n - 1]);
    if (!isfinite(first)) return;
    shift[0] = first;
    for (whole i = 1; i < n; i++) shift[i] = one[i] + first * other[i];
    double along = 0.0, across = 0.0;
    for (whole i = 0; i < N; i++) {
        const double from = shift[i % n], wider = shift[(i + 1) % n] - from;
        tangent[states + y.free + i] += wider;
        for (whole j = 0; j < m; j++)
            for (whole a = 0; a < d; a++) {
                const whole k = (i * m + j) * d + a;
                tangent[k] += slopes[k] * y.scale[a] * (from + y.nodes[j] * wider);
                if (row) along += row[k] * tangent[k] / y.scale[a], across += row[k] * slopes[k];
            }
    }
    if (row && across != 0.0)
        for (whole k = 0; k < states; k++) tangent[k] -= along / across * slopes[k] * y.scale[k % d];
}

}  // namespace moving_mesh
