"""Jacobi's elliptic functions as torque-free rotation needs them: over a time t, with two squared rates p >= r >= 0.

With u = √p t and modulus k = √(r/p) the three functions are sn(u, k)/√p, cn(u, k) and dn(u, k). Written in t, p and r
nothing is divided by p or r, so that they remain exact where the rates vanish: (t, 1, 1) for p = r = 0.
"""

import math

# 17th power of u and above, left out of the series below, are under 3e-17 of sn(u) for every modulus up to this u².
SERIES_REACH = 0.15**2
ROOT_EPSILON = 1e-8  # an arithmetic-geometric mean doubles its digits at each step


def elliptic(t, p, r):
    """sn(u, k)/√p, cn(u, k), dn(u, k) with u = √p t, k² = r/p: power series at a halved t, then doubled back.

    Sources: Abramowitz and Stegun 16.22.1 for the series of sn, carried on to u¹⁵ and written in p + r and p r; 16.18
    for the double argument, its denominator 1 - k² sn⁴ = cn² + sn² dn² as a sum of positive terms.

    >>> elliptic(0.25, 0.0, 0.0)
    (0.25, 1.0, 1.0)
    >>> s, c, d = elliptic(1.0, 1.0, 1.0)
    >>> abs(s - math.tanh(1.0)) < 1e-15, abs(c - 1 / math.cosh(1.0)) < 1e-15, c == d
    (True, True, True)
    """
    n_halvings = 0
    while p * t * t > SERIES_REACH:
        t *= 0.5
        n_halvings += 1
    s = t * sine_series((p + r) * t * t, p * r * (t * t) * (t * t))
    c, d = math.sqrt(1.0 - p * s * s), math.sqrt(1.0 - r * s * s)
    for _ in range(n_halvings):
        cc, dd, ss = c * c, d * d, s * s
        scale = 1.0 / (cc + p * ss * dd)
        s, c, d = 2.0 * s * c * d * scale, (cc - p * ss * dd) * scale, (dd - r * ss * cc) * scale
    return s, c, d


def sine_series(x, y):
    """sn(u, k)/u to u¹⁴ in x = (1 + k²) u² and y = k² u⁴.

    >>> sine_series(0.01, 0.0) == math.sin(0.1) / 0.1
    True
    """
    x2, y2 = x * x, y * y
    third = x * (x2 + 132.0 * y) / 5040.0
    fourth = (x2 * (x2 + 1224.0 * y) + 3024.0 * y2) / 362880.0
    fifth = x * (x2 * (x2 + 11064.0 * y) + 132624.0 * y2) / 39916800.0
    sixth = (x2 * (x2 * (x2 + 99636.0 * y) + 4095792.0 * y2) + 4390848.0 * y2 * y) / 6227020800.0
    seventh = x * (x2 * (x2 * (x2 + 896796.0 * y) + 111810672.0 * y2) + 490287168.0 * y2 * y) / 1307674368000.0
    return 1.0 + (sixth - seventh + (fourth - fifth) + ((x2 + 12.0 * y) / 120.0 - third) - x / 6.0)


def complete_integrals(complementary, n, cosine, sine):
    """K(k) and ∫₀^{π/2} (cosine cos²θ + sine sin²θ) / (cos²θ + n sin²θ) dθ / √(cos²θ + k'² sin²θ).

    complementary : k', above 0    n : above 0    With cosine and sine >= 0 every term is positive: no cancellation.
    Source: R. Bulirsch, Numerische Mathematik 13:305, 1969 (its function cel).

    >>> complete_integrals(1.0, 4.0, 1.0, 1.0) == (math.pi / 2, math.pi / 4)
    True
    """
    mean, geometric, product, doubled = 1.0, complementary, complementary, 1.0
    root = math.sqrt(n)
    total, other = cosine, sine / root
    while True:
        ratio = product / root
        total, other = total + other / root, 2.0 * (other + total * ratio)
        root += ratio
        before, mean, doubled = mean, mean + geometric, 2.0 * doubled
        if abs(before - geometric) <= ROOT_EPSILON * before:
            break
        geometric = 2.0 * math.sqrt(product)
        product = geometric * mean
    return 0.5 * math.pi * doubled / mean, 0.5 * math.pi * (other + total * mean) / (mean * (mean + root))
