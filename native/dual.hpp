// Numbers that carry their partial derivatives: one formula gives a residual and its row of the Jacobian. Forward mode of automatic
// differentiation (Griewank and Walther, Evaluating Derivatives, 2008, chapter 3).
#pragma once
#include "math.hpp"

template <int K> struct Dual {
    double value, partial[K];

    Dual(double x = 0.0) : value(x), partial{} {}
    // f(x) from its value, and partial derivatives from a function of k.
    template <class F> Dual(double x, F slope) : value(x) {
        for (int k = 0; k < K; k++) partial[k] = slope(k);
    }
    static Dual variable(double x, int which) {
        return {x, [=](int k) { return k == which ? 1.0 : 0.0; }};
    }
    // f of this number, whose value and derivative are given.
    Dual chain(double f, double slope) const {
        return {f, [&](int k) { return slope * partial[k]; }};
    }
    friend Dual operator-(const Dual& a) { return a.chain(-a.value, -1.0); }
    friend Dual operator+(const Dual& a, const Dual& b) {
        return {a.value + b.value, [&](int k) { return a.partial[k] + b.partial[k]; }};
    }
    friend Dual operator-(const Dual& a, const Dual& b) {
        return {a.value - b.value, [&](int k) { return a.partial[k] - b.partial[k]; }};
    }
    friend Dual operator*(double a, const Dual& b) { return b.chain(a * b.value, a); }
    friend Dual operator*(const Dual& a, const Dual& b) {
        return {a.value * b.value, [&](int k) { return a.value * b.partial[k] + b.value * a.partial[k]; }};
    }
    friend Dual operator/(const Dual& a, const Dual& b) {
        const double found = a.value / b.value, by = 1.0 / b.value;
        return {found, [&](int k) { return (a.partial[k] - found * b.partial[k]) * by; }};
    }
};

inline double value_of(double x) { return x; }
template <int K> double value_of(const Dual<K>& x) { return x.value; }

template <int K> Dual<K> sqrt(const Dual<K>& x) {
    const double found = sqrt(x.value);
    return x.chain(found, 0.5 / found);
}
template <int K> Dual<K> exponential(const Dual<K>& x) {
    const double found = exponential(x.value);
    return x.chain(found, found);
}
template <int K> void sine_cosine(const Dual<K>& x, Dual<K>& sine, Dual<K>& cosine) {
    double s, c;
    sine_cosine(x.value, s, c);
    sine = x.chain(s, c), cosine = x.chain(c, -s);
}
