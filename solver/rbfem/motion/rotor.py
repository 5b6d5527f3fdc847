"""The free rotor: a rigid body that no torque acts on, moved by any duration in one call.

Body axes are principal axes. In them L' = L × ω, with ω = I⁻¹ L, and in the world L stands still. The exact rotor moves
L by the addition theorems of Jacobi's functions, from where it is: no phase is ever solved for, and what the theorems
need is free of quotients that vanish with a symmetry of the body or of its motion. The attitude follows from L but for
one angle about it, which is an integral over the time.

Sources: R. van Zon, J. Schofield, Journal of Computational Physics 225:145, 2007, and E. Celledoni, F. Fassò,
N. Säfström, A. Zanna, SIAM Journal on Scientific Computing 30:2084, 2008, for the reduction to Jacobi's functions and
an angle; the form of the theorems and of the angle's integrand is derived here, in the functions below.
"""

import math

from rbfem.motion.jacobi import complete_integrals, elliptic
from rbfem.motion.rotation import multiply

# The nodes and weights of Gauss and Legendre with eight points, upper half: Abramowitz and Stegun, table 25.4.
NODE_1, WEIGHT_1 = 0.18343464249564980494, 0.36268378337836198297
NODE_2, WEIGHT_2 = 0.52553240991632898582, 0.31370664587788728734
NODE_3, WEIGHT_3 = 0.79666647741362673959, 0.22238103445337447054
NODE_4, WEIGHT_4 = 0.96028985649753623168, 0.10122853629037625915

PANEL = 0.75  # in u: eight nodes then miss the integral by less than 3e-16 rad in a turn, at any modulus
FAR = 4.0 * PANEL  # in u: up to here the panels cost as much as half periods that are skipped, and they round less
SETTLED = 750.0  # in u: exp(-750) is below every float, so that a motion on the separatrix has come to its end
NEAR_POLE = 1e-3  # of a²: far above what the sum of two floats in `square_in_parts` resolves, 1e-22
FARTHEST = 1e15  # rad: a phase of so many radians is not known to a tenth of one


def turn_freely(q0, q1, q2, q3, l1, l2, l3, r1, r2, r3, duration):
    """The attitude and angular momentum after `duration` without torque: exact to rounding, however long.

    dq/dt = ½ q ω,  dL/dt = L × ω,  ω = (r1 l1, r2 l2, r3 l3)

    q* : unit quaternion, principal axes -> world    l* : kg m^2/s, angular momentum in principal axes
    r* : 1/(kg m^2), reciprocals of the principal moments, > 0, in any order    duration : s, of either sign
    returns : q0, q1, q2, q3, l1, l2, l3; the quaternion is nan beyond `FARTHEST`, where no digit of it would be right
    Not checked: the length of the quaternion, the sign of the moments.

    >>> there = turn_freely(1.0, 0.0, 0.0, 0.0, 0.3, 2.0, 0.1, 1.0, 0.5, 0.25, 2.0)
    >>> [round(x, 3) for x in there]
    [0.5, 0.261, 0.822, -0.077, 0.508, 1.87, -0.589]
    >>> [round(x, 13) + 0.0 for x in turn_freely(*there, 1.0, 0.5, 0.25, -2.0)]
    [1.0, 0.0, 0.0, 0.0, 0.3, 2.0, 0.1]
    """
    length = math.sqrt(l1 * l1 + l2 * l2 + l3 * l3)
    angle = length * max(r1, r2, r3) * abs(duration)
    if angle == 0.0:
        return q0, q1, q2, q3, l1, l2, l3
    if not angle < FARTHEST:
        return math.nan, math.nan, math.nan, math.nan, l1, l2, l3
    # The middle moment goes last, the axes turned in a ring: that keeps the frame right-handed.
    ring = places_to_middle(r1, r2, r3)
    a, b, c = in_ring(ring, l1, l2, l3)
    ra, rb, rc = in_ring(ring, r1, r2, r3)
    t0, ta, tb, tc, a, b, c = turn_between_extremes(a, b, c, ra, rb, rc, length, duration)
    t1, t2, t3 = in_ring(-ring, ta, tb, tc)
    m1, m2, m3 = in_ring(-ring, a, b, c)
    q0, q1, q2, q3 = multiply(q0, q1, q2, q3, t0, t1, t2, t3)
    q0, q1, q2, q3 = with_length_one(q0, q1, q2, q3)
    return q0, q1, q2, q3, m1, m2, m3


