"""From a State, in the axes of the stepper, to a Frame, in the axes of its reader."""

from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from rbfem.compute.rows import each_row
from rbfem.motion import loads as kinds
from rbfem.motion import quaternion
from rbfem.motion.model import ANGULAR_IMPULSE, FIXED, IMPULSE, LEDGER_WIDTH, WORK
from rbfem.motion.rotation import cross, multiply, rotate
from rbfem.motion.state import State, System
from rbfem.scene.scene import Scene
from rbfem.simulation.frame import Balance, ContactBalance, Frame

Array = NDArray[np.float64]

# Columns of what `look_at` returns: the first four for the reader, the others to be summed up over the bodies.
POSITION, ATTITUDE, VELOCITY, ANGULAR_VELOCITY = slice(0, 3), slice(3, 7), slice(7, 10), slice(10, 13)
TRANSLATION, ROTATION, WEIGHT, MOMENTUM, ANGULAR_MOMENTUM = 13, 14, 15, slice(16, 19), slice(19, 22)


NO_CONTACTS = ContactBalance(0.0, 0.0, 0.0, np.zeros(3), np.zeros(3))


@dataclass(frozen=True)
class Setting:
    """What all frames of a run have in common.

    falling : (2, 7) what gravity brings into the sum of the ledgers by the bodies that only it moves, for which nothing
              is integrated: the rates at time zero, and how fast these grow
    springs, sprung : (s,) rows of the load table that are springs, and the bodies that they are rows of
    """

    scene: Scene
    system: System
    falling: Array
    springs: NDArray[np.int64]
    sprung: NDArray[np.int64]


def setting_of(scene: Scene, system: System) -> Setting:
    """The setting of the frames of a scene."""
    bodies, gravity = system.bodies, system.gravity.tolist()
    mass = (bodies.inverse_mass > 0.0) * (1 - bodies.is_pushed) * bodies.mass
    falling = np.zeros((2, LEDGER_WIDTH))
    falling[0, IMPULSE : IMPULSE + 3] = mass.sum() * system.gravity
    mass = mass * ~scene.can_touch  # the moment of those is summed up step by step
    falling[0, ANGULAR_IMPULSE : ANGULAR_IMPULSE + 3] = cross(*(mass @ scene.position).tolist(), *gravity)
    falling[1, ANGULAR_IMPULSE : ANGULAR_IMPULSE + 3] = cross(*(mass @ scene.velocity).tolist(), *gravity)
    springs = np.flatnonzero(system.loads.kind == kinds.SPRING)
    return Setting(scene, system, falling, springs, np.searchsorted(bodies.first_load, springs, side="right") - 1)


def frame_of(setting: Setting, state: State, index: int, contacts: ContactBalance = NO_CONTACTS) -> Frame:
    """The frame of a state."""
    scene, bodies, gravity = setting.scene, setting.system.bodies, setting.system.gravity.tolist()
    table = each_row(
        partial(look_at, gravity),
        quaternion.normalize(state.quaternion), state.position, state.velocity, state.angular_momentum,
        bodies.inverse_moments, bodies.arm, scene.reference.quaternion, bodies.model, bodies.mass, bodies.inverse_mass,
    )  # fmt: skip
    balance = _balance(setting, state, table, contacts)
    return Frame(
        index=index,
        time=state.time,
        position=np.ascontiguousarray(table[:, POSITION]),
        quaternion=np.ascontiguousarray(table[:, ATTITUDE]),
        velocity=np.ascontiguousarray(table[:, VELOCITY]),
        angular_velocity=np.ascontiguousarray(table[:, ANGULAR_VELOCITY]),
        kinetic_energy=table[:, TRANSLATION] + table[:, ROTATION],
        balance=balance,
    )


