// Eigenvalues of a long product of small matrices, without trusting the product: multipliers of a cycle are those of
// S M_{L-1} .. M_0 with M_i = -D_i^-1 A_i and the closure S = diag(1, twist, ..). contvines/core/multipliers/periodic_schur.py, the reference,
// says how: the scaled product with a bound on its rounding; where that is too large the periodic QR algorithm on the factors
// (Bojanczyk, Golub and Van Dooren, Proc. SPIE 1770 (1992) 31). O(L) time and memory.
#pragma once
#include "math.hpp"

namespace algebra {

constexpr double UNIT_ROUNDOFF = 0x1p-53, LARGE = 0x1p200, SMALL = 0x1p-200, LARGEST = 0x1p1023, LEAST = 0x1p-1021;
// A multiplier from the scaled product is trusted up to the relative error CERTIFIED; up to PASSABLE, too, where its bound exceeds the
// effect of rounding the factors themselves by less than EXCESS.
constexpr double CERTIFIED = 1e-10, EXCESS = 50.0, PASSABLE = 1e-7;
enum Certainty { UNDEFINED = -1, UNCERTAIN = 0, CERTAIN = 1, BROKEN = 2 };

inline bool in_range(double size) { return SMALL < size && size < LARGE; }
inline int exponent_of(double x) {
    int e;
    frexp(x, &e);
    return e;
}
inline int clamp(int x, int low, int high) { return x < low ? low : x > high ? high : x; }

// mantissa 2^exponent, clamped away from 0 and infinity (an exact 0 stays 0).
inline double scaled(double mantissa, int exponent) {
    if (mantissa == 0.0 || !isfinite(mantissa)) return mantissa;
    int own;
    double fraction = frexp(mantissa, &own);
    int total = own + exponent;
    if (total > 1023) return copysign(LARGEST, mantissa);
    if (total < -1020) return copysign(LEAST, mantissa);
    return ldexp(fraction, total);
}

// Descending modulus, then real part, then imaginary part.
inline void sort_eigenvalues(double* re, double* im, int n) {
    for (int i = 1; i < n; i++) {
        double x = re[i], y = im[i], r = hypotenuse(x, y);
        int j = i - 1;
        for (; j >= 0; j--) {
            double other = hypotenuse(re[j], im[j]);
            if (other > r || (other == r && (re[j] > x || (re[j] == x && im[j] >= y)))) break;
            re[j + 1] = re[j], im[j + 1] = im[j];
        }
        re[j + 1] = x, im[j + 1] = y;
    }
}

// M_i = -D_i^-1 A_i (LU, partial pivoting), closure included; false if some D_i is singular.
inline bool factors(const double* A, const double* D, whole length, int n, double twist, double* M, double* lu) {
    for (whole i = 0; i < length; i++) {
        double* m = M + i * n * n;
        for (int k = 0; k < n * n; k++) lu[k] = D[i * n * n + k], m[k] = -A[i * n * n + k];
        for (int k = 0; k < n; k++) {
            int pivot = k;
            for (int r = k + 1; r < n; r++)
                if (fabs(lu[r * n + k]) > fabs(lu[pivot * n + k])) pivot = r;
            if (!(fabs(lu[pivot * n + k]) > 0.0)) return false;
            if (pivot != k)
                for (int c = 0; c < n; c++) swap(lu[k * n + c], lu[pivot * n + c]), swap(m[k * n + c], m[pivot * n + c]);
            for (int r = k + 1; r < n; r++) {
                double factor = lu[r * n + k] / lu[k * n + k];
                if (factor == 0.0) continue;
                for (int c = k + 1; c < n; c++) lu[r * n + c] -= factor * lu[k * n + c];
                for (int c = 0; c < n; c++) m[r * n + c] -= factor * m[k * n + c];
            }
        }
        for (int c = 0; c < n; c++)
            for (int r = n - 1; r >= 0; r--) {
                double value = m[r * n + c];
                for (int k = r + 1; k < n; k++) value -= lu[r * n + k] * m[k * n + c];
                m[r * n + c] = value / lu[r * n + r];
            }
    }
    if (twist != 1.0)
        for (int k = n; k < n * n; k++) M[(length - 1) * n * n + k] *= twist;
    return true;
}

// Least number of multipliers that vanish exactly: a zero row of A_i forgets one direction (a stick).
inline int deficiency(const double* A, whole length, int n) {
    int most = 0;
    for (whole i = 0; i < length; i++) {
        int rows = 0;
        for (int r = 0; r < n; r++) {
            bool empty = true;
            for (int c = 0; c < n; c++) empty = empty && A[(i * n + r) * n + c] == 0.0;
            rows += empty;
        }
        most = rows > most ? rows : most;
    }
    return most;
}

// ---- two unknowns per node ----------------------------------------------------------------------------------------------------
struct Factor { double m00, m01, m10, m11, p00, p01, p10, p11, power, norm; };  // M_i, the product before it, its exponent and size

// The error bound, and its part that comes from rounding the factors themselves.
inline double bound_of_two(whole length, double twist, int power, const Factor* stored, double& inherent) {
    double s00 = 1.0, s01 = 0.0, s10 = 0.0, s11 = twist, bound = 0.0;
    int behind = 0;
    inherent = 0.0;
    for (whole i = length - 1; i >= 0; i--) {
        const Factor& f = stored[i];
        double a00 = fabs(f.m00), a01 = fabs(f.m01), a10 = fabs(f.m10), a11 = fabs(f.m11);
        double weight = a00 * (fabs(f.p00 * s00) + fabs(f.p01 * s10)) + a01 * (fabs(f.p10 * s00) + fabs(f.p11 * s10));
        weight += a10 * (fabs(f.p00 * s01) + fabs(f.p01 * s11)) + a11 * (fabs(f.p10 * s01) + fabs(f.p11 * s11));
        double least = a00 * fabs(f.p00 * s00 + f.p01 * s10) + a01 * fabs(f.p10 * s00 + f.p11 * s10);
        least += a10 * fabs(f.p00 * s01 + f.p01 * s11) + a11 * fabs(f.p10 * s01 + f.p11 * s11);
        int raised = int(f.power) + behind - power;
        if (raised != 0) {
            double factor = ldexp(1.0, clamp(raised, -1000, 900));
            weight *= factor, least *= factor;
        }
        bound += weight, inherent += least;
        double t00 = s00 * f.m00 + s01 * f.m10, t01 = s00 * f.m01 + s01 * f.m11;
        double t10 = s10 * f.m00 + s11 * f.m10, t11 = s10 * f.m01 + s11 * f.m11;
        s00 = t00, s01 = t01, s10 = t10, s11 = t11;
        double norm = fabs(s00) + fabs(s01) + fabs(s10) + fabs(s11);
        if (!in_range(norm)) {
            if (!(norm < HUGE_VAL)) return HUGE_VAL;
            if (norm == 0.0) break;
            int shift = exponent_of(norm);
            double factor = ldexp(1.0, -shift);
            s00 *= factor, s01 *= factor, s10 *= factor, s11 *= factor, behind += shift;
        }
    }
    return bound;
}

// A larger bound that costs less, from sums of absolute entries.
inline double simple_bound(whole length, double twist, const Factor* stored) {
    double s00 = 1.0, s01 = 0.0, s10 = 0.0, s11 = twist, norm = 2.0, bound = 0.0;
    for (whole i = length - 1; i >= 0; i--) {
        const Factor& f = stored[i];
        bound += (fabs(f.m00) + fabs(f.m01) + fabs(f.m10) + fabs(f.m11)) * (f.norm * norm);
        double t00 = s00 * f.m00 + s01 * f.m10, t01 = s00 * f.m01 + s01 * f.m11;
        double t10 = s10 * f.m00 + s11 * f.m10, t11 = s10 * f.m01 + s11 * f.m11;
        s00 = t00, s01 = t01, s10 = t10, s11 = t11;
        norm = fabs(s00) + fabs(s01) + fabs(s10) + fabs(s11);
    }
    return bound;
}

inline Certainty product_of_two(const double* A, const double* D, whole length, double twist, double* re, double* im, Factor* stored, double& det, int& det_power) {
    double p00 = 1.0, p01 = 0.0, p10 = 0.0, p11 = 1.0, norm = 2.0;
    int power = 0;
    det = 1.0, det_power = 0;
    for (whole i = 0; i < length; i++, A += 4, D += 4) {
        double delta = D[0] * D[3] - D[1] * D[2];
        if (!(fabs(delta) > 0.0)) return UNDEFINED;
        double inverse = -1.0 / delta;
        double m00 = (D[3] * A[0] - D[1] * A[2]) * inverse, m01 = (D[3] * A[1] - D[1] * A[3]) * inverse;
        double m10 = (D[0] * A[2] - D[2] * A[0]) * inverse, m11 = (D[0] * A[3] - D[2] * A[1]) * inverse;
        det *= (A[1] * A[2] - A[0] * A[3]) * inverse;
        stored[i] = {m00, m01, m10, m11, p00, p01, p10, p11, double(power), norm};
        double t00 = m00 * p00 + m01 * p10, t10 = m10 * p00 + m11 * p10, t01 = m00 * p01 + m01 * p11, t11 = m10 * p01 + m11 * p11;
        p00 = t00, p10 = t10, p01 = t01, p11 = t11;
        norm = fabs(p00) + fabs(p01) + fabs(p10) + fabs(p11);
        if (!in_range(norm)) {
            if (norm == 0.0 || !(norm < HUGE_VAL)) return BROKEN;
            int shift = exponent_of(norm);
            double factor = ldexp(1.0, -shift);
            p00 *= factor, p01 *= factor, p10 *= factor, p11 *= factor, norm *= factor, power += shift;
        }
        if (!in_range(fabs(det)) && det != 0.0) {
            int shift = exponent_of(det);
            det *= ldexp(1.0, -shift), det_power += shift;
        }
    }
    double trace = p00 + twist * p11, half = 0.5 * trace, relative;
    det *= twist;
    int lift = det_power - 2 * power;
    if (det == 0.0 || lift < -900) relative = 0.0;
    else if (lift > 900) return UNCERTAIN;
    else relative = det * ldexp(1.0, lift);
    double disc = half * half - relative, largest = half, modulus;
    if (disc >= 0.0) largest = half + copysign(sqrt(disc), half), modulus = fabs(largest);
    else modulus = sqrt(relative);
    if (power != 0 || !(simple_bound(length, twist, stored) <= CERTIFIED * modulus / UNIT_ROUNDOFF)) {
        double inherent, bound = bound_of_two(length, twist, power, stored, inherent), error = bound * UNIT_ROUNDOFF;
        if (!(error <= CERTIFIED * modulus || (bound <= EXCESS * inherent && error <= PASSABLE * modulus))) return UNCERTAIN;
    }
    if (disc >= 0.0) {
        double first = scaled(largest, power), second = largest != 0.0 ? scaled(det / largest, det_power - power) : 0.0;
        if (fabs(second) > fabs(first) || (fabs(second) == fabs(first) && second > first)) swap(first, second);
        re[0] = first, re[1] = second, im[0] = im[1] = 0.0;
    } else {
        re[0] = re[1] = scaled(half, power);
        im[0] = scaled(sqrt(-disc), power), im[1] = -im[0];
    }
    return CERTAIN;
}

// Two multipliers of different size: the larger one by carrying its eigenvector round the cycle until it settles.
inline Certainty dominant_of_two(whole length, double twist, double* re, double* im, const Factor* stored, double det, int det_power) {
    double x = 0.8, y = 0.6, before = 2.0;
    for (int sweep = 0; sweep < 40; sweep++) {
        double x0 = x, y0 = y, value = 1.0;
        int power = 0;
        for (whole i = 0; i < length; i++) {
            double a = stored[i].m00 * x + stored[i].m01 * y, b = stored[i].m10 * x + stored[i].m11 * y, size = sqrt(a * a + b * b);
            if (!(0.0 < size && size < HUGE_VAL)) return UNCERTAIN;
            double by = 1.0 / size;
            x = a * by, y = b * by, value *= size;
            if (!in_range(value)) {
                int shift = exponent_of(value);
                value *= ldexp(1.0, -shift), power += shift;
            }
        }
        y *= twist;
        double turned = fabs(x * y0 - y * x0);
        if (turned <= 1e-15 || (turned <= 1e-13 && turned >= 0.5 * before)) {
            value = copysign(value, x * x0 + y * y0);
            re[0] = scaled(value, power), re[1] = scaled(det / value, det_power - power), im[0] = im[1] = 0.0;
            return fabs(re[1]) < fabs(re[0]) ? CERTAIN : UNCERTAIN;
        }
        if (sweep > 3 && turned > 0.5 * before) return UNCERTAIN;
        before = turned;
    }
    return UNCERTAIN;
}

// ---- any number of unknowns ---------------------------------------------------------------------------------------------------
// The reflection that maps (x, y, z) to a multiple of e_1, on rows and columns first, .. of H; rows from `begin`, columns to `last`.
inline void reflect_small(double* H, int n, int first, int count, double x, double y, double z, int begin, int last) {
    double size = sqrt(x * x + y * y + z * z);
    if (size == 0.0) return;
    double v = x + copysign(size, x), square = 2.0 / (v * v + y * y + z * z);
    for (int j = begin; j < n; j++) {
        double *a = H + first * n + j, *b = a + n, *c = b + n;
        double dot = (v * *a + y * *b + (count == 3 ? z * *c : 0.0)) * square;
        *a -= dot * v, *b -= dot * y;
        if (count == 3) *c -= dot * z;
    }
    for (int i = 0; i <= last; i++) {
        double* a = H + i * n + first;
        double dot = (v * a[0] + y * a[1] + (count == 3 ? z * a[2] : 0.0)) * square;
        a[0] -= dot * v, a[1] -= dot * y;
        if (count == 3) a[2] -= dot * z;
    }
}

// Eigenvalues of H (destroyed): Hessenberg form, Francis' double shifts; pairs are exactly conjugate. False if it does not converge.
inline bool small_eigenvalues(double* H, int n, double* re, double* im) {
    auto h = [&](int i, int j) -> double& { return H[i * n + j]; };
    for (int j = 0; j < n - 2; j++)
        for (int i = n - 2; i > j; i--) reflect_small(H, n, i, 2, h(i, j), h(i + 1, j), 0.0, j, n - 1), h(i + 1, j) = 0.0;
    int hi = n - 1, tries = 0;
    while (hi >= 0) {
        int lo = hi;
        for (; lo > 0; lo--) {
            double size = fabs(h(lo - 1, lo - 1)) + fabs(h(lo, lo));
            if (size == 0.0) size = fabs(h(lo - 1, hi)) + fabs(h(0, lo));
            if (fabs(h(lo, lo - 1)) <= 0x1p-52 * size) {
                h(lo, lo - 1) = 0.0;
                break;
            }
        }
        if (lo == hi) {
            re[hi] = h(hi, hi), im[hi] = 0.0, hi--, tries = 0;
            continue;
        }
        double a = h(hi - 1, hi - 1), b = h(hi - 1, hi), c = h(hi, hi - 1), d = h(hi, hi);
        if (lo == hi - 1) {
            double half = 0.5 * (a - d), disc = half * half + b * c;
            if (disc >= 0.0) {
                double root = half + copysign(sqrt(disc), half);
                re[hi - 1] = d + root, re[hi] = root != 0.0 ? d - b * c / root : d;
                im[hi - 1] = im[hi] = 0.0;
            } else {
                re[hi - 1] = re[hi] = d + half;
                im[hi - 1] = sqrt(-disc), im[hi] = -im[hi - 1];
            }
            hi -= 2, tries = 0;
            continue;
        }
        if (++tries > 60) return false;
        double trace = a + d, det = a * d - b * c;
        if (tries % 10 == 0) {
            double size = fabs(h(hi, hi - 1)) + fabs(h(hi - 1, hi - 2));
            trace = 1.5 * size, det = size * size;
        }
        double p = h(lo, lo), q = h(lo, lo + 1), r = h(lo + 1, lo), s = h(lo + 1, lo + 1);
        double x = p * p + q * r - trace * p + det, y = r * (p + s - trace), z = r * h(lo + 2, lo + 1);
        for (int k = lo; k < hi; k++) {
            int count = k + 2 <= hi ? 3 : 2;
            if (k > lo) x = h(k, k - 1), y = h(k + 1, k - 1), z = count == 3 ? h(k + 2, k - 1) : 0.0;
            else if (count == 2) z = 0.0;
            reflect_small(H, n, k, count, x, y, z, k > 0 ? k - 1 : 0, k + 3 < hi ? k + 3 : hi);
            if (k > lo) {
                h(k + 1, k - 1) = 0.0;
                if (count == 3) h(k + 2, k - 1) = 0.0;
            }
        }
    }
    return true;
}

inline int rescaled(double* N, int n, double norm) {
    int shift = exponent_of(norm);
    double factor = ldexp(1.0, -shift);
    for (int k = 0; k < n * n; k++) N[k] *= factor;
    return shift;
}

// The scaled product; the bound is the largest row sum of the matrix of bounds. `scratch` has L (2 n n + 1) + 2 n n + 2 n places.
inline Certainty product_of_any(const double* A, const double* D, whole length, int n, double twist, double* re, double* im, double* scratch) {
    const int nn = n * n;
    double *M = scratch, *before = M + length * nn, *powers = before + length * nn, *P = powers + length, *N = P + nn, *x = N + nn, *y = x + n;
    auto unit = [&](double* X) {
        for (int k = 0; k < nn; k++) X[k] = k % (n + 1) == 0 ? 1.0 : 0.0;
    };
    auto multiply = [&](const double* X, const double* Y, double* Z) {
        double norm = 0.0;
        for (int r = 0; r < n; r++)
            for (int c = 0; c < n; c++) {
                double value = 0.0;
                for (int k = 0; k < n; k++) value += X[r * n + k] * Y[k * n + c];
                Z[r * n + c] = value, norm += fabs(value);
            }
        return norm;
    };
    if (!factors(A, D, length, n, twist, M, P)) return UNDEFINED;
    unit(P);
    int power = 0;
    for (whole i = 0; i < length; i++) {
        for (int k = 0; k < nn; k++) before[i * nn + k] = P[k];
        double norm = multiply(M + i * nn, P, N);
        powers[i] = power;
        if (!in_range(norm)) {
            if (norm == 0.0 || !(norm < HUGE_VAL)) return UNCERTAIN;
            power += rescaled(N, n, norm);
        }
        swap(P, N);
    }
    double own = 0.0;  // from the other end: bound on the rounding of the product, in units of 2^power
    for (int r = 0; r < n; r++) {
        double row = 0.0;
        for (int c = 0; c < n; c++) row += fabs(P[r * n + c]), before[r * n + c] = P[r * n + c];  // before[0] was the identity
        own = larger(own, row), y[r] = 0.0;
    }
    unit(P);
    int behind = 0;
    for (whole i = length - 1; i >= 0; i--) {
        const double *m = M + i * nn, *b = before + i * nn;
        for (int r = 0; r < n; r++) {
            x[r] = 0.0;
            for (int c = 0; c < n; c++)
                if (i > 0)
                    for (int k = 0; k < n; k++) x[r] += fabs(m[r * n + k] * b[k * n + c]);
                else x[r] += fabs(m[r * n + c]);
        }
        double factor = ldexp(1.0, clamp(int(powers[i]) + behind - power, -1000, 900));
        for (int r = 0; r < n; r++)
            for (int c = 0; c < n; c++) y[r] += fabs(P[r * n + c]) * x[c] * factor;
        double norm = multiply(P, m, N);
        if (!in_range(norm)) {
            if (!(norm < HUGE_VAL)) return UNCERTAIN;
            if (norm == 0.0) break;
            behind += rescaled(N, n, norm);
        }
        swap(P, N);
    }
    double error = own;
    for (int r = 0; r < n; r++) error = larger(error, y[r]);
    error *= n * UNIT_ROUNDOFF;
    if (!small_eigenvalues(before, n, re, im)) return UNCERTAIN;
    sort_eigenvalues(re, im, n);
    int lost = deficiency(A, length, n);
    lost = lost < n ? lost : n;
    if (lost < n && !(error <= CERTIFIED * hypotenuse(re[n - 1 - lost], im[n - 1 - lost]))) return UNCERTAIN;
    for (int k = 0; k < n; k++) {
        re[k] = scaled(re[k], power), im[k] = scaled(im[k], power);
        if (k >= n - lost) re[k] = im[k] = 0.0;
    }
    return CERTAIN;
}

// ---- the periodic QR algorithm ------------------------------------------------------------------------------------------------
struct Complex { double re, im; };
inline Complex operator+(Complex a, Complex b) { return {a.re + b.re, a.im + b.im}; }
inline Complex operator-(Complex a, Complex b) { return {a.re - b.re, a.im - b.im}; }
inline Complex operator*(Complex a, Complex b) { return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re}; }
inline Complex operator*(double a, Complex b) { return {a * b.re, a * b.im}; }
inline Complex operator~(Complex a) { return {a.re, -a.im}; }
inline double size_of(Complex a) { return hypotenuse(a.re, a.im); }
inline Complex operator/(Complex a, Complex b) {  // scaled: squares of b must not leave the range
    double size = size_of(b);
    Complex unit = {b.re / size, b.im / size}, c = a * ~unit;
    return {c.re / size, c.im / size};
}
inline Complex root(Complex a) {
    double size = size_of(a);
    if (size == 0.0) return {0.0, 0.0};
    double half = sqrt(0.5 * (size + fabs(a.re))), other = 0.5 * fabs(a.im) / half;
    if (a.re >= 0.0) return {half, copysign(other, a.im)};
    return {other, copysign(half, a.im)};
}
struct Rotation { double c; Complex s; };  // [[c, s], [-conj s, c]]

