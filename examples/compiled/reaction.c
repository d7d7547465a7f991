/* A reaction A -> B in a stirred tank (Uppal, Ray and Poore 1974) as a compiled problem: a table of C functions.
   x' = -x + p (1 - x) exp(y),  y' = -b y + B p (1 - x) exp(y).   data: b, B.   work: F (2), dF/du (4), dF/dp (2).
   cc -O2 -shared -fPIC -o reaction.so reaction.c -lm */
#include <math.h>

static double linearise(const double *data, const double *u, double p, double *work)
{
    double b = data[0], B = data[1], e = exp(u[1]), r = (1.0 - u[0]) * e;
    double all[8] = {-u[0] + p * r, -b * u[1] + B * p * r,              /* F */
                     -1.0 - p * e, p * r, -B * p * e, -b + B * p * r,   /* dF/du, row by row */
                     r, B * r};                                         /* dF/dp */
    for (int i = 0; i < 8; i++) work[i] = all[i];
    return fmax(fabs(work[0]), fabs(work[1]));
}

/* [[F_u, F_p], [border]] x = (-F, n) and (0, 1): the rows of the inverse are cross products of the columns. */
static double bordered(const double *data, double *work, const double *g, double n, double *step, double *tangent)
{
    const double *F = work, *J = work + 2, *q = work + 6;
    double a[3] = {J[0], J[2], g[0]}, b[3] = {J[1], J[3], g[1]}, c[3] = {q[0], q[1], g[2]};
    double inverse[3][3] = {
        {b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]},
        {c[1] * a[2] - c[2] * a[1], c[2] * a[0] - c[0] * a[2], c[0] * a[1] - c[1] * a[0]},
        {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}};
    double det = a[0] * inverse[0][0] + a[1] * inverse[0][1] + a[2] * inverse[0][2];
    double by = 1.0 / (det != 0.0 ? det : 1e-300);
    for (int i = 0; i < 3; i++) {
        step[i] = by * (-inverse[i][0] * F[0] - inverse[i][1] * F[1] + inverse[i][2] * n);
        tangent[i] = by * inverse[i][2];
    }
    return (det > 0.0) - (det < 0.0);
}

static void inspect(const double *data, const double *u, double p, double *work, double *row)
{   /* both eigenvalues of dF/du as pairs (re, im) */
    const double *J = work + 2;
    double half = 0.5 * (J[0] + J[3]), below = half * half - (J[0] * J[3] - J[1] * J[2]), root = sqrt(fabs(below));
    row[0] = below < 0.0 ? half : half + root, row[1] = below < 0.0 ? root : 0.0;
    row[2] = below < 0.0 ? half : half - root, row[3] = below < 0.0 ? -root : 0.0;
}

void *table[6] = {(void *)linearise, (void *)bordered, (void *)inspect, 0, 0, 0};
