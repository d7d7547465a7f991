// Sines, cosines and exponentials with the same bits on every processor, within one unit in the last place; arithmetic that keeps
// the digits of small differences. Every function is free of branches where a loop over many arguments is to become vector instructions.
#pragma once
#include "api.h"

constexpr double PI = 3.14159265358979323846, TWO_PI = 2.0 * PI;

inline whole bits_of(double x) { return __builtin_bit_cast(whole, x); }
inline double from_bits(whole x) { return __builtin_bit_cast(double, x); }

// Adding and subtracting this rounds a number below 2^51 to a whole one, whose last bits are then those of the sum.
constexpr double ROUNDING = 0x1.8p52;

// sin x and cos x. The argument is reduced by n pi/2, with pi/2 in three pieces (Cody and Waite) of which the products with n are
// exact for |x| < 1e6; beyond, the error stays below that of rounding x. Kernels: the polynomials of fdlibm (Sun, 1993) on
// [-pi/4, pi/4], with the low part of the reduced argument.
inline void sine_cosine(double x, double& sine, double& cosine) {
    constexpr double P1 = 0x1.921fb544p+0, P2 = 0x1.0b4611a6p-34, P2_REST = 0x1.3198a2e037073p-69;
    constexpr double S1 = -1.66666666666666324348e-01, S2 = 8.33333333332248946124e-03, S3 = -1.98412698298579493134e-04,
                     S4 = 2.75573137070700676789e-06, S5 = -2.50507602534068634195e-08, S6 = 1.58969099521155010221e-10;
    constexpr double C1 = 4.16666666666666019037e-02, C2 = -1.38888888888741095749e-03, C3 = 2.48015872894767294178e-05,
                     C4 = -2.75573143513906633035e-07, C5 = 2.08757232129817482790e-09, C6 = -1.13596475577881948265e-11;
    double t = x * (2.0 / PI) + ROUNDING;
    whole q = bits_of(t);
    double n = t - ROUNDING;
    double r = x - n * P1, w = n * P2, s = r - w;
    double low = n * P2_REST - ((r - s) - w);
    double y = s - low, tail = (s - y) - low;
    double z = y * y, v = z * y, half = 0.5 * z, one = 1.0 - half;
    double rs = S2 + z * (S3 + z * (S4 + z * (S5 + z * S6)));
    double rc = z * (C1 + z * (C2 + z * (C3 + z * (C4 + z * (C5 + z * C6)))));
    double a = y - ((z * (0.5 * tail - v * rs) - tail) - v * S1);
    double b = one + (((1.0 - one) - half) + (z * rc - y * tail));
    bool odd = q & 1;
    double first = odd ? b : a, second = odd ? a : b;
    sine = (q & 2) ? -first : first;
    cosine = ((q + 1) & 2) ? -second : second;
}
inline double sine(double x) {
    double s, c;
    sine_cosine(x, s, c);
    return s;
}
inline double cosine(double x) {
    double s, c;
    sine_cosine(x, s, c);
    return c;
}

// e^x after fdlibm: x = k ln 2 + r, |r| <= ln 2 / 2, and a rational approximation of e^r.
inline double exponential(double x) {
    constexpr double LN2_HIGH = 6.93147180369123816490e-01, LN2_LOW = 1.90821492927058770002e-10;
    constexpr double P1 = 1.66666666666666019037e-01, P2 = -2.77777777770155933842e-03, P3 = 6.61375632143793436117e-05,
                     P4 = -1.65339022054652515390e-06, P5 = 4.13813679705723846039e-08;
    if (!(x > -746.0)) return x != x ? x : 0.0;
    if (x > 710.0) return HUGE_VAL;
    double t = x * 1.44269504088896338700 + ROUNDING, k = t - ROUNDING;
    double high = x - k * LN2_HIGH, low = k * LN2_LOW, r = high - low, z = r * r;
    double c = r - z * (P1 + z * (P2 + z * (P3 + z * (P4 + z * P5))));
    double y = 1.0 - ((low - (r * c) / (2.0 - c)) - high);
    whole power = whole(k), first = power / 2;  // in two steps: the result may be subnormal
    return y * from_bits((1023 + first) << 52) * from_bits((1023 + power - first) << 52);
}

// sqrt(x^2 + y^2) without overflow.
inline double hypotenuse(double x, double y) {
    x = fabs(x), y = fabs(y);
    double large = x > y ? x : y, small = x > y ? y : x;
    if (x != x || y != y) return x + y;
    if (large == 0.0 || large > 1.7976931348623157e308) return large;
    double share = small / large;
    return large * sqrt(1.0 + share * share);
}

// sin x, 1 - cos x, x - sin x and x^2/2 - 1 + cos x, each to full relative accuracy for small x.
struct Remainders { double sine, versine, third, fourth; };
inline Remainders remainders(double x) {
    double z = x * x;
    if (z < 0.25) {
        double third = 1.0 / 5040 - z * (1.0 / 362880 - z * (1.0 / 39916800 - z / 6227020800.0));
        third = x * z * (1.0 / 6 - z * (1.0 / 120 - z * third));
        double fourth = 1.0 / 40320 - z * (1.0 / 3628800 - z * (1.0 / 479001600 - z / 87178291200.0));
        fourth = z * z * (1.0 / 24 - z * (1.0 / 720 - z * fourth));
        return {x - third, 0.5 * z - fourth, third, fourth};
    }
    double s, c;
    sine_cosine(x, s, c);
    double versine = 1.0 - c;
    return {s, versine, x - s, 0.5 * z - versine};
}

// The angle reduced to [0, 2 pi), and the number of turns taken away.
inline double wrap(double angle, double& turns) {
    turns = floor(angle / TWO_PI);
    if (turns != 0.0) angle -= turns * TWO_PI;
    if (angle < 0.0) angle = 0.0;
    else if (angle >= TWO_PI) angle = 0.0, turns += 1.0;
    return angle;
}

// w + low + step as a sum of two floats (Knuth's two-sum); both parts are written back.
inline void shift(double& w, double& low, double step) {
    double total = w + step, part = total - w;
    double rest = (w - (total - part)) + (step - part) + low, out = total + rest;
    low = rest - (out - total);
    w = out;
}