inline Rotation rotation(Complex f, Complex g) {  // maps (f, g) to (r, 0)
    double size = size_of(g), other = size_of(f);
    if (size == 0.0) return {1.0, {0.0, 0.0}};
    if (fmax(size, other) < 0x1p-500) return rotation(0x1p400 * f, 0x1p400 * g);  // numbers below 2^-1022 have few bits
    if (other < 0x1p-560) return {0.0, (1.0 / size) * ~g};
    double norm = hypotenuse(other, size);
    return {other / norm, ((1.0 / other) * f) * ((1.0 / norm) * ~g)};
}

struct PeriodicQR {
    Complex* T;  // L matrices n by n
    whole length;
    int n;
    Complex* turns;
    Complex& at(whole i, int r, int c) { return T[(i * n + r) * n + c]; }
    void rows(whole i, int k, Rotation t, int first, int last) {
        for (int j = first; j <= last; j++) {
            Complex x = at(i, k, j), y = at(i, k + 1, j);
            at(i, k, j) = t.c * x + t.s * y, at(i, k + 1, j) = t.c * y - ~t.s * x;
        }
    }
    void columns(whole i, int k, Rotation t, int first, int last) {
        for (int r = first; r <= last; r++) {
            Complex x = at(i, r, k), y = at(i, r, k + 1);
            at(i, r, k) = t.c * x + ~t.s * y, at(i, r, k + 1) = t.c * y - t.s * x;
        }
    }
    // Carry a rotation of rows k, k+1 of the last factor round the cycle to its columns (rows lo..top).
    void carry(int k, Rotation t, int lo, int hi, int top) {
        for (whole i = 0; i < length - 1; i++) {
            columns(i, k, t, lo, k + 1);
            t = rotation(at(i, k, k), at(i, k + 1, k));
            rows(i, k, t, k, hi);
            at(i, k + 1, k) = {0.0, 0.0};
        }
        columns(length - 1, k, t, lo, top);
    }
    // Periodic Hessenberg-triangular form.
    void reduce() {
        const whole last = length - 1;
        for (whole i = 0; i < last; i++)
            for (int j = 0; j < n - 1; j++)
                for (int k = n - 2; k >= j; k--) {
                    Rotation t = rotation(at(i, k, j), at(i, k + 1, j));
                    rows(i, k, t, j, n - 1);
                    at(i, k + 1, j) = {0.0, 0.0};
                    columns(i + 1, k, t, 0, n - 1);
                }
        for (int j = 0; j < n - 2; j++)
            for (int k = n - 2; k > j; k--) {
                Rotation t = rotation(at(last, k, j), at(last, k + 1, j));
                rows(last, k, t, j, n - 1);
                at(last, k + 1, j) = {0.0, 0.0};
                carry(k, t, 0, n - 1, n - 1);
            }
    }
    // Wilkinson's shift of the trailing 2 x 2 of the product over the leading scale: a mantissa and its exponent.
    Complex shift(int hi, int& power) {
        const whole last = length - 1;
        Complex a = {1.0, 0.0}, b = {0.0, 0.0}, d = {1.0, 0.0};
        power = 0;
        for (whole i = 0; i < last; i++) {
            b = at(i, hi - 1, hi - 1) * b + at(i, hi - 1, hi) * d;
            a = a * at(i, hi - 1, hi - 1), d = d * at(i, hi, hi);
            double norm = size_of(a) + size_of(b) + size_of(d);
            if (norm == 0.0) return power = 0, Complex{0.0, 0.0};
            if (!in_range(norm)) {
                int raised = exponent_of(norm);
                double factor = ldexp(1.0, -raised);
                a = factor * a, b = factor * b, d = factor * d, power += raised;
            }
        }
        Complex p00 = at(last, hi - 1, hi - 1) * a, p01 = at(last, hi - 1, hi - 1) * b + at(last, hi - 1, hi) * d;
        Complex p10 = at(last, hi, hi - 1) * a, p11 = at(last, hi, hi - 1) * b + at(last, hi, hi) * d;
        Complex half = 0.5 * (p00 - p11), r = root(half * half + p01 * p10);
        if ((half * ~r).re < 0.0) r = -1.0 * r;
        Complex total = half + r;
        return total.re == 0.0 && total.im == 0.0 ? p11 : p11 - p01 * p10 / total;
    }
    bool iterate() {
        const whole last = length - 1;
        int hi = n - 1, tries = 0;
        while (hi > 0) {
            int lo = hi;
            for (; lo > 0; lo--) {
                double size = size_of(at(last, lo - 1, lo - 1)) + size_of(at(last, lo, lo));
                if (size == 0.0)
                    for (int j = 0; j <= hi; j++) size += size_of(at(last, lo - 1, j));
                if (size_of(at(last, lo, lo - 1)) <= UNIT_ROUNDOFF * size) {
                    at(last, lo, lo - 1) = {0.0, 0.0};
                    break;
                }
            }
            if (lo == hi) {
                hi--, tries = 0;
                continue;
            }
            bool singular = false;
            Complex ratio = {1.0, 0.0};  // the scale of the product's first column
            int power = 0;
            for (whole i = 0; i < last; i++) {
                for (int k = lo; k <= hi; k++) {
                    double size = 0.0;
                    for (int j = k; j <= hi; j++) size += size_of(at(i, k, j));
                    for (int j = lo; j < k; j++) size += size_of(at(i, j, k));
                    if (size_of(at(i, k, k)) <= UNIT_ROUNDOFF * size) at(i, k, k) = {0.0, 0.0}, singular = true;
                }
                ratio = ratio * at(i, lo, lo);
                double size = size_of(ratio);
                if (!in_range(size) && size != 0.0) {
                    int raised = exponent_of(size);
                    ratio = ldexp(1.0, -raised) * ratio, power += raised;
                }
            }
            if (singular || tries < 2 || tries % 8 == 7) {
                // a step without shift, explicit: it sorts the moduli and sweeps exact zeros down
                for (int k = lo; k < hi; k++) {
                    Rotation t = rotation(at(last, k, k), at(last, k + 1, k));
                    rows(last, k, t, k, hi);
                    at(last, k + 1, k) = {0.0, 0.0};
                    turns[2 * k] = {t.c, 0.0}, turns[2 * k + 1] = t.s;
                }
                for (int k = lo; k < hi; k++) carry(k, {turns[2 * k].re, turns[2 * k + 1]}, lo, hi, k + 1);
            } else {
                int own;
                Complex target = shift(hi, own);
                if (tries % 10 == 9) target = target * Complex{1.0, 0.5};
                int gap = own - power;
                if (gap > 900) gap = 900;
                if (gap < -900) target = {0.0, 0.0}, gap = 0;
                Rotation t = rotation(at(last, lo, lo) - ldexp(1.0, gap) * (target / ratio), at(last, lo + 1, lo));
                rows(last, lo, t, lo, hi);
                carry(lo, t, lo, hi, lo + 2 < hi ? lo + 2 : hi);
                for (int k = lo + 1; k < hi; k++) {
                    t = rotation(at(last, k, k - 1), at(last, k + 1, k - 1));
                    rows(last, k, t, k - 1, hi);
                    at(last, k + 1, k - 1) = {0.0, 0.0};
                    carry(k, t, lo, hi, k + 2 < hi ? k + 2 : hi);
                }
            }
            if (++tries > 120) return false;
        }
        return true;
    }
    // Eigenvalues from the converged form: real ones made real, pairs made exactly conjugate. `values` has n places.
    void diagonal(double* re, double* im, Complex* values, Complex* powers) {
        for (int k = 0; k < n; k++) {
            Complex product = {1.0, 0.0};
            int raised = 0;
            for (whole i = 0; i < length; i++) {
                product = product * at(i, k, k);
                double size = size_of(product);
                if (size == 0.0) break;
                if (!in_range(size)) {
                    int by = exponent_of(size);
                    product = ldexp(1.0, -by) * product, raised += by;
                }
            }
            double size = size_of(product);
            if (size > 0.0) {
                int by = exponent_of(size);
                values[k] = ldexp(1.0, -by) * product, powers[k] = {double(raised + by), 0.0};
            } else values[k] = {0.0, 0.0}, powers[k] = {-2000000.0, 0.0};
        }
        for (int k = 0; k < n; k++) {
            if (powers[k].im != 0.0) continue;
            int mate = -1, raised = int(powers[k].re);
            double closest = 0.5;
            for (int j = k + 1; j < n; j++) {
                if (powers[j].im != 0.0) continue;
                int top = larger(powers[k].re, powers[j].re);
                Complex a = ldexp(1.0, clamp(raised - top, -1000, 0)) * values[k], b = ldexp(1.0, clamp(int(powers[j].re) - top, -1000, 0)) * values[j];
                double distance = size_of(a - ~b), width = fabs(a.im) + fabs(b.im);
                if (width > 0.0 && distance <= closest * width) mate = j, closest = distance / width;
            }
            if (mate < 0) re[k] = scaled(values[k].re, raised), im[k] = 0.0;
            else {
                Complex other = ldexp(1.0, int(powers[mate].re) - raised) * values[mate];
                re[k] = re[mate] = scaled(0.5 * (values[k].re + other.re), raised);
                im[k] = scaled(0.5 * fabs(values[k].im - other.im), raised), im[mate] = -im[k];
                powers[mate].im = 1.0;
            }
        }
    }
};

