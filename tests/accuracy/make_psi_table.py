#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes psi_table.bin: reference values of the segment integral, computed with 60 digits and rounded to double.

Each record is five little-endian doubles: a, a1, psi, w0 = 1 - psi, w1 = psi - exp(-(a + a1)/2), where
psi = integral of exp(-(a u + (a1 - a) u^2 / 2)) over [0, 1]. Needs mpmath; takes some minutes.

usage: make_psi_table.py psi_table.bin
"""
import math
import random
import struct
import sys

import mpmath as mp

mp.mp.dps = 60


def series(a, b):
    """psi, w0, w1 from the Taylor coefficients of exp(-(a u + b u^2/2)); T up to 8."""
    size = max(a, abs(b), mp.mpf(1))
    with mp.workdps(60 + int(2 * size)):
        before, e = mp.mpf(0), mp.mpf(1)
        psi, w0, w1 = mp.mpf(0), mp.mpf(0), mp.mpf(0)
        scale = (a + abs(b)) or mp.mpf(1)
        n = 0
        while True:
            # integral of u^n is 1/(n+1); w0 = int (1-u)(a+bu) E, w1 = int u (a+bu) E
            psi += e / (n + 1)
            w0 += e * (a * (mp.mpf(1) / (n + 1) - mp.mpf(1) / (n + 2)) + b * (mp.mpf(1) / (n + 2) - mp.mpf(1) / (n + 3)))
            w1 += e * (a / (n + 2) + b / (n + 3))
            before, e = e, -(a * e + b * before) / (n + 1)
            n += 1
            if n > 4 and abs(e) + abs(before) < mp.mpf(10) ** -75:
                return +psi, +w0, +w1


def mills(x, b):
    """Integral of exp(-x u - b u^2/2) over [0, infinity)."""
    if b == 0:
        return 1 / x
    y = x / mp.sqrt(2 * b)
    if y > 1000:
        s = term = mp.mpf(1)
        for k in range(1, 40):
            term *= -(2 * k - 1) * b / (x * x)
            s += term
        return s / x
    with mp.workdps(80):
        return mp.sqrt(mp.pi / (2 * b)) * mp.exp(y * y) * mp.erfc(y)


def dawson(x, beta):
    """sqrt(2/beta) D(x / sqrt(2 beta))."""
    if x == 0:
        return mp.mpf(0)
    y = x / mp.sqrt(2 * beta)
    if y > 15:
        s = term = mp.mpf(1)
        for k in range(1, 400):
            new = term * (2 * k - 1) / (2 * y * y)
            if abs(new) > abs(term) or new < mp.mpf(10) ** -70:
                break
            term = new
            s += term
        return s / x
    with mp.workdps(80 + int(y * y / 2)):
        return mp.sqrt(2 / beta) * mp.sqrt(mp.pi) / 2 * mp.exp(-y * y) * mp.erfi(y)


def reference(a, a1):
    a, a1 = mp.mpf(a), mp.mpf(a1)
    b, t = a1 - a, (a + a1) / 2
    if t < 8:
        return series(a, b)
    e = mp.exp(-t) if t < 1e6 else mp.mpf(0)
    if b >= 0:
        psi = mills(a, b) - (e * mills(a1, b) if e else 0)
    else:
        psi = dawson(a, -b) - (e * dawson(a1, -b) if e else 0)
    return psi, 1 - psi, psi - e


def points():
    rng = random.Random(20)
    log = lambda lo, hi: 10 ** rng.uniform(lo, hi)
    sizes = [0.0] + [10.0**k for k in (-300, -200, -100, -30, -17, -8, -3, -1, 0, 1, 2, 3, 8, 16, 100, 200, 300)]
    for a in sizes:
        for a1 in sizes:
            yield a, a1
    for _ in range(20000):  # the whole range of numbers
        yield log(-300, 300), log(-300, 300)
    for _ in range(45000):  # where all the action is
        yield log(-6, 3.5), log(-6, 3.5)
    for _ in range(15000):  # nearly constant extinction
        a = log(-4, 4)
        yield a, a * (1 + rng.choice((-1, 1)) * log(-16, -1))
    for _ in range(4000):  # one end without extinction
        a = log(-20, 20)
        yield (a, 0.0) if rng.random() < 0.5 else (0.0, a)
    borders = [1e-4, 0.01, 0.1, 0.3, 1.0]  # of T, where the formulas change, give or take some ulp
    for _ in range(16000):
        t = rng.choice(borders)
        x = rng.choice((rng.random() * 2, log(-9, 0), 2 - log(-9, 0)))
        a, a1 = t * x, t * (2 - x)
        for _ in range(rng.randrange(4)):
            a1 = math.nextafter(a1, rng.choice((0, 10))) if hasattr(math, "nextafter") else a1 * (1 + rng.choice((-1, 1)) * 2**-52)
        yield a, a1


def main():
    count = 0
    with open(sys.argv[1], "wb") as out:
        for a, a1 in points():
            psi, w0, w1 = reference(a, a1)
            out.write(struct.pack("<5d", a, a1, float(psi), float(w0), float(w1)))
            count += 1
    print(count, "records")


if __name__ == "__main__":
    main()
