"""Jacobi's elliptic functions as torque-free rotation needs them: over a time t, with two squared rates p >= r >= 0.

With u = √p t and modulus k = √(r/p) the three functions are sn(u, k)/√p, cn(u, k) and dn(u, k). Written in t, p and r
nothing is divided by p or r, so that they remain exact where the rates vanish: (t, 1, 1) for p = r = 0.
"""

import math

# Up to this u² what the series below leaves out, u¹⁷ and above, is under 3e-17 of sn(u), whatever the modulus.
SERIES_REACH = 0.15**2
ROOT_EPSILON = 1e-8  # an arithmetic-geometric mean doubles its digits at each step


def elliptic(t, p, r):
    """sn(u, k)/√p, cn(u, k), dn(u, k) with u = √p t and k² = r/p, for |u| < K(k): not beyond a quarter period.

    A power series of sn at t halved often enough, then sn of the double argument as often (Abramowitz and Stegun
    16.18), where √((1 - x)(1 - y))/(1 - xy) - 1 = (3xy - x²y² - x - y)/(...): what is carried along is how much of
    sn(u)/u = 1 + part is missing to 1, a small number whose rounding does not show. cn and dn come from sn at the end.

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
    part = sine_series((p + r) * t * t, p * r * (t * t) * (t * t))
    s = t + t * part
    for _ in range(n_halvings):
        x, y = p * s * s, r * s * s
        xy = x * y
        gain = (xy * (3.0 - xy) - (x + y)) / ((1.0 - xy) * (1.0 - xy + math.sqrt((1.0 - x) * (1.0 - y))))
        part += gain + gain * part
        t *= 2.0
        s = t + t * part
    return s, math.sqrt(1.0 - p * s * s), math.sqrt(1.0 - r * s * s)


def sine_series(x, y):
    """sn(u, k)/u - 1 to u¹⁴, from x = (1 + k²) u² and y = k² u⁴.

    Source: Abramowitz and Stegun 16.22.1, carried on to u¹⁵ by the recurrence of sn'' = -(1 + k²) sn + 2 k² sn³.

    >>> abs(0.1 + 0.1 * sine_series(0.01, 0.0) - math.sin(0.1)) < 2e-17
    True
    """
    x2, y2 = x * x, y * y
    third = x * (x2 + 132.0 * y) / 5040.0
    fourth = (x2 * (x2 + 1224.0 * y) + 3024.0 * y2) / 362880.0
    fifth = x * (x2 * (x2 + 11064.0 * y) + 132624.0 * y2) / 39916800.0
    sixth = (x2 * (x2 * (x2 + 99636.0 * y) + 4095792.0 * y2) + 4390848.0 * y2 * y) / 6227020800.0
    seventh = x * (x2 * (x2 * (x2 + 896796.0 * y) + 111810672.0 * y2) + 490287168.0 * y2 * y) / 1307674368000.0
    return sixth - seventh + (fourth - fifth) + ((x2 + 12.0 * y) / 120.0 - third) - x / 6.0


def complete_integrals(a, b, n, cosine, sine):
    """∫₀^{π/2} dθ/Δ and ∫₀^{π/2} (cosine cos²θ + sine sin²θ)/(cos²θ + n sin²θ) dθ/Δ with Δ² = a² cos²θ + b² sin²θ.

    a >= b > 0, n > 0. The first is K(k)/a with k² = 1 - b²/a². With cosine and sine >= 0 every term is positive.
    Source: R. Bulirsch, Numerische Mathematik 13:305, 1969 (its function cel, here not scaled to a = 1).

    >>> complete_integrals(1.0, 1.0, 4.0, 1.0, 1.0) == (math.pi / 2, math.pi / 4)
    True
    """
    root = a * math.sqrt(n)
    total, other = cosine, sine / math.sqrt(n) * a
    product, doubled = a * b, 1.0
    while True:
        ratio = product / root
        total, other = total + other / root, 2.0 * (other + total * ratio)
        root += ratio
        before, a, doubled = a, a + b, 2.0 * doubled
        if not before - b > ROOT_EPSILON * before:  # so said, it ends for a number that is none as well
            return 0.5 * math.pi * doubled / a, 0.5 * math.pi * (other + total * a) / (a * (a + root))
        b = 2.0 * math.sqrt(product)
        product = b * a
