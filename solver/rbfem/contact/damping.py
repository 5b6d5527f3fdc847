"""Damping from the restitution asked for."""

import math


def restitution_of(damping_ratio: float) -> float:
    """Restitution of a contact whose force is cut off where it would pull.

    For a linear spring and dashpot, m x'' + 2 ζ √(k m) x' + k x = 0, the force turns to tension where
    k x + c x' = 0, a while before the overlap is gone; there the contact ends, with speed e. Hertz's k x^(3/2) with
    c = √5 ζ √(m k) x^(1/4) has the same speed over x^(5/4), so the same e, whatever the speed of impact.

    damping_ratio : ζ ≥ 0
    Source: Schwager, Pöschel, Granular Matter 9:465, 2007; Antypov, Elliott, EPL 94:50004, 2011.

    >>> restitution_of(0.0)
    1.0
    >>> round(restitution_of(1.0), 6)  # exp(-2)
    0.135335
    """
    z = damping_ratio
    if z < 1.0:
        root = math.sqrt(1.0 - z * z)
        phase = math.atan2(2.0 * z * root, 2.0 * z * z - 1.0)
        return math.exp(-z / root * phase)
    if z == 1.0:
        return math.exp(-2.0)
    root = math.sqrt(z * z - 1.0)
    return math.exp(-z / root * math.log((z + root) / (z - root)))


def damping_ratio_for(restitution: float) -> float:
    """The inverse of `restitution_of`, for 0 < e ≤ 1.

    >>> round(restitution_of(damping_ratio_for(0.5)), 12)
    0.5
    """
    from scipy.optimize import brentq

    if restitution >= 1.0:
        return 0.0
    highest = 1.0
    while restitution_of(highest) > restitution:
        highest *= 2.0
    return float(brentq(lambda ratio: restitution_of(ratio) - restitution, 0.0, highest, xtol=1e-15))
