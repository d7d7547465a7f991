/* The floor: continuation of the orbit P_2^1 of the reduced absorber, repeated l/2 times, in the most direct way.

   Unknowns (Psi_i, B_i), i = 0 .. l-1, walls L, R, L, R, ...; parameter: the amplitude C of the shaking. Per point:
   predictor, Newton sweeps (residual, Jacobian, bordered elimination giving step and tangent), step length from the
   angle between tangents and the predictor's error, multipliers of the monodromy matrix, three margins per flight.

   Two eliminations: forward condensation onto the first node (cheapest; loses digits on long unstable words), and
   Householder reflections on neighbouring blocks (keeps them). Compiled with -DVECTOR and fast maths the sines and
   cosines are vectorised. */

#include <math.h>
#include <string.h>

typedef struct {
    double r, a, omega;      /* restitution, friction acceleration (1+eps) mu g, frequency */
    double shift;            /* 2 pi k */
    int l;                   /* nodes */
    int orthogonal;          /* which elimination */
    double *F, *A, *D, *Q;   /* 2l, 4l, 4l, 2l : residual and blocks */
    double *trig;            /* 2(l+1): sines, cosines */
    double *keep;            /* 20 l: what the elimination stores */
    double *solution;        /* 2(2l+1) */
} Work;

static double linearise(Work *w, const double *u, double C)
{
    const int l = w->l;
    const double r = w->r, a = w->a, omega = w->omega, by = 1.0 / omega, speed = C * omega;
    double *sine = w->trig, *cosine = w->trig + l + 1, largest = 0.0;
#ifdef VECTOR
    for (int i = 0; i < l; i++) sine[i] = sin(u[2 * i]);
    for (int i = 0; i < l; i++) cosine[i] = cos(u[2 * i]);
#else
    for (int i = 0; i < l; i++) { sine[i] = sin(u[2 * i]); cosine[i] = cos(u[2 * i]); }
#endif
    sine[l] = sine[0];
    cosine[l] = cosine[0];
    for (int i = 0; i < l; i++) {
        const int next = i + 1 < l ? i + 1 : 0;
        const double s = i % 2 ? 1.0 : -1.0, sa = s * a, b0 = u[2 * i + 1], b1 = u[2 * next + 1];
        const double psi1 = i + 1 < l ? u[2 * next] : u[0] + w->shift;
        const double d = (psi1 - u[2 * i]) * by, s0 = sine[i], c0 = cosine[i], s1 = sine[i + 1], c1 = cosine[i + 1];
        const double pull = b0 + sa * d, V = speed * c1 - pull;
        double *F = w->F + 2 * i, *A = w->A + 4 * i, *D = w->D + 4 * i, *Q = w->Q + 2 * i;
        F[0] = b1 - speed * c1 - r * V;
        F[1] = -2.0 * s + C * (s1 - s0) - (b0 + 0.5 * sa * d) * d;
        A[0] = -r * sa * by;
        A[1] = r;
        A[2] = pull * by - C * c0;
        A[3] = -d;
        D[0] = (1.0 + r) * speed * s1 + r * sa * by;
        D[1] = 1.0;
        D[2] = V * by;
        D[3] = 0.0;
        Q[0] = -(1.0 + r) * omega * c1;
        Q[1] = s1 - s0;
        largest = fmax(largest, fmax(fabs(F[0]), fabs(F[1])));
    }
    return largest;
}

/* 2 x 4 system m (columns x_0, p, right-hand side) by complete pivoting: particular and null solution. */
static double close_cycle(double m[2][4], double part[3], double null[3])
{
    int order[3] = {0, 1, 2};
    double sign = 1.0;
    for (int j = 0; j < 2; j++) {
        int row = j, column = j;
        double best = -1.0;
        for (int i = j; i < 2; i++)
            for (int c = j; c < 3; c++)
                if (fabs(m[i][c]) > best) { best = fabs(m[i][c]); row = i; column = c; }
        if (row != j) {
            sign = -sign;
            for (int c = 0; c < 4; c++) { double t = m[j][c]; m[j][c] = m[row][c]; m[row][c] = t; }
        }
        if (column != j) {
            sign = -sign;
            int t = order[j]; order[j] = order[column]; order[column] = t;
            for (int i = 0; i < 2; i++) { double x = m[i][j]; m[i][j] = m[i][column]; m[i][column] = x; }
        }
        if (m[j][j] < 0.0) sign = -sign;
        if (j == 0) {
            const double ratio = m[1][0] / m[0][0];
            for (int c = 1; c < 4; c++) m[1][c] -= ratio * m[0][c];
        }
    }
    part[order[2]] = 0.0;
    null[order[2]] = 1.0;
    part[order[1]] = m[1][3] / m[1][1];
    null[order[1]] = -m[1][2] / m[1][1];
    part[order[0]] = (m[0][3] - m[0][1] * part[order[1]]) / m[0][0];
    null[order[0]] = -(m[0][2] + m[0][1] * null[order[1]]) / m[0][0];
    return sign;
}

