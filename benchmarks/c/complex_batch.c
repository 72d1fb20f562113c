/* Addition of one divisor of y^2 = f(x), deg f <= 6, to N others in complex numbers: the yardstick of
   bench_float_batch.py.

   The formulas of jacobian/inexact/genus2_complex.py, written by hand in C, without its units, h or tests of the result. Columns
   of first and out: u0, u1, v0, v1, each N numbers. */

#include <complex.h>
#include <math.h>

typedef double complex number;
typedef struct {
    number u0, u1, v0, v1;
} divisor;
typedef struct {
    number q, l1, l0;
} line;
typedef struct {
    number w0, w1, w2, w3;
} cofactor;

#define INLINE static inline __attribute__((always_inline))

INLINE double larger(double a, double b) { return a > b ? a : b; }
INLINE double square(number z) { return creal(z) * creal(z) + cimag(z) * cimag(z); }
INLINE number phase(number z)
{
    double size = sqrt(square(z));
    return size > 0 ? z * (1 / size) : 1;
}

INLINE cofactor quotient(const number *f, divisor D)
{
    cofactor w;
    w.w3 = f[5] - D.u1 * f[6];
    w.w2 = f[4] - D.u1 * w.w3 - D.u0 * f[6];
    w.w1 = f[3] - D.u1 * w.w2 - D.u0 * w.w3;
    w.w0 = f[2] - D.v1 * D.v1 - D.u1 * w.w1 - D.u0 * w.w2;
    return w;
}

/* r[0] + r[1] x = a0 + ... + a4 x^4 modulo x^2 + u1 x + u0 */
INLINE void reduce(number a0, number a1, number a2, number a3, number a4, number u0, number u1, number *r)
{
    number high = a3 - u1 * a4, low = a2 - u1 * high - u0 * a4;
    r[0] = a0 - u0 * low, r[1] = a1 - u1 * low - u0 * high;
}

/* (l0, l1, q) with l0 a + l1 b = q r in the least-squares sense */
static __attribute__((noinline)) line slope(const number *a_, const number *b_, const number *r_)
{
    number a[4], b[4], r[4], dot_b = 0, dot_r = 0;
    double sizes[2] = {0, 0}, norm = 0;
    for (int i = 0; i < 4; i++)
        sizes[0] += square(a_[i]), sizes[1] += square(b_[i]);
    int swap = sizes[0] < sizes[1];
    for (int i = 0; i < 4; i++)
        a[i] = swap ? b_[i] : a_[i], b[i] = swap ? a_[i] : b_[i], r[i] = r_[i], norm += square(a[i]);
    norm = sqrt(norm);
    double k = 1 / (norm * (norm + sqrt(square(a[0]))));
    number turned = phase(a[0]) * norm;
    a[0] += turned;
    for (int i = 0; i < 4; i++)
        dot_b += conj(a[i]) * b[i] * k, dot_r += conj(a[i]) * r[i] * k;
    for (int i = 0; i < 4; i++)
        b[i] -= dot_b * a[i], r[i] -= dot_r * a[i];
    double rest = square(b[1]) + square(b[2]) + square(b[3]);
    number overlap = conj(b[1]) * r[1] + conj(b[2]) * r[2] + conj(b[3]) * r[3];
    if (norm + sqrt(rest) / 16 == norm)
        rest = 0, overlap = 1;
    number second = overlap * turned, first = b[0] * overlap - r[0] * rest, q = rest * turned;
    return swap ? (line){q, first, second} : (line){q, second, first};
}

INLINE line chord(const number *f, divisor D, divisor E, cofactor w)
{
    double weight = 1 / sqrt(larger(1, larger(square(E.v0), square(E.v1))));
    number a[4] = {D.u0 - E.u0, D.u1 - E.u1, (D.v0 + E.v0) * weight, (D.v1 + E.v1) * weight};
    number r[4] = {E.v0 - D.v0, E.v1 - D.v1};
    reduce(w.w0, w.w1, w.w2, w.w3, f[6], E.u0, E.u1, r + 2);
    r[2] *= weight, r[3] *= weight;
    number h0 = a[0] - E.u1 * a[1], h2 = a[2] - E.u1 * a[3];
    number chordal = a[0] * h0 + a[1] * a[1] * E.u0, tangent = a[2] * h2 + a[3] * a[3] * E.u0;
    double size = square(a[0]) + square(a[1]) + square(a[2]) + square(a[3]);
    double weights = square(chordal) + square(tangent);
    line l;
    if (weights > 1e-3 * size * size) {
        chordal = conj(chordal), tangent = conj(tangent);
        l.q = weights;
        l.l1 = chordal * (r[1] * a[0] - r[0] * a[1]) + tangent * (r[3] * a[2] - r[2] * a[3]);
        l.l0 = chordal * (r[0] * h0 + r[1] * a[1] * E.u0) + tangent * (r[2] * h2 + r[3] * a[3] * E.u0);
    } else {
        number b[4] = {-E.u0 * a[1], h0, -E.u0 * a[3], h2};
        l = slope(a, b, r);
    }
    double scale = 1 / sqrt(larger(square(l.l0), larger(square(l.l1), square(l.q))));
    return (line){l.q * scale, l.l1 * scale, l.l0 * scale};
}

