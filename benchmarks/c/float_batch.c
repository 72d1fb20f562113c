/* Addition of one divisor of y^2 = f(x), deg f <= 5, to N others in floats: the yardstick of bench_float_batch.py.

   The formulas of jacobian/inexact/genus2_real.py, written by hand in C, without its units, h or tests of the result. Columns of
   first and out: u0, u1, v0, v1, each N numbers. */

#include <math.h>

typedef struct {
    double u0, u1, v0, v1;
} divisor;
typedef struct {
    double q, l1, l0;
} line;

#define INLINE static inline __attribute__((always_inline))

INLINE double larger(double a, double b) { return a > b ? a : b; }
INLINE double square(double a) { return a * a; }

/* (l0, l1, q) with l0 a + l1 b = q r in the least-squares sense */
static __attribute__((noinline)) line slope(const double *a_, const double *b_, const double *r_)
{
    double a[4], b[4], r[4], sizes[2] = {0, 0};
    for (int i = 0; i < 4; i++)
        a[i] = a_[i], b[i] = b_[i], r[i] = r_[i], sizes[0] += square(a_[i]), sizes[1] += square(b_[i]);
    int swap = sizes[0] < sizes[1];
    if (swap)
        for (int i = 0; i < 4; i++)
            a[i] = b_[i], b[i] = a_[i];
    double norm = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2] + a[3] * a[3]);
    if (a[0] < 0)
        norm = -norm;
    a[0] += norm;
    double k = 1 / (norm * a[0]), dot_b = 0, dot_r = 0;
    for (int i = 0; i < 4; i++)
        dot_b += a[i] * b[i] * k, dot_r += a[i] * r[i] * k;
    for (int i = 0; i < 4; i++)
        b[i] -= dot_b * a[i], r[i] -= dot_r * a[i];
    double size = b[1] * b[1] + b[2] * b[2] + b[3] * b[3], overlap = b[1] * r[1] + b[2] * r[2] + b[3] * r[3];
    if (norm + sqrt(size) / 16 == norm)
        size = 0, overlap = 1;
    double second = overlap * norm, first = b[0] * overlap - r[0] * size, q = size * norm;
    return swap ? (line){q, first, second} : (line){q, second, first};
}

INLINE line chord(const double *f, divisor D, divisor E)
{
    double w2 = f[4] - D.u1 * f[5], w1 = f[3] - D.u1 * w2 - D.u0 * f[5];
    double w0 = f[2] - D.v1 * D.v1 - D.u1 * w1 - D.u0 * w2, high = w2 - E.u1 * f[5];
    double weight = 1 / larger(1, larger(fabs(E.v0), fabs(E.v1)));
    double a0 = D.u0 - E.u0, a1 = D.u1 - E.u1, a2 = (D.v0 + E.v0) * weight, a3 = (D.v1 + E.v1) * weight;
    double r0 = E.v0 - D.v0, r1 = E.v1 - D.v1;
    double r2 = (w0 - E.u0 * high) * weight, r3 = (w1 - E.u0 * f[5] - E.u1 * high) * weight;
    double h0 = a0 - E.u1 * a1, h2 = a2 - E.u1 * a3;
    double chordal = a0 * h0 + a1 * a1 * E.u0, tangent = a2 * h2 + a3 * a3 * E.u0;
    double size = a0 * a0 + a1 * a1 + a2 * a2 + a3 * a3;
    line l = {chordal * chordal + tangent * tangent, 0, 0};
    if (l.q > 1e-3 * size * size) {
        l.l1 = chordal * (r1 * a0 - r0 * a1) + tangent * (r3 * a2 - r2 * a3);
        l.l0 = chordal * (r0 * h0 + r1 * a1 * E.u0) + tangent * (r2 * h2 + r3 * a3 * E.u0);
    } else {
        double a[4] = {a0, a1, a2, a3}, b[4] = {-E.u0 * a1, h0, -E.u0 * a3, h2}, r[4] = {r0, r1, r2, r3};
        l = slope(a, b, r);
    }
    double scale = 1 / larger(fabs(l.l0), larger(fabs(l.l1), fabs(l.q)));
    return (line){l.q * scale, l.l1 * scale, l.l0 * scale};
}

