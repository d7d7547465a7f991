// The derivative of a round from those of its flights, and products of rounds (orbits/cycles/round_maps.py).
#pragma once
#include "math.hpp"

namespace rounds {

constexpr int LARGEST = 8;  // unknowns of a node

// A small square matrix.
struct Square {
    int n;
    double entry[LARGEST * LARGEST];

    double& operator()(int i, int j) { return entry[i * n + j]; }
    double operator()(int i, int j) const { return entry[i * n + j]; }

    static Square unit(int n) {
        Square found{n, {}};
        for (int i = 0; i < n; i++) found(i, i) = 1.0;
        return found;
    }
    static Square read(int n, const double *values) {
        Square found{n, {}};
        for (int i = 0; i < n * n; i++) found.entry[i] = values[i];
        return found;
    }
    void write(double *values) const {
        for (int i = 0; i < n * n; i++) values[i] = entry[i];
    }
    Square sizes() const {
        Square found{n, {}};
        for (int i = 0; i < n * n; i++) found.entry[i] = fabs(entry[i]);
        return found;
    }
};

inline Square operator*(const Square& a, const Square& b) {
    Square found{a.n, {}};
    for (int i = 0; i < a.n; i++)
        for (int j = 0; j < a.n; j++)
            for (int k = 0; k < a.n; k++) found(i, j) += a(i, k) * b(k, j);
    return found;
}

// Gauss-Jordan elimination with partial pivoting: `side` becomes the solution. Returns the determinant.
inline double eliminated(Square matrix, Square& side) {
    const int n = matrix.n;
    double determinant = 1.0;
    for (int i = 0; i < n; i++) {
        int pivot = i;
        for (int j = i + 1; j < n; j++)
            if (fabs(matrix(j, i)) > fabs(matrix(pivot, i))) pivot = j;
        if (pivot != i) {
            determinant = -determinant;
            for (int k = 0; k < n; k++) {
                double one = matrix(i, k), other = side(i, k);
                matrix(i, k) = matrix(pivot, k), matrix(pivot, k) = one;
                side(i, k) = side(pivot, k), side(pivot, k) = other;
            }
        }
        determinant *= matrix(i, i);
        if (matrix(i, i) == 0.0) return 0.0;
        for (int j = 0; j < n; j++) {
            if (j == i) continue;
            const double share = matrix(j, i) / matrix(i, i);
            for (int k = i; k < n; k++) matrix(j, k) -= share * matrix(i, k);
            for (int k = 0; k < n; k++) side(j, k) -= share * side(i, k);
        }
    }
    for (int i = 0; i < n; i++)
        for (int k = 0; k < n; k++) side(i, k) /= matrix(i, i);
    return determinant;
}

}  // namespace rounds

// The product of -D_i^-1 A_i over all flights (of the A_i, without D), and that of their absolute values; 0 where one is singular.
EXPORT whole rounds_through_flights(whole flights, whole n, const double *A, const double *D, double *product, double *sizes) {
    using namespace rounds;
    Square all = Square::unit(int(n)), large = all;
    for (whole i = 0; i < flights; i++) {
        Square factor = Square::read(int(n), A + i * n * n);
        if (D) {
            if (eliminated(Square::read(int(n), D + i * n * n), factor) == 0.0) return 0;
            for (double& x : factor.entry) x = -x;
        }
        all = factor * all;
        large = factor.sizes() * large;
    }
    all.write(product);
    large.write(sizes);
    return 1;
}

// Of each cycle of some rounds, the changed ones first: least and largest distance of its points from the border, product of its rounds.
EXPORT void rounds_sides_of_cycles(whole n, const double *maps, whole cycles, const whole *keys, double *sides, double *products) {
    using namespace rounds;
    const Square map[2] = {Square::read(int(n), maps), Square::read(int(n), maps + n * n)};
    for (whole c = 0; c < cycles; c++) {
        const whole count = keys[2 * c], changed = keys[2 * c + 1];
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (whole first = 0; first < count; first++) {
            const int begins = first < changed;
            Square P = Square::unit(int(n)), M = map[begins];
            for (whole later = 1; later < count; later++) {
                const Square& here = map[(first + later) % count < changed];
                P = here * P;
                for (int i = 0; i < n; i++) P(i, i) += 1.0;
                if (first == 0) M = here * M;
            }
            if (first == 0) M.write(products + c * n * n);
            Square unused = Square::unit(int(n));
            const double side = (2.0 * begins - 1.0) * rounds::eliminated(P, unused);
            if (!(side >= low)) low = side;
            if (!(side <= high)) high = side;
            if (!isfinite(side)) {
                low = high = __builtin_nan("");
                break;
            }
        }
        sides[2 * c] = low;
        sides[2 * c + 1] = high;
    }
}