def turn_by_splitting(q0, q1, q2, q3, l1, l2, l3, r1, r2, r3, duration):
    """The attitude and angular momentum after `duration` without torque, to second order: five plain rotations.

    The energy r1 l1²/2 + r2 l2²/2 + r3 l3²/2 is split into its terms; each turns the body about one of its axes, in
    the order 1, 2, 3, 2, 1, the outer ones by half. |L| is kept, the energy on average, and a step back is the inverse.
    Arguments and what is returned: as of `turn_freely`.
    Source: A. Dullweber, B. Leimkuhler, R. McLachlan, Journal of Chemical Physics 107:5840, 1997.

    >>> [round(x, 15) for x in turn_by_splitting(1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 3.0, 1.0, 1.0, 1.0, math.pi / 3)]
    [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 3.0]
    """
    if not math.sqrt(l1 * l1 + l2 * l2 + l3 * l3) * max(r1, r2, r3) * abs(duration) < FARTHEST:
        return math.nan, math.nan, math.nan, math.nan, l1, l2, l3
    half = 0.5 * duration
    q0, q2, q3, q1, l2, l3, l1 = turn_about_last(q0, q2, q3, q1, l2, l3, l1, half * r1)
    q0, q3, q1, q2, l3, l1, l2 = turn_about_last(q0, q3, q1, q2, l3, l1, l2, half * r2)
    q0, q1, q2, q3, l1, l2, l3 = turn_about_last(q0, q1, q2, q3, l1, l2, l3, duration * r3)
    q0, q3, q1, q2, l3, l1, l2 = turn_about_last(q0, q3, q1, q2, l3, l1, l2, half * r2)
    q0, q2, q3, q1, l2, l3, l1 = turn_about_last(q0, q2, q3, q1, l2, l3, l1, half * r1)
    q0, q1, q2, q3 = with_length_one(q0, q1, q2, q3)
    return q0, q1, q2, q3, l1, l2, l3


def turn_about_last(q0, qa, qb, qc, a, b, c, rate):
    """Turn the body about its last axis by the angle rate c: L' = L × (0, 0, rate c); the axes are right-handed.

    >>> turn_about_last(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0)
    (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0)
    """
    cosine, sine = math.cos(0.5 * rate * c), math.sin(0.5 * rate * c)
    q0, qa, qb, qc = q0 * cosine - qc * sine, qa * cosine + qb * sine, qb * cosine - qa * sine, qc * cosine + q0 * sine
    once, twice = cosine * cosine - sine * sine, 2.0 * sine * cosine
    return q0, qa, qb, qc, once * a + twice * b, once * b - twice * a, c


def with_length_one(q0, q1, q2, q3):
    """A quaternion of length 1 but for rounding, with less of it: to first order 1/√s is 1.5 - 0.5 s about s = 1.

    x + (0.5 - 0.5 s) x rounds to either side alike, as (1.5 - 0.5 s) x would not.

    >>> with_length_one(1.0000000001, 0.0, 0.0, 0.0)
    (1.0, 0.0, 0.0, 0.0)
    """
    scale = 0.5 - 0.5 * (q0 * q0 + q1 * q1 + q2 * q2 + q3 * q3)
    return q0 + scale * q0, q1 + scale * q1, q2 + scale * q2, q3 + scale * q3


def square_in_parts(x, y, z, length):
    """x² + y² + z² as a sum of two floats, where the squares are about length² or less: exact to 1e-22 of that.

    Each number is cut to a multiple of one power of two, so coarse that the squares of the cut ones and the sum of
    these have at most 53 digits: nothing is rounded there, fused or not.

    >>> square_in_parts(1.0, 2.0**-40, 0.0, 1.0) == (1.0, 2.0**-80)
    True
    """
    big = length * 2.0**28
    hx, hy, hz = (x + big) - big, (y + big) - big, (z + big) - big
    return hx * hx + hy * hy + hz * hz, (x - hx) * (x + hx) + (y - hy) * (y + hy) + (z - hz) * (z + hz)


def places_to_middle(r1, r2, r3):
    """How far the axes are to be moved in a ring, see `in_ring`, for the middle moment to be the last.

    >>> places_to_middle(2.0, 1.0, 3.0), places_to_middle(1.0, 2.0, 3.0), places_to_middle(1.0, 3.0, 2.0)
    (1, -1, 0)
    """
    if (r1 - r2) * (r3 - r1) >= 0.0:
        return 1
    if (r2 - r1) * (r3 - r2) >= 0.0:
        return -1
    return 0


