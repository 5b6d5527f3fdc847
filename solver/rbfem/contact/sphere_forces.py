"""Forces between spheres, and between spheres and planes: the loops over all pairs that may touch."""

import math

from rbfem.contact.laws import touch
from rbfem.contact.model import BY_DAMPING, BY_FRICTION, LAW, NONE


def find_pair_forces(spheres, pairs, laws, n_materials, dt, wrench, loss):
    """Add the contact forces and torques between spheres to `wrench` (n, 6), and carry the memory of each on by dt.

    laws : (n_materials², LAW_WIDTH)     loss : (LOSS_WIDTH,) what damping and friction take, added to
    """
    place, rate, inertia, material = spheres.place, spheres.rate, spheres.inertia, spheres.material
    first, other, touches, memory = pairs.first, pairs.other, pairs.touches, pairs.memory
    by_damping, by_friction = 0.0, 0.0
    for i in range(len(place)):
        x, y, z, radius = place[i, 0], place[i, 1], place[i, 2], place[i, 3]
        vx, vy, vz, wx, wy, wz = rate[i, 0], rate[i, 1], rate[i, 2], rate[i, 3], rate[i, 4], rate[i, 5]
        fx, fy, fz, tx, ty, tz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for k in range(first[i], first[i + 1]):
            j = other[k]
            nx, ny, nz = x - place[j, 0], y - place[j, 1], z - place[j, 2]
            reach, squared = radius + place[j, 3], nx * nx + ny * ny + nz * nz
            row = material[i] * n_materials + material[j]
            lightness = inertia[i, 0] + inertia[j, 0]
            if squared >= reach * reach or laws[row, LAW] == NONE or lightness == 0.0:
                touches[k] = 0
                continue
            distance = math.sqrt(squared)
            curvature = 1.0 / distance
            nx, ny, nz = nx * curvature, ny * curvature, nz * curvature
            overlap = reach - distance
            arm, far = radius - 0.5 * overlap, place[j, 3] - 0.5 * overlap
            rx, ry, rz = rate[j, 3], rate[j, 4], rate[j, 5]
            spin = 0.5 * ((wx + rx) * nx + (wy + ry) * ny + (wz + rz) * nz)
            normal, hx, hy, hz, damped, slipped = touch(
                nx, ny, nz, curvature, overlap, vx - rate[j, 0], vy - rate[j, 1], vz - rate[j, 2],
                arm * wx + far * rx, arm * wy + far * ry, arm * wz + far * rz, spin,
                1.0 / lightness, radius * place[j, 3] / reach, dt, row, laws, k, touches, memory,
            )  # fmt: skip
            by_damping, by_friction = by_damping + damped, by_friction + slipped
            px, py, pz = normal * nx + hx, normal * ny + hy, normal * nz + hz
            qx, qy, qz = ny * hz - nz * hy, nz * hx - nx * hz, nx * hy - ny * hx
            fx, fy, fz, tx, ty, tz = fx + px, fy + py, fz + pz, tx - arm * qx, ty - arm * qy, tz - arm * qz
            wrench[j, 0] -= px
            wrench[j, 1] -= py
            wrench[j, 2] -= pz
            wrench[j, 3] -= far * qx
            wrench[j, 4] -= far * qy
            wrench[j, 5] -= far * qz
        wrench[i, 0] += fx
        wrench[i, 1] += fy
        wrench[i, 2] += fz
        wrench[i, 3] += tx
        wrench[i, 4] += ty
        wrench[i, 5] += tz
    loss[BY_DAMPING] += by_damping
    loss[BY_FRICTION] += by_friction


def find_wall_forces(spheres, walls, laws, n_materials, dt, wrench, on_wall, loss):
    """The same for spheres and planes; `on_wall` (w, 6) gets the force on each plane and its torque about zero."""
    place, rate = spheres.place, spheres.rate
    for k in range(len(walls.sphere)):
        i, w = walls.sphere[k], walls.wall[k]
        nx, ny, nz = walls.plane[w, 0], walls.plane[w, 1], walls.plane[w, 2]
        gap = nx * place[i, 0] + ny * place[i, 1] + nz * place[i, 2] - walls.plane[w, 3] - place[i, 3]
        row = spheres.material[i] * n_materials + walls.material[w]
        if gap >= 0.0 or laws[row, LAW] == NONE or spheres.inertia[i, 0] == 0.0:
            walls.touches[k] = 0
            continue
        arm = place[i, 3]
        wx, wy, wz = rate[i, 3], rate[i, 4], rate[i, 5]
        normal, hx, hy, hz, damped, slipped = touch(
            nx, ny, nz, 0.0, -gap, rate[i, 0], rate[i, 1], rate[i, 2], arm * wx, arm * wy, arm * wz,
            0.5 * (wx * nx + wy * ny + wz * nz), 1.0 / spheres.inertia[i, 0], place[i, 3], dt, row, laws, k,
            walls.touches, walls.memory,
        )  # fmt: skip
        loss[BY_DAMPING] += damped
        loss[BY_FRICTION] += slipped
        px, py, pz = normal * nx + hx, normal * ny + hy, normal * nz + hz
        wrench[i, 0] += px
        wrench[i, 1] += py
        wrench[i, 2] += pz
        wrench[i, 3] -= arm * (ny * hz - nz * hy)
        wrench[i, 4] -= arm * (nz * hx - nx * hz)
        wrench[i, 5] -= arm * (nx * hy - ny * hx)
        x, y, z = place[i, 0] - arm * nx, place[i, 1] - arm * ny, place[i, 2] - arm * nz
        on_wall[w, 0] -= px
        on_wall[w, 1] -= py
        on_wall[w, 2] -= pz
        on_wall[w, 3] -= y * pz - z * py
        on_wall[w, 4] -= z * px - x * pz
        on_wall[w, 5] -= x * py - y * px