/* x_{i+1} = P x_0 + q p + f, carried forward; keep holds (P, q, f) of every node; the last P is the monodromy. */
static double forward(Work *w, double *part, double *null)
{
    const int l = w->l;
    double p00 = 1, p01 = 0, p10 = 0, p11 = 1, q0 = 0, q1 = 0, f0 = 0, f1 = 0;
    for (int i = 0; i < l; i++) {
        double *k = w->keep + 8 * i;
        const double *F = w->F + 2 * i, *A = w->A + 4 * i, *D = w->D + 4 * i, *Q = w->Q + 2 * i;
        k[0] = p00; k[1] = p01; k[2] = p10; k[3] = p11; k[4] = q0; k[5] = q1; k[6] = f0; k[7] = f1;
        const double inverse = -1.0 / D[2];   /* D = [[D0, 1], [D2, 0]] */
        const double m10 = A[2] * inverse, m11 = A[3] * inverse, e1 = Q[1] * inverse, g1 = F[1] * inverse;
        const double m00 = -A[0] - D[0] * m10, m01 = -A[1] - D[0] * m11, e0 = -Q[0] - D[0] * e1, g0 = -F[0] - D[0] * g1;
        /* new Psi from row 1, new B from row 0 */
        double t;
        t = m10 * p00 + m11 * p10; p10 = m00 * p00 + m01 * p10; p00 = t;
        t = m10 * p01 + m11 * p11; p11 = m00 * p01 + m01 * p11; p01 = t;
        t = m10 * q0 + m11 * q1 + e1; q1 = m00 * q0 + m01 * q1 + e0; q0 = t;
        t = m10 * f0 + m11 * f1 + g1; f1 = m00 * f0 + m01 * f1 + g0; f0 = t;
    }
    double *end = w->keep + 8 * l, x[3], y[3];
    end[0] = p00; end[1] = p01; end[2] = p10; end[3] = p11;
    double m[2][4] = {{p00 - 1.0, p01, q0, -f0}, {p10, p11 - 1.0, q1, -f1}};
    const double sign = close_cycle(m, x, y);
    for (int i = 0; i < l; i++) {
        const double *k = w->keep + 8 * i;
        part[2 * i] = k[0] * x[0] + k[1] * x[1] + k[4] * x[2] + k[6];
        part[2 * i + 1] = k[2] * x[0] + k[3] * x[1] + k[5] * x[2] + k[7];
        null[2 * i] = k[0] * y[0] + k[1] * y[1] + k[4] * y[2];
        null[2 * i + 1] = k[2] * y[0] + k[3] * y[1] + k[5] * y[2];
    }
    part[2 * l] = x[2];
    null[2 * l] = y[2];
    return sign;
}

