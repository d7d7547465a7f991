/* Lorenz's equations as a compiled right-hand side: a table of three C functions, each for n points at once; see lorenz.py.
   x' = s (y - x),  y' = r x - y - x z,  z' = x y - b z.   p: r, s, b.
   cc -O2 -shared -fPIC -o lorenz.so lorenz.c */
#include <stdint.h>

static void f(int64_t n, const double *x, const double *t, const double *p, double *out)
{
    for (int64_t i = 0; i < n; i++, x += 3, out += 3) {
        out[0] = p[1] * (x[1] - x[0]);
        out[1] = p[0] * x[0] - x[1] - x[0] * x[2];
        out[2] = x[0] * x[1] - p[2] * x[2];
    }
}

static void dfdx(int64_t n, const double *x, const double *t, const double *p, double *out)
{   /* row by row */
    for (int64_t i = 0; i < n; i++, x += 3, out += 9) {
        double all[9] = {-p[1], p[1], 0.0, p[0] - x[2], -1.0, -x[0], x[1], x[0], -p[2]};
        for (int k = 0; k < 9; k++) out[k] = all[k];
    }
}

static void dfdp(int64_t n, const double *x, const double *t, const double *p, double *out)
{   /* of each rate by r, s, b */
    for (int64_t i = 0; i < n; i++, x += 3, out += 9) {
        double all[9] = {0.0, x[1] - x[0], 0.0, x[0], 0.0, 0.0, 0.0, 0.0, -x[2]};
        for (int k = 0; k < 9; k++) out[k] = all[k];
    }
}

void *table[3] = {(void *)f, (void *)dfdx, (void *)dfdp};
