"""Spheres in contact: kick, drift and the forces of contact in turn, any number of steps in one call."""

import math

from rbfem.contact.model import BY_DAMPING, BY_FRICTION, LOSS_WIDTH
from rbfem.contact.sphere_forces import find_pair_forces, find_wall_forces
from rbfem.motion.rotation import multiply

# Columns of the journal of a run behind those of what damping and friction took since the start: the same before the
# last step; ∫ Σ m x dt; of the last call the steps, how far a sphere may get by one step more, and the longest step, m.
BEFORE, MOMENT = LOSS_WIDTH, 2 * LOSS_WIDTH
DONE, REACH, STRIDE, JOURNAL_WIDTH = MOMENT + 3, MOMENT + 4, MOMENT + 5, MOMENT + 6


def step_spheres(
    n_steps, dt, is_whole, allowed, spheres, pairs, walls, laws, n_materials, attitude, moved, gravity, wrench, on_wall,
    impulse, journal,
):  # fmt: skip
    """Take up to n_steps steps of dt, in place; fewer where spheres have moved so far that the lists must be made anew.

        v_½ = v_-½ + Δt a(x_0),  x_1 = x_0 + Δt v_½

    with the forces at x known from the step before: on entry `wrench` (n, 6) holds those at the places on entry, and on
    return those at the places on return. Rates stand half a step behind the places, except where `is_whole`.

    allowed : m, half of the skin: two that meet may use up half of it each; one step more is looked ahead
    moved   : (n, 3) m, since the lists were made       on_wall, impulse : (w, 6) wrench on each wall, and its integral
    journal : (JOURNAL_WIDTH,) see the columns
    """
    done, journal[REACH] = 0, 0.0
    while done < n_steps and journal[REACH] <= allowed:
        duration = 0.5 * dt if is_whole and done == 0 else dt
        for w in range(len(on_wall)):
            for j in range(6):
                impulse[w, j] += duration * on_wall[w, j]
        kick(duration, spheres, gravity, wrench, journal)
        drift(dt, spheres, attitude, moved, journal)
        journal[BEFORE], journal[BEFORE + 1] = journal[BY_DAMPING], journal[BY_FRICTION]
        find_forces(dt, spheres, pairs, walls, laws, n_materials, wrench, on_wall, journal)
        done += 1
    journal[DONE] = done


def kick(duration, spheres, gravity, wrench, journal):
    """Change the rates of all spheres as their wrenches and gravity do in `duration`, and clear the wrenches."""
    place, rate, inertia = spheres.place, spheres.rate, spheres.inertia
    sx, sy, sz = 0.0, 0.0, 0.0
    for i in range(len(place)):
        mass = inertia[i, 2]
        sx, sy, sz = sx + mass * place[i, 0], sy + mass * place[i, 1], sz + mass * place[i, 2]
        by_force, by_torque = duration * inertia[i, 0], duration * inertia[i, 1]
        fall = by_force * mass
        for j in range(3):
            rate[i, j] += by_force * wrench[i, j] + fall * gravity[j]
            rate[i, 3 + j] += by_torque * wrench[i, 3 + j]
            wrench[i, j], wrench[i, 3 + j] = 0.0, 0.0
    journal[MOMENT] += duration * sx
    journal[MOMENT + 1] += duration * sy
    journal[MOMENT + 2] += duration * sz


def drift(duration, spheres, attitude, moved, journal):
    """Let all spheres fly on and turn; see how far they get."""
    place, rate = spheres.place, spheres.rate
    farthest, fastest = 0.0, 0.0
    for i in range(len(place)):
        far, fast = 0.0, 0.0
        for j in range(3):
            step = duration * rate[i, j]
            place[i, j] += step
            moved[i, j] += step
            far, fast = far + moved[i, j] * moved[i, j], fast + step * step
        farthest, fastest = max(farthest, far), max(fastest, fast)
        turn_sphere(i, duration, rate[i, 3], rate[i, 4], rate[i, 5], attitude)
    journal[STRIDE] = math.sqrt(fastest)
    journal[REACH] = math.sqrt(farthest) + 2.0 * journal[STRIDE]  # if no step is twice as long as this one


def turn_sphere(i, duration, wx, wy, wz, attitude):
    """Turn the attitude about ω by (1 + b)²/(1 + b·b), b = ¼ ω Δt: of second order and without a sine. Nothing that a
    sphere does depends on its attitude."""
    x, y, z = 0.25 * duration * wx, 0.25 * duration * wy, 0.25 * duration * wz
    share = 2.0 / (1.0 + x * x + y * y + z * z)
    q0, q1, q2, q3 = multiply(
        share - 1.0, share * x, share * y, share * z, attitude[i, 0], attitude[i, 1], attitude[i, 2], attitude[i, 3]
    )
    attitude[i, 0], attitude[i, 1], attitude[i, 2], attitude[i, 3] = q0, q1, q2, q3


def find_forces(dt, spheres, pairs, walls, laws, n_materials, wrench, on_wall, journal):
    """Forces of all contacts at the places, and their memory carried on by dt."""
    for w in range(len(on_wall)):
        for j in range(6):
            on_wall[w, j] = 0.0
    find_pair_forces(spheres, pairs, laws, n_materials, dt, wrench, journal)
    find_wall_forces(spheres, walls, laws, n_materials, dt, wrench, on_wall, journal)