/* Columns of a panel of 4 rows: x_i (2), x_0 (2), x_{i+1} (2), p, right-hand side. */
static double orthogonal(Work *w, double *part, double *null)
{
    const int l = w->l;
    double sign = 1.0, top[2][8] = {{0}};
    for (int i = 0; i < 2; i++) {
        top[i][0] = w->D[2 * i]; top[i][1] = w->D[2 * i + 1];
        top[i][2] = w->A[2 * i]; top[i][3] = w->A[2 * i + 1];
        top[i][6] = w->Q[i]; top[i][7] = -w->F[i];
    }
    for (int b = 1; b < l; b++) {
        const double *F = w->F + 2 * b, *A = w->A + 4 * b, *D = w->D + 4 * b, *Q = w->Q + 2 * b;
        double m[4][8];
        memcpy(m, top, sizeof top);
        for (int i = 0; i < 2; i++) {
            double *row = m[2 + i];
            row[0] = A[2 * i]; row[1] = A[2 * i + 1]; row[2] = row[3] = 0.0;
            row[4] = D[2 * i]; row[5] = D[2 * i + 1]; row[6] = Q[i]; row[7] = -F[i];
            m[i][4] = m[i][5] = 0.0;
        }
        for (int j = 0; j < 2; j++) {
            double square = 0.0;
            for (int i = j + 1; i < 4; i++) square += m[i][j] * m[i][j];
            const double head = m[j][j], norm = head > 0.0 ? -sqrt(square + head * head) : sqrt(square + head * head);
            const double v0 = head - norm, factor = 1.0 / (norm * v0);
            double dot[8];
            for (int c = 0; c < 8; c++) dot[c] = v0 * m[j][c];
            for (int i = j + 1; i < 4; i++)
                for (int c = 0; c < 8; c++) dot[c] += m[i][j] * m[i][c];
            double v[4] = {0};
            v[j] = v0 * factor;
            for (int i = j + 1; i < 4; i++) v[i] = m[i][j] * factor;
            for (int i = j; i < 4; i++)
                for (int c = 0; c < 8; c++) m[i][c] += v[i] * dot[c];
            sign = norm < 0.0 ? sign : -sign;
        }
        double *k = w->keep + 16 * b;
        memcpy(k, m, 16 * sizeof(double));
        for (int i = 0; i < 2; i++) {
            double *row = m[2 + i];
            top[i][0] = row[4]; top[i][1] = row[5]; top[i][2] = row[2]; top[i][3] = row[3];
            top[i][6] = row[6]; top[i][7] = row[7];
        }
    }
    double m[2][4], x[3], y[3];
    for (int i = 0; i < 2; i++) {
        m[i][0] = top[i][0] + top[i][2]; m[i][1] = top[i][1] + top[i][3]; m[i][2] = top[i][6]; m[i][3] = top[i][7];
    }
    sign *= close_cycle(m, x, y);
    part[0] = x[0]; part[1] = x[1]; part[2 * l] = x[2];
    null[0] = y[0]; null[1] = y[1]; null[2 * l] = y[2];
    double n0 = x[0], n1 = x[1], z0 = y[0], z1 = y[1];
    for (int b = l - 1; b > 0; b--) {
        const double *k = w->keep + 16 * b;
        const double b1 = k[15] - k[14] * x[2] - k[10] * x[0] - k[11] * x[1] - k[12] * n0 - k[13] * n1;
        const double b0 = k[7] - k[6] * x[2] - k[2] * x[0] - k[3] * x[1] - k[4] * n0 - k[5] * n1;
        const double e1 = -k[14] * y[2] - k[10] * y[0] - k[11] * y[1] - k[12] * z0 - k[13] * z1;
        const double e0 = -k[6] * y[2] - k[2] * y[0] - k[3] * y[1] - k[4] * z0 - k[5] * z1;
        const double i1 = 1.0 / k[9], i0 = 1.0 / k[0];
        n1 = b1 * i1; n0 = (b0 - k[1] * n1) * i0;
        z1 = e1 * i1; z0 = (e0 - k[1] * z1) * i0;
        part[2 * b] = n0; part[2 * b + 1] = n1;
        null[2 * b] = z0; null[2 * b + 1] = z1;
    }
    return sign;
}

/* step: solution of the bordered system for (-F, n); tangent: for (0, 1). */
static double bordered(Work *w, const double *border, double n, double *step, double *tangent)
{
    const int size = 2 * w->l;
    double *part = w->solution, *null = part + size + 1, along = 0.0, across = 0.0;
    double sign = w->orthogonal ? orthogonal(w, part, null) : forward(w, part, null);
    for (int i = 0; i <= size; i++) { across += border[i] * part[i]; along += border[i] * null[i]; }
    if (along < 0.0) sign = -sign;
    const double share = (n - across) / along, inverse = 1.0 / along;
    for (int i = 0; i <= size; i++) { step[i] = part[i] + share * null[i]; tangent[i] = null[i] * inverse; }
    return sign;
}

