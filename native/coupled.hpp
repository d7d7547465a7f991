// The absorber on its oscillator between two events, in closed form: for numbers, and for numbers with derivatives. Simulation, cycles
// and margins use the same motion. In words: orbits/machines/reference/maps.py.
#pragma once
#include "dual.hpp"

namespace coupled {

// Response of a damped oscillator to the moving base, X sin Psi + Y cos Psi, and its own decay rate and frequency.
template <class T> struct Response {
    T X = 0.0, Y = 0.0, alpha, beta, kappa, by_beta, by_kappa;  // kappa = alpha^2 + beta^2; reciprocals

    Response(T mass, T force, T excitation, T damping, T omega) {
        T drag = damping * omega, stiffness = 1.0 + -(mass * omega * omega), size = stiffness * stiffness + drag * drag;
        if (value_of(force) != 0.0 && value_of(size) == 0.0) X = Y = HUGE_VAL;
        else if (value_of(size) != 0.0) {
            T scale = force / size;
            X = scale * (stiffness + excitation * drag * drag), Y = scale * drag * (excitation * stiffness - 1.0);
        }
        alpha = 0.5 * damping / mass;
        T square = 1.0 / mass - alpha * alpha;
        beta = value_of(square) <= 0.0 ? T(NAN) : sqrt(square);
        kappa = alpha * alpha + beta * beta;
        by_beta = 1.0 / beta, by_kappa = 1.0 / kappa;
    }
};

// Motion of the oscillator from a state on: q1 = constant + harmonic h + damped oscillation z; q2' and q2'' of the absorber.
template <class T> struct Oscillation {
    T omega, square, alpha, beta, kappa, h0, h1, z0, z1, q2_rate, q2_pull, by_omega, by_beta, by_kappa;
    T h_sine = h1 * by_omega, z_sine = (z1 + alpha * z0) * by_beta, z1_sine = (alpha * z1 + kappa * z0) * by_beta;  // of sines

    // q1 and q1' less those at the start, the mean of q1'' since then; second and third derivatives.
    struct Point { T way, speed, mean, h2, z2, h3, z3; };

    // Taylor series to order 8 up to here: relative error below roundoff.
    static constexpr double NEAR = 0.03;

    Point begin() const {
        T z2 = -2.0 * alpha * z1 - kappa * z0;
        return {0.0, 0.0, z2 - square * h0, -(square * h0), z2, -(square * h1), -2.0 * alpha * z2 - kappa * z1};
    }

    Point at(T t) const {
        if (fabs(value_of(t)) < NEAR) {
            T h2 = -(square * h0), h3 = -(square * h1), z2 = -2.0 * alpha * z1 - kappa * z0, z3 = -2.0 * alpha * z2 - kappa * z1;
            T h4 = -(square * h2), h5 = -(square * h3), z4 = -2.0 * alpha * z3 - kappa * z2, z5 = -2.0 * alpha * z4 - kappa * z3;
            T h6 = -(square * h4), h7 = -(square * h5), h8 = -(square * h6), z6 = -2.0 * alpha * z5 - kappa * z4;
            T z7 = -2.0 * alpha * z6 - kappa * z5, z8 = -2.0 * alpha * z7 - kappa * z6;
            T d2 = h2 + z2, d3 = h3 + z3, d4 = h4 + z4, d5 = h5 + z5, d6 = h6 + z6, d7 = h7 + z7, d8 = h8 + z8;
            constexpr double T3 = 1.0 / 3, T5 = 1.0 / 5, T6 = 1.0 / 6, T7 = 1.0 / 7;
            T b = 0.5 * t, c = t * T3, d = 0.25 * t, e = t * T5, f = t * T6, g = t * T7, i = 0.125 * t;
            T mean = d2 + b * (d3 + c * (d4 + d * (d5 + e * (d6 + f * (d7 + g * d8)))));
            return {t * (h1 + z1) + t * b * (d2 + c * (d3 + d * (d4 + e * (d5 + f * (d6 + g * (d7 + i * d8)))))), t * mean, mean,
                    h2 + t * (h3 + b * (h4 + c * (h5 + d * (h6 + e * (h7 + f * h8))))),
                    z2 + t * (z3 + b * (z4 + c * (z5 + d * (z6 + e * (z7 + f * z8))))),
                    h3 + t * (h4 + b * (h5 + c * (h6 + d * (h7 + e * h8)))),
                    z3 + t * (z4 + b * (z5 + c * (z6 + d * (z7 + e * z8))))};
        }
        T sin_forced, cos_forced, sin_own, cos_own;
        sine_cosine(omega * t, sin_forced, cos_forced);
        sine_cosine(beta * t, sin_own, cos_own);
        T decay = exponential(-(alpha * t)), C = decay * cos_own, S = decay * sin_own;
        T H0 = h0 * cos_forced + h_sine * sin_forced, H1 = h1 * cos_forced - omega * h0 * sin_forced;
        T Z0 = z0 * C + z_sine * S, Z1 = z1 * C - z1_sine * S, Z2 = -2.0 * alpha * Z1 - kappa * Z0;
        T speed = (H1 - h1) + (Z1 - z1);
        return {(H0 - h0) + (Z0 - z0), speed, speed / t, -(square * H0), Z2, -(square * H1), -2.0 * alpha * Z2 - kappa * Z1};
    }

    // Way that the absorber slides less than it would without acceleration of q1: q2 - q2(0).
    T travel(T t) const { return (q2_rate + 0.5 * q2_pull * t) * t; }

    // Fourth and fifth derivatives of q1.
    T fourth(const Point& p) const { return -square * p.h2 - 2.0 * alpha * p.z3 - kappa * p.z2; }
    T fifth(const Point& p) const {
        return -square * p.h3 + 2.0 * alpha * (2.0 * alpha * p.z3 + kappa * p.z2) - kappa * p.z3;
    }

    // Bounds of |h'|, |h''|, .. by order, and of |z'|, |z''|, .. from the time `start` on.
    T driven(int order) const {
        T size = hypotenuse(h0, h_sine);
        for (int k = 0; k < order; k++) size = size * omega;
        return size;
    }
    T own(int order, T start) const {
        T size = hypotenuse(z0, z_sine) * exponential(-alpha * start);
        for (int k = 0; k < order / 2; k++) size = size * kappa;
        return order % 2 ? size * sqrt(kappa) : size;
    }
};

// Displacements and speeds of absorber and cavity.
template <class T> struct Motion { T w, rate, v, v_rate; };

// The machine's numbers. Parameters in order: forcing, frequency, damping, mass ratio, restitution, friction, gravity, excitation, slope.
// pull and lean: accelerations of the absorber by friction and by gravity along the cavity; a and b: the same, relative to the cavity.
template <class T> struct Law {
    static constexpr int PARAMETERS = 9;
    T G, omega, lambda, eps, r, mu, g, chi, pull, lean;
    T full = 1.0 + eps, by_full = 1.0 / full, by_omega = 1.0 / omega, a, b, drag = eps * lambda, square = omega * omega;
    Response<T> slide{1.0, eps * G, chi, drag, omega}, stuck{full, eps * G, chi, drag, omega};

    explicit Law(const T* p) : G(p[0]), omega(p[1]), lambda(p[2]), eps(p[3]), r(p[4]), mu(p[5]), g(p[6]), chi(p[7]) {
        T sin_slope, cos_slope;
        sine_cosine(p[8], sin_slope, cos_slope);
        pull = mu * g * cos_slope, lean = g * sin_slope;
        a = full * pull, b = full * lean;
    }

    // q2'' while the absorber slides.
    T slides(double s) const { return s * pull + lean; }

    // The closed form of a leg that begins with a state.
    Oscillation<T> oscillation(const T& psi, const Motion<T>& x, double s) const {
        const Response<T>& response = s != 0.0 ? slide : stuck;
        T sin_psi, cos_psi, sp = s != 0.0 ? slides(s) : T(0.0), q2_rate = (x.v_rate - x.rate) * by_full, q1 = (x.v + eps * x.w) * by_full;
        sine_cosine(psi, sin_psi, cos_psi);
        T h0 = response.X * sin_psi + response.Y * cos_psi, h1 = omega * (response.X * cos_psi - response.Y * sin_psi);
        return {omega, square, response.alpha, response.beta, response.kappa,
                h0, h1, q1 - h0 + eps * sp, x.v_rate - eps * q2_rate - h1, q2_rate, sp, by_omega, response.by_beta, response.by_kappa};
    }
    // Where such a leg is after a time; `low`: digits of w below its roundoff.
    Motion<T> after(const Oscillation<T>& q, const typename Oscillation<T>::Point& p, const Motion<T>& x, double s, const T& t, double low = 0.0) const {
        if (s == 0.0) return {x.w, 0.0, x.v + full * p.way, x.v_rate + full * p.speed};
        T travel = q.travel(t);
        return {x.w + (low + (p.way - travel)), x.rate + p.speed - q.q2_pull * t, x.v + p.way + eps * travel,
                x.v_rate + p.speed + eps * q.q2_pull * t};
    }
    // v'' = -q1 - eps lambda q1' + e + eps lambda e', which neither friction nor gravity enters: q1 is counted from where all is at rest.
    T push(const Motion<T>& x, const T& sin_psi, const T& cos_psi) const {
        T q1 = (x.v + eps * x.w) / full, q1_rate = (x.v_rate + eps * x.rate) / full;
        return -q1 - drag * q1_rate + eps * G * (sin_psi + chi * drag * omega * cos_psi);
    }
    // Amplitude of the base's force.
    T strength() const { return eps * fabs(G) * sqrt(1.0 + chi * chi * drag * drag * square); }
};

// Time for which y > 0 stays positive while |y''| <= bound: the zero of y + y' h - bound h^2/2.
inline double certain(double y, double slope, double bound) {
    double root = sqrt(slope * slope + 2.0 * bound * y);
    return slope > 0.0 ? (root + slope) / bound : 2.0 * y / (root - slope);
}

// First zero after the time `start` of a number that `look(tau, value, slope)` knows, with |second derivative| <= bound; `end` if there is
// none before. Steps as long as is certain never jump over one. A zero at `start` itself is not counted: the slope there tells for how
// long there is no other. `tiny`: the value's rounding; `phase`: where the motion began.
template <class Look> double first_zero(double start, double end, double bound, double tiny, double phase, Look look) {
    double tau = start, value, slope;
    if (bound <= 1e-300) return end;
    look(tau, value, slope);
    if (fabs(value) <= tiny + 1e-15 * (1.0 + start + fabs(phase)) * fabs(slope)) {
        tau += larger(fabs(slope) / bound, 1e-8);
        if (!(tau < end)) return end;
        look(tau, value, slope);
    }
    const double sign = value > 0.0 ? 1.0 : -1.0;
    for (;;) {
        if (sign * value <= tiny) return tau;
        double step = certain(sign * value, sign * slope, bound);
        if (step <= 2e-16 * (1.0 + tau)) return tau;
        tau += step;
        if (!(tau < end)) return end;
        look(tau, value, slope);
    }
}

}  // namespace coupled