def in_ring(places, x, y, z):
    """(x, y, z) moved by so many places in a ring: 1, 0 or -1.

    >>> in_ring(1, 1.0, 2.0, 3.0), in_ring(-1, 1.0, 2.0, 3.0)
    ((2.0, 3.0, 1.0), (3.0, 1.0, 2.0))
    """
    if places > 0:
        return y, z, x
    if places < 0:
        return z, x, y
    return x, y, z


def turn_between_extremes(a, b, c, ra, rb, rc, length, duration):
    """The turn of the body and its new momentum, where rc is the middle one of three reciprocal moments.

    a, b, c : L in the body    length : |L|
    returns : the quaternion of the turn, new body axes -> old ones, and the new a, b, c

    The larger of the squared rates p and r tells the pole, the axis whose component of L keeps its sign. Turns of the
    frame about its last axis, by a quarter and by a half, make the pole the first axis and its component positive.
    """
    p, r = squared_rates(a, b, c, rc - rb, ra - rc, rb - ra)
    is_quarter = r > p
    if is_quarter:
        a, b, ra, rb = b, -a, rb, ra
    side = 1.0 if a >= 0.0 else -1.0
    t0, ta, tb, tc, a, b, c = turn_about_pole(side * a, side * b, c, ra, rb, rc, length, duration)
    a, b, ta, tb = side * a, side * b, side * ta, side * tb
    if is_quarter:
        a, b, ta, tb = -b, a, -tb, ta
    return t0, ta, tb, tc, a, b, c


def squared_rates(a, b, c, alpha, beta, gamma):
    """p = αβ c² - βγ a² and r = αβ c² - αγ b², which do not change in time.

    a' = α b c,  b' = β c a,  c' = γ a b,  α + β + γ = 0;  α and β have one sign and γ the other, so that no term of p
    and r is negative. √p is the rate of u, the argument of Jacobi's functions, and √(r/p) their modulus, if p >= r.

    >>> squared_rates(1.0, 0.0, 0.0, -1.0, -2.0, 3.0), squared_rates(0.0, 0.0, 1.0, -1.0, -2.0, 3.0)
    ((6.0, 0.0), (2.0, 2.0))
    """
    return beta * (alpha * c * c - gamma * a * a), alpha * (beta * c * c - gamma * b * b)


def turn_about_pole(a, b, c, ra, rb, rc, length, duration):
    """The turn of the body and its new momentum, where a >= 0 and p >= r.

    P, which takes L to the first axis by the shortest way, is a frame that turns about L by the angle ψ of `advance`;
    the turn is P̄ (cos ψ/2, sin ψ/2, 0, 0) P₁ with P ~ (|L| + a, 0, c, -b) of the old momentum and P₁ of the new one.
    Most of ψ is |L| ra t or |L| rc t, whichever leaves less of it, which is known to more digits than a float has; only
    the rest is an integral with the rounding of a float.
    """
    alpha, beta, gamma = rc - rb, ra - rc, rb - ra
    p, r = squared_rates(a, b, c, alpha, beta, gamma)
    reference, drive, slope = ra, gamma * b * b - beta * c * c, 0.0
    if 2.0 * abs(drive) > abs(beta) * length * (length + a):
        reference, drive, slope = rc, beta * a * a - alpha * b * b, beta * length
    side, skipped, rest = 1.0, 0.0, duration
    if p * duration * duration > FAR * FAR:
        side, skipped, rest = skip_half_periods(a, b, c, alpha, beta, gamma, p, length, drive, slope, duration)
    more, a1, b1, c1, ea, eb, ec = advance(a, side * b, side * c, alpha, beta, gamma, p, r, length, drive, slope, rest)
    high, low = angle_in_parts(a, b, c, length, reference, duration)
    cosine, sine = half_angle(high, low + (skipped + more))
    a1, b1, c1 = with_invariants(a1, b1, c1, ea, eb, ec, a, b, c, alpha, beta, gamma, length)
    w, w1 = length + a, length + a1
    t0, ta, tb, tc = multiply(w, 0.0, -c, b, cosine * w1, sine * w1, cosine * c1 + sine * b1, sine * c1 - cosine * b1)
    scale = 0.5 / (length * math.sqrt(w * w1))
    return t0 * scale, ta * scale, tb * scale, tc * scale, a1, b1, c1


