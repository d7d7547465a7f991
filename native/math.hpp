// Sines, cosines and exponentials with the same bits on every processor, within one unit in the last place; arithmetic that keeps
// the digits of small differences. Every function is free of branches where a loop over many arguments is to become vector instructions.
#pragma once
#include "api.h"

constexpr double PI = 3.14159265358979323846, TWO_PI = 2.0 * PI;

template <class T> inline void swap(T& a, T& b) { T c = a; a = b, b = c; }
inline double larger(double a, double b) { return a < b ? b : a; }   // as Python's max(a, b): a where b is no number
inline double smaller(double a, double b) { return b < a ? b : a; }

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
    double r = x - n * P1, w = n * P2, y = r - w, tail = ((r - y) - w) - n * P2_REST;
    double z = y * y, zz = z * z, v = z * y, half = 0.5 * z, one = 1.0 - half;
    double ps = ((S1 + z * S2) + zz * (S3 + z * S4)) + (zz * zz) * (S5 + z * S6);  // in pairs, which do not wait for each other
    double pc = ((C1 + z * C2) + zz * (C3 + z * C4)) + (zz * zz) * (C5 + z * C6);
    double a = y + (v * ps + tail * one);
    double b = one + (((1.0 - one) - half) + (zz * pc - (y + v * S1) * tail));
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

// e^r - 1 - r for |r| <= ln 2 / 2: Taylor's polynomial of degree 13, in pairs, which do not wait for each other.
inline double beyond_linear(double r) {
    constexpr double F2 = 1.0 / 2, F3 = 1.0 / 6, F4 = 1.0 / 24, F5 = 1.0 / 120, F6 = 1.0 / 720, F7 = 1.0 / 5040, F8 = 1.0 / 40320,
                     F9 = 1.0 / 362880, F10 = 1.0 / 3628800, F11 = 1.0 / 39916800, F12 = 1.0 / 479001600, F13 = 1.0 / 6227020800.0;
    double z = r * r, zz = z * z;
    double low = (F2 + r * F3) + z * (F4 + r * F5), middle = (F6 + r * F7) + z * (F8 + r * F9);
    double high = (F10 + r * F11) + z * (F12 + r * F13);
    return z * (low + zz * (middle + zz * high));
}

// e^x: x = k ln 2 + r.
inline double exponential(double x) {
    constexpr double LN2_HIGH = 6.93147180369123816490e-01, LN2_LOW = 1.90821492927058770002e-10;
    if (!(x > -746.0)) return x != x ? x : 0.0;
    if (x > 710.0) return HUGE_VAL;
    double t = x * 1.44269504088896338700 + ROUNDING, k = t - ROUNDING;
    double high = x - k * LN2_HIGH, low = k * LN2_LOW;
    double y = 1.0 - ((low - beyond_linear(high - low)) - high);
    whole power = whole(k), first = power / 2;  // in two steps: the result may be subnormal
    return y * from_bits((1023 + first) << 52) * from_bits((1023 + power - first) << 52);
}

// ln x after fdlibm: x = 2^k (1 + f), a polynomial in f / (2 + f).
inline double logarithm(double x) {
    constexpr double LN2_HIGH = 6.93147180369123816490e-01, LN2_LOW = 1.90821492927058770002e-10;
    constexpr double L1 = 6.666666666666735130e-01, L2 = 3.999999999940941908e-01, L3 = 2.857142874366239149e-01, L4 = 2.222219843214978396e-01,
                     L5 = 1.818357216161805012e-01, L6 = 1.531383769920937332e-01, L7 = 1.479819860511658591e-01;
    if (x == 0.0) return -HUGE_VAL;
    if (!(x > 0.0) || x > 1.7976931348623157e308) return x < 0.0 ? NAN : x;
    int k;
    double m = frexp(x, &k) * 2.0;
    k--;
    if (m > 1.4142135623730951) m *= 0.5, k++;
    double f = m - 1.0, s = f / (2.0 + f), z = s * s, w = z * z, half = 0.5 * f * f;
    double r = z * (L1 + w * (L3 + w * (L5 + w * L7))) + w * (L2 + w * (L4 + w * L6));
    return k * LN2_HIGH - ((half - (s * (half + r) + k * LN2_LOW)) - f);
}