static __attribute__((noinline)) void tangent_polynomial(const double *f, double b0, double b1, double q,
                                                         const double *x, const double *r_, divisor *out)
{
    double y[6], r[6], scale = 1, size = q * q, norm = q * q;
    for (int i = 0; i < 6; i++)
        r[i] = r_[i], scale += r_[i] * r_[i];
    y[2] = -b0 * x[3], y[3] = x[2] - b1 * x[3], y[4] = -b0 * x[5], y[5] = x[4] - b1 * x[5];
    for (int i = 2; i < 6; i++)
        norm += x[i] * x[i];
    norm = sqrt(norm);
    double h = q + norm, k = 1 / (norm * h), dot_y = 0, dot_r = h * r[0] * k;
    for (int i = 2; i < 6; i++)
        dot_y += x[i] * y[i] * k, dot_r += x[i] * r[i] * k;
    y[0] = -dot_y * h, r[0] -= dot_r * h;
    double overlap = q * r[1];
    for (int i = 2; i < 6; i++)
        y[i] -= dot_y * x[i], r[i] -= dot_r * x[i], size += y[i] * y[i], overlap += y[i] * r[i];
    double c1 = size > 0 ? overlap / size : size, c0 = (y[0] * c1 - r[0]) / norm;
    for (int pass = 0; pass < 2; pass++) {
        double squares = c0 * c0 + c1 * c1, doubt = size * (squares * squares + f[0] * f[0] + f[1] * f[1]) / scale;
        double e2 = f[4] - b1 * f[5], e3 = f[3] - b1 * e2 - b0 * f[5], e4 = f[2] - c1 * c1 - b1 * e3 - b0 * e2;
        double d1 = f[1] - 2 * c0 * c1 - b1 * e4 - b0 * e3, d0 = f[0] - c0 * c0 - b0 * e4;
        double direction = y[0] / norm, top = 2 * c1;
        double j0 = 2 * c0 * direction - b0 * top, j1 = 2 * (c1 * direction + c0) - b1 * top;
        double step = (j0 * d0 + j1 * d1) / (j0 * j0 + j1 * j1 + doubt);
        c0 += step * direction, c1 += step;
    }
    out->v0 = c0, out->v1 = c1;
}

INLINE void second_polynomial(const double *f, divisor *S, const double *p, line l, divisor D, divisor E)
{
    double b0 = S->u0, b1 = S->u1, r[6], x[6];
    double high = p[2] - b1 * p[3];
    r[0] = b0 * high - p[0], r[1] = b0 * p[3] + b1 * high - p[1];
    double g3 = -l.q * f[5], w2 = f[4] - D.u1 * f[5], w1 = f[3] - D.u1 * w2 - D.u0 * f[5];
    double w0 = f[2] - D.v1 * D.v1 - D.u1 * w1 - D.u0 * w2;
    high = l.l1 * D.v1 - l.q * w2 - b1 * g3;
    r[2] = l.l0 * D.v0 - l.q * w0 - b0 * high;
    r[3] = l.l0 * D.v1 + l.l1 * D.v0 - l.q * w1 - b0 * g3 - b1 * high;
    double weight = 1 / larger(1, larger(fabs(E.v0), fabs(E.v1))), k0 = p[2] - E.u1 * l.l1;
    w2 = f[4] - E.u1 * f[5], w1 = f[3] - E.u1 * w2 - E.u0 * f[5];
    w0 = f[2] - E.v1 * E.v1 - E.u1 * w1 - E.u0 * w2;
    high = l.l1 * E.v1 - l.q * w2 - b1 * g3;
    r[4] = (k0 * E.v0 - l.q * w0 - b0 * high) * weight;
    r[5] = (k0 * E.v1 + l.l1 * E.v0 - l.q * w1 - b0 * g3 - b1 * high) * weight;
    x[2] = l.l0, x[3] = l.l1, x[4] = k0 * weight, x[5] = l.l1 * weight;
    double lower = x[2] - b1 * x[3], lower2 = x[4] - b1 * x[5];
    double one = x[2] * lower + x[3] * x[3] * b0, other = x[4] * lower2 + x[5] * x[5] * b0;
    double total = one * one + other * other + l.q * l.q;
    if (total > 0.01) {
        double scale = 1 / total;
        S->v1 = (one * (r[3] * x[2] - r[2] * x[3]) + other * (r[5] * x[4] - r[4] * x[5]) + l.q * r[1]) * scale;
        S->v0 = (one * (r[2] * lower + r[3] * x[3] * b0) + other * (r[4] * lower2 + r[5] * x[5] * b0) + l.q * r[0])
                * scale;
    } else
        tangent_polynomial(f, b0, b1, l.q, x, r, S);
}

void add_columns(const double *f, const double *first, const double *second, double *out, long n)
{
    divisor E = {second[0], second[1], second[2], second[3]};
    for (long i = 0; i < n; i++) {
        divisor D = {first[i], first[n + i], first[2 * n + i], first[3 * n + i]}, S;
        line l = chord(f, D, E);
        double p[4] = {l.q * D.v0 + D.u0 * l.l0, l.q * D.v1 + D.u1 * l.l0 + D.u0 * l.l1, l.l0 + D.u1 * l.l1, l.l1};
        double lead = 1 / (l.l1 * l.l1), q2 = l.q * l.q, sum1 = D.u1 + E.u1, sum0 = D.u0 + E.u0 + D.u1 * E.u1;
        S.u1 = (2 * l.l1 * p[2] - q2 * f[5]) * lead - sum1;
        S.u0 = (p[2] * p[2] + 2 * l.l1 * p[1] - q2 * f[4]) * lead - S.u1 * sum1 - sum0;
        second_polynomial(f, &S, p, l, D, E);
        out[i] = S.u0, out[n + i] = S.u1, out[2 * n + i] = S.v0, out[3 * n + i] = S.v1;
    }
}