def with_invariants(a, b, c, ea, eb, ec, a0, b0, c0, alpha, beta, gamma, length):
    """(a, b, c) + (ea, eb, ec) with the length and the energy of (a0, b0, c0), from which it differs by rounding only.

    Without this a symmetric body gains or loses |L| at one and the same share of a rounding in every step. The energy
    is set along L × L', its gradient on the sphere |L|, in the form β a² - α b², which rounds least, or near the pole
    γ b² - β c², which vanishes there; both are constant together with |L|.
    """
    high, low = square_in_parts(a0, b0, c0, length)
    high_now, low_now = square_in_parts(a, b, c, length)
    stretch = (0.5 * (high - high_now + (low - low_now)) - (a * ea + b * eb + c * ec)) / (length * length)
    by_a = (a0 - a) * (a0 + a) - 2.0 * a * (ea + stretch * a)
    by_b = (b0 - b) * (b0 + b) - 2.0 * b * (eb + stretch * b)
    by_c = (c0 - c) * (c0 + c) - 2.0 * c * (ec + stretch * c)
    miss = gamma * by_b - beta * by_c if b * b + c * c < NEAR_POLE * a * a else beta * by_a - alpha * by_b
    da, db, dc = alpha * b * c, beta * c * a, gamma * a * b
    across = da * da + db * db + dc * dc
    step = -0.5 * miss / across if across > 0.0 else 0.0
    return (
        a + (ea + stretch * a + step * (b * dc - c * db)),
        b + (eb + stretch * b + step * (c * da - a * dc)),
        c + (ec + stretch * c + step * (a * db - b * da)),
    )


def angle_in_parts(a, b, c, length, rate, duration):
    """|L| rate duration as a sum of two floats: to 1e-22 of it, |L| anew from a, b, c beyond the digits of `length`.

    >>> angle_in_parts(3.0, 4.0, 0.0, 5.0, 0.5, 2.0)
    (5.0, 0.0)
    """
    high, low = square_in_parts(a, b, c, length)
    cut = upper_half(length)
    rest = length - cut
    missing = 0.5 * (((high - cut * cut) - 2.0 * cut * rest) + (low - rest * rest)) / length
    high, low = product_in_parts(length, missing, rate)
    product = high + low
    return product_in_parts(product, (high - product) + low, duration)


def product_in_parts(x, more, y):
    """(x + more) y as a sum of two floats, where `more` is small beside x: exact to 1e-31 but for the part of `more`.

    The first is a product of numbers of 26 digits, so that nothing is rounded there, fused or not.

    >>> product_in_parts(1.0 + 2.0**-50, 0.0, 1.0 - 2.0**-50)
    (1.0, -7.888609052210118e-31)
    """
    high, high_y = upper_half(x), upper_half(y)
    return high * high_y, high * (y - high_y) + ((x - high) + more) * y


def upper_half(x):
    """x cut to the upper 26 of its 53 digits.

    >>> upper_half(1.0 + 2.0**-20 + 2.0**-40) == 1.0 + 2.0**-20
    True
    """
    big = 2.0**27 * x
    return (x + big) - big


def half_angle(high, low):
    """cos and sin of half of high + low, where their sum is known to more digits than a float has.

    >>> half_angle(math.pi, 0.0)
    (6.123233995736766e-17, 1.0)
    """
    half, rest = 0.5 * (high + low), 0.5 * rounded_off(high, low)
    cosine, sine = math.cos(half), math.sin(half)
    return cosine - rest * sine, sine + rest * cosine


def skip_half_periods(a, b, c, alpha, beta, gamma, p, length, drive, slope, duration):
    """Whole half periods of L at once: the sign that b and c take, ψ over them, and how much of the duration is left.

    Over half a period T = 2 K/√p the integral of (D + e a)/(|L| + a), see `advance`, is brought here, by the exchange
    of n and k²/n in Legendre's third kind (Byrd and Friedman, Handbook of Elliptic Integrals, 117.02), to a form of
    terms of one sign: 2/√p ∫₀^K f du with f = (e cn² + |L| D/share sn²)/(cn² + L²/share sn²), share = a² - (α/γ) c².
    """
    difference = gamma * (alpha * b * b - beta * a * a)
    if difference <= 0.0:
        return on_the_separatrix(a, math.sqrt(p), duration)
    share = a * a - alpha / gamma * c * c
    quarter, integral = complete_integrals(
        math.sqrt(p), math.sqrt(difference), length * length / share, slope, length * drive / share
    )
    half_period = 2.0 * quarter
    n = math.floor(duration / half_period + 0.5)
    side = 1.0 if n % 2 == 0 else -1.0
    return side, n * (2.0 * integral), duration - n * half_period