def look_at(
    gravity, unit, position, velocity, angular_momentum, inverse_moments, arm, to_part, model, mass, inverse_mass
):
    """One body as its reader sees it, and what it has of energy and momentum.

    The centre of mass is at x + a, a = R arm, and moves with v + ω × a, where ω = R I⁻¹ L.

    unit, position, velocity, angular_momentum : of the reference point, the first normalised, see `State`
    to_part : principal axes -> part axes        the others : see `Bodies` and `System`
    returns : position, attitude of the part axes, velocity, angular velocity, J of translation and of rotation about
              the centre of mass, J of the weight, momentum if it is free, angular momentum about the world's origin or,
              if it is held, about its pivot: 22 numbers
    """
    (q0, q1, q2, q3), (p0, p1, p2, p3) = unit, to_part
    (lx, ly, lz), (rx, ry, rz) = angular_momentum, inverse_moments
    wx, wy, wz = rotate(q0, q1, q2, q3, lx * rx, ly * ry, lz * rz)
    ax, ay, az = rotate(q0, q1, q2, q3, arm[0], arm[1], arm[2])
    cx, cy, cz = cross(wx, wy, wz, ax, ay, az)
    x, y, z = position[0] + ax, position[1] + ay, position[2] + az
    vx, vy, vz = velocity[0] + cx, velocity[1] + cy, velocity[2] + cz
    translation = 0.5 * mass * (vx * vx + vy * vy + vz * vz)
    # The energy about a pivot, ½ L·ω, holds that of the moving centre of mass.
    rotation = 0.5 * (lx * lx * rx + ly * ly * ry + lz * lz * rz) - (inverse_mass == 0.0) * translation
    weight = -((model != FIXED) * mass) * (gravity[0] * x + gravity[1] * y + gravity[2] * z)
    free_mass = (inverse_mass > 0.0) * mass
    px, py, pz = free_mass * vx, free_mass * vy, free_mass * vz
    sx, sy, sz = rotate(q0, q1, q2, q3, lx, ly, lz)
    ox, oy, oz = cross(x, y, z, px, py, pz)
    return (
        x, y, z, *multiply(q0, q1, q2, q3, p0, -p1, -p2, -p3), vx, vy, vz, wx, wy, wz,
        translation, rotation, weight, px, py, pz, sx + ox, sy + oy, sz + oz,
    )  # fmt: skip


def _balance(setting: Setting, state: State, table: Array, contacts: ContactBalance) -> Balance:
    total, t = _sum_bodies(table), state.time
    ledger = _sum_bodies(state.ledger) + t * setting.falling[0] + 0.5 * t * t * setting.falling[1]
    return Balance(
        kinetic=float(total[TRANSLATION]),
        rotational=float(total[ROTATION]),
        gravity=float(total[WEIGHT]),
        elastic=_elastic_energy(setting, state) + contacts.elastic,
        damping=contacts.damping,
        friction=contacts.friction,
        work=float(ledger[WORK]),
        momentum=total[MOMENTUM],
        angular_momentum=total[ANGULAR_MOMENTUM],
        impulse=ledger[IMPULSE : IMPULSE + 3] + contacts.impulse,
        angular_impulse=ledger[ANGULAR_IMPULSE : ANGULAR_IMPULSE + 3] + contacts.angular_impulse,
    )


def _sum_bodies(table: Array) -> Array:
    """Sums of the columns, laid out so that NumPy adds each up by halves: the rounding of many bodies stays small."""
    return np.ascontiguousarray(table.T).sum(axis=1)


def _elastic_energy(setting: Setting, state: State) -> float:
    """Σ ½ k (l - L0)²; a spring between two bodies stands twice in the table, once for each."""
    loads, springs, sprung = setting.system.loads, setting.springs, setting.sprung
    if not len(springs):
        return 0.0
    values, other, unit = loads.values[springs], loads.other[springs], quaternion.normalize(state.quaternion)
    near = state.position[sprung] + quaternion.rotate(unit[sprung], values[:, 0:3])
    on_body = state.position[other] + quaternion.rotate(unit[other], values[:, 3:6])
    far = np.where(other[:, None] >= 0, on_body, values[:, 3:6])
    length = np.linalg.norm(far - near, axis=1)
    share = np.where(other >= 0, 0.25, 0.5)
    return float((share * values[:, 6] * (length - values[:, 8]) ** 2).sum())
