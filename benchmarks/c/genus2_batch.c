/* Addition and doubling of N divisors of y^2 = x^5 + f4 x^4 + ... + f0 modulo p: the yardstick of bench_batch.py.

   The formulas, the words, the blocks and the simultaneous inversion are those of jacobian/addition/genus2_words.py,
   jacobian/batch/block_loops.py and jacobian/numbers/words.py, written by hand in C. Compiled with -DBITS=32 or 64 and -DWIDE=0
   or 1, or -DBITS=53 (and -DWIDE=0) for floats: see bench_batch.py, which also compares the results. Special rows are
   counted, not computed. */

#include <math.h>
#include <stdint.h>

#if BITS == 53
typedef double word;
typedef double number;
typedef struct {
    number p, reciprocal, one, half;
} context;
#else
#if BITS == 32
typedef int32_t word;
typedef int64_t twice;
#else
typedef int64_t word;
typedef __int128 twice;
#endif
typedef int64_t number; /* between the dots: a word of either size */
typedef struct {
    number p, reciprocal, one, square, cube, half;
} context;
#endif

enum { BLOCK = 256, LANES = 32 };

typedef struct {
    number f2, f3, f4;
} quintic;
typedef struct {
    number a1, a0, b1, b0;
} line;
typedef struct {
    number r, s1, s0;
} quotient;

#define INLINE static inline __attribute__((always_inline))

#if BITS == 53
INLINE number mul(const context *K, number a, number b)
{
    number high = a * b, low = fma(a, b, -high), quotient = rint(high * K->reciprocal);
    return fma(-quotient, K->p, high) + low;
}

INLINE number dot2(const context *K, number a, number b, number c, number d) { return mul(K, a, b) + mul(K, c, d); }
INLINE number dot3(const context *K, number a, number b, number c, number d, number e, number f)
{
    return dot2(K, a, b, c, d) + mul(K, e, f);
}
INLINE number dot4(const context *K, number a, number b, number c, number d, number e, number f, number g, number h)
{
    return dot2(K, a, b, c, d) + dot2(K, e, f, g, h);
}
#else
INLINE twice times(number a, number b) { return (twice)(word)a * (word)b; }

INLINE number reduced(const context *K, twice t)
{
    twice m = times((number)times((number)t, K->reciprocal), K->p);
    return (number)((t >> BITS) - (m >> BITS));
}

INLINE number mul(const context *K, number a, number b) { return reduced(K, times(a, b)); }
INLINE number dot2(const context *K, number a, number b, number c, number d)
{
    return reduced(K, times(a, b) + times(c, d));
}
INLINE number dot3(const context *K, number a, number b, number c, number d, number e, number f)
{
    return reduced(K, times(a, b) + times(c, d) + times(e, f));
}
INLINE number dot4(const context *K, number a, number b, number c, number d, number e, number f, number g, number h)
{
    return reduced(K, times(a, b) + times(c, d) + times(e, f) + times(g, h));
}
#endif

INLINE number nearest(const context *K, number x)
{
    x = x > K->half ? x - K->p : x;
    return x < -K->half ? x + K->p : x;
}

INLINE number settled(const context *K, number x)
{
    if (!WIDE) {
        number far = K->p + K->half;
        x = x > far ? x - 3 * K->p : x;
        x = x < -far ? x + 3 * K->p : x;
    }
    return nearest(K, x);
}

INLINE number canonical(const context *K, number x) { return BITS == 53 ? settled(K, x) : nearest(K, x); }

INLINE number fit(const context *K, number x) { return WIDE ? canonical(K, x) : x; }

INLINE number add(const context *K, number x, number y) { return fit(K, x + y); }
INLINE number sub(const context *K, number x, number y) { return fit(K, x - y); }

static number inverse(const context *K, number x)
{
    uint64_t a = (uint64_t)K->p, b = (uint64_t)(x < 0 ? -x : x), s = 0, t = 1;
    while (b > 1) {
        uint64_t q = a / b, next = a - q * b;
        a = b;
        b = next;
        next = s - q * t;
        s = t;
        t = next;
    }
    number found = x > 0 ? (number)(int64_t)t : -(number)(int64_t)t;
#if BITS != 53
    found = mul(K, canonical(K, found), K->cube);
#endif
    return canonical(K, found);
}

INLINE quotient chord(const context *K, line d, line e)
{
    number z1 = sub(K, d.a1, e.a1), z2 = sub(K, e.a0, d.a0), w1 = sub(K, d.b1, e.b1), w0 = sub(K, d.b0, e.b0);
    number z3 = add(K, fit(K, mul(K, z1, e.a1)), z2);
    number top = -mul(K, z1, w1);
    quotient q = {dot2(K, z2, z3, mul(K, z1, z1), e.a0), dot3(K, z1, w0, z3, w1, top, e.a1),
                  dot2(K, z3, w0, top, e.a0)};
    return q;
}

INLINE quotient tangent(const context *K, const quintic *C, line d)
{
    number bent = sub(K, d.a1, C->f4);
    number twice_a = add(K, bent, d.a1), double_a0 = add(K, d.a0, d.a0);
    number k1 = sub(K, add(K, fit(K, mul(K, d.a1, add(K, bent, twice_a))), C->f3), double_a0);
    number rest = add(K, fit(K, mul(K, d.a1, bent)), C->f3);
    number k0 = sub(K, C->f2, fit(K, dot3(K, d.b1, d.b1, d.a1, rest, -double_a0, twice_a)));
    number t1 = add(K, d.b1, d.b1), t0 = add(K, d.b0, d.b0);
    number t3 = sub(K, t0, fit(K, mul(K, d.a1, t1)));
    number top = mul(K, t1, k1);
    quotient q = {dot2(K, d.a0, mul(K, t1, t1), t0, t3), dot3(K, t3, k1, -t1, k0, top, d.a1),
                  dot2(K, t3, k0, top, d.a0)};
    return q;
}

