/* The floor of simulation: impacts of the absorber one after the other, closed-form flights, Newton's method for the
   next hit. Only what an impacting attractor needs: no sticks; a turn ends the run. */

#include <math.h>

static const double PI = 3.14159265358979323846;

/* Reduced model. In the phase x since the impact, y = s (w - w_0) has y'' = C sin(theta + x) - A: convex while that is
   positive (Newton from the right), concave after (Newton from the left). start = {phase, w, w'}; rows of 3 numbers:
   phase (not reduced), speed before, speed after. Returns the impacts made. */
int floor_reduced(const double *params, double *start, int count, double *rows)
{
    const double C = params[0], r = params[1], omega = params[5];
    const double A = (1.0 + params[4]) * params[2] * params[3] / (omega * omega), alpha = asin(A / C);
    double psi = start[0], turns = 0.0, s = start[2] > 0.0 ? 1.0 : -1.0, p = fabs(start[2]) / omega, w = start[1];
    for (int i = 0; i < count; i++) {
        double target = 1.0 - s * w;
        for (;;) {
            double theta = s < 0.0 ? psi : psi - PI;
            const double sine0 = sin(theta), cosine0 = cos(theta);
            double x = 0.0, y = 0.0, rate = p, end = alpha - theta;
            int hit = 0;
            if (end <= 0.0) end += 2.0 * PI;
            if (theta >= alpha && theta < PI - alpha) {
                x = PI - alpha - theta;
                y = p * x + C * (sine0 + x * cosine0 - sin(theta + x)) - 0.5 * A * x * x;
                rate = p + C * (cosine0 - cos(theta + x)) - A * x;
                hit = y >= target;
            }
            for (int k = 0; k < 60; k++) {
                if (rate <= 0.0) return i;
                const double step = (target - y) / rate;
                if (fabs(step) <= 1e-15 * (1.0 + x)) { hit = 1; break; }
                if (!hit && x == end) break;
                x += step;
                if (!hit && x > end) x = end;
                y = p * x + C * (sine0 + x * cosine0 - sin(theta + x)) - 0.5 * A * x * x;
                rate = p + C * (cosine0 - cos(theta + x)) - A * x;
            }
            psi += x;
            if (psi >= 2.0 * PI) { psi -= 2.0 * PI; turns += 1.0; }
            p = rate;
            if (hit) break;
            target -= y;
        }
        w = s;
        rows[3 * i] = psi + 2.0 * PI * turns;
        rows[3 * i + 1] = s * omega * p;
        p *= r;
        s = -s;
        rows[3 * i + 2] = s * omega * p;
    }
    start[0] = psi; start[1] = w; start[2] = s * omega * p;
    return count;
}

/* Coupled model: forced damped oscillator and a mass sliding under friction. The flight is scanned in steps of an eighth
   of a period, then Newton's method. start = {phase, w, w', v, v'}; rows as above. */
int floor_coupled(const double *params, double *start, int count, double *rows)
{
    const double G = params[0], omega = params[1], lambda = params[2], eps = params[3], r = params[4];
    const double pull = params[5] * params[6], chi = params[7], drag = eps * lambda * omega, k = 1.0 - omega * omega;
    const double scale = eps * G / (k * k + drag * drag), X = scale * (k + chi * drag * drag);
    const double Y = scale * drag * (chi * k - 1.0), alpha = 0.5 * eps * lambda, beta = sqrt(1.0 - alpha * alpha);
    const double by = 1.0 / (1.0 + eps), pace = 0.25 * PI / omega;
    double psi = start[0], w = start[1], rate = start[2], v = start[3], v_rate = start[4], turns = 0.0;
    for (int i = 0; i < count; i++) {
        const double s = rate > 0.0 ? 1.0 : -1.0;
        const double q1 = (v + eps * w) * by, q1_rate = (v_rate + eps * rate) * by, q2 = (v - w) * by;
        const double q2_rate = (v_rate - rate) * by, offset = -eps * pull * s;
        const double z = q1 - offset - X * sin(psi) - Y * cos(psi);
        const double z_rate = q1_rate - omega * (X * cos(psi) - Y * sin(psi)), B = (z_rate + alpha * z) / beta;
        double tau = 0.0, now = 0.0, Q1 = 0.0, Q1_rate = 0.0, Q2 = 0.0, Q2_rate = 0.0;
        int near = 0;
        for (int n = 0; n < 200; n++) {
            if (near) {
                const double step = (s - now) / rate;
                tau += step;
                if (fabs(step) <= 1e-15 * (1.0 + tau)) break;
            } else
                tau += pace;
            const double S = sin(psi + omega * tau), K = cos(psi + omega * tau), decay = exp(-alpha * tau);
            const double c = decay * cos(beta * tau), d = decay * sin(beta * tau);
            Q1 = offset + X * S + Y * K + z * c + B * d;
            Q1_rate = omega * (X * K - Y * S) + (beta * B - alpha * z) * c - (beta * z + alpha * B) * d;
            Q2 = q2 + (q2_rate + 0.5 * pull * s * tau) * tau;
            Q2_rate = q2_rate + pull * s * tau;
            now = Q1 - Q2;
            rate = Q1_rate - Q2_rate;
            if (s * rate <= 0.0) return i;
            if (s * now >= 1.0) near = 1;
        }
        v = Q1 + eps * Q2;
        v_rate = Q1_rate + eps * Q2_rate;
        psi += omega * tau;
        if (psi >= 2.0 * PI) { psi -= 2.0 * PI; turns += 1.0; }
        w = s;
        rows[3 * i] = psi + 2.0 * PI * turns;
        rows[3 * i + 1] = rate;
        rate *= -r;
        rows[3 * i + 2] = rate;
    }
    start[0] = psi; start[1] = w; start[2] = rate; start[3] = v; start[4] = v_rate;
    return count;
}
