#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes segment_fit.h: polynomials for segments that are not deep (segment_lanes.h), by least squares at Chebyshev nodes.

With T the optical depth of a segment, d half the difference of the extinctions at its ends times its length, |d| <= T, and h = T/2:

  g(h)   = exp(-h) - 1, as h times a polynomial, which is -1 at 0
  K(x,d) = exp(h) (w1 - w0), x = T^2: the difference of the two ends' weights
  Q(x,d) = exp(h) (m0 - m1) / T, of the two moments

as polynomials in x and d. From these alpha = -g (2 + g), w1 - w0 = (1 + g) K, and the moments (segment_lanes.h) follow. Errors of K are relative to
T, as both weights are at least T/3 nearly; that of T Q is absolute, as both moments are about 1/2. Terms that the error allows to leave out are
left out. Needs mpmath; takes a minute.
"""
import mpmath as mp

mp.mp.dps = 40


def integrals(t, d):
    """exp(d/4) times the integrals 1/2 int v^2 cosh(t v/2) E and 1/2 int v sinh(t v/2)/t E over [-1, 1], E = exp(-d v^2/4), by their series."""
    x, y = t * t / 4, -d / 4
    a = b = mp.mpf(0)
    for i in range(18):
        for j in range(26):
            term = x**i * y**j / mp.factorial(j)
            a += term / (mp.factorial(2 * i) * (2 * i + 2 * j + 3))
            b += term / (2 * mp.factorial(2 * i + 1) * (2 * i + 2 * j + 3))
    e = mp.exp(d / 4)
    return e * a, e * b


def K(t, d):
    a, b = integrals(t, d)
    return d * a - t * t * b


def Q(t, d):
    return integrals(t, d)[1]


def node(k, n):
    return mp.cos(mp.pi * (k + mp.mpf(1) / 2) / n)


def least_squares(rows, values):
    matrix = mp.matrix(rows)
    return mp.lu_solve(matrix.T * matrix, matrix.T * mp.matrix(values))


def fit(function, weight, most, degree, target):
    """Coefficients {(i, j): c} of x^i d^j for T <= most, whose error is at most target * T^weight; and that error."""
    samples = [(t, q * t, function(t, q * t)) for t in (most * (1 + node(k, 14)) / 2 for k in range(14))
               for q in (node(k, 15) for k in range(15))]
    checks = [(t, q * t, function(t, q * t)) for t in (most * mp.mpf(k) / 12 for k in range(1, 13))
              for q in (mp.mpf(k) / 6 - 1 for k in range(13))]

    def size(term):
        return most ** (2 * term[0] + term[1] - weight)

    def solve(terms):
        rows = [[t ** (2 * i - weight) * d**j / size((i, j)) for i, j in terms] for t, d, _ in samples]
        found = least_squares(rows, [f / t**weight for t, _, f in samples])
        c = {term: mp.mpf(float(found[n] / size(term))) for n, term in enumerate(terms)}  # as it will be stored
        return c, max(abs(sum(v * t ** (2 * i) * d**j for (i, j), v in c.items()) - f) / t**weight for t, d, f in checks)

    terms = [(i, j) for j in range(degree + 2) for i in range(9) if 2 * i + j <= degree + 1 and (weight < 1 or (i, j) != (0, 0))]
    best, error = solve(terms)
    assert error <= target, (most, degree, error)
    while True:
        small = min(best, key=lambda term: abs(best[term]) * size(term) / 2 ** term[1])
        fewer, more_error = solve([term for term in terms if term != small])
        if more_error > target:
            return best, error
        terms, best, error = [term for term in terms if term != small], fewer, more_error


def fit_g(most, count):
    hs = [most * (1 + node(k, 24)) / 2 for k in range(24)]
    found = least_squares([[(h / most) ** k for k in range(1, count)] for h in hs], [mp.expm1(-h) / h + 1 for h in hs])
    c = [mp.mpf(-1)] + [mp.mpf(float(found[k - 1] / most**k)) for k in range(1, count)]
    return c, max(abs(sum(c[k] * h**k for k in range(count)) * h / mp.expm1(-h) - 1) for h in (most * mp.mpf(k) / 50 for k in range(1, 51)))


def write(function, weight, most, degree, target, name):
    c, error = fit(function, weight, mp.mpf(most), degree, mp.mpf(target))
    unit = {1: ' T', 0: '', -1: ' / T'}[weight]
    print('\n/* T <= %s: off by at most %.1e%s. */\n#define TC_FIT_%s_%s(ROW) \\' % (most, float(error), unit, function.__name__, name))
    last = max(j for _, j in c)
    for j in range(last, -1, -1):
        row = [c.get((i, j), mp.mpf(0)) for i in range(1 + max([i for i, k in c if k == j], default=0))]
        print('  ROW(%s)%s' % (', '.join(float(v).hex() for v in row), ' \\' if j else ''))


def write_g(most, count, name):
    c, error = fit_g(mp.mpf(most) / 2, count)
    print('\n/* T <= %s: off by at most %.1e g. */\n#define TC_FIT_G_%s %s' % (most, float(error), name, ', '.join(float(v).hex() for v in c)))


print('/* SPDX-License-Identifier: Apache-2.0 */')
print('/* clang-format off */')
print('/* Made by make_fit.py: coefficients of g, of rising powers of h; for each power of d, from the highest on, those of the powers of x. */')
print('#ifndef TC_OPTICS_SEGMENT_FIT_H\n#define TC_OPTICS_SEGMENT_FIT_H')
write_g(0.5, 5, 'SINGLE')
write(K, 1, 0.5, 5, '3e-8', 'SINGLE')
for most, g_count, k_degree, q_degree, name in ((0.0625, 6, 6, 5, '16TH'), (0.25, 8, 8, 7, '4TH'), (0.5, 9, 10, None, 'HALF'), (1, 11, None, 11, 'ONE')):
    write_g(most, g_count, name)
    if k_degree:
        write(K, 1, most, k_degree, '1e-15', name)
    if q_degree:
        write(Q, -1, most, q_degree, '3e-16', name)
print('\n#endif')