// Multipliers by the periodic QR algorithm alone. `scratch` has L 3 n n + n n + 8 n places.
inline bool periodic_multipliers(const double* A, const double* D, whole length, int n, double twist, double* re, double* im, double* scratch) {
    const whole size = length * n * n;
    if (!factors(A, D, length, n, twist, scratch, scratch + size)) {
        for (int k = 0; k < n; k++) re[k] = im[k] = NAN;
        return false;
    }
    auto* T = reinterpret_cast<Complex*>(scratch + size + n * n);
    Complex* room = T + size;
    for (whole k = 0; k < size; k++) T[k] = {scratch[k], 0.0};
    PeriodicQR qr = {T, length, n, room};
    qr.reduce();
    bool converged = qr.iterate();
    qr.diagonal(re, im, room, room + n);
    sort_eigenvalues(re, im, n);
    int lost = deficiency(A, length, n);
    for (int k = lost < n ? n - lost : 0; k < n; k++) re[k] = im[k] = 0.0;
    return converged;
}

// Descending modulus, then real part; NaN if a D_i is singular. Returns whether they are certain or the iteration has converged.
// `scratch` has room for length (3 n^2 + 4) + 8 n (n + 1) numbers.
inline bool multipliers(const double* A, const double* D, whole length, int n, double twist, double* re, double* im, double* scratch) {
    Certainty found;
    if (n == 2) {
        auto* stored = reinterpret_cast<Factor*>(scratch);
        double det;
        int det_power;
        found = product_of_two(A, D, length, twist, re, im, stored, det, det_power);
        if (found == UNCERTAIN) found = dominant_of_two(length, twist, re, im, stored, det, det_power);
    } else found = product_of_any(A, D, length, n, twist, re, im, scratch);
    if (found == CERTAIN) return true;
    if (found == UNDEFINED) {
        for (int k = 0; k < n; k++) re[k] = im[k] = NAN;
        return false;
    }
    return periodic_multipliers(A, D, length, n, twist, re, im, scratch);
}

}  // namespace algebra