/* Multipliers (4 numbers), then per node: flight, approach speed, infinity (no turn here), duration. */
static void inspect(Work *w, const double *u, double C, double *row)
{
    const int l = w->l;
    double p00, p01, p10, p11;
    if (w->orthogonal) {
        p00 = p11 = 1.0; p01 = p10 = 0.0;
        for (int i = 0; i < l; i++) {
            const double *A = w->A + 4 * i, *D = w->D + 4 * i;
            const double inverse = -1.0 / D[2], m10 = A[2] * inverse, m11 = A[3] * inverse;
            const double m00 = -A[0] - D[0] * m10, m01 = -A[1] - D[0] * m11;
            double t;
            t = m10 * p00 + m11 * p10; p10 = m00 * p00 + m01 * p10; p00 = t;
            t = m10 * p01 + m11 * p11; p11 = m00 * p01 + m01 * p11; p01 = t;
        }
    } else {
        const double *end = w->keep + 8 * l;
        p00 = end[0]; p01 = end[1]; p10 = end[2]; p11 = end[3];
    }
    const double half = 0.5 * (p00 + p11), det = p00 * p11 - p01 * p10, disc = half * half - det;
    if (disc >= 0.0) {
        const double root = half + copysign(sqrt(disc), half);
        row[0] = root; row[1] = 0.0; row[2] = det / root; row[3] = 0.0;
    } else {
        row[0] = row[2] = half; row[1] = sqrt(-disc); row[3] = -row[1];
    }
    const double omega = w->omega, a = w->a, speed = C * omega, ratio = a / (speed * omega), pi = 3.14159265358979323846;
    const double reversal = ratio < 1.0 ? asin(ratio) : 0.0, root = ratio < 1.0 ? sqrt(1.0 - ratio * ratio) : 0.0;
    for (int i = 0; i < l; i++) {
        const int next = i + 1 < l ? i + 1 : 0;
        const double s = i % 2 ? 1.0 : -1.0, psi0 = u[2 * i], psi1 = next ? u[2 * next] : u[0] + w->shift;
        const double d = (psi1 - psi0) / omega, beta = u[2 * i + 1];
        double flight = INFINITY;
        if (ratio < 1.0) {
            const double base = s > 0.0 ? pi + reversal : reversal;
            const double last = base + 2.0 * pi * floor((psi1 - base) / (2.0 * pi));
            if (last > psi0) flight = s * (-speed * s * root - beta) - a * (last - psi0) / omega;
        }
        row[4 + 4 * i] = flight;
        row[4 + 4 * next + 1] = s * (speed * w->trig[w->l + 1 + i + 1] - beta - s * a * d);
        row[4 + 4 * i + 2] = INFINITY;
        row[4 + 4 * i + 3] = d;
    }
}

/* Newton's method on F = 0, border.(u, p) = target. Returns the sweeps taken, or -1. */
static int correct(Work *w, double *u, double *p, const double *border, double target, double tolerance, int most,
                   double *step, double *tangent, double *sign)
{
    const int n = 2 * w->l;
    double before = 0.0;
    for (int sweep = 0; sweep < most; sweep++) {
        if (!(linearise(w, u, *p) < 1e300)) return -1;
        double gap = target - border[n] * *p;
        for (int i = 0; i < n; i++) gap -= border[i] * u[i];
        *sign = bordered(w, border, gap, step, tangent);
        double size = fabs(step[n]) / (1.0 + fabs(*p));
        for (int i = 0; i < n; i++) size = fmax(size, fabs(step[i]) / (1.0 + fabs(u[i])));
        if (!(size < 1e6)) return -1;
        for (int i = 0; i < n; i++) u[i] += step[i];
        *p += step[n];
        const double ratio = size / before;
        if (size <= 1e-11 || (sweep > 0 && size <= tolerance && ratio * ratio * size <= 1e-13)) return sweep + 1;
        before = size;
    }
    return -1;
}

