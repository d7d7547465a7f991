// Elementary maps of a shaken cavity between consecutive events, with exact derivatives, and margins. A node is (Psi, B+) at an impact
// and (Psi, w) at a turn, stick or slip. In mode s = -1 or +1, with d = (Psi - Psi_0)/Omega and beta = v' - w' at the start,
//     w' = C Omega cos Psi - beta - (b + s a_s) d,   w = w_0 + C (sin Psi - sin Psi_0) - beta d - (b + s a_s) d^2 / 2.
// The reference: orbits/machines/reference/maps.py and margins.py.
#pragma once
#include "cavity_law.hpp"
#include "cycles.hpp"

namespace cycles {

template <class Law> struct Cavity {
    static double linearise(const Cycle& c, const double* u, Workspace& work) {
        const double *par = work.numbers, *slope = par + c.parameters;
        const CavityLaw law = Law::law(par), rate = Law::rate(par, slope);
        const whole length = c.length;
        double* __restrict sines = work.sines;
        double* __restrict cosines = work.cosines;
        const double C = law.amplitude, omega = law.omega, d_C = rate.amplitude, d_omega = rate.omega;
        const double by_omega = 1.0 / omega, speed = C * omega, d_speed = d_C * omega + C * d_omega, peak = speed * omega;
        const double d_peak = d_speed * omega + speed * d_omega;
        for (whole i = 0; i < length; i++) sine_cosine(u[2 * i], sines[i], cosines[i]);
        sines[length] = c.twist * sines[0], cosines[length] = c.twist * cosines[0];
        double largest = 0.0;
        for (whole i = 0; i < length; i++) {
            double *F = work.F + 2 * i, *A = work.A + 4 * i, *D = work.D + 4 * i, *Q = work.Q + 2 * i;
            const whole event = c.events[i], arrival = arrival_of(c, i), mode = c.modes[i];
            const double psi0 = u[2 * i], y0 = u[2 * i + 1];
            const double psi1 = i + 1 < length ? u[2 * i + 2] : u[0] + c.shift;
            double y1 = i + 1 < length ? u[2 * i + 3] : c.twist * u[1], y1_p = 0.0;
            if (i + 1 == length && c.twist < 0.0 && c.events[0] > RIGHT)  // the image about the middle between the walls
                y1 += law.wall[0] + law.wall[1], y1_p = rate.wall[0] + rate.wall[1];
            const double s0 = sines[i], c0 = cosines[i], s1 = sines[i + 1], c1 = cosines[i + 1];
            if (mode == 0) {  // stuck: the absorber waits for the slip
                int way = mode_after(c, i) > 0.0 ? 0 : 1;
                F[0] = peak * s1 + law.pull[way], F[1] = y0 - y1;
                A[0] = 0.0, A[1] = 0.0, A[2] = 0.0, A[3] = 1.0;
                D[0] = peak * c1, D[1] = 0.0, D[2] = 0.0, D[3] = -1.0;
                Q[0] = rate.pull[way] + d_peak * s1, Q[1] = -y1_p;
            } else {
                const int way = mode > 0 ? 0 : 1;
                const double sa = law.pull[way], d_sa = rate.pull[way], d = (psi1 - psi0) * by_omega;
                double w0 = y0, w0_p = 0.0, w0_y = 1.0, beta = speed * c0, beta_psi = -speed * s0, beta_y = 0.0, beta_p = d_speed * c0;
                if (event < TURN) w0 = law.wall[event], w0_p = rate.wall[event], w0_y = 0.0, beta = y0, beta_psi = 0.0, beta_y = 1.0, beta_p = 0.0;
                const double pull = beta + sa * d;
                double V = speed * c1 - pull;
                const double W = w0 + C * (s1 - s0) - (beta + 0.5 * sa * d) * d;
                double V_psi0 = sa * by_omega - beta_psi, V_y0 = -beta_y, V_psi1 = -speed * s1 - sa * by_omega;
                const double W_psi0 = pull * by_omega - C * c0 - beta_psi * d, W_y0 = w0_y - beta_y * d, W_psi1 = V * by_omega;
                const double d_p = -d * by_omega * d_omega;
                double V_p = d_speed * c1 - beta_p - d_sa * d - sa * d_p;
                const double W_p = w0_p + d_C * (s1 - s0) - (beta_p + 0.5 * d_sa * d) * d - pull * d_p;
                if (arrival < TURN) {
                    const double r = law.restitution[arrival], d_r = rate.restitution[arrival];
                    F[0] = y1 - speed * c1 - r * V, F[1] = W - law.wall[arrival];
                    A[0] = -r * V_psi0, A[1] = -r * V_y0, A[2] = W_psi0, A[3] = W_y0;
                    D[0] = speed * s1 - r * V_psi1, D[1] = 1.0, D[2] = W_psi1, D[3] = 0.0;
                    Q[0] = -r * V_p - d_speed * c1 - d_r * V, Q[1] = W_p - rate.wall[arrival];
                } else {
                    if (event >= TURN) {  // from rest to rest: V/d, whose solutions leave out the flight of no duration
                        const double half = 0.5 * (psi1 - psi0);
                        double sine, cosine, ratio = 1.0 - half * half / 6.0, turn = half * (half * half / 30.0 - 1.0 / 3.0);
                        sine_cosine(0.5 * (psi1 + psi0), sine, cosine);
                        if (fabs(half) > 1e-3) {
                            double sh, ch;
                            sine_cosine(half, sh, ch);
                            ratio = sh / half, turn = (ch - ratio) / half;
                        }
                        V = -peak * sine * ratio - sa;
                        V_psi0 = -0.5 * peak * (cosine * ratio - sine * turn), V_psi1 = -0.5 * peak * (cosine * ratio + sine * turn);
                        V_y0 = 0.0, V_p = -d_peak * sine * ratio - d_sa;
                    }
                    F[0] = V, F[1] = W - y1;
                    A[0] = V_psi0, A[1] = V_y0, A[2] = W_psi0, A[3] = W_y0;
                    D[0] = V_psi1, D[1] = 0.0, D[2] = W_psi1, D[3] = -1.0;
                    Q[0] = V_p, Q[1] = W_p - y1_p;
                }
            }
            double size = larger(fabs(F[0]), fabs(F[1]));
            if (!(size <= largest)) largest = size;
        }
        if (c.pinned == 1) largest = larger(largest, pin(c, u, work, law.wall[0] + law.wall[1], rate.wall[0] + rate.wall[1]));
        return largest;
    }

    static constexpr double SLIPPING = 1e-6;  // phase by which the slip may miss the instant at which friction gives way

    // Friction's and slope's share of the shaking, and its arc sine (0 where there is none).
    static double reversal(double pull, double peak, double& angle) {
        angle = 0.0;
        if (!(peak > 0.0)) return pull >= 0.0 ? HUGE_VAL : -HUGE_VAL;
        double ratio = pull / peak;
        if (-1.0 < ratio && ratio < 1.0) angle = arcsine(ratio);
        return ratio;
    }
    // An angle modulo a turn: 0 or ahead, but for rounding, which must not make a turn of an instant that is now.
    static double ahead(double angle) {
        double rest = angle - TWO_PI * floor(angle / TWO_PI);
        return rest > TWO_PI - SLIPPING ? rest - TWO_PI : rest;
    }
    // Smallest distance from the walls at the extrema of w inside a flight on a slope without friction.
    static double reach(const CavityLaw& law, double w0, double beta, double psi0, double psi1) {
        const double C = law.amplitude, omega = law.omega, b = law.slope, speed = C * omega;
        double angle, ratio = reversal(b, speed * omega, angle), least = HUGE_VAL, begin = psi0, before = speed * cosine(psi0) - beta;
        while (begin < psi1) {
            double end = psi1;
            const double bases[] = {-angle, PI + angle};  // sin Psi = -b/(C Omega^2)
            if (-1.0 < ratio && ratio < 1.0)
                for (double base : bases) {
                    double zero = base + TWO_PI * (floor((begin - base) / TWO_PI) + 1.0);
                    if (begin + 1e-12 < zero && zero < end) end = zero;
                }
            double after = speed * cosine(end) - beta - b * (end - psi0) / omega;
            if (before * after < 0.0) {
                double low = begin, high = end;
                for (int k = 0; k < 60; k++) {
                    double psi = 0.5 * (low + high), here = speed * cosine(psi) - beta - b * (psi - psi0) / omega;
                    if (here * before > 0.0) low = psi;
                    else high = psi;
                }
                double d = (low - psi0) / omega, w = w0 + C * (sine(low) - sine(psi0)) - (beta + 0.5 * b * d) * d;
                least = smaller(least, smaller(law.wall[0] - w, w - law.wall[1]));
            }
            begin = end, before = after;
        }
        return least;
    }

    // Four margins per node, positive for an orbit that a machine can follow.
    static void margins(const Cycle& c, const double* u, Workspace& work, double* out) {
        const CavityLaw law = Law::law(work.numbers);
        const whole length = c.length;
        const double C = law.amplitude, omega = law.omega, by_omega = 1.0 / omega, speed = C * omega, peak = C * omega * omega;
        const bool free = law.pull[0] == law.pull[1];  // without friction turns are no events
        // s w' has its interior minima where sin Psi = -s k_s/peak and s cos Psi < 0, with k_s = a_s + s b
        double angles[2], ratios[2] = {reversal(law.pull[0], peak, angles[0]), reversal(-law.pull[1], peak, angles[1])};
        const double extremes[2] = {-sqrt(larger(0.0, 1.0 - ratios[0] * ratios[0])), sqrt(larger(0.0, 1.0 - ratios[1] * ratios[1]))};
        for (whole i = 0; i < length; i++) {
            const whole event = c.events[i], mode = c.modes[i], arrival = arrival_of(c, i);
            const double psi0 = u[2 * i], psi1 = i + 1 < length ? u[2 * i + 2] : u[0] + c.shift;
            const double s0 = work.sines[i], c0 = work.cosines[i], c1 = work.cosines[i + 1];
            const double d = (psi1 - psi0) * by_omega, beta = event < TURN ? u[2 * i + 1] : speed * c0;
            double flight = HUGE_VAL;
            if (mode == 0) {
                // the first time that -m C Omega^2 sin Psi = a with growing left side, for either direction m of the slip
                flight = -1.0;  // it always gives way, or never
                if (!(ratios[0] <= -1.0 || ratios[1] <= -1.0) && (ratios[0] < 1.0 || ratios[1] < 1.0)) {
                    double first = HUGE_VAL;
                    if (ratios[0] < 1.0) first = ahead(PI + angles[0] - psi0);
                    if (ratios[1] < 1.0) first = smaller(first, ahead(angles[1] - psi0));
                    double late = (psi1 - psi0) - first;
                    flight = fabs(late) < SLIPPING ? d : -fabs(late);
                }
            } else if (!free) {
                const int way = mode > 0 ? 0 : 1;  // k_s and where s w' is smallest
                const double pull = mode > 0 ? law.pull[0] : -law.pull[1], ratio = ratios[way];
                if (-1.0 < ratio && ratio < 1.0 && (event != TURN || -double(mode) * peak * s0 > pull)) {  // else the turn's own margin says it
                    const double base = mode > 0 ? PI + angles[0] : angles[1];
                    double last = base + TWO_PI * floor((psi1 - base) / TWO_PI);
                    if (last >= psi1 - (arrival >= TURN ? 1e-9 : 0.0)) last -= TWO_PI;
                    // a slip starts at such a minimum, which is not inside the flight; the next one is 2 pi away
                    const double early = event == SLIP ? 1.0 : event >= TURN ? 1e-9 : 0.0;
                    if (last > psi0 + early) {
                        // s w' = s (speed cos - beta) - k_s (t - t0): the last minimum is the lowest one, the first one if k_s < 0
                        if (pull < 0.0) last -= TWO_PI * ceil((last - psi0 - early) / TWO_PI - 1.0);
                        flight = double(mode) * (speed * extremes[way] - beta) - pull * (last - psi0) * by_omega;
                    }
                }
            } else {
                // without friction the flight may reverse; the walls must hold inside it: extrema where cos Psi = beta/speed
                const double w0 = event < TURN ? law.wall[event] : u[2 * i + 1];
                if (law.slope != 0.0) flight = reach(law, w0, beta, psi0, psi1);
                else if (fabs(beta) < speed) {
                    const double angle = arccosine(beta / speed);
                    const double places[] = {-angle, angle};
                    for (double psi : places) {
                        psi += TWO_PI * ceil((psi0 - psi) / TWO_PI);
                        for (; psi < psi1; psi += TWO_PI)
                            if (psi > psi0) {
                                double w = w0 + C * (sine(psi) - s0) - beta * (psi - psi0) * by_omega;
                                flight = smaller(flight, smaller(law.wall[0] - w, w - law.wall[1]));
                            }
                    }
                }
            }
            out[4 * i] = flight;
            const double push = -peak * s0;  // v''
            if (event == TURN) out[4 * i + 1] = mode_before(c, i) > 0.0 ? law.pull[1] - push : push - law.pull[0];
            else if (event == STICK) out[4 * i + 1] = smaller(law.pull[0] - push, push - law.pull[1]);
            else if (event == SLIP) out[4 * i + 1] = -double(mode) * c0 * peak;
            out[4 * i + 2] = event >= TURN ? smaller(law.wall[0] - u[2 * i + 1], u[2 * i + 1] - law.wall[1]) : HUGE_VAL;
            out[4 * i + 3] = d;
            if (arrival < TURN) {
                whole following = i + 1 < length ? i + 1 : 0;
                out[4 * following + 1] = (1.0 - 2.0 * double(arrival)) * (speed * c1 - beta - law.pull[mode > 0 ? 0 : 1] * d);
            }
        }
    }
};

}  // namespace cycles
