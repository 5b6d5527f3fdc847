"""Torque-free rotation to 50 digits: Taylor series of the quaternion and the angular momentum, in whole numbers."""

from decimal import Decimal, getcontext
from fractions import Fraction
from operator import mul

BITS = 180  # of the fraction: 54 digits, of which the sums below lose a few
REACH = Fraction(1)  # largest |ω| times one step
PI = Decimal("3.14159265358979323846264338327950288419716939937510582097494459230781640629")


def exact_turn(state, reciprocals, duration):
    """(q0, q1, q2, q3, l1, l2, l3) after the duration, each a Fraction; every float that comes in is taken as it is.

    dq/dt = ½ q ω, dL/dt = L × ω, ω = r L: all products of two functions, so each coefficient of the series is a sum of
    products of earlier ones.
    """
    state, rates = [Fraction(x) for x in state], [Fraction(x) for x in reciprocals]
    fastest = max(rates) * (abs(state[4]) + abs(state[5]) + abs(state[6])) * abs(Fraction(duration))
    n_steps = int(fastest / REACH) + 1
    # In units of one step, so that the numbers below stay under one or so; the length of L is put into the rates.
    length = max(abs(x) for x in state[4:]) or Fraction(1)
    rates = [round(x * length * Fraction(duration) / n_steps * 2**BITS) for x in rates]
    values = [round(x * 2**BITS) for x in (*state[:4], *(x / length for x in state[4:]))]
    for _ in range(n_steps):
        values = step(values, rates)
    return [Fraction(x, 2**BITS) * (length if i > 3 else 1) for i, x in enumerate(values)]


def step(values, rates):
    series = [[x] for x in values]  # q0, q1, q2, q3, l1, l2, l3
    omega = [[x * r >> BITS] for x, r in zip(values[4:], rates, strict=True)]
    n = 0
    while n < 4 or max(abs(x[-1]) + abs(x[-2]) for x in series) > 4:
        new = [x // (2 * (n + 1)) for x in quaternion_rate(series[:4], omega)]
        new += [x // (n + 1) for x in momentum_rate(series[4:], omega)]
        for x, coefficient in zip(series, new, strict=True):
            x.append(coefficient)
        for x, coefficient, r in zip(omega, new[4:], rates, strict=True):
            x.append(coefficient * r >> BITS)
        n += 1
    return [sum(x) for x in series]


def quaternion_rate(q, w):
    """The last coefficient of q ω."""
    q0, q1, q2, q3 = q
    w1, w2, w3 = w
    return (
        -product(q1, w1) - product(q2, w2) - product(q3, w3),
        product(q0, w1) + product(q2, w3) - product(q3, w2),
        product(q0, w2) - product(q1, w3) + product(q3, w1),
        product(q0, w3) + product(q1, w2) - product(q2, w1),
    )


def momentum_rate(momentum, w):
    """The last coefficient of L × ω."""
    l1, l2, l3 = momentum
    w1, w2, w3 = w
    return (
        product(l2, w3) - product(l3, w2),
        product(l3, w1) - product(l1, w3),
        product(l1, w2) - product(l2, w1),
    )


def product(x, y):
    return sum(map(mul, x, reversed(y))) >> BITS


def exact_long_turn(state, reciprocals, duration):
    """As `exact_turn`, for any number of periods: the turn over one period of L, multiplied with itself."""
    period = period_of(state[4:], reciprocals)
    n = int(Fraction(duration) / period)
    once = exact_turn((1.0, 0.0, 0.0, 0.0, *state[4:]), reciprocals, period)
    rest = exact_turn((1.0, 0.0, 0.0, 0.0, *state[4:]), reciprocals, Fraction(duration) - n * period)
    attitude = multiply(multiply([Fraction(x) for x in state[:4]], power(once[:4], n)), rest[:4])
    return [*attitude, *rest[4:]]


def period_of(momentum, reciprocals):
    """2 π / agm(√p, √(p - r)), the time after which L is in the body what it was.

    With r1 <= r2 <= r3, E = Σ r l² and G² = Σ l²: p = (r2 - r1)(r3 G² - E) and r = (r3 - r2)(E - r1 G²), or the other
    way round if that is larger (Landau and Lifshitz, Mechanics, eqs. 37.8 to 37.12, in reciprocals).
    """
    getcontext().prec = 70
    l, x = [Fraction(v) for v in momentum], [Fraction(v) for v in reciprocals]
    energy, square = sum(a * b * b for a, b in zip(x, l, strict=True)), sum(b * b for b in l)
    low, middle, high = sorted(x)
    p, r = (middle - low) * (high * square - energy), (high - middle) * (energy - low * square)
    mean, other = decimal(max(p, r)).sqrt(), decimal(abs(p - r)).sqrt()
    while abs(mean - other) > mean * Decimal(10) ** -65:
        mean, other = (mean + other) / 2, (mean * other).sqrt()
    return Fraction(2 * PI / mean)


def power(q, n):
    result = [Fraction(1), Fraction(0), Fraction(0), Fraction(0)]
    while n:
        if n % 2:
            result = multiply(result, q)
        q, n = multiply(q, q), n // 2
    return result


def multiply(a, b):
    """Hamilton's product, rounded to BITS."""
    a0, a1, a2, a3 = a
    b0, b1, b2, b3 = b
    exact = (
        a0 * b0 - a1 * b1 - a2 * b2 - a3 * b3,
        a0 * b1 + a1 * b0 + a2 * b3 - a3 * b2,
        a0 * b2 - a1 * b3 + a2 * b0 + a3 * b1,
        a0 * b3 + a1 * b2 - a2 * b1 + a3 * b0,
    )
    return [Fraction(round(x * 2**BITS), 2**BITS) for x in exact]


def decimal(fraction):
    return Decimal(fraction.numerator) / Decimal(fraction.denominator)
