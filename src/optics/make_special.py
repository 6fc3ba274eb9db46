#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes special_table.h: piecewise Chebyshev fits, as polynomials, of two functions on t = 1/(1 + x) in [0, 1].

  mills:  (1 + x) sqrt(pi/2) erfcx(x/sqrt(2))      Mills' ratio of the normal distribution, scaled to lie in [1, 1.26]
  dawson: (1 + 2x^2) D(x) / x                      Dawson's integral, scaled to lie in [1, 1.31]

Both are smooth and bounded away from 0, so that a relative error of a few ulp is all that is left. Needs mpmath.
"""
import mpmath as mp

mp.mp.dps = 60
PIECES, DEGREE = 64, 10


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
    if t == 1:
        return mp.mpf(1)
    x = 1 / t - 1
    if x > 30:  # asymptotic: D(x) ~ sum (2k-1)!! / (2^(k+1) x^(2k+1))
        s = term = mp.mpf(1)
        for k in range(1, 400):
            new = term * (2 * k - 1) / (2 * x * x)
            if abs(new) > abs(term):
                break
            term = new
            s += term
        return (1 + 2 * x * x) / x * s / (2 * x)
    with mp.workdps(60 + int(x * x / 2)):
        value = mp.sqrt(mp.pi) / 2 * mp.exp(-x * x) * mp.erfi(x)
        return (1 + 2 * x * x) * value / x


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
        worst = max(worst, abs(mp.polyval(poly[::-1], v) / exact - 1))
    return poly, worst


def main():
    print("/* SPDX-License-Identifier: Apache-2.0 */")
    print("/* Made by make_special.py. Piece i covers t in [i, i + 1] / %d; coefficients of rising powers of v in [-1, 1]. */" % PIECES)
    print("enum { TC_SPECIAL_PIECES = %d, TC_SPECIAL_DEGREE = %d };" % (PIECES, DEGREE))
    for name, function in (("mills", mills), ("dawson", dawson)):
        rows, worst = [], 0
        for i in range(PIECES):
            poly, error = fit(function, mp.mpf(i) / PIECES, mp.mpf(i + 1) / PIECES)
            worst = max(worst, error)
            rows.append("  {" + ", ".join(float(c).hex() for c in poly) + "},")
        print("/* largest relative error of the fit: %s */" % mp.nstr(worst, 3))
        print("static const double tc_%s_table[TC_SPECIAL_PIECES][TC_SPECIAL_DEGREE + 1] = {" % name)
        print("\n".join(rows))
        print("};")


if __name__ == "__main__":
    main()