// arctan x after fdlibm.
inline double arctangent(double x) {
    constexpr double HIGH[] = {0.0, 4.63647609000806093515e-01, 7.85398163397448278999e-01, 9.82793723247329054082e-01, 1.57079632679489655800e+00},
                     LOW[] = {0.0, 2.26987774529616870924e-17, 3.06161699786838301793e-17, 1.39033110312309984516e-17, 6.12323399573676603587e-17};
    constexpr double T0 = 3.33333333333329318027e-01, T1 = -1.99999999998764832476e-01, T2 = 1.42857142725034663711e-01,
                     T3 = -1.11111104054623557880e-01, T4 = 9.09088713343650656196e-02, T5 = -7.69187620504482999495e-02,
                     T6 = 6.66107313738753120669e-02, T7 = -5.83357013379057348645e-02, T8 = 4.97687799461593236017e-02,
                     T9 = -3.65315727442169155270e-02, T10 = 1.62858201153657823623e-02;
    double size = fabs(x), y = size;
    int part = size < 0.4375 ? 0 : size < 0.6875 ? 1 : size < 1.1875 ? 2 : size < 2.4375 ? 3 : 4;
    if (part == 1) y = (2.0 * size - 1.0) / (2.0 + size);
    else if (part == 2) y = (size - 1.0) / (size + 1.0);
    else if (part == 3) y = (size - 1.5) / (1.0 + 1.5 * size);
    else if (part == 4) y = -1.0 / size;
    double z = y * y, w = z * z;
    double even = z * (T0 + w * (T2 + w * (T4 + w * (T6 + w * (T8 + w * T10)))));
    double odd = w * (T1 + w * (T3 + w * (T5 + w * (T7 + w * T9))));
    double found = part == 0 ? y - y * (even + odd) : HIGH[part] - ((y * (even + odd) - LOW[part]) - y);
    return copysign(found, x);
}

// x^y for x > 0 as path and laws of parameters need it: exact products and roots for multiples of 1/4.
inline double power(double x, double y) {
    const double quarters = 4.0 * fabs(y);
    if (quarters > 64.0 || quarters != floor(quarters)) return exponential(y * logarithm(x));
    const whole count = whole(quarters);
    double found = 1.0;
    for (whole i = 0; i < count / 4; i++) found *= x;
    if (count & 2) found *= sqrt(x);
    if (count & 1) found *= sqrt(sqrt(x));
    return y < 0.0 ? 1.0 / found : found;
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

// arcsin x after fdlibm.
inline double arcsine(double x) {
    constexpr double P0 = 1.66666666666666657415e-01, P1 = -3.25565818622400915405e-01, P2 = 2.01212532134862925881e-01,
                     P3 = -4.00555345006794114027e-02, P4 = 7.91534994289814532176e-04, P5 = 3.47933107596021167570e-05;
    constexpr double Q1 = -2.40339491173441421878e+00, Q2 = 2.02094576023350569471e+00, Q3 = -6.88283971605453293030e-01,
                     Q4 = 7.70381505559019352791e-02, HALF_PI = 1.57079632679489655800e+00, HALF_PI_LOW = 6.12323399573676603587e-17;
    double size = fabs(x), z = size < 0.5 ? x * x : 0.5 * (1.0 - size);
    double r = z * (P0 + z * (P1 + z * (P2 + z * (P3 + z * (P4 + z * P5))))) / (1.0 + z * (Q1 + z * (Q2 + z * (Q3 + z * Q4))));
    if (size < 0.5) return x + x * r;
    double s = sqrt(z), found;
    if (size >= 0.975) found = HALF_PI - (2.0 * (s + s * r) - HALF_PI_LOW);
    else {
        double high = from_bits(bits_of(s) & ~whole(0xffffffff)), low = (z - high * high) / (s + high);
        found = 0.25 * PI - (2.0 * s * r - (HALF_PI_LOW - 2.0 * low) - (0.25 * PI - 2.0 * high));
    }
    return copysign(found, x);
}

// arccos x; near 1 by the half angle, so that no digits are lost.
inline double arccosine(double x) { return x > 0.5 ? 2.0 * arcsine(sqrt(0.5 * (1.0 - x))) : 0.5 * PI - arcsine(x); }