typedef struct {
    number lead, s, w4, w5;
} cubic;

INLINE cubic cubic_of(const context *K, quotient q, number inv)
{
    number shrink = mul(K, q.r, inv);
    cubic c = {mul(K, mul(K, q.s1, q.s1), inv), fit(K, mul(K, q.s0, shrink)), fit(K, mul(K, q.r, shrink)), 0};
    c.w5 = fit(K, mul(K, c.w4, c.w4));
    return c;
}

INLINE void sum_u(const context *K, const quintic *C, cubic c, line d, line e, line *sum)
{
    number turned = add(K, c.s, sub(K, d.a1, e.a1));
    sum->a1 = settled(K, sub(K, add(K, c.s, turned), c.w5));
    number bow = dot4(K, sub(K, c.s, e.a1), turned, c.s, d.a1, add(K, d.b1, d.b1), c.w4,
                      sub(K, add(K, d.a1, e.a1), C->f4), c.w5);
    sum->a0 = settled(K, add(K, fit(K, bow), sub(K, d.a0, e.a0)));
}

INLINE void sum_v(const context *K, cubic c, line d, line *sum)
{
    number w = sub(K, add(K, c.s, d.a1), sum->a1);
    number inner = add(K, fit(K, dot2(K, c.s, d.a1, -sum->a1, w)), sub(K, d.a0, sum->a0));
    sum->b1 = canonical(K, -add(K, fit(K, mul(K, c.lead, inner)), d.b1));
    sum->b0 = canonical(K, -add(K, fit(K, mul(K, c.lead, dot2(K, c.s, d.a0, -sum->a0, w))), d.b0));
}

static void invert_block(const context *K, word *restrict values)
{
    word before[BLOCK], tail[LANES];
    for (int j = 0; j < LANES; j++)
        tail[j] = values[j];
    for (int start = LANES; start < BLOCK; start += LANES)
        for (int j = 0; j < LANES; j++) {
            before[start + j] = tail[j];
            tail[j] = mul(K, tail[j], values[start + j]);
        }
    number total = K->one;
    for (int j = 0; j < LANES; j++) {
        before[j] = total;
        total = mul(K, total, tail[j]);
    }
    number back = inverse(K, canonical(K, total));
    for (int j = LANES - 1; j >= 0; j--) {
        number end = tail[j];
        tail[j] = mul(K, back, before[j]);
        back = mul(K, back, end);
    }
    for (int start = BLOCK - LANES; start > 0; start -= LANES)
        for (int j = 0; j < LANES; j++) {
            number x = values[start + j];
            values[start + j] = mul(K, tail[j], before[start + j]);
            tail[j] = mul(K, tail[j], x);
        }
    for (int j = 0; j < LANES; j++)
        values[j] = tail[j];
}

/* x, y, out: four rows of n words (u0, u1, v0, v1). y may be x: then the rows are doubled. Returns the number of rows
   that are not general; their results are meaningless. */
int64_t genus2_rows(const context *K, const quintic *C, int64_t n, const word *x, const word *y, word *out)
{
    int64_t special = 0;
    for (int64_t start = 0; start < n; start += BLOCK) {
        int size = n - start < BLOCK ? (int)(n - start) : BLOCK;
        word d[4][BLOCK] = {{0}}, e[4][BLOCK] = {{0}}, r[BLOCK], s1[BLOCK], s0[BLOCK], values[BLOCK];
        for (int k = 0; k < 4; k++)
            for (int j = 0; j < size; j++) {
                d[k][j] = x[k * n + start + j];
                e[k][j] = y[k * n + start + j];
            }
        for (int j = 0; j < BLOCK; j++) {
            line first = {d[1][j], d[0][j], d[3][j], d[2][j]}, second = {e[1][j], e[0][j], e[3][j], e[2][j]};
            quotient q = x == y ? tangent(K, C, first) : chord(K, first, second);
            r[j] = q.r;
            s1[j] = q.s1;
            s0[j] = q.s0;
            values[j] = canonical(K, mul(K, q.r, q.s1));
        }
        for (int j = 0; j < BLOCK; j++)
            if (values[j] == 0) {
                values[j] = K->one;
                special += j < size;
            }
        invert_block(K, values);
        for (int j = 0; j < BLOCK; j++) {
            quotient q = {r[j], s1[j], s0[j]};
            cubic c = cubic_of(K, q, values[j]);
            r[j] = c.lead;
            s1[j] = c.s;
            s0[j] = c.w4;
            values[j] = c.w5;
        }
        for (int j = 0; j < BLOCK; j++) {
            line first = {d[1][j], d[0][j], d[3][j], d[2][j]}, second = {e[1][j], e[0][j], e[3][j], e[2][j]}, sum;
            cubic c = {r[j], s1[j], s0[j], values[j]};
            sum_u(K, C, c, first, second, &sum);
            e[0][j] = sum.a0;
            e[1][j] = sum.a1;
        }
        for (int j = 0; j < BLOCK; j++) {
            line first = {d[1][j], d[0][j], d[3][j], d[2][j]}, sum = {e[1][j], e[0][j], 0, 0};
            cubic c = {r[j], s1[j], s0[j], values[j]};
            sum_v(K, c, first, &sum);
            e[2][j] = sum.b0;
            e[3][j] = sum.b1;
        }
        for (int k = 0; k < 4; k++)
            for (int j = 0; j < size; j++)
                out[k * n + start + j] = e[k][j];
    }
    return special;
}
