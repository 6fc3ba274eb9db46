#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes special_table.h: piecewise Chebyshev fits, as polynomials, of functions on [0, 1].

  mills:  (1 + x) sqrt(pi/2) erfcx(x/sqrt(2)), x = 1/t - 1        Mills' ratio M of the normal distribution, scaled to lie in [1, 1.26]
  dawson: 2 (2 + y) D(y), y = 2 (1/t - 1)                         Dawson's integral, scaled to lie in [0, 3.27]
  mills moment:  (1 + x)^2 (1 - x M(x))                           -M', scaled to lie in [1, 1.6]
  dawson moment: 2 (2 + y)^2 (2 y D(y) - 1)                       -D', scaled to lie in [-8, 2]

The scales are such that nothing is left to be done but a division (segment.c). Needs mpmath.
"""
import mpmath as mp

mp.mp.dps = 60
DEGREE = 7


def mills(t):
    if t < mp.mpf(1) / 200:  # asymptotic: M(x) ~ sum (-1)^k (2k-1)!! / x^(2k+1)
        if t == 0:
            return mp.mpf(1)
        x = 1 / t - 1
        s = term = mp.mpf(1)
        for k in range(1, 60):
            term *= -(2 * k - 1) / (x * x)
            s += term
            if abs(term) < mp.mpf(10) ** -55:
                break
        return (1 + x) / x * s
    x = 1 / t - 1
    return (1 + x) * mp.sqrt(mp.pi / 2) * mp.exp(x * x / 2) * mp.erfc(x / mp.sqrt(2))


def dawson(t):
    if t == 0:
        return mp.mpf(1)
    y = 2 * (1 / t - 1)
    if y > 30:  # asymptotic: D(y) ~ sum (2k-1)!! / (2^(k+1) y^(2k+1))
        s = term = mp.mpf(1)
        for k in range(1, 400):
            new = term * (2 * k - 1) / (2 * y * y)
            if abs(new) > abs(term):
                break
            term = new
            s += term
        return (2 + y) / y * s
    with mp.workdps(60 + int(y * y / 2)):
        return (2 + y) * mp.sqrt(mp.pi) * mp.exp(-y * y) * mp.erfi(y)


def mills_moment(t):
    if t == 0:
        return mp.mpf(1)
    x = 1 / t - 1
    if t < mp.mpf(1) / 200:
        s = term = 1 / (x * x)
        for k in range(2, 60):
            term *= -(2 * k - 1) / (x * x)
            s += term
            if abs(term) < mp.mpf(10) ** -58:
                break
        return (1 + x) ** 2 * s
    return (1 + x) ** 2 * (1 - x * mills(t) / (1 + x))


def dawson_moment(t):
    if t == 0:
        return mp.mpf(1)
    y = 2 * (1 / t - 1)
    if y > 30:  # 2 y D(y) - 1 ~ sum (2k-1)!! / (2 y^2)^k
        s = term = 1 / (2 * y * y)
        for k in range(2, 400):
            new = term * (2 * k - 1) / (2 * y * y)
            if abs(new) > abs(term):
                break
            term = new
            s += term
        return 2 * (2 + y) ** 2 * s
    return 2 * (2 + y) ** 2 * (y * dawson(t) / (2 + y) - 1)


def fit(function, lower, upper):
    """Monomial coefficients in v = 2 (t - lower) / (upper - lower) - 1 of the Chebyshev interpolant."""
    n = DEGREE + 1
    nodes = [mp.cos(mp.pi * (k + mp.mpf(1) / 2) / n) for k in range(n)]
    values = [function((lower + upper) / 2 + (upper - lower) / 2 * x) for x in nodes]
    chebyshev = []
    for j in range(n):
        c = 2 * mp.fsum(values[k] * mp.cos(mp.pi * j * (k + mp.mpf(1) / 2) / n) for k in range(n)) / n
        chebyshev.append(c / 2 if j == 0 else c)
    t0, t1 = [mp.mpf(1)], [mp.mpf(0), mp.mpf(1)]
    poly = [mp.mpf(0)] * n
    for j in range(n):
        for i, c in enumerate(t0):
            poly[i] += chebyshev[j] * c
        t2 = [mp.mpf(0)] + [2 * c for c in t1]
        for i, c in enumerate(t0):
            t2[i] -= c
        t0, t1 = t1, t2
    worst = 0
    for k in range(101):
        v = mp.mpf(k) / 50 - 1
        exact = function((lower + upper) / 2 + (upper - lower) / 2 * v)
        worst = max(worst, abs(mp.polyval(poly[::-1], v) - exact))
    return poly, worst


def main():
    functions = (("mills", mills, 64), ("dawson", dawson, 192), ("mills moment", mills_moment, 64),
                 ("dawson moment", dawson_moment, 192))
    print("/* SPDX-License-Identifier: Apache-2.0 */")
    print("/* clang-format off */")
    print("/* Made by make_special.py, and included where a table is defined. Row i of a function's n covers t in [i, i + 1] / n; coefficients of\n"
          " * rising powers of v in [-1, 1]. */")
    for name, function, pieces in functions:
        rows, worst = [], 0
        for i in range(pieces):
            poly, error = fit(function, mp.mpf(i) / pieces, mp.mpf(i + 1) / pieces)
            worst = max(worst, error)
            rows.append("  {" + ", ".join(float(c).hex() for c in poly) + "},")
        print("  /* %s: largest error of the fit: %s */" % (name, mp.nstr(worst, 3)))
        print("\n".join(rows))


if __name__ == "__main__":
    main()
