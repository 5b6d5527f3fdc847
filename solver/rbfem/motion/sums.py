"""Sums over the steps of a run that carry what each addition rounds off.

A state is a sum of many small changes. Added up plainly, each of them costs half a last digit of the sum: a random
walk, and one in the angular momentum turns the body by ever more. Carried along, what is rounded off comes in with the
next change, and only the rounding of the changes themselves remains: the shorter the steps, the less.
Source: W. Kahan, Communications of the ACM 8:40, 1965, with the error of a sum by D. Knuth, see `rounded_off`.
"""

import math

from rbfem.motion.model import QUATERNION
from rbfem.motion.rotation import multiply
from rbfem.motion.rotor import rounded_off


def add(b, j, change, state, rest):
    """Add to column j of body b; rest[b, j] is what the additions so far have rounded off."""
    before, change = state[b, j], change + rest[b, j]
    state[b, j] = before + change
    rest[b, j] = rounded_off(before, change)


def add_turn(b, t0, t1, t2, t3, state, rest):
    """Multiply the attitude by the unit quaternion T from the right: q T = q + q (T - 1).

    T - 1 = (t0 - 1, t1, t2, t3), and for a turn of less than half a revolution t0 - 1 = -(t1² + t2² + t3²)/(1 + t0).
    """
    less = -(t1 * t1 + t2 * t2 + t3 * t3) / (1.0 + t0) if t0 > 0.0 else t0 - 1.0
    q0, q1 = state[b, QUATERNION], state[b, QUATERNION + 1]
    q2, q3 = state[b, QUATERNION + 2], state[b, QUATERNION + 3]
    c0, c1, c2, c3 = multiply(q0, q1, q2, q3, less, t1, t2, t3)
    add(b, QUATERNION, c0, state, rest)
    add(b, QUATERNION + 1, c1, state, rest)
    add(b, QUATERNION + 2, c2, state, rest)
    add(b, QUATERNION + 3, c3, state, rest)


def normalize(b, state, rest):
    """Bring the attitude back to length one: it adds (1/|q| - 1) q."""
    square = 0.0
    for j in range(QUATERNION, QUATERNION + 4):
        square += state[b, j] * state[b, j]
    length = math.sqrt(square)
    share = (1.0 - square) / (length * (1.0 + length))
    for j in range(QUATERNION, QUATERNION + 4):
        add(b, j, share * state[b, j], state, rest)


def forget(b, first, last, rest):
    """No rests in the columns from first to before last: what they belonged to has been replaced."""
    for j in range(first, last):
        rest[b, j] = 0.0
