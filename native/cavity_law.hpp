// The numbers of a shaken cavity from the parameters of its machines; see orbits/machines/reference/law.py.
#pragma once
#include "math.hpp"

// The numbers of the equations of motion, or their derivatives by the parameter:
// w'' = -amplitude omega^2 sin Psi - pull[0] (w' > 0) or - pull[1] (w' < 0); the slope is the part of the pulls that is no friction.
struct CavityLaw { double amplitude, omega, pull[2], slope, restitution[2], wall[2]; };  // [0]: left, [1]: right

struct AbsorberLaw {
    static CavityLaw law(const double* par) {
        double a = (1.0 + par[4]) * par[2] * par[3];
        return {par[0], par[5], {a, -a}, 0.0, {par[1], par[1]}, {1.0, -1.0}};
    }
    static CavityLaw rate(const double* par, const double* d) {
        double da = (1.0 + par[4]) * (par[2] * d[3] + par[3] * d[2]) + par[2] * par[3] * d[4];
        return {d[0], d[5], {da, -da}, 0.0, {d[1], d[1]}, {0.0, 0.0}};
    }
};
struct GeneralLaw {  // amplitude, restitution_left, _right, friction_left, _right, gravity, mass_ratio, frequency, slope, distance_left, _right
    static CavityLaw law(const double* par) {
        double all = 1.0 + par[6], g = par[5], s, c;
        sine_cosine(par[8], s, c);
        double b = all * g * s;
        return {par[0], par[7], {all * par[3] * g * c + b, b - all * par[4] * g * c}, b, {par[1], par[2]}, {par[9], -par[10]}};
    }
    static CavityLaw rate(const double* par, const double* d) {
        double g = (1.0 + par[6]) * par[5], dg = (1.0 + par[6]) * d[5] + par[5] * d[6], s, c;
        sine_cosine(par[8], s, c);
        double normal = g * c, d_normal = dg * c - g * s * d[8], db = dg * s + g * c * d[8];
        return {d[0], d[7], {d_normal * par[3] + normal * d[3] + db, db - d_normal * par[4] - normal * d[4]}, db, {d[1], d[2]}, {d[9], -d[10]}};
    }
};

