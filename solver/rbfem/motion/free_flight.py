"""A body that only the uniform field moves: its parabola and its torque-free rotation, both exact over any time."""

from rbfem.motion.model import POSITION, QUATERNION, SPIN, STATE_WIDTH, TRANSLATING, VELOCITY
from rbfem.motion.rotation import exp, multiply
from rbfem.motion.rotor import turn_by_splitting, turn_freely
from rbfem.motion.short_turn import is_short, short_turn
from rbfem.motion.sums import add, add_turn, forget

# What turns a body between two kicks: the closed form, five turns about its axes, or one turn at constant rate.
EXACT_ROTOR, SPLIT_ROTOR, CONSTANT_RATE = 0, 1, 2


def fly(b, duration, state, bodies, gravity):
    """Move body b by `duration` (s, of either sign): x + v t + ½ g t², and the exact rotor."""
    translate(b, duration, state, bodies, gravity)
    if bodies.model[b] != TRANSLATING:
        turn(b, duration, EXACT_ROTOR, state, bodies)


def translate(b, duration, state, bodies, gravity):
    """The parabola of the reference point; one that is held stays."""
    if bodies.inverse_mass[b] > 0.0:
        for j in range(3):
            fallen = duration * gravity[j]
            state[b, POSITION + j] += duration * (state[b, VELOCITY + j] + 0.5 * fallen)
            state[b, VELOCITY + j] += fallen


def turn(b, duration, rotor, state, bodies):
    """Torque-free rotation of body b by one of the three rotors."""
    r1, r2, r3 = bodies.inverse_moments[b, 0], bodies.inverse_moments[b, 1], bodies.inverse_moments[b, 2]
    q0, q1 = state[b, QUATERNION], state[b, QUATERNION + 1]
    q2, q3 = state[b, QUATERNION + 2], state[b, QUATERNION + 3]
    x, y, z = state[b, SPIN], state[b, SPIN + 1], state[b, SPIN + 2]
    if rotor == EXACT_ROTOR:
        q0, q1, q2, q3, x, y, z = turn_freely(q0, q1, q2, q3, x, y, z, r1, r2, r3, duration)
    elif rotor == SPLIT_ROTOR:
        q0, q1, q2, q3, x, y, z = turn_by_splitting(q0, q1, q2, q3, x, y, z, r1, r2, r3, duration)
    else:
        e0, e1, e2, e3 = exp(duration * r1 * x, duration * r2 * y, duration * r3 * z)
        q0, q1, q2, q3 = multiply(q0, q1, q2, q3, e0, e1, e2, e3)
    state[b, QUATERNION], state[b, QUATERNION + 1] = q0, q1
    state[b, QUATERNION + 2], state[b, QUATERNION + 3] = q2, q3
    state[b, SPIN], state[b, SPIN + 1], state[b, SPIN + 2] = x, y, z


def fly_on(b, duration, rotor, state, rest, bodies, gravity):
    """`fly` by any rotor as one flight of many: `rest` is what the additions so far have rounded off, see `sums`."""
    if bodies.inverse_mass[b] > 0.0:
        for j in range(3):
            fallen = duration * gravity[j]
            add(b, POSITION + j, duration * (state[b, VELOCITY + j] + 0.5 * fallen), state, rest)
            add(b, VELOCITY + j, fallen, state, rest)
    if bodies.model[b] == TRANSLATING:
        return
    x, y, z = state[b, SPIN], state[b, SPIN + 1], state[b, SPIN + 2]
    r1, r2, r3 = bodies.inverse_moments[b, 0], bodies.inverse_moments[b, 1], bodies.inverse_moments[b, 2]
    if rotor == EXACT_ROTOR and is_short(x, y, z, r1, r2, r3, duration):
        t0, t1, t2, t3, dx, dy, dz = short_turn(x, y, z, r1, r2, r3, duration)
        add_turn(b, t0, t1, t2, t3, state, rest)
        add(b, SPIN, dx, state, rest)
        add(b, SPIN + 1, dy, state, rest)
        add(b, SPIN + 2, dz, state, rest)
    else:
        turn(b, duration, rotor, state, bodies)
        forget(b, QUATERNION, VELOCITY, rest)
        forget(b, SPIN, STATE_WIDTH, rest)
