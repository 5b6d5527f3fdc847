"""What a short turn of a free rotor adds to the attitude and to the angular momentum.

The closed form of `rotor`, rearranged so that every number is a sum of terms that shrink with the turn: the changes
come out to rounding *of themselves*, not of what they are added to. Sums that carry what they round off can then take
as many of them as a run has steps.
"""

import math

from rbfem.motion.jacobi import elliptic
from rbfem.motion.rotation import multiply
from rbfem.motion.rotor import (
    NODE_1,
    NODE_2,
    NODE_3,
    NODE_4,
    PANEL,
    WEIGHT_1,
    WEIGHT_2,
    WEIGHT_3,
    WEIGHT_4,
    in_ring,
    pair_of_rates,
    places_to_middle,
    squared_rates,
)


def is_short(l1, l2, l3, r1, r2, r3, duration):
    """Whether a turn is one that `short_turn` is for: at most `PANEL` radians, and so one panel of eight nodes.

    >>> is_short(3.0, 0.0, 4.0, 0.5, 1.0, 0.2, -0.1), is_short(3.0, 0.0, 4.0, 0.5, 1.0, 0.2, 0.2)
    (True, False)
    """
    return math.sqrt(l1 * l1 + l2 * l2 + l3 * l3) * max(r1, r2, r3) * abs(duration) <= PANEL


def short_turn(l1, l2, l3, r1, r2, r3, duration):
    """The quaternion that the attitude is multiplied by, from the right, and the change of the angular momentum.

    dq/dt = ½ q ω,  dL/dt = L × ω,  ω = (r1 l1, r2 l2, r3 l3), for a turn that `is_short`

    l* : kg m^2/s, angular momentum in principal axes    r* : 1/(kg m^2), reciprocals of the principal moments, > 0
    returns : t0, t1, t2, t3 and three changes in kg m^2/s; the errors of t1, t2, t3 and of the changes over |L| are
              roundings of the angle that the body turns by, not of one

    >>> [round(x, 15) for x in short_turn(0.0, 0.0, 0.4, 1.0, 0.5, 1.0, 1.0)]
    [0.980066577841242, 0.0, 0.0, 0.198669330795061, 0.0, 0.0, 0.0]
    """
    length = math.sqrt(l1 * l1 + l2 * l2 + l3 * l3)
    if length == 0.0:
        return 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    ring = places_to_middle(r1, r2, r3)
    a, b, c = in_ring(ring, l1, l2, l3)
    ra, rb, rc = in_ring(ring, r1, r2, r3)
    p, r = squared_rates(a, b, c, rc - rb, ra - rc, rb - ra)
    is_quarter = r > p
    if is_quarter:
        a, b, ra, rb, p, r = b, -a, rb, ra, r, p
    side = 1.0 if a >= 0.0 else -1.0
    ta, tb, tc, da, db, dc = short_turn_about_pole(side * a, side * b, c, ra, rb, rc, p, r, length, duration)
    ta, tb, da, db = side * ta, side * tb, side * da, side * db
    if is_quarter:
        ta, tb, da, db = -tb, ta, -db, da
    t1, t2, t3 = in_ring(-ring, ta, tb, tc)
    d1, d2, d3 = in_ring(-ring, da, db, dc)
    return math.sqrt(1.0 - t1 * t1 - t2 * t2 - t3 * t3), t1, t2, t3, d1, d2, d3


def short_turn_about_pole(a, b, c, ra, rb, rc, p, r, length, duration):
    """ta, tb, tc and the changes of `short_turn`, where a >= 0, p >= r and rc is the middle one of the three.

    The turn P̄ E P₁/(|P| |P₁|) of `rotor.turn_about_pole`, E = (cos ψ/2, sin ψ/2, 0, 0) and P = (|L| + a, 0, c, -b), has
    the vector part of P̄ (P₁ - P) + P̄ (E - 1) P₁, both of which vanish with the duration.
    """
    alpha, beta, gamma = rc - rb, ra - rc, rb - ra
    psi, da, db, dc = short_advance(a, b, c, alpha, beta, gamma, p, r, length, duration)
    psi += duration * length * min(ra, rb)
    sine, cosine = math.sin(0.25 * psi), math.cos(0.25 * psi)
    cosine, sine = -2.0 * sine * sine, 2.0 * sine * cosine  # cos ψ/2 - 1 and sin ψ/2
    w, w1, b1, c1 = length + a, length + (a + da), b + db, c + dc
    _, ta, tb, tc = multiply(w, 0.0, -c, b, cosine * w1, sine * w1, cosine * c1 + sine * b1, sine * c1 - cosine * b1)
    ta, tb, tc = ta + (c * db - b * dc), tb + (w * dc - c * da), tc + (b * da - w * db)
    scale = 0.5 / (length * math.sqrt(w * w1))
    return ta * scale, tb * scale, tc * scale, da, db, dc


def short_advance(a, b, c, alpha, beta, gamma, p, r, length, duration):
    """`rotor.advance` in one panel: ψ - |L| min(ra, rb) duration, and the changes of a, b, c."""
    drive, slope = gamma * b * b - beta * c * c, 0.0
    if gamma < 0.0:
        drive, slope = alpha * c * c - gamma * a * a, -length * gamma
    half = 0.5 * duration
    s, cn, dn = elliptic(half, p, r)
    cn_less, dn_less = -p * s * s / (1.0 + cn), -r * s * s / (1.0 + dn)  # cn - 1 and dn - 1
    da, db, dc = change(a, b, c, alpha, beta, gamma, s, cn, dn, cn_less, dn_less)
    ma, mb, mc = a + da, b + db, c + dc
    product, square = alpha * mb * mc, -beta * gamma * ma * ma
    s1, cn1, dn1 = elliptic(NODE_1 * half, p, r)
    s2, cn2, dn2 = elliptic(NODE_2 * half, p, r)
    s3, cn3, dn3 = elliptic(NODE_3 * half, p, r)
    s4, cn4, dn4 = elliptic(NODE_4 * half, p, r)
    total = WEIGHT_4 * pair_of_rates(ma, product, square, drive, slope, length, s4, cn4, dn4)
    total += WEIGHT_1 * pair_of_rates(ma, product, square, drive, slope, length, s1, cn1, dn1)
    total += WEIGHT_3 * pair_of_rates(ma, product, square, drive, slope, length, s3, cn3, dn3)
    total += WEIGHT_2 * pair_of_rates(ma, product, square, drive, slope, length, s2, cn2, dn2)
    ea, eb, ec = change(ma, mb, mc, alpha, beta, gamma, s, cn, dn, cn_less, dn_less)
    return half * total, da + ea, db + eb, dc + ec


def change(a, b, c, alpha, beta, gamma, s, cn, dn, cn_less, dn_less):
    """What `rotor.moved` adds to a, b, c, from cn - 1 and dn - 1: its denominator is 1 - αβ c² s².

    >>> change(0.6, 0.0, 0.8, 0.0, -1.0, 1.0, 0.0, 1.0, 1.0, 0.0, 0.0)
    (0.0, 0.0, 0.0)
    """
    less = alpha * beta * (c * s) * (c * s)
    scale = 1.0 / (1.0 - less)
    return (
        scale * ((dn_less + less) * a + alpha * s * cn * (b * c)),
        scale * ((cn_less + less) * b + beta * s * dn * (c * a)),
        scale * ((cn_less + dn_less + cn_less * dn_less + less) * c + gamma * s * (a * b)),
    )