static double predict(const double *x, const double *y, const double *tx, const double *ty, double px, double py,
                      int n, double h, double metric_u, double metric_p, int straight, double *u)
{
    /* x, tx: last point and tangent; y, ty: the one before */
    if (!straight) {
        double chord = 0.0, bend = 0.0;
        for (int j = 0; j < n; j++) {
            chord += (x[j] - y[j]) * (x[j] - y[j]);
            bend += (tx[j] - ty[j]) * (tx[j] - ty[j]);
        }
        const double square = metric_u * chord + metric_p * (px - py) * (px - py);
        const double turn = metric_u * bend + metric_p * (tx[n] - ty[n]) * (tx[n] - ty[n]);
        const double d = sqrt(square) * (1.0 + turn / 24.0);
        if (d > 0.0 && turn < 1.0 && h < 4.0 * d) {
            const double s = h / d, by = 1.0 / d;
            for (int j = 0; j < n; j++) {
                const double mean = (x[j] - y[j]) * by;
                u[j] = x[j] + h * (tx[j] + s * (2.0 * tx[j] + ty[j] - 3.0 * mean + s * (tx[j] + ty[j] - 2.0 * mean)));
            }
            const double mean = (px - py) * by;
            return px + h * (tx[n] + s * (2.0 * tx[n] + ty[n] - 3.0 * mean + s * (tx[n] + ty[n] - 2.0 * mean)));
        }
    }
    for (int j = 0; j < n; j++) u[j] = x[j] + h * tx[j];
    return px + h * tx[n];
}

/* Continue from the solution in points[0], values[0], tangents[0]; control = {metric_u, metric_p, angle, min step,
   max step, tolerance, lower, upper}; memory holds 60 l + 100 numbers. Returns the points filled. */
int floor_march(int l, int eliminate, int most, const double *params, const double *control, int count, double *points,
                double *values, double *tangents, double *rows, double *memory, double h, long *work_done)
{
    const int n = 2 * l, row = 4 + 4 * l;
    Work w = {params[1], (1.0 + params[4]) * params[2] * params[3], params[5], l * 3.14159265358979323846, l, eliminate};
    w.F = memory; w.Q = w.F + 2 * l; w.A = w.Q + 2 * l; w.D = w.A + 4 * l; w.trig = w.D + 4 * l;
    w.keep = w.trig + 2 * l + 2; w.solution = w.keep + 16 * l + 8;
    double *u = w.solution + 2 * n + 2, *border = u + n, *step = border + n + 1, *tangent = step + n + 1;
    const double metric_u = control[0], metric_p = control[1], angle = control[2];
    long sweeps_done = 0, tried = 0;
    int i = 1;
    while (i < count) {
        const double *last = tangents + (long)(i - 1) * (n + 1);
        if (h < control[3]) break;
        const int back = i > 1;
        double p = predict(points + (long)(i - 1) * n, points + (long)(i - 1 - back) * n, last, last - back * (n + 1),
                           values[i - 1], values[i - 1 - back], n, h, metric_u, metric_p, !back, u);
        if (p > control[7] || p < control[6]) break;
        double target = 0.0, *here = points + (long)i * n;
        for (int j = 0; j < n; j++) {
            border[j] = metric_u * last[j];
            target += border[j] * u[j];
            here[j] = u[j];
        }
        border[n] = metric_p * last[n];
        target += border[n] * p;
        const double guess = p;
        double sign;
        tried++;
        const int sweeps = correct(&w, u, &p, border, target, control[5], most, step, tangent, &sign);
        if (sweeps < 0) { h *= 0.5; continue; }
        sweeps_done += sweeps;
        double norm = 0.0, cosine = 0.0, error = 0.0;
        for (int j = 0; j < n; j++) {
            norm += tangent[j] * tangent[j];
            cosine += tangent[j] * last[j];
            error += (u[j] - here[j]) * (u[j] - here[j]);
        }
        norm = sqrt(metric_u * norm + metric_p * tangent[n] * tangent[n]);
        cosine = (metric_u * cosine + metric_p * tangent[n] * last[n]) / norm;
        error = sqrt(metric_u * error + metric_p * (p - guess) * (p - guess));
        const double turn = sqrt(fmax(0.0, 2.0 - 2.0 * cosine));
        if (!(turn <= 2.0 * angle && error <= angle * h + 1e-12)) { h *= 0.5; continue; }
        if (p > control[7] || p < control[6]) break;
        double *t = tangents + (long)i * (n + 1);
        const double by = 1.0 / norm;
        for (int j = 0; j < n; j++) {
            here[j] = u[j];
            t[j] = tangent[j] * by;
        }
        t[n] = tangent[n] * by;
        values[i] = p;
        inspect(&w, u, p, rows + (long)i * row);
        i++;
        double factor = turn > 0.5 * angle ? fmax(0.5, angle / turn) : 2.0;
        if (sweeps > 3) factor = fmin(factor, 0.8);
        h = fmin(h * factor, control[4]);
    }
    work_done[0] = sweeps_done;
    work_done[1] = tried;
    return i;
}