def on_the_separatrix(a, rate, duration):
    """As `skip_half_periods`, for a motion that takes forever: all but a finite time it turns about the middle axis.

    There ψ grows by |L| rc t, and that is the part of it which `turn_about_pole` knows without an integral.
    """
    reach = SETTLED / rate if a > 0.0 else 0.0
    return 1.0, 0.0, max(-reach, min(reach, duration))


def advance(a, b, c, alpha, beta, gamma, p, r, length, drive, slope, duration):
    """The rest of ψ and the new a, b, c with their roundings, in as many panels as are needed for eight nodes each.

    dψ/dt = |L| ra + D/(|L| + a) with D = γ b² - β c², or |L| rc + (D + e a)/(|L| + a) with D = β a² - α b² and
    e = β |L|, of one sign; D does not change in time. drive : D    slope : e
    """
    n_panels = max(1, math.ceil(math.sqrt(p) * abs(duration) / PANEL))
    half = 0.5 * duration / n_panels
    s, cn, dn = elliptic(half, p, r)
    s1, cn1, dn1 = elliptic(NODE_1 * half, p, r)
    s2, cn2, dn2 = elliptic(NODE_2 * half, p, r)
    s3, cn3, dn3 = elliptic(NODE_3 * half, p, r)
    s4, cn4, dn4 = elliptic(NODE_4 * half, p, r)
    x, y = p * s * s / (1.0 + cn), r * s * s / (1.0 + dn)
    total, ea, eb, ec = 0.0, 0.0, 0.0, 0.0
    for _ in range(n_panels):
        a, b, c, _, _, _ = moved(a, b, c, alpha, beta, gamma, s, cn, dn, x, y)
        product, square = alpha * b * c, -beta * gamma * a * a
        total += WEIGHT_4 * pair_of_rates(a, product, square, drive, slope, length, s4, cn4, dn4)
        total += WEIGHT_1 * pair_of_rates(a, product, square, drive, slope, length, s1, cn1, dn1)
        total += WEIGHT_3 * pair_of_rates(a, product, square, drive, slope, length, s3, cn3, dn3)
        total += WEIGHT_2 * pair_of_rates(a, product, square, drive, slope, length, s2, cn2, dn2)
        a, b, c, ea, eb, ec = moved(a, b, c, alpha, beta, gamma, s, cn, dn, x, y)
    return half * total, a, b, c, ea, eb, ec


def moved(a, b, c, alpha, beta, gamma, s, cn, dn, x, y):
    """The momentum after the time that s, cn, dn belong to, see `elliptic`, and what its last additions rounded off.

    x = 1 - cn, y = 1 - dn. Abramowitz and Stegun 16.17, with the amplitudes of the functions multiplied out, as what
    is added to the old momentum; the denominator 1 - k² sn² sn² = cn² - βγ a² s² is a sum of positive terms.

    >>> moved(0.6, 0.0, 0.8, 0.0, -1.0, 1.0, 0.0, 1.0, 1.0, 0.0, 0.0)
    (0.6, 0.0, 0.8, 0.0, 0.0, 0.0)
    """
    z = -beta * gamma * (a * s) * (a * s)
    scale = 1.0 / (cn * cn + z)
    da = scale * ((x * cn + (x - y) - z) * a + alpha * s * cn * (b * c))
    db = scale * ((x * cn - z) * b + beta * s * dn * (c * a))
    dc = scale * (((x - y) * cn - z) * c + gamma * s * (a * b))
    return a + da, b + db, c + dc, rounded_off(a, da), rounded_off(b, db), rounded_off(c, dc)


def rounded_off(x, y):
    """What x + y loses by rounding: exact (D. Knuth, The Art of Computer Programming 2, section 4.2.2).

    >>> rounded_off(1.0, 2.0**-60) == 2.0**-60
    True
    """
    total = x + y
    part = total - x
    return (x - (total - part)) + (y - part)


def pair_of_rates(a, product, square, drive, slope, length, s, cn, dn):
    """The sum of (D + e a)/(|L| + a) at a time before a given one and as much after it.

    There a is (P ± Q)/δ by the addition theorem of `moved`. With product = α b c and square = -βγ a².

    >>> pair_of_rates(0.25, 0.0, 0.0, 2.0, 0.0, 1.0, 0.0, 1.0, 1.0)
    3.2
    """
    delta, even, odd = cn * cn + square * s * s, a * dn, product * s * cn
    middle = length * delta + even
    return 2.0 * ((drive * delta + slope * even) * middle - slope * odd * odd) / ((middle - odd) * (middle + odd))