static __attribute__((noinline)) void tangent_polynomial(const number *f, number q, const number *x, const number *r_,
                                                         divisor *out)
{
    number b0 = out->u0, b1 = out->u1, y[6], r[6], dot_y = 0, dot_r, m[2], d[2];
    double scale = 1, size = square(q), norm = square(q);
    for (int i = 0; i < 6; i++)
        r[i] = r_[i], scale += square(r_[i]);
    y[2] = -b0 * x[3], y[3] = x[2] - b1 * x[3], y[4] = -b0 * x[5], y[5] = x[4] - b1 * x[5];
    for (int i = 2; i < 6; i++)
        norm += square(x[i]);
    norm = sqrt(norm);
    number turn = phase(q), h = q + turn * norm, overlap = conj(q) * r[1];
    double k = 1 / (norm * (norm + sqrt(square(q))));
    dot_r = conj(h) * k * r[0];
    for (int i = 2; i < 6; i++)
        dot_y += conj(x[i]) * y[i] * k, dot_r += conj(x[i]) * r[i] * k;
    for (int i = 2; i < 6; i++)
        y[i] -= dot_y * x[i], r[i] -= dot_r * x[i], size += square(y[i]), overlap += conj(y[i]) * r[i];
    number inverse = conj(turn) * (1 / norm), lean = -dot_y * h * inverse, rest = -(r[0] - dot_r * h) * inverse;
    number c1 = size > 0 ? overlap * (1 / size) : 0, c0 = lean * c1 + rest;
    for (int pass = 0; pass < 2; pass++) {
        double sizes = square(c0) + square(c1), doubt = size * (sizes * sizes + square(f[0]) + square(f[1])) / scale;
        reduce(f[0] - c0 * c0, f[1] - 2 * c0 * c1, f[2] - c1 * c1, f[3], f[4], b0, b1, d);
        reduce(0, 0, 0, f[5], f[6], b0, b1, m);
        for (int i = 0; i < 2; i++) {
            number carry = m[1];
            m[1] = m[0] - b1 * carry, m[0] = -b0 * carry;
        }
        d[0] += m[0], d[1] += m[1];
        number top = 2 * c1, j0 = 2 * c0 * lean - b0 * top, j1 = 2 * (c1 * lean + c0) - b1 * top;
        number step = (conj(j0) * d[0] + conj(j1) * d[1]) * (1 / (square(j0) + square(j1) + doubt));
        c0 += step * lean, c1 += step;
    }
    out->v0 = c0, out->v1 = c1;
}

INLINE void second_polynomial(const number *f, divisor *S, const number *p, line l, divisor D, divisor E, cofactor w)
{
    number b0 = S->u0, b1 = S->u1, r[6], x[6], high = p[2] - b1 * p[3], top = -l.q * f[6];
    r[0] = b0 * high - p[0], r[1] = b0 * p[3] + b1 * high - p[1];
    reduce(l.l0 * D.v0 - l.q * w.w0, l.l0 * D.v1 + l.l1 * D.v0 - l.q * w.w1, l.l1 * D.v1 - l.q * w.w2, -l.q * w.w3, top,
           b0, b1, r + 2);
    double weight = 1 / sqrt(larger(1, larger(square(E.v0), square(E.v1))));
    number k0 = p[2] - E.u1 * l.l1;
    w = quotient(f, E);
    reduce(k0 * E.v0 - l.q * w.w0, k0 * E.v1 + l.l1 * E.v0 - l.q * w.w1, l.l1 * E.v1 - l.q * w.w2, -l.q * w.w3, top, b0,
           b1, r + 4);
    r[4] *= weight, r[5] *= weight;
    x[2] = l.l0, x[3] = l.l1, x[4] = k0 * weight, x[5] = l.l1 * weight;
    number lower = x[2] - b1 * x[3], lower2 = x[4] - b1 * x[5];
    number one = x[2] * lower + x[3] * x[3] * b0, other = x[4] * lower2 + x[5] * x[5] * b0;
    double total = square(one) + square(other) + square(l.q);
    if (total > 0.01) {
        double scale = 1 / total;
        one = conj(one) * scale, other = conj(other) * scale;
        number own = conj(l.q) * scale;
        S->v1 = one * (r[3] * x[2] - r[2] * x[3]) + other * (r[5] * x[4] - r[4] * x[5]) + own * r[1];
        S->v0 = one * (r[2] * lower + r[3] * x[3] * b0) + other * (r[4] * lower2 + r[5] * x[5] * b0) + own * r[0];
    } else
        tangent_polynomial(f, l.q, x, r, S);
}

void add_columns(const number *f, const number *first, const number *second, number *out, long n)
{
    divisor E = {second[0], second[1], second[2], second[3]};
    for (long i = 0; i < n; i++) {
        divisor D = {first[i], first[n + i], first[2 * n + i], first[3 * n + i]}, S;
        cofactor w = quotient(f, D);
        line l = chord(f, D, E, w);
        number p[4] = {l.q * D.v0 + D.u0 * l.l0, l.q * D.v1 + D.u1 * l.l0 + D.u0 * l.l1, l.l0 + D.u1 * l.l1, l.l1};
        number q2 = l.q * l.q, top = l.l1 * l.l1 - q2 * f[6], inverse = conj(top) * (1 / square(top));
        number sum1 = D.u1 + E.u1, sum0 = D.u0 + E.u0 + D.u1 * E.u1;
        S.u1 = (2 * l.l1 * p[2] - q2 * f[5]) * inverse - sum1;
        S.u0 = (p[2] * p[2] + 2 * l.l1 * p[1] - q2 * f[4]) * inverse - S.u1 * sum1 - sum0;
        second_polynomial(f, &S, p, l, D, E, w);
        out[i] = S.u0, out[n + i] = S.u1, out[2 * n + i] = S.v0, out[3 * n + i] = S.v1;
    }
}
