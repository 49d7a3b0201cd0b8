/* SPDX-License-Identifier: BSD-3-Clause */
/* The series of the tangent at x / 1024, then ten times tan(2 x) = 2 tan(x) / (1 - tan(x)^2). Numbers are sums of two
 * doubles (T. J. Dekker, Numerische Mathematik 18, 1971): about 30 digits, 16 of which are left in the end. */
#include "base/geometry/math3.h"

#include <math.h>

enum { DOUBLINGS = 10 };

struct pair {
    double high, low; /* low is at most half a unit in the last place of high */
};

static struct pair pair_of(double high, double low)
{
    double sum = high + low;
    return (struct pair){sum, low - (sum - high)};
}

static struct pair add(struct pair a, struct pair b)
{
    double sum = a.high + b.high;
    double part = sum - a.high;
    double rest = (a.high - (sum - part)) + (b.high - part);
    return pair_of(sum, rest + (a.low + b.low));
}

static struct pair multiply(struct pair a, struct pair b)
{
    double product = a.high * b.high;
    double rest = fma(a.high, b.high, -product);
    return pair_of(product, rest + (a.high * b.low + a.low * b.high));
}

static struct pair divide(struct pair a, struct pair b)
{
    double quotient = a.high / b.high;
    struct pair taken = multiply((struct pair){-quotient, 0}, b);
    return pair_of(quotient, add(a, taken).high / b.high);
}

double tangent(double x)
{
    static const double series[][2] = {{62, 2835}, {17, 315}, {2, 15}, {1, 3}, {1, 1}};
    const struct pair one = {1, 0};
    struct pair small = {ldexp(x, -DOUBLINGS), 0};
    struct pair square = multiply(small, small);
    struct pair sum = {0, 0};
    for (int i = 0; i < 5; i++) {
        struct pair term = divide((struct pair){series[i][0], 0}, (struct pair){series[i][1], 0});
        sum = add(multiply(sum, square), term);
    }
    struct pair t = multiply(small, sum);
    for (int i = 0; i < DOUBLINGS; i++) {
        struct pair negative = multiply((struct pair){-t.high, -t.low}, t);
        t = divide((struct pair){2 * t.high, 2 * t.low}, add(one, negative));
    }
    return t.high + t.low;
}
